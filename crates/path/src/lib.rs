//! The nozzle's way through a layer: order, travel and speed.
//!
//! In: the beads of a layer, with what the layer is made of. Out: for each
//! layer a [`PacedLayer`](pace::PacedLayer): every move with its speed, and all
//! retractions, lifts and fans between them.
//!
//! | module | what it decides |
//! |---|---|
//! | [`order`] | what is printed after what, and where loops begin |
//! | [`spiral`] | the turns of a vase, which need no order |
//! | [`z_contouring`] | how far beads follow the surface above and below their layer |
//! | [`travel`] | the ways between beads, and where to retract |
//! | [`pace`] | the speed of each move, and the time of all |
//!
//! Guarantees: no bead moves sideways, but `order` joins hidden ones over short
//! ways, and `spiral` makes its own. The same input gives the same moves, on any
//! number of threads. Times follow the rules of the firmware's planner; the
//! folder `pace/motion` says what is left out.
//!
//! Not known here: the words of any firmware.

#![warn(unreachable_pub)]

pub mod order;
pub mod pace;
pub mod spiral;
pub mod travel;
pub mod z_contouring;
