//! Winding numbers of triangles with a rim.
//!
//! In: triangles. Out: at any place the share of the sphere of sight that they
//! cover, seen from behind (Jacobson, Kavan and Sorkine-Hornung 2013). What is
//! far from a place is taken together: its areas as vectors, and how they are
//! spread (Barill et al. 2018).

use crate::shell::Shell;
use crate::tree::{Child, STACK, child};
use glam::{DMat3, DVec3};
use std::f64::consts::PI;

/// Far is what is this many times as far as it is large. The error of what is
/// taken together is then about 10⁻³ of its share of the sphere.
const FAR: f64 = 4.0;

/// What is below a node, as seen from afar.
#[derive(Clone, Copy, Debug)]
struct Dipole {
    /// The middle of the areas.
    middle: DVec3,
    /// All is within this distance of the middle.
    radius: f64,
    /// The sum of the areas as vectors.
    area: DVec3,
    /// The sum of the products of offset and area.
    spread: DMat3,
}

/// Triangles whose winding number is asked for.
#[derive(Debug)]
pub(crate) struct Winding {
    /// By the tree's nodes.
    dipoles: Vec<Dipole>,
}

impl Winding {
    pub(crate) fn new(shell: &Shell) -> Winding {
        let nodes = &shell.tree.nodes;
        // The triangles below a node follow one another.
        let mut spans = vec![(usize::MAX, 0); nodes.len()];
        for at in (0..nodes.len()).rev() {
            let mut span = (usize::MAX, 0);
            for i in 0..4 {
                let (first, end) = match child(nodes[at].link(i)) {
                    Child::Nothing => continue,
                    Child::Leaf(first, end) => (first, end),
                    Child::Node(next) => spans[next],
                };
                span = (span.0.min(first), span.1.max(end));
            }
            spans[at] = span;
        }
        let dipoles = spans
            .into_iter()
            .map(|(first, end)| dipole(shell, first.min(end), end))
            .collect();
        Winding { dipoles }
    }

    /// Memory, bytes.
    pub(crate) fn bytes(&self) -> usize {
        self.dipoles.capacity() * size_of::<Dipole>()
    }

    /// The winding number of `shell`, of which this was made, at a place.
    pub(crate) fn at(&self, shell: &Shell, p: DVec3) -> f64 {
        let mut sum = 0.0;
        let mut stack = [0u32; STACK];
        let mut top = usize::from(!self.dipoles.is_empty());
        while top > 0 {
            top -= 1;
            let at = stack[top] as usize;
            let dipole = &self.dipoles[at];
            let to = dipole.middle - p;
            let reach = FAR * dipole.radius;
            if to.length_squared() > reach * reach {
                sum += dipole.seen(to);
                continue;
            }
            for i in (0..4).rev() {
                match child(shell.tree.nodes[at].link(i)) {
                    Child::Nothing => {}
                    Child::Node(next) => {
                        stack[top] = next as u32;
                        top += 1;
                    }
                    Child::Leaf(first, end) => {
                        for i in first..end {
                            sum += solid_angle(p, shell.triangle(i));
                        }
                    }
                }
            }
        }
        sum / (4.0 * PI)
    }
}

impl Dipole {
    /// The solid angle, `to` being the way to the middle.
    fn seen(&self, to: DVec3) -> f64 {
        let square = to.length_squared();
        let cube = square * square.sqrt();
        let trace =
            self.spread.x_axis.x + self.spread.y_axis.y + self.spread.z_axis.z;
        let bent = 3.0 * to.dot(self.spread * to) / square;
        (self.area.dot(to) + trace - bent) / cube
    }
}

/// Some triangles, as seen from afar.
fn dipole(shell: &Shell, first: usize, end: usize) -> Dipole {
    let (mut weight, mut sum, mut area) = (0.0, DVec3::ZERO, DVec3::ZERO);
    for i in first..end {
        let [a, b, c] = shell.triangle(i);
        let normal = 0.5 * (b - a).cross(c - a);
        let size = normal.length();
        weight += size;
        sum += (a + b + c) * (size / 3.0);
        area += normal;
    }
    let middle = if weight > 0.0 {
        sum / weight
    } else {
        shell.triangle(first.min(shell.corners.len() - 1))[0]
    };
    let (mut radius, mut spread) = (0.0f64, DMat3::ZERO);
    for i in first..end {
        let [a, b, c] = shell.triangle(i);
        let normal = 0.5 * (b - a).cross(c - a);
        let offset = (a + b + c) / 3.0 - middle;
        spread += DMat3::from_cols(
            offset * normal.x,
            offset * normal.y,
            offset * normal.z,
        );
        for v in [a, b, c] {
            radius = radius.max(v.distance_squared(middle));
        }
    }
    Dipole {
        middle,
        radius: radius.sqrt(),
        area,
        spread,
    }
}

/// The solid angle of a triangle (Van Oosterom and Strackee 1983), positive if
/// it is seen from behind.
pub(crate) fn solid_angle(p: DVec3, triangle: [DVec3; 3]) -> f64 {
    let [a, b, c] = triangle.map(|v| v - p);
    let [x, y, z] = [a, b, c].map(DVec3::length);
    let up = a.dot(b.cross(c));
    let along = x * y * z + a.dot(b) * z + b.dot(c) * x + c.dot(a) * y;
    if up == 0.0 {
        // In the plane. On the triangle it is half of the sphere, whose sign
        // nobody knows.
        return 0.0;
    }
    2.0 * libm::atan2(up, along)
}
