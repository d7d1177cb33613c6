//! What neighbouring layers leave open of an area, island by island.
//!
//! Most of a layer's fill lies well inside most of its neighbours, or far
//! outside them. So the neighbours' edges are first looked up in a grid of
//! the islands' edges. If no edge of a neighbour comes into an island, the
//! neighbour covers all of the island or nothing of it, and any point of the
//! island tells which. For other islands the first neighbours often tell that
//! nothing that matters is covered. Only if they do not, all neighbours that
//! touch the island go into one sweep.

pub mod neighbour;

use isoslice_base::units::Mm;
use isoslice_planar::clip::{crop, intersection, not_covered_by_all};
use isoslice_planar::grid::EdgeGrid;
use isoslice_planar::nest::Nest;
use isoslice_planar::{Area, Rect, Solid, edges, point_beside};
use neighbour::Neighbour;

/// How far borders between skin and sparse infill may be off, mm: nobody sees
/// these borders, and a bead is much wider.
pub const TOLERANCE: Mm = 0.02;

/// The part of an island that is not covered by all covers.
#[derive(Clone, Debug, PartialEq)]
pub enum Exposed {
    /// No part: each cover covers all of the island.
    Nowhere,
    /// This part of the island is not covered.
    Part(Area),
    /// The whole island, or all but parts that do not matter.
    Everywhere,
}

/// How much of an island one cover covers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Covered {
    /// All of the island.
    Wholly,
    /// A part of the island, or all of it except along its border.
    Partly,
    /// Nothing of the island.
    Not,
}

/// Connected areas, to be asked what covers touch or cover of them.
pub struct Islands<'a> {
    all: &'a [Area],
    /// Edges of the islands.
    grid: EdgeGrid,
    /// The box around all of them.
    bounds: Rect,
    /// Outer rings of the islands.
    nest: Nest,
}

/// Size of the cells in which islands are looked up, mm.
const CELL: Mm = 1.0;

impl<'a> Islands<'a> {
    /// Islands, each an outer ring followed by its holes.
    pub fn new(all: &'a [Area]) -> Islands<'a> {
        let edges = all.iter().enumerate().flat_map(|(i, island)| {
            let all = island.rings.iter().flat_map(|r| edges(r));
            all.map(move |e| (i, e))
        });
        Islands {
            all,
            grid: EdgeGrid::of(edges, CELL),
            bounds: all.iter().fold(Rect::EMPTY, |r, i| r.union(i.bounds())),
            nest: Nest::new(all.iter().filter_map(|i| i.rings.first())),
        }
    }

    /// How much of each island a cover covers.
    pub fn covered(&self, cover: &Solid<'_>) -> Vec<Covered> {
        let of = |(island, touched): (&Area, bool)| {
            let p = island.rings.first().and_then(|r| r.first());
            match p {
                Some(_) if touched => Covered::Partly,
                Some(&p) if cover.grid().contains(p) => Covered::Wholly,
                _ => Covered::Not,
            }
        };
        self.all.iter().zip(self.touching(cover)).map(of).collect()
    }

    /// For each island, true if an edge of the cover runs in it.
    fn touching(&self, cover: &Solid<'_>) -> Vec<bool> {
        let mut touched = vec![false; self.all.len()];
        for ring in &cover.area().rings {
            let mut meets = false;
            let around = Rect::around(ring);
            if !around.meets(self.bounds) {
                continue;
            }
            for (a, b) in edges(ring) {
                let (lo, hi) = (a.min(b), a.max(b));
                if !self.bounds.meets(Rect::new(lo, hi)) {
                    continue;
                }
                self.grid.visit_near(a, b, TOUCH, |i| {
                    touched[i] = true;
                    meets = true;
                });
            }
            // A ring that meets no border is inside one island or in none.
            if !meets
                && let Some(&p) = ring.first()
                && self.bounds.contains(p)
                && self.grid.contains(p)
                && let Some(i) = self.nest.around(p)
            {
                touched[i] = true;
            }
        }
        touched
    }
}

/// What a cover leaves open of an area; see [`not_covered_by_all`].
pub fn open(area: &Area, cover: &Area) -> Area {
    not_covered_by_all(area, &[&near(area, cover)])
}

/// What a cover has around an area, enough to tell what it covers of it.
pub fn near(area: &Area, cover: &Area) -> Area {
    crop(&cover.rings, area.bounds().grown(1.0))
}

/// An edge nearer than this counts as touching, mm.
const TOUCH: Mm = 1e-4;

/// Where the covers, together, leave each island open. `matters` tells whether
/// it matters that a connected area is covered. If an area does not matter, its
/// parts must not matter either.
pub fn exposed(
    asked: &Islands<'_>,
    covers: &[&Solid<'_>],
    matters: impl Fn(&Area) -> bool,
) -> Vec<Exposed> {
    let touching: Vec<Vec<bool>> =
        covers.iter().map(|c| asked.touching(c)).collect();
    let islands = asked.all;
    let mut result: Vec<Exposed> = islands
        .iter()
        .enumerate()
        .map(|(i, island)| {
            let Some(&p) = island.rings.first().and_then(|r| r.first()) else {
                return Exposed::Everywhere;
            };
            let open = |(k, c): (usize, &&Solid<'_>)| {
                !touching[k][i] && !c.grid().contains(p)
            };
            if covers.iter().enumerate().any(open) {
                Exposed::Everywhere
            } else {
                Exposed::Nowhere
            }
        })
        .collect();
    let left: Vec<usize> = (0..islands.len())
        .filter(|&i| {
            result[i] == Exposed::Nowhere && touching.iter().any(|t| t[i])
        })
        .collect();
    if left.is_empty() {
        return result;
    }
    let sorted: Vec<Neighbour<'_>> =
        covers.iter().map(|c| Neighbour::new(c.area())).collect();
    for i in left {
        if isoslice_base::limits::is_stopped() {
            break;
        }
        let touching = sorted.iter().zip(&touching).filter(|(_, t)| t[i]);
        let near: Vec<Area> =
            touching.map(|(cover, _)| cover.near(&islands[i])).collect();
        result[i] = if anything_matters(&islands[i], &near, &matters) {
            let near: Vec<&Area> = near.iter().collect();
            part(not_covered_by_all(&islands[i], &near))
        } else {
            Exposed::Everywhere
        };
    }
    result
}

/// Whether what all covers cover of an island may matter. Intersections with
/// the first covers often leave little, and then going on costs little. If they
/// leave much, the sweep of all covers is faster.
fn anything_matters(
    island: &Area,
    covers: &[Area],
    matters: &impl Fn(&Area) -> bool,
) -> bool {
    /// Intersections after which half of the island must be gone.
    const TRIALS: usize = 2;
    let mut rest = island.clone();
    for (k, cover) in covers.iter().enumerate() {
        if k == TRIALS && rest.content() > 0.5 * island.content() {
            return true;
        }
        let parts = intersection(&rest, cover).islands().into_iter();
        rest.rings =
            parts.filter(|p| matters(p)).flat_map(|p| p.rings).collect();
        if rest.is_empty() {
            return false;
        }
    }
    true
}

/// Areas by the island that each of them lies in.
pub fn by_island(islands: &[Area], areas: Vec<Area>) -> Vec<Area> {
    let nest = Nest::new(islands.iter().filter_map(|p| p.rings.first()));
    let mut sorted: Vec<Area> = vec![Area::EMPTY; islands.len()];
    for area in areas {
        let p = area.rings.first().and_then(|r| point_beside(r));
        if let Some(i) = p.and_then(|p| nest.around(p)) {
            sorted[i].rings.extend(area.rings);
        }
    }
    sorted
}

fn part(open: Area) -> Exposed {
    if open.is_empty() {
        Exposed::Nowhere
    } else {
        Exposed::Part(open)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use isoslice_planar::clip::{difference, union};
    use isoslice_planar::shapes::rect;

    /// What is covered of each island.
    fn contents(islands: &[Area], covers: &[Area]) -> Vec<f64> {
        let covers: Vec<Solid<'_>> =
            covers.iter().map(|c| Solid::of(c, 1.0)).collect();
        let covers: Vec<&Solid<'_>> = covers.iter().collect();
        let of = |(e, island): (&Exposed, &Area)| match e {
            Exposed::Nowhere => island.content(),
            Exposed::Part(part) => island.content() - part.content(),
            Exposed::Everywhere => 0.0,
        };
        let asked = Islands::new(islands);
        let all = exposed(&asked, &covers, |a| a.content() > 1.0);
        all.iter().zip(islands).map(of).collect()
    }

    #[test]
    fn islands_are_covered_wholly_partly_or_not() {
        let islands = [
            rect(0.0, 0.0, 10.0, 10.0),
            rect(20.0, 0.0, 30.0, 10.0),
            rect(40.0, 0.0, 50.0, 10.0),
            rect(60.0, 0.0, 70.0, 10.0),
        ];
        let wide = rect(-5.0, -5.0, 100.0, 20.0);
        // A ring of the cover inside one island, and a gap around another.
        let holed = difference(&wide, &rect(3.0, 3.0, 5.0, 5.0));
        let gap = rect(39.0, -1.0, 51.0, 11.0);
        let holed = difference(&holed, &gap);
        let half = rect(-5.0, -5.0, 66.0, 20.0);
        let found = contents(&islands, &[wide, holed, half]);
        for (f, e) in found.iter().zip([96.0, 100.0, 0.0, 60.0]) {
            assert!((f - e).abs() < 1e-6, "{found:?}");
        }
    }

    #[test]
    fn one_cover_covers_all_some_or_nothing() {
        let islands = [
            rect(0.0, 0.0, 10.0, 10.0),
            rect(20.0, 0.0, 30.0, 10.0),
            rect(40.0, 0.0, 50.0, 10.0),
        ];
        let area = rect(-1.0, -1.0, 24.0, 11.0);
        use Covered::{Not, Partly, Wholly};
        let covered = Islands::new(&islands).covered(&Solid::of(&area, 1.0));
        assert_eq!(covered, [Wholly, Partly, Not]);
        assert!((open(&islands[1], &area).content() - 60.0).abs() < 1e-6);
        assert!((open(&islands[2], &area).content() - 100.0).abs() < 1e-6);
    }

    #[test]
    fn holes_inside_the_island_s_own_holes_do_not_matter() {
        let frame =
            difference(&rect(0.0, 0.0, 20.0, 20.0), &rect(5.0, 5.0, 9.0, 9.0));
        let cover = difference(
            &rect(-1.0, -1.0, 21.0, 21.0),
            &rect(6.0, 6.0, 8.0, 8.0),
        );
        let cover = Solid::new(cover);
        let all = exposed(&Islands::new(&[frame]), &[&cover], |_| true);
        assert_eq!(all, [Exposed::Nowhere]);
    }

    #[test]
    fn many_islands_may_lie_under_one_ring() {
        // A comb-like cover with an edge in each of many islands.
        let islands: Vec<Area> = (0..60)
            .map(|i| {
                let x = 4.0 * f64::from(i);
                rect(x, 0.0, x + 3.0, 10.0)
            })
            .collect();
        let mut cover = rect(-1.0, -2.0, 300.0, -1.0);
        for i in 0..60 {
            let x = 4.0 * f64::from(i) + 1.0;
            cover = union(&cover, &rect(x, -1.5, x + 5.0 / 3.0, 5.0));
        }
        assert_eq!(cover.rings.len(), 1);
        for c in contents(&islands, &[cover]) {
            assert!((c - 25.0 / 3.0).abs() < 1e-3, "{c}");
        }
    }
}
