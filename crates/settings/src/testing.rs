//! Settings, and the plans that follow from them, for the tests of other crates.

use super::{Builder, Settings};

/// The default settings with assignments as `--set` takes them. Combinations
/// that cannot be printed are allowed.
#[allow(clippy::unwrap_used, reason = "it serves tests, which may unwrap")]
pub fn settings(assignments: &[&str]) -> Settings {
    let mut builder = Builder::new();
    for assignment in assignments {
        builder.set(assignment).unwrap();
    }
    builder.settings().clone()
}

/// What the default settings resolve to.
pub fn usual_plan<P>(of: impl FnOnce(&Settings) -> P) -> P {
    plan_with(of, |_| ())
}

/// What the default settings with a change resolve to.
pub fn plan_with<P>(
    of: impl FnOnce(&Settings) -> P,
    change: impl FnOnce(&mut Settings),
) -> P {
    let mut settings = Settings::default();
    change(&mut settings);
    of(&settings)
}
