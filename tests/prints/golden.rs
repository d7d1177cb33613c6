//! What comes out, as snapshots: tables of layers, and a little G-code.
//!
//! The tables say what a print means rather than how it is written, and are
//! rounded so that no machine's last digit shows. When they change, look at a
//! picture of the layer before you accept the change (CONTRIBUTING.md).

use crate::common;
use crate::common::{ROLES, formula, layers, parse, settings, slice};
use isocontour::Outline;
use isoslice::model::{Placement, SourceKind};
use isoslice::pipeline::Summary;
use std::fmt::Write;

/// One line for each layer: what its outline is, and what is printed there.
fn table((gcode, summary): &(String, Summary), outlines: &[Outline]) -> String {
    assert_eq!(summary.warnings, [""; 0]);
    let printed = parse(gcode);
    assert_eq!(printed.len(), outlines.len());
    let mut table = String::new();
    for (layer, outline) in printed.iter().zip(outlines) {
        let islands = outline.area.islands().len();
        let holes = outline.area.rings.len() - islands;
        let area = outline.area.content();
        write!(
            table,
            "z {:.2}: {islands} islands, {holes} holes, {area:.1} mm²",
            layer.z
        )
        .unwrap();
        for role in ROLES {
            let length = layer.length(role);
            if length > 0.0 {
                write!(table, "; {role} {length:.1}").unwrap();
            }
        }
        table.push('\n');
    }
    table
}

macro_rules! assert_table {
    ($model:expr, $settings:expr) => {
        insta::with_settings!({ omit_expression => true }, {
            let (_, outlines) = layers($model, $settings);
            insta::assert_snapshot!(table(&slice($model, $settings, 2), &outlines));
        });
    };
}

#[test]
fn ball() {
    let settings = settings(&[
        // With more walls nothing would be left for the skin.
        "walls=1",
        "layer_height=1",
        "first_layer_height=1",
        "top_layers=0.8 mm",
        "bottom_layers=0.6 mm",
        "printer.nozzle_diameter=1.4",
        "outer_wall_width=1.5",
        "inner_wall_width=1.5",
        "skin_width=1.5",
        "infill_width=1.5",
    ]);
    let model = formula("sqrt(x^2 + y^2 + z^2) - 10", &settings);
    assert_table!(&model, &settings);
}

/// Skin where a step ends, sparse infill under the next one, and a tunnel
/// thinner than the skin, whose floor and ceiling need skin as well.
const STAIRS: &str = "
    fn block(x0, x1, z1) {
        (x0 - x).max(x - x1).max(abs(y) - 8.0).max(-z).max(z - z1)
    }
    let stairs = block(0.0, 30.0, 2.0)
        .min(block(10.0, 30.0, 4.0))
        .min(block(20.0, 30.0, 6.0));
    let tunnel = (abs(y) - 3.0).max(abs(z - 3.0) - 0.2);
    stairs.max(-tunnel)
";

#[test]
fn stairs() {
    let settings = settings(&["infill=grid", "infill_density=20%"]);
    let placement = Placement::default();
    let model =
        common::model(SourceKind::Script, STAIRS, &[], &placement, &settings);
    assert_table!(&model, &settings);
}

const PLATE: &str = "max(max(max(abs(x) - 15, abs(y) - 10), abs(z) - 0.6), \
                     5 - min(sqrt((x - 8)^2 + y^2) + 1.5, \
                     sqrt((x + 7)^2 + y^2)))";

#[test]
fn plate_with_holes() {
    let settings = settings(&[]);
    assert_table!(&formula(PLATE, &settings), &settings);
}

/// The G-code without what changes with every release.
fn lasting((text, _): &(String, Summary)) -> String {
    text.replacen(env!("CARGO_PKG_VERSION"), "[version]", 1)
}

#[test]
fn both_ends_of_a_file() {
    let settings =
        settings(&["gcode.flavour=klipper", "gcode.relative_e=true"]);
    let text = lasting(&slice(&formula(PLATE, &settings), &settings, 2));
    let lines: Vec<&str> = text.lines().collect();
    let (first, last) = (&lines[..40], &lines[lines.len() - 40..]);
    insta::with_settings!({ omit_expression => true }, {
        insta::assert_snapshot!(format!(
            "{}\n…\n{}\n",
            first.join("\n"),
            last.join("\n")
        ));
    });
}

#[test]
fn all_of_a_tiny_cube() {
    let settings = settings(&["layer_height=0.25", "skirt.loops=0"]);
    let model = formula("max(max(abs(x), abs(y)), abs(z)) - 2.5", &settings);
    let text = lasting(&slice(&model, &settings, 2));
    assert!(text.len() < 40_000, "{}", text.len());
    insta::with_settings!({ omit_expression => true }, {
        insta::assert_snapshot!(text);
    });
}
