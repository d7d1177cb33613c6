//! The paths in a source file, by its words.
//!
//! In: a file's text. Out: every path that starts at the crate's root, in the
//! file's own folder or with a crate that only some may name.
//!
//! It reads words, not types: a path inside a macro's body is seen as written,
//! and what a glob brings in is not followed.

use crate::CONFINED;
use std::collections::BTreeSet;

/// A module, from the crate's root down: `vary::depth` is `["vary", "depth"]`.
pub type Module = Vec<String>;

/// A file and the paths in it.
pub struct Source {
    /// The file's name below `src`.
    pub name: String,
    pub module: Module,
    pub references: Vec<Reference>,
    /// All words of its code.
    pub words: BTreeSet<String>,
}

pub struct Reference {
    pub line: usize,
    pub in_test: bool,
    /// Whether the path is (part of) a `use`, and its last name can be passed
    /// on.
    pub is_use: bool,
    /// Whether the first name is a crate in [`CONFINED`].
    pub external: bool,
    /// Names from the crate's root on, or from another crate's name on.
    pub path: Vec<String>,
}

/// The module of a file; that of `lib.rs` is the root, without a name.
pub fn module_of(name: &str) -> Module {
    if name == "lib.rs" {
        return Module::new();
    }
    let name = name.trim_end_matches(".rs").trim_end_matches("/mod");
    name.split('/').map(str::to_owned).collect()
}

impl Source {
    /// True for a file of a module of the crate's root.
    pub fn is_in(&self, module: &str) -> bool {
        self.module.first().is_some_and(|name| name == module)
    }

    pub fn new(name: &str, text: &str) -> Self {
        let module = module_of(name);
        let bare = bare(text);
        let tokens = tokens(&bare);
        let word = |i: usize| tokens.get(i).map_or("", |token| token.1);
        let mut references = Vec::new();
        // The module at each open brace: that of the file, and inline ones.
        let mut open = vec![module.clone()];
        let mut in_use = false;
        for i in 0..tokens.len() {
            let mut here = open.last().unwrap_or(&module).clone();
            match word(i) {
                "{" if i > 1 && word(i - 2) == "mod" => {
                    here.push(word(i - 1).to_owned());
                    open.push(here);
                    continue;
                }
                "{" => open.push(here.clone()),
                "}" => drop(open.pop()),
                "use" => in_use = true,
                ";" => in_use = false,
                _ => {}
            }
            // Only the first word of a path can name the root or a crate.
            if i > 1 && word(i - 1) == "::" && is_word(word(i - 2)) {
                continue;
            }
            let external = CONFINED.iter().any(|c| c.name == word(i));
            let imported = i > 0 && matches!(word(i - 1), "use" | "crate");
            let root =
                matches!(word(i), "crate" | "isoslice" | "super" | "self");
            let is_path = word(i + 1) == "::" && (external || root);
            if !(is_path || imported && is_word(word(i))) {
                continue;
            }
            let mut paths = Vec::new();
            expand(&tokens, i, Vec::new(), &mut paths);
            for (line, path) in paths {
                let path = if external {
                    path.iter().map(|s| s.to_string()).collect()
                } else {
                    absolute(&here, &path)
                };
                if path.is_empty() {
                    continue;
                }
                references.push(Reference {
                    line,
                    in_test: here.iter().any(|m| m == "tests"),
                    is_use: in_use,
                    external,
                    path,
                });
            }
        }
        Self {
            name: name.to_owned(),
            module,
            references,
            words: tokens.iter().map(|token| token.1.to_owned()).collect(),
        }
    }
}

/// A path as seen from the crate's root.
fn absolute(here: &[String], path: &[&str]) -> Vec<String> {
    let ups = path.iter().take_while(|name| **name == "super").count();
    let (from, rest) = match path.first() {
        Some(&("crate" | "isoslice")) => (&here[..0], &path[1..]),
        Some(&"self") => (here, &path[1..]),
        _ => (&here[..here.len().saturating_sub(ups)], &path[ups..]),
    };
    let rest = rest.iter().map(|name| name.to_string());
    from.iter().cloned().chain(rest).collect()
}

/// Lists the paths that begin at a token, with those before it in front, and
/// returns the token after them.
fn expand<'a>(
    tokens: &[(usize, &'a str)],
    mut at: usize,
    mut path: Vec<&'a str>,
    found: &mut Vec<(usize, Vec<&'a str>)>,
) -> usize {
    let word = |i: usize| tokens.get(i).map_or("", |token| token.1);
    if word(at) == "{" {
        at += 1;
        while !matches!(word(at), "}" | "") {
            at = expand(tokens, at, path.clone(), found);
            // What follows `as` is no path.
            while !matches!(word(at), "," | "}" | "") {
                at += 1;
            }
            at += usize::from(word(at) == ",");
        }
        return at + 1;
    }
    path.push(word(at));
    let goes_on = is_word(word(at + 2)) || matches!(word(at + 2), "{" | "*");
    if word(at + 1) == "::" && goes_on {
        return expand(tokens, at + 2, path, found);
    }
    found.push((tokens[at].0, path));
    at + 1
}

fn is_word(text: &str) -> bool {
    text.starts_with(|c: char| c == '_' || c.is_alphanumeric())
}

/// Words, `::` and single signs with their lines.
fn tokens(text: &str) -> Vec<(usize, &str)> {
    let mut tokens = Vec::new();
    for (line, text) in text.lines().enumerate() {
        let mut rest = text.trim_start();
        while let Some(first) = rest.chars().next() {
            let inside = |c: char| c == '_' || c.is_alphanumeric();
            let end = if inside(first) {
                rest.find(|c| !inside(c)).unwrap_or(rest.len())
            } else if rest.starts_with("::") {
                2
            } else {
                first.len_utf8()
            };
            tokens.push((line + 1, &rest[..end]));
            rest = rest[end..].trim_start();
        }
    }
    tokens
}

/// The text without comments, strings and characters; the lines stay. Block
/// comments are read as code: the house has none.
fn bare(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(c) = rest.chars().next() {
        let escape = rest[1.min(rest.len())..].starts_with('\\') && c == '\'';
        let quoted = c == '\'' && rest.chars().nth(2) == Some('\'');
        let end = if rest.starts_with("//") {
            rest.find('\n').unwrap_or(rest.len())
        } else if c == '"' {
            end_of_string(rest, &out)
        } else if escape {
            rest[3..].find('\'').map_or(rest.len(), |n| n + 4)
        } else if quoted {
            rest[1..].find('\'').map_or(rest.len(), |n| n + 2)
        } else {
            out.push(c);
            rest = &rest[c.len_utf8()..];
            continue;
        };
        out.push(' ');
        out.extend(rest[..end].matches('\n'));
        rest = &rest[end..];
    }
    out
}

/// Length of the string that a text begins with; `before` ends in `r##` if it
/// is a raw one.
fn end_of_string(text: &str, before: &str) -> usize {
    let prefix = before.trim_end_matches('#');
    if prefix.ends_with('r') {
        let close = format!("\"{}", &before[prefix.len()..]);
        let end = text[1..].find(&close);
        return end.map_or(text.len(), |n| n + 1 + close.len());
    }
    let mut escaped = false;
    let end = text.char_indices().skip(1).find(|(_, c)| {
        let ends = *c == '"' && !escaped;
        escaped = *c == '\\' && !escaped;
        ends
    });
    end.map_or(text.len(), |(at, _)| at + 1)
}
