//! The edges of an area, for asking what is near to them.

use glam::DVec2;
use isocontour::plane::{edges, nearest_on};
use isocontour::{Area, Rect};
use rstar::primitives::{GeomWithData, Line};
use rstar::{AABB, RTree};

type Edge = GeomWithData<Line<[f64; 2]>, (DVec2, DVec2)>;

/// The edges of an area, in a tree.
pub struct Edges {
    tree: RTree<Edge>,
    bounds: Rect,
}

impl Edges {
    pub fn new(area: &Area) -> Edges {
        let all = area.rings.iter().flat_map(|r| edges(r));
        let edge = |(a, b): (DVec2, DVec2)| {
            Edge::new(Line::new(a.to_array(), b.to_array()), (a, b))
        };
        Edges {
            tree: RTree::bulk_load(all.map(edge).collect()),
            bounds: area.bounds(),
        }
    }

    fn around(
        &self,
        a: DVec2,
        b: DVec2,
    ) -> impl Iterator<Item = (DVec2, DVec2)> {
        let (lo, hi) = (a.min(b).to_array(), a.max(b).to_array());
        let envelope = AABB::from_corners(lo, hi);
        self.tree
            .locate_in_envelope_intersecting(&envelope)
            .map(|edge| edge.data)
    }

    /// Distance to the nearest edge, if it is less than `reach`.
    pub fn nearest_within(&self, p: DVec2, reach: f64) -> Option<f64> {
        self.around(p - reach, p + reach)
            .map(|(a, b)| p.distance(nearest_on(p, a, b)))
            .filter(|d| *d < reach)
            .min_by(f64::total_cmp)
    }

    /// Whether a point is inside: a ray from it crosses an odd number of edges.
    pub fn contains(&self, p: DVec2) -> bool {
        let end = DVec2::new(self.bounds.max.x + 1.0, p.y);
        let crossed = |(a, b): &(DVec2, DVec2)| {
            (a.y > p.y) != (b.y > p.y)
                && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x)
        };
        self.around(p, p.max(end)).filter(crossed).count() % 2 == 1
    }

    /// Where the way from `a` to `b` crosses edges, as shares of the way.
    pub fn crossings(&self, a: DVec2, b: DVec2) -> Vec<f64> {
        let way = b - a;
        self.around(a, b)
            .filter_map(|(c, d)| {
                let edge = d - c;
                let across = way.perp_dot(edge);
                let t = (c - a).perp_dot(edge) / across;
                let s = (c - a).perp_dot(way) / across;
                let on = (0.0..=1.0).contains(&t) && (0.0..1.0).contains(&s);
                on.then_some(t)
            })
            .collect()
    }
}
