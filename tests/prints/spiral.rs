//! A vase printed as one climbing wall, against the surface it stands for.

use crate::common;
use crate::common::head::Head;
use glam::{DVec2, DVec3};
use isoslice::pipeline::{self, Options};

/// Layer height, mm, and the wall's width.
const HEIGHT: f64 = 0.2;
const WIDTH: f64 = 0.45;

/// A move that extrudes: from, to, filament.
type Step = (DVec3, DVec3, f64);

const BASE: [&str; 8] = [
    "spiral=true",
    "layer_height=0.2",
    "first_layer_height=0.2",
    "outer_wall_width=0.45",
    "bottom_layers=2",
    "gcode.relative_e=true",
    "gcode.progress=off",
    "skirt.loops=0",
];

fn asked<'a>(more: &[&'a str]) -> Vec<&'a str> {
    [&BASE[..], more].concat()
}

/// The moves of the layers from `first` on, from the middle of the default bed,
/// and their text.
fn turns(gcode: &str, first: usize) -> (Vec<Step>, String) {
    let mut layers = gcode.split(";LAYER_CHANGE\n").skip(1 + first);
    let mut text: String = layers.by_ref().collect();
    text.truncate(text.find("; end of layers").unwrap());
    let mut head = Head::new(DVec3::new(110.0, 110.0, 0.0));
    let steps = text.lines().filter_map(|line| head.step(line));
    let printing = steps.filter(|s| s.fed > 0.0 && s.to.distance(s.from) > 0.0);
    let steps = printing.map(|s| (s.from, s.to, s.fed)).collect();
    (steps, text)
}

/// A cone that widens by half of its height.
fn cone(more: &[&str]) -> (Vec<Step>, String) {
    let part = "max(sqrt(x^2 + y^2) - 15 - 0.5*z, max(-z, z - 6))";
    let (model, settings) = common::part(part, &asked(more));
    let (gcode, _) = common::slice(&model, &settings, 2);
    turns(&gcode, 2)
}

#[test]
fn every_point_is_on_the_surface_at_its_own_height() {
    let (steps, _) = cone(&[]);
    assert!(steps.len() > 28 * 50);
    let last = steps.iter().map(|s| s.1.z).fold(0.0, f64::max);
    assert!((last - 6.0).abs() < 1e-9);
    let mut worst: f64 = 0.0;
    for (from, to, _) in &steps {
        // The first turn grows, and the flat one at the end follows the last
        // layer's outline.
        let flat = from.z == 6.0;
        if from.z < 0.4 + HEIGHT || flat {
            continue;
        }
        for i in 0..=4 {
            let p = from.lerp(*to, 0.25 * f64::from(i));
            let surface = 15.0 + 0.5 * (p.z - 0.5 * HEIGHT);
            let off = p.truncate().length() + 0.5 * WIDTH - surface;
            worst = worst.max(off.abs());
        }
    }
    // `accuracy`, and the rounding of coordinates.
    assert!(worst < 0.005 + 0.001, "{worst}");
}

#[test]
fn it_climbs_without_a_break() {
    let (steps, text) = cone(&[]);
    for (a, b) in steps.iter().zip(&steps[1..]) {
        assert_eq!(a.1, b.0);
        assert!(b.1.z >= b.0.z);
        assert!(b.1.z - b.0.z < 0.1 * HEIGHT);
    }
    assert!(!text.contains("G10") && !text.contains("E-"));
    // After the way to the first turn, no step is without filament.
    let mut moves = text.lines().filter(|l| l.starts_with("G1 X"));
    let climb: Vec<_> =
        moves.by_ref().skip_while(|l| !l.contains('Z')).collect();
    // The bead is down to nothing where the last turn ends.
    let climb = &climb[..climb.len() - 1];
    assert_eq!(climb.iter().find(|l| !l.contains('E')), None);
}

/// A pipe leans by 60° towards x, so that this side reaches far beyond the turn below,
/// and the opposite side as far into the hollow.
#[test]
fn sides_that_hang_are_overhangs_all_along() {
    let part = "max(sqrt((x - 1.7*z)^2 + y^2) - 12, max(-z, z - 6))";
    let (model, settings) = common::part(part, &asked(&[]));
    let (gcode, _) = common::slice(&model, &settings, 2);
    let (steps, text) = turns(&gcode, 2);
    for (a, b) in steps.iter().zip(&steps[1..]) {
        assert_eq!(a.1, b.0);
    }
    let mut head = Head::new(DVec3::new(110.0, 110.0, 0.0));
    let (mut hangs, mut seen) = (false, [0; 2]);
    for line in text.lines() {
        match line.strip_prefix(";TYPE:") {
            Some(role) => hangs = role == "Overhang perimeter",
            None => {
                let Some(step) = head.step(line) else {
                    continue;
                };
                let middle = 0.5 * (step.from + step.to);
                if step.fed <= 0.0 || middle.z < 0.7 || middle.z > 5.9 {
                    continue;
                }
                let axis = 1.7 * (middle.z - 3.0);
                let side = DVec2::new(middle.x - axis, middle.y);
                // A turn moves by 0.34 mm, and half of the width is 0.225.
                match (side.x / side.length()).abs() {
                    lean if lean > 0.75 => assert!(hangs, "{middle}"),
                    lean if lean < 0.55 => assert!(!hangs, "{middle}"),
                    _ => continue,
                }
                seen[usize::from(hangs)] += 1;
            }
        }
    }
    assert!(seen.iter().all(|n| *n > 200), "{seen:?}");
}

/// The flat turn at the end lies on the turn of its own layer, in thick layers, too.
#[test]
fn nothing_of_it_lies_in_the_air() {
    for height in ["layer_height=0.28", "layer_height=0.2"] {
        let part = "max(sqrt(x^2 + y^2) - 12, max(-z, z - 6))";
        let (model, settings) = common::part(part, &asked(&[height]));
        let (_, summary) = common::slice(&model, &settings, 2);
        let verdict = summary.verdict.unwrap();
        assert!(verdict.findings.is_empty(), "{:?}", verdict.findings);
    }
}

#[test]
fn it_lays_what_fills_the_wall() {
    let (steps, _) = cone(&[]);
    let laid: f64 = steps.iter().map(|s| s.2).sum();
    let laid = laid * common::filament_area(1.75);
    // From the second layer's top to the part's, by the middle line's radius.
    let section =
        (WIDTH - HEIGHT * (1.0 - std::f64::consts::FRAC_PI_4)) * HEIGHT;
    let middle = 15.0 + 0.25 * (0.4 + 6.0) - 0.5 * WIDTH;
    let meant = section * (6.0 - 0.4) / HEIGHT * std::f64::consts::TAU * middle;
    // The first turn and the last are lower than a bead that fills its share of
    // the plane, half of the height on average: their round ends are smaller.
    let ends = 2.0 / 28.0 * 0.1;
    assert!((laid / meant - 1.0).abs() < ends, "{laid} {meant}");
}

/// Each of three walls of the cone is at its depth at each point's height, and
/// the outer one has the volume that it has alone.
#[test]
fn walls_inside_climb_beside_the_outer_one() {
    let (alone, _) = cone(&[]);
    let (steps, text) = cone(&["spiral=3", "inner_wall_width=0.5"]);
    // Distances of neighbours: half of both widths, less what ends overlap.
    let overlap = HEIGHT * (1.0 - std::f64::consts::FRAC_PI_4);
    let depth =
        [0.0, 0.475 - overlap, 0.975 - 2.0 * overlap].map(|d| 0.5 * WIDTH + d);
    let mut seen = [0; 3];
    let mut worst: f64 = 0.0;
    for (from, to, _) in &steps {
        if from.z < 0.4 + HEIGHT || from.z == 6.0 {
            continue;
        }
        for i in 0..=4 {
            let p = from.lerp(*to, 0.25 * f64::from(i));
            let surface = 15.0 + 0.5 * (p.z - 0.5 * HEIGHT);
            let own = surface - p.truncate().length();
            let (wall, off) = depth
                .iter()
                .map(|d| (own - d).abs())
                .enumerate()
                .min_by(|a, b| a.1.total_cmp(&b.1))
                .unwrap();
            seen[wall] += 1;
            worst = worst.max(off);
        }
    }
    assert!(worst < 0.005 + 0.001, "{worst}");
    assert!(seen.iter().all(|n| *n > 28 * 50), "{seen:?}");
    // The outer wall is the one that it is alone.
    let outer = |s: &&Step| {
        let p = s.0.lerp(s.1, 0.5);
        let surface = 15.0 + 0.5 * (p.z - 0.5 * HEIGHT);
        (surface - p.truncate().length() - depth[0]).abs() < 0.1
    };
    let fed = |all: &[Step]| all.iter().filter(outer).map(|s| s.2).sum::<f64>();
    assert!((fed(&steps) / fed(&alone) - 1.0).abs() < 0.002);
    // The nozzle goes to the next wall 3 times a layer, and pulls nothing back.
    assert!(!text.contains("G10") && !text.contains("E-"));
    let breaks = steps.windows(2).filter(|w| w[0].1 != w[1].0).count();
    assert!(breaks <= 28 * 3 + 3, "{breaks}");
    // Between two walls the nozzle goes down by a layer, and by no more.
    for (a, b) in steps.iter().zip(&steps[1..]) {
        assert!(a.1.z - b.0.z < HEIGHT + 1e-6, "{a:?} {b:?}");
        assert!(b.1.z >= b.0.z);
    }
}

#[test]
fn walls_without_room_are_an_error_that_says_where() {
    let settings = common::settings(&asked(&["spiral=2"]));
    // A dumb-bell with a waist of 1 mm, up to 2.5 mm.
    let part = "max(min(min(sqrt((x-9)^2 + y^2), sqrt((x+9)^2 + y^2)) - 6, \
                max(abs(x) - 9, abs(y) - 0.5 - max(0, z - 2.5))), \
                max(-z, z - 4))";
    let model = common::formula(part, &settings);
    let mut out = Vec::new();
    let error =
        pipeline::slice(&model, &settings, &Options::default(), &mut out)
            .unwrap_err()
            .to_string();
    assert!(error.contains("no room for wall 2"), "{error}");
    assert!(error.contains("z = 0.30 mm (layer 2)"), "{error}");
    // In the waist, in the middle of the bed.
    let at = error.split("beside x = ").nth(1).unwrap();
    let x: f64 = at.split(',').next().unwrap().parse().unwrap();
    assert!((x - 110.0).abs() < 3.5, "{error}");
}

#[test]
fn a_high_skirt_is_refused_in_layers_of_any_height() {
    let settings = common::settings(&asked(&[
        "layer_heights=adaptive",
        "skirt.loops=1",
        "skirt.layers=9",
    ]));
    let part = "max(sqrt(x^2 + y^2) - 15 - 0.5*z, max(-z, z - 6))";
    let model = common::formula(part, &settings);
    let mut out = Vec::new();
    let error =
        pipeline::slice(&model, &settings, &Options::default(), &mut out)
            .unwrap_err()
            .to_string();
    assert!(error.contains("set skirt.layers to 2 or less"), "{error}");
}

#[test]
fn corners_stay_sharp() {
    let settings = common::settings(&asked(&[]));
    let part = "max(max(abs(x), abs(y)) - 10 + 0.3*z, max(-z, z - 6))";
    let model = common::formula(part, &settings);
    let (gcode, _) = common::slice(&model, &settings, 1);
    let (steps, _) = turns(&gcode, 2);
    let mut corners = 0;
    for (_, p, _) in steps.iter().filter(|s| s.1.z > 0.6 && s.1.z < 5.9) {
        let side = 10.0 - 0.3 * (p.z - 0.5 * HEIGHT) - 0.5 * WIDTH;
        let far = p.truncate().abs();
        assert!((far.max_element() - side).abs() < 0.003, "{p}");
        corners += usize::from((far.min_element() - side).abs() < 0.003);
    }
    assert!(corners >= 4 * 25, "{corners}");
}

#[test]
fn what_is_no_single_wall_is_an_error() {
    let settings = common::settings(&asked(&[]));
    for (part, word) in [
        (
            "max(min(sqrt((x-9)^2 + y^2), sqrt((x+9)^2 + y^2)) - 6, \
             max(-z, z - 3))",
            "2 pieces",
        ),
        (
            "max(sqrt(x^2 + y^2) - 0.1 - 2*abs(z - 1.5), max(-z, z - 3))",
            "thinner",
        ),
    ] {
        let model = common::formula(part, &settings);
        let mut out = Vec::new();
        let error =
            pipeline::slice(&model, &settings, &Options::default(), &mut out)
                .unwrap_err()
                .to_string();
        assert!(error.contains(word), "{error}");
        assert!(out.is_empty());
    }
}

#[test]
fn what_a_spiral_leaves_out_is_told() {
    let settings = common::settings(&asked(&[]));
    for (part, word) in [
        ("max(abs(sqrt(x^2 + y^2) - 9) - 2, max(-z, z - 3))", "holes"),
        ("max(sqrt(x^2 + y^2 + z^2) - 6, -z)", "so flat"),
    ] {
        let model = common::formula(part, &settings);
        let (_, summary) = common::slice(&model, &settings, 1);
        let told = summary.warnings.join("\n");
        assert!(told.contains(word), "{told}");
    }
}

/// Parts with inner corners, and such whose wall moves along itself from layer to
/// layer.
#[test]
fn it_never_folds_back() {
    let bodies = [
        // An L, a plus that twists, and flutes as steep as threads.
        "max(max(abs(x) - 8, abs(y) - 8), -max(x, y))",
        "min(max(abs(x*cos(z/6) + y*sin(z/6)) - 9, abs(y*cos(z/6) - x*sin(z/6)) - 3), \
         max(abs(x*cos(z/6) + y*sin(z/6)) - 3, abs(y*cos(z/6) - x*sin(z/6)) - 9))",
        "sqrt(x^2 + y^2) - 12 - 0.8*sin(20*(atan2(y, x) + z/12))",
        // A notch that moves by 0.3 mm a layer.
        "max(max(abs(x), abs(y)) - 9, 2 - max(abs(x - 1.5*(z - 2)), 5 - y))",
    ];
    for body in bodies {
        let part = format!("max({body}, max(-z, z - 4))");
        let (model, settings) = common::part(&part, &asked(&[]));
        let (gcode, _) = common::slice(&model, &settings, 2);
        let (steps, _) = turns(&gcode, 2);
        let level = |s: &Step| (s.1 - s.0).truncate();
        let long: Vec<&Step> =
            steps.iter().filter(|s| level(s).length() > 0.01).collect();
        for pair in long.windows(2) {
            let [a, b] = [level(pair[0]), level(pair[1])];
            // The part's own corners turn by 90°.
            let turn = a.angle_to(b).abs().to_degrees();
            assert!(turn < 110.0, "{body}: {turn} at {}", pair[1].0);
        }
        // The wall is as long as the walls of flat layers.
        let flat = asked(&["spiral=false", "walls=1", "infill_density=0"]);
        let flat = [&flat[..], &["bottom_layers=0", "top_layers=0"]].concat();
        let (model, settings) = common::part(&part, &flat);
        let (gcode, _) = common::slice(&model, &settings, 2);
        let (walls, _) = turns(&gcode, 2);
        let length = |all: &[Step]| all.iter().map(|s| level(s).length()).sum();
        // The first of them is the last one of the vase, too.
        let (climb, flat): (f64, f64) = (length(&steps), length(&walls));
        let share = climb / (flat * 19.0 / 18.0) - 1.0;
        assert!(share.abs() < 0.02, "{body}: {share}");
    }
}
