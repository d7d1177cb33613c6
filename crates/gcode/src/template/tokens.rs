//! The tokens of a template's code, as far as its structure needs them.
//!
//! The limits between tokens are minijinja's own: where its lexer sees a bracket
//! or the end of a text, so does this one.

/// A token of code.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Token<'a> {
    /// A name, a word of the language, or a number.
    Word(&'a str),
    /// A text in quotes.
    Text,
    /// An opening bracket; the bracket that closes it.
    Open(char),
    /// A closing bracket.
    Close(char),
    Comma,
    /// Any other sign. Signs of two characters, such as `//`, count as two.
    Sign(char),
}

/// Goes through the tokens of code, up to a text that is not closed.
#[derive(Clone, Debug)]
pub(super) struct Tokens<'a> {
    rest: &'a str,
    /// True behind a dot, where a number has no fraction.
    after_dot: bool,
}

impl<'a> Tokens<'a> {
    pub(super) fn of(code: &'a str) -> Self {
        Tokens {
            rest: code,
            after_dot: false,
        }
    }

    /// What is left of the code.
    pub(super) fn rest(&mut self) -> &'a str {
        self.rest = self.rest.trim_ascii_start();
        self.rest
    }
}

impl<'a> Iterator for Tokens<'a> {
    type Item = Token<'a>;

    fn next(&mut self) -> Option<Token<'a>> {
        let rest = self.rest();
        let first = rest.chars().next()?;
        let (token, length) = match first {
            '(' => (Token::Open(')'), 1),
            '[' => (Token::Open(']'), 1),
            '{' => (Token::Open('}'), 1),
            ')' | ']' | '}' => (Token::Close(first), 1),
            ',' => (Token::Comma, 1),
            '"' | '\'' => (Token::Text, text(rest, first)?),
            c if is_part(c) => {
                let length = word(rest, !self.after_dot);
                (Token::Word(&rest[..length]), length)
            }
            c => (Token::Sign(c), c.len_utf8()),
        };
        self.after_dot = token == Token::Sign('.');
        self.rest = &rest[length..];
        Some(token)
    }
}

fn is_part(c: char) -> bool {
    c.is_ascii_alphanumeric() || c == '_'
}

/// Length of the text in quotes at the beginning of `code`; none if it has no
/// end.
fn text(code: &str, quote: char) -> Option<usize> {
    let mut escaped = false;
    code.char_indices().skip(1).find_map(|(at, c)| {
        if !escaped && c == quote {
            return Some(at + 1);
        }
        escaped = !escaped && c == '\\';
        None
    })
}

/// Length of the word or the number at the beginning of `code`.
fn word(code: &str, may_have_fraction: bool) -> usize {
    let length = |text: &str| text.find(|c| !is_part(c)).unwrap_or(text.len());
    let whole = length(code);
    let is_whole = code[..whole].bytes().all(|b| b.is_ascii_digit());
    let fraction = code[whole..]
        .strip_prefix('.')
        .filter(|f| f.starts_with(|c: char| c.is_ascii_digit()));
    match fraction {
        Some(fraction) if is_whole && may_have_fraction => {
            whole + 1 + length(fraction)
        }
        _ => whole,
    }
}
