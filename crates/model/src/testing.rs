//! Models for the tests of other modules.

use super::{BuildVolume, Model, Placement, Source, load, place};
use isoslice_settings::testing::settings;

#[allow(clippy::unwrap_used, reason = "it serves tests, which may unwrap")]
/// A formula's model on the bed of the default settings, whose middle is at
/// 110 mm.
pub fn placed(formula: &str, placement: &Placement) -> Model {
    let source = Source::formula("part", formula);
    let bed = BuildVolume::of(&settings(&[]));
    place(&load(&source, &[]).unwrap(), placement, bed).unwrap()
}
