//! What goes in and what comes out as text: models, settings, profiles and
//! other slicers' files, and G-code as firmware and viewers read it.

// A test that cannot go on should say so and stop.
#![allow(
    clippy::panic,
    clippy::unwrap_used,
    reason = "helpers of tests may fail, too"
)]

#[path = "../common/mod.rs"]
mod common;

mod expressions;
mod firmware;
mod hostile;
mod join;
mod model;
mod profiles;
mod ranges;
mod readers;
mod settings;
mod untrusted;
