//! Marching squares over sampled leaves (Lorensen and Cline 1987, in 2D).
//!
//! The corners of a cell tell which of its edges the outline joins (`cells`).
//! Two cases are ambiguous, in which two opposite corners are inside and the
//! other two are outside. There the field at the cell's centre decides.
//!
//! Where the straight pieces do not explain the outline, it is followed within
//! its cell (`trace`). A cell is divided (`divide`) where this fails, where a
//! saddle's pieces bend, and where the cell may hide something (`doubt`).

use super::blind::{Blind, judge_planes};
use super::divide::{Cell, Divided, Fineness, divide};
use super::doubt::doubts;
use super::edges::Edges;
use super::link::{Crossing, NONE};
use super::noise::Noise;
use super::refine::{Bracket, refine};
use super::runs::Runs;
use super::samples::{Eyes, Samples};
use super::trace::{Chord, Look, Traced, Vertex, look, trace};
use crate::Length;
use crate::cells::{Place, bits, segments};
use crate::field::{Batch, FieldError, LEAF, Lattice, Leaf, NODES, Sampler};
use glam::DVec2;
use std::ops::Range;

/// Nodes of a leaf.
const COUNT: usize = NODES * NODES;

/// A piece of outline across one cell.
#[derive(Clone, Copy, Debug)]
struct Segment {
    /// Layer of the slab.
    layer: usize,
    /// Number of the leaf within the batch.
    leaf: usize,
    /// Lattice column and row of the cell.
    cell: [usize; 2],
    /// Numbers of the vertices within the batch.
    from: u32,
    to: u32,
    /// True if the cell has another piece.
    saddle: bool,
}

/// How outlines are found.
#[derive(Clone, Copy, Debug)]
pub(super) struct Precision {
    /// Greatest distance of a chord from the outline.
    pub chord: Length,
    /// Size of the smallest feature that has to be found.
    pub smallest: Length,
}

/// Least number of parts that a cell is divided into, along its side.
const PARTS: usize = 8;
/// Greatest number of parts: a million samples would be too many for a cell.
const MOST_PARTS: usize = 64;

impl Precision {
    /// How cells of a given size are divided: finely enough for at least one
    /// node in a feature.
    fn fineness(&self, spacing: Length) -> Fineness {
        let mut parts = PARTS;
        while parts < MOST_PARTS && spacing / parts as f64 > 0.6 * self.smallest
        {
            parts *= 2;
        }
        Fineness {
            parts,
            tolerance: self.chord,
            trusted: 1.5 * self.smallest,
            smallest: self.smallest,
        }
    }
}

/// The field may wave between the nodes of a leaf if it is this many times as
/// steep on the outline as from node to node, in this many cells.
const STEEP: f64 = 4.0;
const STEEP_PLACES: usize = 4;

/// About how many samples cells that are divided together have. The lines found
/// in the samples need several times the memory of the samples.
const AT_ONCE: usize = 1 << 16;

/// Walks batches of leaves and adds their pieces to the layers' chains.
pub(super) struct Marcher<'a> {
    lattice: &'a Lattice,
    precision: Precision,
    z: &'a [f32],
    nan: Vec<usize>,
    /// For each layer, why its plane is blind.
    blind: Vec<Blind>,
    noise: Noise,
    edges: Edges,
    /// Where the outlines cross the edges.
    vertices: Vec<Vertex>,
    segments: Vec<Segment>,
    /// Ambiguous cells: leaf, cell in the leaf, and true if the centre is
    /// inside.
    saddles: Vec<(usize, usize, bool)>,
    /// Segments that bend, each with the point that it bends through.
    bends: Vec<(usize, DVec2)>,
    /// Memory for looks at the field between batches.
    samples: Samples,
}

impl<'a> Marcher<'a> {
    pub(super) fn new(
        lattice: &'a Lattice,
        z: &'a [f32],
        precision: Precision,
    ) -> Self {
        Marcher {
            lattice,
            precision,
            z,
            nan: vec![0; z.len()],
            blind: vec![Blind::NOT; z.len()],
            noise: Noise::new(precision.smallest),
            edges: Edges::default(),
            vertices: Vec::new(),
            segments: Vec::new(),
            saddles: Vec::new(),
            bends: Vec::new(),
            samples: Samples::default(),
        }
    }

    /// For each layer the number of samples that were NaN.
    pub(super) fn nan_samples(&self) -> Vec<usize> {
        self.nan.clone()
    }

    /// Judges whether the planes of a batch's layers are blind, where layers
    /// are needed. Only the reasons in `heeded` count.
    pub(super) fn judge_planes(
        &mut self,
        batch: &mut Batch<'_>,
        needed: &Range<usize>,
        heeded: Blind,
    ) -> Result<(), FieldError> {
        if heeded == Blind::NOT {
            return Ok(());
        }
        let Batch {
            leaves,
            span,
            values,
            ..
        } = *batch;
        let mut samples = std::mem::take(&mut self.samples);
        let eyes = &mut self.eyes(&mut *batch.sampler, &mut samples);
        let judged = judge_planes(leaves, span, values, needed, eyes)?;
        self.samples = samples;
        for (layer, blind) in judged {
            let span = layer..layer + span;
            for k in span.filter(|k| needed.contains(k)) {
                self.blind[k] = self.blind[k].or(blind.and(heeded));
            }
        }
        Ok(())
    }

    /// Why the planes of the layers are blind, as far as they have been judged.
    pub(super) fn blind(&self) -> &[Blind] {
        &self.blind
    }

    /// Adds a batch's pieces of outline to the runs of layers. Each of its
    /// leaves stands for `weight` layers that are needed.
    pub(super) fn march(
        &mut self,
        batch: Batch<'_>,
        weight: usize,
        runs: &mut Runs,
    ) -> Result<(), FieldError> {
        let (leaves, values) = (batch.leaves, batch.values);
        for (leaf, values) in leaves.iter().zip(values.chunks_exact(COUNT)) {
            let span = leaf.layer..leaf.layer + batch.span;
            for k in runs.firsts(span.clone()) {
                runs.at(k).visited(leaf);
            }
            let nan = values.iter().filter(|f| f.is_nan()).count();
            self.nan[span].iter_mut().for_each(|sum| *sum += nan);
        }
        let above = runs_above(&batch, runs);
        let mut samples = std::mem::take(&mut self.samples);
        let eyes = &mut self.eyes(batch.sampler, &mut samples);
        self.noise.look(leaves, values, weight, eyes)?;
        self.vertices(leaves, values, eyes)?;
        for n in self.too_steep() {
            self.noise.look_into(n, &leaves[n], true, eyes)?;
        }
        let (chords, traced) = self.trace(eyes)?;
        let few = self.lattice.spacing <= self.precision.smallest;
        let (mut divide, in_doubt) = doubts(leaves, values, few, eyes)?;
        divide.extend(self.unexplained(leaves, &chords, &traced));
        for n in in_doubt {
            self.noise.look_into(n, &leaves[n], true, eyes)?;
        }
        let divided = self.divide(divide, true, leaves, eyes)?;
        self.samples = samples;
        for up in above {
            self.append(runs, up, &chords, &traced, &divided);
            self.leave(leaves, runs, up);
        }
        Ok(())
    }

    /// The means to look at points of a batch, with memory of its own.
    fn eyes<'e>(
        &self,
        sampler: &'e mut dyn Sampler,
        samples: &'e mut Samples,
    ) -> Eyes<'e>
    where
        'a: 'e,
    {
        Eyes {
            z: self.z,
            lattice: self.lattice,
            sampler,
            samples,
        }
    }

    /// Divides given cells of a batch's leaves. Their outline has been taken
    /// out of the chains.
    pub(super) fn redivide(
        &mut self,
        batch: Batch<'_>,
        cells: &[Place],
        runs: &mut Runs,
    ) -> Result<(), FieldError> {
        let leaves = batch.leaves;
        self.noise.begin(leaves, 1);
        let mut samples = std::mem::take(&mut self.samples);
        let eyes = &mut self.eyes(batch.sampler, &mut samples);
        self.vertices(leaves, batch.values, eyes)?;
        self.segments.clear();
        self.bends.clear();
        let divided = self.divide(cells.to_vec(), false, leaves, eyes)?;
        self.samples = samples;
        self.vertices.clear();
        self.append(runs, 0, &[], &[], &divided);
        self.leave(leaves, runs, 0);
        Ok(())
    }

    /// Tells the runs that begin `up` layers above the leaves which of these are
    /// too fine to be looked into any further.
    fn leave(&self, leaves: &[Leaf], runs: &mut Runs, up: usize) {
        for (n, leaf) in leaves.iter().enumerate() {
            if self.noise.is_in(n) {
                runs.at(leaf.layer + up).leave(leaf);
            }
        }
    }

    /// Judges the whole slab, once all of it has been looked at.
    ///
    /// # Errors
    /// If too much of the slab is too fine.
    pub(super) fn finish(&self) -> Result<(), FieldError> {
        self.noise.finish()
    }

    /// Finds the batch's vertices and how they are connected.
    fn vertices(
        &mut self,
        leaves: &[Leaf],
        values: &[f32],
        eyes: &mut Eyes<'_>,
    ) -> Result<(), FieldError> {
        self.edges.find(leaves, values, self.lattice);
        self.decide_saddles(leaves, eyes)?;
        self.find_segments(leaves);
        let edges = &self.edges.all;
        let mut brackets: Vec<Bracket> =
            edges.iter().map(|edge| edge.bracket(self.z)).collect();
        let ends = refine(&mut brackets, eyes)?;
        self.vertices.clear();
        self.vertices
            .extend(ends.into_iter().zip(edges).map(|(end, edge)| Vertex {
                end,
                crossing: Crossing::whole(edge.number),
            }));
        Ok(())
    }

    /// The leaves in which the field is much steeper on the outline than from
    /// node to node, in many places. There it may wave between the nodes.
    fn too_steep(&self) -> Vec<usize> {
        let is_steep = |v: u32| {
            let edge = &self.edges.all[v as usize];
            let way = edge.outside - edge.inside;
            let rise = self.vertices[v as usize].end.gradient.dot(way);
            rise > STEEP * f64::from(edge.field[1] - edge.field[0])
        };
        let of_leaf = self.segments.chunk_by(|a, b| a.leaf == b.leaf);
        let steep = of_leaf.filter(|segments| {
            let steep = segments.iter().filter(|s| is_steep(s.from));
            steep.count() >= STEEP_PLACES
        });
        steep.map(|segments| segments[0].leaf).collect()
    }

    /// Follows the outline where a segment is not within tolerance of it.
    /// Returns the numbers of these segments, and the outcome for each.
    fn trace(
        &mut self,
        eyes: &mut Eyes<'_>,
    ) -> Result<(Vec<usize>, Vec<Traced>), FieldError> {
        let Fineness {
            tolerance, trusted, ..
        } = self.precision.fineness(self.lattice.spacing);
        let (mut numbers, mut chords) = (Vec::new(), Vec::new());
        self.bends.clear();
        for (n, s) in self.segments.iter().enumerate() {
            if self.noise.is_in(s.leaf) {
                continue;
            }
            let [from, to] =
                [s.from, s.to].map(|v| self.vertices[v as usize].end);
            match look(from, to, tolerance, trusted) {
                Look::Straight => continue,
                Look::Bent(point) if !s.saddle => {
                    self.bends.push((n, point));
                    continue;
                }
                _ => {}
            }
            let [i, j] = s.cell;
            numbers.push(n);
            chords.push(Chord {
                from,
                to,
                cell: self.lattice.cell(i, j),
                // The division of the cell will find the corner.
                beyond: 0.0,
                z: self.z[s.layer],
            });
        }
        let traced = trace(&chords, tolerance, trusted, eyes)?;
        Ok((numbers, traced))
    }

    /// Cells whose outline could not be followed, or might cross itself.
    fn unexplained(
        &self,
        leaves: &[Leaf],
        chords: &[usize],
        traced: &[Traced],
    ) -> Vec<Place> {
        let mut found: Vec<Place> = Vec::new();
        // Cells beside the owner of a corner in which the corner lies, each
        // with the owner.
        let mut guests: Vec<([i64; 3], Place)> = Vec::new();
        for (&n, t) in chords.iter().zip(traced) {
            let s = &self.segments[n];
            let leaf = &leaves[s.leaf];
            let own = (s.leaf, [s.cell[0] - leaf.i, s.cell[1] - leaf.j]);
            if t.lost || (s.saddle && !t.points.is_empty()) {
                found.push(own);
            } else if let Some(by) = t.beside {
                let [i, j] =
                    [0, 1].map(|d| s.cell[d] as i64 + i64::from(by[d]));
                guests.push(([s.layer as i64, i, j], own));
            }
        }
        guests.sort_unstable();
        for pair in guests.windows(2).filter(|p| p[0].0 == p[1].0) {
            found.extend([pair[0].1, pair[1].1]);
        }
        found
    }

    /// Divides cells, given by leaf and place in the leaf. With `spread` it
    /// also divides the cells beside them where the outline passes between the
    /// two.
    fn divide(
        &mut self,
        mut wanted: Vec<Place>,
        spread: bool,
        leaves: &[Leaf],
        eyes: &mut Eyes<'_>,
    ) -> Result<Vec<(Vec<Cell>, Divided)>, FieldError> {
        let fineness = self.precision.fineness(self.lattice.spacing);
        let mut done: Vec<Place> = Vec::new();
        let mut rounds = Vec::new();
        loop {
            wanted.sort_unstable();
            wanted.dedup();
            wanted.retain(|c| done.binary_search(c).is_err());
            self.noise.dividing(leaves, &wanted, eyes)?;
            // Cells of leaves that are too fine keep their outline. Without
            // `spread` it has been taken out already, so they are divided.
            wanted.retain(|&(leaf, _)| !(spread && self.noise.is_in(leaf)));
            if wanted.is_empty() {
                return Ok(rounds);
            }
            let mut next = Vec::new();
            let at_once = AT_ONCE / (fineness.parts * fineness.parts);
            for wanted in wanted.chunks(at_once.max(1)) {
                let cells = wanted.iter().map(|&c| self.cell(leaves, c));
                let cells: Vec<Cell> = cells.collect();
                let divided = divide(&cells, fineness, eyes)?;
                let places = wanted.iter().zip(&cells);
                for ((place, cell), width) in places.zip(&divided.widths) {
                    if let Some(width) = *width
                        && !self.noise.is_in(place.0)
                    {
                        let z = self.z[cell.layer];
                        self.noise.divided(cell.at, z, width, self.lattice)?;
                    }
                }
                if spread {
                    for (cell, wrong) in cells.iter().zip(&divided.wrong) {
                        let [i, j] = cell.at.map(|k| k as i64);
                        let beside =
                            [[i, j - 1], [i + 1, j], [i, j + 1], [i - 1, j]];
                        let wrong = beside.iter().zip(wrong).filter(|x| *x.1);
                        next.extend(wrong.filter_map(|(at, _)| {
                            find(leaves, cell.layer, *at)
                        }));
                    }
                }
                rounds.push((cells, divided));
            }
            done.append(&mut wanted);
            done.sort_unstable();
            wanted = next;
        }
    }

    /// A cell with what the lattice knows of it.
    fn cell(&self, leaves: &[Leaf], (n, [i, j]): Place) -> Cell {
        Cell {
            layer: leaves[n].layer,
            at: [leaves[n].i + i, leaves[n].j + j],
            vertices: self.edges.of_cell(n, i, j).map(|edge| match edge {
                NONE => None,
                v => Some(self.vertices[v as usize]),
            }),
        }
    }

    /// Asks the field at the centres of ambiguous cells.
    fn decide_saddles(
        &mut self,
        leaves: &[Leaf],
        eyes: &mut Eyes<'_>,
    ) -> Result<(), FieldError> {
        self.saddles.clear();
        eyes.clear();
        for (n, leaf) in leaves.iter().enumerate() {
            for j in 0..LEAF {
                let [low, high] = self.edges.row(n, j);
                // Opposite corners are on one side; neighbouring corners are
                // not.
                let mask = (low ^ (low >> 1))
                    & (high ^ (high >> 1))
                    & (low ^ high)
                    & 0xff;
                for i in bits(mask) {
                    self.saddles.push((n, j * LEAF + i, false));
                    let cell = self.lattice.cell(leaf.i + i, leaf.j + j);
                    eyes.push(cell.centre(), self.z[leaf.layer]);
                }
            }
        }
        for (saddle, &f) in self.saddles.iter_mut().zip(eyes.values()?) {
            saddle.2 = f < 0.0;
        }
        Ok(())
    }

    /// Connects the vertices across the cells.
    fn find_segments(&mut self, leaves: &[Leaf]) {
        self.segments.clear();
        let mut saddles = self.saddles.iter().peekable();
        for (n, leaf) in leaves.iter().enumerate() {
            for j in 0..LEAF {
                let [low, high] = self.edges.row(n, j);
                let mixed =
                    ((low ^ (low >> 1)) | (high ^ (high >> 1)) | (low ^ high))
                        & 0xff;
                for i in bits(mixed) {
                    let case = usize::from(
                        (low >> i & 3)
                            | (high >> (i + 1) & 1) << 2
                            | (high >> i & 1) << 3,
                    );
                    let own = |s: &&(usize, usize, bool)| {
                        (s.0, s.1) == (n, j * LEAF + i)
                    };
                    let is_joined =
                        || saddles.next_if(own).is_some_and(|s| s.2);
                    let list = segments(case, is_joined);
                    let sides = self.edges.of_cell(n, i, j);
                    let slot = |side: u8| sides[usize::from(side)];
                    for &(from, to) in list {
                        self.segments.push(Segment {
                            layer: leaf.layer,
                            leaf: n,
                            cell: [leaf.i + i, leaf.j + j],
                            from: slot(from),
                            to: slot(to),
                            saddle: list.len() > 1,
                        });
                    }
                }
            }
        }
    }

    /// Adds vertices and segments to the runs that begin `up` layers above their
    /// own. `traced` are the results for the segments in `chords`. Divided cells
    /// bring their own pieces.
    fn append(
        &self,
        runs: &mut Runs,
        up: usize,
        chords: &[usize],
        traced: &[Traced],
        divided: &[(Vec<Cell>, Divided)],
    ) {
        let mut skip: Vec<Place> = Vec::new();
        for cell in divided.iter().flat_map(|d| &d.0) {
            skip.push((cell.layer, cell.at));
            runs.at(cell.layer + up).divided(cell.at);
        }
        skip.sort_unstable();
        // Number of each vertex in its layer, by its number in the batch.
        let own: Vec<u32> = self
            .vertices
            .iter()
            .zip(&self.edges.all)
            .map(|(v, edge)| {
                let chains = runs.at(edge.layer as usize + up);
                chains.add(v.end.point, v.crossing)
            })
            .collect();
        let mut traced = chords.iter().zip(traced).peekable();
        let mut bends = self.bends.iter().peekable();
        for (n, s) in self.segments.iter().enumerate() {
            let points = match traced.peek() {
                Some(t) if *t.0 == n => traced.next().map(|t| &t.1.points),
                _ => None,
            };
            let bend = match bends.peek() {
                Some(b) if b.0 == n => bends.next().map(|b| b.1),
                _ => None,
            };
            if !skip.is_empty()
                && skip.binary_search(&(s.layer, s.cell)).is_ok()
            {
                continue;
            }
            let (from, to) = (own[s.from as usize], own[s.to as usize]);
            let chains = runs.at(s.layer + up);
            match (points, bend) {
                (None, None) => chains.connect(from, to),
                (points, bend) => {
                    let points = points.into_iter().flatten().map(|p| p.1);
                    chains.connect_through(from, points.chain(bend), to);
                }
            }
        }
        for (_, d) in divided {
            let mut own = vec![NONE; d.vertices.len()];
            for piece in &d.pieces {
                let chains = runs.at(piece.layer + up);
                for v in [piece.from, piece.to].map(|v| v as usize) {
                    if own[v] == NONE {
                        let Vertex { end, crossing } = d.vertices[v];
                        own[v] = chains.add(end.point, crossing);
                    }
                }
                let [from, to] =
                    [piece.from, piece.to].map(|v| own[v as usize]);
                let points = piece.points.iter().copied();
                chains.connect_through(from, points, to);
            }
        }
    }
}

/// How far above a batch's layers the runs begin for which its leaves stand.
fn runs_above(batch: &Batch<'_>, runs: &Runs) -> Vec<usize> {
    match batch.leaves {
        [leaf, ..] if batch.span > 1 => {
            let firsts = runs.firsts(leaf.layer..leaf.layer + batch.span);
            firsts.into_iter().map(|k| k - leaf.layer).collect()
        }
        _ => vec![0],
    }
}

/// The leaf of a batch in which a cell lies, and the cell's place there.
fn find(leaves: &[Leaf], layer: usize, [i, j]: [i64; 2]) -> Option<Place> {
    leaves.iter().enumerate().find_map(|(n, leaf)| {
        let (a, b) = (i - leaf.i as i64, j - leaf.j as i64);
        let within = |k: i64| (0..LEAF as i64).contains(&k);
        (leaf.layer == layer && within(a) && within(b))
            .then_some((n, [a as usize, b as usize]))
    })
}
