//! The nearest point of a piece.
//!
//! The square of the distance of a point p to B(t) has its extremes where
//! (B(t) - p) · B'(t) is zero, a polynomial of degree 5 at most, which is
//! linear in p.

use crate::curve::Curve;
use crate::roots::{Bernstein, each_crossing};
use glam::DVec2;

/// A piece, and what is needed to find nearest points of it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Piece {
    pub(crate) curve: Curve,
    /// Coefficients of (B - start) · B'.
    own: [f64; 6],
    /// Coefficients of B', of the same degree.
    ways: [DVec2; 6],
}

/// Binomial coefficients.
const CHOOSE: [[f64; 6]; 6] = [
    [1.0, 0.0, 0.0, 0.0, 0.0, 0.0],
    [1.0, 1.0, 0.0, 0.0, 0.0, 0.0],
    [1.0, 2.0, 1.0, 0.0, 0.0, 0.0],
    [1.0, 3.0, 3.0, 1.0, 0.0, 0.0],
    [1.0, 4.0, 6.0, 4.0, 1.0, 0.0],
    [1.0, 5.0, 10.0, 10.0, 5.0, 1.0],
];

impl Piece {
    pub(crate) fn new(curve: Curve) -> Piece {
        let n = curve.degree();
        let (slope, _) = curve.slope();
        let mut own = [0.0; 6];
        let mut ways = [DVec2::ZERO; 6];
        for (i, p) in curve.control().iter().enumerate() {
            for (j, s) in slope[..n].iter().enumerate() {
                let share =
                    CHOOSE[n][i] * CHOOSE[n - 1][j] / CHOOSE[2 * n - 1][i + j];
                own[i + j] += share * (*p - curve.start()).dot(*s);
                ways[i + j] += share * *s;
            }
        }
        Piece { curve, own, ways }
    }

    /// The square of the distance of a point, and the parameter of the nearest
    /// point.
    pub(crate) fn nearest(&self, p: DVec2) -> (f64, f64) {
        let curve = &self.curve;
        let from = p - curve.start();
        if curve.degree() == 1 {
            let way = curve.end() - curve.start();
            let t = (from.dot(way) / way.length_squared()).clamp(0.0, 1.0);
            let at = if t == 1.0 { curve.end() } else { curve.at(t) };
            return ((p - at).length_squared(), t);
        }
        let mut best = (from.length_squared(), 0.0);
        let end = (p - curve.end()).length_squared();
        if end < best.0 {
            best = (end, 1.0);
        }
        let n = 2 * curve.degree();
        let mut values = [0.0; 6];
        for (v, (own, way)) in
            values.iter_mut().zip(self.own.iter().zip(&self.ways))
        {
            *v = own - from.dot(*way);
        }
        each_crossing(&Bernstein::new(&values[..n]), |t, rises| {
            let far = (p - curve.at(t)).length_squared();
            if rises && far < best.0 {
                best = (far, t);
            }
        });
        best
    }
}
