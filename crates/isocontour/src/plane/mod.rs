//! Closed rings in the plane, and the areas that they bound.
//!
//! An [`Area`] is a set of closed rings, outer ones counter-clockwise and
//! holes clockwise. [`simplify`] thins a ring within a tolerance, and
//! [`Nest`](nest::Nest) tells which ring is around a point.

#[cfg(feature = "geo-types")]
mod geo;
pub mod nest;
pub mod shelves;
pub mod simplify;

use crate::{Content, Length};
use glam::DVec2;

/// A closed ring of points; the first point is not repeated at the end.
pub type Ring = Vec<DVec2>;

/// An axis-aligned box in the plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rect {
    /// Lower left corner.
    pub min: DVec2,
    /// Upper right corner.
    pub max: DVec2,
}

impl Rect {
    /// The box that contains nothing.
    pub const EMPTY: Rect = Rect {
        min: DVec2::INFINITY,
        max: DVec2::NEG_INFINITY,
    };

    /// The box between two corners.
    #[inline]
    pub const fn new(min: DVec2, max: DVec2) -> Rect {
        Rect { min, max }
    }

    /// The smallest box around some points.
    #[inline]
    pub fn around<'a>(points: impl IntoIterator<Item = &'a DVec2>) -> Rect {
        points.into_iter().fold(Rect::EMPTY, |r, &p| r.with(p))
    }

    /// The smallest box around this one and a point.
    #[inline]
    pub fn with(self, p: DVec2) -> Rect {
        Rect::new(self.min.min(p), self.max.max(p))
    }

    /// The smallest box around both.
    #[inline]
    pub fn union(self, other: Rect) -> Rect {
        Rect::new(self.min.min(other.min), self.max.max(other.max))
    }

    /// The box with a margin on all sides. A negative margin is taken away.
    #[inline]
    pub fn grown(self, by: Length) -> Rect {
        Rect::new(self.min - by, self.max + by)
    }

    /// The box at another place.
    #[inline]
    pub fn moved(self, by: DVec2) -> Rect {
        Rect::new(self.min + by, self.max + by)
    }

    /// Width and depth.
    #[inline]
    pub fn size(self) -> DVec2 {
        self.max - self.min
    }

    /// The middle.
    #[inline]
    pub fn centre(self) -> DVec2 {
        self.min.midpoint(self.max)
    }

    /// The corners, counter-clockwise from the lower left one.
    #[inline]
    pub fn corners(self) -> [DVec2; 4] {
        let Rect { min, max } = self;
        [min, DVec2::new(max.x, min.y), max, DVec2::new(min.x, max.y)]
    }

    /// The distance of another box: 0 if the two have a point in common.
    #[inline]
    pub fn gap(self, other: Rect) -> Length {
        let apart = (self.min - other.max).max(other.min - self.max);
        apart.max(DVec2::ZERO).length()
    }

    /// The square of the distance of a point: 0 inside.
    #[inline]
    pub fn distance2(self, p: DVec2) -> f64 {
        let apart = (self.min - p).max(p - self.max);
        apart.max(DVec2::ZERO).length_squared()
    }

    /// True if the two boxes have a point in common.
    #[inline]
    pub fn meets(&self, other: Rect) -> bool {
        self.min.cmple(other.max).all() && other.min.cmple(self.max).all()
    }

    /// True if the point is inside or on the border.
    #[inline]
    pub fn contains(&self, p: DVec2) -> bool {
        self.min.cmple(p).all() && p.cmple(self.max).all()
    }
}

/// A part of the plane, bounded by closed rings: outer rings run
/// counter-clockwise, holes clockwise, and none cross.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Area {
    /// The rings, in no particular order.
    pub rings: Vec<Ring>,
}

impl Area {
    /// The area that contains nothing.
    pub const EMPTY: Area = Area { rings: Vec::new() };

    /// True if there are no rings.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.rings.is_empty()
    }

    /// Content of the area: outer rings less holes.
    #[inline]
    pub fn content(&self) -> Content {
        self.rings.iter().map(|r| signed_area(r)).sum()
    }

    /// Length of all rings together.
    #[inline]
    pub fn perimeter(&self) -> Length {
        self.rings.iter().map(|r| ring_length(r)).sum()
    }

    /// The box around the area.
    #[inline]
    pub fn bounds(&self) -> Rect {
        Rect::around(self.rings.iter().flatten())
    }

    /// True if the point is inside (even–odd rule; points on the border may
    /// count either way).
    #[inline]
    pub fn contains(&self, p: DVec2) -> bool {
        self.rings.iter().filter(|r| ring_contains(r, p)).count() % 2 == 1
    }

    /// The connected parts, each an outer ring followed by its holes, in the
    /// order of the outer rings.
    pub fn islands(&self) -> Vec<Area> {
        let is_outer = |r: &Ring| signed_area(r) > 0.0;
        let outers = self.rings.iter().filter(|r| is_outer(r));
        let mut islands: Vec<Area> = outers.cloned().map(Area::from).collect();
        if islands.len() == self.rings.len() {
            return islands;
        }
        // The island that each outer ring is of.
        let mut count = 0..;
        let own = |r| if is_outer(r) { count.next() } else { None };
        let own: Vec<Option<usize>> = self.rings.iter().map(own).collect();
        let nest = nest::Nest::new(self.rings.iter());
        for (i, hole) in self.rings.iter().enumerate() {
            let owner = || self.owner(i, &own, &nest);
            if own[i].is_none()
                && let Some(island) = owner()
            {
                islands[island].rings.push(hole.clone());
            }
        }
        islands
    }

    /// The island that the hole with number `i` is in, given those of the outer
    /// rings: the island of the smallest ring around a point of the hole. But rings
    /// that were thinned may cross by what thinning moves them. Then a point may lie
    /// outside of the ring around the hole, and so in a hole of another ring, or in
    /// an island within the hole, and another point tells. Where the strip between
    /// both rings is a hair, all points may lie outside; then a point of the outer
    /// ring lies in the hole.
    fn owner(
        &self,
        i: usize,
        own: &[Option<usize>],
        nest: &nest::Nest,
    ) -> Option<usize> {
        let hole = &self.rings[i];
        let around = |p: DVec2| {
            let ring = nest.around_but(p, i)?;
            let holds = nest.content(ring) >= nest.content(i);
            if holds { own[ring] } else { None }
        };
        let inside_out = || {
            let bounds = Rect::around(hole);
            let holds =
                |p: &DVec2| bounds.contains(*p) && ring_contains(hole, *p);
            let meets = |k: usize| self.rings[k].iter().any(holds);
            (0..own.len())
                .filter(|&k| own[k].is_some() && meets(k))
                .max_by(|&a, &b| nest.content(a).total_cmp(&nest.content(b)))
                .and_then(|k| own[k])
        };
        let middles = || edges(hole).map(|(a, b)| a.midpoint(b));
        hole.iter()
            .find_map(|&p| around(p))
            .or_else(|| middles().find_map(around))
            .or_else(inside_out)
    }
}

/// The area of one ring, which runs counter-clockwise.
impl From<Ring> for Area {
    fn from(ring: Ring) -> Area {
        Area { rings: vec![ring] }
    }
}

/// The area that rings bound together.
impl FromIterator<Ring> for Area {
    fn from_iter<I: IntoIterator<Item = Ring>>(rings: I) -> Area {
        Area {
            rings: rings.into_iter().collect(),
        }
    }
}

/// Areas that lie apart, as one.
impl FromIterator<Area> for Area {
    fn from_iter<I: IntoIterator<Item = Area>>(areas: I) -> Area {
        areas.into_iter().flat_map(|area| area.rings).collect()
    }
}

/// Length of a path, with the closing segment of a closed one.
#[inline]
pub fn path_length(points: &[DVec2], closed: bool) -> Length {
    let open: f64 = points.windows(2).map(|p| p[0].distance(p[1])).sum();
    match (closed, points.first(), points.last()) {
        (true, Some(a), Some(b)) => open + b.distance(*a),
        _ => open,
    }
}

/// Signed content of a ring: positive if it runs counter-clockwise.
#[inline]
pub fn signed_area(ring: &[DVec2]) -> Content {
    let Some(&o) = ring.first() else { return 0.0 };
    // Points are taken relative to the first one. Far from the origin the
    // products of coordinates would swallow the digits of a small ring's
    // content. The edges to and from the first point add nothing.
    let twice = |p: &[DVec2]| (p[0] - o).perp_dot(p[1] - o);
    0.5 * ring.windows(2).map(twice).sum::<f64>()
}

/// Length of a ring, its closing edge included.
#[inline]
pub fn ring_length(ring: &[DVec2]) -> Length {
    edges(ring).map(|(a, b)| a.distance(b)).sum()
}

/// A point just inside an outer ring, or just outside a hole, 1 µm off the
/// middle of its longest edge. It tells what surrounds a part that shares the
/// ring as its border.
#[inline]
pub fn point_beside(ring: &[DVec2]) -> Option<DVec2> {
    const OFF: Length = 1e-3;
    let longest = edges(ring).max_by(|(a, b), (c, d)| {
        a.distance_squared(*b).total_cmp(&c.distance_squared(*d))
    });
    longest
        .map(|(a, b)| a.midpoint(b) + (b - a).normalize_or_zero().perp() * OFF)
}

/// The edges of a ring, the closing one last.
#[inline]
pub fn edges(
    ring: &[DVec2],
) -> impl Iterator<Item = (DVec2, DVec2)> + Clone + '_ {
    let n = ring.len();
    (0..n).map(move |i| (ring[i], ring[if i + 1 == n { 0 } else { i + 1 }]))
}

/// True if the ring winds around the point.
#[inline]
pub fn ring_contains(ring: &[DVec2], p: DVec2) -> bool {
    is_within(edges(ring), p)
}

/// True if a ray from the point to the right crosses an odd number of edges.
#[inline]
fn is_within(edges: impl Iterator<Item = (DVec2, DVec2)>, p: DVec2) -> bool {
    edges.fold(false, |inside, (a, b)| {
        if (a.y > p.y) == (b.y > p.y) {
            return inside;
        }
        let x = a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x);
        inside ^ (p.x < x)
    })
}

/// The point of the segment from `a` to `b` nearest to `p`.
#[inline]
pub fn nearest_on(p: DVec2, a: DVec2, b: DVec2) -> DVec2 {
    let along = b - a;
    let t = (p - a).dot(along) / along.length_squared();
    // A segment without length is its own nearest point.
    let t = if t.is_finite() {
        t.clamp(0.0, 1.0)
    } else {
        0.0
    };
    a + along * t
}

#[cfg(test)]
mod tests {
    use super::*;

    pub(super) fn square(x: f64, y: f64, half: f64) -> Ring {
        [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]
            .map(|(a, b)| DVec2::new(x + a * half, y + b * half))
            .to_vec()
    }

    pub(super) fn reversed(mut r: Ring) -> Ring {
        r.reverse();
        r
    }

    #[test]
    fn boxes_are_apart_by_their_corners_too() {
        let rect = |x: f64, y: f64| {
            Rect::new(DVec2::new(x, y), DVec2::new(x + 10.0, y + 10.0))
        };
        assert_eq!(rect(0.0, 0.0).gap(rect(13.0, 14.0)), 5.0);
        assert_eq!(rect(13.0, 14.0).gap(rect(0.0, 0.0)), 5.0);
        assert_eq!(rect(0.0, 0.0).gap(rect(30.0, 5.0)), 20.0);
        assert_eq!(rect(0.0, 0.0).gap(rect(5.0, 5.0)), 0.0);
    }

    #[test]
    fn content_and_winding() {
        assert_eq!(signed_area(&square(100.0, 50.0, 2.0)), 16.0);
        assert_eq!(signed_area(&reversed(square(0.0, 0.0, 2.0))), -16.0);
        assert_eq!(ring_length(&square(0.0, 0.0, 2.0)), 16.0);
    }

    #[test]
    fn a_point_beside_a_ring_is_in_the_solid() {
        let ring = vec![
            DVec2::ZERO,
            DVec2::new(9.0, 0.0),
            DVec2::new(9.0, 4.0),
            DVec2::new(8.0, 1.0),
        ];
        let p = point_beside(&ring).unwrap();
        assert_eq!(p, DVec2::new(4.5, 1e-3));
        assert!(ring_contains(&ring, p));
        let hole = reversed(ring);
        assert!(!ring_contains(&hole, point_beside(&hole).unwrap()));
        assert_eq!(point_beside(&[]), None);
    }

    #[test]
    fn a_hole_whose_points_lie_outside_stays_in_its_ring() {
        // The hole's corners stand out of the frame's sides by a micrometre.
        let frame = square(0.0, 0.0, 10.0);
        let corners = [(10.001, 0.0), (0.0, -10.001), (-10.001, 0.0)];
        let hole: Ring = corners
            .into_iter()
            .chain([(0.0, 10.001)])
            .map(|(x, y)| DVec2::new(x, y))
            .collect();
        let plate = square(0.0, 0.0, 30.0);
        let around = reversed(square(0.0, 0.0, 20.0));
        let area = Area::from_iter([
            plate.clone(),
            around,
            frame.clone(),
            hole.clone(),
        ]);
        let islands = area.islands();
        assert_eq!(islands[1].rings, vec![frame, hole]);
        // A hair of a strip: the frame lies inside of its own hole.
        let frame = square(50.0, 0.0, 10.0);
        let hole = reversed(square(50.0, 0.0, 10.001));
        let islands =
            Area::from_iter([plate, frame.clone(), hole.clone()]).islands();
        assert_eq!(islands[1].rings, vec![frame, hole]);
        // A hole's corner in the island within the hole.
        let outer = square(0.0, 0.0, 30.0);
        let hole = reversed(square(0.0, 0.0, 10.0));
        let island: Ring =
            [(-9.0, -9.0), (9.0, -10.5), (9.0, 9.0), (-9.0, 9.0)]
                .map(|(x, y)| DVec2::new(x, y))
                .to_vec();
        let islands = Area::from_iter([outer, hole, island]).islands();
        assert_eq!(
            islands.iter().map(|i| i.rings.len()).collect::<Vec<_>>(),
            [2, 1]
        );
    }

    #[test]
    fn islands_keep_their_own_holes() {
        // A frame with an island in its hole, and a square beside it.
        let area = Area::from_iter([
            square(0.0, 0.0, 10.0),
            reversed(square(0.0, 0.0, 8.0)),
            square(0.0, 0.0, 5.0),
            reversed(square(0.0, 0.0, 1.0)),
            square(30.0, 0.0, 2.0),
        ]);
        let islands = area.islands();
        let content: Vec<f64> = islands.iter().map(Area::content).collect();
        assert_eq!(content, vec![400.0 - 256.0, 100.0 - 4.0, 16.0]);
        assert!(area.contains(DVec2::new(9.0, 0.0)));
        assert!(!area.contains(DVec2::new(7.0, 0.0)));
        assert!(area.contains(DVec2::new(3.0, 0.5)));
        assert!(!area.contains(DVec2::new(0.5, 0.2)));
    }
}
