//! What the resolution of paths follows from.

use isoslice_base::units::Mm;
use isoslice_settings::Settings;

/// How near paths have to come to what is meant.
#[derive(Clone, Copy, Debug)]
pub struct Resolution {
    /// Greatest error of what shows, mm.
    pub(super) accuracy: Mm,
    /// Greatest error of what does not show, mm.
    pub(super) path_accuracy: Mm,
    /// True if curved paths become arcs.
    pub arcs: bool,
}

impl Resolution {
    /// The resolution that settings ask for.
    pub fn of(settings: &Settings) -> Resolution {
        Resolution {
            accuracy: settings.accuracy,
            path_accuracy: settings.path_accuracy,
            arcs: settings.arcs(),
        }
    }
}
