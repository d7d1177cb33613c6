//! Edges at which triangles do not meet their neighbours.
//!
//! In: triangles. Out: their rim, the edges that are gone along more often one
//! way than the other. Without a rim the triangles bound a body, however they
//! cross or double one another. Then winding numbers are whole.

use crate::edges::each_edge;
use crate::shell::Shell;
use glam::DVec3;
use isoslice_base::sets::Sets;
use std::collections::BTreeMap;

/// An edge of the rim.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct RimEdge {
    /// The vertices, in the direction of the triangle that is there.
    pub from: u32,
    pub to: u32,
    /// How often it is there.
    pub times: u32,
}

/// The rim of triangles.
pub(crate) fn rim(corners: &[[u32; 3]], vertices: usize) -> Vec<RimEdge> {
    let mut rim = Vec::new();
    each_edge(corners, vertices, |edge| {
        if let Some((from, to, times)) = edge.excess() {
            rim.push(RimEdge { from, to, times });
        }
    });
    rim
}

/// Triangles that close a rim: from each of its edges to the middle of the edges
/// that hang together with it.
pub(crate) fn caps(shell: &Shell, rim: &[RimEdge]) -> Shell {
    let mut numbers = BTreeMap::new();
    let mut vertices: Vec<DVec3> = Vec::new();
    let mut number = |v: u32| {
        *numbers.entry(v).or_insert_with(|| {
            vertices.push(shell.vertices[v as usize]);
            vertices.len() as u32 - 1
        })
    };
    let edges: Vec<(u32, u32, u32)> = rim
        .iter()
        .map(|e| (number(e.from), number(e.to), e.times))
        .collect();
    let mut sets = Sets::new(vertices.len());
    for &(from, to, _) in &edges {
        sets.join(from as usize, to as usize);
    }
    let mut middles: BTreeMap<usize, (u32, DVec3)> = BTreeMap::new();
    for (v, place) in vertices.iter().enumerate() {
        let middle = middles.entry(sets.of(v)).or_default();
        middle.0 += 1;
        middle.1 += place;
    }
    let mut tops = BTreeMap::new();
    for (set, (number, sum)) in middles {
        tops.insert(set, vertices.len() as u32);
        vertices.push(sum / f64::from(number));
    }
    let mut corners = Vec::new();
    for (from, to, times) in edges {
        let top = tops[&sets.of(from as usize)];
        for _ in 0..times {
            corners.push([top, to, from]);
        }
    }
    Shell::new(vertices, corners)
}
