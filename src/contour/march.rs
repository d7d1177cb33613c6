//! Marching squares over sampled leaves (Lorensen and Cline 1987, in 2D).
//!
//! ```text
//!   tl ──N── tr      corner bits: bl 1, br 2, tr 4, tl 8
//!   │        │       a segment runs from edge to edge with the inside
//!   W        E       on its left
//!   │        │
//!   bl ──S── br
//! ```
//!
//! The two cells in which opposite corners are inside and the others are not
//! are decided by the field at the cell's centre.

use super::corner;
use super::link::{Chains, NONE};
use super::refine::{Bracket, refine};
use crate::field::{Batch, FieldError, LEAF, Lattice, Leaf, NODES};
use crate::units::Mm;
use glam::DVec2;

/// Nodes of a leaf.
const COUNT: usize = NODES * NODES;
/// Edges of a leaf: the horizontal ones, then the vertical ones.
const EDGES: usize = 2 * LEAF * NODES;

const S: u8 = 0;
const E: u8 = 1;
const N: u8 = 2;
const W: u8 = 3;

/// Segments of each case; the ambiguous ones (5 and 10) as if the cell's
/// centre were outside.
const CASES: [&[(u8, u8)]; 16] = [
    &[],
    &[(S, W)],
    &[(E, S)],
    &[(E, W)],
    &[(N, E)],
    &[(S, W), (N, E)],
    &[(N, S)],
    &[(N, W)],
    &[(W, N)],
    &[(S, N)],
    &[(E, S), (W, N)],
    &[(E, N)],
    &[(W, E)],
    &[(S, E)],
    &[(W, S)],
    &[],
];

/// The ambiguous cases with the centre inside.
const JOINED_5: &[(u8, u8)] = &[(N, W), (S, E)];
const JOINED_10: &[(u8, u8)] = &[(W, S), (E, N)];

/// A vertex of the outline.
#[derive(Clone, Copy, Debug)]
pub(super) struct Vertex {
    /// Place, mm.
    pub point: DVec2,
    /// In-plane gradient of the field, of no particular length.
    pub gradient: DVec2,
    /// The lattice edge it lies on; `NONE` for an inserted corner.
    pub edge: u32,
}

/// A piece of outline across one cell.
#[derive(Clone, Copy, Debug)]
pub(super) struct Segment {
    /// Layer of the slab.
    pub layer: usize,
    /// Lattice column and row of the cell.
    pub cell: [usize; 2],
    /// Vertices, counted within the batch.
    pub from: u32,
    pub to: u32,
}

/// Walks batches of leaves and adds their pieces to the layers' chains.
pub(super) struct Marcher<'a> {
    lattice: &'a Lattice,
    z: Vec<f32>,
    nan: Vec<usize>,
    /// Rows of inside bits of the batch's leaves.
    rows: Vec<[u16; NODES]>,
    /// Edges with a sign change, leaf by leaf.
    brackets: Vec<Bracket>,
    edges: Vec<u32>,
    layers: Vec<usize>,
    /// Batch-wide vertex number of each of a leaf's edges.
    slots: Vec<[u32; EDGES]>,
    vertices: Vec<Vertex>,
    segments: Vec<Segment>,
    /// Ambiguous cells: (leaf, cell in the leaf), centre inside.
    saddles: Vec<(usize, usize, bool)>,
    scratch: Scratch,
}

/// Coordinates and results of one bulk evaluation.
#[derive(Default)]
pub(super) struct Scratch {
    pub x: Vec<f32>,
    pub y: Vec<f32>,
    pub z: Vec<f32>,
    pub values: Vec<f32>,
    pub gradients: Vec<[f32; 2]>,
}

impl Scratch {
    pub(super) fn clear(&mut self) {
        self.x.clear();
        self.y.clear();
        self.z.clear();
    }

    pub(super) fn push(&mut self, p: DVec2, z: f32) {
        self.x.push(p.x as f32);
        self.y.push(p.y as f32);
        self.z.push(z);
    }
}

impl<'a> Marcher<'a> {
    pub(super) fn new(lattice: &'a Lattice, z: &[Mm]) -> Self {
        Marcher {
            lattice,
            z: z.iter().map(|&z| z as f32).collect(),
            nan: vec![0; z.len()],
            rows: Vec::new(),
            brackets: Vec::new(),
            edges: Vec::new(),
            layers: Vec::new(),
            slots: Vec::new(),
            vertices: Vec::new(),
            segments: Vec::new(),
            saddles: Vec::new(),
            scratch: Scratch::default(),
        }
    }

    /// Samples per layer that were not numbers.
    pub(super) fn nan_samples(&self) -> Vec<usize> {
        self.nan.clone()
    }

    /// Adds a batch's pieces of outline to the layers.
    pub(super) fn march(
        &mut self,
        batch: Batch<'_>,
        layers: &mut [Chains],
    ) -> Result<(), FieldError> {
        self.find_edges(&batch, layers);
        self.decide_saddles(batch.leaves, &mut *batch.sampler)?;
        let heights: Vec<f32> =
            self.layers.iter().map(|&k| self.z[k]).collect();
        refine(
            &mut self.brackets,
            &heights,
            self.lattice.spacing,
            batch.sampler,
            &mut self.scratch,
        )?;
        self.vertices.clear();
        for (b, &edge) in self.brackets.iter().zip(&self.edges) {
            self.vertices.push(Vertex {
                point: b.point(),
                gradient: DVec2::ZERO,
                edge,
            });
        }
        self.gradients(&heights, batch.sampler)?;
        self.find_segments(batch.leaves);
        let corners = corner::corners(
            &self.segments,
            &self.vertices,
            &self.z,
            self.lattice,
            batch.sampler,
            &mut self.scratch,
        )?;
        self.append(layers, &corners);
        Ok(())
    }

    /// Finds the edges with a sign change and numbers their vertices.
    fn find_edges(&mut self, batch: &Batch<'_>, layers: &mut [Chains]) {
        self.rows.clear();
        self.brackets.clear();
        self.edges.clear();
        self.layers.clear();
        self.slots.clear();
        let width = self.lattice.width() + 1;
        for (n, leaf) in batch.leaves.iter().enumerate() {
            layers[leaf.layer].visited(leaf);
            let values = &batch.values[n * COUNT..(n + 1) * COUNT];
            let mut rows = [0u16; NODES];
            for (row, v) in rows.iter_mut().zip(values.chunks_exact(NODES)) {
                for (i, &f) in v.iter().enumerate() {
                    *row |= u16::from(f < 0.0) << i;
                }
            }
            if values.iter().any(|f| f.is_nan()) {
                self.nan[leaf.layer] +=
                    values.iter().filter(|f| f.is_nan()).count();
            }
            let mut slots = [NONE; EDGES];
            let mut add = |i: usize, j: usize, dir: usize| {
                let number = self.brackets.len() as u32;
                let (a, b) = (j * NODES + i, (j + dir) * NODES + i + 1 - dir);
                let at = |i: usize, j: usize| {
                    DVec2::new(
                        f64::from(self.lattice.x[leaf.i + i]),
                        f64::from(self.lattice.y[leaf.j + j]),
                    )
                };
                let (pa, pb) = (at(i, j), at(i + 1 - dir, j + dir));
                self.brackets.push(if values[a] < 0.0 {
                    Bracket::new(pa, pb, values[a], values[b])
                } else {
                    Bracket::new(pb, pa, values[b], values[a])
                });
                let node = (leaf.j + j) * width + leaf.i + i;
                self.edges.push((2 * node + dir) as u32);
                self.layers.push(leaf.layer);
                number
            };
            for j in 0..NODES {
                let across = (rows[j] ^ (rows[j] >> 1)) & 0xff;
                for i in bits(across) {
                    slots[j * LEAF + i] = add(i, j, 0);
                }
                if j < LEAF {
                    for i in bits(rows[j] ^ rows[j + 1]) {
                        slots[NODES * LEAF + j * NODES + i] = add(i, j, 1);
                    }
                }
            }
            self.rows.push(rows);
            self.slots.push(slots);
        }
    }

    /// Asks the field at the centres of ambiguous cells.
    fn decide_saddles(
        &mut self,
        leaves: &[Leaf],
        sampler: &mut dyn crate::field::Sampler,
    ) -> Result<(), FieldError> {
        self.saddles.clear();
        self.scratch.clear();
        for (n, rows) in self.rows.iter().enumerate() {
            for j in 0..LEAF {
                let (low, high) = (rows[j], rows[j + 1]);
                // Opposite corners alike, neighbours not.
                let mask = (low ^ (low >> 1))
                    & (high ^ (high >> 1))
                    & (low ^ high)
                    & 0xff;
                for i in bits(mask) {
                    self.saddles.push((n, j * LEAF + i, false));
                    let (ci, cj) = (leaves[n].i + i, leaves[n].j + j);
                    let l = self.lattice;
                    let centre = DVec2::new(
                        0.5 * (f64::from(l.x[ci]) + f64::from(l.x[ci + 1])),
                        0.5 * (f64::from(l.y[cj]) + f64::from(l.y[cj + 1])),
                    );
                    self.scratch.push(centre, self.z[leaves[n].layer]);
                }
            }
        }
        if self.saddles.is_empty() {
            return Ok(());
        }
        let s = &mut self.scratch;
        sampler.values(&s.x, &s.y, &s.z, &mut s.values)?;
        for (saddle, &f) in self.saddles.iter_mut().zip(&s.values) {
            saddle.2 = f < 0.0;
        }
        Ok(())
    }

    fn gradients(
        &mut self,
        heights: &[f32],
        sampler: &mut dyn crate::field::Sampler,
    ) -> Result<(), FieldError> {
        let s = &mut self.scratch;
        s.clear();
        for (v, &z) in self.vertices.iter().zip(heights) {
            s.push(v.point, z);
        }
        if self.vertices.is_empty() {
            return Ok(());
        }
        sampler.gradients(&s.x, &s.y, &s.z, &mut s.gradients)?;
        for (v, g) in self.vertices.iter_mut().zip(&s.gradients) {
            v.gradient = DVec2::new(f64::from(g[0]), f64::from(g[1]));
        }
        Ok(())
    }

    /// Connects the vertices across the cells.
    fn find_segments(&mut self, leaves: &[Leaf]) {
        self.segments.clear();
        let mut saddles = self.saddles.iter().peekable();
        for (n, leaf) in leaves.iter().enumerate() {
            let (rows, slots) = (&self.rows[n], &self.slots[n]);
            for j in 0..LEAF {
                let (low, high) = (rows[j], rows[j + 1]);
                let mixed =
                    ((low ^ (low >> 1)) | (high ^ (high >> 1)) | (low ^ high))
                        & 0xff;
                for i in bits(mixed) {
                    let case = usize::from(
                        (low >> i & 3)
                            | (high >> (i + 1) & 1) << 2
                            | (high >> i & 1) << 3,
                    );
                    let mut list = CASES[case];
                    if case == 5 || case == 10 {
                        let joined = saddles
                            .next_if(|s| s.0 == n && s.1 == j * LEAF + i)
                            .is_some_and(|s| s.2);
                        if joined {
                            list = if case == 5 { JOINED_5 } else { JOINED_10 };
                        }
                    }
                    let vertical = NODES * LEAF + j * NODES + i;
                    let slot = |edge: u8| match edge {
                        S => slots[j * LEAF + i],
                        N => slots[(j + 1) * LEAF + i],
                        W => slots[vertical],
                        _ => slots[vertical + 1],
                    };
                    for &(from, to) in list {
                        self.segments.push(Segment {
                            layer: leaf.layer,
                            cell: [leaf.i + i, leaf.j + j],
                            from: slot(from),
                            to: slot(to),
                        });
                    }
                }
            }
        }
    }

    /// Hands vertices and segments over to their layers.
    fn append(&mut self, layers: &mut [Chains], corners: &[(usize, DVec2)]) {
        // Batch-wide vertex number → number in the vertex's layer.
        let own: Vec<u32> = self
            .vertices
            .iter()
            .zip(&self.layers)
            .map(|(v, &k)| layers[k].add(v.point, v.edge))
            .collect();
        let mut corners = corners.iter().peekable();
        for (n, s) in self.segments.iter().enumerate() {
            let (from, to) = (own[s.from as usize], own[s.to as usize]);
            let chains = &mut layers[s.layer];
            match corners.next_if(|c| c.0 == n) {
                Some(&(_, point)) => {
                    let middle = chains.add(point, NONE);
                    chains.connect(from, middle);
                    chains.connect(middle, to);
                }
                None => chains.connect(from, to),
            }
        }
    }
}

/// The numbers of the bits that are set.
fn bits(mut mask: u16) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        if mask == 0 {
            return None;
        }
        let i = mask.trailing_zeros() as usize;
        mask &= mask - 1;
        Some(i)
    })
}
