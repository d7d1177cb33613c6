//! Arcs in place of many straight segments.
//!
//! In: a line of points, and a tolerance. Out: points on it, and how the way
//! leads from each to the next: straight, or along an arc.
//!
//! Guarantees: the way begins and ends where the line does. Each place where
//! the line crosses the curve that it stands for ([`curve`]), and the middle
//! between two such places, is within the tolerance of the way. Each corner of
//! the line is within 2.5 times the tolerance. No arc turns by more than 149°
//! or has a radius of more than 2 m.
//!
//! Not guaranteed: that there are as few arcs as possible. Each arc is as long
//! as it can be from the end of the arc before it.

use super::curve::curve;
use super::simplify::longest;
use glam::DVec2;
use isoslice_base::units::Mm;
use std::f64::consts::FRAC_PI_2;

/// Greatest tangent of half of an arc's angle: that of 1.3 radians. Firmware tells
/// from an arc's ends which way round it goes, and near half a circle rounding would
/// decide.
const WIDEST: f64 = 3.602;

/// Slack up to which its tangent is taken from a series, in radians: without
/// functions of angles, which were half of the time that arcs took.
const SLIGHT: f64 = 0.5;

/// Greatest radius, mm: what is flatter is straight to any printer.
const FLATTEST: Mm = 2000.0;

/// How far a corner may be from the line through the places beside it where the
/// line crosses its curve, in tolerances.
const CURVED: f64 = 1.5;

/// An arc from one point to another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turn {
    /// The arc's centre.
    pub centre: DVec2,
    /// By how much the arc turns, in radians; to the left if positive.
    pub angle: f64,
}

impl Turn {
    /// Radius of the arc that begins at a point.
    pub fn radius(&self, from: DVec2) -> Mm {
        from.distance(self.centre)
    }

    /// Length of the arc that begins at a point.
    pub fn length(&self, from: DVec2) -> Mm {
        self.radius(from) * self.angle.abs()
    }

    /// The arc that begins at a point, cut after a share of its way: the place
    /// of the cut, and both parts.
    pub fn halves(self, from: DVec2, share: f64) -> (DVec2, [Turn; 2]) {
        let part = |share: f64| Turn {
            angle: share * self.angle,
            ..self
        };
        let parts = [part(share), part(1.0 - share)];
        let arm = DVec2::from_angle(parts[0].angle).rotate(from - self.centre);
        (self.centre + arm, parts)
    }

    /// The ends of `count` chords of the arc from one point to another.
    pub fn chords(
        self,
        from: DVec2,
        to: DVec2,
        count: usize,
    ) -> impl Iterator<Item = DVec2> {
        let arm = from - self.centre;
        (1..=count).map(move |k| {
            if k == count {
                to
            } else {
                let angle = self.angle * k as f64 / count as f64;
                self.centre + DVec2::from_angle(angle).rotate(arm)
            }
        })
    }
}

/// The line's way in arcs and straight pieces: the points between them, and
/// for each piece its arc, if it is one.
pub fn fit(line: &[DVec2], tolerance: Mm) -> (Vec<DVec2>, Vec<Option<Turn>>) {
    let line: Vec<DVec2> = curve(line, false, CURVED * tolerance)
        .into_iter()
        .map(|(point, _)| point)
        .collect();
    let mut points: Vec<DVec2> = line.first().copied().into_iter().collect();
    let mut turns = Vec::new();
    let (mut start, mut like) = (0, 2);
    while start + 1 < line.len() {
        let piece = |end: usize| way(line.get(start..=end)?, tolerance);
        let (end, turn) = longest(start, line.len() - 1, like, piece);
        points.push(line[end]);
        turns.push(turn.flatten());
        (start, like) = (end, end - start);
    }
    (points, turns)
}

/// The points of a way with chords in place of its arcs, each as near to its
/// arc as `accuracy`.
pub fn flat(
    points: &[DVec2],
    turns: &[Option<Turn>],
    accuracy: Mm,
) -> Vec<DVec2> {
    let mut out: Vec<DVec2> = points.first().copied().into_iter().collect();
    for (ends, turn) in points.windows(2).zip(turns) {
        match turn {
            None => out.push(ends[1]),
            Some(turn) => {
                let step = (8.0 * turn.radius(ends[0]) * accuracy).sqrt();
                let count = (turn.length(ends[0]) / step).ceil().max(1.0);
                out.extend(turn.chords(ends[0], ends[1], count as usize));
            }
        }
    }
    out
}

/// How a single piece of the way leads along the points: straight, or along an
/// arc. None if neither comes near enough to them.
pub fn way(piece: &[DVec2], tolerance: Mm) -> Option<Option<Turn>> {
    let (&a, &b) = (piece.first()?, piece.last()?);
    let chord = b - a;
    let length = chord.length();
    // From every place on an arc the chord is seen under one angle. So each
    // sample says which angles bring the arc near enough to it. What is shorter
    // than the tolerance is straight, or leads back.
    let widest = if length > tolerance { WIDEST } else { 0.0 };
    let (mut low, mut high) = (-widest, widest);
    for q in samples(piece) {
        let own = tangents(q - a, b - q, tolerance * length);
        (low, high) = (low.max(own[0]), high.min(own[1]));
        if low > high {
            return None;
        }
    }
    let [low, high] = [low, high].map(f64::atan);
    if low <= 0.0 && high >= 0.0 {
        let along = chord / length;
        let near = |q: DVec2| along.perp_dot(q - a).abs() <= tolerance;
        let onward = |p: &[DVec2]| {
            let step = p[1] - p[0];
            along.dot(step) >= 0.0 || step.length() <= tolerance
        };
        return (samples(piece).all(near) && piece.windows(2).all(onward))
            .then_some(None);
    }
    let half = 0.5 * (low + high);
    let radius = 0.5 * length / half.sin().abs();
    let turn = Turn {
        centre: a.midpoint(b) + chord.perp() * (0.5 / half.tan()),
        angle: 2.0 * half,
    };
    if radius > FLATTEST {
        return None;
    }
    let near = |q: DVec2| (turn.radius(q) - radius).abs() <= tolerance;
    let onward = |p: &[DVec2]| {
        let (u, v) = (p[0] - turn.centre, p[1] - turn.centre);
        u.perp_dot(v) * half >= 0.0 || u.distance(v) <= tolerance
    };
    (samples(piece).all(near) && piece.windows(2).all(onward))
        .then_some(Some(turn))
}

/// Tangents of the angles under which a chord may be seen from a place, from the
/// least to the greatest one. `u` and `v` are the ways from one end of the chord to
/// the place and on to the other end, `room` is the chord's length times how far the
/// place may be moved.
fn tangents(u: DVec2, v: DVec2, room: f64) -> [f64; 2] {
    let slack = room / (u.length_squared() * v.length_squared()).sqrt();
    let (across, along) = (u.perp_dot(v), u.dot(v));
    if slack < SLIGHT && along > 0.0 {
        // The tangent of the slack, to a part in 10,000.
        let square = slack * slack;
        let series = 1.0 / 3.0 + square * (2.0 / 15.0 + square * 17.0 / 315.0);
        let s = slack * (1.0 + square * series);
        return [-s, s].map(|s| {
            let below = along - s * across;
            // Beyond a quarter turn there is no tangent.
            let over = f64::INFINITY.copysign(s);
            if below > 0.0 {
                (across + s * along) / below
            } else {
                over
            }
        });
    }
    let angle = across.atan2(along);
    [angle - slack, angle + slack].map(|a| a.clamp(-FRAC_PI_2, FRAC_PI_2).tan())
}

/// The points between the ends, and the middles of the segments.
fn samples(piece: &[DVec2]) -> impl Iterator<Item = DVec2> + '_ {
    let inner = piece.get(1..piece.len() - 1).unwrap_or(&[]);
    let middles = piece.windows(2).map(|p| p[0].midpoint(p[1]));
    inner.iter().copied().chain(middles)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{PI, TAU};

    /// Greatest distance of a way's arcs from a curve. `from` tells how far a
    /// point is from the curve.
    fn off(line: &[DVec2], tolerance: Mm, from: impl Fn(DVec2) -> Mm) -> Mm {
        let (points, turns) = fit(line, tolerance);
        assert_eq!(points.len(), turns.len() + 1);
        assert_eq!(points.last(), line.last());
        let flat = flat(&points, &turns, 1e-5);
        flat.into_iter().map(|p| from(p).abs()).fold(0.0, f64::max)
    }

    fn circle(radius: Mm, n: usize) -> Vec<DVec2> {
        let at = |i| radius * DVec2::from_angle(TAU * i as f64 / n as f64);
        (0..=n).map(at).collect()
    }

    #[test]
    fn a_circle_is_three_arcs() {
        for (radius, n) in [(0.5, 40), (4.0, 100), (60.0, 500)] {
            let line = circle(radius, n);
            let tolerance = 0.005 * radius;
            let (_, turns) = fit(&line, tolerance);
            assert!((3..=4).contains(&turns.len()), "{turns:?}");
            for turn in turns.iter().flatten() {
                assert!(turn.angle > 0.0 && turn.angle < PI);
                assert!(turn.centre.length() < 0.05 * radius, "{turn:?}");
            }
            let far = |p: DVec2| p.length() - radius;
            assert!(off(&line, tolerance, far) < 1.01 * tolerance);
        }
    }

    #[test]
    fn an_ellipse_is_met_within_the_tolerance() {
        let (a, b) = (8.0, 3.0);
        let n = 400;
        let at = |i: usize| TAU * i as f64 / n as f64;
        for sign in [1.0, -1.0] {
            let line: Vec<DVec2> = (0..=n)
                .map(|i| DVec2::new(a * at(i).cos(), sign * b * at(i).sin()))
                .collect();
            // The distance, to first order.
            let far = |p: DVec2| {
                let f = (p.x / a).powi(2) + (p.y / b).powi(2) - 1.0;
                f / (2.0 * DVec2::new(p.x / a / a, p.y / b / b).length())
            };
            let tolerance = 0.005;
            assert!(off(&line, tolerance, far) < 1.1 * tolerance);
            let (_, turns) = fit(&line, tolerance);
            assert!(turns.len() < 40, "{}", turns.len());
            let left = |t: &Turn| t.angle * sign > 0.0;
            assert!(turns.iter().flatten().all(left));
        }
    }

    #[test]
    fn tangents_are_those_of_the_angles() {
        for k in -24..=24 {
            let angle = 0.0625 * f64::from(k);
            let (u, v) = (DVec2::X, 0.8 * DVec2::from_angle(angle));
            for slack in [0.0, 1e-3, 0.05, 0.2, 0.499, 0.51, 1.0, 9.0] {
                let found = tangents(u, v, slack * 0.8);
                let meant = [angle - slack, angle + slack];
                for (found, meant) in found.map(f64::atan).iter().zip(meant) {
                    let within = meant.clamp(-1.3, 1.3);
                    let off = found.clamp(-1.3, 1.3) - within;
                    assert!(
                        off.abs() <= 1e-4 * slack + 1e-9,
                        "{angle} {slack}: {off}"
                    );
                }
            }
        }
        let nowhere = tangents(DVec2::ZERO, DVec2::ONE, 1.0);
        assert!(nowhere[0] < -1e9 && nowhere[1] > 1e9, "{nowhere:?}");
    }

    #[test]
    fn corners_and_straight_lines_stay() {
        let square = [(0.0, 0.0), (5.0, 0.0), (5.0, 5.0), (0.0, 5.0)];
        let line: Vec<DVec2> = square.map(DVec2::from).to_vec();
        assert_eq!(fit(&line, 0.005), (line.clone(), vec![None; 3]));
        let many: Vec<DVec2> =
            (0..100).map(|i| DVec2::X * (0.1 * i as f64)).collect();
        let (points, turns) = fit(&many, 0.005);
        assert_eq!((points.len(), turns), (2, vec![None]));
        // The line goes there and back again.
        let back: Vec<DVec2> =
            many.iter().chain(many.iter().rev()).copied().collect();
        let (points, _) = fit(&back, 0.005);
        assert!(points.iter().any(|p| p.x > 9.89), "{points:?}");
    }

    #[test]
    fn nothing_panics() {
        assert_eq!(fit(&[], 0.01), (vec![], vec![]));
        let same = [DVec2::ONE; 5];
        assert_eq!(fit(&same, 0.01).0.last(), Some(&DVec2::ONE));
        let nan = [DVec2::ZERO, DVec2::NAN, DVec2::ONE];
        assert!(!fit(&nan, 0.01).0.is_empty());
    }
}
