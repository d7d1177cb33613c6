//! How far plastic may stick out over the layer below.

use crate::settings::Settings;
use crate::units::Mm;

/// Lip that hangs without harm, in widths of the outer wall.
const LIP: f64 = 2.0;
/// Rims are known so well, mm.
const SLACK: Mm = 0.01;

/// How far a layer may stick out.
#[derive(Clone, Copy, Debug)]
pub(super) struct Limits {
    /// What the layer below holds beyond its rim.
    pub held: Mm,
    /// What hangs beyond that without harm.
    pub lip: Mm,
}

impl Limits {
    /// Of a layer of this height.
    pub(super) fn new(height: Mm, settings: &Settings) -> Limits {
        Limits {
            held: height * settings.support.angle.to_radians().tan() + SLACK,
            lip: LIP * settings.outer_wall_width(),
        }
    }
}
