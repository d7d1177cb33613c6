//! What a start template does about heating. The writer does the rest.

/// What a start template does about a heater.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Heating {
    /// The template does nothing.
    Not,
    /// The template sets the temperature and goes on.
    Sets,
    /// The template sets the temperature and waits for it.
    Waits,
}

/// What a template does about the heater whose commands are `set` and `wait`
/// and whose temperatures have the placeholders `names`. A macro that is
/// given the temperature is trusted to wait for it.
pub(super) fn heating(
    source: &str,
    rendered: &str,
    set: &str,
    wait: &str,
    names: &[&str],
) -> Heating {
    let mut found = Heating::Not;
    for command in rendered.lines().filter_map(command) {
        if command.eq_ignore_ascii_case(set) {
            found = Heating::Sets;
        } else if command.eq_ignore_ascii_case(wait) {
            return Heating::Waits;
        }
    }
    // Only the source tells which placeholder a number comes from, and only the
    // filled-in text tells whether a condition left it out.
    let written = |name: &str| {
        let mut commands = rendered.lines().filter_map(command);
        commands.any(|c| c.eq_ignore_ascii_case(name))
    };
    for line in source.lines() {
        let Some(name) = command(line).filter(|c| is_macro(c)) else {
            continue;
        };
        let code = line.split(';').next().unwrap_or("");
        if !names.iter().any(|name| uses(code, name)) || !written(name) {
            continue;
        }
        match of_macro(name) {
            Heating::Waits => return Heating::Waits,
            Heating::Sets => found = Heating::Sets,
            Heating::Not => {}
        }
    }
    found
}

/// Klipper's commands that only show or remember something.
const TELL: [&str; 6] = [
    "RESPOND",
    "SET_DISPLAY_TEXT",
    "SET_GCODE_VARIABLE",
    "SET_PRINT_STATS_INFO",
    "SAVE_VARIABLE",
    "ACTION_RESPOND_INFO",
];

/// What a named command does with a temperature that it is given. Klipper's own
/// commands are known; any other is a macro of the printer.
fn of_macro(name: &str) -> Heating {
    let is = |other: &str| name.eq_ignore_ascii_case(other);
    if TELL.iter().any(|t| is(t)) {
        Heating::Not
    } else if is("SET_HEATER_TEMPERATURE") {
        Heating::Sets
    } else {
        Heating::Waits
    }
}

/// True if a filled-in template may leave the machine with other units or
/// modes. Either the template sets them itself, or it calls a macro, which can
/// do anything.
pub(super) fn may_change_modes(rendered: &str) -> bool {
    const MODES: [&str; 6] = ["G20", "G21", "G90", "G91", "M82", "M83"];
    let mut all = rendered.lines().flat_map(commands).filter_map(command);
    all.any(|c| is_macro(c) || MODES.iter().any(|m| c.eq_ignore_ascii_case(m)))
}

/// Commands that leave the head and the zero of its axes where they are: they
/// wait, show, beep, take a picture, heat, cool, or set modes and limits.
const STILL: [&str; 49] = [
    "G4", "G20", "G21", "G90", "G91", "M17", "M31", "M42", "M73", "M75", "M76",
    "M77", "M82", "M83", "M104", "M105", "M106", "M107", "M108", "M109",
    "M114", "M115", "M116", "M117", "M118", "M140", "M141", "M150", "M155",
    "M190", "M191", "M201", "M203", "M204", "M205", "M207", "M220", "M221",
    "M240", "M300", "M355", "M400", "M486", "M566", "M572", "M593", "M900",
    "M907", "M971",
];

/// True if a filled-in template may leave the head at another place. Whatever
/// is not known to leave it alone may move it.
pub(super) fn may_move(rendered: &str) -> bool {
    rendered.lines().flat_map(commands).any(|one| {
        let Some(name) = command(one) else {
            return false;
        };
        let is = |other: &&str| name.eq_ignore_ascii_case(other);
        let still = match name.to_ascii_uppercase().as_str() {
            // These are about the filament or the speed alone.
            "G0" | "G1" | "G92" => {
                let has = |letters: &str| {
                    let mut all = one.chars().map(|c| c.to_ascii_uppercase());
                    all.any(|c| letters.contains(c))
                };
                has("EF") && !has("XYZUVWABC")
            }
            _ => STILL.iter().chain(&TELL).any(is),
        };
        !still
    })
}

/// The commands of a line. RepRapFirmware takes several: a G or an M after a
/// blank begins the next one, unless it is in quotes, or in text that is shown.
/// Other firmware takes the first one alone.
fn commands(line: &str) -> impl Iterator<Item = &str> {
    let code = line.split(';').next().unwrap_or("");
    let name = command(code).unwrap_or("");
    let alone = name.eq_ignore_ascii_case("M117") || is_macro(name);
    let (mut blank, mut quoted) = (false, false);
    let begins = code.char_indices().filter(move |&(_, c)| {
        let next = blank && !quoted && matches!(c, 'G' | 'g' | 'M' | 'm');
        blank = c.is_whitespace();
        quoted ^= c == '"';
        next && !alone
    });
    let starts: Vec<usize> =
        [0].into_iter().chain(begins.map(|(i, _)| i)).collect();
    let ends = starts.clone().into_iter().skip(1).chain([code.len()]);
    starts
        .into_iter()
        .zip(ends)
        .map(move |(from, to)| &code[from..to])
}

/// The first word of a line, if it is not in a comment.
fn command(line: &str) -> Option<&str> {
    line.split(';').next()?.split_whitespace().next()
}

/// True for a command that is a name, not a letter and a number. The text that
/// `M117` shows is not a macro.
fn is_macro(command: &str) -> bool {
    let starts = command.starts_with(|c: char| c.is_alphabetic() || c == '_');
    let numbered = command
        .chars()
        .skip(1)
        .all(|c| c.is_ascii_digit() || c == '.');
    starts && !numbered
}

/// True if an expression in `code` names `name`.
fn uses(code: &str, name: &str) -> bool {
    let part = |c: char| c.is_alphanumeric() || c == '_';
    code.split("{{")
        .skip(1)
        .filter_map(|rest| rest.split("}}").next())
        .any(|inside| inside.split(|c| !part(c)).any(|word| word == name))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn changes_of_mode_are_recognised() {
        assert!(!may_change_modes("G28 ; G91\nG1 Z5"));
        assert!(may_change_modes("G28\n g91\nG1 Z5\nG90"));
        assert!(may_change_modes("START_PRINT"));
    }

    #[test]
    fn a_line_may_have_several_commands() {
        let all = |line| commands(line).map(str::trim).collect::<Vec<_>>();
        let line = "  M106 S128 G91 g1 Z5 G90 ; G28";
        assert_eq!(all(line), ["", "M106 S128", "G91", "g1 Z5", "G90"]);
        for whole in ["M117 at G1", "M118 S\"at G1\"", "G1 X5 E1", "SAY G1"] {
            assert_eq!(all(whole), [whole]);
        }
        assert!(may_move(line) && may_change_modes(line));
        assert!(may_move("M106 S128 G1 Z5"));
        assert!(may_change_modes("M106 S128 M82"));
        assert!(!may_move("G1 E-1 F900 M106 S128"));
        assert!(!may_change_modes("G1 E-1 F900 M106 S128"));
    }

    #[test]
    fn what_may_move_the_head_is_recognised() {
        for still in [
            "; G1 X5",
            "M117 G1 X5",
            "g92 e0",
            "G1 E-0.5 F1800\nM106 S80",
            "SET_DISPLAY_TEXT MSG=\"layer 3\"\n\nM73 P4 ; X",
        ] {
            assert!(!may_move(still), "{still}");
        }
        for moves in [
            "G91\nG1 Z5\nG90",
            "G0X3",
            "G28",
            "G92",
            "G92 E0 Z1",
            "TIMELAPSE_TAKE_FRAME",
            "M600",
            "M240\nm125",
            "T1",
        ] {
            assert!(may_move(moves), "{moves}");
        }
    }

    #[test]
    fn heating_is_recognised() {
        let nozzle = |s| heating(s, s, "M104", "M109", &["nozzle_temperature"]);
        assert_eq!(nozzle("G28 ; M109 S200"), Heating::Not);
        assert_eq!(nozzle("G28\nm104 S200"), Heating::Sets);
        assert_eq!(nozzle("M117 at {{ nozzle_temperature }}"), Heating::Not);
        assert_eq!(nozzle("M104 S200\nM109 S200"), Heating::Waits);
        assert_eq!(
            nozzle("START_PRINT T={{ [nozzle_temperature, 200] | max }}"),
            Heating::Waits
        );
        assert_eq!(
            nozzle("START_PRINT T={{ first_layer_nozzle_temperature }}"),
            Heating::Not
        );
        assert_eq!(
            nozzle("START_PRINT ; {{ nozzle_temperature }}"),
            Heating::Not
        );
        // Klipper's own commands set, wait or tell.
        let sets = "SET_HEATER_TEMPERATURE HEATER=extruder \
                    TARGET={{ nozzle_temperature }}";
        assert_eq!(nozzle(sets), Heating::Sets);
        let waits = "TEMPERATURE_WAIT SENSOR=extruder \
                     MINIMUM={{ nozzle_temperature }}";
        assert_eq!(nozzle(waits), Heating::Waits);
        let tells = "RESPOND MSG=\"to {{ nozzle_temperature }}\"";
        assert_eq!(nozzle(tells), Heating::Not);
        // A command that a condition leaves out does not heat.
        let source = "{% if klipper %}\nSTART T={{ nozzle_temperature }}\n\
                      {% else %}\nG28\n{% endif %}";
        let names = &["nozzle_temperature"];
        let found = heating(source, "G28\n", "M104", "M109", names);
        assert_eq!(found, Heating::Not);
        let found = heating(source, "START T=200\n", "M104", "M109", names);
        assert_eq!(found, Heating::Waits);
        let source = "{% if false %}\nM109 S200\n{% endif %}\nG28";
        let found = heating(source, "G28\n", "M104", "M109", &[]);
        assert_eq!(found, Heating::Not);
    }
}
