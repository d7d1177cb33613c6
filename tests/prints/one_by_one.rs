//! Parts that are printed one after the other: each is complete, and the head
//! never comes near what is finished.

use crate::common::head::Head;
use crate::common::{settings, wanted};
use glam::{DVec2, DVec3};
use isoslice::check::{FindingKind, Rules, check};
use isoslice::layers::LayerRange;
use isoslice::pipeline::{Options, SliceError, slice_plate};
use isoslice::plate::{Plate, Wanted};

const LOW: &str = "max(max(abs(x) - 5, abs(y) - 4), max(-z, z - 6))";
const HIGH: &str = "max(sqrt(x^2 + y^2) - 6, max(-z, z - 30))";

const RADIUS: f64 = 40.0;
const GANTRY: f64 = 20.0;

/// Parts one by one, with labels by name and filament by moves.
const PLAIN: [&str; 8] = [
    "plate.sequence=one-by-one",
    "printer.head_clearance_radius=40",
    "printer.gantry_height=20",
    "gcode.flavour=klipper",
    "gcode.relative_e=true",
    "gcode.progress=off",
    "sample_spacing=0.225",
    "accuracy=0.02",
];

fn plate(more: &[&str]) -> Plate {
    let settings = settings(&[&PLAIN[..], more].concat());
    let all = [
        wanted("high", HIGH, 1, &settings),
        wanted("low", LOW, 2, &settings),
    ];
    Plate::new("plate", &all, &settings).unwrap()
}

fn run(plate: &Plate, threads: usize) -> String {
    let options = Options {
        threads: Some(threads),
        ..Options::default()
    };
    let mut out = Vec::new();
    slice_plate(plate, &options, &mut out).unwrap();
    String::from_utf8(out).unwrap()
}

/// A straight way of the nozzle, and what it prints.
struct Way {
    label: String,
    layer: usize,
    from: DVec3,
    to: DVec3,
    fed: f64,
}

/// All ways from the first layer to the last.
fn ways(gcode: &str) -> Vec<Way> {
    let (mut label, mut layer) = (String::new(), 0);
    let mut head = Head::new(DVec3::ZERO);
    let mut all = Vec::new();
    for line in gcode.lines() {
        if line == "; end of layers" {
            break;
        }
        layer += usize::from(line == ";LAYER_CHANGE");
        if let Some(name) = line.strip_prefix("EXCLUDE_OBJECT_START NAME=") {
            label = name.to_owned();
        }
        if line.starts_with("EXCLUDE_OBJECT_END") {
            label.clear();
        }
        let Some(step) = head.step(line) else {
            continue;
        };
        if layer > 0 {
            all.push(Way {
                label: label.clone(),
                layer,
                from: step.from,
                to: step.to,
                fed: step.fed,
            });
        }
    }
    all
}

/// Distance of the points of a way from those of beads.
fn distance(way: &Way, points: &[DVec2]) -> f64 {
    let ends = [way.from.truncate(), way.to.truncate()];
    let along = (0..=8).map(|i| ends[0].lerp(ends[1], i as f64 / 8.0));
    let near = |p: DVec2| points.iter().map(move |q| p.distance(*q));
    along.flat_map(near).fold(f64::INFINITY, f64::min)
}

#[test]
fn a_skirt_that_is_not_named_is_no_finished_part() {
    for layer_height in ["layer_height=0.1", "layer_height=0.2"] {
        let more = [
            "gcode.comments=none",
            layer_height,
            "first_layer_height=0.2",
            "skirt.loops=2",
        ];
        let plate = plate(&more);
        let gcode = run(&plate, 1);
        let verdict =
            check(gcode.as_bytes(), &Rules::new(&plate.settings)).unwrap();
        assert!(verdict.counts.is_empty(), "{:?}", verdict.findings);
    }
}

/// A higher skirt would be in the head's way.
#[test]
fn a_high_skirt_is_told_to_be_low() {
    let told = |more: &[&str]| {
        let plate = plate(more);
        let options = Options::default();
        let summary = slice_plate(&plate, &options, &mut Vec::new()).unwrap();
        let warnings = summary.warnings.iter();
        warnings.filter(|w| w.starts_with("skirt.layers")).count()
    };
    assert_eq!(told(&["skirt.layers=5"]), 1);
    assert_eq!(told(&["skirt.layers=5", "skirt.loops=0"]), 0);
    assert_eq!(told(&["skirt.layers=1"]), 0);
}

#[test]
fn each_part_is_finished_before_the_next_begins_and_nothing_is_hit() {
    let plate = plate(&[]);
    assert_eq!(plate.order().unwrap(), ["low_1", "low_2", "high"]);
    let gcode = run(&plate, 1);
    let ways = ways(&gcode);
    // The names' runs in the file.
    let mut names: Vec<&str> = Vec::new();
    for way in ways.iter().filter(|way| !way.label.is_empty()) {
        if names.last() != Some(&&*way.label) {
            names.push(&way.label);
        }
    }
    assert_eq!(names, ["low_1", "low_2", "high"]);
    // 6 mm in layers of 0.2 mm twice, and 30 mm.
    assert_eq!(gcode.matches(";LAYER_CHANGE").count(), 30 + 30 + 150);
    assert_eq!(ways.last().unwrap().layer, 210);
    let mut finished: Vec<(Vec<DVec2>, f64)> = Vec::new();
    for name in &names {
        let mut points = Vec::new();
        let mut top: f64 = 0.0;
        let mut lowest = f64::INFINITY;
        for way in ways.iter().filter(|way| way.label == *name) {
            for (beads, height) in &finished {
                let below = way.from.z.min(way.to.z);
                if below < *height {
                    let apart = distance(way, beads);
                    assert!(apart >= RADIUS, "{name}: {apart}");
                    assert!(height - below <= GANTRY, "{name}: {height}");
                }
            }
            if way.fed > 0.0 && way.from.truncate() != way.to.truncate() {
                points.extend([way.from.truncate(), way.to.truncate()]);
                top = top.max(way.to.z);
                lowest = lowest.min(way.to.z);
            }
        }
        assert_eq!(lowest, 0.2, "{name}");
        finished.push((points, top));
    }
    assert_eq!(finished[0].1, 6.0);
    assert_eq!(finished[2].1, 30.0);
    // The way to the next part is above what is finished.
    for name in ["low_2", "high"] {
        let mut to_it = ways.iter().skip_while(|way| way.label != name);
        let mut travels = to_it.by_ref().take_while(|way| way.fed <= 0.0);
        let sideways = travels
            .find(|w| w.from.truncate().distance(w.to.truncate()) > 1.0)
            .unwrap();
        assert!(sideways.from.z >= 8.0 && sideways.to.z >= 8.0, "{name}");
    }
    let verdict =
        check(gcode.as_bytes(), &Rules::new(&plate.settings)).unwrap();
    assert!(verdict.findings.is_empty(), "{:?}", verdict.findings);
}

#[test]
fn each_part_is_what_it_is_alone() {
    let plate = plate(&["skirt.loops=0"]);
    let together = ways(&run(&plate, 2));
    assert_eq!(run(&plate, 1), run(&plate, 3));
    for (k, name) in [(0, "high"), (1, "low_1"), (1, "low_2")] {
        let mut alone = plate.clone();
        alone.parts = vec![plate.parts[k].clone()];
        alone.parts[0].places.retain(|place| place.name == name);
        let shift = alone.parts[0].places[0].shift;
        let alone = ways(&run(&alone, 1));
        let fed = |ways: &[Way], name: &str| {
            let own = ways.iter().filter(|way| way.label == name);
            let own = own.filter(|way| {
                way.fed > 0.0 && way.from.truncate() != way.to.truncate()
            });
            own.map(|way| (way.to, way.fed)).collect::<Vec<_>>()
        };
        let (all, own) = (fed(&together, name), fed(&alone, name));
        assert_eq!(all.len(), own.len(), "{name}");
        for (a, b) in all.iter().zip(&own) {
            // A part alone on a plate stands where it is placed.
            assert!(a.0.distance(b.0) < 2e-3, "{name}: {a:?}, {b:?}, {shift}");
            assert!((a.1 - b.1).abs() < 2e-5, "{name}: {a:?}, {b:?}");
        }
    }
}

/// What is no higher than a nozzle is wide is a part as well.
#[test]
fn a_thin_part_is_finished_before_the_next_begins() {
    let settings = settings(&PLAIN);
    let square = |half: f64, height: f64| {
        format!("max(max(abs(x), abs(y)) - {half}, max(-z, z - {height}))")
    };
    let at = |name: &str, half: f64, height: f64, at: (f64, f64)| Wanted {
        at: Some(at),
        ..wanted(name, &square(half, height), 1, &settings)
    };
    // The box around the first two would hold the third.
    for thin in [0.2, 0.6] {
        let all = [
            at("thin", 10.0, thin, (30.0, 100.0)),
            at("far", 5.0, 15.0, (190.0, 100.0)),
            at("between", 5.0, 16.0, (110.0, 100.0)),
        ];
        let plate = Plate::new("plate", &all, &settings).unwrap();
        let gcode = run(&plate, 1);
        let verdict =
            check(gcode.as_bytes(), &Rules::new(&plate.settings)).unwrap();
        let mut hits = verdict.findings.iter();
        assert!(!hits.any(|f| f.kind == FindingKind::Collision), "{thin}");
    }
}

#[test]
fn the_check_sees_a_head_that_comes_too_near() {
    let plate = plate(&[]);
    let gcode = run(&plate, 1);
    for (more, word) in [
        ("printer.head_clearance_radius=60", "head_clearance_radius"),
        ("printer.gantry_height=5", "gantry_height"),
    ] {
        let stricter = settings(&[&PLAIN[..], &[more]].concat());
        let verdict = check(gcode.as_bytes(), &Rules::new(&stricter)).unwrap();
        let hits = verdict.findings.iter();
        let mut hits = hits.filter(|f| f.kind == FindingKind::Collision);
        let first = hits.next().expect(more);
        assert!(first.message.contains(word), "{}", first.message);
        assert!(!verdict.is_safe());
    }
}

/// On a printer whose bed moves in y the beam is a strip behind the nozzle.
#[test]
fn high_parts_stand_one_behind_the_other_where_the_beam_is_behind_the_head() {
    const FRONT: f64 = 45.0;
    let settings =
        settings(&[&PLAIN[..], &["printer.front_clearance=45"]].concat());
    let all = [
        wanted("high", HIGH, 3, &settings),
        wanted("low", LOW, 2, &settings),
    ];
    let plate = Plate::new("plate", &all, &settings).unwrap();
    let order = plate.order().unwrap();
    assert_eq!(order[..2], ["low_1", "low_2"]);
    let gcode = run(&plate, 2);
    let verdict =
        check(gcode.as_bytes(), &Rules::new(&plate.settings)).unwrap();
    assert!(verdict.is_safe(), "{:?}", verdict.findings);
    // Where the beads of each part are in y, and how high its last one is.
    let mut found: Vec<(String, f64, f64, f64)> = Vec::new();
    for way in ways(&gcode) {
        if way.label.is_empty() || way.fed <= 0.0 {
            continue;
        }
        if found.last().is_none_or(|part| part.0 != way.label) {
            found.push((way.label, f64::INFINITY, f64::NEG_INFINITY, 0.0));
        }
        if let Some(part) = found.last_mut() {
            part.1 = part.1.min(way.to.y);
            part.2 = part.2.max(way.to.y);
            part.3 = part.3.max(way.to.z);
        }
    }
    assert_eq!(found.len(), 5);
    for (k, first) in found.iter().enumerate() {
        for later in &found[k + 1..] {
            let passes = later.1 - first.2 >= FRONT;
            assert!(first.3 <= GANTRY || passes, "{first:?} {later:?}");
        }
    }
    // The check refuses the same file on a printer whose beam is anywhere.
    let anywhere = Rules::new(&crate::common::settings(&PLAIN));
    let verdict = check(gcode.as_bytes(), &anywhere).unwrap();
    let mut hits = verdict.findings.iter();
    assert!(hits.any(|f| f.message.contains("gantry_height")));

    let at = |name: &str, at: (f64, f64)| Wanted {
        at: Some(at),
        ..wanted(name, HIGH, 1, &settings)
    };
    let placed = |a, b| {
        let both = [at("a", a), at("b", b)];
        match Plate::new("plate", &both, &settings) {
            Ok(plate) => plate.order().unwrap().join(" "),
            Err(error) => error.to_string(),
        }
    };
    // Boxes of 12 mm: 45 mm apart in y, whichever is named first.
    assert_eq!(placed((110.0, 80.0), (50.0, 137.1)), "a b");
    assert_eq!(placed((110.0, 137.1), (50.0, 80.0)), "b a");
    let beside = placed((50.0, 80.0), (150.0, 130.0));
    assert!(beside.contains("45.0 mm in front"), "{beside}");
}

#[test]
fn parts_that_stand_in_the_way_are_named() {
    let error =
        |all: &[Wanted]| match Plate::new("plate", all, &all[0].settings) {
            Ok(_) => String::new(),
            Err(error) => error.to_string(),
        };
    let plain = settings(&PLAIN);
    let at = |name: &str, text: &str, x: f64| Wanted {
        at: Some((x, 110.0)),
        ..wanted(name, text, 1, &plain)
    };
    // Boxes of 10 and 12 mm, 39 mm apart.
    let near = error(&[at("a", LOW, 60.0), at("b", HIGH, 110.0)]);
    assert!(
        near.starts_with("b is 39.0 mm beside a, which is finished before it"),
        "{near}"
    );
    assert_eq!(error(&[at("a", LOW, 60.0), at("b", HIGH, 111.1)]), "");
    let high = error(&[wanted("tall", HIGH, 2, &plain)]);
    assert!(
        high.starts_with("tall_1 is 30.0 mm high, and tall_2 is printed after"),
        "{high}"
    );
    // Nothing of the head is below 7 mm.
    let above = "printer.head_clearance_radius=40 mm above 7 mm";
    let free = settings(&[&PLAIN[..], &[above]].concat());
    let close = [("a", 60.0), ("b", 75.0)].map(|(name, x)| Wanted {
        at: Some((x, 110.0)),
        ..wanted(name, LOW, 1, &free)
    });
    assert_eq!(error(&close), "");
    let unknown = settings(&["plate.sequence=one-by-one"]);
    let unknown = error(&[wanted("a", LOW, 2, &unknown)]);
    assert!(
        unknown.contains("printer.head_clearance_radius"),
        "{unknown}"
    );
    let shield = settings(&[&PLAIN[..], &["draft_shield=full"]].concat());
    let shield = error(&[wanted("a", LOW, 2, &shield)]);
    assert!(shield.contains("draft shield"), "{shield}");
    let full = error(&[wanted("a", LOW, 30, &plain)]);
    assert!(full.contains("40 mm between them"), "{full}");
}

#[test]
fn ranges_are_for_parts_that_grow_together() {
    let plate = plate(&[]);
    let options = Options {
        layers: "1..3".parse::<LayerRange>().unwrap(),
        ..Options::default()
    };
    let error = slice_plate(&plate, &options, &mut Vec::new());
    assert!(matches!(error, Err(SliceError::RangeOneByOne)), "{error:?}");
}

#[test]
fn supports_and_brims_keep_their_distance_too() {
    let mushroom = "min(max(sqrt(x^2+y^2) - 3, max(-z, z - 10)), \
         max(sqrt(x^2+y^2) - 8, max(8 - z, z - 10)))";
    // Supports lie between the layers of the part.
    let more = ["supports=auto", "brim.place=outer", "layer_height=0.15"];
    let settings_with =
        |own: &[&str]| settings(&[&PLAIN[..], &more[..], own].concat());
    let settings = settings_with(&[]);
    let all = [wanted("mushroom", mushroom, 3, &settings)];
    let plate = Plate::new("plate", &all, &settings).unwrap();
    let gcode = run(&plate, 2);
    assert!(gcode.contains(";TYPE:Support material"));
    let verdict = check(gcode.as_bytes(), &Rules::new(&settings)).unwrap();
    assert!(verdict.is_safe(), "{:?}", verdict.findings);
    let wider = settings_with(&["printer.head_clearance_radius=60"]);
    let verdict = check(gcode.as_bytes(), &Rules::new(&wider)).unwrap();
    let mut hits = verdict.findings.iter();
    assert!(hits.any(|f| f.kind == FindingKind::Collision));
    let ways = ways(&gcode);
    let of = |name: &str| {
        let own = ways.iter().filter(|way| way.label == name && way.fed > 0.0);
        own.map(|way| way.to.truncate()).collect::<Vec<_>>()
    };
    let all = ["mushroom_1", "mushroom_2", "mushroom_3"].map(of);
    for (i, a) in all.iter().enumerate() {
        for b in &all[..i] {
            let near = a.iter().flat_map(|p| b.iter().map(|q| p.distance(*q)));
            let near = near.fold(f64::INFINITY, f64::min);
            assert!(near >= RADIUS, "{near}");
        }
    }
}
