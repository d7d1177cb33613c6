//! Boxes whose sides are parallel to the axes.

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
    /// Extent along each axis.
    pub fn size(&self) -> DVec3 {
        self.max - self.min
    }

    /// The box as seen from above.
    pub fn from_above(&self) -> Rect {
        Rect::new(self.min.truncate(), self.max.truncate())
    }

    /// The box moved by a vector.
    pub fn moved(self, by: DVec3) -> Bounds {
        Bounds {
            min: self.min + by,
            max: self.max + by,
        }
    }

    /// The least box around this one and another.
    pub fn union(self, other: Bounds) -> Bounds {
        Bounds {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
        }
    }

    /// The middle.
    pub fn centre(&self) -> DVec3 {
        0.5 * (self.min + self.max)
    }
}
