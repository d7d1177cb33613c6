//! From the beads of a layer of a part to their order, and on to paths.
//!
//! In: filled layers of a part. Out: their paths, as if the part stood alone where
//! its model was placed. Where a layer ends depends on no other layer, and the rest of
//! it on nothing of the layers below but where the last one ends. So layers are worked
//! on in any order, on any number of threads. `ways` makes paths of beads in order.

use super::SliceError;
use super::job::{Base, Job, Planned};
use super::layer::{Filled, Layer};
use super::plans::Plans;
use crate::report::LayerFigures;
use glam::DVec2;
use isoslice_base::parallel;
use isoslice_base::timings::{Stage, Timings};
use isoslice_base::units::{Mm2, Mm3};
use isoslice_held::overhangs::LayerOverhang;
use isoslice_layer::adhesion::{keep_on_bed, without_ears};
use isoslice_layer::infill::told::InfillCount;
use isoslice_layer::seam::Ground;
use isoslice_layer::seam::ending::{Ended, cut, endings};
use isoslice_layer::walls::{Reach, Support};
use isoslice_path::order::{self, Begun, LayerBeads, linked, order};
use isoslice_path::pace::rates;
use isoslice_path::travel::LayerPath;
use isoslice_path::z_contouring::ZContouring;
use isoslice_planar::Solid;
use isoslice_planar::bead::Bead;
use isoslice_plate::Part;
use rayon::ThreadPool;
use std::sync::Arc;

/// What makes the paths of one part.
pub(super) struct PartPaths<'a> {
    pub planned: &'a Planned<'a>,
    pub(super) plans: &'a Plans,
    part: &'a Part,
    /// Way from the model's coordinates to the bed's.
    pub(super) offset: DVec2,
    /// What lets beads follow the surface, if they have to.
    pub(super) z_contouring: Option<ZContouring<'a>>,
    /// What lets tops of supports follow the undersides above them, if they have
    /// to.
    pub(super) under: Option<ZContouring<'a>>,
    pub(super) timings: &'a Timings,
}

/// Where a layer ends; none if that is not known, or if it has no bead.
#[derive(Clone, Copy, Default)]
pub(super) struct LayerEnd {
    /// Where the layer is to end. That is known before the order of its beads is.
    planned: Option<DVec2>,
    /// Where its last bead ends.
    at: Option<DVec2>,
}

/// A layer whose end is known.
struct Beginning<'f> {
    filled: &'f Filled,
    /// What holds the layer's walls, unless all of them are held.
    support: Option<Support<'f>>,
    ground: Option<Ground<'f>>,
    /// True if supports hold a part of the layer.
    supported: bool,
    /// Where the head is likely to come from, and where the seams are expected.
    from: Option<DVec2>,
    seams: Vec<DVec2>,
    /// The beads, but for the turns of a climbing wall.
    begun: Begun,
    turns: Vec<Bead>,
    warnings: Vec<String>,
}

impl Beginning<'_> {
    fn context(&self) -> order::Context<'_> {
        order::Context {
            here: self.filled.layer.face(),
            from: self.from,
            seams: &self.seams,
            support: self.support.as_ref(),
            ground: self.ground,
            supported: self.supported,
        }
    }
}

/// The beads of a layer in their order, with the ends of its walls, and what the
/// user should know.
type Ordered = (Vec<Ended>, Vec<String>);

/// A layer of a part whose path is known.
pub(super) struct Passed {
    /// The layer's moves, where the model was placed.
    pub path: LayerPath,
    /// The outline to print.
    pub outline: Arc<Solid<'static>>,
    /// What holds the layer, if that matters: the layer below, if its outline
    /// differs, and supports.
    pub below: Option<Arc<Solid<'static>>>,
    pub held: Option<Solid<'static>>,
}

impl Passed {
    /// Where the layer's beads are in a place that is `shift` away from where
    /// the model was placed.
    pub(super) fn site(&self, shift: DVec2) -> rates::Site<'_> {
        let held = self.held.as_ref().map(Solid::grid);
        let below = self.below.as_ref();
        rates::Site {
            solid: Some(self.outline.grid()),
            reach: below.map(|below| Reach::new(below.grid(), held)),
            shift,
        }
    }
}

/// What of a layer is counted.
pub(super) struct Counted {
    pub layer: Layer,
    /// How the layer lies over the layer below, if their outlines differ.
    pub look: Option<LayerOverhang>,
    /// Its infill.
    pub infill: InfillCount,
    /// Area of gaps that nothing fills.
    pub gap: Mm2,
    /// Number of the part's beads.
    pub beads: usize,
    /// True if there are supports, and the volume of their beads.
    pub supported: bool,
    pub support: Mm3,
    /// The layer's accuracy, if it was measured.
    pub figures: Option<LayerFigures>,
    /// What the user should know.
    pub warnings: Vec<String>,
}

impl Counted {
    /// Counts the beads of a layer.
    pub(super) fn new<'b>(
        filled: &mut Filled,
        beads: impl Iterator<Item = &'b Bead> + Clone,
        warnings: Vec<String>,
    ) -> Counted {
        let of_support = beads.clone().filter(|bead| bead.role.is_support());
        let volume = |bead: &Bead| bead.area() * bead.stroke.length();
        Counted {
            layer: filled.layer.clone(),
            look: filled.look.take(),
            infill: InfillCount::new(
                filled.left_out,
                beads.clone(),
                filled.sparse.area().content(),
            ),
            gap: filled.gap,
            beads: beads.filter(|bead| bead.role.is_part()).count(),
            supported: of_support.clone().next().is_some(),
            support: of_support.map(volume).sum(),
            figures: filled.figures.take(),
            warnings,
        }
    }
}

impl<'a> PartPaths<'a> {
    /// What makes the paths of a job's part.
    ///
    /// # Errors
    /// If an expression of the settings has a mistake.
    pub(super) fn new(
        job: &'a Job<'a>,
        planned: &'a Planned<'a>,
        base: &'a Base<'a>,
        pool: &'a ThreadPool,
    ) -> Result<Self, SliceError> {
        let Planned { part, stages, .. } = planned;
        let [z_contouring, under] =
            [ZContouring::new, ZContouring::of_supports].map(|z_contouring| {
                let plan = stages.plans.z_contouring.clone();
                let (around, timings) = (&base.around, &stages.timings);
                z_contouring(&part.model, plan, around, pool, timings)
                    .map_err(|e| SliceError::of(job.plate, part, e.into()))
            });
        Ok(PartPaths {
            planned,
            plans: stages.plans,
            part,
            offset: part.model.offset.truncate(),
            z_contouring: z_contouring?,
            under: under?,
            timings: &stages.timings,
        })
    }

    /// The paths of some layers, one above the other, on all threads of the pool
    /// that this is called in. `below` is the end of the layer below, and becomes
    /// the end of the highest one.
    pub(super) fn layers(
        &self,
        mut batch: Vec<Filled>,
        below: &mut LayerEnd,
    ) -> Vec<Result<(Passed, Counted), SliceError>> {
        let take = |filled: &mut Filled| std::mem::take(&mut filled.beads);
        let beads: Vec<LayerBeads> = batch.iter_mut().map(take).collect();
        let begin = |i: usize, beads| self.begin(&batch[i], beads);
        let begun = parallel::map_owned(beads, begin);
        let from = |layer: &Beginning<'_>| {
            std::mem::replace(&mut below.planned, layer.begun.end())
        };
        let from: Vec<Option<DVec2>> = begun.iter().map(from).collect();
        let finish = |i: usize, layer| self.finish(layer, from[i]);
        let ordered = parallel::map_owned(begun, finish);
        let from = |(beads, _): &Ordered| {
            let end = beads.last().and_then(Ended::end);
            std::mem::replace(&mut below.at, end)
        };
        let from: Vec<Option<DVec2>> = ordered.iter().map(from).collect();
        let all = batch.into_iter().zip(ordered);
        parallel::map_owned(all, |i, (filled, (beads, warnings))| {
            self.path(filled, beads, warnings, from[i])
        })
    }

    /// True for the part's first layer, which nothing holds but the bed or a raft.
    fn is_first(&self, filled: &Filled) -> bool {
        filled.layer.span.index == self.plans.raft.layers
    }

    /// What a layer stands on, if that is another layer of the part whose outline
    /// differs.
    pub(super) fn stands_on<'f>(
        &self,
        filled: &'f Filled,
    ) -> Option<&'f Arc<Solid<'static>>> {
        let layer = &filled.layer;
        let below = filled.below.as_ref().filter(|_| !self.is_first(filled));
        let below = below.filter(|below| !layer.same_outline(below));
        below.map(Layer::top)
    }

    /// Puts the last beads of a layer in order.
    fn begin<'f>(
        &self,
        filled: &'f Filled,
        mut beads: LayerBeads,
    ) -> Beginning<'f> {
        let layer = &filled.layer;
        let warnings = self.keep_on_bed(&mut beads.skirt, layer.span.index);
        let turns = std::mem::take(&mut beads.turns);
        // A climbing wall leans on the turn below.
        let held = turns.is_empty() && !self.is_first(filled);
        let below = filled.below.as_ref().filter(|_| held);
        let support = self.timings.time(Stage::Travel, || {
            let below = self.stands_on(filled).filter(|_| held)?;
            Support::new(below, &layer.outline, &self.plans.walls)
        });
        let course = &self.planned.stages.course;
        let mut begun = Beginning {
            filled,
            support,
            ground: below.and_then(|below| layer.ground(below)),
            supported: self
                .planned
                .stages
                .is_supported(&layer.face(), below.map(Layer::face).as_ref()),
            from: course.begin(layer),
            seams: course.seams(&layer.span),
            begun: Begun::default(),
            turns,
            warnings,
        };
        let plan = &self.plans.order;
        begun.begun = self
            .timings
            .time(Stage::Order, || order(beads, begun.context(), plan));
        begun
    }

    /// Puts all beads of a layer in order, and gives its walls their ends. `from` is
    /// where the layer below ends.
    fn finish(&self, mut layer: Beginning<'_>, from: Option<DVec2>) -> Ordered {
        let solid = layer.filled.layer.outline.grid();
        let begun = std::mem::take(&mut layer.begun);
        let ended = self.timings.time(Stage::Order, || {
            let plan = &self.plans.order;
            let beads = begun.finish(from, layer.context(), plan);
            let beads = linked(beads, solid, plan);
            let first = self.is_first(layer.filled);
            let mut ended = endings(beads, solid, first, &self.plans.ending);
            let turns = std::mem::take(&mut layer.turns);
            ended.extend(turns.into_iter().map(Ended::from));
            ended
        });
        let beads = self.timings.time(Stage::Travel, || match &layer.support {
            Some(support) => cut(ended, support),
            None => ended,
        });
        (beads, layer.warnings)
    }

    /// Leaves out what of a layer's skirt is not on the bed. A loop that leaves
    /// the bed in one place is left out in all, so that equal parts stay equal.
    /// Returns what the user should know.
    fn keep_on_bed(&self, skirt: &mut Vec<Bead>, index: usize) -> Vec<String> {
        let mut warnings = Vec::new();
        if index == 0 {
            warnings.extend(without_ears(skirt, &self.plans.adhesion.brim));
        }
        for place in &self.part.places {
            if skirt.is_empty() {
                break;
            }
            let offset = self.offset + place.shift;
            let off_bed = keep_on_bed(skirt, offset, self.plans.adhesion.bed);
            for warning in off_bed.into_iter().filter(|_| index == 0) {
                if !warnings.contains(&warning) {
                    warnings.push(warning);
                }
            }
        }
        warnings
    }
}
