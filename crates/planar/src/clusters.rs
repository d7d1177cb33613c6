//! Parts of an area whose boxes keep apart.
//!
//! ```text
//!   ┌─────────────┐ ┌───┐    What is sampled on a lattice over a box is
//!   │╭───────────╮│ │ ╱ │    sampled once, however many islands lie within
//!   ││ ╭──╮ ╭──╮ ││ │╱  │    each other's boxes. Where there is nothing
//!   ││ ╰──╯ ╰──╯ ││ └───┘    between boxes, there is no lattice.
//!   │╰───────────╯│
//!   └─────────────┘
//! ```

use super::{Area, Rect};
use isoslice_base::units::Mm;
use rstar::RTree;
use rstar::primitives::{GeomWithData, Rectangle};
use rstar::{AABB, Envelope};

/// Islands whose boxes meet, directly or through the boxes of others.
#[derive(Clone, Debug, PartialEq)]
pub struct Cluster {
    /// The islands.
    pub area: Area,
    /// The box around them.
    pub bounds: Rect,
}

/// Boxes nearer to each other than this count as meeting, mm.
const GAP: Mm = 0.01;

impl Cluster {
    /// True if a point of the area belongs to this cluster.
    pub fn has(&self, p: glam::DVec2) -> bool {
        // Rounding moves points off the border that are meant to be on it.
        self.bounds.grown(0.25 * GAP).contains(p)
    }
}

/// The clusters of an area, in the order of their first rings.
pub fn clusters(area: &Area) -> Vec<Cluster> {
    type Boxed = GeomWithData<Rectangle<[f64; 2]>, Vec<usize>>;
    // Boxes that keep apart, each with the numbers of its rings.
    let mut apart: RTree<Boxed> = RTree::new();
    for (i, ring) in area.rings.iter().enumerate() {
        if isoslice_base::limits::is_stopped() {
            break;
        }
        let b = Rect::around(ring);
        if !(b.min.is_finite() && b.max.is_finite()) {
            continue;
        }
        let (min, max) = (b.min - 0.5 * GAP, b.max + 0.5 * GAP);
        let mut frame = AABB::from_corners(min.to_array(), max.to_array());
        let mut rings = vec![i];
        loop {
            let met: Vec<Boxed> =
                apart.drain_in_envelope_intersecting(frame).collect();
            if met.is_empty() {
                break;
            }
            for mut other in met {
                let (min, max) = (other.geom().lower(), other.geom().upper());
                frame.merge(&AABB::from_corners(min, max));
                if other.data.len() > rings.len() {
                    std::mem::swap(&mut other.data, &mut rings);
                }
                rings.append(&mut other.data);
            }
        }
        let corners = (frame.lower(), frame.upper());
        let r = Rectangle::from_corners(corners.0, corners.1);
        apart.insert(GeomWithData::new(r, rings));
    }
    let mut sets: Vec<Vec<usize>> =
        apart.drain().map(|boxed| boxed.data).collect();
    sets.iter_mut().for_each(|rings| rings.sort_unstable());
    sets.sort_unstable();
    let cluster = |rings: Vec<usize>| {
        let rings = rings.into_iter().map(|i| area.rings[i].clone());
        let area: Area = rings.collect();
        let bounds = area.bounds();
        Cluster { area, bounds }
    };
    sets.into_iter().map(cluster).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes::rect;
    use glam::DVec2;

    #[test]
    fn boxes_that_meet_are_one_cluster() {
        let frame = crate::clip::difference(
            &rect(0.0, 0.0, 20.0, 20.0),
            &rect(2.0, 2.0, 18.0, 18.0),
        );
        let parts = [
            rect(5.0, 5.0, 6.0, 6.0),
            rect(30.0, 0.0, 31.0, 1.0),
            // The box of this island meets the box of the second island after
            // it.
            rect(40.0, 0.0, 41.0, 9.0),
            rect(50.0, 0.0, 51.0, 1.0),
            rect(40.5, 5.0, 45.0, 6.0),
            frame,
            rect(22.0, 19.0, 23.0, 30.0),
        ];
        let rings = parts.iter().flat_map(|p| p.rings.clone());
        let area: Area = rings.collect();
        let found = clusters(&area);
        let counts: Vec<usize> =
            found.iter().map(|c| c.area.rings.len()).collect();
        assert_eq!(counts, [3, 1, 2, 1, 1]);
        assert_eq!(found[0].bounds, rect(0.0, 0.0, 20.0, 20.0).bounds());
        assert_eq!(found[2].bounds, rect(40.0, 0.0, 45.0, 9.0).bounds());
        let all: f64 = found.iter().map(|c| c.area.content()).sum();
        assert!((all - area.content()).abs() < 1e-9);
        // Every point of the area is in its own cluster only.
        for (i, c) in found.iter().enumerate() {
            for p in c.area.rings.iter().flatten() {
                for (k, other) in found.iter().enumerate() {
                    let near = p + DVec2::splat(1e-9);
                    assert_eq!(other.has(near), i == k, "{p}");
                }
            }
        }
        assert!(clusters(&Area::EMPTY).is_empty());
    }
}
