//! Geometry of one layer's plane: rings, areas, and what is done to them.
//!
//! An [`Area`] is a set of closed rings, outer ones counter-clockwise and holes
//! clockwise, in millimetres.
//!
//! | module | what it does |
//! |---|---|
//! | [`clip`] | combines areas |
//! | [`offset`] | grows and shrinks areas; [`trim`] helps it |
//! | [`simplify`] | thins rings within a tolerance |
//! | [`along`] | finds the point at a length along a line, and cuts the line there |
//! | [`arc`] | puts arcs in the place of segments |
//! | [`bend`] | tells how rings bend |
//! | [`hatch`] | draws parallel lines across an area |
//! | [`border`] | cuts any lines at an area, and follows its border |
//! | [`zero`] | finds where a function is zero near an area |
//! | [`clusters`] | puts islands whose boxes meet together |
//! | [`grid`] | answers which edges are near a place; [`places`] counts along rings |
//! | [`nest`] | tells which ring is around a point |
//!
//! A [`Solid`] is an area with its grid, and [`BoxTree`] tells which boxes meet
//! another one. [`hull()`] is the convex ring around points.

pub(crate) mod along;
pub(crate) mod arc;
pub(crate) mod bend;
pub(crate) mod border;
mod box_tree;
pub(crate) mod clip;
pub(crate) mod clusters;
pub(crate) mod curve;
pub(crate) mod grid;
pub(crate) mod hatch;
mod hull;
pub(crate) mod offset;
#[cfg(test)]
mod oracle;
pub(crate) mod places;
#[cfg(test)]
pub(crate) mod shapes;
mod solid;
mod trim;
pub(crate) mod zero;

pub(crate) use box_tree::BoxTree;
pub(crate) use hull::hull;
pub(crate) use isocontour::plane::{
    Area, Rect, Ring, edges, nest, path_length, point_beside, ring_length,
    signed_area, simplify,
};
#[cfg(test)]
pub(crate) use shapes::rect;
pub(crate) use solid::Solid;
