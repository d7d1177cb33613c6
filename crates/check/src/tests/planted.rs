//! Faults planted into a clean print of two layers.

use super::*;

/// A square of 12 mm, filled with lines, at a height. Travels are retracted.
fn layer(z: f64) -> String {
    let mut text = format!(
        ";LAYER_CHANGE\n;Z:{z:.1}\n;HEIGHT:0.2\n;WIDTH:0.45\nG1 E-0.8 F2100\n\
         G1 Z{z:.1} F600\nG1 X50 Y50 F9000\nG1 E0.8 F2100\nG1 F1800\n"
    );
    for k in 0..30 {
        let (y, x) = (50.0 + 0.4 * f64::from(k), 50 + 12 * ((k + 1) % 2));
        text += &format!("G1 X{x} E0.406\nG1 Y{:.1} E0.0135\n", y + 0.4);
    }
    text
}

/// A clean print, with `planted` in the middle of its second layer.
fn print_with(planted: &str) -> String {
    let (first, second) = (layer(0.2), layer(0.4));
    let at = second.find("G1 Y56").unwrap();
    let (before, after) = second.split_at(at);
    let head = "G28\nM109 S200\nM83\n;TYPE:Perimeter\n";
    format!("{head}{first}{before}{planted}{after}{}{END}", layer(0.6))
}

/// What is found, each with its line counted from the planted one.
fn found(planted: &str) -> Vec<(FindingKind, i64)> {
    let text = print_with(planted);
    let clean = print_with("");
    let same = text.lines().zip(clean.lines()).take_while(|(a, b)| a == b);
    let line = same.count() as i64;
    let all = verdict(&text);
    let findings = all.findings.iter();
    findings.map(|f| (f.kind, f.line as i64 - line)).collect()
}

#[test]
fn a_clean_print_is_clean() {
    let all = verdict(&print_with(""));
    assert!(all.counts.is_empty(), "{all:#?}");
}

#[test]
fn no_filament_is_pushed_in_place() {
    for blob in [
        "G1 E+80 F200\nG1 F1800\n",
        "G1 E1 F200\nG1 F1800\n",
        "M82\nG92 E0\nG1 E80 F200\nG92 E0\nM83\nG1 F1800\n",
        "G1 Z0.9 E5 F600\nG1 Z0.4\nG1 F1800\n",
    ] {
        let first = blob
            .lines()
            .position(|l| l.contains("E8") || l.contains("F"));
        let line = first.unwrap() as i64 + 1;
        assert_eq!(found(blob), [(FindingKind::Blob, line)], "{blob}");
    }
    // Many small drops are one blob.
    let drops = "G1 E0.2 F200\n".repeat(9);
    assert_eq!(
        found(&format!("{drops}G1 F1800\n")),
        [(FindingKind::Blob, 3)]
    );
    for fine in [
        "G1 E-0.8 F2100\nG1 E0.9\nG1 F1800\n",
        // What a user's own template does is the user's own choice.
        ";TYPE:Custom\nG1 E80 F200\nG1 F1800\n;TYPE:Perimeter\n",
        // A tower takes what a new filament pushes out.
        ";TYPE:Wipe tower\nG1 E80 F200\nG1 F1800\n;TYPE:Perimeter\n",
    ] {
        assert_eq!(found(fine), [], "{fine}");
    }
    // The end unloads and loads.
    let end = print_with("").replace(END, "G1 E40 F200\nM104 S0\n");
    assert!(verdict(&end).counts.is_empty());
    let more = ["retract.extra_prime=2"];
    let all = verdict_with(&print_with("G1 E2.4 F200\nG1 F1800\n"), &more);
    assert_eq!(count(&all, FindingKind::Blob), 0);
}

#[test]
fn the_nozzle_does_not_go_down_into_the_print() {
    let dive = |z: f64| found(&format!("G1 Z{z} F600\nG1 Z0.4\nG1 F1800\n"));
    assert_eq!(dive(0.0), [(FindingKind::Low, 1)]);
    // A scarf begins within its layer.
    assert_eq!(dive(0.22), []);
    // Relative moves are followed.
    let deep = "G91\nG1 Z-0.4 F600\nG1 Z0.4\nG90\nM83\nG1 F1800\n";
    assert_eq!(found(deep), [(FindingKind::Low, 2)]);
    // More than the nozzle is wide is a fault.
    let tall: String = (4..12).map(|k| layer(0.2 * f64::from(k))).collect();
    let text = print_with("").replace(END, &tall);
    let over = |end: &str| {
        let text = format!("{text}G1 Z0.9 F600\n{end}{END}");
        let all = verdict(&text);
        (count(&all, FindingKind::Dive), all.is_safe())
    };
    assert_eq!(over("G1 Z2.2\nG1 F1800\nG1 X60 E0.3\n"), (1, false));
    assert_eq!(over(""), (1, false), "the part is finished, and spoiled");
    // Ends are looked at, too, wherever they lead.
    let ends = |end: &str| {
        let all = verdict(&format!("{text};TYPE:Custom\n{end}{END}"));
        (
            count(&all, FindingKind::Dive),
            count(&all, FindingKind::Low),
        )
    };
    assert_eq!(ends("G1 Z0 F600\n"), (1, 0));
    assert_eq!(ends("G1 X60 Y60 Z0 F600\n"), (1, 0));
    assert_eq!(ends("G1 X20 F6000\nG1 Z0 F600\n"), (0, 0));
    assert_eq!(ends("G1 X20 Y60 F6000\nG1 Z0.5 F600\nG1 X90\n"), (0, 1));
    // Beds that go down are homed at their lower end.
    assert_eq!(ends("G28 Z\nG1 X60 Y60 F6000\n"), (0, 0));
    assert_eq!(dive(2.0), []);
}

#[test]
fn nothing_is_measured_in_the_middle_of_a_print() {
    for code in [
        "G29",
        "G30",
        "G32",
        "G33",
        "G34",
        "G35",
        "G80",
        "M48",
        "M81",
        "M420 S0",
        "BED_MESH_CALIBRATE",
        "bed_mesh_clear",
        "Z_TILT_ADJUST",
        "QUAD_GANTRY_LEVEL",
        "PROBE",
        "G425",
        "M401",
        "BED_MESH_OFFSET X=1",
        "SET_GCODE_OFFSET X=3",
        // These move the head away.
        "G12",
        "G27",
        "G42 I1 J1",
        "G61",
    ] {
        let line = format!("{code}\n");
        assert_eq!(found(&line), [(FindingKind::Harmful, 1)], "{code}");
        // Before and after the print these commands are usual.
        let beside = format!("{line}{}{line}", print_with(""));
        assert!(verdict(&beside).counts.is_empty(), "{code}");
    }
}

#[test]
fn no_bead_begins_with_a_tool_that_cools() {
    for code in ["M568 P0 A0", "M568 A1", "M568 P0 A2\nM568 P0 A0"] {
        let kinds = found(&format!("{code}\n"));
        assert!(kinds.iter().any(|k| k.0 == FindingKind::Cold), "{code}");
    }
    // The tool is taken again, heated again, or another one.
    for code in [
        "M568 P0 A1\nM568 P0 A2",
        "M568 A1\nT0",
        "M568 A0\nM109 S200",
    ] {
        assert_eq!(found(&format!("{code}\n")), [], "{code}");
    }
    assert_eq!(found("M568 P1 A0\n"), []);
}

#[test]
fn axes_are_not_homed_over_a_print() {
    for code in ["G28", "G28 Z", "g28 w", "G28 X Y"] {
        let kinds = found(&format!("{code}\n"));
        assert_eq!(kinds[0], (FindingKind::Harmful, 1), "{code}");
    }
}

/// After the print, too, z is not homed where something is printed.
#[test]
fn z_is_not_homed_over_a_finished_print() {
    let over = |code: &str| {
        let file = format!("{code}\n{}{code}\n", print_with(""));
        verdict(&file).counts.into_iter().collect::<Vec<_>>()
    };
    // Where the head is after all axes are homed, nothing is printed.
    for code in ["G28", "g28 w", "G28 X Y", "G28 X0 Y0"] {
        assert_eq!(over(code), [], "{code}");
    }
    assert_eq!(over("G28 Z"), [(FindingKind::Changed, 1)]);
    let aside = format!("{}G1 Z9 F600\nG1 X200 F6000\nG28 Z\n", print_with(""));
    assert!(verdict(&format!("G28\n{aside}")).counts.is_empty());
    // The middle of this bed is within the print.
    let small = ["printer.bed_x=110", "printer.bed_y=110"];
    for code in ["G28", "G28 Z"] {
        let file = format!("G28\n{}{code}\n", print_with(""));
        let all = verdict_with(&file, &small);
        assert_eq!(count(&all, FindingKind::Changed), 1, "{code}: {all:?}");
    }
}

#[test]
fn motors_keep_their_places() {
    for code in ["M84", "M18 X", "M84 X Y E"] {
        let kinds = found(&format!("{code}\n"));
        assert!(kinds.contains(&(FindingKind::Harmful, 1)), "{code}");
        let after = format!("{}{code}\n", print_with(""));
        assert!(verdict(&after).counts.is_empty(), "{code}");
    }
    assert_eq!(found("M84 S120\n"), []);
    assert_eq!(found("M84 E\n"), []);
}

/// Some commands are to be looked at anywhere, and are faults in the middle.
#[test]
fn no_step_or_offset_changes_in_the_middle_of_a_print() {
    for code in [
        "M92 E140",
        "M851 Z-1.2",
        "M206 Z-0.2",
        "M218 T1 X3",
        "G10 P0 X3",
        "M501",
        "M666 X0.3",
        "M350 X32",
        "G26",
        "G38.2 Z0",
        "MANUAL_PROBE",
        "PROBE_CALIBRATE",
        "SHAPER_CALIBRATE",
        "SET_SKEW CLEAR=1",
        "SET_STEPPER_ENABLE STEPPER=stepper_x ENABLE=0",
    ] {
        let line = format!("{code}\n");
        assert_eq!(found(&line), [(FindingKind::Harmful, 1)], "{code}");
        let all = verdict(&format!("{line}{}", print_with("")));
        let kinds: Vec<_> = all.counts.into_iter().collect();
        assert_eq!(kinds, [(FindingKind::Changed, 1)], "{code}");
    }
}

#[test]
fn what_may_move_something_in_the_middle_is_to_be_looked_at() {
    for code in [
        "M280 P0 S10",
        "M140 S0",
        "M190 S0",
        "M144",
        "SET_HEATER_TEMPERATURE HEATER=heater_bed TARGET=0",
        "M402",
        "SET_SERVO SERVO=probe ANGLE=10",
        "SET_GCODE_OFFSET Z=0.05",
        "SET_GCODE_OFFSET Z_ADJUST=-0.02",
    ] {
        let line = format!("{code}\n");
        assert_eq!(found(&line), [(FindingKind::Changed, 1)], "{code}");
        let word = code.split(' ').next().unwrap();
        let told = verdict(&print_with(&line)).findings;
        assert!(told.iter().any(|f| f.message.starts_with(word)), "{code}");
        let beside = format!("{line}{}{line}", print_with(""));
        let all = verdict(&beside);
        assert_eq!(count(&all, FindingKind::Changed), 0, "{code}");
    }
    for step in ["M290 Z0.05", "M290 S-0.1", "M290 X1"] {
        let line = format!("{step}\n");
        assert_eq!(found(&line), [(FindingKind::Changed, 1)], "{step}");
    }
    assert_eq!(found("M290 Z0\n"), []);
    assert_eq!(found("M280 P0 S90\n"), []);
}

#[test]
fn a_head_that_was_parked_is_brought_back() {
    let back = "G1 X62 Y56 F9000\nG1 Z0.4 F600\nG1 E0.8 F2100\nG1 F1800\n";
    for park in ["G27", "G12", "G28 X Y", "G61"] {
        let parked = |back: &str| {
            let lines = format!("G1 E-0.8 F2100\n{park}\n{back}");
            let all = verdict(&print_with(&lines));
            count(&all, FindingKind::Harmful)
        };
        assert_eq!(parked(back), 0, "{park}");
        let flat = back.replace("G1 Z0.4 F600\n", "");
        assert_eq!(parked(&flat), 1, "{park}");
    }
}

/// A file whose slicer calls overhangs by their name has no other walls in the
/// air.
#[test]
fn a_print_that_goes_on_beside_itself_is_found() {
    let with = |wall: &str, by: f64| {
        let ring = |z: f64, x: f64| {
            let [l, r] = [x, x + 20.0];
            format!(
                ";LAYER_CHANGE\n;Z:{z:.1}\n;HEIGHT:0.2\n;WIDTH:0.45\n\
                 ;TYPE:{wall}\nG1 Z{z:.1} F600\nG1 X{l} Y50 F9000\nG1 F1800\n\
                 G1 X{r} E0.66\nG1 Y70 E0.66\nG1 X{l} E0.66\nG1 Y50 E0.66\n"
            )
        };
        let rings = (1..9).map(|k| {
            ring(0.2 * f64::from(k), if k < 5 { 50.0 } else { 50.0 + by })
        });
        let rings: String = rings.collect();
        verdict(&format!("G28\nM109 S200\nM83\n{rings}{END}"))
    };
    for by in [3.0, 8.0, -3.0] {
        for wall in ["External perimeter", "Outer wall"] {
            let all = with(wall, by);
            assert_eq!(count(&all, FindingKind::Adrift), 1, "{by} {wall}");
            assert_eq!(all.counts.len(), 1);
        }
        // Cura has one name for all outer walls.
        assert!(with("WALL-OUTER", by).counts.is_empty());
    }
    for by in [0.0, 0.3] {
        assert!(with("External perimeter", by).counts.is_empty(), "{by}");
    }
}

#[test]
fn numbers_are_never_too_large_for_the_rules() {
    for (line, kind) in [
        ("M206 Z-10000000000", FindingKind::Harmful),
        ("M851 Z9999999999999999999999", FindingKind::Harmful),
        ("M290 Z-1000000000", FindingKind::Harmful),
        ("M104 S10000000000", FindingKind::TooHot),
        ("M190 S99999999999999999999999", FindingKind::TooHot),
        (
            "SET_HEATER_TEMPERATURE HEATER=extruder TARGET=1e12",
            FindingKind::TooHot,
        ),
        ("M204 P10000000000", FindingKind::Changed),
        ("M106 S10000000000", FindingKind::Changed),
        ("G4 P99999999999", FindingKind::Changed),
        ("SET_GCODE_OFFSET Z=nan", FindingKind::Senseless),
        ("G1 X10000000000", FindingKind::Senseless),
        ("G1 E10000000000", FindingKind::Blob),
    ] {
        let kinds = found(&format!("{line}\n"));
        assert_eq!(kinds.first(), Some(&(kind, 1)), "{line}: {kinds:?}");
    }
    let offset = found("SET_GCODE_OFFSET Z=-10000000000\nG1 Z0.4 F600\n");
    assert!(offset.contains(&(FindingKind::OutOfReach, 2)), "{offset:?}");
}

#[test]
fn the_first_layer_lies_on_the_bed() {
    let with = |z: &str| {
        let text = print_with("").replacen("G1 Z0.2", &format!("G1 Z{z}"), 1);
        let all = verdict(&text);
        let first = all.findings.iter().find(|f| f.kind == FindingKind::OffBed);
        first.map(|f| (f.line, f.message.clone()))
    };
    assert_eq!(with("0.2"), None);
    // Offsets make up for an end stop.
    assert_eq!(with("0.15"), None);
    assert_eq!(with("0.28"), None);
    let (line, said) = with("0").unwrap();
    assert!(
        line == 14 && said.contains("with the nozzle on the bed"),
        "{said}"
    );
    let (_, said) = with("0.4").unwrap();
    assert!(said.contains("0.20 mm of air"), "{said}");
    let (_, said) = with("1.8").unwrap();
    assert!(said.contains("1.60 mm of air"), "{said}");
    // Without comments a bead is no higher than the nozzle is wide.
    let bare = |z: f64| {
        let text = format!(
            "G28\nM109 S200\nM83\nG1 Z{z} F600\nG1 X50 Y50 F6000\n\
             G1 X80 E1.2 F1800\nG1 Y80 E1.2\n{END}"
        );
        count(&verdict(&text), FindingKind::OffBed)
    };
    assert_eq!((bare(0.35), bare(1.8), bare(0.0)), (0, 2, 2));
    // What rises begins a wall that climbs; what follows it in the air does not.
    let rising = |to: &str| {
        let text = format!(
            "G28\nM109 S200\nM83\n;LAYER_CHANGE\n;Z:0.2\nG1 Z0.2 F600\n\
             G1 X50 Y50 F6000\nG1 X80 Z{to} E1.2 F1800\nG1 Y80 E1.2\n{END}"
        );
        count(&verdict(&text), FindingKind::OffBed)
    };
    assert_eq!((rising("0.3"), rising("0.6")), (0, 1));
}

#[test]
fn no_layer_is_left_out() {
    let bare = |heights: &[u32]| {
        let layers = heights.iter().map(|k| layer(0.2 * f64::from(*k)));
        let text: String = layers.collect();
        let head = "G28\nM109 S200\nM83\n;TYPE:WALL-OUTER\n";
        let text = format!("{head}{text}{END}").replace(";LAYER_CHANGE\n", "");
        let text = text.replace(";HEIGHT:0.2\n", "");
        let all = verdict(&text.replace(";WIDTH:0.45\n", ""));
        all.counts.into_iter().collect::<Vec<_>>()
    };
    assert_eq!(bare(&[1, 2, 3, 4, 5, 6]), []);
    assert_eq!(bare(&[1, 2, 3, 5, 6, 7]), [(FindingKind::Jump, 1)]);
    assert_eq!(bare(&[1, 2, 3, 5, 6, 8, 9]), [(FindingKind::Jump, 2)]);
}

/// A part that stands on an edge hangs above the bed on both sides.
#[test]
fn what_hangs_above_the_bed_is_no_missing_layer() {
    let beside = |z| layer(z).replace("X50", "X64").replace("X62", "X76");
    let head = "G28\nM109 S200\nM83\n;TYPE:Perimeter\n";
    let hanging = format!("{}{}{}", layer(0.2), beside(0.4), beside(0.6));
    let text = format!("{head}{hanging}{END}");
    let jumps = |text: &str| count(&verdict(text), FindingKind::Jump);
    assert_eq!(jumps(&text), 0);
    let missing = format!("{head}{}{}{END}", layer(0.2), layer(0.6));
    assert_eq!(jumps(&missing), 1);
}

#[test]
fn the_print_is_not_shifted() {
    for shift in ["G92 X60\n", "G92 Y50\n", "G92 X50 Y50 E0\n", "G92\n"] {
        let kinds = found(shift);
        assert!(
            kinds.contains(&(FindingKind::Harmful, 1)),
            "{shift}: {kinds:?}"
        );
        // Before and after the print this is usual.
        let (start, end) = ("G92 X0 Y0\nG28\n", "G92 X0 Y0\n");
        let beside = format!("{start}{}{end}", print_with(""));
        assert!(verdict(&beside).counts.is_empty());
    }
    assert_eq!(found("G92 E0\n"), []);
}

#[test]
fn beads_take_the_filament_that_the_file_tells() {
    let with = |said: f64| {
        let said = format!("; filament used [mm] = {said}\n");
        let all = verdict(&format!("{}{said}", print_with("")));
        all.counts.into_iter().collect::<Vec<_>>()
    };
    assert_eq!(with(37.8), []);
    assert_eq!(with(18.9), [(FindingKind::Flow, 1)]);
    // A start may purge any length.
    assert_eq!(with(120.0), []);
}

#[test]
fn no_layer_is_printed_twice() {
    let twice = |head: &str| {
        let again = format!("{}{}", layer(0.4), layer(0.4));
        let text = print_with("").replace(&layer(0.4), &again);
        let all = verdict(&text.replace(";LAYER_CHANGE\n", head));
        all.counts.into_iter().collect::<Vec<_>>()
    };
    assert_eq!(twice(";LAYER_CHANGE\n"), [(FindingKind::Again, 1)]);
    // A file without marks has one layer there, with twice the plastic.
    let kinds = twice("");
    assert!(kinds.contains(&(FindingKind::Again, 1)), "{kinds:?}");
    assert!(kinds.contains(&(FindingKind::Flow, 1)), "{kinds:?}");
}

#[test]
fn plastic_is_as_much_as_there_is_room_for() {
    let with = |share: f64, said: bool| {
        let mut text = String::new();
        for line in print_with("").lines() {
            let fed =
                line.split_once(" E0.").filter(|_| !line.ends_with("F2100"));
            match fed {
                Some((way, fed)) => {
                    let fed: f64 = format!("0.{fed}").parse().unwrap();
                    text += &format!("{way} E{:.5}\n", share * fed);
                }
                None if !said && line.starts_with(';') => {}
                None => text += &format!("{line}\n"),
            }
        }
        let all = verdict(&text);
        (count(&all, FindingKind::Flow), all.is_safe())
    };
    for said in [true, false] {
        for usual in [0.6, 1.0, 1.2] {
            assert_eq!(with(usual, said), (0, true), "{usual} {said}");
        }
        for wrong in [0.1, 2.0, 5.0, 14.0] {
            assert_eq!(with(wrong, said), (3, false), "{wrong} {said}");
        }
    }
    let double = print_with("").replace("M83\n", "M83\nM221 S200\n");
    assert_eq!(count(&verdict(&double), FindingKind::Flow), 3);
    let all = verdict_with(&double, &["flow=200"]);
    assert_eq!(count(&all, FindingKind::Flow), 0);
}

#[test]
fn a_file_without_filament_prints_nothing() {
    let dry = |text: &str| {
        let lines = text.lines().map(|line| match line.split_once(" E") {
            Some((way, _)) => way,
            None => line,
        });
        let all = verdict(&lines.collect::<Vec<_>>().join("\n"));
        count(&all, FindingKind::Empty)
    };
    assert_eq!(dry(&print_with("")), 1);
    // The filament may also end in the middle.
    let text = print_with("");
    let at = text.find(";Z:0.4").unwrap();
    let all =
        verdict(&(text[..at].to_owned() + &text[at..].replace(" E", " ;")));
    assert_eq!(count(&all, FindingKind::Empty), 1, "{all:?}");
}

#[test]
fn a_bead_is_not_interrupted() {
    let text = print_with("");
    let at = text.find("G1 Y56").unwrap();
    let line = text[..at].lines().count() as u64;
    let last = text[..at].trim_end().rfind(" E").unwrap();
    let all = verdict(&(text[..last].to_owned() + &text[at - 1..]));
    assert_eq!(count(&all, FindingKind::Gap), 1, "{all:?}");
    assert_eq!(all.findings[0].line, line);
    assert!(
        all.findings[0]
            .message
            .starts_with("12.00 mm without filament")
    );
}

#[test]
fn a_print_that_goes_on_in_the_air_is_found() {
    let shifted = |by: f64, travel: bool| {
        let shift = format!("G92 X{}\n", 62.0 - by);
        let planted = if travel {
            let back = "G1 E0.8 F2100\nG1 F1800\n";
            format!("G1 E-0.8 F2100\n{shift}G1 X50 F9000\n{back}")
        } else {
            shift
        };
        let all = verdict(&print_with(&planted));
        let kinds = [FindingKind::InTheAir, FindingKind::Adrift];
        let of = all.findings.iter().filter(|f| kinds.contains(&f.kind));
        of.map(|f| f.line).min()
    };
    for travel in [true, false] {
        assert!(
            shifted(40.0, travel).is_some_and(|line| line > 0),
            "{travel}"
        );
        assert_eq!(shifted(0.2, travel), None);
    }
}

#[test]
fn a_command_ends_where_marlin_still_reads_it() {
    let blanks = " ".repeat(90);
    for line in [
        format!("G1{blanks}X62 Y56 E0.01\n"),
        format!("{blanks}G1 X62 E0.01\n"),
        format!("M104{blanks}  S210\n"),
    ] {
        let kinds = found(&line);
        assert_eq!(kinds.first(), Some(&(FindingKind::Senseless, 1)), "{line}");
    }
    for fine in [
        format!("M117 {}\n", "printing ".repeat(20)),
        format!("M105{blanks}; {blanks}a comment\n"),
        format!("M105{blanks}{blanks}\n"),
        format!("STATUS{blanks}A={}\n", "x".repeat(90)),
    ] {
        assert_eq!(found(&fine).len(), 0, "{fine}");
    }
}

#[test]
fn a_printer_of_one_tool_takes_no_other() {
    assert_eq!(found("T1\n"), [(FindingKind::NoTool, 1)]);
    assert_eq!(found("T0\n"), []);
    for tool in ["T1", "T63", "T100"] {
        let all = verdict(&print_with(&format!("{tool}\n")));
        let told = &all.findings[0].message;
        assert!(told.starts_with(&format!("{tool} takes")), "{told}");
    }
    let text = print_with("T1\nG1 E9\n");
    let fine = |text: String| count(&verdict(&text), FindingKind::NoTool) == 0;
    // Files for several tools or filaments heat them, or name them.
    assert!(fine(text.replace("M83\n", "M83\nM104 T1 S200\n")));
    assert!(fine(text.replace("M83\n", "M83\nT1\n")));
    assert!(fine(text.clone() + "; filament_diameter = 1.75,1.75\n"));
    assert!(fine(text.replace("T1\n", "T1\n;TYPE:Wipe tower\n")));
    assert!(!fine(text + "; filament_diameter = 1.75\n"));
}

#[test]
fn wipes_need_no_comments() {
    for wipe in [
        "G1 X55 E-0.8 F2100\nG1 X80 F9000\nG1 X62\nG1 E0.8 F2100\nG1 F1800\n",
        "G1 X58 E-0.4 F2100\nG1 X55 E-0.4\nG1 Z1 F600\nG1 Z0.4\nG1 X62 F9000\n\
         G1 E0.8 F2100\nG1 F1800\n",
    ] {
        assert_eq!(found(wipe), [], "{wipe}");
    }
    let back = "G1 X55 E-0.8 F2100\nG1 E0.8\nG1 F1800\n";
    assert_eq!(found(back), [(FindingKind::Backwards, 1)]);
}

#[test]
fn two_letters_are_no_gcode() {
    let rules = Rules::new(&settings(&[]));
    for text in ["PK", "PK\n", "PK\x03", "GC", "GCD"] {
        assert!(check(text.as_bytes(), &rules).is_err(), "{text:?}");
    }
    // A longer file may begin with a macro of that name.
    assert!(check(&b"PK\nG28\n"[..], &rules).is_ok());
}
