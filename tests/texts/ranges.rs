//! A part sliced in ranges of layers is the part sliced in one run, layer for
//! layer; and joined, byte for byte. `tests/texts/join.rs` has what is refused.

use crate::common;
use crate::common::{Example, slice_layers};
use isoslice::pipeline::{self, Options};
use isoslice::plate::Plate;

/// What lies between a file's head and its end.
fn body(gcode: &str) -> &str {
    let from = gcode.find(";LAYER_CHANGE\n").unwrap();
    let to = gcode.find("; end of layers\n").unwrap();
    &gcode[from..to]
}

/// Slices whole and in pieces that end before the given layers (from 0).
#[track_caller]
fn assert_same_in_ranges(plate: &Plate, cuts: &[usize]) {
    let (model, settings) = (&plate.parts[0].model, &plate.settings);
    let (whole, summary) = slice_layers(model, settings, "..", 1);
    let count = summary.layer_count;
    let mut joined = String::new();
    let mut files = Vec::new();
    let (mut time, mut filament) = (0.0, 0.0);
    let mut from = 0;
    for (k, &to) in cuts.iter().chain([&count]).enumerate() {
        let range = format!("{}..{to}", from + 1);
        let threads = if k % 2 == 0 { 3 } else { 1 };
        let (part, of_part) = slice_layers(model, settings, &range, threads);
        assert_eq!(of_part.layers, from..to);
        assert!(
            part.contains(&format!("; total layers count = {}", to - from))
        );
        joined.push_str(body(&part));
        files.push(part);
        time += of_part.time;
        filament += of_part.filament_length;
        from = to;
    }
    assert!(
        common::join(&files).unwrap() == whole.as_bytes(),
        "{cuts:?}: the joined file is not that of a single run"
    );
    // Only a whole part's file tells how far it has come.
    let tells = |line: &&str| line.starts_with("M73 ");
    let lines = body(&whole).split_inclusive('\n');
    let whole: String = lines.filter(|line| !tells(line)).collect();
    let differs = whole.lines().zip(joined.lines()).position(|(a, b)| a != b);
    assert_eq!(differs, None, "lines of {cuts:?} that are not the same");
    assert_eq!(whole.len(), joined.len(), "{cuts:?}");
    // Layers take equal times; each further file has a head and a foot, too.
    let more = (time - summary.time) / cuts.len() as f64;
    assert!(
        (0.0..20.0).contains(&more),
        "{more} s for each head and foot"
    );
    let length = summary.filament_length;
    assert!((filament - length).abs() < 1e-9 * length);
}

/// Coarse settings, which are quick, with several slabs of layers.
const COARSE: [&str; 3] =
    ["sample_spacing=0.225", "accuracy=0.05", "retract.z_hop=0.3"];

fn check_example(name: &str, layer_height: &str, cuts: &[usize]) {
    let example = common::example(name);
    check_with(&example, layer_height, cuts);
}

fn check_with(example: &Example, layer_height: &str, cuts: &[usize]) {
    let height = format!("layer_height={layer_height}");
    let mut all = COARSE.to_vec();
    all.push(&height);
    let (model, settings) = example.place(&all);
    assert_same_in_ranges(&Plate::of(&model, &settings), cuts);
}

#[test]
fn a_blend_with_holes() {
    check_example("blended-bracket", "0.25", &[1, 32, 129]);
}

#[test]
fn a_prism_whose_layers_are_all_alike() {
    // Heights above the bed are rounded differently from layer to layer.
    let settings = common::settings(&[]);
    let text = "max(sqrt(x*x + y*y) - 3, max(-z, z - 40))";
    let model = common::formula(text, &settings);
    assert_same_in_ranges(&Plate::of(&model, &settings), &[140]);
}

#[test]
fn a_twist() {
    check_example("twisted-vase", "0.3", &[33, 128, 140]);
}

#[test]
fn a_spiral() {
    let settings = common::settings(&["spiral=true", "accuracy=0.05"]);
    let part = "max(sqrt(x^2 + y^2) - 8 - sin(0.2*z), max(-z, z - 30))";
    let model = common::formula(part, &settings);
    assert_same_in_ranges(&Plate::of(&model, &settings), &[2, 40, 128, 131]);
    let settings =
        common::settings(&["spiral=2", "accuracy=0.05", "gcode.progress=off"]);
    assert_same_in_ranges(&Plate::of(&model, &settings), &[2, 40, 128, 131]);
}

#[test]
fn a_surface_without_steps() {
    let settings = common::settings(&[
        "contour_z=100",
        "contour_z_below=true",
        "supports=auto",
        "gcode.progress=off",
    ]);
    let part = "max(sqrt(x^2 + y^2) - 8, abs(z - 14) - 14 - 0.5*sin(x))";
    let model = common::formula(part, &settings);
    assert_same_in_ranges(&Plate::of(&model, &settings), &[2, 40, 139]);
}

#[test]
fn internal_bridges() {
    let settings = common::settings(&[
        "internal_bridges=true",
        "sample_spacing=0.225",
        "accuracy=0.05",
    ]);
    // Stairs. One of the layers with internal bridges is the first of the
    // second block of layers, and lies on infill of the first block.
    let part = "max(max(abs(x) - 50 + 3*floor((z + 1.6)/2), abs(y) - 6), \
                max(-z, z - 29))";
    let model = common::formula(part, &settings);
    assert_same_in_ranges(&Plate::of(&model, &settings), &[2, 40, 128, 130]);
}

#[test]
fn more_layers_of_internal_bridges() {
    // Stairs whose bridges lie on both sides of where a block begins.
    for layers in ["2", "3"] {
        let layers = format!("internal_bridges={layers}");
        let settings = common::settings(&[
            &layers,
            "infill_density=8",
            "sample_spacing=0.225",
            "accuracy=0.05",
            "gcode.progress=off",
        ]);
        for shift in ["1.4", "1.6", "1.8"] {
            let part = format!(
                "max(max(abs(x) - 50 + 3*floor((z + {shift})/2), abs(y) - 6), \
                 max(-z, z - 29))"
            );
            let model = common::formula(&part, &settings);
            assert_same_in_ranges(
                &Plate::of(&model, &settings),
                &[40, 62, 63, 64, 65, 128, 130],
            );
        }
    }
}

/// A dome has skin over its infill in every layer, so that no layer is independent
/// of the bridges below it. Cubes whose corners are blended have infill whose beads
/// stand on those below them.
#[test]
fn what_lies_on_the_layers_below() {
    let dome = "max(sqrt(x^2 + y^2 + z^2) - 14, -z)";
    let cuts = [2, 30, 63, 64, 65, 90, 100];
    for more in [
        &["infill_density=12"][..],
        &["infill_density=expr: 10 + d"],
        &["infill=expr: sqrt(x^2 + y^2 + (z - 5)^2) - 4"],
    ] {
        let all = [&COARSE[..], &["layer_height=0.12"], more].concat();
        let settings = common::settings(&all);
        let model = common::formula(dome, &settings);
        assert_same_in_ranges(&Plate::of(&model, &settings), &cuts);
    }
}

#[test]
fn several_bodies() {
    check_example("box-with-lid", "0.3", &[5, 50]);
}

#[test]
fn a_lattice() {
    // The example is made smaller, but still has more than four slabs of layers.
    let mut small = common::example("lattice-part");
    small.define("radius", "13");
    check_with(&small, "0.17", &[45]);
}

/// Layers without anything in them, before the part and between its pieces.
#[test]
fn islands_in_the_air() {
    for flavour in ["gcode.flavour=marlin", "gcode.flavour=klipper"] {
        let relative = format!("gcode.relative_e={}", flavour.contains('k'));
        let mut all = COARSE.to_vec();
        all.extend(["layer_height=0.1", "first_layer_height=0.1"]);
        all.extend([flavour, &relative, "filament.nozzle_temperature=215"]);
        let settings = common::settings(&all);
        let model = common::formula(
            "max(max(abs(x) - 4, abs(y) - 4), min(min(abs(z) - 1, \
             abs(z - 9.5) - 1), abs(z - 12.8) - 1))",
            &settings,
        );
        let cuts = [2, 30, 32, 90, 96, 127, 128, 133];
        assert_same_in_ranges(&Plate::of(&model, &settings), &cuts);
    }
}

/// Supports are planned from the whole part, whichever layers are written.
#[test]
fn supports_of_a_tee() {
    supports_of_a_tee_with("support.z_gap=0.2");
}

/// Supports between the layers have marks of their own.
#[test]
fn supports_of_a_tee_between_its_layers() {
    supports_of_a_tee_with("support.z_gap=0.13");
}

fn supports_of_a_tee_with(gap: &str) {
    let mut all = COARSE.to_vec();
    all.extend(["supports=auto", "layer_height=0.2", gap]);
    let settings = common::settings(&all);
    let model = common::formula(
        "min(max(abs(x) - 3, abs(y) - 4, abs(z - 5) - 5), \
         max(abs(x) - 12, abs(y) - 4, abs(z - 11) - 1))",
        &settings,
    );
    let (text, summary) = slice_layers(&model, &settings, "..", 2);
    assert!(text.contains(";TYPE:Support material\n"));
    assert!(text.contains(";TYPE:Support material interface\n"));
    assert!(summary.support_length > 0.0);
    assert_eq!(summary.warnings, Vec::<String>::new());
    assert_same_in_ranges(&Plate::of(&model, &settings), &[3, 33, 52]);
}

/// The raft is planned from the whole part, too. Ranges begin in it, with the
/// part, and above.
#[test]
fn a_raft_under_a_tee() {
    let mut all = COARSE.to_vec();
    all.extend(["supports=auto", "layer_height=0.2", "raft.layers=3"]);
    all.extend(["skirt.layers=4", "support.z_gap=0.15"]);
    let settings = common::settings(&all);
    let model = common::formula(
        "min(max(abs(x) - 3, abs(y) - 4, abs(z - 5) - 5), \
         max(abs(x) - 12, abs(y) - 4, abs(z - 11) - 1))",
        &settings,
    );
    assert_same_in_ranges(&Plate::of(&model, &settings), &[2, 3, 4, 33]);
}

/// Seams have followed corners through the layers below, which a range does not
/// make.
#[test]
fn seams_in_corners_that_wind_and_lean() {
    let winds = "max(max(abs(x*cos(z/20) - y*sin(z/20)), \
                 abs(x*sin(z/20) + y*cos(z/20))) - 5, abs(z - 30) - 30)";
    let leans = "max(max(abs(x - z/2), abs(y + z/3)) - 5, abs(z - 30) - 30)";
    for text in [winds, leans] {
        let all = [&COARSE[..], &["accuracy=0.03", "raft.layers=1"]].concat();
        let settings = common::settings(&all);
        let model = common::formula(text, &settings);
        assert_same_in_ranges(&Plate::of(&model, &settings), &[128, 200, 256]);
    }
}

/// What the layers below have told the machine, a range's head tells it.
#[test]
fn a_range_alone_has_its_fan_acceleration_and_speed() {
    let mut all = COARSE.to_vec();
    all.extend(["gcode.flavour=klipper", "acceleration.outer_wall=700"]);
    let settings = common::settings(&all);
    let model = common::formula("max(sqrt(x^2+y^2)-8, abs(z)-6)", &settings);
    let head = |layers: &str| {
        let (gcode, _) = slice_layers(&model, &settings, layers, 1);
        gcode[..gcode.find(";LAYER_CHANGE\n").unwrap()].to_owned()
    };
    assert!(!head("..").contains("M106"));
    let above = head("30..33");
    assert!(above.contains("\nM106 S255\n"), "{above}");
    let last: Vec<&str> = above.lines().rev().take(2).collect();
    assert!(last[1].starts_with("M204 S"), "{above}");
    assert!(last[0].starts_with("G1 F"), "{above}");
}

#[test]
fn a_range_above_the_part_is_an_error_and_an_empty_one_is_not() {
    let settings = common::settings(&COARSE);
    let model = common::formula(
        "max(max(abs(x) - 4, abs(y) - 4), abs(abs(z) - 4) - 1)",
        &settings,
    );
    let (gcode, summary) = slice_layers(&model, &settings, "20..25", 1);
    assert_eq!(gcode.matches(";LAYER_CHANGE").count(), 6);
    assert!(gcode.contains("\n; layers 20 to 25 of 50\n"));
    assert_eq!(summary.filament_length, 0.0);
    assert!(summary.warnings[0].contains("nothing to print"));
    let options = Options {
        threads: Some(1),
        layers: "51..".parse().unwrap(),
        ..Options::default()
    };
    let error = pipeline::slice(&model, &settings, &options, &mut Vec::new())
        .unwrap_err();
    assert!(error.to_string().contains("has 50 layers"), "{error}");
}

/// The places at which the moves of a layer's beads of a role end, sorted.
fn places<'a>(layer: &'a str, role: &str) -> Vec<&'a str> {
    let mut of_role = false;
    let mut all = Vec::new();
    for line in layer.lines() {
        if let Some(name) = line.strip_prefix(";TYPE:") {
            of_role = name == role;
        } else if of_role && line.starts_with("G1 X") && line.contains(" E") {
            let end = line.find(" E").unwrap();
            all.push(&line[..end]);
        }
    }
    all.sort_unstable();
    all.dedup();
    all
}

/// A glimpse of a layer has the beads that the layer has in a whole run, though
/// they may begin elsewhere.
#[test]
fn a_glimpse() {
    let settings = common::settings(&["layer_height=0.25", "skirt.loops=0"]);
    let part = "max(max(abs(x), abs(y)) - 6 - sin(0.5*z), abs(z - 20) - 20)";
    let model = common::formula(part, &settings);
    let (whole, summary) = slice_layers(&model, &settings, "..", 1);
    let layers: Vec<&str> = body(&whole).split(";LAYER_CHANGE\n").collect();
    let height = |layer: usize| 0.2 + 0.25 * layer as f64;
    let count = summary.layer_count;
    for (z, layer) in [
        (-5.0, 0),
        (0.0, 0),
        (0.21, 1),
        (height(60) - 0.1, 60),
        (height(131), 131),
        (height(count - 1), count - 1),
        (1e9, count - 1),
        (f64::NAN, 0),
    ] {
        let options = Options {
            threads: Some(2),
            glimpse: Some(z),
            ..Options::default()
        };
        let mut gcode = Vec::new();
        let of_layer =
            pipeline::slice(&model, &settings, &options, &mut gcode).unwrap();
        assert_eq!(of_layer.layers, layer..layer + 1, "{z}");
        assert_eq!(of_layer.layer_count, count);
        let gcode = String::from_utf8(gcode).unwrap();
        let layer = layers[layer + 1];
        assert!(!places(layer, "External perimeter").is_empty());
        for role in [
            "External perimeter",
            "Perimeter",
            "Solid infill",
            "Top solid infill",
            "Internal infill",
        ] {
            let (a, b) = (places(body(&gcode), role), places(layer, role));
            // A loop has two more moves where it begins.
            let other = a.iter().filter(|p| !b.contains(p)).count();
            assert!(other <= 4, "{role} of {z}: {other} of {}", a.len());
            assert!(a.len().abs_diff(b.len()) <= 4, "{role} of {z}");
        }
    }
}
