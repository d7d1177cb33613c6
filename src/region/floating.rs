//! Islands inside the part that nothing below holds: what hangs from the roof
//! of a cavity, where supports could not be taken out.
//!
//! In: a layer's outline and the layer below. Out: a point of each island that
//! no solid lies under, but around which there is solid.
//!
//! Not looked for: whether the cavity is closed above and below.

use super::cover::{Cover, Covered, Islands};
use crate::plane::Area;
use crate::plane::nest::Nest;
use glam::DVec2;

/// A point of each of a layer's islands that begin in the air over `below`,
/// with solid around them.
pub fn floating(outline: &Area, below: &Cover<'_>) -> Vec<DVec2> {
    let mut free = outline.islands();
    free.retain(|island| {
        // Nearly always the first point tells.
        let mut points = island.rings.first().into_iter().flatten();
        !points.any(|&p| below.grid.contains(p))
    });
    if free.is_empty() {
        return Vec::new();
    }
    let around = Nest::new(below.area.rings.iter());
    let covered = Islands::new(&free).covered(below);
    free.iter()
        .zip(covered)
        .filter(|(_, covered)| *covered == Covered::Not)
        .filter_map(|(island, _)| island.rings.first()?.first().copied())
        .filter(|&p| around.around(p).is_some())
        .collect()
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
        let two = Area {
            rings: [
                rect(7.0, 9.0, 8.0, 9.0).rings,
                rect(40.0, 45.0, 8.0, 12.0).rings,
                rect(15.0, 19.0, 8.0, 12.0).rings,
            ]
            .concat(),
        };
        assert_eq!(on(&two), [DVec2::new(7.0, 8.0), DVec2::new(15.0, 8.0)]);
        assert!(on(&rect(3.0, 12.0, 8.0, 12.0)).is_empty());
        assert!(on(&rect(-5.0, 50.0, -5.0, 50.0)).is_empty());
    }
}
