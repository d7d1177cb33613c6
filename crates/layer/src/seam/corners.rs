//! Finds the corners of a ring.
//!
//! In: a ring, whose vertices stand for a curve. Out: where it turns sharply,
//! how much, and to which side.
//!
//! The turning of the ring is added up over a short way, weighted by the
//! distance, and compared with that of a circle as long as the ring. So facets
//! of a curve and small circles are no corners, and a corner that an offset has
//! rounded counts as being as sharp as before. A corner lies at the weighted
//! middle of its turning.

use glam::DVec2;
use isoslice_base::units::Mm;
use isoslice_planar::along::point_at;
use isoslice_planar::path_length;
use std::f64::consts::TAU;

/// A place where a ring turns sharply.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Corner {
    pub at: DVec2,
    /// The angle by which the ring turns, in radians, positive.
    pub turn: f64,
}

/// The least turn of a concave corner, in radians (30°).
const CONCAVE: f64 = 0.52;
/// The least turn of a convex corner, in radians (45°).
const CONVEX: f64 = 0.79;
/// Half the way over which turns are added up to a concave corner, mm. Walls go
/// round such a corner in arcs whose radius is half a line's width.
const WAY: Mm = 0.4;
/// Half the way over which turns are added up to a convex corner, which stays
/// sharp, mm.
const SHARP_WAY: Mm = 0.1;
/// Twice the mean of the weights, for both halves of the way.
const MEAN_WEIGHT: f64 = 16.0 / 15.0;

/// A ring and how it turns.
pub(super) struct Corners<'a> {
    ring: &'a [DVec2],
    /// The turn at each vertex, in radians, positive to the left.
    turns: Vec<f64>,
    length: Mm,
    /// 1 if the ring as a whole turns to the left, else −1.
    side: f64,
    /// Length of a facet of a tight curve, mm.
    facet: Mm,
}

impl<'a> Corners<'a> {
    /// The corners of a ring that lies within `accuracy` of the curve that it
    /// stands for.
    pub(super) fn new(ring: &'a [DVec2], accuracy: Mm) -> Corners<'a> {
        let n = ring.len();
        let turns: Vec<f64> = (0..n)
            .map(|i| {
                let (a, b, c) =
                    (ring[(i + n - 1) % n], ring[i], ring[(i + 1) % n]);
                let (u, v) = (b - a, c - b);
                u.perp_dot(v).atan2(u.dot(v))
            })
            .collect();
        let side = turns.iter().sum::<f64>().signum();
        Corners {
            ring,
            turns,
            length: path_length(ring, true),
            side,
            // A facet of a circle with a radius of 2 mm.
            facet: (16.0 * accuracy).sqrt(),
        }
    }

    /// Corners that point into the part, which lies to the left.
    pub(super) fn concave(&self) -> Vec<Corner> {
        self.find(-1.0, CONCAVE, WAY.max(self.facet))
    }

    /// Corners that point out of the part.
    pub(super) fn convex(&self) -> Vec<Corner> {
        self.find(1.0, CONVEX, SHARP_WAY.max(0.5 * self.facet))
    }

    fn find(&self, sign: f64, least: f64, way: Mm) -> Vec<Corner> {
        let n = self.ring.len();
        let circle = sign * self.side * TAU * MEAN_WEIGHT * way / self.length;
        let least = least + circle.max(0.0);
        let mut found: Vec<(usize, Corner)> = Vec::new();
        for i in 0..n {
            // Most vertices turn far too little for a corner.
            if sign * self.turns[i] < 0.02 {
                continue;
            }
            let (turn, _) = self.sum(i, 0.0, sign, way);
            if turn < least {
                continue;
            }
            // In some steps the offset moves to the middle of the turning.
            let mut offset = 0.0;
            let mut turn = turn;
            for _ in 0..8 {
                let (sum, middle) = self.sum(i, offset, sign, way);
                turn = sum;
                offset = middle;
            }
            let at = self.at(i, offset);
            let corner = Corner { at, turn };
            // Several vertices lead to one corner.
            let same = |c: &&mut (usize, Corner)| c.1.at.distance(at) < way;
            match found.iter_mut().rev().take(8).find(same) {
                Some(other) if other.1.turn >= turn => {}
                Some(other) => *other = (i, corner),
                None => found.push((i, corner)),
            }
        }
        if found.len() > 1
            && let (Some(first), Some(last)) = (found.first(), found.last())
            && first.1.at.distance(last.1.at) < way
        {
            found.pop();
        }
        found.into_iter().map(|(_, c)| c).collect()
    }

    /// The turning around the place `offset` after vertex `i`, and its weighted
    /// middle, as an offset.
    fn sum(&self, i: usize, offset: Mm, sign: f64, way: Mm) -> (f64, Mm) {
        let n = self.ring.len();
        let (mut sum, mut moment) = (0.0, 0.0);
        let mut add = |k: usize, s: Mm| {
            let u = (s - offset) / way;
            let weight = (1.0 - u * u).max(0.0);
            let turn = sign * self.turns[k] * weight * weight;
            sum += turn;
            moment += turn * s;
        };
        add(i, 0.0);
        let half = 0.5 * self.length;
        for step in [1, n - 1] {
            let (mut k, mut s) = (i, 0.0);
            let forth = if step == 1 { 1.0 } else { -1.0 };
            // The sum goes beyond the middle by as much as the middle is off
            // the vertex.
            while s < (way + offset.abs()).min(half) {
                let next = (k + step) % n;
                s += self.ring[k].distance(self.ring[next]);
                k = next;
                if k == i || s >= half {
                    break;
                }
                add(k, forth * s);
            }
        }
        if sum > 1e-9 {
            (sum, moment / sum)
        } else {
            (sum, offset)
        }
    }

    /// The point `offset` after vertex `i`.
    fn at(&self, i: usize, offset: Mm) -> DVec2 {
        let n = self.ring.len();
        let step = if offset < 0.0 { n - 1 } else { 1 };
        let line = (0..=n).map(|k| self.ring[(i + k * step) % n]);
        point_at(line, offset.abs()).unwrap_or(self.ring[i])
    }
}
