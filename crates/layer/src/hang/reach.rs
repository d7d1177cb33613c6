//! How far plastic may stick out over the layer below.

use isoslice_base::units::Mm;
use isoslice_settings::Settings;

/// Width of a lip that hangs without harm, as a multiple of the outer wall's.
pub(super) const LIP: f64 = 2.0;
/// How far rims may be off, mm. So much more counts as held: otherwise a face
/// that leans by just `support.angle` would hang here and there.
const SLACK: Mm = 0.01;

/// How far a layer may stick out.
#[derive(Clone, Copy, Debug)]
pub(super) struct Limits {
    /// How far beyond its rim the layer below holds something.
    pub held: Mm,
    /// Width of what hangs beyond that without harm.
    pub lip: Mm,
}

impl Limits {
    /// The limits of a layer of this height.
    pub(super) fn new(height: Mm, settings: &Settings) -> Limits {
        Limits {
            held: settings.held(height) + SLACK,
            lip: LIP * settings.outer_wall_width(),
        }
    }
}
