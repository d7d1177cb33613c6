//! Where a distance is that to a plane.
//!
//! If all triangles that are closest to some place of a box are in one plane, the
//! distance is that to the plane. For at an edge with another triangle that one
//! would be as close.

use crate::mesh::Mesh;
use crate::shell::Shell;
use crate::tree::{Child, child};
use glam::DVec3;
use isocontour::Bounds;

/// Most triangles that are looked at: more are rarely in one plane.
const MOST: usize = 256;
/// Normals that differ by no more than this are one, and so are planes whose
/// distance is no larger share of the way between their triangles.
const ALIKE: f64 = 1e-9;
/// How far gradients may be off by rounding.
const SLACK: f64 = 1e-5;

/// A plane.
struct Plane {
    normal: DVec3,
    at: DVec3,
}

impl Mesh {
    /// For each axis two numbers between which all derivatives in a box are.
    pub(crate) fn slopes_over(&self, over: &Bounds) -> [[f64; 2]; 3] {
        match self.gradient_over(over) {
            None => [[-1.0, 1.0]; 3],
            Some(g) => g.to_array().map(|g| [g - SLACK, g + SLACK]),
        }
    }

    /// The gradient in a box, if it is the same everywhere.
    fn gradient_over(&self, over: &Bounds) -> Option<DVec3> {
        let reach = over.min.abs().max(over.max.abs()).max_element();
        // Also if it is not a number.
        let is_near = reach < 1e9;
        if !is_near {
            return None;
        }
        let greatest = self.greatest(over) * (1.0 + 1e-9) + 1e-12 * reach;
        if self.sign.may_be_near_rim(over, greatest) {
            return None;
        }
        let plane = self.shell.plane(over, greatest)?;
        let half = 0.5 * over.size() * plane.normal.signum();
        let centre = over.centre();
        for (end, is_outside) in [(centre + half, true), (centre - half, false)]
        {
            let height = (end - plane.at).dot(plane.normal);
            let is_there = if is_outside {
                height > 0.0
            } else {
                height < 0.0
            };
            if is_there && self.is_inside(end) == is_outside {
                return None;
            }
        }
        Some(plane.normal)
    }
}

impl Shell {
    /// The plane of all triangles that may be as near to a box as `greatest`.
    fn plane(&self, over: &Bounds, greatest: f64) -> Option<Plane> {
        let mut plane: Option<Plane> = None;
        let mut count = 0;
        let mut todo = vec![0];
        while let Some(at) = todo.pop() {
            let node = &self.tree.nodes[at];
            for i in 0..4 {
                if over.gap(&node.bounds(i)) > greatest {
                    continue;
                }
                match child(node.link(i)) {
                    Child::Nothing => {}
                    Child::Node(next) => todo.push(next),
                    Child::Leaf(first, end) => {
                        for i in first..end {
                            if self.apart(i, over) > greatest {
                                continue;
                            }
                            count += 1;
                            if count > MOST || !self.is_in(i, &mut plane)? {
                                return None;
                            }
                        }
                    }
                }
            }
        }
        plane
    }

    /// True if a triangle is in a plane, which is its own if there is none yet.
    /// None if it has no plane.
    fn is_in(&self, i: usize, plane: &mut Option<Plane>) -> Option<bool> {
        let normal = self.normal(i).try_normalize()?;
        let triangle = self.triangle(i);
        let plane = plane.get_or_insert(Plane {
            normal,
            at: triangle[0],
        });
        let is_near = |v: DVec3| {
            let way = v - plane.at;
            way.dot(plane.normal).abs() <= ALIKE * way.length()
        };
        Some(
            normal.distance(plane.normal) <= ALIKE
                && triangle.into_iter().all(is_near),
        )
    }
}
