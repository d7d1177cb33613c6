//! What the stages of a part do, resolved once from the part's settings.

use isoslice_held::hang::HangPlan;
use isoslice_held::support::SupportPlan;
use isoslice_layer::adhesion::AdhesionPlan;
use isoslice_layer::exposure::ExposurePlan;
use isoslice_layer::infill::InfillPlan;
use isoslice_layer::outline::OutlinePlan;
use isoslice_layer::resolution::Resolution;
use isoslice_layer::seam::EndingPlan;
use isoslice_layer::skin::SkinPlan;
use isoslice_layer::walls::WallPlan;
use isoslice_path::order::OrderPlan;
use isoslice_path::pace::PacePlan;
use isoslice_path::spiral::SpiralPlan;
use isoslice_path::travel::TravelPlan;
use isoslice_path::z_contouring::ZContouringPlan;
use isoslice_settings::Settings;

/// The plans of a part.
pub(super) struct Plans {
    pub resolution: Resolution,
    pub outline: OutlinePlan,
    pub walls: WallPlan,
    pub exposure: ExposurePlan,
    pub skin: SkinPlan,
    pub infill: InfillPlan,
    pub adhesion: AdhesionPlan,
    pub hang: HangPlan,
    pub support: SupportPlan,
    pub ending: EndingPlan,
    pub spiral: SpiralPlan,
    pub order: OrderPlan,
    pub z_contouring: ZContouringPlan,
    pub travel: TravelPlan,
    pub pace: PacePlan,
}

impl Plans {
    /// The plans of a part with these settings.
    pub(super) fn of(settings: &Settings) -> Plans {
        Plans {
            resolution: Resolution::of(settings),
            outline: OutlinePlan::of(settings),
            walls: WallPlan::of(settings),
            exposure: ExposurePlan::of(settings),
            skin: SkinPlan::of(settings),
            infill: InfillPlan::of(settings),
            adhesion: AdhesionPlan::of(settings),
            hang: HangPlan::of(settings),
            support: SupportPlan::of(settings),
            ending: EndingPlan::of(settings),
            spiral: SpiralPlan::of(settings),
            order: OrderPlan::of(settings),
            z_contouring: ZContouringPlan::of(settings),
            travel: TravelPlan::of(settings),
            pace: PacePlan::of(settings),
        }
    }
}
