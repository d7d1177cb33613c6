//! Rims that lie on one another.
//!
//! Rounding makes two vertices of one, or puts a vertex of one side on the edge
//! of the other:
//!
//! ```text
//!   ───────A──────────────B───     the upper triangle has the edge AB,
//!   ───────A─────C────────B───     the lower ones have AC and CB
//! ```
//!
//! Vertices of rims that are as near as rounding, or not much farther apart, are made
//! one. A vertex on an
//! edge parts it: a triangle A, C, B without an area is put between.

use super::Work;
use crate::edges::each_edge;
use crate::tree::{Node, Tree, above, below};
use glam::DVec3;
use isocontour::Bounds;
use isoslice_base::limits::is_stopped;
use isoslice_base::sets::Sets;
use std::cell::Cell;

/// What is nearer than this share of the mesh's size is at the same place: some
/// roundings of f32.
const NEAR: f64 = 1e-6;
/// Where rims are left open, places farther apart are the same: 1 µm and 10 µm in
/// a part of 100 mm.
const FARTHER: [f64; 2] = [1e-5, 1e-4];
/// Share of the shortest rim edge at a vertex beyond which no other one is at the same
/// place, unless it is as near as rounding: fine rims keep their shape.
const OF_EDGE: f64 = 0.1;
/// Nodes of the tree and edges that are looked at, by edge of the rim. Usual rims
/// take 7 to 16. Where all edges lie on one another, not all are looked at.
const LOOKS: usize = 40;

/// Edges with an odd number of triangles, and places on them.
struct Rim {
    /// From and to, as more triangles go.
    edges: Vec<[u32; 2]>,
    reach: f64,
    /// Distance of places that are the same whatever the rim is like.
    rounding: f64,
    /// Length of the shortest edge of the rim at each vertex.
    shortest: Vec<f64>,
}

impl Rim {
    fn of(vertices: &[DVec3], corners: &[[u32; 3]], near: f64) -> Rim {
        let mut edges = Vec::new();
        each_edge(corners, vertices.len(), |edge| {
            if let Some((from, to, more)) = edge.excess()
                && more % 2 == 1
            {
                edges.push([from, to]);
            }
        });
        let mut shortest = vec![f64::INFINITY; vertices.len()];
        for [a, b] in edges.iter().map(|edge| edge.map(|v| v as usize)) {
            let length = vertices[a].distance(vertices[b]);
            shortest[a] = length.min(shortest[a]);
            shortest[b] = length.min(shortest[b]);
        }
        let around = Bounds::around(vertices.iter().copied());
        let size = around.size().max_element();
        Rim {
            edges,
            reach: near * size,
            rounding: NEAR * size,
            shortest,
        }
    }

    /// How far from a vertex another place may be that is the same.
    fn reach_of(&self, vertex: u32) -> f64 {
        let own = OF_EDGE * self.shortest[vertex as usize];
        own.min(self.reach).max(self.rounding)
    }

    /// Calls `see` with vertices of the rim and the numbers of edges that may be
    /// near to them.
    fn each_near(&self, vertices: &[DVec3], mut see: impl FnMut(u32, usize)) {
        let edges: Vec<[u32; 3]> =
            self.edges.iter().map(|[a, b]| [*a, *b, *b]).collect();
        let (tree, order) = Tree::new(vertices, &edges);
        let looks = Cell::new(0);
        let look = || looks.set(looks.get() + 1);
        let mut is_seen = vec![false; vertices.len()];
        // What follows one another in the tree is near in memory.
        let ends = order.iter().flat_map(|edge| self.edges[*edge as usize]);
        for end in ends {
            if std::mem::replace(&mut is_seen[end as usize], true) {
                continue;
            }
            // The caller asks as well, and drops what is unfinished.
            if is_stopped() {
                return;
            }
            let p = vertices[end as usize];
            let low = (p - self.reach).to_array().map(below);
            let high = (p + self.reach).to_array().map(above);
            if looks.get() > LOOKS * edges.len() {
                return;
            }
            tree.visit(
                |node| {
                    look();
                    meets(node, low, high)
                },
                |first, after| {
                    for edge in &order[first..after] {
                        look();
                        see(end, *edge as usize);
                    }
                },
            );
        }
    }
}

/// The boxes of a node that meet a box.
fn meets(node: &Node, low: [f32; 3], high: [f32; 3]) -> [bool; 4] {
    [0, 1, 2, 3].map(|i| {
        (0..3).all(|k| node.min[k][i] <= high[k] && node.max[k][i] >= low[k])
    })
}

/// Joins rims that lie on one another. Returns how many vertices were made one with
/// others, or part an edge.
pub(super) fn join(work: &mut Work) -> usize {
    let near = nearness(work);
    weld(work, near) + part_edges(work, near)
}

/// How near places have to be that are one, as a share of the size: farther apart
/// than roundings only if that leaves less than half of the open edges that a smaller
/// distance leaves.
fn nearness(work: &Work) -> f64 {
    let mut best = NEAR;
    let mut least = usize::MAX;
    for near in std::iter::once(NEAR).chain(FARTHER) {
        let mut trial = Work::new(work.vertices.clone(), work.corners.clone());
        weld(&mut trial, near);
        let open = Rim::of(&trial.vertices, &trial.corners, near).edges.len();
        if open < least.div_ceil(2) {
            (best, least) = (near, open);
        }
        if open == 0 || is_stopped() {
            break;
        }
    }
    best
}

/// Makes vertices of rims one that are at the same place. Returns how many are
/// gone.
fn weld(work: &mut Work, near: f64) -> usize {
    let vertices = &work.vertices;
    let rim = Rim::of(vertices, &work.corners, near);
    let mut sets = Sets::new(vertices.len());
    let mut welded = 0;
    rim.each_near(vertices, |end, edge| {
        for other in rim.edges[edge] {
            let reach = rim.reach_of(end).min(rim.reach_of(other));
            let one = sets.of(end as usize);
            let other = sets.of(other as usize);
            if vertices[one].distance(vertices[other]) <= reach
                && sets.join(one, other)
            {
                welded += 1;
            }
        }
    });
    if welded > 0 {
        for corner in work.corners.as_flattened_mut() {
            *corner = sets.of(*corner as usize) as u32;
        }
        work.leave_out(|[a, b, c]| a == b || b == c || c == a);
    }
    welded
}

/// Parts edges of rims at the vertices of rims that lie on them. Returns how
/// many vertices did.
fn part_edges(work: &mut Work, near: f64) -> usize {
    let rim = Rim::of(&work.vertices, &work.corners, near);
    let mut places = Vec::new();
    rim.each_near(&work.vertices, |vertex, edge| {
        let [from, to] = rim.edges[edge];
        if vertex == from || vertex == to {
            return;
        }
        let [p, a, b] = [vertex, from, to].map(|v| work.vertices[v as usize]);
        let along = (p - a).dot(b - a) / (b - a).length_squared();
        if along > 0.0
            && along < 1.0
            && p.distance(a.lerp(b, along)) <= rim.reach_of(vertex)
            // Each vertex lies on one edge, if not many lie on one another.
            && places.len() < rim.edges.len()
        {
            places.push((edge, along, vertex));
        }
    });
    places.sort_unstable_by(|a, b| {
        a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)).then(a.2.cmp(&b.2))
    });
    for on in places.chunk_by(|a, b| a.0 == b.0) {
        if !work.has_room(on.len()) {
            break;
        }
        let [mut from, to] = rim.edges[on[0].0];
        for (_, _, vertex) in on {
            work.add([to, from, *vertex]);
            from = *vertex;
        }
    }
    places.len()
}
