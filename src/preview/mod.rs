//! Pictures of what will be printed.
//!
//! `svg` draws a layer, `folder` keeps the pictures of a run together. `html`
//! makes a page to turn and look into from any G-code that [`crate::reader`]
//! reads: `toolpath` gathers its moves, `clock` times them, `pack` makes them
//! small.

mod clock;
mod folder;
mod html;
mod pack;
mod svg;
mod toolpath;

pub use folder::Pictures;
pub use html::write_html;
pub use svg::layer_svg;
pub use toolpath::{Share, Statistics, Toolpath};
