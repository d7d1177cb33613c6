//! The point of a triangle that is closest to a place.
//!
//! Seen along the normal, the place is inside the triangle, or outside of one
//! edge or two. Inside, its foot on the plane is closest. Outside, the closest
//! point is on one of those edges. This holds its digits on slivers, where
//! products of coordinates, as barycentric ones are made of, lose them.

use glam::DVec3;

/// A sliver whose square of height by length is below this has no normal to be
/// trusted. Its edges are then all that counts: it is lower than 10⁻⁹ of its
/// length.
const SLIVER: f64 = 1e-18;

/// The closest point of a triangle.
#[inline]
pub(crate) fn closest(p: DVec3, [a, b, c]: [DVec3; 3]) -> DVec3 {
    let (ab, bc, ca) = (b - a, c - b, a - c);
    let normal = ab.cross(bc);
    let square = normal.length_squared();
    let longest = ab
        .length_squared()
        .max(bc.length_squared())
        .max(ca.length_squared());
    let is_sliver = square <= SLIVER * longest * longest;
    let corners = [a, b, c];
    let edges = [ab, bc, ca];
    let outside = [0, 1, 2]
        .map(|i| is_sliver || edges[i].cross(p - corners[i]).dot(normal) < 0.0);
    if outside == [false; 3] {
        return p - normal * ((p - a).dot(normal) / square);
    }
    let mut best = (f64::INFINITY, a);
    for i in 0..3 {
        if outside[i] {
            let q = on_edge(p, corners[i], edges[i]);
            let d = p.distance_squared(q);
            if d < best.0 {
                best = (d, q);
            }
        }
    }
    best.1
}

/// The closest point of the edge from `a` along `edge`.
#[inline]
fn on_edge(p: DVec3, a: DVec3, edge: DVec3) -> DVec3 {
    let along = (p - a).dot(edge);
    let square = edge.length_squared();
    if along <= 0.0 {
        a
    } else if along >= square {
        a + edge
    } else {
        a + edge * (along / square)
    }
}

/// The closest triangle of a mesh.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Near {
    /// The square of the distance.
    pub square: f64,
    pub triangle: usize,
    /// The closest point.
    pub point: DVec3,
}

impl Near {
    /// Farther than any triangle.
    pub(crate) const NOTHING: Near = Near {
        square: f64::INFINITY,
        triangle: usize::MAX,
        point: DVec3::INFINITY,
    };

    /// True if this triangle counts, and not the other: of several at one distance
    /// the first counts.
    #[inline]
    pub(crate) fn is_closer(&self, other: &Near) -> bool {
        self.square < other.square
            || (self.square == other.square && self.triangle < other.triangle)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The least distance to many points of a triangle, made closer by steps.
    fn by_search(p: DVec3, [a, b, c]: [DVec3; 3]) -> f64 {
        let at = |u: f64, v: f64| a + (b - a) * u + (c - a) * v;
        let mut best = (f64::INFINITY, 0.0, 0.0);
        let mut size = 1.0;
        let (mut u0, mut v0) = (0.5, 0.5);
        for _ in 0..60 {
            for i in -10..=10 {
                for j in -10..=10 {
                    let u: f64 = u0 + size * f64::from(i) / 10.0;
                    let v: f64 = v0 + size * f64::from(j) / 10.0;
                    let u = u.clamp(0.0, 1.0);
                    let v = v.clamp(0.0, 1.0 - u);
                    let d = p.distance(at(u, v));
                    if d < best.0 {
                        best = (d, u, v);
                    }
                }
            }
            (u0, v0) = (best.1, best.2);
            size *= 0.6;
        }
        best.0
    }

    #[test]
    fn distances_are_those_of_a_search() {
        let mut rng = fastrand::Rng::with_seed(2);
        let mut random = |scale: f64| {
            DVec3::from_array([0; 3].map(|_| (rng.f64() - 0.5) * scale))
        };
        for i in 0..300 {
            let [a, b] = [random(1.0), random(1.0)];
            let c = match i % 3 {
                0 => random(1.0),
                1 => a.lerp(b, 0.3) + random(1e-4),
                _ => a.lerp(b, 1.5) + random(1e-12),
            };
            let p = random(4.0);
            let d = p.distance(closest(p, [a, b, c]));
            assert!((d - by_search(p, [a, b, c])).abs() < 1e-6);
        }
    }

    #[test]
    fn slivers_keep_their_digits() {
        let [a, b] = [DVec3::ZERO, DVec3::new(100.0, 0.0, 0.0)];
        for height in [1e-3, 1e-6, 1e-9, 1e-12, 0.0] {
            let c = DVec3::new(30.0, height, 0.0);
            let p = DVec3::new(60.0, 1e-4, 90.0);
            let d = p.distance(closest(p, [a, b, c]));
            assert!((d - 90.0).abs() < 1e-6, "{height}: {d}");
        }
    }
}
