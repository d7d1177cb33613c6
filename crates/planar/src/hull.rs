//! The convex ring around some points.

use super::Ring;
use geo::{ConvexHull, Coord, MultiPoint, Point};
use glam::DVec2;

/// The corners of the convex ring around some points, counter-clockwise; fewer
/// than 3 if there is no such ring.
pub fn hull(points: impl Iterator<Item = DVec2>) -> Ring {
    let points: MultiPoint<f64> =
        points.map(|p| Point::new(p.x, p.y)).collect();
    let hull = points.convex_hull();
    let corners = hull.exterior().coords();
    // The last corner repeats the first one.
    corners.skip(1).map(|c: &Coord| (c.x, c.y).into()).collect()
}
