//! A file that is being written: complete, or not there at all.
//!
//! Guaranteed: the destination changes in one step, once everything is written.
//! Until then, and after an error, it is as it was. Not guaranteed: a
//! destination that is not a file, such as a pipe, is written piece by piece,
//! and a process that is killed may leave a hidden file beside the destination,
//! `.isoslice-….tmp`. A process that is asked to end removes that file first:
//! see [`Output::discard_all`].

use crate::limits;
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use tempfile::NamedTempFile;

/// Bytes that are written at a time. Files of tens of megabytes are common, and
/// each call to the system costs microseconds.
const BUFFER: usize = 1 << 18;

/// Names of half-written files, which are removed if the process ends.
static PENDING: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

fn pending() -> MutexGuard<'static, Vec<PathBuf>> {
    PENDING.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Why a file cannot be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum OutputError {
    /// The name is a folder's.
    #[error(
        "the output {} is a folder; name a file in it, as in {}",
        .0.display(),
        .0.join("part.gcode").display()
    )]
    Folder(PathBuf),
    /// The name is a link's that leads nowhere.
    #[error(
        "the output {} is a link that leads nowhere; remove it, or choose \
         another name",
        .0.display()
    )]
    DeadLink(PathBuf),
    /// The file is an input, too.
    #[error(
        "the output {} is also an input and would be overwritten; choose \
         another name",
        .0.display()
    )]
    Input(PathBuf),
    /// The file's folder does not exist.
    #[error(
        "cannot write {}: there is no folder {}; make it, or choose another",
        path.display(),
        folder.display()
    )]
    NoFolder {
        /// The file.
        path: PathBuf,
        /// The folder.
        folder: PathBuf,
    },
    /// The file may not be replaced.
    #[error(
        "the output {} exists and is read-only; choose another name",
        .0.display()
    )]
    ReadOnly(PathBuf),
    /// A new file is wanted, and there is one already.
    #[error(
        "{} is already there, and is left as it is; choose another name",
        .0.display()
    )]
    Exists(PathBuf),
    /// The system refuses.
    #[error("cannot write {}", path.display())]
    System {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
}

/// Output that is being written.
pub struct Output {
    kind: OutputKind,
    /// The output's name in errors.
    path: PathBuf,
}

enum OutputKind {
    /// A file beside the destination, which is renamed at the end.
    Pending {
        writer: BufWriter<NamedTempFile>,
        listed: Listed,
        destination: PathBuf,
        /// True if the file replaces another one at the destination.
        replaces: bool,
    },
    /// A stream that is written to directly.
    Stream(BufWriter<Box<dyn Write + Send>>),
}

/// The name of a half-written file, in the list of them.
struct Listed(PathBuf);

impl Drop for Listed {
    fn drop(&mut self) {
        pending().retain(|path| *path != self.0);
    }
}

impl Output {
    /// Starts writing to `path`, which must be none of the `inputs`.
    ///
    /// # Errors
    /// If nothing can be written there.
    pub fn create(path: &Path, inputs: &[&Path]) -> Result<Self, OutputError> {
        let this = || path.to_owned();
        if path.is_dir() {
            return Err(OutputError::Folder(this()));
        }
        let is_link = fs::symlink_metadata(path).is_ok_and(|d| d.is_symlink());
        if is_link && fs::metadata(path).is_err() {
            return Err(OutputError::DeadLink(this()));
        }
        // If the destination is a link, the file that it points to is replaced.
        let destination =
            fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
        if inputs.iter().any(|input| same_file(input, &destination)) {
            return Err(OutputError::Input(this()));
        }
        let existing = fs::metadata(&destination).ok();
        let system = |source| OutputError::System {
            path: path.to_owned(),
            source,
        };
        if existing.as_ref().is_some_and(|data| !data.is_file()) {
            let file = File::options()
                .write(true)
                .open(&destination)
                .map_err(system)?;
            return Ok(Output::stream(path, file));
        }
        let folder = folder_of(&destination);
        if !folder.is_dir() {
            return Err(OutputError::NoFolder {
                path: this(),
                folder: folder.to_owned(),
            });
        }
        let (file, listed) = temporary_in(folder).map_err(system)?;
        if let Some(data) = existing {
            if data.permissions().readonly() {
                return Err(OutputError::ReadOnly(this()));
            }
            file.as_file()
                .set_permissions(data.permissions())
                .map_err(system)?;
        }
        let kind = OutputKind::Pending {
            writer: BufWriter::with_capacity(BUFFER, file),
            listed,
            destination,
            replaces: true,
        };
        let path = path.to_owned();
        Ok(Output { kind, path })
    }

    /// Starts writing to `path`. No file may be there, neither now nor at the
    /// end.
    ///
    /// # Errors
    /// If there is one, or nothing can be written there.
    pub fn create_new(path: &Path) -> Result<Self, OutputError> {
        let path = path.to_owned();
        if fs::symlink_metadata(&path).is_ok() {
            return Err(OutputError::Exists(path));
        }
        let folder = folder_of(&path);
        if !folder.is_dir() {
            let folder = folder.to_owned();
            return Err(OutputError::NoFolder { path, folder });
        }
        match temporary_in(folder) {
            Ok((file, listed)) => {
                let kind = OutputKind::Pending {
                    writer: BufWriter::with_capacity(BUFFER, file),
                    listed,
                    destination: path.clone(),
                    replaces: false,
                };
                Ok(Output { kind, path })
            }
            Err(source) => Err(OutputError::System { path, source }),
        }
    }

    /// Output to a stream, which gets it piece by piece. Errors call it `path`.
    pub fn stream(path: &Path, to: impl Write + Send + 'static) -> Self {
        let to: Box<dyn Write + Send> = Box::new(to);
        Output {
            kind: OutputKind::Stream(BufWriter::with_capacity(BUFFER, to)),
            path: path.to_owned(),
        }
    }

    /// Removes half-written files, because the process is about to end. While
    /// the result is held, no file is begun or put in its place.
    pub fn discard_all() -> MutexGuard<'static, Vec<PathBuf>> {
        let mut pending = pending();
        for path in pending.drain(..) {
            // Nobody can be told of a failure here.
            let _ = fs::remove_file(path);
        }
        pending
    }

    /// True if `path` names the file that this output is to become.
    pub fn is_at(&self, path: &Path) -> bool {
        same_file(&self.path, path)
    }

    /// True if the output is not a file, so that messages on standard output
    /// might get into it.
    pub fn is_stream(&self) -> bool {
        matches!(self.kind, OutputKind::Stream(_))
    }

    /// Writes bytes, all the way to the system.
    ///
    /// # Errors
    /// If the system refuses.
    pub fn put(&mut self, bytes: &[u8]) -> Result<(), OutputError> {
        let put = self.write_all(bytes).and_then(|()| self.flush());
        put.map_err(|source| OutputError::System {
            path: self.path.clone(),
            source,
        })
    }

    /// Puts the finished output in its place.
    ///
    /// # Errors
    /// If the system refuses. The destination is then as it was.
    pub fn finish(self) -> Result<(), OutputError> {
        let Output { kind, path } = self;
        kind.finish()
            .map_err(|source| OutputError::System { path, source })
    }
}

impl OutputKind {
    fn finish(self) -> io::Result<()> {
        match self {
            OutputKind::Stream(mut writer) => writer.flush(),
            OutputKind::Pending {
                writer,
                listed,
                destination,
                replaces,
            } => {
                // What stopped work has written is not whole.
                limits::io_goes_on()?;
                let file = writer.into_inner().map_err(|e| e.into_error())?;
                // Some systems report a full disk only now. The contents must
                // also be on the disk before the name is.
                file.as_file().sync_all()?;
                // No process that is about to end removes the file any more.
                let pending = pending();
                let done = if replaces {
                    file.persist(destination)
                } else {
                    file.persist_noclobber(destination)
                };
                drop(pending);
                drop(listed);
                done.map(drop).map_err(|e| e.error)
            }
        }
    }
}

impl Write for Output {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match &mut self.kind {
            OutputKind::Pending { writer, .. } => writer.write(bytes),
            OutputKind::Stream(writer) => writer.write(bytes),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match &mut self.kind {
            OutputKind::Pending { writer, .. } => writer.flush(),
            OutputKind::Stream(writer) => writer.flush(),
        }
    }
}

/// True if two names are names of one file, which may not exist yet. Links,
/// hard links and systems that ignore case are seen through.
pub(crate) fn same_file(a: &Path, b: &Path) -> bool {
    let is_file = |path: &Path| fs::metadata(path).is_ok_and(|d| d.is_file());
    if is_file(a) && is_file(b) {
        return ::same_file::is_same_file(a, b).unwrap_or(a == b);
    }
    let resolved = |path: &Path| {
        fs::canonicalize(path).or_else(|_| {
            let name = path.file_name().unwrap_or_default();
            fs::canonicalize(folder_of(path)).map(|folder| folder.join(name))
        })
    };
    match (resolved(a), resolved(b)) {
        (Ok(a), Ok(b)) => a == b,
        _ => a == b,
    }
}

/// The folder that a file of this name is in.
fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    }
}

/// A file that is to take the place of another one in a folder.
///
/// # Errors
/// If it cannot be made.
pub fn beginning_in(folder: &Path) -> io::Result<NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".isoslice-").suffix(".tmp");
    #[cfg(unix)]
    {
        // Temporary files are private by default. This one becomes the user's,
        // so it gets the permissions of any new file, which the umask limits.
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    builder.tempfile_in(folder)
}

fn temporary_in(folder: &Path) -> io::Result<(NamedTempFile, Listed)> {
    let mut pending = pending();
    let file = beginning_in(folder)?;
    let listed = Listed(file.path().to_owned());
    pending.push(listed.0.clone());
    Ok((file, listed))
}
