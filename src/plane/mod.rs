//! Geometry of one layer's plane: rings, areas, and what is done to them.
//!
//! An [`Area`] is a set of closed rings, outer ones counter-clockwise and
//! holes clockwise, in millimetres. [`clip`] combines areas, [`offset`]
//! grows and shrinks them, [`simplify`] thins their rings within a tolerance,
//! [`arc`] puts arcs in the place of segments, [`hatch`] draws parallel lines across them, [`border`] cuts any lines,
//! [`grid`] answers what is where and [`nest`] which ring is around a point;
//! a [`Solid`] is an area with its grid.

pub(crate) mod arc;
pub(crate) mod border;
pub(crate) mod clip;
pub(crate) mod grid;
pub(crate) mod hatch;
pub(crate) mod offset;
#[cfg(test)]
mod oracle;
pub(crate) mod places;
mod solid;
mod trim;

pub(crate) use isocontour::plane::{
    Area, Rect, Ring, edges, nest, path_length, point_beside, ring_length,
    signed_area, simplify,
};
pub(crate) use solid::Solid;

/// A rectangle, for tests.
#[cfg(test)]
pub(crate) fn rect(x0: f64, y0: f64, x1: f64, y1: f64) -> Area {
    let ring = [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]
        .map(|(x, y)| glam::DVec2::new(x, y))
        .to_vec();
    Area { rings: vec![ring] }
}
