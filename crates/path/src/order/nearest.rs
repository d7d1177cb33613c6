//! Points to be visited, nearest first.

use glam::DVec2;
use rstar::RTree;
use rstar::primitives::GeomWithData;

/// Points to be visited nearest first.
pub(super) struct Nearest {
    tree: RTree<GeomWithData<[f64; 2], usize>>,
}

impl Nearest {
    /// The points to be visited, each with its number.
    pub(super) fn new(points: impl Iterator<Item = (DVec2, usize)>) -> Nearest {
        let all = points
            .map(|(p, i)| GeomWithData::new(p.to_array(), i))
            .collect();
        Nearest {
            tree: RTree::bulk_load(all),
        }
    }

    /// Adds a point.
    pub(super) fn push(&mut self, at: DVec2, number: usize) {
        self.tree.insert(GeomWithData::new(at.to_array(), number));
    }

    /// Takes the point nearest to `from`. Without `from` it takes the point
    /// nearest to the origin, so that the order does not depend on the tree's
    /// shape.
    pub(super) fn pop(&mut self, from: Option<DVec2>) -> Option<usize> {
        let at = from.unwrap_or(DVec2::ZERO).to_array();
        self.tree.pop_nearest_neighbor(&at).map(|g| g.data)
    }
}
