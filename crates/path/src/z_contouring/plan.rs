//! What beads that follow a surface need of the settings.

use isoslice_base::units::{Mm, Percent};
use isoslice_layer::resolution::Resolution;
use isoslice_settings::{FullAngle, Settings, Varying};

/// How far beads follow the surface above and below their layer.
#[derive(Clone, Debug)]
pub struct ZContouringPlan {
    /// How far beads of the part follow its surface.
    pub(super) strength: Varying<Percent>,
    /// True if the part has beads in layers, not climbing walls.
    pub(super) in_layers: bool,
    /// True if the part's beads follow its undersides, too.
    pub(super) undersides: bool,
    /// Gap below the undersides that tops of supports follow, mm; none if they
    /// are flat.
    pub(super) support_gap: Option<Mm>,
    /// Diameter of the nozzle's hole, mm.
    pub(super) nozzle: Mm,
    /// The steepest face that is followed in full.
    pub(super) full_angle: FullAngle,
    /// How near paths come to what is meant.
    pub(super) resolution: Resolution,
}

impl ZContouringPlan {
    /// The plan that settings ask for.
    pub fn of(s: &Settings) -> ZContouringPlan {
        ZContouringPlan {
            strength: s.contour_z.clone(),
            in_layers: !s.is_vase(),
            undersides: s.contour_z_below,
            support_gap: s.supports_follow().then_some(s.support.z_gap),
            nozzle: s.printer.nozzle_diameter,
            full_angle: s.contour_z_full_angle(),
            resolution: Resolution::of(s),
        }
    }
}
