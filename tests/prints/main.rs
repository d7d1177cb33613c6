//! What is printed: parts are sliced whole, and their G-code is measured
//! against what is known of the parts.

// A test that cannot go on should say so and stop.
#![allow(
    clippy::panic,
    clippy::unwrap_used,
    reason = "helpers of tests may fail, too"
)]

#[path = "../common/mod.rs"]
mod common;

mod adhesion;
mod checked;
mod compensation;
mod data;
mod exposure;
mod flow_change;
mod golden;
mod hanging;
mod interlock;
mod internal_bridges;
mod invariants;
mod joints;
mod meshes;
mod one_by_one;
mod overhangs;
mod pairs;
mod plates;
mod raft;
mod seams;
mod spiral;
mod stopping;
mod supports;
mod top_walls;
mod vases;
mod z_contouring;
