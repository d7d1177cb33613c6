//! Leaves out islands of support that rest on nothing.
//!
//! In: the islands of support in each layer. Out: those that stay. An island
//! stays if it rests on an island below it that stays, or, where supports may
//! stand there, on the part. So no support begins in the air.
//!
//! ```text
//!       ▒▒▒▒▒▒▒
//!       ▒▒▒▒         The lowest layer of a support on a slope is only above the
//!     ┌──────        highest step: all of it is `support.z_gap_bottom` above the
//!     │    └──       part, and the next layers hang over the lower steps.
//! ```
//!
//! So it is where that step is wide enough to stand on, and carries all that lies
//! on the island. What the next layer of supports does not cover stays, since it
//! may be right below a face of the part.

use super::parts::Parts;
use super::pieces::SupportIsland;
use super::plan::SupportPlan;
use super::room::BESIDE;
use super::slice::Slice;
use super::{SPECK, TOLERANCE};
use glam::DVec2;
use isoslice_base::units::Mm2;
use isoslice_layer::cover::neighbour::Neighbour;
use isoslice_planar::clip::{crop, difference, intersection, union, unite};
use isoslice_planar::offset::offset;
use isoslice_planar::opening::is_wider;
use isoslice_planar::{Area, Rect, Ring};

/// Least part of an island that has to rest on something: this share of the
/// island, or this area if that is less.
const REST: (f64, Mm2) = (0.1, 0.3);
/// Least part of an island that has to be above the highest step of a slope if
/// that step is to carry the island alone.
const ON_HIGHEST_STEP: f64 = 1.0 / 3.0;
/// Number of points at which two areas are compared.
const POINTS: u32 = 24;
/// Points are spread by these shares of a box from one to the next, so that no
/// row of them lies along a side (Roberts 2018, the sequence R2).
const SPREAD: DVec2 = DVec2::new(0.754_877_666, 0.569_840_291);

/// The supports of each layer: the islands that rest on something.
pub(super) fn settled(
    parts: Parts<'_>,
    mut layers: Vec<Vec<SupportIsland>>,
    plan: &SupportPlan,
) -> Vec<Slice> {
    let mut slices = Vec::with_capacity(layers.len());
    // The supports in the layer below. There is no such layer below the first
    // one that can have supports.
    let mut below: Option<Vec<SupportIsland>> = None;
    for j in 0..layers.len() {
        if isoslice_base::limits::is_stopped() {
            slices.push(Slice::default());
            continue;
        }
        let pieces = std::mem::take(&mut layers[j]);
        let mut slice = Slice::default();
        if parts.heights.span(j).is_none() {
            slices.push(slice);
            continue;
        }
        let on_support = |piece: &SupportIsland| {
            below.as_ref().is_none_or(|below| {
                let near =
                    below.iter().filter(|b| b.bounds.meets(piece.bounds));
                rests_on(piece.all(), near.flat_map(|b| &b.all().rings))
            })
        };
        let close = parts.heights.stands_close(j);
        let close = close.map(|on| Neighbour::new(&parts.outlines[on]));
        let apart = |piece: SupportIsland| match &close {
            Some(on) if on_support(&piece) => without_close(piece, on),
            _ => vec![piece],
        };
        let mut stays = Vec::with_capacity(pieces.len());
        for mut piece in pieces.into_iter().flat_map(apart) {
            if !on_support(&piece) {
                // Supports from the plate do not stand on the part.
                if !plan.on_part || !stands(piece.all(), j, parts) {
                    continue;
                }
                let mut higher = j + 1..layers.len();
                let next = higher.find(|&k| parts.heights.span(k).is_some());
                let above = next.map_or(&[][..], |k| &layers[k]);
                if let Some(step) = on_step(&piece, j, above, parts, plan) {
                    piece = step;
                }
                let deeper = parts.heights.deeper(j);
                if deeper != 0.0 {
                    slice.deeper = deeper;
                    slice.standing.rings.extend_from_slice(&piece.all().rings);
                }
            }
            slice.body.rings.extend_from_slice(&piece.body.rings);
            slice
                .interface
                .rings
                .extend_from_slice(&piece.interface.rings);
            stays.push(piece);
        }
        below = Some(stays);
        slices.push(slice);
    }
    slices
}

/// A piece that rests on supports, parted from what lies over `close`, a layer of the
/// part that is too near below for beads of the usual height.
fn without_close(
    piece: SupportIsland,
    close: &Neighbour<'_>,
) -> Vec<SupportIsland> {
    let near = close.within(piece.bounds.grown(2.0 * BESIDE));
    if near.is_empty() {
        return vec![piece];
    }
    let close = offset(&near, BESIDE, TOLERANCE);
    let [over, rest] = [intersection, difference].map(|of| {
        let islands = of(piece.all(), &close).islands().into_iter();
        islands.filter(|i| i.content() > SPECK).collect::<Vec<_>>()
    });
    let all = over.iter().chain(&rest);
    all.map(|island| piece.within(island)).collect()
}

/// True if an island of support in layer `j` has enough of the part below it to
/// stand on.
pub(super) fn stands(island: &Area, j: usize, parts: Parts<'_>) -> bool {
    // The layers right below may lie in the gap between support and part.
    let mut below = parts.heights.gap_below(j);
    below.any(|k| rests_on(island, &parts.outlines[k].rings))
}

/// An island of layer `j`, which stands on the part, without what is above the
/// lower steps of the part and below `above`, the islands of the next layer; nothing
/// if it stays whole: if nothing is to be left out, or the highest step is too
/// little to stand on, or does not carry alone what lies on the island.
fn on_step(
    piece: &SupportIsland,
    j: usize,
    above: &[SupportIsland],
    parts: Parts<'_>,
    plan: &SupportPlan,
) -> Option<SupportIsland> {
    let all = piece.all();
    let on = &parts.outlines[parts.heights.stands_on(j)?];
    let over = intersection(all, &unite(&crop(&on.rings, piece.bounds)));
    let thinnest = plan.overhangs.thinnest;
    let wide = |island: &Area| is_wider(island, thinnest, TOLERANCE);
    let step: Area = over.islands().into_iter().filter(wide).collect();
    if step.content() <= least(all).max(ON_HIGHEST_STEP * all.content()) {
        return None;
    }
    let above = above.iter().filter(|a| a.bounds.meets(piece.bounds));
    let carried = |above: &Area| {
        rests_on(above, &step.rings)
            || intersection(above, all).content() <= SPECK
    };
    if !above.clone().all(|above| carried(above.all())) {
        return None;
    }
    let above = unite(&crop(above.flat_map(|a| &a.all().rings), piece.bounds));
    // Of a post that leans, each layer reaches a little beyond the next one. No line
    // fits in there, and no face is near.
    let rest = difference(all, &above).islands().into_iter();
    let rest = rest.filter(|rest| {
        wide(rest) || intersection(rest, &piece.interface).content() > SPECK
    });
    let kept = union(&step, &rest.collect());
    // What is left beside the step must not begin in the air.
    let held = |island: &Area| {
        rests_on(island, &step.rings) || stands(island, j, parts)
    };
    let cut = all.content() - kept.content() > SPECK;
    (cut && kept.islands().iter().all(held)).then(|| piece.within(&kept))
}

/// True if enough of an island lies on an area of these rings.
fn rests_on<'a>(
    island: &Area,
    rings: impl IntoIterator<Item = &'a Ring>,
) -> bool {
    let bounds = island.bounds();
    let under = crop(rings, bounds);
    if under.is_empty() {
        return false;
    }
    let least = least(island);
    // A few points mostly decide, and take much less time.
    common(island, &under, bounds) > 2.0 * least
        || intersection(island, &under).content() >= least
}

/// The least part of an island that has to rest on something.
fn least(island: &Area) -> Mm2 {
    (REST.0 * island.content()).min(REST.1)
}

/// Estimates how much two areas have in common within a box, by points spread
/// over it.
fn common(a: &Area, b: &Area, within: Rect) -> Mm2 {
    let size = within.size();
    let at = |k: u32| within.min + (f64::from(k) * SPREAD).fract() * size;
    let points = (1..=POINTS).map(at);
    let both = points.filter(|&p| a.contains(p) && b.contains(p)).count();
    // One point or two in both areas say too little about the content.
    if both < 3 {
        return 0.0;
    }
    size.element_product() * both as f64 / f64::from(POINTS)
}

#[cfg(test)]
mod tests {
    use super::super::heights::Heights;
    use super::super::pieces::pieces;
    use super::*;
    use isoslice_planar::rect;
    use isoslice_settings::Supports;
    use isoslice_settings::layers::LayerSpan;
    use isoslice_settings::testing::plan_with;

    #[test]
    fn an_island_rests_on_a_tenth_of_itself_or_a_third_of_a_square_millimetre()
    {
        let rests = |island: &Area, on: &Area| {
            let by_points = common(island, on, island.bounds());
            (rests_on(island, &on.rings), by_points > 0.0)
        };
        let post = rect(0.0, 0.0, 1.0, 1.0);
        assert_eq!(rests(&post, &post), (true, true));
        let strip = |by: f64| rect(1.0 - by, -1.0, 2.0, 2.0);
        assert_eq!(rests(&post, &strip(0.11)), (true, false));
        assert_eq!(rests(&post, &strip(0.09)), (false, false));
        let roof = rect(0.0, 0.0, 20.0, 20.0);
        // A rib of 0.01 mm along all of a roof is 0.2 mm².
        for y in 0..200 {
            let y = 0.1 * f64::from(y) + 0.003;
            let rib = rect(-1.0, y, 21.0, y + 0.01);
            assert_eq!(rests(&roof, &rib), (false, false), "{y}");
        }
        assert_eq!(rests(&roof, &rect(19.0, 19.0, 20.0, 19.4)), (true, false));
        assert!(!rests(&roof, &Area::EMPTY).0);
    }

    #[test]
    fn thin_beads_stand_on_the_part_beside_supports_that_go_on_down() {
        let plan = plan_with(SupportPlan::of, |s| s.supports = Supports::Auto);
        // A block of three layers of 0.3 mm ends at x = 0. A support of 4 mm, half
        // over the block, begins in layer 4, 0.1 mm above it. The gap is 0.2 mm.
        let heights = Heights::new(LayerSpan::stack(0.3, 8), &plan);
        assert_eq!(heights.stands_close(4), Some(2));
        let block = |k: usize| match k {
            0..3 => rect(-9.0, -9.0, 0.0, 9.0),
            _ => Area::EMPTY,
        };
        let outlines: Vec<Area> = (0..8).map(block).collect();
        let none = vec![Area::EMPTY; 8];
        let parts = Parts::in_layers(&heights, &outlines, &none);
        let of = |j: usize| match j {
            0..4 => rect(0.5, -2.0, 2.0, 2.0),
            4 | 5 => rect(-2.0, -2.0, 2.0, 2.0),
            _ => Area::EMPTY,
        };
        let areas = (0..8).map(of).collect();
        let all = pieces(parts, &none, areas, &Area::EMPTY, &plan);
        let slices = settled(parts, all.clone(), &plan);
        let [lower, upper] = [&slices[4], &slices[5]];
        assert!((lower.deeper + 0.1).abs() < 1e-9, "{}", lower.deeper);
        let standing = lower.standing.content();
        assert!((standing - 8.0).abs() < 0.01, "{standing}");
        let beside = 4.0 * (2.0 - BESIDE);
        assert!((lower.area().content() - 8.0 - beside).abs() < 0.02);
        // Supports from the plate keep off the block.
        let plate =
            plan_with(SupportPlan::of, |s| s.supports = Supports::Plate);
        let lower = settled(parts, all, &plate)[4].area();
        assert!((lower.content() - beside).abs() < 0.01);
        assert!(upper.standing.is_empty() && upper.deeper == 0.0);
    }

    #[test]
    fn the_lowest_layer_on_a_slope_is_above_the_highest_step_alone() {
        let plan = plan_with(SupportPlan::of, |s| s.supports = Supports::Auto);
        let heights = Heights::new(LayerSpan::stack(0.2, 8), &plan);
        // Steps of 0.4 mm. A support in layer 4 stands on layer 2, which ends
        // at x = 0.
        let step = |k: i32| rect(-9.0, -9.0, 0.4 * f64::from(2 - k), 9.0);
        let outlines: Vec<Area> = (0..8).map(step).collect();
        let none = vec![Area::EMPTY; 8];
        let parts = Parts::in_layers(&heights, &outlines, &none);
        assert_eq!(heights.stands_on(4), Some(2));
        // Layers 4 and on have supports; layer 5 has only those in `next`, and the
        // layers above it none if that is empty.
        let settled_below = |post: &Area, next: &Area| -> Vec<f64> {
            let of = |j: usize| match j {
                4 => post.clone(),
                5 => next.clone(),
                6.. if !next.is_empty() => post.clone(),
                _ => Area::EMPTY,
            };
            let areas = (0..8).map(of).collect();
            let pads = Area::EMPTY;
            let all = pieces(parts, &none, areas, &pads, &plan);
            let slices = super::settled(parts, all, &plan).into_iter();
            slices.map(|slice| slice.area().content()).collect()
        };
        let post = |x: f64| rect(x, -0.6, x + 1.2, 0.6);
        let settled = |x: f64| settled_below(&post(x), &post(x));
        let near = |found: &[f64], wanted: [f64; 3]| {
            let pairs = found[3..6].iter().zip(wanted);
            let far = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(far < 1e-3, "{found:?} {wanted:?}");
        };
        near(&settled(-0.6), [0.0, 0.72, 1.44]);
        // All of it is above that step, or too little for a line.
        near(&settled(-1.3), [0.0, 1.44, 1.44]);
        near(&settled(-0.15), [0.0, 1.44, 1.44]);
        // Nothing to stand on.
        near(&settled(0.0), [0.0, 0.0, 0.0]);
        // That step carries a third of the island, or less.
        near(&settled(-0.42), [0.0, 0.504, 1.44]);
        near(&settled(-0.38), [0.0, 1.44, 1.44]);
        // A face is right above all of the layer, or above a corner of it.
        let below = |next: &Area| settled_below(&post(-0.6), next);
        near(&below(&Area::EMPTY), [0.0, 1.44, 0.0]);
        near(&below(&rect(-0.6, -0.6, 0.6, 0.2)), [0.0, 0.96, 0.96]);
        // The post leans.
        near(&below(&rect(-0.7, -0.6, 0.5, 0.6)), [0.0, 0.72, 1.44]);
        // The face covers so much of the layer that the rest of it would begin
        // in the air.
        near(&below(&rect(-0.6, -0.6, 0.3, 0.6)), [0.0, 1.44, 1.08]);
        // An island above lies beside the step, on what would be left out.
        near(&below(&rect(0.1, -0.6, 0.6, 0.6)), [0.0, 1.44, 0.6]);
    }
}
