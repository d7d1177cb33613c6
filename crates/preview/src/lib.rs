//! Pictures of what will be printed.
//!
//! `picture` draws the part and its supports: `raster` finds the visible surface,
//! `slabs` has the faces of supports, `shade` lights the surface, `edges` says
//! which pixels need a closer look, and `image` holds the pixels. `svg` draws a
//! layer, and `folder` keeps the pictures of a run together. `html` makes an
//! interactive page from any G-code that [`isoslice_gcode_read::reader`] reads:
//! `toolpath` gathers its moves and their times, and `pack` makes them small.
//! `view` says from where a picture is taken.
//!
//! In: a model, faces of supports, beads, or G-code. Out: PNG, JPEG and QOI
//! pictures, SVG files, and pages that need nothing else.
//!
//! Guarantees: the same input gives the same bytes, on any number of threads.

#![warn(unreachable_pub)]

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

pub use folder::Pictures;
pub use html::live_html;
pub use picture::thumbnails;
pub use raster::PictureError;
pub use raster::outline_from_above;
pub use slabs::Slabs;
pub(crate) use svg::layer_svg;
pub use toolpath::{Toolpath, ToolpathError};
pub use view::View;
