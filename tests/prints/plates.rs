//! Several parts on one plate: each as if it were alone, moved.

use crate::common::head::{Head, Step};
use crate::common::{number, settings, wanted};
use glam::{DVec2, DVec3};
use isoslice::layers::LayerRange;
use isoslice::pipeline::{Options, SliceError, Summary, slice_plate};
use isoslice::plate::{Plate, PlateFile};
use isoslice::settings::Builder;
use std::collections::BTreeMap;
use std::fs;

const CYLINDER: &str = "max(sqrt(x^2 + y^2) - 7, max(-z, z - 4))";
const BOX: &str = "max(max(abs(x) - 9, abs(y) - 6), max(-z, z - 6 + 0.05*x))";

/// Labels by name, filament by moves, and no skirt.
const PLAIN: [&str; 6] = [
    "gcode.flavour=klipper",
    "gcode.relative_e=true",
    "gcode.progress=off",
    "sample_spacing=0.225",
    "accuracy=0.02",
    "skirt.loops=0",
];

fn run(plate: &Plate, layers: &str, threads: usize) -> (String, Summary) {
    let options = Options {
        threads: Some(threads),
        layers: layers.parse::<LayerRange>().unwrap(),
        ..Options::default()
    };
    let mut out = Vec::new();
    let summary = slice_plate(plate, &options, &mut out).unwrap();
    (String::from_utf8(out).unwrap(), summary)
}

/// Segments that print, by label and layer.
type Printed = BTreeMap<(String, usize), Vec<(DVec2, DVec2)>>;

fn printed(gcode: &str) -> Printed {
    let mut found = Printed::new();
    let (mut label, mut layer) = (String::new(), 0);
    let mut head = Head::new(DVec3::ZERO);
    for line in gcode.lines() {
        if line == ";LAYER_CHANGE" {
            layer += 1;
        }
        if let Some(name) = line.strip_prefix("EXCLUDE_OBJECT_START NAME=") {
            assert!(label.is_empty(), "{label} has not ended");
            label = name.to_owned();
        }
        if let Some(name) = line.strip_prefix("EXCLUDE_OBJECT_END NAME=") {
            assert_eq!(label, name);
            label.clear();
        }
        if let Some(step) = head.step(line).filter(Step::prints) {
            let of_part = found.entry((label.clone(), layer)).or_default();
            of_part.push((step.from.truncate(), step.to.truncate()));
        }
    }
    found
}

/// The segments of one label, layer by layer.
fn of<'a>(
    all: &'a Printed,
    name: &'a str,
) -> impl Iterator<Item = (usize, &'a Vec<(DVec2, DVec2)>)> {
    let here = all.iter().filter(move |((label, _), _)| label == name);
    here.map(|((_, layer), segments)| (*layer, segments))
}

fn plate_of_three() -> Plate {
    let plain = settings(&PLAIN);
    let more = settings(&[&PLAIN[..], &["walls=3"]].concat());
    let all = [
        wanted("cylinder", CYLINDER, 2, &plain),
        wanted("box", BOX, 1, &more),
    ];
    Plate::new("three", &all, &plain).unwrap()
}

/// Compares all that is printed of a plate's parts with each of them alone:
/// how many segments, what is printed of the plate, and its summary.
fn alone_and_together(plate: &Plate) -> (usize, Printed, Summary) {
    let (gcode, summary) = run(plate, "..", 2);
    let together = printed(&gcode);
    let mut compared = 0;
    for part in &plate.parts {
        let settings = &part.settings;
        let (alone, of_one) = run(&Plate::of(&part.model, settings), "..", 1);
        let alone = printed(&alone);
        for place in &part.places {
            let here: Vec<_> = of(&together, &place.name).collect();
            let there: Vec<_> = of(&alone, &part.model.name).collect();
            assert_eq!(here.len(), there.len());
            for ((layer, here), (same, there)) in here.iter().zip(&there) {
                assert_eq!(layer, same);
                assert_eq!(here.len(), there.len(), "layer {layer}");
                for (a, b) in here.iter().zip(*there) {
                    let off = (a.0 - b.0 - place.shift)
                        .abs()
                        .max((a.1 - b.1 - place.shift).abs());
                    assert!(off.max_element() < 1.01e-3, "{off}");
                    compared += 1;
                }
            }
        }
        let told = summary.parts.iter().find(|p| p.name == part.model.name);
        let told = told.unwrap();
        assert_eq!(told.copies, part.places.len());
        assert_eq!(told.layer_count, of_one.layer_count);
        let share = told.filament_length / of_one.filament_length;
        assert!((share - 1.0).abs() < 1e-3, "{share}");
    }
    (compared, together, summary)
}

#[test]
fn every_part_is_printed_as_if_it_were_alone() {
    let plate = plate_of_three();
    let (compared, together, summary) = alone_and_together(&plate);
    assert!(compared > 3000, "{compared}");
    assert_eq!(
        together
            .keys()
            .filter(|(label, _)| label.is_empty())
            .count(),
        0
    );
    assert_eq!(summary.layer_count, 32);
}

#[test]
fn supports_and_rafts_are_those_of_each_part_alone() {
    let tee = "min(max(max(abs(x) - 4, abs(y) - 6), abs(z - 3) - 3), \
               max(max(abs(x) - 9, abs(y) - 6), abs(z - 7) - 1))";
    let set = [
        "supports=auto",
        "bridge_max=0",
        "raft.layers=2",
        "speed.overhang=25:40, 75:20",
    ];
    let plain = settings(&[&PLAIN[..], &set].concat());
    let all = [wanted("tee", tee, 2, &plain), wanted("box", BOX, 1, &plain)];
    let plate = Plate::new("p", &all, &plain).unwrap();
    let (compared, together, summary) = alone_and_together(&plate);
    assert!(compared > 3000, "{compared}");
    assert!(summary.support_length > 50.0, "{}", summary.support_length);
    // The raft's layers count.
    let name = &plate.parts[0].places[1].name;
    assert_eq!(of(&together, name).count(), 2 + 40);
}

/// What the check allows is what the part's own settings ask for, whatever those
/// of the plate are, and whatever other parts there are.
#[test]
fn a_part_may_have_a_flow_widths_and_gaps_of_its_own() {
    let tee = "min(max(max(abs(x) - 4, abs(y) - 6), abs(z - 1) - 1), \
               max(max(abs(x) - 9, abs(y) - 6), abs(z - 3) - 1))";
    let wide = "outer_wall_width=2\ninner_wall_width=2\ninfill_width=2\n\
                top_skin_width=2\nskin_width=2";
    let held = "supports=auto\nbridge_max=0\nsupport.z_gap=1\n\
                support.z_gap_bottom=1";
    for (of_plate, own) in [
        ("", "flow=170"),
        ("", "flow=155"),
        ("", "flow=25"),
        ("flow=60", "flow=100"),
        ("", wide),
        (wide, "flow=100\nouter_wall_width=0.4\ninner_wall_width=0.4"),
        ("infill_density=100\nthin_max=300", "thin_max=150"),
        ("", held),
    ] {
        let with = |more: &str| {
            let mut sets = PLAIN.to_vec();
            sets.extend(more.lines());
            settings(&sets)
        };
        let all = with(of_plate);
        let one = wanted("tee", tee, 1, &with(own));
        let alone = Plate::new("p", std::slice::from_ref(&one), &all).unwrap();
        let verdict = run(&alone, "..", 2).1.verdict.unwrap();
        assert!(verdict.is_safe(), "{own}");
        let other = wanted("box", BOX, 1, &all);
        let beside = Plate::new("p", &[one, other], &all).unwrap();
        assert!(run(&beside, "..", 2).1.verdict.unwrap().is_safe(), "{own}");
    }
}

#[test]
fn a_draft_shield_stands_round_all_parts() {
    let all = settings(&[&PLAIN[..], &["draft_shield=3"]].concat());
    let parts = [
        wanted("cylinder", CYLINDER, 2, &all),
        wanted("box", BOX, 1, &all),
    ];
    let plate = Plate::new("p", &parts, &all).unwrap();
    let printed = printed(&run(&plate, "..", 2).0);
    let shield: Vec<_> = of(&printed, "").collect();
    assert_eq!(shield.len(), 15);
    let mut points = shield.iter().flat_map(|(_, s)| s.iter().map(|s| s.0));
    let corners = |points: &mut dyn Iterator<Item = DVec2>| {
        points.fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(low, high), p| {
            (low.min(p), high.max(p))
        })
    };
    let (low, high) = corners(&mut points);
    let of_parts = printed.iter().filter(|((label, _), _)| !label.is_empty());
    let mut points = of_parts.flat_map(|(_, s)| s.iter().map(|s| s.0));
    let (inner_low, inner_high) = corners(&mut points);
    for away in [inner_low - low, high - inner_high] {
        // The gap, and half a line of the shield and of the wall.
        assert!((away - 10.45).abs().max_element() < 0.1, "{away}");
    }
}

#[test]
fn parts_take_turns_in_the_order_of_nearness() {
    let plate = plate_of_three();
    let (gcode, _) = run(&plate, "..", 1);
    let starts: Vec<Vec<&str>> = gcode
        .split(";LAYER_CHANGE\n")
        .skip(1)
        .map(|layer| {
            let lines = layer.lines();
            lines
                .filter_map(|l| l.strip_prefix("EXCLUDE_OBJECT_START NAME="))
                .collect()
        })
        .collect();
    for pair in starts[..18].windows(2) {
        assert_eq!(pair[0].len(), 3);
        // A layer begins with the part that the layer below has ended with.
        assert_eq!(pair[0].last(), pair[1].first());
    }
    // From one part to the next there is a retraction.
    let (mut retracted, mut checked) = (false, 0);
    let mut last = "";
    for line in gcode.lines() {
        if line.starts_with("G1 E-") {
            retracted = true;
        }
        if let Some(name) = line.strip_prefix("EXCLUDE_OBJECT_START NAME=") {
            checked += usize::from(!last.is_empty() && name != last);
            (last, retracted) = (name, false);
        }
        if line.starts_with("G1 X") && line.contains(" E") && checked > 0 {
            let first = last;
            assert!(retracted || first == last, "{line}");
        }
    }
    assert!(checked > 30, "{checked}");
}

#[test]
fn ranges_and_threads_give_the_same_bytes() {
    let mut plate = plate_of_three();
    plate.settings = settings(&[&PLAIN[..], &["skirt.loops=2"]].concat());
    let body = |gcode: &str| {
        let from = gcode.find(";LAYER_CHANGE\n").unwrap();
        let to = gcode.find("; end of layers\n").unwrap();
        gcode[from..to].to_owned()
    };
    let (whole, summary) = run(&plate, "..", 1);
    assert_eq!(whole, run(&plate, "..", 3).0);
    let mut joined = String::new();
    for range in ["1..1", "2..19", "20..27", "28.."] {
        joined += &body(&run(&plate, range, 2).0);
    }
    assert_eq!(body(&whole), joined);
    assert_eq!(summary.parts.len(), 2);
    // Another run gives equal bytes.
    assert_eq!(whole, run(&plate, "..", 2).0);
}

#[test]
fn a_plate_longer_than_a_block_can_be_sliced_in_ranges() {
    let plain = settings(&PLAIN);
    let pin = "max(sqrt(x^2 + y^2) - 3 + 0.02*z, max(-z, z - 30))";
    let cone = "max(sqrt(x^2 + y^2) - 6 + 0.2*z, max(-z, z - 26.9))";
    let all = [
        wanted("pin", pin, 2, &plain),
        wanted("cone", cone, 2, &plain),
        // The low part ends below the second block.
        wanted("low", CYLINDER, 1, &plain),
    ];
    let plate = Plate::new("p", &all, &plain).unwrap();
    let body = |gcode: &str| {
        let from = gcode.find(";LAYER_CHANGE\n").unwrap();
        let to = gcode.find("; end of layers\n").unwrap();
        gcode[from..to].to_owned()
    };
    let (whole, summary) = run(&plate, "..", 2);
    assert_eq!(summary.layer_count, 150);
    let mut joined = String::new();
    for range in ["1..40", "41..130", "131..140", "141.."] {
        joined += &body(&run(&plate, range, 1).0);
    }
    let whole = body(&whole);
    let differs = whole.lines().zip(joined.lines()).position(|(a, b)| a != b);
    assert_eq!(differs, None);
    assert_eq!(whole.len(), joined.len());
}

#[test]
fn hosts_can_leave_out_each_part() {
    let mut text = Vec::new();
    for flavour in ["klipper", "marlin", "rrf", "prusa"] {
        let flavour = format!("gcode.flavour={flavour}");
        let settings =
            settings(&[&flavour, "gcode.labels=on", "accuracy=0.05"]);
        // Names are no commands.
        let all = [
            wanted("cylinder\nM112", CYLINDER, 2, &settings),
            wanted("box", BOX, 1, &settings),
        ];
        let plate = Plate::new("p", &all, &settings).unwrap();
        let gcode = run(&plate, "1..3", 2).0;
        assert!(!gcode.lines().any(|l| l.starts_with("M112")));
        text.push(gcode);
    }
    let lines = |k: usize, start: &str| -> Vec<&str> {
        let lines = text[k].lines();
        lines.filter(|line| line.starts_with(start)).collect()
    };
    let defined = lines(0, "EXCLUDE_OBJECT_DEFINE");
    assert_eq!(defined.len(), 3);
    assert!(
        defined[1].contains("NAME=cylinder_M112_2 CENTER="),
        "{defined:?}"
    );
    for k in [1, 2, 3] {
        assert_eq!(lines(k, "M486 T"), ["M486 T3"]);
        // Each place is named in each of three layers.
        for place in 0..3 {
            let start = format!("M486 S{place}");
            let alone =
                lines(k, &start).iter().filter(|l| **l == start).count();
            assert!(alone == 3 || k == 3 && alone == 4, "{k} {place} {alone}");
        }
    }
    assert_eq!(lines(2, "M486 S2 A"), ["M486 S2 A\"box\""]);
    assert_eq!(lines(3, "M486 A").len(), 3);
}

/// Least distance between some points and some segments.
fn between(segments: &[(DVec2, DVec2)], points: &[DVec2]) -> f64 {
    let away = |p: &DVec2| {
        let to = segments.iter().map(|&(a, b)| {
            let t = (p - a).dot(b - a) / (b - a).length_squared();
            p.distance(a.lerp(b, t.clamp(0.0, 1.0)))
        });
        to.fold(f64::INFINITY, f64::min)
    };
    points.iter().map(away).fold(f64::INFINITY, f64::min)
}

/// A brim of wide lines ends elsewhere than one of the plate's own lines.
#[test]
fn the_skirt_keeps_away_from_a_brim_of_other_lines() {
    let loops = [&PLAIN[..], &["skirt.loops=1"]].concat();
    let of_all = settings(&loops);
    let own = ["brim.place=outer", "outer_wall_width=0.8"];
    let with_brim = settings(&[&loops[..], &own].concat());
    let all = [
        wanted("cylinder", CYLINDER, 1, &of_all),
        wanted("box", BOX, 1, &with_brim),
    ];
    let plate = Plate::new("p", &all, &of_all).unwrap();
    let all = printed(&run(&plate, "1..1", 2).0);
    let skirt = &all[&(String::new(), 1)];
    let of_box = &all[&("box".to_owned(), 1)];
    let of_box: Vec<DVec2> = of_box.iter().map(|s| s.0).collect();
    let gap = between(skirt, &of_box) - 0.5 * (0.45 + 0.8);
    assert!((5.95..6.1).contains(&gap), "{gap}");
}

#[test]
fn the_skirt_goes_round_all_and_each_part_has_its_brim() {
    let loops = [&PLAIN[..], &["skirt.loops=1"]].concat();
    let of_all = settings(&loops);
    let with_brim = settings(&[&loops[..], &["brim.place=outer"]].concat());
    let all = [
        wanted("cylinder", CYLINDER, 2, &of_all),
        wanted("box", BOX, 1, &with_brim),
    ];
    let plate = Plate::new("p", &all, &of_all).unwrap();
    let all = printed(&run(&plate, "1..2", 2).0);
    let skirt: Vec<_> = all[&(String::new(), 1)].clone();
    assert!(!all.contains_key(&(String::new(), 2)));
    // The skirt is round the parts, and 6 mm away from what is nearest, the
    // brim.
    let of_parts: Vec<DVec2> = all
        .iter()
        .filter(|((label, _), _)| !label.is_empty())
        .flat_map(|(_, segments)| segments.iter().flat_map(|s| [s.0, s.1]))
        .collect();
    let nearest = between(&skirt, &of_parts);
    assert!((6.3..6.6).contains(&nearest), "{nearest}");
    let (low, high) = skirt
        .iter()
        .fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(low, high), s| {
            (low.min(s.0), high.max(s.0))
        });
    assert!(
        of_parts
            .iter()
            .all(|p| { p.cmpgt(low + 6.0).all() && p.cmplt(high - 6.0).all() })
    );
    let wide = |label: &str| {
        let segments = &all[&(label.to_owned(), 1)];
        let xs = segments.iter().map(|s| s.0.x);
        let most = xs.clone().fold(f64::NEG_INFINITY, f64::max);
        most - xs.fold(f64::INFINITY, f64::min)
    };
    assert!((wide("cylinder_1") - 13.55).abs() < 0.1);
    assert!(wide("box") > 18.0 + 2.0 * 4.5, "{}", wide("box"));
}

#[test]
fn layers_of_different_heights_suit_all_parts() {
    let settings = settings(&[
        "layer_heights=adaptive 0.08",
        "accuracy=0.05",
        "sample_spacing=0.225",
    ]);
    let ball = "max(sqrt(x^2 + y^2 + (z - 6)^2) - 8, max(-z, z - 12))";
    let step = "max(max(abs(x), abs(y)) - 6, max(-z, z - 7.13))";
    let alone =
        Plate::new("p", &[wanted("ball", ball, 1, &settings)], &settings);
    let both = [
        wanted("ball", ball, 1, &settings),
        wanted("step", step, 2, &settings),
    ];
    let both = Plate::new("p", &both, &settings).unwrap();
    let (_, of_ball) = run(&alone.unwrap(), "..", 2);
    let (gcode, of_both) = run(&both, "..", 2);
    assert!(of_both.layer_count >= of_ball.layer_count);
    // The step's top is a layer's.
    assert!(gcode.contains(";Z:7.13\n"));
    let step = of_both.parts.iter().find(|p| p.name == "step").unwrap();
    assert!(step.layer_count < of_both.layer_count);
}

#[test]
fn a_report_is_of_one_part() {
    let plate = plate_of_three();
    let options = Options {
        report: true,
        ..Options::default()
    };
    let error = slice_plate(&plate, &options, &mut Vec::new()).unwrap_err();
    assert!(matches!(error, SliceError::ReportOfSeveral));
}

#[test]
fn plate_files_say_what_where_and_how() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("plate.toml");
    let script = "let w = param(\"w\", 10.0);\n\
                  draw(box(#{ lower: vec3(0.0, 0.0, 0.0), \
                  upper: vec3(w, 5.0, 3.0) }));\n";
    fs::write(folder.path().join("a.rhai"), script).unwrap();
    let read = |text: &str| {
        fs::write(&path, text).unwrap();
        let sets = ["walls=4".to_owned()];
        let mut builder = Builder::new();
        builder.set(&sets[0]).unwrap();
        let read = PlateFile::read(&path, builder, &sets);
        read.map_err(|error| error.to_string())
    };
    let file = read(
        "settings = { walls = 1, infill_density = 30, layer_height = 0.3 }\n\
         [[part]]\nmodel = \"a.rhai\"\ncopies = 2\nparams = { w = 20 }\n\
         [[part]]\nmodel = \"a.rhai\"\nat = [50, 60.5]\nlay = true\nrotate = 90\n\
         settings = { walls = 2, brim.width = 3 }\n",
    )
    .unwrap();
    assert_eq!(file.parts.len(), 2);
    // What the command line sets wins over the file's settings, and those of a
    // part win over both.
    let of_parts = file.parts.iter().map(|p| &p.settings);
    let all = std::iter::once(file.builder.settings()).chain(of_parts);
    let walls: Vec<f64> = all.map(|s| number(s, "walls")).collect();
    assert_eq!(walls, [4.0, 4.0, 2.0]);
    assert_eq!(file.parts[0].defines, [("w".into(), "20".into())]);
    assert_eq!(file.parts[1].placement.rotate, [0.0, 0.0, 90.0]);
    assert!(file.parts[1].placement.lay && !file.parts[0].placement.lay);
    assert_eq!(file.parts[1].at, Some((50.0, 60.5)));
    assert_eq!(file.models, [folder.path().join("a.rhai")]);

    let error = |text: &str| match read(text) {
        Ok(file) => {
            let made = Plate::new("p", &file.parts, file.builder.settings());
            made.map(|_| ()).unwrap_err().to_string()
        }
        Err(error) => error,
    };
    let part = "[[part]]\nmodel = \"a.rhai\"\n";
    for (text, expected) in [
        (
            format!("{part}copys = 2\n"),
            ":3: a part has no key \"copys\"; did you mean copies?",
        ),
        (
            format!("{part}walls = 2\n"),
            ":3: a part has no key \"walls\"; settings stand in settings = { walls = … }",
        ),
        (
            format!("{part}copies = 1000000000\n"),
            ":3: copies = 1000000000 is out of range; use 1 to 1000",
        ),
        (
            format!("{part}copies = -1\n"),
            ":3: copies = -1 is out of range",
        ),
        (
            format!("{part}at = [1, nan]\n"),
            ":3: at is where the middle",
        ),
        (format!("{part}at = 5\n"), ":3: at is where the middle"),
        (
            format!("{part}at = [9, -1e300]\n"),
            ":3: at = [9e0, -1e300] is on no bed",
        ),
        (
            format!("{part}copies = 2\nat = [9, 9]\n"),
            "2 copies cannot all stand in one place",
        ),
        (
            format!("{part}settings = {{ wals = 2 }}\n"),
            ":3: there is no setting \"wals\"; did you mean walls?",
        ),
        (
            format!("{part}settings = {{ layer_height = 0.1 }}\n"),
            ":1 (",
        ),
        (
            format!("{part}params = {{ w = [1] }}\n"),
            ":3: params: w is a number",
        ),
        (
            format!("{part}scale = 2\nsize = 3\n"),
            "cannot be given together",
        ),
        ("[[part]]\ncopies = 2\n".into(), ":1: the part has no model"),
        (format!("{part}lay = 3\n"), ":3: lay says whether"),
        (
            "part = 3\n".into(),
            "write each part below a line of its own",
        ),
        (
            "prt = 3\n".into(),
            ":1: a plate file has no key \"prt\"; did you mean part?",
        ),
        ("".into(), "there is no part"),
        (
            "[[part]]\nmodel = \"missing.rhai\"\n".into(),
            "missing.rhai",
        ),
        ("[[part]\n".into(), ":1: "),
        (
            part.repeat(1001),
            "1001 parts are more than a plate may have",
        ),
        (
            format!("{part}copies = 900\n{part}copies = 900\n"),
            "1800 parts are more",
        ),
    ] {
        let told = error(&text);
        assert!(told.contains(expected), "{text}\n{told}\n{expected}");
    }
    let differs =
        error(&format!("{part}settings = {{ layer_height = 0.1 }}\n"));
    assert!(
        differs.contains("layer_height = 0.1 differs from"),
        "{differs}"
    );
    let long = "#".repeat(2 << 20);
    assert!(error(&long).contains("larger than"), "a long file");
}
