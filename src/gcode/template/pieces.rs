//! A template's text, taken apart into plain text and code.

use std::ops::Range;

/// A piece of a template.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Piece {
    /// Place of the piece, in bytes.
    pub at: Range<usize>,
    /// True for an expression or a condition, false for plain text.
    pub code: bool,
}

/// The pieces of a template: plain text, and what is between braces.
/// Comments and raw text are left out.
pub(super) fn pieces(source: &str) -> Vec<Piece> {
    let mut all = Vec::new();
    let mut at = 0;
    while let Some(open) = source[at..]
        .match_indices('{')
        .map(|(i, _)| at + i)
        .find(|&i| source[i + 1..].starts_with(['{', '%', '#']))
    {
        all.push(Piece {
            at: at..open,
            code: false,
        });
        let close = match source.as_bytes().get(open + 1) {
            Some(b'{') => "}}",
            Some(b'%') => "%}",
            _ => "#}",
        };
        let inside = open + 2;
        let end = |from: usize, what: &str| {
            source[from..].find(what).map_or(source.len(), |i| from + i)
        };
        let to = end(inside, close);
        let tag = source[inside..to].trim_matches(['-', '+', ' ', '\t']);
        at = (to + close.len()).min(source.len());
        if close == "%}" && tag == "raw" {
            let over = end(at, "endraw");
            at = (end(over, "%}") + 2).min(source.len());
        } else if close != "#}" {
            all.push(Piece {
                at: inside..to,
                code: true,
            });
        }
    }
    all.push(Piece {
        at: at..source.len(),
        code: false,
    });
    all
}

/// Where the template first uses `name`.
pub(super) fn find(source: &str, pieces: &[Piece], name: &str) -> usize {
    let part = |c: char| c.is_alphanumeric() || c == '_';
    pieces
        .iter()
        .filter(|p| p.code)
        .flat_map(|p| {
            let places = source[p.at.clone()].match_indices(name);
            places.map(|(i, _)| p.at.start + i)
        })
        .find(|&i| {
            let before = source[..i].chars().next_back();
            let after = source[i + name.len()..].chars().next();
            !before.is_some_and(|c| part(c) || c == '.')
                && !after.is_some_and(part)
        })
        .unwrap_or(0)
}
