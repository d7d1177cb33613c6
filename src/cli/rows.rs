//! Results for people: lines with a title each.

use std::fmt::Display;

/// Lines of text, of which most have a title.
#[derive(Default)]
pub(super) struct Rows {
    pub(super) text: String,
    last: &'static str,
}

impl Rows {
    /// Adds a line without a title, as it is.
    pub(super) fn plain(&mut self, line: impl Display) {
        self.last = "";
        self.text.push_str(&format!("{line}\n"));
    }

    /// Adds a line. Of lines of one title that follow one another only the first
    /// has it.
    pub(super) fn add(&mut self, title: &'static str, what: impl Display) {
        let shown = if title == self.last { "" } else { title };
        self.last = title;
        self.text.push_str(&format!("  {shown:<11} {what}\n"));
    }
}

/// Writes `1 fault` or `2 faults`.
pub(super) fn counted(count: usize, what: &str) -> String {
    let s = if count == 1 { "" } else { "s" };
    format!("{count} {what}{s}")
}
