//! Pictures of what will be printed.
//!
//! `svg` draws a layer, `folder` keeps the pictures of a run together.

mod folder;
mod svg;

pub use folder::Pictures;
pub use svg::layer_svg;
