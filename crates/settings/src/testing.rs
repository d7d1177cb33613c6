//! Settings for the tests of other crates.

use super::{Builder, Settings};

#[allow(clippy::unwrap_used, reason = "it serves tests, which may unwrap")]
/// The default settings with assignments as `--set` takes them. Combinations
/// that cannot be printed are allowed.
pub fn settings(assignments: &[&str]) -> Settings {
    let mut builder = Builder::new();
    for assignment in assignments {
        builder.set(assignment).unwrap();
    }
    builder.settings().clone()
}
