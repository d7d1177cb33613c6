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
use std::io::{self, Read, Seek, SeekFrom};
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

/// A file without a name, which several may read at once.
pub(super) struct Text {
    file: Mutex<File>,
    /// Its size, bytes.
    pub length: u64,
}

impl Text {
    pub(super) fn new(mut file: File) -> io::Result<Text> {
        let length = file.seek(SeekFrom::End(0))?;
        let file = Mutex::new(file);
        Ok(Text { file, length })
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
