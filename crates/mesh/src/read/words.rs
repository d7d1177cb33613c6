//! Words of a text file, one after another.

use crate::error::MeshError;
use glam::DVec3;
use isoslice_base::units::human_start;
use std::io::{BufRead, BufReader, Read};
use std::str::FromStr;

/// Greatest length of a word, bytes. Numbers have up to 30.
const LONGEST: usize = 4096;

/// Reads words, and knows their line.
#[derive(Debug)]
pub(super) struct Words<R> {
    source: BufReader<R>,
    line: u64,
    word: Vec<u8>,
    /// True if the word ended its line.
    is_last: bool,
}

impl<R: Read> Words<R> {
    pub(super) fn new(source: R) -> Words<R> {
        Words {
            source: BufReader::with_capacity(1 << 16, source),
            line: 1,
            word: Vec::new(),
            is_last: false,
        }
    }

    /// The line of the last word, from 1.
    pub(super) fn line(&self) -> u64 {
        self.line - u64::from(self.is_last)
    }

    /// The next word; none at the end.
    pub(super) fn next(&mut self) -> Result<Option<&[u8]>, MeshError> {
        self.word.clear();
        self.is_last = false;
        loop {
            let bytes = self.source.fill_buf()?;
            if bytes.is_empty() {
                break;
            }
            if self.word.is_empty() {
                let blank =
                    bytes.iter().take_while(|b| b.is_ascii_whitespace());
                let (mut count, mut lines) = (0, 0);
                for b in blank {
                    count += 1;
                    lines += u64::from(*b == b'\n');
                }
                self.line += lines;
                if count > 0 {
                    self.source.consume(count);
                    continue;
                }
            }
            let end = bytes.iter().position(u8::is_ascii_whitespace);
            let part = &bytes[..end.unwrap_or(bytes.len())];
            if self.word.len() + part.len() > LONGEST {
                return Err(MeshError::at(
                    format_args!("line {}", self.line),
                    "a word of more than 4,096 letters; is it text?",
                ));
            }
            self.word.extend_from_slice(part);
            let count = part.len();
            if let Some(end) = end {
                self.is_last = bytes[end] == b'\n';
                self.line += u64::from(self.is_last);
                self.source.consume(count + 1);
                break;
            }
            self.source.consume(count);
        }
        Ok((!self.word.is_empty()).then_some(&self.word[..]))
    }

    /// The next word of the line; none if the last one ended it.
    pub(super) fn next_in_line(&mut self) -> Result<Option<&[u8]>, MeshError> {
        while !self.is_last {
            match self.source.fill_buf()?.first() {
                None => return Ok(None),
                Some(b'\n') => {
                    self.source.consume(1);
                    self.line += 1;
                    self.is_last = true;
                }
                Some(b) if b.is_ascii_whitespace() => self.source.consume(1),
                Some(_) => return self.next(),
            }
        }
        Ok(None)
    }

    /// Makes the next line part of this one.
    pub(super) fn join_line(&mut self) {
        self.is_last = false;
    }

    /// Reads bytes that follow the words.
    pub(super) fn bytes(&mut self, out: &mut [u8]) -> std::io::Result<()> {
        self.source.read_exact(out)
    }

    /// Skips the rest of the line.
    pub(super) fn skip_line(&mut self) -> Result<(), MeshError> {
        while !self.is_last {
            let bytes = self.source.fill_buf()?;
            if bytes.is_empty() {
                break;
            }
            let end = bytes.iter().position(|b| *b == b'\n');
            let count = end.map_or(bytes.len(), |end| end + 1);
            self.is_last = end.is_some();
            self.line += u64::from(self.is_last);
            self.source.consume(count);
        }
        Ok(())
    }

    /// What is wrong in the line of the last word.
    pub(super) fn wrong(&self, what: impl Into<String>) -> MeshError {
        MeshError::at(format_args!("line {}", self.line()), what)
    }

    /// The next three words as a point.
    pub(super) fn point(&mut self) -> Result<DVec3, MeshError> {
        Ok(DVec3::new(self.number()?, self.number()?, self.number()?))
    }

    /// The next word as a number.
    pub(super) fn number(&mut self) -> Result<f64, MeshError> {
        let word = self.next()?;
        if let Some(number) = word.and_then(parsed) {
            return Ok(number);
        }
        let what = match word {
            None => "the file ends where a number should be".to_owned(),
            Some(word) => {
                format!("{:?} is no number", shortened(word))
            }
        };
        Err(self.wrong(what))
    }
}

/// A word as a number.
pub(super) fn parsed<T: FromStr>(word: &[u8]) -> Option<T> {
    std::str::from_utf8(word).ok()?.parse().ok()
}

/// The beginning of a word, for messages.
pub(super) fn shortened(word: &[u8]) -> String {
    human_start(&String::from_utf8_lossy(word), 30)
}
