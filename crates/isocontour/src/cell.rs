//! An axis-aligned box, in f64. The search for bounds cuts space into such
//! boxes.

/// An axis-aligned box, perhaps a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Cell {
    pub lo: [f64; 3],
    pub hi: [f64; 3],
}

impl Cell {
    pub(crate) fn width(&self, axis: usize) -> f64 {
        self.hi[axis] - self.lo[axis]
    }

    pub(crate) fn centre(&self) -> [f64; 3] {
        // The ends are halved before they are added, so that the sum does not
        // overflow.
        std::array::from_fn(|i| 0.5 * self.lo[i] + 0.5 * self.hi[i])
    }

    /// Cuts the box in two across `axis`.
    pub(crate) fn split(&self, axis: usize) -> [Self; 2] {
        let (mut a, mut b) = (*self, *self);
        let middle = self.centre()[axis];
        a.hi[axis] = middle;
        b.lo[axis] = middle;
        [a, b]
    }

    /// The box around two boxes.
    pub(crate) fn joined(&self, other: &Self) -> Self {
        Self {
            lo: std::array::from_fn(|i| self.lo[i].min(other.lo[i])),
            hi: std::array::from_fn(|i| self.hi[i].max(other.hi[i])),
        }
    }

    /// The axis along which it is widest.
    pub(crate) fn widest_axis(&self) -> usize {
        (0..3).fold(0, |best, i| {
            if self.width(i) > self.width(best) {
                i
            } else {
                best
            }
        })
    }

    /// Extent along the widest axis.
    pub(crate) fn largest_side(&self) -> f64 {
        self.width(self.widest_axis())
    }

    /// What the box has in common with another one. If that is nothing, an
    /// upper end is below its lower end.
    pub(crate) fn common(&self, other: &Self) -> Self {
        Self {
            lo: std::array::from_fn(|i| self.lo[i].max(other.lo[i])),
            hi: std::array::from_fn(|i| self.hi[i].min(other.hi[i])),
        }
    }
}
