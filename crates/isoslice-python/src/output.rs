//! What G-code is written to: a file, which is complete or not there at all, or
//! bytes.

use anyhow::{Context, bail};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

/// Bytes that are written at a time.
const BUFFER: usize = 1 << 18;

/// Output that is being written.
pub(crate) enum Output {
    Bytes(Vec<u8>),
    /// A file beside the destination, which gets its name at the end.
    File {
        writer: BufWriter<NamedTempFile>,
        destination: PathBuf,
    },
}

/// Output that is complete.
pub(crate) enum Written {
    Bytes(Vec<u8>),
    File(PathBuf),
}

impl Output {
    /// Starts writing to a file, or to bytes without a file.
    pub(crate) fn create(path: Option<&Path>) -> anyhow::Result<Output> {
        let Some(path) = path else {
            return Ok(Output::Bytes(Vec::new()));
        };
        if path.is_dir() {
            bail!(
                "the output {} is a folder; name a file in it, as in -o {}",
                path.display(),
                path.join("part.gcode").display()
            );
        }
        // If the destination is a link, the file that it points to is replaced.
        let destination =
            path.canonicalize().unwrap_or_else(|_| path.to_owned());
        let folder = match destination.parent() {
            Some(folder) if folder != Path::new("") => folder,
            _ => Path::new("."),
        };
        if !folder.is_dir() {
            bail!(
                "cannot write {}: there is no folder {}; make it, or choose \
                 another with -o",
                path.display(),
                folder.display()
            );
        }
        let no_output = || format!("cannot write {}", path.display());
        let mut builder = tempfile::Builder::new();
        builder.prefix(".isoslice-").suffix(".tmp");
        #[cfg(unix)]
        {
            // Temporary files are private by default, and this one becomes the
            // user's.
            use std::os::unix::fs::PermissionsExt;
            builder.permissions(std::fs::Permissions::from_mode(0o666));
        }
        let file = builder.tempfile_in(folder).with_context(no_output)?;
        if let Ok(data) = destination.metadata() {
            if data.permissions().readonly() {
                bail!(
                    "the output {} exists and is read-only; choose another \
                     name with -o",
                    path.display()
                );
            }
            let file = file.as_file();
            let given = file.set_permissions(data.permissions());
            given.with_context(no_output)?;
        }
        Ok(Output::File {
            writer: BufWriter::with_capacity(BUFFER, file),
            destination,
        })
    }

    /// Puts the finished output in its place.
    pub(crate) fn finish(self) -> anyhow::Result<Written> {
        match self {
            Output::Bytes(bytes) => Ok(Written::Bytes(bytes)),
            Output::File {
                writer,
                destination,
            } => {
                let done = || -> io::Result<()> {
                    let file =
                        writer.into_inner().map_err(|e| e.into_error())?;
                    // The contents must be on the disk before the name is.
                    file.as_file().sync_all()?;
                    file.persist(&destination).map_err(|e| e.error)?;
                    Ok(())
                };
                done().with_context(|| {
                    format!("cannot write {}", destination.display())
                })?;
                Ok(Written::File(destination))
            }
        }
    }
}

impl Write for Output {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self {
            Output::Bytes(all) => all.write(bytes),
            Output::File { writer, .. } => writer.write(bytes),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match self {
            Output::Bytes(_) => Ok(()),
            Output::File { writer, .. } => writer.flush(),
        }
    }
}
