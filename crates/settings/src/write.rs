//! Settings as commented TOML that reads back as the same settings.

use super::table::{self, Key};
use super::{Settings, keys};

/// Width to which comments are broken, the hash included.
const WIDTH: usize = 78;

impl Settings {
    /// All settings as TOML, each with its description, unit, range and
    /// default as a comment.
    pub fn to_toml(&self) -> String {
        let mut text = String::from(
            "# All settings of isoslice. A file needs only those that differ \
             from the\n# default; pass it with --config, or single ones with \
             --set key=value.\n",
        );
        let mut section = "";
        for key in keys() {
            if key.section != section {
                section = key.section;
                text.push_str("\n\n");
                comment(&mut text, "## ", &key.section());
                if !key.group().is_empty() {
                    text.push_str(&format!("[{}]\n", key.group()));
                }
            }
            text.push('\n');
            explain(&mut text, key);
            text.push_str(&format!("{} = {}\n", key.leaf(), key.get(self)));
        }
        text
    }

    /// The settings that differ from their defaults, as TOML that reads back as
    /// these settings.
    pub fn changed(&self) -> String {
        let mut text = String::new();
        for key in keys() {
            let value = key.get(self);
            if value != key.default() {
                text.push_str(&format!("{} = {value}\n", key.name));
            }
        }
        text
    }

    /// All settings as TOML, each with a comment that says where its value is
    /// from.
    pub fn to_toml_with_origins(
        &self,
        origin: impl Fn(&Key) -> String,
    ) -> String {
        // Most lines are shorter than this, which aligns the comments.
        const COLUMN: usize = 44;
        let mut text = String::new();
        let mut group = "";
        for key in keys() {
            if key.group() != group {
                group = key.group();
                text.push_str(&format!("\n[{group}]\n"));
            }
            let line = format!("{} = {}", key.leaf(), key.get(self));
            let last = line.rsplit('\n').next().unwrap_or(&line);
            let gap = COLUMN.saturating_sub(last.chars().count());
            text.push_str(&format!("{line}{:gap$} # {}\n", "", origin(key)));
        }
        text
    }

    /// The settings with these names, explained, each with its default in a
    /// comment. The text sets none of them.
    pub fn suggestions(names: &[&str]) -> String {
        let mut text = String::new();
        for key in names.iter().filter_map(|name| table::find(name)) {
            explain(&mut text, key);
            // Whole names make a line work anywhere in a file.
            text.push_str(&format!("# {} = {}\n\n", key.name, key.default()));
        }
        text
    }
}

/// What a setting means and takes, as comments.
fn explain(text: &mut String, key: &Key) {
    comment(text, "# ", &key.description());
    let mut facts = key.allowed();
    let default = key.default();
    if !default.contains('\n') {
        facts.push_str("; default ");
        facts.push_str(default.trim_matches('"'));
        if default.parse::<f64>().is_ok() {
            facts.push_str(&key.spaced_unit());
        }
    }
    let usual = Settings::default();
    if let Some(length) = key.length(&usual) {
        let nozzle = usual.printer.nozzle_diameter;
        facts.push_str(&format!(", {length} mm with a nozzle of {nozzle} mm"));
    }
    comment(text, "# ", &format!("({facts})"));
}

/// Appends `words` as comment lines.
fn comment(text: &mut String, mark: &str, words: &str) {
    let mut width = 0;
    for word in words.split(' ') {
        let len = word.chars().count();
        if width == 0 {
            text.push_str(mark);
            width = mark.len();
        } else if width + 1 + len > WIDTH {
            text.push('\n');
            text.push_str(mark);
            width = mark.len();
        } else {
            text.push(' ');
            width += 1;
        }
        text.push_str(word);
        width += len;
    }
    text.push('\n');
}
