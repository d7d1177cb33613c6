//! Places on an area's rings, by the numbers that an [`EdgeGrid`] gives to
//! their edges. Each ring has one number more than it has edges.
//!
//! [`EdgeGrid`]: super::grid::EdgeGrid

use super::{Area, edges};
use isoslice_base::units::Mm;

/// How far along its ring each edge begins.
#[derive(Clone, Debug)]
pub struct Places {
    /// Number of each ring's first edge; one more than rings.
    first: Vec<usize>,
    /// Way along its ring to each number's beginning.
    before: Vec<Mm>,
}

impl Places {
    /// The places on an area's rings.
    pub fn new(area: &Area) -> Places {
        let mut first = vec![0];
        let mut before = Vec::new();
        for ring in &area.rings {
            let mut way = 0.0;
            for (a, b) in edges(ring) {
                before.push(way);
                way += a.distance(b);
            }
            if !ring.is_empty() {
                before.push(way);
            }
            first.push(before.len());
        }
        Places { first, before }
    }

    /// The ring of an edge.
    pub fn ring(&self, edge: usize) -> usize {
        self.first.partition_point(|&f| f <= edge) - 1
    }

    /// Number of a ring's first edge.
    pub fn first(&self, ring: usize) -> usize {
        self.first[ring]
    }

    /// The ways along a ring to its points, in order.
    pub fn of_ring(&self, ring: usize) -> &[Mm] {
        let all = &self.before[self.first[ring]..self.first[ring + 1]];
        &all[..all.len().saturating_sub(1)]
    }

    /// Way along its ring to where an edge begins.
    pub fn begin(&self, edge: usize) -> Mm {
        self.before[edge]
    }

    /// Length of a ring.
    pub fn length(&self, ring: usize) -> Mm {
        let all = &self.before[self.first[ring]..self.first[ring + 1]];
        all.last().copied().unwrap_or(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::super::grid::EdgeGrid;
    use super::super::shapes::rect;
    use super::*;

    #[test]
    fn numbers_are_those_of_a_grid() {
        let mut area = rect(0.0, 0.0, 4.0, 2.0);
        area.rings.push(Vec::new());
        area.rings.extend(rect(10.0, 0.0, 11.0, 3.0).rings);
        let places = Places::new(&area);
        let grid = EdgeGrid::new(&area, 1.0);
        for (i, ring) in area.rings.iter().enumerate() {
            for (k, edge) in edges(ring).enumerate() {
                let number = places.first(i) + k;
                assert_eq!(grid.edge(number), edge);
                assert_eq!((places.ring(number), grid.owner(number)), (i, i));
            }
        }
        assert_eq!(places.of_ring(0), [0.0, 4.0, 6.0, 10.0]);
        assert_eq!((places.length(0), places.length(2)), (12.0, 8.0));
        assert!(places.of_ring(1).is_empty() && places.length(1) == 0.0);
    }
}
