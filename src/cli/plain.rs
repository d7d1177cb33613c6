//! Makes text safe to show on a terminal.
//!
//! In: text with parts that strangers may have written (names of files,
//! messages of scripts, descriptions in profiles, lines of G-code). Out: the
//! text without anything that a terminal obeys instead of showing it. Control
//! characters of both sets, marks that turn the direction of writing, other
//! ends of lines, and letters without a width are each written as `\u{1b}`.
//! Long text is shortened in its middle.

use super::output;
use std::borrow::Cow;
use std::io::{IsTerminal, stdout};

/// Greatest length of a message or value, characters.
const LONGEST: usize = 1600;
/// Characters kept from the beginning of a long message. The others are kept
/// from its end, which often has the remedy.
const HEAD: usize = 1000;

/// Text as one line, in which ends of lines are escaped, too.
pub(super) fn line(text: &str) -> Cow<'_, str> {
    escaped(shortened(text), |_| false)
}

/// A value, as part of a line.
pub(super) fn value(value: impl ToString) -> String {
    line(&value.to_string()).into_owned()
}

/// Text whose ends of lines are meant.
pub(super) fn lines(text: &str) -> Cow<'_, str> {
    escaped(Cow::Borrowed(text), |c| c == '\n')
}

/// JSON, which has escapes of its own.
pub(super) fn json(text: &str) -> String {
    let mut plain = String::with_capacity(text.len());
    for c in text.chars() {
        if is_obeyed(c) && c != '\n' {
            for unit in c.encode_utf16(&mut [0; 2]) {
                plain.push_str(&format!("\\u{unit:04x}"));
            }
        } else {
            plain.push(c)
        }
    }
    plain
}

/// Writes a result for people to standard output.
pub(super) fn print(text: &str) -> anyhow::Result<()> {
    output::print(lines(text).as_bytes())
}

/// Writes the text of a file to standard output: unchanged, unless that is a
/// terminal.
pub(super) fn print_file(text: &str) -> anyhow::Result<()> {
    if stdout().is_terminal() {
        print(text)
    } else {
        output::print(text.as_bytes())
    }
}

/// True for a character that a terminal obeys or hides.
pub(super) fn is_obeyed(c: char) -> bool {
    c.is_control()
        || matches!(c,
            '\u{61c}'
            | '\u{200b}' | '\u{200e}' | '\u{200f}'
            | '\u{2028}'..='\u{202e}'
            | '\u{2060}'..='\u{206f}'
            | '\u{feff}'
            | '\u{fff9}'..='\u{fffb}'
            | '\u{e0000}'..='\u{e007f}')
}

fn escaped(text: Cow<'_, str>, keep: impl Fn(char) -> bool) -> Cow<'_, str> {
    let obeyed = |c: char| is_obeyed(c) && !keep(c);
    if !text.contains(obeyed) {
        return text;
    }
    let mut plain = String::with_capacity(text.len() + 16);
    for c in text.chars() {
        if obeyed(c) {
            plain.extend(c.escape_default())
        } else {
            plain.push(c)
        }
    }
    Cow::Owned(plain)
}

fn shortened(text: &str) -> Cow<'_, str> {
    // Most messages are short, and counting their bytes takes less time than
    // counting their characters.
    let count = if text.len() <= LONGEST {
        return Cow::Borrowed(text);
    } else {
        text.chars().count()
    };
    if count <= LONGEST {
        return Cow::Borrowed(text);
    }
    let at = |n: usize| text.char_indices().nth(n).map_or(0, |(i, _)| i);
    let (head, tail) = (at(HEAD), at(count - (LONGEST - HEAD)));
    Cow::Owned(format!(
        "{}… ({} characters left out) …{}",
        &text[..head],
        count - LONGEST,
        &text[tail..]
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_terminal_obeys_is_shown() {
        let evil = "a\u{1b}]0;t\u{7}\r\n\0\u{9b}2J\u{202e}\u{2028}\u{feff}é…";
        let shown = line(evil);
        assert_eq!(
            shown,
            "a\\u{1b}]0;t\\u{7}\\r\\n\\u{0}\\u{9b}2J\\u{202e}\\u{2028}\
             \\u{feff}é…"
        );
        assert!(!shown.contains(is_obeyed));
        assert_eq!(lines("a\n\tb"), "a\n\\tb");
        assert_eq!(line("plain, é, 日本"), "plain, é, 日本");
    }

    #[test]
    fn json_stays_json() {
        let text = serde_json::to_string_pretty(&["\u{9b}\u{202e}\u{e0001}\n"])
            .unwrap();
        let plain = json(&text);
        assert!(plain.contains("\\u009b\\u202e\\udb40\\udc01\\n"), "{plain}");
        let back: Vec<String> = serde_json::from_str(&plain).unwrap();
        assert_eq!(back, ["\u{9b}\u{202e}\u{e0001}\n"]);
    }

    #[test]
    fn what_is_long_is_shortened_in_its_middle() {
        let long = format!("begin {} end", "é".repeat(10_000_000));
        let short = line(&long);
        assert!(short.chars().count() < LONGEST + 60, "{}", short.len());
        assert!(short.starts_with("begin é") && short.ends_with("é end"));
        assert!(short.contains("characters left out"));
        let just = "é".repeat(LONGEST);
        assert_eq!(line(&just), just);
    }
}
