//! Where closed walls begin: a rule by its name, or an expression.

use super::value::{Kind, Measure, Raw, Refused, Value};
use super::{SeamRule, Varying};

/// Where closed walls begin and end. Settings keep an expression as text;
/// [`crate::model`] knows what it means.
#[derive(Clone, Debug, PartialEq)]
pub enum Seam {
    /// A rule by its name.
    Rule(SeamRule),
    /// A formula of x, y, z and d. Walls begin where it is least.
    Expression(String),
}

impl Seam {
    /// True if a loop may begin wherever the nozzle is nearest.
    pub fn is_nearest(&self) -> bool {
        *self == Seam::Rule(SeamRule::Nearest)
    }
}

impl Value for Seam {
    fn assign(
        &mut self,
        raw: Raw<'_>,
        measure: Measure,
    ) -> Result<(), Refused> {
        if let Raw::Text(text) | Raw::Word(text) = raw
            && let Some(formula) = text.trim().strip_prefix(<Varying>::PREFIX)
        {
            *self = Seam::Expression(formula.trim().to_owned());
            return Ok(());
        }
        let mut rule = SeamRule::Aligned;
        rule.assign(raw, measure)?;
        *self = Seam::Rule(rule);
        Ok(())
    }

    fn to_toml(&self) -> String {
        match self {
            Seam::Rule(rule) => rule.to_toml(),
            Seam::Expression(text) => {
                format!("{} {text}", <Varying>::PREFIX).to_toml()
            }
        }
    }

    fn number(&self) -> Option<f64> {
        None
    }

    fn kind(&self) -> Kind {
        match SeamRule::Aligned.kind() {
            Kind::Word(words) => Kind::WordOrFormula(words),
            kind => kind,
        }
    }
}
