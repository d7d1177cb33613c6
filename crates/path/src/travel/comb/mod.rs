//! Combing: ways through an area, around its holes and notches.
//!
//! In: two points inside one island. Out: the way points of a short way
//! between them that stays inside.
//!
//! ```text
//!   a ──────╮ ╭───╮            The straight way leaves the island where it
//!           │ │   │            meets a ring, and comes back at the same ring.
//!           ╰─╯ ○ ╰────── b    A way along the ring replaces what is between.
//!                              Then the line is pulled tight.
//! ```
//!
//! Each part of the plane outside of an island is bounded by only one of the
//! island's rings. So the straight way returns by the ring by which it has
//! left, and a way along that ring exists: between any two points of an island
//! a way is found (V. Lumelsky and A. Stepanov, *Path planning strategies for a
//! point mobile automaton*, 1987). The way keeps away from the outline as far
//! as there is room, up to a clearance.
//!
//! In most cases the tight way round a ring is the convex hull of the ring's
//! stretch and of both ends ([`hug`]). If something else is in the way, the way
//! follows the ring and is pulled tight from point to point ([`pull`]). So it
//! is the shortest of the ways that pass these holes on these sides, not of all
//! ways.
//!
//! Cost: in proportion to the edges near the straight way and on the rings'
//! stretches.

mod hug;
mod pull;
mod rings;

use glam::DVec2;
use isoslice_base::units::Mm;
use isoslice_planar::Solid;
use isoslice_planar::grid::{EdgeGrid, nearest_on};
use rings::Rings;
use std::borrow::Cow;
use std::cell::OnceCell;

/// Ways inside an area.
pub(super) struct Comb<'a> {
    solid: Cow<'a, Solid<'a>>,
    clearance: Mm,
    /// The rings are made when the first travel needs them.
    rings: OnceCell<Rings>,
}

/// A point of a way, and a distance that it keeps from the outline.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stop {
    pub at: DVec2,
    pub room: Mm,
    /// The point of the outline from which the stop was moved away, or the
    /// stop's own point if it was not moved.
    pub base: DVec2,
}

/// Share of the room of two points that the line between them keeps free.
const KEPT: f64 = 0.9;

/// Share of the room of two points that the line between them keeps free if
/// there is no other way.
const PASSED: f64 = 0.1;

/// First distance between the points of a ring on a way, as a share of the
/// clearance.
const SPACING: f64 = 0.7;

/// How many times longer than the longest way allowed a way along rings may be.
/// Pulling it tight does not shorten it by more.
const BEFORE_PULLING_TIGHT: f64 = 2.0;

/// Greatest number of times that a way is pulled tight.
const ROUNDS: usize = 4;

/// Gain in length, as a share, below which a way is tight.
const GAIN: f64 = 0.01;

impl<'a> Comb<'a> {
    /// Ways inside `solid` that keep the distance `clearance` from its
    /// border where they can.
    pub(super) fn new(solid: Cow<'a, Solid<'a>>, clearance: Mm) -> Comb<'a> {
        Comb {
            solid,
            clearance,
            rings: OnceCell::new(),
        }
    }

    fn grid(&self) -> &EdgeGrid {
        self.solid.grid()
    }

    fn rings(&self) -> &Rings {
        self.rings.get_or_init(|| Rings::new(self.solid.area()))
    }

    /// The way points between `a` and `b`, without any if the straight way is
    /// inside. None if `a` and `b` are not in one island, or if the way along
    /// the rings is so much longer than `longest` that pulling it tight cannot
    /// help.
    pub(super) fn way(
        &self,
        a: DVec2,
        b: DVec2,
        longest: Mm,
    ) -> Option<Vec<DVec2>> {
        if isoslice_base::limits::is_stopped() {
            return None;
        }
        let ends = [a, b];
        // The ends may be on walls, so they are moved off them first.
        let (a, b) = (self.off(a), self.off(b));
        if self.sees(a, b) {
            return Some(inner(&ends, &[a, b]));
        }
        let marks = self.marks(a.at, b.at)?;
        if let Some(way) = self.hugging(a, b, &marks, longest) {
            return Some(inner(&ends, &way));
        }
        let along: Mm = marks
            .chunks_exact(2)
            .map(|pair| self.ring_way(pair[0], pair[1]).abs())
            .sum();
        if along > BEFORE_PULLING_TIGHT * longest {
            return None;
        }
        let around = |spacing: Mm| {
            let mut way = vec![a];
            // Without a mark the straight way stays inside, but comes too near
            // to the outline.
            if marks.is_empty() {
                way.extend(self.aside(a.at, b.at));
            }
            for pair in marks.chunks_exact(2) {
                self.along(pair[0], pair[1], spacing, &mut way);
            }
            way.push(b);
            self.pulled(&self.joined(&way)?)
        };
        // Few points of the rings mostly suffice.
        let sparse = around(SPACING * self.clearance);
        let mut way = sparse.or_else(|| around(0.0))?;
        // A nearly straight way is tight.
        if stops_length(&way) > (1.0 + 2.0 * GAIN) * a.at.distance(b.at) {
            way = self.tightened(a, way);
        }
        Some(inner(&ends, &way))
    }

    /// A way from `a`, pulled tight from its other end, and with points added
    /// in between, as long as this makes it shorter.
    fn tightened(&self, a: Stop, mut way: Vec<Stop>) -> Vec<Stop> {
        let mut length = stops_length(&way);
        for _ in 0..ROUNDS {
            let Some(tighter) = self.pulled(&self.denser(&way)) else {
                break;
            };
            let shorter = stops_length(&tighter);
            way = tighter;
            if shorter > (1.0 - GAIN) * length {
                break;
            }
            length = shorter;
        }
        if way.first().map(|s| s.at) != Some(a.at) {
            way.reverse();
        }
        way
    }

    /// The place inside, off the border, at which a way from or to `p` begins;
    /// none if `p` is outside by more than `reach`.
    pub(super) fn entry(&self, p: DVec2, reach: Mm) -> Option<DVec2> {
        if self.grid().contains(p) {
            return Some(self.off(p).at);
        }
        let (edge, q) = self.grid().nearest_edge(p, reach)?;
        let stop = self.off_border(q, edge);
        (stop.room > 0.0).then_some(stop.at)
    }

    /// The island that an edge of the border belongs to.
    pub(super) fn island_of_edge(&self, edge: usize) -> Option<usize> {
        self.rings().of_edge(edge)
    }

    /// Calls `visit` with the edges of the border that come closer than `reach`
    /// to `p`, and with their points nearest to `p`.
    pub(super) fn visit_border(
        &self,
        p: DVec2,
        reach: Mm,
        mut visit: impl FnMut(usize, DVec2),
    ) {
        self.grid().visit_edges_near(p, p, reach, |edge| {
            let (a, b) = self.grid().edge(edge);
            visit(edge, nearest_on(p, a, b));
        });
    }

    /// Direction into the area, square to an edge of its border: the area is
    /// to the left of its edges.
    pub(super) fn normal(&self, edge: usize) -> DVec2 {
        let (a, b) = self.grid().edge(edge);
        (b - a).perp().normalize_or_zero()
    }

    /// A point of the border, moved into the area.
    pub(super) fn off_border(&self, q: DVec2, edge: usize) -> Stop {
        let (from, to) = self.grid().edge(edge);
        let t = match (q == from, q == to) {
            (true, _) => 0.0,
            (_, true) => 1.0,
            _ => 0.5,
        };
        self.inwards(q, edge, t)
    }

    /// A point near `p` with more room: away from all edges that are about as
    /// near as the nearest one.
    fn off(&self, p: DVec2) -> Stop {
        /// How much farther than the nearest edge these edges may be, mm.
        const ABOUT: Mm = 0.1;
        let here = self.stop(p);
        if here.room >= self.clearance {
            return here;
        }
        let mut away = DVec2::ZERO;
        self.grid()
            .visit_edges_near(p, p, here.room + ABOUT, |edge| {
                let (a, b) = self.grid().edge(edge);
                away += (p - nearest_on(p, a, b)).normalize_or_zero();
            });
        let away = away.normalize_or_zero();
        let wanted = self.clearance - here.room;
        // The way out of a right-angled corner is longer than the way off an
        // edge.
        let trials = [1.5, 1.0, 0.5].map(|share| {
            let at = p + share * wanted * away;
            Stop {
                base: at,
                ..self.stop(at)
            }
        });
        let inside = |s: &&Stop| {
            s.room > here.room && self.grid().clear(p, s.at, 0.5 * here.room)
        };
        let best = trials.iter().filter(inside);
        best.max_by(|s, t| s.room.total_cmp(&t.room))
            .copied()
            .unwrap_or(here)
    }

    /// A point of the way with the room around it.
    pub(super) fn stop(&self, at: DVec2) -> Stop {
        let near = self.grid().nearest_edge(at, self.clearance);
        Stop {
            at,
            room: near.map_or(self.clearance, |(_, q)| at.distance(q)),
            base: at,
        }
    }

    /// True if the line between two points keeps away from the outline as far
    /// as the points do.
    fn sees(&self, a: Stop, b: Stop) -> bool {
        self.grid().clear(a.at, b.at, KEPT * a.room.min(b.room))
    }

    /// True if the line between two points is inside.
    fn passes(&self, a: Stop, b: Stop) -> bool {
        let room = a.room.min(b.room);
        room > 0.0 && self.grid().clear(a.at, b.at, PASSED * room)
    }

    /// A point beside the place where the outline comes nearest to a line.
    fn aside(&self, a: DVec2, b: DVec2) -> Option<Stop> {
        let mut nearest: Option<(f64, usize, f64)> = None;
        let ab = b - a;
        self.grid().visit_edges_near(a, b, self.clearance, |edge| {
            let (p, q) = self.grid().edge(edge);
            for v in [p, q] {
                let t = ((v - a).dot(ab) / ab.length_squared()).clamp(0.0, 1.0);
                let d = v.distance_squared(a + t * ab);
                let nearer = nearest.is_none_or(|(least, e, _)| {
                    d < least || (d == least && edge < e)
                });
                if nearer && t > 0.0 && t < 1.0 {
                    nearest = Some((d, edge, if v == p { 0.0 } else { 1.0 }));
                }
            }
        });
        let (_, edge, end) = nearest?;
        let (p, q) = self.grid().edge(edge);
        Some(self.inwards(p.lerp(q, end), edge, end))
    }

    /// A point of the outline, on an edge at `t`, moved into the part by the
    /// clearance, or as far as there is room.
    fn inwards(&self, p: DVec2, edge: usize, t: f64) -> Stop {
        /// Number of trials after which there counts as being no room.
        const TRIALS: usize = 6;
        /// The share of the distance at which the search begins: just off the
        /// edge.
        const START: f64 = 1e-3;
        let rings = self.rings();
        let ring = rings.places.ring(edge);
        let first = rings.places.first(ring);
        let count = rings.places.of_ring(ring).len();
        let normal = |e: usize| self.normal(e);
        let other = match t {
            0.0 => first + (edge - first + count - 1) % count,
            1.0 => first + (edge - first + 1) % count,
            _ => edge,
        };
        let inward = (normal(edge) + normal(other)).normalize_or(normal(edge));
        let mut far = self.clearance;
        let mut best = Stop {
            at: p,
            room: 0.0,
            base: p,
        };
        for _ in 0..TRIALS {
            let at = p + far * inward;
            let mut across = false;
            self.grid()
                .visit_crossed(p + START * far * inward, at, |_, _| {
                    across = true;
                });
            let near = self.grid().nearest_edge(at, far);
            let room = near.map_or(far, |(_, q)| at.distance(q));
            if !across && room > best.room {
                best = Stop { at, room, base: p };
            }
            if !across && room > 0.9 * far {
                break;
            }
            // The point goes to the middle between this side and the other one.
            far = if across {
                0.5 * far
            } else {
                0.5 * (far + room)
            };
        }
        best
    }
}

/// The points of a way that are not its ends.
fn inner(ends: &[DVec2; 2], way: &[Stop]) -> Vec<DVec2> {
    let points = way.iter().map(|s| s.at);
    points.filter(|p| !ends.contains(p)).collect()
}

fn stops_length(way: &[Stop]) -> Mm {
    way.windows(2).map(|p| p[0].at.distance(p[1].at)).sum()
}

#[cfg(test)]
mod property;
#[cfg(test)]
mod tests;
