//! Lines of a file, one at a time, in memory that does not grow.
//!
//! In: bytes. Out: lines without their ends, and their numbers. A line that
//! is longer than the buffer is cut off there and marked; nothing is assumed
//! about the text, which may be any bytes at all.

use crate::bgcode::Unpacked;
use std::io::{self, Read};

/// Longest line that is read whole, bytes. Slicers write their templates into
/// single comment lines of some kilobytes.
const LONGEST: usize = 1 << 18;

/// Reads lines.
#[derive(Debug)]
pub(super) struct Lines<R> {
    input: Unpacked<R>,
    buffer: Vec<u8>,
    /// Where the bytes not yet handed out begin and end.
    start: usize,
    end: usize,
    number: u64,
    /// The rest of a line that was cut off is still to be skipped.
    skipping: bool,
    ended: bool,
}

/// A line.
#[derive(Debug, PartialEq)]
pub(super) struct Line<'a> {
    /// Its bytes, without the line feed and what blanks there are before it.
    pub text: &'a [u8],
    /// False if there was more of it than can be read.
    pub whole: bool,
}

impl<R: Read> Lines<R> {
    pub fn new(input: R) -> Self {
        Self {
            input: Unpacked::new(input),
            buffer: vec![0; LONGEST],
            start: 0,
            end: 0,
            number: 0,
            skipping: false,
            ended: false,
        }
    }

    /// Number of the line handed out last; the first is 1. What binary G-code
    /// says of itself before its text does not count.
    pub fn number(&self) -> u64 {
        self.number.saturating_sub(self.input.preface())
    }

    /// The next line, or nothing at the end.
    pub fn next(&mut self) -> io::Result<Option<Line<'_>>> {
        // Bytes from `start` that are known to hold no line feed.
        let mut searched = 0;
        loop {
            let fresh = &self.buffer[self.start + searched..self.end];
            if let Some(i) = memchr::memchr(b'\n', fresh) {
                let from = self.start;
                let to = from + searched + i;
                self.start = to + 1;
                if std::mem::take(&mut self.skipping) {
                    searched = 0;
                    continue;
                }
                return Ok(Some(self.line(from, to, true)));
            }
            if self.skipping {
                self.start = self.end;
            }
            searched = self.end - self.start;
            if self.ended {
                if searched == 0 {
                    return Ok(None);
                }
                let (from, to) = (self.start, self.end);
                self.start = self.end;
                return Ok(Some(self.line(from, to, true)));
            }
            if searched == self.buffer.len() {
                self.skipping = true;
                let (from, to) = (self.start, self.end);
                self.start = self.end;
                return Ok(Some(self.line(from, to, false)));
            }
            self.fill()?;
        }
    }

    /// Reads on; what is left over moves to the buffer's start.
    fn fill(&mut self) -> io::Result<()> {
        // A line may be without end.
        crate::limits::check();
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
        self.ended = read == 0;
        Ok(())
    }

    fn line(&mut self, from: usize, to: usize, whole: bool) -> Line<'_> {
        self.number += 1;
        let text = self.buffer[from..to].trim_ascii_end();
        Line { text, whole }
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
    fn an_endless_line_is_cut_off_and_the_next_one_found() {
        let mut text = vec![b'x'; 3 * LONGEST];
        text.extend_from_slice(b"\nG28\n");
        let found = all(&text[..]);
        assert_eq!(found.len(), 2);
        assert_eq!((found[0].1.len(), found[0].2), (LONGEST, false));
        assert_eq!(found[1], (2, "G28".to_owned(), true));
    }
}
