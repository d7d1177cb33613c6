//! Fewer walls around tops: what a layer has of them, and what is left for all
//! of the walls.
//!
//! ```text
//!   ┌───────────────────────┐   A step, from above: the layer has one wall
//!   │╱╱╱╱╱╱╱╱╱╱╱┌──────────┐│   around the top ╱, whose lines reach it, and
//!   │╱╱╱╱╱╱╱╱╱╱╱│┌────────┐││   all of its walls around what the next layer
//!   │╱╱╱╱╱╱╱╱╱╱╱││        │││   stands on. The innermost of the walls around a
//!   │╱╱╱╱╱╱╱╱╱╱╱│└────────┘││   top lies below the outer wall of the next
//!   │╱╱╱╱╱╱╱╱╱╱╱└──────────┘│   layer, where nobody sees it.
//!   └───────────────────────┘
//! ```
//!
//! In: what the outermost walls of a layer leave, and the outline of the layer
//! above. Out: the top, and the rest.

use super::WallPlan;
use crate::cover::near;
use isoslice_base::units::Mm;
use isoslice_planar::Area;
use isoslice_planar::clip::{difference, union};
use isoslice_planar::offset::offset;
use isoslice_planar::opening::wide_parts;

/// A layer's area, divided.
#[derive(Debug, PartialEq)]
pub(super) struct Divided {
    /// What is seen from above, and is filled up to the outermost walls.
    pub top: Area,
    /// What has all of the walls.
    pub rest: Area,
}

/// Divides what the outermost walls of a layer leave, `left`, if the layer has
/// a top: some place where the outline `above` leaves more than two lines of
/// skin open. `above` is nothing at the part's highest layer. What of the rest
/// is narrower than a wall goes to the top. Borders are exact to `tolerance`.
pub(super) fn divided(
    left: &Area,
    above: &Area,
    plan: &WallPlan,
    tolerance: Mm,
) -> Option<Divided> {
    if left.is_empty() {
        return None;
    }
    // The border lies below the middle of the next layer's outer wall.
    let half = 0.5 * plan.outer;
    let covered = offset(&near(left, above), -half, tolerance);
    let open = difference(left, &covered);
    let wide = wide_parts(&open, plan.top_skin, tolerance);
    if wide.is_empty() {
        return None;
    }
    let rest = difference(left, &wide);
    let half = 0.5 * plan.inner;
    let rest = wide_parts(&rest, half, tolerance);
    let top = difference(left, &rest);
    Some(Divided { top, rest })
}

impl Divided {
    /// What is to be filled, if the walls leave so much of the rest.
    pub(super) fn filled(&self, rest: &Area) -> Area {
        union(&self.top, rest)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2;
    use isoslice_planar::rect;
    use isoslice_settings::testing::plan_with;

    const TOLERANCE: Mm = 0.002;

    fn plan() -> WallPlan {
        plan_with(WallPlan::of, |s| {
            s.outer_wall_width = 0.4.into();
            s.inner_wall_width = 0.5.into();
            s.top_skin_width = 0.5.into();
        })
    }

    #[test]
    fn a_step_is_divided_below_the_next_layers_wall() {
        let left = rect(0.0, 0.0, 20.0, 10.0);
        // The next layer ends at x = 8 and shares the other borders, which
        // are a wall's width farther out than what its walls leave.
        let above = rect(-0.4, -0.4, 8.0, 10.4);
        let found = divided(&left, &above, &plan(), TOLERANCE);
        let Divided { top, rest } = found.expect("a top");
        assert!((rest.content() - 7.8 * 10.0).abs() < 0.05, "{rest:?}");
        assert!((top.content() - 12.2 * 10.0).abs() < 0.05, "{top:?}");
        assert!(top.contains(DVec2::new(7.85, 5.0)));
        assert!(rest.contains(DVec2::new(7.75, 5.0)));
        // Not even corners are lost.
        assert!(top.contains(DVec2::new(19.99, 9.99)));
        assert!(rest.contains(DVec2::new(0.01, 0.01)));
    }

    #[test]
    fn the_highest_layer_is_a_top_everywhere() {
        let left = rect(0.0, 0.0, 20.0, 10.0);
        let found = divided(&left, &Area::EMPTY, &plan(), TOLERANCE);
        let Divided { top, rest } = found.expect("a top");
        assert!(rest.is_empty());
        assert!((top.content() - 200.0).abs() < 1e-6);
    }

    #[test]
    fn slopes_keep_their_walls() {
        let left = rect(0.0, 0.0, 20.0, 10.0);
        // So much is open of it; two lines are 1 mm wide.
        for (by, is_top) in [(0.0, false), (0.95, false), (1.05, true)] {
            let above = rect(-0.4, -0.4, 20.2 - by, 10.4);
            let found = divided(&left, &above, &plan(), TOLERANCE);
            assert_eq!(found.is_some(), is_top, "{by}");
        }
    }

    /// A rib too narrow for a wall of its own is filled with the top.
    #[test]
    fn narrow_rests_are_part_of_the_top() {
        let left = rect(0.0, 0.0, 20.0, 10.0);
        let above = rect(9.6, -0.4, 10.4, 10.4);
        let found = divided(&left, &above, &plan(), TOLERANCE);
        let Divided { top, rest } = found.expect("a top");
        assert!(rest.is_empty(), "{rest:?}");
        assert!((top.content() - 200.0).abs() < 1e-6);
    }
}
