//! The order of the modules, as a test: data flows one way, and so do the
//! imports.
//!
//! Cargo keeps the order of the crates: none can name one that comes after it.
//! Inside the crates listed in [`ORDER`], this test keeps the order of the
//! modules. It reads every file below their `src` and every path in it that leads to another
//! one (`crate::…`, `isoslice::…`, `super::…`, `self::…`). It fails where
//! - a module imports one below it in [`ORDER`], or a sibling on its step;
//! - files of one folder import one another in a circle ([`CIRCLES`] has the
//!   exceptions);
//! - a module names a crate that belongs elsewhere ([`CONFINED`]);
//! - a file names the whole `Settings` that could have a plan ([`KNOWING`]).
//!
//! Not seen: what a glob re-exports, and circles between a folder's `mod.rs`
//! and the files below it. `mod.rs` is the folder's face: it declares the
//! types that the files share and calls those files. So does a crate's `lib.rs`.

// A test that cannot go on should say so and stop.
#![allow(
    clippy::panic,
    clippy::unwrap_used,
    reason = "helpers of tests may fail, too"
)]

#[path = "architecture/checker.rs"]
mod checker;
#[path = "architecture/scan.rs"]
mod scan;

use scan::{Module, Reference, Source, module_of};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

/// The modules of a crate from first to last. Names on one step are siblings,
/// which may not import one another.
type Steps = &'static [&'static [&'static str]];

/// The crates that hold several steps, by their folders.
const ORDER: &[(&str, Steps)] = &[
    (
        "crates/base/src",
        &[
            &["units"],
            &["sets", "random"],
            // Every reader of text files needs `encoding`.
            &["encoding"],
            // Several name the values of their enums, and have tables of words.
            &["named", "pairs"],
            // Both `limits` and `timings` need the processor time of a thread.
            &["stopwatch"],
            // Any loop may ask whether it is to go on.
            &["limits"],
            // Work that may stop says so in words.
            &["problem"],
            // Threads of a loop are under the watch of the one that begins it.
            &["parallel"],
            // Reading a pipe may take long, so `files` and `archive` ask `limits`
            // as well.
            &["files", "archive"],
            // `timings` has a stopwatch for every stage, and knows none of
            // them.
            &["timings"],
        ],
    ),
    (
        "crates/layer/src",
        &[
            // Any stage that makes strokes may thin them, and all stages may ask
            // what is around a layer.
            &["resolution", "view"],
            // Nearly all ask what of an area others cover.
            &["cover"],
            &["outline", "walls", "floating"],
            // `exposure` splits what walls leave.
            &["exposure"],
            &["fuzzy", "skin", "infill", "adhesion"],
            // Where loops begin follows from the walls before fuzzy skin.
            &["seam"],
        ],
    ),
    (
        "crates/held/src",
        &[
            // `overhangs` finds what hangs, except for what the skin's bridges hold.
            &["overhangs"],
            // `support` holds what hangs. Skin says where bridges hold it.
            &["support"],
        ],
    ),
    (
        "crates/gcode-read/src",
        &[
            // `package` makes archives of G-code, and opens them.
            &["package"],
            // `bgcode` has the binary form of G-code. Whoever reads it also
            // opens archives.
            &["bgcode"],
            // `reader` makes moves of any slicer's G-code.
            &["reader"],
        ],
    ),
    (
        "crates/path/src",
        &[
            &["order"],
            // `spiral` only lays turns, which need no order.
            &["spiral"],
            // `z_contouring` moves beads that have their order and their ends.
            &["z_contouring"],
            &["travel"],
            &["pace"],
        ],
    ),
    ("src", &[&["cli"], &["main"]]),
];

/// Files that import one another in a circle, by folder. No others may, and
/// whoever opens a circle takes it off this list.
const CIRCLES: &[(&str, &[&str])] = &[
    // A table, its macro, and the reasons that its rows name, which may stay.
    ("crates/settings/src", &["idle", "rows", "table"]),
    // What a value is, and the errors about it, which name each other.
    (
        "crates/isoslice-python/src",
        &["error", "list", "request", "value"],
    ),
    // The formats of files, and the table that translates their keys.
    (
        "crates/slicerprofile/src",
        &[
            "conversion",
            "cura",
            "gcode",
            "given",
            "ini",
            "orca",
            "parents",
            "project",
            "source",
            "table",
        ],
    ),
];

/// Files that know the whole `Settings`, besides those named `plan.rs` and the
/// crate of the settings itself. All others get a plan of plain numbers, or the
/// few values that they need.
const KNOWING: &[&str] = &[
    // What follows from settings alone.
    "crates/check/src/rules.rs",
    "crates/model/src/placement/mod.rs",
    "crates/preview/src/toolpath.rs",
    "crates/pipeline/src/plans.rs",
    // Who reads settings.
    "crates/gcode/src/join/file.rs",
    "crates/isoslice-python/src/request.rs",
    "src/cli/args.rs",
    "src/cli/new.rs",
    "src/cli/settings.rs",
    "crates/plate/src/schema.rs",
    // What users of the library call.
    "src/lib.rs",
    "crates/pipeline/src/hanging.rs",
    "crates/pipeline/src/run.rs",
    "crates/plate/src/lib.rs",
    // Tests of the settings, and what gives all other tests theirs.
    "tests/common/mod.rs",
    "tests/texts/hostile.rs",
    "tests/texts/profiles.rs",
    "tests/texts/settings.rs",
];

/// Files in which a case of an enum, or a struct of another crate, has the
/// name.
const NAMESAKES: &[&str] = &["benches/through-mesh/mesh.rs", "src/cli/mod.rs"];

/// Crates that only some modules of the root package may name.
const CONFINED: &[Confined] = &[
    Confined {
        name: "clap",
        modules: &["cli"],
    },
    Confined {
        name: "httparse",
        modules: &["cli"],
    },
    Confined {
        name: "ureq",
        modules: &["cli"],
    },
    Confined {
        name: "anyhow",
        modules: &["cli"],
    },
];

struct Confined {
    name: &'static str,
    modules: &'static [&'static str],
}

/// All files of a crate, in `folder`, by their modules.
fn sources(folder: &str) -> BTreeMap<Module, Source> {
    fn collect(dir: &Path, root: &Path, found: &mut BTreeMap<Module, Source>) {
        for entry in fs::read_dir(dir).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                collect(&path, root, found);
            } else if path.extension().is_some_and(|e| e == "rs") {
                let name = path.strip_prefix(root).unwrap().to_str().unwrap();
                let name = name.replace('\\', "/");
                let text = fs::read_to_string(&path).unwrap();
                found.insert(module_of(&name), Source::new(&name, &text));
            }
        }
    }
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
    let mut found = BTreeMap::new();
    collect(&root, &root, &mut found);
    found
}

/// The folders of all crates: the program's, and those below `crates`.
fn folders() -> Vec<String> {
    let crates = Path::new(env!("CARGO_MANIFEST_DIR")).join("crates");
    let name = |entry: fs::DirEntry| {
        format!("crates/{}/src", entry.file_name().to_str().unwrap())
    };
    let below = fs::read_dir(crates)
        .unwrap()
        .map(|entry| name(entry.unwrap()));
    std::iter::once("src".to_owned()).chain(below).collect()
}

#[test]
fn imports_follow_the_order_of_the_modules() {
    let of_crate = |(folder, steps): &(&str, Steps)| {
        let sources = sources(folder);
        let faults = sources.values().flat_map(|s| faults(folder, steps, s));
        faults.collect::<Vec<_>>()
    };
    let faults: Vec<_> = ORDER.iter().flat_map(of_crate).collect();
    assert!(faults.is_empty(), "\n{}\n", faults.join("\n"));
}

#[test]
fn every_name_in_the_lists_is_in_use() {
    for (folder, steps) in ORDER {
        let sources = sources(folder);
        let mut named = BTreeSet::new();
        for module in steps.iter().flat_map(|step| step.iter()) {
            let known = sources.contains_key(&module_of(module));
            assert!(known, "no module {module} in {folder}");
            let once = named.insert(module);
            assert!(once, "{module} of {folder} is on two steps");
        }
    }
    let sources = sources("src");
    for Confined { name, modules } in CONFINED {
        for module in *modules {
            let used = sources
                .values()
                .filter(|source| source.is_in(module))
                .flat_map(|source| &source.references)
                .any(|r| !r.in_test && r.path[0] == *name);
            assert!(used, "{module} does not use {name}: take it off the list");
        }
    }
}

#[test]
fn files_of_a_folder_import_one_another_in_no_circle() {
    let mut found = BTreeSet::new();
    for folder in folders() {
        for (inner, circle) in circles(&sources(&folder)) {
            let name = format!("{folder}/{inner}");
            found.insert((name.trim_end_matches('/').to_owned(), circle));
        }
    }
    let listed = CIRCLES.iter().map(|(folder, files)| {
        (
            folder.to_string(),
            files.iter().map(|f| f.to_string()).collect(),
        )
    });
    let listed: BTreeSet<(String, Vec<String>)> = listed.collect();
    let new: Vec<_> = found.difference(&listed).collect();
    let opened: Vec<_> = listed.difference(&found).collect();
    assert!(
        new.is_empty() && opened.is_empty(),
        "new circles: {new:#?}\nno longer circles, so take them off CIRCLES: \
         {opened:#?}"
    );
}

#[test]
fn only_plans_know_the_settings() {
    let folders = folders().into_iter();
    let others = ["benches", "fuzz", "tests"].map(str::to_owned);
    let mut found = BTreeSet::new();
    let mut plans = 0;
    for folder in folders.chain(others) {
        if folder == "crates/settings/src" {
            continue;
        }
        for source in sources(&folder).into_values() {
            if !source.words.contains("Settings") {
                continue;
            }
            if source.module.last().is_some_and(|m| m == "plan") {
                plans += 1;
            } else {
                found.insert(format!("{folder}/{}", source.name));
            }
        }
    }
    let listed = KNOWING.iter().chain(NAMESAKES).map(|name| name.to_string());
    let listed: BTreeSet<String> = listed.collect();
    let new: Vec<_> = found.difference(&listed).collect();
    let gone: Vec<_> = listed.difference(&found).collect();
    assert!(
        new.is_empty() && gone.is_empty(),
        "a plan.rs may ask for {new:?}; take {gone:?} off the list"
    );
    let count = plans + KNOWING.len();
    assert!(count <= 40, "{count} files know the settings");
}

/// Whether the root package hands a name out: a module of other crates' items,
/// or an item.
fn is_handed_out(name: &str) -> bool {
    let words = |line: &'static str| {
        line.split(|c: char| !c.is_alphanumeric() && c != '_')
    };
    include_str!("../src/lib.rs")
        .lines()
        .filter_map(|line| {
            line.strip_prefix("pub use ")
                .or_else(|| line.strip_prefix("pub mod "))
                .or_else(|| line.strip_prefix("pub fn "))
        })
        .any(|line| words(line).any(|word| word == name))
}

/// Everything wrong with the imports of one file of a crate, as lines to print.
fn faults(folder: &str, steps: Steps, source: &Source) -> Vec<String> {
    let step_of = |module: &str| steps.iter().position(|s| s.contains(&module));
    // The root only declares and re-exports.
    let Some(here) = source.module.first().map(String::as_str) else {
        return Vec::new();
    };
    let Some(step) = step_of(here) else {
        return vec![format!(
            "{folder}/{}: module `{here}` is not in ORDER: add it to \
             tests/architecture.rs",
            source.name
        )];
    };
    let fault = |r: &Reference| {
        let to = r.path[0].as_str();
        if r.external {
            let confined = CONFINED.iter().find(|c| c.name == to)?;
            let modules = confined.modules.join(", ");
            return (!confined.modules.contains(&here))
                .then(|| format!("`{to}` belongs in {modules} only"));
        }
        if to == here || to == "self" {
            return None;
        }
        if to == "*" {
            return Some("import modules by name, not the whole root".into());
        }
        // Only the program sees the library from outside.
        if ["cli", "main"].contains(&here) && is_handed_out(to) {
            return None;
        }
        match step_of(to) {
            None => Some(format!(
                "`{to}` is not in ORDER: add it to tests/architecture.rs"
            )),
            Some(there) if there > step => Some(format!(
                "`{here}` may not import `{to}`, which comes after it"
            )),
            Some(there) if there == step => {
                Some(format!("`{here}` may not import its sibling `{to}`"))
            }
            Some(_) => None,
        }
    };
    let line = |r: &Reference| {
        let fault = fault(r)?;
        Some(format!("{folder}/{}:{}: {fault}", source.name, r.line))
    };
    source.references.iter().filter_map(line).collect()
}

/// The circles among the files of each folder; a folder in it counts as one
/// file, and tests do not count.
fn circles(
    sources: &BTreeMap<Module, Source>,
) -> BTreeSet<(String, Vec<String>)> {
    // Arrows by folder, from one name in it to another.
    let mut arrows: BTreeMap<&[String], BTreeSet<(&str, &str)>> =
        BTreeMap::new();
    let targets: Vec<_> = sources
        .values()
        .flat_map(|source| source.references.iter().map(move |r| (source, r)))
        .filter(|(_, r)| !r.in_test && !r.external)
        .map(|(source, r)| (&source.module, target(r.path.clone(), sources)))
        .filter(|(_, to)| sources.contains_key(to))
        .collect();
    for (from, to) in &targets {
        let shared = from.iter().zip(to).take_while(|(a, b)| a == b).count();
        // A folder and what is below it share all of its name.
        if shared < from.len().min(to.len()) {
            let arrow = (from[shared].as_str(), to[shared].as_str());
            arrows.entry(&from[..shared]).or_default().insert(arrow);
        }
    }
    let mut found = BTreeSet::new();
    for (folder, mut arrows) in arrows {
        // From each name to all that it leads to in the end.
        loop {
            let further: Vec<_> = arrows
                .iter()
                .flat_map(|a| arrows.iter().map(move |b| (a, b)))
                .filter(|(a, b)| a.1 == b.0)
                .map(|(a, b)| (a.0, b.1))
                .collect();
            let before = arrows.len();
            arrows.extend(further);
            if arrows.len() == before {
                break;
            }
        }
        for (name, _) in arrows.iter().filter(|(a, b)| a == b) {
            let both = |other: &&str| {
                arrows.contains(&(name, *other))
                    && arrows.contains(&(*other, name))
            };
            let names: BTreeSet<_> = arrows.iter().map(|a| a.0).collect();
            let circle = names.into_iter().filter(both).map(str::to_owned);
            found.insert((folder.join("/"), circle.collect()));
        }
    }
    found
}

/// The file that a path leads to, past the re-exports of folders.
fn target(mut path: Vec<String>, sources: &BTreeMap<Module, Source>) -> Module {
    // More re-exports in a row would be a circle of their own.
    for _ in 0..8 {
        let known = (0..=path.len())
            .rev()
            .find(|n| sources.contains_key(&path[..*n]));
        let Some(known) = known else { break };
        let (module, rest) = path.split_at(known);
        let passed_on = rest.first().and_then(|name| {
            let references = sources[module].references.iter();
            let mut of_children = references.filter(|r| {
                r.is_use
                    && r.path.len() > known + 1
                    && r.path.starts_with(module)
            });
            of_children.find(|r| r.path.last() == Some(name))
        });
        let Some(passed_on) = passed_on else {
            return module.to_vec();
        };
        path = passed_on.path.iter().chain(&rest[1..]).cloned().collect();
    }
    path
}
