//! Geometry of one layer's plane: rings, areas, and what is done to them.
//!
//! An [`Area`] is a set of closed rings, outer ones counter-clockwise and
//! holes clockwise, in millimetres. [`clip`] combines areas, [`offset`]
//! grows and shrinks them, [`simplify`] thins their rings within a tolerance,
//! [`arc`] puts arcs in the place of segments, [`bend`] tells how rings bend, [`hatch`] draws parallel lines across them, [`border`] cuts any lines,
//! [`zero`] finds where a function is zero near an area, [`clusters`] are boxes of islands,
//! [`grid`] answers what is where and [`nest`] which ring is around a point;
//! a [`Solid`] is an area with its grid.

pub(crate) mod arc;
pub(crate) mod bend;
pub(crate) mod border;
pub(crate) mod clip;
pub(crate) mod clusters;
pub(crate) mod grid;
pub(crate) mod hatch;
pub(crate) mod offset;
#[cfg(test)]
mod oracle;
pub(crate) mod places;
#[cfg(test)]
pub(crate) mod shapes;
mod solid;
mod trim;
pub(crate) mod zero;

pub(crate) use isocontour::plane::{
    Area, Rect, Ring, edges, nest, path_length, point_beside, ring_length,
    signed_area, simplify,
};
#[cfg(test)]
pub(crate) use shapes::rect;
pub(crate) use solid::Solid;
