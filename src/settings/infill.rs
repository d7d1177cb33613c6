//! What the sparse infill is: one of the patterns, or an expression.

use super::value::{Kind, Measure, Raw, Refused, Value};
use super::{InfillPattern, Varying};

/// Sparse infill. Settings keep expressions and scripts as text;
/// [`crate::model`] knows what they mean.
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
    fn assign(
        &mut self,
        raw: Raw<'_>,
        measure: Measure,
    ) -> Result<(), Refused> {
        if let Raw::Text(text) | Raw::Word(text) = raw {
            let text = text.trim();
            if let Some(formula) = text.strip_prefix(<Varying>::PREFIX) {
                *self = Infill::Expression(formula.trim().to_owned());
                return Ok(());
            }
            if text.ends_with(SCRIPT) {
                *self = Infill::Script(text.to_owned());
                return Ok(());
            }
        }
        let mut pattern = InfillPattern::Rectilinear;
        pattern.assign(raw, measure)?;
        *self = Infill::Pattern(pattern);
        Ok(())
    }

    fn to_toml(&self) -> String {
        match self {
            Infill::Pattern(pattern) => pattern.to_toml(),
            Infill::Expression(text) => {
                format!("{} {text}", <Varying>::PREFIX).to_toml()
            }
            Infill::Script(path) => path.to_toml(),
        }
    }

    fn number(&self) -> Option<f64> {
        None
    }

    fn kind(&self) -> Kind {
        match InfillPattern::Rectilinear.kind() {
            Kind::Word(words) => Kind::WordOrShape(words),
            kind => kind,
        }
    }
}
