//! The files that models read, and the data made of them.
//!
//! In: the folder of the script or formula, and names in it. Out: expressions
//! that read the files' data.
//!
//! A file that has not changed is read once, as long as somebody uses it.

use super::folder::Folder;
use super::kinds::{Asked, Kind, Made, kind};
use super::lock;
use super::options::Options;
use fidget::context::Tree;
use isocontour::{Data, call};
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, Weak};
use std::time::{Duration, Instant, SystemTime};

/// The files that one model may read, and what it has read.
pub(crate) struct Files {
    folder: Folder,
    taken: Taken,
    /// An expression does not keep its data.
    kept: Mutex<Vec<Arc<dyn Data>>>,
    notes: Mutex<Vec<String>>,
}

/// What the reading of data took, which no script is blamed for.
#[derive(Clone, Default)]
pub(crate) struct Taken(Arc<[AtomicU64; 2]>);

impl Taken {
    /// The data's memory, in bytes.
    pub(crate) fn bytes(&self) -> u64 {
        self.0[0].load(Ordering::Relaxed)
    }

    /// The time that the reading took.
    pub(crate) fn time(&self) -> Duration {
        Duration::from_micros(self.0[1].load(Ordering::Relaxed))
    }

    fn add(&self, bytes: u64, time: Duration) {
        let time = u64::try_from(time.as_micros()).unwrap_or(u64::MAX);
        self.0[0].fetch_add(bytes, Ordering::Relaxed);
        self.0[1].fetch_add(time, Ordering::Relaxed);
    }
}

impl Default for Files {
    fn default() -> Files {
        Files::within(Path::new(""))
    }
}

impl Files {
    /// The files in a folder.
    pub(crate) fn within(folder: &Path) -> Files {
        Files::of(Folder::new(Some(folder)))
    }

    /// All files, for programs that have them anyway.
    pub(crate) fn anywhere() -> Files {
        Files::of(Folder::new(None))
    }

    fn of(folder: Folder) -> Files {
        Files {
            folder,
            taken: Taken::default(),
            kept: Mutex::default(),
            notes: Mutex::default(),
        }
    }

    /// What the reading took so far. It goes on counting.
    pub(crate) fn taken(&self) -> Taken {
        self.taken.clone()
    }

    /// The files that were read.
    pub(crate) fn read(&self) -> Vec<PathBuf> {
        self.folder.found()
    }

    /// What users should know of what was read, in sentences.
    pub(crate) fn notes(&self) -> Vec<String> {
        lock(&self.notes).clone()
    }

    /// What a function makes of a file, or of a text, as a function of x, y
    /// and z.
    ///
    /// # Errors
    /// In words, if it cannot be made, or the file may not be read.
    pub(crate) fn call(
        &self,
        kind: &Kind,
        text: &str,
        options: &Options,
    ) -> Result<Tree, String> {
        let path = if kind.of_file {
            self.folder.find(text)?
        } else {
            PathBuf::new()
        };
        self.made(kind, text, &path, options)
    }

    /// A mesh's file as a function of x, y and z.
    ///
    /// # Errors
    /// In words, if it cannot be read.
    pub(crate) fn mesh(&self, path: &Path) -> Result<Tree, String> {
        let kind = kind("mesh").ok_or("meshes are not known")?;
        let shown = path.file_name().unwrap_or_default().to_string_lossy();
        self.made(kind, &shown, path, &Options::new())
    }

    fn made(
        &self,
        kind: &Kind,
        text: &str,
        path: &Path,
        options: &Options,
    ) -> Result<Tree, String> {
        let begin = Instant::now();
        let asked = Asked {
            text,
            path,
            options,
            folder: &self.folder,
        };
        let Made { data, notes } = known_or_made(kind, &asked)?;
        self.taken.add(data.bytes() as u64, begin.elapsed());
        lock(&self.notes).extend(notes);
        let (x, y, z) = Tree::axes();
        let z = if data.is_flat() {
            Tree::constant(0.0)
        } else {
            z
        };
        let tree = call(&data, [x, y, z]);
        lock(&self.kept).push(data);
        Ok(tree)
    }
}

/// A version of a file, and what was asked of it.
#[derive(PartialEq)]
struct Version {
    asked: String,
    path: PathBuf,
    length: u64,
    changed: SystemTime,
}

/// Data in use, with the version of the file that it is from, and what users
/// should know of it.
struct Known {
    version: Version,
    data: Weak<dyn Data>,
    notes: Vec<String>,
}

/// What a function makes. What somebody uses is made once of a file that has
/// not changed.
fn known_or_made(kind: &Kind, asked: &Asked<'_>) -> Result<Made, String> {
    static KNOWN: Mutex<Vec<Known>> = Mutex::new(Vec::new());
    if !kind.of_file {
        let made = kind.make(asked);
        return made.map_err(|e| format!("{}: {e}", kind.name));
    }
    let path = asked.path;
    let failed = |e: &dyn std::fmt::Display| {
        format!("cannot read {}: {e}", path.display())
    };
    let facts = fs::metadata(path).map_err(|e| failed(&e))?;
    if !facts.is_file() {
        return Err(failed(&"it is not a file"));
    }
    let version = || {
        let all = (kind.name, asked.text, asked.options);
        Some(Version {
            asked: format!("{all:?}"),
            path: fs::canonicalize(path).ok()?,
            length: facts.len(),
            changed: facts.modified().ok()?,
        })
    };
    let version = version();
    let is_same = |known: &&Known| Some(&known.version) == version.as_ref();
    let same = lock(&KNOWN).iter().find(is_same).and_then(|known| {
        let notes = known.notes.clone();
        known.data.upgrade().map(|data| Made { data, notes })
    });
    if let Some(made) = same {
        return Ok(made);
    }
    let made = kind.make(asked).map_err(|e| failed(&e))?;
    if let Some(version) = version {
        let mut known = lock(&KNOWN);
        known.retain(|known| known.data.strong_count() > 0);
        known.push(Known {
            version,
            data: Arc::downgrade(&made.data),
            notes: made.notes.clone(),
        });
    }
    Ok(made)
}
