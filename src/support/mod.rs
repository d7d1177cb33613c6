//! Supports: what holds faces that nothing of the part holds.
//!
//! ```text
//!        ┌──────────────────────┐
//!        └───────┐  ┌───────────┘
//!      ▒▒▒▒▒▒▒▒▒ │  │               top: a roof of dense lines, a gap below
//!       ╲░░░░░╱  │  │               the underside
//!        ╲░░░╱   │  │               its sides lean inwards on the way down
//!         │░│    │  │               until what is left is a thin wall or a post
//! ────────┴─┴────┴──┴──────
//! ```
//!
//! In: the outlines of all layers. Out: a [`Plan`], which has an area of
//! support for every layer.
//!
//! 1. [`need`] finds, layer by layer, what sticks out too far over the layer
//!    below, begins on nothing, or is too long for a bridge.
//! 2. From the top down, each layer's support is that of the layer above, drawn
//!    in by h·tan(`support.taper_angle`) where it is wider than a thin wall,
//!    and what is needed anew, less the part and `support.xy_gap` around it.
//! 3. From the bottom up, each island of support that rests on nothing is taken
//!    out, so none begins in the air.
//!
//! The plan depends on the part and on the settings only, and is made of all
//! layers, whichever are written.
//!
//! Not guaranteed: gaps in z are whole layers, at least as high as asked for.
//! Supports go straight down and do not lean away from what is below them.
//! The plan keeps areas for all layers, so its memory grows with the height.

mod need;
mod plan;

pub(crate) use plan::{Parts, Plan, Slice, Unheld};
