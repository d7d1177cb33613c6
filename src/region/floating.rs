//! Islands that nothing below holds: where a part begins in the air.
//!
//! In: a layer's outline and the layer below. Out: a point of each island that
//! no solid lies under, and whether it is inside the part: what hangs in a
//! cavity cannot be supported, nor could supports be taken out.

use super::cover::{Cover, Covered, covered};
use crate::plane::Area;
use glam::DVec2;

/// An island that begins in the air.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Floating {
    /// A point of its outline.
    pub at: DVec2,
    /// Solid is around it in the layer below.
    pub inside: bool,
}

/// The islands of a layer that begin in the air over `below`.
pub fn floating(outline: &Area, below: &Cover<'_>) -> Vec<Floating> {
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
        if alone == [Covered::Not] {
            let around = |r: &Vec<DVec2>| crate::plane::ring_contains(r, at);
            let inside = below.area.rings.iter().any(around);
            found.push(Floating { at, inside });
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plane::clip::difference;
    use crate::plane::grid::EdgeGrid;

    fn rect(x0: f64, x1: f64) -> Area {
        let ring = [(x0, 0.0), (x1, 0.0), (x1, 9.0), (x0, 9.0)]
            .map(|(x, y)| DVec2::new(x, y))
            .to_vec();
        Area { rings: vec![ring] }
    }

    #[test]
    fn only_what_has_nothing_below_floats() {
        let frame = |x0: f64, x1: f64| {
            let ring = [(x0, -9.0), (x1, -9.0), (x1, 18.0), (x0, 18.0)]
                .map(|(x, y)| DVec2::new(x, y))
                .to_vec();
            Area { rings: vec![ring] }
        };
        let block = frame(0.0, 30.0);
        let below = difference(&block, &rect(5.0, 25.0));
        let grid = EdgeGrid::new(&below, 1.0);
        let cover = Cover {
            area: &below,
            grid: &grid,
        };
        let on = |area: &Area| floating(area, &cover);
        // Within the hole; beside it all; over an edge; over all of it.
        let inner = on(&rect(8.0, 12.0));
        assert!(inner.len() == 1 && inner[0].inside, "{inner:?}");
        let outer = on(&rect(40.0, 45.0));
        assert!(outer.len() == 1 && !outer[0].inside, "{outer:?}");
        assert!(on(&rect(3.0, 12.0)).is_empty());
        assert!(on(&frame(-5.0, 50.0)).is_empty());
    }
}
