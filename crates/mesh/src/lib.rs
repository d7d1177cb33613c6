//! Meshes as functions of x, y and z: signed distances, bounds, plane sections.
//!
//! In: a file (STL, OBJ or PLY), of unknown origin, or triangles that another
//! crate collects. Out: a [`Mesh`], which
//! is [`isocontour::Data`]: a leaf of any expression.
//!
//! ```text
//!  part.stl ─ read ─▶ Triangles ─ Mesh::new ─▶ Mesh
//!                     │                        │
//!                     bounds, transform        at, value(s): how far, which way
//!                     (--size, --rotate)       range, slopes: bounds over a box
//!                                              section: rings at a height
//!
//!            ┌────────────┐        value = distance to the closest triangle,
//!            │      −2    │  +3            negative where the winding number
//!            │   ┌────────┼────┐           is above one half
//!            │   │   −1   │    │   Shells may cross or double one another, and
//!            └───┼────────┘    │   holes are closed: inside stays inside. The
//!                │        −1   │   closest triangle may be one in the body.
//!                └─────────────┘
//! ```
//!
//! ```
//! use glam::{DAffine3, DVec3};
//! use isocontour::Data;
//! use isoslice_mesh::{Format, Mesh, read};
//! use std::io::Cursor;
//!
//! # fn main() -> Result<(), isoslice_mesh::MeshError> {
//! let text = "v 0 0 0\nv 4 0 0\nv 0 4 0\nv 0 0 4\n\
//!             f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
//! let triangles = read(Cursor::new(text), Format::Obj)?;
//! let mesh = Mesh::new("mesh(\"corner.obj\")", triangles)?;
//! assert_eq!(mesh.facts().to_string(), "4 triangles");
//! assert_eq!(mesh.value(DVec3::new(1.0, 1.0, -2.0)), 2.0);
//! assert_eq!(mesh.value(DVec3::new(0.25, 1.0, 1.0)), -0.25);
//! let rings = mesh.section(&DAffine3::IDENTITY, 1.0).unwrap();
//! assert_eq!(rings[0].len(), 3);
//! # Ok(())
//! # }
//! ```
//!
//! | module | what it does |
//! |---|---|
//! | `read` | makes triangles of files, within bounds of time and memory |
//! | `merge` | makes one vertex of those at the same place |
//! | `tree`, `shell` | boxes around boxes around triangles |
//! | `closest`, `four` | the closest point of a triangle; bounds for four at a time |
//! | `repair` | turns, joins and closes triangles so that they bound a body |
//! | `loops`, `fill` | rims as loops, and triangles that fill them |
//! | `edges`, `rim`, `cover` | edges without a neighbour, and what covers openings |
//! | `ray`, `winding`, `sign` | inside or outside |
//! | `range`, `slopes` | bounds over boxes |
//! | `section` | exact plane sections |
//! | `lines` | where lines of sight cross the surface |
//! | `struts` | struts of lattices, which need no triangles |
//!
//! Guarantees:
//! - Distances are those to the closest triangle, exact but for roundings of f64.
//!   Signs of meshes without a rim are exact.
//! - Values depend on the place alone: not on the machine, the number of threads,
//!   or places that were asked for before.
//! - Bounds over boxes hold all values in them.
//! - Triangles that bound a body stay as they are. Others are repaired where that
//!   needs no guess, and `Facts` tells it.
//! - Sections have no tolerance. Where they are none, since only winding numbers
//!   tell what is inside, they say so.
//! - Files end in triangles or an error that says the place, what is wrong, and
//!   what to do.
//!
//! Not guaranteed: that a mesh of single, unconnected faces is closed where it
//! looks closed. Then winding numbers tell what is likely. A triangle that faces
//! the wrong way and has no neighbour stays as it is.

#![warn(unreachable_pub)]

mod closest;
mod cover;
mod edges;
mod error;
mod facets;
mod facts;
mod few;
mod fill;
mod four;
mod limits;
mod lines;
mod loops;
mod merge;
mod mesh;
mod range;
mod ray;
mod read;
mod repair;
mod rim;
mod section;
mod shell;
mod sign;
mod slopes;
mod struts;
#[cfg(test)]
mod tests;
mod tree;
mod triangles;
mod winding;

pub use error::MeshError;
pub use facts::Facts;
pub use limits::{MOST_STRUTS, MOST_TRIANGLES};
pub use mesh::Mesh;
pub use read::{Format, read};
pub use struts::{Cap, Strut, Struts};
pub use triangles::{Collector, Triangles};
