//! Fewer points on a ring, within a tolerance and without a bias.
//!
//! ```text
//!     ╲  ·  ╱        Each point has a gate across the path, as wide as the
//!   ───╲───╱───      tolerance to both sides. From a corner of the result a
//!     ·│   │·        straight edge goes through as many gates as one edge can.
//!   ───│───│───      The next edge begins where it leaves the strip between
//!      │   │         two gates.
//! ```
//!
//! This is the greedy walk of Guibas, Hershberger, Mitchell and Snoeyink 1993
//! (*Approximating polygons and subdivisions with minimum-link paths*), but
//! each edge begins at a point instead of in a region. Edges of a circle then
//! reach from outside of it to inside and out again, and are inside a little
//! more than outside. So the gates are narrower than the tolerance, and in the
//! end all corners move to where the edges fit the path best, by least squares.
//!
//! Guarantee: points of the input are within `tolerance` of the result, and
//! points of the result within `tolerance` of the input. Not guaranteed: that
//! rings that are closer than the tolerance to each other (or to themselves) do
//! not cross afterwards.

mod fit;
mod points;
mod walk;

pub use walk::longest;

use super::{Area, Ring, signed_area};
use crate::Length;
use glam::DVec2;
use points::Points;
use walk::{GATE, PATH_GATE, Walk};

/// The ring with as few points as the tolerance permits. It is empty if less
/// than a triangle would be left.
pub fn simplify(ring: &[DVec2], tolerance: Length) -> Ring {
    simplify_but(ring, tolerance, |_| false)
}

/// The area whose rings have as few points as the tolerance permits, without
/// the rings of which less than a triangle would be left.
pub fn simplify_area(area: &Area, tolerance: Length) -> Area {
    let rings = area.rings.iter().map(|ring| simplify(ring, tolerance));
    rings.filter(|ring| !ring.is_empty()).collect()
}

/// Does what [`simplify`] does, but keeps the points for which `stays` is true.
pub fn simplify_but(
    ring: &[DVec2],
    tolerance: Length,
    stays: impl Fn(DVec2) -> bool,
) -> Ring {
    let mut points = ring.to_vec();
    drop_repeated(&mut points);
    if points.len() < 3 {
        return Ring::new();
    }
    // The point farthest from another point is a good beginning: it is a
    // corner, if there is one.
    let from = points[0];
    let distance = |i: &usize| points[*i].distance_squared(from);
    let farthest =
        (0..points.len()).max_by(|a, b| distance(a).total_cmp(&distance(b)));
    points.rotate_left(farthest.unwrap_or(0));
    let signed = signed_area(&points);
    let points = Points {
        all: &points,
        closed: true,
    };
    let half = GATE * tolerance;
    let corner = |k: usize| points.turns(k) || stays(points.at(k));
    let walk = Walk {
        points,
        half,
        gates: points.gates(half, corner),
        tolerance,
        fits: |_, _| true,
        between: true,
    };
    let mut out = walk.joints().into_iter().map(|j| j.at).collect();
    drop_straight(&mut out);
    // A sliver thinner than the tolerance may fold over.
    if out.len() < 3 || signed_area(&out) * signed <= 0.0 {
        return Ring::new();
    }
    out
}

/// Notes which points of a line stay, so that all others are near enough to the
/// lines between these (Ramer 1972, Douglas and Peucker 1973). `farthest` gives
/// the point that must stay between two that do, if there is one. What is noted
/// already stays, and so do both ends.
pub fn keep_farthest(
    keep: &mut [bool],
    farthest: impl Fn(usize, usize) -> Option<usize>,
) {
    if let [first, .., last] = keep {
        (*first, *last) = (true, true);
    }
    let kept: Vec<usize> = (0..keep.len()).filter(|&i| keep[i]).collect();
    let pairs = kept.iter().copied().zip(kept.iter().copied().skip(1));
    let mut spans: Vec<(usize, usize)> = pairs.collect();
    while let Some((from, to)) = spans.pop() {
        if let Some(k) = farthest(from, to) {
            keep[k] = true;
            spans.extend([(from, k), (k, to)]);
        }
    }
}

/// A path with as few points as the tolerance permits, each with the number of
/// the input's point for which it stands. An open path keeps its ends. A closed
/// path does not repeat its first point, neither here nor in the result, and
/// may begin elsewhere.
///
/// A piece of the path may become a line only if `fits` is true for the numbers
/// of the points at which the piece begins and ends. In a closed path the
/// second number may be greater than that of the last point. It then counts on
/// from the first point.
pub fn simplify_path(
    path: &[DVec2],
    closed: bool,
    tolerance: Length,
    fits: impl Fn(usize, usize) -> bool,
) -> Vec<(DVec2, usize)> {
    walk(path, closed, tolerance, fits, false)
}

/// Does what [`simplify_path`] does for a path of which only the points count:
/// edges may also meet between two of its points, so that fewer points are
/// left.
pub fn simplify_line(
    path: &[DVec2],
    closed: bool,
    tolerance: Length,
) -> Vec<(DVec2, usize)> {
    walk(path, closed, tolerance, |_, _| true, true)
}

/// Thins a path. Edges may meet `between` its points.
fn walk(
    path: &[DVec2],
    closed: bool,
    tolerance: Length,
    fits: impl Fn(usize, usize) -> bool,
    between: bool,
) -> Vec<(DVec2, usize)> {
    let n = path.len();
    let whole = || path.iter().copied().zip(0..n).collect();
    if n < 3 {
        return whole();
    }
    let mut points = path.to_vec();
    let mut first = 0;
    if closed {
        // A path that begins in the middle of a line would keep its first
        // point.
        let corner = |k: &usize| {
            let (a, b) = (path[(k + n - 1) % n], path[(k + 1) % n]);
            (path[*k] - a).perp_dot(b - path[*k]).abs()
        };
        let sharpest = (0..n).max_by(|a, b| corner(a).total_cmp(&corner(b)));
        first = sharpest.unwrap_or(0);
        points.rotate_left(first);
    }
    let points = Points {
        all: &points,
        closed,
    };
    let half = PATH_GATE * tolerance;
    let corner = |k| points.turns(k) && points.stands_out(k, half);
    let walk = Walk {
        points,
        half,
        gates: points.gates(half, corner),
        tolerance,
        fits: |i, j| fits(first + i, first + j),
        between,
    };
    let out: Vec<(DVec2, usize)> = walk
        .joints()
        .into_iter()
        .map(|j| (j.at, (first + j.place as usize) % n))
        .collect();
    // A ring narrower than the tolerance may fold over.
    let folded = || {
        let ring: Ring = out.iter().map(|o| o.0).collect();
        out.len() < 3 || signed_area(&ring) * signed_area(path) <= 0.0
    };
    if closed && folded() {
        return whole();
    }
    out
}

/// Distance from the line between its neighbours below which a point does not
/// count.
const STRAIGHT: f64 = 1e-7;

/// Takes out the points of a ring that equal the point before them.
fn drop_repeated(ring: &mut Ring) {
    ring.dedup();
    while ring.len() > 1 && ring.first() == ring.last() {
        ring.pop();
    }
}

/// Takes out the points at which a ring goes straight on, or straight back.
fn drop_straight(ring: &mut Ring) {
    drop_repeated(ring);
    let n = ring.len();
    if n < 4 {
        return;
    }
    let mut out = Ring::with_capacity(n);
    let mut a = ring[n - 1];
    for k in 0..n {
        let (b, c) = (ring[k], ring[if k + 1 == n { 0 } else { k + 1 }]);
        let (u, v) = (b - a, c - b);
        // This also takes out a spike without width.
        let longest = u.length_squared().max(v.length_squared());
        let side = u.perp_dot(v);
        if side * side > STRAIGHT * STRAIGHT * longest {
            out.push(b);
            a = b;
        }
    }
    *ring = out;
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{PI, TAU};

    fn circle(r: f64, n: usize) -> Ring {
        (0..n)
            .map(|i| DVec2::from_angle(TAU * i as f64 / n as f64) * r)
            .collect()
    }

    #[test]
    fn a_circle_is_thinned_without_shrinking() {
        for r in [0.5, 5.0, 50.0] {
            let tolerance = 0.005;
            let s = simplify(&circle(r, 20_000), tolerance);
            // The chord's height is 1.44 × the tolerance.
            let ideal = PI / (1.0 - 1.44 * tolerance / r).acos();
            assert!((s.len() as f64) < 1.1 * ideal, "{} {ideal}", s.len());
            let mut mean = 0.0;
            for (a, b) in super::super::edges(&s) {
                for i in 0..100 {
                    let e = a.lerp(b, f64::from(i) / 100.0).length() - r;
                    assert!(e.abs() <= 1.03 * tolerance, "{e}");
                    mean += e / (100.0 * s.len() as f64);
                }
            }
            assert!(mean.abs() < 0.0005, "{mean}");
            let content = signed_area(&s) / (PI * r * r) - 1.0;
            assert!(content.abs() * r < 0.001, "{content}");
        }
    }

    #[test]
    fn no_short_rest_is_left_where_a_ring_closes() {
        for k in 0..40 {
            let r = 3.0 + 0.05 * f64::from(k);
            let s = simplify(&circle(r, 2000), 0.005);
            let sides = super::super::edges(&s).map(|(a, b)| a.distance(b));
            let (short, long) = sides.fold((f64::INFINITY, 0.0), |m, side| {
                (f64::min(m.0, side), f64::max(m.1, side))
            });
            assert!(short > 0.4 * long, "{r}: {short} {long}");
        }
    }

    #[test]
    fn corners_of_a_square_stay() {
        let corner = [(0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (0.0, 10.0)]
            .map(|(x, y)| DVec2::new(x, y));
        let mut ring = Ring::new();
        for i in 0..4 {
            for k in 0..97 {
                let t = f64::from(k) / 97.0;
                ring.push(corner[i].lerp(corner[(i + 1) % 4], t));
            }
        }
        ring.rotate_left(31);
        let s = simplify(&ring, 0.005);
        assert_eq!(s.len(), 4);
        for c in corner {
            assert!(s.iter().any(|p| p.distance(c) < 1e-9));
        }
    }

    /// The curve bends to both sides, and has neighbouring lines that do not
    /// meet near it.
    #[test]
    fn points_of_a_wave_are_within_the_tolerance() {
        for (length, height) in [(0.9, 0.02), (1.7, 0.03), (0.3, 0.006)] {
            let mut ring: Ring = (0..=2000)
                .map(|k| f64::from(k) / 200.0)
                .map(|x| DVec2::new(x, height * (TAU * x / length).sin()))
                .collect();
            ring.extend([DVec2::new(10.0, 5.0), DVec2::new(0.0, 5.0)]);
            let s = simplify(&ring, 0.004);
            assert!(s.len() < 400);
            for p in &ring {
                let off = super::super::edges(&s)
                    .map(|(a, b)| {
                        let t = (*p - a).dot(b - a) / (b - a).length_squared();
                        a.lerp(b, t.clamp(0.0, 1.0)).distance(*p)
                    })
                    .fold(f64::INFINITY, f64::min);
                assert!(off <= 1.01 * 0.004, "{off} at {p}");
            }
        }
    }

    #[test]
    fn slivers_vanish_and_nothing_panics() {
        let flat: Ring = (0..50)
            .chain((0..50).rev())
            .map(|i| DVec2::new(f64::from(i), 0.0))
            .collect();
        assert!(simplify(&flat, 0.005).is_empty());
        assert!(simplify(&[], 0.005).is_empty());
        assert!(simplify(&[DVec2::ZERO; 7], 0.005).is_empty());
    }
}
