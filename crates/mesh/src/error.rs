//! Why a file holds no mesh.

use std::io;

/// Why a mesh cannot be read or used.
///
/// Each says the place in the file, what is wrong, and what to do.
#[derive(Debug, thiserror::Error)]
pub enum MeshError {
    /// The system refuses to read the file.
    #[error(transparent)]
    System(#[from] io::Error),
    /// The work was stopped from outside.
    #[error(transparent)]
    Cancelled(#[from] isocontour::Cancelled),
    /// Something in the file is not as it should be.
    #[error("{at}: {what}")]
    Wrong {
        /// The place, such as "line 12" or "triangle 7".
        at: String,
        /// What is wrong there, and what to do.
        what: String,
    },
    /// The whole file is not what it should be.
    #[error("{0}")]
    File(String),
    /// There are no triangles.
    #[error(
        "it holds no triangles; export the part as a mesh of triangles (STL, \
         OBJ, PLY or 3MF)"
    )]
    Empty,
    /// There are too many triangles.
    #[error(
        "it has more than {} million triangles; reduce it in the program that \
         made it",
        crate::limits::MOST_TRIANGLES / 1_000_000
    )]
    TooMany,
    /// There are too many struts.
    #[error(
        "it has more than {} million beams; cut it into parts",
        crate::limits::MOST_STRUTS / 1_000_000
    )]
    TooManyStruts,
}

impl MeshError {
    /// What is wrong at a place.
    pub fn at(
        place: impl std::fmt::Display,
        what: impl Into<String>,
    ) -> MeshError {
        MeshError::Wrong {
            at: place.to_string(),
            what: what.into(),
        }
    }

    /// The same error, of a part of the file that is named.
    pub fn within(self, place: &str) -> MeshError {
        match self {
            MeshError::Wrong { at, what } => {
                MeshError::at(format_args!("{place}, {at}"), what)
            }
            MeshError::File(what) => MeshError::at(place, what),
            other => other,
        }
    }
}
