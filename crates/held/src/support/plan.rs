//! What supports follow from.

use crate::overhangs::OverhangPlan;
use isoslice_base::units::{Degrees, Mm};
use isoslice_settings::{Settings, SupportStyle, Supports, Varying};

/// Where supports are, and how they grow.
#[derive(Clone, Debug)]
pub struct SupportPlan {
    /// What tells which places hang.
    pub overhangs: OverhangPlan,
    /// Where undersides are held whatever their angle (above 0), or left alone
    /// (below 0).
    pub wanted: Varying,
    /// True if supports may stand on the part, and not only on the bed.
    pub on_part: bool,
    /// What supports look like below their dense tops.
    pub style: SupportStyle,
    /// Greatest angle of branches from the vertical.
    pub branch_angle: Degrees,
    /// Line width, mm.
    pub width: Mm,
    /// Greatest height of a bead, mm.
    pub highest_bead: Mm,
    /// Number of dense layers below what is held.
    pub interface_layers: usize,
    /// Gap between supports and the part beside them, mm.
    pub xy_gap: Mm,
    /// Gap between a support and the part above it, mm.
    pub gap_top: Mm,
    /// Gap between the part and a support that stands on it, mm.
    pub gap_bottom: Mm,
    /// Height of the part's lowest point above the bed, mm.
    pub lift: Mm,
}

impl SupportPlan {
    /// The plan that settings ask for.
    pub fn of(settings: &Settings) -> SupportPlan {
        let support = &settings.support;
        let width = settings.infill_width();
        SupportPlan {
            overhangs: OverhangPlan {
                by_skin: false,
                ..OverhangPlan::of(settings)
            },
            wanted: support.where_.clone(),
            on_part: settings.supports == Supports::Auto,
            style: support.style,
            branch_angle: support.branch_angle,
            width,
            highest_bead: settings.highest_bead(width),
            interface_layers: support.interface_layers as usize,
            xy_gap: support.xy_gap,
            gap_top: support.z_gap,
            gap_bottom: support.z_gap_bottom,
            lift: settings.raft_height(),
        }
    }

    /// How far branches lean, mm aside per mm of height.
    pub(super) fn lean(&self) -> f64 {
        self.branch_angle.to_radians().tan()
    }
}
