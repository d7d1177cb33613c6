//! The file that a command writes: complete, or not there at all.
//!
//! Guaranteed: the destination changes in one step, once everything is written.
//! Until then, and after an error, it is as it was. Not guaranteed: a
//! destination that is not a file, such as standard output, is written piece by
//! piece, and a process that is killed may leave a hidden file beside the
//! destination, `.isoslice-….tmp`. A process that is asked to end (Ctrl-C)
//! removes that file first: see [`discard_all`].

use super::closed;
use anyhow::{Context, bail};
use std::fs::{self, File};
use std::io::{self, BufWriter, Write, stdout};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use tempfile::NamedTempFile;

/// True if `path` stands for standard input or output.
pub(super) fn is_stream(path: &Path) -> bool {
    path.as_os_str() == "-"
}

/// Bytes that are written at a time. Files of tens of megabytes are common, and
/// each call to the system costs microseconds.
const BUFFER: usize = 1 << 18;

/// Names of half-written files, which are removed if the process ends.
static PENDING: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

fn pending() -> MutexGuard<'static, Vec<PathBuf>> {
    PENDING.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Removes half-written files, because the process is about to end. While the
/// result is held, no file is begun or put in its place.
pub(super) fn discard_all() -> MutexGuard<'static, Vec<PathBuf>> {
    let mut pending = pending();
    for path in pending.drain(..) {
        // Nobody can be told of a failure here.
        let _ = fs::remove_file(path);
    }
    pending
}

/// Output that is being written.
pub(super) enum Output {
    /// A file beside the destination, which is renamed at the end.
    Pending {
        writer: BufWriter<NamedTempFile>,
        destination: PathBuf,
        /// True if the file replaces another one at the destination.
        replaces: bool,
    },
    /// A stream that is written to directly.
    Stream(BufWriter<Box<dyn Write>>),
}

impl Output {
    /// Starts writing to `path`, which must be none of the `inputs`; `-` is
    /// standard output.
    pub(super) fn create(
        path: &Path,
        inputs: &[&Path],
    ) -> anyhow::Result<Self> {
        if is_stream(path) || closed::is_output(path) {
            closed::need_output()?;
        }
        if is_stream(path) {
            return Ok(Output::Stream(BufWriter::with_capacity(
                BUFFER,
                Box::new(stdout()),
            )));
        }
        if path.is_dir() {
            bail!(
                "the output {} is a folder; name a file in it, as in -o {}",
                path.display(),
                path.join("part.gcode").display()
            );
        }
        let is_link = fs::symlink_metadata(path).is_ok_and(|d| d.is_symlink());
        if is_link && fs::metadata(path).is_err() {
            bail!(
                "the output {} is a link that leads nowhere; remove it, or \
                 choose another name with -o",
                path.display()
            );
        }
        // If the destination is a link, the file that it points to is replaced.
        let destination =
            fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
        for input in inputs {
            if same_file(input, &destination) {
                bail!(
                    "the output {} is also an input and would be \
                     overwritten; choose another name with -o",
                    path.display()
                );
            }
        }
        let existing = fs::metadata(&destination).ok();
        let no_output = || format!("cannot write {}", path.display());
        if existing.as_ref().is_some_and(|data| !data.is_file()) {
            let file = File::options()
                .write(true)
                .open(&destination)
                .with_context(no_output)?;
            let file: Box<dyn Write> = Box::new(file);
            return Ok(Output::Stream(BufWriter::with_capacity(BUFFER, file)));
        }
        let folder = folder_of(&destination);
        if !folder.is_dir() {
            bail!(
                "cannot write {}: there is no folder {}; make it, or choose \
                 another with -o",
                path.display(),
                folder.display()
            );
        }
        let file = temporary_in(folder).with_context(no_output)?;
        if let Some(data) = existing {
            if data.permissions().readonly() {
                bail!(
                    "the output {} exists and is read-only; choose another \
                     name with -o",
                    path.display()
                );
            }
            file.as_file()
                .set_permissions(data.permissions())
                .with_context(no_output)?;
        }
        Ok(Output::Pending {
            writer: BufWriter::with_capacity(BUFFER, file),
            destination,
            replaces: true,
        })
    }

    /// Starts writing to `path`. No file may be there, neither now nor at the
    /// end.
    pub(super) fn create_new(path: &Path) -> anyhow::Result<Self> {
        if fs::symlink_metadata(path).is_ok() {
            bail!(
                "{} is already there, and is left as it is; choose another \
                 name",
                path.display()
            );
        }
        let file = temporary_in(folder_of(path))
            .with_context(|| format!("cannot write {}", path.display()))?;
        Ok(Output::Pending {
            writer: BufWriter::with_capacity(BUFFER, file),
            destination: path.to_owned(),
            replaces: false,
        })
    }

    /// True if the output is not a file, so that messages on standard output
    /// might get into it.
    pub(super) fn is_stream(&self) -> bool {
        matches!(self, Output::Stream(_))
    }

    /// Puts the finished output in its place.
    pub(super) fn finish(self) -> io::Result<()> {
        match self {
            Output::Stream(mut writer) => writer.flush(),
            Output::Pending {
                writer,
                destination,
                replaces,
            } => {
                let file = writer.into_inner().map_err(|e| e.into_error())?;
                // Some systems report a full disk only now. The contents must
                // also be on the disk before the name is.
                file.as_file().sync_all()?;
                let mut pending = pending();
                let path = file.path().to_owned();
                let done = if replaces {
                    file.persist(destination)
                } else {
                    file.persist_noclobber(destination)
                };
                pending.retain(|p| *p != path);
                done.map(drop).map_err(|e| e.error)
            }
        }
    }
}

impl Write for Output {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self {
            Output::Pending { writer, .. } => writer.write(bytes),
            Output::Stream(writer) => writer.write(bytes),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match self {
            Output::Pending { writer, .. } => writer.flush(),
            Output::Stream(writer) => writer.flush(),
        }
    }
}

/// Writes a command's result to standard output.
///
/// # Errors
/// If standard output is closed, or does not take all of the result.
pub(super) fn print(result: &[u8]) -> anyhow::Result<()> {
    closed::need_output()?;
    let mut out = stdout().lock();
    out.write_all(result)?;
    Ok(out.flush()?)
}

/// True if two names are names of one file, which may not exist yet. Links,
/// hard links and systems that ignore case are seen through.
pub(super) fn same_file(a: &Path, b: &Path) -> bool {
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

fn temporary_in(folder: &Path) -> io::Result<NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".isoslice-").suffix(".tmp");
    #[cfg(unix)]
    {
        // Temporary files are private by default. This one becomes the user's,
        // so it gets the permissions of any new file, which the umask limits.
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    let mut pending = pending();
    let file = builder.tempfile_in(folder)?;
    pending.push(file.path().to_owned());
    Ok(file)
}
