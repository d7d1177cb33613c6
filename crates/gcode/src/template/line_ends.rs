//! Blocks at the ends of lines.

use std::borrow::Cow;
use std::fmt::Write as _;

/// Keeps the end of a line that has a block at its end and other text before
/// it. minijinja drops the line's end after a block, which would make two
/// commands one.
pub(super) fn with_line_ends(source: &str) -> Cow<'_, str> {
    let eats = |line: &str| {
        line.ends_with("%}")
            && !line.ends_with("-%}")
            && !line.ends_with("+%}")
            && line.contains("{%")
            && has_text(line)
    };
    let line_of = |line: &'_ str| -> bool {
        line.ends_with('\n') && eats(line.trim_end_matches(['\r', '\n']))
    };
    if !source.split_inclusive('\n').any(line_of) {
        return Cow::Borrowed(source);
    }
    let mut out = String::with_capacity(source.len() + 16);
    for line in source.split_inclusive('\n') {
        if line_of(line) {
            let end = line.rfind("%}").unwrap_or(0);
            let _ = write!(out, "{}+{}", &line[..end], &line[end..]);
        } else {
            out.push_str(line);
        }
    }
    Cow::Owned(out)
}

/// True if a line has text beside blocks and comments.
fn has_text(mut line: &str) -> bool {
    loop {
        line = line.trim_start();
        let close = match line.get(..2) {
            Some("{%") => "%}",
            Some("{#") => "#}",
            _ => return !line.is_empty(),
        };
        match line.find(close) {
            Some(at) => line = &line[at + 2..],
            None => return false,
        }
    }
}
