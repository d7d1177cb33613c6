//! Geometry of one layer's plane: rings, areas, and what is done to them.
//!
//! In: rings of finite points, in millimetres. Out: rings, areas, lines and the
//! strokes of beads. An [`Area`] is a set of closed rings, outer ones
//! counter-clockwise and holes clockwise.
//!
//! | module | what it does |
//! |---|---|
//! | [`clip`] | combines areas |
//! | [`offset`] | grows and shrinks areas; [`trim`] helps it |
//! | [`opening`] | tells what of an area is wide, and fills gaps |
//! | [`simplify`] | thins rings within a tolerance |
//! | [`along`] | finds the point at a length along a line, and cuts the line there |
//! | [`arc`] | puts arcs in the place of segments |
//! | [`bend`] | tells how rings bend |
//! | [`hatch`] | draws parallel lines across an area |
//! | [`border`] | cuts any lines at an area, and follows its border |
//! | [`zero`] | finds where a function is zero near an area |
//! | [`joints`] | puts pieces together whose ends go on in one another |
//! | [`clusters`] | puts islands whose boxes meet together |
//! | [`grid`] | answers which edges are near a place; [`places`] counts along rings |
//! | [`nest`] | tells which ring is around a point |
//! | `box_tree` | tells which boxes meet a box |
//! | `joined` | puts the halves of an area together that was cut |
//! | `hull` | draws the convex ring around points |
//! | `curve` | finds the curve that a polygon stands for |
//! | `solid` | is an area that can be asked what is where |
//! | [`bead`] | has the cross-section of a line, and its role |
//! | [`shapes`] | makes rings and areas for tests |
//!
//! A [`Solid`] is an area with its grid, and [`BoxTree`] tells which boxes meet
//! another one. [`hull()`] is the convex ring around points.
//!
//! Guarantees: the same input gives the same output. Each function that takes a
//! tolerance says what lies within it. Nothing here knows settings or fields.

#![warn(unreachable_pub)]

pub mod along;
pub mod arc;
pub mod bead;
pub mod bend;
pub mod border;
mod box_tree;
pub mod clip;
pub mod clusters;
pub mod curve;
pub mod grid;
pub mod hatch;
mod hull;
mod joined;
pub mod joints;
pub mod offset;
pub mod opening;
#[cfg(test)]
mod oracle;
pub mod places;
pub mod shapes;
mod solid;
mod trim;
pub mod zero;

pub use box_tree::BoxTree;
pub use hull::hull;
pub use isocontour::plane::{
    Area, Rect, Ring, edges, nest, path_length, point_beside, ring_length,
    shelves, signed_area, simplify,
};
pub use shapes::rect;
pub use solid::Solid;
