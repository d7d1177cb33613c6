//! Pictures of what will be printed.
//!
//! `picture` draws the part and its supports: `raster` finds the visible surface,
//! `slabs` has the faces of supports, `shade` lights the surface, `edges` says
//! which pixels need a closer look, and `image` holds the pixels. `svg` draws a
//! layer, and `folder` keeps the pictures of a run together. `html` makes an
//! interactive page from any G-code that [`crate::reader`] reads: `toolpath` gathers its moves and
//! their times, and `pack` makes them small.

mod edges;
mod folder;
mod html;
mod image;
mod pack;
mod picture;
mod raster;
mod shade;
mod slabs;
mod svg;
mod toolpath;
mod view;

pub(crate) use folder::Pictures;
pub use html::live_html;
pub(crate) use picture::thumbnails;
pub use raster::PictureError;
pub(crate) use raster::outline_from_above;
pub use slabs::Slabs;
pub(crate) use svg::layer_svg;
pub use toolpath::{Toolpath, ToolpathError};
pub use view::View;
