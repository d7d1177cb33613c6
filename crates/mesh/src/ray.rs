//! How often a ray leaves triangles by their outside.
//!
//! In: a place and a direction along an axis. Out: the number of triangles that
//! the ray meets from behind, less those that it meets from the front. For
//! triangles without a rim it is the winding number, whatever the direction.
//!
//! Guarantees: it is exact. A ray that meets an edge or a corner meets as many
//! triangles as one beside it: signs are those of exact arithmetic, and a place
//! in line with an edge counts as beside it, always on the same side.

use crate::shell::Shell;
use crate::tree::{Node, above, below};
use glam::{DVec2, DVec3};
use robust::{Coord, Coord3D, orient2d, orient3d};

/// A direction along an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Direction {
    pub axis: usize,
    pub is_up: bool,
}

/// A ray from `p`.
struct Ray {
    p: DVec3,
    /// The axes across, and the one along.
    axes: [usize; 3],
    is_up: bool,
    /// The place, rounded down and up.
    low: [f32; 3],
    high: [f32; 3],
}

impl Shell {
    /// The crossings of a ray from `p` with the triangles that `counts` names.
    pub(crate) fn crossings(
        &self,
        p: DVec3,
        direction: Direction,
        counts: impl Fn(usize) -> bool,
    ) -> i64 {
        let mut sum = 0;
        self.each_crossing(p, direction, |i, leaves| {
            if counts(i) {
                sum += leaves;
            }
        });
        sum
    }

    /// Calls `see` with triangles that a ray from `p` may meet, and 1 if it meets
    /// them from behind, −1 if from the front, or 0.
    pub(crate) fn each_crossing(
        &self,
        p: DVec3,
        direction: Direction,
        mut see: impl FnMut(usize, i64),
    ) {
        let k = direction.axis;
        let ray = Ray {
            p,
            axes: [(k + 1) % 3, (k + 2) % 3, k],
            is_up: direction.is_up,
            low: p.to_array().map(below),
            high: p.to_array().map(above),
        };
        self.tree.visit(
            |node| ray.meets(node),
            |first, end| {
                for i in first..end {
                    see(i, ray.leaves(self.triangle(i)));
                }
            },
        );
    }
}

impl Ray {
    /// The boxes of a node that the ray meets.
    #[inline]
    fn meets(&self, node: &Node) -> [bool; 4] {
        let [u, v, w] = self.axes;
        let within = |axis: usize, i: usize| {
            node.min[axis][i] <= self.high[axis]
                && node.max[axis][i] >= self.low[axis]
        };
        [0, 1, 2, 3].map(|i| {
            let ahead = if self.is_up {
                node.max[w][i] >= self.low[w]
            } else {
                node.min[w][i] <= self.high[w]
            };
            ahead && within(u, i) && within(v, i)
        })
    }

    /// 1 if the ray meets a triangle from behind, −1 if from the front.
    fn leaves(&self, triangle: [DVec3; 3]) -> i64 {
        let [u, v, w] = self.axes;
        let flat = |q: DVec3| DVec2::new(q[u], q[v]);
        let around = around(triangle.map(flat), flat(self.p));
        if around == 0 {
            return 0;
        }
        let high = |q: DVec3| Coord3D {
            x: q[u],
            y: q[v],
            z: q[w],
        };
        let [a, b, c] = triangle.map(high);
        // Positive if the place is below the triangle, as seen from where it is
        // counter-clockwise.
        let below = orient3d(a, b, c, high(self.p)) * around as f64;
        match (below > 0.0, self.is_up) {
            (true, true) => around,
            (false, false) => -around,
            _ => 0,
        }
    }
}

/// How often a triangle goes round a place, counter-clockwise.
pub(crate) fn around(triangle: [DVec2; 3], p: DVec2) -> i64 {
    let coord = |q: DVec2| Coord { x: q.x, y: q.y };
    let mut around = 0;
    for i in 0..3 {
        let (a, b) = (triangle[i], triangle[(i + 1) % 3]);
        let is_upward = a.y <= p.y;
        if is_upward == (b.y <= p.y) {
            continue;
        }
        let (low, high) = if is_upward { (a, b) } else { (b, a) };
        let is_left = if p.x < low.x.min(high.x) {
            true
        } else if p.x > low.x.max(high.x) {
            false
        } else {
            orient2d(coord(low), coord(high), coord(p)) > 0.0
        };
        if is_left {
            around += if is_upward { 1 } else { -1 };
        }
    }
    around
}
