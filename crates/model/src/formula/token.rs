//! A formula's text as numbers, names and symbols.

use super::FormulaError;

#[derive(Clone, Debug, PartialEq)]
pub(super) enum Token {
    Number(f64),
    Name(String),
    /// A text in quotes.
    Text(String),
    Symbol(&'static str),
}

impl std::fmt::Display for Token {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Number(v) => write!(f, "`{v}`"),
            Self::Name(n) => write!(f, "`{n}`"),
            Self::Text(t) => write!(f, "{t:?}"),
            Self::Symbol(s) => write!(f, "`{s}`"),
        }
    }
}

/// The tokens of a text, each with its column.
/// `of_setting` tells what the formula is for, which messages depend on.
pub(super) fn tokens(
    text: &str,
    of_setting: bool,
) -> Result<Vec<(Token, usize)>, FormulaError> {
    let chars: Vec<char> = text.chars().collect();
    let mut out = Vec::new();
    let mut i = 0;
    while let Some(&c) = chars.get(i) {
        let column = i + 1;
        let is = |j: usize, f: fn(&char) -> bool| chars.get(j).is_some_and(f);
        if c.is_whitespace() {
            i += 1;
        } else if c.is_ascii_digit()
            || (c == '.' && is(i + 1, char::is_ascii_digit))
        {
            let start = i;
            while is(i, |c| c.is_ascii_digit() || *c == '.') {
                i += 1;
            }
            // An exponent needs digits: `2e` is 2 and the name e.
            if is(i, |c| matches!(c, 'e' | 'E')) {
                let sign = usize::from(is(i + 1, |c| matches!(c, '+' | '-')));
                if is(i + 1 + sign, char::is_ascii_digit) {
                    i += 1 + sign;
                    while is(i, char::is_ascii_digit) {
                        i += 1;
                    }
                }
            }
            let digits: String = chars[start..i].iter().collect();
            let value = digits
                .parse::<f64>()
                .ok()
                .filter(|v| v.abs() <= f64::from(f32::MAX));
            let Some(value) = value else {
                let message = format!("`{digits}` is not a number in range");
                return Err(FormulaError::at(column, message));
            };
            out.push((Token::Number(value), column));
        } else if c.is_alphabetic() || c == '_' {
            let start = i;
            while is(i, |c| c.is_alphanumeric() || *c == '_') {
                i += 1;
            }
            let name = chars[start..i].iter().collect();
            out.push((Token::Name(name), column));
        } else if c == '"' {
            let rest = &chars[i + 1..];
            let Some(length) = rest.iter().position(|c| *c == '"') else {
                return Err(FormulaError::at(
                    column,
                    "the text that begins here has no end: write it in \
                     quotes, as in mesh(\"part.stl\")",
                ));
            };
            let text = rest[..length].iter().collect();
            out.push((Token::Text(text), column));
            i += length + 2;
        } else {
            let power = c == '*' && is(i + 1, |c| *c == '*');
            let symbol = match c {
                _ if power => "^",
                '+' => "+",
                '-' | '\u{2212}' => "-",
                '*' | '\u{b7}' | '\u{d7}' => "*",
                '/' => "/",
                '%' => "%",
                '^' => "^",
                '(' => "(",
                ')' => ")",
                ',' => ",",
                other => {
                    let hint = match other {
                        '=' | '<' | '>' | '\u{2264}' | '\u{2265}'
                            if of_setting =>
                        {
                            "; a formula does not compare: step(20, z) is 1 \
                             where z is at least 20, and 0 elsewhere"
                        }
                        '|' => {
                            "; write abs(z) for |z|, and min(f, g) for f | g"
                        }
                        '&' => "; write max(f, g) for f & g",
                        '=' | '<' | '>' | '\u{2264}' | '\u{2265}' => {
                            "; a formula is one value, negative inside the \
                             part: write a - b for a < b or a = b"
                        }
                        '\u{b2}' => "; write the power as ^2",
                        '\u{b3}' => "; write the power as ^3",
                        _ => "",
                    };
                    let shown = other.escape_default();
                    return Err(FormulaError::at(
                        column,
                        format!("unexpected character `{shown}`{hint}"),
                    ));
                }
            };
            i += if power { 2 } else { 1 };
            out.push((Token::Symbol(symbol), column));
        }
    }
    Ok(out)
}
