//! Joins the leaves' pieces of outline into closed rings.
//!
//! Within a leaf the pieces are connected as they are found. A vertex on the
//! border of two leaves exists once in each, at the same place (both refined
//! it on the same lattice edge): where one leaf's chain ends, the other's
//! goes on.

use crate::field::{LEAF, Lattice, Leaf};
use crate::plane::Ring;
use glam::DVec2;

/// No vertex, or no lattice edge.
pub(super) const NONE: u32 = u32::MAX;

/// A lattice edge and the vertex on it at which a chain breaks off.
type Loose = (u32, u32);

/// One layer's vertices and how they follow each other.
#[derive(Default)]
pub(super) struct Chains {
    points: Vec<DVec2>,
    edges: Vec<u32>,
    next: Vec<u32>,
    has_previous: Vec<bool>,
    leaves: Vec<(u32, u32)>,
}

impl Chains {
    /// Notes that a leaf has been sampled.
    pub(super) fn visited(&mut self, leaf: &Leaf) {
        self.leaves.push((leaf.i as u32, leaf.j as u32));
    }

    /// Adds a vertex; returns its number.
    pub(super) fn add(&mut self, point: DVec2, edge: u32) -> u32 {
        self.points.push(point);
        self.edges.push(edge);
        self.next.push(NONE);
        self.has_previous.push(false);
        self.points.len() as u32 - 1
    }

    /// Lets `to` follow `from`.
    pub(super) fn connect(&mut self, from: u32, to: u32) {
        self.next[from as usize] = to;
        self.has_previous[to as usize] = true;
    }

    /// Vertices at which a chain ends and those at which one begins, by
    /// lattice edge.
    fn loose(&self) -> (Vec<Loose>, Vec<Loose>) {
        let (mut ends, mut starts) = (Vec::new(), Vec::new());
        for i in 0..self.points.len() {
            match (self.has_previous[i], self.next[i] != NONE) {
                (true, false) => ends.push((self.edges[i], i as u32)),
                (false, true) => starts.push((self.edges[i], i as u32)),
                _ => {}
            }
        }
        ends.sort_unstable();
        starts.sort_unstable();
        (ends, starts)
    }

    /// Leaves beside loose ends that were not sampled.
    pub(super) fn missing_leaves(
        &self,
        layer: usize,
        lattice: &Lattice,
    ) -> Vec<Leaf> {
        let (ends, starts) = self.loose();
        let mut missing: Vec<(u32, u32)> = Vec::new();
        let width = lattice.width() + 1;
        let mut look = |edge: u32| {
            let (node, dir) = ((edge / 2) as usize, (edge % 2) as usize);
            let (i, j) = (node % width, node / width);
            // The cells on both sides of the edge.
            for back in [0, 1] {
                let ci = i.checked_sub(if dir == 1 { back } else { 0 });
                let cj = j.checked_sub(if dir == 0 { back } else { 0 });
                if let (Some(ci), Some(cj)) = (ci, cj)
                    && ci < lattice.width()
                    && cj < lattice.height()
                {
                    let leaf = (ci / LEAF * LEAF, cj / LEAF * LEAF);
                    missing.push((leaf.0 as u32, leaf.1 as u32));
                }
            }
        };
        let paired =
            |a: &[Loose], e: u32| a.binary_search_by_key(&e, |x| x.0).is_ok();
        for &(e, _) in ends.iter().filter(|x| !paired(&starts, x.0)) {
            look(e);
        }
        for &(e, _) in starts.iter().filter(|x| !paired(&ends, x.0)) {
            look(e);
        }
        if missing.is_empty() {
            return Vec::new();
        }
        let mut sampled = self.leaves.clone();
        sampled.sort_unstable();
        missing.sort_unstable();
        missing.dedup();
        missing.retain(|l| sampled.binary_search(l).is_err());
        missing
            .into_iter()
            .map(|(i, j)| Leaf {
                layer,
                i: i as usize,
                j: j as usize,
            })
            .collect()
    }

    /// The closed rings, and how many had to be closed by force.
    pub(super) fn into_rings(mut self) -> (Vec<Ring>, usize) {
        let (ends, starts) = self.loose();
        for (edge, end) in ends {
            let at = starts.partition_point(|s| s.0 < edge);
            if let Some(&(e, start)) = starts.get(at)
                && e == edge
            {
                self.connect(end, start);
            }
        }
        let mut seen = vec![false; self.points.len()];
        let mut rings = Vec::new();
        let mut forced = 0;
        // Open chains first, from their beginnings; then the closed ones.
        let open = (0..seen.len()).filter(|&i| !self.has_previous[i]);
        for first in open.chain(0..seen.len()) {
            if seen[first] || self.next[first] == NONE {
                continue;
            }
            let mut ring = Ring::new();
            let mut i = first;
            loop {
                seen[i] = true;
                if ring.last() != Some(&self.points[i]) {
                    ring.push(self.points[i]);
                }
                match self.next[i] {
                    NONE => {
                        forced += 1;
                        break;
                    }
                    n if seen[n as usize] => break,
                    n => i = n as usize,
                }
            }
            rings.push(ring);
        }
        (rings, forced)
    }
}
