//! The lattice edges that the outlines of a batch of leaves cross.
//!
//! An edge on the border of two leaves of the batch is found once. For each
//! node a bit tells on which side of the outline it is. The bits of a row of
//! nodes are one number.

use super::link::NONE;
use super::refine::Bracket;
use crate::cells::bits;
use crate::field::{LEAF, Lattice, Leaf, NODES};
use glam::DVec2;

/// Nodes of a leaf.
const COUNT: usize = NODES * NODES;
/// Edges of a leaf: the horizontal ones, then the vertical ones.
const EDGES: usize = 2 * LEAF * NODES;

/// The number of the horizontal edge that begins at a node, among a leaf's
/// edges.
fn horizontal(i: usize, j: usize) -> usize {
    j * LEAF + i
}

/// The number of the vertical edge that begins at a node, among a leaf's edges.
fn vertical(i: usize, j: usize) -> usize {
    NODES * LEAF + j * NODES + i
}

/// An edge with different signs of the field at its ends.
#[derive(Clone, Copy, Debug)]
pub(super) struct Edge {
    pub inside: DVec2,
    pub outside: DVec2,
    /// The field at both ends.
    pub field: [f32; 2],
    /// The edge's number in the lattice.
    pub number: u32,
    /// The edge's layer in the slab.
    pub layer: u32,
}

impl Edge {
    pub(super) fn bracket(&self, z: &[f32]) -> Bracket {
        let z = z[self.layer as usize];
        Bracket::new([self.inside, self.outside], self.field, z)
    }
}

/// The edges of a batch of leaves.
#[derive(Default)]
pub(super) struct Edges {
    /// All edges. The vertices on them have the same numbers.
    pub all: Vec<Edge>,
    /// Rows of inside bits of each leaf.
    rows: Vec<[u16; NODES]>,
    /// Numbers of each leaf's edges.
    slots: Vec<[u32; EDGES]>,
}

impl Edges {
    /// Finds the crossed edges of a batch.
    pub(super) fn find(
        &mut self,
        leaves: &[Leaf],
        values: &[f32],
        lattice: &Lattice,
    ) {
        self.all.clear();
        self.rows.clear();
        self.slots.clear();
        for (n, values) in values.chunks_exact(COUNT).enumerate() {
            self.leaf(&leaves[n], &leaves[..n], values, lattice);
        }
    }

    /// Finds the edges of a leaf, given those that came before it.
    fn leaf(
        &mut self,
        leaf: &Leaf,
        known: &[Leaf],
        values: &[f32],
        lattice: &Lattice,
    ) {
        let mut rows = [0u16; NODES];
        for (row, v) in rows.iter_mut().zip(values.chunks_exact(NODES)) {
            for (i, &f) in v.iter().enumerate() {
                *row |= u16::from(f < 0.0) << i;
            }
        }
        let mut slots = [NONE; EDGES];
        let beside = |di: usize, dj: usize| {
            let (i, j) = (leaf.i.checked_sub(di)?, leaf.j.checked_sub(dj)?);
            let place = |l: &Leaf| (l.layer, l.j, l.i);
            // Batches come in this order. If one does not, some leaves are not
            // found here, and an edge that two leaves share is noted for both.
            known.binary_search_by_key(&(leaf.layer, j, i), place).ok()
        };
        if let Some(left) = beside(LEAF, 0) {
            for j in 0..LEAF {
                slots[vertical(0, j)] = self.slots[left][vertical(LEAF, j)];
            }
        }
        if let Some(below) = beside(0, LEAF) {
            for i in 0..LEAF {
                slots[horizontal(i, 0)] =
                    self.slots[below][horizontal(i, LEAF)];
            }
        }
        let width = lattice.width() + 1;
        let corner = leaf.j * width + leaf.i;
        let at = |i: usize, j: usize| lattice.node(leaf.i + i, leaf.j + j);
        let all = &mut self.all;
        let mut add = |slot: usize, [i, j]: [usize; 2], [k, l]: [usize; 2]| {
            if slots[slot] != NONE {
                return;
            }
            slots[slot] = all.len() as u32;
            let (f, g) = (values[j * NODES + i], values[l * NODES + k]);
            let (inside, outside, field) = if f < 0.0 {
                (at(i, j), at(k, l), [f, g])
            } else {
                (at(k, l), at(i, j), [g, f])
            };
            let node = corner + j * width + i;
            all.push(Edge {
                inside,
                outside,
                field,
                number: (2 * node + l - j) as u32,
                layer: leaf.layer as u32,
            });
        };
        for j in 0..NODES {
            let across = (rows[j] ^ (rows[j] >> 1)) & 0xff;
            for i in bits(across) {
                add(horizontal(i, j), [i, j], [i + 1, j]);
            }
            if j < LEAF {
                for i in bits(rows[j] ^ rows[j + 1]) {
                    add(vertical(i, j), [i, j], [i, j + 1]);
                }
            }
        }
        self.rows.push(rows);
        self.slots.push(slots);
    }

    /// Inside bits of the lower and the upper nodes of a row of cells.
    pub(super) fn row(&self, leaf: usize, j: usize) -> [u16; 2] {
        let rows = &self.rows[leaf];
        [rows[j], rows[j + 1]]
    }

    /// Numbers of a cell's edges, south, east, north and west.
    pub(super) fn of_cell(&self, leaf: usize, i: usize, j: usize) -> [u32; 4] {
        let slots = &self.slots[leaf];
        let south = slots[horizontal(i, j)];
        let north = slots[horizontal(i, j + 1)];
        let west = slots[vertical(i, j)];
        [south, slots[vertical(i + 1, j)], north, west]
    }
}
