//! Pictures of what will be printed.
//!
//! `picture` draws the part itself: `raster` finds what of its field is seen,
//! `shade` lights it, `image` is what comes of it.
//! `svg` draws a layer, `folder` keeps the pictures of a run together. `html`
//! makes a page to turn and look into from any G-code that [`crate::reader`]
//! reads: `toolpath` gathers its moves and their times, `pack` makes them
//! small.

mod folder;
mod html;
mod image;
mod pack;
mod picture;
mod raster;
mod shade;
mod svg;
mod toolpath;

pub use folder::Pictures;
pub use html::write_html;
pub use image::Picture;
pub use picture::{draw, thumbnails};
pub use raster::{PictureError, View, outline_from_above};
pub use svg::layer_svg;
pub use toolpath::{Share, Statistics, Toolpath};
