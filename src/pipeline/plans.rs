//! What the stages of a part do, resolved once from the part's settings.

use isoslice_layer::resolution::Resolution;
use isoslice_layer::seam::EndingPlan;
use isoslice_settings::Settings;

/// The plans of a part.
pub(super) struct Plans {
    pub resolution: Resolution,
    pub ending: EndingPlan,
}

impl Plans {
    /// The plans of a part with these settings.
    pub(super) fn of(settings: &Settings) -> Plans {
        Plans {
            resolution: Resolution::of(settings),
            ending: EndingPlan::of(settings),
        }
    }
}
