//! A layer over the one below, at places on their rims: how far the layer sticks out,
//! and where that is for the judge to say.
//!
//! Most of a layer lies right over the layer below. So only places on the two
//! rims are looked at, a small way apart. Those of the layer itself are near
//! the rim below nearly everywhere; those of the layer below may lie under a
//! lid. The [`judge`](super::judge) is asked only where these places stick out so far
//! that a bridge might hold something, or that more than a lip hangs. What sticks
//! out less in each layer is followed at these places ([`track`](super::track)).

use super::across::{DRIFT, Upper};
use super::held::Limits;
use super::ledges::{Ledge, ledges};
use super::plan::OverhangPlan;
use super::printed::kept;
use glam::DVec2;
use isoslice_base::units::{Mm, Mm2};
use isoslice_layer::floating::{Floating, floating};
use isoslice_planar::grid::EdgeGrid;
use isoslice_planar::{Area, Rect, Ring, Solid, edges, signed_area};
use std::collections::HashSet;

/// A layer over the one below.
#[derive(Clone, Debug)]
pub struct LayerOverhang {
    pub(super) limits: Limits,
    /// The layer's number.
    pub(super) number: usize,
    /// Height of the layer.
    pub(super) height: Mm,
    /// Islands that begin on nothing.
    pub(super) begins: Vec<Floating>,
    /// What hangs in this layer alone.
    pub(super) ledges: Vec<Ledge>,
    /// Places on the rim, ring by ring.
    pub(super) rim: Vec<RimPlace>,
    /// True if some of these places stick out by more than the layer below
    /// holds.
    pub(super) leans: bool,
}

/// A place on the rim of a layer. A place on rings is an edge's number, as a
/// grid has it, plus a share of the edge.
#[derive(Clone, Copy, Debug)]
pub(super) struct RimPlace {
    pub at: DVec2,
    /// The place on the layer's rings.
    pub on: f64,
    /// The places of its ring's beginning and end.
    pub ring: (f64, f64),
    /// Length of the rim that the place stands for.
    pub length: Mm,
    /// The nearest place on the rings of the layer below, if it is known. A
    /// place far inside does not need it.
    pub foot: Option<f64>,
    /// How far the place sticks out over the layer below; negative if it is
    /// inside that layer, and NaN if it is so far inside that the distance is
    /// unknown.
    pub beyond: Mm,
    /// Content of what sticks out around it.
    pub strip: Mm2,
    /// What the judge says of it.
    pub said: Said,
}

/// What the judge says of a place on the rim.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Said {
    /// It was not asked: the place itself tells how far it hangs.
    Nothing,
    /// It has to be asked.
    Asked,
    /// The place is at the rim of a ledge with this content.
    Ledge(Mm2),
    /// A bridge, or something near, holds the place, or it is too thin to be printed.
    Held,
}

/// A wall bridges a gap only if it sticks out beyond what is held by more than this
/// share of its width: otherwise its middle is held.
const MIDDLE: f64 = 0.5;
/// Least length of a rim along which a wall may bridge a gap, mm. What hangs along a
/// shorter one is small, and lattices are full of them.
const LONG: Mm = 3.0;
/// Distance between places on a curved rim, and on a straight one, mm.
const RIM_STEP: Mm = 0.5;
const STRAIGHT: Mm = 1.0;
/// Distance between places on the rim of the layer below, mm. It may be large,
/// since lids are wide.
const WIDE_STEP: Mm = 2.0;

impl LayerOverhang {
    /// Looks at a layer over the layer below. The heights are those of both.
    pub fn new(
        [here, below]: [&Solid<'_>; 2],
        number: usize,
        heights: [Mm; 2],
        plan: &OverhangPlan,
    ) -> LayerOverhang {
        let [height, height_below] = heights;
        let here = kept(here, height, plan);
        let below = kept(below, height_below, plan);
        let (here, below) = (here.as_ref(), below.as_ref());
        let upper = Upper {
            outline: here,
            number,
            height,
            plan,
        };
        let limits = Limits::new(height, plan);
        let begins = floating(here.area(), below);
        let rings_of = |f: &'_ Floating| -> Vec<Name> {
            let firsts = f.island.rings.iter().filter_map(|r| r.first());
            firsts.map(|p| name(*p)).collect()
        };
        let new: HashSet<Name> = begins.iter().flat_map(rings_of).collect();
        let is_new =
            |ring: &Ring| ring.first().is_some_and(|p| new.contains(&name(*p)));
        let mut look = LayerOverhang {
            limits,
            number,
            height,
            begins: Vec::new(),
            ledges: Vec::new(),
            rim: Vec::new(),
            leans: false,
        };
        let mut boxes = Vec::new();
        let bridges = limits.held + MIDDLE * plan.walls.outer;
        let mut first = 0;
        for ring in &here.area().rings {
            let numbers = EdgeGrid::numbers(std::slice::from_ref(ring));
            let from = look.rim.len();
            look.places(ring, first);
            first += numbers;
            let own = &mut look.rim[from..];
            if begins.is_empty() || !is_new(ring) {
                look.leans |=
                    over(own, below.grid(), limits, bridges, &mut boxes);
            }
        }
        under_lids(here, below.area(), limits, &mut boxes);
        if !boxes.is_empty() {
            let old = here.area().rings.iter().filter(|ring| !is_new(ring));
            let old: Area = old.cloned().collect();
            look.ledges = ledges(boxes, &old, below, upper);
            look.hear();
        }
        look.begins = begins;
        look
    }

    /// Places on a ring whose first edge has this number.
    fn places(&mut self, ring: &Ring, first: usize) {
        let ends = (first as f64, (first + ring.len()) as f64);
        let from = self.rim.len();
        let mut push = |at: DVec2, on: f64| {
            self.rim.push(RimPlace {
                at,
                on,
                ring: ends,
                length: 0.0,
                foot: None,
                beyond: f64::NAN,
                strip: 0.0,
                said: Said::Nothing,
            });
        };
        let mut since = f64::INFINITY;
        for (i, (a, b)) in edges(ring).enumerate() {
            let on = (first + i) as f64;
            if since >= RIM_STEP {
                push(a, on);
                since = 0.0;
            }
            let length = a.distance(b);
            let parts = (length / STRAIGHT).floor() as usize + 1;
            for k in 1..parts {
                let t = k as f64 / parts as f64;
                push(a.lerp(b, t), on + t);
            }
            since = match parts {
                1 => since + length,
                n => length / n as f64,
            };
        }
        let own = &mut self.rim[from..];
        for i in 0..own.len() {
            let next = (i + 1) % own.len();
            let half = 0.5 * own[i].at.distance(own[next].at);
            own[i].length += half;
            own[next].length += half;
        }
    }

    /// Takes in what the judge says of the places about which it was asked, and of
    /// those beside them that belong to the same ledge.
    fn hear(&mut self) {
        let bounds = self.bounds();
        for i in 0..self.rim.len() {
            let place = self.rim[i];
            let asked = place.said == Said::Asked;
            if !asked && !self.hangs(&place) {
                continue;
            }
            self.rim[i].said = match self.ledge_at(i, &bounds) {
                Some(k) if self.ledges[k].counts => {
                    Said::Ledge(self.ledges[k].piece.area)
                }
                None if asked => Said::Held,
                _ => Said::Nothing,
            };
        }
    }

    /// Leaves out what hangs without a wall, and the rims of holes: all that is printed
    /// is a wall round the layer.
    pub fn of_a_wall_around(mut self) -> LayerOverhang {
        for ring in self.rim.chunk_by_mut(|a, b| a.ring == b.ring) {
            let points: Vec<DVec2> = ring.iter().map(|p| p.at).collect();
            if signed_area(&points) > 0.0 {
                continue;
            }
            for place in ring {
                place.beyond = f64::NAN;
                place.strip = 0.0;
                place.said = Said::Nothing;
            }
        }
        self.leans = self.rim.iter().any(|place| self.hangs(place));
        let bounds = self.bounds();
        let mut walled = vec![false; self.ledges.len()];
        for i in 0..self.rim.len() {
            if self.hangs(&self.rim[i])
                && let Some(k) = self.ledge_at(i, &bounds)
            {
                walled[k] = true;
            }
        }
        for (ledge, walled) in self.ledges.iter_mut().zip(walled) {
            ledge.counts &= walled;
        }
        self
    }

    /// True if a place on the rim sticks out by more than the layer below holds.
    fn hangs(&self, place: &RimPlace) -> bool {
        place.beyond > self.limits.held
    }

    fn bounds(&self) -> Vec<Rect> {
        self.ledges.iter().map(|l| l.area.bounds()).collect()
    }

    /// The number of the ledge along whose border the rim runs at its `i`th place, if
    /// there is one. `bounds` are those of the ledges.
    fn ledge_at(&self, i: usize, bounds: &[Rect]) -> Option<usize> {
        let place = self.rim[i];
        // A point a little inside the rim tells which ledge it is.
        let next = match self.rim.get(i + 1) {
            Some(next) if next.ring == place.ring => next.at,
            // The last place of a ring is followed by the ring's first.
            _ => {
                let from = place.ring.0;
                let first = self.rim.partition_point(|p| p.on < from);
                self.rim[first].at
            }
        };
        let along = (next - place.at).normalize_or_zero();
        let p = place.at.midpoint(next) + 0.02 * along.perp();
        let mut all = self.ledges.iter().zip(bounds);
        all.position(|(l, b)| b.contains(p) && l.area.contains(p))
    }
}

/// What names a ring: its first point, to the last bit.
pub(super) type Name = [u64; 2];

/// The name of the ring that begins at `first`.
pub(super) fn name(first: DVec2) -> Name {
    first.to_array().map(f64::to_bits)
}

/// Finds out how far the places of a ring stick out, and adds boxes around those about
/// which the judge is to be asked. Walls that stick out farther than `bridges` may be
/// bridges. True if some places stick out by more than what is held.
fn over(
    places: &mut [RimPlace],
    below: &EdgeGrid,
    limits: Limits,
    bridges: Mm,
    boxes: &mut Vec<Rect>,
) -> bool {
    let mut leans = false;
    let mut feet = Vec::with_capacity(places.len());
    for place in places.iter_mut() {
        let foot = nearest(place.at, below, limits.held);
        place.beyond = foot.beyond;
        place.foot = foot.on;
        feet.push(foot.at);
        leans |= place.beyond > limits.held;
    }
    if !leans {
        return false;
    }
    ask(places, limits, bridges);
    let mut run: Option<Rect> = None;
    for place in places.iter() {
        if place.said == Said::Asked {
            let margin = place.beyond + limits.held + limits.harmless;
            let around = Rect::new(place.at - margin, place.at + margin);
            run = Some(run.map_or(around, |r| r.union(around)));
        } else {
            boxes.extend(run.take());
        }
    }
    boxes.extend(run);
    for i in 0..places.len() {
        let next = (i + 1) % places.len();
        let (a, b) = (places[i], places[next]);
        let out = [a.beyond.max(0.0), b.beyond.max(0.0)];
        // What sticks out farther is a ledge as a whole.
        if limits.harm(a.beyond.max(b.beyond)) || out == [0.0; 2] {
            continue;
        }
        let foot =
            |p: RimPlace, q: DVec2| if p.beyond > 0.0 { q } else { p.at };
        let (p, q) = (foot(a, feet[i]), foot(b, feet[next]));
        let side = a.at.distance(b.at);
        let strip = if p.distance(q) <= side + out[0] + out[1] {
            signed_area(&[a.at, b.at, q, p]).abs()
        } else {
            0.5 * side * (out[0] + out[1])
        };
        places[i].strip += 0.5 * strip;
        places[next].strip += 0.5 * strip;
    }
    true
}

/// Finds the places of a ring about which the judge is to be asked: those at ledges, and
/// those at a straight rim between places that are held, along which a wall sticks out
/// farther than `bridges`.
fn ask(places: &mut [RimPlace], limits: Limits, bridges: Mm) {
    for place in places.iter_mut() {
        if limits.harm(place.beyond) {
            place.said = Said::Asked;
        }
    }
    let count = places.len();
    let leans = |place: &RimPlace| place.beyond > limits.held;
    // What leans all round has no ends that are held.
    let Some(held) = places.iter().position(|place| !leans(place)) else {
        return;
    };
    let order: Vec<usize> = (held..held + count).map(|k| k % count).collect();
    let runs = order.chunk_by(|a, b| leans(&places[*a]) == leans(&places[*b]));
    let at = |k: usize| places[k].at;
    let runs =
        runs.filter(|run| leans(&places[run[0]]) && is_straight(run, at));
    let runs: Vec<usize> = runs.flatten().copied().collect();
    for k in runs {
        if places[k].beyond > bridges {
            places[k].said = Said::Asked;
        }
    }
}

/// True if places lie along a line that a wall may bridge. `at` says where they are.
fn is_straight(run: &[usize], at: impl Fn(usize) -> DVec2) -> bool {
    let [first, .., last] = run else { return false };
    let (a, way) = (at(*first), at(*last) - at(*first));
    let across = way.normalize_or_zero().perp();
    way.length() >= LONG
        && run.iter().all(|k| across.dot(at(*k) - a).abs() <= DRIFT)
}

/// The place of the layer below that is nearest to a place.
struct NearestBelow {
    at: DVec2,
    on: Option<f64>,
    beyond: Mm,
}

/// Looks for the nearest place. Deep inside, the result is unknown.
fn nearest(p: DVec2, below: &EdgeGrid, near: Mm) -> NearestBelow {
    /// Nearly all places have an edge so near, mm, which tells at once on which side
    /// the solid is.
    const NEAR: Mm = 1.0;
    let found = below.nearest_edge(p, near.max(NEAR));
    let outside = match found {
        Some((edge, at)) => is_outside(p, below.edge(edge), at),
        None => None,
    };
    let outside = outside.unwrap_or_else(|| !below.contains(p));
    let close = found.filter(|(_, at)| p.distance(*at) <= near);
    let found = match close {
        None if outside => found.or_else(|| below.foot(p)),
        _ => close,
    };
    let Some((edge, at)) = found else {
        let beyond = if outside { f64::INFINITY } else { f64::NAN };
        return NearestBelow {
            at: p,
            on: None,
            beyond,
        };
    };
    let (a, b) = below.edge(edge);
    let t = (at - a).dot(b - a) / (b - a).length_squared().max(1e-18);
    let distance = p.distance(at);
    NearestBelow {
        at,
        on: Some(edge as f64 + t.clamp(0.0, 1.0)),
        beyond: if outside { distance } else { -distance },
    }
}

/// True if a place is outside of a solid whose nearest edge leads from `a` to `b` and is
/// nearest at `at`. At a corner the edge does not tell.
fn is_outside(p: DVec2, (a, b): (DVec2, DVec2), at: DVec2) -> Option<bool> {
    /// Within this distance a place is on the rim, mm.
    const ON: Mm = 1e-3;
    if p.distance(at) < ON {
        return Some(true);
    }
    let t = (at - a).dot(b - a) / (b - a).length_squared().max(1e-18);
    // Solid is to the left of its rim.
    let side = (b - a).perp_dot(p - a) < 0.0;
    (t > 1e-9 && t < 1.0 - 1e-9).then_some(side)
}

/// Adds boxes around runs of the rim below that lie far under solid.
fn under_lids(
    here: &Solid<'_>,
    below: &Area,
    limits: Limits,
    boxes: &mut Vec<Rect>,
) {
    let depth = limits.held + limits.harmless;
    // The box reaches to the next place, and around what hangs there.
    let margin = WIDE_STEP + 2.0 * depth;
    for ring in &below.rings {
        let mut run: Option<Rect> = None;
        let mut since = f64::INFINITY;
        let mut ask = |p: DVec2| {
            let free = here.grid().nearest_edge(p, depth).is_none();
            if free && here.grid().contains(p) {
                let around = Rect::new(p - margin, p + margin);
                run = Some(run.map_or(around, |r| r.union(around)));
            } else {
                boxes.extend(run.take());
            }
        };
        for (a, b) in edges(ring) {
            if since >= WIDE_STEP {
                ask(a);
                since = 0.0;
            }
            let length = a.distance(b);
            let parts = (length / WIDE_STEP).floor() as usize + 1;
            for k in 1..parts {
                ask(a.lerp(b, k as f64 / parts as f64));
            }
            since = match parts {
                1 => since + length,
                n => length / n as f64,
            };
        }
        boxes.extend(run);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::overhangs::Tracker;
    use isoslice_planar::clip::difference;
    use isoslice_planar::shapes::rect;
    use isoslice_settings::testing::usual_plan;

    #[test]
    fn a_wall_around_has_no_ceilings() {
        let plan = usual_plan(OverhangPlan::of);
        let sums = |below: Area, here: Area| {
            let [here, below] = [here, below].map(Solid::new);
            let all = LayerOverhang::new([&here, &below], 5, [0.2; 2], &plan);
            [all.clone(), all.of_a_wall_around()].map(|look| {
                let mut tracker = Tracker::default();
                tracker.layer(&look, here.grid(), true, |p| p.extend(1.0));
                tracker.end(&plan);
                let sums = tracker.finish();
                (sums.bridges.count, sums.leans.area.round())
            })
        };
        // The ceiling of a pocket, and of one that only gets narrower.
        let block = rect(0.0, 0.0, 60.0, 60.0);
        let pocket = difference(&block, &rect(5.0, 5.0, 55.0, 55.0));
        let narrow = difference(&block, &rect(15.0, 15.0, 45.0, 45.0));
        let [all, wall] = sums(pocket.clone(), block.clone());
        assert!(all.0 > 0 && wall == (0, 0.0), "{all:?} {wall:?}");
        let [all, wall] = sums(pocket, narrow);
        assert!(
            all.0 + all.1 as usize > 0 && wall == (0, 0.0),
            "{all:?} {wall:?}"
        );
        // A wall leads round what sticks out.
        let wider = rect(-10.0, 0.0, 60.0, 60.0);
        let [all, wall] = sums(block, wider);
        assert!(all.1 > 0.0 && all == wall, "{all:?} {wall:?}");
    }

    #[test]
    fn a_bridge_is_held_wherever_its_ring_begins() {
        let mut below = rect(0.0, 0.0, 10.0, 10.0);
        below.rings.extend(rect(20.0, 0.0, 30.0, 10.0).rings);
        let at = |x: f64, y: f64| DVec2::new(x, y);
        // The island begins in the middle of the gap.
        let ring =
            vec![at(15.0, 0.0), at(30.0, 0.0), at(30.0, 10.0), at(0.0, 10.0)];
        let ring = [ring, vec![at(0.0, 0.0)]].concat();
        let here = Area::from(ring);
        let [here, below] = [here, below].map(Solid::new);
        let look = LayerOverhang::new(
            [&here, &below],
            5,
            [0.2; 2],
            &usual_plan(OverhangPlan::of),
        );
        let said: Vec<Said> = look
            .rim
            .iter()
            .map(|place| place.said)
            .filter(|said| *said != Said::Nothing)
            .collect();
        assert!(said.len() > 10, "{said:?}");
        assert!(said.iter().all(|s| *s == Said::Held), "{said:?}");
    }
}
