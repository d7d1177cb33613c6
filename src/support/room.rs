//! Where a layer has room for supports.
//!
//! In: the outlines of all layers. Out: for each layer the area that the part
//! takes with its gaps, and the one from which no way leads down to the bed:
//!
//! ```text
//!         ╲░░░╱         above a part, what is nearer to its middle than
//!        ┌─╲░╱─┐        a branch can lean on its way down cannot get past
//!        └─────┘
//! ───────────────────
//! ```
//!
//! That area shrinks upwards by what a branch may lean in a layer:
//! closed(j) = taken(j) ∪ (closed(j − 1) shrunk by h·tan(angle)).

use super::TOLERANCE;
use super::branch::Size;
use super::gaps::{gap_below, top_below};
use super::plan::Parts;
use crate::plane::clip::{crop, difference, union, unite};
use crate::plane::offset::offset;
use crate::plane::simplify::simplify;
use crate::plane::{Area, Rect};
use crate::settings::Settings;
use crate::units::Mm;
use rayon::prelude::*;

/// What of the layers, from the bed, is no place for supports.
pub(super) struct Room {
    /// By layer, the part and what is too near to it.
    taken: Vec<Area>,
    /// By layer, what is too near to the part for the middle of a branch.
    tight: Vec<Area>,
    /// By layer, from where the middle of a branch cannot get down to the bed;
    /// it has what is too near, too.
    closed: Vec<Area>,
}

/// What a support stands on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Foot {
    /// The bed.
    Bed,
    /// Whatever is below.
    Part,
}

impl Room {
    /// The room in the lowest `count` layers.
    pub(super) fn new(
        parts: Parts<'_>,
        count: usize,
        settings: &Settings,
    ) -> Room {
        let taken: Vec<Area> = (0..count)
            .into_par_iter()
            .map(|j| taken(parts, j, settings))
            .collect();
        let core = Size::new(settings).core + TOLERANCE;
        let tight = taken.par_iter();
        let tight: Vec<Area> = tight
            .map(|taken| thinned(offset(taken, core, TOLERANCE)))
            .collect();
        let lean = settings.support.branch_angle.to_radians().tan();
        let mut closed: Vec<Area> = Vec::with_capacity(count);
        for (tight, span) in tight.iter().zip(parts.spans) {
            crate::limits::check();
            let reach = -lean * span.height();
            let left = closed.last().map(|c| offset(c, reach, TOLERANCE));
            closed.push(match left.filter(|left| !left.is_empty()) {
                None => tight.clone(),
                Some(left) => thinned(union(tight, &left)),
            });
        }
        Room {
            taken,
            tight,
            closed,
        }
    }

    /// The part of layer `j` and what is too near to it.
    pub(super) fn taken(&self, j: usize) -> &Area {
        &self.taken[j]
    }

    /// Splits an area of layer `j` into that from which the middle of a branch
    /// gets down to the bed, and the rest where it may be.
    pub(super) fn split(&self, area: &Area, j: usize) -> [Area; 2] {
        let bounds = area.bounds();
        let near = |all: &Area| crop(&all.rings, bounds);
        let free = difference(area, &near(&self.tight[j]));
        let to_bed = difference(&free, &near(&self.closed[j]));
        // Without what is only there by rounding.
        let to_part = offset(&difference(&free, &to_bed), -BESIDE, TOLERANCE);
        let to_part = offset(&to_part, BESIDE, TOLERANCE);
        [to_bed, to_part]
    }

    /// What of a box in layer `j` is no place for the middle of a branch that
    /// stands on `foot`.
    pub(super) fn blocked(&self, j: usize, foot: Foot, within: Rect) -> Area {
        let all = match foot {
            Foot::Bed => &self.closed,
            Foot::Part => &self.tight,
        };
        crop(&all[j].rings, within)
    }
}

/// How far a support is to the side of what is right below or above it within
/// the gaps, mm.
const BESIDE: Mm = 0.05;

/// Where no support may be in layer `j`: the part and what is near to it.
fn taken(parts: Parts<'_>, j: usize, settings: &Settings) -> Area {
    crate::limits::check();
    let Parts {
        spans, outlines, ..
    } = parts;
    // Of which the tolerances of what keeps off may take some.
    let gap = settings.support.xy_gap + TOLERANCE;
    let area = thinned(offset(&outlines[j], gap, TOLERANCE));
    // The layers within the gaps above and below.
    let below = gap_below(spans, j, settings);
    let below = (below.start + 1).min(j)..j;
    let above = (j + 1..spans.len())
        .take_while(|&i| top_below(spans, i, settings).is_none_or(|t| t < j));
    let others = below.chain(above).map(|k| &outlines[k]);
    let others = others.filter(|other| **other != outlines[j]);
    let rings: Vec<_> = others.flat_map(|o| o.rings.clone()).collect();
    if rings.is_empty() {
        return area;
    }
    union(&area, &offset(&unite(&Area { rings }), BESIDE, TOLERANCE))
}

/// The area with fewer points: they would grow in number with every layer.
pub(super) fn thinned(area: Area) -> Area {
    let rings = area.rings.iter().map(|ring| simplify(ring, TOLERANCE));
    Area {
        rings: rings.filter(|ring| ring.len() > 2).collect(),
    }
}

/// A box with a margin on all sides.
pub(super) fn widened(bounds: Rect, by: Mm) -> Rect {
    Rect {
        min: bounds.min - by,
        max: bounds.max + by,
    }
}
