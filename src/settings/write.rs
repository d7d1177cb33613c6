//! Settings as commented TOML that reads back as the same settings.

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
            comment(&mut text, "# ", &key.description());
            let mut facts = key.allowed();
            let default = key.default();
            if !default.contains('\n') {
                facts.push_str("; default ");
                facts.push_str(default.trim_matches('"'));
                if key.range.is_some() && default != "\"auto\"" {
                    facts.push_str(&key.spaced_unit());
                }
            }
            comment(&mut text, "# ", &format!("({facts})"));
            text.push_str(&format!("{} = {}\n", key.leaf(), key.get(self)));
        }
        text
    }
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
