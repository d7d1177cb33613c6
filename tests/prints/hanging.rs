//! What hangs, of parts of which it is known: area, reach and place by kind.

use crate::common;
use crate::common::{formula, settings, slice_layers};
use isoslice::pipeline::Summary;
use isoslice::{Hanging, Survey, survey};
use isoslice_held::overhangs::OverhangPlan;

fn run(text: &str, set: &[&str], layers: &str, threads: usize) -> Summary {
    let all = [&["sample_spacing=0.225", "accuracy=0.02"], set].concat();
    let settings = settings(&all);
    let model = formula(text, &settings);
    slice_layers(&model, &settings, layers, threads).1
}

fn hanging(text: &str) -> Hanging {
    run(text, &[], "..", 2).hanging
}

/// A box from one corner to the other.
fn block(low: [f64; 3], high: [f64; 3]) -> String {
    let axis = |i: usize| {
        let (middle, half) =
            (0.5 * (low[i] + high[i]), 0.5 * (high[i] - low[i]));
        format!("abs({} - {middle}) - {half}", ["x", "y", "z"][i])
    };
    format!("max(max({}, {}), {})", axis(0), axis(1), axis(2))
}

#[track_caller]
fn near(found: f64, expected: f64, share: f64) {
    let off = (found - expected).abs();
    assert!(off <= share * expected, "{found}, expected {expected}");
}

/// A plate of 60 by 20 mm on a post of 6 mm.
fn plate() -> String {
    let plate = block([-30.0, -10.0, 10.0], [30.0, 10.0, 14.0]);
    let post = block([-3.0, -3.0, 0.0], [3.0, 3.0, 11.0]);
    format!("min({plate}, {post})")
}

#[test]
fn a_plate_on_a_post_hangs_all_round() {
    let summary = run(&plate(), &[], "..", 2);
    let leans = summary.hanging.leans;
    near(leans.area, 60.0 * 20.0 - 36.0, 0.01);
    // From the post's corner to the plate's.
    near(leans.reach, 27.0_f64.hypot(7.0), 0.01);
    let first = leans.first.unwrap();
    near(first.z, 10.0, 0.001);
    assert!((first.x - 110.0).abs() > 29.0, "{first}");
    let told = summary.warnings.join("\n");
    assert!(told.contains("1164 mm² of undersides"), "{told}");
    assert!(told.contains("turn the part"), "{told}");
    assert!(summary.hanging.bridges.is_none());
    assert!(summary.hanging.begins.is_none());
}

#[test]
fn arms_reach_to_their_ends() {
    let stem = block([-4.0, -6.0, 0.0], [4.0, 6.0, 20.5]);
    let arms = block([-24.0, -6.0, 20.0], [24.0, 6.0, 25.0]);
    let leans = hanging(&format!("min({stem}, {arms})")).leans;
    near(leans.area, 2.0 * 20.0 * 12.0, 0.01);
    near(leans.reach, 20.0, 0.01);
}

/// A wall 10 mm thick and 20 mm wide and high, that leans by an angle.
fn wall(angle: f64) -> String {
    let slope = angle.to_radians().tan();
    format!("max(max(abs(x - z*{slope}) - 5, abs(y) - 10), abs(z - 10) - 10)")
}

#[test]
fn a_wall_hangs_from_the_angle_on() {
    for angle in [30.0, 50.0, 54.0] {
        let hanging = hanging(&wall(angle));
        assert_eq!(hanging, Hanging::default(), "{angle}");
    }
    let leans = hanging(&wall(60.0)).leans;
    let slope = |degrees: f64| degrees.to_radians().tan();
    near(leans.area, 20.0 * 20.0 * slope(60.0), 0.02);
    near(leans.reach, 20.0 * (slope(60.0) - slope(55.0)), 0.2);
    // The settings say which faces hold themselves.
    let better = run(&wall(60.0), &["support.angle=62"], "..", 1);
    assert_eq!(better.hanging, Hanging::default());
    assert_eq!(better.warnings, [""; 0]);
    let worse = run(&wall(50.0), &["support.angle=45"], "..", 1);
    near(worse.hanging.leans.area, 400.0 * slope(50.0), 0.02);
}

#[test]
fn of_a_ball_its_lower_cap_hangs_and_its_foot_is_small() {
    // A coarse outline grows by more in one layer than in the next.
    let fine = ["accuracy=0.005"];
    let summary = run("sqrt(x^2 + y^2 + z^2) - 15", &fine, "..", 2);
    let leans = summary.hanging.leans;
    // The ball leans by more than 55° there, except for what lies on the bed. A tenth
    // of a layer more is held.
    let foot = std::f64::consts::PI * (15.0_f64.powi(2) - 14.9_f64.powi(2));
    let angle = (55.0_f64.to_radians().tan() + 0.1).atan();
    let steep = angle.cos() * 15.0;
    near(
        leans.area,
        std::f64::consts::PI * steep * steep - foot,
        0.04,
    );
    assert!((2.5..4.0).contains(&leans.reach), "{leans:?}");
    near(summary.hanging.foot.unwrap().area, foot, 0.02);
    let told = summary.warnings.join("\n");
    assert!(told.contains("the part stands on 9.4 mm²"), "{told}");
}

#[test]
fn the_inside_of_a_dome_hangs_and_that_of_a_small_cavity_does_not() {
    let dome = "max(max(sqrt(x^2 + y^2 + z^2) - 22, \
                20 - sqrt(x^2 + y^2 + z^2)), -z)";
    let leans = hanging(dome).leans;
    let steep = 55.0_f64.to_radians().cos() * 20.0;
    let all = std::f64::consts::PI * steep * steep;
    // The hole that is left at the top is bridged.
    assert!((0.7 * all..all).contains(&leans.area), "{leans:?}");
    assert!((2.5..5.0).contains(&leans.reach), "{leans:?}");
    let small = "max(max(max(abs(x) - 8, abs(y) - 8), abs(z - 8) - 8), \
                 4 - sqrt(x^2 + y^2 + (z - 8)^2))";
    assert_eq!(hanging(small), Hanging::default());
}

#[test]
fn a_bridge_holds_up_to_its_length() {
    let bridge = |half: f64| {
        let end = half + 5.0;
        let deck = block([-end, -8.0, 10.0], [end, 8.0, 13.0]);
        let legs = format!(
            "max(max(abs(abs(x) - {}) - 2.5, abs(y) - 8), abs(z - 5.5) - 5.5)",
            half + 2.5
        );
        format!("min({deck}, {legs})")
    };
    assert_eq!(hanging(&bridge(4.5)), Hanging::default());
    let far = run(&bridge(9.0), &["bridge_max=20"], "..", 1);
    assert_eq!(far.hanging, Hanging::default());
    let long = hanging(&bridge(15.0));
    near(long.bridges.reach, 30.0, 0.01);
    near(long.bridges.area, 30.0 * 16.0, 0.02);
    assert_eq!(long.bridges.count, 1);
    near(long.bridges.first.unwrap().z, 10.0, 0.001);
    assert!(long.leans.is_none());
    let short = run(&bridge(9.0), &["bridge_max=12"], "..", 1);
    near(short.hanging.bridges.reach, 18.0, 0.01);
    let told = short.warnings.join("\n");
    assert!(told.contains("bridge_max = 12 mm"), "{told}");
    // Lines askew lead from the legs to the free sides.
    let askew = run(&bridge(9.0), &["bridge_max=0"], "..", 1);
    near(askew.hanging.leans.area, 18.0 * 16.0, 0.02);
}

#[test]
fn a_lid_over_a_wide_box_hangs_though_its_rim_is_held() {
    let cup = block([-20.0, -20.0, 0.0], [20.0, 20.0, 10.0]);
    let room = block([-18.0, -18.0, 2.0], [18.0, 18.0, 8.0]);
    let bridges = hanging(&format!("max({cup}, -({room}))")).bridges;
    near(bridges.reach, 36.0, 0.01);
    near(bridges.area, 36.0 * 36.0, 0.02);
}

#[test]
fn a_vase_has_no_ceilings_that_hang() {
    // A coaster with two pockets inside, as for magnets.
    let block = block([-15.0, -15.0, 0.0], [15.0, 15.0, 4.0]);
    let pocket = |x: f64| format!("max(hypot(x - {x}, y) - 6, abs(z - 2) - 1)");
    let text = format!("max({block}, -min({}, {}))", pocket(-7.5), pocket(7.5));
    let set = ["bridge_max=8", "skirt.loops=0"];
    let solid = run(&text, &set, "..", 2).hanging;
    assert_eq!(solid.bridges.count, 2);
    let vase = [&set[..], &["spiral=true", "bottom_layers=2"]].concat();
    let vase = run(&text, &vase, "..", 2);
    let told = |w: &String| w.contains("bridge");
    assert!(vase.hanging.bridges.is_none() && vase.hanging.leans.is_none());
    assert!(!vase.warnings.iter().any(told), "{:?}", vase.warnings);
}

#[test]
fn what_begins_on_nothing_counts_unless_it_is_a_tip() {
    // A pin beside a post, 2 mm below a bar that joins them.
    let pin = |half: f64| {
        format!(
            "min({}, min({}, {}))",
            block([-2.0, -2.0, 0.0], [2.0, 2.0, 6.0]),
            block([5.0, -half, 2.0], [5.0 + 2.0 * half, half, 4.5]),
            block([-2.0, -2.0, 4.0], [10.0, 2.0, 6.0])
        )
    };
    let begins = hanging(&pin(2.0)).begins;
    assert_eq!(begins.count, 1);
    near(begins.area, 16.0, 0.01);
    near(begins.first.unwrap().z, 2.0, 0.001);
    assert!(hanging(&pin(0.5)).begins.is_none());
    // This pin is thin, but it hangs down by 4 mm.
    let long = format!(
        "min({}, {})",
        block([-2.0, -2.0, 0.0], [2.0, 2.0, 6.0]),
        format_args!(
            "min({}, {})",
            block([5.0, -0.5, 1.0], [6.0, 0.5, 5.5]),
            block([-2.0, -2.0, 5.0], [10.0, 2.0, 6.0])
        )
    );
    assert_eq!(hanging(&long).begins.count, 1);
}

#[test]
fn a_pillar_is_too_high_for_its_foot_and_a_brim_helps() {
    let pillar = block([-1.5, -1.5, 0.0], [1.5, 1.5, 60.0]);
    let summary = run(&pillar, &[], "..", 1);
    let foot = summary.hanging.foot.unwrap();
    near(foot.area, 9.0, 0.01);
    near(foot.holds, 2.5 * 27.0 / 6.0 / 2.0_f64.sqrt(), 0.02);
    let told = summary.warnings.join("\n");
    assert!(told.contains("is 60.0 mm high"), "{told}");
    let brim = run(&pillar, &["brim.place=outer"], "..", 1);
    assert_eq!(brim.hanging.foot, None);
    // Nothing is said of layers above, nor of a part as low as a cube or as
    // wide as a vase.
    assert_eq!(run(&pillar, &[], "10..20", 1).hanging.foot, None);
    let cube = block([-5.0, -5.0, 0.0], [5.0, 5.0, 10.0]);
    assert_eq!(hanging(&cube), Hanging::default());
    let vase = "max(max(sqrt(x^2 + y^2) - 15, 14 - sqrt(x^2 + y^2)), \
                abs(z - 40) - 40)";
    assert_eq!(hanging(vase), Hanging::default());
}

#[test]
fn ranges_of_layers_tell_what_hangs_in_them() {
    // A range counts a slope from its first layer on.
    let slope = wall(60.0).replace("abs(z - 10) - 10", "abs(z - 15) - 15");
    let whole = run(&slope, &[], "..", 2).hanging.leans;
    let ranges = ["1..40", "41..128", "129..135", "136.."];
    let parts = ranges.map(|layers| run(&slope, &[], layers, 1).hanging.leans);
    let area: f64 = parts.iter().map(|sum| sum.area).sum();
    near(area, whole.area, 0.02 * whole.area);
    assert!(parts.iter().all(|sum| sum.reach <= whole.reach));
    assert_eq!(parts[0].first, whole.first);
    assert_eq!(run(&slope, &[], "..", 1).hanging.leans, whole);
}

/// A tube of 4 mm about a helix of one turn: its lower end leans on the bed, and its tip
/// gets farther in every layer.
#[test]
fn what_a_ledge_has_is_counted_once() {
    let spring = "max(sqrt((sqrt(x^2 + y^2) - 10)^2 + \
                  ((z/7 - atan2(y, x)/(2*3.14159265) - \
                  round(z/7 - atan2(y, x)/(2*3.14159265)))*7)^2) - 2, \
                  abs(z - 14) - 14)";
    let leans = run(spring, &["accuracy=0.005"], "..", 2).hanging.leans;
    // By the triangles of the surface that lean by more than 55°, less those that
    // lean by up to 57°, there are 538 to 569 mm².
    assert!((530.0..585.0).contains(&leans.area), "{leans:?}");
}

/// What a survey says of a part, and what a run without supports says.
fn both(text: &str, set: &[&str]) -> (Survey, Summary) {
    let all = [&["sample_spacing=0.225", "accuracy=0.005"], set].concat();
    let settings = settings(&all);
    let model = formula(text, &settings);
    let found = survey(&model, &settings, Some(2)).unwrap();
    (found, slice_layers(&model, &settings, "..", 2).1)
}

#[test]
fn a_survey_and_a_run_tell_the_same() {
    let lip = format!(
        "min({}, {})",
        block([-8.0, -8.0, 0.0], [8.0, 8.0, 8.0]),
        block([-8.7, -8.7, 8.0], [8.7, 8.7, 12.0])
    );
    let ball = "sqrt(x^2 + y^2 + (z - 20)^2) - 20".to_owned();
    let leaning = wall(60.0).replace("abs(z - 10) - 10", "abs(z - 15) - 15");
    for (name, text) in [
        ("plate", plate()),
        ("lip", lip),
        ("ball", ball),
        ("wall", leaning),
    ] {
        let (found, summary) = both(&text, &[]);
        let hanging = Hanging {
            foot: None,
            ..summary.hanging
        };
        assert_eq!(found.hanging, hanging, "{name}");
        let area: f64 = found.places.iter().map(|p| p.area).sum();
        if name == "lip" {
            // Supports hold it, since its underside is better then. It does not
            // sag by so much that it is worth a warning.
            near(area, 17.4_f64.powi(2) - 16.0_f64.powi(2), 0.01);
            assert!(hanging.leans.is_none() && !found.places.is_empty());
            continue;
        }
        // Both count what is seen from below.
        near(area, hanging.leans.area, 0.05);
        let reach = found.places.iter().map(|p| p.reach).fold(0.0, f64::max);
        near(reach, hanging.leans.reach, 0.02);
    }
}

/// Walls that run straight across a gap beside a ledge, from post to post, are bridges
/// for supports, and so they are for warnings.
#[test]
fn a_ledge_that_walls_bridge_does_not_hang() {
    // A step of 1 mm in every third layer, 8 mm long, between two posts.
    let steps = |x: f64| {
        let step = |k: i32| {
            let z = 4.0 + 0.6 * f64::from(k);
            let out = 1.0 * f64::from(k + 1);
            block([-10.0, -4.5, z], [out - 6.0, 4.5, z + 5.0])
        };
        (0..3).map(step).fold(
            format!(
                "min({}, min({}, {}))",
                block([-10.0, -4.5, 0.0], [-6.0, 4.5, 8.0]),
                block([-10.0, -9.0, 0.0], [x, -4.0, 8.0]),
                block([-10.0, 4.0, 0.0], [x, 9.0, 8.0])
            ),
            |all, step| format!("min({all}, {step})"),
        )
    };
    let (found, summary) = both(&steps(2.0), &[]);
    assert_eq!(found.places, [], "supports");
    assert_eq!(summary.hanging, Hanging::default());
    // Without the posts it hangs.
    let (found, summary) = both(&steps(-6.0), &[]);
    assert!(!found.places.is_empty());
    assert!(!summary.hanging.leans.is_none());
}

#[test]
fn what_a_thread_in_the_air_would_hold_hangs() {
    // A plate on a pin of 0.2 mm, which is not printed.
    let pin = block([-0.1, -0.1, 0.0], [0.1, 0.1, 4.0]);
    let post = block([10.0, -3.0, 0.0], [16.0, 3.0, 6.0]);
    let plate = block([-3.0, -3.0, 4.0], [3.0, 3.0, 6.0]);
    let begins = hanging(&format!("min({pin}, min({post}, {plate}))")).begins;
    near(begins.area, 36.0, 0.01);
    near(begins.first.unwrap().z, 4.0, 0.001);
}

#[test]
fn no_example_hangs() {
    for example in common::examples() {
        let (model, settings) =
            example.place(&["sample_spacing=0.2", "accuracy=0.05"]);
        let summary = slice_layers(&model, &settings, "..", 2).1;
        let (plan, top) = (OverhangPlan::of(&settings), summary.size.z);
        let told = summary.hanging.warnings(top, &plan);
        assert!(told.is_empty(), "{}: {told:?}", example.name);
    }
}

/// Where `bridge_max` is 0, supports count no lines of skin as bridges, and the
/// places that need some are measured likewise.
#[test]
fn without_bridges_a_gap_is_listed_with_its_reach() {
    // A lid on two walls that are 5 mm apart.
    let table = "min(max(max(abs(abs(x) - 4.5) - 2, abs(y) - 8), \
                 abs(z - 2) - 2), max(max(abs(x) - 6.5, abs(y) - 8), \
                 abs(z - 4.5) - 0.5))";
    for angle in ["skin_angle=0", "skin_angle=45", "skin_angle=90"] {
        let settings = common::settings(&["bridge_max=0", angle]);
        let model = common::formula(table, &settings);
        let survey = survey(&model, &settings, Some(2)).unwrap();
        let [place] = &survey.places[..] else {
            panic!("{angle}: {:?}", survey.places);
        };
        assert!((place.area - 5.0 * 16.0).abs() < 5.0, "{place:?}");
        assert!((place.reach - 2.5).abs() < 0.3, "{place:?}");
    }
}
