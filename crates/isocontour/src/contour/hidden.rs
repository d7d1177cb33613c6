//! Proves which cells may hide what their nodes do not show.
//!
//! ```text
//!   •───────•───────•     Interval arithmetic bounds the field's values and
//!   │       │  ○    │     slopes over a leaf, and over its cells. A cell hides
//!   │       │       │     nothing where the field cannot be zero, or where it
//!   •───────•───────•     rises in one direction, so that the outline is a
//!   │ ╲     │       │     single line. All other cells are looked into: parts
//!   │   ╲   │       │     with a value that cannot be zero are ruled out, and
//!   •─────╲─•───────•     the others divided until a sample in each says more.
//! ```
//!
//! So a feature is found if it holds a disc as wide as the smallest feature,
//! because such a disc holds a sample.
//!
//! Lattices that are hardly coarser than the smallest feature are not searched
//! in this way, since the proofs would cost several times what the samples do,
//! and little is hidden. There it is only certain that a disc 1.4 times as wide
//! as a cell holds a node.

use super::samples::Samples;
use crate::Length;
use crate::cells::Place;
use crate::field::{Bound, FieldError, LEAF, Lattice, Leaf, NODES, Sampler};
use crate::plane::Rect;
use glam::DVec2;

/// Greatest width of a cell that is not looked into, as a multiple of the
/// smallest feature.
const FINE: f64 = 2.0;
/// Distance of the samples in a box that is not ruled out, as a share of the
/// smallest feature. A disc as wide as the feature holds one of them.
const PITCH: f64 = 0.7;

/// Size of a part of a cell, in distances of samples, below which it is sampled
/// all over. That is quicker than ruling some of it out.
const CHEAP: f64 = 8.0;

/// About how many parts of cells are looked into at once. Their bounds need
/// some hundred bytes for every input of the expression.
const AT_ONCE: f64 = 16384.0;

/// A batch that is searched, and how finely.
struct Search<'a> {
    leaves: &'a [Leaf],
    /// For each leaf, the values of its nodes.
    values: &'a [[f32; NODES * NODES]],
    z: &'a [f32],
    lattice: &'a Lattice,
    sampler: &'a mut dyn Sampler,
    scratch: &'a mut Samples,
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

/// The cells of a batch that hide something, or may do so.
pub(super) fn hidden(
    leaves: &[Leaf],
    values: &[f32],
    z: &[f32],
    lattice: &Lattice,
    smallest: Length,
    sampler: &mut dyn Sampler,
    scratch: &mut Samples,
) -> Result<Vec<Place>, FieldError> {
    if lattice.spacing <= FINE * smallest {
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
    // Cells with corners of both signs are divided; the other cells are looked
    // into first.
    let (open, mut found): (Vec<Place>, Vec<Place>) =
        search.unclear().into_iter().partition(|&cell| {
            let corners = search.corners(cell);
            let inside = corners.iter().filter(|f| **f < 0.0).count();
            matches!(inside, 0 | 4)
        });
    let pitch = PITCH * smallest;
    let parts = (lattice.spacing / pitch).max(1.0).powi(2);
    for open in open.chunks((AT_ONCE / parts).max(1.0) as usize) {
        found.extend(search.explore(open, pitch)?);
    }
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

    /// The square of `size` × `size` cells that begins at a cell.
    fn area(&self, (n, [i, j]): Place, size: usize) -> Rect {
        let (i, j) = (self.leaves[n].i + i, self.leaves[n].j + j);
        let node = |i: usize, j: usize| {
            let (x, y) = (self.lattice.x[i], self.lattice.y[j]);
            DVec2::new(f64::from(x), f64::from(y))
        };
        Rect::new(node(i, j), node(i + size, j + size))
    }

    fn height(&self, owner: Place) -> f32 {
        self.z[self.leaves[owner.0].layer]
    }

    /// The cells that are cleared neither by their own bounds nor by the bounds
    /// of a square of cells around them.
    fn unclear(&mut self) -> Vec<Place> {
        let mut squares: Vec<Place> =
            (0..self.leaves.len()).map(|n| (n, [0, 0])).collect();
        let mut size = LEAF;
        let mut bounds = Vec::new();
        loop {
            let boxes: Vec<(Rect, f32)> = squares
                .iter()
                .map(|&s| (self.area(s, size), self.height(s)))
                .collect();
            self.sampler.bounds(&boxes, &mut bounds);
            let mut kept = bounds.iter().map(|b| !is_clear(b));
            squares.retain(|_| kept.next() == Some(true));
            if size == 1 {
                return squares;
            }
            size /= 2;
            let of = |(n, [i, j]): Place| {
                [(0, 0), (size, 0), (0, size), (size, size)]
                    .map(|(a, b)| (n, [i + a, j + b]))
            };
            squares = squares.into_iter().flat_map(of).collect();
        }
    }

    /// The cells of parts whose centre has another sign than their corners.
    fn other_sign(&mut self, parts: &[Part]) -> Result<Vec<Place>, FieldError> {
        if parts.is_empty() {
            return Ok(Vec::new());
        }
        self.scratch.clear();
        for p in parts {
            let centre = p.area.centre();
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

    /// Divides cells with corners of one sign into quarters, and these again,
    /// where the field may be zero, until they are no larger than `pitch`.
    /// Returns the cells in which a quarter's centre has the other sign.
    fn explore(
        &mut self,
        cells: &[Place],
        pitch: Length,
    ) -> Result<Vec<Place>, FieldError> {
        let mut found: Vec<Place> = Vec::new();
        let mut parts: Vec<Part> = cells
            .iter()
            .map(|&owner| Part {
                owner,
                inside: self.corners(owner)[0] < 0.0,
                area: self.area(owner, 1),
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
            if size < CHEAP * pitch {
                continue;
            }
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
            area: Rect::new(DVec2::new(x[0], y[0]), DVec2::new(x[1], y[1])),
        }
    })
}
