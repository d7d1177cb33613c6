//! Good prints pass the check, whatever their comments tell of layers, roles and
//! heights.

use crate::common::{settings, wanted};
use isoslice::layers::LayerRange;
use isoslice::pipeline::{Options, slice_plate};
use isoslice::plate::Plate;

/// A table with two legs, whose supports are large.
const TABLE: &str = "min(max(sqrt((abs(x) - 10)^2 + y^2) - 3, max(-z, z - 3)), \
     max(max(abs(x), abs(y)) - 14, max(2 - z, z - 3)))";

const ONE_BY_ONE: [&str; 3] = [
    "plate.sequence=one-by-one",
    "printer.head_clearance_radius=40",
    "printer.gantry_height=20",
];

/// The G-code of a formula with these settings passes the check that each slice makes.
fn passes(formula: &str, own: &[&str]) {
    let settings = settings(own);
    let model = crate::common::formula(formula, &settings);
    let options = Options::default();
    let out = &mut Vec::new();
    let sliced = isoslice::pipeline::slice(&model, &settings, &options, out);
    assert!(sliced.is_ok(), "{formula} {own:?}: {sliced:?}");
}

/// Slices tables with each kind of comments and the heights of layers at which
/// supports, which have heights of their own, lie just above or below the part's.
fn all_pass(copies: u64, layers: &str, more: &[&str]) {
    for comments in ["prusa", "orca", "bambu", "cura", "none"] {
        for height in ["0.12", "0.15", "0.25"] {
            let own = [
                &format!("gcode.comments={comments}"),
                &format!("layer_height={height}"),
                "sample_spacing=0.225",
                "accuracy=0.02",
            ];
            let settings = settings(&[&own[..], more].concat());
            let all = [wanted("table", TABLE, copies, &settings)];
            let plate = Plate::new("plate", &all, &settings).unwrap();
            let options = Options {
                layers: layers.parse::<LayerRange>().unwrap(),
                ..Options::default()
            };
            let sliced = slice_plate(&plate, &options, &mut Vec::new());
            assert!(sliced.is_ok(), "{comments} {height}: {sliced:?}");
        }
    }
}

#[test]
fn supports_lie_between_the_layers_of_the_part() {
    all_pass(1, "1..", &["supports=auto"]);
}

#[test]
fn supports_lie_between_the_layers_of_parts_one_by_one() {
    all_pass(2, "1..", &[&ONE_BY_ONE[..], &["supports=auto"]].concat());
}

#[test]
fn parts_one_by_one_begin_on_their_rafts() {
    for more in [&["raft.layers=2"][..], &["raft.layers=2", "supports=auto"]] {
        all_pass(2, "1..", &[&ONE_BY_ONE[..], more].concat());
    }
}

#[test]
fn ranges_begin_on_what_is_printed() {
    all_pass(1, "8..12", &[]);
    all_pass(1, "8..12", &["supports=auto"]);
}

/// A formula whose top lies between layers, and the settings that lead beads there.
const RISING: [(&str, &[&str]); 4] = [
    // A level top half a layer above the last one: 1.5 times the plastic.
    (
        "max(max(abs(y) - 0.45, abs(x) - 8), max(-z, z - 0.575))",
        &["layer_height=0.25", "first_layer_height=0.2"],
    ),
    // The two ends of a scarf have half as much again.
    (
        "max(hypot(x, y) - 2.45, max(-z, z - 0.9))",
        &["first_layer_height=0.2", "seam_scarf=8"],
    ),
    // The first layer rises out of itself, under the edge of the next one.
    (
        "max(abs(hypot(x, y) - 6) - 3, max(-z, z - 0.65 - 0.04*x))",
        &[
            "layer_height=0.3",
            "first_layer_height=0.2",
            "infill_density=0",
        ],
    ),
    // What irons follows the surface as well.
    (
        "max(abs(hypot(x, y) - 6) - 3, max(-z, z - 1.225 - 0.002*x))",
        &["layer_height=0.35", "ironing=true"],
    ),
];

#[test]
fn beads_that_rise_have_more_plastic_than_others() {
    for comments in ["prusa", "cura", "none"] {
        for (formula, own) in RISING {
            let more = [&format!("gcode.comments={comments}"), "contour_z=100"];
            passes(formula, &[own, &more].concat());
        }
    }
}

/// Foams print with little flow, and files with Cura's words do not say how wide
/// beads are.
#[test]
fn any_plastic_passes_with_any_comments() {
    let wheel = "max(hypot(x, y) - 7 - 0.5*sin(9*atan2(y, x)), abs(z - 1) - 1)";
    for comments in ["prusa", "cura", "none"] {
        for plastic in [
            "flow=10",
            "flow=45",
            "flow=65",
            "flow=200",
            "bead_width=50",
            "bead_width=180",
            "bead_width=expr: 50 + 130*step(x, 0)",
            "bead_width=expr: 60 + 60*step(1, z)",
            "flow=expr: 100 + 80*step(1, z)",
        ] {
            let own = [
                &format!("gcode.comments={comments}"),
                plastic,
                "accuracy=0.02",
            ];
            passes(wheel, &own);
        }
    }
}

/// What settings ask for is no fault: ends of scarfs with much plastic, and filament
/// that is missing at the beginning of each of many short beads.
#[test]
fn legal_settings_pass() {
    let many = "max(max(sin(2*x), sin(2*y)) - 0.1, max(max(abs(x), abs(y)) - 6, \
                abs(z - 1) - 1))";
    let ball = "sqrt(x^2 + y^2 + z^2) - 4";
    let disc = "max(hypot(x, y) - 8, abs(z - 1) - 1)";
    let stepped = "min(max(hypot(x, y) - 6, abs(z - 1.1) - 0.85), \
                   max(hypot(x, y) - 5.6, abs(z - 0.5) - 0.5))";
    for (formula, own) in [
        (
            many,
            &["retract.extra_prime=-0.3", "retract.min_travel=0"][..],
        ),
        (ball, &["flow=150", "seam_scarf=10"][..]),
        // The halves of a scarf of a wide wall have more than one bead of the nozzle's
        // width.
        (disc, &["outer_wall_width=1", "seam_scarf=10"][..]),
        (
            disc,
            &["outer_wall_width=0.65", "seam_scarf=10 mm from 10%"][..],
        ),
        // The first turn of a vase rises by much less than the flat layer is high.
        (
            stepped,
            &[
                "spiral=true",
                "layer_heights=adaptive",
                "bottom_layers=0",
                "gcode.comments=cura",
            ][..],
        ),
    ] {
        passes(formula, own);
    }
}

/// Files without comments do not say which layer a bead belongs to that rises.
#[test]
fn beads_that_rise_are_no_fault_in_files_without_comments() {
    let pins = "min(max(max(abs(x), abs(y)) - 4.2, abs(z - 0.3) - 0.3), \
                min(max(hypot(x + 1.2, y + 2.8) - 1.1, abs(z - 1) - 1), \
                max(hypot(x - 2.2, y + 0.2) - 1.2, abs(z - 0.8) - 0.8)))";
    let pockets = "max(max(max(max(max(abs(x), abs(y)) - 7.998, abs(z - 1) - 1), \
                   -max(abs(x + 3.865) - 3.784, abs(z - 1.182) - 0.7656)), \
                   -max(max(abs(x - 5.945) - 3.992, abs(y - 4.793) - 3.943), \
                   abs(z - 1.419) - 1.107)), \
                   -max(abs(x - 2.274) - 3.043, abs(y + 4.321) - 1.837))";
    let scarf: &[&str] = &[
        "layer_height=0.18",
        "infill_density=0",
        "top_walls=1",
        "seam_scarf=20 mm from 0%",
    ];
    for (formula, own) in [(pockets, &["contour_z=100"][..]), (pins, scarf)] {
        let settings = settings(&[own, &["gcode.comments=none"]].concat());
        let model = crate::common::formula(formula, &settings);
        let out = &mut Vec::new();
        let sliced = isoslice::pipeline::slice(
            &model,
            &settings,
            &Options::default(),
            out,
        );
        let warnings = sliced.unwrap().warnings;
        let of_check = |w: &&String| w.contains("is laid into");
        assert_eq!(warnings.iter().filter(of_check).count(), 0, "{warnings:?}");
    }
}

/// A fin on a plate: one that is thinner than the thinnest bead gets that, and one that
/// gets none is told of.
#[test]
fn a_fin_is_printed_or_told_of() {
    let fin = |thickness: f64| {
        let half = 0.5 * thickness;
        let part = format!(
            "min(max(max(abs(x) - 8, abs(y) - 5), abs(z - 1) - 1), \
             max(max(abs(x) - 6, abs(y) - {half}), abs(z - 3) - 3))"
        );
        let own = settings(&["layer_height=0.2", "first_layer_height=0.2"]);
        let model = crate::common::formula(&part, &own);
        let (_, summary) = crate::common::slice(&model, &own, 2);
        let told = |w: &String| w.contains("the highest 4.0 mm of the part");
        (summary.layer_count, summary.warnings.iter().any(told))
    };
    for thickness in [0.14, 0.2, 0.26, 0.4] {
        assert_eq!(fin(thickness), (30, false), "{thickness}");
    }
    assert_eq!(fin(0.1), (10, true));
}

/// Skin begins behind a wall that hangs over, scarfs are of wide beads, and a bar stands
/// on its edge.
#[test]
fn layers_unlike_those_below_them_pass() {
    let waves = "max(max(sqrt(x^2 + y^2) - 15 - 5*sin(z/12) - 0.5*sin(z*2), -z), z - 6)";
    passes(waves, &["walls=1", "infill_density=0"]);
    let block = "max(max(abs(x) - 8, abs(y) - 8), abs(z - 2) - 2)";
    passes(
        block,
        &["seam_scarf=20", "layer_height=0.3", "bead_width=180"],
    );
    for slope in [0.7, 1.0, 1.3, 1.5] {
        passes(
            &format!("max(max(abs(x) - 10, abs(y) - z*{slope}), z - 6)"),
            &[],
        );
    }
}
