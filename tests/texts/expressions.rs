//! Expressions of settings, from the settings' text to the G-code.

use crate::common::{
    Layer, Move, MoveKind, OUTER_WALL, formula, parse, settings, slice,
};

/// A ball of 12 mm, lowest point at z = 0 of the bed but not of the model.
const BALL: &str = "sqrt(x^2 + y^2 + z^2) - 6";

fn print(assignments: &[&str]) -> Vec<Layer> {
    let mut all = vec![
        "cooling.min_layer_time=0",
        "speed.first_layer=2000",
        "speed.small_wall_length=0",
        "printer.max_moves_per_second=100000",
    ];
    all.extend(assignments);
    let settings = settings(&all);
    let (text, _) = slice(&formula(BALL, &settings), &settings, 2);
    parse(&text)
}

fn outer_walls(layers: &[Layer]) -> impl Iterator<Item = (&Layer, &Move)> {
    layers.iter().flat_map(|l| {
        l.prints()
            .filter(|m| m.role == OUTER_WALL)
            .map(move |m| (l, m))
    })
}

#[test]
fn a_speed_follows_the_height_above_the_bed() {
    let layers = print(&["speed.outer_wall=expr: 20 + 2*z"]);
    let mut count = 0;
    for (layer, m) in outer_walls(&layers) {
        let wanted = 60.0 * (20.0 + 2.0 * layer.z);
        assert!((m.feed / wanted - 1.0).abs() < 1e-3, "{m:?} {wanted}");
        count += 1;
    }
    assert!(count > 1000);
}

#[test]
fn a_speed_that_differs_along_a_wall_does_not_cut_it() {
    let plain = print(&[]);
    let layers = print(&["speed.outer_wall=expr: 30 + 3*x"]);
    // Moves that do not print do not change.
    let travels = |layers: &[Layer]| -> Vec<usize> {
        let of = |l: &Layer| {
            l.moves
                .iter()
                .filter(|m| m.kind == MoveKind::Travel)
                .count()
        };
        layers.iter().map(of).collect()
    };
    assert_eq!(travels(&plain), travels(&layers));
    for (_, m) in outer_walls(&layers) {
        // The bed's middle is the model's origin.
        let x = 0.5 * (m.from.x + m.to.x) - 110.0;
        let wanted = 30.0 + 3.0 * x;
        // The speed is asked for every millimetre, and told within a per cent.
        assert!(
            (m.feed / 60.0 - wanted).abs() < 1.6 + 0.01 * wanted,
            "{m:?}"
        );
    }
    let length = |layers: &[Layer]| -> f64 {
        outer_walls(layers)
            .map(|(_, m)| m.from.distance(m.to))
            .sum()
    };
    let (a, b) = (length(&plain), length(&layers));
    assert!((a / b - 1.0).abs() < 1e-4, "{a} {b}");
}

#[test]
fn flow_by_depth_thins_what_is_near_the_surface() {
    let fed = |flow: &str| -> (f64, f64) {
        let layers = print(&[flow]);
        let sum = |role: bool| -> f64 {
            let moves = layers.iter().flat_map(|l| l.prints());
            moves
                .filter(|m| (m.role == OUTER_WALL) == role)
                .map(|m| m.fed)
                .sum()
        };
        (sum(true), sum(false))
    };
    let plain = fed("flow=100");
    // The outer wall's centre is 0.225 mm deep at most, all else deeper.
    let thin = fed("flow=expr: 100 - 50*(compare(0.3, d) + 1)/2");
    assert!((thin.0 / plain.0 - 0.5).abs() < 0.02, "{plain:?} {thin:?}");
    assert!(thin.1 / plain.1 > 0.7, "{plain:?} {thin:?}");
}

#[test]
fn the_nozzle_cools_as_the_print_grows() {
    let settings = settings(&["filament.nozzle_temperature=expr: 220 - z"]);
    let (text, _) = slice(&formula(BALL, &settings), &settings, 1);
    let mut z = 0.0;
    let mut told = Vec::new();
    for line in text.lines() {
        if let Some(height) = line.strip_prefix(";Z:") {
            z = height.parse::<f64>().unwrap();
        }
        if let Some(t) = line.strip_prefix("M104 S")
            && z > 0.25
        {
            let t: f64 = t.split(' ').next().unwrap().parse().unwrap();
            if t > 0.0 {
                assert!((t - (220.0 - z)).abs() <= 0.5, "{z} {t}");
                told.push(t);
            }
        }
    }
    // The temperatures go from 220 to 208, a degree at a time, each once.
    assert_eq!(told.len(), 13, "{told:?}");
}

#[test]
fn a_fan_that_varies_is_never_off_between_layers() {
    let settings = settings(&["cooling.fan_speed=expr: 50 + 2*z"]);
    let (text, _) = slice(&formula(BALL, &settings), &settings, 1);
    let body = text.split(";LAYER_CHANGE").skip(3);
    let layers: Vec<&str> = body.collect();
    for layer in &layers[..layers.len() - 1] {
        assert!(!layer.contains("M107"), "{layer}");
    }
    // The fan is set once a layer, but for bridges and overhangs.
    let told = text.matches("M106").count();
    assert!(told >= layers.len() && told < 3 * layers.len(), "{told}");
}

#[test]
fn limits_hold_and_what_has_no_value_is_an_error() {
    let fast =
        print(&["speed.outer_wall=expr: 1e6*z", "filament.max_flow=500"]);
    let greatest = outer_walls(&fast).map(|(_, m)| m.feed).fold(0.0, f64::max);
    assert!(greatest <= 60.0 * 2000.0, "{greatest}");
    let error = |assignment: &str| {
        let settings = settings(&[assignment]);
        let model = formula(BALL, &settings);
        let options = isoslice::pipeline::Options {
            threads: Some(1),
            ..isoslice::pipeline::Options::default()
        };
        let done = isoslice::pipeline::slice(
            &model,
            &settings,
            &options,
            &mut Vec::new(),
        );
        done.unwrap_err().to_string()
    };
    let e = error("speed.outer_wall=expr: sqrt(x)");
    assert!(e.contains("speed.outer_wall") && e.contains("x = -"), "{e}");
    let e = error("cooling.fan_speed=expr: 10 + speed");
    assert!(
        e.contains("cooling.fan_speed") && e.contains("column 6"),
        "{e}"
    );
    let e = error("filament.nozzle_temperature=expr: 200 + x");
    assert!(e.contains("z only"), "{e}");
}

#[test]
fn fuzzy_walls_stay_within_their_thickness_and_grow_with_it() {
    // Walls are smooth at the bed, and off by up to 0.4 mm at the top.
    let layers = print(&["fuzzy.thickness=expr: 0.4*z/12"]);
    let plain = print(&[]);
    let off = |layers: &[Layer], from: f64, to: f64| -> f64 {
        outer_walls(layers)
            .filter(|(l, _)| (from..to).contains(&l.z))
            .map(|(l, m)| {
                let middle = l.z - 0.5 * l.height - 6.0;
                let r = (36.0 - middle * middle).sqrt() - 0.225;
                let p = m.from.truncate() - glam::DVec2::splat(110.0);
                (p.length() - r).abs()
            })
            .fold(0.0, f64::max)
    };
    assert!(off(&plain, 1.0, 11.0) < 0.006);
    let (low, high) = (off(&layers, 1.0, 2.0), off(&layers, 9.0, 11.0));
    assert!((0.02..0.08).contains(&low), "{low}");
    assert!((0.2..0.4).contains(&high), "{high}");
    // The texture depends on the place, so it never changes.
    let again = print(&["fuzzy.thickness=expr: 0.4*z/12"]);
    assert_eq!(off(&again, 0.0, 12.0), off(&layers, 0.0, 12.0));
}

/// Rings of a ball of infill lie on nothing as long as the ball grows.
#[test]
fn beads_of_infill_that_lie_on_nothing_are_left_out_and_counted() {
    const BLOCK: &str = "max(max(abs(x) - 10, abs(y) - 10), abs(z - 10) - 10)";
    let count = |bridges: bool, threads: usize| {
        let settings = settings(&[
            "infill=expr: sqrt(x^2 + y^2 + (z - 10)^2) - 4",
            &format!("internal_bridges={bridges}"),
        ]);
        let model = formula(BLOCK, &settings);
        let (gcode, summary) = slice(&model, &settings, threads);
        let found: Vec<usize> = summary
            .warnings
            .iter()
            .filter_map(|w| w.split_once("are left out: ")?.1.parse().ok())
            .collect();
        let rings = parse(&gcode)
            .into_iter()
            .filter(|layer| layer.length("Internal infill") > 0.0);
        (found, rings.count())
    };
    // The ball has 40 layers, and none of its rings lies on another.
    assert_eq!(count(false, 2), (vec![40], 0));
    assert_eq!(count(true, 1), (vec![40], 0));
}
