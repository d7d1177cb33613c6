//! Rings and areas for tests.

use super::{Area, Ring};
use glam::DVec2;
use std::f64::consts::TAU;

/// A ring through some points.
pub fn ring(points: &[(f64, f64)]) -> Ring {
    points.iter().map(|&p| p.into()).collect()
}

/// A rectangle's ring.
pub fn rect_ring(x0: f64, y0: f64, x1: f64, y1: f64) -> Ring {
    ring(&[(x0, y0), (x1, y0), (x1, y1), (x0, y1)])
}

/// A rectangle.
pub fn rect(x0: f64, y0: f64, x1: f64, y1: f64) -> Area {
    Area::from(rect_ring(x0, y0, x1, y1))
}

/// The ring of a square around the origin, of half a side's length.
pub fn square_ring(half: f64) -> Ring {
    rect_ring(-half, -half, half, half)
}

/// A square around the origin, of half a side's length.
pub fn square(half: f64) -> Area {
    rect(-half, -half, half, half)
}

/// A square of 10 mm with a square hole of 4 mm.
pub fn frame() -> Area {
    let mut hole = square_ring(2.0);
    hole.reverse();
    Area::from_iter([square_ring(5.0), hole])
}

/// A circle around the origin, as a polygon of `n` corners.
pub fn circle(radius: f64, n: usize) -> Ring {
    (0..n)
        .map(|i| DVec2::from_angle(TAU * i as f64 / n as f64) * radius)
        .collect()
}

/// The area of such a circle.
pub fn disc(radius: f64, n: usize) -> Area {
    Area::from(circle(radius, n))
}

/// An area, turned about the origin by an angle in radians.
pub fn turned(area: &Area, angle: f64) -> Area {
    let turn = DVec2::from_angle(angle);
    let ring = |r: &Ring| r.iter().map(|p| p.rotate(turn)).collect::<Ring>();
    area.rings.iter().map(ring).collect()
}

/// A ring at another place.
pub fn moved(ring: Ring, x: f64, y: f64) -> Ring {
    ring.into_iter().map(|p| p + DVec2::new(x, y)).collect()
}
