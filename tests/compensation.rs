//! Compensations, brims and skirts in the G-code, against the radii of a tube.

#![allow(clippy::unwrap_used, reason = "helpers of tests may unwrap, too")]

mod common;

use common::{Kind, Layer, formula, parse, settings, slice};
use glam::DVec2;
use isoslice::model::{
    BuildVolume, PlaceError, Placement, Source, SourceKind, load, place,
};

/// A tube of 20 and 10 mm radius, 2 mm high.
const TUBE: &str = "max(max(sqrt(x^2+y^2) - 20, 10 - sqrt(x^2+y^2)), \
                    abs(z - 1) - 1)";

fn layers(assignments: &[&str]) -> Vec<Layer> {
    let settings = settings(assignments);
    parse(&slice(&formula(TUBE, &settings), &settings, 2).0)
}

/// Least and greatest distance from the middle of the bed of what a role
/// prints inside and outside the radius 15.
fn radii(layer: &Layer, role: &str) -> [f64; 4] {
    let mut found = [f64::INFINITY, 0.0, f64::INFINITY, 0.0];
    for m in layer.moves.iter().filter(|m| m.role == role) {
        if m.kind != Kind::Print {
            continue;
        }
        let (a, b) = m.ends();
        for p in [a, b] {
            let r = p.distance(DVec2::splat(110.0));
            let side = if r < 15.0 { 0 } else { 2 };
            found[side] = found[side].min(r);
            found[side + 1] = found[side + 1].max(r);
        }
    }
    found
}

fn close(got: [f64; 4], [inner, outer]: [f64; 2]) {
    let exact = [inner, inner, outer, outer];
    for (got, exact) in got.into_iter().zip(exact) {
        // What the G-code resolves, and the accuracy.
        assert!((got - exact).abs() < 0.006, "{got} is not {exact}");
    }
}

#[test]
fn walls_lie_where_the_compensation_puts_them() {
    let wall = 0.225;
    for layer in layers(&[]) {
        close(
            radii(&layer, "External perimeter"),
            [10.0 + wall, 20.0 - wall],
        );
    }
    for by in [0.15, -0.1] {
        let assignment = format!("xy_compensation={by}");
        for layer in layers(&[&assignment]) {
            close(
                radii(&layer, "External perimeter"),
                [10.0 + wall - by, 20.0 - wall + by],
            );
        }
    }
    let drawn = layers(&["elephant_foot=0.2", "elephant_foot_layers=2"]);
    for (layer, by) in drawn.iter().zip([0.2, 0.1, 0.0, 0.0]) {
        close(
            radii(layer, "External perimeter"),
            [10.0 + wall + by, 20.0 - wall - by],
        );
    }
}

#[test]
fn a_brim_lies_beside_the_first_layer_only() {
    let all = ["brim.place=both", "brim.gap=0.2", "brim.width=3"];
    let printed = layers(&[&all[..], &["skirt.loops=0"]].concat());
    let [_, nearest_inside, nearest_outside, widest] =
        radii(&printed[0], "Skirt/Brim");
    assert!((nearest_inside - (10.0 - 0.2 - 0.225)).abs() < 0.02);
    assert!((nearest_outside - (20.0 + 0.2 + 0.225)).abs() < 0.02);
    assert!((widest - (20.0 + 3.2)).abs() < 0.45);
    for layer in &printed[1..] {
        assert_eq!(layer.length("Skirt/Brim"), 0.0);
    }
}

#[test]
fn nothing_hangs_over_the_elephants_foot() {
    // The next layer sticks out by more than half a line.
    let printed = layers(&["elephant_foot=0.3", "elephant_foot_layers=1"]);
    for layer in &printed {
        assert_eq!(layer.length("Overhang perimeter"), 0.0);
    }
}

#[test]
fn a_skirt_of_several_layers_stands_on_itself() {
    // A cone that stands on its tip's end: each layer is wider.
    let settings = settings(&["skirt.layers=4", "skirt.distance=4"]);
    let cone = "max(sqrt(x^2+y^2) - 10 - 2*z, abs(z - 1) - 1)";
    let printed = parse(&slice(&formula(cone, &settings), &settings, 2).0);
    let skirt = |layer: &Layer| radii(layer, "Skirt/Brim");
    // Round the widest of the layers beside it, that from 0.6 to 0.8 mm.
    let exact = 10.0 + 2.0 * 0.7 + 4.0 + 0.225;
    for layer in &printed[..4] {
        let [_, _, least, most] = skirt(layer);
        assert!((least - exact).abs() < 0.02, "{least} {exact}");
        assert!((most - exact).abs() < 0.02, "{most} {exact}");
    }
    assert_eq!(printed[4].length("Skirt/Brim"), 0.0);
}

/// What outlines grow by needs room on the bed, and is part of what hosts and
/// templates are told.
#[test]
fn what_is_added_to_the_part_has_to_fit_the_bed() {
    const PLATE: &str = "max(max(abs(x) - 109.8, abs(y) - 5), abs(z) - 0.4)";
    let grown = |assignment: &str| {
        let s = settings(&[
            assignment,
            "skirt.loops=0",
            "sample_spacing=0.5",
            "infill_density=0",
            "gcode.flavour=klipper",
            "gcode.start=; {{ part_min_x }} {{ part_max_x }}",
        ]);
        let source = Source::Text {
            name: "plate".into(),
            kind: SourceKind::Formula,
            text: PLATE.into(),
        };
        let placement = Placement {
            margin: s.reach(),
            ..Placement::default()
        };
        let bed = BuildVolume {
            x: s.printer.bed_x,
            y: s.printer.bed_y,
            z: s.printer.height,
        };
        let model = place(&load(&source, &[]).unwrap(), &placement, bed);
        (model, s)
    };
    for too_much in ["xy_compensation=0.25", "fuzzy.thickness=0.25"] {
        let (model, _) = grown(too_much);
        let error = model.err().unwrap();
        assert!(matches!(error, PlaceError::TooLarge { .. }), "{error}");
        assert!(error.to_string().contains("0.10 mm too wide"), "{error}");
    }
    for (fits, reach) in [
        ("xy_compensation=0.15", 0.15),
        ("xy_compensation=-0.15", 0.0),
        ("fuzzy.thickness=0.15", 0.15),
    ] {
        let (model, s) = grown(fits);
        let (gcode, _) = slice(&model.unwrap(), &s, 2);
        let written = |x: f64| (x * 100.0).round() / 100.0;
        let ends = [0.2 - reach, 219.8 + reach].map(written);
        let ends = format!("; {} {}", ends[0], ends[1]);
        assert!(gcode.contains(&ends), "{fits}: no {ends}");
        let polygon = gcode.split("POLYGON=").nth(1).unwrap();
        let ring: Vec<[f64; 2]> =
            serde_json::from_str(polygon.lines().next().unwrap()).unwrap();
        let x = ring.iter().map(|p| p[0]);
        let (least, greatest) =
            (x.clone().fold(300.0, f64::min), x.fold(0.0, f64::max));
        assert!((least - 0.2 + reach).abs() < 0.03, "{fits}: {least}");
        assert!(
            (greatest - 219.8 - reach).abs() < 0.03,
            "{fits}: {greatest}"
        );
        for m in parse(&gcode).iter().flat_map(|l| l.prints()) {
            for end in [m.from, m.to] {
                let half = 0.5 * m.width;
                assert!(end.x >= half - 1e-3, "{fits}: {end}");
                assert!(end.x <= 220.0 - half + 1e-3, "{fits}: {end}");
            }
        }
    }
}
