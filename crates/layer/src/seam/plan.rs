//! What the ends of outer walls follow from.

use crate::resolution::Resolution;
use isoslice_base::units::Mm;
use isoslice_settings::Settings;

/// How outer walls end where they began.
#[derive(Clone, Copy, Debug)]
pub struct EndingPlan {
    /// Length of a scarf, mm; 0 for none.
    pub scarf: Mm,
    /// Height at which a scarf that rises begins, as a share of the bead's.
    pub start: f64,
    /// True if scarfs rise with their flow.
    pub rises: bool,
    /// Length of the gap between end and beginning, mm.
    pub gap: Mm,
    /// How far the nozzle goes on into the part, mm; 0 if it does not.
    pub wipe: Mm,
    /// True if some walls run the other way round.
    pub reversed: bool,
    /// The pieces that scarfs are made of.
    pub resolution: Resolution,
}

impl EndingPlan {
    /// The plan that settings ask for.
    pub fn of(settings: &Settings) -> EndingPlan {
        EndingPlan {
            scarf: settings.seam_scarf.length,
            start: 0.01 * settings.seam_scarf.start,
            rises: settings.scarf_rises(),
            gap: settings.seam_gap,
            wipe: settings.seam_wipe,
            reversed: settings.overhang_reverse,
            resolution: Resolution::of(settings),
        }
    }
}
