//! The areas of support of all layers.

use super::TOLERANCE;
use super::cavity::{Enclosed, enclosed};
use super::heights::Heights;
use super::need::Need;
use super::pad::pads;
use super::parts::Parts;
use super::pieces::pieces;
use super::plan::SupportPlan;
use super::room::Room;
use super::settle::settled;
use super::slice::Slice;
use super::survey::{Asked, Found, Survey};
use super::tree::grow;
use crate::overhangs::{OverhangPlan, without_lips};
use glam::DVec3;
use isoslice_base::parallel;
use isoslice_base::units::{Mm, Mm2};
use isoslice_layer::cover::neighbour::Neighbour;
use isoslice_planar::clip::{difference, intersection, union, unite};
use isoslice_planar::clusters::clusters;
use isoslice_planar::offset::offset;
use isoslice_planar::{Area, Rect};

/// A face needs no support if no gap fits below it and it is no higher above the
/// bed than this, mm.
const OVER_BED: Mm = 0.5;

/// Areas that need a support and do not get one.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Unheld {
    /// Content of these areas.
    pub area: Mm2,
    /// A point of the largest of these areas, in the model's plane, and its
    /// height above the bed.
    pub worst: DVec3,
    largest: Mm2,
}

/// The support of a part.
#[derive(Clone, Debug, Default)]
pub struct Plan {
    slices: Vec<Slice>,
    /// What in the first layer holds what begins less than a gap above it.
    pads: Area,
    /// The heights of its layers.
    pub heights: Heights,
    /// What needs a support and has none.
    pub unheld: Unheld,
    /// Areas that get no support although wishes ask for one. They do not need
    /// one otherwise.
    pub unmet: Unheld,
    /// Supports that nobody can take out.
    pub enclosed: Enclosed,
    /// True if there are wishes, and none is for an underside of the part.
    pub idle: bool,
    /// True if something needs a support, and wishes forbid all of it.
    pub forbidden: bool,
}

impl Plan {
    /// The plan for what a survey of all of a part's layers has found.
    /// `sections` is the part at the middle of each layer of supports, if that
    /// is not the middle of the part's layer. `bed` is in the model's
    /// coordinates.
    pub fn new(
        mut survey: Survey,
        sections: Option<Vec<Area>>,
        heights: Heights,
        bed: Rect,
        asked: Asked<'_>,
    ) -> Plan {
        let (wished, to) = (asked.wishes.is_some(), asked.plan);
        let idle = wished && !survey.found.iter().any(|found| found.wished);
        let forbidden = survey.found.iter().any(|found| found.forbidden);
        let found = std::mem::take(&mut survey.found);
        let Survey {
            outlines,
            unprinted: ends,
            ..
        } = survey;
        let parts = Parts {
            heights: &heights,
            outlines: &outlines,
            ends: &ends,
            sections: sections.as_ref().unwrap_or(&outlines),
            bed,
        };
        let [needs, musts] = needs(found, parts, &to.overhangs);
        let Some(highest) = needs.iter().rposition(|n| !n.is_empty()) else {
            return Plan {
                idle,
                forbidden,
                ..Plan::default()
            };
        };
        let room = Room::new(parts, highest, to);
        let mut areas = grow(parts, &needs, room, highest, to);
        let pads = pads(parts, &needs, to);
        if !pads.is_empty() {
            areas.resize(areas.len().max(1), Area::EMPTY);
            areas[0] = union(&areas[0], &pads);
        }
        let pieces = pieces(parts, &needs, areas, &pads, to);
        let slices = settled(parts, pieces, to);
        let lowest = slices.first().map_or(Area::EMPTY, Slice::area);
        let mut plan = Plan {
            pads: if pads.is_empty() {
                pads
            } else {
                intersection(&pads, &lowest)
            },
            slices,
            idle,
            ..Plan::default()
        };
        plan.enclosed = enclosed(parts, &plan.slices);
        plan.unheld = plan.without(parts, &musts, to);
        if wished {
            let wanted = |i: usize| difference(&needs[i], &musts[i]);
            let wanted = parallel::map(needs.len(), wanted);
            plan.unmet = plan.without(parts, &wanted, to);
        }
        plan.heights = heights;
        plan
    }

    /// The support in a layer, if there is any.
    pub fn slice(&self, layer: usize) -> Option<&Slice> {
        self.slices.get(layer).filter(|slice| !slice.is_empty())
    }

    /// What in the first layer holds what begins less than a gap above it.
    pub fn pads(&self) -> &Area {
        &self.pads
    }

    /// The area of the supports that hold a layer. Their tops are a gap below it,
    /// except for pads.
    pub fn under(&self, layer: usize) -> Option<Area> {
        match self.heights.below(layer) {
            Some(below) => self.slice(below).map(Slice::area),
            None if self.pads.is_empty() => None,
            None => {
                let is_low = self.heights.low().contains(&layer);
                is_low.then(|| self.pads.clone())
            }
        }
    }

    /// The part of `needs` that has no support.
    fn without(
        &self,
        parts: Parts<'_>,
        needs: &[Area],
        plan: &SupportPlan,
    ) -> Unheld {
        // A support also holds what is nearer to its side than this. Over a wide
        // gap beside the part, lines from the part to the support are bridges.
        let beside = plan.xy_gap.min(0.5 * plan.overhangs.bridge_max);
        let near = beside + plan.overhangs.walls.outer;
        let lost = parallel::map(needs.len(), |i| {
            let need = &needs[i];
            if need.is_empty() {
                return Area::EMPTY;
            }
            let top = parts.heights.below(i);
            // The bed holds what is right above it.
            if top.is_none() && parts.spans()[i].bottom < OVER_BED {
                return Area::EMPTY;
            }
            let here: Area = match top.map(|top| self.slice(top)) {
                Some(Some(slice)) => {
                    let all = [&slice.body, &slice.interface].into_iter();
                    all.flat_map(|area| &area.rings).cloned().collect()
                }
                None if parts.heights.low().contains(&i) => self.pads.clone(),
                _ => return need.clone(),
            };
            let here = Neighbour::new(&here);
            let lost = clusters(need).into_iter().map(|need| {
                let around = need.bounds.grown(near + TOLERANCE);
                let held = unite(&here.within(around));
                // This difference costs less than the offset below, and mostly
                // leaves nothing to look at.
                let beside = difference(&need.area, &held);
                if beside.is_empty() {
                    return beside;
                }
                difference(&beside, &offset(&held, near, TOLERANCE))
            });
            lost.collect()
        });
        let mut unheld = Unheld::default();
        for (i, area) in lost.into_iter().enumerate() {
            for island in area.islands() {
                let content = island.content();
                unheld.area += content;
                let at = island.rings.first().and_then(|r| r.first());
                if let Some(at) = at
                    && content > unheld.largest
                {
                    unheld.largest = content;
                    unheld.worst = at.extend(parts.spans()[i].bottom);
                }
            }
        }
        unheld
    }
}

/// By layer, what gets a support, and the outlines of the layers.
pub fn held(
    mut survey: Survey,
    heights: &Heights,
    plan: &OverhangPlan,
) -> [Vec<Area>; 2] {
    let found = std::mem::take(&mut survey.found);
    let parts = Parts {
        heights,
        outlines: &survey.outlines,
        ends: &survey.unprinted,
        sections: &survey.outlines,
        bed: Rect::EMPTY,
    };
    let [needs, _] = needs(found, parts, plan);
    [needs, survey.outlines]
}

/// By layer, what gets a support, and what of it needs one.
fn needs(
    found: Vec<Found>,
    parts: Parts<'_>,
    plan: &OverhangPlan,
) -> [Vec<Area>; 2] {
    let neighbour = |i: usize| Neighbour::new(&parts.outlines[i]);
    let outlines = parallel::map(parts.outlines.len(), neighbour);
    let of_layer = |i: usize, found: Found| {
        let Need { must, wanted } = found.need;
        let must = without_lips(must, i, parts.spans(), &outlines, plan);
        (union(&must, &wanted), must)
    };
    let layers = parallel::map_owned(found, of_layer);
    let (needs, musts) = layers.into_iter().unzip();
    [needs, musts]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::support::Disc;
    use glam::DVec2;
    use isoslice_planar::clip::intersection;
    use isoslice_planar::rect;
    use isoslice_settings::Supports;
    use isoslice_settings::layers::LayerSpan;
    use isoslice_settings::testing::{plan_with, usual_plan};

    fn spans(count: usize) -> Vec<LayerSpan> {
        LayerSpan::stack(0.2, count)
    }

    /// A T: a stem of 8 mm, and from 10 mm on arms of 20 mm on both sides.
    fn tee() -> Vec<Area> {
        let stem = rect(-4.0, -6.0, 4.0, 6.0);
        let arms = rect(-24.0, -6.0, 24.0, 6.0);
        let of = |i| if i < 50 { stem.clone() } else { arms.clone() };
        (0..60).map(of).collect()
    }

    fn asking(supports: Supports) -> SupportPlan {
        plan_with(SupportPlan::of, |s| s.supports = supports)
    }

    fn plan(outlines: &[Area], supports: Supports) -> Plan {
        planned(outlines, spans(outlines.len()), &asking(supports))
    }

    /// The plan for layers of some heights.
    fn planned(
        outlines: &[Area],
        spans: Vec<LayerSpan>,
        plan: &SupportPlan,
    ) -> Plan {
        let asked = Asked { wishes: None, plan };
        let layers = spans.iter().copied().zip(outlines);
        let survey = Survey::new(layers, asked).unwrap();
        let bed = Rect::new(DVec2::splat(-100.0), DVec2::splat(100.0));
        let heights = Heights::new(spans, plan);
        Plan::new(survey, None, heights, bed, asked)
    }

    fn all(plan: &Plan, layer: usize) -> Area {
        plan.slice(layer).map_or(Area::EMPTY, Slice::area)
    }

    #[test]
    fn a_tee_is_held_with_its_gaps_down_to_the_bed() {
        let outlines = tee();
        let plan = plan(&outlines, Supports::Auto);
        assert_eq!(plan.unheld.area, 0.0);
        // The arms begin at 10 mm; the gap is 0.2 mm, the layer below it.
        assert!(all(&plan, 49).is_empty());
        let top = all(&plan, 48);
        let under = intersection(&top, &outlines[50]).content();
        let arms = 2.0 * (20.0 - 0.35) * 12.0;
        assert!((under - arms).abs() < 0.02 * arms, "{under} of {arms}");
        for (j, outline) in outlines.iter().enumerate().take(49) {
            let here = all(&plan, j);
            assert!(!here.is_empty(), "layer {j}");
            let near = offset(outline, 0.35, 1e-3);
            assert_eq!(intersection(&here, &near).content(), 0.0);
        }
        // It comes down to a post under each arm.
        assert!(all(&plan, 0).content() < 0.15 * top.content());
    }

    /// The layers of a body whose half is as wide as `x(z)` says.
    fn body(x: impl Fn(Mm) -> Mm, spans: &[LayerSpan]) -> Vec<Area> {
        let layer = |span: &LayerSpan| match x(span.sample_z()) {
            x if x > 0.0 => rect(-x, -10.0, x, 10.0),
            _ => Area::EMPTY,
        };
        spans.iter().map(layer).collect()
    }

    #[test]
    fn a_roof_ends_within_half_a_line_beyond_what_needs_it() {
        // A cylinder of 16 mm that lies 12 mm above the bed.
        let x = |z: Mm| (64.0 - (z - 20.0).powi(2)).max(0.0).sqrt();
        let spans = spans(140);
        let outlines = body(x, &spans);
        let plan = plan(&outlines, Supports::Auto);
        let held = crate::overhangs::held(0.2, &usual_plan(OverhangPlan::of));
        let leans = spans.windows(2).filter_map(|pair| {
            let [below, here] = [0, 1].map(|k| x(pair[k].sample_z()));
            (here - below > held).then_some(here)
        });
        let needs = leans.fold(0.0, f64::max);
        assert!((4.0..5.0).contains(&needs), "{needs}");
        let layers = (0..140).map(|j| all(&plan, j));
        let layers = layers.filter(|area| !area.is_empty());
        let wide = layers.map(|area| area.bounds().max.x).fold(0.0, f64::max);
        let beyond = wide - needs;
        let half = 0.5 * usual_plan(SupportPlan::of).width;
        assert!((0.0..half + 0.05).contains(&beyond), "{beyond}");
    }

    #[test]
    fn a_roof_is_wider_only_where_the_part_is_in_its_way() {
        let plan = plan(&tee(), Supports::Auto);
        let top = all(&plan, 48);
        let beyond = |from: Mm, to: Mm| {
            let here = rect(from, -9.0, to, 9.0);
            intersection(&top, &here).bounds().max.y - 6.0
        };
        let size = super::super::room::Size::new(&usual_plan(SupportPlan::of));
        let [near, far] = [beyond(4.4, 4.8), beyond(12.0, 20.0)];
        assert!((near - size.post).abs() < 0.05, "{near}");
        assert!((far - size.beyond).abs() < 0.05, "{far}");
    }

    /// The layers of a wedge that stands on its edge, which is in the layer
    /// `first`.
    fn wedge(first: usize) -> impl Fn(usize) -> Area {
        move |i| match i.checked_sub(first) {
            Some(k) => {
                let half = 0.1 * (k as Mm + 0.5);
                rect(-8.0, -half, 8.0, half)
            }
            None => Area::EMPTY,
        }
    }

    #[test]
    fn supports_of_an_edge_leave_out_what_is_too_thin_to_be_printed() {
        let of = wedge(30);
        let outlines: Vec<Area> = (0..50).map(&of).collect();
        let plan = plan(&outlines, Supports::Auto);
        assert_eq!(plan.unheld.area, 0.0);
        // The first line fits into layer 31. Its support is in layer 29, and
        // nothing of the part is there.
        let roof = all(&plan, 29);
        assert!(roof.contains(DVec2::ZERO) && all(&plan, 30).is_empty());
        // A line that is wider begins two layers above the edge.
        let wide = plan_with(SupportPlan::of, |s| {
            s.supports = Supports::Auto;
            s.thin_min = 100.0;
            s.outer_wall_width = 1.0.into();
        });
        let plan = planned(&outlines, spans(50), &wide);
        let roof = all(&plan, 30);
        let edge = offset(&of(30), 0.1, 1e-3);
        assert!(intersection(&roof, &edge).is_empty());
        for side in [-1.0, 1.0] {
            let beside = rect(-8.0, 0.2 * side - 0.02, 8.0, 0.2 * side + 0.02);
            let held = intersection(&roof, &beside).content();
            assert!(held > 0.95 * beside.content(), "{held}");
        }
    }

    #[test]
    fn an_edge_on_the_bed_stands_on_a_pad_that_is_not_in_the_part() {
        let of = wedge(0);
        let outlines: Vec<Area> = (0..20).map(&of).collect();
        for supports in [Supports::Auto, Supports::Plate] {
            let plan = plan(&outlines, supports);
            assert_eq!(plan.unheld.area, 0.0);
            let pad = all(&plan, 0);
            assert!(intersection(&pad, &of(0)).is_empty());
            // The line in the layer above lies on both sides of the edge.
            let under = intersection(&pad, &of(1)).content();
            let exact = 16.0 * (0.3 - 0.1 - 2.0 * 0.05);
            assert!((under - exact).abs() < 0.1, "{under}");
            assert!(plan.under(1).is_some() && all(&plan, 1).is_empty());
            assert!(plan.under(0).is_none());
        }
    }

    #[test]
    fn steep_faces_of_thin_layers_are_held() {
        let spans = LayerSpan::stack(0.1, 100);
        for lean in [1.7, 2.0] {
            let x = |z: Mm| 5.0 + lean * z;
            let outlines = body(x, &spans);
            let auto = asking(Supports::Auto);
            let plan = planned(&outlines, spans.clone(), &auto);
            for (i, span) in spans.iter().enumerate().skip(10) {
                let [from, to] = [0.1, 0.0].map(|d| x(span.sample_z() - d));
                let below = plan.heights.below(i).unwrap();
                let face = rect(from, -9.0, to, 9.0);
                let held = intersection(&all(&plan, below), &face);
                assert!(held.content() > 0.0, "{lean}: {i}");
            }
        }
    }

    #[test]
    fn every_island_of_support_rests_on_support_or_part() {
        // A plate under one of the arms.
        let mut outlines = tee();
        for outline in &mut outlines[20..25] {
            *outline = union(outline, &rect(3.0, -12.0, 32.0, 12.0));
        }
        for (supports, lands) in
            [(Supports::Auto, true), (Supports::Plate, false)]
        {
            let plan = plan(&outlines, supports);
            let mut landed = false;
            for j in 1..49 {
                for island in all(&plan, j).islands() {
                    let below = all(&plan, j - 1);
                    let on = intersection(&island, &below).content() > 0.01;
                    let part =
                        intersection(&island, &outlines[j.saturating_sub(2)]);
                    let stands = part.content() > 0.01;
                    assert!(on || stands, "{supports:?}, layer {j}");
                    landed |= !on;
                }
            }
            assert_eq!(landed, lands, "{supports:?}");
        }
    }

    #[test]
    fn what_cannot_be_reached_is_told_of() {
        let mut outlines = tee();
        for outline in &mut outlines[20..22] {
            *outline = rect(-40.0, -20.0, 40.0, 20.0);
        }
        let plan = plan(&outlines, Supports::Plate);
        // The arms, over a plate that is wider than they are.
        assert!(plan.unheld.area > 400.0, "{:?}", plan.unheld);
        assert!((plan.unheld.worst.z - 10.0).abs() < 1e-9);
    }

    #[test]
    fn a_point_in_the_air_is_held_where_its_first_bead_is() {
        // A pyramid that hangs with its tip down, 0.1 mm wider in every layer.
        let tip = |i: usize| match i.checked_sub(30) {
            Some(k) if k > 0 => {
                let half = 0.05 * k as f64;
                rect(-half, -half, half, half)
            }
            _ => Area::EMPTY,
        };
        let outlines: Vec<Area> = (0..50).map(tip).collect();
        let plan = plan(&outlines, Supports::Auto);
        // A line of 0.27 mm fits where it is 0.3 mm wide, in layer 33.
        assert!(all(&plan, 32).is_empty());
        for j in 0..31 {
            assert!(all(&plan, j).contains(DVec2::ZERO), "layer {j}");
        }
        // The tip in layer 31 has no room for a line, nor for the support.
        let top = all(&plan, 31);
        assert!(intersection(&top, &tip(31)).is_empty());
        assert!(top.contains(DVec2::new(0.4, 0.0)));
        assert_eq!(plan.unheld.area, 0.0);
    }

    #[test]
    fn branches_have_no_neck_thinner_than_their_posts() {
        // A lid of 14 mm on a side, 14 mm above the bed, beside a column. On its
        // way down the branch under it is a cross of four thin arms.
        let lid = rect(10.0, -7.0, 24.0, 7.0);
        let column = rect(0.0, -2.0, 4.0, 2.0);
        let of = |i| match i {
            0..70 => column.clone(),
            _ => union(&column, &lid),
        };
        let outlines: Vec<Area> = (0..72).map(of).collect();
        let plan = plan(&outlines, Supports::Auto);
        for j in 0..68 {
            let content = all(&plan, j).content();
            // A thirtieth of what it holds, as a polygon in a circle.
            assert!(content > 0.9 * 14.0 * 14.0 / 30.0, "{j}: {content}");
        }
    }

    /// Islands of support in a layer.
    fn posts(plan: &Plan, layer: usize) -> Vec<Area> {
        all(plan, layer).islands()
    }

    #[test]
    fn each_layer_of_support_lies_within_reach_of_the_one_below() {
        let plan = plan(&tee(), Supports::Auto);
        for j in 1..49 {
            let (upper, lower) = (all(&plan, j), all(&plan, j - 1));
            // Less than a quarter of a line's width is laid over nothing.
            let reached = offset(&lower, 0.2 + 0.1, 1e-3);
            let hangs = difference(&upper, &reached);
            // Where a post begins, a corner of its polygon may stick out.
            assert!(hangs.content() < 0.1, "{j}: {}", hangs.content());
        }
    }

    #[test]
    fn posts_are_at_most_twelve_times_as_high_as_thick() {
        // A lid of 4 mm on a side, 60 mm above the bed, beside a column.
        let lid = rect(20.0, 0.0, 24.0, 4.0);
        let of = |i| match i {
            0..300 => rect(0.0, 0.0, 4.0, 4.0),
            _ => union(&rect(0.0, 0.0, 4.0, 4.0), &lid),
        };
        let outlines: Vec<Area> = (0..302).map(of).collect();
        let plan = plan(&outlines, Supports::Auto);
        for j in [250, 200, 100, 10] {
            let [post] = &posts(&plan, j)[..] else {
                panic!("{} posts in layer {j}", posts(&plan, j).len());
            };
            let depth = 60.0 - 0.2 * j as f64;
            let size = post.bounds().max - post.bounds().min;
            assert!(size.min_element() > 0.95 * depth / 12.0, "{j}: {size}");
            assert!(size.max_element() < depth / 12.0 + 1.5, "{j}: {size}");
        }
    }

    #[test]
    fn posts_meet_well_above_the_bed_or_not_at_all() {
        let of = |height: usize| {
            let lids =
                union(&rect(0.0, 0.0, 2.0, 2.0), &rect(10.0, 0.0, 12.0, 2.0));
            let stem = rect(0.0, 20.0, 5.0, 25.0);
            let layer = |i| {
                if i < height {
                    stem.clone()
                } else {
                    union(&stem, &lids)
                }
            };
            let outlines: Vec<Area> = (0..height + 2).map(layer).collect();
            posts(&plan(&outlines, Supports::Auto), 3).len()
        };
        // Half of ten millimetres at 45°, and half as much below it.
        assert_eq!(of(50), 1);
        assert_eq!(of(20), 2);
    }

    #[test]
    fn branches_lean_past_the_part_to_reach_the_bed() {
        // A lid of 2 mm, 20 mm above the bed, over the edge of a plate that is
        // 5 mm high: straight down there is no way to the bed.
        let lid = rect(0.0, 0.0, 2.0, 2.0);
        let plate = rect(-20.0, -20.0, 4.0, 20.0);
        let of = |i| match i {
            0..25 => plate.clone(),
            25..100 => rect(-20.0, -20.0, -15.0, 20.0),
            _ => union(&lid, &rect(-20.0, -20.0, -15.0, 20.0)),
        };
        let outlines: Vec<Area> = (0..102).map(of).collect();
        let plan = plan(&outlines, Supports::Plate);
        assert_eq!(plan.unheld.area, 0.0);
        let [post] = &posts(&plan, 0)[..] else {
            panic!("no single post on the bed");
        };
        assert!(post.bounds().min.x > 4.35, "{:?}", post.bounds());
    }

    #[test]
    fn posts_beside_a_wall_step_aside_and_stay_whole() {
        // A ledge that sticks out of a wall: a post that goes straight down from
        // it has no room for all of itself.
        let wall = rect(-8.0, -10.0, 0.0, 10.0);
        let ledge = union(&wall, &rect(-1.0, -1.5, 2.0, 1.5));
        let of = |i| if i < 60 { wall.clone() } else { ledge.clone() };
        let outlines: Vec<Area> = (0..64).map(of).collect();
        let plan = plan(&outlines, Supports::Auto);
        assert_eq!(plan.unheld.area, 0.0);
        let gap = usual_plan(SupportPlan::of).xy_gap;
        // The post has a foot in the lowest layers.
        for j in 6..40 {
            let post = all(&plan, j);
            let [ring] = &post.rings[..] else {
                panic!("layer {j}: {post:?}");
            };
            assert!(Disc::of(ring).is_some(), "layer {j}: {ring:?}");
            assert!(post.bounds().min.x >= gap, "layer {j}: {ring:?}");
        }
    }

    #[test]
    fn posts_do_not_end_in_the_air_between_two_walls() {
        // Two lids over a block with a groove between them that gets too narrow
        // for a post. Posts lean towards each other, and could end in there.
        let block = rect(-9.0, -3.0, 9.0, 3.0);
        let groove = |i: usize| {
            let half = 0.06 * (i as f64 - 10.0);
            rect(-half, -4.0, half, 4.0)
        };
        let lids =
            union(&rect(-3.0, -1.0, -2.0, 1.0), &rect(2.0, -1.0, 3.0, 1.0));
        let of = |i| match i {
            0..11 => block.clone(),
            11..40 => difference(&block, &groove(i)),
            40..62 => rect(-9.0, -3.0, -8.0, 3.0),
            _ => union(&rect(-9.0, -3.0, -8.0, 3.0), &lids),
        };
        let outlines: Vec<Area> = (0..64).map(of).collect();
        let plan = plan(&outlines, Supports::Auto);
        assert_eq!(plan.unheld.area, 0.0);
        for j in 42..60 {
            assert!(!all(&plan, j).is_empty(), "layer {j}");
        }
    }
}
