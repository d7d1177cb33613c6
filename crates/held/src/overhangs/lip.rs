//! Lips: what sticks out so little that it needs no support.
//!
//! ```text
//!        ┌─────────────┐
//!        │             └┐        The outermost line of a lip sticks to the line
//!        │              │ lip    beside it, which the layer below holds.
//!        │             ┌┘
//!        │             │
//! ```
//!
//! In: an area of a layer that the layer below does not hold, and the outlines
//! and heights of all layers. Out: whether that is a lip. A lip is no wider than the line of
//! an outer wall, wherever it is measured from: from the layers below it, and as
//! far as it goes on in the layers above. So a slope is no lip, although each of
//! its layers sticks out as little. A lip is held along its length: what begins on
//! nothing is none.
//!
//! What sticks out by up to two lines hangs without harm, and no warning names it.
//! But where supports are asked for, the underside of such a lip is better with a
//! support, and `isoslice info --supports` lists it.

use super::held::held;
use super::plan::OverhangPlan;
use glam::DVec2;
use isoslice_base::units::Mm;
use isoslice_layer::cover::neighbour::Neighbour;
use isoslice_planar::clip::{difference, intersection};
use isoslice_planar::grid::nearest_on;
use isoslice_planar::offset::offset;
use isoslice_planar::{Area, edges};
use isoslice_settings::layers::LayerSpan;

/// Tolerance of the offsets, mm.
const TOLERANCE: Mm = 0.02;
/// Number of points of an area's rim that are tried before the whole area is
/// compared, which takes longer.
const POINTS: usize = 8;
/// Content of a square's corner outside of a quarter of a circle, as a share of the
/// square of the radius. A lip has such a corner beyond what is as near as the
/// lip's width.
const CORNER: f64 = 1.0 - std::f64::consts::FRAC_PI_4;
/// Width of the seam between a lip and what holds it, mm.
const SEAM: Mm = 0.1;

/// The islands of `need` that are no lips. `need` is the part of layer `i` that the
/// layer below does not hold; `outlines` and `spans` are those of all layers.
pub(crate) fn without_lips(
    need: Area,
    i: usize,
    spans: &[LayerSpan],
    outlines: &[Neighbour<'_>],
    plan: &OverhangPlan,
) -> Area {
    if i == 0 || need.is_empty() {
        return need;
    }
    let islands = need.islands().into_iter();
    let rest = islands.filter(|area| !is_lip(area, i, spans, outlines, plan));
    rest.collect()
}

/// True if an island of layer `i` that the layer below does not hold is a lip.
fn is_lip(
    island: &Area,
    i: usize,
    spans: &[LayerSpan],
    outlines: &[Neighbour<'_>],
    plan: &OverhangPlan,
) -> bool {
    if isoslice_base::limits::is_stopped() {
        return false;
    }
    let lip = plan.walls.outer;
    // A slope of `support.angle` gets twice as far as a lip in this height.
    let height = 2.0 * lip / plan.slope(1.0).max(0.1);
    let bottom = spans[i].bottom;
    let lowest = spans.partition_point(|s| s.bottom < bottom - height);
    let highest = spans.partition_point(|s| s.bottom <= bottom + height);
    let layers = lowest.min(i - 1)..highest.max(i + 1);
    // The corner of a lip is as far away as its diagonal.
    let farthest = std::f64::consts::SQRT_2 * lip;
    let deep = outlines[layers.start]
        .within(island.bounds().grown(farthest + TOLERANCE));
    if !few_are_near(island, &deep, farthest) {
        return false;
    }
    let around = island.bounds().grown(2.0 * lip);
    let near = |k: usize| outlines[k].within(around);
    let reached = |k: usize| offset(&near(k), lip, TOLERANCE);
    let from_below = reached(i - 1);
    let beside = offset(island, lip, TOLERANCE);
    let lies_in = |area: &Area, reached: &Area| {
        let mut beyond = difference(area, reached).islands().into_iter();
        beyond.all(|piece| piece.content() <= CORNER * lip * lip)
    };
    let ends_here = |k: usize| {
        let above = intersection(&near(k), &beside);
        lies_in(&above, &from_below)
    };
    lies_in(island, &from_below)
        && (layers.start..i - 1).all(|k| lies_in(island, &reached(k)))
        && (i..layers.end).all(ends_here)
        && is_held(
            island,
            [i, i - 1].map(|k| &outlines[k]),
            held(spans[i].height(), plan),
            plan,
        )
}

/// True if [`POINTS`] points or so of an area's rim are within `reach` of another area.
fn few_are_near(area: &Area, other: &Area, reach: Mm) -> bool {
    let points = area.rings.iter().flatten();
    let every = points.clone().count().div_ceil(POINTS).max(1);
    let sides = || other.rings.iter().flat_map(|ring| edges(ring));
    let near = |p: DVec2| {
        other.contains(p)
            || sides().any(|(a, b)| nearest_on(p, a, b).distance(p) <= reach)
    };
    points.step_by(every).all(|&p| near(p))
}

/// True if an island of a layer lies along what the layer below holds, which
/// reaches as far as `held` beyond it: the island's length, by its content and the
/// width of a lip, is no more than that of the seam between both.
fn is_held(
    island: &Area,
    [here, below]: [&Neighbour<'_>; 2],
    held: Mm,
    plan: &OverhangPlan,
) -> bool {
    let seam = offset(island, SEAM, TOLERANCE);
    let around = seam.bounds().grown(held + 1.0);
    let [here, below] = [here, below].map(|layer| layer.within(around));
    let held = offset(&below, held, TOLERANCE);
    let seam = intersection(&intersection(&seam, &here), &held);
    island.content() * SEAM <= seam.content() * plan.walls.outer
}

#[cfg(test)]
mod tests {
    use super::*;
    use isoslice_planar::clip::union;
    use isoslice_planar::rect;
    use isoslice_settings::testing::usual_plan;

    /// What is left of `need` in the middle one of some layers.
    fn left(need: &Area, outlines: &[Area]) -> Area {
        let plan = usual_plan(OverhangPlan::of);
        let spans = LayerSpan::stack(0.2, outlines.len());
        let middle = outlines.len() / 2;
        let outlines: Vec<_> = outlines.iter().map(Neighbour::new).collect();
        without_lips(need.clone(), middle, &spans, &outlines, &plan)
    }

    /// Layers whose right side is at `x(k)` in the k-th layer above the middle
    /// one.
    fn wall(x: impl Fn(i32) -> f64) -> Vec<Area> {
        let layer = |k| rect(0.0, 0.0, 10.0 + x(k), 20.0);
        (-10..=10).map(layer).collect()
    }

    #[test]
    fn a_lip_of_one_line_needs_no_support_and_a_wider_one_does() {
        for (reach, needs) in
            [(0.35, false), (0.42, false), (0.5, true), (3.0, true)]
        {
            let outlines = wall(|k| if k < 0 { 0.0 } else { reach });
            let need = rect(10.3, 0.0, 10.0 + reach, 20.0);
            let left = left(&need, &outlines);
            assert_eq!(!left.is_empty(), needs, "{reach}");
        }
    }

    #[test]
    fn a_slope_is_no_lip_from_its_first_layer_to_its_last() {
        // Of 60 degrees, and of 75 degrees.
        for out in [0.346, 0.746] {
            for (from, to) in [(-4, 4), (0, 8), (-8, 0)] {
                let x = |k: i32| out * f64::from(k.clamp(from - 1, to));
                let outlines = wall(x);
                let need = rect(10.3 + x(-1), 0.0, 10.0 + x(0), 20.0);
                assert_eq!(left(&need, &outlines), need, "{out} {from}");
            }
        }
    }

    #[test]
    fn steps_that_follow_each_other_are_no_lips() {
        let x = |k: i32| 0.4 * f64::from((k + 10).div_euclid(2));
        let need = rect(10.3 + x(-1), 0.0, 10.0 + x(0), 20.0);
        assert_eq!(left(&need, &wall(x)), need);
        let x = |k: i32| 0.4 * f64::from((k + 10).div_euclid(5));
        let need = rect(10.3 + x(-1), 0.0, 10.0 + x(0), 20.0);
        assert!(left(&need, &wall(x)).is_empty());
    }

    #[test]
    fn what_is_not_held_along_its_length_is_no_lip() {
        let block = rect(0.0, 0.0, 10.0, 20.0);
        let of = |more: &Area| -> Vec<Area> {
            let here = union(&block, more);
            let of = |k: i32| if k < 0 { block.clone() } else { here.clone() };
            (-10..=10).map(of).collect()
        };
        // An island that begins on nothing beside a wall, and a tongue that
        // runs along the wall, 0.3 mm away from it.
        let island = rect(10.3, 5.0, 10.4, 15.0);
        assert_eq!(left(&island, &of(&island)), island);
        let root = rect(9.0, 5.0, 10.4, 5.5);
        let tongue = union(&island, &root);
        assert_eq!(left(&island, &of(&tongue)), island);
        // A finger that is as short as a lip.
        let finger = rect(9.0, 5.0, 10.4, 5.5);
        let need = rect(10.3, 5.0, 10.4, 5.5);
        assert!(left(&need, &of(&finger)).is_empty());
    }
}
