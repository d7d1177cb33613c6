//! Small files, each with one thing wrong.

use super::*;
use isoslice_settings::testing::settings;

mod heights;
mod planted;

const START: &str = "G28\nM109 S200\nM83\n;LAYER_CHANGE\n;Z:0.2\n\
                     G1 Z0.2 F600\n;TYPE:External perimeter\n\
                     G1 X50 Y50 F6000\n";

fn verdict_with(text: &str, assignments: &[&str]) -> Verdict {
    check(text.as_bytes(), &Rules::new(&settings(assignments))).unwrap()
}

fn verdict(text: &str) -> Verdict {
    verdict_with(text, &[])
}

/// Turns everything off.
const END: &str = "M104 S0\n";

/// What is wrong with the lines after a good beginning.
fn found(lines: &str) -> Vec<(FindingKind, u64)> {
    let all = verdict(&format!("{START}{lines}{END}"));
    all.counts.into_iter().collect()
}

/// How many findings of that kind a file has.
fn count(all: &Verdict, kind: FindingKind) -> u64 {
    all.counts.get(&kind).copied().unwrap_or(0)
}

#[test]
fn a_good_file_is_safe() {
    let all = verdict(&format!(
        "{START}G1 X80 E1.2 F1800\nG1 E-0.8 F2100\nG1 X50 F9000\n\
         G1 E0.8 F2100\nG1 Y80 E1.2 F1800\n;LAYER_CHANGE\n;Z:0.4\n\
         G1 Z0.4 F600\nG1 X50 Y50 F9000\nG1 X80 E1.2 F1800\nM104 S0\n"
    ));
    assert!(all.counts.is_empty(), "{all:?}");
    assert!(all.is_safe());
    assert_eq!((all.layers, all.lines), (2, 19));
}

#[test]
fn the_head_stays_in_the_printer() {
    assert!(found("G1 X220 Y0 F9000\n").is_empty());
    for out in ["X220.1", "X-0.1", "Y221", "Z251 F600", "Z-0.1 F600"] {
        let kinds = found(&format!("G1 {out} F600\n"));
        assert_eq!(kinds[0], (FindingKind::OutOfReach, 1), "{out}");
    }
    // Arcs are followed, not only their ends.
    let arc = "G1 X219 Y100 F6000\nG2 X219 Y110 I0 J5\n";
    assert!(found(arc).is_empty(), "the arc's near side");
    let arc = "G1 X219 Y110 F6000\nG2 X219 Y100 I0 J-5\n";
    assert_eq!(found(arc)[0].0, FindingKind::OutOfReach);
    // Templates purge beside the bed.
    let purge = "M109 S200\nG1 Y-3 F1000\n";
    assert!(verdict(purge).is_safe());
    assert!(!verdict("M109 S200\nG1 Y-30 F1000\n").is_safe());
}

#[test]
fn cold_nozzles_push_nothing() {
    let cold =
        |text: &str| verdict(text).counts.contains_key(&FindingKind::Cold);
    assert!(cold("M83\nG1 E5 F100\n"));
    assert!(cold("M104 S200\nM83\nG1 E5 F100\n"), "nobody waited");
    assert!(cold("M109 S200\nM104 S0\nM83\nG1 E5 F100\n"));
    assert!(!cold("M109 S200\nM83\nG1 E5 F100\n"));
    assert!(!cold("M109 S200\nM104 S190\nM83\nG1 E5 F100\n"));
    assert!(!cold("M83\nG1 E-5 F100\n"));
    // A macro may have homed and heated.
    let text = "START_PRINT EXTRUDER=200\nM83\nG1 X1 E5 F100\nG1 X2 E5\n";
    let all = verdict(text);
    assert_eq!(all.counts.get(&FindingKind::Unknown), Some(&1));
    assert!(!all.counts.contains_key(&FindingKind::Cold));
}

#[test]
fn tools_have_a_heat_and_a_retraction_each() {
    let bead = "M83\nG1 Z0.2 F600\nG1 X1 E0.1\n";
    let safe = |head: &str| verdict(&format!("{head}{bead}{END}")).is_safe();
    assert!(safe("M109 S200 T0\nM104 T1 S0\nT0\n"));
    assert!(!safe("M109 T1 S200\nT0\n"), "T0 is cold");
    assert!(safe("M109 T1 S200\nT1\n"));
    // RepRapFirmware heats a tool in this way; other slicers write it, too.
    assert!(safe("G10 P0 S205 R180\nT0\nM116\n"));
    assert!(safe("G10 S205\nM116\n"), "no retraction");
    assert!(safe("M568 P0 S205\nM116\n"));
    assert!(!safe("G10 P0 S205 R180\nT0\n"), "nobody waited");
    // Each tool has its own filament.
    let both = "M109 T0 S200\nM109 T1 S200\nM83\nG1 Z0.2 F600\nG1 X0 Y0 F900\n\
                ;LAYER:0\n";
    let change = format!("{both}G1 E-9.6\nT1\nG92 E0\nG1 X5 E0.2\nT0\n");
    assert!(verdict(&format!("{change}{END}")).is_safe());
    let forgotten = verdict(&format!("{change}G1 X10 E0.2\n"));
    assert_eq!(forgotten.counts.get(&FindingKind::Unprimed), Some(&1));
    // A tool keeps the temperature that it was told before any tool was named.
    let late = "T1\nM109 S200\nM104 T1 S205\n";
    let all = verdict(&format!("{late}{bead}M104 S0\n"));
    assert!(!all.counts.contains_key(&FindingKind::Cold), "{all:?}");
    assert!(!all.counts.contains_key(&FindingKind::LeftOn), "{all:?}");
    // No table holds so many tools.
    assert!(safe("M109 T4000000000 S200\nT4000000000\n"));
}

#[test]
fn less_filament_may_be_wanted_than_was_pulled_back() {
    let cycle = "G1 E-0.8 F2100\nG1 X50 F9000\nG1 E0.6 F2100\n\
                 G1 X80 E1.2 F1800\n";
    let text = format!("{START}{}{END}", cycle.repeat(9));
    // 0.2 mm are missing each time, but the gaps do not add up.
    let all = verdict(&text);
    assert_eq!(all.counts.get(&FindingKind::Unprimed), Some(&9));
    let said = &all.sentences("x", Severity::Fault)[0];
    assert!(
        said.contains("0.20 mm") && said.contains("8 more"),
        "{said}"
    );
    let all = verdict_with(&text, &["retract.extra_prime=-0.2"]);
    assert_eq!(count(&all, FindingKind::Unprimed), 0);
}

#[test]
fn beads_beyond_the_bed_take_no_memory() {
    let mut text = String::from(START);
    for k in 0..2000 {
        text += &format!("G1 X{} Y5000 E1 F900\nG1 X{} Y0\n", k * 20, k * 20);
    }
    let all = verdict(&text);
    assert!(!all.is_safe());
    assert!(all.counts[&FindingKind::OutOfReach] > 2000);
    let rules = Rules::new(&settings(&[]));
    let mut checker = Checker::new(&rules);
    let mut reader = Reader::new(text.as_bytes());
    while let Some(event) = reader.next() {
        checker.take(event.unwrap(), &reader);
    }
    // The tiles of 16 mm cover the bed and what is beside it. These moves would
    // take a hundred thousand.
    assert!(
        checker.ground.tiles() <= 17 * 17,
        "{}",
        checker.ground.tiles()
    );
}

#[test]
fn filament_goes_back_in_retractions_only() {
    let again = "G1 E0.5 F900\nG1 X80 E0.4\n";
    let back = format!("G1 X60 E-0.5 F900\n{again}");
    assert_eq!(found(&back), [(FindingKind::Backwards, 1)]);
    // A move up or down is no wipe, and end codes may pull back.
    assert!(found(&format!("G1 Z1 E-0.5 F600\nG1 Z0.2\n{again}")).is_empty());
    assert!(found("G1 X60 E-0.5 F900\n").is_empty());
    let wipe = ";WIPE_START\nG1 X60 E-0.5 F900\n;WIPE_END\n";
    assert!(found(wipe).is_empty());
    let long = "G1 E-25 F900\nG1 E25\nG1 X60 E0.4\n";
    assert_eq!(found(long), [(FindingKind::LongRetraction, 1)]);
    assert!(found("G1 E-25 F900\n").is_empty());
    let starved = "G1 E-1 F900\nG1 E0.5 F900\nG1 X60 E0.5 F900\n";
    assert_eq!(found(starved), [(FindingKind::Unprimed, 1)]);
    assert_eq!(
        found("G10\nG1 X60 E0.4 F900\n"),
        [(FindingKind::Unprimed, 1)]
    );
    assert!(found("G10\nG11\nG1 X60 E0.4 F900\n").is_empty());
}

#[test]
fn beads_and_feeds_have_limits() {
    // 3 mm of filament for 5 mm of bead are 1.44 mm².
    assert_eq!(found("G1 X55 E3 F900\n"), [(FindingKind::ThickBead, 1)]);
    // 1.5 mm are 0.72 mm²: too much for Klipper alone.
    let text = format!("{START}G1 X55 E1.5 F900\n{END}");
    assert!(verdict(&text).is_safe());
    let klipper = ["gcode.flavour=klipper"];
    let all = verdict_with(&text, &klipper);
    assert_eq!(all.counts.get(&FindingKind::ThickBead), Some(&1));
    let all = verdict_with(&format!("{START}G1 E51 F900\n"), &klipper);
    assert_eq!(all.counts.get(&FindingKind::LongFeed), Some(&1));
}

#[test]
fn speeds_are_the_printers() {
    assert_eq!(found("G1 Z5 F601\n"), [(FindingKind::TooFast, 1)]);
    assert!(found("G1 Z5 F600\n").is_empty());
    // The move is mostly sideways: 1 mm up on 100 mm.
    assert!(found("G1 X150 Z1.2 F6000\n").is_empty());
    let none = verdict("G1 X10\n");
    assert_eq!(none.counts.get(&FindingKind::NoSpeed), Some(&1));
    let rules = Rules {
        speed: 100.0,
        ..Rules::new(&settings(&[]))
    };
    let fast = format!("{START}G1 X100 F6001\nG1 X50 F6100\n");
    let all = check(fast.as_bytes(), &rules).unwrap();
    assert_eq!(all.counts.get(&FindingKind::TooFast), Some(&1));
}

#[test]
fn z_rises_by_layers() {
    let jump = "G1 X60 E0.3 F900\n;LAYER_CHANGE\n;Z:0.7\nG1 Z0.7 F600\n\
                G1 X50 E0.3 F900\n";
    assert_eq!(found(jump), [(FindingKind::Jump, 1)]);
    let low = "G1 X60 E0.3 F900\nG1 Z0.6 F600\nG1 X50 E0.3\nG1 Z0.1\n\
               G1 X80 F9000\n";
    let kinds = found(low);
    assert!(kinds.contains(&(FindingKind::Low, 1)), "{kinds:?}");
}

#[test]
fn islands_stand_on_something() {
    let layer = |z: f64, lines: &str| {
        format!(";LAYER_CHANGE\n;Z:{z}\nG1 Z{z} F600\n{lines}")
    };
    let square = |x: f64| {
        format!(
            "G1 X{x} Y50 F6000\nG1 X{} E0.3 F900\nG1 Y60 E0.3\n\
             G1 X{x} E0.3\nG1 Y50 E0.3\n",
            x + 10.0
        )
    };
    let two = |second: f64| {
        let head = "G28\nM109 S200\nM83\n;TYPE:Perimeter\n";
        let upper = format!("{}{}", square(50.0), square(second));
        let lower = layer(0.2, &square(50.0));
        format!("{head}{lower}{}{END}", layer(0.4, &upper))
    };
    assert!(verdict(&two(50.3)).counts.is_empty());
    let all = verdict(&two(80.0));
    assert_eq!(all.counts.get(&FindingKind::InTheAir), Some(&1));
    let at = all.findings[0].at;
    assert!((at - DVec3::new(80.0, 50.0, 0.4)).length() < 0.36, "{at}");
    assert!(all.is_safe(), "it is a warning");
}

#[test]
fn islands_stand_on_supports_with_a_gap() {
    // Squares of the part and of supports, each in a layer of its own.
    let layer = |(z, x, role): &(f64, f64, &str)| {
        format!(
            ";LAYER_CHANGE\n;Z:{z}\n;HEIGHT:{}\nG1 Z{z} F600\n\
             ;TYPE:{role}\nG1 X{x} Y50 F6000\nG1 X{} E0.3 F900\n\
             G1 Y60 E0.3\nG1 X{x} E0.3\nG1 Y50 E0.3\n",
            z.min(0.2),
            x + 10.0
        )
    };
    let in_the_air = |layers: &[(f64, f64, &str)]| {
        let layers: String = layers.iter().map(layer).collect();
        let all = verdict(&format!("G28\nM109 S200\nM83\n{layers}{END}"));
        all.counts.get(&FindingKind::InTheAir).copied().unwrap_or(0)
    };
    let (part, support) = ("Perimeter", "Support material");
    let beside = [
        (0.2, 50.0, part),
        (0.2, 80.0, support),
        // The supports come after the part, and are lower.
        (0.4, 50.0, part),
        (0.35, 80.0, support),
        (0.55, 80.0, support),
        (0.6, 50.0, part),
    ];
    let on_top = |z, x, role| [&beside[..], &[(z, x, role)]].concat();
    assert_eq!(in_the_air(&beside), 0);
    assert_eq!(in_the_air(&on_top(0.9, 80.0, part)), 0);
    assert_eq!(in_the_air(&on_top(0.9, 110.0, part)), 1);
    // A support may stand above a gap. The part may not.
    assert_eq!(in_the_air(&on_top(1.0, 50.0, support)), 0);
    let higher = [&beside[..], &[(0.8, 80.0, part), (1.0, 50.0, part)]];
    assert_eq!(in_the_air(&higher.concat()), 1);
    // The first layer of supports is lower than the part's, which stands on the
    // bed.
    let lower = [(0.15, 80.0, support), (0.2, 50.0, part)];
    assert_eq!(in_the_air(&lower), 0);
    assert_eq!(in_the_air(&[&lower[..], &[(0.4, 110.0, part)]].concat()), 1);
}

#[test]
fn senseless_lines_are_faults() {
    for senseless in ["G1 X Y60 F900\n", "G1 X999999999 F900\n"] {
        let kinds = found(senseless);
        assert!(kinds.contains(&(FindingKind::Senseless, 1)), "{kinds:?}");
    }
}

#[test]
fn findings_are_kept_in_part_and_counted_in_full() {
    let all =
        verdict(&format!("{START}{}", "G1 X300 F900\nG1 X50\n".repeat(9)));
    assert_eq!(all.counts.get(&FindingKind::OutOfReach), Some(&9));
    let sentences = all.sentences("part.gcode", Severity::Fault);
    assert_eq!(sentences.len(), 1);
    assert!(sentences[0].starts_with("part.gcode:9: the head goes to"));
    let rest = "(8 more, next in lines 11 and 13)";
    assert!(sentences[0].ends_with(rest), "{}", sentences[0]);
}

#[test]
fn heat_is_what_the_printer_bears() {
    let limits = [
        "printer.max_nozzle_temperature=300",
        "printer.max_bed_temperature=100",
        "printer.max_chamber_temperature=60",
    ];
    for hot in [
        "M104 S301",
        "M109 S500",
        "M109 R500",
        "M104 T1 S400",
        "M104.1 T1 S400",
        "M190 S300",
        "M140 S101",
        "M141 S61",
        "M191 S61",
        "M568 P0 S500 R180",
        "M568 P0 R500",
        "G10 P0 S500 R180",
        "G10 P0 S205 R500",
        "SET_HEATER_TEMPERATURE HEATER=extruder TARGET=500",
        "set_heater_temperature heater=heater_bed target=300",
        "SET_HEATER_TEMPERATURE HEATER=\"heater_generic chamber\" TARGET=90",
        "PRINT_START BED=60 EXTRUDER=500",
        "START_PRINT BED_TEMP=300 EXTRUDER_TEMP=210",
        "PRINT_START CHAMBER=90",
        ";EXTRUDER_TRAIN.0.INITIAL_TEMPERATURE:400\nG28",
    ] {
        let all = verdict_with(&format!("{hot}\n"), &limits);
        assert_eq!(count(&all, FindingKind::TooHot), 1, "{hot}: {all:?}");
    }
    for fine in [
        "M104 S300",
        "M190 S100",
        "M191 S60",
        "G10 P0 S205 R180",
        "PRINT_START BED=100 EXTRUDER=300 MATERIAL=PLA NOZZLE_DIAMETER=400",
    ] {
        let all = verdict_with(&format!("{fine}\n"), &limits);
        assert_eq!(count(&all, FindingKind::TooHot), 0, "{fine}");
    }
    // No setting says what the printer bears.
    assert_eq!(count(&verdict("M109 S500\n"), FindingKind::TooHot), 1);
    assert_eq!(count(&verdict("M109 S320\n"), FindingKind::Hot), 1);
    assert_eq!(count(&verdict("M190 S300\n"), FindingKind::TooHot), 1);
    assert!(verdict("M109 S260\nM190 S110\nM109 S0\nM140 S0\n").is_safe());
}

#[test]
fn plastic_is_pushed_through_a_nozzle_that_melts_it() {
    let bead = "M83\nG1 X9 E0.3 F600\n";
    let cold = |text: &str| {
        count(&verdict(&format!("{text}{bead}")), FindingKind::Cold)
    };
    assert_eq!(cold("M109 S30\n"), 1);
    assert_eq!(cold("M109 S169\n"), 1);
    assert_eq!(cold("M109 S170\n"), 0);
    assert_eq!(cold(&format!("M109 S200\n{bead}M104 S1\n")), 1);
    assert_eq!(cold(&format!("M109 S200\n{bead}M104 S190\n")), 0);
    assert_eq!(cold("M104 S200\nM116\n"), 0);
    assert_eq!(
        cold("M302 P1\nM109 S30\n"),
        1,
        "it does not melt all the same"
    );
    // The nozzle is cold for probing, and hot again.
    assert_eq!(cold("M109 R150\nG28\nM109 S210\n"), 0);
    assert_eq!(cold("M109 R150\nG28\nM104 S210\n"), 1, "nobody waited");
    // These are Klipper's words.
    let set = "SET_HEATER_TEMPERATURE HEATER=extruder TARGET=";
    let wait = "TEMPERATURE_WAIT SENSOR=extruder MINIMUM=";
    assert_eq!(cold(&format!("{set}210\n{wait}205\n")), 0);
    assert_eq!(cold(&format!("{set}210\n{wait}100\n")), 1);
    assert_eq!(cold(&format!("{set}210\n{wait}205\nTURN_OFF_HEATERS\n")), 1);
    // A macro is told a temperature, or it is not.
    assert_eq!(cold("PRINT_START EXTRUDER=30\n"), 1);
    assert_eq!(cold("PRINT_START EXTRUDER=1 BED=60\n"), 0);
    assert_eq!(cold("PRINT_START\nM104 S1\n"), 1);
    assert_eq!(cold("PRINT_START\nM104 S210\n"), 0);
    // Ultimaker's printers heat before the first line.
    let griffin = ";FLAVOR:Griffin\n;EXTRUDER_TRAIN.0.INITIAL_TEMPERATURE:";
    assert_eq!(cold(&format!("{griffin}205\n")), 0);
    assert_eq!(cold(&format!("{griffin}30\n")), 1);
    assert_eq!(cold(";FLAVOR:UltiGCode\n"), 0);
    // Clay is no plastic.
    let clay = ["filament.min_nozzle_temperature=0"];
    let all = verdict_with(&format!("M109 S30\n{bead}"), &clay);
    assert_eq!(count(&all, FindingKind::Cold), 0);
}

#[test]
fn a_carriage_return_ends_a_line_and_hides_nothing() {
    let text = format!("{START}{END}");
    let hidden = verdict(&text.replacen("G28\n", "G28\rG1 Z-10 F600\n", 1));
    assert!(count(&hidden, FindingKind::OutOfReach) > 0);
    assert_eq!(hidden.findings[0].kind, FindingKind::LineEnd);
    let all = verdict(&text.replace('\n', "\r"));
    assert_eq!(all.lines, text.lines().count() as u64);
    assert_eq!(all.moves, verdict(&text).moves);
    assert_eq!(count(&all, FindingKind::LineEnd), all.lines);
    assert_eq!(verdict(&text.replace('\n', "\r\n")), verdict(&text));
}

#[test]
fn files_that_are_no_gcode_are_said_to_be_none() {
    for text in [
        "",
        "\n\n",
        "; a comment\n",
        "// a model\nlet x = axis(\"x\");\nlet y = 3;\ndraw(x);\n",
        "<!DOCTYPE html>\n<html>\n<body>\nG1\n</body>\n",
        "\u{7f}ELF\0\0\u{1}\n\0\n",
        "solid a\nfacet normal 0 0 1\nendfacet\nvertex 1 2 3\n",
    ] {
        let all = verdict(text);
        assert_eq!(all.counts.len(), 1, "{text:?}: {all:?}");
        assert_eq!(count(&all, FindingKind::NoGcode), 1, "{text:?}");
        assert!(!all.is_safe());
    }
    assert_eq!(count(&verdict("START_PRINT\n"), FindingKind::NoGcode), 0);
    let rules = Rules::new(&settings(&[]));
    let all = check(&b"\x1f\x8b\x08\x00x"[..], &rules).unwrap();
    assert_eq!(count(&all, FindingKind::NoGcode), 1);
    assert!(all.findings[0].message.contains("zcat"), "{all:?}");
    // Archives are opened.
    let error = check(&b"PK\x03\x04\n"[..], &rules).unwrap_err();
    assert!(error.to_string().contains("archive"), "{error}");
    // One line among others is no command.
    assert_eq!(found("hello there\n"), [(FindingKind::Senseless, 1)]);
}

#[test]
fn a_print_ends_as_a_whole_and_cold() {
    let bead = "G1 X60 E0.4 F900\n";
    let ends = |end: &str| {
        let all = verdict(&format!("{START}{bead}{end}"));
        let counts = all.counts.into_iter();
        counts.map(|(kind, _)| kind).collect::<Vec<_>>()
    };
    assert_eq!(ends("M104 S0\n"), []);
    assert_eq!(ends("M104 S0"), []);
    assert_eq!(ends("PRINT_END\n"), [FindingKind::UnknownWord]);
    assert_eq!(ends("TURN_OFF_HEATERS\n"), []);
    // The file stops in the middle.
    assert_eq!(ends(""), [FindingKind::CutOff]);
    assert_eq!(ends(";TYPE:Perimeter\n"), [FindingKind::CutOff]);
    assert_eq!(ends("G1 X70"), [FindingKind::CutOff]);
    // A heater stays hot, or is heated again.
    assert_eq!(ends("M107\n"), [FindingKind::LeftOn]);
    assert_eq!(ends("M104 S0\nM104 S200\n"), [FindingKind::LeftOn]);
    assert_eq!(ends("M140 S60\nM104 S0\n"), [FindingKind::LeftOn]);
    assert_eq!(ends("M104 S0\nM140 S0\nM141 S40\n"), [FindingKind::LeftOn]);
    // Slicers mark the end of the last layer.
    for head in [
        "; generated by isoslice 0.1.0\n",
        "; generated by PrusaSlicer 2.9.0 on 2026-01-01 at 12:00:00 UTC\n",
        ";Generated with Cura_SteamEngine 5.9.0\n",
        "; EXECUTABLE_BLOCK_START\n",
    ] {
        let all = verdict(&format!("{head}{START}{bead}G1 X1\nM107\n"));
        assert_eq!(count(&all, FindingKind::CutOff), 1, "{head}");
    }
}

#[test]
fn axes_are_homed_before_they_move() {
    let bead = "M109 S200\nM83\nG1 X60 E0.4 F900\nM104 S0\n";
    let homed = |head: &str| {
        count(&verdict(&format!("{head}{bead}")), FindingKind::NotHomed) == 0
    };
    assert!(homed("G28\n"));
    assert!(homed("g28 w\n"));
    assert!(homed("G1 Z5 F600\nG28 X Y\nG1 X9 F900\nG28 Z\n"));
    assert!(homed("PRINT_START\n"));
    assert!(homed("G28\nM84 S120\n"));
    assert!(!homed(""));
    assert!(homed("G28\nM84 E\n"));
    assert!(homed("G28 XY\nM84 E\nG28 Z\n"));
    assert!(!homed("G28\nM84 X Y E\n"));
    assert!(!homed("G28 X Y\n"));
    assert!(!homed("G1 X5 F900\nG28\n"));
    assert!(!homed("G28\nM84\n"));
    // The finding names all axes that were not homed, though the first move
    // needs only some of them.
    let said = |head: &str| {
        let all = verdict(&format!("{head}G1 X5 Y5 F900\n{bead}"));
        all.sentences("a", Severity::Warning).join("\n")
    };
    assert!(said("").contains("x, y and z were not homed"));
    // A file that is being written has no name yet.
    let all = verdict(&format!("G1 X5 Y5 F900\n{bead}"));
    let unnamed = &all.sentences("", Severity::Warning)[0];
    assert!(unnamed.starts_with("the G-code, line 1: "), "{unnamed}");
    assert!(said("G28 X Z\nM84 Z\n").contains("z was not homed"));
}

#[test]
fn beads_that_rise_in_a_file_without_comments_may_be_low() {
    let start = "G28\nM109 S200\nM83\nG1 X50 Y50 Z0.2 F6000\n";
    // The second layer has a bead that rises to 0.42, another one that begins there, and
    // which looks like a layer, and one that follows the surface down.
    let told = |rise: &str, low: &str| {
        let text = format!(
            "{start}G1 X80 E1.2 F900\nG1 X50 Y50 Z0.4 F6000\nG1 X80 E1.2 F900\n\
             G1 X50 Y50.4 F6000\nG1 X60 {rise} E0.4 F900\n\
             G1 X60 Y54 Z0.6 F6000\nG1 Z0.42\nG1 X50 Y52 E0.4 F900\nG1 Z0.6 F6000\n\
             G1 X80 Y50 F6000\nG1 Z{low}\nG1 X62 E0.6 F900\n{END}"
        );
        let all = verdict(&text);
        count(&all, FindingKind::Sunk)
    };
    assert_eq!(told("Z0.42", "0.31"), 0);
    // Without such beads, layers are what they seem.
    assert_eq!(told("", "0.31"), 1);
}

#[test]
fn a_pause_is_one_for_the_firmware_that_reads_it() {
    let told = |flavour: &str, line: &str| {
        let text = format!("{START}{line}\nG1 X60 E0.4 F900\n{END}");
        let all = verdict_with(&text, &[&format!("gcode.flavour={flavour}")]);
        let findings = all.findings.into_iter();
        findings.map(|f| (f.kind, f.message)).collect::<Vec<_>>()
    };
    for (flavour, line, says) in [
        ("marlin", "M0", "M0 stops the print until somebody is there"),
        (
            "marlin",
            "M600",
            "if Marlin was built with ADVANCED_PAUSE_FEATURE",
        ),
        ("marlin", "M601", "M601 does not stop the print: Marlin"),
        ("marlin", "PAUSE", "write M0"),
        (
            "klipper",
            "PAUSE",
            "PAUSE stops the print until somebody is there",
        ),
        ("klipper", "PAUSE", "if printer.cfg has [pause_resume]"),
        (
            "klipper",
            "M600",
            "M600 does not stop the print unless printer.cfg defines it",
        ),
        ("klipper", "M0", "write PAUSE"),
        ("rrf", "M226", "M226 stops the print"),
        ("rrf", "M125", "write M226"),
        ("prusa", "M601", "M601 stops the print"),
        ("prusa", "M226", "write M601"),
        ("bambu", "M400 U1", "M400 U1 stops the print"),
        ("bambu", "M600", "M600 does not stop the print"),
        ("bambu", "M600", "write M400 U1"),
        ("marlin", "M400 U1", "M400 U1 does not stop the print"),
    ] {
        let told = told(flavour, line);
        assert_eq!(told.len(), 1, "{flavour} {line}: {told:?}");
        assert_eq!(told[0].0, FindingKind::Changed, "{flavour} {line}");
        assert!(told[0].1.contains(says), "{flavour} {line}: {told:?}");
    }
    // A plain M400 waits for the moves before it.
    assert_eq!(told("bambu", "M400"), []);
    // RepRapFirmware's M0 ends the print, which belongs at the end of a file only.
    assert_eq!(
        told("rrf", "G1 X55 E0.2 F900\nM0")[0].0,
        FindingKind::Harmful
    );
    let end = format!("{START}G1 X60 E0.4 F900\n{END}M0\n");
    assert!(
        verdict_with(&end, &["gcode.flavour=rrf"])
            .findings
            .is_empty()
    );
}

#[test]
fn commands_are_known_or_said_not_to_be() {
    let kinds = |line: &str| {
        let all = verdict(&format!("{START}{line}\nG1 X60 E0.4 F900\n{END}"));
        let counts = all.counts.into_iter();
        counts.map(|(kind, _)| kind).collect::<Vec<_>>()
    };
    for harmless in [
        "M106 S127",
        "M105",
        "M117 G1 X999",
        "M204 P1000 T1500",
        "G29",
        "M220 S100",
        "M221 S95",
        "M206 Z0",
        "M862.3 P \"MK4\"",
        "M211 S1",
        "G53",
        "RESPOND MSG=\"a b\"",
        "M302.5",
        "G90",
        "M18 S60",
        "T0",
    ] {
        let expected: &[FindingKind] = match harmless {
            "M302.5" => &[FindingKind::UnknownWord],
            _ => &[],
        };
        assert_eq!(kinds(harmless), expected, "{harmless}");
    }
    for changes in [
        "M106 S9999",
        "M220 S9999",
        "M500",
        "M92 E93",
        "M206 Z-0.1",
        "M302 P1",
        "M0",
        "M600",
        "M211 S0",
        "M851 Z-1",
        "M301 P1",
        "M201 X9999999",
        "M218 T1 X20",
        "M207 S50",
        "M207 S0.8 R-50",
        "M208 S50",
        "SET_RETRACTION RETRACT_LENGTH=50",
        "SET_RETRACTION UNRETRACT_EXTRA_LENGTH=50",
        "M290 Z2",
        "M143 H1 S400",
        "SAVE_CONFIG",
        "M203 X0",
        "RESTORE_GCODE_STATE NAME=a",
        "SET_PIN PIN=a VALUE=1",
        "if {true}",
        "M42 P1 S1",
        "M564 S0",
    ] {
        let kind = match changes {
            "M220 S9999" => vec![FindingKind::TooFast, FindingKind::Changed],
            "M290 Z2" | "SAVE_CONFIG" => vec![FindingKind::Harmful],
            _ => vec![FindingKind::Changed],
        };
        assert_eq!(kinds(changes), kind, "{changes}");
    }
    for harms in [
        "M112",
        "M502",
        "M92 X80",
        "M206 Z-10",
        "M428",
        "M997",
        "M28 a.g",
        "M30 a.g",
        "M303 E0 S200",
        "G55",
        "M149 F",
        "M999",
        "M218 T1 X900",
        "SET_KINEMATIC_POSITION X=0",
        "FORCE_MOVE STEPPER=x DISTANCE=5",
        "FIRMWARE_RESTART",
        "M410",
        "M524",
        "M569 P0 S0",
        "G10 L2 P1 Z5",
    ] {
        assert_eq!(kinds(harms), [FindingKind::Harmful], "{harms}");
    }
    for senseless in ["G5 X9 Y9 I1 J1 P1 Q1 F900", "G1 X9 G1 X10", "M104 S"] {
        let kinds = kinds(senseless);
        assert_eq!(kinds, [FindingKind::Senseless], "{senseless}");
    }
    // What the reader can follow has its effect.
    assert!(
        kinds("M221 S1000\nG1 X55 E0.4 F900").contains(&FindingKind::ThickBead)
    );
    assert!(kinds("G53 G1 Z-10 F600").contains(&FindingKind::OutOfReach));
    assert!(kinds("G92 Z10\nG1 Z0 F600").contains(&FindingKind::OutOfReach));
    let offset = "SET_GCODE_OFFSET Z=-10\nG1 Z0 F600";
    assert!(kinds(offset).contains(&FindingKind::OutOfReach));
    // Each unknown command is reported once, with its count.
    let text = format!("{START}M1234\nM1234 S1\nPURGE_IT X=1\n{END}");
    let all = verdict(&text);
    let words: Vec<_> = all.unknown_words().collect();
    assert_eq!(words, [("M1234", 2), ("PURGE_IT", 1)]);
    let said = all.sentences("a", Severity::Warning);
    assert_eq!(
        said,
        [
            "a: not known, so nothing is said of what they do: M1234 (2 times \
          from line 9), PURGE_IT (line 11)"
        ]
    );
    // However many unknown commands there are, memory does not grow.
    let many: String = (0..5000).map(|k| format!("MACRO_{k}\n")).collect();
    let all = verdict(&many);
    assert_eq!(count(&all, FindingKind::UnknownWord), 5000);
    assert!(all.findings.len() < 50, "{}", all.findings.len());
}

#[test]
fn the_same_is_said_once() {
    let layers: String = (1..200)
        .map(|k| {
            let z = 0.2 * f64::from(k);
            format!(
                ";LAYER_CHANGE\nG1 Z{z:.1} F9000\nG1 X60 E0.4 F900\nG1 X50\n"
            )
        })
        .collect();
    let all = verdict(&format!("{START}{layers}{END}"));
    assert_eq!(all.counts.len(), 1, "{all:?}");
    let said = all.sentences("a", Severity::Warning);
    assert_eq!(said.len(), 1);
    assert!(said[0].contains("z moves at 150.0 mm/s"), "{}", said[0]);
    assert!(
        said[0].ends_with("(197 more, next in lines 18 and 22)"),
        "{}",
        said[0]
    );
}

/// Start and end codes in the manner of other slicers.
#[test]
fn other_slicers_codes_are_no_faults() {
    let print = "G0 X60 Y60 Z0.2 F1500\n;LAYER:0\n;TYPE:WALL-OUTER\n\
                 G1 X80 Y60 E0.7 F1200\nG1 X80 Y80 E0.7\n";
    let files = [
        // Cura, for an Ender.
        format!(
            ";FLAVOR:Marlin\n;Generated with Cura_SteamEngine 5.9.0\nM140 S60\n\
             M190 S60\nM104 S200\nM109 S200\nG28\nM83\n\
             G1 X0.1 Y200 Z0.3 F1500 E15\n{print}M140 S0\nG91\n\
             G1 E-2 F2700\nG1 E-2 Z0.2 F2400\nG1 X5 Y5 F3000\nG1 Z10\nG90\n\
             G1 X0 Y220\nM106 S0\nM104 S0\nM140 S0\nM84 X Y E\n\
             ;End of Gcode\n"
        ),
        // Cura, for an Ultimaker 3.
        format!(
            ";START_OF_HEADER\n;FLAVOR:Griffin\n\
             ;EXTRUDER_TRAIN.0.INITIAL_TEMPERATURE:205\n\
             ;BUILD_PLATE.INITIAL_TEMPERATURE:60\n;END_OF_HEADER\nT0\nM83\n\
             G280 S1\nG1 F1500 E-6.5\nG1 E6.5\n{print}M107\nG91\n\
             G0 F5000 X8 Z0.5 E-4.5\nG0 Z1.5 E4.5\nG90\n;End of Gcode\n"
        ),
        // Bambu Studio.
        format!(
            "; EXECUTABLE_BLOCK_START\nG91\nM17 Z0.3\nG380 S2 Z30 F300\nG90\n\
             M1002 gcode_claim_action : 2\nM140 S55\nM190 S55\nG28 X\n\
             M104 S220\nG28 Z P0 T250\nM109 S220\nM83\nG1 E50 F200\n\
             M104.1 T0 S220\nT1000\n{print}M140 S0\nM620 S255\nT255\n\
             M621 S255\nM104 S0\nM73.2 R1.0\n; EXECUTABLE_BLOCK_END\n"
        ),
        // Simplify3D and ideaMaker.
        format!(
            "M140 S60\nM104 S200 T0\nM109 S200 T0\nG28\nM83\n{print}\
             M104 S0\nM140 S0\nG91\nG1 E-1 F300\n\
             G1 Z+0.5 E-5 X-20 Y-20 F3000\nG28 X0 Y0\nM84\nG90\n"
        ),
        // PrusaSlicer, with filaments that share a nozzle.
        format!(
            "M104 S215\nM140 S60\nM109 S215\nG28 W\nG80\nM221 S95\nM83\nT1\n\
             {print}M104 S0\nM140 S0\nM107\nG1 X0 Y200 F3000\nM84\n"
        ),
    ];
    for text in files {
        let all = verdict(&text);
        assert!(all.is_safe(), "{all:#?}\n{text}");
        let harmless = [FindingKind::TooFast, FindingKind::Changed];
        let kinds = all.counts.keys();
        let serious: Vec<_> = kinds.filter(|k| !harmless.contains(k)).collect();
        assert!(serious.is_empty(), "{all:#?}\n{text}");
    }
}

#[test]
fn a_target_that_is_no_number_does_not_turn_a_heater_off() {
    let heater = "SET_HEATER_TEMPERATURE HEATER=";
    for to in ["{temperature}", "nan", "hot"] {
        let all = verdict(&format!("{START}{heater}extruder TARGET={to}\n"));
        assert_eq!(count(&all, FindingKind::Senseless), 1, "{to}");
        assert_eq!(count(&all, FindingKind::LeftOn), 1, "{to}");
    }
    // An unknown heater has no limit, and the check says that it does not know
    // it.
    let all = verdict(&format!("{START}{heater}drybox TARGET=400\n{END}"));
    let unknown: Vec<_> = all.unknown_words().collect();
    assert_eq!(unknown, [("SET_HEATER_TEMPERATURE HEATER=drybox", 1)]);
}

/// One text again and again, without end.
struct Endless(Vec<u8>, usize);

impl Read for Endless {
    fn read(&mut self, out: &mut [u8]) -> std::io::Result<usize> {
        let (text, at) = (&self.0, self.1);
        let n = out.len().min(text.len() - at);
        out[..n].copy_from_slice(&text[at..at + n]);
        self.1 = (at + n) % text.len();
        Ok(n)
    }
}

#[test]
fn streams_without_end_are_no_gcode() {
    let noise: Vec<u8> = (0..1u64 << 16)
        .map(|k| (k * k).wrapping_mul(0x9E37_79B9_7F4A_7C15).to_le_bytes()[6])
        .collect();
    for (text, words) in [
        (vec![0], "line 1 is longer than 64 MB"),
        (noise, "lines are no commands"),
        (b"y\n".to_vec(), "lines are no commands"),
        (b"; a comment\n\n".to_vec(), "no command in its first 64 MB"),
        (b"G28\n".to_vec(), "commands do not move the head"),
        (b"G1 X5 E1\n".to_vec(), "commands do not move the head"),
    ] {
        let rules = Rules::new(&settings(&[]));
        let all = check(Endless(text, 0), &rules).unwrap();
        assert_eq!(all.counts.len(), 1, "{all:?}");
        assert_eq!(count(&all, FindingKind::NoGcode), 1, "{all:?}");
        assert!(all.findings[0].message.contains(words), "{all:?}");
    }
    // A long file of true G-code is read to its end, whatever its head is.
    let head = "; thumbnail\n".repeat(100_000);
    let text = "G28\nSTART_OBJECT\nG1 X10 F6000\n".repeat(100_000);
    let rest = "written by hand\n".repeat(5_000);
    let all = verdict(&format!("{head}{rest}{text}"));
    assert_eq!(all.moves, 100_000);
    assert_eq!(count(&all, FindingKind::NoGcode), 0);
}
