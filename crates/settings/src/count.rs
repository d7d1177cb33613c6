//! Whether something is done, and how often.

use super::value::{Measure, Raw, Refused, Value, ValueKind};

/// Off, on as usual, or on so many times.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SwitchOrCount {
    /// Not at all.
    Off,
    /// As often as usual.
    On,
    /// So many times, at least once.
    Count(u32),
}

impl SwitchOrCount {
    /// True unless it is off.
    pub fn is_on(self) -> bool {
        self != SwitchOrCount::Off
    }

    /// The number of times, if it was given.
    pub fn count(self) -> Option<u32> {
        match self {
            SwitchOrCount::Count(count) => Some(count),
            SwitchOrCount::Off | SwitchOrCount::On => None,
        }
    }
}

impl Value for SwitchOrCount {
    fn assign(
        &mut self,
        raw: Raw<'_>,
        measure: Measure,
    ) -> Result<(), Refused> {
        *self = match raw {
            Raw::Bool(true) | Raw::Word("true") => SwitchOrCount::On,
            Raw::Bool(false) | Raw::Word("false") => SwitchOrCount::Off,
            _ => {
                let mut count = 0;
                u32::assign(&mut count, raw, measure)?;
                SwitchOrCount::Count(count)
            }
        };
        Ok(())
    }

    fn to_toml(&self) -> String {
        match self {
            SwitchOrCount::Off => false.to_toml(),
            SwitchOrCount::On => true.to_toml(),
            SwitchOrCount::Count(count) => count.to_toml(),
        }
    }

    fn kind(&self) -> ValueKind {
        ValueKind::SwitchOrWhole
    }
}
