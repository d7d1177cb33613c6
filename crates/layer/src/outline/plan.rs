//! How outlines are changed, in numbers.

use isoslice_base::units::Mm;
use isoslice_settings::Settings;

/// How outlines are changed before anything is made of them.
#[derive(Clone, Copy, Debug)]
pub struct OutlinePlan {
    /// Slits narrower than this are filled, mm.
    pub slit: Mm,
    /// By how much outlines move outwards, mm; 0 if that differs from place to
    /// place.
    pub grow: Mm,
    /// By how much the first layer is drawn in, mm; 0 on a raft, since it is not
    /// squeezed there.
    pub foot: Mm,
    /// Number of layers that are drawn in, less and less.
    pub foot_layers: usize,
    /// Thickness of what may be left when an outline is drawn in, mm.
    pub keep: Mm,
    /// Greatest error, mm.
    pub tolerance: Mm,
}

impl OutlinePlan {
    /// The plan that settings ask for.
    pub fn of(settings: &Settings) -> OutlinePlan {
        let on_bed = settings.raft_layers() == 0;
        OutlinePlan {
            slit: 2.0 * settings.slit_closing(),
            grow: settings.xy_compensation.constant().unwrap_or(0.0),
            foot: if on_bed {
                settings.elephant_foot.drawn
            } else {
                0.0
            },
            foot_layers: settings.elephant_foot.layers as usize,
            keep: 2.0 * settings.outer_wall_width(),
            tolerance: 0.2 * settings.accuracy,
        }
    }
}
