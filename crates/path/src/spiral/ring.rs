//! Points along rings, and where rings begin.

use crate::order::begin_near;
use glam::{DMat2, DVec2};
use isoslice_base::units::Mm;
use isoslice_planar::Ring;
use isoslice_planar::bead::Stroke;
use isoslice_planar::grid::nearest_on;

/// Greatest distance of points whose way to the surface is looked for, mm.
const SURFACE_STEP: Mm = 0.25;

/// Sine of the angle from which a corner is kept as one.
const CORNER: f64 = 0.1;

/// A point of a turn, on its way to the surface.
pub(super) struct Point {
    pub at: DVec2,
    /// Share of the turn's way.
    pub share: f64,
    /// Directions to the surface: one, or, at a corner, two.
    pub out: [DVec2; 2],
}

impl Point {
    /// How the point moves if the surface moves by `way` in its directions.
    pub(super) fn shift(&self, way: DVec2) -> DVec2 {
        let [a, b] = self.out;
        if a == b {
            return way.x * a;
        }
        // The point keeps its distance from both sides.
        DMat2::from_cols(a, b).transpose().inverse() * way
    }
}

/// The first point of a ring that is farthest from all of some pieces. None of
/// them is beside it.
pub(super) fn lonely(ring: &[DVec2], pieces: &[Ring]) -> DVec2 {
    let away = |p: &DVec2| {
        let to = pieces.iter().map(|piece| distance(*p, piece));
        to.fold(f64::INFINITY, f64::min)
    };
    let far = ring.iter().map(|p| (away(p), *p));
    let farthest = far.reduce(|a, b| if b.0 > a.0 { b } else { a });
    farthest.map_or(DVec2::ZERO, |far| far.1)
}

/// Points along a ring, the first one once more at the end.
pub(super) fn points(ring: &[DVec2]) -> Vec<Point> {
    let n = ring.len();
    let side = |i: usize| (ring[i % n], ring[(i + 1) % n]);
    let normal = |i: usize| {
        let (a, b) = side(i);
        -(b - a).normalize_or_zero().perp()
    };
    let length: Mm = (0..n).map(|i| side(i).0.distance(side(i).1)).sum();
    let mut points = Vec::new();
    let mut done = 0.0;
    for i in 0..=n {
        let (a, b) = side(i);
        let (before, after) = (normal(i + n - 1), normal(i));
        let out = if before.perp_dot(after).abs() > CORNER {
            [before, after]
        } else {
            [(before + after).normalize_or_zero(); 2]
        };
        points.push(Point {
            at: a,
            share: (done / length).min(1.0),
            out,
        });
        if i == n {
            break;
        }
        let step = a.distance(b);
        let count = (step / SURFACE_STEP).ceil().max(1.0);
        for k in 1..count as usize {
            let t = k as f64 / count;
            points.push(Point {
                at: a.lerp(b, t),
                share: ((done + t * step) / length).min(1.0),
                out: [after; 2],
            });
        }
        done += step;
    }
    points
}

/// The ring from its point nearest to `start` on.
pub(super) fn begin(ring: &[DVec2], start: DVec2) -> Ring {
    let mut stroke = Stroke::new(ring.to_vec(), true, 0.0);
    begin_near(&mut stroke, start);
    stroke.points
}

/// The point of a ring that lies farthest back.
pub(super) fn rear(ring: &[DVec2]) -> DVec2 {
    let by_y = |a: &&DVec2, b: &&DVec2| a.y.total_cmp(&b.y);
    ring.iter().max_by(by_y).copied().unwrap_or_default()
}

/// Greatest distance of some of a ring's points from another ring; 0 if that
/// ring has no points.
pub(super) fn farthest(ring: &[DVec2], from: &[DVec2]) -> Mm {
    /// Points that are looked at.
    const LOOKS: usize = 64;
    let step = ring.len().div_ceil(LOOKS).max(1);
    let looks = ring.iter().step_by(step).map(|&p| distance(p, from));
    looks.filter(|d| d.is_finite()).fold(0.0, f64::max)
}

/// Distance of a point from a ring.
pub(super) fn distance(p: DVec2, ring: &[DVec2]) -> Mm {
    let sides = ring.iter().zip(ring.iter().cycle().skip(1));
    let to = sides.map(|(&a, &b)| nearest_on(p, a, b).distance(p));
    to.fold(f64::INFINITY, f64::min)
}
