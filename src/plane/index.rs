//! Which edges of an area a segment meets, through an R-tree.
//!
//! Built once per layer and asked for every travel; a query looks only at
//! edges whose boxes meet the segment's.

use super::{Area, edges};
use glam::DVec2;
use rstar::primitives::{GeomWithData, Line};
use rstar::{AABB, PointDistance, RTree};

type Edge = GeomWithData<Line<[f64; 2]>, u32>;

/// The edges of an area's rings.
pub struct EdgeIndex {
    tree: RTree<Edge>,
}

impl EdgeIndex {
    /// Index of all rings' edges; each knows the number of its ring.
    pub fn new(area: &Area) -> EdgeIndex {
        let all = area.rings.iter().enumerate().flat_map(|(i, ring)| {
            edges(ring).map(move |(a, b)| {
                Edge::new(Line::new(a.to_array(), b.to_array()), i as u32)
            })
        });
        EdgeIndex {
            tree: RTree::bulk_load(all.collect()),
        }
    }

    /// The points at which the segment from `a` to `b` crosses edges, as
    /// fractions of its length, in no particular order. Touching counts.
    pub fn crossings(&self, a: DVec2, b: DVec2) -> Vec<f64> {
        let lo = a.min(b);
        let hi = a.max(b);
        let window = AABB::from_corners(lo.to_array(), hi.to_array());
        self.tree
            .locate_in_envelope_intersecting(&window)
            .filter_map(|e| {
                let line = e.geom();
                crossing(a, b, line.from.into(), line.to.into())
            })
            .collect()
    }

    /// Number of the ring nearest to the point.
    pub fn nearest_ring(&self, p: DVec2) -> Option<usize> {
        self.tree
            .nearest_neighbor(&p.to_array())
            .map(|e| e.data as usize)
    }

    /// The point of the edges nearest to `p`, and the number of its ring.
    pub fn nearest_point(&self, p: DVec2) -> Option<(usize, DVec2)> {
        let q = p.to_array();
        self.tree.nearest_neighbor(&q).map(|e| {
            let on = e.geom().nearest_point(&q);
            (e.data as usize, on.into())
        })
    }

    /// Distance from the point to the nearest edge.
    pub fn distance(&self, p: DVec2) -> Option<f64> {
        let q = p.to_array();
        self.tree
            .nearest_neighbor(&q)
            .map(|e| e.geom().distance_2(&q).sqrt())
    }
}

/// Where on a–b (0 to 1) it meets c–d, if it does.
fn crossing(a: DVec2, b: DVec2, c: DVec2, d: DVec2) -> Option<f64> {
    let (u, v) = (b - a, d - c);
    let det = u.perp_dot(v);
    if det == 0.0 {
        return None;
    }
    let t = (c - a).perp_dot(v) / det;
    let s = (c - a).perp_dot(u) / det;
    ((0.0..=1.0).contains(&t) && (0.0..=1.0).contains(&s)).then_some(t)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn crossings_of_a_square() {
        let ring = [(0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (0.0, 4.0)]
            .map(|(x, y)| DVec2::new(x, y))
            .to_vec();
        let index = EdgeIndex::new(&Area { rings: vec![ring] });
        let mut t =
            index.crossings(DVec2::new(-1.0, 1.0), DVec2::new(7.0, 1.0));
        t.sort_by(f64::total_cmp);
        assert_eq!(t, vec![0.125, 0.625]);
        let inside =
            index.crossings(DVec2::new(1.0, 1.0), DVec2::new(3.0, 3.5));
        assert!(inside.is_empty());
        assert_eq!(index.nearest_ring(DVec2::new(9.0, 9.0)), Some(0));
        assert_eq!(index.distance(DVec2::new(2.0, 1.0)), Some(1.0));
    }
}
