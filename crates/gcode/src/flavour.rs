//! The G-code commands in which firmwares differ.
//!
//! The commands for labels of parts are in `label`. A firmware's [`Planner`]
//! says how fast the firmware takes corners.
//!
//! In: the writer's plan. Out: the firmware's own commands for its limits, pressure
//! advance, fan, progress and retraction, and the start and end templates for
//! settings that give none.
//!
//! | | Marlin 2 | Prusa | RepRapFirmware 3 | Klipper | Bambu |
//! |---|---|---|---|---|---|
//! | acceleration | M204 P T | M204 P T | M204 P T | SET_VELOCITY_LIMIT, M204 S | M204 S |
//! | acceleration of a bead | M204 P | M204 P | M204 P | M204 S | M204 S |
//! | corners | M205 X Y J | M205 X Y | M566 X Y | SET_VELOCITY_LIMIT | M205 X Y |
//! | pressure advance | M900 K | M900 K, M572 S | M572 D0 S | SET_PRESSURE_ADVANCE | M900 K L M |
//! | fan off | M107 | M107 | M106 S0 | M107 | M106 S0 |
//! | fan full | M106 S255 | M106 S255 | M106 S1 | M106 S255 | M106 S255 |
//! | retraction | M207, M208 | M207, M208 | M207 | SET_RETRACTION | |
//! | layers | | | | SET_PRINT_STATS_INFO | M73 L, M991 |
//!
//! Klipper knows none of M201, M203, M205, M900, M862, M486, G29 and, with one
//! extruder, no `T0`; its M204 takes `S`, one acceleration for every move. In
//! RepRapFirmware M208 sets how far the axes reach, and a fan's speed of 1 is
//! full.

use super::number::text;
use super::plan::{Board, WriterPlan};
use isoslice_base::units::{MmPerSec, Percent, feed_rate};
use isoslice_path::pace::motion::{Limits, Planner};
use isoslice_settings::Flavour;

/// The start template for settings that have none. It homes and lifts the
/// nozzle off the bed. The writer adds the heating before and after it.
pub(super) const START: &str = "\
G28
G1 Z5 F{{ feed_rate_z }}
";

/// The end template for settings that have none. It turns the heaters off first,
/// so that they are off even if a move is refused. Then it lifts the nozzle before
/// it moves the nozzle aside, so that the nozzle is not dragged over the part. The
/// writer turns the fan off.
pub(super) const END: &str = "\
M104 S0
{% if bed_temperature > 0 or first_layer_bed_temperature > 0 %}
M140 S0
{% endif %}
G1 Z{{ park_z }} F{{ feed_rate_z }}
G1 X0 Y{{ bed_y }} F{{ feed_rate_travel }}
M84
";

/// Decimals of accelerations and speeds.
const COARSE: u32 = 1;

/// Sets the acceleration of printing moves to the number that follows.
pub(super) fn print_acceleration(flavour: Flavour) -> &'static [u8] {
    if flavour.firmware().one_acceleration {
        b"M204 S"
    } else {
        b"M204 P"
    }
}

/// Lines that tell the printer that a layer begins, by its number from 1.
pub(super) fn layer_begins(flavour: Flavour, number: usize) -> Vec<String> {
    match flavour {
        Flavour::Klipper => {
            vec![format!("SET_PRINT_STATS_INFO CURRENT_LAYER={number}")]
        }
        // The first line is for the screen, the second one for the camera.
        Flavour::Bambu => vec![
            format!("M73 L{number}"),
            format!("M991 S0 P{}", number.saturating_sub(1)),
        ],
        Flavour::Marlin | Flavour::Rrf | Flavour::Prusa => Vec::new(),
    }
}

/// Lines that ask the firmware whether the file is for this printer.
pub(super) fn checks(plan: &WriterPlan<'_>) -> Vec<String> {
    let printer = plan.printer;
    if !plan.flavour.firmware().asks_printer {
        return Vec::new();
    }
    let mut lines = Vec::new();
    // The name must not hold a quote or the end of a line.
    let model: String = printer
        .model
        .trim()
        .chars()
        .filter(|c| !c.is_control() && *c != '"')
        .collect();
    if !model.is_empty() {
        lines.push(format!("M862.3 P \"{model}\""));
    }
    lines.push(format!("M862.1 P{}", text(printer.nozzle_diameter, 2)));
    lines
}

/// Lines that set the accelerations and the speed through corners.
///
/// The square corner velocity v is the jerk of firmware that limits the sudden
/// change of each axis: at a right angle one axis loses v and the other gains
/// v. A junction deviation of v²·(√2 − 1)/a gives the same speed at a right
/// angle.
pub(super) fn limits(plan: &WriterPlan<'_>) -> Vec<String> {
    let Limits {
        acceleration: print,
        travel_acceleration: travel,
        ..
    } = plan.limits;
    let corner = plan.corner;
    let two = || {
        let [p, t] = [print, travel].map(|a| text(a, COARSE));
        format!("M204 P{p} T{t}")
    };
    if !plan.sets_limits {
        return Vec::new();
    }
    let v = text(corner, COARSE);
    match plan.flavour {
        Flavour::Marlin => {
            let deviation = Planner::deviation(corner, print);
            vec![two(), format!("M205 X{v} Y{v} J{}", text(deviation, 3))]
        }
        Flavour::Prusa => vec![two(), format!("M205 X{v} Y{v}")],
        Flavour::Bambu => vec![
            format!("M204 S{}", text(print, COARSE)),
            format!("M205 X{v} Y{v}"),
        ],
        Flavour::Rrf => {
            let v = text(feed_rate(corner), 0);
            vec![two(), format!("M566 X{v} Y{v}")]
        }
        Flavour::Klipper => vec![format!(
            "SET_VELOCITY_LIMIT ACCEL={} SQUARE_CORNER_VELOCITY={v}",
            text(print.max(travel), COARSE)
        )],
    }
}

/// The line that sets the pressure advance; nothing if it is to stay as it is.
pub(super) fn pressure_advance(plan: &WriterPlan<'_>) -> Option<String> {
    let k = text(plan.pressure_advance?, 4);
    Some(match plan.flavour {
        Flavour::Marlin => format!("M900 K{k}"),
        Flavour::Prusa => match plan.board {
            Board::Buddy => format!("M572 S{k}"),
            Board::Old | Board::Mini | Board::Unknown => format!("M900 K{k}"),
        },
        Flavour::Rrf => format!("M572 D0 S{k}"),
        // M10 chooses a linear model, and L is its greatest flow, mm³/s.
        Flavour::Bambu => format!("M900 K{k} L1000 M10"),
        Flavour::Klipper => format!("SET_PRESSURE_ADVANCE ADVANCE={k}"),
    })
}

/// Lines that tell the firmware how to retract; none if the firmware does not
/// retract.
pub(super) fn retraction(plan: &WriterPlan<'_>) -> Vec<String> {
    let retract = plan.retract;
    if !retract.firmware || retract.length <= 0.0 {
        return Vec::new();
    }
    let length = text(retract.length, 5);
    let extra = text(retract.extra_prime, 5);
    let feed = |speed: MmPerSec| text(feed_rate(speed), 0);
    let (back, forth) = (feed(retract.speed), feed(retract.prime_speed));
    match plan.flavour {
        // The file lifts the nozzle itself.
        Flavour::Marlin | Flavour::Prusa | Flavour::Bambu => vec![
            format!("M207 S{length} F{back} Z0"),
            format!("M208 S{extra} F{forth}"),
        ],
        Flavour::Rrf => {
            vec![format!("M207 S{length} R{extra} F{back} T{forth} Z0")]
        }
        Flavour::Klipper => vec![format!(
            "SET_RETRACTION RETRACT_LENGTH={length} RETRACT_SPEED={} \
             UNRETRACT_EXTRA_LENGTH={extra} UNRETRACT_SPEED={}",
            text(retract.speed, COARSE),
            text(retract.prime_speed, COARSE)
        )],
    }
}

/// The line that sets the fan to `pwm` of 255.
pub(super) fn fan(flavour: Flavour, pwm: i64) -> String {
    match flavour {
        Flavour::Rrf => format!("M106 S{}", text(pwm as f64 / 255.0, 3)),
        Flavour::Marlin | Flavour::Klipper | Flavour::Prusa if pwm == 0 => {
            "M107".to_owned()
        }
        Flavour::Marlin
        | Flavour::Klipper
        | Flavour::Prusa
        | Flavour::Bambu => format!("M106 S{pwm}"),
    }
}

/// A fan's speed as the firmware counts it.
pub(super) fn pwm(speed: Percent) -> i64 {
    // NaN becomes 0, which stops the fan.
    (speed.clamp(0.0, 100.0) * 2.55).round() as i64
}

/// How far the print has come.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Progress {
    /// Whole percents done.
    pub percent: u8,
    /// Whole minutes left.
    pub minutes: u64,
}

/// How far the print has come.
pub(super) fn progress(flavour: Flavour, now: Progress) -> String {
    let Progress { percent, minutes } = now;
    match flavour {
        // Klipper counts the minutes itself.
        Flavour::Klipper => format!("M73 P{percent}"),
        Flavour::Marlin | Flavour::Rrf | Flavour::Prusa | Flavour::Bambu => {
            format!("M73 P{percent} R{minutes}")
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plan(flavour: Flavour, model: &str) -> WriterPlan<'static> {
        WriterPlan::with(|s| {
            s.gcode.flavour = flavour;
            s.printer.model = model.to_owned();
        })
    }

    #[test]
    fn the_limits_agree_about_a_right_angle() {
        let mut s = plan(Flavour::Marlin, "");
        s.corner = 10.0;
        assert_eq!(limits(&s), ["M204 P1000 T1500", "M205 X10 Y10 J0.041"]);
        s.flavour = Flavour::Rrf;
        assert_eq!(limits(&s)[1], "M566 X600 Y600");
        s.flavour = Flavour::Klipper;
        let all = "SET_VELOCITY_LIMIT ACCEL=1500 SQUARE_CORNER_VELOCITY=10";
        assert_eq!(limits(&s), [all]);
        s.sets_limits = false;
        assert!(limits(&s).is_empty());
    }

    #[test]
    fn prusa_printers_get_the_words_of_their_firmware() {
        let advance = |model| {
            let mut s = plan(Flavour::Prusa, model);
            s.pressure_advance = Some(0.05);
            pressure_advance(&s).unwrap_or_default()
        };
        for old in ["", "MK3S", "mk2.5", "MINI"] {
            assert_eq!(advance(old), "M900 K0.05", "{old}");
        }
        for new in ["MK4", "XL", "MK3.5", "MK3.9", "COREONE"] {
            assert_eq!(advance(new), "M572 S0.05", "{new}");
        }
        assert_eq!(
            checks(&plan(Flavour::Prusa, "MK\"3S\n")),
            ["M862.3 P \"MK3S\"", "M862.1 P0.4"]
        );
        assert_eq!(checks(&plan(Flavour::Prusa, "")), ["M862.1 P0.4"]);
        assert!(checks(&plan(Flavour::Marlin, "MK3S")).is_empty());
    }

    #[test]
    fn the_fan_is_full_where_it_should_be() {
        assert_eq!(fan(Flavour::Marlin, pwm(100.0)), "M106 S255");
        assert_eq!(fan(Flavour::Rrf, pwm(100.0)), "M106 S1");
        // In RepRapFirmware an S of 1 is not 1/255.
        assert_eq!(fan(Flavour::Rrf, 1), "M106 S0.004");
        assert_eq!(fan(Flavour::Rrf, 0), "M106 S0");
        assert_eq!(fan(Flavour::Klipper, pwm(f64::NAN)), "M107");
    }
}
