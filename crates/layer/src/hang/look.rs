//! A layer over the one below: how far its rim sticks out, and where it has
//! a ledge, a lid or a bridge.
//!
//! Most of a layer lies right over the layer below. So only places on the two
//! rims are looked at, a small way apart. Those of the layer itself are near
//! the rim below nearly everywhere; those of the layer below may lie under a
//! lid. Areas are made only where these places tell of a ledge.

use super::gap::{Gap, gaps};
use super::reach::Limits;
use crate::region::floating::{Floating, floating};
use glam::DVec2;
use isoslice_base::units::{Mm, Mm2};
use isoslice_planar::grid::EdgeGrid;
use isoslice_planar::{Area, Rect, Ring, Solid, edges, signed_area};
use isoslice_settings::Settings;
use std::collections::HashSet;

/// A layer over the one below.
#[derive(Clone, Debug)]
pub struct Look {
    pub(super) limits: Limits,
    /// Height of the layer.
    pub(super) height: Mm,
    /// Islands that begin on nothing.
    pub(super) begins: Vec<Floating>,
    /// What sticks out by more than a lip in this layer alone.
    pub(super) gaps: Vec<Gap>,
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
    /// What becomes of the ledge at whose rim the place is.
    pub ledge: Ledge,
}

/// What a place on the rim has to do with ledges.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Ledge {
    /// The place is not at a ledge.
    No,
    /// The place is at the rim of a ledge with this content.
    Free(Mm2),
    /// The place is at the rim of a ledge that a bridge, or something near,
    /// holds.
    Held,
}

/// Distance between places on a curved rim, and on a straight one, mm.
const STEP: Mm = 0.5;
const STRAIGHT: Mm = 1.0;
/// Distance between places on the rim of the layer below, mm. It may be large,
/// since lids are wide.
const WIDE_STEP: Mm = 2.0;

impl Look {
    /// Looks at layer `number` of some height, `here`, over `below`.
    pub fn new(
        here: &Solid<'_>,
        below: &Solid<'_>,
        number: usize,
        height: Mm,
        settings: &Settings,
    ) -> Look {
        let limits = Limits::new(height, settings);
        let begins = floating(here.area(), below);
        let rings_of = |f: &'_ Floating| -> Vec<Name> {
            let firsts = f.island.rings.iter().filter_map(|r| r.first());
            firsts.map(|p| name(*p)).collect()
        };
        let new: HashSet<Name> = begins.iter().flat_map(rings_of).collect();
        let is_new =
            |ring: &Ring| ring.first().is_some_and(|p| new.contains(&name(*p)));
        let mut look = Look {
            limits,
            height,
            begins: Vec::new(),
            gaps: Vec::new(),
            rim: Vec::new(),
            leans: false,
        };
        let mut boxes = Vec::new();
        let mut first = 0;
        for ring in &here.area().rings {
            let numbers = EdgeGrid::numbers(std::slice::from_ref(ring));
            let from = look.rim.len();
            look.places(ring, first);
            first += numbers;
            let own = &mut look.rim[from..];
            if begins.is_empty() || !is_new(ring) {
                look.leans |= over(own, below.grid(), limits, &mut boxes);
            }
        }
        under_lids(here, below.area(), limits, &mut boxes);
        if !boxes.is_empty() {
            let old = here.area().rings.iter().filter(|ring| !is_new(ring));
            let old: Area = old.cloned().collect();
            look.gaps = gaps(boxes, &old, below, number, limits, settings);
            look.settle_ledges();
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
                ledge: Ledge::No,
            });
        };
        let mut since = f64::INFINITY;
        for (i, (a, b)) in edges(ring).enumerate() {
            let on = (first + i) as f64;
            if since >= STEP {
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

    /// Finds out for places on ledges what holds the ledges.
    fn settle_ledges(&mut self) {
        let bounds: Vec<Rect> =
            self.gaps.iter().map(|gap| gap.area.bounds()).collect();
        for i in 0..self.rim.len() {
            let place = self.rim[i];
            if place.ledge == Ledge::No {
                continue;
            }
            // The gap's border runs along the rim here, so a point a little
            // inside the rim tells which gap it is.
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
            let mut all = self.gaps.iter().zip(&bounds);
            let gap = all.find(|(g, b)| b.contains(p) && g.area.contains(p));
            self.rim[i].ledge = match gap {
                Some((gap, _)) if gap.leans == 0.0 => Ledge::Held,
                Some((gap, _)) => Ledge::Free(gap.leans),
                None => place.ledge,
            };
        }
    }
}

/// What names a ring: its first point, to the last bit.
pub(super) type Name = [u64; 2];

/// The name of the ring that begins at `first`.
pub(super) fn name(first: DVec2) -> Name {
    first.to_array().map(f64::to_bits)
}

/// Finds out how far the places of a ring stick out, and adds boxes around
/// ledges. True if some places stick out by more than what is held.
fn over(
    places: &mut [RimPlace],
    below: &EdgeGrid,
    limits: Limits,
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
    let mut run: Option<Rect> = None;
    for place in places.iter_mut() {
        if place.beyond > limits.held + limits.lip {
            place.ledge = Ledge::Free(0.0);
            let margin = place.beyond + limits.held + limits.lip;
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
        if a.ledge != Ledge::No || b.ledge != Ledge::No || out == [0.0; 2] {
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

/// The place of the layer below that is nearest to a place.
struct Foot {
    at: DVec2,
    on: Option<f64>,
    beyond: Mm,
}

/// Looks for the nearest place. Deep inside, the result is unknown.
fn nearest(p: DVec2, below: &EdgeGrid, near: Mm) -> Foot {
    /// Within this distance a place is on the rim, mm.
    const ON: Mm = 1e-3;
    let close = below.nearest_edge(p, near);
    let inside = close.is_none() && below.contains(p);
    let found = match close {
        Some(found) => Some(found),
        None if inside => None,
        None => below.foot(p),
    };
    let Some((edge, at)) = found else {
        let beyond = if inside { f64::NAN } else { f64::INFINITY };
        return Foot {
            at: p,
            on: None,
            beyond,
        };
    };
    let (a, b) = below.edge(edge);
    let t = (at - a).dot(b - a) / (b - a).length_squared().max(1e-18);
    let distance = p.distance(at);
    let outside = if close.is_none() || distance < ON {
        true
    } else if t > 1e-9 && t < 1.0 - 1e-9 {
        // Solid is to the left of its rim.
        (b - a).perp_dot(p - a) < 0.0
    } else {
        !below.contains(p)
    };
    Foot {
        at,
        on: Some(edge as f64 + t.clamp(0.0, 1.0)),
        beyond: if outside { distance } else { -distance },
    }
}

/// Adds boxes around runs of the rim below that lie far under solid.
fn under_lids(
    here: &Solid<'_>,
    below: &Area,
    limits: Limits,
    boxes: &mut Vec<Rect>,
) {
    let depth = limits.held + limits.lip;
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
    use isoslice_planar::shapes::rect;

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
        let look = Look::new(&here, &below, 5, 0.2, &Settings::default());
        let ledges: Vec<Ledge> = look
            .rim
            .iter()
            .map(|place| place.ledge)
            .filter(|ledge| *ledge != Ledge::No)
            .collect();
        assert!(ledges.len() > 10, "{ledges:?}");
        assert!(ledges.iter().all(|l| *l == Ledge::Held), "{ledges:?}");
    }
}
