//! Reads meshes from files.

mod obj;
mod ply;
mod polygon;
mod stl;
#[cfg(test)]
mod tests;
mod words;

use crate::error::MeshError;
use crate::triangles::Triangles;
use std::io::{Read, Seek, SeekFrom};

/// A format of files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Triangles, as text or binary.
    Stl,
    /// Wavefront's text of vertices and faces.
    Obj,
    /// Stanford's list of vertices and faces, as text or binary.
    Ply,
}

impl Format {
    /// The format of files whose names end so, without the dot: `stl`, `OBJ`.
    pub fn of_extension(extension: &str) -> Option<Format> {
        match extension.to_ascii_lowercase().as_str() {
            "stl" => Some(Format::Stl),
            "obj" => Some(Format::Obj),
            "ply" => Some(Format::Ply),
            _ => None,
        }
    }
}

/// Reads a mesh from a file, or from bytes in a [`std::io::Cursor`]. The file is
/// read piece by piece, and never held as a whole.
///
/// # Errors
/// If it cannot be read, or holds no mesh of that format.
pub fn read(
    mut source: impl Read + Seek,
    format: Format,
) -> Result<Triangles, MeshError> {
    let length = source.seek(SeekFrom::End(0))?;
    source.rewind()?;
    match format {
        Format::Stl => stl::read(source, length),
        Format::Obj => obj::read(source),
        Format::Ply => ply::read(source),
    }
}
