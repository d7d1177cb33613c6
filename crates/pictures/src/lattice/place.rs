//! A lattice in space.

use super::bounds::Ends;
use super::{Lattice, Range};
use glam::{DAffine3, DVec3};
use isocontour::{Bounds, places};

/// A lattice, and where it lies.
#[derive(Debug)]
pub(crate) struct Place {
    pub(crate) lattice: Lattice,
    /// From space to coordinates of the lattice.
    pub(crate) to_lattice: DAffine3,
}

/// `a` · `b`, where nothing times the infinite is nothing.
fn times(a: f64, b: f64) -> f64 {
    if a == 0.0 { 0.0 } else { a * b }
}

/// The range of a number times those of a range.
fn scaled(factor: f64, [a, b]: Range) -> Range {
    let (a, b) = (times(factor, a), times(factor, b));
    [a.min(b), a.max(b)]
}

fn plus([a, b]: Range, [c, d]: Range) -> Range {
    [a + c, b + d]
}

/// Wider by what rounding may do to sums of such numbers.
fn rounded([a, b]: Range, size: f64) -> Range {
    let by = 8.0 * f64::EPSILON * size;
    [a - by, b + by]
}

impl Place {
    pub(crate) fn at(&self, p: DVec3) -> (f64, DVec3) {
        let (value, slope) =
            self.lattice.at(self.to_lattice.transform_point3(p));
        (value, self.to_lattice.matrix3.transpose() * slope)
    }

    pub(crate) fn values(&self, at: [&[f32]; 3], out: &mut Vec<f32>) {
        let seen = |p| self.to_lattice.transform_point3(p);
        self.lattice.values(places(at).map(|p| p.map(seen)), out);
    }

    /// Tells all on which it depends.
    pub(crate) fn contents(&self, tell: &mut dyn FnMut(&[u8])) {
        for v in self.to_lattice.to_cols_array() {
            tell(&v.to_le_bytes());
        }
        self.lattice.contents(tell);
    }

    pub(crate) fn range(&self, over: &Bounds) -> Range {
        self.lattice.range(self.ends(over))
    }

    pub(crate) fn slopes(&self, over: &Bounds) -> [Range; 3] {
        let slopes = self.lattice.slopes(self.ends(over));
        std::array::from_fn(|a| {
            let column = self.to_lattice.matrix3.col(a).to_array();
            let terms = [0, 1, 2].map(|r| scaled(column[r], slopes[r]));
            let sum = terms.into_iter().fold([0.0; 2], plus);
            // Infinite ends stay, since what is added to them is finite.
            let size = terms.iter().flatten().filter(|v| v.is_finite());
            rounded(sum, size.map(|v| v.abs()).sum())
        })
    }

    /// A box as the lattice's axes see it.
    fn ends(&self, over: &Bounds) -> Ends {
        let (min, max) = (over.min.to_array(), over.max.to_array());
        std::array::from_fn(|r| {
            let offset = self.to_lattice.translation[r];
            let mut ends = [offset; 2];
            let mut size = offset.abs();
            for a in 0..3 {
                let factor = self.to_lattice.matrix3.col(a)[r];
                ends = plus(ends, scaled(factor, [min[a], max[a]]));
                for end in [min[a], max[a]] {
                    let term = times(factor, end).abs();
                    size += if term.is_finite() { term } else { 0.0 };
                }
            }
            rounded(ends, size)
        })
    }
}
