//! What the sparse infill is: one of the patterns, or an expression.

use super::InfillPattern;
use super::value::{
    Form, Measure, Raw, Refused, Value, ValueKind, formula, formula_to_toml,
};

/// Sparse infill. Settings keep expressions and scripts as text;
/// the crate `isoslice-model` knows what they mean.
#[derive(Clone, Debug, PartialEq)]
pub enum Infill {
    /// A pattern by its name.
    Pattern(InfillPattern),
    /// A formula of x, y, z and d.
    Expression(String),
    /// The path of a `.rhai` script.
    Script(String),
}

/// The extension of a script's path.
const SCRIPT: &str = ".rhai";

impl Value for Infill {
    fn read(raw: Raw<'_>, measure: Measure) -> Result<Self, Refused> {
        if let Some(formula) = formula(raw) {
            return Ok(Infill::Expression(formula));
        }
        Ok(match raw {
            Raw::Text(text) | Raw::Word(text)
                if text.trim().ends_with(SCRIPT) =>
            {
                Infill::Script(text.trim().to_owned())
            }
            _ => Infill::Pattern(Value::read(raw, measure)?),
        })
    }

    fn to_toml(&self) -> String {
        match self {
            Infill::Pattern(pattern) => pattern.to_toml(),
            Infill::Expression(text) => formula_to_toml(text),
            Infill::Script(path) => path.to_toml(),
        }
    }

    fn kind(&self) -> ValueKind {
        match InfillPattern::default().kind() {
            ValueKind::Word(words) => {
                ValueKind::WordOrText(words, &[Form::Expression, Form::Script])
            }
            kind => kind,
        }
    }
}
