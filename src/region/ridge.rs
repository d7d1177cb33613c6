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

use crate::plane::grid::EdgeGrid;
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

/// Distance of the balls along the border, mm.
const STEP: Mm = 0.1;

/// The ridges of an area where it is thinner than `limit`. `grid` holds the
/// area's edges. Lines are thinned to `tolerance`, in place and thickness.
pub fn ridges(
    area: &Area,
    grid: &EdgeGrid,
    limit: Mm,
    tolerance: Mm,
) -> Vec<Ridge> {
    let mut runs: Vec<Run> = Vec::new();
    let mut first_edge = 0;
    for ring in &area.rings {
        let balls = balls(ring, first_edge, grid, limit);
        split_runs(&balls, limit, &mut runs);
        first_edge += ring.len();
    }
    join(&mut runs);
    runs.into_iter()
        .filter(|run| {
            let thick =
                run.balls.iter().map(|b| b.thickness).fold(0.0, f64::max);
            run.closed || run.length() >= 0.5 * thick
        })
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

/// A ball for points all along a ring; none where the area is thick, and none
/// where the ball from the other side will do: of two edges that face each
/// other the one with the lower number has the balls. The ring's edges are
/// numbered from `first_edge`, as in the grid.
fn balls(
    ring: &[DVec2],
    first_edge: usize,
    grid: &EdgeGrid,
    limit: Mm,
) -> Vec<Option<Ball>> {
    let radius = 0.5 * limit;
    let mut balls = Vec::new();
    for (number, (a, b)) in (first_edge..).zip(edges(ring)) {
        let along = b - a;
        let length = along.length();
        if length == 0.0 {
            continue;
        }
        let normal = along.perp() / length;
        // Nothing within reach of the whole edge's centres: no ball shrinks.
        // A little less than the radius, or every edge would meet the next.
        let (c, d) = (a + normal * radius, b + normal * radius);
        if grid.clear(c, d, 0.98 * radius) {
            balls.push(None);
            continue;
        }
        let count = (length / STEP).ceil().clamp(1.0, 1e6);
        balls.extend((0..count as usize).map(|k| {
            let p = a.lerp(b, (k as f64 + 0.5) / count);
            ball(p, normal, grid, radius)
                .filter(|(_, opposite)| number < *opposite)
                .map(|(ball, _)| ball)
        }));
    }
    balls
}

/// The largest ball up to `radius` that touches the border at `p`, if it is
/// smaller and touches the opposite side, and the number of that side's edge.
fn ball(
    p: DVec2,
    normal: DVec2,
    grid: &EdgeGrid,
    radius: Mm,
) -> Option<(Ball, usize)> {
    /// Rounds after which a ball that still shrinks is given up: each brings
    /// it to touch a nearer edge, and few edges are near.
    const ROUNDS: usize = 16;
    const TOUCHING: Mm = 1e-5;
    let mut r = radius;
    let mut touch = None;
    for _ in 0..ROUNDS {
        let centre = p + normal * r;
        let near = grid
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
    let centre = p + normal * r;
    // Seen from the centre, p and q are more than 120° apart.
    let (edge, q) = touch?;
    let opposite = (p - centre).dot(q - centre) < -0.5 * r * r;
    let ball = Ball {
        centre,
        thickness: 2.0 * r,
    };
    opposite.then_some((ball, edge))
}

/// Cuts a ring's balls into runs of neighbours.
fn split_runs(balls: &[Option<Ball>], limit: Mm, runs: &mut Vec<Run>) {
    let n = balls.len();
    let near = |a: &Ball, b: &Ball| {
        a.centre.distance(b.centre) < 4.0 * STEP + 0.25 * limit
    };
    let follows = |i: usize| {
        let (a, b) = (&balls[i % n], &balls[(i + 1) % n]);
        matches!((a, b), (Some(a), Some(b)) if near(a, b))
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
fn join(runs: &mut Vec<Run>) {
    /// Runs beyond which the few that could be joined are not worth it.
    const MANY: usize = 2000;
    let mut i = 0;
    while i < runs.len() && runs.len() <= MANY {
        let joined = (0..runs.len()).filter(|&j| j != i).find_map(|j| {
            let (a, b) = (&runs[i], &runs[j]);
            a.followed_by(b).map(|run| (j, run))
        });
        match joined {
            Some((j, run)) => {
                runs[i] = run;
                runs.remove(j);
                i = i.min(j);
            }
            None => i += 1,
        }
    }
}

impl Run {
    fn length(&self) -> Mm {
        self.balls
            .windows(2)
            .map(|w| w[0].centre.distance(w[1].centre))
            .sum()
    }

    /// Both as one, if an end of the other is at this one's end.
    fn followed_by(&self, other: &Run) -> Option<Run> {
        if self.closed || other.closed {
            return None;
        }
        let near = |a: &Ball, b: &Ball| {
            a.centre.distance(b.centre) < 2.5 * STEP
                && (a.thickness - b.thickness).abs() < STEP
        };
        let (end, first, last) = (
            self.balls.last()?,
            other.balls.first()?,
            other.balls.last()?,
        );
        let mut balls = self.balls.clone();
        if near(end, first) {
            balls.extend(&other.balls);
        } else if near(end, last) {
            balls.extend(other.balls.iter().rev());
        } else {
            return None;
        }
        Some(Run {
            balls,
            closed: false,
        })
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
