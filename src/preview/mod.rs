//! Pictures of what will be printed.

mod svg;

pub use svg::layer_svg;
