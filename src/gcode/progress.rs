//! Lines that tell how far the print has come.
//!
//! In: the file's text, and marks in it with the time that has passed there.
//! Out: the same text with a line at each mark, once the whole time is known.
//! Until then the text waits in a temporary file, so that memory does not
//! grow with the part.

use super::Writer;
use super::flavour::{self, Progress};
use crate::pace::{PacedLayer, PacedMove};
use crate::settings::{Emit, Flavour, Settings};
use crate::units::Seconds;
use std::fs::File;
use std::io::{self, BufRead, BufReader, BufWriter, Seek, Write};

/// Bytes that are written or read at a time.
const BUFFER: usize = 1 << 18;

/// The text of a file until its total time is known.
#[derive(Debug)]
pub(super) struct Waiting {
    flavour: Flavour,
    text: BufWriter<File>,
    length: u64,
    marks: Vec<Mark>,
    /// Number of marks within the text up to `length`.
    passed: usize,
}

#[derive(Clone, Copy, Debug)]
struct Mark {
    /// Length of the text before the mark, bytes.
    at: u64,
    /// Time that has passed at the mark.
    time: Seconds,
}

impl Progress {
    fn new(time: Seconds, total: Seconds) -> Self {
        if total <= 0.0 || time >= total {
            return Progress {
                percent: 100,
                minutes: 0,
            };
        }
        Progress {
            // Casts of floats saturate.
            percent: (100.0 * time / total).floor() as u8,
            minutes: ((total - time) / 60.0).round() as u64,
        }
    }
}

impl Waiting {
    /// An empty text.
    pub(super) fn new(flavour: Flavour) -> io::Result<Self> {
        Ok(Self {
            flavour,
            text: BufWriter::with_capacity(BUFFER, tempfile::tempfile()?),
            length: 0,
            marks: Vec::new(),
            passed: 0,
        })
    }

    fn line(&self, now: Progress) -> String {
        let mut line = flavour::progress(self.flavour, now);
        line.push('\n');
        line
    }

    /// Appends text. `copy` gets it with a line at each mark whose numbers are
    /// 0.
    pub(super) fn write(
        &mut self,
        bytes: &[u8],
        copy: &mut dyn FnMut(&[u8]),
    ) -> io::Result<()> {
        let line = self.line(Progress::default());
        let mut rest = bytes;
        for mark in &self.marks[self.passed..] {
            let done = self.length + (bytes.len() - rest.len()) as u64;
            let (before, after) = rest.split_at((mark.at - done) as usize);
            copy(before);
            copy(line.as_bytes());
            rest = after;
        }
        copy(rest);
        self.passed = self.marks.len();
        self.length += bytes.len() as u64;
        self.text.write_all(bytes)
    }

    /// Marks the place `ahead` bytes after what has been written so far.
    pub(super) fn mark(&mut self, ahead: usize, time: Seconds) {
        let at = self.length + ahead as u64;
        self.marks.push(Mark { at, time });
    }

    /// Whether a mark is due. Hosts show minutes, and percents of short prints.
    pub(super) fn is_due(&self, time: Seconds) -> bool {
        let last = self.marks.last().map_or(0.0, |m| m.time);
        time - last >= (0.05 * time).clamp(10.0, 60.0)
    }

    /// Writes the text to `out`, with a line at each mark.
    pub(super) fn release(
        self,
        out: &mut impl Write,
        total: Seconds,
    ) -> io::Result<()> {
        let lines = self.marks.iter().map(|mark| {
            let line = self.line(Progress::new(mark.time, total));
            (mark.at, line)
        });
        let lines: Vec<(u64, String)> = lines.collect();
        let mut file = self.text.into_inner().map_err(|e| e.into_error())?;
        file.rewind()?;
        let mut text = BufReader::with_capacity(BUFFER, file);
        let mut done = 0;
        for (at, line) in lines {
            copy(&mut text, at - done, out)?;
            done = at;
            out.write_all(line.as_bytes())?;
        }
        copy(&mut text, u64::MAX, out)
    }
}

/// Copies a number of bytes, or as many as there are. `io::copy` would do it in
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

impl<W: io::Write> Writer<'_, W> {
    /// Marks a place whose line will tell how far the print has come. `time`
    /// has passed since the layer's beginning.
    pub(super) fn mark(&mut self, time: Seconds) {
        let time = self.totals.time + time;
        if let Some(waiting) = &mut self.waiting {
            waiting.mark(self.buffer.len(), time);
        }
    }

    /// Marks a place as [`Writer::mark`] does, if the last mark was long ago.
    pub(super) fn mark_if_due(&mut self, time: Seconds) {
        let now = self.totals.time + time;
        if self.waiting.as_ref().is_some_and(|w| w.is_due(now)) {
            self.mark(time);
        }
    }
}

/// True if layers are to tell how far the print has come.
pub(super) fn tells_progress(settings: &Settings) -> bool {
    match settings.gcode.progress {
        Emit::On => true,
        Emit::Off => false,
        // A Marlin built without M73 says that it does not know it, and goes
        // on.
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
        if self.printing > 0.0 {
            self.time * self.passed / self.printing
        } else {
            0.0
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
    fn lines_come_where_the_marks_are() {
        let mut waiting = Waiting::new(Flavour::Marlin).unwrap();
        let mut copied = String::new();
        let mut copy = |text: &[u8]| {
            copied += std::str::from_utf8(text).unwrap();
        };
        waiting.mark(0, 0.0);
        waiting.write(b"a\n", &mut copy).unwrap();
        waiting.mark(2, 150.0);
        waiting.mark(4, 300.0);
        waiting.write(b"b\nc\n", &mut copy).unwrap();
        waiting.mark(0, 600.0);
        waiting.write(b"", &mut copy).unwrap();
        let mut out = Vec::new();
        waiting.release(&mut out, 600.0).unwrap();
        let text = String::from_utf8(out).unwrap();
        let lines = ["M73 P0 R10", "M73 P25 R8", "M73 P50 R5", "M73 P100 R0"];
        let [a, b, c, d] = lines;
        assert_eq!(text, format!("{a}\na\nb\n{b}\nc\n{c}\n{d}\n"));
        // The copy and the file differ only in these numbers.
        let nothing = "M73 P0 R0";
        let blank = lines.iter().fold(text, |t, l| t.replace(l, nothing));
        assert_eq!(copied, blank);
    }

    #[test]
    fn long_prints_are_marked_every_minute_and_short_ones_more_often() {
        let mut waiting = Waiting::new(Flavour::Marlin).unwrap();
        for second in 0..36_000 {
            let now = f64::from(second);
            if waiting.is_due(now) {
                waiting.mark(0, now);
            }
        }
        let short = waiting.marks.iter().filter(|m| m.time <= 300.0);
        assert!(short.count() >= 20);
        assert!((600..700).contains(&waiting.marks.len()));
    }

    #[test]
    fn figures_stay_in_their_range() {
        let figures = |time, total| {
            let now = Progress::new(time, total);
            (now.percent, now.minutes)
        };
        assert_eq!(figures(0.0, 0.0), (100, 0));
        assert_eq!(figures(1.0, 3600.0), (0, 60));
        assert_eq!(figures(3599.0, 3600.0), (99, 0));
        assert_eq!(figures(3601.0, 3600.0), (100, 0));
    }
}
