//! Compensations, brims and skirts in the G-code, against the radii of a tube.

use crate::common::{
    Layer, MoveKind, formula, parse, settings, slice, slice_layers,
};
use glam::DVec2;
use isoslice::model::{
    BuildVolume, PlaceError, Placement, Source, load, place,
};
use isoslice::pipeline::{self, Options};

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
        if m.kind != MoveKind::Print {
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
        // The slack is what the G-code resolves, and the accuracy.
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
    let drawn = layers(&["elephant_foot=0.2 over 2"]);
    for (layer, by) in drawn.iter().zip([0.2, 0.1, 0.0, 0.0]) {
        close(
            radii(layer, "External perimeter"),
            [10.0 + wall + by, 20.0 - wall - by],
        );
    }
}

/// The tube's hole becomes wider by 1 mm² over its radius, and its outside
/// moves by what the formula says of z.
#[test]
fn a_formula_moves_each_outline_by_its_curvature() {
    let wall = 0.225;
    let by = "expr: 1*min(curvature, 0) + 0.1*min(max(curvature*20, 0), 1)*z/2";
    let assignment = format!("xy_compensation={by}");
    let printed = layers(&[&assignment]);
    assert!(printed.len() > 5);
    for layer in printed {
        let middle = layer.z - 0.5 * layer.height;
        let [least, most, narrow, wide] = radii(&layer, "External perimeter");
        // The curvature of a polygon is good to a few per cent.
        for r in [least, most] {
            assert!((r - (10.0 + wall + 0.1)).abs() < 0.01, "{r}");
        }
        for r in [narrow, wide] {
            let exact = 20.0 - wall + 0.05 * middle;
            assert!((r - exact).abs() < 0.012, "{r} {exact}");
        }
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
    let printed = layers(&["elephant_foot=0.3"]);
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
    // The skirt goes round the widest of the layers beside it, from 0.6 to 0.8
    // mm.
    let exact = 10.0 + 2.0 * 0.7 + 4.0 + 0.225;
    for layer in &printed[..4] {
        let [_, _, least, most] = skirt(layer);
        assert!((least - exact).abs() < 0.02, "{least} {exact}");
        assert!((most - exact).abs() < 0.02, "{most} {exact}");
    }
    assert_eq!(printed[4].length("Skirt/Brim"), 0.0);
}

/// Two bodies of 10 × 8 mm side by side, a gap between them, turned.
fn two_bodies(gap: f64, degrees: f64) -> String {
    let (s, c) = degrees.to_radians().sin_cos();
    let (u, v) = (format!("(x*{c} + y*{s})"), format!("(y*{c} - x*{s})"));
    let half = 0.5 * gap;
    format!(
        "max(max(min(max({u} - 10, {half} - {u}), max(-10 - {u}, {u} + {half})), \
         abs({v}) - 4), abs(z - 0.4) - 0.4)"
    )
}

/// Lengths of the outer walls of what is one body, and of what are two.
const ONE: f64 = 2.0 * (20.0 - 0.45 + 8.0 - 0.45);
const TWO: f64 = 4.0 * (10.0 - 0.45 + 8.0 - 0.45);

#[test]
fn bodies_with_a_slit_between_them_are_one() {
    let outer = |text: &str, assignments: &[&str]| {
        let layers = {
            let settings = settings(assignments);
            parse(&slice(&formula(text, &settings), &settings, 2).0)
        };
        assert_eq!(layers.len(), 4);
        let length = layers[1].length("External perimeter");
        assert!((layers[2].length("External perimeter") - length).abs() < 0.1);
        length
    };
    // The lattice hardly sees the first gap, and sees the last one well.
    for gap in [0.0, 0.002, 0.005, 0.01, 0.02, 0.038] {
        for degrees in [0.0, 7.0, 30.0] {
            let length = outer(&two_bodies(gap, degrees), &[]);
            let off = length - ONE;
            assert!(off.abs() < 0.25, "{gap} {degrees}: {off}");
        }
    }
    for (gap, closing) in
        [(0.05, "auto"), (0.11, "0.05"), (0.3, "0.05"), (0.03, "0")]
    {
        let setting = format!("slit_closing={closing}");
        let length = outer(&two_bodies(gap, 7.0), &[&setting]);
        let exact = TWO - 4.0 * 0.5 * gap;
        assert!((length - exact).abs() < 0.25, "{gap}: {length} {exact}");
    }
    let length = outer(&two_bodies(0.3, 7.0), &["slit_closing=0.2"]);
    assert!((length - ONE).abs() < 0.25, "{length}");
    let field = outer(&two_bodies(0.03, 7.0), &["wall_offset=field"]);
    assert!((field - ONE).abs() < 0.25, "{field}");
}

/// A closed slit is no error of the outline, and no range of layers sees
/// another one.
#[test]
fn closed_slits_are_reported_and_divided_like_anything_else() {
    let settings = settings(&[]);
    let part = formula(&two_bodies(0.03, 7.0), &settings);
    let options = Options {
        report: true,
        ..Options::default()
    };
    let summary = pipeline::slice(&part, &settings, &options, &mut Vec::new());
    let report = summary.unwrap().report.unwrap();
    assert!(report.outline_um.unwrap().max < 5.0);
    assert!(report.outer_wall_um.unwrap().max < 10.0);
    assert!(report.area.unwrap().excess_percent.abs() < 0.2);
    let text = |text: &str, layer: usize| -> Vec<String> {
        let part = text.split(";LAYER_CHANGE").nth(layer).unwrap();
        let lines = part.lines().filter(|l| !l.starts_with("M73"));
        lines.map(str::to_owned).collect()
    };
    let whole = slice(&part, &settings, 1).0;
    let range = slice_layers(&part, &settings, "3..4", 2).0;
    assert_eq!(text(&whole, 3), text(&range, 1));
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
            "sample_spacing=0.225",
            "infill_density=0",
            "gcode.flavour=klipper",
            "gcode.start=; {{ part_min_x }} {{ part_max_x }}",
        ]);
        let source = Source::formula("plate", PLATE);
        let placement = Placement {
            margin: s.reach(),
            ..Placement::default()
        };
        let bed = BuildVolume::of(&s);
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
