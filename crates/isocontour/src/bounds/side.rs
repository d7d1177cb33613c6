//! A side of a box, and how far out things are on that side.

use crate::cell::Cell;

/// A side of a box.
#[derive(Clone, Copy)]
pub(super) struct BoxSide {
    /// Number of the axis: x, y or z.
    pub axis: usize,
    /// True for the upper end.
    pub up: bool,
}

impl BoxSide {
    pub(super) fn all() -> [Self; 6] {
        std::array::from_fn(|i| Self {
            // z comes first: the part stands on that side.
            axis: 2 - i / 2,
            up: i % 2 == 1,
        })
    }

    pub(super) fn name(self) -> &'static str {
        [["-x", "+x"], ["-y", "+y"], ["-z", "+z"]][self.axis]
            [usize::from(self.up)]
    }

    /// Turns a coordinate into a distance outwards, or back.
    pub(super) fn outward(self, v: f64) -> f64 {
        if self.up { v } else { -v }
    }

    /// How far out a cell reaches.
    pub(super) fn reach(self, cell: &Cell) -> f64 {
        if self.up {
            cell.hi[self.axis]
        } else {
            -cell.lo[self.axis]
        }
    }

    /// Coordinate of a cell's face opposite to this side.
    pub(super) fn inner_face(self, cell: &Cell) -> f64 {
        if self.up {
            cell.lo[self.axis]
        } else {
            cell.hi[self.axis]
        }
    }

    /// Removes the part that is less far out than `from`.
    pub(super) fn clip(self, cell: &mut Cell, from: f64) {
        if self.up {
            cell.lo[self.axis] = cell.lo[self.axis].max(from);
        } else {
            cell.hi[self.axis] = cell.hi[self.axis].min(-from);
        }
    }

    /// Moves a cell's face on this side.
    pub(super) fn set_reach(self, cell: &mut Cell, reach: f64) {
        if self.up {
            cell.hi[self.axis] = reach;
        } else {
            cell.lo[self.axis] = -reach;
        }
    }
}
