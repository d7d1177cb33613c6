//! Meshes as functions.

#![warn(unreachable_pub)]

mod closest;
mod cover;
mod edges;
mod error;
mod facts;
mod four;
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
#[cfg(test)]
mod tests;
mod tree;
mod triangles;
mod winding;

pub use error::MeshError;
pub use facts::Facts;
pub use mesh::Mesh;
pub use read::{Format, read};
pub use triangles::{MOST_TRIANGLES, Triangles};
