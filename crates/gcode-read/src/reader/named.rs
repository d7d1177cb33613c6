//! Commands that are names: Klipper's own, and macros of a printer.
//!
//! In: a line's bytes. Out: the name and its `KEY=VALUE` pairs, as Klipper
//! reads them (`klippy/gcode.py`): letters may be small, a value may be in
//! quotes, and `;` or `#` ends the command. RepRapFirmware's `if`, `while`,
//! `set` and the like are names as well.

use super::words::limited;

/// Longest command that is kept, bytes.
const LONGEST: usize = 4096;

/// RepRapFirmware's words that any text may follow.
const META: [&[u8]; 12] = [
    b"if",
    b"elif",
    b"else",
    b"while",
    b"break",
    b"continue",
    b"var",
    b"global",
    b"set",
    b"echo",
    b"abort",
    b"skip",
];

/// A command that is a name. An empty name stands for a printer's own start:
/// see [`Event::Macro`](super::Event::Macro).
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Named {
    /// The command without its comment and the blanks round it.
    text: Vec<u8>,
    /// Length of the name.
    name: usize,
    /// True if the command's end was left out.
    cut: bool,
}

impl Named {
    /// Takes a line. False if it is no command.
    pub(super) fn take(&mut self, line: &[u8]) -> bool {
        self.clear();
        let end = memchr::memchr(b';', line).unwrap_or(line.len());
        let mut text = &line[..end.min(LONGEST)];
        self.cut = end > LONGEST;
        if self.cut {
            // A long command is cut at the end of a word.
            let blank = text.iter().rposition(u8::is_ascii_whitespace);
            text = &text[..blank.unwrap_or(text.len())];
        }
        let text = text.trim_ascii();
        self.text.extend_from_slice(text);
        let at = text.iter().position(u8::is_ascii_whitespace);
        self.name = at.unwrap_or(text.len());
        let hash = unquoted(&text[self.name..], |b| b == b'#');
        if let (Some(at), false) = (hash, self.is_free()) {
            self.text.truncate(self.name + at);
        }
        self.makes_sense()
    }

    /// Forgets the command.
    pub(super) fn clear(&mut self) {
        self.text.clear();
        self.name = 0;
        self.cut = false;
    }

    /// True if the command was too long to keep its end.
    pub(super) fn is_cut(&self) -> bool {
        self.cut
    }

    /// True if anything may stand after the name.
    fn is_free(&self) -> bool {
        self.text.first() == Some(&b'@')
            || META.iter().any(|m| self.name().eq_ignore_ascii_case(m))
    }

    fn makes_sense(&self) -> bool {
        let name = self.name();
        // OctoPrint's own commands begin with an @, and Prusa's `T?` asks.
        let name = name.strip_prefix(b"@").unwrap_or(name);
        if name.eq_ignore_ascii_case(b"T?") {
            return true;
        }
        let is_name = name.len() > 1
            && (name[0].is_ascii_alphabetic() || name[0] == b'_')
            && name.iter().all(|b| b.is_ascii_alphanumeric() || *b == b'_');
        is_name && (self.is_free() || self.words().all(|w| w.contains(&b'=')))
    }

    /// The name as it is written.
    pub fn name(&self) -> &[u8] {
        &self.text[..self.name]
    }

    /// True if the command has this name, in capital or small letters.
    pub fn is(&self, name: &str) -> bool {
        self.name().eq_ignore_ascii_case(name.as_bytes())
    }

    /// The words after the name, split at blanks outside of quotes.
    fn words(&self) -> impl Iterator<Item = &[u8]> {
        let mut rest = &self.text[self.name..];
        std::iter::from_fn(move || {
            rest = rest.trim_ascii_start();
            let end = unquoted(rest, |b| b.is_ascii_whitespace());
            let (word, left) = rest.split_at(end.unwrap_or(rest.len()));
            rest = left;
            (!word.is_empty()).then_some(word)
        })
    }

    /// The pairs of keys and values after the name, without quotes.
    pub fn pairs(&self) -> impl Iterator<Item = (&[u8], &[u8])> {
        self.words().filter_map(|word| {
            let at = memchr::memchr(b'=', word)?;
            let (key, value) = (&word[..at], &word[at + 1..]);
            let inner = match value {
                [b'"', inner @ .., b'"'] | [b'\'', inner @ .., b'\''] => inner,
                _ => value,
            };
            Some((key, inner))
        })
    }

    /// The value of a key.
    pub fn get(&self, key: &str) -> Option<&[u8]> {
        self.pairs()
            .find(|(k, _)| k.eq_ignore_ascii_case(key.as_bytes()))
            .map(|(_, value)| value)
    }

    /// The number of a key.
    pub fn number(&self, key: &str) -> Option<f64> {
        self.get(key).and_then(number)
    }
}

/// The index of the first character outside of quotes that `is` accepts.
fn unquoted(text: &[u8], is: impl Fn(u8) -> bool) -> Option<usize> {
    let mut quote = None;
    text.iter().position(|&b| match (quote, b) {
        (Some(q), _) if q == b => {
            quote = None;
            false
        }
        (Some(_), _) => false,
        (None, b'"' | b'\'') => {
            quote = Some(b);
            false
        }
        (None, _) => is(b),
    })
}

/// The value as a number that is small enough to compute with; none if it is not a
/// number.
pub fn number(value: &[u8]) -> Option<f64> {
    let text = std::str::from_utf8(value.trim_ascii()).ok()?;
    text.parse().ok().filter(|n: &f64| !n.is_nan()).map(limited)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn named(line: &str) -> (Named, bool) {
        let mut named = Named::default();
        let sense = named.take(line.as_bytes());
        (named, sense)
    }

    #[test]
    fn names_and_pairs_are_told_apart() {
        let (found, sense) =
            named("  start_print BED=60 Msg=\"a b=c\" x= ; NOT=1");
        assert!(sense && found.is("START_PRINT"));
        let pairs: Vec<_> = found.pairs().collect();
        let expected: [(&[u8], &[u8]); 3] =
            [(b"BED", b"60"), (b"Msg", b"a b=c"), (b"x", b"")];
        assert_eq!(pairs, expected);
        assert_eq!(found.number("bed"), Some(60.0));
        assert_eq!((found.number("MSG"), found.get("NOT")), (None, None));
        // A # ends a command, unless it is in quotes.
        let (found, sense) = named("START_PRINT A='#1' BED=60 # B=5 it is hot");
        assert!(sense, "{found:?}");
        assert_eq!(
            (found.get("A"), found.number("BED")),
            (Some(&b"#1"[..]), Some(60.0))
        );
        assert_eq!(found.get("B"), None);
        // A cut command must be a problem, not silence.
        let (found, sense) = named(&format!("AB {}", "B=1 ".repeat(2000)));
        assert!(sense && found.is_cut());
        assert!(!named(&format!("A1 B=1 ;{}", " x".repeat(9000))).0.is_cut());
    }

    #[test]
    fn what_is_no_command_is_known() {
        for line in [
            "START_PRINT",
            "_CLIENT_LINEAR_MOVE E=5",
            "@pause",
            "@OCTOLAPSE TAKE-SNAPSHOT",
            "T?",
            "Tx",
            "if {move.axes[0].homed}",
            "set global.x = 1",
        ] {
            assert!(named(line).1, "{line}");
        }
        for line in [
            "let x = axis();",
            "<html>",
            "{if true}",
            "}",
            "x",
            "layer_height = 0.2",
            "this is text",
            "draw(x)",
            "\u{fffd}\u{1}",
            "=",
        ] {
            assert!(!named(line).1, "{line}");
        }
    }
}
