//! The regular lattice on which a layer's field is sampled.

use super::{FieldError, LEAF};
use crate::Length;
use crate::plane::Rect;
use glam::DVec2;

/// Nodes at equal distances over the part's box and a margin around it. All
/// layers have one lattice, a whole number of leaves wide and high.
#[derive(Clone, Debug, PartialEq)]
pub struct Lattice {
    /// x of the node columns. It is in `f32`, in which the field is evaluated:
    /// a vertex between nodes must lie between these very values.
    pub x: Vec<f32>,
    /// y of the node rows.
    pub y: Vec<f32>,
    /// Distance between neighbouring nodes.
    pub spacing: Length,
}

/// Fractions of a cell by which the lattice is moved against the box. So the
/// flat faces of simple models do not fall on nodes, where f = 0 exactly and
/// rounding decides what is inside.
const SHIFT: [f64; 2] = [0.414_213_56, 0.732_050_81];

impl Lattice {
    /// The lattice over a box, with a margin of at least a cell.
    ///
    /// # Errors
    /// If the lattice would have more edges than fit a `u32`.
    pub fn over(bounds: Rect, spacing: Length) -> Result<Lattice, FieldError> {
        let size = bounds.size();
        let leaves = |extent: f64| (extent / spacing + 3.0) / LEAF as f64;
        let cells = [leaves(size.x), leaves(size.y)].map(|n| n.ceil() * 8.0);
        // Two edges start at each node. One number means that there is no edge.
        let nodes = (cells[0] + 1.0) * (cells[1] + 1.0);
        if nodes.is_nan() || nodes >= f64::from(u32::MAX / 2) {
            return Err(FieldError::TooLarge {
                x: size.x,
                y: size.y,
                spacing,
            });
        }
        let axis = |origin: f64, shift: f64, cells: f64| -> Vec<f32> {
            (0..=cells as usize)
                .map(|i| (origin + (i as f64 - 1.0 - shift) * spacing) as f32)
                .collect()
        };
        Ok(Lattice {
            x: axis(bounds.min.x, SHIFT[0], cells[0]),
            y: axis(bounds.min.y, SHIFT[1], cells[1]),
            spacing,
        })
    }

    /// The lower left and the upper right node.
    pub fn corners(&self) -> (DVec2, DVec2) {
        (self.node(0, 0), self.node(self.width(), self.height()))
    }

    /// The node of column `i` and row `j`.
    pub fn node(&self, i: usize, j: usize) -> DVec2 {
        DVec2::new(f64::from(self.x[i]), f64::from(self.y[j]))
    }

    /// The cell of column `i` and row `j`.
    pub fn cell(&self, i: usize, j: usize) -> Rect {
        Rect::new(self.node(i, j), self.node(i + 1, j + 1))
    }

    /// Cells along x.
    pub fn width(&self) -> usize {
        self.x.len() - 1
    }

    /// Cells along y.
    pub fn height(&self) -> usize {
        self.y.len() - 1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_box_is_covered_with_a_margin() {
        let bounds = Rect::new(DVec2::new(-3.0, 10.0), DVec2::new(5.05, 10.2));
        let l = Lattice::over(bounds, 0.1).unwrap();
        assert_eq!(l.width() % LEAF, 0);
        assert_eq!(l.height() % LEAF, 0);
        assert!(f64::from(l.x[1]) < -3.0 && l.y[1] < 10.0);
        assert!(f64::from(l.x[l.width() - 1]) > 5.05);
        assert!(f64::from(l.y[l.height() - 1]) > 10.2);
    }

    #[test]
    fn too_many_nodes_are_an_error() {
        let bounds = Rect::new(DVec2::ZERO, DVec2::splat(1e5));
        assert!(Lattice::over(bounds, 0.1).is_err());
        let nan = Rect::new(DVec2::NAN, DVec2::NAN);
        assert!(Lattice::over(nan, 0.1).is_err());
    }
}
