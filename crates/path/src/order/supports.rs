//! The order of a layer's supports, and whether they are printed before the part
//! or after it.
//!
//! In: a layer's outline, the beads of its supports, and whether these end below the
//! layer's top. Out: their order, and true if they are printed after the part.
//!
//! If layers take turns, the nozzle changes between part and supports once in a
//! layer. But the ways between many small supports in the holes of a part lead over
//! the part, and would scratch it if it were printed already. Such supports are
//! printed first in each layer, those of one hole in turn, and the holes on a short
//! way.

use super::jobs::{self, Job};
use super::tour::{Stop, tour};
use glam::DVec2;
use isoslice_base::units::Mm;
use isoslice_planar::bead::Bead;
use isoslice_planar::nest::Nest;
use isoslice_planar::{Area, Solid};
use std::collections::{BTreeMap, BTreeSet};

/// Supports in so many places may come last: with two places, two layers change three
/// times between the part and supports or between places, and four times if supports
/// come first in both.
const PLACES: usize = 2;

/// True if the supports of a layer with this number and outline come last. Those that
/// end below the top of the layer come first if the nozzle would run into the part
/// otherwise: `low` is the radius of the nozzle's flat end in such a layer.
pub fn supports_last(
    number: usize,
    outline: &Solid<'_>,
    supports: &[Bead],
    low: Option<Mm>,
) -> bool {
    let runs_into = |radius: Mm| {
        let mut ways = supports.iter().flat_map(|bead| bead.stroke.segments());
        ways.any(|(a, b)| !outline.grid().clear(a, b, radius))
    };
    let first = number.is_multiple_of(2)
        || apart(outline.area(), supports.iter())
        || low.is_some_and(runs_into);
    !first
}

/// True if the part keeps supports apart in many places, so that it is printed
/// after them in each layer.
fn apart<'a>(outline: &Area, supports: impl Iterator<Item = &'a Bead>) -> bool {
    let places: BTreeSet<_> = places(outline, supports).into_iter().collect();
    places.len() > PLACES
}

/// The place of the air beside the part in which each support begins. Two points
/// are in one place if the same ring is the smallest one around both.
fn places<'a>(
    outline: &Area,
    supports: impl Iterator<Item = &'a Bead>,
) -> Vec<Option<usize>> {
    let nest = Nest::new(outline.rings.iter());
    supports.map(|bead| nest.around(start(bead))).collect()
}

/// Where a bead begins.
fn start(bead: &Bead) -> DVec2 {
    bead.stroke.points.first().copied().unwrap_or_default()
}

/// Prints supports, in one place of the air beside the part after another, on a
/// short way from where the head is.
pub(super) fn print(
    supports: Vec<Bead>,
    outline: &Area,
    at: &mut Option<DVec2>,
    out: &mut Vec<Bead>,
) {
    let places = places(outline, supports.iter());
    // The number of beads in each place, and the sum of their starts.
    let mut sums: BTreeMap<_, (f64, DVec2)> = BTreeMap::new();
    for (bead, place) in supports.iter().zip(&places) {
        let sum = sums.entry(*place).or_default();
        sum.0 += 1.0;
        sum.1 += start(bead);
    }
    let stops = sums.values().map(|(count, sum)| Stop::at(sum / count));
    let stops: Vec<Stop> = stops.collect();
    let mut stages = vec![0; stops.len()];
    for (stage, visit) in (0..).zip(tour(&stops, *at, None)) {
        stages[visit.stop] = stage;
    }
    let stages: BTreeMap<_, u32> = sums.into_keys().zip(stages).collect();
    let jobs = supports.into_iter().zip(places);
    let jobs = jobs.map(|(bead, place)| (stages[&place], Job::of(bead)));
    jobs::print(jobs.collect(), at, None, out);
}

#[cfg(test)]
mod tests {
    use super::*;
    use isoslice_planar::bead::{Role, Stroke};
    use isoslice_planar::{Ring, rect};

    /// A support of 1 mm at x.
    fn support(x: f64) -> Bead {
        let points = vec![DVec2::new(x, 5.0), DVec2::new(x, 6.0)];
        Bead::new(Role::Support, Stroke::new(points, false, 0.45), 0.2)
    }

    /// A plate of 40 mm with four holes in a row.
    fn plate() -> Area {
        let hole = |x: f64| -> Ring {
            let mut area = rect(x - 2.0, 3.0, x + 2.0, 8.0);
            area.rings[0].reverse();
            area.rings.remove(0)
        };
        let mut outline = rect(0.0, 0.0, 40.0, 10.0);
        outline.rings.extend([5.0, 15.0, 25.0, 35.0].map(hole));
        outline
    }

    #[test]
    fn supports_that_the_part_keeps_apart_are_printed_first() {
        let plate = plate();
        let outline = Solid::of(&plate, 1.0);
        let last = |number: usize, at: &[f64]| {
            let beads: Vec<Bead> = at.iter().map(|&x| support(x)).collect();
            supports_last(number, &outline, &beads, None)
        };
        // All beside the part, or in one or two holes: layers take turns.
        for at in [&[-3.0, -4.0][..], &[4.5, 5.5], &[5.0, 14.0, 15.0, 4.0]] {
            assert!(last(3, at) && !last(4, at), "{at:?}");
        }
        for at in [&[5.0, 15.0, 25.0][..], &[-3.0, 5.0, 15.0]] {
            assert!(!last(3, at) && !last(4, at), "{at:?}");
        }
    }

    #[test]
    fn low_supports_come_first_if_the_nozzle_would_run_into_the_part() {
        let outline = rect(0.0, 0.0, 40.0, 10.0);
        let outline = Solid::of(&outline, 1.0);
        let last = |x: f64, low: Option<f64>| {
            supports_last(3, &outline, &[support(x)], low)
        };
        assert!(last(-0.49, None) && last(-0.51, None));
        assert!(last(-0.51, Some(0.5)) && !last(-0.49, Some(0.5)));
    }

    #[test]
    fn what_is_in_one_hole_is_printed_in_turn() {
        let at = [3.5, 13.5, 16.5, 6.5, 15.0, 5.0];
        let beads: Vec<Bead> = at.iter().map(|&x| support(x)).collect();
        for (from, first) in [(0.0, 5.0), (12.0, 15.0), (30.0, 15.0)] {
            let (mut head, mut out) = (Some(DVec2::new(from, 5.0)), Vec::new());
            print(beads.clone(), &plate(), &mut head, &mut out);
            let holes = out
                .iter()
                .map(|bead| (bead.stroke.points[0].x - first).abs());
            let holes: Vec<bool> = holes.map(|d| d < 4.0).collect();
            assert_eq!(holes, [true, true, true, false, false, false]);
        }
    }

    #[test]
    fn holes_are_taken_on_a_short_way_whatever_the_order_of_their_supports() {
        let mut wanted = [5.0, 15.0, 25.0, 35.0];
        for from in [0.0, 40.0] {
            for at in [[25.0, 5.0, 35.0, 15.0], [15.0, 35.0, 5.0, 25.0]] {
                let beads = at.iter().map(|&x| support(x)).collect();
                let mut head = Some(DVec2::new(from, 5.0));
                let mut out = Vec::new();
                print(beads, &plate(), &mut head, &mut out);
                let found: Vec<_> =
                    out.iter().map(|b| b.stroke.points[0].x).collect();
                assert_eq!(found, wanted, "{from} {at:?}");
            }
            wanted.reverse();
        }
    }
}
