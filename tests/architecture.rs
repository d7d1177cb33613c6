//! The order of the modules, as a test: data flows one way, and so do the
//! imports.
//!
//! Reads every file below `src`, looks for paths that start at the crate's
//! root (`crate::…`, `isoslice::…`, `super::…` where it climbs that far), and
//! fails when one leads to a module on the right of the importing one in
//! [`ORDER`], or to a sibling on the same step. Also keeps the heavy crates
//! where they belong ([`CONFINED`]).
//!
//! It reads tokens, not types: a path built inside a macro's body is seen as
//! written, and what a re-export leads to is not followed.

// A test that cannot go on should say so and stop.
#![allow(clippy::unwrap_used)]

use std::fs;
use std::path::{Path, PathBuf};

/// The modules from left to right; names on one step are siblings, which may
/// not import one another.
const ORDER: &[&[&str]] = &[
    &["units"],
    // Whoever reads files of text.
    &["encoding"],
    // Any loop may ask whether it is to go on.
    &["limits"],
    // Reading a pipe may be waiting, so it asks as well.
    &["files"],
    // A stopwatch for every stage; it knows none of them.
    &["timings"],
    // Plain geometry: it knows neither settings nor fields.
    &["plane"],
    &["settings"],
    &["model"],
    &["layers"],
    // What settings that are expressions amount to, place by place.
    &["vary"],
    &["field"],
    &["contour"],
    // Before the regions: how far walls lie apart, and so what they leave
    // for filling, follows from the cross-section of a bead.
    &["bead"],
    &["region"],
    &["walls", "fuzzy", "skin", "infill", "adhesion"],
    // What hangs, but for what the skin's bridges hold.
    &["hang"],
    // Where loops begin follows from the walls as they are before fuzzy skin.
    &["seam"],
    &["order"],
    &["travel"],
    // G-code's binary form: text in, bytes out, and back.
    &["bgcode"],
    // G-code of any slicer, back to moves. Before the pace, whose clock tells
    // how long they take.
    &["reader"],
    &["pace"],
    &["gcode", "report"],
    // Is it safe to run?
    &["check"],
    &["preview"],
    &["pipeline"],
    &["cli"],
    &["main"],
];

/// Crates that only some modules may name.
const CONFINED: &[Confined] = &[
    Confined {
        name: "fidget",
        modules: &[
            "model", "layers", "vary", "field", "contour", "preview", "report",
        ],
        in_tests: true,
    },
    Confined {
        name: "clap",
        modules: &["cli", "main"],
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
    /// Whether `#[cfg(test)]` modules may name it anywhere.
    in_tests: bool,
}

#[test]
fn imports_follow_the_order_of_the_modules() {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut files = Vec::new();
    collect(&src, &mut files);
    assert!(!files.is_empty(), "no source files below {}", src.display());
    let mut faults = Vec::new();
    for file in files {
        let text = fs::read_to_string(&file).expect("source is readable");
        let path = file.strip_prefix(&src).expect("file is below src");
        faults.extend(check(path, &text));
    }
    assert!(faults.is_empty(), "\n{}\n", faults.join("\n"));
}

#[test]
fn every_name_in_the_order_is_a_module() {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    for module in ORDER.iter().flat_map(|step| step.iter()) {
        let file = src.join(format!("{module}.rs"));
        let folder = src.join(module).join("mod.rs");
        assert!(file.is_file() || folder.is_file(), "no module {module}");
    }
}

fn collect(dir: &Path, files: &mut Vec<PathBuf>) {
    let mut entries: Vec<_> = fs::read_dir(dir)
        .expect("source directory is readable")
        .map(|entry| entry.expect("entry is readable").path())
        .collect();
    entries.sort();
    for path in entries {
        if path.is_dir() {
            collect(&path, files);
        } else if path.extension().is_some_and(|e| e == "rs") {
            files.push(path);
        }
    }
}

/// Everything wrong with one file, as lines to print. `path` is below `src`.
fn check(path: &Path, text: &str) -> Vec<String> {
    let mut modules: Vec<String> = path
        .with_extension("")
        .iter()
        .map(|part| part.to_string_lossy().into_owned())
        .collect();
    if modules.last().is_some_and(|last| last == "mod") {
        modules.pop();
    }
    // The root only declares and re-exports.
    if modules == ["lib"] {
        return Vec::new();
    }
    let here = modules[0].clone();
    let Some(step) = step_of(&here) else {
        return vec![format!(
            "src/{}: module `{here}` is not in ORDER: add it to \
             tests/architecture.rs",
            path.display()
        )];
    };
    // main.rs is a crate root of its own: no `super` leads out of it.
    let depth = match here.as_str() {
        "main" => usize::MAX / 2,
        _ => modules.len(),
    };
    let in_test_file = modules.iter().any(|m| m == "tests");

    let mut faults = Vec::new();
    for reference in references(&tokens(text), depth) {
        let fault = match &reference.target {
            Target::Module(to) if *to == here => None,
            Target::Module(to) => match step_of(to) {
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
            },
            Target::Everything => {
                Some("import modules by name, not the whole root".to_owned())
            }
            Target::Crate(name) => CONFINED
                .iter()
                .find(|c| c.name == name)
                .filter(|c| !c.modules.contains(&here.as_str()))
                .filter(|c| {
                    !(c.in_tests && (reference.in_test || in_test_file))
                })
                .map(|c| {
                    format!("`{name}` belongs in {} only", c.modules.join(", "))
                }),
        };
        if let Some(fault) = fault {
            let line = reference.line;
            faults.push(format!("src/{}:{line}: {fault}", path.display()));
        }
    }
    faults
}

fn step_of(module: &str) -> Option<usize> {
    ORDER.iter().position(|step| step.contains(&module))
}

/// What a path leads to.
#[derive(Debug, PartialEq)]
enum Target {
    /// A module at the crate's root.
    Module(String),
    /// All of the root (`use crate::*`).
    Everything,
    /// A crate in [`CONFINED`].
    Crate(String),
}

struct Reference {
    line: usize,
    in_test: bool,
    target: Target,
}

struct Token {
    line: usize,
    text: String,
}

/// Paths in a file whose module lies `depth` levels below the root.
fn references(tokens: &[Token], depth: usize) -> Vec<Reference> {
    let text = |i: usize| tokens.get(i).map_or("", |t| t.text.as_str());
    let mut found = Vec::new();
    // One entry per open brace: whether it opened an inline module, and
    // whether that is (inside) a test module.
    let mut braces: Vec<(bool, bool)> = Vec::new();
    for i in 0..tokens.len() {
        let in_test = braces.last().is_some_and(|b| b.1);
        match text(i) {
            "{" => {
                let is_module = i >= 2 && text(i - 2) == "mod";
                let is_test = is_module && cfg_test_before(tokens, i - 2);
                braces.push((is_module, in_test || is_test));
            }
            "}" => {
                braces.pop();
            }
            _ => {}
        }
        // Only the first word of a path can name the root or a crate.
        let continues = i >= 2 && text(i - 1) == "::" && is_word(text(i - 2));
        if continues {
            continue;
        }
        let mut push = |line, target| {
            found.push(Reference {
                line,
                in_test,
                target,
            });
        };
        let word = text(i);
        if CONFINED.iter().any(|c| c.name == word) {
            let imported = i >= 1 && matches!(text(i - 1), "use" | "crate");
            if text(i + 1) == "::" || imported {
                push(tokens[i].line, Target::Crate(word.to_owned()));
            }
            continue;
        }
        let after = match word {
            "crate" | "isoslice" if text(i + 1) == "::" => i + 2,
            "super" => {
                let inline = braces.iter().filter(|b| b.0).count();
                let mut supers = 1;
                let mut next = i + 1;
                while text(next) == "::" && text(next + 1) == "super" {
                    supers += 1;
                    next += 2;
                }
                if text(next) != "::" || supers < depth + inline {
                    continue;
                }
                next + 1
            }
            _ => continue,
        };
        for (line, name) in heads(tokens, after) {
            match name.as_str() {
                "self" => {}
                "*" => push(line, Target::Everything),
                _ => push(line, Target::Module(name)),
            }
        }
    }
    found
}

/// The first words of the path or of the group of paths at `start`.
fn heads(tokens: &[Token], start: usize) -> Vec<(usize, String)> {
    let Some(first) = tokens.get(start) else {
        return Vec::new();
    };
    if first.text != "{" {
        return vec![(first.line, first.text.clone())];
    }
    let mut heads = Vec::new();
    let mut depth = 0;
    for (i, token) in tokens.iter().enumerate().skip(start) {
        match token.text.as_str() {
            "{" => depth += 1,
            "}" => depth -= 1,
            _ => {}
        }
        if depth == 0 {
            break;
        }
        let before = tokens[i - 1].text.as_str();
        let name = is_word(&token.text) || token.text == "*";
        if depth == 1 && name && matches!(before, "{" | ",") {
            heads.push((token.line, token.text.clone()));
        }
    }
    heads
}

/// Whether `#[cfg(test)]` stands before the `mod` at `at`.
fn cfg_test_before(tokens: &[Token], at: usize) -> bool {
    const ATTRIBUTE: [&str; 7] = ["#", "[", "cfg", "(", "test", ")", "]"];
    let before: Vec<_> = tokens[..at]
        .iter()
        .rev()
        .take_while(|t| !matches!(t.text.as_str(), ";" | "{" | "}"))
        .map(|t| t.text.as_str())
        .collect();
    before
        .windows(ATTRIBUTE.len())
        .any(|w| w.iter().rev().eq(ATTRIBUTE.iter()))
}

fn is_word(text: &str) -> bool {
    text.starts_with(|c: char| c == '_' || c.is_alphanumeric())
}

/// Words, `::` and single signs; comments, strings and characters left out.
fn tokens(text: &str) -> Vec<Token> {
    let chars: Vec<char> = text.chars().collect();
    let at = |i: usize| chars.get(i).copied().unwrap_or('\0');
    let mut tokens = Vec::new();
    let mut line = 1;
    let mut i = 0;
    while i < chars.len() {
        let start = i;
        let first_line = line;
        match chars[i] {
            '/' if at(i + 1) == '/' => {
                while i < chars.len() && chars[i] != '\n' {
                    i += 1;
                }
            }
            '/' if at(i + 1) == '*' => {
                let mut depth = 0;
                loop {
                    match (at(i), at(i + 1)) {
                        ('/', '*') => {
                            depth += 1;
                            i += 2;
                        }
                        ('*', '/') => {
                            depth -= 1;
                            i += 2;
                        }
                        _ => i += 1,
                    }
                    if depth == 0 || i >= chars.len() {
                        break;
                    }
                }
            }
            '"' => i = end_of_string(&chars, i),
            // A character, unless it is a lifetime.
            '\'' if at(i + 1) == '\\' => {
                i += 3;
                while i < chars.len() && chars[i] != '\'' {
                    i += 1;
                }
                i += 1;
            }
            '\'' if at(i + 2) == '\'' => i += 3,
            ':' if at(i + 1) == ':' => i += 2,
            c if c == '_' || c.is_alphanumeric() => {
                while at(i) == '_' || at(i).is_alphanumeric() {
                    i += 1;
                }
                let word: String = chars[start..i].iter().collect();
                let hashes =
                    chars[i..].iter().take_while(|c| **c == '#').count();
                if at(i + hashes) == '"' {
                    match word.as_str() {
                        "r" | "br" | "cr" => {
                            i = end_of_raw_string(&chars, i, hashes);
                        }
                        "b" | "c" => i = end_of_string(&chars, i),
                        _ => tokens.push(Token { line, text: word }),
                    }
                } else {
                    tokens.push(Token { line, text: word });
                }
            }
            _ => i += 1,
        }
        i = i.min(chars.len());
        let passed: String = chars[start..i].iter().collect();
        line += passed.matches('\n').count();
        let is_sign = passed == "::"
            || (i - start == 1
                && passed.starts_with(|c: char| c.is_ascii_punctuation())
                && passed != "_");
        if is_sign {
            tokens.push(Token {
                line: first_line,
                text: passed,
            });
        }
    }
    tokens
}

/// Index behind the string whose opening quote is at `open`.
fn end_of_string(chars: &[char], open: usize) -> usize {
    let mut i = open + 1;
    while i < chars.len() && chars[i] != '"' {
        i += if chars[i] == '\\' { 2 } else { 1 };
    }
    i + 1
}

/// Index behind the raw string whose hashes start at `open`.
fn end_of_raw_string(chars: &[char], open: usize, hashes: usize) -> usize {
    let mut i = open + hashes + 1;
    while i < chars.len() {
        let closing = chars[i + 1..].iter().take_while(|c| **c == '#');
        if chars[i] == '"' && closing.count() >= hashes {
            return i + 1 + hashes;
        }
        i += 1;
    }
    i
}

/// The checker itself must not be blind.
mod checker {
    use super::*;

    fn faults(path: &str, text: &str) -> Vec<String> {
        check(Path::new(path), text)
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
            "use crate::units::Mm;\n\nuse crate::gcode::Writer;\n",
            "src/layers.rs:3: `layers` may not import `gcode`",
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
            "/* /* nested */ */ use crate::pace;",
        ] {
            assert_fault("field/tile.rs", text, "may not import `pace`");
        }
        assert_fault("units.rs", "use super::pace;", "`pace`");
        assert_fault("field/mod.rs", "use super::{pace, units};", "`pace`");
    }

    #[test]
    fn siblings_may_not_meet() {
        assert_fault("skin/mod.rs", "use crate::walls;", "sibling `walls`");
        assert_fault("gcode/mod.rs", "use crate::report;", "sibling");
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
             // use crate::cli;\n/* use crate::cli; /* */ use crate::cli; */\n\
             const S: &str = \"use crate::cli; \\\" use crate::cli;\";\n\
             const R: &str = r##\"\"# use crate::cli;\"##;\n",
        );
    }

    #[test]
    fn forward_and_inner_paths_are_clean() {
        assert_clean(
            "field/tile.rs",
            "use crate::{layers::LayerSpan, model::{Model, Bounds}};\n\
             use super::Grid;\nuse crate::field::Grid as G;\n\
             pub(crate) fn f() {}\npub(in crate::field) fn g() {}\n\
             mod tests { use super::*; use super::super::Grid; }\n",
        );
        assert_clean("units.rs", "mod tests { use super::*; }");
        assert_clean("main.rs", "use isoslice::cli;\nuse anyhow::Result;");
        assert_clean("main.rs", "mod tests { use super::*; }");
        assert_clean("lib.rs", "pub use crate::pipeline::slice;");
    }

    #[test]
    fn heavy_crates_stay_where_they_belong() {
        assert_fault("walls.rs", "use fidget::context::Tree;", "`fidget`");
        assert_fault("walls.rs", "fn f(t: &::fidget::Tree) {}", "`fidget`");
        assert_fault("gcode/mod.rs", "use anyhow::Context;", "`anyhow`");
        assert_fault("pace.rs", "#[derive(clap::Parser)]", "`clap`");
        assert_fault("pace.rs", "use clap as c;", "`clap`");
        assert_clean("field/mod.rs", "use fidget::vm::VmFunction;");
        assert_clean("cli/mod.rs", "use clap::Parser; use anyhow::Result;");
        assert_clean(
            "walls.rs",
            "#[cfg(test)]\nmod tests { use fidget::context::Tree; }",
        );
        assert_fault(
            "walls.rs",
            "#[cfg(test)]\nmod tests {}\nuse fidget::context::Tree;",
            "`fidget`",
        );
    }
}
