//! Control characters in templates.
//!
//! Some firmware ends a line at a carriage return. A carriage return within a
//! line of a template could thus hide a command. At the end of a line it is
//! fine: the writer writes line feeds.

/// The first control character of `text` that is neither a tab nor part of a
/// line's end: where it is, in bytes, and what to do about it.
pub(super) fn control(text: &str) -> Option<(usize, String)> {
    let mut rest = text.char_indices().peekable();
    while let Some((at, c)) = rest.next() {
        let ends_line = c == '\n'
            || (c == '\r' && rest.peek().is_some_and(|(_, c)| *c == '\n'));
        if ends_line || c == '\t' || !c.is_control() {
            continue;
        }
        let message = match c {
            '\r' => "a carriage return without a line feed, at which some \
                     firmware begins another command: end lines with a line \
                     feed (\\n)"
                .into(),
            _ => format!(
                "the control character U+{:04X}, which no firmware takes: \
                 remove it",
                u32::from(c)
            ),
        };
        return Some((at, message));
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_may_end_in_both_ways_and_nothing_else_is_there() {
        for fine in ["", "G28\nG1 X1\n", "G28\r\nG1\tX1\r\n", "M117 µ"] {
            assert_eq!(control(fine), None, "{fine:?}");
        }
        for (text, at) in [
            ("G28\rG1 Z-10", 3),
            ("G28\r", 3),
            ("G28\r\r\n", 3),
            ("G1\0", 2),
            ("; \u{1b}[2J", 2),
            ("\u{85}", 0),
        ] {
            assert_eq!(control(text).map(|c| c.0), Some(at), "{text:?}");
        }
    }
}
