//! The rings of an area, its islands, and ways along them.

use super::{Comb, Stop};
use glam::DVec2;
use isoslice_base::units::Mm;
use isoslice_planar::grid::EdgeGrid;
use isoslice_planar::nest::Nest;
use isoslice_planar::places::Places;
use isoslice_planar::{Area, signed_area};

/// The rings' islands and lengths.
pub(super) struct Rings {
    pub nest: Nest,
    /// Island that each ring belongs to.
    pub island: Vec<Option<usize>>,
    pub places: Places,
}

/// A place on a ring.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Mark {
    /// Place of the mark along the straight way.
    pub t: f64,
    pub edge: usize,
    pub at: DVec2,
}

impl Rings {
    pub(super) fn new(outline: &Area) -> Rings {
        let outer: Vec<bool> =
            outline.rings.iter().map(|r| signed_area(r) > 0.0).collect();
        let outers = || {
            let all = outline.rings.iter().zip(&outer);
            all.filter(|(_, o)| **o).map(|(r, _)| r)
        };
        let nest = Nest::new(outers());
        let mut number = 0;
        let island = outline.rings.iter().zip(&outer).map(|(ring, outer)| {
            if *outer {
                number += 1;
                return Some(number - 1);
            }
            // The points of a hole's border belong to the hole's island.
            ring.first().and_then(|p| nest.around(*p))
        });
        let island = island.collect();
        Rings {
            nest,
            island,
            places: Places::new(outline),
        }
    }

    /// The island that an edge belongs to.
    pub(super) fn of_edge(&self, edge: usize) -> Option<usize> {
        self.island[self.places.ring(edge)]
    }

    /// Place of a mark along the mark's ring.
    pub(super) fn place(&self, grid: &EdgeGrid, mark: &Mark) -> Mm {
        let (p, _) = grid.edge(mark.edge);
        self.places.begin(mark.edge) + p.distance(mark.at)
    }
}

impl Comb<'_> {
    /// Where the straight way leaves the island and comes back, in pairs; none
    /// if its ends are not in one island.
    pub(super) fn marks(&self, a: DVec2, b: DVec2) -> Option<Vec<Mark>> {
        /// How far aside another straight way is tried, mm. If a way passes
        /// through a vertex, its crossings may come out of order.
        const ASIDE: Mm = 1e-4;
        let island = self.island(a)?;
        if self.island(b) != Some(island) {
            return None;
        }
        let aside = ASIDE * (b - a).perp().normalize_or_zero();
        [0.0, 1.0, -1.0, 0.3, -0.3]
            .into_iter()
            .find_map(|k| self.marks_of(island, a + k * aside, b + k * aside))
    }

    fn marks_of(&self, island: usize, a: DVec2, b: DVec2) -> Option<Vec<Mark>> {
        let rings = self.rings();
        let mut marks = self.crossed(a, b);
        marks.retain(|m| rings.of_edge(m.edge) == Some(island));
        let pairs = marks.chunks(2).all(|pair| {
            pair.len() == 2
                && rings.places.ring(pair[0].edge)
                    == rings.places.ring(pair[1].edge)
        });
        pairs.then_some(marks)
    }

    /// The island that a point is in, if any.
    pub(crate) fn island(&self, p: DVec2) -> Option<usize> {
        self.rings().nest.around(p)
    }

    /// Where a line crosses the border, in order.
    pub(crate) fn crossed(&self, a: DVec2, b: DVec2) -> Vec<Mark> {
        let mut marks: Vec<Mark> = Vec::new();
        self.grid().visit_crossed(a, b, |t, edge| {
            let at = a.lerp(b, t);
            marks.push(Mark { t, edge, at });
        });
        marks.sort_by(|p, q| p.t.total_cmp(&q.t).then(p.edge.cmp(&q.edge)));
        marks.dedup_by(|p, q| p.edge == q.edge);
        marks
    }

    /// Length of the shorter way along a ring, negative if it runs against the
    /// ring's direction.
    pub(super) fn ring_way(&self, from: Mark, to: Mark) -> Mm {
        let rings = self.rings();
        let total = rings.places.length(rings.places.ring(from.edge));
        let way =
            rings.place(self.grid(), &to) - rings.place(self.grid(), &from);
        let forwards = way.rem_euclid(total);
        if forwards <= 0.5 * total {
            forwards
        } else {
            forwards - total
        }
    }

    /// Appends the shorter way along a ring. Its points are no closer than
    /// `spacing`.
    pub(super) fn along(
        &self,
        from: Mark,
        to: Mark,
        spacing: Mm,
        way: &mut Vec<Stop>,
    ) {
        let rings = self.rings();
        let ring = rings.places.ring(from.edge);
        let way_round = self.ring_way(from, to);
        let ahead =
            rings.place(self.grid(), &to) >= rings.place(self.grid(), &from);
        let first = rings.places.first(ring);
        let count = rings.places.of_ring(ring).len();
        let next = |e: usize| first + (e - first + 1) % count;
        let previous = |e: usize| first + (e - first + count - 1) % count;
        way.push(self.inwards(from.at, from.edge, 0.5));
        let mut edge = from.edge;
        let mut last = from.at;
        let mut add = |p: DVec2, edge: usize, t: f64| {
            if p.distance(last) >= spacing {
                way.push(self.inwards(p, edge, t));
                last = p;
            }
        };
        if way_round >= 0.0 {
            // The way goes round at most once, also if both marks are on one
            // edge.
            let mut left = count;
            while (edge != to.edge || (left == count && !ahead)) && left > 0 {
                add(self.grid().edge(edge).1, edge, 1.0);
                edge = next(edge);
                left -= 1;
            }
        } else {
            let mut left = count;
            while (edge != to.edge || (left == count && ahead)) && left > 0 {
                add(self.grid().edge(edge).0, edge, 0.0);
                edge = previous(edge);
                left -= 1;
            }
        }
        way.push(self.inwards(to.at, to.edge, 0.5));
    }
}
