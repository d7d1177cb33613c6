//! Pictures of what will be printed.
//!
//! `svg` draws a layer, `folder` keeps the pictures of a run together.
//! `picture` draws the part itself: `raster` finds what of its field is seen,
//! `shade` lights it, `image` is what comes of it.

mod folder;
mod image;
mod picture;
mod raster;
mod shade;
mod svg;

pub use folder::Pictures;
pub use image::Picture;
pub use picture::{draw, thumbnails};
pub use raster::{PictureError, View, outline_from_above};
pub use svg::layer_svg;
