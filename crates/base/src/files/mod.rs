//! Reads what users name: a file, a pipe, a device, a folder. `output` writes
//! files.
//!
//! In: a path, and the greatest length of such a file. Out: the file's bytes or
//! text. Guaranteed: reading takes no more memory than that length, and a pipe
//! that nobody writes to does not outlast the run's time limit.

mod output;

pub use output::{Output, OutputError, beginning_in};

use crate::encoding::{self, NotText};
use crate::limits;
use crate::units::human_bytes;
use std::fs::{self, File};
use std::io::{self, Read};
use std::path::Path;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread;
use std::time::Duration;

/// Greatest length of a settings file, profile or script, bytes. The longest in
/// use have some 10 kB.
pub const MAX_SETTINGS_BYTES: u64 = 1 << 20;

/// Time between checks of the limits while a pipe is waited for.
const EVERY: Duration = Duration::from_millis(20);

/// Why a file cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum FileError {
    /// The system refuses to read the file.
    #[error(transparent)]
    System(#[from] io::Error),
    /// The file is too large.
    #[error("it is larger than {}", human_bytes(*.most))]
    TooLarge {
        /// The limit, bytes.
        most: u64,
    },
    /// The file is not text.
    #[error(transparent)]
    NotText(#[from] NotText),
}

/// The bytes of a file, which may have at most `most` of them.
///
/// # Errors
/// If the file cannot be read, or is larger.
pub fn read(path: &Path, most: u64) -> Result<Vec<u8>, FileError> {
    let bytes = if fs::metadata(path)?.is_file() {
        up_to(File::open(path)?, most)?
    } else {
        // Opening a pipe waits for somebody to write to it.
        let path = path.to_owned();
        waiting(move || up_to(File::open(path)?, most))?
    };
    within(bytes, most)
}

/// Does what [`read_text`] does, for standard input.
///
/// # Errors
/// Those of [`read_text`].
pub fn read_standard_input(most: u64) -> Result<String, FileError> {
    let bytes = waiting(move || up_to(io::stdin().lock(), most))?;
    text(&within(bytes, most)?)
}

/// Does what [`read`] does, and returns the bytes as text.
///
/// # Errors
/// Those of [`read`], and an error if the bytes are not UTF-8.
pub fn read_text(path: &Path, most: u64) -> Result<String, FileError> {
    text(&read(path, most)?)
}

/// Bytes as text.
fn text(bytes: &[u8]) -> Result<String, FileError> {
    Ok(encoding::text(bytes)?.to_owned())
}

/// Reads at most one byte more than `most`. The size of a file is not asked
/// for, since pipes and devices have none.
fn up_to(source: impl Read, most: u64) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    source.take(most + 1).read_to_end(&mut bytes)?;
    Ok(bytes)
}

fn within(bytes: Vec<u8>, most: u64) -> Result<Vec<u8>, FileError> {
    if bytes.len() as u64 > most {
        Err(FileError::TooLarge { most })
    } else {
        Ok(bytes)
    }
}

/// Reads on a thread of its own, since reading may have to wait. If the run is
/// stopped, the thread is abandoned.
fn waiting(
    read: impl FnOnce() -> io::Result<Vec<u8>> + Send + 'static,
) -> io::Result<Vec<u8>> {
    let (sender, receiver) = channel();
    let reading = thread::Builder::new().name("reading".into());
    reading.spawn(move || {
        // If the run was stopped, nobody receives the result.
        let _ = sender.send(read());
    })?;
    loop {
        match receiver.recv_timeout(EVERY) {
            Ok(result) => return result,
            Err(RecvTimeoutError::Timeout) => limits::io_goes_on()?,
            Err(RecvTimeoutError::Disconnected) => {
                return Err(io::Error::other("reading it failed"));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_read_up_to_their_limit() {
        let file = tempfile::NamedTempFile::new().unwrap();
        fs::write(file.path(), b"a\nb\n\xff").unwrap();
        assert_eq!(read(file.path(), 5).unwrap().len(), 5);
        let error = read(file.path(), 4).unwrap_err();
        assert!(matches!(error, FileError::TooLarge { most: 4 }));
        assert_eq!(error.to_string(), "it is larger than 4 bytes");
        let error = read_text(file.path(), 5).unwrap_err();
        assert!(matches!(error, FileError::NotText(NotText::Line(3))));
        let folder = std::env::temp_dir();
        let error = read(&folder, 5).unwrap_err();
        assert!(matches!(error, FileError::System(_)));
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn devices_without_end_take_no_memory() {
        let error = read(Path::new("/dev/zero"), 1 << 20).unwrap_err();
        assert_eq!(error.to_string(), "it is larger than 1 MB");
        assert_eq!(read(Path::new("/dev/null"), 1 << 20).unwrap(), b"");
    }
}
