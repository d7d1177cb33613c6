//! How far a layer holds what is above it, and how much hangs without harm.
//! Both figures are the same for warnings and for supports.

use super::plan::OverhangPlan;
use isoslice_base::units::Mm;

/// Width of a lip that hangs without harm, as a multiple of the outer wall's: a bead
/// laid beside one that is held sticks to it, and so does the next. Supports hold the
/// second one, too, as its underside is better then; no warning names it.
pub(super) const HARMLESS: f64 = 2.0;
/// What sticks out beyond what is held hangs only if it is more than this share of
/// the layer's height: a face that leans by just `support.angle` holds itself, in
/// layers of any height.
const HELD_ANYWAY: f64 = 0.1;

/// How far a layer of some height holds what is above it.
pub(crate) fn held(height: Mm, plan: &OverhangPlan) -> Mm {
    plan.slope(height) + HELD_ANYWAY * height
}

/// How far a layer may stick out.
#[derive(Clone, Copy, Debug)]
pub(super) struct Limits {
    /// How far a face sticks out that leans by just `support.angle`.
    pub slope: Mm,
    /// How far beyond its rim the layer below holds something.
    pub held: Mm,
    /// Width of what hangs beyond that without harm.
    pub harmless: Mm,
}

impl Limits {
    /// The limits of a layer of this height.
    pub(super) fn new(height: Mm, plan: &OverhangPlan) -> Limits {
        Limits {
            slope: plan.slope(height),
            held: held(height, plan),
            harmless: HARMLESS * plan.walls.outer,
        }
    }

    /// True if something that gets so far from what is below hangs by more than a
    /// lip.
    pub(super) fn harm(self, reach: Mm) -> bool {
        reach > self.held + self.harmless
    }

    /// What a layer adds to the distance from what holds a face, if its rim sticks out
    /// by this over the layer below. It comes nearer where it sticks out by less than
    /// the angle allows.
    pub(super) fn farther(self, beyond: Mm) -> Mm {
        if beyond > self.held {
            beyond - self.slope
        } else {
            (beyond - self.slope).min(0.0)
        }
    }
}
