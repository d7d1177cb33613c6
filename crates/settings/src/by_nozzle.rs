//! Lengths that may follow the nozzle: in millimetres, or as a share of its
//! diameter.

use super::value::{Measure, Raw, Refused, Value, ValueKind};
use isoslice_base::units::{Mm, Percent};

/// A length that has to suit the nozzle.
///
/// `auto` is usually a share, too, and each setting has its own.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum ByNozzle {
    /// The length that usually suits the nozzle.
    #[default]
    Auto,
    /// A length that does not depend on the nozzle.
    Length(Mm),
    /// A share of the nozzle's diameter.
    Share(Percent),
}

impl ByNozzle {
    /// The length with a nozzle of this diameter; `usual` is what `auto` stands
    /// for.
    pub(super) fn with(self, nozzle: Mm, usual: Mm) -> Mm {
        match self {
            ByNozzle::Auto => usual,
            ByNozzle::Length(length) => length,
            ByNozzle::Share(share) => share_of(nozzle, share),
        }
    }
}

/// A share of the nozzle's diameter.
pub(super) fn share_of(nozzle: Mm, share: Percent) -> Mm {
    // Multiplied first, 70 % of 0.4 mm are the number nearest to 0.28.
    share * nozzle / 100.0
}

impl From<Mm> for ByNozzle {
    fn from(length: Mm) -> Self {
        ByNozzle::Length(length)
    }
}

/// A share is checked against the range once the nozzle is known.
const SHARE: Measure = Measure {
    unit: "%",
    range: None,
};

impl Value for ByNozzle {
    fn read(raw: Raw<'_>, measure: Measure) -> Result<Self, Refused> {
        Ok(match raw {
            Raw::Text("auto") | Raw::Word("auto") => ByNozzle::Auto,
            Raw::Text(text) | Raw::Word(text) if text.ends_with('%') => {
                ByNozzle::Share(Value::read(raw, SHARE)?)
            }
            _ => ByNozzle::Length(Value::read(raw, measure)?),
        })
    }

    fn to_toml(&self) -> String {
        match self {
            ByNozzle::Auto => "\"auto\"".to_owned(),
            ByNozzle::Length(length) => length.to_toml(),
            ByNozzle::Share(share) => format!("{}%", share.to_toml()).to_toml(),
        }
    }

    fn kind(&self) -> ValueKind {
        ValueKind::ByNozzle
    }
}
