//! The checker itself must not be blind.

use crate::Steps;
use crate::scan::{Source, module_of};

/// A crate of four steps, and the program after them.
const STEPS: Steps = &[
    &["units"],
    &["layers"],
    &["walls", "skin"],
    &["vary"],
    &["pace"],
    &["cli"],
    &["main"],
];

fn faults(path: &str, text: &str) -> Vec<String> {
    super::faults("src", STEPS, &Source::new(path, text))
}

fn circles(files: &[(&str, &str)]) -> Vec<(String, Vec<String>)> {
    let sources = files
        .iter()
        .map(|(name, text)| (module_of(name), Source::new(name, text)));
    super::circles(&sources.collect()).into_iter().collect()
}

#[track_caller]
fn assert_fault(path: &str, text: &str, expected: &str) {
    let found = faults(path, text);
    assert_eq!(found.len(), 1, "{text}: {found:?}");
    assert!(found[0].contains(expected), "{found:?}");
}

#[track_caller]
fn assert_clean(path: &str, text: &str) {
    assert_eq!(faults(path, text), Vec::<String>::new(), "{text}");
}

#[test]
fn a_back_edge_is_caught_with_its_line() {
    assert_fault(
        "layers.rs",
        "use crate::units::Mm;\n\nuse crate::pace::Pacer;\n",
        "src/layers.rs:3: `layers` may not import `pace`",
    );
}

#[test]
fn every_way_to_write_it_is_caught() {
    for text in [
        "use crate::{units, pace};",
        "use crate::{units::{Mm, Mm2}, pace::Plan};",
        "use {crate::units, crate::pace};",
        "pub use crate :: pace;",
        "fn f() -> crate::pace::Plan {}",
        "fn f() { let s = \"// \"; crate::pace::plan() }",
        "fn f<'a>(c: char) { if c == '\"' { crate::pace::plan('\"') } }",
        "use super::super::pace;",
        "mod inner { use super::super::super::pace; }",
        "#[cfg(test)] mod tests { use crate::pace::plan; }",
        "use isoslice::pace;",
        "macro_rules! m { () => { $crate::pace::plan() } }",
        "const S: &str = r#\" \" \"#; use crate::pace;",
    ] {
        assert_fault("vary/tile.rs", text, "may not import `pace`");
    }
    assert_fault("units.rs", "use super::pace;", "`pace`");
    assert_fault("vary/mod.rs", "use super::{pace, units};", "`pace`");
}

#[test]
fn siblings_may_not_meet() {
    assert_fault("skin/mod.rs", "use crate::walls;", "sibling `walls`");
    assert_fault("walls.rs", "use crate::skin::Skin;", "sibling");
}

#[test]
fn the_whole_root_may_not_be_imported() {
    assert_fault("pace.rs", "use crate::*;", "by name");
    assert_fault("pace.rs", "use super::*;", "by name");
}

#[test]
fn unknown_modules_must_be_added() {
    assert_fault("mystery.rs", "", "add it to tests/architecture.rs");
    assert_fault("pace.rs", "use crate::mystery::X;", "`mystery`");
}

#[test]
fn comments_and_strings_do_not_count() {
    assert_clean(
        "units.rs",
        "//! Used by [`crate::gcode`].\n/// crate::pace::x\n\
         // use crate::cli;\n\
         const S: &str = \"use crate::cli; \\\" use crate::cli;\";\n\
         const R: &str = r##\"\"# use crate::cli;\"##;\n",
    );
}

#[test]
fn forward_and_inner_paths_are_clean() {
    assert_clean(
        "vary/tile.rs",
        "use crate::{layers::LayerSpan, walls::{Wall, Side}};\n\
         use super::Grid;\nuse crate::vary::Grid as G;\n\
         pub(crate) fn f() {}\npub(in crate::vary) fn g() {}\n\
         mod tests { use super::*; use super::super::Grid; }\n",
    );
    assert_clean("units.rs", "mod tests { use super::*; }");
    assert_clean("main.rs", "use isoslice::cli;");
    assert_clean("main.rs", "mod tests { use super::*; }");
}

#[test]
fn heavy_crates_stay_where_they_belong() {
    assert_fault("walls.rs", "use anyhow::Context;", "`anyhow`");
    assert_fault("walls.rs", "fn f(t: &::anyhow::Error) {}", "`anyhow`");
    assert_fault("pace.rs", "#[derive(clap::Parser)]", "`clap`");
    assert_fault("pace.rs", "use clap as c;", "`clap`");
    assert_clean("cli/mod.rs", "use clap::Parser; use anyhow::Result;");
}

#[test]
fn circles_are_found_and_named() {
    let circle = |names: [&str; 2]| {
        vec![("vary".to_owned(), names.map(str::to_owned).to_vec())]
    };
    let all = "mod a;\nmod b;\npub use b::{B, C as D};\n";
    let one_way = [
        ("vary/mod.rs", all),
        ("vary/a.rs", "use super::b::B;\nfn f() { super::mine() }"),
        ("vary/b.rs", "mod tests { use super::super::a::A; }"),
    ];
    assert_eq!(circles(&one_way), []);
    for back in [
        "use super::a::A;",
        "fn f() -> crate::vary::a::A {}",
        "use super::{a, C};",
    ] {
        let mut files = one_way;
        files[2].1 = back;
        assert_eq!(circles(&files), circle(["a", "b"]), "{back}");
        // This path leads past the folder's face.
        files[1].1 = "use super::B;";
        assert_eq!(circles(&files), circle(["a", "b"]), "{back}");
    }
    // A crate's root is a face as well.
    let root = [
        ("lib.rs", "mod a;\nmod b;\npub use b::B;"),
        ("a.rs", "use crate::B;"),
        ("b.rs", "use crate::a::A;"),
    ];
    let named = vec!["a".to_owned(), "b".to_owned()];
    assert_eq!(circles(&root), vec![(String::new(), named)]);
    // A folder in a folder counts as one file.
    let nested = [
        ("vary/mod.rs", ""),
        ("vary/a/mod.rs", ""),
        ("vary/a/deep.rs", "use crate::vary::b::B;"),
        ("vary/b.rs", "use super::a::deep::Deep;"),
    ];
    assert_eq!(circles(&nested), circle(["a", "b"]));
}
