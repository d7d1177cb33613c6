//! Notices a field that changes its sign finer than anything can be printed.
//!
//! ```text
//!   ┌──────────┐   A leaf with many sign changes between its nodes is looked
//!   │┄┄┄┄┄┄┄┄┄┄│   at along lines across it, at points a quarter of the
//!   │          │   smallest feature apart. N changes over lines of length ℓ,
//!   │┄┄┄┄┄┄┄┄┄┄│   as many along x as along y, are an outline of about
//!   │          │   π N / (2 ℓ) mm per mm² (Crofton's formula), and what lies
//!   └──────────┘   between is on average as wide as the inverse of that.
//! ```
//!
//! Where that is less than the smallest feature, next to nothing of the field
//! is left in the print. Following its outline there would be hours of work for
//! what is dropped at the end: such a leaf is taken as its nodes say, and a slab
//! with more than some mm² of them is refused. So is one with too many cells
//! beside such leaves that were divided in vain.
//!
//! The verdict depends on the slab's layers and on nothing else. Not noticed:
//! waves that the lattice's nodes all miss, which are as cheap as none.

use super::samples::Samples;
use crate::field::{FieldError, LEAF, Lattice, Leaf, NODES, Sampler};
use crate::{Content, Length};
use glam::DVec2;

/// Sign changes between the 144 pairs of neighbouring nodes of a leaf below
/// which it is not looked at. A field without any order has 72, one that waves
/// along one axis alone 36, a single outline across the leaf 16.
const MANY: u32 = 20;
/// Lines across a leaf, each way.
const LINES: usize = 3;
/// Distance of the points along them, as a share of the smallest feature.
const PITCH: f64 = 0.25;
/// What is let pass in a slab's layers, together: where forty blades of a fan
/// meet there are 6 mm² in each. With much more than that, fields that wave
/// finely take minutes before they are refused.
const LET_PASS: Content = 200.0;
/// A divided cell counts as so many cells: it costs as much as a quarter of a
/// leaf.
const CELL: f64 = 16.0;

/// Counts what is too fine in a slab.
pub(super) struct Noise {
    smallest: Length,
    area: Content,
    /// Where it was first, and how wide what is there is on average.
    first: Option<([f64; 3], Length)>,
    /// By leaf of the batch, whether it is too fine.
    found: Vec<bool>,
}

/// Sign changes between neighbouring nodes.
fn changes(values: &[f32; NODES * NODES]) -> u32 {
    let mut count = 0;
    for row in values.as_chunks::<NODES>().0 {
        for i in 0..LEAF {
            count += u32::from((row[i] < 0.0) != (row[i + 1] < 0.0));
        }
    }
    for i in 0..NODES * LEAF {
        count += u32::from((values[i] < 0.0) != (values[i + NODES] < 0.0));
    }
    count
}

impl Noise {
    /// None seen so far; `smallest` is the size of what is left out.
    pub(super) fn new(smallest: Length) -> Self {
        Noise {
            smallest,
            area: 0.0,
            first: None,
            found: Vec::new(),
        }
    }

    /// Looks at a batch of leaves.
    ///
    /// # Errors
    /// If there is now more of it than is let pass.
    pub(super) fn look(
        &mut self,
        leaves: &[Leaf],
        values: &[f32],
        z: &[f32],
        lattice: &Lattice,
        sampler: &mut dyn Sampler,
        scratch: &mut Samples,
    ) -> Result<(), FieldError> {
        self.found.clear();
        let (values, _) = values.as_chunks();
        for (leaf, values) in leaves.iter().zip(values) {
            // Where nothing is too small, nothing is too fine.
            if self.smallest <= 0.0 || changes(values) < MANY {
                self.found.push(false);
                continue;
            }
            let z = z[leaf.layer];
            let width = self.width(leaf, z, lattice, sampler, scratch)?;
            self.found.push(width < self.smallest);
            if width < self.smallest {
                let (x, y) = (lattice.x[leaf.i + 4], lattice.y[leaf.j + 4]);
                let side = LEAF as f64 * lattice.spacing;
                self.add([x, y, z].map(f64::from), width, side * side)?;
            }
        }
        Ok(())
    }

    /// True if a leaf of the batch that was last looked at is too fine.
    pub(super) fn is_in(&self, leaf: usize) -> bool {
        self.found[leaf]
    }

    /// Notes that a cell was divided in which what is inside and what is
    /// outside turned out to be `width` wide on average.
    ///
    /// # Errors
    /// As [`Noise::look`].
    pub(super) fn divided(
        &mut self,
        at: [usize; 2],
        z: f32,
        width: Length,
        lattice: &Lattice,
    ) -> Result<(), FieldError> {
        let (x, y) = (lattice.x[at[0]], lattice.y[at[1]]);
        let area = CELL * lattice.spacing * lattice.spacing;
        self.add([x, y, z].map(f64::from), width, area)
    }

    fn add(
        &mut self,
        at: [f64; 3],
        width: Length,
        area: Content,
    ) -> Result<(), FieldError> {
        self.area += area;
        let (at, width) = *self.first.get_or_insert((at, width));
        match self.area > LET_PASS {
            true => Err(FieldError::TooFine {
                at,
                width,
                smallest: self.smallest,
            }),
            false => Ok(()),
        }
    }

    /// How wide what is inside and what is outside is in a leaf, on average.
    fn width(
        &self,
        leaf: &Leaf,
        z: f32,
        lattice: &Lattice,
        sampler: &mut dyn Sampler,
        scratch: &mut Samples,
    ) -> Result<Length, FieldError> {
        let node = |i: usize, j: usize| {
            let (x, y) = (lattice.x[leaf.i + i], lattice.y[leaf.j + j]);
            DVec2::new(f64::from(x), f64::from(y))
        };
        let (low, size) = (node(0, 0), node(LEAF, LEAF) - node(0, 0));
        let steps = (size.x / (PITCH * self.smallest)).ceil().max(1.0);
        let count = steps as usize + 1;
        scratch.clear();
        for along in [DVec2::X, DVec2::Y] {
            for line in 0..LINES {
                let across = (line as f64 + 0.5) / LINES as f64;
                for k in 0..count {
                    let part = along * (k as f64 / steps)
                        + (DVec2::ONE - along) * across;
                    scratch.push(low + part * size, z);
                }
            }
        }
        let s = scratch;
        sampler.values(&s.x, &s.y, &s.z, &mut s.values)?;
        let changed = |line: &[f32]| {
            let pairs = line.windows(2);
            pairs.filter(|p| (p[0] < 0.0) != (p[1] < 0.0)).count()
        };
        let changes: usize = s.values.chunks_exact(count).map(changed).sum();
        let length = LINES as f64 * (size.x + size.y);
        let density = std::f64::consts::FRAC_PI_2 * changes as f64 / length;
        Ok(1.0 / density)
    }
}
