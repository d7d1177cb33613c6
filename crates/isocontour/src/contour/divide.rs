//! Samples cells anew on a lattice of their own, several times finer.
//!
//! ```text
//!   ┌───────────┬───────────┐   A cell whose outline the lattice does not
//!   │           │ · · · · · │   explain is divided, and the outline is found
//!   │           │ · · · · · │   among its smaller cells. Where its side is
//!   │           │ · ·/\ · · │   crossed as the lattice's edge said, the
//!   │      next ├───/  \────┤   crossing is the edge's, and the next cell is
//!   │           │  /· · \ · │   not concerned. Otherwise the next cell is
//!   └───────────┴─/──────\──┘   divided, too.
//! ```
//!
//! Both cells at a side see the same nodes on it. So both come to one
//! conclusion, whichever cell is divided first, and also if only one is
//! divided.

use super::link::Crossing;
use super::refine::{Bracket, End, refine};
use super::samples::Eyes;
use super::trace::{Chord, Look, Vertex, line, lines_cross, look, trace};
use crate::Length;
use crate::cells::segments;
use crate::field::{FieldError, Lattice};
use crate::plane::Rect;
use glam::DVec2;
use std::f64::consts::FRAC_PI_2;

/// A cell to be divided.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cell {
    pub layer: usize,
    /// Column and row of the cell in the lattice.
    pub at: [usize; 2],
    /// The vertices on the lattice edges around the cell: south, east, north,
    /// west.
    pub vertices: [Option<Vertex>; 4],
}

/// A piece of the outline in a divided cell.
pub(super) struct OutlinePiece {
    pub layer: usize,
    /// Vertices, counted within the batch of cells.
    pub from: u32,
    pub to: u32,
    /// Points between the two vertices.
    pub points: Vec<DVec2>,
}

/// The outline in some divided cells.
#[derive(Default)]
pub(super) struct Divided {
    pub vertices: Vec<Vertex>,
    pub pieces: Vec<OutlinePiece>,
    /// For each cell, the sides on which the lattice's edge was wrong: south,
    /// east, north, west.
    pub wrong: Vec<[bool; 4]>,
    /// For each cell, how wide its inside and its outside are on average, if
    /// they are too fine for the outline to be followed.
    pub widths: Vec<Option<Length>>,
}

/// How a cell is divided and its outline followed.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fineness {
    /// Number of parts along a cell's side.
    pub parts: usize,
    pub tolerance: Length,
    pub trusted: Length,
    /// Size of the smallest feature that has to be found.
    pub smallest: Length,
}

/// The field is too fine where a line has this many sign changes within the
/// length of the smallest feature: three whole pieces lie between them.
const DENSE: usize = 4;
/// Share of its lines from which on a cell is too fine.
const DENSE_LINES: f64 = 1.0 / 6.0;

/// A divided cell is too fine if the gradients at the ends contradict at least
/// this many of its pieces, and at least half of them: more of the outline is
/// hidden between the nodes.
const AGAINST: usize = 8;

/// The field on a divided cell.
struct Patch {
    x: Vec<f32>,
    y: Vec<f32>,
    /// The values at the nodes, row by row.
    values: Vec<f32>,
    /// Numbers of vertices by edge: first the edges along x, then those along
    /// y.
    slots: Vec<u32>,
}

impl Patch {
    fn node(&self, a: usize, b: usize) -> usize {
        b * self.x.len() + a
    }

    fn is_inside(&self, node: usize) -> bool {
        self.values[node] < 0.0
    }

    /// True if an edge has a sign change.
    fn changes(&self, a: usize, b: usize, dir: usize) -> bool {
        let next = self.node(a + 1 - dir, b + dir);
        self.is_inside(self.node(a, b)) != self.is_inside(next)
    }

    fn point(&self, a: usize, b: usize) -> DVec2 {
        DVec2::new(f64::from(self.x[a]), f64::from(self.y[b]))
    }

    fn cell(&self, a: usize, b: usize) -> Rect {
        Rect::new(self.point(a, b), self.point(a + 1, b + 1))
    }

    /// Which corners of a part are inside, as a bit each, counter-clockwise from
    /// the lower left one.
    fn case(&self, a: usize, b: usize) -> usize {
        let bit = |a, b| usize::from(self.is_inside(self.node(a, b)));
        bit(a, b)
            | bit(a + 1, b) << 1
            | bit(a + 1, b + 1) << 2
            | bit(a, b + 1) << 3
    }

    /// The vertex on an edge of a part; the edges are the lower one, the right
    /// one, the upper one and the left one.
    fn vertex(&self, a: usize, b: usize, edge: u8) -> u32 {
        self.slots[match edge {
            0 => self.slot(a, b, 0),
            1 => self.slot(a + 1, b, 1),
            2 => self.slot(a, b + 1, 0),
            _ => self.slot(a, b, 1),
        }]
    }

    /// Distance of the patch's nodes.
    fn step(&self) -> Length {
        let last = self.x.len() - 1;
        (f64::from(self.x[last]) - f64::from(self.x[0])) / last as f64
    }

    /// How wide the inside and the outside are on average, worked out as in
    /// `noise`, if that is too fine: a third of the smallest feature all over
    /// or in some places, or less than the smallest feature where every fourth
    /// edge has a sign change.
    fn too_fine(&self, smallest: Length) -> Option<Length> {
        let n = self.x.len();
        let step = self.step();
        // This many edges in a row are as long as the smallest feature.
        let span = ((smallest / step) as usize).max(DENSE);
        let (mut changes, mut dense) = (0, 0);
        let mut line = |at: &dyn Fn(usize) -> usize| {
            let mut places = [0; DENSE];
            let (mut count, mut found) = (0, false);
            for k in 1..n {
                if self.is_inside(at(k - 1)) != self.is_inside(at(k)) {
                    places[count % DENSE] = k;
                    count += 1;
                    // The next change overwrites the oldest of the last few.
                    found |= count >= DENSE && k - places[count % DENSE] < span;
                }
            }
            changes += count;
            dense += usize::from(found);
        };
        for m in 0..n {
            line(&|k| self.node(k, m));
            line(&|k| self.node(m, k));
        }
        let density = FRAC_PI_2 * changes as f64
            / (2.0 * n as f64 * step * (n as f64 - 1.0));
        let width = 1.0 / density;
        let most = if 2 * changes > n * (n - 1) {
            smallest
        } else {
            smallest / 3.0
        };
        let dense = dense as f64 >= DENSE_LINES * 2.0 * n as f64;
        (width < most || (dense && smallest > 0.0)).then_some(width)
    }

    fn slot(&self, a: usize, b: usize, dir: usize) -> usize {
        let n = self.x.len() - 1;
        match dir {
            0 => b * n + a,
            _ => n * (n + 1) + b * (n + 1) + a,
        }
    }
}

/// The nodes of a cell's axis, of which the ends are the lattice's.
fn nodes(axis: &[f32], from: usize, parts: usize) -> Vec<f32> {
    let (lo, hi) = (f64::from(axis[from]), f64::from(axis[from + 1]));
    (0..=parts)
        .map(|k| (lo + (hi - lo) * (k as f64 / parts as f64)) as f32)
        .collect()
}

/// Finds the outline in cells by sampling them more finely.
pub(super) fn divide(
    cells: &[Cell],
    fineness: Fineness,
    eyes: &mut Eyes<'_>,
) -> Result<Divided, FieldError> {
    let mut out = Divided::default();
    if cells.is_empty() {
        return Ok(out);
    }
    let mut patches = sample(cells, fineness.parts, eyes)?;
    let widths = patches.iter().map(|p| p.too_fine(fineness.smallest));
    out.widths = widths.collect();
    find_vertices(cells, &mut patches, &mut out, eyes)?;
    connect(cells, &patches, fineness, &mut out, eyes)?;
    Ok(out)
}

fn sample(
    cells: &[Cell],
    parts: usize,
    eyes: &mut Eyes<'_>,
) -> Result<Vec<Patch>, FieldError> {
    eyes.clear();
    let mut patches = Vec::with_capacity(cells.len());
    for cell in cells {
        let patch = Patch {
            x: nodes(&eyes.lattice.x, cell.at[0], parts),
            y: nodes(&eyes.lattice.y, cell.at[1], parts),
            values: Vec::new(),
            slots: vec![u32::MAX; 2 * parts * (parts + 1)],
        };
        for (a, b) in places(parts + 1) {
            eyes.push(patch.point(a, b), eyes.z[cell.layer]);
        }
        patches.push(patch);
    }
    let values = eyes.values()?.chunks_exact((parts + 1) * (parts + 1));
    for (patch, values) in patches.iter_mut().zip(values) {
        patch.values = values.to_vec();
    }
    Ok(patches)
}

/// A side of a cell: its lattice edge, and the edges of its parts as (a, b,
/// direction).
fn side(
    cell: &Cell,
    which: usize,
    lattice: &Lattice,
    parts: usize,
) -> (u32, impl Iterator<Item = (usize, usize, usize)>) {
    let [i, j] = cell.at;
    let width = lattice.width() + 1;
    let dir = which % 2;
    let (far_i, far_j) = (usize::from(which == 1), usize::from(which == 2));
    let node = (j + far_j) * width + i + far_i;
    let edges = (0..parts).map(move |k| match dir {
        0 => (k, far_j * parts, 0),
        _ => (far_i * parts, k, 1),
    });
    ((2 * node + dir) as u32, edges)
}

/// Finds vertices on all edges of the patches with a sign change.
fn find_vertices(
    cells: &[Cell],
    patches: &mut [Patch],
    out: &mut Divided,
    eyes: &mut Eyes<'_>,
) -> Result<(), FieldError> {
    let mut brackets = Vec::new();
    let mut numbers = Vec::new();
    for (cell, patch) in cells.iter().zip(patches) {
        let parts = patch.x.len() - 1;
        // Crossings of the sides come first, since they have names.
        let mut names = vec![Crossing::NONE; patch.slots.len()];
        let mut wrong = [false; 4];
        let mut known = Vec::new();
        for (which, wrong) in wrong.iter_mut().enumerate() {
            let (edge, edges) = side(cell, which, eyes.lattice, parts);
            let own: Vec<_> = edges
                .filter(|&(a, b, dir)| patch.changes(a, b, dir))
                .collect();
            let vertex = cell.vertices[which];
            if let (&[(a, b, dir)], Some(v)) = (&own[..], vertex)
                && between(v.end.point, patch, a, b, dir)
            {
                known.push((patch.slot(a, b, dir), v));
                continue;
            }
            *wrong = !own.is_empty() || vertex.is_some();
            for (a, b, dir) in own {
                let part = [a, b][dir] as u32;
                names[patch.slot(a, b, dir)] = Crossing { edge, part };
            }
        }
        out.wrong.push(wrong);
        let mut slots = std::mem::take(&mut patch.slots);
        for (slot, v) in known {
            slots[slot] = out.vertices.len() as u32;
            out.vertices.push(v);
        }
        for dir in [0, 1] {
            for b in 0..=parts - dir {
                for a in 0..parts + dir {
                    let slot = patch.slot(a, b, dir);
                    if !patch.changes(a, b, dir) || slots[slot] != u32::MAX {
                        continue;
                    }
                    slots[slot] = out.vertices.len() as u32;
                    numbers.push(out.vertices.len());
                    out.vertices.push(Vertex {
                        end: End::default(),
                        crossing: names[slot],
                    });
                    let ends = [(a, b), (a + 1 - dir, b + dir)];
                    brackets.push(Bracket::new(
                        ends.map(|(a, b)| patch.point(a, b)),
                        ends.map(|(a, b)| patch.values[patch.node(a, b)]),
                        eyes.z[cell.layer],
                    ));
                }
            }
        }
        patch.slots = slots;
    }
    for (n, end) in numbers.into_iter().zip(refine(&mut brackets, eyes)?) {
        out.vertices[n].end = end;
    }
    Ok(())
}

/// True if the gradient at an end of a piece of outline contradicts the nodes,
/// because it rises to the side on which the nodes are inside.
fn is_against(from: End, to: End) -> bool {
    let out = -(to.point - from.point).perp();
    [from, to].iter().any(|end| end.gradient.dot(out) < 0.0)
}

/// True if a vertex lies on an edge of a patch.
fn between(p: DVec2, patch: &Patch, a: usize, b: usize, dir: usize) -> bool {
    let (lo, hi) = (patch.point(a, b), patch.point(a + 1 - dir, b + dir));
    (lo[dir]..=hi[dir]).contains(&p[dir])
}

/// Connects the vertices across the parts of the cells.
fn connect(
    cells: &[Cell],
    patches: &[Patch],
    fineness: Fineness,
    out: &mut Divided,
    eyes: &mut Eyes<'_>,
) -> Result<(), FieldError> {
    let parts = fineness.parts;
    let mut joined = joined_saddles(cells, patches, parts, eyes)?.into_iter();
    let mut chords = Chords::default();
    for (n, (cell, p)) in cells.iter().zip(patches).enumerate() {
        let in_vain = out.widths[n].is_some();
        let first = chords.all.len();
        let (mut count, mut against) = (0, 0);
        for (a, b) in places(parts) {
            let list = segments(p.case(a, b), || joined.next() == Some(true));
            for (n, &edges) in list.iter().enumerate() {
                let [from, to] =
                    <[u8; 2]>::from(edges).map(|edge| p.vertex(a, b, edge));
                let ends = [from, to].map(|v| out.vertices[v as usize].end);
                count += 1;
                against += usize::from(is_against(ends[0], ends[1]));
                let (near, far) = (fineness.tolerance, fineness.trusted);
                // Both pieces of a saddle are followed, so that they can be
                // compared.
                let is_followed = list.len() > 1
                    || !matches!(
                        look(ends[0], ends[1], near, far),
                        Look::Straight
                    );
                if !in_vain && is_followed {
                    chords.owners.push((out.pieces.len(), n > 0));
                    chords.all.push(Chord {
                        from: ends[0],
                        to: ends[1],
                        cell: p.cell(a, b),
                        // The tip of a corner may reach far between the nodes,
                        // up to a whole cell of the lattice.
                        beyond: parts as f64,
                        z: eyes.z[cell.layer],
                    });
                }
                out.pieces.push(OutlinePiece {
                    layer: cell.layer,
                    from,
                    to,
                    points: Vec::new(),
                });
            }
        }
        if !in_vain && against >= AGAINST && 2 * against >= count {
            out.widths[n] = Some(p.step());
            chords.truncate(first);
        }
    }
    chords.follow(fineness, out, eyes)
}

/// The parts of a cell that has `parts` along each side.
fn places(parts: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..parts * parts).map(move |k| (k % parts, k / parts))
}

/// For each saddle among the parts of the cells whether its middle is inside,
/// which joins the insides of its two corners.
fn joined_saddles(
    cells: &[Cell],
    patches: &[Patch],
    parts: usize,
    eyes: &mut Eyes<'_>,
) -> Result<Vec<bool>, FieldError> {
    eyes.clear();
    for (cell, p) in cells.iter().zip(patches) {
        let is_saddle =
            |&(a, b): &(usize, usize)| matches!(p.case(a, b), 5 | 10);
        for (a, b) in places(parts).filter(is_saddle) {
            eyes.push(p.cell(a, b).centre(), eyes.z[cell.layer]);
        }
    }
    Ok(eyes.values()?.iter().map(|&f| f < 0.0).collect())
}

/// Chords of pieces that have to be followed.
#[derive(Default)]
struct Chords {
    all: Vec<Chord>,
    /// For each chord its piece, and whether the chord before it is in the same
    /// cell.
    owners: Vec<(usize, bool)>,
}

impl Chords {
    fn truncate(&mut self, count: usize) {
        self.all.truncate(count);
        self.owners.truncate(count);
    }

    /// Gives the pieces their points. Two in one cell that would cross get none.
    fn follow(
        self,
        fineness: Fineness,
        out: &mut Divided,
        eyes: &mut Eyes<'_>,
    ) -> Result<(), FieldError> {
        let Chords { all, owners } = self;
        let (near, far) = (fineness.tolerance, fineness.trusted);
        let mut traced = trace(&all, near, far, eyes)?;
        for k in (1..all.len()).filter(|&k| owners[k].1) {
            let [one, other] = [k - 1, k]
                .map(|k| line(&all[k], &traced[k]).collect::<Vec<DVec2>>());
            if lines_cross(&one, &other) {
                traced[k - 1].points.clear();
                traced[k].points.clear();
            }
        }
        for ((piece, _), t) in owners.into_iter().zip(traced) {
            let points = t.points.into_iter().map(|p| p.1);
            out.pieces[piece].points = points.collect();
        }
        Ok(())
    }
}
