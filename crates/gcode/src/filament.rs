//! Where the filament is: what has been fed, what is pulled back, and what the
//! machine has been told.

use isoslice_base::units::Mm;

/// Number of units of the filament's last decimal in a millimetre.
const E_UNITS: f64 = 1e5;

/// The filament's position.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Filament {
    /// True if each E word is a step, not a position.
    pub(super) relative: bool,
    /// Filament fed into the print, not rounded, mm.
    pub(super) exact: Mm,
    /// Filament that is pulled back now, in units of the last decimal.
    pub(super) back: i64,
    /// The position that the machine was told last, counted from the start, in
    /// units of the last decimal.
    pub(super) told: i64,
    /// The position of the last reset, in units of the last decimal; nothing if
    /// the next layer has to begin with a reset.
    pub(super) zero: Option<i64>,
}

impl Filament {
    /// The number of the E word that brings the machine to where the filament
    /// should be; nothing if the filament is there.
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
