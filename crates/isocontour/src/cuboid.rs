//! Boxes whose sides are parallel to the axes.

use crate::Length;
use crate::plane::Rect;
use glam::DVec3;

/// An axis-aligned box, in the model's own frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Lower corner.
    pub min: DVec3,
    /// Upper corner.
    pub max: DVec3,
}

impl Bounds {
    /// The box that contains nothing.
    pub const EMPTY: Bounds = Bounds::new(DVec3::INFINITY, DVec3::NEG_INFINITY);

    /// The box between two corners.
    #[inline]
    pub const fn new(min: DVec3, max: DVec3) -> Bounds {
        Bounds { min, max }
    }

    /// The least box around some points.
    #[inline]
    pub fn around(points: impl IntoIterator<Item = DVec3>) -> Bounds {
        points.into_iter().fold(Bounds::EMPTY, Bounds::with)
    }

    /// The least box around this one and a point.
    #[inline]
    pub fn with(self, p: DVec3) -> Bounds {
        Bounds::new(self.min.min(p), self.max.max(p))
    }

    /// The least box around this one and another.
    #[inline]
    pub fn union(self, other: Bounds) -> Bounds {
        Bounds::new(self.min.min(other.min), self.max.max(other.max))
    }

    /// The box with a margin on all sides.
    #[inline]
    pub fn grown(self, by: Length) -> Bounds {
        Bounds::new(self.min - by, self.max + by)
    }

    /// The box moved by a vector.
    #[inline]
    pub fn moved(self, by: DVec3) -> Bounds {
        Bounds::new(self.min + by, self.max + by)
    }

    /// Extent along each axis.
    pub fn size(&self) -> DVec3 {
        self.max - self.min
    }

    /// The middle.
    pub fn centre(&self) -> DVec3 {
        0.5 * (self.min + self.max)
    }

    /// The box as seen from above.
    pub fn from_above(&self) -> Rect {
        Rect::new(self.min.truncate(), self.max.truncate())
    }

    /// True if the point is inside or on the border.
    #[inline]
    pub fn contains(&self, p: DVec3) -> bool {
        self.min.cmple(p).all() && p.cmple(self.max).all()
    }

    /// True if all of its corners are finite.
    pub fn is_finite(&self) -> bool {
        self.min.is_finite() && self.max.is_finite()
    }

    /// The distance of another box: 0 if the two have a point in common.
    #[inline]
    pub fn gap(&self, other: &Bounds) -> Length {
        let apart = (self.min - other.max).max(other.min - self.max);
        apart.max(DVec3::ZERO).length()
    }

    /// The square of the distance of a point: 0 inside.
    #[inline]
    pub fn distance2(&self, p: DVec3) -> f64 {
        let apart = (self.min - p).max(p - self.max);
        apart.max(DVec3::ZERO).length_squared()
    }
}
