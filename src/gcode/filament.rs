//! Where the filament is: what has been fed, what is pulled back, and what the
//! machine has been told.

use crate::units::Mm;

/// Units of the last decimal of filament in a millimetre.
const E_UNITS: f64 = 1e5;

/// The filament's position.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Filament {
    /// True if each word is a step, and no place.
    pub(super) relative: bool,
    /// Fed into the print, exactly, mm.
    pub(super) exact: Mm,
    /// Pulled back at present, units of the last decimal.
    pub(super) back: i64,
    /// Where the machine has been told to go since the start, units.
    pub(super) told: i64,
    /// Where its last reset was, units; nothing if the next layer has to
    /// begin with one.
    pub(super) zero: Option<i64>,
}

impl Filament {
    /// Brings the machine to where the filament should be: the number for an
    /// E word, or nothing if it is there.
    pub(super) fn word(&mut self) -> Option<i64> {
        let goal = (self.exact * E_UNITS).round() as i64 - self.back;
        let step = goal - self.told;
        self.told = goal;
        let number = if self.relative {
            step
        } else {
            goal - self.zero.unwrap_or(0)
        };
        (step != 0).then_some(number)
    }
}
