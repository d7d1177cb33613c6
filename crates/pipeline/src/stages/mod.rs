//! The stages that run for many layers at a time, on any thread.
//!
//! In: a slab's spans. Out: the outlines of its layers, and, once a layer's
//! neighbours are known, its beads. Nothing here depends on the order in which
//! layers are worked on.
//!
//! | file | what it does |
//! |---|---|
//! | `outlines` | outlines from the field |
//! | `printed` | which layers print anything |
//! | `spiral`, `support`, `skirt` | what is planned for all layers at once, and what a layer has of it |
//! | `course` | where layers begin and end, and the lines of their seams |
//! | `inside` | walls and what they leave |
//! | `beads` | all beads of a layer |
//! | `bridges` | skin that replaces what lies over infill |

mod beads;
mod bridges;
mod course;
mod inside;
mod outlines;
mod printed;
mod skirt;
mod spiral;
mod support;

use super::SliceError;
use super::layer::Layer;
use super::plans::{Plans, WallFieldPlan};
use super::raft::Raft;
use super::supported::{Fills, Supported};
use crate::report::Gauge;
use course::Course;
use isoslice_base::timings::Timings;
use isoslice_base::units::Mm;
use isoslice_layer::adhesion::Skirt;
use isoslice_layer::exposure::Exposure;
use isoslice_layer::fuzzy::Fuzzy;
use isoslice_layer::infill::standing::Standing;
use isoslice_layer::infill::{self, Infill};
use isoslice_layer::outline::Growth;
use isoslice_layer::seam::Seams;
use isoslice_model::Model;
use isoslice_model::contour::{Field, field};
use isoslice_model::expressions::Surroundings;
use isoslice_path::spiral::Spiral;
use isoslice_planar::Rect;
use isoslice_settings::layers::LayerSpan;
pub(super) use outlines::ALL_LAYERS;
use outlines::{WallFields, by_depth};
use std::ops::Range;

/// What the layers have in common.
pub(super) struct Stages<'a> {
    pub plans: &'a Plans,
    model: &'a Model,
    /// The part's box in the plane.
    rect: Rect,
    field: Field,
    wall_fields: WallFields,
    seams: Seams<'a>,
    /// What runs through all layers, once it is planned.
    pub course: Course,
    fuzzy: Option<Fuzzy<'a>>,
    /// The skirt, if more layers than the first have it.
    skirt: Option<Skirt>,
    /// The supports, once they are planned.
    support: Option<Supported<'a>>,
    /// Layers of the part that are known from planning its supports, from below.
    known: Vec<Layer>,
    /// The raft, once it is planned.
    raft: Option<Raft<'a>>,
    /// Height of the bed in the model's coordinates.
    bed: Mm,
    /// The climbing wall, if there is one.
    pub spiral: Option<Spiral>,
    /// How far outlines grow, if that differs from place to place.
    growth: Option<Growth>,
    exposure: Exposure<'a>,
    infill: Infill<'a>,
    pub timings: Timings,
    pub gauge: Gauge<'a>,
}

impl<'a> Stages<'a> {
    pub(super) fn new(
        model: &'a Model,
        plans: &'a Plans,
        around: &'a Surroundings<'a>,
        gauge: Gauge<'a>,
        spans: &'a [LayerSpan],
    ) -> Result<Self, SliceError> {
        let rect = model.bounds.from_above();
        let spacing = plans.sample_spacing;
        let make = |depth: Mm| field(&model.tree, depth, rect, spacing);
        let field = make(0.0)?;
        let wall_fields = match plans.wall_fields {
            WallFieldPlan::None => WallFields::None,
            WallFieldPlan::Alike(height) => {
                WallFields::Alike(by_depth(height, &plans.walls, make)?)
            }
            WallFieldPlan::ByHeight => WallFields::ByHeight,
        };
        let site = site(model, rect);
        let infill = Infill::new(plans.infill.clone(), around, site)?;
        Ok(Stages {
            plans,
            model,
            rect,
            field,
            wall_fields,
            seams: Seams::new(&plans.seam, plans.accuracy, around)?,
            course: Course::default(),
            fuzzy: Fuzzy::new(&plans.fuzzy, around)?,
            skirt: None,
            support: None,
            known: Vec::new(),
            raft: None,
            bed: -model.offset.z,
            spiral: None,
            exposure: Exposure::new(plans.exposure, spans),
            growth: Growth::new(&plans.growth, model)?,
            infill,
            timings: Timings::default(),
            gauge,
        })
    }

    /// A rectangle of the bed in the model's coordinates.
    fn in_model(&self, on_bed: Rect) -> Rect {
        let offset = self.model.offset.truncate();
        Rect::new(on_bed.min - offset, on_bed.max - offset)
    }

    /// What fills of supports and of a raft have in common.
    fn fills(&self, around: &'a Surroundings<'a>) -> Fills<'_, 'a> {
        Fills {
            plans: self.plans,
            around,
            site: site(self.model, self.rect),
        }
    }

    /// True if a layer is the part's first one, on a raft.
    pub(super) fn is_on_raft(&self, layer: usize) -> bool {
        self.plans.raft.layers > 0 && layer == self.plans.raft.layers
    }

    /// A check of infill that may stand on nothing, if the settings need one.
    pub(super) fn standing(&self) -> Option<Standing> {
        Standing::new(&self.plans.infill)
    }

    /// Number of layers whose field is walked at a time.
    pub(super) fn slab_layers(&self) -> usize {
        self.field.slab_layers()
    }

    /// The layers whose outlines are needed to make the layers `made` of `count`:
    /// these layers and their neighbours.
    pub(super) fn needed(
        &self,
        made: &Range<usize>,
        count: usize,
    ) -> Range<usize> {
        // The part may end below all of these.
        let below = made.start.saturating_sub(self.reach_below()).min(count);
        below..(made.end + self.reach_above()).clamp(below, count)
    }

    /// Number of layers above a layer that it depends on.
    pub(super) fn reach_above(&self) -> usize {
        self.exposure.reach_above()
    }

    /// Number of layers below a layer that it depends on.
    pub(super) fn reach_below(&self) -> usize {
        // A turn lies on a layer that has to be known.
        let below = usize::from(self.plans.vase);
        self.exposure.reach_below().max(below)
    }
}

/// The site from which the fillings of a part are laid out.
fn site(model: &Model, part: Rect) -> infill::Site {
    infill::Site {
        part,
        height: model.bounds.size().z,
        origin: model.origin.truncate(),
    }
}
