//! A template's text, taken apart into plain text and code.

use super::tokens::{Token, Tokens};
use std::ops::Range;

/// A piece of a template.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct TemplatePiece {
    /// Place of the piece, in bytes.
    pub at: Range<usize>,
    /// True for an expression or a condition, false for plain text.
    pub code: bool,
}

/// The pieces of a template: plain text, and what is between braces, as
/// minijinja sees them. Comments and raw text are left out.
pub(super) fn pieces(source: &str) -> Vec<TemplatePiece> {
    let mut all = Vec::new();
    let mut at = 0;
    while let Some(open) = source[at..]
        .match_indices('{')
        .map(|(i, _)| at + i)
        .find(|&i| source[i + 1..].starts_with(['{', '%', '#']))
    {
        all.push(TemplatePiece {
            at: at..open,
            code: false,
        });
        let inside = open + 2;
        let rest = &source[inside..];
        let close = match source.as_bytes().get(open + 1) {
            Some(b'{') => "}}",
            Some(b'%') => "%}",
            _ => {
                at = inside + rest.find("#}").map_or(rest.len(), |i| i + 2);
                continue;
            }
        };
        if close == "%}"
            && let Some(tag) = tag(rest, "raw")
        {
            at = inside + tag;
            at += raw(&source[at..]);
            continue;
        }
        let (code, over) = extent(rest, close);
        all.push(TemplatePiece {
            at: inside..inside + code,
            code: true,
        });
        at = inside + over;
    }
    all.push(TemplatePiece {
        at: at..source.len(),
        code: false,
    });
    all
}

/// Length of the tag at the beginning of `text`, behind its `{%`, if it is
/// `word` alone.
fn tag(text: &str, word: &str) -> Option<usize> {
    let is_mark = |c: char| matches!(c, '-' | '+');
    let inner = text.strip_prefix(is_mark).unwrap_or(text);
    let inner = inner.trim_ascii_start().strip_prefix(word)?;
    let inner = inner.trim_ascii_start();
    let inner = inner.strip_prefix(is_mark).unwrap_or(inner);
    Some(text.len() - inner.strip_prefix("%}")?.len())
}

/// Length of raw text with the tag that ends it.
fn raw(text: &str) -> usize {
    text.match_indices("{%")
        .map(|(i, _)| i + 2)
        .find_map(|i| Some(i + tag(&text[i..], "endraw")?))
        .unwrap_or(text.len())
}

/// Length of the code at the beginning of `text`, and the same with its
/// `close`. Code whose brackets do not match ends there.
fn extent(text: &str, close: &str) -> (usize, usize) {
    let mut tokens = Tokens::of(text);
    let mut open = Vec::new();
    let code = loop {
        let rest = tokens.rest();
        let at = text.len() - rest.len();
        if open.is_empty() && rest.starts_with(close) {
            return (at, at + close.len());
        }
        match tokens.next() {
            Some(Token::Open(closing)) => open.push(closing),
            Some(Token::Close(c)) if open.pop() != Some(c) => break at,
            Some(_) => {}
            None => break at,
        }
    };
    let rest = &text[code..];
    let code = code + rest.find(close).unwrap_or(rest.len());
    (code, (code + close.len()).min(text.len()))
}

/// Where the template first uses `name`.
pub(super) fn find(
    source: &str,
    pieces: &[TemplatePiece],
    name: &str,
) -> usize {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn assert_code(source: &str, expected: &[&str]) {
        let pieces = pieces(source);
        let code = pieces.iter().filter(|p| p.code);
        let code: Vec<_> = code.map(|p| &source[p.at.clone()]).collect();
        assert_eq!(code, expected, "{source}");
    }

    #[test]
    fn code_ends_where_its_braces_do() {
        assert_code("{{ a }} {% if b -%}", &[" a ", " if b -"]);
        assert_code("{{ '}}' }} {{ b }}", &[" '}}' ", " b "]);
        assert_code(r"{{ '\'}}' }} {{ b }}", &[r" '\'}}' ", " b "]);
        assert_code("{{ {1: {2: 3}} }}x}}", &[" {1: {2: 3}} "]);
        assert_code("{{ 5 %}}{% if 1 %}", &[" 5 %", " if 1 "]);
        assert_code("{# {{ a }} {{ b #}{{ c }}", &[" c "]);
        assert_code("{%- raw +%} endraw {# {%+ endraw -%}{{ a }} #}", &[" a "]);
        assert_code("{% raw a %}{{ b }}", &[" raw a ", " b "]);
    }

    #[test]
    fn code_without_an_end_goes_no_further_than_it_must() {
        assert_code("{{ a", &[" a"]);
        assert_code("{{ (a]) }} {{ b }}", &[" (a]) ", " b "]);
        assert_code("{{ a) }} {{ b }}", &[" a) ", " b "]);
        assert_code("{{ 'a }} {{ b }}", &[" 'a ", " b "]);
        assert_code("{% raw %}{{ a }}", &[]);
        assert_code("{# {{ a }}", &[]);
    }
}
