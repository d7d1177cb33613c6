//! Islands inside the part that nothing below holds: what hangs from the roof
//! of a cavity, where supports could not be taken out.
//!
//! In: a layer's outline and the layer below. Out: a point of each island that
//! no solid lies under, but around which there is solid.
//!
//! Not looked for: whether the cavity is closed above and below.

use super::cover::{Cover, Covered, covered};
use crate::plane::{Area, Ring, ring_contains};
use glam::DVec2;

/// A point of each of a layer's islands that begin in the air over `below`,
/// with solid around them.
pub fn floating(outline: &Area, below: &Cover<'_>) -> Vec<DVec2> {
    let mut found = Vec::new();
    for island in outline.islands() {
        let Some(ring) = island.rings.first() else {
            continue;
        };
        // Nearly always the first point tells.
        if ring.iter().any(|&p| below.grid.contains(p)) {
            continue;
        }
        let Some(&at) = ring.first() else { continue };
        let alone = covered(std::slice::from_ref(&island), below);
        let around = |r: &Ring| ring_contains(r, at);
        if alone == [Covered::Not] && below.area.rings.iter().any(around) {
            found.push(at);
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plane::clip::difference;
    use crate::plane::grid::EdgeGrid;

    fn rect(x0: f64, x1: f64, low: f64, high: f64) -> Area {
        let ring = [(x0, low), (x1, low), (x1, high), (x0, high)]
            .map(|(x, y)| DVec2::new(x, y))
            .to_vec();
        Area { rings: vec![ring] }
    }

    #[test]
    fn only_what_hangs_in_a_hole_floats() {
        let block = rect(0.0, 30.0, 0.0, 30.0);
        let below = difference(&block, &rect(5.0, 25.0, 5.0, 25.0));
        let grid = EdgeGrid::new(&below, 1.0);
        let cover = Cover {
            area: &below,
            grid: &grid,
        };
        let on = |area: &Area| floating(area, &cover);
        assert_eq!(on(&rect(8.0, 12.0, 8.0, 12.0)), [DVec2::splat(8.0)]);
        // Beside it all, over an edge, and over all of it.
        assert!(on(&rect(40.0, 45.0, 8.0, 12.0)).is_empty());
        assert!(on(&rect(3.0, 12.0, 8.0, 12.0)).is_empty());
        assert!(on(&rect(-5.0, 50.0, -5.0, 50.0)).is_empty());
    }
}
