//! What runs through a whole part from layer to layer, planned before its layers
//! are made: the lines of its seams, and where layers begin.
//!
//! ```text
//!   layer 3   ○ ○ ○ ○ ←    The islands of a layer are visited on a short way. The
//!   layer 2   → ○ ○ ○ ○    next layer goes the same way back, so that it begins
//!   layer 1   ○ ○ ○ ○ ←    where this one ends.
//! ```
//!
//! In: the outlines of a few layers. Out: for each layer where to begin, and where
//! seams are expected. What a layer prints last follows from that alone, and so where
//! the next layer begins; what comes before it is then ordered between the two
//! places.

use super::Stages;
use super::outlines::WallFields;
use crate::SliceError;
use crate::layer::Layer;
use glam::DVec2;
use isoslice_base::limits;
use isoslice_base::parallel;
use isoslice_base::units::Mm;
use isoslice_layer::seam::{BACK, Guide};
use isoslice_path::order::course;
use isoslice_planar::{Ring, signed_area};
use isoslice_settings::layers::LayerSpan;
use rayon::ThreadPool;
use std::ops::Range;

/// Layers from one that is looked at to the next. A seam that moves by 0.2 mm a
/// layer on a circle of 5 mm leaves the straight line from look to look by 0.26 mm.
const STRIDE: usize = 16;
/// Which of so many layers is looked at: one in the middle, so that the highest look
/// is near the top.
const PLACE: usize = 13;

/// Distance from a planned place up to which an island counts as the one that was
/// seen there, mm: a wall that leans by 45° moves by 3 mm from look to look.
const ISLAND_MOVES: Mm = 3.0;

/// What runs through a part.
#[derive(Default)]
pub(crate) struct Course {
    /// The seams, if they are in lines.
    guide: Option<Guide>,
    /// For each layer that was looked at, from below: its number, and the ends of a
    /// short way through its islands.
    ways: Vec<(usize, [DVec2; 2])>,
}

impl Course {
    /// Where the head is likely to come from when a layer begins, if that was
    /// planned.
    pub(crate) fn begin(&self, layer: &Layer) -> Option<DVec2> {
        let span = &layer.span;
        let meant = self.ends_in(layer)?[span.index % 2];
        // An island begins at its seam, which has moved on since the look.
        let away = |p: &DVec2| p.distance_squared(meant);
        let near = |a: &DVec2, b: &DVec2| away(a).total_cmp(&away(b));
        self.seams(span).into_iter().min_by(near).or(Some(meant))
    }

    /// The ends of a short way through the islands of a layer: those that the look
    /// below has found, or, if these are not in the layer or near each other, those
    /// of the look above. An island may begin or end between two looks.
    fn ends_in(&self, layer: &Layer) -> Option<[DVec2; 2]> {
        let next = self.ways.partition_point(|way| way.0 <= layer.span.index);
        let below = next.checked_sub(1).and_then(|k| self.ways.get(k));
        let grid = layer.outline.grid();
        let there = |p: DVec2| grid.nearest_within(p, ISLAND_MOVES).is_some();
        let reach = |[a, b]: [DVec2; 2]| {
            if there(a) && there(b) {
                a.distance(b)
            } else {
                -1.0
            }
        };
        let farther = |best: [DVec2; 2], other: [DVec2; 2]| {
            if reach(other) > reach(best) + ISLAND_MOVES {
                other
            } else {
                best
            }
        };
        let looks = below.into_iter().chain(self.ways.get(next));
        looks.map(|way| way.1).reduce(farther)
    }

    /// Where the seams of a layer are expected.
    pub(crate) fn seams(&self, span: &LayerSpan) -> Vec<DVec2> {
        let guide = self.guide.as_ref();
        guide.map_or_else(Vec::new, |guide| guide.seams(span))
    }

    /// Looks at the next of some layers, with the layer right below it, if there is
    /// one.
    fn look(&mut self, layer: &Layer, below: Option<&Layer>) {
        if let Some(guide) = &mut self.guide {
            let ground = below.and_then(|below| layer.ground(below));
            let below = below.map(|below| (&below.span, &*below.outline));
            guide.look(&layer.span, &layer.outline, below, ground);
        }
        self.visit(layer);
    }

    /// Finds the ends of the way through a layer's islands, each of which begins at
    /// its seam, or at the back.
    fn visit(&mut self, layer: &Layer) {
        let rings = &layer.area().rings;
        let mut seams = vec![None; rings.len()];
        for seam in self.seams(&layer.span) {
            if let Some((ring, _)) = layer.outline.grid().nearest(seam) {
                seams[ring] = Some(seam);
            }
        }
        let back = |a: &DVec2, b: &DVec2| BACK.dot(*a).total_cmp(&BACK.dot(*b));
        let island = |(ring, seam): (&Ring, Option<DVec2>)| {
            let outer = signed_area(ring) > 0.0;
            let place = seam.or_else(|| ring.iter().copied().max_by(back));
            place.filter(|_| outer)
        };
        let islands = rings.iter().zip(seams).filter_map(island);
        let places: Vec<DVec2> = islands.collect();
        let way = course(&places);
        if let (Some(&first), Some(&last)) = (way.first(), way.last()) {
            let ends = [places[first], places[last]];
            self.ways.push((layer.span.index, ends));
        }
    }
}

impl Stages<'_> {
    /// Plans what runs through the part, with a look at few of its layers.
    pub(crate) fn plan_course(
        &mut self,
        pool: &ThreadPool,
        spans: &[LayerSpan],
    ) -> Result<(), SliceError> {
        let mut course = Course {
            guide: self.seams.guide(),
            ways: Vec::new(),
        };
        // The lowest layer tells nothing of how seams move, nor of what hangs.
        let lowest = self.plans.raft.layers;
        let first = (lowest + 1).min(spans.len().saturating_sub(1));
        let flat = |&i: &usize| self.spiral_at(i).is_none();
        let looked = |&i: &usize| i == first || i % STRIDE == PLACE;
        let all = (first..spans.len()).filter(looked).filter(flat);
        let looks: Vec<usize> = all.collect();
        // Some at a time, since a layer may take megabytes.
        for some in looks.chunks(pool.current_num_threads()) {
            limits::go_on()?;
            let pair = |k: usize| {
                let i = some[k];
                self.only(spans, i.saturating_sub(1).max(lowest)..i + 1)
            };
            for layers in parallel::map_in(pool, some.len(), pair) {
                if let [below @ .., layer] = &*layers? {
                    course.look(layer, below.first());
                }
            }
        }
        self.course = course;
        Ok(())
    }

    /// These layers and no others. They are a slab of their own, which costs less
    /// than the whole slab that they are in.
    fn only(
        &self,
        spans: &[LayerSpan],
        layers: Range<usize>,
    ) -> Result<Vec<Layer>, SliceError> {
        let none = &WallFields::None;
        let slab = spans.get(layers.start..layers.end.min(spans.len()));
        let slab = slab.unwrap_or_default();
        self.layers_of(&self.field, none, slab, &layers)
    }
}
