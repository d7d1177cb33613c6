//! A template's text, taken apart: to find names in it, and what only looks
//! like a placeholder.

use std::ops::Range;

/// A piece of a template.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Piece {
    /// Where it is, in bytes.
    at: Range<usize>,
    /// Whether it is an expression or a condition, and not plain text.
    code: bool,
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

/// Where `name` is used first.
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

/// A placeholder in brackets of another kind, `{name}` or `[name]`, that
/// would reach the printer as it is.
pub(super) fn foreign(
    source: &str,
    pieces: &[Piece],
    known: &[&str],
) -> Option<(usize, String)> {
    pieces.iter().filter(|p| !p.code).find_map(|p| {
        let piece = &source[p.at.clone()];
        piece.match_indices(['{', '[']).find_map(|(i, open)| {
            // Comments may hold anything.
            let line = piece[..i].rsplit('\n').next().unwrap_or("");
            let close = if open == "{" { '}' } else { ']' };
            let end = i + piece[i..].find(close)?;
            let name = piece[i + 1..end].trim();
            let plain = !name.is_empty()
                && name.chars().all(|c| c.is_alphanumeric() || c == '_')
                && !name.starts_with(|c: char| c.is_ascii_digit());
            let meant = plain && (open == "{" || known.contains(&name));
            (meant && !line.contains(';')).then(|| {
                let message = format!(
                    "{} would reach the printer as it is; write \
                     {{{{ {name} }}}} for a placeholder",
                    &piece[i..=end]
                );
                (p.at.start + i, message)
            })
        })
    })
}
