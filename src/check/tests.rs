//! Small files, each with one thing wrong.

use super::*;
use crate::settings::Builder;

const START: &str = "G28\nM109 S200\nM83\n;LAYER_CHANGE\n;Z:0.2\n\
                     G1 Z0.2 F600\n;TYPE:External perimeter\n\
                     G1 X50 Y50 F6000\n";

fn verdict_with(text: &str, assignments: &[&str]) -> Verdict {
    let mut builder = Builder::new();
    for assignment in assignments {
        builder.set(assignment).unwrap();
    }
    let (settings, _) = builder.finish().unwrap();
    check(text.as_bytes(), &Rules::new(&settings)).unwrap()
}

fn verdict(text: &str) -> Verdict {
    verdict_with(text, &[])
}

/// What is wrong with the lines after a good beginning.
fn found(lines: &str) -> Vec<(Kind, u64)> {
    let all = verdict(&format!("{START}{lines}"));
    all.counts.into_iter().collect()
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
        assert_eq!(kinds[0], (Kind::OutOfReach, 1), "{out}");
    }
    // Arcs are followed, not only their ends.
    let arc = "G1 X219 Y100 F6000\nG2 X219 Y110 I0 J5\n";
    assert!(found(arc).is_empty(), "the arc's near side");
    let arc = "G1 X219 Y110 F6000\nG2 X219 Y100 I0 J-5\n";
    assert_eq!(found(arc)[0].0, Kind::OutOfReach);
    // Templates purge beside the bed.
    let purge = "M109 S200\nG1 Y-3 F1000\n";
    assert!(verdict(purge).is_safe());
    assert!(!verdict("M109 S200\nG1 Y-30 F1000\n").is_safe());
}

#[test]
fn cold_nozzles_push_nothing() {
    let cold = |text: &str| verdict(text).counts.contains_key(&Kind::Cold);
    assert!(cold("M83\nG1 E5 F100\n"));
    assert!(cold("M104 S200\nM83\nG1 E5 F100\n"), "nobody waited");
    assert!(cold("M109 S200\nM104 S0\nM83\nG1 E5 F100\n"));
    assert!(!cold("M109 S200\nM83\nG1 E5 F100\n"));
    assert!(!cold("M109 S200\nM104 S190\nM83\nG1 E5 F100\n"));
    assert!(!cold("M83\nG1 E-5 F100\n"));
    // A macro may have done it.
    let text = "START_PRINT EXTRUDER=200\nM83\nG1 X1 E5 F100\nG1 X2 E5\n";
    let all = verdict(text);
    assert_eq!(all.counts.get(&Kind::Unknown), Some(&1));
    assert!(!all.counts.contains_key(&Kind::Cold));
}

#[test]
fn tools_have_a_heat_and_a_retraction_each() {
    let bead = "M83\nG1 X1 E0.1 F600\n";
    let safe = |head: &str| verdict(&format!("{head}{bead}")).is_safe();
    assert!(safe("M109 S200 T0\nM104 T1 S0\nT0\n"));
    assert!(!safe("M109 T1 S200\nT0\n"), "T0 is cold");
    assert!(safe("M109 T1 S200\nT1\n"));
    // RepRapFirmware's way, also of other slicers.
    assert!(safe("G10 P0 S205 R180\nT0\nM116\n"));
    assert!(safe("G10 S205\nM116\n"), "no retraction");
    assert!(safe("M568 P0 S205\nM116\n"));
    assert!(!safe("G10 P0 S205 R180\nT0\n"), "nobody waited");
    // Each tool's filament is its own.
    let both = "M109 T0 S200\nM109 T1 S200\nM83\nG1 X0 Y0 F900\n;LAYER:0\n";
    let change = format!("{both}G1 E-9.6\nT1\nG92 E0\nG1 X5 E0.2\nT0\n");
    assert!(verdict(&change).is_safe());
    let forgotten = verdict(&format!("{change}G1 X10 E0.2\n"));
    assert_eq!(forgotten.counts.get(&Kind::Unprimed), Some(&1));
    // So many tools that no table holds them.
    assert!(safe("M109 T4000000000 S200\nT4000000000\n"));
}

#[test]
fn less_filament_may_be_wanted_than_was_pulled_back() {
    let cycle = "G1 E-0.8 F2100\nG1 X50 F9000\nG1 E0.6 F2100\n\
                 G1 X80 E1.2 F1800\n";
    let text = format!("{START}{}", cycle.repeat(9));
    // 0.2 mm are missing each time, and not more and more.
    let all = verdict(&text);
    assert_eq!(all.counts.get(&Kind::Unprimed), Some(&9));
    assert!(all.sentences("x", Severity::Fault)[2].contains("0.20 mm"));
    assert!(verdict_with(&text, &["retract.extra_prime=-0.2"]).is_safe());
}

#[test]
fn beads_beyond_the_bed_take_no_memory() {
    let mut text = String::from(START);
    for k in 0..2000 {
        text += &format!("G1 X{} Y5000 E1 F900\nG1 X{} Y0\n", k * 20, k * 20);
    }
    let all = verdict(&text);
    assert!(!all.is_safe());
    assert!(all.counts[&Kind::OutOfReach] > 2000);
    let rules = Rules::new(&Settings::default());
    let mut state = State::new(&rules);
    for event in Reader::new(text.as_bytes()) {
        state.take(event.unwrap());
    }
    // The bed and what is beside it, in tiles of 16 mm; these moves would
    // take a hundred thousand.
    assert!(state.ground.tiles() <= 17 * 17, "{}", state.ground.tiles());
}

#[test]
fn filament_goes_back_in_retractions_only() {
    assert_eq!(found("G1 X60 E-0.5 F900\n"), [(Kind::Backwards, 1)]);
    let wipe = ";WIPE_START\nG1 X60 E-0.5 F900\n;WIPE_END\n";
    assert!(found(wipe).is_empty());
    assert_eq!(found("G1 E-25 F900\n"), [(Kind::LongRetraction, 1)]);
    let starved = "G1 E-1 F900\nG1 E0.5 F900\nG1 X60 E0.5 F900\n";
    assert_eq!(found(starved), [(Kind::Unprimed, 1)]);
    assert_eq!(found("G10\nG1 X60 E0.4 F900\n"), [(Kind::Unprimed, 1)]);
    assert!(found("G10\nG11\nG1 X60 E0.4 F900\n").is_empty());
}

#[test]
fn beads_and_feeds_have_limits() {
    // 3 mm of filament for 5 mm of bead are 1.44 mm².
    assert_eq!(found("G1 X55 E3 F900\n"), [(Kind::ThickBead, 1)]);
    // 1.5 mm are 0.72 mm²: too much for Klipper alone.
    let text = format!("{START}G1 X55 E1.5 F900\n");
    assert!(verdict(&text).is_safe());
    let klipper = ["gcode.flavour=klipper"];
    let all = verdict_with(&text, &klipper);
    assert_eq!(all.counts.get(&Kind::ThickBead), Some(&1));
    let all = verdict_with(&format!("{START}G1 E51 F900\n"), &klipper);
    assert_eq!(all.counts.get(&Kind::LongFeed), Some(&1));
}

#[test]
fn speeds_are_the_printers() {
    assert_eq!(found("G1 Z5 F601\n"), [(Kind::TooFast, 1)]);
    assert!(found("G1 Z5 F600\n").is_empty());
    // Mostly sideways: 1 mm up on 100 mm.
    assert!(found("G1 X150 Z1.2 F6000\n").is_empty());
    let none = verdict("G1 X10\n");
    assert_eq!(none.counts.get(&Kind::NoSpeed), Some(&1));
    let rules = Rules {
        speed: 100.0,
        ..Rules::new(&Settings::default())
    };
    let fast = format!("{START}G1 X100 F6001\nG1 X50 F6100\n");
    let all = check(fast.as_bytes(), &rules).unwrap();
    assert_eq!(all.counts.get(&Kind::TooFast), Some(&1));
}

#[test]
fn z_rises_by_layers() {
    let jump = "G1 X60 E0.3 F900\n;LAYER_CHANGE\n;Z:0.7\nG1 Z0.7 F600\n\
                G1 X50 E0.3 F900\n";
    assert_eq!(found(jump), [(Kind::Jump, 1)]);
    let low = "G1 X60 E0.3 F900\nG1 Z0.6 F600\nG1 X50 E0.3\nG1 Z0.1\n\
               G1 X80 F9000\n";
    let kinds = found(low);
    assert!(kinds.contains(&(Kind::Low, 1)), "{kinds:?}");
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
        format!("{head}{}{}", layer(0.2, &square(50.0)), layer(0.4, &upper))
    };
    assert!(verdict(&two(50.3)).counts.is_empty());
    let all = verdict(&two(80.0));
    assert_eq!(all.counts.get(&Kind::InTheAir), Some(&1));
    let at = all.findings[0].at;
    assert!((at - DVec3::new(80.25, 50.25, 0.4)).length() < 0.01, "{at}");
    assert!(all.is_safe(), "it is a warning");
}

#[test]
fn senseless_lines_are_faults() {
    for senseless in ["G1 X Y60 F900\n", "G1 X999999999 F900\n"] {
        let kinds = found(senseless);
        assert!(kinds.contains(&(Kind::Senseless, 1)), "{kinds:?}");
    }
}

#[test]
fn findings_are_kept_in_part_and_counted_in_full() {
    let all =
        verdict(&format!("{START}{}", "G1 X300 F900\nG1 X50\n".repeat(9)));
    assert_eq!(all.counts.get(&Kind::OutOfReach), Some(&9));
    let sentences = all.sentences("part.gcode", Severity::Fault);
    assert_eq!(sentences.len(), 4);
    assert!(sentences[0].starts_with("part.gcode:9: the head goes to"));
    assert_eq!(sentences[3], "part.gcode: 6 more of out-of-reach");
    assert!(all.sentences("part.gcode", Severity::Warning).is_empty());
}
