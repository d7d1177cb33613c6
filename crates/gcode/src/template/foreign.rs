//! Placeholders of other slicers: `[first_layer_temperature]`,
//! `{bed_temperature[0]}`, `{if layer_num == 1}`. Imports translate them; in a
//! print they are mistakes, since they would reach the printer unchanged. In a
//! comment they do no harm.

use super::pieces::TemplatePiece;
use crate::placeholders::{self, Scope};

/// What to write for text that only looks like a placeholder.
const AS_IT_IS: &str = "if it is meant for the printer, put it between {% raw \
                        %} and {% endraw %}";

/// Greatest length of a placeholder, bytes.
const LONGEST: usize = 2048;

/// The first placeholder of another slicer in the plain text of a template: its
/// place in bytes, and what to do about it.
pub(super) fn foreign(
    source: &str,
    pieces: &[TemplatePiece],
    scope: Scope,
) -> Option<(usize, String)> {
    let mut comment = Comment {
        source,
        looked: 0,
        open: false,
    };
    let plain = pieces.iter().filter(|p| !p.code);
    let signs = plain.flat_map(|p| {
        let signs = source[p.at.clone()].match_indices(['{', '[']);
        signs.map(move |(i, _)| (p.at.start + i, p.at.end))
    });
    for (start, end) in signs {
        let text = &source[start..end];
        if comment.is_open(start) {
            continue;
        }
        match extent(text) {
            Some(length) => {
                return Some((start, told(&text[..length], scope)));
            }
            None if text.starts_with('{') => {
                let message =
                    format!("{{ has no }} within {LONGEST} bytes; {AS_IT_IS}");
                return Some((start, message));
            }
            None => {}
        }
    }
    None
}

/// What to do about a placeholder.
fn told(given: &str, scope: Scope) -> String {
    let name = given[1..given.len() - 1].trim();
    // A name that is only alike may mean another thing in another slicer.
    let own = placeholders::names(scope).find(|known| *known == name);
    let own = own.map_or_else(String::new, |own| {
        format!(", and isoslice's own of that name is {{{{ {own} }}}}")
    });
    let given: String = given.chars().take(60).collect();
    format!(
        "{given} is another slicer's placeholder, and would reach the printer \
         as it is: `isoslice profiles import` translates profiles and settings \
         files with such placeholders{own}; {AS_IT_IS}"
    )
}

/// Looks for comments. Each place that is asked about must be behind the last.
struct Comment<'a> {
    source: &'a str,
    looked: usize,
    open: bool,
}

impl Comment<'_> {
    fn is_open(&mut self, at: usize) -> bool {
        let since = &self.source[self.looked..at];
        if let Some(last) = since.rfind([';', '\n']) {
            let line = since.rfind('\n').map_or(0, |i| i + 1);
            self.open = since[line.min(last)..].contains(';')
                || (self.open && line == 0);
        }
        self.looked = at;
        self.open
    }
}

/// Length of the bracketed text at the beginning of `text`; nothing if it
/// cannot be a placeholder.
fn extent(text: &str) -> Option<usize> {
    // An unlimited search would take minutes for 100,000 brackets that are
    // never closed.
    let text = &text[..text.floor_char_boundary(LONGEST)];
    if text.starts_with('{') {
        return Some(text.find('}')? + 1);
    }
    let length = text.find(']')? + 1;
    let name = text[1..length - 1].trim();
    let is_name = name.chars().all(|c| c.is_alphanumeric() || c == '_')
        && name.starts_with(|c: char| c.is_alphabetic() || c == '_');
    is_name.then_some(length)
}
