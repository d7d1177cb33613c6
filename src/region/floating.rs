//! Islands that begin on nothing: no solid lies under them in the layer
//! below.
//!
//! In: a layer's outline and the layer below. Out: each such island, and
//! whether it is inside the part, with solid around it: what hangs from the
//! roof of a cavity, where supports could not be taken out.
//!
//! Tips that the layers right above join to what stands beside them are told
//! apart ([`joins`]): a lattice cut by a slanted surface is full of them.
//!
//! Not looked for: whether the cavity is closed above and below.

use super::cover::{Cover, Covered, Islands};
use crate::plane::{Area, ring_contains};
use crate::plane::nest::Nest;
use glam::DVec2;

/// An island that begins in the air.
#[derive(Clone, Debug, PartialEq)]
pub struct Floating {
    /// Its outer ring and its holes.
    pub island: Area,
    /// A point of it.
    pub at: DVec2,
    /// Whether the layer below has solid around it.
    pub in_cavity: bool,
}

/// A layer's islands that begin in the air over `below`.
pub fn floating(outline: &Area, below: &Cover<'_>) -> Vec<Floating> {
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
    let free = free.into_iter().zip(covered);
    free.filter(|(_, covered)| *covered == Covered::Not)
        .filter_map(|(island, _)| {
            let at = *island.rings.first()?.first()?;
            let in_cavity = around.around(at).is_some();
            Some(Floating {
                island,
                at,
                in_cavity,
            })
        })
        .collect()
}

/// True if what begins as `island` in the layer `here` is one with something
/// else of it in one of the layers `above`, nearest first.
pub fn joins<'a>(
    island: &Area,
    here: Cover<'a>,
    above: impl Iterator<Item = Cover<'a>>,
) -> bool {
    let Some(mut own) = island.rings.first().cloned() else {
        return false;
    };
    let mut below = here;
    for cover in above {
        let Some(&p) = own.iter().find(|&&p| cover.grid.contains(p)) else {
            return false;
        };
        let rings = &cover.area.rings;
        let Some(i) = Nest::new(rings.iter()).around(p) else {
            return false;
        };
        // The island above: what of it has solid below that is not this one?
        let stands = |&&q: &&DVec2| {
            below.grid.contains(q) && !ring_contains(&own, q)
        };
        if rings[i].iter().any(|q| stands(&q)) {
            return true;
        }
        own.clone_from(&rings[i]);
        below = cover;
    }
    false
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plane::clip::difference;
    use crate::plane::grid::EdgeGrid;

    fn rect(x0: f64, x1: f64, low: f64, high: f64) -> Area {
        crate::plane::rect(x0, low, x1, high)
    }

    #[test]
    fn a_tip_joins_what_stands_beside_it() {
        let tip = rect(0.0, 1.0, 0.0, 1.0);
        let post = rect(2.0, 5.0, 0.0, 5.0);
        let both = |tip: &Area| Area {
            rings: [tip.rings.clone(), post.rings.clone()].concat(),
        };
        let wide = both(&rect(-0.5, 1.5, 0.0, 1.5));
        let one = rect(-0.7, 5.0, -0.1, 4.9);
        let layers = [both(&tip), wide.clone(), one];
        let grids: Vec<EdgeGrid> =
            layers.iter().map(|a| EdgeGrid::new(a, 1.0)).collect();
        let all = layers.iter().zip(&grids);
        let all: Vec<Cover<'_>> =
            all.map(|(area, grid)| Cover { area, grid }).collect();
        let joined = |n: usize| {
            joins(&tip, all[0], all[1..n].iter().copied())
        };
        assert!(!joined(1) && !joined(2));
        assert!(joined(3));
        // A wall that only rises beside it is another's.
        let beside = [all[1], all[1], all[1]];
        assert!(!joins(&tip, all[0], beside.into_iter()));
    }

    #[test]
    fn what_has_nothing_below_floats_in_a_cavity_or_beside_the_part() {
        let block = rect(0.0, 30.0, 0.0, 30.0);
        let below = difference(&block, &rect(5.0, 25.0, 5.0, 25.0));
        let grid = EdgeGrid::new(&below, 1.0);
        let cover = Cover {
            area: &below,
            grid: &grid,
        };
        let on = |area: &Area| -> Vec<(DVec2, bool)> {
            let all = floating(area, &cover).into_iter();
            all.map(|f| (f.at, f.in_cavity)).collect()
        };
        let place = DVec2::new;
        let inside = rect(8.0, 12.0, 8.0, 12.0);
        assert_eq!(on(&inside), [(place(8.0, 8.0), true)]);
        assert_eq!(floating(&inside, &cover)[0].island, inside);
        // Beside it all, over an edge, and over all of it.
        let beside = rect(40.0, 45.0, 8.0, 12.0);
        assert_eq!(on(&beside), [(place(40.0, 8.0), false)]);
        assert!(on(&rect(3.0, 12.0, 8.0, 12.0)).is_empty());
        assert!(on(&rect(-5.0, 50.0, -5.0, 50.0)).is_empty());
        let several = Area {
            rings: [
                rect(7.0, 9.0, 8.0, 9.0).rings,
                beside.rings,
                rect(15.0, 19.0, 8.0, 12.0).rings,
            ]
            .concat(),
        };
        let expected = [
            (place(7.0, 8.0), true),
            (place(40.0, 8.0), false),
            (place(15.0, 8.0), true),
        ];
        assert_eq!(on(&several), expected);
    }
}
