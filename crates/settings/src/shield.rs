//! How high the draft shield is: nowhere, a height, or all of the print.

use super::value::{Measure, Raw, Refused, Value, ValueKind};
use isoslice_base::units::Mm;

/// A wall around the print that keeps draughts off.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DraftShield {
    /// There is no draft shield.
    Off,
    /// The draft shield is as high as the print.
    Full,
    /// The draft shield is this high, mm.
    UpTo(Mm),
}

impl DraftShield {
    /// Height of the draft shield above the bed, mm; 0 if there is none.
    pub fn height(self) -> Mm {
        match self {
            DraftShield::Off => 0.0,
            DraftShield::Full => f64::INFINITY,
            DraftShield::UpTo(height) => height,
        }
    }
}

impl Value for DraftShield {
    fn assign(
        &mut self,
        raw: Raw<'_>,
        measure: Measure,
    ) -> Result<(), Refused> {
        *self = match raw {
            Raw::Text("off") | Raw::Word("off") => DraftShield::Off,
            Raw::Text("full") | Raw::Word("full") => DraftShield::Full,
            _ => {
                let mut height = 0.0;
                f64::assign(&mut height, raw, measure)?;
                DraftShield::UpTo(height)
            }
        };
        Ok(())
    }

    fn to_toml(&self) -> String {
        match self {
            DraftShield::Off => "\"off\"".to_owned(),
            DraftShield::Full => "\"full\"".to_owned(),
            DraftShield::UpTo(height) => height.to_toml(),
        }
    }

    fn kind(&self) -> ValueKind {
        ValueKind::WordOrNumber(&["off", "full"])
    }
}
