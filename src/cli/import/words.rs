//! Names, values and texts of other slicers as profiles and summaries have them.

use isoslice_base::units::human_start;
use slicerprofile::{Setting, Value};

/// Greatest length of a profile's name.
const LONGEST_NAME: usize = 80;

/// A setting as a line of TOML.
pub(super) fn assignment(setting: &Setting) -> String {
    let value = match &setting.value {
        Value::Number(x) => shown(&Value::Number(*x)),
        Value::Switch(yes) => yes.to_string(),
        Value::Text(text) => toml::Value::String(text.clone()).to_string(),
    };
    format!("{} = {value}", setting.name)
}

pub(super) fn shown(value: &Value) -> String {
    match value {
        // Whole settings have no decimals.
        Value::Number(x) => format!("{x}"),
        Value::Switch(yes) => yes.to_string(),
        Value::Text(text) => shortened(text),
    }
}

/// A value, as part of a line of the summary.
pub(super) fn shortened(text: &str) -> String {
    // The rest of the line has the setting's name, and where it is from.
    const LONGEST: usize = 60;
    human_start(text, LONGEST)
}

/// Text that cannot end a comment's line.
pub(super) fn one_line(text: &str) -> String {
    let plain = |c: char| if c.is_control() { ' ' } else { c };
    text.chars().map(plain).collect()
}

/// The name of a profile's file: small letters, digits, dots and dashes.
pub(super) fn slug(name: &str) -> String {
    let mut out = String::new();
    for c in name.chars().flat_map(char::to_lowercase) {
        let plain = c.is_alphanumeric() || (c == '.' && !out.is_empty());
        if plain && out.len() < LONGEST_NAME {
            out.push(c);
        } else if !out.ends_with('-') && !out.is_empty() {
            out.push('-');
        }
    }
    let out = out.trim_end_matches(['-', '.']);
    // With this ending the name would be a path on the command line.
    out.strip_suffix(".toml").unwrap_or(out).to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_files_are_plain() {
        for (name, file) in [
            (
                "Original Prusa MK4S 0.4 nozzle",
                "original-prusa-mk4s-0.4-nozzle",
            ),
            ("../../etc/passwd", "etc-passwd"),
            ("K1 (0.4)", "k1-0.4"),
            ("a.toml", "a"),
            ("…", ""),
        ] {
            assert_eq!(slug(name), file);
        }
    }
}
