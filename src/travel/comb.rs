//! Combing: ways through the part, around its holes and notches.
//!
//! In: two points inside one island. Out: the way points of a short way
//! between them that stays inside.
//!
//! ```text
//!   a ──────╮ ╭───╮            the straight way leaves the island where it
//!           │ │   │            meets a ring, and comes back at the same ring:
//!           ╰─╯ ○ ╰────── b    what is between is replaced by the shorter
//!                              way along the ring; then the line is pulled
//!                              tight
//! ```
//!
//! Each part of the plane that is outside of an island is bounded by one of
//! its rings only, so the straight way always returns by the ring by which it
//! has left, and a way along that ring exists: if two points are in one
//! island, a way between them is found (V. Lumelsky and A. Stepanov, *Path
//! planning strategies for a point mobile automaton*, 1987). It is kept away
//! from the outline as far as there is room, up to a clearance; and pulling it
//! tight makes it the shortest of all that pass the same holes on the same
//! sides, not of all that there are.
//!
//! Cost: that of the edges near the straight way and on the rings' stretches.

use crate::plane::grid::{EdgeGrid, nearest_on};
use crate::plane::nest::Nest;
use crate::plane::places::Places;
use crate::plane::{Area, signed_area};
use crate::units::Mm;
use glam::DVec2;
use std::cell::OnceCell;

/// Ways inside a layer's outline.
pub struct Comb<'a> {
    outline: &'a Area,
    grid: &'a EdgeGrid,
    clearance: Mm,
    /// Only layers with travels that need it pay for it.
    rings: OnceCell<Rings>,
}

/// What is known of the rings as a whole.
struct Rings {
    nest: Nest,
    /// Island that each ring belongs to.
    island: Vec<Option<usize>>,
    places: Places,
}

/// A point of a way, and how far from the outline it is known to be.
#[derive(Clone, Copy, Debug)]
struct Stop {
    at: DVec2,
    room: Mm,
    /// The point of the outline that it was moved away from, or itself.
    base: DVec2,
}

/// A place on a ring.
#[derive(Clone, Copy, Debug)]
struct Mark {
    /// How far along the straight way.
    t: f64,
    edge: usize,
    at: DVec2,
}

/// Share of the room of two points that the line between them keeps.
const KEPT: f64 = 0.9;

/// The same where there is no other way.
const PASSED: f64 = 0.1;

/// Distance between the points of a ring that are tried first, as a share of
/// the clearance.
const SPACING: f64 = 0.7;

/// How much longer than the longest way allowed a way along rings may be: as
/// much as pulling it tight may gain.
const SLACK: f64 = 2.0;

/// How often a way is pulled tight at most.
const ROUNDS: usize = 4;

/// Gain in length below which it is tight.
const GAIN: f64 = 0.01;

impl<'a> Comb<'a> {
    /// For travels inside `outline`, whose edges are in `grid`, that keep the
    /// distance `clearance` from it where they can.
    pub fn new(
        outline: &'a Area,
        grid: &'a EdgeGrid,
        clearance: Mm,
    ) -> Comb<'a> {
        Comb {
            outline,
            grid,
            clearance,
            rings: OnceCell::new(),
        }
    }

    fn rings(&self) -> &Rings {
        self.rings.get_or_init(|| Rings::new(self.outline))
    }

    /// The way points between `a` and `b`, none if the straight way is inside;
    /// nothing if they are not in one island, or if the way along the rings is
    /// so much longer than `longest` that pulling it tight cannot help.
    pub fn way(&self, a: DVec2, b: DVec2, longest: Mm) -> Option<Vec<DVec2>> {
        let ends = [a, b];
        // Off the walls first, which the ends may be on.
        let (a, b) = (self.off(a), self.off(b));
        if self.sees(a, b) {
            return Some(inner(&ends, &[a, b]));
        }
        let marks = self.marks(a.at, b.at)?;
        let along: Mm = marks
            .chunks_exact(2)
            .map(|pair| self.ring_way(pair[0], pair[1]).abs())
            .sum();
        if along > SLACK * longest {
            return None;
        }
        let around = |spacing: Mm| {
            let mut way = vec![a];
            match marks.is_empty() {
                // It stays inside, but comes too near to the outline.
                true => way.extend(self.aside(a.at, b.at)),
                false => {
                    for pair in marks.chunks_exact(2) {
                        self.along(pair[0], pair[1], spacing, &mut way);
                    }
                }
            }
            way.push(b);
            self.pulled(&self.joined(&way)?)
        };
        // A few points of the rings do, mostly.
        let sparse = around(SPACING * self.clearance);
        let mut way = sparse.or_else(|| around(0.0))?;
        let mut length = stops_length(&way);
        for _ in 0..ROUNDS {
            crate::limits::check();
            // From the other end, and from between, it can be pulled tighter.
            let tighter = self.pulled(&self.denser(&way))?;
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
        Some(inner(&ends, &way))
    }

    /// A point with as much room as there is near `p`: away from all edges
    /// that are about as near as the nearest one.
    fn off(&self, p: DVec2) -> Stop {
        /// How much farther these edges may be, mm.
        const ABOUT: Mm = 0.1;
        let here = self.stop(p);
        if here.room >= self.clearance {
            return here;
        }
        let mut away = DVec2::ZERO;
        self.grid.visit_edges_near(p, p, here.room + ABOUT, |edge| {
            let (a, b) = self.grid.edge(edge);
            away += (p - nearest_on(p, a, b)).normalize_or_zero();
        });
        let away = away.normalize_or_zero();
        let wanted = self.clearance - here.room;
        // Out of a right-angled corner it is farther than off an edge.
        let trials = [1.5, 1.0, 0.5].map(|share| {
            let at = p + share * wanted * away;
            Stop {
                base: at,
                ..self.stop(at)
            }
        });
        let inside = |s: &&Stop| {
            s.room > here.room && self.grid.clear(p, s.at, 0.5 * here.room)
        };
        let best = trials.iter().filter(inside);
        best.max_by(|s, t| s.room.total_cmp(&t.room))
            .copied()
            .unwrap_or(here)
    }

    /// The way with points added where two that follow each other do not see
    /// each other: down to the outline, along it, and up again. Nothing if
    /// that does not help.
    fn joined(&self, way: &[Stop]) -> Option<Vec<Stop>> {
        /// Halvings of the distance from the outline.
        const TRIALS: usize = 9;
        let mut out = vec![*way.first()?];
        for pair in way.windows(2) {
            let (mut low, mut high) = (vec![pair[0]], vec![pair[1]]);
            loop {
                let (a, b) = (low[low.len() - 1], high[high.len() - 1]);
                if self.passes(a, b) {
                    break;
                }
                if low.len() > TRIALS {
                    return None;
                }
                low.push(self.stop_near(a));
                high.push(self.stop_near(b));
            }
            out.extend(&low[1..]);
            out.extend(high.iter().rev());
        }
        Some(out)
    }

    /// Half as far from the outline.
    fn stop_near(&self, stop: Stop) -> Stop {
        Stop {
            base: stop.base,
            ..self.stop(0.5 * (stop.at + stop.base))
        }
    }

    /// The way, turned round, with a point in the middle of each line.
    fn denser(&self, way: &[Stop]) -> Vec<Stop> {
        let mut out = Vec::with_capacity(2 * way.len());
        for pair in way.windows(2) {
            out.push(pair[0]);
            out.push(self.stop(0.5 * (pair[0].at + pair[1].at)));
        }
        out.extend(way.last());
        out.reverse();
        out
    }

    /// A point of the way with the room it has.
    fn stop(&self, at: DVec2) -> Stop {
        let near = self.grid.nearest_edge(at, self.clearance);
        Stop {
            at,
            room: near.map_or(self.clearance, |(_, q)| at.distance(q)),
            base: at,
        }
    }

    /// True if the line between two points keeps away from the outline as far
    /// as they do.
    fn sees(&self, a: Stop, b: Stop) -> bool {
        self.grid.clear(a.at, b.at, KEPT * a.room.min(b.room))
    }

    /// True if the line between two points is inside at all.
    fn passes(&self, a: Stop, b: Stop) -> bool {
        let room = a.room.min(b.room);
        room > 0.0 && self.grid.clear(a.at, b.at, PASSED * room)
    }

    /// Where the straight way leaves the island and comes back, in pairs;
    /// nothing if its ends are not in one island.
    fn marks(&self, a: DVec2, b: DVec2) -> Option<Vec<Mark>> {
        let rings = self.rings();
        let island = rings.nest.around(a)?;
        if rings.nest.around(b) != Some(island) {
            return None;
        }
        let mut marks: Vec<Mark> = Vec::new();
        self.grid.visit_crossed(a, b, |t, edge| {
            if rings.island[rings.places.ring(edge)] == Some(island) {
                let at = a.lerp(b, t);
                marks.push(Mark { t, edge, at });
            }
        });
        marks.sort_by(|p, q| p.t.total_cmp(&q.t).then(p.edge.cmp(&q.edge)));
        marks.dedup_by(|p, q| p.edge == q.edge);
        let pairs = marks.chunks(2).all(|pair| {
            pair.len() == 2
                && rings.places.ring(pair[0].edge)
                    == rings.places.ring(pair[1].edge)
        });
        // Else it passes through a vertex, where what is crossed is counted
        // more than once or not at all.
        pairs.then_some(marks)
    }

    /// A point beside the place where the outline comes nearest to a line.
    fn aside(&self, a: DVec2, b: DVec2) -> Option<Stop> {
        let mut nearest: Option<(f64, usize, f64)> = None;
        let ab = b - a;
        self.grid.visit_edges_near(a, b, self.clearance, |edge| {
            let (p, q) = self.grid.edge(edge);
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
        let (p, q) = self.grid.edge(edge);
        Some(self.inwards(p.lerp(q, end), edge, end))
    }

    /// Length of the shorter way along a ring, negative if it runs against the
    /// ring's direction.
    fn ring_way(&self, from: Mark, to: Mark) -> Mm {
        let rings = self.rings();
        let total = rings.places.length(rings.places.ring(from.edge));
        let way = rings.place(self.grid, &to) - rings.place(self.grid, &from);
        let forwards = way.rem_euclid(total);
        match forwards <= 0.5 * total {
            true => forwards,
            false => forwards - total,
        }
    }

    /// Appends the shorter way along a ring, points no closer than `spacing`.
    fn along(&self, from: Mark, to: Mark, spacing: Mm, way: &mut Vec<Stop>) {
        let rings = self.rings();
        let ring = rings.places.ring(from.edge);
        let way_round = self.ring_way(from, to);
        let ahead =
            rings.place(self.grid, &to) >= rings.place(self.grid, &from);
        let first = rings.places.first(ring);
        let count = rings.places.of_ring(ring).len();
        let next = |e: usize| first + (e - first + 1) % count;
        let previous = |e: usize| first + (e - first + count - 1) % count;
        way.push(self.inwards(from.at, from.edge, 0.5));
        let mut edge = from.edge;
        let mut last = from.at;
        let mut add = |p: DVec2, edge: usize, t: f64| {
            if p.distance(last) >= spacing {
                way.push(self.inwards(p, edge, t));
                last = p;
            }
        };
        if way_round >= 0.0 {
            // Once round at most, also where both are on one edge.
            let mut left = count;
            while (edge != to.edge || (left == count && !ahead)) && left > 0 {
                add(self.grid.edge(edge).1, edge, 1.0);
                edge = next(edge);
                left -= 1;
            }
        } else {
            let mut left = count;
            while (edge != to.edge || (left == count && ahead)) && left > 0 {
                add(self.grid.edge(edge).0, edge, 0.0);
                edge = previous(edge);
                left -= 1;
            }
        }
        way.push(self.inwards(to.at, to.edge, 0.5));
    }

    /// A point of the outline, on an edge at `t`, moved into the part by the
    /// clearance, or as far as there is room.
    fn inwards(&self, p: DVec2, edge: usize, t: f64) -> Stop {
        /// Trials before it counts as none.
        const TRIALS: usize = 6;
        /// Where to begin to look, as a share of the distance: off the edge.
        const START: f64 = 1e-3;
        let rings = self.rings();
        let ring = rings.places.ring(edge);
        let first = rings.places.first(ring);
        let count = rings.places.of_ring(ring).len();
        let normal = |e: usize| {
            let (a, b) = self.grid.edge(e);
            // The part is to the left.
            (b - a).perp().normalize_or_zero()
        };
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
            self.grid
                .visit_crossed(p + START * far * inward, at, |_, _| {
                    across = true;
                });
            let near = self.grid.nearest_edge(at, far);
            let room = near.map_or(far, |(_, q)| at.distance(q));
            if !across && room > best.room {
                best = Stop { at, room, base: p };
            }
            if !across && room > 0.9 * far {
                break;
            }
            // The middle between this side and the other one.
            far = match across {
                true => 0.5 * far,
                false => 0.5 * (far + room),
            };
        }
        best
    }

    /// The way with every detour left out that can be: from each point
    /// straight to the farthest one that it sees. Nothing if a point does not
    /// see the next one.
    fn pulled(&self, way: &[Stop]) -> Option<Vec<Stop>> {
        let mut out = vec![*way.first()?];
        let mut i = 0;
        while i + 1 < way.len() {
            // Farther and farther, then back in halves.
            let mut seen = i;
            let mut stride = 1;
            let mut unseen = way.len();
            while i + stride < way.len() {
                if self.sees(way[i], way[i + stride]) {
                    seen = i + stride;
                    stride *= 2;
                } else {
                    unseen = i + stride;
                    break;
                }
            }
            if seen > i && unseen == way.len() {
                // The end is nearer than the next stride.
                if self.sees(way[i], way[way.len() - 1]) {
                    seen = way.len() - 1;
                }
            }
            while unseen > seen + 1 {
                let middle = seen + (unseen - seen) / 2;
                match self.sees(way[i], way[middle]) {
                    true => seen = middle,
                    false => unseen = middle,
                }
            }
            if seen == i && self.passes(way[i], way[i + 1]) {
                seen = i + 1;
            }
            if seen == i {
                return None;
            }
            out.push(way[seen]);
            i = seen;
        }
        Some(out)
    }
}

impl Rings {
    fn new(outline: &Area) -> Rings {
        let outer: Vec<bool> =
            outline.rings.iter().map(|r| signed_area(r) > 0.0).collect();
        let outers = || {
            let all = outline.rings.iter().zip(&outer);
            all.filter(|(_, o)| **o).map(|(r, _)| r)
        };
        let nest = Nest::new(outers());
        let mut number = 0;
        let island = outline.rings.iter().zip(&outer).map(|(ring, outer)| {
            if *outer {
                number += 1;
                return Some(number - 1);
            }
            // A hole's own points are in no island but its own.
            ring.first().and_then(|p| nest.around(*p))
        });
        let island = island.collect();
        Rings {
            nest,
            island,
            places: Places::new(outline),
        }
    }

    /// How far along its ring a mark is.
    fn place(&self, grid: &EdgeGrid, mark: &Mark) -> Mm {
        let (p, _) = grid.edge(mark.edge);
        self.places.begin(mark.edge) + p.distance(mark.at)
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
mod tests {
    use super::*;
    use crate::plane::path_length;
    use std::f64::consts::{PI, TAU};

    fn ring(points: &[(f64, f64)]) -> Vec<DVec2> {
        points.iter().map(|&(x, y)| DVec2::new(x, y)).collect()
    }

    fn circle(at: (f64, f64), r: f64, n: usize) -> Vec<DVec2> {
        (0..n)
            .map(|i| {
                DVec2::from(at)
                    + r * DVec2::from_angle(TAU * i as f64 / n as f64)
            })
            .collect()
    }

    fn hole(mut ring: Vec<DVec2>) -> Vec<DVec2> {
        ring.reverse();
        ring
    }

    fn way(
        rings: Vec<Vec<DVec2>>,
        a: (f64, f64),
        b: (f64, f64),
    ) -> Option<(f64, Vec<DVec2>)> {
        let area = Area { rings };
        let grid = EdgeGrid::new(&area, 0.5);
        let comb = Comb::new(&area, &grid, 0.5);
        let (a, b) = (a.into(), b.into());
        let points = comb.way(a, b, 1e3)?;
        let all: Vec<DVec2> = [&[a], &points[..], &[b]]
            .into_iter()
            .flatten()
            .copied()
            .collect();
        for pair in all.windows(2) {
            assert!(grid.crossings(pair[0], pair[1]).is_empty(), "{all:?}");
        }
        Some((path_length(&all, false), points))
    }

    const SQUARE: [(f64, f64); 4] =
        [(-20.0, -20.0), (20.0, -20.0), (20.0, 20.0), (-20.0, 20.0)];

    #[test]
    fn a_clear_way_is_straight() {
        let (_, points) =
            way(vec![ring(&SQUARE)], (-15.0, 3.0), (15.0, -8.0)).unwrap();
        assert!(points.is_empty());
    }

    #[test]
    fn round_a_hole_by_the_shorter_side() {
        // The tangents to the clearance's circle and the arc between them.
        let rings = vec![ring(&SQUARE), hole(circle((0.0, 1.0), 5.0, 400))];
        let (length, points) = way(rings, (-15.0, 0.0), (15.0, 0.0)).unwrap();
        assert!(points.iter().all(|p| p.y < 0.0), "{points:?}");
        let (r, d) = (5.5_f64, 226.0_f64.sqrt());
        let tangent = (d * d - r * r).sqrt();
        let turn = PI - 2.0 * (r / d).acos() - 2.0 * (1.0 / 15.0_f64).atan();
        let shortest = 2.0 * tangent + r * turn;
        assert!(
            (0.995..1.01).contains(&(length / shortest)),
            "{length} {shortest}"
        );
        assert!(points.len() < 12, "{points:?}");
    }

    #[test]
    fn through_a_spiral() {
        // A corridor 3 mm wide that winds inwards.
        let mut left = Vec::new();
        let mut right = Vec::new();
        for i in 0..=600 {
            let angle = TAU * 3.0 * f64::from(i) / 600.0;
            let r = 4.0 + 6.0 * angle / TAU;
            left.push((r - 1.5) * DVec2::from_angle(angle));
            right.push((r + 1.5) * DVec2::from_angle(angle));
        }
        left.reverse();
        right.extend(left);
        let (length, points) =
            way(vec![right], (4.0, 0.1), (22.0, -0.1)).unwrap();
        let middle: f64 = TAU * 3.0 * 13.0;
        assert!((0.8..1.0).contains(&(length / middle)), "{length} {middle}");
        assert!(points.len() < 90, "{}", points.len());
    }

    #[test]
    fn between_many_holes() {
        let mut rings = vec![ring(&SQUARE)];
        for i in -4..=4 {
            for j in -4..=4 {
                let at = (4.0 * f64::from(i), 4.0 * f64::from(j));
                rings.push(hole(circle(at, 1.4, 60)));
            }
        }
        let (length, points) =
            way(rings, (-18.5, -17.0), (18.0, 18.5)).unwrap();
        let straight = (36.5_f64 * 36.5 + 35.5 * 35.5).sqrt();
        assert!(length < 1.25 * straight, "{length} {straight}");
        assert!(points.len() < 60, "{}", points.len());
    }

    #[test]
    fn a_neck_narrower_than_the_clearance_is_passed() {
        let rings = vec![ring(&[
            (-10.0, -5.0),
            (-0.2, -5.0),
            (-0.2, -0.15),
            (0.2, -0.15),
            (0.2, -5.0),
            (10.0, -5.0),
            (10.0, 5.0),
            (0.2, 5.0),
            (0.2, 0.15),
            (-0.2, 0.15),
            (-0.2, 5.0),
            (-10.0, 5.0),
        ])];
        let (length, _) = way(rings, (-8.0, -4.0), (8.0, 4.0)).unwrap();
        assert!(length < 18.2, "{length}");
    }

    #[test]
    fn islands_are_not_left() {
        let rings =
            vec![circle((0.0, 0.0), 5.0, 90), circle((20.0, 0.0), 5.0, 90)];
        assert!(way(rings, (0.0, 0.0), (20.0, 0.0)).is_none());
        // An island in a hole is not the one around it.
        let rings = vec![
            circle((0.0, 0.0), 20.0, 90),
            hole(circle((0.0, 0.0), 10.0, 90)),
            circle((0.0, 0.0), 5.0, 90),
        ];
        assert!(way(rings.clone(), (0.0, 0.0), (15.0, 0.0)).is_none());
        // Past it there is a way.
        let (length, _) = way(rings, (-15.0, 0.1), (15.0, 0.1)).unwrap();
        assert!(length < 15.0 * PI, "{length}");
    }
}
