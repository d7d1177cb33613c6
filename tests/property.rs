//! Outlines of random solids and of random formulas.
//!
//! The solids are judged by their own function in `f64`: within the accuracy
//! of every point of an outline the sign must change, and where it does not
//! change for the size of a printable feature the outline must agree with it.
//! The formulas are only to be survived.

// A test that cannot go on should say so and stop.
#![allow(clippy::unwrap_used)]

#[path = "property/check.rs"]
mod check;
#[path = "property/csg.rs"]
mod csg;

use csg::{Solid, solid};
use glam::DVec2;
use isoslice::contour::{Detail, outlines};
use isoslice::field::{Backend, Field};
use isoslice::plane::Rect;
use isoslice::timings::Timings;
use proptest::prelude::*;
use proptest::test_runner::{Config, RngAlgorithm, RngSeed};

const DETAIL: Detail = Detail {
    accuracy: 0.005,
    smallest: 0.11,
};
/// Half the side of the square around the solids.
const HALF: f64 = 4.0;

fn config(cases: u32) -> Config {
    Config {
        cases,
        failure_persistence: None,
        rng_algorithm: RngAlgorithm::ChaCha,
        rng_seed: RngSeed::Fixed(20),
        ..Config::default()
    }
}

/// Everything wrong with the outline of a solid at a height.
fn judge(solid: &Solid, spacing: f64, z: f64) -> Result<(), String> {
    let bounds = Rect {
        min: DVec2::splat(-HALF),
        max: DVec2::splat(HALF),
    };
    let heights = [-HALF, HALF];
    let vm = Some(Backend::Vm);
    let field =
        Field::new(&solid.tree(), 0.0, bounds, spacing, heights, vm).unwrap();
    let outline = outlines(&field, &[z], DETAIL, &Timings::default())
        .unwrap()
        .remove(0);
    if outline.forced_rings > 0 {
        return Err(format!("{} rings do not close", outline.forced_rings));
    }
    let inside = |p: DVec2| solid.value(p.extend(z)) < 0.0;
    check::topology(&outline.area)?;
    // A tenth of a micrometre of rounding: fidget works in `f32`.
    check::accuracy(&outline.area, DETAIL.accuracy + 1e-4, &inside)?;
    check::complete(&outline.area, HALF, DETAIL.smallest, &inside)
}

proptest! {
    #![proptest_config(config(150))]

    #[test]
    fn outlines_of_solids_are_exact(
        solid in solid(),
        spacing in prop_oneof![Just(0.1), Just(0.2), Just(0.4)],
        z in -0.7..0.7,
    ) {
        if let Err(fault) = judge(&solid, spacing, z) {
            return Err(TestCaseError::fail(fault));
        }
    }
}

#[test]
fn survey() {
    use proptest::strategy::ValueTree;
    use proptest::test_runner::TestRunner;
    let mut r = TestRunner::new(config(1));
    let st = (
        solid(),
        prop_oneof![Just(0.1), Just(0.2), Just(0.4)],
        -0.7..0.7,
    );
    for n in 0..3000 {
        let (s, h, z) = st.new_tree(&mut r).unwrap().current();
        if let Err(e) = judge(&s, h, z) {
            println!("CASE {n} {h} {z:.3} {e}");
            if std::env::var("SHOW") == Ok(n.to_string()) {
                println!("{s:?} {z}");
            }
        }
    }
}
