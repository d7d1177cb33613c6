//! What each firmware is told, for every example: nothing that it does not
//! know, and nothing that it would refuse.

use crate::common;
use crate::common::filament_area;
use crate::common::{examples, number, part, slice, slice_layers, text};
use glam::DVec2;
use isoslice::pipeline::{Options, slice_plate};
use isoslice::plate::Plate;
use std::collections::BTreeSet;

/// Coarse settings, which are quick, with all that a firmware can be told.
const ALL: [&str; 11] = [
    "sample_spacing=0.2",
    "accuracy=0.05",
    "layer_height=0.3",
    "retract.firmware=true",
    "retract.z_hop=0.2",
    "filament.pressure_advance=0.04",
    "gcode.progress=on",
    "gcode.labels=on",
    "gcode.thumbnails=16x16",
    "acceleration.outer_wall=600",
    "acceleration.first_layer=400",
];

/// Marlin 2: <https://marlinfw.org/meta/gcode/>.
const MARLIN: &[&str] = &[
    "G0", "G1", "G4", "G10", "G11", "G20", "G21", "G28", "G29", "G90", "G91",
    "G92", "M73", "M82", "M83", "M84", "M104", "M106", "M107", "M109", "M117",
    "M140", "M190", "M201", "M203", "M204", "M205", "M207", "M208", "M220",
    "M221", "M400", "M420", "M486", "M900",
];

/// Klipper: docs/G-Codes.md, and what `register_command` is called with in
/// klippy/gcode.py, klippy/toolhead.py and klippy/extras/{gcode_move,
/// display_status, exclude_object, fan, firmware_retraction, heaters,
/// print_stats}.py and klippy/kinematics/extruder.py.
const KLIPPER: &[&str] = &[
    "G0",
    "G1",
    "G4",
    "G10",
    "G11",
    "G20",
    "G21",
    "G28",
    "G90",
    "G91",
    "G92",
    "M73",
    "M82",
    "M83",
    "M84",
    "M104",
    "M106",
    "M107",
    "M109",
    "M117",
    "M140",
    "M190",
    "M204",
    "M220",
    "M221",
    "M400",
    "EXCLUDE_OBJECT_DEFINE",
    "EXCLUDE_OBJECT_START",
    "EXCLUDE_OBJECT_END",
    "SET_PRESSURE_ADVANCE",
    "SET_PRINT_STATS_INFO",
    "SET_RETRACTION",
    "SET_VELOCITY_LIMIT",
];

/// RepRapFirmware 3: <https://docs.duet3d.com/User_manual/Reference/Gcodes>.
/// M208 is not here: it would set how far the axes reach.
const RRF: &[&str] = &[
    "G0", "G1", "G4", "G10", "G11", "G20", "G21", "G28", "G29", "G90", "G91",
    "G92", "M73", "M82", "M83", "M84", "M104", "M106", "M109", "M117", "M140",
    "M190", "M201", "M203", "M204", "M207", "M220", "M221", "M400", "M486",
    "M566", "M572", "T0",
];

/// Prusa's firmwares: the comments above each command in
/// Firmware/Marlin_main.cpp of Prusa-Firmware, and lib/Marlin and
/// src/marlin_stubs of Prusa-Firmware-Buddy.
const PRUSA: &[&str] = &[
    "G0", "G1", "G4", "G10", "G11", "G20", "G21", "G28", "G29", "G80", "G90",
    "G91", "G92", "M73", "M82", "M83", "M84", "M104", "M106", "M107", "M109",
    "M115", "M117", "M140", "M190", "M201", "M203", "M204", "M205", "M207",
    "M208", "M220", "M221", "M400", "M486", "M572", "M862.1", "M862.3", "M900",
];

/// Bambu Lab's firmware: the commands in files of Bambu Studio.
const BAMBU: &[&str] = &[
    "G0", "G1", "G4", "G21", "G28", "G29", "G90", "G91", "G92", "M18", "M73",
    "M82", "M83", "M104", "M106", "M109", "M140", "M190", "M204", "M205",
    "M220", "M221", "M400", "M412", "M624", "M625", "M900", "M975", "M991",
];

/// A file's commands without comments.
fn commands(gcode: &str) -> impl Iterator<Item = &str> {
    gcode
        .lines()
        .map(|line| line.split(';').next().unwrap_or("").trim())
        .filter(|code| !code.is_empty())
}

fn word(code: &str) -> &str {
    code.split(' ').next().unwrap_or("")
}

/// Slices the lower layers of every example for a firmware and looks at each
/// file.
fn each_example(
    flavour: &str,
    known: &[&str],
    look: impl Fn(&str, &str, &Plate),
) {
    let flavour = format!("gcode.flavour={flavour}");
    let mut all = ALL.to_vec();
    all.push(&flavour);
    for example in examples() {
        let (model, settings) = example.place(&all);
        let (gcode, _) = slice_layers(&model, &settings, "1..24", 2);
        assert_known(&gcode, known);
        let count =
            |command| commands(&gcode).filter(|c| word(c) == command).count();
        let name = &example.name;
        assert!(count("G10") > 0, "{name}");
        let left = count("G10").abs_diff(count("G11"));
        assert!(left <= 1, "{name}: {left} retractions without a partner");
        let plate = Plate::of(&model, &settings);
        accelerations(&gcode, &plate);
        look(name, &gcode, &plate);
    }
    // A whole part tells how far it has come.
    let (model, settings) = part(BALL, &all);
    let (gcode, _) = slice(&model, &settings, 2);
    assert_known(&gcode, known);
    assert!(commands(&gcode).filter(|c| word(c) == "M73").count() > 10);
    look("test", &gcode, &Plate::of(&model, &settings));
}

/// Each bead has the acceleration of its role, told only where it changes.
#[track_caller]
fn accelerations(gcode: &str, Plate { settings: s, .. }: &Plate) {
    let klipper = text(s, "gcode.flavour") == "\"klipper\"";
    let word = if klipper { "M204 S" } else { "M204 P" };
    let mut layer = 0;
    let mut role = "";
    let mut now = None;
    let mut seen = BTreeSet::new();
    for line in gcode.lines() {
        if line == ";LAYER_CHANGE" {
            layer += 1;
        } else if let Some(name) = line.strip_prefix(";TYPE:") {
            role = name;
        } else if let Some(a) = line.strip_prefix(word)
            && layer > 0
        {
            let a: f64 = a.parse().unwrap();
            assert_ne!(now, Some(a), "told twice");
            now = Some(a);
        } else if layer > 0 && role != "Custom" && line.starts_with("G1 X") {
            let prints = line.contains(" E");
            let own = match (layer, role) {
                (1, _) => 400.0,
                (_, "External perimeter") => 600.0,
                _ => number(s, "printer.acceleration"),
            };
            let at = if prints {
                own
            } else if klipper {
                number(s, "printer.travel_acceleration")
            } else {
                continue;
            };
            assert_eq!(now, Some(at), "layer {layer}, {role}: {line}");
            seen.insert(at as u32);
        }
    }
    assert!(seen.contains(&400) && seen.contains(&600), "{seen:?}");
}

fn assert_known(gcode: &str, known: &[&str]) {
    for code in commands(gcode) {
        assert!(known.contains(&word(code)), "{code}");
    }
}

/// The lines of a file's head, in this order.
#[track_caller]
fn assert_head(name: &str, gcode: &str, lines: &[&str]) {
    let head = gcode.split(";LAYER_CHANGE").next().unwrap();
    let mut rest = head.lines();
    for line in lines {
        assert!(rest.any(|l| l == *line), "{name}: no {line} in\n{head}");
    }
}

#[test]
fn marlin_knows_every_line() {
    each_example("marlin", MARLIN, |name, gcode, s| {
        let corner = number(&s.settings, "printer.square_corner_velocity");
        let lines = [
            "M486 T1",
            "G28",
            "M204 P1000 T1500",
            &format!("M205 X{corner} Y{corner} J0.01"),
            "M900 K0.04",
            "M207 S0.8 F2100 Z0",
            "M208 S0 F2100",
        ];
        assert_head(name, gcode, &lines);
    });
}

#[test]
fn reprapfirmware_knows_every_line() {
    each_example("rrf", RRF, |name, gcode, _| {
        let label = format!("M486 S0 A\"{}\"", name.replace('-', "_"));
        let lines = [
            label.as_str(),
            "T0",
            "M109 S215",
            "M566 X300 Y300",
            "M572 D0 S0.04",
            "M207 S0.8 R0 F2100 T2100 Z0",
        ];
        // Examples may have another name than their files.
        let own: Vec<&str> = if gcode.contains(&label) {
            lines.to_vec()
        } else {
            lines[1..].to_vec()
        };
        assert_head(name, gcode, &own);
        // An S above 1 would count to 255, and 1 is full already.
        for fan in commands(gcode).filter(|c| word(c) == "M106") {
            let speed: f64 = fan["M106 S".len()..].parse().unwrap();
            assert!((0.0..=1.0).contains(&speed), "{fan}");
        }
    });
}

#[test]
fn prusa_firmware_knows_every_line() {
    each_example("prusa", PRUSA, |name, gcode, _| {
        let lines = [
            "M862.1 P0.4",
            "G28",
            "M205 X5 Y5",
            "M900 K0.04",
            "M208 S0 F2100",
        ];
        assert_head(name, gcode, &lines);
    });
}

#[test]
fn bambu_firmware_knows_every_line() {
    let own = [
        "gcode.flavour=bambu",
        "gcode.comments=bambu",
        "gcode.relative_e=true",
        "filament.pressure_advance=0.02",
        "gcode.end=M104 S0\nM140 S0\nM18 X Y Z",
    ];
    let (model, settings) = part(BALL, &own);
    let (gcode, _) = slice(&model, &settings, 2);
    assert_known(&gcode, BAMBU);
    for line in ["M204 S1000", "M205 X5 Y5", "M900 K0.02 L1000 M10"] {
        let head = gcode.split("; CHANGE_LAYER").next().unwrap();
        assert!(head.lines().any(|l| l == line), "{line}: {head}");
    }
    let count = |line: &str| gcode.lines().filter(|l| *l == line).count();
    let layers = count("; CHANGE_LAYER");
    assert!(layers > 10);
    for (k, number) in (1..=layers).enumerate() {
        assert_eq!(count(&format!("M73 L{number}")), 1);
        assert_eq!(count(&format!("M991 S0 P{k}")), 1);
    }
    assert_eq!(count("; model label id: 1"), 1);
    // The label has the first of 64 bits.
    assert_eq!(count("M624 AQAAAAAAAAA="), layers);
    assert_eq!(count("M625"), layers);
    assert!(gcode.contains("\n; FEATURE: Outer wall\n"));
    assert!(gcode.contains("\n; LINE_WIDTH: 0.45\n"));
    assert!(!gcode.contains("\nM107"));
    assert!(gcode.contains("\nM73 P100 R0\n"));
}

/// More parts than Bambu Lab's firmware tells apart have no labels, which is said.
#[test]
fn too_many_parts_for_labels_are_told() {
    let own = [&ALL[..3], &["gcode.flavour=bambu"]].concat();
    let settings = common::settings(&own);
    let labels = |copies: u64| {
        let dot = "max(hypot(x, y) - 1.5, abs(z - 0.3) - 0.3)";
        let all = [common::wanted("dot", dot, copies, &settings)];
        let plate = Plate::new("plate", &all, &settings).unwrap();
        let mut gcode = Vec::new();
        let options = Options::default();
        let summary = slice_plate(&plate, &options, &mut gcode).unwrap();
        let text = String::from_utf8(gcode).unwrap();
        let told = summary.warnings.iter();
        let told = told.filter(|w| w.starts_with("gcode.labels: no part"));
        (text.matches("M624 ").count() > 0, told.count())
    };
    assert_eq!(labels(64), (true, 0));
    assert_eq!(labels(65), (false, 1));
}

#[test]
fn klipper_knows_every_line_and_refuses_none() {
    each_example("klipper", KLIPPER, |name, gcode, s| {
        let lines = [
            "G28",
            "SET_VELOCITY_LIMIT ACCEL=1500 SQUARE_CORNER_VELOCITY=5",
            "SET_PRESSURE_ADVANCE ADVANCE=0.04",
            "SET_RETRACTION RETRACT_LENGTH=0.8 RETRACT_SPEED=35 \
             UNRETRACT_EXTRA_LENGTH=0 UNRETRACT_SPEED=35",
        ];
        assert_head(name, gcode, &lines);
        for code in commands(gcode) {
            klipper_parses(code);
        }
        klipper_extrudes(gcode, s);
        klipper_objects(gcode, s);
    });
}

/// The forms of Klipper's parameters.
fn klipper_parses(code: &str) {
    let mut words = code.split(' ');
    let command = words.next().unwrap();
    let words: Vec<&str> = words.collect();
    if command.contains('_') {
        assert!(words.iter().all(|w| w.contains('=')), "{code}");
        return;
    }
    for w in &words {
        let (letter, value) = w.split_at(1);
        assert!(letter.chars().all(|c| c.is_ascii_uppercase()), "{code}");
        assert!(value.parse::<f64>().is_ok(), "{code}");
    }
    let has = |letter: char| words.iter().any(|w| w.starts_with(letter));
    match command {
        "M204" => assert!(has('S') || has('P') && has('T'), "{code}"),
        "M109" | "M190" => assert!(has('S') && !has('R'), "{code}"),
        "G4" => assert!(has('P') && !has('S'), "{code}"),
        "M73" => assert!(has('P') && !has('R'), "{code}"),
        _ => {}
    }
}

/// What klippy/kinematics/extruder.py refuses, by its defaults.
fn klipper_extrudes(gcode: &str, Plate { settings: s, .. }: &Plate) {
    let filament = filament_area(number(s, "filament.diameter"));
    let nozzle = number(s, "printer.nozzle_diameter");
    let greatest = 4.0 * nozzle * nozzle / filament;
    let (mut at, mut e) = (DVec2::NAN, 0.0);
    for code in commands(gcode) {
        match word(code) {
            "G92" => e = 0.0,
            "G1" => {
                let mut to = at;
                let mut fed = 0.0;
                for w in code.split(' ').skip(1) {
                    let value: f64 = w[1..].parse().unwrap();
                    match &w[..1] {
                        "X" => to.x = value,
                        "Y" => to.y = value,
                        "E" if text(s, "gcode.relative_e") == "true" => {
                            fed = value
                        }
                        "E" => fed = value - std::mem::replace(&mut e, value),
                        _ => {}
                    }
                }
                let length = at.distance(to);
                at = to;
                let alone = length.is_nan() || length == 0.0 || fed < 0.0;
                if alone {
                    assert!(fed.abs() <= 50.0, "{code}");
                } else if fed > nozzle * greatest {
                    assert!(fed / length <= greatest, "{code}");
                }
            }
            _ => {}
        }
    }
}

/// klippy/extras/exclude_object.py: the shape of what is defined, and that
/// each start has its end.
fn klipper_objects(gcode: &str, Plate { settings: s, .. }: &Plate) {
    let mut open = false;
    let mut name = "";
    for code in commands(gcode) {
        let value = |key: &str| {
            let mut words = code.split(' ');
            words.find_map(|w| w.strip_prefix(key)?.strip_prefix('='))
        };
        match word(code) {
            "EXCLUDE_OBJECT_DEFINE" => {
                name = value("NAME").unwrap();
                let ring: Vec<[f64; 2]> =
                    serde_json::from_str(value("POLYGON").unwrap()).unwrap();
                assert!(ring.len() >= 3, "{code}");
                let bed = DVec2::new(
                    number(s, "printer.bed_x"),
                    number(s, "printer.bed_y"),
                );
                for &[x, y] in &ring {
                    let p = DVec2::new(x, y);
                    assert!(p.cmpge(DVec2::ZERO).all() && p.cmple(bed).all());
                }
                let centre = value("CENTER").unwrap().split_once(',').unwrap();
                assert!(centre.0.parse::<f64>().is_ok());
            }
            "EXCLUDE_OBJECT_START" => {
                assert!(!open);
                assert_eq!(value("NAME"), Some(name));
                open = true;
            }
            "EXCLUDE_OBJECT_END" => {
                assert!(open);
                assert_eq!(value("NAME"), Some(name));
                open = false;
            }
            "SET_PRINT_STATS_INFO" => assert!(!open, "a layer in the label"),
            _ => {}
        }
    }
    assert!(!open && !name.is_empty());
}

const BALL: &str = "sqrt(x^2 + y^2 + z^2) - 8";

/// The label's outline is the part's, seen from above.
#[test]
fn the_outline_for_klipper_is_the_parts() {
    let (model, settings) = part(BALL, &["gcode.flavour=klipper"]);
    let (gcode, _) = slice(&model, &settings, 2);
    let line = commands(&gcode).find(|c| c.contains("POLYGON=")).unwrap();
    assert!(line.contains(" CENTER=110,110 "), "{line}");
    let ring = line.split("POLYGON=").nth(1).unwrap();
    let ring: Vec<[f64; 2]> = serde_json::from_str(ring).unwrap();
    assert!(ring.len() > 20);
    for [x, y] in ring {
        // A pixel of 0.16 mm, to its corner.
        let r = DVec2::new(x - 110.0, y - 110.0).length();
        assert!((7.9..=8.3).contains(&r), "{r}");
    }
    // The skirt is not part of the label's outline.
    let first = gcode.split(";LAYER_CHANGE").nth(1).unwrap();
    let skirt = first.find(";TYPE:Skirt/Brim").unwrap();
    let start = first.find("EXCLUDE_OBJECT_START").unwrap();
    assert!(skirt < start && start < first.find(";TYPE:Perimeter").unwrap());
}

/// Minutes and percents, in order.
fn progress(gcode: &str) -> Vec<(u32, u64)> {
    commands(gcode)
        .filter_map(|c| c.strip_prefix("M73 P"))
        .map(|c| {
            let (percent, minutes) = c.split_once(" R").unwrap();
            (percent.parse().unwrap(), minutes.parse().unwrap())
        })
        .collect()
}

#[test]
fn progress_goes_from_nothing_to_all() {
    let (model, settings) = part(BALL, &["gcode.flavour=prusa"]);
    let (gcode, summary) = slice(&model, &settings, 2);
    let all = progress(&gcode);
    let minutes = (summary.time / 60.0).round() as u64;
    assert_eq!(all.first(), Some(&(0, minutes)));
    assert_eq!(all.last(), Some(&(100, 0)));
    for pair in all.windows(2) {
        assert!(pair[0].0 <= pair[1].0 && pair[0].1 >= pair[1].1);
        assert_ne!(pair[0], pair[1]);
    }
    // Layers of seconds: no step of more than a few percent.
    assert!(all.windows(2).all(|p| p[1].0 - p[0].0 <= 5), "{all:?}");
    let (again, _) = slice(&model, &settings, 1);
    assert_eq!(gcode, again);
    // By default Marlin is told as well, and nobody else.
    for (flavour, told) in
        [("marlin", true), ("klipper", false), ("rrf", false)]
    {
        let (model, settings) =
            part(BALL, &[&format!("gcode.flavour={flavour}")]);
        let gcode = slice(&model, &settings, 2).0;
        assert_eq!(gcode.contains("\nM73 P100"), told, "{flavour}");
    }
}

/// Files of ranges do not know the whole print's time. They have no such lines,
/// and do not differ otherwise.
#[test]
fn ranges_tell_no_progress_and_are_the_same_otherwise() {
    fn body(gcode: &str) -> String {
        let from = gcode.find(";LAYER_CHANGE\n").unwrap();
        let to = gcode.find("; end of layers\n").unwrap();
        let lines = gcode[from..to].lines();
        let rest: Vec<&str> = lines.filter(|l| !l.starts_with("M73")).collect();
        rest.join("\n")
    }
    let layer = "gcode.layer=TIMELAPSE N={{ layer }} Z={{ layer_z }}";
    for flavour in ["prusa", "marlin", "rrf", "klipper"] {
        let flavour = format!("gcode.flavour={flavour}");
        let extra = ["retract.firmware=true", "gcode.labels=on"];
        let (model, settings) = part(
            BALL,
            &[&flavour, layer, extra[0], extra[1], "layer_height=0.25"],
        );
        let (whole, _) = slice(&model, &settings, 2);
        let joined: Vec<String> = ["1..20", "21..40", "41.."]
            .iter()
            .map(|range| slice_layers(&model, &settings, range, 1).0)
            .inspect(|part| assert!(!part.contains("M73")))
            .map(|part| body(&part))
            .collect();
        assert!(body(&whole) == joined.join("\n"), "{flavour}");
        assert!(whole.contains("\nTIMELAPSE N=7 Z=1.7\n"), "{flavour}");
    }
}

/// A template that moves away costs nothing but the way back.
#[test]
fn a_layer_template_may_do_what_it_likes() {
    let lines = "gcode.layer=G91\nG1 Z5 F600\nG90\nG1 X0 Y0 F6000\nM106 S0";
    for relative in ["gcode.relative_e=true", "gcode.relative_e=false"] {
        let (model, plain) = part(BALL, &[relative]);
        let (without, said) = slice(&model, &plain, 2);
        let without = common::parse(&without);
        let (model, settings) = part(BALL, &[relative, lines]);
        let (gcode, summary) = slice(&model, &settings, 2);
        assert_eq!(summary.warnings, said.warnings);
        assert!(gcode.contains("G1 X0 Y0 F6000\nM106 S0\nG21\nG90\nM8"));
        // What is printed is the same, from the same place.
        let prints = |layers: &[common::Layer]| -> Vec<[f64; 5]> {
            let all = layers.iter().skip(1).flat_map(|l| l.prints());
            let figures = all.map(|m| {
                let fed = (m.fed * 1e4).round();
                [m.from.x, m.from.y, m.to.x, m.to.y, fed]
            });
            figures.collect()
        };
        let rest: String = gcode
            .lines()
            .filter(|l| !["G91", "G1 Z5 F600", "G1 X0 Y0 F6000"].contains(l))
            .map(|l| format!("{l}\n"))
            .collect();
        let (a, b) = (prints(&common::parse(&rest)), prints(&without));
        assert_eq!(a.len(), b.len());
        assert!(a.iter().zip(&b).all(|(a, b)| {
            a.iter().zip(b).all(|(a, b)| (a - b).abs() <= 1.0)
        }));
        // The fan is set again after the template.
        let layers: Vec<&str> = gcode.split(";LAYER_CHANGE").collect();
        assert!(layers[5].contains("\nM106 S255\n"));
    }
}

#[test]
fn klipper_is_warned_of_purge_lines_that_it_refuses() {
    let start = "gcode.start=M109 S210\nG28\nG1 X0 Y0 F6000\nG1 X20 E15 F600";
    let (model, settings) = part(BALL, &["gcode.flavour=klipper", start]);
    let (_, summary) = slice(&model, &settings, 2);
    let warned = summary.warnings.join("\n");
    assert!(warned.contains("max_extrude_cross_section"), "{warned}");
    assert!(warned.contains("gcode.start, line 4"), "{warned}");
}
