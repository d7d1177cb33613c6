//! What the commands do that the reader does not follow.
//!
//! In: a command. Out: an [`Effect`], or nothing if the command is unknown. A
//! row in the table makes a command known. Sources: Marlin's G-code index,
//! RepRapFirmware's and Klipper's G-code references, Prusa's and Bambu Lab's
//! start and end codes.
//!
//! Of a command's rows the first one that applies counts. If none applies, the
//! command is harmless.

use isoslice_gcode_read::reader::{Named, Words};
use std::collections::BTreeMap;
use std::sync::LazyLock;

/// What a command does to what the check has understood.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Effect {
    /// The command does nothing that matters.
    None,
    /// The command should be looked at. The text says what it does, and
    /// completes a sentence that begins with the command.
    Warns(&'static str),
    /// The command is a pause of some firmware's. What it does depends on the
    /// firmware ([`pause`]).
    Pauses,
    /// The command should be looked at if it stands between two beads.
    Doubts(&'static str),
    /// The command has no place between two beads of a print.
    Disturbs(&'static str),
    /// The command has no place between two beads, and should be looked at
    /// elsewhere.
    Spoils(&'static str),
    /// The head is elsewhere after the command, and has to be brought back
    /// before the next bead.
    Leaves(&'static str),
    /// The command has no place in a file, or changes what the lines after it
    /// mean.
    Harms(&'static str),
}
use Effect::{Disturbs, Doubts, Harms, Leaves, Pauses, Spoils, Warns};

/// When a row applies.
#[derive(Clone, Copy, Debug)]
enum When {
    Always,
    /// One of the letters stands in the command.
    Has(&'static [u8]),
    /// One of the letters has a number outside this range.
    Beyond(&'static [u8], f64, f64),
    /// The letter has this number.
    Is(u8, f64),
    /// None of the letters stands in the command.
    Lacks(&'static [u8]),
}
use When::{Always, Beyond, Has, Is, Lacks};

impl When {
    fn applies(self, words: &Words) -> bool {
        match self {
            Always => true,
            Has(letters) => letters.iter().any(|l| words.has(*l)),
            Beyond(letters, least, most) => letters.iter().any(|l| {
                words.get(*l).is_some_and(|n| !(least..=most).contains(&n))
            }),
            Is(letter, number) => words.get(letter) == Some(number),
            Lacks(letters) => !letters.iter().any(|l| words.has(*l)),
        }
    }
}

/// Commands that the reader follows, and commands that neither move nor heat
/// nor feed: they wait, measure, show, report, light, beep, label, or tell the
/// firmware how to print well.
const HARMLESS: &str = "
    G0 G1 G2 G3 G4 G5 G5.1 G10 G11 G17 G18 G19 G20 G21 G28 G29.2
    G29.4 G29.5 G29.6 G29.7 G29.8 G31 G36 G39 G53 G54 G60
    G69 G75 G77 G81 G82 G83 G86 G87 G88 G89 G90 G91 G98 G99 G150
    G162 G163 G164 G280 G392 G9001
    M5 M7 M8 M9 M10 M11 M16 M17 M18 M20 M21 M22 M27 M31 M36 M38 M39 M73
    M73.2 M70 M72 M74 M75 M76 M77 M78 M80 M82 M83 M84 M85 M86 M87 M100
    M104 M104.1 M105 M106 M107 M108 M109 M110 M111 M113 M114 M115 M116 M117
    M118 M119 M122 M123 M132 M140 M141 M145 M146 M150 M154 M155 M190
    M191 M192 M200 M204.2 M208 M209 M211 M217 M220 M221 M240 M250 M255 M256
    M281 M282 M290 M300 M355 M400 M404 M405 M406 M407
    M408 M409 M411 M412 M413 M414 M415 M422 M430 M450 M451 M486 M493
    M494 M503 M504 M510 M511 M512 M540 M550 M552 M557 M567 M568 M571
    M572 M573 M575 M577 M578 M586 M591 M593 M595 M603 M604 M614 M615 M616
    M617 M620 M620.1 M620.3 M620.10 M620.11 M621 M622 M622.1 M623 M624 M625
    M630 M671 M672 M673 M674 M710 M711 M855 M860 M861 M862 M862.1 M862.2
    M862.3 M862.4 M862.5 M862.6 M863 M864 M865 M869 M871 M876 M900 M910 M911
    M919 M951 M953 M954 M955 M956 M960 M961 M969 M970 M970.1 M970.2 M970.3
    M971 M972 M973 M974 M975 M976 M977 M978 M980 M980.3 M981 M982 M982.2
    M982.4 M982.5 M983 M983.1 M983.3 M984 M985 M986 M990 M991 M1002 M1003
    M1004 M1005 M1006 M1007 M1010 M1011 M201.2
    G40 G94 M602 M912 M929 M998
    T255 T1000 T1001 T1100 T65279 T65535
";

/// Why a speed, an acceleration or a share looks like a mistake.
const ABSURD: &str = "is far from anything a printer does";
const NO_PRINT: &str = "has no place in a print";
const ZERO: &str = "moves the zero that places are counted from, and \
                    firmware differs in which way";
const STEPS: &str = "changes how far a motor goes for a millimetre: every \
                     length after it is another";
const MEMORY: &str = "writes settings to the printer's memory, where they \
                      stay after this print";
const UNSEEN: &str = "moves the head where the check cannot follow";
pub(super) const AWAY: &str = "moves the head away, and the next bead begins wherever it \
                    is then: write a travel in x and y, and a move in z, \
                    before it";
const PROBES: &str = "measures the bed or moves its motors, with a print on the \
                      bed that goes on after it: the nozzle or the probe \
                      would meet the print";
const LEVEL: &str = "changes how heights follow the measured bed in the middle \
                     of the print";
const CONTROL: &str = "changes how the printer controls a heater";
const SHAPE: &str = "changes the machine's own geometry";
const FREE: &str = "lets the head leave the printer's bounds";
const FILES: &str = "writes, deletes or starts files on the printer";
const MOTORS: &str = "changes the current or the set-up of motors";
const RECALL: &str = "sets places and modes back to what was saved before, \
                      which the check does not follow";
const TOO_FAR: &str = "retracts farther than a nozzle can bear";
const PRIME: &str = "pushes much more or much less forward than was pulled back, \
                     at each retraction";
const LOGIC: &str = "makes what follows depend on what only the printer knows";

// Rows: commands, perhaps when the row applies, and the effect.
macro_rules! rows {
    ($($($part:expr),+ => $effect:expr;)*) => {
        &[$(($($part,)+ $effect)),*]
    };
}

/// The effects of the other commands.
const ROWS: &[(&str, When, Effect)] = rows! {
    "G6", Always => Harms(UNSEEN);
    "G10", Has(b"L") => Harms(ZERO);
    "G10", Beyond(b"XYZ", 0.0, 0.0) => Spoils("moves a tool's place");
    "G12 G27 G42 G61 M361 M362 M363 M364", Always => Leaves(AWAY);
    "G26", Always => Spoils("prints a pattern of the firmware's own");
    "G29 G30 G32 G33 G34 G35 G76 G80 G425 M45 M48 M401", Always
        => Disturbs(PROBES);
    "G29.1", Beyond(b"Z", -1.0, 1.0) => Harms(ZERO);
    "G38 G38.2 G38.3 G38.4 G38.5 M360 M585", Always => Spoils(UNSEEN);
    "G380 G383", Always => Warns(UNSEEN);
    "G55 G56 G57 G58 G59 G59.1 G59.2 G59.3 M428", Always => Harms(ZERO);
    "G68", Always => Harms("turns every move after it about a point");
    "G92", Has(b"XYZ") => Disturbs(ZERO);
    "G92", Lacks(b"E") => Disturbs(ZERO);
    "G92.1 M212", Always => Warns(ZERO);
    "G93", Always => Harms("makes every F a time and not a speed");
    "G95", Always => Harms("makes every F a share of a turn");
    "M0 M1 M25 M125 M226 M600 M601", Always => Pauses;
    "M3 M4", Always => Warns("turns a spindle or a laser on");
    "M23 M26 M28 M29 M30 M32 M472 M559 M560", Always => Harms(FILES);
    "M24", Always => Warns("starts a file on the printer, or this one again");
    "M33 M470 M471 M928", Always => Warns(FILES);
    "M37", Always => Harms("makes the printer simulate and not print");
    "M42", Always => Warns("switches a pin, and the check cannot know of what");
    "M43", Always => Warns("switches pins, and the check cannot know of what");
    "M98 M402", Always
        => Doubts("runs what the printer has for it, which may move the head");
    "M81", Always => Disturbs("turns the printer off");
    "M92", Has(b"XYZ") => Harms(STEPS);
    "M92", Always => Spoils(STEPS);
    "M106", Beyond(b"S", 0.0, 255.0)
        => Warns("has a fan speed beyond 255, which is full");
    "M112", Always => Harms("is the emergency stop");
    "M120", Always
        => Warns("turns end stops on, or saves the state of the machine");
    "M121", Always
        => Warns("turns end stops off, or sets the machine's state back");
    "M143", Always
        => Warns("changes the greatest temperature that the printer allows");
    "M144", Always
        => Doubts("lets the bed cool in the middle of the print: the print may \
                   come loose from it");
    "M149", Has(b"FK") => Harms("makes temperatures Fahrenheit or Kelvin");
    "M163 M164 M165 M166", Always => Warns("changes what is mixed");
    "M201 M202", Beyond(b"XYZE", 1.0, 200_000.0) => Warns(ABSURD);
    "M203", Beyond(b"XYZE", 0.1, 200_000.0) => Warns(ABSURD);
    "M204", Beyond(b"SPRT", 1.0, 200_000.0) => Warns(ABSURD);
    "M205", Beyond(b"XYZE", 0.0, 200.0) => Warns(ABSURD);
    "M205", Beyond(b"J", 0.0, 1.0) => Warns(ABSURD);
    "M206", Beyond(b"XYZ", -1.0, 1.0) => Harms(ZERO);
    "M206", Beyond(b"XYZ", 0.0, 0.0) => Spoils(ZERO);
    "M207", Beyond(b"S", 0.0, 20.0)
        => Warns(TOO_FAR);
    "M207", Beyond(b"R", -5.0, 5.0) => Warns(PRIME);
    "M207", Beyond(b"Z", 0.0, 20.0) => Warns(ABSURD);
    "M208", Has(b"XYZ") => Warns("changes how far the axes reach");
    "M208", Beyond(b"S", -5.0, 5.0) => Warns(PRIME);
    "M210", Always => Warns("changes the speed of homing");
    "M211", Is(b'S', 0.0) => Warns(FREE);
    "M211", Has(b"XYZ") => Warns(FREE);
    "M218", Beyond(b"XY", -100.0, 100.0)
        => Harms("moves a tool farther than tools are apart");
    "M218", Beyond(b"Z", -5.0, 5.0)
        => Harms("moves a tool farther than tools are apart");
    "M218", Beyond(b"XYZ", 0.0, 0.0) => Spoils("moves a tool's place");
    "M220", Beyond(b"S", 10.0, 300.0)
        => Warns("has a share of the speed beyond 10 to 300 %");
    "M221", Beyond(b"S", 50.0, 200.0)
        => Warns("has a share of the flow beyond 50 to 200 %");
    // A probe's pin comes down at small angles.
    "M280", Beyond(b"S", 60.0, f64::INFINITY)
        => Doubts("moves a servo, which may bring the probe down");
    "M260", Always => Warns("talks to other devices");
    "M290", Beyond(b"XYZS", -1.0, 1.0) => Harms(ZERO);
    "M290", Beyond(b"XYZS", 0.0, 0.0)
        => Warns("moves all that follows by a small step");
    "M301 M304 M305 M306 M307 M308 M309", Always => Warns(CONTROL);
    "M302", Always => Warns("lets cold filament be pushed");
    "M303", Always => Harms("tunes a heater, in the middle of a file");
    "M350", Always
        => Spoils("changes the motors' microsteps, and with it lengths in some \
                  firmware");
    "M400", Is(b'U', 1.0) => Pauses;
    "M410", Always => Harms("stops all motors at once");
    "M420 M561", Always => Disturbs(LEVEL);
    "M421", Always => Warns("changes the measured bed");
    "M425", Always => Warns("changes the backlash that is made up for");
    "M452", Always => Warns("makes the printer a laser");
    "M453", Always => Warns("makes the printer a mill");
    "M500", Always => Warns(MEMORY);
    "M501", Always
        => Spoils("reads the settings back from the printer's memory");
    "M502", Always
        => Harms("resets the printer's settings: steps, offsets, limits");
    "M524", Always => Harms("ends the print");
    "M553 M554 M587 M588 M589", Always => Warns(NO_PRINT);
    "M555", Always => Warns("changes what the printer takes commands for");
    "M556 M665 M666 M852", Always => Spoils(SHAPE);
    "M558", Always => Warns("changes the probe");
    "M562", Always => Warns("resets a heater's fault");
    "M563", Always => Spoils("defines a tool anew");
    "M564", Is(b'S', 0.0) => Warns(FREE);
    "M564", Is(b'H', 0.0) => Warns("lets axes move that were not homed");
    "M566", Beyond(b"XYZE", 0.0, 12_000.0) => Warns(ABSURD);
    "M569", Has(b"P") => Harms(MOTORS);
    "M570", Always => Warns("changes when a heater's fault is noticed");
    "M574", Always => Warns("changes the end stops");
    "M579", Always => Harms(STEPS);
    "M581 M582 M703", Always => Warns(LOGIC);
    "M584", Always => Harms(MOTORS);
    "M592", Always => Warns("makes the feed another at speed");
    "M605", Beyond(b"S", 0.0, 1.0) => Warns("makes two heads print the same");
    "M667 M669", Always => Harms(SHAPE);
    "M701", Always => Warns("loads filament in the firmware's own way");
    "M702", Always => Warns("unloads filament in the firmware's own way");
    "M808", Always => Warns(LOGIC);
    "M851", Beyond(b"Z", -10.0, 10.0)
        => Harms("changes how high the nozzle is over the bed");
    "M851", Has(b"XYZ") => Spoils("changes how high the nozzle is over the bed");
    // Bambu Lab's printers take L1000 beside K and M10.
    "M900", Beyond(b"K", 0.0, 200.0) => Warns(ABSURD);
    "M900", Has(b"M") => Effect::None;
    "M900", Beyond(b"L", 0.0, 200.0) => Warns(ABSURD);
    "M906", Beyond(b"XYZE", 0.0, 3000.0) => Harms(MOTORS);
    "M906", Always => Warns(MOTORS);
    "M907 M908 M909 M913 M914 M915", Always => Warns(MOTORS);
    "M950", Always => Warns("defines pins, heaters or fans anew");
    "M997", Always => Harms("replaces the printer's firmware");
    "M999", Always
        => Harms("restarts the printer, or goes on after its emergency stop");
};

/// Commands that are names and neither move nor heat nor feed, or that the
/// reader follows.
const HARMLESS_NAMES: &str = "
    ACTIVATE_EXTRUDER BED_MESH_MAP BED_MESH_OUTPUT
    CALC_MEASURED_SKEW CLEAR_PAUSE ECHO EXCLUDE_OBJECT EXCLUDE_OBJECT_DEFINE
    EXCLUDE_OBJECT_END EXCLUDE_OBJECT_START GET_POSITION GET_RETRACTION HELP
    PALETTE_CLEAR QUERY_ENDSTOPS QUERY_FILAMENT_SENSOR QUERY_PROBE RESPOND
    SAVE_GCODE_STATE SAVE_VARIABLE SET_DISPLAY_GROUP SET_DISPLAY_TEXT
    SET_DOTSTAR SET_FAN_SPEED SET_FILAMENT_SENSOR SET_GCODE_VARIABLE
    SET_HEATER_TEMPERATURE SET_IDLE_TIMEOUT SET_INPUT_SHAPER SET_LED
    SET_LED_TEMPLATE SET_NEOPIXEL SET_PRESSURE_ADVANCE SET_PRINT_STATS_INFO
    SET_SMOOTH_TIME SET_TEMPERATURE_FAN_TARGET
    SET_VELOCITY_LIMIT STATUS TEMPERATURE_WAIT TIMELAPSE_TAKE_FRAME
    TURN_OFF_HEATERS BREAK CONTINUE T? TX TC
    DUMP_TMC GLOBAL RESUME SKIP VAR
";

/// The effects of the other commands that are names.
const NAMES: &[(&str, Effect)] = rows! {
    "@PAUSE"
        => Warns("stops the print until somebody is there, if OctoPrint sends the \
                  file: printers do not know it");
    "PAUSE" => Pauses;
    "ANGLE_CALIBRATE AXIS_TWIST_COMPENSATION_CALIBRATE BED_SCREWS_ADJUST \
     ENDSTOP_PHASE_CALIBRATE MANUAL_PROBE PROBE_CALIBRATE \
     PROBE_EDDY_CURRENT_CALIBRATE PROBE_EDDY_CURRENT_TAP_CALIBRATE \
     SHAPER_CALIBRATE TEMPERATURE_PROBE_CALIBRATE TEST_RESONANCES \
     Z_ENDSTOP_CALIBRATE" => Spoils(PROBES);
    "ABORT CANCEL_PRINT" => Harms("ends the print");
    "MANUAL_STEPPER" => Warns(UNSEEN);
    "BLTOUCH_DEBUG SET_SERVO"
        => Doubts("moves a servo, which may bring the probe down");
    "BED_MESH_CALIBRATE BED_TILT_CALIBRATE DELTA_CALIBRATE PROBE \
     PROBE_ACCURACY QUAD_GANTRY_LEVEL SCREWS_TILT_CALCULATE Z_TILT_ADJUST"
        => Disturbs(PROBES);
    "BED_MESH_CLEAR BED_MESH_OFFSET BED_MESH_PROFILE" => Disturbs(LEVEL);
    "ELIF ELSE IF SDCARD_LOOP_BEGIN SET UPDATE_DELAYED_GCODE WHILE"
        => Warns(LOGIC);
    "FIRMWARE_RESTART RESTART" => Harms("restarts the printer");
    "FORCE_MOVE" => Harms("moves a motor without the printer's knowing where");
    "INIT_TMC SET_TMC_CURRENT SET_TMC_FIELD" => Warns(MOTORS);
    "PID_CALIBRATE" => Harms("tunes a heater, in the middle of a file");
    "RESTORE_DUAL_CARRIAGE_STATE RESTORE_GCODE_STATE" => Warns(RECALL);
    "SAVE_CONFIG" => Harms("writes the printer's settings and restarts it");
    "SDCARD_PRINT_FILE SDCARD_RESET_FILE" => Harms(FILES);
    "SET_DUAL_CARRIAGE" => Warns("takes another carriage");
    "SET_EXTRUDER_ROTATION_DISTANCE SET_EXTRUDER_STEP_DISTANCE" => Harms(STEPS);
    "SET_KINEMATIC_POSITION"
        => Harms("tells the printer that the head is elsewhere");
    "SET_PIN" => Warns("switches a pin, and the check cannot know of what");
    "SET_SKEW SET_STEPPER_CARRIAGES SKEW_PROFILE" => Spoils(SHAPE);
    "SET_STEPPER_ENABLE" => Spoils("turns motors on or off");
    "STEPPER_BUZZ" => Harms(NO_PRINT);
    "SYNC_EXTRUDER_MOTION" => Warns("joins extruders to one another");
    "TUNING_TOWER" => Warns("changes a setting of the printer's by height");
    "Z_OFFSET_APPLY_ENDSTOP Z_OFFSET_APPLY_PROBE" => Warns(MEMORY);
};

type Rows = Vec<(When, Effect)>;

/// The rows of each command.
static TABLE: LazyLock<BTreeMap<(u8, u32), Rows>> = LazyLock::new(|| {
    let mut table: BTreeMap<_, Rows> = BTreeMap::new();
    for key in HARMLESS.split_whitespace().filter_map(key) {
        table.entry(key).or_default();
    }
    for (names, when, effect) in ROWS {
        for key in names.split_whitespace().filter_map(key) {
            table.entry(key).or_default().push((*when, *effect));
        }
    }
    table
});

/// The table's key for a command: `G38.2` is G and 382.
fn key(name: &str) -> Option<(u8, u32)> {
    let (letter, number) = name.split_at_checked(1)?;
    let tenths = (number.parse::<f64>().ok()? * 10.0).round() as u32;
    Some((letter.as_bytes()[0], tenths))
}

/// What a command of a letter and a number does; none if the command is
/// unknown.
pub(super) fn of_code(
    letter: char,
    tenths: u32,
    words: &Words,
) -> Option<Effect> {
    let rows = TABLE.get(&(letter as u8, tenths))?;
    let row = rows.iter().find(|(when, _)| when.applies(words));
    Some(row.map_or(Effect::None, |(_, effect)| *effect))
}

/// What a command that is a name does; none if the command is unknown.
pub(super) fn of_name(named: &Named) -> Option<Effect> {
    if named.is("SET_GCODE_OFFSET") {
        return Some(offset(named));
    }
    if named.is("SET_RETRACTION") {
        return Some(retraction(named));
    }
    let among = |names: &str| names.split_whitespace().any(|n| named.is(n));
    let row = NAMES.iter().find(|(names, _)| among(names));
    let effect = row.map(|(_, effect)| *effect);
    effect.or_else(|| among(HARMLESS_NAMES).then_some(Effect::None))
}

/// What a command does that is a pause of some firmware's, if this firmware reads it,
/// and whether it ends the print.
pub(super) fn pause(
    word: &str,
    of: &isoslice_settings::Pauses,
) -> (String, bool) {
    if of.ends.contains(&word) {
        let firmware = of.firmware;
        let why = format!("ends the print with {firmware}; {}", of.advice);
        return (why, true);
    }
    let known = of.known.iter().find(|(known, _)| *known == word);
    let why = match known {
        Some((_, needs)) => {
            format!("stops the print until somebody is there{needs}")
        }
        None => {
            let unless = of
                .defined_in
                .map(|place| format!(" unless {place} defines it"));
            format!(
                "does not stop the print{}: {} does not know it as a pause, and \
                 prints on; {}",
                unless.unwrap_or_default(),
                of.firmware,
                of.advice
            )
        }
    };
    (why, false)
}

/// What an offset of Klipper's does, which the reader adds to all places.
fn offset(named: &Named) -> Effect {
    let beyond = |most: f64, keys: &[&str]| {
        let numbers = keys.iter().filter_map(|key| named.number(key));
        numbers.into_iter().any(|n| n.abs() > most)
    };
    let heights = ["Z", "Z_ADJUST"];
    if beyond(1.0, &heights) {
        Warns("moves every height by more than a millimetre")
    } else if beyond(0.0, &["X", "X_ADJUST", "Y", "Y_ADJUST"]) {
        Disturbs(ZERO)
    } else if beyond(0.0, &heights) {
        Doubts("moves all that follows by a small step")
    } else {
        Effect::None
    }
}

/// What Klipper's lengths of retractions by the firmware do.
fn retraction(named: &Named) -> Effect {
    let beyond = |key: &str, least: f64, most: f64| {
        let number = named.number(key);
        number.is_some_and(|n| !(least..=most).contains(&n))
    };
    if beyond("RETRACT_LENGTH", 0.0, 20.0) {
        Warns(TOO_FAR)
    } else if beyond("UNRETRACT_EXTRA_LENGTH", -5.0, 5.0) {
        Warns(PRIME)
    } else {
        Effect::None
    }
}

/// A command as it is written: `M104.1`.
pub(super) fn code(letter: char, tenths: u32) -> String {
    match (tenths / 10, tenths % 10) {
        (whole, 0) => format!("{letter}{whole}"),
        (whole, tenth) => format!("{letter}{whole}.{tenth}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_row_is_a_command_and_can_apply() {
        for name in HARMLESS.split_whitespace() {
            // Only Bambu Lab's commands have two digits after the point. They
            // are rounded.
            let (letter, tenths) = key(name).unwrap();
            let written = code(char::from(letter), tenths);
            assert!(written == name || name.starts_with("M620.1"), "{name}");
        }
        let mut last_of = BTreeMap::new();
        for (i, (names, when, _)) in ROWS.iter().enumerate() {
            for name in names.split_whitespace() {
                let always = matches!(when, Always);
                let before = last_of.insert(key(name).unwrap(), (i, always));
                // Rows of a command stand together, and none follows a row
                // that always applies.
                assert!(before.is_none_or(|b| b == (i - 1, false)), "{name}");
            }
        }
        let names =
            NAMES.iter().flat_map(|(names, _)| names.split_whitespace());
        let all: Vec<&str> =
            names.chain(HARMLESS_NAMES.split_whitespace()).collect();
        let apart: std::collections::BTreeSet<_> = all.iter().collect();
        assert_eq!(apart.len(), all.len());
    }
}
