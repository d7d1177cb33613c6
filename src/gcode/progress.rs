//! Lines that tell how far the print has come.
//!
//! In: the file's text, and marks in it with the time that has passed there.
//! Out: the same text with a line at each mark, once the whole time is known.
//! Until then the text waits in a temporary file, so that memory does not
//! grow with the part.

use super::Writer;
use crate::pace::{PacedLayer, PacedMove};
use crate::settings::{Emit, Flavour, Settings};
use crate::units::Seconds;
use std::fs::File;
use std::io::{self, BufRead, BufReader, BufWriter, Seek, Write};

/// Bytes that are written or read at a time.
const BUFFER: usize = 1 << 18;

/// Time between marks, at least: hosts show minutes.
pub(super) const BETWEEN: Seconds = 20.0;

/// A file's text that waits for its total time.
#[derive(Debug)]
pub(super) struct Waiting {
    text: BufWriter<File>,
    length: u64,
    marks: Vec<Mark>,
}

#[derive(Clone, Copy, Debug)]
struct Mark {
    /// Bytes before it.
    at: u64,
    /// Time that has passed.
    time: Seconds,
}

impl Waiting {
    /// An empty text.
    pub(super) fn new() -> io::Result<Self> {
        Ok(Self {
            text: BufWriter::with_capacity(BUFFER, tempfile::tempfile()?),
            length: 0,
            marks: Vec::new(),
        })
    }

    /// Adds to the text.
    pub(super) fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.length += bytes.len() as u64;
        self.text.write_all(bytes)
    }

    /// Marks the place `ahead` bytes after what has been written so far.
    pub(super) fn mark(&mut self, ahead: usize, time: Seconds) {
        let at = self.length + ahead as u64;
        self.marks.push(Mark { at, time });
    }

    /// When the last mark was.
    pub(super) fn last(&self) -> Option<Seconds> {
        self.marks.last().map(|m| m.time)
    }

    /// Hands the text on, with the `line` of percent and minutes left at each
    /// mark where it differs from the one before.
    pub(super) fn release(
        self,
        out: &mut impl Write,
        total: Seconds,
        line: impl Fn(u8, u64) -> String,
    ) -> io::Result<()> {
        let mut file = self.text.into_inner().map_err(|e| e.into_error())?;
        file.rewind()?;
        let mut text = BufReader::with_capacity(BUFFER, file);
        let mut done = 0;
        let mut said = None;
        for mark in self.marks {
            copy(&mut text, mark.at - done, out)?;
            done = mark.at;
            let now = figures(mark.time, total);
            if said != Some(now) {
                said = Some(now);
                writeln!(out, "{}", line(now.0, now.1))?;
            }
        }
        copy(&mut text, u64::MAX, out)
    }
}

/// Hands on so many bytes, or as many as there are; `io::copy` would do it in
/// small pieces.
fn copy(
    from: &mut impl BufRead,
    count: u64,
    to: &mut impl Write,
) -> io::Result<()> {
    let mut left = count;
    while left > 0 {
        let all = match from.fill_buf() {
            Err(e) if e.kind() == io::ErrorKind::Interrupted => continue,
            all => all?,
        };
        let n = usize::try_from(left).unwrap_or(usize::MAX).min(all.len());
        if n == 0 {
            break;
        }
        to.write_all(&all[..n])?;
        from.consume(n);
        left -= n as u64;
    }
    Ok(())
}

/// Whole percents done, whole minutes left.
fn figures(time: Seconds, total: Seconds) -> (u8, u64) {
    if total <= 0.0 || time >= total {
        return (100, 0);
    }
    // Casts of floats saturate.
    let percent = (100.0 * time / total).floor() as u8;
    (percent, ((total - time) / 60.0).round() as u64)
}

impl<W: io::Write> Writer<'_, W> {
    /// Marks a place that tells how far the print has come; `time` is that
    /// since the layer's beginning.
    pub(super) fn mark(&mut self, time: Seconds) {
        let time = self.totals.time + time;
        if let Some(waiting) = &mut self.waiting {
            waiting.mark(self.buffer.len(), time);
        }
    }

    /// The same, if the last one was long ago.
    pub(super) fn mark_if_due(&mut self, time: Seconds) {
        let last = self.waiting.as_ref().and_then(Waiting::last);
        let since = self.totals.time + time - last.unwrap_or(0.0);
        if since >= BETWEEN {
            self.mark(time);
        }
    }
}

/// True if layers are to tell how far the print has come.
pub(super) fn tells_progress(settings: &Settings) -> bool {
    match settings.gcode.progress {
        Emit::On => true,
        Emit::Off => false,
        // A Marlin that does not know M73 says so and goes on.
        Emit::Auto => {
            matches!(settings.gcode.flavour, Flavour::Marlin | Flavour::Prusa)
        }
    }
}

/// How far a layer has come in time: its share of the printing moves at their
/// speeds.
pub(super) struct Clock {
    time: Seconds,
    printing: Seconds,
    passed: Seconds,
}

impl Clock {
    pub(super) fn new(layer: &PacedLayer) -> Self {
        Self {
            time: layer.time,
            printing: layer.moves.iter().map(printing).sum(),
            passed: 0.0,
        }
    }

    pub(super) fn step(&mut self, step: &PacedMove) {
        self.passed += printing(step);
    }

    pub(super) fn time(&self) -> Seconds {
        match self.printing > 0.0 {
            true => self.time * self.passed / self.printing,
            false => 0.0,
        }
    }
}

fn printing(step: &PacedMove) -> Seconds {
    match step {
        PacedMove::Print { bead, speed, .. } => bead.length() / speed,
        _ => 0.0,
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn lines_come_where_the_marks_are_and_only_if_they_change() {
        let mut waiting = Waiting::new().unwrap();
        waiting.mark(0, 0.0);
        waiting.write(b"a\n").unwrap();
        waiting.mark(2, 0.5);
        waiting.mark(2, 300.0);
        waiting.write(b"b\nc\n").unwrap();
        waiting.mark(0, 600.0);
        let mut out = Vec::new();
        let line = |p, m| format!("{p} {m}");
        waiting.release(&mut out, 600.0, line).unwrap();
        let text = String::from_utf8(out).unwrap();
        assert_eq!(text, "0 10\na\nb\n50 5\nc\n100 0\n");
    }

    #[test]
    fn figures_stay_in_their_range() {
        assert_eq!(figures(0.0, 0.0), (100, 0));
        assert_eq!(figures(1.0, 3600.0), (0, 60));
        assert_eq!(figures(3599.0, 3600.0), (99, 0));
        assert_eq!(figures(3601.0, 3600.0), (100, 0));
    }
}
