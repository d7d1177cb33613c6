//! Heights of layers, compared with what is known of the surfaces.

use super::*;
use crate::Placement;
use isoslice_settings::testing::settings;

fn placed(formula: &str) -> Model {
    crate::placed(formula, &Placement::default())
}

fn asked(assignments: &[&str]) -> HeightPlan {
    HeightPlan::of(&settings(assignments))
}

fn adaptive() -> HeightPlan {
    asked(&["layer_heights=adaptive 0.1"])
}

/// Number of layers of one height that make steps as small on a surface as level
/// as this.
fn as_fine(found: &Heights, level: f64) -> f64 {
    let top = found.spans.last().unwrap().top;
    layers::plan(top, 0.2, 0.1 / level).unwrap().len() as f64
}

/// The layers of a part whose levelness at the height z above the bed is
/// `level(z)`, after they have been judged.
fn judged(
    formula: &str,
    plan: &HeightPlan,
    level: impl Fn(Mm) -> f64,
) -> Heights {
    let model = placed(formula);
    let found = heights(&model, plan).unwrap();
    let top = model.bounds.size().z;
    let last = found.spans.last().unwrap();
    assert!((last.top - top).abs() < 1e-3, "{} {top}", last.top);
    let (least, most) = (plan.least, plan.most);
    for pair in found.spans.windows(2) {
        assert_eq!(pair[0].top, pair[1].bottom);
    }
    for span in &found.spans[1..] {
        let height = span.height();
        assert!(height >= 0.5 * least - 0.001 && height <= most + 1e-9);
        let digits = 1000.0 * span.top;
        assert!((digits - digits.round()).abs() < 1e-6);
        // Faces at which a layer ends do not count.
        let steps = (1..200).map(|k| {
            let t = f64::from(k) / 200.0;
            height * level(span.bottom + t * height)
        });
        let step = steps.fold(0.0, f64::max);
        assert!(step <= plan.step + 1e-9, "{span:?}: {step}");
    }
    found
}

/// Tests that at least a quarter of the layers is saved.
fn saves(found: &Heights) {
    let steps = found.steps.unwrap();
    let share = found.spans.len() as f64 / as_fine(found, 1.0);
    assert!(share <= 0.75, "{steps:?}: {}", found.spans.len());
    assert_eq!(steps.unproved_mm, 0.0);
}

/// Tests that the layers are hardly more than the least number that any heights
/// within the limits can do with: the integral of 1/h, where h is the greatest
/// height at z.
fn near_the_least(
    found: &Heights,
    plan: &HeightPlan,
    level: impl Fn(Mm) -> f64,
) {
    const PARTS: usize = 100_000;
    let bottom = found.spans[0].top;
    let dz = (found.spans.last().unwrap().top - bottom) / PARTS as f64;
    let at = |k: usize| level(bottom + (k as f64 + 0.5) * dz);
    let height = |level: f64| plan.clamp(plan.step / level);
    let least: f64 = (0..PARTS).map(|k| dz / height(at(k))).sum();
    let count = (found.spans.len() - 1) as f64;
    // A layer is as thin as its most level place asks for, and the last one may
    // be all too much.
    assert!(count <= 1.02 * least + 1.0, "{count}, {least}");
}

#[test]
fn a_dome_gets_thin_layers_where_it_is_level() {
    let dome = "max(sqrt(x^2 + y^2 + z^2) - 20, -z)";
    let found = judged(dome, &adaptive(), |z| z / 20.0);
    saves(&found);
    near_the_least(&found, &adaptive(), |z| z / 20.0);
    let spans = &found.spans;
    assert!(spans[5].height() > 0.28);
    assert!(spans[spans.len() - 2].height() < 0.11);
    // The limit is used up: h = 0.1 · 20 / z.
    let middle = spans.iter().find(|s| s.bottom > 14.0).unwrap();
    assert!(middle.height() > 0.92 * 2.0 / middle.top, "{middle:?}");
}

#[test]
fn an_ellipsoid_that_is_no_distance() {
    // Half axes along z and along the longer one of the others.
    for (formula, high, long) in [
        ("x^2/144 + y^2/100 + z^2/324 - 1", 18.0, 12.0),
        ("x^2/400 + y^2/144 + z^2/64 - 1", 8.0, 20.0),
    ] {
        let level = |height: Mm| {
            let z = (height - high) / high;
            let (up, along) = (z / high, (1.0 - z * z).max(0.0).sqrt() / long);
            up.abs() / up.hypot(along)
        };
        let found = judged(formula, &adaptive(), level);
        saves(&found);
        near_the_least(&found, &adaptive(), level);
    }
}

#[test]
fn a_screw_has_thin_layers_at_its_thread_only() {
    // The part has a shank of 20 mm and a thread of 12 mm with flanks of up to
    // 2π·0.6/3.
    let screw = "max(max(sqrt(x^2 + y^2) - 5 - max(0, min(1, (20 - z)*1000)) \
                 - 0.6*sin(2*pi*z/3 - atan2(y, x))*max(0, min(1, (z - 20) \
                 * 1000)), -z), z - 32)";
    let model = placed(screw);
    let found = heights(&model, &adaptive()).unwrap();
    let of = |z: Mm| found.spans.iter().find(|s| s.top > z).unwrap().height();
    assert!(of(10.0) > 0.28, "{}", of(10.0));
    // The slopes are 0.6·2π/3 along z and 0.6/5 round the part where the thread
    // is steepest.
    assert!(of(26.0) <= 0.1 / 0.78 && of(26.0) > 0.12, "{}", of(26.0));
}

#[test]
fn a_thread_on_a_shank_takes_a_third_fewer_layers() {
    // The radius of the thread is 5 + 0.6·sin(2π·z/3 − φ): where its cosine is 1,
    // its slopes are 0.6·2π/3 along z and 0.6/5 round it.
    let screw = "max(-z, min(max(sqrt(x^2 + y^2) - 6, z - 20), \
                 max(sqrt(x^2 + y^2) - 5 - 0.6*sin(2*pi*z/3 - atan2(y, x)), \
                 z - 32)))";
    let along = 0.6 * std::f64::consts::TAU / 3.0;
    let level = along / along.hypot(1.0).hypot(0.12);
    // The shank's top is a face at which a layer ends.
    let level_at = |z: Mm| if z < 20.0 { 0.0 } else { level };
    let found = judged(screw, &adaptive(), level_at);
    let share = found.spans.len() as f64 / as_fine(&found, level);
    assert!(share <= 0.7, "{share}: {}", found.spans.len());
    assert_eq!(found.steps.unwrap().unproved_mm, 0.0);
    // Uniform layers as fine as this are 252. These were 168 while the search
    // left 0.64 mm unproved.
    assert!(found.spans.len() <= 168, "{}", found.spans.len());
    // Where the thread begins, layers become thinner step by step.
    let of_thread = found.spans.iter().filter(|s| s.bottom > 20.5);
    let least = 11.5 * level / 0.1;
    let count = of_thread.count() as f64;
    assert!(count <= 1.03 * least + 1.0, "{count}, {least}");
    let hit = |z: Mm| found.spans.iter().any(|s| (s.top - z).abs() < 1e-6);
    assert!(hit(20.0) && hit(32.0));
}

#[test]
fn layers_end_at_level_faces_and_stay_thick() {
    let stairs = "min(max(max(abs(x) - 10, abs(y) - 8), abs(z - 2) - 2), \
                  min(max(max(abs(x) - 7, abs(y) - 8), abs(z - 3.617) \
                  - 3.617), max(max(abs(x) - 4, abs(y) - 8), \
                  abs(z - 5.05) - 5.05)))";
    let found = judged(stairs, &adaptive(), |_| 0.0);
    for face in [4.0, 7.234, 10.1] {
        let hit = found.spans.iter().any(|s| (s.top - face).abs() < 1e-6);
        assert!(hit, "{face}: {found:?}");
    }
    let steps = found.steps.unwrap();
    assert_eq!((steps.level_faces, steps.missed_faces), (3, 0));
    assert!(steps.thinnest_mm > 0.2, "{steps:?}");
}

#[test]
fn an_expression_gives_the_height() {
    let rising = asked(&["layer_heights=expr: 0.1 + z / 100"]);
    let model = placed("max(sqrt(x^2 + y^2) - 6, abs(z - 10) - 10)");
    let found = heights(&model, &rising).unwrap();
    for span in &found.spans[1..] {
        let asked = 0.1 + 0.01 * span.bottom;
        assert!((span.height() / asked - 1.0).abs() < 0.05, "{span:?}");
    }
    let bad = asked(&["layer_heights=expr: x"]);
    assert!(heights(&model, &bad).is_err());
}

#[test]
fn uniform_layers_are_as_they_were() {
    let model = placed("sqrt(x^2 + y^2 + z^2) - 3");
    let found = heights(&model, &asked(&[])).unwrap();
    let top = model.bounds.max.z + model.offset.z;
    assert_eq!(found.spans, layers::plan(top, 0.2, 0.2).unwrap());
    assert_eq!(found.steps, None);
}

/// By default adaptive layers make no greater step than uniform ones, and are
/// not more.
#[test]
fn by_default_there_are_no_more_layers_than_uniform_ones() {
    for (height, most) in [(0.1, 0.3), (0.2, 0.3), (0.05, 0.3), (0.32, 0.32)] {
        let layer_height = format!("layer_height={height}");
        let plan = asked(&[&layer_height, "layer_heights=adaptive"]);
        assert_eq!(plan.most, most);
        let dome = "max(sqrt(x^2 + y^2 + z^2) - 9.5, -z)";
        let found = judged(dome, &plan, |z| z / 9.5);
        let steps = found.steps.unwrap();
        let uniform = layers::plan(9.5, 0.2, height).unwrap().len();
        assert_eq!(steps.uniform_layers, uniform);
        // The last layer may be one that the exact top takes.
        assert!(found.spans.len() <= uniform + 1, "{height}: {steps:?}");
    }
}

#[test]
fn layers_end_at_a_level_face_wherever_it_lies_beside_a_dome() {
    for face in [1.5_f64, 3.0, 4.5, 5.0, 6.0, 6.3, 7.5, 9.0] {
        let part = format!(
            "min(max(max(abs(x), abs(y)) - 12, abs(z - {face}/2) - {face}/2), \
             max(sqrt(x^2 + y^2 + z^2) - 9.5, -z))"
        );
        // The dome shows above the face alone.
        let level = |z: Mm| if z < face { 0.0 } else { z / 9.5 };
        let found = judged(&part, &adaptive(), level);
        let hit = |z: Mm| found.spans.iter().any(|s| (s.top - z).abs() < 1e-6);
        assert!(hit(face), "{face}: {found:?}");
        assert_eq!(found.steps.unwrap().unproved_mm, 0.0, "{face}");
    }
}
