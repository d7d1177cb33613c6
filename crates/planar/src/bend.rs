//! How an outline bends.
//!
//! In: a ring, with the area on its left. Out: places along it, each with the
//! way out of the area and with the ring's curvature.
//!
//! The curvature of a polygon is in its corners. Here each corner's angle is
//! spread evenly over half of the sides beside it, or over [`REACH`] if that is
//! less, and the curvature at a place is the mean over [`REACH`] to both sides.
//! A round outline of many corners then has the curvature of its circle, and a
//! sharp corner counts as a bend.

use super::Ring;
use glam::DVec2;
use isoslice_base::units::{Mm, PerMm};

/// Length to both sides over which the curvature is a mean.
const REACH: Mm = 1.0;

/// Greatest distance of two places along a ring.
const RING_STEP: Mm = 0.25;

/// Greatest way that a sharp corner moves, as a multiple of the distance by
/// which its sides move.
const MITRE: f64 = 2.0;

/// A place on a ring.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bend {
    /// Where it is.
    pub at: DVec2,
    /// The way out of the area. It is longer than 1 at a corner: if the sides
    /// move by 1, the corner moves by its length.
    pub out: DVec2,
    /// One over the radius: positive where the area is convex, negative in
    /// holes and notches, 0 where the ring is straight.
    pub curvature: PerMm,
}

/// Places along a ring, no more than [`RING_STEP`] apart, its corners among them.
pub fn bends(ring: &Ring) -> Vec<Bend> {
    let corners = corners(ring);
    let Some(length) = corners.last().map(|c| c.before) else {
        return Vec::new();
    };
    let turned = Turned::new(&corners, length);
    // All of a small ring counts, and no part of it twice.
    let reach = REACH.min(0.5 * length);
    let mut out = Vec::new();
    let mut from = 0.0;
    for (i, corner) in corners.iter().enumerate() {
        let a = corners[(i + corners.len() - 1) % corners.len()].at;
        let side = corner.before - from;
        let count = (side / RING_STEP).ceil().max(1.0);
        for k in 1..=count as usize {
            let t = k as f64 / count;
            let s = from + t * side;
            let last = k == count as usize;
            out.push(Bend {
                at: if last {
                    corner.at
                } else {
                    a.lerp(corner.at, t)
                },
                out: if last { corner.out } else { corner.side },
                curvature: (turned.at(s + reach) - turned.at(s - reach))
                    / (2.0 * reach),
            });
        }
        from = corner.before;
    }
    out
}

/// By how much a ring has turned up to a place along it.
struct Turned {
    /// Lengths along the ring, from its last corner, and angles in radians,
    /// between which the angle grows evenly.
    knots: Vec<(Mm, f64)>,
    length: Mm,
    whole: f64,
}

impl Turned {
    fn new(corners: &[Corner], length: Mm) -> Turned {
        let mut whole = 0.0;
        let mut knots = Vec::with_capacity(2 * corners.len());
        let mut from = 0.0;
        for (i, corner) in corners.iter().enumerate() {
            let at = corner.before;
            let next = match corners.get(i + 1) {
                Some(next) => next.before - at,
                None => corners[0].before,
            };
            let half = |side: Mm| (0.5 * side).min(REACH);
            knots.push((at - half(at - from), whole));
            whole += corner.angle;
            knots.push((at + half(next), whole));
            from = at;
        }
        Turned {
            knots,
            length,
            whole,
        }
    }

    /// The angle up to `s`, which may lie beyond the ring's ends.
    fn at(&self, s: Mm) -> f64 {
        let Some(&first) = self.knots.first() else {
            return 0.0;
        };
        let rounds = ((s - first.0) / self.length).floor();
        let s = s - rounds * self.length;
        let before = rounds * self.whole;
        let i = self.knots.partition_point(|knot| knot.0 <= s);
        let low = i.checked_sub(1).map_or(first, |k| self.knots[k]);
        let high = self.knots.get(i).copied().unwrap_or((s, self.whole));
        let step = high.0 - low.0;
        let share = if step > 0.0 { (s - low.0) / step } else { 0.0 };
        before + low.1 + share.clamp(0.0, 1.0) * (high.1 - low.1)
    }
}

/// A ring's corner.
struct Corner {
    at: DVec2,
    /// The ring's length up to it, from the ring's last corner.
    before: Mm,
    /// By how much the ring turns to the left there, in radians.
    angle: f64,
    /// The ways out of the area, at the side before the corner and at the
    /// corner.
    side: DVec2,
    out: DVec2,
}

fn corners(ring: &Ring) -> Vec<Corner> {
    let mut points: Vec<DVec2> = ring.to_vec();
    points.dedup();
    if points.len() > 1 && points.first() == points.last() {
        points.pop();
    }
    let n = points.len();
    if n < 3 {
        return Vec::new();
    }
    let mut length = 0.0;
    (0..n)
        .map(|i| {
            let [a, b, c] = [i + n - 1, i, i + 1].map(|k| points[k % n]);
            length += a.distance(b);
            let (u, v) = ((b - a).normalize(), (c - b).normalize());
            let (side, next) = (-u.perp(), -v.perp());
            let out = (side + next) / (1.0 + side.dot(next)).max(1e-9);
            Corner {
                at: b,
                before: length,
                angle: u.perp_dot(v).atan2(u.dot(v)),
                side,
                out: out.clamp_length_max(MITRE),
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes::{circle, rect_ring};
    use std::f64::consts::TAU;

    #[test]
    fn circles_and_holes_have_the_curvature_of_their_radius() {
        for (radius, n) in [(0.2, 24), (1.0, 60), (3.0, 90), (20.0, 300)] {
            let middle = DVec2::new(3.0, 4.0);
            let round = circle(radius, n).into_iter();
            let mut ring: Ring = round.map(|p| p + middle).collect();
            for sign in [1.0, -1.0] {
                let exact = sign / radius;
                let all = bends(&ring);
                assert!(all.len() >= n);
                for bend in all {
                    let off = (bend.curvature - exact).abs() * radius;
                    assert!(off < 0.01, "{bend:?} of {exact}");
                    // A chord's middle lies inside, and its way out is that of
                    // the chord.
                    let arm = sign * (bend.at - middle);
                    let along = bend.out.normalize().dot(arm.normalize());
                    assert!(along > 0.98, "{along}");
                }
                ring.reverse();
            }
        }
    }

    #[test]
    fn straight_sides_have_none_and_corners_a_bend() {
        let all = bends(&rect_ring(0.0, 0.0, 20.0, 10.0));
        for bend in &all {
            let corner = |p: DVec2| {
                let c = DVec2::new(
                    if p.x > 10.0 { 20.0 } else { 0.0 },
                    if p.y > 5.0 { 10.0 } else { 0.0 },
                );
                p.distance(c)
            };
            // A corner's quarter of a turn is spread over 1 mm to both sides,
            // and the mean is taken over as much.
            let away = corner(bend.at);
            let exact = (2.0 - away).max(0.0) / 4.0 * 0.25 * TAU;
            assert!((bend.curvature - exact).abs() < 1e-9, "{bend:?}");
            let long = if away == 0.0 { 2f64.sqrt() } else { 1.0 };
            assert!((bend.out.length() - long).abs() < 1e-9, "{bend:?}");
        }
        // All the angles together are a full turn.
        let mean: f64 = all.iter().map(|b| b.curvature * RING_STEP).sum();
        assert!((mean - TAU).abs() < 0.01, "{mean}");
    }

    #[test]
    fn rings_of_next_to_nothing_have_no_places() {
        assert!(bends(&Vec::new()).is_empty());
        assert!(bends(&vec![DVec2::ZERO; 5]).is_empty());
    }
}
