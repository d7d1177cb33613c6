//! 3MF files as functions of x, y and z, and functions as 3MF files.
//!
//! In: an archive, of unknown origin. Out: a [`Body`], an expression that is
//! negative inside what is to be built. [`write`](fn@write) goes the other way.
//!
//! ```text
//!  build: item ── transform ──▶ object ── component, transform ──▶ object
//!                                                                  │
//!              mesh: vertices, triangles, beams  ◀─────────────────┘
//!
//!  body = min(mesh of all triangles, struts of all beams,
//!             max(struts that are clipped, ± their mesh), …,
//!             max(function, mesh around it), …)
//! ```
//!
//! | module | what it does |
//! |---|---|
//! | `package` | the archive, unpacked piece by piece |
//! | `relations` | which files of the archive belong to which |
//! | `xml`, `space` | elements, and where their names are from |
//! | `marks` | what slicers say is no part of the body |
//! | `model` | objects, and what is to be built of them |
//! | `sound`, `materials` | what a file has to have, though the body does not need it |
//! | `lattice` | beam lattices |
//! | `functions` | functions of nodes and of stacks of pictures |
//! | `level` | objects that are where a function is below zero |
//! | `leaves` | meshes and stacks that functions ask for |
//! | `transform` | transforms, as files write them |
//! | `collect` | triangles of objects |
//! | `build` | places all that is to be built |
//! | `body` | makes one function of what was placed |
//! | `write` | writes a function as a file |
//!
//! Read are the core specification, the production extension, by which objects
//! are in other files of the archive, beam lattices with their balls, and level
//! sets of the volumetric and implicit extensions.
//! Projects of PrusaSlicer, OrcaSlicer, Bambu Studio and Cura hold more than the
//! body: what they call modifiers, negative volumes and supports is left out.
//!
//! Guaranteed: files in the archive are unpacked piece by piece, and
//! bounded in length; objects that hold one another end in an error.

#![warn(unreachable_pub)]

mod body;
mod build;
mod collect;
mod functions;
mod lattice;
mod leaves;
mod level;
mod marks;
mod materials;
mod model;
mod package;
mod relations;
mod sound;
mod space;
#[cfg(test)]
mod tests;
mod transform;
mod write;
mod xml;

pub use body::Body;
pub use isoslice_mesh::MeshError;
pub use write::{ExportError, Part, write};

use std::io::{Read, Seek};

/// Reads what is to be built of a 3MF file. `name` is how messages call it, such
/// as `mesh("part.3mf")`.
///
/// # Errors
/// If it cannot be read, or nothing is to be built in it.
pub fn read(
    name: &str,
    mut source: impl Read + Seek,
) -> Result<Body, MeshError> {
    source.rewind()?;
    body::of(name, build::read(name, source)?)
}
