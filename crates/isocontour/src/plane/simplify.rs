//! Fewer points on a ring, within a tolerance and without a bias.
//!
//! A chord between two points of a curve lies on its inner side, so a ring
//! thinned to a subset of its points shrinks. Here the ring is cut into the
//! longest pieces that a line fits, each piece is replaced by the line at the
//! *mean* of the deviations from its chord, and the new corners are where
//! neighbouring lines meet: a circle's polygon then lies on both sides of the
//! circle and encloses its content, with fewer corners for the same tolerance.
//! A line at the middle of the deviations would need 15 % fewer corners, and
//! rings would shrink by a third of the tolerance.
//!
//! Guarantee: points of the input are within `tolerance` of the result's
//! lines. Not guaranteed: that rings closer than the tolerance to each other (or
//! to themselves) do not cross afterwards.

use super::{Ring, nearest_on, signed_area};
use crate::Length;
use glam::DVec2;

/// A piece of the input, from the point `start` to the point `end`, and the
/// line that stands for it.
#[derive(Clone, Copy)]
struct Piece {
    start: usize,
    end: usize,
    line: Line,
    /// All points between are as near to it as they have to be.
    fits: bool,
    /// The piece begins at a corner, which stays where it is.
    corner: bool,
    /// How its line meets that of the piece before.
    meets: Meets,
}

/// How the lines of two pieces that follow each other meet.
#[derive(Clone, Copy, PartialEq)]
enum Meets {
    /// Beside the point between the pieces.
    There,
    /// Farther along one of the pieces, whose last points then lie beside the
    /// other one's line.
    Along,
    /// Nowhere near: the lines are nearly parallel.
    Not,
}

/// A line along a chord.
#[derive(Clone, Copy)]
struct Line {
    /// The chord's direction; zero if it has none.
    along: DVec2,
    /// Deviation of the line from the chord, along the chord's left normal.
    shift: f64,
}

impl Line {
    /// Along the chord itself.
    fn chord(a: DVec2, b: DVec2) -> Line {
        Line {
            along: (b - a).normalize_or_zero(),
            shift: 0.0,
        }
    }
}

/// The points of a path.
#[derive(Clone, Copy)]
struct Points<'a> {
    /// If the path is closed, the first again at the end.
    all: &'a [DVec2],
    /// How far each is from the next.
    steps: &'a [Length],
    closed: bool,
}

impl Points<'_> {
    /// The ways to point `k` and on from it; none at the end of an open path.
    fn ways(&self, k: usize) -> Option<(DVec2, DVec2)> {
        let before = match k.checked_sub(1) {
            Some(before) => before,
            None if self.closed => self.all.len() - 2,
            None => return None,
        };
        let here = self.all[k];
        Some((here - self.all[before], self.all.get(k + 1)? - here))
    }

    /// True if the path turns sharply at point `k`.
    fn turns(&self, k: usize) -> bool {
        let Some((u, v)) = self.ways(k) else {
            return true;
        };
        // By the cosine: the angle itself costs ten times as much.
        let along = u.dot(v);
        let bound = CORNER.cos().powi(2) * u.length_squared();
        along < 0.0 || along * along < bound * v.length_squared()
    }

    /// True if a line between the points beside point `k` leaves it farther
    /// away than the tolerance.
    fn stands_out(&self, k: usize, tolerance: Length) -> bool {
        self.ways(k).is_none_or(|(u, v)| {
            let reach = tolerance * (u + v).length();
            u.dot(v) < 0.0 || u.perp_dot(v).abs() > reach
        })
    }
}

/// The ring with as few points as the tolerance permits; empty if less
/// than a triangle would be left.
pub fn simplify(ring: &[DVec2], tolerance: Length) -> Ring {
    simplify_but(ring, tolerance, |_| false)
}

/// As [`simplify`], but keeps the points for which `stays` is true as they are.
pub fn simplify_but(
    ring: &[DVec2],
    tolerance: Length,
    stays: impl Fn(DVec2) -> bool,
) -> Ring {
    // Room for the first point again.
    let mut points = Ring::with_capacity(ring.len() + 1);
    points.extend_from_slice(ring);
    points.dedup();
    while points.len() > 1 && points.first() == points.last() {
        points.pop();
    }
    if points.len() < 3 {
        return Ring::new();
    }
    // The point farthest from another is a good one to begin at: a corner,
    // if there is one.
    let from = points[0];
    let distance = |i: &usize| points[*i].distance_squared(from);
    let farthest =
        (0..points.len()).max_by(|a, b| distance(a).total_cmp(&distance(b)));
    points.rotate_left(farthest.unwrap_or(0));
    let signed = signed_area(&points);
    // The first point again at the end: the last piece ends there.
    points.extend_from_within(..1);
    let steps = steps(&points);
    let points = Points {
        all: &points,
        steps: &steps,
        closed: true,
    };
    let corner = |k: usize| points.turns(k) || stays(points.all[k]);
    let (mut out, _) = thinned(points, tolerance, corner, |_, _| true);
    drop_straight(&mut out);
    // A sliver thinner than the tolerance may fold over.
    if out.len() < 3 || signed_area(&out) * signed <= 0.0 {
        return Ring::new();
    }
    out
}

/// A path with as few points as the tolerance permits, each with the number of
/// the input's point that it stands for. An open path keeps its ends. A closed
/// path does not repeat its first point, neither here nor in the result, and
/// may begin elsewhere.
///
/// A piece of the path may become a line only if `fits` says so, which gets the
/// numbers of the points at which the piece begins and ends. In a closed path
/// the second number may be greater than that of the last point: it then counts
/// on from the first point.
pub fn simplify_path(
    path: &[DVec2],
    closed: bool,
    tolerance: Length,
    fits: impl Fn(usize, usize) -> bool,
) -> Vec<(DVec2, usize)> {
    let n = path.len();
    let whole = || path.iter().copied().zip(0..n).collect();
    if n < 3 {
        return whole();
    }
    let mut points = Ring::with_capacity(n + 1);
    points.extend_from_slice(path);
    let mut first = 0;
    if closed {
        // A path that begins in the middle of a line would keep a point there.
        let corner = |k: &usize| {
            let (a, b) = (path[(k + n - 1) % n], path[(k + 1) % n]);
            (path[*k] - a).perp_dot(b - path[*k]).abs()
        };
        let sharpest = (0..n).max_by(|a, b| corner(a).total_cmp(&corner(b)));
        first = sharpest.unwrap_or(0);
        points.rotate_left(first);
        points.extend_from_within(..1);
    }
    let steps = steps(&points);
    let points = Points {
        all: &points,
        steps: &steps,
        closed,
    };
    let corner = |k: usize| points.turns(k) && points.stands_out(k, tolerance);
    let fits = |i: usize, j: usize| fits(first + i, first + j);
    let (out, pieces) = thinned(points, tolerance, corner, fits);
    // A ring narrower than the tolerance may fold over.
    if closed && (out.len() < 3 || signed_area(&out) * signed_area(path) <= 0.0)
    {
        return whole();
    }
    let numbers = pieces.iter().map(|p| (first + p.start) % n);
    let last = (!closed).then_some(n - 1);
    out.into_iter().zip(numbers.chain(last)).collect()
}

/// How far each point is from the next.
fn steps(points: &[DVec2]) -> Vec<Length> {
    points.windows(2).map(|p| p[0].distance(p[1])).collect()
}

/// The points' lines, and where they meet.
fn thinned(
    points: Points<'_>,
    tolerance: Length,
    corner: impl Fn(usize) -> bool,
    fits: impl Fn(usize, usize) -> bool,
) -> (Ring, Vec<Piece>) {
    // A point beside a corner is a little farther from the edges that end
    // there than from their lines.
    let tolerance = 0.99 * tolerance;
    let mut pieces = split(points, tolerance, corner, fits);
    let mut out = corners(points, &mut pieces);
    while let Some(finer) = halve_misfits(points, &pieces, &out, tolerance) {
        pieces = finer;
        out = corners(points, &mut pieces);
    }
    (out, pieces)
}

/// Turn at a point, in radians, from which it is a corner that stays.
const CORNER: f64 = 0.45;

/// Cuts the ring into pieces, each as long as the tolerance permits and none
/// across a corner or a point that stays.
fn split(
    points: Points<'_>,
    tolerance: Length,
    is_corner: impl Fn(usize) -> bool,
    fits: impl Fn(usize, usize) -> bool,
) -> Vec<Piece> {
    let all = points.all;
    let n = all.len() - 1;
    let mut pieces = Vec::with_capacity(n / 8 + 4);
    let mut start = 0;
    let mut corner = is_corner(start);
    let mut like = 2;
    while start < n {
        let last = (start + 1..n).find(|&k| is_corner(k)).unwrap_or(n);
        while start < last {
            let fit = |end: usize| {
                fit(points, start, end, tolerance, corner)
                    .filter(|_| fits(start, end))
            };
            let (end, line) = longest(start, last, like, fit);
            let chord = || Line::chord(all[start], all[end]);
            like = end - start;
            pieces.push(Piece {
                start,
                end,
                // A piece of two points has none between.
                fits: true,
                line: line.unwrap_or_else(chord),
                corner,
                meets: Meets::Not,
            });
            (start, corner) = (end, false);
        }
        corner = true;
    }
    pieces
}

/// The farthest end, up to `last`, of a piece that begins at the point
/// `start`, and what `fit` says of a piece that ends there; nothing if the
/// piece has but two points. `fit` says nothing of a piece that is too long.
///
/// The piece is lengthened in growing steps until it no longer fits, then the
/// rest is halved. The first try is as long as `like`, the piece before.
pub fn longest<T>(
    start: usize,
    last: usize,
    like: usize,
    fit: impl Fn(usize) -> Option<T>,
) -> (usize, Option<T>) {
    let mut best = (start + 1, None);
    let mut bad = last + 1;
    let (mut end, mut step) = (start + like.max(2), 1);
    while best.0 < last {
        end = end.min(last);
        match fit(end) {
            Some(line) => best = (end, Some(line)),
            None => {
                bad = end;
                break;
            }
        }
        end += step;
        step *= 2;
    }
    while bad - best.0 > 1 && best.0 < last {
        let middle = best.0 + (bad - best.0) / 2;
        match fit(middle) {
            Some(line) => best = (middle, Some(line)),
            None => bad = middle,
        }
    }
    best
}

/// The chord from point `i` to point `j`, shifted to lie at the mean of the
/// points between; `None` if some are then still farther from it than the
/// tolerance. At a corner the line cannot be shifted: the
/// chord itself must fit.
fn fit(
    points: Points<'_>,
    i: usize,
    j: usize,
    tolerance: Length,
    corner: bool,
) -> Option<Line> {
    let (piece, steps) = (points.all.get(i..=j)?, points.steps.get(i..j)?);
    let (&first, &last) = (piece.first()?, piece.last()?);
    let chord = (last - first).try_normalize()?;
    // Most pieces that do not fit are off in the middle already.
    let middle = chord.perp_dot(piece[piece.len() / 2] - first);
    if middle.abs() > 2.0 * tolerance {
        return None;
    }
    let (mut lo, mut hi) = (0.0_f64, 0.0_f64);
    let (mut sum, mut length) = (0.0, 0.0);
    let mut previous = 0.0;
    for (pair, &step) in piece.windows(2).zip(steps) {
        let deviation = chord.perp_dot(pair[1] - first);
        let along = pair[1] - pair[0];
        sum += 0.5 * (deviation + previous) * step;
        length += step;
        previous = deviation;
        // As `min` and `max`, which also look for what is not a number.
        lo = if deviation < lo { deviation } else { lo };
        hi = if deviation > hi { deviation } else { hi };
        if hi - lo > 2.0 * tolerance {
            return None;
        }
        // A piece must not double back on itself.
        if chord.dot(along) < 0.0 && step > tolerance {
            return None;
        }
    }
    let mean = if length > 0.0 { sum / length } else { 0.0 };
    let error = (hi - mean).max(mean - lo);
    let chord_error = if corner { hi.max(-lo) } else { 0.0 };
    (error.max(chord_error) <= tolerance).then_some(Line {
        along: chord,
        shift: mean,
    })
}

/// How far a point may be from a corner, as a multiple of the tolerance.
const AT_CORNER: f64 = 1.01;

/// The pieces, with those halved whose points are not within the tolerance of
/// the edge that came of them: where neighbouring lines did not meet, it does
/// not lie where the piece's own line does. `None` if there are none.
fn halve_misfits(
    points: Points<'_>,
    pieces: &[Piece],
    out: &[DVec2],
    tolerance: Length,
) -> Option<Vec<Piece>> {
    // As `fit` allows, and a little for rounding.
    let limit = 1.0001 * tolerance;
    let misfit = |i: usize| {
        let p = &pieces[i];
        if p.end <= p.start + 1 {
            return false;
        }
        let next = if i + 1 == out.len() { 0 } else { i + 1 };
        let (a, b) = (out[i], out[next]);
        // Both on the piece's own line: so it is nearly always.
        let apart = a.distance_squared(b) > tolerance * tolerance;
        let after = pieces.get(next).map_or(Meets::Not, |p| p.meets);
        let there = p.meets == Meets::There && after == Meets::There;
        if p.fits && there && apart {
            return false;
        }
        let Some(along) = (b - a).try_normalize() else {
            return true;
        };
        // Points beyond an end of the edge belong to the one that follows.
        let near = |from: DVec2, to: DVec2, q: DVec2, limit: Length| {
            nearest_on(q, from, to).distance_squared(q) <= limit * limit
        };
        let before = out[if i == 0 { out.len() - 1 } else { i - 1 }];
        let beyond = out.get(next + 1).or(out.first()).copied();
        let behind = |q: DVec2, limit: Length| {
            (p.meets == Meets::Along && near(before, a, q, limit))
                || (after == Meets::Along
                    && beyond.is_some_and(|c| near(b, c, q, limit)))
        };
        let far_along = p.meets == Meets::Along || after == Meets::Along;
        let corner = AT_CORNER * tolerance;
        let all = &points.all[p.start..=p.end];
        all.iter().any(|&q| {
            // A point may be beside the edge's line, but beyond its end.
            let off_line = along.perp_dot(q - a).abs() > limit;
            (off_line && !behind(q, limit))
                || (far_along && !near(a, b, q, corner) && !behind(q, corner))
        })
    };
    let first = (0..pieces.len()).find(|&i| misfit(i))?;
    let mut finer = Vec::with_capacity(2 * pieces.len());
    for (i, p) in pieces.iter().enumerate() {
        let bad = i >= first && misfit(i);
        if !bad {
            finer.push(*p);
            continue;
        }
        let middle = p.start + (p.end - p.start) / 2;
        for (start, end) in [(p.start, middle), (middle, p.end)] {
            let corner = p.corner && start == p.start;
            let line = fit(points, start, end, tolerance, corner);
            let chord = || Line::chord(points.all[start], points.all[end]);
            finer.push(Piece {
                start,
                end,
                fits: line.is_some(),
                line: line.unwrap_or_else(chord),
                corner,
                meets: Meets::Not,
            });
        }
    }
    Some(finer)
}

/// Distance from the line between its neighbours below which a point says
/// nothing.
const STRAIGHT: f64 = 1e-7;

/// Takes out the points at which a ring goes on straight, or straight back.
fn drop_straight(ring: &mut Ring) {
    ring.dedup();
    while ring.len() > 1 && ring.first() == ring.last() {
        ring.pop();
    }
    let n = ring.len();
    if n < 4 {
        return;
    }
    let mut out = Ring::with_capacity(n);
    let mut a = ring[n - 1];
    for k in 0..n {
        let (b, c) = (ring[k], ring[if k + 1 == n { 0 } else { k + 1 }]);
        let (u, v) = (b - a, c - b);
        // Also a spike that has no width.
        let longest = u.length_squared().max(v.length_squared());
        let side = u.perp_dot(v);
        if side * side > STRAIGHT * STRAIGHT * longest {
            out.push(b);
            a = b;
        }
    }
    *ring = out;
}

/// Share of the shorter one of two pieces along which their lines may meet.
const ALONG: f64 = 0.4;

/// The points where the lines of neighbouring pieces meet, and the end of an
/// open path.
fn corners(points: Points<'_>, pieces: &mut [Piece]) -> Ring {
    let line = |p: &Piece| {
        let Line { along, shift } = p.line;
        let length = points.all[p.start].distance(points.all[p.end]);
        (along, along.perp() * shift, shift, length)
    };
    let mut out = Ring::with_capacity(pieces.len() + 1);
    let Some(last) = pieces.last() else {
        return out;
    };
    let mut before = line(last);
    for piece in pieces {
        let own = line(piece);
        let (u, du, shift_before, length_before) =
            std::mem::replace(&mut before, own);
        let (v, dv, shift, length) = own;
        let p = points.all[piece.start];
        if piece.corner {
            out.push(p);
            continue;
        }
        // The lines through p + du along u and through p + dv along v.
        let sine = u.perp_dot(v);
        let meet = du + u * ((dv - du).perp_dot(v) / sine);
        let beside = 2.0 * shift_before.abs().max(shift.abs());
        let along = ALONG * length_before.min(length);
        let far = meet.length();
        piece.meets = if sine.abs() <= 1e-9 || far > beside.max(along) {
            Meets::Not
        } else if far > beside {
            Meets::Along
        } else {
            Meets::There
        };
        let by = match piece.meets {
            // Nearly parallel lines meet far away.
            Meets::Not => 0.5 * (du + dv),
            Meets::Along | Meets::There => meet,
        };
        out.push(p + by);
    }
    if !points.closed {
        out.extend(points.all.last());
    }
    out
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
            // A chord of sagitta 1.5 × tolerance.
            let ideal = PI / (1.0 - 1.5 * tolerance / r).acos();
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

    /// A curve whose bends turn to both sides, with neighbouring lines that do
    /// not meet near it.
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
