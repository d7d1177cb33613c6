//! The files that a model may read: those in its own folder and below it.
//!
//! There are no absolute paths, no `..`, and no links that lead out.

use super::lock;
use isoslice_base::files;
use std::collections::BTreeSet;
use std::fs;
use std::path::{Component, Path, PathBuf};
use std::sync::Mutex;

/// Greatest number of files of a model, those that are not there included.
const MOST_FILES: usize = 1000;

/// A folder, and what was found in it.
pub(super) struct Folder {
    /// None: any file may be read.
    path: Option<PathBuf>,
    found: Mutex<BTreeSet<PathBuf>>,
}

impl Folder {
    /// A folder; the current one has no name. Without one all files may be
    /// read.
    pub(super) fn new(path: Option<&Path>) -> Folder {
        let named = |path: &Path| {
            let here = path.as_os_str().is_empty();
            if here { ".".into() } else { path.into() }
        };
        Folder {
            path: path.map(named),
            found: Mutex::default(),
        }
    }

    /// The files that were found.
    pub(super) fn found(&self) -> Vec<PathBuf> {
        lock(&self.found).iter().cloned().collect()
    }

    /// The path of a file that may be read.
    pub(super) fn find(&self, name: &str) -> Result<PathBuf, String> {
        let Some(folder) = &self.path else {
            return Ok(name.into());
        };
        let shown = name.escape_default();
        let is_plain = Path::new(name)
            .components()
            .all(|c| matches!(c, Component::Normal(_)));
        if name.is_empty() || !is_plain {
            return Err(format!(
                "\"{shown}\" is not the name of a file in the model's own \
                 folder; a model reads only what lies there or in folders \
                 below, as in \"part.stl\" or \"parts/part.stl\""
            ));
        }
        let path = folder.join(name);
        self.note(&path)?;
        let absent =
            |e: std::io::Error| format!("cannot read {}: {e}", path.display());
        let real = fs::canonicalize(&path).map_err(absent)?;
        let folder = fs::canonicalize(folder).map_err(absent)?;
        if !real.starts_with(folder) {
            return Err(format!(
                "{} is a link that leads out of the model's folder; copy the \
                 file there",
                path.display()
            ));
        }
        Ok(path)
    }

    /// Notes a path. What is not there may appear, and whoever watches waits
    /// for that.
    fn note(&self, path: &Path) -> Result<(), String> {
        let mut found = lock(&self.found);
        if found.contains(path) {
            return Ok(());
        }
        if found.len() >= MOST_FILES {
            return Err(format!(
                "{}: a model reads {MOST_FILES} files at most",
                path.display()
            ));
        }
        found.insert(path.to_owned());
        Ok(())
    }

    /// The bytes of a file, at most so many.
    pub(super) fn bytes(path: &Path, most: u64) -> Result<Vec<u8>, String> {
        files::read(path, most).map_err(|e| e.to_string())
    }
}
