//! PrusaSlicer's `.ini`: one configuration, or a bundle of sections
//! `[print:NAME]` that inherit from one another.

use crate::values::Values;
use crate::{Named, PresetKind};
use std::collections::{BTreeMap, BTreeSet};

/// Greatest number of profiles that one profile may inherit from, all together.
const MOST_ANCESTORS: usize = 500;
/// Greatest number of keys of these profiles, all together. A profile usually
/// has about a hundred.
const MOST_KEYS: usize = 50_000;
/// Greatest number of profiles that inherit from one another in a row.
const DEEPEST: usize = 32;

/// A file taken apart.
#[derive(Debug, Default)]
pub(crate) struct Ini {
    /// The lines before the first section.
    pub(crate) plain: Values,
    /// Sections by kind and name, with the names from which they inherit.
    sections: BTreeMap<(PresetKind, String), (Values, Vec<String>)>,
    /// Keys that are given more than once in a section. The last one counts.
    pub(crate) repeated: BTreeSet<String>,
    /// Number of lines that are neither a section, an entry nor a comment.
    pub(crate) odd: usize,
}

/// Reads a file's text.
pub(crate) fn read(text: &str) -> Ini {
    let mut ini = Ini::default();
    let mut section: Option<(PresetKind, String)> = None;
    let mut skipped = false;
    for line in text.lines() {
        let line = line.trim();
        if line.is_empty() || line.starts_with(['#', ';']) {
            continue;
        }
        if let Some(head) = line.strip_prefix('[') {
            let head = head.strip_suffix(']').unwrap_or(head);
            let kind = head.split_once(':').and_then(|(kind, name)| {
                Some((
                    PresetKind::of_word(kind.trim())?,
                    name.trim().to_owned(),
                ))
            });
            skipped = kind.is_none();
            if let Some(at) = &kind {
                ini.sections.entry(at.clone()).or_default();
            }
            section = kind;
            continue;
        }
        let Some((key, value)) = line.split_once('=') else {
            ini.odd += 1;
            continue;
        };
        let (key, value) = (key.trim(), value.trim());
        let values = match &section {
            Some(at) => {
                let (values, parents) =
                    ini.sections.entry(at.clone()).or_default();
                if key == "inherits" {
                    *parents = names(value);
                    continue;
                }
                values
            }
            // `[vendor]`, `[printer_model:…]`, `[obsolete_presets]`.
            None if skipped => continue,
            None => &mut ini.plain,
        };
        if values.text(key).is_some() {
            ini.repeated.insert(key.to_owned());
        }
        values.set(key, items(value));
    }
    ini
}

/// How much has been read for one profile.
#[derive(Default)]
struct Seen {
    profiles: usize,
    keys: usize,
}

impl Ini {
    /// The profiles to choose from. Names in asterisks are for other profiles
    /// to inherit from.
    pub(crate) fn list(&self) -> Vec<Named> {
        let named = |(kind, name): &(PresetKind, String)| Named {
            kind: *kind,
            name: name.clone(),
        };
        let all = self.sections.keys();
        all.filter(|(_, name)| !name.starts_with('*'))
            .map(named)
            .collect()
    }

    /// True if there are sections of profiles.
    pub(crate) fn is_bundle(&self) -> bool {
        !self.sections.is_empty()
    }

    /// A profile's values, with those that it inherits.
    ///
    /// # Errors
    /// A sentence, if a profile is missing or profiles inherit in a circle.
    pub(crate) fn resolve(
        &self,
        kind: PresetKind,
        name: &str,
    ) -> Result<Values, String> {
        let mut seen = Seen::default();
        let mut open = BTreeSet::new();
        self.resolved(kind, name, &mut open, &mut seen)
    }

    fn resolved(
        &self,
        kind: PresetKind,
        name: &str,
        open: &mut BTreeSet<String>,
        seen: &mut Seen,
    ) -> Result<Values, String> {
        let Some((values, parents)) =
            self.sections.get(&(kind, name.to_owned()))
        else {
            return Err(format!(
                "there is no [{}:{name}] in it, which another one inherits",
                kind.word()
            ));
        };
        seen.profiles += 1;
        seen.keys += values.len();
        if !open.insert(name.to_owned()) {
            return Err(format!("{name:?} inherits from itself"));
        }
        if open.len() > DEEPEST || seen.profiles > MOST_ANCESTORS {
            return Err(format!(
                "{name:?} inherits through too many others: {DEEPEST} in a \
                 row and {MOST_ANCESTORS} in all are allowed"
            ));
        }
        if seen.keys > MOST_KEYS {
            return Err(format!(
                "{name:?} and those that it inherits from have more than \
                 {MOST_KEYS} keys"
            ));
        }
        let mut values = values.clone();
        // The last parent counts most, so it comes first.
        for parent in parents.iter().rev() {
            values.inherit(&self.resolved(kind, parent, open, seen)?);
        }
        open.remove(name);
        Ok(values)
    }
}

/// The names in `A; "B"; C`.
fn names(text: &str) -> Vec<String> {
    let all = text.split(';').map(|name| name.trim().trim_matches('"'));
    all.filter(|name| !name.is_empty())
        .map(ToOwned::to_owned)
        .collect()
}

/// The items of a value. Each text in quotes is an item. A value without quotes
/// is a single item, with its escapes undone.
pub(crate) fn items(value: &str) -> Vec<String> {
    if !value.starts_with('"') {
        return vec![unescaped(value)];
    }
    let mut found = Vec::new();
    let mut rest = value;
    while let Some(inner) = rest.trim_start().strip_prefix('"') {
        let mut escaped = false;
        let end = inner.char_indices().find(|(_, c)| {
            let ends = *c == '"' && !escaped;
            escaped = *c == '\\' && !escaped;
            ends
        });
        let Some((end, _)) = end else {
            // Quotes that are never closed are part of a text.
            return vec![unescaped(value)];
        };
        found.push(unescaped(&inner[..end]));
        rest = inner[end + 1..].trim_start_matches([';', ',', ' ']);
    }
    if !rest.trim().is_empty() {
        return vec![unescaped(value)];
    }
    found
}

/// A text with `\n`, `\"` and `\\` undone.
pub(crate) fn unescaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    let mut chars = text.chars();
    while let Some(c) = chars.next() {
        if c != '\\' {
            out.push(c);
            continue;
        }
        match chars.next() {
            Some('n') => out.push('\n'),
            Some('r') => {}
            Some('t') => out.push('\t'),
            Some(other @ ('"' | '\\' | '\'')) => out.push(other),
            Some(other) => {
                out.push('\\');
                out.push(other);
            }
            None => out.push('\\'),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn later_parents_win_and_a_child_wins_over_them() {
        let ini = read(
            "[vendor]\nname = x\n[print:*a*]\nk = 1\nl = 1\nm = 1\n\
             [print:*b*]\nk = 2\nl = 2\n# no\n; k = 9\n\
             [print:c]\ninherits = *a*; *b*\nk = 3\n",
        );
        let c = ini.resolve(PresetKind::Print, "c").unwrap();
        let got = ["k", "l", "m"].map(|k| c.number(k).unwrap());
        assert_eq!(got, [3.0, 2.0, 1.0]);
        assert_eq!(ini.list().len(), 1);
        assert!(ini.plain.is_empty());
    }

    #[test]
    fn keys_that_are_given_twice_are_known() {
        let ini = read("a = 1\nb = 2\na = 3\n[print:x]\na = 1\nb = 1\nb = 2\n");
        assert_eq!(Vec::from_iter(ini.repeated), ["a", "b"]);
        assert_eq!(ini.plain.number("a"), Some(3.0));
        let ini = read("a = 1\n[print:x]\na = 1\n[print:y]\na = 1\n");
        assert!(ini.repeated.is_empty());
    }

    #[test]
    fn circles_gaps_and_bombs_of_parents_are_errors() {
        let circle = "[print:a]\ninherits = b\n[print:b]\ninherits = a\n";
        let e = read(circle).resolve(PresetKind::Print, "a").unwrap_err();
        assert!(e.contains("inherits from itself"), "{e}");
        let gap = "[print:a]\ninherits = b\n";
        let e = read(gap).resolve(PresetKind::Print, "a").unwrap_err();
        assert!(e.contains("no [print:b]"), "{e}");
        // Each profile inherits twice from the next one: 2³⁰ in all.
        let bomb: String = (0..30)
            .map(|i| {
                let next = i + 1;
                format!("[print:{i}]\ninherits = {next}; {next}\n")
            })
            .chain(["[print:30]\nk = 1\n".to_owned()])
            .collect();
        let e = read(&bomb).resolve(PresetKind::Print, "0").unwrap_err();
        assert!(e.contains("too many"), "{e}");
        // One large profile is inherited many times.
        let keys: String = (0..2000).map(|i| format!("k{i} = 1\n")).collect();
        let parents = "b;".repeat(400);
        let bomb =
            format!("[print:a]\ninherits = {parents}\n[print:b]\n{keys}");
        let e = read(&bomb).resolve(PresetKind::Print, "a").unwrap_err();
        assert!(e.contains("more than 50000 keys"), "{e}");
        let row: String = (0..100)
            .map(|i| format!("[print:{i}]\ninherits = {}\n", i + 1))
            .collect();
        let e = read(&row).resolve(PresetKind::Print, "0").unwrap_err();
        assert!(e.contains("too many"), "{e}");
    }

    #[test]
    fn quoted_lists_and_escapes_are_undone() {
        assert_eq!(items(r"G28\nG1 X1"), ["G28\nG1 X1"]);
        assert_eq!(items(r#""a\nb";"c;\"d\"""#), ["a\nb", "c;\"d\""]);
        assert_eq!(items(r#""open"#), ["\"open"]);
        assert_eq!(items(r#""a" b"#), ["\"a\" b"]);
        assert_eq!(items("0.4,0.4"), ["0.4,0.4"]);
        assert_eq!(unescaped(r"a\q\"), r"a\q\");
    }
}
