//! The words of a command: letters with numbers.
//!
//! In: a line's bytes. Out: which letters stand in it, with which numbers,
//! and where its comment begins. Line numbers (`N`), checksums (`*`) and
//! comments in brackets are passed over. As firmware does, `E` begins a word
//! of its own and is never an exponent, letters may be small, and blanks may
//! be left out.

/// What a larger number counts as. It is far beyond any machine, so that no rule
/// takes it for a usual number, and small enough to compute with.
const LARGEST: f64 = 1e9;

/// The number, or the nearest one that is small enough to compute with.
pub(super) fn limited(number: f64) -> f64 {
    number.clamp(-LARGEST, LARGEST)
}

/// The words of one command.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Words {
    /// A bit for each letter, from A.
    given: u32,
    /// A bit for each letter that stands without a number.
    bare: u32,
    numbers: [f64; 26],
}

/// What a line is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Command {
    /// Nothing, or only a comment.
    Blank,
    /// A letter and a number, as in G1 or M104. The number is in tenths, for
    /// commands like G38.2.
    Code(u8, u32),
    /// Anything else: words of a macro language.
    Text,
}

/// A line taken apart. Its words are in the [`Words`] that were given.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Parsed {
    pub command: Command,
    /// Where the comment begins, after its semicolon.
    pub comment: Option<usize>,
    /// Where the last word ends.
    pub end: usize,
    /// True if there are characters that are neither words nor a comment.
    pub stray: bool,
}

impl Words {
    /// The number of a letter (`b'X'`), if the command has one.
    pub fn get(&self, letter: u8) -> Option<f64> {
        let bit = bit(letter);
        (self.given & bit != 0)
            .then(|| self.numbers[usize::from(letter - b'A')])
    }

    /// True if the command has the letter, with a number or without.
    pub fn has(&self, letter: u8) -> bool {
        (self.given | self.bare) & bit(letter) != 0
    }

    /// True if a letter stands without a number, as in words for people.
    pub(super) fn has_text(&self) -> bool {
        self.bare != 0
    }

    /// The first of `letters` that has no number.
    pub(super) fn bare_among(&self, letters: &[u8]) -> Option<u8> {
        letters.iter().copied().find(|&l| self.bare & bit(l) != 0)
    }

    fn set(&mut self, letter: u8, number: Option<f64>) {
        match number {
            Some(number) => {
                self.numbers[usize::from(letter - b'A')] = number;
                self.given |= bit(letter);
            }
            None => self.bare |= bit(letter),
        }
    }

    fn clear(&mut self) {
        self.given = 0;
        self.bare = 0;
    }
}

/// The bit of a capital letter; 0 for anything else.
fn bit(letter: u8) -> u32 {
    match letter {
        b'A'..=b'Z' => 1 << (letter - b'A'),
        _ => 0,
    }
}

/// Takes a line apart.
pub(super) fn parse(line: &[u8], words: &mut Words) -> Parsed {
    words.clear();
    let mut parsed = Parsed {
        command: Command::Blank,
        comment: None,
        end: 0,
        stray: false,
    };
    let mut i = 0;
    while let Some(&sign) = line.get(i) {
        match sign {
            b' ' | b'\t' | b'\r' => i += 1,
            b';' => {
                parsed.comment = Some(i + 1);
                break;
            }
            b'(' => {
                let end = memchr::memchr(b')', &line[i..]);
                i = end.map_or(line.len(), |end| i + end + 1);
            }
            // A checksum ends the command.
            b'*' => {
                i = memchr::memchr(b';', &line[i..])
                    .map_or(line.len(), |at| i + at);
            }
            _ => {
                let letter = sign.to_ascii_uppercase();
                if !letter.is_ascii_uppercase() {
                    parsed.stray = true;
                    if parsed.command == Command::Blank {
                        parsed.command = Command::Text;
                    }
                    i += 1;
                    continue;
                }
                let (number, length) = number(&line[i + 1..]);
                i += 1 + length;
                parsed.end = i;
                match parsed.command {
                    Command::Blank if letter == b'N' && length > 0 => {}
                    Command::Blank => {
                        parsed.command = command(letter, number);
                        if parsed.command == Command::Text {
                            // The line is not a letter with a number, but may
                            // have a comment.
                            let end = memchr::memchr(b';', &line[i..]);
                            i = end.map_or(line.len(), |end| i + end);
                        }
                    }
                    _ => words.set(letter, number),
                }
            }
        }
    }
    parsed
}

fn command(letter: u8, number: Option<f64>) -> Command {
    match (letter, number) {
        (b'G' | b'M' | b'T', Some(n)) if (0.0..1e6).contains(&n) => {
            Command::Code(letter, (n * 10.0).round() as u32)
        }
        _ => Command::Text,
    }
}

/// The number at the start of `text`, at most [`LARGEST`], and the bytes that it
/// takes. None if there is no number.
fn number(text: &[u8]) -> (Option<f64>, usize) {
    // These powers of ten are exact as doubles.
    const POWERS: [f64; 20] = [
        1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12,
        1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19,
    ];
    let at = |i: usize| text.get(i).copied().unwrap_or(0);
    let mut i = 0;
    let negative = at(i) == b'-';
    if matches!(at(i), b'-' | b'+') {
        i += 1;
    }
    // Up to 18 digits fit. Further digits do not matter after the point, and
    // make the number too large before it.
    let (mut digits, mut decimals, mut whole, mut any) = (0u64, 0, 0, false);
    while at(i).is_ascii_digit() {
        any = true;
        if whole < 18 {
            digits = digits * 10 + u64::from(at(i) - b'0');
        }
        whole += usize::from(whole > 0 || at(i) != b'0');
        i += 1;
    }
    let too_large = whole > 18;
    if at(i) == b'.' {
        i += 1;
        while at(i).is_ascii_digit() {
            any = true;
            if whole + decimals < 18 {
                digits = digits * 10 + u64::from(at(i) - b'0');
                decimals += 1;
            }
            i += 1;
        }
    }
    if !any {
        return (None, 0);
    }
    // Digits below 2^53 are exact, and the quotient is then the double nearest
    // to the decimal number.
    let size = if too_large {
        LARGEST
    } else {
        limited(digits as f64 / POWERS[decimals])
    };
    (Some(if negative { -size } else { size }), i)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(line: &str) -> (Parsed, Words) {
        let mut words = Words::default();
        let parsed = parse(line.as_bytes(), &mut words);
        (parsed, words)
    }

    #[test]
    fn numbers_are_what_rust_makes_of_them() {
        for text in [
            "0",
            "1",
            "-1",
            "+2.5",
            ".5",
            "-.25",
            "7.",
            "0.1",
            "123.456",
            "0.000001",
            "99999.99999",
            "00012.50",
            "2147483.647",
        ] {
            let (found, length) = number(text.as_bytes());
            assert_eq!(found, Some(text.parse::<f64>().unwrap()), "{text}");
            assert_eq!(length, text.len(), "{text}");
        }
        let long = "0.1234567890123456789012345678901234567890";
        let (found, length) = number(long.as_bytes());
        assert!((found.unwrap() - 0.123456789012345).abs() < 1e-15);
        assert_eq!(length, long.len());
    }

    #[test]
    fn what_is_no_number_is_none() {
        for (text, length) in [
            ("", 0),
            ("-", 0),
            (".", 0),
            ("nan", 0),
            ("inf", 0),
            ("{x}", 0),
        ] {
            assert_eq!(number(text.as_bytes()), (None, length), "{text}");
        }
    }

    #[test]
    fn a_number_too_large_to_compute_with_is_still_a_large_one() {
        for text in [
            "1000000000",
            "99999999999",
            "9999999999999999999999999",
            "10000000000.00000000000000001",
        ] {
            let found = number(text.as_bytes());
            assert_eq!(found, (Some(LARGEST), text.len()), "{text}");
            let negative = format!("-{text}");
            let found = number(negative.as_bytes());
            assert_eq!(found, (Some(-LARGEST), negative.len()), "{text}");
        }
    }

    #[test]
    fn words_are_found_however_they_are_written() {
        for line in [
            "G1 X10 Y-2.5 E.3 F1200 ; a comment X99",
            "g1x10y-2.5e.3f1200;c",
            "N12 G1 X10 Y-2.5 E.3 F1200*71",
            "  G01\tX10 (to the right X7) Y-2.5 E.3 F1200",
        ] {
            let (parsed, words) = words(line);
            assert_eq!(parsed.command, Command::Code(b'G', 10), "{line}");
            assert_eq!(words.get(b'X'), Some(10.0), "{line}");
            assert_eq!(words.get(b'Y'), Some(-2.5), "{line}");
            assert_eq!(words.get(b'E'), Some(0.3), "{line}");
            assert_eq!(words.get(b'F'), Some(1200.0), "{line}");
            assert_eq!(words.get(b'Z'), None, "{line}");
            assert!(!parsed.stray, "{line}");
        }
    }

    #[test]
    fn e_is_never_an_exponent() {
        let (_, words) = words("G1 X1e3");
        assert_eq!(words.get(b'X'), Some(1.0));
        assert_eq!(words.get(b'E'), Some(3.0));
    }

    #[test]
    fn macros_and_letters_without_numbers_are_told_apart() {
        let (parsed, found) = words("SET_FAN X=1 ;TYPE:x");
        assert_eq!(parsed.command, Command::Text);
        assert_eq!(parsed.comment, Some(13));
        assert!(!found.has(b'X'));
        let (parsed, found) = words("G28 X Y");
        assert_eq!(parsed.command, Command::Code(b'G', 280));
        assert!(found.has(b'X') && !found.has(b'Z'));
        assert_eq!(found.get(b'X'), None);
        assert_eq!(found.bare_among(b"ZY"), Some(b'Y'));
        assert_eq!(words("G38.2").0.command, Command::Code(b'G', 382));
        assert_eq!(words("\u{fffd}G1").0.command, Command::Text);
        assert_eq!(words("; only this").0.command, Command::Blank);
        assert_eq!(words("").0.comment, None);
    }
}
