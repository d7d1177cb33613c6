//! Bodies that share a face are printed as one, and fields that are zero outside
//! end where they are negative.

use crate::common::{OUTER_WALL, formula, parse, settings, slice};
use glam::DVec2;

const COARSE: &[&str] = &["skirt.loops=0"];

/// Filament in a print of a formula, mm.
fn filament(text: &str, assignments: &[&str]) -> f64 {
    let settings = settings(&[COARSE, assignments].concat());
    let (_, summary) = slice(&formula(text, &settings), &settings, 2);
    assert_eq!(summary.warnings, [""; 0], "{text}");
    summary.filament_length
}

/// `f`, and its parts on both sides of the plane in which `plane` is zero.
fn cut(f: &str, plane: &str) -> String {
    format!("min(max({f}, {plane}), max({f}, -({plane})))")
}

/// The heights are in the middle of a layer and on a layer's border.
#[test]
fn a_body_that_is_cut_in_two_is_printed_as_one() {
    let block = "max(max(abs(x) - 6, abs(y) - 5), abs(z - 3) - 3)";
    for more in [
        &["layer_heights=uniform"][..],
        &["layer_heights=adaptive"],
        &["contour_z=100"],
    ] {
        let whole = filament(block, more);
        for plane in ["z - 4.5", "z - 3.3", "z - 2.4", "x - 1.37", "y + x"] {
            let cut = filament(&cut(block, plane), more);
            let off = (cut / whole - 1.0).abs();
            assert!(off < 0.002, "{more:?} {plane}: {cut} for {whole}");
        }
    }
}

/// A tower on a foot whose top is in the middle of a layer. That layer is the
/// foot's.
#[test]
fn what_stands_on_a_level_face_begins_in_its_layer() {
    let prism = |half: f64, low: f64, high: f64| {
        format!("max(max(abs(x), abs(y)) - {half}, max({low} - z, z - {high}))")
    };
    for height in [1.5, 2.3, 4.1] {
        let tower = |low: f64, high: f64| {
            let (foot, tower) = (prism(8.0, 0.0, low), prism(5.0, high, 6.0));
            filament(&format!("min({foot}, {tower})"), &[])
        };
        let shared = tower(height, height);
        let overlapping = tower(height + 0.07, height - 0.07);
        let off = (shared / overlapping - 1.0).abs();
        assert!(off < 0.002, "{height}: {shared} for {overlapping}");
    }
}

#[test]
fn walls_of_a_field_that_is_zero_outside_follow_what_is_negative() {
    let settings = settings(COARSE);
    let disc = "max(min(sqrt(x^2 + y^2) - 5.03, 0), \
                max(max(abs(x), abs(y)) - 8, abs(z) - 0.5))";
    let model = formula(disc, &settings);
    let (text, _) = slice(&model, &settings, 2);
    let mut seen = 0;
    for layer in parse(&text) {
        for m in layer.prints().filter(|m| m.role == OUTER_WALL) {
            let (a, b) = m.ends();
            let middle = 0.5 * (a + b) - model.offset.truncate();
            let off = middle.length() - (5.03 - 0.5 * m.width);
            assert!(off.abs() < 0.007, "{middle}: {off}");
            seen += 1;
        }
        let centre: DVec2 = model.offset.truncate();
        let reach = |p: DVec2| p.distance(centre);
        let most = layer.prints().map(|m| reach(m.ends().1));
        assert!(most.fold(0.0, f64::max) < 5.03);
    }
    assert!(seen > 100);
}
