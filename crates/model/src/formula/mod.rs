//! One formula of x, y and z, as given on the command line.
//!
//! In: text such as `sqrt(x^2 + y^2 + z^2) - 15`. Out: an expression tree, or
//! an error with the column.
//!
//! ```text
//! sum     = product { ("+" | "-") product }
//! product = sign { ("*" | "/" | "%") sign }
//! sign    = ("+" | "-") sign | power
//! power   = atom [ ("^" | "**") sign ]
//! atom    = number | name | name "(" sum { "," sum } ")" | "(" sum ")"
//!         | name "(" text ")"
//! ```
//!
//! As in mathematics, `^` binds tighter than a sign before it and groups to
//! the right: -x^2 = -(x²), 2^3^2 = 2^9. Nesting is limited, so that hostile
//! input cannot overflow the stack. Constant parts are computed in f64.

mod names;
mod parser;
#[cfg(test)]
mod tests;
mod token;

use super::data::Files;
use super::term::Term;
use fidget::context::Tree;
pub(super) use names::Name;
use parser::parse;

/// What is wrong with a text that is not a formula.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("column {column}: {message}")]
pub struct FormulaError {
    /// Column of the mistake, in characters from 1.
    pub column: usize,
    /// What is wrong, and the remedy.
    pub message: String,
}

impl FormulaError {
    fn at(column: usize, message: impl Into<String>) -> FormulaError {
        let message = message.into();
        FormulaError { column, message }
    }
}

/// Parses the formula of a shape, which may read files.
pub(crate) fn parse_formula(
    text: &str,
    files: &Files,
) -> Result<Tree, FormulaError> {
    match parse(text, None, Some(files))? {
        Term::Field(tree) => Ok(tree),
        Term::Number(v) => Err(FormulaError::at(
            1,
            format!(
                "the formula is the constant {v}; a shape needs at least \
                 one of x, y, z"
            ),
        )),
    }
}

/// Parses a formula that may be a constant, in which a name stands for a
/// fourth variable.
pub(super) fn parse_with(
    text: &str,
    name: Name,
    variable: Tree,
) -> Result<Tree, FormulaError> {
    parse(text, Some((name, variable)), None).map(Term::tree)
}
