//! The grammar: one function per rule, and tokens in, values out.

use super::FormulaError;
use super::names::{CONSTANTS, Name, call, constant};
use super::token::{Token, tokens};
use crate::data::{Files, KINDS, Options, kind};
use crate::term::Term;
use fidget::context::Tree;

/// Deepest nesting of parentheses, signs and powers.
const MAX_DEPTH: usize = 200;

/// Parses a formula, which may have a fourth variable, and may read files.
pub(super) fn parse(
    text: &str,
    fourth: Option<(Name, Tree)>,
    files: Option<&Files>,
) -> Result<Term, FormulaError> {
    let mut parser = Parser {
        files,
        tokens: tokens(text, fourth.is_some())?,
        next: 0,
        end: text.chars().count() + 1,
        fourth,
    };
    if parser.tokens.is_empty() {
        return Err(FormulaError::at(
            1,
            "the formula is empty; example: sqrt(x^2 + y^2 + z^2) - 15",
        ));
    }
    let value = parser.sum(0)?;
    if let Some((token, column)) = parser.tokens.get(parser.next) {
        let message = match token {
            Token::Symbol(")") => "unmatched `)`".to_owned(),
            Token::Symbol(",") => {
                "a `,` outside a function's parentheses".to_owned()
            }
            _ => format!(
                "expected an operator before {token}; write multiplication as \
                 `*`"
            ),
        };
        return Err(FormulaError::at(*column, message));
    }
    Ok(value)
}

struct Parser<'a> {
    /// The files that the formula may read.
    files: Option<&'a Files>,
    tokens: Vec<(Token, usize)>,
    next: usize,
    /// Column after the last character.
    end: usize,
    /// The fourth variable, if there is one.
    fourth: Option<(Name, Tree)>,
}

impl Parser<'_> {
    fn column(&self) -> usize {
        self.tokens.get(self.next).map_or(self.end, |t| t.1)
    }

    fn error<T>(&self, message: String) -> Result<T, FormulaError> {
        Err(FormulaError::at(self.column(), message))
    }

    /// Takes the next token if it is one of `symbols`.
    fn take(&mut self, symbols: &[&'static str]) -> Option<&'static str> {
        match self.tokens.get(self.next) {
            Some((Token::Symbol(s), _)) if symbols.contains(s) => {
                self.next += 1;
                Some(s)
            }
            _ => None,
        }
    }

    fn sum(&mut self, depth: usize) -> Result<Term, FormulaError> {
        let mut left = self.product(depth)?;
        while let Some(op) = self.take(&["+", "-"]) {
            let right = self.product(depth)?;
            left = match op {
                "+" => left + right,
                _ => left - right,
            };
        }
        Ok(left)
    }

    fn product(&mut self, depth: usize) -> Result<Term, FormulaError> {
        let mut left = self.sign(depth)?;
        while let Some(op) = self.take(&["*", "/", "%"]) {
            let right = self.sign(depth)?;
            left = match op {
                "*" => left * right,
                "/" => left / right,
                _ => left.modulo(right),
            };
        }
        Ok(left)
    }

    fn sign(&mut self, depth: usize) -> Result<Term, FormulaError> {
        if depth > MAX_DEPTH {
            return self.error(format!(
                "nested more than {MAX_DEPTH} deep; use a .rhai script with \
                 intermediate values"
            ));
        }
        match self.take(&["+", "-"]) {
            Some("-") => Ok(-self.sign(depth + 1)?),
            Some(_) => self.sign(depth + 1),
            None => self.power(depth),
        }
    }

    fn power(&mut self, depth: usize) -> Result<Term, FormulaError> {
        let base = self.atom(depth)?;
        if self.take(&["^"]).is_none() {
            return Ok(base);
        }
        let exponent = self.sign(depth + 1)?;
        Ok(base.raised(exponent))
    }

    fn atom(&mut self, depth: usize) -> Result<Term, FormulaError> {
        let column = self.column();
        let Some((token, _)) = self.tokens.get(self.next).cloned() else {
            return self.error("the formula ends too early".to_owned());
        };
        match token {
            Token::Number(v) => {
                self.next += 1;
                Ok(Term::Number(v))
            }
            Token::Symbol("(") => {
                self.next += 1;
                let value = self.sum(depth + 1)?;
                self.close(column)?;
                Ok(value)
            }
            Token::Text(_) => self.error(format!(
                "{token} is a text; it belongs in parentheses, as in \
                 mesh(\"part.stl\")"
            )),
            Token::Symbol(_) => self.error(format!(
                "expected a number, a name or `(`, found {token}"
            )),
            Token::Name(name) => {
                self.next += 1;
                if self.take(&["("]).is_none() {
                    return match &self.fourth {
                        Some((fourth, tree)) if name == fourth.text() => {
                            Ok(Term::Field(tree.clone()))
                        }
                        Some((fourth, _)) => {
                            constant(&name, column, fourth.constants())
                        }
                        None => constant(&name, column, CONSTANTS),
                    };
                }
                if let Some((Token::Text(text), _)) =
                    self.tokens.get(self.next).cloned()
                {
                    self.next += 1;
                    self.close(column)?;
                    return self.read(&name, &text, column);
                }
                let mut arguments = Vec::new();
                if self.take(&[")"]).is_none() {
                    loop {
                        arguments.push(self.sum(depth + 1)?);
                        if self.take(&[","]).is_none() {
                            break;
                        }
                    }
                    self.close(column)?;
                }
                call(&name, &arguments, column)
            }
        }
    }

    /// The value of a function that takes a text.
    fn read(
        &self,
        name: &str,
        text: &str,
        column: usize,
    ) -> Result<Term, FormulaError> {
        let failed = |message| FormulaError::at(column, message);
        let Some(kind) = kind(name) else {
            let all: Vec<&str> = KINDS.iter().map(|k| k.example).collect();
            return Err(failed(format!(
                "{name} takes no text; these do: {}",
                all.join(", ")
            )));
        };
        let files = self.files.ok_or_else(|| {
            failed("only a model reads files, and no setting does".to_owned())
        })?;
        let made = files.call(kind, text, &Options::new());
        made.map(Term::Field).map_err(failed)
    }

    fn close(&mut self, opened: usize) -> Result<(), FormulaError> {
        if self.take(&[")"]).is_some() {
            return Ok(());
        }
        match self.tokens.get(self.next) {
            None => self.error(format!(
                "the parenthesis of column {opened} is not closed"
            )),
            Some((token, _)) => self.error(format!(
                "expected an operator or `)` before {token}; write \
                 multiplication as `*`"
            )),
        }
    }
}
