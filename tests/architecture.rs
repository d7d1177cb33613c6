//! The order of the modules, as a test: data flows one way, and so do the
//! imports.
//!
//! The test reads every file below `src` and every path in it that leads to
//! another one (`crate::…`, `isoslice::…`, `super::…`, `self::…`). It fails
//! where
//! - a module imports one on its right in [`ORDER`], or a sibling on its step;
//! - files of one folder import one another in a circle ([`CIRCLES`] has the
//!   exceptions), also in the crates;
//! - a module names a crate that belongs elsewhere ([`CONFINED`]).
//!
//! Not seen: what a glob re-exports, and circles between a folder's `mod.rs`
//! and the files below it. `mod.rs` is the folder's face: it declares the
//! types that the files share and calls those files.

// A test that cannot go on should say so and stop.
#![allow(clippy::unwrap_used, reason = "helpers of tests may unwrap, too")]

#[path = "architecture/checker.rs"]
mod checker;
#[path = "architecture/scan.rs"]
mod scan;

use scan::{Module, Reference, Source, module_of};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

/// The modules from left to right; names on one step are siblings, which may
/// not import one another.
const ORDER: &[&[&str]] = &[
    &["units"],
    &["sets", "random"],
    // Every reader of text files needs `encoding`.
    &["encoding"],
    // Both `limits` and `timings` need the processor time of a thread.
    &["stopwatch"],
    // Any loop may ask whether it is to go on.
    &["limits"],
    // Reading a pipe may take long, so `files` asks `limits` as well.
    &["files"],
    // `timings` has a stopwatch for every stage, and knows none of them.
    &["timings"],
    // `plane` is plain geometry. It knows neither settings nor fields.
    &["plane"],
    &["settings"],
    &["model"],
    &["layers"],
    // `vary` gives settings that are expressions their value at each place.
    &["vary"],
    // Heights of layers may be an expression.
    &["heights"],
    &["contour"],
    // The cross-section of a bead says how far apart walls lie, and with that
    // what they leave for filling. So `region` comes after it.
    &["bead"],
    // Any stage that makes strokes may thin them.
    &["resolution"],
    &["region"],
    &["walls", "fuzzy", "skin", "infill", "adhesion"],
    // `plate` has the parts to print, with their brims.
    &["plate"],
    // `hang` finds what hangs, except for what the skin's bridges hold.
    &["hang"],
    // `support` holds what hangs. Skin says where bridges hold it.
    &["support"],
    // Where loops begin follows from the walls before fuzzy skin.
    &["seam"],
    &["order"],
    // `spiral` only lays turns, which need no order.
    &["spiral"],
    // `relief` moves beads that have their order and their ends.
    &["relief"],
    &["travel"],
    // `package` makes archives of G-code, and opens them.
    &["package"],
    // `bgcode` has the binary form of G-code. Whoever reads it also opens
    // archives.
    &["bgcode"],
    // `reader` makes moves of any slicer's G-code. The clock of `pace` times
    // them.
    &["reader"],
    &["pace"],
    &["gcode", "report"],
    // `check` tells whether G-code is safe to run.
    &["check"],
    &["preview"],
    &["pipeline"],
    &["cli"],
    &["main"],
];

/// Files that import one another in a circle, by folder. No others may, and
/// whoever opens a circle takes it off this list.
const CIRCLES: &[(&str, &[&str])] = &[
    // A table and its macro, which may stay.
    ("src/settings", &["rows", "table"]),
];

/// Crates that only some modules may name.
const CONFINED: &[Confined] = &[
    Confined {
        name: "fidget",
        modules: &["model", "vary", "contour", "preview"],
        in_tests: true,
    },
    Confined {
        name: "clap",
        modules: &["cli"],
        in_tests: false,
    },
    Confined {
        name: "httparse",
        modules: &["cli"],
        in_tests: false,
    },
    Confined {
        name: "ureq",
        modules: &["cli"],
        in_tests: false,
    },
    Confined {
        name: "anyhow",
        modules: &["cli", "main"],
        in_tests: false,
    },
];

struct Confined {
    name: &'static str,
    modules: &'static [&'static str],
    /// Whether test modules may name it anywhere.
    in_tests: bool,
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
    // The root only declares and re-exports.
    found.remove(&module_of("lib.rs"));
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
    let faults: Vec<_> = sources("src").values().flat_map(faults).collect();
    assert!(faults.is_empty(), "\n{}\n", faults.join("\n"));
}

#[test]
fn every_name_in_the_lists_is_in_use() {
    let sources = sources("src");
    for module in ORDER.iter().flat_map(|step| step.iter()) {
        let known = sources.contains_key(&module_of(module));
        assert!(known, "no module {module}");
    }
    for Confined { name, modules, .. } in CONFINED {
        for module in *modules {
            let used = sources
                .values()
                .filter(|source| source.module[0] == *module)
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

/// Whether the library's root re-exports a name from one of its modules.
fn is_re_exported(name: &str) -> bool {
    include_str!("../src/lib.rs")
        .lines()
        .filter_map(|line| line.strip_prefix("pub use "))
        .any(|line| {
            line.split(|c: char| !c.is_alphanumeric() && c != '_')
                .any(|word| word == name)
        })
}

/// Everything wrong with the imports of one file, as lines to print.
fn faults(source: &Source) -> Vec<String> {
    let here = source.module[0].as_str();
    let Some(step) = step_of(here) else {
        return vec![format!(
            "src/{}: module `{here}` is not in ORDER: add it to \
             tests/architecture.rs",
            source.name
        )];
    };
    let fault = |r: &Reference| {
        let to = r.path[0].as_str();
        if r.external {
            let confined = CONFINED.iter().find(|c| c.name == to)?;
            let free = confined.in_tests && r.in_test;
            let allowed = free || confined.modules.contains(&here);
            let modules = confined.modules.join(", ");
            return (!allowed)
                .then(|| format!("`{to}` belongs in {modules} only"));
        }
        if to == here || to == "self" {
            return None;
        }
        if to == "*" {
            return Some("import modules by name, not the whole root".into());
        }
        // Only the program sees the library from outside.
        if ["cli", "main"].contains(&here) && is_re_exported(to) {
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
        Some(format!("src/{}:{}: {}", source.name, r.line, fault(r)?))
    };
    source.references.iter().filter_map(line).collect()
}

fn step_of(module: &str) -> Option<usize> {
    ORDER.iter().position(|step| step.contains(&module))
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
        let known = (1..=path.len())
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
