//! Islands that begin on nothing: no solid lies under them in the layer
//! below.
//!
//! In: a layer's outline and the layer below. Out: each such island, and
//! whether it is inside the part, with solid around it. Such an island hangs
//! from the roof of a cavity, out of which supports could not be taken.
//!
//! Not looked for: whether the cavity is closed above and below.

use crate::cover::{Covered, Islands};
use glam::DVec2;
use isoslice_planar::nest::Nest;
use isoslice_planar::{Area, Solid};

/// An island that begins in the air.
#[derive(Clone, Debug, PartialEq)]
pub struct Floating {
    /// Outer ring and holes of the island.
    pub island: Area,
    /// A point of the island.
    pub at: DVec2,
    /// True if the layer below has solid all around the island.
    pub in_cavity: bool,
}

/// A layer's islands that begin in the air over `below`.
pub fn floating(outline: &Area, below: &Solid<'_>) -> Vec<Floating> {
    let mut free = outline.islands();
    // Nearly always the first point of an island tells whether solid is below it, or
    // its middle, where the part gets wider.
    free.retain(|island| {
        let lies_on = |p: DVec2| below.grid().contains(p);
        let Some(ring) = island.rings.first() else {
            return false;
        };
        let mean = ring.iter().sum::<DVec2>() / ring.len().max(1) as f64;
        let first = ring.first().is_some_and(|p| lies_on(*p));
        let lies = first
            || lies_on(mean) && island.contains(mean)
            || ring.iter().any(|p| lies_on(*p));
        !lies
    });
    if free.is_empty() {
        return Vec::new();
    }
    let around = Nest::new(below.area().rings.iter());
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

#[cfg(test)]
mod tests {
    use super::*;
    use isoslice_planar::clip::difference;

    fn rect(x0: f64, x1: f64, low: f64, high: f64) -> Area {
        isoslice_planar::rect(x0, low, x1, high)
    }

    #[test]
    fn what_has_nothing_below_floats_in_a_cavity_or_beside_the_part() {
        let block = rect(0.0, 30.0, 0.0, 30.0);
        let below = difference(&block, &rect(5.0, 25.0, 5.0, 25.0));
        let below = Solid::new(below);
        let on = |area: &Area| -> Vec<(DVec2, bool)> {
            let all = floating(area, &below).into_iter();
            all.map(|f| (f.at, f.in_cavity)).collect()
        };
        let place = DVec2::new;
        let inside = rect(8.0, 12.0, 8.0, 12.0);
        assert_eq!(on(&inside), [(place(8.0, 8.0), true)]);
        assert_eq!(floating(&inside, &below)[0].island, inside);
        // Beside it all, over an edge, and over all of it.
        let beside = rect(40.0, 45.0, 8.0, 12.0);
        assert_eq!(on(&beside), [(place(40.0, 8.0), false)]);
        assert!(on(&rect(3.0, 12.0, 8.0, 12.0)).is_empty());
        assert!(on(&rect(-5.0, 50.0, -5.0, 50.0)).is_empty());
        let several = Area::from_iter([
            rect(7.0, 9.0, 8.0, 9.0),
            beside,
            rect(15.0, 19.0, 8.0, 12.0),
        ]);
        let expected = [
            (place(7.0, 8.0), true),
            (place(40.0, 8.0), false),
            (place(15.0, 8.0), true),
        ];
        assert_eq!(on(&several), expected);
    }
}
