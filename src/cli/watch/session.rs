//! The state that the work, the page's requests and the watch over files share:
//! what is to be shown, and what has been made so far.
//!
//! Each change of what pages show gets a revision, a number that is never used
//! twice, and wakes all threads that wait for one.

use super::choice::Choice;
use super::subject::Subject;
use isoslice::limits::Watch;
use isoslice::preview::View;
use serde::Serialize;
use serde_json::Value;
use std::fs::File;
use std::io::{self, BufRead, BufReader, ErrorKind, Read, Seek, SeekFrom};
use std::path::PathBuf;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Least time between two reports of progress.
const PROGRESS: Duration = Duration::from_millis(100);

/// The shared state, and who waits for it.
pub(super) struct Session {
    state: Mutex<State>,
    changed: Condvar,
}

/// The state itself.
pub(super) struct State {
    /// Revision of the newest change.
    pub revision: u64,
    /// What is to be shown.
    pub choice: Choice,
    /// Revision of what is to be shown. Work for an older revision is in vain.
    pub wanted: u64,
    /// Stops the work that is being done.
    pub watch: Option<Watch>,
    /// Name of the work that is being done; none while there is no work.
    pub busy: Option<&'static str>,
    /// Number of layers that are sliced, and of all layers.
    pub progress: (usize, usize),
    reported: Instant,
    /// The error because of which the model cannot be shown.
    pub fault: Option<Fault>,
    /// Warnings about the settings.
    pub warnings: Vec<String>,
    pub settings: Option<Arc<Listed>>,
    pub model: Option<Arc<Shown>>,
    pub print: Option<Arc<Print>>,
    /// Height of the layer that a page shows, mm; none if no page has told of
    /// one. If several pages are open, the one that told of its layer last
    /// counts.
    pub layer: Option<f64>,
    /// The layer at [`State::layer`] of the newest model, until the whole model
    /// is sliced.
    pub glimpse: Option<Arc<Glimpse>>,
    /// Files that the model and its settings were read from.
    pub files: Vec<PathBuf>,
    /// The view that a page asked for last. A rough picture of it is drawn
    /// ahead.
    pub look: Look,
    /// The picture that was drawn last.
    pub picture: Option<(u64, Look, Arc<[u8]>)>,
    pub sending: Sending,
}

/// An error, for people.
#[derive(Clone, Debug, Default, Serialize)]
pub(super) struct Fault {
    pub text: String,
    /// The lines of the script around the place of the error.
    pub excerpt: String,
}

/// The settings in use.
pub(super) struct Listed {
    pub revision: u64,
    /// JSON with an object for each setting.
    pub json: String,
    /// TOML with the settings that differ from their defaults.
    pub toml: String,
}

/// A model that can be drawn.
pub(super) struct Shown {
    pub revision: u64,
    pub subject: Subject,
    /// What pages are told of the model.
    pub told: Value,
}

/// A sliced model.
pub(super) struct Print {
    pub revision: u64,
    /// What pages are told of the print.
    pub told: Value,
    /// The moves in the form that pages get.
    pub moves: Arc<[u8]>,
    pub gcode: Arc<Text>,
    /// Name of the file under which a page saves the G-code.
    pub file: String,
    /// The printer that the G-code was made for, if the settings name it.
    pub printer_model: String,
}

/// One layer of a model that is still being sliced.
pub(super) struct Glimpse {
    pub revision: u64,
    /// What pages are told of the layer.
    pub told: Value,
    /// The moves in the form that pages get.
    pub moves: Arc<[u8]>,
}

/// A view of the part that a page asks for, and the size of its picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Look {
    pub view: View,
    pub size: [usize; 2],
    /// True if the picture is to be quick rather than fine.
    pub rough: bool,
}

/// How far the sending of a print has come.
#[derive(Clone, Debug, Default, Serialize)]
pub(super) struct Sending {
    pub busy: bool,
    pub text: String,
}

impl Session {
    pub(super) fn new(choice: Choice, files: Vec<PathBuf>) -> Session {
        Session {
            state: Mutex::new(State {
                revision: 1,
                choice,
                wanted: 1,
                watch: None,
                busy: Some("reading the model"),
                progress: (0, 0),
                reported: Instant::now(),
                fault: None,
                warnings: Vec::new(),
                settings: None,
                model: None,
                print: None,
                layer: None,
                glimpse: None,
                files,
                look: Look {
                    view: View::ISO,
                    size: [300, 200],
                    rough: true,
                },
                picture: None,
                sending: Sending::default(),
            }),
            changed: Condvar::new(),
        }
    }

    /// The state, locked for reading.
    pub(super) fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Changes the state under a new revision, which the change is given, and
    /// wakes all pages that wait.
    pub(super) fn tell<T>(&self, change: impl FnOnce(&mut State) -> T) -> T {
        let mut state = self.lock();
        state.revision += 1;
        let result = change(&mut state);
        self.changed.notify_all();
        result
    }

    /// Changes what is wanted, and stops work that is now in vain.
    pub(super) fn want(&self, change: impl FnOnce(&mut State)) {
        self.tell(|state| {
            change(state);
            state.wanted = state.revision;
            state.busy = Some("reading the model");
            state.progress = (0, 0);
            if let Some(watch) = &state.watch {
                watch.cancel();
            }
        });
    }

    /// Reports how many layers are sliced, though not at every layer.
    pub(super) fn report(&self, done: usize, total: usize) {
        let mut state = self.lock();
        if state.reported.elapsed() > PROGRESS {
            state.reported = Instant::now();
            state.revision += 1;
            state.progress = (done, total);
            self.changed.notify_all();
        }
    }

    /// Waits for a revision newer than the page has, or until `patience` is
    /// over.
    pub(super) fn news(
        &self,
        seen: u64,
        patience: Duration,
    ) -> MutexGuard<'_, State> {
        self.wait(patience, |state| state.revision != seen)
    }

    /// Waits until something other than revision `last` is to be shown.
    pub(super) fn next_wanted(&self, last: u64) -> MutexGuard<'_, State> {
        let mut state = self.lock();
        while state.wanted == last {
            let waited = self.changed.wait(state);
            state = waited.unwrap_or_else(PoisonError::into_inner);
        }
        state
    }

    /// Waits until a condition holds, or until `patience` is over.
    pub(super) fn wait(
        &self,
        patience: Duration,
        until: impl Fn(&State) -> bool,
    ) -> MutexGuard<'_, State> {
        let state = self.lock();
        let waited =
            self.changed
                .wait_timeout_while(state, patience, |state| !until(state));
        waited.unwrap_or_else(PoisonError::into_inner).0
    }
}

/// Number of lines between two places that [`Text`] remembers.
const STRIDE: usize = 1000;

/// Greatest length of a line that a page gets, bytes.
const LONGEST_LINE: u64 = 1 << 10;

/// G-code in a file without a name, which several threads may read at once.
pub(super) struct Text {
    file: Mutex<File>,
    /// Size of the file, bytes.
    pub length: u64,
    /// Where every [`STRIDE`]th line begins.
    lines: Vec<u64>,
}

impl Text {
    /// # Errors
    /// If the file cannot be read.
    pub(super) fn new(mut file: File) -> io::Result<Text> {
        file.rewind()?;
        let mut lines = vec![0];
        let (mut length, mut count) = (0, 0);
        let mut buffer = vec![0; 1 << 16];
        loop {
            let read = match file.read(&mut buffer) {
                Ok(0) => break,
                Ok(read) => read,
                Err(error) if error.kind() == ErrorKind::Interrupted => {
                    continue;
                }
                Err(error) => return Err(error),
            };
            for at in memchr::memchr_iter(b'\n', &buffer[..read]) {
                count += 1;
                if count % STRIDE == 0 {
                    lines.push(length + at as u64 + 1);
                }
            }
            length += read as u64;
        }
        Ok(Text {
            file: Mutex::new(file),
            length,
            lines,
        })
    }

    /// The line of a number, counted from 1, without its end; none if the file
    /// has no such line.
    pub(super) fn line(self: &Arc<Self>, number: usize) -> Option<String> {
        let before = number.checked_sub(1)?;
        let at = *self.lines.get(before / STRIDE)?;
        let text = self.clone();
        let mut reader = BufReader::new(TextReader { text, at });
        for _ in 0..before % STRIDE {
            reader.skip_until(b'\n').ok()?;
        }
        let mut line = Vec::new();
        reader
            .take(LONGEST_LINE)
            .read_until(b'\n', &mut line)
            .ok()?;
        let line = String::from_utf8_lossy(&line);
        (!line.is_empty()).then(|| line.trim_end().to_owned())
    }

    /// A reader of the whole file.
    pub(super) fn read(self: &Arc<Self>) -> TextReader {
        TextReader {
            text: self.clone(),
            at: 0,
        }
    }
}

/// Reads a [`Text`] from its beginning.
pub(super) struct TextReader {
    text: Arc<Text>,
    at: u64,
}

impl Read for TextReader {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let file = self.text.file.lock();
        let mut file = file.unwrap_or_else(PoisonError::into_inner);
        file.seek(SeekFrom::Start(self.at))?;
        let read = file.read(buffer)?;
        self.at += read as u64;
        Ok(read)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write;

    #[test]
    fn every_line_can_be_told() {
        let mut file = tempfile::tempfile().unwrap();
        for number in 1..=2500 {
            writeln!(file, "G1 X{number}").unwrap();
        }
        write!(file, "the last").unwrap();
        let text = Arc::new(Text::new(file).unwrap());
        for number in [1, 2, 999, 1000, 1001, 1002, 2000, 2001, 2500] {
            assert_eq!(text.line(number), Some(format!("G1 X{number}")));
        }
        assert_eq!(text.line(2501).as_deref(), Some("the last"));
        for none in [0, 2502, 4000, usize::MAX] {
            assert_eq!(text.line(none), None);
        }
        let mut all = String::new();
        text.read().read_to_string(&mut all).unwrap();
        assert_eq!(all.len() as u64, text.length);
    }
}
