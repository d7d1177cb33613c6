//! Lines that tell how far the print has come.
//!
//! In: the file's text, and marks in it with the time that has passed there.
//! Out: the same text with a line at each mark, once the whole time is known.
//! Until then the text waits in a temporary file, so that memory does not
//! grow with the part.
//!
//! A mark stands at some of a layer's [`Moment`]s. Which places are moments
//! follows from the layer alone, so files of ranges of layers know theirs; which
//! of them get a mark follows from the whole print's time, by [`Rhythm`].

use super::Writer;
use super::flavour::{self, Progress};
use isoslice_base::units::Seconds;
use isoslice_path::pace::{PacedLayer, PacedMove};
use isoslice_settings::Flavour;
use serde::{Deserialize, Serialize};
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
    rhythm: Rhythm,
}

/// Least time between a layer's moments, s.
const MOMENT: Seconds = 1.0;

/// A place in a layer where there may be a mark.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Moment {
    /// Length of the text before the place, bytes.
    pub at: u64,
    /// Time that has passed since the layer's beginning.
    pub time: Seconds,
}

/// Says which moments get a mark: every minute in a long print, more in a short
/// one. Hosts show minutes, and percents of short prints.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Rhythm {
    /// Time at the last mark.
    last: Seconds,
}

impl Rhythm {
    /// True if a mark is due at this time after the print's beginning. The time
    /// then counts as that of the last mark.
    pub(super) fn is_due(&mut self, time: Seconds) -> bool {
        let due = time - self.last >= (0.05 * time).clamp(10.0, 60.0);
        if due {
            self.last = time;
        }
        due
    }
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
            rhythm: Rhythm::default(),
        })
    }

    /// Appends text. `copy` gets the text, with a line at each mark whose
    /// numbers are 0.
    pub(super) fn write(
        &mut self,
        bytes: &[u8],
        copy: &mut dyn FnMut(&[u8]),
    ) -> io::Result<()> {
        let line = line(self.flavour, Progress::default());
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

    /// Writes the text to `out`, with a line at each mark.
    pub(super) fn release(
        self,
        out: &mut impl Write,
        total: Seconds,
    ) -> io::Result<()> {
        let mut file = self.text.into_inner().map_err(|e| e.into_error())?;
        file.rewind()?;
        let mut text = BufReader::with_capacity(BUFFER, file);
        let mut done = 0;
        for mark in &self.marks {
            copy(&mut text, mark.at - done, out)?;
            done = mark.at;
            let line = line_at(self.flavour, mark.time, total);
            out.write_all(line.as_bytes())?;
        }
        copy(&mut text, u64::MAX, out)?;
        Ok(())
    }
}

/// The line that tells how far the print has come after `time`.
pub(super) fn line_at(
    flavour: Flavour,
    time: Seconds,
    total: Seconds,
) -> String {
    line(flavour, Progress::new(time, total))
}

fn line(flavour: Flavour, now: Progress) -> String {
    flavour::progress(flavour, now) + "\n"
}

/// Copies a number of bytes, or as many as there are, and tells how many are
/// missing. `io::copy` would do it in small pieces.
pub(super) fn copy(
    from: &mut impl BufRead,
    count: u64,
    to: &mut impl Write,
) -> io::Result<u64> {
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
    Ok(left)
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

    /// Notes a layer's moment: a whole file marks it, if the last mark was long
    /// ago, and a range's file tells of it.
    pub(super) fn moment(&mut self, time: Seconds) {
        let now = self.totals.time + time;
        let ahead = self.buffer.len();
        if let Some(waiting) = &mut self.waiting {
            if waiting.rhythm.is_due(now) {
                waiting.mark(ahead, now);
            }
        } else if let Some(record) = &mut self.record {
            record.moment(ahead, time);
        }
    }
}

/// How far a layer has come in time: its share of the printing moves at their
/// speeds.
pub(super) struct Clock {
    time: Seconds,
    printing: Seconds,
    passed: Seconds,
    /// Time at which the next moment may come.
    next: Seconds,
}

impl Clock {
    pub(super) fn new(layer: &PacedLayer) -> Self {
        Self {
            time: layer.time,
            printing: layer.moves.iter().map(printing).sum(),
            passed: 0.0,
            next: 0.0,
        }
    }

    /// The time, if it is a moment's. A layer's beginning is one.
    pub(super) fn moment(&mut self) -> Option<Seconds> {
        let now = self.time();
        let is = now >= self.next;
        if is {
            self.next = now + MOMENT;
        }
        is.then_some(now)
    }

    pub(super) fn step(&mut self, step: &PacedMove) {
        self.passed += printing(step);
    }

    fn time(&self) -> Seconds {
        if self.printing > 0.0 {
            self.time * self.passed / self.printing
        } else {
            0.0
        }
    }
}

fn printing(step: &PacedMove) -> Seconds {
    match step {
        PacedMove::Print { bead, speed, .. } => bead.stroke.length() / speed,
        _ => 0.0,
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "helpers of tests may unwrap, too")]
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
        let mut rhythm = Rhythm::default();
        let seconds = (0..36_000).map(f64::from);
        let marks: Vec<f64> = seconds.filter(|&s| rhythm.is_due(s)).collect();
        assert!(marks.iter().filter(|time| **time <= 300.0).count() >= 20);
        assert!((600..700).contains(&marks.len()));
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
