//! How deep a template is nested, before it is compiled.
//!
//! minijinja reads, compiles and drops expressions by recursion, and bounds
//! that by its brackets only. `1+1+…+1` nests its first term in every sum that
//! follows, so a long enough one would overflow the stack and end the program.
//!
//! In: the pieces of a template. Out: where it is nested too deeply, if it is.
//! The count is never below the true depth: each operator counts as a level,
//! whether it makes one or not. Lists may be as long as they like, since the
//! elements of a list lie side by side.

use super::pieces::TemplatePiece;
use super::tokens::{Token, Tokens};

/// Greatest number of operators that lie in one another, and of `elif` behind
/// one `if`. So many take 0.25 MB of stack, optimised; the threads of `watch`,
/// which compile templates too, have 2 MB.
const DEEPEST: usize = 250;

/// Where a template is nested too deeply, in bytes, and what to do about it.
pub(super) fn too_deep(
    source: &str,
    pieces: &[TemplatePiece],
) -> Option<(usize, String)> {
    let mut alternatives = Alternatives::default();
    let deep = pieces.iter().filter(|piece| piece.code).find(|piece| {
        let code = &source[piece.at.clone()];
        depth(code) > DEEPEST || alternatives.after(code) > DEEPEST
    })?;
    let message = format!(
        "it has more than {DEEPEST} operators within one another, or elif in a \
         row; set parts of it to names of their own, by {{% set name = … %}}"
    );
    Some((deep.at.start, message))
}

/// Operators that are words.
const WORDS: [&str; 6] = ["and", "or", "not", "is", "in", "if"];

/// Levels between two brackets.
#[derive(Clone, Copy, Default)]
struct Level {
    /// Levels of the element of a list that is being read: its own operators, and
    /// what is in its brackets.
    own: usize,
    inner: usize,
    /// Levels of the deepest of the elements before it.
    over: usize,
}

impl Level {
    fn deepest(self) -> usize {
        self.over.max(self.own + self.inner)
    }

    fn next_element(self) -> Self {
        Level {
            over: self.deepest(),
            ..Level::default()
        }
    }

    fn with_inner(self, inner: Level) -> Self {
        let inner = self.inner.max(inner.deepest());
        Level { inner, ..self }
    }
}

/// An upper bound of the depth of the code in a tag.
fn depth(code: &str) -> usize {
    let mut open: Vec<(Level, char)> = Vec::new();
    let mut level = Level::default();
    for token in Tokens::of(code) {
        match token {
            Token::Open(close) => {
                level.own += 1;
                open.push((std::mem::take(&mut level), close));
            }
            Token::Close(close) => {
                // minijinja stops at a bracket that does not match.
                let matches = open.pop_if(|(_, wanted)| *wanted == close);
                let Some((outer, _)) = matches else { break };
                level = outer.with_inner(level);
            }
            Token::Comma => level = level.next_element(),
            Token::Sign(_) => level.own += 1,
            Token::Word(word) if WORDS.contains(&word) => level.own += 1,
            Token::Word(_) | Token::Text => {}
        }
    }
    let within = open.into_iter().rev();
    let all = within.fold(level, |inner, (outer, _)| outer.with_inner(inner));
    all.deepest()
}

/// Counts the `elif` of the conditions that are open, each of which lies in the
/// one before it.
#[derive(Default)]
struct Alternatives {
    of_each: Vec<usize>,
    all: usize,
}

impl Alternatives {
    /// The number after a tag.
    fn after(&mut self, code: &str) -> usize {
        let first = Tokens::of(code.trim_start_matches(['-', '+'])).next();
        match first {
            Some(Token::Word("if")) => self.of_each.push(0),
            Some(Token::Word("elif")) => {
                self.all += 1;
                if let Some(last) = self.of_each.last_mut() {
                    *last += 1;
                }
            }
            Some(Token::Word("endif")) => {
                self.all -= self.of_each.pop().unwrap_or(0);
            }
            _ => {}
        }
        self.all
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_lies_side_by_side_does_not_count() {
        for (code, expected) in [
            ("", 0),
            ("bed_x", 0),
            ("1 + 2", 1),
            ("[1, 2, 3, 'a + b', -4]", 2),
            ("[1, [2, 3 + 4], 5]", 3),
            ("f(a + b, c) + [d + e + f][0]", 6),
            ("a.b.c | round(2)", 4),
            ("x if y else z", 1),
            ("1.5", 0),
            ("((1", 2),
            ("1 + 1))) + 2 + 3", 1),
            ("(1 + 2] + 3", 2),
            ("x.1.1.1", 3),
            ("1.real.real", 2),
            ("0x1.5", 1),
            ("'a + b' ~ \"(\"", 1),
        ] {
            assert_eq!(depth(code), expected, "{code}");
        }
        let list = format!("[{}]", "1 + 2, ".repeat(10_000));
        assert_eq!(depth(&list), 2);
    }

    #[test]
    fn conditions_one_after_the_other_are_not_within_one_another() {
        let mut alternatives = Alternatives::default();
        for _ in 0..1000 {
            for (code, expected) in [
                (" if a ", 0),
                ("- elif b -", 1),
                ("if c", 1),
                ("+elif d", 2),
                (" endif ", 1),
                ("else", 1),
                ("endif", 0),
            ] {
                assert_eq!(alternatives.after(code), expected, "{code}");
            }
        }
    }
}
