//! Why a function cannot be a 3MF file.

use crate::functions::graph::MOST_NODES;
use crate::model::MOST_SHAPES;
use crate::package::MOST_FILES;
use isocontour::{Cancelled, ExpandError};
use std::io;

/// Why a function cannot be written as a 3MF file.
#[derive(Debug, thiserror::Error)]
pub enum ExportError {
    /// The expression is too large for any use.
    #[error(transparent)]
    Expand(#[from] ExpandError),
    /// The work was stopped from outside.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// The archive cannot be made.
    #[error(transparent)]
    Archive(#[from] io::Error),
    /// The expression is larger than what is read again.
    #[error(
        "it takes more than {MOST_NODES} nodes, and no larger function of a 3MF \
         file is read; repeat shapes with `%` (modulo) or `abs` of a coordinate \
         instead of copies"
    )]
    TooLarge,
    /// There is an operation that functions of 3MF files cannot express.
    #[error(
        "it calls rand, which mixes the bits of a number: 3MF has no node for \
         that; put a formula in its place, such as \
         fract(sin(12.9898 * x + 78.233 * y) * 43758.5453)"
    )]
    Random,
    /// There is a constant that files cannot hold.
    #[error(
        "one of its numbers is {0}, and those of 3MF are finite; look for a \
         division by zero"
    )]
    NotFinite(f32),
    /// There is data for which there is no node.
    #[error(
        "it reads {0}, and functions of 3MF files have nodes for meshes, \
         pictures and volumes only; leave it out, or put a formula or a mesh in \
         its place"
    )]
    Data(String),
    /// A picture or a volume is of a kind for which there is no stack.
    #[error("it reads {0}, which {1}")]
    Picture(String, &'static str),
    /// There are too many meshes, pictures and volumes.
    #[error(
        "it has more than {0} meshes, pictures and volumes, and no function of a \
         3MF file with more is read; join them in the program that made them"
    )]
    TooMuchData(usize),
    /// The sheets of pictures and volumes are more than what is read again.
    #[error(
        "its pictures and volumes take more than {MOST_FILES} files, a thousand \
         million samples together, or 256 MB for one sheet, and no 3MF file with \
         more is read; scale them down"
    )]
    TooManySheets,
    /// The meshes are larger than what is read again.
    #[error(
        "its meshes have more than {} million vertices and triangles together, \
         and no 3MF file with more is read; reduce them in the program that \
         made them",
        MOST_SHAPES / 1_000_000
    )]
    TooManyShapes,
}
