//! The program as its users meet it: each test runs it, and reads what it says
//! and writes.

// A test that cannot go on should say so and stop.
#![allow(
    clippy::panic,
    clippy::unwrap_used,
    reason = "helpers of tests may fail, too"
)]

#[path = "../common/program.rs"]
mod program;
#[path = "../common/served.rs"]
mod served;

mod bambu;
mod cli;
mod completions;
mod docs;
mod export;
mod gallery;
mod import;
mod preview;
mod send;
mod terminal;
mod watch;
