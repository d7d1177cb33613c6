//! Arcs (G2, G3) as straight moves.
//!
//! In: an arc in the plane of the bed, with its centre (I, J) or its radius
//! (R). Out: points on it, the last one exactly its end; z rises evenly. No
//! chord is farther than [`ACCURACY`] from the arc, unless that would take more
//! than [`MOST_CHORDS`] chords.

use glam::{DVec2, DVec3};
use isoslice_base::units::Mm;
use std::f64::consts::TAU;

/// Greatest distance between the arc and its chords.
const ACCURACY: Mm = 0.01;
/// Greatest radius. An arc with a larger one is a mistake, or as good as
/// straight.
const LARGEST: Mm = 1e5;
/// Most chords of one arc: a full circle of a metre's radius has fewer.
const MOST_CHORDS: u32 = 720;

/// An arc, walked along chord by chord.
#[derive(Clone, Debug)]
pub(super) struct Arc {
    centre: DVec2,
    from: DVec3,
    to: DVec3,
    /// Radius at the start, and its change over the whole arc.
    radius: [f64; 2],
    angle: [f64; 2],
    count: u32,
    next: u32,
}

impl Arc {
    /// The arc from `from` to `to` round the centre at `from + offset`; none if
    /// there is no such arc.
    pub(super) fn around(
        from: DVec3,
        to: DVec3,
        offset: DVec2,
        clockwise: bool,
    ) -> Option<Arc> {
        let centre = from.truncate() + offset;
        let (a, b) = (from.truncate() - centre, to.truncate() - centre);
        let (r0, r1) = (a.length(), b.length());
        // The comparison also refuses NaN.
        if !(r0.min(r1) > 1e-6 && r0.max(r1) < LARGEST) {
            return None;
        }
        let start = a.to_angle();
        let mut turn = b.to_angle() - start;
        // An arc back to its start is a full circle.
        if clockwise {
            while turn > -1e-9 {
                turn -= TAU;
            }
        } else {
            while turn < 1e-9 {
                turn += TAU;
            }
        }
        let radius = r0.max(r1);
        let step = 2.0 * (1.0 - (ACCURACY / radius).min(0.5)).acos();
        let count = (turn.abs() / step).ceil();
        Some(Arc {
            centre,
            from,
            to,
            radius: [r0, r1 - r0],
            angle: [start, turn],
            count: (count as u32).clamp(1, MOST_CHORDS),
            next: 1,
        })
    }

    /// The arc from `from` to `to` with a radius; if the radius is negative,
    /// the long way round.
    pub(super) fn with_radius(
        from: DVec3,
        to: DVec3,
        radius: f64,
        clockwise: bool,
    ) -> Option<Arc> {
        let chord = (to - from).truncate();
        let half = 0.5 * chord.length();
        if half < 1e-6 || radius.abs() < half - 0.01 {
            return None;
        }
        // Distance of the centre from the chord; rounding may make its square
        // negative.
        let reach = (radius * radius - half * half).max(0.0).sqrt();
        let left = chord.perp().normalize();
        let side = if clockwise == (radius > 0.0) {
            -1.0
        } else {
            1.0
        };
        Arc::around(from, to, 0.5 * chord + left * reach * side, clockwise)
    }

    /// Share of each chord in the whole arc.
    pub(super) fn share(&self) -> f64 {
        1.0 / f64::from(self.count)
    }
}

impl Iterator for Arc {
    type Item = DVec3;

    fn next(&mut self) -> Option<DVec3> {
        if self.next > self.count {
            return None;
        }
        let t = f64::from(self.next) / f64::from(self.count);
        self.next += 1;
        if self.next > self.count {
            return Some(self.to);
        }
        let radius = self.radius[0] + t * self.radius[1];
        let angle = self.angle[0] + t * self.angle[1];
        let at = self.centre + radius * DVec2::from_angle(angle);
        Some(at.extend(self.from.z + t * (self.to.z - self.from.z)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FROM: DVec3 = DVec3::new(10.0, 0.0, 1.0);

    fn length(arc: Arc) -> f64 {
        let mut at = arc.from;
        let mut sum = 0.0;
        for p in arc {
            sum += p.distance(at);
            at = p;
        }
        sum
    }

    #[test]
    fn a_quarter_and_three_quarters() {
        let to = DVec3::new(0.0, 10.0, 1.0);
        let offset = DVec2::new(-10.0, 0.0);
        let quarter = Arc::around(FROM, to, offset, false).unwrap();
        for p in quarter.clone() {
            assert!((p.truncate().length() - 10.0).abs() < 1e-9);
            assert!(p.x >= -1e-9 && p.y >= -1e-9);
        }
        assert_eq!(quarter.clone().last(), Some(to));
        assert!((length(quarter) - 2.5 * TAU).abs() < 0.02);
        let rest = Arc::around(FROM, to, offset, true).unwrap();
        assert!((length(rest) - 7.5 * TAU).abs() < 0.06);
    }

    #[test]
    fn chords_stay_within_the_tolerance() {
        let arc =
            Arc::around(FROM, FROM, DVec2::new(-10.0, 0.0), true).unwrap();
        let mut at = FROM;
        for p in arc {
            let middle = 0.5 * (p + at).truncate();
            assert!(middle.length() > 10.0 - ACCURACY - 1e-9);
            at = p;
        }
    }

    #[test]
    fn a_radius_says_the_same_as_a_centre() {
        let to = DVec3::new(0.0, 10.0, 3.0);
        for (radius, clockwise, expected) in [
            (10.0, false, DVec2::ZERO),
            (-10.0, false, DVec2::splat(10.0)),
            (10.0, true, DVec2::splat(10.0)),
            (-10.0, true, DVec2::ZERO),
        ] {
            let arc = Arc::with_radius(FROM, to, radius, clockwise).unwrap();
            assert!(arc.centre.distance(expected) < 1e-9, "{arc:?}");
            let heights: Vec<f64> = arc.map(|p| p.z).collect();
            assert!(heights.is_sorted());
        }
    }

    #[test]
    fn what_is_no_arc_is_none() {
        let to = DVec3::new(0.0, 10.0, 1.0);
        assert!(Arc::around(FROM, to, DVec2::ZERO, true).is_none());
        assert!(Arc::with_radius(FROM, to, 1.0, true).is_none());
        assert!(Arc::with_radius(FROM, FROM, 1.0, true).is_none());
        let far = DVec2::splat(f64::INFINITY);
        assert!(Arc::around(FROM, to, far, true).is_none());
    }
}
