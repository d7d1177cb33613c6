//! Meshes as functions.

#![warn(unreachable_pub)]

mod caps;
mod closest;
mod error;
mod facts;
mod four;
mod limits;
mod mend;
mod merge;
mod mesh;
mod range;
mod ray;
mod read;
mod rim;
mod section;
mod shell;
mod sign;
#[cfg(test)]
mod tests;
mod tree;
mod triangles;
mod winding;

pub use error::MeshError;
pub use facts::Facts;
pub use limits::MOST_TRIANGLES;
pub use mesh::Mesh;
pub use read::{Format, read};
pub use triangles::Triangles;
