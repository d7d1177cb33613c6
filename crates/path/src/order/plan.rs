//! What the order of beads needs of the settings.

use isoslice_base::units::Mm;
use isoslice_settings::{SeamRule, Settings, Varying, WallOrder};

/// In which order beads are printed, and what may go on in what.
#[derive(Clone, Copy, Debug)]
pub struct OrderPlan {
    /// True if inner walls are printed before the outer wall.
    pub(super) inner_first: bool,
    /// True if they are where the outer wall hangs.
    pub(super) inner_first_at_overhangs: bool,
    /// True if walls that hang run the other way round in every other layer.
    pub(super) turns_overhangs: bool,
    /// True if loops begin where the nozzle is.
    pub(super) begins_anywhere: bool,
    /// Width of the outer wall, mm.
    pub(super) outer_width: Mm,
    /// True if a closed outer wall ends where it begins, in full width.
    pub(super) whole_seams: bool,
    /// True if a way may lead from an inner wall to where an outer wall begins. It
    /// would be a step where beads follow the surface in z.
    pub(super) enters_seams: bool,
    /// True if lines of skin end at the ring around them, without a gap.
    pub(super) skin_meets_ring: bool,
}

impl OrderPlan {
    /// The plan that settings ask for.
    pub fn of(s: &Settings) -> OrderPlan {
        let whole_seams = s.seam_gap <= 0.0 && s.seam_scarf.length <= 0.0;
        let level = s.contour_z == Varying::Constant(0.0);
        OrderPlan {
            inner_first: s.wall_order == WallOrder::InnerFirst,
            inner_first_at_overhangs: s.wall_order
                == WallOrder::OuterFirstUnlessOverhang,
            turns_overhangs: s.overhang_reverse,
            begins_anywhere: s.seam == Varying::Constant(SeamRule::Nearest),
            outer_width: s.outer_wall_width(),
            whole_seams,
            enters_seams: whole_seams && level,
            skin_meets_ring: s.skin_ring_gap <= 0.0,
        }
    }
}
