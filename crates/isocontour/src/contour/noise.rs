//! Notices a field that changes its sign finer than the smallest feature that
//! is asked for.
//!
//! ```text
//!   ┌──────────┐   A leaf with many sign changes between its nodes is looked
//!   │┄┄┄┄┄┄┄┄┄┄│   at along lines across it, at points a quarter of the
//!   │          │   smallest feature apart. N changes over lines of length ℓ,
//!   │┄┄┄┄┄┄┄┄┄┄│   as many along x as along y, are an outline of about
//!   │          │   π N / (2 ℓ) mm per mm² (Crofton's formula). What lies
//!   └──────────┘   between is on average as wide as the inverse of that.
//! ```
//!
//! Where that width is less than the smallest feature, or where the inside (or
//! the outside) has no room for a disc of that size, hardly anything of the
//! field would be left in the outline. Following the outline there would be
//! hours of work on rings that are dropped at the end. So such a leaf is too
//! fine, and taken as its nodes show it. A leaf is also looked at if many of
//! its cells had to be divided, since waves nearly as long as the distance of
//! the nodes show in few of them.
//!
//! A slab is refused if the leaves that are too fine are more than some mm² and
//! 0.1 of the leaves that hold some of its surface, or very many. Cells beside
//! them that were divided in vain count as well, since a rough skin fills no
//! leaves but those along its middle. A share of 0.1 can be afforded: the cost
//! of a leaf that is taken as its nodes show it is bounded, so the run takes
//! little longer than the rest of the part does. A fan of n blades with the
//! radius R is too fine up to r = n w / π, where w is the smallest feature.
//! That is the share (r / R)² of the fan, and the rest is coarse enough. A
//! field that waves finely all over does so in nearly all of these leaves.
//!
//! The verdict depends on the slab's layers that are asked for and on nothing
//! else. Waves that all nodes of the lattice miss are not noticed, and cost
//! nothing.

use super::samples::Eyes;
use crate::cells::Place;
use crate::field::{FieldError, LEAF, Lattice, Leaf, NODES};
use crate::{Content, Length};
use glam::DVec2;
use std::collections::BTreeMap;
use std::f64::consts::FRAC_PI_2;

/// Least number of sign changes between a leaf's 144 pairs of neighbouring
/// nodes for the leaf to be looked at. A field without any order has 72 of
/// them, one that waves along one axis alone 36, and a single outline across
/// the leaf 16.
const MANY: u32 = 20;
/// Least number of a leaf's 64 cells that are to be divided for the leaf to be
/// looked at.
const DIVIDED: usize = 12;
/// Number of lines across a leaf in each direction.
const LINES: usize = 4;
/// By how much a line's place in its own part of the leaf differs from that of
/// the line before: the golden section. Lines at even distances could all pass
/// through a row of pins, or all between two.
const UNEVEN: f64 = 0.618_033_988_749_895;
/// Greatest width of inside and outside on average, in smallest features, at
/// which a leaf is too fine if only one of the two is too thin. A single thin
/// wall is not noise.
const SPARSE: f64 = 2.0;
/// Distance of the points along the lines, as a share of the smallest feature.
const PITCH: f64 = 0.25;
/// Distance of the points where the nodes hide something, as a share of the
/// smallest feature.
const CLOSE_PITCH: f64 = 1.0 / 16.0;
/// Area of leaves that are too fine, in all layers of a slab together, that is
/// accepted whatever its share. Where 40 blades of a fan meet there are 6 mm²
/// in each layer.
const LET_PASS: Content = 200.0;
/// Share of the leaves from which on a slab is refused.
const SHARE: f64 = 0.1;
/// Greatest area of leaves that are too fine. The rings that the nodes of such
/// leaves make have to be filled and travelled to.
const MOST_FINE_AREA: Content = 2000.0;
/// How many cells a divided cell counts as: it costs as much as a quarter of a
/// leaf.
const CELL: f64 = 16.0;

/// Counts what is too fine in a slab.
pub(super) struct Noise {
    smallest: Length,
    area: Content,
    /// Area of all leaves so far.
    all: Content,
    /// The first place that was too fine, and how wide its inside and outside
    /// are on average.
    first: Option<([f64; 3], Length)>,
    /// True for each leaf of the batch that is too fine.
    found: Vec<bool>,
    /// For how many layers that are asked for a leaf of the batch stands.
    weight: f64,
    /// For each leaf, how many of its cells were to be divided so far.
    divided: BTreeMap<[usize; 3], usize>,
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
    /// A count that has seen nothing so far. Rings below the size `smallest`
    /// are left out.
    pub(super) fn new(smallest: Length) -> Self {
        Noise {
            smallest,
            area: 0.0,
            all: 0.0,
            first: None,
            found: Vec::new(),
            weight: 1.0,
            divided: BTreeMap::new(),
        }
    }

    /// Looks at a batch of leaves, each of which stands for `weight` layers.
    ///
    /// # Errors
    /// If the area that is too fine is more than what is accepted.
    pub(super) fn look(
        &mut self,
        leaves: &[Leaf],
        values: &[f32],
        weight: usize,
        eyes: &mut Eyes<'_>,
    ) -> Result<(), FieldError> {
        self.begin(leaves, weight);
        let side = LEAF as f64 * eyes.lattice.spacing;
        self.all += self.weight * leaves.len() as f64 * side * side;
        let (values, _) = values.as_chunks();
        for (n, (leaf, values)) in leaves.iter().zip(values).enumerate() {
            if changes(values) >= MANY {
                self.look_into(n, leaf, false, eyes)?;
            }
        }
        Ok(())
    }

    /// Begins another batch of leaves, each of which stands for `weight` layers.
    pub(super) fn begin(&mut self, leaves: &[Leaf], weight: usize) {
        self.weight = weight as f64;
        self.found.clear();
        self.found.resize(leaves.len(), false);
    }

    /// Notes which cells of the batch are to be divided, in order. Looks at the
    /// leaves that have many of them.
    ///
    /// # Errors
    /// Those of [`Noise::look`].
    pub(super) fn dividing(
        &mut self,
        leaves: &[Leaf],
        cells: &[Place],
        eyes: &mut Eyes<'_>,
    ) -> Result<(), FieldError> {
        for cells in cells.chunk_by(|a, b| a.0 == b.0) {
            let n = cells[0].0;
            let Leaf { layer, i, j } = leaves[n];
            let count = self.divided.entry([layer, i, j]).or_default();
            let before = *count;
            *count += cells.len();
            if before < DIVIDED && *count >= DIVIDED {
                self.look_into(n, &leaves[n], true, eyes)?;
            }
        }
        Ok(())
    }

    /// Looks at the batch's `n`th leaf, unless it is known to be too fine.
    ///
    /// # Errors
    /// Those of [`Noise::look`].
    pub(super) fn look_into(
        &mut self,
        n: usize,
        leaf: &Leaf,
        closely: bool,
        eyes: &mut Eyes<'_>,
    ) -> Result<(), FieldError> {
        // A leaf in which nothing is too small is not too fine.
        if self.smallest <= 0.0 || self.found[n] {
            return Ok(());
        }
        let Some(width) = self.too_fine(leaf, closely, eyes)? else {
            return Ok(());
        };
        self.found[n] = true;
        let lattice = eyes.lattice;
        let side = LEAF as f64 * lattice.spacing;
        let (x, y) = (lattice.x[leaf.i + 4], lattice.y[leaf.j + 4]);
        let at = [x, y, eyes.z[leaf.layer]].map(f64::from);
        self.add(at, width, side * side)
    }

    /// True if a leaf of the batch begun last is too fine.
    pub(super) fn is_in(&self, leaf: usize) -> bool {
        self.found[leaf]
    }

    /// Notes that a cell was divided, and that its inside and outside turned
    /// out to be `width` wide on average.
    ///
    /// # Errors
    /// Those of [`Noise::look`].
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
        self.area += self.weight * area;
        self.first.get_or_insert((at, width));
        self.verdict(MOST_FINE_AREA)
    }

    /// Judges the slab, once all leaves have been looked at.
    ///
    /// # Errors
    /// If more of the leaves are too fine than is accepted.
    pub(super) fn finish(&self) -> Result<(), FieldError> {
        self.verdict(LET_PASS.max(SHARE * self.all))
    }

    fn verdict(&self, most: Content) -> Result<(), FieldError> {
        match self.first {
            Some((at, width)) if self.area > most => Err(FieldError::TooFine {
                at,
                width,
                smallest: self.smallest,
            }),
            _ => Ok(()),
        }
    }

    /// How wide the inside and the outside of a leaf are on average, if the
    /// leaf is too fine.
    fn too_fine(
        &self,
        leaf: &Leaf,
        closely: bool,
        eyes: &mut Eyes<'_>,
    ) -> Result<Option<Length>, FieldError> {
        let Leaf { layer, i, j } = *leaf;
        let low = eyes.lattice.node(i, j);
        let size = eyes.lattice.node(i + LEAF, j + LEAF) - low;
        let pitch = if closely { CLOSE_PITCH } else { PITCH };
        let steps = (size.x / (pitch * self.smallest)).ceil().max(1.0);
        let count = steps as usize + 1;
        eyes.clear();
        let mut within = (i + 3 * j + layer) as f64 * UNEVEN;
        for along in [DVec2::X, DVec2::Y] {
            for line in 0..LINES {
                within = (within + UNEVEN).fract();
                let across = (line as f64 + within) / LINES as f64;
                for k in 0..count {
                    let part = along * (k as f64 / steps)
                        + (DVec2::ONE - along) * across;
                    eyes.push(low + part * size, eyes.z[layer]);
                }
            }
        }
        let values = eyes.values()?;
        let changed = |line: &[f32]| {
            let pairs = line.windows(2);
            pairs.filter(|p| (p[0] < 0.0) != (p[1] < 0.0)).count()
        };
        let changes: usize = values.chunks_exact(count).map(changed).sum();
        let length = LINES as f64 * (size.x + size.y);
        let density = FRAC_PI_2 * changes as f64 / length;
        let width = 1.0 / density;
        let inside = values.iter().filter(|f| **f < 0.0).count();
        let inside = inside as f64 / values.len() as f64;
        // Twice the area over the outline is the width of a stripe, and half
        // the width of a disc.
        let thinner = 2.0 * inside.min(1.0 - inside) * width;
        let fine = width < self.smallest
            || (width < SPARSE * self.smallest
                && thinner < 0.5 * self.smallest);
        Ok(fine.then_some(width))
    }
}
