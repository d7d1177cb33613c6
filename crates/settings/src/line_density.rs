//! How dense lines are: a share of the area, or their distance.

use super::value::{Form, Measure, Range, Raw, Refused, Value, ValueKind};
use isoslice_base::units::{Mm, Percent};

/// How dense parallel lines are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LineDensity {
    /// The share of the area that is printed.
    Share(Percent),
    /// The distance of the lines, from middle to middle.
    Spacing(Mm),
}

/// A distance between lines.
const SPACING: Measure = Measure {
    unit: "mm",
    range: Some(Range::between(0.1, 20.0)),
};

impl Value for LineDensity {
    fn read(raw: Raw<'_>, measure: Measure) -> Result<Self, Refused> {
        Ok(match raw.length() {
            Some(length) => {
                LineDensity::Spacing(Value::read(Raw::Word(length), SPACING)?)
            }
            None => LineDensity::Share(Value::read(raw, measure)?),
        })
    }

    fn to_toml(&self) -> String {
        match self {
            LineDensity::Share(share) => share.to_toml(),
            LineDensity::Spacing(apart) => {
                format!("{} mm", apart.to_toml()).to_toml()
            }
        }
    }

    fn kind(&self) -> ValueKind {
        ValueKind::NumberOrText(
            "10 to 100%, or the distance of lines, 0.1 to 20 mm, such as \"0.8 mm\"",
            &[Form::Length, Form::Share],
        )
    }
}
