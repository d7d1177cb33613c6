//! Discs, the cross-sections of posts.

use glam::DVec2;
use isoslice_base::units::Mm;
use isoslice_planar::Ring;
use std::f64::consts::{PI, TAU};

/// Greatest distance of a side of a disc's polygon from the circle around it,
/// mm.
const SAGITTA: Mm = 0.02;
/// Corners of a polygon that are off by less than this are off by rounding, mm:
/// booleans put them on a grid.
const ROUNDED: Mm = 1e-4;

/// A disc around a point. Its corners are on the circle.
pub(super) fn disc(middle: DVec2, radius: Mm) -> Ring {
    let half = (1.0 - SAGITTA / radius).clamp(0.0, 1.0).acos();
    let corners = (PI / half).ceil().clamp(8.0, 48.0);
    polygon(middle, radius, corners as usize)
}

/// A regular polygon, whose first corner lies in the direction of x.
fn polygon(middle: DVec2, radius: Mm, corners: usize) -> Ring {
    let step = TAU / corners as f64;
    let corner = |k| DVec2::from_angle(k as f64 * step) * radius + middle;
    (0..corners).map(corner).collect()
}

/// A disc of some size, wherever it lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Disc {
    corners: usize,
    /// The radius in units of [`ROUNDED`].
    radius: u64,
}

impl Disc {
    /// The disc that a ring is, and its middle, if it is one. The ring may begin
    /// at any of its corners.
    pub fn of(ring: &[DVec2]) -> Option<(Disc, DVec2)> {
        if !(8..=48).contains(&ring.len()) {
            return None;
        }
        let middle = ring.iter().sum::<DVec2>() / ring.len() as f64;
        let sum: Mm = ring.iter().map(|p| p.distance(middle)).sum();
        let radius = sum / ring.len() as f64;
        let disc = Disc {
            corners: ring.len(),
            radius: (radius / ROUNDED).round() as u64,
        };
        let x = |k: &usize| ring[*k].x;
        let first = (0..ring.len()).max_by(|a, b| x(a).total_cmp(&x(b)))?;
        let corners = ring[first..].iter().chain(&ring[..first]);
        let exact = disc.ring().into_iter().map(|p| p + middle);
        let is = |(p, q): (&DVec2, DVec2)| p.distance(q) < ROUNDED;
        corners.zip(exact).all(is).then_some((disc, middle))
    }

    /// The disc around the origin.
    pub fn ring(self) -> Ring {
        let radius = self.radius as f64 * ROUNDED;
        polygon(DVec2::ZERO, radius, self.corners)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use isoslice_planar::rect;

    #[test]
    fn a_disc_is_known_wherever_it_lies_and_nothing_else_is() {
        let at = DVec2::new(93.7, -41.3);
        for radius in [0.3, 0.495, 2.0, 7.3] {
            let (found, middle) = Disc::of(&disc(at, radius)).unwrap();
            assert!(middle.distance(at) < 1e-9);
            let here = Disc::of(&disc(DVec2::ZERO, radius)).unwrap();
            assert_eq!(here.0, found);
            // A boolean lets it begin elsewhere, and rounds it.
            let turned = disc(at, radius).into_iter();
            let mut turned: Ring =
                turned.map(|p| (1e5 * p).round() / 1e5).collect();
            turned.rotate_left(5);
            assert_eq!(Disc::of(&turned).unwrap().0, found);
            for (p, q) in found.ring().iter().zip(disc(at, radius)) {
                assert!((p + at).distance(q) < 1e-4);
            }
        }
        let mut dented = disc(at, 0.495);
        dented[3] = dented[3].lerp(at, 0.01);
        assert_eq!(Disc::of(&dented), None);
        assert_eq!(Disc::of(&rect(0.0, 0.0, 1.0, 1.0).rings[0]), None);
    }
}
