//! Checks G-code while it is written.
//!
//! A thread reads a copy of the text as it would read a file. So the verdict is
//! about the text that is written, and does not depend on timing. Memory stays
//! bounded: if the checker is slower than the writer, the writer waits.

use super::{Rules, Verdict, check};
use isoslice_base::stopwatch::Stopwatch;
use isoslice_base::units::Seconds;
use isoslice_gcode_read::reader::ReadError;
use std::io::{self, Read};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread::{Builder, JoinHandle};

/// Bytes that are handed over at a time.
const CHUNK: usize = 1 << 16;

/// Chunks that may wait for the checker.
const WAITING: usize = 8;

/// A check of text on a thread of its own while the text is written.
pub struct Alongside {
    chunk: Vec<u8>,
    chunks: SyncSender<Vec<u8>>,
    checker: JoinHandle<(Result<Verdict, ReadError>, Seconds)>,
}

impl Alongside {
    /// Starts a check by `rules`.
    ///
    /// # Errors
    /// If no thread can be started.
    pub fn new(rules: Rules) -> io::Result<Self> {
        let (chunks, written) = sync_channel(WAITING);
        let checker = Builder::new().name("check".into()).spawn(move || {
            let clock = Stopwatch::start();
            let verdict = check(Written::new(written), &rules);
            (verdict, clock.elapsed().as_secs_f64())
        })?;
        Ok(Alongside {
            chunk: Vec::with_capacity(CHUNK),
            chunks,
            checker,
        })
    }

    /// Takes the next part of the text.
    pub fn read(&mut self, text: &[u8]) {
        self.chunk.extend_from_slice(text);
        if self.chunk.len() >= CHUNK {
            self.hand_over();
        }
    }

    /// Ends the check: the verdict on the whole text, and the processor time
    /// that the check took.
    ///
    /// # Errors
    /// If the text is not G-code.
    pub fn finish(mut self) -> Result<(Verdict, Seconds), ReadError> {
        self.hand_over();
        // Without a sender the checker sees the end of the text.
        drop(self.chunks);
        match self.checker.join() {
            Ok((verdict, time)) => Ok((verdict?, time)),
            Err(panic) => std::panic::resume_unwind(panic),
        }
    }

    fn hand_over(&mut self) {
        let next = Vec::with_capacity(CHUNK);
        let chunk = std::mem::replace(&mut self.chunk, next);
        // If the checker has stopped, it tells its error at the end.
        let _ = self.chunks.send(chunk);
    }
}

/// The checker's end of the channel: the written text, as a file.
struct Written {
    chunks: Receiver<Vec<u8>>,
    chunk: Vec<u8>,
    /// Bytes of the chunk that have been read.
    read: usize,
}

impl Written {
    fn new(chunks: Receiver<Vec<u8>>) -> Self {
        Written {
            chunks,
            chunk: Vec::new(),
            read: 0,
        }
    }
}

impl Read for Written {
    fn read(&mut self, out: &mut [u8]) -> io::Result<usize> {
        while self.read == self.chunk.len() {
            let Ok(chunk) = self.chunks.recv() else {
                return Ok(0);
            };
            (self.chunk, self.read) = (chunk, 0);
        }
        let left = &self.chunk[self.read..];
        let count = left.len().min(out.len());
        out[..count].copy_from_slice(&left[..count]);
        self.read += count;
        Ok(count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use isoslice_settings::testing::settings;

    #[test]
    fn what_is_written_is_checked_as_a_file_is() {
        let rules = Rules::new(&settings(&[]));
        let mut text = String::from("G28\nM109 S200\nM83\n;LAYER_CHANGE\n");
        // The text is more than the channel holds, with something wrong at the
        // end.
        for k in 0..60_000 {
            text += &format!("G1 X{} Y10 E0.1 F600\n", 50 + k % 2);
        }
        text += "G1 X900\nM104 S0\n";
        assert!(text.len() > (WAITING + 1) * CHUNK);
        let mut checker = Alongside::new(rules.clone()).unwrap();
        // No line and no chunk is a whole number of such pieces.
        for piece in text.as_bytes().chunks(977) {
            checker.read(piece);
        }
        let (verdict, _) = checker.finish().unwrap();
        let expected = check(text.as_bytes(), &rules).unwrap();
        assert_eq!(verdict, expected);
        assert_eq!(verdict.lines, 60_006);
        assert!(!verdict.is_safe());
    }
}
