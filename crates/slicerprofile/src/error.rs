//! What is wrong with a file.

use std::path::{Path, PathBuf};

/// Why a file cannot be read as profiles.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The system refuses to read the file.
    #[error("cannot read {path}, check its name: {cause}", path = .path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        cause: std::io::Error,
    },
    /// The file is not a profile, or a damaged one.
    #[error("{path}: {message}", path = .path.display())]
    NotUnderstood {
        /// The file.
        path: PathBuf,
        /// What is wrong, and what to do.
        message: String,
    },
    /// The file has several profiles, or none of the name that was given.
    #[error("{path}: {message}", path = .path.display())]
    Choose {
        /// The file.
        path: PathBuf,
        /// The profiles to choose from.
        message: String,
    },
}

impl Error {
    /// A file that the system refuses to read, by the system's reason.
    pub(crate) fn unreadable(
        path: &Path,
    ) -> impl Fn(std::io::Error) -> Error + Copy {
        move |cause| Error::Unreadable {
            path: path.to_owned(),
            cause,
        }
    }

    /// A file that is not understood, by what is wrong with it.
    pub(crate) fn wrong(path: &Path) -> impl Fn(String) -> Error + Copy {
        move |message| Error::NotUnderstood {
            path: path.to_owned(),
            message,
        }
    }
}
