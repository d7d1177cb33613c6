//! What is shared between the work, the page's requests and the files: what is
//! wanted, and what there is to show.
//!
//! Whoever changes something that pages show gives it a new revision and wakes
//! those who wait. A revision is never used twice.

use super::choice::Choice;
use isoslice::limits::Watch;
use isoslice::model::Model;
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

/// All that is known.
pub(super) struct State {
    /// Of the newest news.
    pub revision: u64,
    /// What is to be shown.
    pub choice: Choice,
    /// Of what is to be shown. Work for an older one is in vain.
    pub wanted: u64,
    /// Stops the work under way.
    pub watch: Option<Watch>,
    /// What is being done; nothing while all is done.
    pub busy: Option<&'static str>,
    /// Layers sliced, and layers in all.
    pub progress: (usize, usize),
    reported: Instant,
    /// Why what is wanted cannot be shown.
    pub fault: Option<Fault>,
    /// Warnings about the settings.
    pub warnings: Vec<String>,
    pub settings: Option<Arc<Listed>>,
    pub model: Option<Arc<Shown>>,
    pub print: Option<Arc<Print>>,
    /// Files that were read for it.
    pub files: Vec<PathBuf>,
    /// How a page looked at the part last, for a rough picture.
    pub look: Look,
    /// The picture that was drawn last.
    pub picture: Option<(u64, Look, Arc<[u8]>)>,
    pub sending: Sending,
}

/// An error, for people.
#[derive(Clone, Debug, Default, Serialize)]
pub(super) struct Fault {
    pub text: String,
    /// Lines of the script where it failed.
    pub excerpt: String,
}

/// The settings in use.
pub(super) struct Listed {
    pub revision: u64,
    /// One object for each setting, as JSON.
    pub json: String,
    /// Those that are not the defaults, as TOML.
    pub toml: String,
}

/// A model that can be drawn.
pub(super) struct Shown {
    pub revision: u64,
    pub model: Model,
    /// What pages are told of it.
    pub told: Value,
}

/// A sliced model.
pub(super) struct Print {
    pub revision: u64,
    /// What pages are told of it.
    pub told: Value,
    /// The moves, as pages get them.
    pub moves: Arc<[u8]>,
    pub gcode: Arc<Text>,
    /// Name for the G-code's file.
    pub file: String,
    /// The printer that it was made for, if the settings tell.
    pub printer_model: String,
}

/// Where a page looks at the part from, and the size of its picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Look {
    pub view: View,
    pub size: [usize; 2],
    /// Whether it is to be there quickly, and not to be fine.
    pub rough: bool,
}

/// What becomes of a print that is sent.
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

    /// The state, to look at.
    pub(super) fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Changes the state, which is news to all pages. The change is told its
    /// revision.
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

    /// Tells how far the slicing is, now and then.
    pub(super) fn report(&self, done: usize, total: usize) {
        let mut state = self.lock();
        if state.reported.elapsed() > PROGRESS {
            state.reported = Instant::now();
            state.revision += 1;
            state.progress = (done, total);
            self.changed.notify_all();
        }
    }

    /// Waits until there is news, or until `patience` is over.
    pub(super) fn news(
        &self,
        seen: u64,
        patience: Duration,
    ) -> MutexGuard<'_, State> {
        self.wait(patience, |state| state.revision != seen)
    }

    /// Waits for another revision to be wanted than `last`.
    pub(super) fn next_wanted(&self, last: u64) -> MutexGuard<'_, State> {
        let mut state = self.lock();
        while state.wanted == last {
            let waited = self.changed.wait(state);
            state = waited.unwrap_or_else(PoisonError::into_inner);
        }
        state
    }

    /// Waits for something, or until `patience` is over.
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

/// Lines from one place that [`Text`] remembers to the next.
const STRIDE: usize = 1000;

/// Longest line that is told, bytes.
const LONGEST_LINE: u64 = 1 << 10;

/// A file without a name, which several may read at once.
pub(super) struct Text {
    file: Mutex<File>,
    /// Its size, bytes.
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

    /// A line by its number, from 1, without its end; nothing if there is none.
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

    /// A reader of all of it.
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
