//! Distances to four triangles at a time, in f32.
//!
//! They decide which triangles have to be looked at closely, so they are bounds
//! from below.

use glam::{BVec4A, DVec3, Vec4};

/// Roundings of f32 take no more than this share of a distance, and as much of
/// the triangle's longest side: the normal of a triangle lower than its length by
/// a hundred is off by 10⁻⁵.
const ROUNDINGS: f32 = 2e-5;
/// A triangle lower than a hundredth of its length has a normal that f32 knows
/// too badly: the square of twice its area, by the fourth power of its length.
const SLIVER: f32 = 1e-4;
/// Squares below this have lost digits.
const SMALLEST: f32 = 1e-30;
/// Places beyond this make squares of products that f32 has no numbers for.
const FARTHEST: f64 = 1e9;

/// Vectors of four.
#[derive(Clone, Copy)]
struct Vectors {
    x: Vec4,
    y: Vec4,
    z: Vec4,
}

impl Vectors {
    #[inline]
    fn new(v: [DVec3; 4]) -> Vectors {
        let [a, b, c, d] = v.map(|v| v.as_vec3());
        Vectors {
            x: Vec4::new(a.x, b.x, c.x, d.x),
            y: Vec4::new(a.y, b.y, c.y, d.y),
            z: Vec4::new(a.z, b.z, c.z, d.z),
        }
    }

    #[inline]
    fn dot(self, v: Vectors) -> Vec4 {
        self.x * v.x + self.y * v.y + self.z * v.z
    }

    #[inline]
    fn cross(self, v: Vectors) -> Vectors {
        Vectors {
            x: self.y * v.z - self.z * v.y,
            y: self.z * v.x - self.x * v.z,
            z: self.x * v.y - self.y * v.x,
        }
    }

    #[inline]
    fn minus(self, v: Vectors, times: Vec4) -> Vectors {
        Vectors {
            x: self.x - v.x * times,
            y: self.y - v.y * times,
            z: self.z - v.z * times,
        }
    }
}

#[inline]
fn root(v: Vec4) -> Vec4 {
    Vec4::from_array(v.to_array().map(f32::sqrt))
}

/// Bounds from below on the squares of the distances to four triangles.
#[inline]
pub(crate) fn squares(p: DVec3, triangles: [[DVec3; 3]; 4]) -> [f32; 4] {
    if p.abs().max_element() > FARTHEST {
        return [0.0; 4];
    }
    // From each corner to the place, and to the next corner.
    let to = [0, 1, 2].map(|k| Vectors::new(triangles.map(|t| p - t[k])));
    let edges = [0, 1, 2]
        .map(|k| Vectors::new(triangles.map(|t| t[(k + 1) % 3] - t[k])));
    let normal = edges[0].cross(edges[1]);
    let mut least = Vec4::splat(f32::MAX);
    let mut longest = Vec4::ZERO;
    let mut inside = BVec4A::splat(true);
    for k in 0..3 {
        let square = edges[k].dot(edges[k]);
        longest = longest.max(square);
        let along = to[k].dot(edges[k]) / square.max(Vec4::splat(SMALLEST));
        let along = along.max(Vec4::ZERO).min(Vec4::ONE);
        let apart = to[k].minus(edges[k], along);
        least = least.min(apart.dot(apart));
        inside &= edges[k].cross(to[k]).dot(normal).cmpge(Vec4::ZERO);
    }
    let area = normal.dot(normal);
    let along = normal.dot(to[0]);
    let height = along.abs() / root(area.max(Vec4::splat(SMALLEST)));
    let distance = Vec4::select(inside, height, root(least));
    let bound = distance - (distance + root(longest)) * ROUNDINGS;
    let bound = bound.max(Vec4::ZERO);
    let is_known = area.cmpgt(longest * longest * SLIVER)
        & area.cmpgt(Vec4::splat(SMALLEST));
    Vec4::select(is_known, bound * bound, Vec4::ZERO).to_array()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::closest::closest;
    use crate::tests::Random;

    #[test]
    fn no_bound_is_above_the_distance() {
        let mut random = Random::new(4);
        for i in 0..100_000 {
            let scale = [1.0, 1e-3, 1e3, 1e-9, 1e8][i % 5];
            let middle = random.within(1.0) * [0.0, 1.0, 1e6][i / 5 % 3];
            let thin = [1.0, 1e-2, 1e-3, 1e-6][i / 15 % 4];
            let triangles = [(); 4].map(|()| {
                let [a, b] = [random.within(scale), random.within(scale)];
                let c = a.lerp(b, 0.4) + random.within(scale * thin);
                [a, b, c].map(|v| v + middle)
            });
            let away = scale * [1e-3, 1.0, 1e3][i % 3];
            let p = middle + random.within(away);
            let bounds = squares(p, triangles);
            for (bound, triangle) in bounds.into_iter().zip(triangles) {
                let exact = p.distance_squared(closest(p, triangle));
                assert!(f64::from(bound) <= exact, "{bound} {exact}");
            }
        }
    }
}
