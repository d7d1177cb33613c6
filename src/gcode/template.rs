//! Templates: the user's own lines at the start and the end of a file.
//!
//! In: text with placeholders, `{name}`; `{{` and `}}` stand for the braces
//! themselves. Out: the text with every placeholder replaced by its value.
//! [`PLACEHOLDERS`] is the list of them.
//!
//! Guarantees: a placeholder nobody knows, and a brace without its partner,
//! are errors that say where; nothing is left out silently.

use super::Header;
use super::number::text;
use crate::settings::Settings;
use crate::units::feed_rate;

/// A name that a template may use.
#[derive(Clone, Copy, Debug)]
pub struct Placeholder {
    /// The name, as between the braces.
    pub name: &'static str,
    /// What it stands for, with its unit.
    pub description: &'static str,
    /// Its value in a print.
    pub value: fn(&Settings, &Header) -> String,
}

macro_rules! placeholders {
    ($($name:literal, $description:literal,
       |$s:pat_param, $h:pat_param| $value:expr;)*) => {
        &[$(Placeholder {
            name: $name,
            description: $description,
            value: |$s, $h| $value,
        }),*]
    };
}

/// How far above the part the head is parked, mm: out of the way of a hand.
const PARK_LIFT: f64 = 10.0;

/// Every placeholder, in the order documentation lists them.
pub const PLACEHOLDERS: &[Placeholder] = placeholders![
    "nozzle_temperature", "nozzle temperature, °C",
        |s, _| {
            // An expression begins above the first layer.
            let filament = &s.filament;
            let above = filament.nozzle_temperature.constant();
            text(above.unwrap_or(filament.first_layer_nozzle_temperature), 1)
        };
    "first_layer_nozzle_temperature",
        "nozzle temperature of the first layer, °C",
        |s, _| text(s.filament.first_layer_nozzle_temperature, 1);
    "bed_temperature", "bed temperature, °C",
        |s, _| text(s.filament.bed_temperature, 1);
    "first_layer_bed_temperature", "bed temperature of the first layer, °C",
        |s, _| text(s.filament.first_layer_bed_temperature, 1);
    "layer_count", "number of layers",
        |_, h| h.layer_count.to_string();
    "layer_height", "layer height, mm",
        |s, _| text(s.layer_height, 4);
    "first_layer_height", "height of the first layer, mm",
        |s, _| text(s.first_layer_height, 4);
    "bed_x", "width of the bed, mm",
        |s, _| text(s.printer.bed_x, 3);
    "bed_y", "depth of the bed, mm",
        |s, _| text(s.printer.bed_y, 3);
    "height", "greatest height the printer prints, mm",
        |s, _| text(s.printer.height, 3);
    "nozzle_diameter", "diameter of the nozzle, mm",
        |s, _| text(s.printer.nozzle_diameter, 3);
    "filament_diameter", "diameter of the filament, mm",
        |s, _| text(s.filament.diameter, 3);
    "retract_length", "length of a retraction, mm",
        |s, _| text(s.retract.length, 3);
    "feed_rate_travel", "travel speed as a feed rate, mm/min",
        |s, _| text(feed_rate(s.speed.travel), 0);
    "feed_rate_z", "greatest speed of z as a feed rate, mm/min",
        |s, _| text(feed_rate(s.printer.max_speed_z), 0);
    "part_min_x", "least x of the part, mm", |_, h| text(h.part_min.x, 3);
    "part_min_y", "least y of the part, mm", |_, h| text(h.part_min.y, 3);
    "part_min_z", "least z of the part, mm", |_, h| text(h.part_min.z, 3);
    "part_max_x", "greatest x of the part, mm", |_, h| text(h.part_max.x, 3);
    "part_max_y", "greatest y of the part, mm", |_, h| text(h.part_max.y, 3);
    "part_max_z", "greatest z of the part, mm", |_, h| text(h.part_max.z, 3);
    "park_z", "10 mm above the part, or as high as the printer goes, mm",
        |s, h| text(
            (h.part_max.z + PARK_LIFT)
                .min(s.printer.height)
                .max(h.part_max.z),
            3,
        );
    "model_name", "name of the model, without folder and extension",
        |_, h| one_line(&h.model_name);
];

/// Why a template cannot be filled in.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum TemplateError {
    /// A placeholder that does not exist.
    #[error(
        "{template}, line {line}, column {column}: there is no placeholder \
         {{{name}}}{hint}; the known ones are {known}"
    )]
    Unknown {
        /// The setting that holds the template.
        template: &'static str,
        /// Line, from 1.
        line: usize,
        /// Column of its brace in characters, from 1.
        column: usize,
        /// Its name.
        name: String,
        /// What may have been meant, as the end of a sentence; or nothing.
        hint: String,
        /// All names.
        known: String,
    },
    /// A brace that opens and does not close on its line.
    #[error(
        "{template}, line {line}, column {column}: {{ is not closed on its \
         line; write {{name}} for a placeholder, {{{{ for the brace itself"
    )]
    Unclosed {
        /// The setting that holds the template.
        template: &'static str,
        /// Line, from 1.
        line: usize,
        /// Column of the brace in characters, from 1.
        column: usize,
    },
    /// A brace that closes nothing.
    #[error(
        "{template}, line {line}, column {column}: }} closes nothing; write \
         }}}} for the brace itself"
    )]
    Unopened {
        /// The setting that holds the template.
        template: &'static str,
        /// Line, from 1.
        line: usize,
        /// Column of the brace in characters, from 1.
        column: usize,
    },
}

/// Fills in `source`, which is the setting called `template`. Lines end in a
/// line feed, the last one too, without blanks before it.
///
/// # Errors
/// If a placeholder is unknown or a brace has no partner.
pub fn render(
    template: &'static str,
    source: &str,
    settings: &Settings,
    header: &Header,
) -> Result<String, TemplateError> {
    let mut out = String::with_capacity(2 * source.len());
    for (number, line) in source.lines().enumerate() {
        let place = Place {
            template,
            line: number + 1,
        };
        fill(line, &place, settings, header, &mut out)?;
        out.truncate(out.trim_end_matches([' ', '\t', '\r']).len());
        out.push('\n');
    }
    Ok(out)
}

/// Where a line stands, for error messages.
struct Place {
    template: &'static str,
    line: usize,
}

/// Fills in one line.
fn fill(
    line: &str,
    place: &Place,
    settings: &Settings,
    header: &Header,
    out: &mut String,
) -> Result<(), TemplateError> {
    let Place {
        template,
        line: number,
    } = *place;
    let mut rest = line;
    while let Some(at) = rest.find(['{', '}']) {
        let (before, brace) = rest.split_at(at);
        out.push_str(before);
        let column = line[..line.len() - brace.len()].chars().count() + 1;
        if let Some(after) = brace.strip_prefix("{{") {
            out.push('{');
            rest = after;
        } else if let Some(after) = brace.strip_prefix("}}") {
            out.push('}');
            rest = after;
        } else if let Some(after) = brace.strip_prefix('{') {
            let Some((name, after)) = after.split_once('}') else {
                return Err(TemplateError::Unclosed {
                    template,
                    line: number,
                    column,
                });
            };
            let known =
                find(name.trim()).ok_or_else(|| TemplateError::Unknown {
                    template,
                    line: number,
                    column,
                    name: name.to_owned(),
                    hint: hint(name.trim()),
                    known: names().collect::<Vec<_>>().join(", "),
                })?;
            out.push_str(&(known.value)(settings, header));
            rest = after;
        } else {
            return Err(TemplateError::Unopened {
                template,
                line: number,
                column,
            });
        }
    }
    out.push_str(rest);
    Ok(())
}

/// What a start template does about a heater itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Heating {
    /// Nothing.
    Not,
    /// Sets the temperature and goes on.
    Sets,
    /// Sets the temperature and waits for it.
    Waits,
}

/// What `source` does about the heater whose commands are `set` and `wait`
/// and whose temperatures have the placeholders `names`. A macro that is
/// given the temperature is trusted to wait for it.
pub(super) fn heating(
    source: &str,
    set: &str,
    wait: &str,
    names: &[&str],
) -> Heating {
    let mut found = Heating::Not;
    for line in source.lines() {
        let code = line.split(';').next().unwrap_or("");
        let command = code.split_whitespace().next().unwrap_or("");
        if command.eq_ignore_ascii_case(set) {
            found = Heating::Sets;
        } else if command.eq_ignore_ascii_case(wait)
            || (is_macro(command) && names.iter().any(|n| uses(code, n)))
        {
            return Heating::Waits;
        }
    }
    found
}

/// True if `source` may leave the machine with other units or modes than it
/// found: it sets them for its own use, or calls a macro, which can do
/// anything.
pub(super) fn may_change_modes(source: &str) -> bool {
    const MODES: [&str; 6] = ["G20", "G21", "G90", "G91", "M82", "M83"];
    source
        .lines()
        .map(|line| line.split(';').next().unwrap_or(""))
        .filter_map(|code| code.split_whitespace().next())
        .any(|c| is_macro(c) || MODES.iter().any(|m| c.eq_ignore_ascii_case(m)))
}

/// True for a command that is a name, not a letter and a number: what an
/// `M117` shows does not heat.
fn is_macro(command: &str) -> bool {
    !command
        .chars()
        .skip(1)
        .all(|c| c.is_ascii_digit() || c == '.')
}

/// True if `code` has the placeholder `name`.
fn uses(code: &str, name: &str) -> bool {
    code.split('{')
        .filter_map(|part| part.split_once('}'))
        .any(|(inside, _)| inside.trim() == name)
}

fn names() -> impl Iterator<Item = &'static str> {
    PLACEHOLDERS.iter().map(|p| p.name)
}

fn find(name: &str) -> Option<&'static Placeholder> {
    PLACEHOLDERS.iter().find(|p| p.name == name)
}

/// The nearest known name, if one is near.
fn hint(name: &str) -> String {
    // Below this two names have little more than a letter in common.
    const NEAR: f64 = 0.8;
    names()
        .map(|known| (strsim::jaro_winkler(name, known), known))
        .filter(|(likeness, _)| *likeness >= NEAR)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, known)| format!(", did you mean {{{known}}}?"))
        .unwrap_or_default()
}

/// `name` without what would end its line or hide in it.
fn one_line(name: &str) -> String {
    name.chars()
        .map(|c| if c.is_control() { ' ' } else { c })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    fn header() -> Header {
        Header {
            model_name: "gyroid\nball".to_owned(),
            layer_count: 12,
            nozzle_temperature: 210.0,
            layers: 0..1,
            part_min: DVec3::new(95.0, 95.0, 0.0),
            part_max: DVec3::new(125.0, 125.0, 30.0),
        }
    }

    fn filled(source: &str) -> Result<String, TemplateError> {
        render("gcode.start", source, &Settings::default(), &header())
    }

    #[test]
    fn placeholders_are_filled_in() {
        assert_eq!(
            filled("M104 S{nozzle_temperature} \r\nG1 Z{ park_z }").as_deref(),
            Ok("M104 S210\nG1 Z40\n")
        );
        assert_eq!(
            filled("M117 {{{model_name}}}").as_deref(),
            Ok("M117 {gyroid ball}\n")
        );
        assert_eq!(filled("").as_deref(), Ok(""));
    }

    #[test]
    fn every_placeholder_has_a_value_and_its_own_name() {
        for p in PLACEHOLDERS {
            let value = (p.value)(&Settings::default(), &header());
            assert!(!value.is_empty(), "{}", p.name);
            assert_eq!(names().filter(|n| *n == p.name).count(), 1);
        }
    }

    #[test]
    fn errors_say_where() {
        let error = filled("G28\nM104 Sé{nozle_temp}").map_err(|e| {
            let s = e.to_string();
            s.split("; ").next().unwrap_or("").to_owned()
        });
        assert_eq!(
            error,
            Err("gcode.start, line 2, column 8: there is no placeholder \
                 {nozle_temp}, did you mean {nozzle_temperature}?"
                .to_owned())
        );
        assert!(matches!(
            filled("G28 {bed_x"),
            Err(TemplateError::Unclosed {
                line: 1,
                column: 5,
                ..
            })
        ));
        assert!(matches!(
            filled("\n\nG28 }"),
            Err(TemplateError::Unopened {
                line: 3,
                column: 5,
                ..
            })
        ));
    }

    #[test]
    fn changes_of_mode_are_recognised() {
        assert!(!may_change_modes("G28 ; G91\nG1 Z5"));
        assert!(may_change_modes("G28\n g91\nG1 Z5\nG90"));
        assert!(may_change_modes("START_PRINT"));
    }

    #[test]
    fn heating_is_recognised() {
        let nozzle = |s| heating(s, "M104", "M109", &["nozzle_temperature"]);
        assert_eq!(nozzle("G28 ; M109 S200"), Heating::Not);
        assert_eq!(nozzle("G28\nm104 S200"), Heating::Sets);
        assert_eq!(nozzle("M117 at {nozzle_temperature}"), Heating::Not);
        assert_eq!(nozzle("M104 S{nozzle_temperature}\nG28"), Heating::Sets);
        assert_eq!(
            nozzle("M104 S{nozzle_temperature}\nM109 S200"),
            Heating::Waits
        );
        assert_eq!(
            nozzle("START_PRINT T={ nozzle_temperature }"),
            Heating::Waits
        );
    }
}
