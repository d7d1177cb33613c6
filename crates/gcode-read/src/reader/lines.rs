//! Lines of a file, one at a time, in memory that does not grow.
//!
//! In: bytes. Out: lines without their ends, and their numbers. A line ends at
//! a line feed, at a carriage return, or at both together, as Marlin and
//! RepRapFirmware have it. A line longer than the buffer is cut off and marked.
//! A line without end is refused. The text may be any bytes.

use super::NoGcode;
use crate::bgcode::Unpacked;
use std::io::{self, Read};

/// Length of the longest line that is read whole, bytes. Slicers write their
/// templates into single comment lines of some kilobytes.
const LONGEST: usize = 1 << 18;

/// Length of a line at which reading stops, bytes. No slicer writes such a
/// line, but devices and other kinds of files may have no end of a line.
const ENDLESS: u64 = 1 << 26;

/// Reads lines.
#[derive(Debug)]
pub(super) struct Lines<R> {
    input: Unpacked<R>,
    buffer: Vec<u8>,
    /// Where the bytes that have not been handed out begin and end.
    start: usize,
    end: usize,
    number: u64,
    /// Bytes read so far.
    read: u64,
    /// True while the rest of a line that was cut off is skipped.
    skipping: bool,
    /// Number of bytes skipped of the line that was cut off.
    skipped: u64,
    /// True after a carriage return. A line feed that follows belongs to it.
    returned: bool,
    ended: bool,
}

/// A line.
#[derive(Debug, PartialEq)]
pub(super) struct Line<'a> {
    /// The bytes without the line's end and the blanks before it.
    pub text: &'a [u8],
    /// False if the line was cut off.
    pub whole: bool,
    /// What ends the line.
    pub end: LineEnd,
}

/// What ends a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum LineEnd {
    /// A line feed, alone or after a carriage return. The line may also be cut
    /// off.
    Feed,
    /// A carriage return alone.
    Return,
    /// The end of the file.
    File,
}

impl<R: Read> Lines<R> {
    pub(super) fn new(input: R) -> Self {
        Self {
            input: Unpacked::new(input),
            buffer: vec![0; LONGEST],
            start: 0,
            end: 0,
            number: 0,
            read: 0,
            skipping: false,
            skipped: 0,
            returned: false,
            ended: false,
        }
    }

    /// Number of the line handed out last, from 1. Lines that binary G-code has
    /// before its text do not count.
    pub(super) fn number(&self) -> u64 {
        self.number.saturating_sub(self.input.preface())
    }

    /// Bytes of text read so far.
    pub(super) fn bytes(&self) -> u64 {
        self.read
    }

    /// The next line, or nothing at the end.
    ///
    /// # Errors
    /// If the input fails, or a line has no end.
    pub(super) fn next(&mut self) -> io::Result<Option<Line<'_>>> {
        // Number of bytes from `start` that hold no line's end.
        let mut searched = 0;
        loop {
            let fresh = &self.buffer[self.start + searched..self.end];
            if self.returned && !fresh.is_empty() {
                self.returned = false;
                if fresh[0] == b'\n' {
                    self.start += 1;
                    continue;
                }
            }
            if let Some(i) = memchr::memchr2(b'\n', b'\r', fresh) {
                // The byte after a carriage return tells what ends the line.
                let alone = fresh[i] == b'\r'
                    && match fresh.get(i + 1) {
                        Some(&next) => next != b'\n',
                        None => false,
                    };
                let unsure = fresh[i] == b'\r' && i + 1 == fresh.len();
                if unsure && !self.ended && searched + i + 1 < LONGEST {
                    searched += i;
                    self.fill()?;
                    continue;
                }
                let from = self.start;
                let to = from + searched + i;
                self.returned = fresh[i] == b'\r';
                self.start = to + 1;
                if std::mem::take(&mut self.skipping) {
                    searched = 0;
                    continue;
                }
                let end = if alone || unsure {
                    LineEnd::Return
                } else {
                    LineEnd::Feed
                };
                return Ok(Some(self.line(from, to, true, end)));
            }
            if self.skipping {
                self.skipped += (self.end - self.start) as u64;
                self.start = self.end;
                if self.skipped > ENDLESS {
                    let megabytes = ENDLESS >> 20;
                    let line = self.number();
                    return Err(NoGcode::LongLine { line, megabytes }.into());
                }
            }
            searched = self.end - self.start;
            if self.ended {
                if searched == 0 {
                    return Ok(None);
                }
                let (from, to) = (self.start, self.end);
                self.start = self.end;
                return Ok(Some(self.line(from, to, true, LineEnd::File)));
            }
            if searched == self.buffer.len() {
                self.skipping = true;
                self.skipped = 0;
                let (from, to) = (self.start, self.end);
                self.start = self.end;
                return Ok(Some(self.line(from, to, false, LineEnd::Feed)));
            }
            self.fill()?;
        }
    }

    /// Reads on. Bytes that are left over move to the buffer's start.
    fn fill(&mut self) -> io::Result<()> {
        // A line may have no end.
        isoslice_base::limits::io_goes_on()?;
        self.buffer.copy_within(self.start..self.end, 0);
        self.end -= self.start;
        self.start = 0;
        let read = loop {
            match self.input.read(&mut self.buffer[self.end..]) {
                Err(e) if e.kind() == io::ErrorKind::Interrupted => {}
                read => break read?,
            }
        };
        self.end += read;
        self.read += read as u64;
        self.ended = read == 0;
        Ok(())
    }

    fn line(
        &mut self,
        from: usize,
        to: usize,
        whole: bool,
        end: LineEnd,
    ) -> Line<'_> {
        self.number += 1;
        let text = self.buffer[from..to].trim_ascii_end();
        Line { text, whole, end }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Hands out as few bytes at a time as a reader may.
    struct Dripping<'a>(&'a [u8]);

    impl Read for Dripping<'_> {
        fn read(&mut self, out: &mut [u8]) -> io::Result<usize> {
            let n = self.0.len().min(out.len()).min(1);
            out[..n].copy_from_slice(&self.0[..n]);
            self.0 = &self.0[n..];
            Ok(n)
        }
    }

    fn all(input: impl Read) -> Vec<(u64, String, bool)> {
        let mut lines = Lines::new(input);
        let mut found = Vec::new();
        while let Some(line) = lines.next().unwrap() {
            let text = String::from_utf8_lossy(line.text).into_owned();
            let whole = line.whole;
            found.push((lines.number(), text, whole));
        }
        found
    }

    #[test]
    fn lines_end_as_they_like() {
        let text = b"a\r\n\nb  \nlast";
        let expected = [(1, "a"), (2, ""), (3, "b"), (4, "last")]
            .map(|(n, t)| (n, t.to_owned(), true));
        assert_eq!(all(&text[..]), expected);
        assert_eq!(all(Dripping(text)), expected);
        assert_eq!(all(&b""[..]), []);
    }

    #[test]
    fn a_carriage_return_ends_a_line() {
        for (text, expected) in [
            ("a\rb\r", &["a", "b"][..]),
            ("a\rb", &["a", "b"]),
            ("a\r\rb\n", &["a", "", "b"]),
            ("a\r\nb\r\n\r\n", &["a", "b", ""]),
            ("a\n\rb", &["a", "", "b"]),
            ("\r", &[""]),
        ] {
            for found in [all(text.as_bytes()), all(Dripping(text.as_bytes()))]
            {
                let texts: Vec<&str> =
                    found.iter().map(|l| l.1.as_str()).collect();
                assert_eq!(texts, expected, "{text:?}");
                let last = found.last().map(|l| l.0);
                assert_eq!(last, Some(expected.len() as u64), "{text:?}");
            }
        }
        // The ends of lines are told apart.
        let mut lines = Lines::new(Dripping(b"a\rb\r\nc\nd"));
        for end in
            [LineEnd::Return, LineEnd::Feed, LineEnd::Feed, LineEnd::File]
        {
            assert_eq!(lines.next().unwrap().unwrap().end, end);
        }
    }

    #[test]
    fn an_endless_line_is_cut_off_and_the_next_one_found() {
        let mut text = vec![b'x'; 3 * LONGEST];
        text.extend_from_slice(b"\nG28\n");
        let found = all(&text[..]);
        assert_eq!(found.len(), 2);
        assert_eq!((found[0].1.len(), found[0].2), (LONGEST, false));
        assert_eq!(found[1], (2, "G28".to_owned(), true));
    }

    #[test]
    fn a_line_without_end_is_refused() {
        let text = (&b"G28\n"[..]).chain(io::repeat(0));
        let mut lines = Lines::new(text);
        assert!(lines.next().unwrap().unwrap().whole);
        assert!(!lines.next().unwrap().unwrap().whole);
        let error = lines.next().unwrap_err().to_string();
        assert!(error.contains("line 2 is longer than 64 MB"), "{error}");
    }
}
