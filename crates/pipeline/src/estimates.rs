//! Tests of the estimate of time against Klipper's own planner.
//!
//! The times were taken from Klipper itself, by its batch mode, at its commit
//! 84104bb of August 2026, for a cartesian printer with `max_velocity: 300`,
//! `max_accel: 3000`, `max_z_velocity: 12`, `max_z_accel: 200`,
//! `max_extrude_only_velocity: 120`, `max_extrude_only_accel: 5000` and its
//! defaults otherwise (`square_corner_velocity: 5`,
//! `minimum_cruise_ratio: 0.5`, `instantaneous_corner_velocity: 1`). They are
//! the sums of the moves' times, without homing.

use crate::{Options, slice};
use isoslice_model::{Placement, placed};
use isoslice_path::pace::clock::time_of;
use isoslice_path::pace::limits;
use isoslice_settings::Flavour;
use isoslice_settings::testing::settings;
use std::fmt::Write;

/// What the printer does before each case.
const HEAD: &str = "G28\nG90\nM83\n";

/// The printer of the module's head.
const KLIPPER: [&str; 6] = [
    "gcode.flavour=klipper",
    "printer.acceleration=3000",
    "printer.travel_acceleration=3000",
    "printer.max_speed_z=12",
    "printer.max_acceleration_z=200",
    "printer.retract_acceleration=5000",
];

#[track_caller]
fn takes(text: &str, seconds: f64) {
    let limits = limits(&settings(&KLIPPER));
    let (time, _) = time_of(format!("{HEAD}{text}").as_bytes(), limits);
    let off = time / seconds - 1.0;
    assert!(off.abs() < 2e-4, "{time} s instead of {seconds} s");
}

#[test]
fn a_square_takes_what_klipper_takes() {
    let text = "M204 S1000\nG1 X10 Y10 F9000\nG1 Z0.2 F600\n\
                G1 X40 Y10 E1 F3000\nG1 X40 Y40 E1\nG1 X10 Y40 E1\n\
                G1 X10 Y10 E1\n";
    takes(text, 2.864_083);
}

#[test]
fn a_small_circle_takes_what_klipper_takes() {
    let mut text = String::from("M204 S1000\nG1 X53 Y50 F9000\n");
    for k in 1..=3 * 190 {
        let t = std::f64::consts::TAU * f64::from(k) / 190.0;
        let (x, y) = (50.0 + 3.0 * t.cos(), 50.0 + 3.0 * t.sin());
        writeln!(text, "G1 X{x:.3} Y{y:.3} E0.0033 F6000").unwrap();
    }
    takes(&text, 1.791_410);
}

#[test]
fn a_zigzag_takes_what_klipper_takes() {
    let mut text = String::from("M204 S3000\nG1 X20 Y20 F9000\n");
    for k in 0..40 {
        let x = if k % 2 == 0 { 28 } else { 20 };
        let y = 20.4 + 0.4 * f64::from(k);
        writeln!(text, "G1 X{x} E0.26 F6000\nG1 Y{y:.3} E0.013").unwrap();
    }
    takes(&text, 5.491_309);
}

#[test]
fn retractions_and_hops_take_what_klipper_takes() {
    let mut text = String::from("G1 Z0.2 F600\nM204 S1500\nG1 X20 Y20 F9000\n");
    for k in 0..30 {
        let (x, y, to) = (30 + k, 20 + k, 20 + k);
        let z = 0.4 + 0.2 * f64::from(k);
        let (up, beside) = (z + 0.2, y + 1);
        writeln!(
            text,
            "M204 S1000\nG1 X{x} Y{y} E0.4 F1800\nG1 X{x} Y{beside} E0.04\n\
             G1 E-0.8 F2100\nM204 S1500\nG1 Z{up:.1} F600\n\
             G1 X{to} Y{beside} F9000\nG1 Z{z:.1} F600\nG1 E0.8 F2100"
        )
        .unwrap();
    }
    takes(&text, 25.601_630);
}

#[test]
fn wipes_and_sharp_corners_take_what_klipper_takes() {
    let text = "M204 S1000\nG1 X20 Y20 F9000\nG1 X60 E1.6 F3000\n\
                G1 X60.3 Y20.2 E0.012\nG1 X60.5 Y20.9 E0.02\n\
                G1 X60.1 Y24 E0.1\nG1 E-0.5 F2100\n\
                G1 X58 Y23.5 E-0.3 F7200\nM204 S1500\n\
                G1 X20 Y60 F9000\nG1 E0.8 F2100\n\
                G1 X20.2 Y60 E0.01 F3000\nG1 X50 Y60 E1.5\n";
    takes(text, 2.568_477);
}

#[test]
fn the_estimate_is_what_the_text_takes() {
    let cup = "max(sqrt(x^2+y^2) - 6, abs(z) - 2, 4 - sqrt(x^2+y^2+z^2))";
    let cup = placed(cup, &Placement::default());
    for flavour in Flavour::ALL {
        for relative in [false, true] {
            let settings = settings(&[
                "retract.z_hop=0.4",
                "gcode.end=G91\nG1 E-2 F1200\nG1 Z10 F600\nG90\n\
                 G1 X0 Y200 F6000\nG4 P1500\nM84\n",
                &format!("gcode.flavour={}", flavour.name()),
                &format!("gcode.relative_e={relative}"),
            ]);
            let mut text = Vec::new();
            let options = Options::default();
            let summary = slice(&cup, &settings, &options, &mut text).unwrap();
            let (read, _) = time_of(&text, limits(&settings));
            let off = summary.time / read - 1.0;
            assert!(
                off.abs() < 3e-3,
                "{flavour:?}: {} s, the text takes {read} s",
                summary.time
            );
        }
    }
}
