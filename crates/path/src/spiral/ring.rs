//! Points along rings, their corners, and where rings begin.

use crate::order::begin_near;
use glam::DVec2;
use isoslice_base::units::Mm;
use isoslice_planar::Ring;
use isoslice_planar::bead::Stroke;
use isoslice_planar::grid::nearest_on;

/// Greatest distance of a turn's points, mm.
const STEP: Mm = 0.25;

/// Turn from which on a point of a ring is a corner, radians. The arcs of an offset turn
/// by 0.3 from one of their sides to the next with the usual accuracy.
const CORNER: f64 = 0.5;

/// A point of a turn.
pub(super) struct Point {
    pub at: DVec2,
    /// Share of the turn's way.
    pub share: f64,
    /// Direction of the turn.
    pub along: DVec2,
    /// Greater than 0 at a corner to the left, less at one to the right, and 0
    /// where there is none.
    pub corner: f64,
}

/// The sides of a ring.
pub(super) fn sides(ring: &[DVec2]) -> impl Iterator<Item = (DVec2, DVec2)> {
    let next = ring.iter().cycle().skip(1);
    ring.iter().copied().zip(next.copied())
}

/// Directions before and after a point of a ring.
fn directions(ring: &[DVec2], i: usize) -> [DVec2; 2] {
    let n = ring.len();
    [i + n - 1, i]
        .map(|i| (ring[(i + 1) % n] - ring[i % n]).normalize_or_zero())
}

/// The way in which a ring runs at a point.
pub(super) fn along(ring: &[DVec2], i: usize) -> DVec2 {
    let [before, after] = directions(ring, i);
    before + after
}

/// Greater than 0 if a ring has a corner to the left at a point, less than 0 if it has
/// one to the right, and 0 if it has none there.
pub(super) fn corner(ring: &[DVec2], i: usize) -> f64 {
    let [before, after] = directions(ring, i);
    let turn = before.angle_to(after);
    if turn.abs() > CORNER { turn } else { 0.0 }
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
    let length: Mm = sides(ring).map(|(a, b)| a.distance(b)).sum();
    let mut points = Vec::new();
    let mut done = 0.0;
    for (i, (a, b)) in sides(ring).enumerate() {
        points.push(Point {
            at: a,
            share: done / length,
            along: along(ring, i),
            corner: corner(ring, i),
        });
        let step = a.distance(b);
        let count = (step / STEP).ceil().max(1.0);
        for k in 1..count as usize {
            let t = k as f64 / count;
            points.push(Point {
                at: a.lerp(b, t),
                share: (done + t * step) / length,
                along: b - a,
                corner: 0.0,
            });
        }
        done += step;
    }
    points.extend(ring.first().map(|&at| Point {
        at,
        share: 1.0,
        along: DVec2::ZERO,
        corner: 0.0,
    }));
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
    let to = sides(ring).map(|(a, b)| nearest_on(p, a, b).distance(p));
    to.fold(f64::INFINITY, f64::min)
}
