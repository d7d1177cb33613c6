//! Notices that files have changed.
//!
//! The files are looked at many times a second. That takes a few microseconds,
//! also works on network drives, and sees an editor that writes a file anew as
//! well as one that puts another file in its place.

use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

/// Time between two looks at the files.
pub(super) const EVERY: Duration = Duration::from_millis(15);

/// Number of looks for which a file may be missing before that counts as a
/// change. Some editors remove a file before they write it anew.
const PATIENCE: u32 = 30;

/// By how much the time of a change may be earlier than the change: the clock of file
/// systems goes by ticks, of up to 16 ms.
const TICK: Duration = Duration::from_millis(20);

/// The files at one look: time of the last change and size of each.
type Look = Vec<Option<(SystemTime, u64)>>;

/// Remembers what files were like.
#[derive(Debug)]
pub(super) struct Stamps {
    /// When the last change was reported, and files began to be read anew.
    reported: SystemTime,
    files: Vec<PathBuf>,
    /// The stamps when a change was reported last.
    known: Look,
    /// The stamps at the look before this one.
    last: Look,
    missing: u32,
    /// True once a list of files was given.
    looked: bool,
}

impl Stamps {
    /// The files are read from now on.
    pub(super) fn new() -> Stamps {
        Stamps {
            reported: SystemTime::now(),
            files: Vec::new(),
            known: Look::new(),
            last: Look::new(),
            missing: 0,
            looked: false,
        }
    }

    /// True if a file has changed since the last change that was reported, and
    /// has stayed the same since the look before, so that nobody is writing it.
    /// Files that are new in the list count as unchanged, but for those that
    /// were written after the reading began, which may have missed them. Their
    /// times may be too early by a tick, so files that a reading named count as
    /// written after it if they are no older than a tick before it. The first list is
    /// the command line's, whose times are believed: a user who has just saved a file
    /// would have it read twice at every start.
    pub(super) fn changed(&mut self, files: &[PathBuf]) -> bool {
        let is_first = !std::mem::replace(&mut self.looked, true);
        let now: Look = files.iter().map(|file| stamp(file)).collect();
        if self.files != files {
            let tick = if is_first { Duration::ZERO } else { TICK };
            let old = self.files.iter().zip(&self.known);
            let old: Vec<_> = old.map(|(f, s)| (f.clone(), *s)).collect();
            let known = |file: &PathBuf, now: Option<(SystemTime, u64)>| {
                let before = old.iter().find(|(f, _)| f == file);
                let read = now.filter(|(at, _)| {
                    at.checked_add(tick).is_some_and(|at| at <= self.reported)
                });
                before.map_or(read, |(_, stamp)| *stamp)
            };
            self.known =
                files.iter().zip(&now).map(|(f, s)| known(f, *s)).collect();
            self.files = files.to_vec();
        }
        let calm = std::mem::replace(&mut self.last, now) == self.last;
        let gone = |(now, known): (&Option<_>, &Option<_>)| {
            now.is_none() && known.is_some()
        };
        if self.last.iter().zip(&self.known).any(gone) {
            self.missing += 1;
        } else {
            self.missing = 0;
        }
        let waits = (1..PATIENCE).contains(&self.missing);
        if !calm || waits || self.last == self.known {
            return false;
        }
        self.known.clone_from(&self.last);
        self.reported = SystemTime::now();
        true
    }
}

fn stamp(file: &Path) -> Option<(SystemTime, u64)> {
    let data = std::fs::metadata(file).ok()?;
    Some((data.modified().ok()?, data.len()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn a_change_is_told_once_and_when_it_is_over() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("part.rhai");
        let files = [file.clone()];
        fs::write(&file, "x").unwrap();
        let mut stamps = Stamps::new();
        assert!(!stamps.changed(&files));
        assert!(!stamps.changed(&files));
        fs::write(&file, "x + 1").unwrap();
        assert!(!stamps.changed(&files), "it may still be written");
        assert!(stamps.changed(&files));
        assert!(!stamps.changed(&files));
        // Another file is put in its place.
        fs::write(folder.path().join("new"), "x + 1 + 1").unwrap();
        fs::rename(folder.path().join("new"), &file).unwrap();
        assert!(!stamps.changed(&files));
        assert!(stamps.changed(&files));
    }

    #[test]
    fn a_file_that_came_before_it_was_listed_is_told_of() {
        let folder = tempfile::tempdir().unwrap();
        let file = |name: &str| folder.path().join(name);
        fs::write(file("part.rhai"), "x").unwrap();
        let written = |name: &str, at: SystemTime| {
            let made = fs::File::create(file(name)).unwrap();
            made.set_modified(at).unwrap();
        };
        let mut stamps = Stamps::new();
        let began = stamps.reported;
        written("old.svg", began - Duration::from_secs(1));
        // It was written after the reading began, by a clock that goes by ticks.
        written("new.svg", began - Duration::from_millis(10));
        assert!(!stamps.changed(&[file("part.rhai")]));
        let listed = ["part.rhai", "old.svg"].map(file);
        assert!(!stamps.changed(&listed));
        assert!(!stamps.changed(&listed));
        let listed = ["part.rhai", "old.svg", "new.svg"].map(file);
        assert!(!stamps.changed(&listed), "it may still be written");
        assert!(stamps.changed(&listed));
        assert!(!stamps.changed(&listed));
    }

    /// A formula on the command line is no file, so its first list is empty.
    #[test]
    fn a_file_that_a_formula_named_is_told_of() {
        let folder = tempfile::tempdir().unwrap();
        let files = [folder.path().join("new.svg")];
        let mut stamps = Stamps::new();
        assert!(!stamps.changed(&[]));
        let made = fs::File::create(&files[0]).unwrap();
        let at = stamps.reported - Duration::from_millis(10);
        made.set_modified(at).unwrap();
        assert!(!stamps.changed(&files), "it may still be written");
        assert!(stamps.changed(&files));
        assert!(!stamps.changed(&files));
    }

    #[test]
    fn a_file_may_be_missing_for_a_moment() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("part.rhai");
        let files = [file.clone()];
        fs::write(&file, "x").unwrap();
        let mut stamps = Stamps::new();
        assert!(!stamps.changed(&files));
        fs::remove_file(&file).unwrap();
        for _ in 1..PATIENCE {
            assert!(!stamps.changed(&files));
        }
        assert!(stamps.changed(&files));
    }
}
