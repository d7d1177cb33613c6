//! Tells whether a file has changed.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// A version of a file.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) struct FileVersion {
    path: PathBuf,
    length: u64,
    changed: SystemTime,
}

impl FileVersion {
    /// None if the system does not tell when the file was changed.
    pub(super) fn of(path: &Path) -> Result<Option<FileVersion>, String> {
        let failed = |e: &dyn std::fmt::Display| {
            format!("cannot read {}: {e}", path.display())
        };
        let facts = fs::metadata(path).map_err(|e| failed(&e))?;
        if !facts.is_file() {
            return Err(failed(&"it is not a file"));
        }
        let version = || {
            Some(FileVersion {
                path: fs::canonicalize(path).ok()?,
                length: facts.len(),
                changed: facts.modified().ok()?,
            })
        };
        Ok(version())
    }
}
