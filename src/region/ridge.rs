//! The middle of places too thin for two beads side by side.
//!
//! ```text
//!   ━━━━━━━━━━p━━━━━━━━━━━   From a point p of the border a ball grows
//!         ╭── │ ──╮           inwards until it touches the border elsewhere:
//!   ┄┄┄┄┄┄┄┄┄┄c┄┄┄┄┄┄┄┄┄┄┄    its centre c is on the ridge of the distance
//!         ╰── │ ──╯           to the border (the medial axis), its diameter
//!   ━━━━━━━━━━q━━━━━━━━━━━    is the local thickness.
//! ```
//!
//! In: an area and the thickness below which a place is thin. Out: the
//! ridge's lines there, with the thickness at each point. Both sides of a
//! strip give the same line; one of them is asked. Balls that touch two sides of a
//! corner, and not opposite sides, are left out: the ridge's branches into
//! corners are not places for a bead.
//!
//! The balls shrink as in Ma, Bae and Choi, 3D medial axis point
//! approximation using nearest neighbors and the normal field (2012).
//!
//! Not guaranteed: that lines meet where three strips do; they end within
//! about a third of the thickness of each other.

use crate::plane::grid::{EdgeGrid, nearest_on};
use crate::plane::{Area, edges};
use crate::units::Mm;
use glam::DVec2;

/// A line along the middle of a thin place.
#[derive(Clone, Debug, PartialEq)]
pub struct Ridge {
    /// Points of the line.
    pub points: Vec<DVec2>,
    /// Thickness of the area at each point.
    pub thickness: Vec<Mm>,
    /// The line returns to its first point: a thin ring.
    pub closed: bool,
}

/// A point of the ridge and the thickness there.
#[derive(Clone, Copy, Debug)]
struct Ball {
    centre: DVec2,
    thickness: Mm,
}

/// Balls that follow each other along the border.
struct Run {
    balls: Vec<Ball>,
    closed: bool,
}

/// Distance of the balls along the border, mm: shorter edges get one each.
const STEP: Mm = 0.2;
/// How exactly the end of a ridge is looked for along the border, mm.
const END: Mm = 0.005;
/// Turn of the border at a corner, and between balls that touch the corner.
const FAN: f64 = 0.35;
/// Distance of ball and border below which they touch, mm.
const TOUCHING: Mm = 1e-5;

/// The ridges of an area where it is thinner than `limit`. `grid` holds the
/// area's edges. Lines are thinned to `tolerance`, in place and thickness.
pub fn ridges(
    area: &Area,
    grid: &EdgeGrid,
    limit: Mm,
    tolerance: Mm,
) -> Vec<Ridge> {
    let mut border = Border {
        grid,
        radius: 0.5 * limit,
        seen: Seen::new(area.rings.iter().map(Vec::len).sum()),
        next: Vec::new(),
        last: Vec::new(),
    };
    for ring in &area.rings {
        let first = border.next.len() as u32;
        let n = ring.len() as u32;
        border.next.extend((1..n).map(|k| first + k));
        border.next.extend((n > 0).then_some(first));
        border
            .last
            .extend((n > 0).then_some(first + n.wrapping_sub(1)));
        border.last.extend((1..n).map(|k| first + k - 1));
    }
    let mut runs: Vec<Run> = Vec::new();
    let mut first_edge = 0;
    for ring in &area.rings {
        let balls = border.balls(ring, first_edge);
        split_runs(&balls, grid, &mut runs);
        first_edge += ring.len();
    }
    join(&mut runs, grid);
    runs.into_iter()
        .filter(|run| run.closed || run.balls.len() > 1)
        .map(|run| {
            let balls = run.balls.iter();
            let ridge = Ridge {
                points: balls.clone().map(|b| b.centre).collect(),
                thickness: balls.map(|b| b.thickness).collect(),
                closed: run.closed,
            };
            ridge.thinned(tolerance)
        })
        .collect()
}

/// The stretches of edges that balls from the other side touch: asked again
/// from this side, they would give the same ridge.
struct Seen {
    /// Each edge's last entry in `stretches`; `NONE` without one.
    last: Vec<u32>,
    /// From where to where along an edge, and the entry before it.
    stretches: Vec<(Mm, Mm, u32)>,
}

const NONE: u32 = u32::MAX;

impl Seen {
    fn new(edges: usize) -> Seen {
        Seen {
            last: vec![NONE; edges],
            stretches: Vec::new(),
        }
    }

    fn add(&mut self, edge: usize, from: Mm, to: Mm) {
        let entry = self.stretches.len() as u32;
        self.stretches
            .push((from.min(to), from.max(to), self.last[edge]));
        self.last[edge] = entry;
    }

    fn has(&self, edge: usize, at: Mm) -> bool {
        let mut entry = self.last[edge];
        while let Some(&(from, to, before)) = self.stretches.get(entry as usize)
        {
            if (from..=to).contains(&at) {
                return true;
            }
            entry = before;
        }
        false
    }
}

/// What balls are grown from.
struct Border<'a> {
    grid: &'a EdgeGrid,
    /// Largest radius that matters.
    radius: Mm,
    /// The edge that follows each edge on its ring.
    next: Vec<u32>,
    /// The edge before it.
    last: Vec<u32>,
    seen: Seen,
}

/// A ball and where it touches the other side.
#[derive(Clone, Copy)]
struct Grown {
    ball: Ball,
    edge: usize,
    touch: DVec2,
}

impl Border<'_> {
    /// Balls of points all along a ring, in order; none where the area is
    /// thick, and none where another ball has come from the other side. The
    /// ring's edges are numbered from `first_edge`, as in the grid.
    fn balls(
        &mut self,
        ring: &[DVec2],
        first_edge: usize,
    ) -> Vec<Option<Ball>> {
        let mut balls = Vec::with_capacity(ring.len());
        // The last ball, its edge, and how far along the edge it is.
        let mut before: Option<(usize, Mm, Option<Grown>)> = None;
        // The first one, if there was one right away.
        let mut very_first = None;
        let mut last_along = (0..ring.len()).rev().find_map(|i| {
            let (a, b) = (ring[i], ring[(i + 1) % ring.len()]);
            (b - a).try_normalize()
        });
        for (number, (a, b)) in (first_edge..).zip(edges(ring)) {
            let along = b - a;
            let length = along.length();
            if length == 0.0 {
                continue;
            }
            let along = along / length;
            let normal = along.perp();
            let turn = match last_along {
                Some(last) => DVec2::angle_to(last, along),
                None => 0.0,
            };
            last_along = Some(along);
            if turn < -FAN {
                let first = self.fan(a, number, normal, -turn, &mut balls);
                before = first.map(|g| (number, 0.0, Some(g)));
            }
            // Nothing within reach of the whole edge's centres: no ball
            // shrinks. A little less than the radius, or every edge would
            // meet the next.
            let up = normal * self.radius;
            let beside = before.is_some_and(|b| b.2.is_some());
            if !beside && self.grid.clear(a + up, b + up, 0.98 * self.radius) {
                balls.push(None);
                before = None;
                continue;
            }
            let count = (length / STEP).ceil().clamp(1.0, 1e6);
            for k in 0..count as usize {
                let at = (k as f64 + 0.5) / count * length;
                if self.seen.has(number, at) {
                    balls.push(None);
                    before = None;
                    continue;
                }
                let hint = before.and_then(|b| b.2);
                let here = self.grow(a + along * at, normal, hint);
                let on_edge = |at: Mm, border: &Border<'_>| {
                    border.grow(a + along * at, normal, hint)
                };
                match (before, here) {
                    (Some((edge, from, Some(g))), None) if edge == number => {
                        let end = self.end(from, g, at, on_edge);
                        balls.push(Some(end.ball));
                        self.mark(g, end);
                    }
                    (Some((edge, from, None)), Some(g)) if edge == number => {
                        let begin = self.end(at, g, from, on_edge);
                        balls.push(Some(begin.ball));
                        self.mark(begin, g);
                    }
                    (Some((_, _, Some(f))), Some(g)) => self.mark(f, g),
                    _ => {}
                }
                if balls.is_empty() {
                    very_first = here;
                }
                balls.push(here.map(|g| g.ball));
                before = Some((number, at, here));
            }
        }
        if let (Some((_, _, Some(last))), Some(first)) = (before, very_first) {
            self.mark(last, first);
        }
        balls
    }

    /// Balls that touch the corner at the start of an edge with this
    /// `normal`, where the border turns by `turn` away from the area: the last
    /// of them.
    fn fan(
        &mut self,
        corner: DVec2,
        number: usize,
        normal: DVec2,
        turn: f64,
        balls: &mut Vec<Option<Ball>>,
    ) -> Option<Grown> {
        let count = (turn / FAN).ceil();
        let mut before: Option<Grown> = None;
        for k in 0..count as usize {
            let angle = turn * (1.0 - (k as f64 + 0.5) / count);
            let normal = DVec2::from_angle(angle).rotate(normal);
            let here = self.grow(corner, normal, None).filter(|g| {
                // Of two corners the first one has the balls, and of a corner
                // and an edge as well.
                let (a, b) = self.grid.edge(g.edge);
                match g.touch {
                    q if q.distance(a) < TOUCHING => number < g.edge,
                    q if q.distance(b) < TOUCHING => {
                        number < self.next[g.edge] as usize
                    }
                    _ => number < g.edge,
                }
            });
            if let (Some(f), Some(g)) = (before, here) {
                self.mark(f, g);
            }
            balls.push(here.map(|g| g.ball));
            before = here;
        }
        before
    }

    /// The last ball on the way from where there is one to where there is
    /// none.
    fn end(
        &self,
        mut from: Mm,
        mut last: Grown,
        mut to: Mm,
        grow: impl Fn(Mm, &Border<'_>) -> Option<Grown>,
    ) -> Grown {
        while (to - from).abs() > END {
            let middle = 0.5 * (from + to);
            match grow(middle, self) {
                Some(g) => (from, last) = (middle, g),
                None => to = middle,
            }
        }
        last
    }

    /// Notes what lies between the touches of two balls that follow each
    /// other: the border runs the other way there.
    fn mark(&mut self, first: Grown, second: Grown) {
        /// Edges and length beyond which the two touch different parts of
        /// the border.
        const FEW: usize = 8;
        const LONG: Mm = 5.0 * STEP;
        if !first.ball.near(&second.ball) {
            return;
        }
        let mut stretch = [(0, 0.0, 0.0); FEW];
        let mut length = 0.0;
        let mut edge = second.edge;
        for k in 0..FEW {
            let (a, b) = self.grid.edge(edge);
            let low = match edge == second.edge {
                true => second.touch.distance(a),
                false => 0.0,
            };
            let last = edge == first.edge;
            let high = match last {
                true => first.touch.distance(a),
                false => a.distance(b),
            };
            stretch[k] = (edge, low, high);
            length += (high - low).abs();
            if length > LONG {
                return;
            }
            if last {
                for (edge, low, high) in stretch.into_iter().take(k + 1) {
                    self.seen.add(edge, low, high);
                }
                return;
            }
            edge = self.next[edge] as usize;
        }
    }

    /// The largest ball that touches the border at `p`, if it is smaller
    /// than all that matter and touches the opposite side as well. `hint` is
    /// one from nearby.
    fn grow(
        &self,
        p: DVec2,
        normal: DVec2,
        hint: Option<Grown>,
    ) -> Option<Grown> {
        let guess = hint.and_then(|h| self.beside(p, normal, h));
        let (r, touch) = match guess {
            Some((r, touch)) => {
                let (r, nearer) = self.shrink(p, normal, r)?;
                (r, nearer.or(Some(touch)))
            }
            None => self.shrink(p, normal, self.radius)?,
        };
        let (edge, q) = touch?;
        let centre = p + normal * r;
        // Seen from the centre, p and q are more than 120° apart.
        let opposite = (p - centre).dot(q - centre) < -0.5 * r * r;
        let ball = Ball {
            centre,
            thickness: 2.0 * r,
        };
        opposite.then_some(Grown {
            ball,
            edge,
            touch: q,
        })
    }

    /// The radius of a ball at `p` that touches the border where another did,
    /// or beside that: nothing larger fits there.
    fn beside(
        &self,
        p: DVec2,
        normal: DVec2,
        hint: Grown,
    ) -> Option<(Mm, (usize, DVec2))> {
        /// Rounds after which it is near enough to be looked after.
        const ROUNDS: usize = 6;
        let (before, after) = (self.last[hint.edge], self.next[hint.edge]);
        let beside = [hint.edge, before as usize, after as usize];
        let mut r = (0.75 * hint.ball.thickness).min(self.radius);
        let mut touch = None;
        for _ in 0..ROUNDS {
            let centre = p + normal * r;
            let near = |edge: usize| {
                let (a, b) = self.grid.edge(edge);
                let q = nearest_on(centre, a, b);
                (q.distance_squared(centre), edge, q)
            };
            let (d, edge, q) = beside
                .map(near)
                .into_iter()
                .min_by(|a, b| a.0.total_cmp(&b.0))?;
            if d >= (r - TOUCHING).max(0.0).powi(2) {
                break;
            }
            let v = q - p;
            let up = normal.dot(v);
            if up <= TOUCHING {
                return None;
            }
            touch = Some((edge, q));
            r = v.length_squared() / (2.0 * up);
        }
        touch.map(|t| (r, t))
    }

    /// The ball of radius `r` at `p` shrunk until nothing of the border is in
    /// it: its radius, and the point of the border that it touches last.
    fn shrink(
        &self,
        p: DVec2,
        normal: DVec2,
        mut r: Mm,
    ) -> Option<(Mm, Option<(usize, DVec2)>)> {
        /// Rounds after which a ball that still shrinks is given up: each
        /// brings it to touch a nearer edge, and few edges are near.
        const ROUNDS: usize = 16;
        let mut touch = None;
        for _ in 0..ROUNDS {
            let centre = p + normal * r;
            let near = self
                .grid
                .nearest_edge(centre, r - TOUCHING)
                .filter(|(_, q)| q.distance_squared(p) > TOUCHING * TOUCHING);
            let Some((edge, q)) = near else { break };
            let v = q - p;
            let up = normal.dot(v);
            if up <= 0.0 {
                return None;
            }
            touch = Some((edge, q));
            r = v.length_squared() / (2.0 * up);
        }
        Some((r, touch))
    }
}

impl Ball {
    /// True if the two can follow each other on a ridge.
    fn near(&self, other: &Ball) -> bool {
        let apart = self.centre.distance_squared(other.centre);
        apart
            < (2.0 * STEP + 0.25 * self.thickness.min(other.thickness)).powi(2)
    }
}

/// Cuts a ring's balls into runs of neighbours.
fn split_runs(balls: &[Option<Ball>], grid: &EdgeGrid, runs: &mut Vec<Run>) {
    let n = balls.len();
    let follows = |i: usize| {
        let (a, b) = (&balls[i % n], &balls[(i + 1) % n]);
        match (a, b) {
            // Close together, they have turned with the border.
            (Some(a), Some(b)) => {
                a.near(b) && (a.close(b) || a.leads_to(b, grid))
            }
            _ => false,
        }
    };
    // Begin behind a break; without one the run is closed.
    let Some(start) = (0..n).find(|&i| !follows(i)) else {
        let all: Vec<Ball> = balls.iter().copied().flatten().collect();
        if !all.is_empty() {
            runs.push(Run {
                balls: all,
                closed: true,
            });
        }
        return;
    };
    let mut run = Vec::new();
    for i in start + 1..=start + n {
        run.extend(balls[i % n]);
        if !follows(i) && !run.is_empty() {
            runs.push(Run {
                balls: std::mem::take(&mut run),
                closed: false,
            });
        }
    }
}

/// Joins runs that end where another begins: along a strip the balls change
/// sides where the border's numbering begins anew.
fn join(runs: &mut Vec<Run>, grid: &EdgeGrid) {
    /// Runs beyond which the few that could be joined are not worth it.
    const MANY: usize = 2000;
    let mut i = 0;
    while i < runs.len() && runs.len() <= MANY {
        let next = (0..runs.len())
            .filter(|&j| j != i)
            .find_map(|j| Some((j, runs[i].meets(&runs[j], grid)?)));
        let Some((j, meeting)) = next else {
            i += 1;
            continue;
        };
        let mut other = runs[j].balls.clone();
        if meeting.turn_other {
            other.reverse();
        }
        let run = &mut runs[i].balls;
        if meeting.turn_this {
            run.reverse();
        }
        run.extend(other);
        runs.remove(j);
        i = i.min(j);
    }
    for run in runs {
        let ends = (run.balls.first(), run.balls.last());
        let meet = matches!(ends, (Some(a), Some(b)) if a.meets(b, grid));
        run.closed |= meet && run.length() > 8.0 * STEP;
    }
}

/// What has to be turned for one run to go on in another.
struct Meeting {
    turn_this: bool,
    turn_other: bool,
}

impl Ball {
    /// True if runs that end with these two are one.
    fn meets(&self, other: &Ball, grid: &EdgeGrid) -> bool {
        let far = (1.5 * STEP).max(1.1 * self.thickness);
        self.centre.distance_squared(other.centre) < far * far
            && (self.thickness - other.thickness).abs() < 0.4 * STEP
            && self.leads_to(other, grid)
    }

    fn close(&self, other: &Ball) -> bool {
        let apart = self.centre.distance_squared(other.centre);
        apart < (1.5 * STEP).powi(2)
    }

    /// True if a bead from one to the other stays inside the border.
    fn leads_to(&self, other: &Ball, grid: &EdgeGrid) -> bool {
        /// By how much it may stick out, mm.
        const OUT: Mm = 0.01;
        let apart = self.centre.distance_squared(other.centre);
        let radius = 0.25 * (self.thickness + other.thickness) - OUT;
        apart < (0.5 * STEP).powi(2)
            || radius <= 0.0
            || grid
                .nearest_edge(self.centre.midpoint(other.centre), radius)
                .is_none()
    }
}

impl Run {
    fn length(&self) -> Mm {
        self.balls
            .windows(2)
            .map(|w| w[0].centre.distance(w[1].centre))
            .sum()
    }

    fn meets(&self, other: &Run, grid: &EdgeGrid) -> Option<Meeting> {
        if self.closed || other.closed {
            return None;
        }
        let mine = (self.balls.first()?, self.balls.last()?);
        let theirs = (other.balls.first()?, other.balls.last()?);
        let turned = |turn_this, turn_other| {
            Some(Meeting {
                turn_this,
                turn_other,
            })
        };
        if mine.1.meets(theirs.0, grid) {
            turned(false, false)
        } else if mine.1.meets(theirs.1, grid) {
            turned(false, true)
        } else if mine.0.meets(theirs.0, grid) {
            turned(true, false)
        } else if mine.0.meets(theirs.1, grid) {
            turned(true, true)
        } else {
            None
        }
    }
}

impl Ridge {
    /// The line with as few points as the tolerance permits (Douglas and
    /// Peucker 1973), half the thickness counting as a third coordinate.
    pub(super) fn thinned(&self, tolerance: Mm) -> Ridge {
        let at = |i: usize| self.points[i].extend(0.5 * self.thickness[i]);
        let Some(last) = self.points.len().checked_sub(1) else {
            return self.clone();
        };
        let mut keep = vec![false; self.points.len()];
        (keep[0], keep[last]) = (true, true);
        let mut todo = vec![(0, last)];
        while let Some((i, j)) = todo.pop() {
            let (a, b) = (at(i), at(j));
            let along = b - a;
            let off = |k: usize| {
                let t = (at(k) - a).dot(along) / along.length_squared();
                let t = if t.is_finite() {
                    t.clamp(0.0, 1.0)
                } else {
                    0.0
                };
                at(k).distance(a + along * t)
            };
            let worst = (i + 1..j)
                .map(|k| (off(k), k))
                .max_by(|p, q| p.0.total_cmp(&q.0));
            if let Some((d, k)) = worst
                && d > tolerance
            {
                keep[k] = true;
                todo.extend([(i, k), (k, j)]);
            }
        }
        let kept = || (0..=last).filter(|&i| keep[i]);
        Ridge {
            points: kept().map(|i| self.points[i]).collect(),
            thickness: kept().map(|i| self.thickness[i]).collect(),
            closed: self.closed,
        }
    }

    /// The ridge cut where its thickness passes `limit`: each part is above
    /// or below it all along.
    pub(super) fn split_at(self, limit: Mm) -> Vec<Ridge> {
        let above = |t: Mm| t > limit;
        let n = self.points.len();
        let first = self.thickness.first().copied().unwrap_or(0.0);
        if self.thickness.iter().all(|&t| above(t) == above(first)) {
            return vec![self];
        }
        let mut parts: Vec<Ridge> = Vec::new();
        let segments = if self.closed { n } else { n - 1 };
        let mut part = Ridge {
            points: vec![self.points[0]],
            thickness: vec![first],
            closed: false,
        };
        for k in 0..segments {
            let (i, j) = (k, (k + 1) % n);
            let (a, b) = (self.thickness[i], self.thickness[j]);
            if above(a) != above(b) {
                let t = (limit - a) / (b - a);
                let p = self.points[i].lerp(self.points[j], t);
                // A hair to each side, so that both know where they are.
                let hair = 1e-9 * limit;
                let (end, begin) = match above(a) {
                    true => (limit + hair, limit),
                    false => (limit, limit + hair),
                };
                part.points.push(p);
                part.thickness.push(end);
                let next = Ridge {
                    points: vec![p],
                    thickness: vec![begin],
                    closed: false,
                };
                parts.push(std::mem::replace(&mut part, next));
            }
            part.points.push(self.points[j]);
            part.thickness.push(b);
        }
        parts.push(part);
        parts
    }

    /// Length of the line.
    pub(super) fn length(&self) -> Mm {
        let open: Mm =
            self.points.windows(2).map(|p| p[0].distance(p[1])).sum();
        match (self.closed, self.points.first(), self.points.last()) {
            (true, Some(a), Some(b)) => open + b.distance(*a),
            _ => open,
        }
    }

    /// The thickness half way through its points.
    pub(super) fn middle_thickness(&self) -> Mm {
        let n = self.thickness.len();
        let (a, b) = (n.saturating_sub(1) / 2, n / 2);
        let at = |i: usize| self.thickness.get(i).copied().unwrap_or(0.0);
        0.5 * (at(a) + at(b))
    }

    /// Goes on with another ridge, which begins where this one ends.
    pub(super) fn append(&mut self, other: Ridge) {
        self.points.extend(other.points.into_iter().skip(1));
        self.thickness.extend(other.thickness.into_iter().skip(1));
    }

    /// The thickness of the thinnest place.
    pub(super) fn thinnest(&self) -> Mm {
        self.thickness.iter().copied().fold(f64::INFINITY, f64::min)
    }

    /// The thickness of the thickest place.
    pub(super) fn thickest(&self) -> Mm {
        self.thickness.iter().copied().fold(0.0, f64::max)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    fn area(points: &[(f64, f64)]) -> Area {
        let ring = points.iter().map(|&(x, y)| DVec2::new(x, y)).collect();
        Area { rings: vec![ring] }
    }

    fn ridges_of(area: &Area, limit: f64) -> Vec<Ridge> {
        ridges(area, &EdgeGrid::new(area, limit), limit, 0.005)
    }

    fn total(r: &Ridge) -> f64 {
        r.points.windows(2).map(|w| w[0].distance(w[1])).sum()
    }

    #[test]
    fn a_strip_has_one_straight_ridge() {
        let strip = area(&[(0.0, 0.0), (20.0, 0.0), (20.0, 0.5), (0.0, 0.5)]);
        let found = ridges_of(&strip, 0.8);
        assert_eq!(found.len(), 1, "{found:?}");
        let r = &found[0];
        assert_eq!(r.points.len(), 2);
        assert!(r.thickness.iter().all(|t| (t - 0.5).abs() < 1e-4));
        assert!(r.points.iter().all(|p| (p.y - 0.25).abs() < 1e-4));
        // It ends where a round end of that width reaches the strip's end.
        assert!((total(r) - 19.5).abs() < 0.3, "{}", total(r));
        assert!(ridges_of(&strip, 0.4).is_empty());
    }

    #[test]
    fn a_wedge_is_followed_until_it_is_thick() {
        let wedge = area(&[(0.0, 0.0), (20.0, -1.0), (20.0, 1.0)]);
        let found = ridges_of(&wedge, 0.8);
        assert_eq!(found.len(), 1, "{found:?}");
        for (p, t) in found[0].points.iter().zip(&found[0].thickness) {
            assert!(p.y.abs() < 0.01);
            assert!((t / p.x - 0.1).abs() < 0.002, "{t} at {}", p.x);
        }
        let thickest = found[0].thickness.iter().copied().fold(0.0, f64::max);
        assert!((thickest - 0.8).abs() < 0.03, "{thickest}");
    }

    #[test]
    fn a_thin_ring_has_a_closed_ridge() {
        let circle = |r: f64| -> Vec<DVec2> {
            (0..400)
                .map(|i| DVec2::from_angle(TAU * f64::from(i) / 400.0) * r)
                .collect()
        };
        let mut hole = circle(4.4);
        hole.reverse();
        let ring = Area {
            rings: vec![circle(5.0), hole],
        };
        let found = ridges_of(&ring, 0.8);
        assert_eq!(found.len(), 1);
        assert!(found[0].closed);
        for (p, t) in found[0].points.iter().zip(&found[0].thickness) {
            assert!((p.length() - 4.7).abs() < 0.005);
            assert!((t - 0.6).abs() < 0.005);
        }
    }

    #[test]
    fn corners_of_thick_parts_have_none() {
        let block = area(&[(0.0, 0.0), (9.0, 0.0), (9.0, 5.0), (4.0, 9.0)]);
        assert!(ridges_of(&block, 0.8).is_empty());
        assert!(ridges_of(&Area::EMPTY, 0.8).is_empty());
    }
}
