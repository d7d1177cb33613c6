//! Pads: supports on the bed below what begins right above it.
//!
//! ```text
//!        ╲      ╱
//!         ╲    ╱         the layers of a part that stands on its edge
//!       ┌──╲  ╱──┐       pad: a support in the first layer
//! ──────┴──────────┴──
//! ```
//!
//! A part that meets the bed in a point or in an edge is too thin for a line in
//! the first layer, so the layer above begins on nothing. A support with its gap
//! does not fit below that layer. Without a pad the part would stand on the air.
//! The pad ends right below the layer, or less than `support.z_gap` below it,
//! where layers are thin or that gap is no whole number of layers.
//!
//! In: what needs supports. Out: the area of pads in the first layer. It keeps
//! away from whatever else of the part is so near to the bed.

use super::TOLERANCE;
use super::parts::Parts;
use super::plan::SupportPlan;
use super::room::Size;
use isoslice_base::units::Mm;
use isoslice_layer::floating::floating;
use isoslice_planar::clip::{difference, intersection, union, unite};
use isoslice_planar::offset::offset;
use isoslice_planar::{Area, Solid};

/// Distance in the plane of a pad from what hangs over the bed beside it, mm.
const BESIDE: Mm = 0.05;

/// Where pads are. `needs` is what needs a support in each layer.
pub(super) fn pads(
    parts: Parts<'_>,
    needs: &[Area],
    plan: &SupportPlan,
) -> Area {
    let outlines = parts.outlines;
    let mut held = Area::EMPTY;
    // What sticks out over what begins below it is no obstacle.
    let mut others = Area::EMPTY;
    for i in parts.heights.low() {
        let begins = if needs[i].is_empty() {
            Area::EMPTY
        } else {
            begins(&outlines[i - 1], &outlines[i], &needs[i])
        };
        held = union(&held, &begins);
        let apart = outlines[i].islands().into_iter();
        let apart = apart.filter(|i| intersection(i, &held).is_empty());
        others.rings.extend(apart.flat_map(|island| island.rings));
    }
    if held.is_empty() {
        return held;
    }
    let apart = plan.xy_gap + TOLERANCE;
    let near = [(&outlines[0], apart), (&unite(&others), BESIDE)];
    // A pad is as wide as a post.
    let beyond = Size::new(plan).post;
    let all = offset(&held, beyond, TOLERANCE);
    near.into_iter().fold(all, |pad, (other, gap)| {
        difference(&pad, &offset(other, gap, TOLERANCE))
    })
}

/// The islands of a layer, some of which is needed, that begin on nothing.
fn begins(below: &Area, here: &Area, need: &Area) -> Area {
    let begun = floating(here, &Solid::new(below.clone())).into_iter();
    let begun = begun.map(|f| f.island);
    let needed = begun.filter(|i| !intersection(i, need).is_empty());
    needed.collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::support::heights::Heights;
    use isoslice_base::units::Mm2;
    use isoslice_planar::rect;
    use isoslice_settings::layers::LayerSpan;
    use isoslice_settings::testing::usual_plan;

    /// Content of the pads below a stack of layers, all of which need a support.
    fn pad(height: Mm, outlines: &[Area]) -> f64 {
        let plan = usual_plan(SupportPlan::of);
        let spans = LayerSpan::stack(height, outlines.len());
        let heights = Heights::new(spans, &plan);
        let parts = Parts::in_layers(&heights, outlines, &[]);
        pads(parts, outlines, &plan).content()
    }

    /// Content of what lies within reach of the pad of a rectangle.
    fn around(wide: Mm, high: Mm) -> Mm2 {
        let beyond = Size::new(&usual_plan(SupportPlan::of)).post;
        let round = std::f64::consts::PI * beyond * beyond;
        wide * high + 2.0 * (wide + high) * beyond + round
    }

    #[test]
    fn a_pad_holds_what_begins_too_near_to_the_bed_for_a_gap() {
        let (none, edge) = (Area::EMPTY, rect(0.0, 0.0, 10.0, 0.4));
        let found = pad(0.2, &[none.clone(), edge.clone(), edge.clone()]);
        let exact = around(10.0, 0.4);
        assert!((found - exact).abs() < 0.05, "{found} {exact}");
        // The gap fits below the layer above.
        assert_eq!(pad(0.2, &[none.clone(), none.clone(), edge.clone()]), 0.0);
        // In thinner layers the gap fits neither below the edge nor below what
        // sticks out above it.
        let wider = rect(-0.3, -0.3, 10.3, 0.7);
        let layers = [none.clone(), none.clone(), edge.clone(), wider];
        let found = pad(0.1, &layers);
        assert!((found - exact).abs() < 0.05, "{found} {exact}");
        // What stands on the bed, or sticks out over that, needs no pad.
        let wide = rect(0.0, 0.0, 10.0, 3.0);
        assert_eq!(pad(0.2, &[edge, wide.clone(), wide]), 0.0);
    }

    #[test]
    fn a_pad_keeps_away_from_what_else_is_near_to_the_bed() {
        let plan = usual_plan(SupportPlan::of);
        let edge = rect(0.0, 0.0, 10.0, 0.4);
        // The space between the edge and what is beside it, and half a pad.
        let rest = |space: Mm| {
            let beyond = Size::new(&plan).post;
            let half = 0.5 * (around(10.0, 0.4) - 0.4 * (10.0 + 2.0 * beyond));
            half + (10.0 + 2.0 * beyond) * (0.4 + space)
        };
        // A block on the bed, and one that leans over the bed.
        let gap = plan.xy_gap + TOLERANCE;
        let block = rect(-9.0, 0.4 + gap + 0.2, 19.0, 5.0);
        let both = union(&edge, &block);
        let found = pad(0.2, &[block.clone(), both.clone(), both.clone()]);
        let exact = rest(0.2);
        assert!((found - exact).abs() < 0.05, "{found} {exact}");
        let leans = rect(-9.0, 3.0, 19.0, 5.0);
        let over = rect(-9.0, 0.7, 19.0, 5.0);
        let both = union(&edge, &over);
        let found = pad(0.2, &[leans, both.clone(), both]);
        let exact = rest(0.3 - BESIDE);
        assert!((found - exact).abs() < 0.05, "{found} {exact}");
    }
}
