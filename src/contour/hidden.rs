//! Finds the cells that hide what their nodes do not show, by proof.
//!
//! ```text
//!   •───────•───────•     Interval arithmetic bounds the field's values and
//!   │       │  ○    │     slopes over a leaf, and over its cells. A cell hides
//!   │       │       │     nothing where the field cannot be zero, or where it
//!   •───────•───────•     rises in one direction, so that the outline is a
//!   │ ╲     │       │     single line. What is left is looked into: parts
//!   │   ╲   │       │     with a value that cannot be zero are ruled out, and
//!   •─────╲─•───────•     the others divided until a sample in each says more.
//! ```
//!
//! So a feature is found if it holds a disc as wide as the smallest one asked
//! for: there is a sample in it. The same cells are where the outline may bend
//! between two points at which its gradients agree.
//!
//! Not for lattices finer than the smallest feature: there a disc 1.4 times as
//! wide as a cell holds a node, and the proofs would cost more than the samples.

use super::march::{Place, Scratch, bits};
use crate::field::{Bound, FieldError, LEAF, Lattice, Leaf, NODES, Sampler};
use crate::plane::Rect;
use crate::units::Mm;
use glam::DVec2;

/// Distance of the samples in a box that is not ruled out, as a share of the
/// smallest feature: a disc as wide as that holds one of them.
const PITCH: f64 = 0.7;

/// What the search needs.
struct Search<'a> {
    leaves: &'a [Leaf],
    /// By leaf, its nodes' values.
    values: &'a [[f32; NODES * NODES]],
    z: &'a [f32],
    lattice: &'a Lattice,
    sampler: &'a mut dyn Sampler,
    scratch: &'a mut Scratch,
}

/// Nodes of a row, a bit for each.
#[derive(Clone, Copy, Default)]
struct Row {
    inside: u16,
    /// Those whose values are so small that the field may be zero near them.
    near: u16,
}

impl Row {
    fn new(values: &[f32; NODES], safe: f32) -> Row {
        let mut row = Row::default();
        for (i, &f) in values.iter().enumerate() {
            let far = f.abs() > safe;
            row.inside |= u16::from(f < 0.0) << i;
            row.near |= u16::from(!far) << i;
        }
        row
    }

    /// Of the cells between this row and the one above, those with corners of
    /// one sign, those with both, and those that a near node is a corner of.
    fn cells(self, above: Row) -> (u16, u16, u16) {
        const CELLS: u16 = (1 << LEAF) - 1;
        let (a, b) = (self.inside, above.inside);
        let other = ((a ^ (a >> 1)) | (b ^ (b >> 1)) | (a ^ b)) & CELLS;
        let near = self.near | above.near;
        (!other & CELLS, other, (near | near >> 1) & CELLS)
    }
}

/// True if a box of these bounds hides nothing.
fn is_clear(bound: &Bound) -> bool {
    bound.is_uniform() || bound.is_simple()
}

/// A part of a cell in which the field may be zero.
struct Part {
    owner: Place,
    inside: bool,
    area: Rect,
}

/// The cells of a batch that hide something, or may do.
pub(super) fn hidden(
    leaves: &[Leaf],
    values: &[f32],
    z: &[f32],
    lattice: &Lattice,
    smallest: Mm,
    sampler: &mut dyn Sampler,
    scratch: &mut Scratch,
) -> Result<Vec<Place>, FieldError> {
    if lattice.spacing <= smallest {
        return Ok(Vec::new());
    }
    let (values, _) = values.as_chunks();
    let mut search = Search {
        leaves,
        values,
        z,
        lattice,
        sampler,
        scratch,
    };
    let (open, mixed) = search.unproven();
    let (open, mixed) = (search.unclear(open), search.unclear(mixed));
    let mut found = search.explore(open, PITCH * smallest)?;
    found.extend(mixed);
    found.sort_unstable();
    found.dedup();
    Ok(found)
}

impl Search<'_> {
    /// Values at the corners of a cell.
    fn corners(&self, (n, [i, j]): Place) -> [f32; 4] {
        let at = j * NODES + i;
        [at, at + 1, at + NODES, at + NODES + 1].map(|k| self.values[n][k])
    }

    fn area(&self, (n, [i, j]): Place) -> Rect {
        let (i, j) = (self.leaves[n].i + i, self.leaves[n].j + j);
        let node = |i: usize, j: usize| {
            let (x, y) = (self.lattice.x[i], self.lattice.y[j]);
            DVec2::new(f64::from(x), f64::from(y))
        };
        Rect {
            min: node(i, j),
            max: node(i + 1, j + 1),
        }
    }

    fn height(&self, owner: Place) -> f32 {
        self.z[self.leaves[owner.0].layer]
    }

    /// Cells that the bounds of their leaf do not clear: those with corners
    /// of one sign, and the others.
    fn unproven(&mut self) -> (Vec<Place>, Vec<Place>) {
        let whole: Vec<(Rect, f32)> = (0..self.leaves.len())
            .map(|n| {
                let [first, last] =
                    [[0, 0], [LEAF - 1, LEAF - 1]].map(|k| self.area((n, k)));
                let (min, max) = (first.min, last.max);
                (Rect { min, max }, self.height((n, [0, 0])))
            })
            .collect();
        let mut bounds = Vec::new();
        self.sampler.bounds(&whole, &mut bounds);
        let (mut open, mut mixed) = (Vec::new(), Vec::new());
        for (n, bound) in bounds.iter().enumerate() {
            if is_clear(bound) {
                continue;
            }
            for (j, (near, other)) in
                self.near(n, bound).into_iter().enumerate()
            {
                open.extend(bits(near).map(|i| (n, [i, j])));
                mixed.extend(bits(other).map(|i| (n, [i, j])));
            }
        }
        (open, mixed)
    }

    /// By row of a leaf, the cells with corners of one sign and values so
    /// small that by a bound the field may have the other one, and the cells
    /// with corners of both signs.
    fn near(&self, n: usize, bound: &Bound) -> [(u16, u16); LEAF] {
        let half = 0.5 * self.lattice.spacing;
        // The nearest corner is at most half a cell away. What is not a
        // number is never safe.
        let safe = bound.change(half, half) as f32;
        let rows: &[[f32; NODES]] = self.values[n].as_chunks().0;
        let mut out = [(0, 0); LEAF];
        for (out, pair) in out.iter_mut().zip(rows.windows(2)) {
            let (low, high) =
                (Row::new(&pair[0], safe), Row::new(&pair[1], safe));
            let (same, other, near) = low.cells(high);
            *out = (same & near, other);
        }
        out
    }

    /// The owners of parts whose centre's sign is not that of the corners.
    fn other_sign(&mut self, parts: &[Part]) -> Result<Vec<Place>, FieldError> {
        if parts.is_empty() {
            return Ok(Vec::new());
        }
        self.scratch.clear();
        for p in parts {
            let centre = 0.5 * (p.area.min + p.area.max);
            self.scratch
                .push(centre, self.z[self.leaves[p.owner.0].layer]);
        }
        let s = &mut *self.scratch;
        self.sampler.values(&s.x, &s.y, &s.z, &mut s.values)?;
        let other = parts
            .iter()
            .zip(&s.values)
            .filter(|(p, f)| (**f < 0.0) != p.inside);
        Ok(other.map(|(p, _)| p.owner).collect())
    }

    /// Of some cells, those that their own bounds do not clear.
    fn unclear(&mut self, cells: Vec<Place>) -> Vec<Place> {
        let bounds = self.bounds(&cells);
        let pairs = cells.into_iter().zip(&bounds);
        pairs.filter(|p| !is_clear(p.1)).map(|p| p.0).collect()
    }

    fn bounds(&mut self, cells: &[Place]) -> Vec<Bound> {
        let boxes: Vec<(Rect, f32)> = cells
            .iter()
            .map(|&c| (self.area(c), self.height(c)))
            .collect();
        let mut bounds = Vec::new();
        self.sampler.bounds(&boxes, &mut bounds);
        bounds
    }

    /// Divides cells with corners of one sign into quarters, and these again,
    /// where the field may be zero, until they are no larger than `pitch`.
    /// Returns the cells in which a quarter's centre has the other sign.
    fn explore(
        &mut self,
        cells: Vec<Place>,
        pitch: Mm,
    ) -> Result<Vec<Place>, FieldError> {
        let mut found: Vec<Place> = Vec::new();
        let mut parts: Vec<Part> = cells
            .into_iter()
            .map(|owner| Part {
                owner,
                inside: self.corners(owner)[0] < 0.0,
                area: self.area(owner),
            })
            .collect();
        let mut size = self.lattice.spacing;
        while !parts.is_empty() {
            let mut other = self.other_sign(&parts)?;
            other.sort_unstable();
            other.dedup();
            parts.retain(|p| other.binary_search(&p.owner).is_err());
            found.append(&mut other);
            if size <= pitch {
                break;
            }
            size *= 0.5;
            parts = parts.iter().flat_map(quarters).collect();
            let boxes: Vec<(Rect, f32)> = parts
                .iter()
                .map(|p| (p.area, self.height(p.owner)))
                .collect();
            let mut bounds = Vec::new();
            self.sampler.bounds(&boxes, &mut bounds);
            let mut kept = bounds.iter().map(|b| !b.is_uniform());
            parts.retain(|_| kept.next() == Some(true));
        }
        Ok(found)
    }
}

fn quarters(part: &Part) -> [Part; 4] {
    let Rect { min, max } = part.area;
    let middle = 0.5 * (min + max);
    [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(i, j)| {
        let side = |k: usize, far: i32| match far {
            0 => [min[k], middle[k]],
            _ => [middle[k], max[k]],
        };
        let (x, y) = (side(0, i), side(1, j));
        Part {
            owner: part.owner,
            inside: part.inside,
            area: Rect {
                min: DVec2::new(x[0], y[0]),
                max: DVec2::new(x[1], y[1]),
            },
        }
    })
}
