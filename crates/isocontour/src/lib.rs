//! Contours of implicit functions: closed rings on f = 0, at any height.
//!
//! In: a [fidget](https://docs.rs/fidget) expression f(x, y, z), negative
//! inside, a box in the plane, the spacing of a lattice, heights and an
//! accuracy. Out: for each height closed rings on f = 0, outer ones
//! counter-clockwise and holes clockwise, none crossing.
//!
//! f need not be a distance. It may be NaN or infinite somewhere, which counts
//! as outside, and it may jump. How accurate a ring is does not depend on the
//! lattice's spacing, which only decides what is connected.
//!
//! ```
//! use fidget::context::Tree;
//! use glam::DVec2;
//! use isocontour::{Detail, Field, Rect, outlines};
//!
//! # fn main() -> Result<(), isocontour::FieldError> {
//! let (x, y, z) = Tree::axes();
//! let ball = (x.square() + y.square() + z.square()).sqrt() - 5.0;
//! let rect = Rect {
//!     min: DVec2::splat(-6.0),
//!     max: DVec2::splat(6.0),
//! };
//! let field = Field::new(&ball, 0.0, rect, 0.25)?;
//! let detail = Detail {
//!     accuracy: 0.001,
//!     smallest: 0.1,
//! };
//! let circles = outlines(&field, &[0.0, 3.0], detail)?;
//! for (circle, radius) in circles.iter().zip([5.0, 4.0]) {
//!     for p in &circle.area.rings[0] {
//!         assert!((p.length() - radius).abs() < 0.001);
//!     }
//! }
//! # Ok(())
//! # }
//! ```
//!
//! [`find_bounds`] finds the box of {f < 0} when it is not known. [`Sight`]
//! tells what lines through space meet first. [`Cancel`] stops either from
//! outside.
//!
//! Lengths are in the unit of the coordinates. A few constants are lengths,
//! such as the 10⁻⁶ at which a vertex has arrived. They suit parts of 1 to 1000
//! units with features of 0.01 or more, so millimetres suit most parts.

#![warn(unreachable_pub)]

mod bounds;
mod cancel;
mod ceiling;
mod cell;
mod cells;
mod contour;
mod cuboid;
mod data;
mod expand;
mod field;
mod grid;
mod interval;
mod lean;
pub mod level;
mod number;
pub mod plane;
mod program;
mod shift;
mod solid;
mod tree;

pub use bounds::{
    BoundsError, FoundBounds, SearchOptions, find_bounds, is_flat,
};
pub use cancel::{Cancel, Cancelled};
pub use contour::{
    Detail, Outline, Phase, outline_of, outlines, outlines_in_phases,
};
pub use cuboid::Bounds;
pub use data::{Call, Crossing, Data, Facet};
pub use data::{call, call_of, data_of, known as known_data, places};
pub use expand::{ExpandError, MAX_EXPANDED_NODES};
pub use expand::{expand, expand_with, nodes_of};
pub use field::{
    Batch, Field, FieldError, Hit, LEAF, Lattice, Leaf, NODES, SLAB, Sampler,
    Sight, Values, Visit, apart,
};
pub use grid::Grid;
pub use lean::{Lean, LeanError, LeanOptions, lean};
pub use plane::{Area, Rect, Ring};
pub use shift::{digits, shifted};
pub use solid::{Solid, solid};
pub use tree::{BINARY, UNARY, binary, operands, unary};

/// A length, in the unit of the coordinates.
pub type Length = f64;
/// Content of an area, in that unit squared.
pub type Content = f64;
