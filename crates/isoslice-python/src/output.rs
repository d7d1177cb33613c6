//! The output of G-code: a file, which is complete or not there at all, or
//! bytes.

use isoslice::files;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Output that is being written.
pub(crate) enum Output {
    Bytes(Vec<u8>),
    File(files::Output, PathBuf),
}

/// Output that is complete.
pub(crate) enum Written {
    Bytes(Vec<u8>),
    File(PathBuf),
    /// A pipe or a device, which cannot be read again.
    Stream(PathBuf),
}

impl Output {
    /// Starts writing to a file, which must be none of the `inputs`, or to
    /// bytes without a file.
    pub(crate) fn create(
        path: Option<PathBuf>,
        inputs: &[&Path],
    ) -> anyhow::Result<Output> {
        Ok(match path {
            None => Output::Bytes(Vec::new()),
            Some(path) => {
                Output::File(files::Output::create(&path, inputs)?, path)
            }
        })
    }

    /// Puts the finished output in its place.
    pub(crate) fn finish(self) -> anyhow::Result<Written> {
        match self {
            Output::Bytes(bytes) => Ok(Written::Bytes(bytes)),
            Output::File(file, path) => {
                let is_stream = file.is_stream();
                file.finish()?;
                Ok(if is_stream {
                    Written::Stream(path)
                } else {
                    Written::File(path)
                })
            }
        }
    }
}

impl Write for Output {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self {
            Output::Bytes(all) => all.write(bytes),
            Output::File(file, _) => file.write(bytes),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match self {
            Output::Bytes(_) => Ok(()),
            Output::File(file, _) => file.flush(),
        }
    }
}
