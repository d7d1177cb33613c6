//! Supports: what holds faces that nothing of the part holds.
//!
//! ```text
//!        ┌──────────────────────┐
//!        └───────┐  ┌───────────┘
//!      ▒▒▒▒▒▒▒▒▒ │  │               top: a roof of dense lines, a gap below
//!       ╲░░░░░╱  │  │               the underside
//!        ╲░░░╱   │  │               it is drawn together on the way down
//!         │░│    │  │               until what is left is a post
//! ────────┴─┴────┴──┴──────
//! ```
//!
//! In: the outlines of all layers, slab by slab ([`Survey`]). Out: a [`Plan`], which has an area of
//! support for every layer.
//!
//! 1. [`overhangs`](crate::overhangs) says, layer by layer, what sticks out too far over the layer
//!    below, begins on nothing, or is too long for a bridge, and what of it is a lip
//!    that needs none. [`wish`] adds what `support.where` asks for, and takes away what
//!    it forbids ([`need`]).
//! 2. [`room`] finds where supports may be, and from where they can get down
//!    to the bed past the part.
//! 3. [`tree`] lets branches grow from the top down: each is drawn together by
//!    `support.branch_angle` until it is a post, and posts that can meet do.
//!    [`pad`] holds what begins so near to the bed that no gap fits below it.
//! 4. [`pieces`] splits the islands of support into sparse and dense parts, and
//!    [`settle`] takes out, from the bottom up, those that rest on nothing.
//! 5. [`cavity`] tells which of them nobody can take out.
//!
//! The [`Plan`] depends on the part and on its [`SupportPlan`] only, and is made of all
//! layers, whichever are written.
//!
//! Supports have heights of their own ([`Heights`]), so that gaps in z are what
//! is asked for, whatever the layer height.
//!
//! Not guaranteed: where layers of different heights follow each other, not
//! every gap can be exact; none is smaller than asked for. The plan keeps areas
//! for all layers, so its memory grows with the height. What sorts them, which
//! takes several times as much, is kept for few layers at a time.

use isoslice_base::units::{Mm, Mm2};

mod areas;
mod branch;
mod cavity;
mod cells;
mod disc;
mod heights;
mod need;
mod pad;
mod parts;
mod pieces;
mod plan;
mod room;
mod settle;
mod slice;
mod survey;
mod tree;
mod wish;

pub use areas::{Plan, held};
pub use disc::Disc;
pub use heights::Heights;
pub use plan::SupportPlan;
pub use slice::Slice;
pub use survey::{Asked, Survey, coarse};
pub use wish::Wishes;

/// Tolerance of the offsets, mm.
const TOLERANCE: Mm = 0.02;
/// What is smaller than this is not printed, mm².
const SPECK: Mm2 = 0.1;
