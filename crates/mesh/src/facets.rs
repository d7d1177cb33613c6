//! The parts of a mesh's surface, and of surfaces at one distance from it, that a box
//! may meet, moved and turned as the mesh is.
//!
//! In: a box in coordinates that an affine map takes to those of the mesh, and a
//! distance. Out: the parts there, in the coordinates of the box. At the mesh itself
//! these are its triangles. At a distance they are the triangles moved along their
//! normals, pieces of cylinders around edges, and pieces of balls around vertices:
//!
//! ```text
//!      ________                An edge has a piece of a cylinder on the side from
//!    ╱    b    ╲               which it sticks out, between the normals of its
//!   |  ________ |  a triangle  faces. On the other side the moved triangles cross.
//!   a |        |
//! ```
//!
//! Guarantees: what is inside at that distance begins and ends on these parts only,
//! and on the cover over openings. Where a mesh has faces inside, as of bodies that
//! cross one another, both sides of all faces count at a distance inwards.

use crate::mesh::Mesh;
use crate::shell::Shell;
use crate::tree::Node;
use glam::{DAffine3, DVec3};
use isocontour::{Bounds, Facet};

/// By how much the scales of a map may differ, as a share, where it keeps distances
/// but for one factor. Constants of expressions have 32 bits.
const ALIKE: f64 = 1e-6;
/// Sine of the angle by which a direction may miss the border of those that an edge
/// or a vertex has.
const BESIDE: f64 = 1e-9;
/// Most edges of a vertex that are looked at: the work grows with their third power.
/// With fewer edges there are more directions, so that no bound is too low.
const MOST_EDGES: usize = 32;

impl Mesh {
    /// Tells all parts that may meet a box of the surface with the value `level`.
    /// False if what is inside may begin elsewhere, or the map cannot be inverted, or
    /// changes shapes.
    pub(crate) fn facets_over(
        &self,
        place: &DAffine3,
        level: f64,
        over: &Bounds,
        tell: &mut dyn FnMut(Facet),
    ) -> bool {
        let to = place.inverse();
        if !self.sign.is_whole() || !to.is_finite() {
            return false;
        }
        if level == 0.0 {
            self.shell
                .triangles_over(&to, over, 0.0, &mut |_, corners| {
                    tell(Facet::Flat(corners));
                });
        } else {
            let Some(scale) = scale_of(&to) else {
                return false;
            };
            let both = level < 0.0 && self.has_inner();
            let sides: &[f64] = if both { &[-1.0, 1.0] } else { &[1.0] };
            for side in sides {
                let side = side * level.signum();
                let at = Offset {
                    to,
                    scale,
                    level,
                    side,
                };
                self.shell.offset_over(&at, over, tell);
            }
        }
        if let Some(cover) = self.sign.cover() {
            let lid = cover.alone();
            lid.triangles_over(&to, over, 0.0, &mut |_, corners| {
                tell(Facet::Flat(corners));
            });
        }
        true
    }
}

/// The factor of a map that turns, mirrors and scales only.
fn scale_of(to: &DAffine3) -> Option<f64> {
    let m = to.matrix3;
    let scale = m.x_axis.length();
    let square = scale * scale;
    let lengths = [m.y_axis, m.z_axis]
        .iter()
        .all(|axis| (axis.length() - scale).abs() <= ALIKE * scale);
    let right = [
        m.x_axis.dot(m.y_axis),
        m.y_axis.dot(m.z_axis),
        m.z_axis.dot(m.x_axis),
    ]
    .iter()
    .all(|dot| dot.abs() <= ALIKE * square);
    (lengths && right && scale > 0.0).then_some(scale)
}

/// A surface at one distance of triangles.
struct Offset {
    /// The map to the coordinates of the box, and its factor.
    to: DAffine3,
    scale: f64,
    /// The distance, in the coordinates of the mesh.
    level: f64,
    /// The side of the triangles on which the surface is: 1 where their normals lead,
    /// or -1.
    side: f64,
}

impl Offset {
    /// The distance in the coordinates of the box, along the normals.
    fn radius(&self) -> f64 {
        self.level.abs() * self.side * self.scale
    }

    /// A direction in the coordinates of the box.
    fn turned(&self, way: DVec3) -> DVec3 {
        (self.to.matrix3 * way).normalize_or_zero()
    }

    /// The direction in the mesh whose height is looked at.
    fn upward(&self) -> DVec3 {
        self.to.matrix3.row(2).normalize_or_zero()
    }
}

/// Some directions, by how far each leads up.
struct Ways {
    least: (f64, DVec3),
    most: (f64, DVec3),
    sum: DVec3,
}

impl Ways {
    const NONE: Ways = Ways {
        least: (f64::INFINITY, DVec3::ZERO),
        most: (f64::NEG_INFINITY, DVec3::ZERO),
        sum: DVec3::ZERO,
    };

    fn add(&mut self, upward: DVec3, way: DVec3) {
        let up = way.dot(upward);
        if up < self.least.0 {
            self.least = (up, way);
        }
        if up > self.most.0 {
            self.most = (up, way);
        }
        self.sum += way;
    }

    /// The part of a surface that is as far from a line as `at` says. None if there
    /// is no more than one direction.
    fn around(self, at: &Offset, line: [DVec3; 2]) -> Option<Facet> {
        let spread = self.most.1.distance(self.least.1);
        if self.least.0 > self.most.0 || spread <= BESIDE {
            return None;
        }
        let middle = self.sum.try_normalize().unwrap_or(self.most.1);
        Some(Facet::Round {
            line,
            radius: at.radius(),
            up: [self.least.0, self.most.0],
            ways: [middle, self.least.1, self.most.1].map(|way| at.turned(way)),
        })
    }
}

impl Shell {
    /// Tells the numbers of all triangles that may be within a distance of a box, and
    /// their corners once they are taken `to` its coordinates.
    fn triangles_over(
        &self,
        to: &DAffine3,
        over: &Bounds,
        within: f64,
        tell: &mut dyn FnMut(usize, [DVec3; 3]),
    ) {
        let wide = over.grown(within);
        let meets = |node: &Node| {
            [0, 1, 2, 3].map(|i| {
                // Boxes are low, so that height tells most.
                [2, 0, 1].iter().all(|&axis| {
                    let row = to.matrix3.row(axis);
                    let [low, high] = node.range(i, row, to.translation[axis]);
                    low <= wide.max[axis] && high >= wide.min[axis]
                })
            })
        };
        self.tree.visit(meets, |first, end| {
            for i in first..end {
                let corners = self.triangle(i).map(|p| to.transform_point3(p));
                if Bounds::around(corners).gap(over) <= within {
                    tell(i, corners);
                }
            }
        });
    }

    /// Tells all parts that may meet a box of the surface at a distance.
    fn offset_over(
        &self,
        at: &Offset,
        over: &Bounds,
        tell: &mut dyn FnMut(Facet),
    ) {
        let within = at.radius().abs() * (1.0 + ALIKE);
        let mut edges: Vec<([u32; 2], u32)> = Vec::new();
        let mut vertices: Vec<(u32, u32)> = Vec::new();
        self.triangles_over(&at.to, over, within, &mut |i, corners| {
            let Some(normal) = self.normal(i).try_normalize() else {
                return;
            };
            let way = at.turned(normal) * at.radius();
            let moved = corners.map(|p| p + way);
            if Bounds::around(moved).gap(over) == 0.0 {
                tell(Facet::Flat(moved));
            }
            let numbers = self.corners[i];
            for k in 0..3 {
                let (a, b) = (numbers[k], numbers[(k + 1) % 3]);
                edges.push(([a.min(b), a.max(b)], i as u32));
                vertices.push((a, i as u32));
            }
        });
        // All triangles of an edge or a vertex that is near are near.
        let is_near =
            |line: [DVec3; 2]| Bounds::around(line).gap(over) <= within;
        let place = |v: u32| at.to.transform_point3(self.vertices[v as usize]);
        edges.sort_unstable();
        for of in edges.chunk_by(|a, b| a.0 == b.0) {
            let line = of[0].0.map(place);
            if is_near(line) {
                let ways = self.ways_of_edge(at, of);
                ways.around(at, line).into_iter().for_each(&mut *tell);
            }
        }
        vertices.sort_unstable();
        for of in vertices.chunk_by(|a, b| a.0 == b.0) {
            let line = [place(of[0].0); 2];
            if is_near(line) {
                let ways = self.ways_of_vertex(at, of);
                ways.around(at, line).into_iter().for_each(&mut *tell);
            }
        }
    }

    /// The normals of the surface around an edge: the directions, on the surface's
    /// side, in which none of its triangles leads.
    fn ways_of_edge(&self, at: &Offset, of: &[([u32; 2], u32)]) -> Ways {
        let mut ways = Ways::NONE;
        let [a, b] = of[0].0.map(|v| self.vertices[v as usize]);
        let Some(along) = (b - a).try_normalize() else {
            return ways;
        };
        let upward = at.upward();
        // From the edge into each triangle.
        let into: Vec<DVec3> = of
            .iter()
            .filter_map(|&([a, b], triangle)| {
                let corners = self.corners[triangle as usize];
                let third = corners.into_iter().find(|v| *v != a && *v != b)?;
                let way =
                    self.vertices[third as usize] - self.vertices[a as usize];
                (way - along * way.dot(along)).try_normalize()
            })
            .collect();
        let is_free =
            |way: DVec3| into.iter().all(|into| way.dot(*into) <= BESIDE);
        let normal: DVec3 = of
            .iter()
            .map(|e| self.normal(e.1 as usize).normalize_or_zero())
            .sum();
        let is_rim = of.len() == 1;
        let mut add = |way: DVec3| {
            let on_side = is_rim || way.dot(normal) * at.side > 0.0;
            if on_side && is_free(way) {
                ways.add(upward, way * at.side);
            }
        };
        for into in &into {
            let across = into.cross(along);
            add(across);
            add(-across);
        }
        // The most level ones, if they are between the others.
        let flat = upward - along * upward.dot(along);
        if let Some(way) = flat.try_normalize() {
            add(way);
            add(-way);
        }
        ways
    }

    /// The normals of the surface around a vertex: the directions, on the surface's
    /// side, in which none of its edges leads.
    fn ways_of_vertex(&self, at: &Offset, of: &[(u32, u32)]) -> Ways {
        let mut ways = Ways::NONE;
        let own = of[0].0;
        let upward = at.upward();
        let mut others: Vec<u32> = of
            .iter()
            .flat_map(|v| self.corners[v.1 as usize])
            .filter(|v| *v != own)
            .collect();
        others.sort_unstable();
        others.dedup();
        let step = others.len().div_ceil(MOST_EDGES).max(1);
        let place = |v: u32| self.vertices[v as usize];
        let edges: Vec<DVec3> = others
            .into_iter()
            .step_by(step)
            .filter_map(|v| (place(v) - place(own)).try_normalize())
            .collect();
        let is_free =
            |way: DVec3| edges.iter().all(|edge| way.dot(*edge) <= BESIDE);
        // By their angles, so that the sum is on one side of the surface with all
        // places that are closest to the vertex (Bærentzen and Aanæs, "Signed distance
        // computation using the angle weighted pseudonormal", 2005).
        let normal: DVec3 = of
            .iter()
            .map(|v| {
                let i = v.1 as usize;
                let normal = self.normal(i).normalize_or_zero();
                normal * self.angle(i, own)
            })
            .sum();
        let mut add = |way: DVec3| {
            if way.dot(normal) * at.side > 0.0 && is_free(way) {
                ways.add(upward, way * at.side);
            }
        };
        // The most level directions are straight up or down, or on the border.
        let mut both = |way: DVec3| {
            if let Some(way) = way.try_normalize() {
                add(way);
                add(-way);
            }
        };
        both(upward);
        for (i, a) in edges.iter().enumerate() {
            both(upward - *a * upward.dot(*a));
            for b in &edges[..i] {
                both(a.cross(*b));
            }
        }
        ways
    }

    /// The angle of a triangle at one of its vertices.
    fn angle(&self, triangle: usize, vertex: u32) -> f64 {
        let at = self.corners[triangle].iter().position(|v| *v == vertex);
        let corners = self.triangle(triangle);
        let k = at.unwrap_or(0);
        let [a, b] = [1, 2].map(|i| corners[(k + i) % 3] - corners[k]);
        a.angle_between(b)
    }
}

#[cfg(test)]
mod tests;
