//! Whether something is done, and how often or how much.

use super::value::{Measure, Raw, Refused, Value, ValueKind};

/// Off, on as usual, or on with a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SwitchOr<T> {
    /// Not at all.
    Off,
    /// As usual.
    On,
    /// So often, or so much.
    Number(T),
}

impl<T: Copy> SwitchOr<T> {
    /// True unless it is off.
    pub fn is_on(self) -> bool {
        !matches!(self, SwitchOr::Off)
    }

    /// The number, if it was given.
    pub fn number(self) -> Option<T> {
        match self {
            SwitchOr::Number(number) => Some(number),
            SwitchOr::Off | SwitchOr::On => None,
        }
    }
}

impl<T: Value + Default> Value for SwitchOr<T> {
    fn read(raw: Raw<'_>, measure: Measure) -> Result<Self, Refused> {
        Ok(match raw {
            Raw::Bool(true) | Raw::Word("true") => SwitchOr::On,
            Raw::Bool(false) | Raw::Word("false") => SwitchOr::Off,
            _ => SwitchOr::Number(T::read(raw, measure)?),
        })
    }

    fn to_toml(&self) -> String {
        match self {
            SwitchOr::Off => false.to_toml(),
            SwitchOr::On => true.to_toml(),
            SwitchOr::Number(number) => number.to_toml(),
        }
    }

    fn kind(&self) -> ValueKind {
        match T::default().kind() {
            ValueKind::Whole => ValueKind::SwitchOrWhole,
            _ => ValueKind::SwitchOrNumber,
        }
    }
}
