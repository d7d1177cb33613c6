//! Boxes that can be asked which of them meet a box.

use super::Rect;
use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{AABB, RTree};

/// Boxes, sorted by place, each with a number.
#[derive(Debug)]
pub struct BoxTree(RTree<GeomWithData<Rectangle<[f64; 2]>, usize>>);

impl BoxTree {
    /// Sorts boxes.
    pub fn new(all: impl Iterator<Item = (usize, Rect)>) -> BoxTree {
        let entry = |(number, Rect { min, max })| {
            let corners = (min.to_array(), max.to_array());
            let rectangle = Rectangle::from_corners(corners.0, corners.1);
            GeomWithData::new(rectangle, number)
        };
        BoxTree(RTree::bulk_load(all.map(entry).collect()))
    }

    /// The numbers of the boxes that meet a box.
    pub fn meeting(&self, rect: Rect) -> impl Iterator<Item = usize> {
        let (min, max) = (rect.min.to_array(), rect.max.to_array());
        let frame = AABB::from_corners(min, max);
        let met = self.0.locate_in_envelope_intersecting(&frame);
        met.map(|found| found.data)
    }
}
