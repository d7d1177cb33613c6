//! The curve that a polygon stands for.
//!
//! ```text
//!        ·  ╱╲              A line that was thinned lies on both sides of its
//!   ──×──╱──×╲──×──         curve: its corners stick out, and the middles of
//!      ╲╱      ╲╱           its segments are inside. It crosses the curve (×)
//!                           twice in each segment.
//! ```
//!
//! In: a line. Out: points much nearer to the curve than the line's corners
//! are. They are where the line crosses the curve and, beside corners and
//! middles of segments, on the parabola through the crossings. Another line or
//! an arc may be as far from these points as the tolerance permits.
//!
//! Guarantees: a corner that turns by more than a curve does stays. An open line
//! keeps its ends.

use glam::DVec2;
use isoslice_base::units::Mm;

/// How far from a corner a segment crosses the curve, as a share of itself, if
/// the squares of their distances are least: Gauss's point.
const CROSSING: f64 = 0.211_324_865;

// A chord of sagitta s is 2s/3 off at its ends and s/3 at its middle. The line
// through both crossings beside a corner is 4 · CROSSING · s from that corner.

/// How far the curve is from a corner, as a share of how far the line through
/// both crossings is.
const AT_CORNER: f64 = 2.0 / 3.0 / (4.0 * CROSSING);

/// How far the curve is from the middle of a segment, on the other side, as a
/// share of how far the line through both crossings is from a corner.
const AT_MIDDLE: f64 = 1.0 / 3.0 / (4.0 * CROSSING);

/// The curve has a point beside the middle of a segment only if it crosses the
/// segment at more than this share of the usual way from both of its ends. If it
/// does not, the segment is much longer than those beside it, and does not bend as
/// they do.
const LONG: f64 = 0.5;

/// A corner that is near to the curve.
struct Bend {
    /// The shares of the ways back and on at which the line crosses the curve.
    shares: [f64; 2],
    /// The way to the middle between both crossings.
    middle: DVec2,
}

impl Bend {
    /// The corner between the ways back and on; nothing if it is farther than
    /// `most` from the line through both crossings.
    fn of(back: DVec2, on: DVec2, most: Mm) -> Option<Bend> {
        let (before, after) = (back.length(), on.length());
        let reach = CROSSING * before.min(after);
        let shares = [reach / before, reach / after];
        let middle = 0.5 * (shares[0] * back + shares[1] * on);
        let bends = back.dot(on) < 0.0 && middle.length() <= most;
        (bends && reach > 0.0).then_some(Bend { shares, middle })
    }
}

/// The points, and the place of each: the number of the line's point before it
/// and the share of the way to the next one. A corner that is farther than
/// `most` from the line through the crossings beside it stays.
pub fn curve(line: &[DVec2], closed: bool, most: Mm) -> Vec<(DVec2, f64)> {
    let n = line.len();
    let bend = |k: usize| {
        let inner = closed || (k > 0 && k + 1 < n);
        let (here, back) = (line[k % n], line[(k + n - 1) % n]);
        let on = line[(k + 1) % n];
        inner.then(|| Bend::of(back - here, on - here, most))?
    };
    let mut out = Vec::with_capacity(4 * n);
    let mut this = (n > 0).then(|| bend(0)).flatten();
    for k in 0..n {
        let (here, place) = (line[k], k as f64);
        let to = |k: usize| line[k % n] - here;
        match &this {
            Some(Bend { shares, middle }) => {
                let back = shares[0] * to(k + n - 1);
                out.push((here + back, place - shares[0]));
                out.push((here + AT_CORNER * *middle, place));
                out.push((here + shares[1] * to(k + 1), place + shares[1]));
            }
            None => out.push((here, place)),
        }
        if k + 1 == n && !closed {
            break;
        }
        let next = bend((k + 1) % n);
        if let (Some(a), Some(b)) = (&this, &next)
            && a.shares[1].min(b.shares[0]) > LONG * CROSSING
        {
            let off = 0.5 * AT_MIDDLE * (a.middle + b.middle);
            out.push((here + 0.5 * to(k + 1) - off, place + 0.5));
        }
        this = next;
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes::circle;
    use crate::simplify::simplify;

    #[test]
    fn points_are_nearer_to_the_curve_than_corners() {
        for r in [0.5, 4.0, 30.0] {
            let circle = circle(r, 2000);
            let ring = simplify(&circle, 0.005);
            let off = |p: DVec2| (p.length() - r).abs();
            let corners = ring.iter().map(|p| off(*p)).fold(0.0, f64::max);
            let all = curve(&ring, true, 0.01);
            assert_eq!(all.len(), 4 * ring.len());
            let worst = all.iter().map(|p| off(p.0)).fold(0.0, f64::max);
            // Where the ring closes, its sides are not equally long.
            assert!(worst < 0.45 * corners, "{r}: {worst} {corners}");
        }
    }

    #[test]
    fn corners_and_ends_stay() {
        let square = [(0.0, 0.0), (5.0, 0.0), (5.0, 5.0), (0.0, 5.0)];
        let square = square.map(DVec2::from);
        for closed in [true, false] {
            let all = curve(&square, closed, 0.01);
            let points: Vec<DVec2> = all.iter().map(|p| p.0).collect();
            assert_eq!(points, square);
        }
        let odd = [DVec2::ONE, DVec2::ONE, DVec2::NAN];
        assert_eq!(curve(&odd, true, 0.01).len(), 3);
        assert!(curve(&[], true, 0.01).is_empty());
    }

    #[test]
    fn places_are_those_of_the_points() {
        let line: Vec<DVec2> = (0..9)
            .map(|i| 5.0 * DVec2::from_angle(0.06 * f64::from(i)))
            .collect();
        for closed in [true, false] {
            for (p, place) in curve(&line, closed, 0.01) {
                let k = place.rem_euclid(9.0);
                let (a, b) = (line[k as usize], line[(k as usize + 1) % 9]);
                let on = a.lerp(b, k.fract());
                assert!(on.distance(p) < 0.003, "{place}: {p} {on}");
            }
        }
    }
}
