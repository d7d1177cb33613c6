//! The scalar field of a slab of layers: samples where it may change its sign.
//!
//! In: the model's expression, a lattice over its box, the sample heights of a
//! slab of layers. Out: for every leaf of 8 × 8 cells of a layer that interval
//! arithmetic cannot prove empty or full, the field at its 9 × 9 nodes, with a
//! [`Sampler`] for further points near by.
//!
//! ```text
//!  slab of ≤ 32 layers           block of ≤ 8 layers       leaf, one layer
//!  ┌──────────64 cells──┐  ───►  ┌──32 cells──┐   ───►     ┌─8─┐ 9 × 9
//!  │ prove or simplify  │        │  likewise  │            │   │ samples
//!  └────────────────────┘        └────────────┘            └───┘
//! ```
//!
//! A tile that spans several layers shares its proof and its simplified
//! expression with all of them. If that expression does not read z, the layers
//! share their samples as well. A leaf that is left out has no sign change on
//! its nodes, up to rounding (the proofs are in `f64`, the samples in `f32`).
//! If a leaf was left out wrongly, an outline stops at its border; `contour`
//! notices that, and asks for the leaf with [`Field::leaves`].
//!
//! Sums of exponentials, as in smooth unions, get branches that proofs can rule
//! out (`blend`). Branches that do not change the field's sign are left out
//! (`signs`). Calls of data are evaluated before the expression that reads them
//! (`calls`). Parts that depend on one coordinate alone, such as sin(k·x),
//! are taken out of the expression (`hoist`, `split`) and evaluated once per
//! column, row or layer (`axis`). `lanes` evaluates the rest, for many points
//! or boxes at a time. `workspace` brings both together for the walk in
//! `engine`. `sight` looks at the whole part from somewhere.
//!
//! This is the one place where `f64` millimetres become fidget's `f32`.

mod axis;
mod blend;
pub(crate) mod boxes;
mod calls;
mod engine;
mod expr;
mod hoist;
pub(crate) mod lanes;
mod lattice;
mod repeat;
mod sight;
mod signs;
mod source;
mod split;
mod values;
mod workspace;

pub use lattice::Lattice;
pub use sight::{Hit, Sight};
pub use values::Values;

use crate::Length;
use crate::cancel::{Cancel, Cancelled};
use crate::ceiling::uncapped;
use crate::plane::Rect;
use calls::Called;
use engine::Engine;
use fidget::context::{Context, Tree};
use split::Split;
use std::sync::OnceLock;

/// Cells along a leaf's side.
pub const LEAF: usize = 8;
/// Nodes along a leaf's side.
pub const NODES: usize = LEAF + 1;
/// Greatest number of layers that share one walk over the tiles.
pub const SLAB: usize = 32;
/// Greatest number of cells in a slab of a large lattice. It bounds the memory
/// of the layers' outlines by the extent in the plane, and not by the height. A
/// cell with an outline takes some 60 bytes until the slab is done. More layers
/// would save only proofs.
const SLAB_CELLS: usize = 4_000_000;

/// Why a field cannot be evaluated.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FieldError {
    /// The lattice would have more nodes than can be numbered.
    #[error("{x:.0} × {y:.0} is too large for samples every {spacing}")]
    TooLarge {
        /// Extent in x.
        x: Length,
        /// Extent in y.
        y: Length,
        /// Distance of the samples.
        spacing: Length,
    },
    /// The field changes its sign more finely than the smallest feature asked
    /// for, over large parts.
    #[error(
        "the field changes its sign too finely near x = {:.1}, y = {:.1}, \
         z = {:.1}: what is inside and what is outside is {width:.3} wide on \
         average, and what is narrower than {smallest:.3} is left out",
        .at[0], .at[1], .at[2]
    )]
    TooFine {
        /// A place with such changes.
        at: [Length; 3],
        /// How wide the field's inside and outside are there, on average.
        width: Length,
        /// Size below which features are left out.
        smallest: Length,
    },
    /// A look at the part takes more operations than are allowed.
    #[error("a look at the part takes more than {most} operations")]
    Costly {
        /// Number of operations that are allowed.
        most: u64,
    },
    /// fidget refused the expression, which is a bug, ours or fidget's.
    #[error("the expression cannot be evaluated ({0}), which is a bug")]
    Evaluator(String),
    /// The work was stopped.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// The error for what only a mistake in this crate or in fidget can cause.
fn bug(e: impl std::fmt::Display) -> FieldError {
    FieldError::Evaluator(e.to_string())
}

/// A leaf of one layer whose nodes have been sampled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Leaf {
    /// Number of the layer within the slab.
    pub layer: usize,
    /// Lattice column of the lower left node.
    pub i: usize,
    /// Lattice row of the lower left node.
    pub j: usize,
}

/// Evaluates the field at any points within one lattice cell of a batch of
/// leaves, at the heights of their layers or next to them ([`apart`]).
pub trait Sampler {
    /// Writes field values at points, of which `at` has the coordinates, to
    /// `out`.
    ///
    /// # Errors
    /// If the work has to stop.
    fn values(
        &mut self,
        at: [&[f32]; 3],
        out: &mut Vec<f32>,
    ) -> Result<(), FieldError>;

    /// Field values and in-plane slopes (f, ∂f/∂x, ∂f/∂y), written over `out`.
    fn slopes(&mut self, at: [&[f32]; 3], out: &mut Vec<[f32; 3]>);
}

/// A batch of sampled leaves.
pub struct Batch<'a> {
    /// The leaves.
    pub leaves: &'a [Leaf],
    /// For how many layers each leaf stands: for its own, and for those right
    /// above it. More than one if the expression does not read z there. Then
    /// all leaves are of one layer.
    pub span: usize,
    /// The leaves' node values, 81 per leaf, row by row.
    pub values: &'a [f32],
    /// Evaluates the field in and next to the leaves.
    pub sampler: &'a mut dyn Sampler,
}

/// What a caller does with a batch.
pub type Visit<'a> = dyn FnMut(Batch<'_>) -> Result<(), FieldError> + 'a;

/// How far from a plane the field is asked where the plane itself does not tell
/// inside from outside. The two heights differ by enough digits of `f32` for
/// the roundings of an expression, and by too little to be seen in an outline:
/// 10⁻⁴, or above 100 a millionth of the height.
pub fn apart(z: f32) -> f32 {
    (NEAR * z.abs()).max(APART)
}

const APART: f32 = 1e-4;
const NEAR: f32 = 1e-6;

/// A model's expression on a lattice over its box.
pub struct Field {
    tree: Tree,
    lattice: Lattice,
    engine: Engine,
    cancel: Cancel,
    /// The fields that stand in for this one in planes in which it does not
    /// tell inside from outside, once they have been asked for.
    beside: OnceLock<Box<Field>>,
    without_zeros: OnceLock<Box<Field>>,
}

impl Field {
    /// The field `tree` + `depth` over the box `bounds`, sampled every
    /// `spacing` millimetres.
    ///
    /// # Errors
    /// If the lattice would be too large, or fidget refuses the expression.
    pub fn new(
        tree: &Tree,
        depth: f64,
        bounds: Rect,
        spacing: Length,
    ) -> Result<Field, FieldError> {
        let tree = match depth {
            0.0 => tree.clone(),
            _ => tree.clone() + depth as f32,
        };
        Field::on(tree, Lattice::over(bounds, spacing)?)
    }

    /// The field `tree` on a lattice.
    fn on(tree: Tree, lattice: Lattice) -> Result<Field, FieldError> {
        let mut ctx = Context::new();
        let root = ctx.import(&tree);
        let root = uncapped(&mut ctx, root);
        let root = blend::branched(&mut ctx, root);
        let split = Split::new(Called::new(ctx, root, None)?)?;
        let engine = Engine::new(split, &lattice);
        Ok(Field {
            tree,
            lattice,
            engine,
            cancel: Cancel::NEVER,
            beside: OnceLock::new(),
            without_zeros: OnceLock::new(),
        })
    }

    /// The field that is negative where this one is just above the plane or
    /// just below it.
    ///
    /// # Errors
    /// If fidget refuses the expression, which is a bug.
    pub(crate) fn beside(&self) -> Result<&Field, FieldError> {
        self.other(&self.beside, |tree| {
            let (x, y, z) = Tree::axes();
            let apart = (z.abs() * NEAR).max(APART);
            let at = |z: Tree| tree.remap_xyz(x.clone(), y.clone(), z);
            at(z.clone() - apart.clone()).min(at(z + apart))
        })
    }

    /// The field that is infinite where this one is 0.
    ///
    /// # Errors
    /// If fidget refuses the expression, which is a bug.
    pub(crate) fn without_zeros(&self) -> Result<&Field, FieldError> {
        /// The square of this number is infinite.
        const GREAT: f32 = 1e30;
        self.other(&self.without_zeros, |tree| {
            tree.clone() + tree.not() * GREAT * GREAT
        })
    }

    /// The field that is kept in `place`. It is made when it is needed.
    fn other<'a>(
        &self,
        place: &'a OnceLock<Box<Field>>,
        make: impl Fn(&Tree) -> Tree,
    ) -> Result<&'a Field, FieldError> {
        if let Some(made) = place.get() {
            return Ok(made);
        }
        let made = Field::on(make(&self.tree), self.lattice.clone())?;
        let made = made.with_cancel(self.cancel.clone());
        Ok(place.get_or_init(|| Box::new(made)))
    }

    /// Lets `cancel` stop work on the field.
    pub fn with_cancel(mut self, cancel: Cancel) -> Field {
        self.cancel = cancel;
        self
    }

    /// The hook that stops work on the field.
    pub(crate) fn cancel(&self) -> &Cancel {
        &self.cancel
    }

    /// Stops if the hook asks for it.
    ///
    /// # Errors
    /// If the hook asks to stop.
    pub(crate) fn check(&self) -> Result<(), FieldError> {
        Ok(self.cancel.check()?)
    }

    /// The lattice on which the field is sampled.
    pub fn lattice(&self) -> &Lattice {
        &self.lattice
    }

    /// True if the layers at heights `z` are surely alike, all of them: then
    /// [`SLAB`] of them may be walked at a time, however large the lattice is.
    ///
    /// # Errors
    /// If it is stopped, or if fidget fails, which is a bug.
    pub fn is_level(&self, z: &[Length]) -> Result<bool, FieldError> {
        let z: Vec<f32> = z.iter().map(|&z| z as f32).collect();
        let fits = (1..=SLAB).contains(&z.len());
        Ok(fits && self.engine.is_level(&z, &self.cancel)?)
    }

    /// Number of layers to walk at a time: [`SLAB`], or a power of two below it
    /// for a large lattice. Layers that are alike may be more
    /// ([`Field::is_level`]).
    pub fn slab_layers(&self) -> usize {
        let cells = self.lattice.width() * self.lattice.height();
        let mut layers = SLAB;
        while layers > 1 && layers * cells > SLAB_CELLS {
            layers /= 2;
        }
        layers
    }

    /// Visits every leaf of the layers at heights `z` (at most [`SLAB`]) that
    /// may have a sign change.
    ///
    /// # Errors
    /// If the evaluator fails, or `visit` does.
    pub fn slab(
        &self,
        z: &[Length],
        visit: &mut Visit<'_>,
    ) -> Result<(), FieldError> {
        let z: Vec<f32> = z.iter().map(|&z| z as f32).collect();
        self.engine.slab(&z, &self.cancel, visit)
    }

    /// Visits given leaves, whether or not they may have a sign change.
    ///
    /// # Errors
    /// If the evaluator fails, or `visit` does.
    pub fn leaves(
        &self,
        z: &[Length],
        leaves: &[Leaf],
        visit: &mut Visit<'_>,
    ) -> Result<(), FieldError> {
        let z: Vec<f32> = z.iter().map(|&z| z as f32).collect();
        self.engine.leaves(&z, leaves, &self.cancel, visit)
    }
}
