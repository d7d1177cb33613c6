//! What travels need of the settings.

use isoslice_base::units::Mm;
use isoslice_layer::resolution::Resolution;
use isoslice_settings::{Combing, Retract, Settings};

/// Where travels may lead, and when they retract.
#[derive(Clone, Debug)]
pub struct TravelPlan {
    /// Where travels may lead.
    pub(super) combing: Combing,
    /// By how much a way round may be longer than the straight way, mm.
    pub(super) max_detour: Mm,
    /// When to retract, wipe and hop.
    pub(super) retract: Retract,
    /// Width of the outer wall, of walls inside, and of infill, mm.
    pub(super) outer_width: Mm,
    pub(super) inner_width: Mm,
    pub(super) infill_width: Mm,
    /// True if nothing is printed where there is room for infill.
    pub(super) hollow: bool,
    /// How near paths come to what is meant.
    pub(super) resolution: Resolution,
}

impl TravelPlan {
    /// The plan that settings ask for.
    pub fn of(s: &Settings) -> TravelPlan {
        TravelPlan {
            combing: s.travel.combing,
            max_detour: s.travel.max_detour,
            retract: s.retract.clone(),
            outer_width: s.outer_wall_width(),
            inner_width: s.inner_wall_width(),
            infill_width: s.infill_width(),
            hollow: s.is_hollow(),
            resolution: Resolution::of(s),
        }
    }
}
