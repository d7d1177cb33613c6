//! What is wrong with a file.

use std::path::PathBuf;

/// Why a file cannot be read as profiles.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The system refuses it.
    #[error("cannot read {path}: {cause}", path = .path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// Why.
        cause: std::io::Error,
    },
    /// It is no profile, or a damaged one.
    #[error("{path}: {message}", path = .path.display())]
    NotUnderstood {
        /// The file.
        path: PathBuf,
        /// What is wrong, and what to do.
        message: String,
    },
    /// The file has several profiles, or none of that name.
    #[error("{path}: {message}", path = .path.display())]
    Choose {
        /// The file.
        path: PathBuf,
        /// What there is to choose from.
        message: String,
    },
}
