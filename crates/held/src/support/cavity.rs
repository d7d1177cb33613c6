//! Whether supports stand in cavities from which nobody can take them.
//!
//! ```text
//!   ┌───────────────┐
//!   │   ┌───┐       │     What is empty in a layer is one with what is empty
//!   │   │   └───────┘     in the next layer where the one lies over the other.
//!   │   └─▒▒▒───────┐
//!   └───────────────┘
//! ```
//!
//! In: the outlines of all layers, and the supports in each. Out: how much of
//! the supports is in holes that no way leads out of, and where.
//!
//! Holes are compared at some places beside each ring, [`BESIDE`] inside what is
//! empty. A way out is not found if it is narrower than that distance, or if it
//! leans so much that its holes in two layers do not overlap. A hole in the lowest
//! layer is a way out, since a part is lifted off the bed.

use super::parts::Parts;
use super::slice::Slice;
use glam::{DVec2, DVec3};
use isoslice_base::parallel;
use isoslice_base::sets::Sets;
use isoslice_base::units::{Mm, Mm3};
use isoslice_planar::nest::Nest;
use isoslice_planar::{Area, edges, point_beside, signed_area};

/// Distance from a ring to what is empty beside it, mm.
const BESIDE: Mm = 0.02;
/// Places that are looked at beside a ring, at most.
const PLACES: usize = 16;
/// Number of layers that are looked at together.
const TOGETHER: usize = 64;
/// The number of the space around the part. Holes have the numbers after it.
const OUTSIDE: usize = 0;

/// Supports that cannot be taken out.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Enclosed {
    /// Volume of these supports.
    pub volume: Mm3,
    /// A point of the largest of these supports, in the model's plane, and its
    /// height above the bed.
    pub worst: DVec3,
}

/// The supports that stand in closed cavities.
pub(super) fn enclosed(parts: Parts<'_>, slices: &[Slice]) -> Enclosed {
    let outlines = parts.outlines;
    let used = slices.iter().rposition(|slice| !slice.is_empty());
    if used.is_none() || !outlines.iter().any(has_holes) {
        return Enclosed::default();
    }
    let mut first = OUTSIDE + 1;
    let numbers: Vec<usize> = outlines
        .iter()
        .map(|outline| {
            first += outline.rings.len();
            first - outline.rings.len()
        })
        .collect();
    let level = |j: usize| Level::new(&outlines[j], numbers[j]);
    let islands = |level: &Level<'_>, j: usize, slice: &Slice| {
        if isoslice_base::limits::is_stopped() {
            return Vec::new();
        }
        let mut within = Vec::new();
        for island in slice.area().islands() {
            let at = island.rings.first().and_then(|r| point_beside(r));
            let hole = at.and_then(|at| level.empty(at));
            if let (Some(at), Some(hole)) = (at, hole)
                && hole != OUTSIDE
            {
                within.push((j, hole, at, island.content()));
            }
        }
        within
    };
    let mut sets = Sets::new(first);
    for end in [0, outlines.len() - 1] {
        let holes = level(end);
        for hole in holes.holes() {
            sets.join(hole, OUTSIDE);
        }
    }
    // What is known of a layer takes more memory than its outline, so only some
    // layers are looked at together.
    let mut within: Vec<(usize, usize, DVec2, f64)> = Vec::new();
    for begin in (0..outlines.len()).step_by(TOGETHER) {
        let end = outlines.len().min(begin + TOGETHER + 1);
        let levels = parallel::map(end - begin, |i| level(begin + i));
        let pairs = parallel::map(levels.len() - 1, |i| {
            joins(&levels[i], &levels[i + 1])
        });
        for [a, b] in pairs.into_iter().flatten() {
            sets.join(a, b);
        }
        let here = slices.len().saturating_sub(begin).min(TOGETHER);
        let found = parallel::map(here, |i| {
            islands(&levels[i], begin + i, &slices[begin + i])
        });
        within.extend(found.into_iter().flatten());
    }
    let outside = sets.of(OUTSIDE);
    let mut enclosed = Enclosed::default();
    let mut largest = 0.0;
    for (j, hole, at, content) in within {
        if sets.of(hole) == outside {
            continue;
        }
        let Some(span) = parts.heights.span(j) else {
            continue;
        };
        enclosed.volume += content * span.height();
        if content > largest {
            largest = content;
            enclosed.worst = at.extend(span.bottom);
        }
    }
    enclosed
}

/// True if an area has holes.
fn has_holes(area: &Area) -> bool {
    area.rings.iter().any(|ring| signed_area(ring) < 0.0)
}

/// The empty spaces of a layer: the holes, and the space around the part.
struct Level<'a> {
    outline: &'a Area,
    nest: Nest,
    /// For each ring, whether it is the border of a hole.
    is_hole: Vec<bool>,
    /// The number of the layer's first ring among the rings of all layers.
    first: usize,
}

impl<'a> Level<'a> {
    fn new(outline: &'a Area, first: usize) -> Level<'a> {
        let rings = outline.rings.iter();
        Level {
            outline,
            nest: Nest::new(rings.clone()),
            is_hole: rings.map(|ring| signed_area(ring) < 0.0).collect(),
            first,
        }
    }

    /// The number of the empty space that a point is in; nothing if the point
    /// is in solid.
    fn empty(&self, at: DVec2) -> Option<usize> {
        match self.nest.around(at) {
            None => Some(OUTSIDE),
            Some(ring) if self.is_hole[ring] => Some(self.first + ring),
            Some(_) => None,
        }
    }

    /// The numbers of the layer's holes.
    fn holes(&self) -> impl Iterator<Item = usize> {
        let holes = self.is_hole.iter().enumerate().filter(|(_, hole)| **hole);
        holes.map(|(ring, _)| self.first + ring)
    }

    /// Places in the empty spaces beside the layer's rings.
    fn beside(&self) -> impl Iterator<Item = DVec2> {
        self.outline.rings.iter().flat_map(|ring| {
            let every = ring.len().div_ceil(PLACES).max(1);
            edges(ring).step_by(every).map(|(a, b)| {
                // Solid is to the left.
                let out = -(b - a).normalize_or_zero().perp();
                a.midpoint(b) + BESIDE * out
            })
        })
    }
}

/// The empty spaces of two layers that lie over each other, as pairs of their
/// numbers.
fn joins(a: &Level<'_>, b: &Level<'_>) -> Vec<[usize; 2]> {
    let none = a.holes().next().is_none() && b.holes().next().is_none();
    if none || isoslice_base::limits::is_stopped() {
        return Vec::new();
    }
    let of = |at: DVec2| Some([a.empty(at)?, b.empty(at)?]);
    let mut pairs: Vec<[usize; 2]> =
        a.beside().chain(b.beside()).filter_map(of).collect();
    pairs.retain(|[a, b]| a != b);
    pairs.sort_unstable();
    pairs.dedup();
    pairs
}
