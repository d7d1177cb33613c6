//! Offset borders that run into each other, cut back where they meet.
//!
//! ```text
//!   ────────╲   ╱────────   The border has been moved inwards from both
//!            ╲ ╱            sides of a neck. The two fronts cross (×). Beyond
//!   - - - - - × - - - - -   the crossing each front is too near to the other's
//!            ╱ ╲            origin, and not part of the result. Before the
//!   ────────╱   ╲────────   crossing, each front goes on in the other.
//! ```
//!
//! In: rings whose edges have been moved, and a grid of their origins, the
//! edges they come from. Out: the rings without what is nearer to the origins
//! than it should be. Only edges that are too near in part, and those beside
//! them, are compared with each other: a sweep of all edges costs many times as
//! much.
//!
//! Three fronts may meet at one place, to within the tolerance. There the ends
//! and beginnings of what is left are as near to each other, and are joined.
//!
//! Fronts that graze each other may cross where no edge is too near by more
//! than the tolerance. Then what is left does not close, and all edges around
//! the loose ends are compared in a second round. If that does not help either,
//! nothing is returned, and the caller has to sweep.

use super::grid::{EdgeGrid, nearest_on};
use super::{Rect, Ring};
use glam::DVec2;
use isoslice_base::units::Mm;

/// How near a moved edge is to the origins.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum State {
    /// No origin is nearer than it should be.
    Clear,
    /// A part of the edge may be too near to an origin.
    Mixed,
    /// All of the edge is too near to an origin.
    Covered,
}

/// The state of the moved edge from `a` to `b`. `grid` has the origins of all
/// moved edges, and no origin should be nearer than `clearance`. `by` is an origin
/// by which the edge before is covered, if it is, and becomes this edge's.
pub(super) fn state(
    a: DVec2,
    b: DVec2,
    grid: &EdgeGrid,
    clearance: Mm,
    by: &mut Option<u32>,
) -> State {
    // In a thin strip, edges are covered by one origin after another. Only where
    // these do not cover it, all that are near are looked at.
    let covers = |edge: &u32| covers(a, b, grid, *edge, clearance);
    let beside = by.take().map(|last| grid.beside(last));
    *by = beside.and_then(|mut beside| beside.find(covers));
    if by.is_some() {
        return State::Covered;
    }
    let mut state = State::Clear;
    grid.near(a, b, clearance, |edge| {
        *by = Some(edge as u32).filter(covers);
        state = if by.is_some() {
            State::Covered
        } else {
            State::Mixed
        };
        by.is_none()
    });
    state
}

/// True if the whole of the moved edge from `a` to `b` is nearer than
/// `clearance` to an edge of the grid; false if there is no such edge.
pub(super) fn covers(
    a: DVec2,
    b: DVec2,
    grid: &EdgeGrid,
    edge: u32,
    clearance: Mm,
) -> bool {
    // The distance from a segment is convex, so it is greatest at an end.
    grid.get(edge).is_some_and(|(c, d)| {
        let far = |p: DVec2| p.distance_squared(nearest_on(p, c, d));
        let limit = clearance * clearance;
        far(a) < limit && far(b) < limit
    })
}

/// Bend of fronts that may just touch, mm. It tells how far beside a place that
/// is too near by more than the slack they may cross.
const BEND: Mm = 2.0;

/// How far around a loose end its continuation is looked for, mm.
const AROUND: Mm = 0.5;

/// Edges shorter than this tell nothing, mm: they may lie within the slack
/// beside what is dropped.
const SHORT: Mm = 0.02;

/// Parts of edges, beside a crossing or an edge that is too near, tell something if
/// they are longer, mm. Fronts that graze each other cross at places that differ by
/// about as much.
const LONG: Mm = 0.5;

/// How far the end of a piece may be from the beginning of the next one, as a
/// multiple of the slack.
const GAP: f64 = 3.0;

/// Share of the slack by which an edge that is certainly left is farther from
/// all origins than the clearance. It is all of the slack farther from its own.
const FAR: f64 = 0.6;

/// Points nearer to each other than this are one, mm.
const SAME: Mm = 1e-6;

/// Rings that have been moved, with their edges' states.
pub(super) struct Moved<'a> {
    /// The rings.
    pub rings: &'a [Ring],
    /// The states of all edges, ring by ring.
    pub states: Vec<State>,
    /// The origins: the edges from which the moved edges come.
    pub grid: &'a EdgeGrid,
    /// The least distance from the origins.
    pub clearance: Mm,
    /// By how much `clearance` is less than the distance that the edges have
    /// moved.
    pub slack: Mm,
    /// True if the edges have moved to their left.
    pub left: bool,
    /// True for each ring that has been turned inside out.
    pub turned: &'a [bool],
}

/// A place where two edges cross.
struct Crossing {
    at: DVec2,
    /// The events on the edge that ends here and on the edge that begins here,
    /// if the border goes on from one to the other.
    ends: usize,
    begins: usize,
}

/// A crossing, seen from one of its edges.
struct Event {
    ring: usize,
    /// Number of the ring's first edge.
    first: usize,
    /// Number of the edge in its ring.
    edge: usize,
    /// Where on the edge, from 0 to 1.
    t: f64,
    crossing: usize,
    /// The ring's next event. The stretch up to there has the number of the
    /// event with which it begins.
    next: usize,
    /// The ring's event before this one.
    last: usize,
}

/// Places that are taken one after another.
struct Places {
    grid: EdgeGrid,
    /// For each place, where it is, and whether it is still there.
    all: Vec<(DVec2, bool)>,
    /// How far from the place that was asked for one may be.
    reach: Mm,
}

impl Places {
    fn new(places: impl Iterator<Item = DVec2> + Clone, reach: Mm) -> Places {
        let points = places.clone().map(|p| (p, p)).enumerate();
        Places {
            grid: EdgeGrid::of(points, reach),
            all: places.map(|p| (p, true)).collect(),
            reach,
        }
    }

    /// Takes the nearest place that is within reach and still there.
    fn take_nearest(&mut self, p: DVec2) -> Option<usize> {
        let mut nearest: Option<(f64, usize)> = None;
        self.grid.visit_near(p, p, self.reach, |i| {
            let (at, there) = self.all[i];
            let this = (at.distance(p), i);
            if there && nearest.is_none_or(|best| this < best) {
                nearest = Some(this);
            }
        });
        let (_, i) = nearest?;
        self.all[i].1 = false;
        Some(i)
    }

    /// The numbers of the places that nobody took.
    fn left(&self) -> impl Iterator<Item = usize> {
        let all = self.all.iter().enumerate();
        all.filter_map(|(i, &(_, there))| there.then_some(i))
    }
}

impl Moved<'_> {
    /// What is left of the rings; none if that does not close.
    pub(super) fn trim(mut self) -> Option<Vec<Ring>> {
        let mut marked = self.marked();
        let loose = match self.cut_back(&marked) {
            Ok(rings) => return Some(rings),
            Err(loose) => loose,
        };
        let ends = loose.iter().map(|&p| (0, (p, p)));
        let ends = EdgeGrid::of(ends, AROUND);
        let mut edge = 0;
        let mut differs = false;
        for ring in self.rings {
            for (a, b) in super::edges(ring) {
                let (lo, hi) = (a.min(b) - AROUND, a.max(b) + AROUND);
                if ends.meets(Rect::new(lo, hi)) {
                    let now = state(a, b, self.grid, self.clearance, &mut None);
                    differs |= !marked[edge] || now != self.states[edge];
                    self.states[edge] = now;
                    marked[edge] = true;
                }
                edge += 1;
            }
        }
        // Of the same edges the same is left.
        differs.then(|| self.cut_back(&marked).ok()).flatten()
    }

    /// What is left of the rings if only marked edges cross.
    ///
    /// # Errors
    /// The places where what is left has a loose end.
    fn cut_back(&self, marked: &[bool]) -> Result<Vec<Ring>, Vec<DVec2>> {
        let (crossings, mut events) = self.crossings(marked);
        link(&mut events);
        let near: Vec<Option<DVec2>> =
            events.iter().map(|e| self.too_near(e, &events)).collect();
        // A crossing is live if the border goes on there from one edge to the
        // other.
        let live = |c: &Crossing| {
            near[events[c.ends].last].is_none() && near[c.begins].is_none()
        };
        let live: Vec<bool> = crossings.iter().map(live).collect();
        let mut gone: Vec<bool> = near.iter().map(Option::is_some).collect();
        for (c, _) in crossings.iter().zip(&live).filter(|(_, live)| **live) {
            gone[c.ends] = true;
            gone[events[c.begins].last] = true;
        }
        // For each piece that is left, the piece that follows it.
        let mut next: Vec<Option<usize>> = vec![None; events.len()];
        let mut entered = vec![false; events.len()];
        let mut loose = Vec::new();
        // Pieces whose end is loose, and what would follow.
        let mut ends = Vec::new();
        for piece in (0..events.len()).filter(|&i| !gone[i]) {
            let end = events[piece].next;
            let number = events[end].crossing;
            let c = &crossings[number];
            let follows = if live[number] { c.begins } else { end };
            let stray = live[number] && c.ends != end;
            if stray || gone[follows] || entered[follows] {
                ends.push((piece, follows));
                continue;
            }
            entered[follows] = true;
            next[piece] = Some(follows);
        }
        let at = |event: usize| crossings[events[event].crossing].at;
        let begins: Vec<usize> = (0..events.len())
            .filter(|&i| !gone[i] && !entered[i])
            .collect();
        let mut beginnings =
            Places::new(begins.iter().map(|&i| at(i)), GAP * self.slack);
        for (piece, follows) in ends {
            let end = events[piece].next;
            if let Some(i) = beginnings.take_nearest(at(end)) {
                next[piece] = Some(begins[i]);
                continue;
            }
            loose.push(at(end));
            // The missed crossing may be where the pieces that begin here
            // become too near.
            loose.extend(near[follows]);
            loose.extend(near[crossings[events[end].crossing].begins]);
        }
        let begins = beginnings.left().map(|i| begins[i]);
        for i in begins {
            loose.push(at(i));
            loose.extend(near[events[i].last]);
        }
        // A piece may be dropped only if it is too near all along. If it is
        // not, a crossing was missed.
        let dropped = (0..events.len()).filter(|&i| next[i].is_none());
        loose.extend(dropped.filter_map(|i| self.far(&events[i], &events)));
        let mut out = match self.untouched(&events) {
            Ok(rings) if loose.is_empty() => rings,
            Ok(_) => return Err(loose),
            Err(more) => {
                loose.extend(more);
                return Err(loose);
            }
        };
        for start in 0..events.len() {
            let mut ring = Ring::new();
            let mut piece = start;
            while let Some(follows) = next[piece].take() {
                ring.push(crossings[events[piece].crossing].at);
                self.points(&events[piece], &events, &mut ring);
                piece = follows;
            }
            ring.dedup_by(|a, b| a.distance_squared(*b) < SAME * SAME);
            if ring.len() >= 3 {
                out.push(ring);
            }
        }
        Ok(out)
    }

    /// Where marked edges cross.
    fn crossings(&self, marked: &[bool]) -> (Vec<Crossing>, Vec<Event>) {
        let mut suspects: Vec<(usize, usize, usize)> = Vec::new();
        let mut first = 0;
        for (r, ring) in self.rings.iter().enumerate() {
            // Edges that are too near all along cannot cross what is left.
            let crossed = |&k: &usize| {
                marked[first + k] && self.states[first + k] != State::Covered
            };
            let own = (0..ring.len()).filter(crossed);
            suspects.extend(own.map(|k| (r, first, k)));
            first += ring.len();
        }
        let edge = |(r, _, k): (usize, usize, usize)| {
            let ring = &self.rings[r];
            (ring[k], ring[(k + 1) % ring.len()])
        };
        let all = suspects.iter().enumerate().map(|(i, &s)| (i, edge(s)));
        let length: Mm = all.clone().map(|(_, (a, b))| a.distance(b)).sum();
        let mean = length / suspects.len().max(1) as f64;
        let grid = EdgeGrid::of(all, 2.0 * mean);
        let mut crossings = Vec::new();
        let mut events = Vec::new();
        let mut beside: Vec<usize> = Vec::new();
        for (i, &own) in suspects.iter().enumerate() {
            let (a, b) = edge(own);
            beside.clear();
            grid.visit_box(a.min(b), a.max(b), |e| beside.push(grid.owner(e)));
            beside.retain(|&j| j > i);
            beside.sort_unstable();
            beside.dedup();
            for &j in &beside {
                let other = suspects[j];
                let n = self.rings[own.0].len();
                let apart = (other.2 + n - own.2) % n;
                if own.0 == other.0 && (apart == 1 || apart + 1 == n) {
                    continue;
                }
                let (c, d) = edge(other);
                let Some((t, s)) = crossing(a, b, c, d) else {
                    continue;
                };
                let number = events.len();
                let event = |place: (usize, usize, usize), t: f64| Event {
                    ring: place.0,
                    first: place.1,
                    edge: place.2,
                    t,
                    crossing: crossings.len(),
                    next: 0,
                    last: 0,
                };
                events.push(event(own, t));
                events.push(event(other, s));
                // What lies ahead of both fronts is left. The front that
                // crosses towards the side from which the other has come ends
                // here.
                let left = (b - a).perp_dot(d - c) > 0.0;
                let (ends, begins) = if left == self.left {
                    (number, number + 1)
                } else {
                    (number + 1, number)
                };
                let at = a.lerp(b, t);
                crossings.push(Crossing { at, ends, begins });
            }
        }
        (crossings, events)
    }

    /// The edges whose crossings matter.
    fn marked(&self) -> Vec<bool> {
        let beside = (2.0 * BEND * self.slack).sqrt();
        let mut marked = vec![false; self.states.len()];
        let mut first = 0;
        for ring in self.rings {
            let n = ring.len();
            let states = &self.states[first..first + n];
            let marked = &mut marked[first..first + n];
            first += n;
            let Some(begin) = states.iter().position(|s| *s != State::Clear)
            else {
                continue;
            };
            let length = |k: usize| {
                ring[k].distance(ring[if k + 1 == n { 0 } else { k + 1 }])
            };
            // `left` is what is left of the way beside the last edge that is
            // not clear.
            let mut pass = |left: Mm, k: usize| {
                if states[k] == State::Clear && left <= 0.0 {
                    return left;
                }
                marked[k] = true;
                match states[k] {
                    State::Clear => left - length(k),
                    _ => beside,
                }
            };
            // The ring is walked both ways round, from an edge that is not
            // clear.
            (begin..n).chain(0..begin).fold(0.0, &mut pass);
            let back = (0..=begin).rev().chain((begin + 1..n).rev());
            back.fold(0.0, &mut pass);
        }
        marked
    }

    /// A place where the piece that begins with an event is too near to an
    /// origin.
    fn too_near(&self, begin: &Event, events: &[Event]) -> Option<DVec2> {
        let end = &events[begin.next];
        let ring = &self.rings[begin.ring];
        let n = ring.len();
        let count = edges_between(begin, end, n);
        (0..=count).find_map(|j| {
            let k = (begin.edge + j) % n;
            let from = if j == 0 { begin.t } else { 0.0 };
            let to = if j == count { end.t } else { 1.0 };
            let middle = ring[k].lerp(ring[(k + 1) % n], 0.5 * (from + to));
            let near = match self.states[begin.first + k] {
                State::Clear => false,
                State::Covered => true,
                State::Mixed => {
                    !self.grid.clear(middle, middle, self.clearance)
                }
            };
            near.then_some(middle)
        })
    }

    /// A place where the piece that begins with an event is certainly not too
    /// near to any origin: in the middle of an edge that is clear, or of its part
    /// before or after a crossing.
    fn far(&self, begin: &Event, events: &[Event]) -> Option<DVec2> {
        let end = &events[begin.next];
        let ring = &self.rings[begin.ring];
        let n = ring.len();
        let count = edges_between(begin, end, n);
        (0..=count).find_map(|j| {
            let k = (begin.edge + j) % n;
            let (a, b) = (ring[k], ring[(k + 1) % n]);
            let from = if j == 0 { a.lerp(b, begin.t) } else { a };
            let to = if j == count { a.lerp(b, end.t) } else { b };
            let state = self.states[begin.first + k];
            let whole = state == State::Clear && 0 < j && j < count;
            let tells = whole || from.distance(to) > LONG;
            let far = tells && self.surely_far(state, from, to);
            far.then(|| from.midpoint(to))
        })
    }

    /// True if a moved edge, or a part of it, is certainly part of what is left.
    fn surely_far(&self, state: State, a: DVec2, b: DVec2) -> bool {
        let p = a.midpoint(b);
        let distance = self.clearance + FAR * self.slack;
        // A mixed edge may have passed through a thin strip in part.
        let on_own_side = match state {
            State::Clear => true,
            State::Mixed => self.grid.contains(p) == self.left,
            State::Covered => false,
        };
        on_own_side && a.distance(b) > SHORT && self.grid.clear(p, p, distance)
    }

    /// The points between an event and the next.
    fn points(&self, begin: &Event, events: &[Event], out: &mut Ring) {
        let end = &events[begin.next];
        let ring = &self.rings[begin.ring];
        let n = ring.len();
        let count = edges_between(begin, end, n);
        out.extend((1..=count).map(|j| ring[(begin.edge + j) % n]));
    }

    /// The rings that no other ring crosses and that are far enough from all
    /// origins. A ring that is much thinner than the distance may be turned
    /// inside out; it is then on the wrong side, and left out.
    ///
    /// # Errors
    /// Places of a ring that is too near to origins in part only: it should
    /// have been crossed. There are no places if it has turned in part only, as a
    /// needle does.
    fn untouched(&self, events: &[Event]) -> Result<Vec<Ring>, Vec<DVec2>> {
        let mut touched = vec![false; self.rings.len()];
        for event in events {
            touched[event.ring] = true;
        }
        let mut first = 0;
        let mut out = Vec::new();
        for (r, ring) in self.rings.iter().enumerate() {
            let states = &self.states[first..first + ring.len()];
            first += ring.len();
            let far = |(&state, (a, b)): (&State, (DVec2, DVec2))| match state {
                State::Clear => true,
                State::Covered => false,
                State::Mixed => {
                    let p = a.midpoint(b);
                    self.grid.clear(p, p, self.clearance)
                }
            };
            if touched[r] {
                continue;
            }
            let edges = || states.iter().zip(super::edges(ring));
            if !self.turned[r] && edges().all(far) {
                out.push(ring.clone());
                continue;
            }
            if edges().any(|(&state, (a, b))| self.surely_far(state, a, b)) {
                let near = edges().filter(|&e| !far(e));
                return Err(near.map(|(_, (a, b))| a.midpoint(b)).collect());
            }
        }
        Ok(out)
    }
}

/// How many edges of a ring of `n` begin between two events on it.
fn edges_between(begin: &Event, end: &Event, n: usize) -> usize {
    match (end.edge + n - begin.edge) % n {
        0 if end.t > begin.t => 0,
        0 => n,
        count => count,
    }
}

/// Links each event with those before and after it on its ring.
fn link(events: &mut [Event]) {
    let mut order: Vec<usize> = (0..events.len()).collect();
    order.sort_by(|&i, &j| {
        let (a, b) = (&events[i], &events[j]);
        let place = |e: &Event| (e.ring, e.edge);
        place(a).cmp(&place(b)).then(a.t.total_cmp(&b.t))
    });
    let mut from = 0;
    while from < order.len() {
        let ring = events[order[from]].ring;
        let own = |&i: &usize| events[i].ring == ring;
        let to = from + order[from..].iter().take_while(|i| own(i)).count();
        for k in from..to {
            let next = if k + 1 == to { from } else { k + 1 };
            events[order[k]].next = order[next];
            events[order[next]].last = order[k];
        }
        from = to;
    }
}

/// Where two segments cross, from 0 to 1 along each. A point on a line counts
/// as right of the line in every test. So a line through a vertex crosses one
/// of the vertex's edges, or both, or none.
fn crossing(a: DVec2, b: DVec2, c: DVec2, d: DVec2) -> Option<(f64, f64)> {
    let left = |p: DVec2, q: DVec2, r: DVec2| (q - p).perp_dot(r - p) > 0.0;
    if left(a, b, c) == left(a, b, d) || left(c, d, a) == left(c, d, b) {
        return None;
    }
    let (u, v) = (b - a, d - c);
    let det = u.perp_dot(v);
    let t = (c - a).perp_dot(v) / det;
    let s = (c - a).perp_dot(u) / det;
    (t.is_finite() && s.is_finite())
        .then(|| (t.clamp(0.0, 1.0), s.clamp(0.0, 1.0)))
}

#[cfg(test)]
mod tests {
    use super::super::offset::moved;
    use super::super::shapes::rect;
    use super::super::{Area, edges};
    use super::*;
    use std::f64::consts::PI;

    const TOLERANCE: Mm = 1e-3;
    const ALLOWED: Mm = 1.02 * TOLERANCE + 1e-6;

    /// The area's rings moved inwards, with their edges' exact states.
    struct Shrunk {
        rings: Vec<Ring>,
        grid: EdgeGrid,
        clearance: Mm,
        states: Vec<State>,
    }

    fn shrunk(area: &Area, by: Mm) -> Shrunk {
        let grid = EdgeGrid::new(area, by);
        let mut origins = Vec::new();
        let rings: Vec<Ring> = area
            .rings
            .iter()
            .map(|r| moved(r, by, TOLERANCE, &mut origins))
            .collect();
        let clearance = by - ALLOWED;
        let all = rings.iter().flat_map(|r| edges(r));
        let mut by = None;
        let states = all
            .map(|(a, b)| state(a, b, &grid, clearance, &mut by))
            .collect();
        Shrunk {
            rings,
            grid,
            clearance,
            states,
        }
    }

    impl Shrunk {
        fn trim(&self) -> Option<Area> {
            let turned = vec![false; self.rings.len()];
            let moved = Moved {
                rings: &self.rings,
                states: self.states.clone(),
                grid: &self.grid,
                clearance: self.clearance,
                slack: ALLOWED,
                left: true,
                turned: &turned,
            };
            moved.trim().map(|rings| Area { rings })
        }
    }

    fn hole(x: f64, y: f64, r: f64) -> Ring {
        let n = 360;
        (0..n)
            .map(|i| DVec2::from_angle(-2.0 * PI * f64::from(i) / 360.0))
            .map(|p| DVec2::new(x, y) + p * r)
            .collect()
    }

    /// Content that two discs of radius `r` whose middles are `apart` have in
    /// common.
    fn lens(r: f64, apart: f64) -> f64 {
        let half = (apart / (2.0 * r)).acos();
        2.0 * r * r * half - 0.5 * apart * (4.0 * r * r - apart * apart).sqrt()
    }

    #[test]
    fn an_edge_is_clear_mixed_or_covered() {
        let wall = rect(0.0, 0.0, 10.0, 1.0);
        let grid = EdgeGrid::new(&wall, 1.0);
        let of = |x0: f64, y0: f64, x1: f64, y1: f64| {
            let [a, b] = [DVec2::new(x0, y0), DVec2::new(x1, y1)];
            state(a, b, &grid, 0.5, &mut None)
        };
        assert_eq!(of(2.0, 1.51, 8.0, 1.51), State::Clear);
        assert_eq!(of(2.0, 1.49, 8.0, 1.49), State::Covered);
        assert_eq!(of(2.0, 1.6, 8.0, 1.4), State::Mixed);
        // Beyond the wall's end only a part of it is near.
        assert_eq!(of(8.0, 1.4, 12.0, 1.4), State::Mixed);
        // Round its corner, 0.5 off in the diagonal.
        let off = |d: f64| 1.0 + d * 0.5_f64.sqrt();
        let corner = |d: f64| of(9.0 + off(d), off(d), 9.0 + off(d), off(d));
        assert_eq!(corner(0.501), State::Clear);
        assert_eq!(corner(0.499), State::Covered);
        let near = |edge| {
            let (a, b) = (DVec2::new(2.0, 1.4), DVec2::new(8.0, 1.4));
            covers(a, b, &grid, edge, 0.5)
        };
        // The upper side, another side, and a number without an edge.
        assert_eq!([2, 0, 77].map(near), [true, false, false]);
    }

    #[test]
    fn a_neck_is_cut_back_to_where_its_sides_cross() {
        // Two squares of 4 mm and a neck of 2 mm, 0.4 mm wide.
        let bell = [
            (0.0, 0.0),
            (4.0, 0.0),
            (4.0, 1.8),
            (6.0, 1.8),
            (6.0, 0.0),
            (10.0, 0.0),
            (10.0, 4.0),
            (6.0, 4.0),
            (6.0, 2.2),
            (4.0, 2.2),
            (4.0, 4.0),
            (0.0, 4.0),
        ];
        let ring = bell.map(DVec2::from).to_vec();
        let area = Area::from(ring);
        let by = 0.5;
        let left = shrunk(&area, by).trim().unwrap();
        assert_eq!(left.rings.len(), 2);
        // Each square keeps 3 by 3 mm and, between the arcs around the neck's
        // corners, what is beyond its side.
        let up = (by * by - 0.04_f64).sqrt();
        let sector = by * by * (0.2 / by).asin();
        let bulge = 0.4 * by - (0.2 * up + sector);
        let exact = 2.0 * (9.0 + bulge);
        let perimeter = left.perimeter();
        assert!((left.content() - exact).abs() < TOLERANCE * perimeter);
        // The tip of the bulge is where the arcs cross.
        let tip = left.rings.iter().flatten().map(|p| p.x);
        let tip = tip.filter(|x| *x < 5.0).fold(0.0, f64::max);
        assert!((tip - (4.0 - up)).abs() < 2.0 * TOLERANCE, "{tip}");
    }

    #[test]
    fn holes_that_grow_into_each_other_become_one() {
        let mut area = rect(-10.0, -10.0, 10.0, 10.0);
        area.rings
            .extend([hole(-2.0, 0.0, 1.5), hole(2.0, 0.0, 1.5)]);
        for by in [0.49, 0.505, 0.6, 1.3] {
            let all = shrunk(&area, by);
            let left = all.trim().unwrap();
            let (r, side) = (1.5 + by, 20.0 - 2.0 * by);
            let common = if r > 2.0 { lens(r, 4.0) } else { 0.0 };
            let exact = side * side - 2.0 * PI * r * r + common;
            let off = left.content() - exact;
            assert!(off.abs() < TOLERANCE * left.perimeter(), "{by}: {off}");
            let rings = if r > 2.0 { 2 } else { 3 };
            assert_eq!(left.rings.len(), rings, "{by}");
        }
    }

    /// Three fronts meet nearly at one place: what is between them vanishes
    /// within the tolerance.
    #[test]
    fn three_fronts_meet_at_one_place() {
        let side: f64 = 4.0;
        let r = 1.5;
        let mut area = rect(-10.0, -10.0, 10.0, 10.0);
        let middle = side / 3.0_f64.sqrt();
        for i in 0..3 {
            let turn = DVec2::from_angle(2.0 * PI * f64::from(i) / 3.0 + 0.1);
            let p = turn * middle;
            area.rings.push(hole(p.x, p.y, r));
        }
        let mut trimmed = 0;
        for off in -20..=20 {
            let by = middle - r + 2e-4 * f64::from(off);
            let Some(left) = shrunk(&area, by).trim() else {
                continue;
            };
            trimmed += 1;
            let (big, inner) = (r + by, 20.0 - 2.0 * by);
            // What is left in the middle, or counted thrice, is nothing.
            let discs = 3.0 * (PI * big * big - lens(big, side));
            let exact = inner * inner - discs;
            let error = left.content() - exact;
            let limit = TOLERANCE * left.perimeter();
            assert!(error.abs() < limit, "{off}: {error}");
        }
        assert!(trimmed > 30, "{trimmed}");
    }

    #[test]
    fn what_is_too_near_all_along_vanishes() {
        let mut ring = hole(0.0, 0.0, 5.0);
        ring.reverse();
        let thin = Area::from_iter([ring, hole(0.0, 0.0, 4.3)]);
        assert!(shrunk(&thin, 0.4).trim().unwrap().is_empty());
        let left = shrunk(&thin, 0.3).trim().unwrap();
        let exact = PI * (4.7_f64.powi(2) - 4.6_f64.powi(2));
        assert!((left.content() - exact).abs() < TOLERANCE * 2.0 * PI * 9.3);
    }

    /// States that are wrong must not cost a wall: either the border closes
    /// anyway, or the result is none.
    #[test]
    fn wrong_states_never_lose_a_wall() {
        let mut area = rect(-10.0, -10.0, 10.0, 10.0);
        area.rings
            .extend([hole(-2.0, 0.0, 1.5), hole(2.0, 0.0, 1.5)]);
        let mut all = shrunk(&area, 0.6);
        let exact = all.trim().unwrap().content();
        let states = all.states.clone();
        let n = states.len();
        for from in (0..n).step_by(7) {
            for count in [1, 3, n / 5] {
                all.states.clone_from(&states);
                for k in from..from + count {
                    all.states[k % n] = State::Covered;
                }
                if let Some(left) = all.trim() {
                    let off = left.content() - exact;
                    assert!(off.abs() < 0.01, "{from} {count}: {off}");
                }
            }
        }
    }

    #[test]
    fn segments_cross_once_however_they_touch() {
        let p = DVec2::new;
        let at = crossing(p(0.0, 0.0), p(4.0, 0.0), p(1.0, -1.0), p(1.0, 3.0));
        assert_eq!(at, Some((0.25, 0.25)));
        let beside =
            crossing(p(0.0, 0.0), p(4.0, 0.0), p(5.0, -1.0), p(5.0, 3.0));
        assert_eq!(beside, None);
        // A line through a vertex crosses one of the edges there.
        let count = [(p(1.0, 1.0), p(2.0, 0.0)), (p(2.0, 0.0), p(3.0, -1.0))]
            .into_iter()
            .filter(|&(c, d)| {
                crossing(p(0.0, 0.0), p(4.0, 0.0), c, d).is_some()
            })
            .count();
        assert_eq!(count, 1);
        // A corner that only touches it crosses it twice or not at all.
        let count = [(p(1.0, 1.0), p(2.0, 0.0)), (p(2.0, 0.0), p(3.0, 1.0))]
            .into_iter()
            .filter(|&(c, d)| {
                crossing(p(0.0, 0.0), p(4.0, 0.0), c, d).is_some()
            })
            .count();
        assert_eq!(count % 2, 0);
    }
}
