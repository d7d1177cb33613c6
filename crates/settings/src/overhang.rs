//! Rates of walls that hang over the layer below: one for all, or steps by how
//! far they reach out.

use super::steps::{Of, Steps};
use super::value::{
    Form, Measure, Raw, Refused, Value, ValueKind, Varying, formula,
};
use isoslice_base::units::Percent;

/// One rate for all overhangs, or rates by steps.
#[derive(Clone, Debug, PartialEq)]
pub enum OfOverhangs<T> {
    /// All overhangs have this rate.
    Same(T),
    /// The rate depends on the share of a wall's width that reaches beyond the
    /// layer below.
    Steps(Steps),
}

/// Speed of overhangs, mm/s.
pub type OverhangSpeed = OfOverhangs<Varying>;
/// Speed of the fan at overhangs, %.
pub type OverhangFan = OfOverhangs<Percent>;

impl<T> OfOverhangs<T> {
    /// The rate, if all overhangs have the same.
    pub fn same(&self) -> Option<&T> {
        match self {
            OfOverhangs::Same(rate) => Some(rate),
            OfOverhangs::Steps(_) => None,
        }
    }

    /// The steps, if there are any.
    pub fn steps(&self) -> Option<&Steps> {
        match self {
            OfOverhangs::Same(_) => None,
            OfOverhangs::Steps(steps) => Some(steps),
        }
    }
}

/// What a value says: steps, or a rate.
fn read<T: Value>(
    raw: Raw<'_>,
    measure: Measure,
    of: Of,
) -> Result<OfOverhangs<T>, Refused> {
    Ok(match raw {
        Raw::Text(text) | Raw::Word(text)
            if text.contains(':') && formula(raw).is_none() =>
        {
            OfOverhangs::Steps(Steps::read(text, of)?)
        }
        _ => OfOverhangs::Same(T::read(raw, measure)?),
    })
}

fn written<T: Value>(rate: &OfOverhangs<T>) -> String {
    match rate {
        OfOverhangs::Same(rate) => rate.to_toml(),
        OfOverhangs::Steps(steps) => steps.to_toml(),
    }
}

impl Value for OverhangSpeed {
    fn read(raw: Raw<'_>, measure: Measure) -> Result<Self, Refused> {
        read(raw, measure, Of::Speed)
    }

    fn to_toml(&self) -> String {
        written(self)
    }

    fn kind(&self) -> ValueKind {
        ValueKind::NumberOrText(
            "0.1 to 2000 mm/s, or \"expr: ...\", or shares of the width, above \
             0 to 100%, each with its speed, or a share of what it is \
             elsewhere, 1 to 100%, such as \"10: 100%, 25: 80%, 50: 30, 100: \
             15\"",
            &[Form::Expression, Form::Steps],
        )
    }
}

impl Value for OverhangFan {
    fn read(raw: Raw<'_>, measure: Measure) -> Result<Self, Refused> {
        read(raw, measure, Of::Fan)
    }

    fn to_toml(&self) -> String {
        written(self)
    }

    fn kind(&self) -> ValueKind {
        ValueKind::NumberOrText(
            "0 to 100%, or shares of the width, above 0 to 100%, each with its \
             value, 0 to 100%, such as \"25: 50, 100: 100\"",
            &[Form::Share, Form::Steps],
        )
    }
}
