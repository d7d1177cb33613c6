//! From the beads of a layer of a part to their order, and on to paths.
//!
//! In: filled layers of a part. Out: their paths, as if the part stood alone where
//! its model was placed. A layer's order depends on no other layer's, and its path
//! on nothing of the layer below but where that ends. So layers can be worked on
//! in any order, on any number of threads. `ways` makes paths of beads in order.

use super::SliceError;
use super::job::{Base, Job, Planned};
use super::layer::{Filled, Layer};
use super::plans::Plans;
use crate::plate::Part;
use crate::report::LayerFigures;
use glam::DVec2;
use isoslice_base::timings::{Stage, Timings};
use isoslice_base::units::{Mm2, Mm3};
use isoslice_held::overhangs::LayerOverhang;
use isoslice_layer::adhesion::{keep_on_bed, without_ears};
use isoslice_layer::seam::Ground;
use isoslice_layer::seam::ending::{Ended, cut, endings};
use isoslice_layer::walls::{Reach, Support};
use isoslice_path::order::{self, Begun, LayerBeads, linked, order};
use isoslice_path::pace::rates;
use isoslice_path::travel::LayerPath;
use isoslice_path::z_contouring::ZContouring;
use isoslice_planar::Solid;
use isoslice_planar::bead::Bead;
use rayon::ThreadPool;
use rayon::prelude::*;
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

/// A layer of a part whose beads are in order.
pub(super) struct Ordered {
    pub beads: Vec<Ended>,
    /// The layer, without its beads.
    pub filled: Filled,
    /// What the user should know.
    pub warnings: Vec<String>,
}

/// Where a layer ends; none if that is not known, or if it has no bead.
#[derive(Clone, Copy, Default)]
pub(super) struct LayerEnd {
    /// Where the layer is to end. That is known before the order of its beads is.
    planned: Option<DVec2>,
    /// Where its last bead ends.
    at: Option<DVec2>,
}

/// What of the layers around a layer matters for its order.
struct Around<'f> {
    /// What holds the layer's walls, unless all of them are held.
    support: Option<Support<'f>>,
    ground: Option<Ground<'f>>,
    /// Where the seams are expected.
    seams: Vec<DVec2>,
}

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
    /// Number of beads of the infill that are left out, since they stand on
    /// nothing.
    pub left_out: usize,
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
            left_out: filled.left_out,
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
                    .map_err(|e| job.plate.named(part, e.into()))
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
        let take = |filled: &mut Filled| {
            let mut beads = std::mem::take(&mut filled.beads);
            let index = filled.layer.span.index;
            let warnings = self.keep_on_bed(&mut beads.skirt, index);
            let turns = std::mem::take(&mut beads.turns);
            (beads, turns, warnings)
        };
        let taken: Vec<_> = batch.iter_mut().map(take).collect();
        let all = batch.par_iter().zip(&taken);
        let around = all.map(|(filled, (_, turns, _))| {
            self.around(filled, !turns.is_empty())
        });
        let around: Vec<Around<'_>> = around.collect();
        let all = batch.par_iter().zip(&around).zip(taken);
        let begun = all.map(|((filled, around), (beads, turns, warnings))| {
            (self.begin(filled, around, beads), turns, warnings)
        });
        let begun: Vec<_> = begun.collect();
        let from =
            |end: Option<DVec2>| std::mem::replace(&mut below.planned, end);
        let from: Vec<_> = begun.iter().map(|b| b.0.end()).map(from).collect();
        let all = batch.par_iter().zip(&around);
        let all = all.zip(begun).zip(from);
        let ended = all.map(|(((filled, around), begun), from)| {
            let (begun, turns, warnings) = begun;
            (self.end(filled, around, begun, turns, from), warnings)
        });
        let ended: Vec<(Vec<Ended>, Vec<String>)> = ended.collect();
        drop(around);
        let from = |(beads, _): &(Vec<Ended>, _)| {
            let end = beads.last().and_then(Ended::end);
            std::mem::replace(&mut below.at, end)
        };
        let from: Vec<Option<DVec2>> = ended.iter().map(from).collect();
        let all = batch.into_par_iter().zip(ended).zip(from);
        let passed = all.map(|((filled, (beads, warnings)), from)| {
            let ordered = Ordered {
                beads,
                filled,
                warnings,
            };
            self.path(ordered, from)
        });
        passed.collect()
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

    /// What is around a layer. A layer that `climbs` leans on the turn below.
    fn around<'f>(&self, filled: &'f Filled, climbs: bool) -> Around<'f> {
        let layer = &filled.layer;
        let below = filled.below.as_ref();
        let below = below.filter(|_| !climbs && !self.is_first(filled));
        let support = self.timings.time(Stage::Travel, || {
            let below = self.stands_on(filled).filter(|_| !climbs)?;
            Support::new(below, &layer.outline, &self.plans.walls)
        });
        Around {
            support,
            ground: below.and_then(|below| layer.ground(below)),
            seams: self.planned.stages.course.seams(&layer.span),
        }
    }

    /// Puts the last beads of a layer in order.
    fn begin<'f>(
        &'f self,
        filled: &'f Filled,
        around: &'f Around<'f>,
        beads: LayerBeads,
    ) -> Begun<'f> {
        let layer = &filled.layer;
        let context = order::Context {
            here: layer.face(),
            from: self.planned.stages.course.begin(layer),
            seams: &around.seams,
            support: around.support.as_ref(),
            ground: around.ground,
        };
        self.timings
            .time(Stage::Order, || order(beads, context, &self.plans.order))
    }

    /// Puts all beads of a layer in order, and gives its walls their ends. `from` is
    /// where the layer below ends.
    fn end(
        &self,
        filled: &Filled,
        around: &Around<'_>,
        begun: Begun<'_>,
        turns: Vec<Bead>,
        from: Option<DVec2>,
    ) -> Vec<Ended> {
        let solid = filled.layer.outline.grid();
        let ended = self.timings.time(Stage::Order, || {
            let beads = linked(begun.from(from), solid, &self.plans.order);
            let first = self.is_first(filled);
            let mut ended = endings(beads, solid, first, &self.plans.ending);
            ended.extend(turns.into_iter().map(Ended::from));
            ended
        });
        self.timings.time(Stage::Travel, || match &around.support {
            Some(support) => cut(ended, support),
            None => ended,
        })
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
