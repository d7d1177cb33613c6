//! A job: all that is known of a run before its first layer is printed.
//!
//! In: a plate and its layers. Out: the stages of each part, with what needs the
//! whole part at once (climbing walls, supports, rafts, draft shields) planned,
//! and the layers of the file.

use super::options::Extent;
use super::plans::Plans;
use super::stages::Stages;
use super::{Options, SliceError};
use crate::report::Gauge;
use glam::DVec2;
use isoslice_base::timings::{Stage, Timings};
use isoslice_base::units::{Mm, Seconds};
use isoslice_model::expressions::Surroundings;
use isoslice_planar::Area;
use isoslice_planar::offset::offset;
use isoslice_plate::{Part, Plate};
use isoslice_preview::{PictureError, outline_from_above};
use isoslice_settings::layers::LayerSpan;
use isoslice_settings::{DraftShield, Supports};
use rayon::ThreadPool;
use std::ops::Range;

/// What a run has to do.
pub(super) struct Run<'a> {
    /// The plate, with its parts on their rafts.
    pub plate: &'a Plate,
    /// The plate without rafts, for pictures.
    pub on_bed: &'a Plate,
    pub options: &'a Options<'a>,
    pub pool: &'a ThreadPool,
    /// All layers of each part.
    pub spans: &'a [Vec<LayerSpan>],
    /// The layers to be written, if all layers print.
    pub layers: Range<usize>,
}

/// What the stages of a part need.
pub(super) struct Base<'a> {
    pub part: &'a Part,
    pub spans: &'a [LayerSpan],
    pub around: Surroundings<'a>,
    pub plans: Plans,
}

impl<'a> Base<'a> {
    pub(super) fn new(part: &'a Part, spans: &'a [LayerSpan]) -> Base<'a> {
        Base {
            part,
            spans,
            around: Surroundings::new(&part.model),
            plans: Plans::of(&part.settings),
        }
    }

    /// The stages of the part, and its layers up to the highest that prints.
    /// `layers` are those to be written.
    ///
    /// # Errors
    /// If there is nothing to print.
    pub(super) fn stages(
        &'a self,
        layers: &Range<usize>,
        options: &Options<'_>,
        pool: &ThreadPool,
    ) -> Result<Planned<'a>, SliceError> {
        let Base {
            part,
            spans,
            around,
            plans,
        } = self;
        let model = &part.model;
        // In a glimpse as few places are measured as in a layer of a whole run.
        let count = match options.glimpse {
            Some(_) => spans.len(),
            None => layers.end.min(spans.len()).saturating_sub(layers.start),
        };
        let gauge =
            Gauge::new(model, &plans.used, count.max(1), options.report)?;
        let stages = Stages::new(model, plans, around, gauge, spans)?;
        let printed = stages.printed(pool, spans)?;
        if printed.layers == 0 {
            return Err(SliceError::NothingToPrint {
                layers: spans.len(),
                line: plans.walls.outer,
            });
        }
        Ok(Planned {
            part,
            stages,
            spans: &spans[..printed.layers],
            top: printed.top,
        })
    }
}

/// True if a part is to have supports where it needs some.
pub(super) fn has_supports(part: &Part) -> bool {
    part.settings.supports != Supports::Off && !part.settings.is_vase()
}

/// A part whose layers can be made.
pub(super) struct Planned<'a> {
    pub part: &'a Part,
    pub stages: Stages<'a>,
    /// The layers up to the highest that prints.
    pub spans: &'a [LayerSpan],
    /// Top of the highest layer in which the part has anything at all, mm.
    pub top: Mm,
}

impl<'a> Planned<'a> {
    /// Plans the part's supports, if it is to have some.
    pub(super) fn plan_supports(
        &mut self,
        base: &'a Base<'a>,
        pool: &ThreadPool,
    ) -> Result<(), SliceError> {
        if !has_supports(self.part) {
            return Ok(());
        }
        let (around, room) = (&base.around, self.part.room());
        self.stages.plan_supports(pool, self.spans, around, room)
    }

    /// Plans what needs all of the part at once. `base` is what the part's stages
    /// were made of. A `glimpse` of one layer needs nothing of other layers.
    fn plan(
        &mut self,
        base: &'a Base<'a>,
        glimpse: bool,
        pool: &ThreadPool,
    ) -> Result<(), SliceError> {
        let (part, spans) = (self.part, self.spans);
        let settings = &part.settings;
        self.stages.plan_spiral(pool, spans)?;
        if !glimpse {
            self.stages.plan_course(pool, spans)?;
        }
        self.plan_supports(base, pool)?;
        let stages = &mut self.stages;
        stages.plan_raft(spans, &base.around, part.room())?;
        if settings.draft_shield == DraftShield::Off {
            stages.plan_skirt(spans)
        } else {
            let outline = pool.install(|| outline_of(part))?;
            stages.plan_shield(spans, &outline);
            Ok(())
        }
    }
}

/// A run that is ready to print.
pub(super) struct Job<'a> {
    pub plate: &'a Plate,
    /// The plate's parts; there is at least one.
    pub parts: Vec<Planned<'a>>,
    /// The places in the order of their parts, if these are printed one by one.
    pub turns: Option<Vec<usize>>,
    /// The layers of the highest part.
    pub spans: &'a [LayerSpan],
    /// Number of all layers. Those of parts that are printed one by one add up.
    pub count: usize,
    /// The layers of the run.
    pub extent: Extent,
}

impl<'a> Job<'a> {
    /// Plans the parts of a run's plate, one for each of `bases`.
    ///
    /// # Errors
    /// If a part cannot be printed or planned, or if there is none.
    pub(super) fn new(
        run: &Run<'a>,
        bases: &'a [Base<'a>],
    ) -> Result<Job<'a>, SliceError> {
        let Run {
            plate,
            options,
            pool,
            ..
        } = *run;
        let mut parts = Vec::with_capacity(bases.len());
        for base in bases {
            let made = base.stages(&run.layers, options, pool);
            parts.push(made.map_err(|e| SliceError::of(plate, base.part, e))?);
        }
        // There are as many layers as the highest part has.
        let tallest = parts.iter().map(|planned| planned.spans);
        let Some(spans) = tallest.max_by_key(|spans| spans.len()) else {
            return Err(SliceError::NoParts);
        };
        let layers = options.indices(spans)?;
        let turns = plate.turns();
        for (planned, base) in parts.iter_mut().zip(bases) {
            let made = planned.plan(base, options.glimpse.is_some(), pool);
            made.map_err(|e| SliceError::of(plate, base.part, e))?;
        }
        let count = match &turns {
            Some(_) => {
                let places = plate.shifts().into_iter();
                places.map(|(part, _)| parts[part].spans.len()).sum()
            }
            None => spans.len(),
        };
        let layers = match &turns {
            Some(_) => options.layers.indices(count)?,
            None => layers,
        };
        Ok(Job {
            plate,
            extent: options.extent(layers),
            parts,
            turns,
            spans,
            count,
        })
    }

    /// The stopwatch for what belongs to no part.
    pub(super) fn stopwatch(&self) -> &Timings {
        &self.parts[0].stages.timings
    }

    /// Where the processor time went, added up over all parts.
    pub(super) fn timings(&self) -> Vec<(Stage, Seconds)> {
        let of = |stage| {
            let parts = self.parts.iter();
            parts.map(|p| p.stages.timings.seconds(stage)).sum()
        };
        Stage::ALL.map(|stage| (stage, of(stage))).to_vec()
    }
}

/// A convex ring around what is printed of a part.
pub(super) fn outline_of(part: &Part) -> Result<Vec<DVec2>, PictureError> {
    /// Tolerance of the ring's round corners, mm.
    const TOLERANCE: Mm = 0.02;
    let reach = part.settings.reach();
    let ring = outline_from_above(&part.model)?;
    if reach <= 0.0 {
        return Ok(ring);
    }
    let grown = offset(&Area::from(ring), reach, TOLERANCE);
    Ok(grown.rings.into_iter().next().unwrap_or_default())
}
