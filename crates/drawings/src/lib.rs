//! Drawings and text as exact distances in the plane.
//!
//! In: an SVG or DXF file, a text and a font, or outlines. Out: a [`Drawing`], which
//! is [`isocontour::Data`]: the distance to the border of the drawn area in the
//! plane, negative inside, the same at all heights, with its gradient and
//! bounds of both over boxes.
//!
//! Guarantees: the distance is that of the curves as they are drawn, not of
//! chords, within 10⁻⁹ mm but for rounding; where shapes cross or cover one
//! another it is that of the border of all together; the sign is right
//! whatever outlines do; the same values on any machine. Files are not trusted:
//! no file refers to another, and sizes, counts and depths are bounded.

#![warn(unreachable_pub)]

mod area;
mod curve;
mod drawing;
mod dxf;
mod left_out;
mod outline;
mod place;
mod roots;
mod stroke;
mod svg;
#[cfg(test)]
mod tests;
#[cfg(feature = "text")]
mod text;
mod tree;

pub use drawing::{Drawing, MOST_DRAWING_BYTES};
pub use dxf::DxfOptions;
pub use outline::{Fill, Outline};
pub use place::Anchor;
pub use svg::{SvgOptions, White};
#[cfg(feature = "text")]
pub use text::{Align, TextOptions, Vertical};
