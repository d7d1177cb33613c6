//! The settings that a file was sliced with, in its tail.
//!
//! In: the writer's plan. Out: a comment for each one that differs from its default,
//! from which [`settings_in_gcode`] makes text that reads back as equal settings.
//! What parts of a plate have of their own is not among them.

use super::plan::WriterPlan;
use isoslice_settings::keys;
use std::fmt::Write as _;

/// What the first of these lines says.
const HEAD: &str = "; isoslice settings that differ from the defaults:";

/// What each of these lines begins with. No host or firmware looks for it, as
/// they do for `; layer_height`.
const MARK: &str = "; isoslice ";

/// The lines.
pub(super) fn lines(plan: &WriterPlan<'_>) -> String {
    let mut lines = String::new();
    let mut count = 0;
    for key in keys() {
        let value = plan.value(key);
        if value != key.default() {
            count += 1;
            let _ = writeln!(lines, "{MARK}{} = {}", key.name, in_line(value));
        }
    }
    format!("{HEAD} {count}\n{lines}")
}

/// A byte order mark, which a file of settings may have begun with.
const MARK_OF_ORDER: char = '\u{feff}';

/// A value of TOML in one line. Texts of several lines, and those with a mark
/// that has no place within a file, are written as JSON does, which TOML reads
/// as well.
fn in_line(value: String) -> String {
    if !value.contains(['\n', MARK_OF_ORDER]) {
        return value;
    }
    let table = format!("value = {value}").parse::<toml::Table>();
    let text = table.ok().and_then(|mut table| table.remove("value"));
    match text {
        Some(toml::Value::String(text)) => {
            let text = serde_json::Value::String(text).to_string();
            text.replace(MARK_OF_ORDER, "\\uFEFF")
        }
        _ => String::from("\"\""),
    }
}

/// The settings in G-code of this program that differ from the defaults, as
/// TOML; none if the text has none of these lines.
pub fn settings_in_gcode(text: &str) -> Option<String> {
    let mut lines = text.lines().map(str::trim_end);
    lines.find(|line| line.starts_with(HEAD))?;
    let own = lines.map_while(|line| line.strip_prefix(MARK));
    Some(own.flat_map(|line| [line, "\n"]).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use isoslice_settings::Builder;

    #[track_caller]
    fn assert_reads_back(given: &Builder) {
        let plan = WriterPlan::of(given.settings());
        let text = format!("G1 X1\r\n{}; more = 1\n", lines(&plan));
        let toml = settings_in_gcode(&text).unwrap();
        let mut builder = Builder::new();
        builder.toml("own", &toml).unwrap();
        assert_eq!(builder.settings(), given.settings());
    }

    #[test]
    fn every_setting_reads_back() {
        assert_reads_back(&Builder::new());
        let mut builder = Builder::new();
        for set in [
            "walls=5",
            "layer_height=0.07",
            "spiral=true",
            "infill_density=expr: 20 + z",
            "speed.overhang=25: 50%, 75: 12.5",
            "printer.bed_x=350",
            "printer.model=A \"B\" \\ µ",
            "gcode.start=G28\n; a = \"b\"\tc\nM117 {{ layer_count }}\n\n",
            "gcode.end=\u{feff}M84",
            "gcode.thumbnails=16x16, 380x285/QOI",
        ] {
            builder.set(set).unwrap();
        }
        assert_reads_back(&builder);
        // One at a time: each one at another value than its default.
        for key in keys() {
            let values =
                ["true", "false", "1", "2", "30", "150", "auto", "a b"];
            for value in values.into_iter().chain(key.words().iter().copied()) {
                let mut builder = Builder::new();
                if builder.set(&format!("{}={value}", key.name)).is_ok() {
                    assert_reads_back(&builder);
                }
            }
        }
    }

    #[test]
    fn other_files_have_none() {
        assert_eq!(settings_in_gcode("; layer_height = 0.2\n"), None);
        let text = format!("{HEAD} 0\n; objects = 1\n");
        assert_eq!(settings_in_gcode(&text).as_deref(), Some(""));
    }
}
