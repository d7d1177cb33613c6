//! The stages that run for many layers at a time, on any thread.
//!
//! In: a slab's spans. Out: the outlines of its layers, and, once a layer's
//! neighbours are known, its beads. Nothing here depends on the order in which
//! layers are worked on.

use super::layer::{Inside, Layer, SAME_HEIGHT, faces, window};
use super::raft::{self, Raft};
use super::sound::{self, Found};
use super::supported::{Fills, Supported};
use super::{BLOCK, SliceError, shielded};
use crate::adhesion::{Skirt, loops};
use crate::bead::{Bead, Role};
use crate::contour::{
    Detail, Field, FieldError, Outline, field, field_in, outlines,
};
use crate::fuzzy::Fuzzy;
use crate::hang::Look;
use crate::infill::{self, Infill, InfillError};
use crate::layers::LayerSpan;
use crate::limits;
use crate::model::Model;
use crate::order::LayerBeads;
use crate::plane::clip::union;
use crate::plane::offset::offset;
use crate::plane::{Area, Rect, Solid};
use crate::region::compensate::{Compensation, Growth};
use crate::region::cover::rough;
use crate::region::exposure::{Exposure, FillAreas, roomy};
use crate::region::{
    OUTLINE_SHARE, Walls, field_walls, wall_depths, walls_below,
};
use crate::report::{Gauge, LayerFigures, LayerParts, ReportError};
use crate::resolution::thin;
use crate::seam::Seams;
use crate::settings::{DraftShield, Settings, WallOffset};
use crate::skin::Patch;
use crate::skin::over_infill::{Below, Level, Over, Under, bridged};
use crate::spiral::Spiral;
use crate::support::{Asked, Heights, Plan, Survey, Wishes, coarse};
use crate::timings::{Stage, Timings};
use crate::units::Mm;
use crate::vary::{Surroundings, VaryError};
use crate::{skin, walls};
use glam::DVec2;
use rayon::ThreadPool;
use rayon::prelude::*;
use std::collections::VecDeque;
use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Extent below which an island or a hole is left out, as a share of the outer
/// wall's width.
const PRINTABLE: f64 = 0.25;

/// About how many layers' outlines a high skirt is laid round. It keeps a
/// distance from the part, which the layers in between do not exceed.
const SKIRT_SAMPLES: usize = 64;

/// Number of points of the outlines that are kept from planning supports to
/// printing. They take about 100 bytes each. Outlines beyond that are found a
/// second time.
const KNOWN: usize = 2_000_000;

/// The fields of the walls by their depths, if walls are offsets of the
/// expression.
enum WallFields {
    /// They are not.
    None,
    /// All layers have the same.
    Alike(Vec<(Mm, Field)>),
    /// A wall's depth depends on its layer's height, so fields are made for each.
    ByHeight,
}

/// The fields of the walls in a layer of a height, and that of what they leave,
/// each with its depth.
fn by_depth(
    height: Mm,
    settings: &Settings,
    make: impl Fn(Mm) -> Result<Field, FieldError>,
) -> Result<Vec<(Mm, Field)>, FieldError> {
    let (depths, border) = wall_depths(height, settings);
    let depths = depths.into_iter().chain([border]);
    depths.map(|d| Ok((d, make(d)?))).collect()
}

/// What the layers have in common.
pub(super) struct Stages<'a> {
    settings: &'a Settings,
    model: &'a Model,
    /// The part's box in the plane.
    rect: Rect,
    field: Field,
    wall_fields: WallFields,
    seams: Seams<'a>,
    fuzzy: Option<Fuzzy<'a>>,
    /// The skirt, if more layers than the first have it.
    skirt: Option<Skirt>,
    /// The supports, once they are planned.
    support: Option<Supported<'a>>,
    /// Layers of the part that are known from planning its supports, from below.
    known: Vec<Layer>,
    /// The raft, once it is planned, and the number of its layers.
    raft: Option<Raft<'a>>,
    raft_layers: usize,
    /// Height of the bed in the model's coordinates.
    bed: Mm,
    /// The climbing wall, if there is one.
    pub spiral: Option<Spiral<'a>>,
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
        settings: &'a Settings,
        around: &'a Surroundings<'a>,
        gauge: Gauge<'a>,
        spans: &'a [LayerSpan],
    ) -> Result<Self, SliceError> {
        let rect = Rect {
            min: model.bounds.min.truncate(),
            max: model.bounds.max.truncate(),
        };
        let spacing = settings.sample_spacing;
        let make = |depth: Mm| field(&model.tree, depth, rect, spacing);
        let field = make(0.0)?;
        let wall_fields = match settings.wall_offset {
            WallOffset::Distance => WallFields::None,
            WallOffset::Field if settings.is_uniform() => WallFields::Alike(
                by_depth(settings.layer_height(), settings, make)?,
            ),
            WallOffset::Field => WallFields::ByHeight,
        };
        let printer = &settings.printer;
        let bed = 0.5 * DVec2::new(printer.bed_x, printer.bed_y);
        let site = infill::Site {
            part: rect,
            height: model.bounds.size().z,
            bed: bed - model.offset.truncate(),
            origin: model.origin.truncate(),
        };
        let mut stages = Stages {
            settings,
            model,
            rect,
            field,
            wall_fields,
            seams: Seams::new(settings, around)?,
            fuzzy: Fuzzy::new(settings, around)?,
            skirt: None,
            support: None,
            known: Vec::new(),
            raft: None,
            raft_layers: settings.raft_layers(),
            bed: -model.offset.z,
            spiral: None,
            exposure: Exposure::new(settings, spans),
            growth: Growth::new(settings, model)?,
            infill: Infill::new(settings, around, site)?,
            timings: Timings::default(),
            gauge,
        };
        let shield = settings.draft_shield != DraftShield::Off;
        let high = settings.skirt.loops > 0 && settings.skirt.layers > 1;
        if high && !shield {
            stages.skirt = Some(stages.skirt_round(spans)?);
        }
        Ok(stages)
    }

    /// The skirt round all layers that stand beside it, or round some of them
    /// if it is high.
    fn skirt_round(&self, spans: &[LayerSpan]) -> Result<Skirt, SliceError> {
        let layers = self.settings.skirt.layers as usize;
        let areas = self.beside(spans, layers)?;
        Ok(Skirt::new(&areas, self.settings))
    }

    /// What stands of the part and its supports in the lowest `layers`, or in
    /// some of them if they are many.
    pub(super) fn beside(
        &self,
        spans: &[LayerSpan],
        layers: usize,
    ) -> Result<Vec<Area>, SliceError> {
        let beside = &spans[..spans.len().min(layers)];
        let step = beside.len().div_ceil(SKIRT_SAMPLES).max(1);
        let mut areas = Vec::new();
        for span in beside.iter().step_by(step).chain(beside.last()) {
            let of_span =
                self.layers(std::slice::from_ref(span), &(0..usize::MAX))?;
            areas.extend(of_span.iter().map(|l| l.area().clone()));
        }
        let slice = |s: &LayerSpan| self.support.as_ref()?.slice(s.index);
        let support = beside.iter().filter_map(slice);
        let support = support.flat_map(|s| [&s.body, &s.interface]);
        areas.extend(support.cloned());
        areas.extend(self.raft.iter().map(|raft| raft.area.clone()));
        Ok(areas)
    }

    /// Plans the supports of the whole part, `spans`. `fills` are the settings
    /// by which supports and their dense tops are filled. `room` is the part of
    /// the bed that supports may use.
    ///
    /// # Errors
    /// If the part's outlines cannot be found, or `support.where` has no value
    /// somewhere.
    pub(super) fn plan_supports(
        &mut self,
        pool: &ThreadPool,
        spans: &'a [LayerSpan],
        around: &'a Surroundings<'a>,
        fills: &'a Fills,
        room: Rect,
    ) -> Result<(), SliceError> {
        let wishes = Wishes::new(self.settings, around)?;
        let asked = Asked {
            wishes: wishes.as_ref(),
            settings: self.settings,
        };
        // The plan does not know the raft, which serves as its bed.
        let raft = (self.raft_layers, self.settings.raft_height());
        let above = spans.iter().skip(self.raft_layers);
        let above = above.map(|span| without_raft(*span, raft)).collect();
        let heights = Heights::new(above, self.settings);
        let sections = self.sections(pool, &heights)?;
        let (stages, left): (&Stages<'a>, _) = (self, AtomicUsize::new(KNOWN));
        let of_slab = |slab: &[LayerSpan]| {
            let layers = stages.layers(slab, &(0..usize::MAX))?;
            let found = layers
                .iter()
                .map(|layer| (without_raft(layer.span, raft), layer.area()));
            let survey = || Survey::new(found, asked);
            let survey = stages.timings.time(Stage::Support, survey)?;
            let kept = keep(&layers, &left);
            Ok::<_, SliceError>((survey, kept.then_some(layers)))
        };
        let slabs = spans[self.raft_layers..].par_chunks(self.slab_layers());
        let made: Vec<Result<_, SliceError>> =
            pool.install(|| slabs.map(of_slab).collect());
        let mut survey = Survey::default();
        let mut known = Vec::new();
        for slab in made {
            let (above, layers) = slab?;
            survey.append(above, asked)?;
            known.extend(layers.into_iter().flatten());
        }
        let bed = self.in_model(room);
        let plan = pool.install(|| {
            let plan = || Plan::new(survey, sections, heights, bed, asked);
            self.timings.time(Stage::Support, plan)
        });
        self.known = known;
        let site = self.site();
        self.support = Some(Supported::new(plan, fills, around, site)?);
        if self.skirt.is_some() {
            self.skirt = Some(self.skirt_round(spans)?);
        }
        Ok(())
    }

    /// The part at half the height of each layer's supports, where that is not
    /// half the height of the layer.
    fn sections(
        &self,
        pool: &ThreadPool,
        heights: &Heights,
    ) -> Result<Option<Vec<Area>>, SliceError> {
        if heights.own().eq(heights.spans().iter().copied()) {
            return Ok(None);
        }
        let lift = self.settings.raft_height();
        let own: Vec<LayerSpan> = heights
            .own()
            .map(|span| LayerSpan {
                index: span.index + self.raft_layers,
                bottom: span.bottom + lift,
                top: span.top + lift,
            })
            .collect();
        let of_slab = |slab: &[LayerSpan]| {
            let all = 0..usize::MAX;
            let none = &WallFields::None;
            let layers = self.layers_of(&self.field, none, slab, &all)?;
            let sections =
                layers.iter().map(|l| coarse(l.area(), self.settings));
            Ok::<_, SliceError>(sections.collect())
        };
        let slabs = own.par_chunks(self.slab_layers());
        let made: Vec<Result<Vec<Area>, SliceError>> =
            pool.install(|| slabs.map(of_slab).collect());
        let made: Vec<Vec<Area>> =
            made.into_iter().collect::<Result<_, _>>()?;
        Ok(Some(made.concat()))
    }

    /// Plans the raft of the whole part, `spans`, after its supports, if there
    /// is a raft. The raft carries the layers up to the lowest one in which a
    /// line of the part has room, since the layers below that are empty, or
    /// nearly so.
    ///
    /// # Errors
    /// If the outlines above the raft cannot be found.
    pub(super) fn plan_raft(
        &mut self,
        spans: &[LayerSpan],
        around: &'a Surroundings<'a>,
        fills: &'a raft::Fills,
        room: Rect,
    ) -> Result<(), SliceError> {
        let first = self.raft_layers;
        if first == 0 {
            return Ok(());
        }
        let s = self.settings;
        let half = 0.5 * s.thinnest_line();
        let mut under = Area::EMPTY;
        for span in spans.iter().skip(first) {
            limits::check();
            let of_span =
                self.layers(std::slice::from_ref(span), &(0..usize::MAX))?;
            if let Some(support) = self.support_area(span.index) {
                under = union(&under, &support);
            }
            let Some(layer) = of_span.first() else {
                continue;
            };
            under = union(&under, layer.area());
            if !offset(layer.area(), -half, s.accuracy).is_empty() {
                break;
            }
        }
        let raft =
            Raft::new(&under, self.in_model(room), fills, around, self.site())?;
        self.raft = Some(raft);
        if self.skirt.is_some() {
            self.skirt = Some(self.skirt_round(spans)?);
        }
        Ok(())
    }

    /// The part and its supports as seen from above. `part` lies around the
    /// part, on the bed.
    pub(super) fn seen_from_above(
        &self,
        spans: &[LayerSpan],
        part: &[DVec2],
    ) -> Vec<Area> {
        let offset = self.model.offset.truncate();
        let part = Area {
            rings: vec![part.iter().map(|p| p - offset).collect()],
        };
        let supports = spans.iter();
        let supports = supports.filter_map(|s| self.support_area(s.index));
        std::iter::once(part).chain(supports).collect()
    }

    /// Plans the draft shield of the whole part, `spans`, after its supports
    /// and its raft. `part` lies around the part as seen from above, on the
    /// bed.
    pub(super) fn plan_shield(&mut self, spans: &[LayerSpan], part: &[DVec2]) {
        let all = self.seen_from_above(spans, part);
        let layers = shielded(spans, self.settings);
        self.skirt = Some(Skirt::shield(&all, layers, self.settings));
    }

    /// A rectangle of the bed in the model's coordinates.
    fn in_model(&self, on_bed: Rect) -> Rect {
        let offset = self.model.offset.truncate();
        Rect {
            min: on_bed.min - offset,
            max: on_bed.max - offset,
        }
    }

    /// The site from which fillings of supports are laid out.
    fn site(&self) -> infill::Site {
        let printer = &self.settings.printer;
        let bed = 0.5 * DVec2::new(printer.bed_x, printer.bed_y);
        infill::Site {
            part: self.rect,
            height: self.model.bounds.size().z,
            bed: bed - self.model.offset.truncate(),
            origin: self.model.origin.truncate(),
        }
    }

    /// True if a layer is the part's first one, on a raft.
    pub(super) fn is_on_raft(&self, layer: usize) -> bool {
        self.raft_layers > 0 && layer == self.raft_layers
    }

    /// The supports, once they are planned.
    pub(super) fn support(&self) -> Option<&Supported<'a>> {
        self.support.as_ref()
    }

    /// Where a layer has supports.
    pub(super) fn support_area(&self, layer: usize) -> Option<Area> {
        match &self.raft {
            Some(raft) if layer < self.raft_layers => Some(raft.area.clone()),
            _ => self.support()?.area(layer),
        }
    }

    /// Height of the tops of a layer's supports above the layer's own top, mm.
    pub(super) fn support_rise(&self, span: &LayerSpan) -> Mm {
        self.support().map_or(0.0, |support| support.rise(span))
    }

    /// Where supports stand on a layer, if its beads follow the surface.
    pub(super) fn on_which_supports_stand(
        &self,
        span: &LayerSpan,
    ) -> Option<Area> {
        let follows = !self.settings.contour_z.is(0.0);
        self.support().filter(|_| follows)?.on_top(span)
    }

    /// Where supports hold a layer, if that matters for its walls.
    pub(super) fn held_by_support(&self, layer: usize) -> Option<Area> {
        let by_reach = self.settings.by_reach();
        self.support().filter(|_| by_reach)?.under(layer)
    }

    /// Plans the climbing wall of the layers to be printed, if there is one. It
    /// takes all of their outlines, one slab after another, since each turn
    /// begins where the turn below ends.
    pub(super) fn plan_spiral(
        &mut self,
        pool: &ThreadPool,
        spans: &[LayerSpan],
    ) -> Result<(), SliceError> {
        if !self.settings.spiral {
            return Ok(());
        }
        let mut spiral = Spiral::new(self.model, self.settings, spans)?;
        let last_flat = spiral.first() - 1;
        let all = last_flat..spans.len();
        for slab in spans.chunks(self.slab_layers()) {
            limits::check();
            // Offset fields are not asked for.
            let none = &WallFields::None;
            let made = || self.layers_of(&self.field, none, slab, &all);
            for layer in pool.install(made)? {
                spiral.add(&layer.span, layer.area())?;
            }
        }
        self.spiral = Some(spiral);
        Ok(())
    }

    /// The turns of a layer's climbing walls; none if it is flat.
    fn turns(
        &self,
        layers: &VecDeque<Layer>,
        i: usize,
    ) -> Result<Vec<Bead>, SliceError> {
        let Layer { span, outline, .. } = &layers[i];
        let below = i.checked_sub(1).map(|k| layers[k].span);
        match (self.spiral_at(span.index), below) {
            (Some(spiral), Some(below)) => {
                Ok(spiral.turns(span, &below, outline.area())?)
            }
            _ => Ok(Vec::new()),
        }
    }

    /// The climbing wall, if a layer is part of it.
    pub(super) fn spiral_at(&self, layer: usize) -> Option<&Spiral<'a>> {
        self.spiral.as_ref().filter(|spiral| spiral.has(layer))
    }

    /// Number of layers whose field is walked at a time.
    pub(super) fn slab_layers(&self) -> usize {
        self.field.slab_layers()
    }

    /// The layers whose outlines are needed to write `layers` of `count`: these
    /// layers, those to be rehearsed, and the neighbours of all of them.
    pub(super) fn needed(
        &self,
        layers: &Range<usize>,
        count: usize,
    ) -> Range<usize> {
        let first = layers.start - layers.start % BLOCK;
        // The part may end below all of these.
        let below = first.saturating_sub(self.reach_below()).min(count);
        below..(layers.end + self.reach_above()).clamp(below, count)
    }

    /// Number of layers above a layer that it depends on.
    pub(super) fn reach_above(&self) -> usize {
        self.exposure.reach_above()
    }

    /// Number of layers below a layer that it depends on.
    pub(super) fn reach_below(&self) -> usize {
        // A turn lies on a layer that has to be known.
        let below = usize::from(self.settings.spiral);
        // Internal bridges lie on infill, which has to be known as well.
        let infill = self.rehearsed_bridges();
        self.exposure.reach_below().max(below) + infill
    }

    /// Outlines of a slab's layers, as far as they are needed.
    pub(super) fn layers(
        &self,
        spans: &[LayerSpan],
        needed: &Range<usize>,
    ) -> Result<Vec<Layer>, SliceError> {
        if !self.known.is_empty() {
            let needed = spans.iter().filter(|s| needed.contains(&s.index));
            let known = |s: &LayerSpan| {
                let by = |layer: &Layer| layer.span.index;
                let at = self.known.binary_search_by_key(&s.index, by);
                at.ok().map(|at| self.known[at].clone())
            };
            let layers: Option<Vec<Layer>> = needed.map(known).collect();
            if let Some(layers) = layers {
                return Ok(layers);
            }
        }
        self.layers_of(&self.field, &self.wall_fields, spans, needed)
    }

    fn growth(&self) -> Option<&Growth> {
        self.growth.as_ref()
    }

    /// Does what [`Stages::layers`] does, for a field and the fields of its
    /// walls, if walls are offsets of the expression.
    fn layers_of(
        &self,
        field: &Field,
        wall_fields: &WallFields,
        spans: &[LayerSpan],
        needed: &Range<usize>,
    ) -> Result<Vec<Layer>, SliceError> {
        // The part has nothing in the layers of a raft.
        let below = spans.iter().take_while(|s| s.index < self.raft_layers);
        let below = below.count();
        let detail = Detail {
            accuracy: self.settings.accuracy * OUTLINE_SHARE,
            smallest: PRINTABLE * self.settings.outer_wall_width(),
        };
        let make = |f: &Field, spans: &[LayerSpan]| {
            let z = spans.iter().map(|s| s.sample_z() + self.bed);
            let z: Vec<Mm> = z.collect();
            if z.is_empty() {
                return Ok(Vec::new());
            }
            let first = spans.first().map_or(0, |s| s.index);
            let asked = needed.start.saturating_sub(first)
                ..needed.end.saturating_sub(first).min(z.len());
            let made = outlines(f, &z, &asked, detail, &self.timings)?;
            let rings = made.iter().flat_map(|o| &o.area.rings);
            limits::made(rings.map(|ring| ring.len()).sum());
            Ok::<_, FieldError>(made)
        };
        let of_part = &spans[below..];
        let mut outlines_of_slab = vec![Outline::default(); below];
        outlines_of_slab.extend(make(field, of_part)?);
        // For walls that are offsets of the expression: of each layer, by depth.
        let mut offsets_of_slab = vec![Vec::new(); spans.len()];
        let mut add = |first: usize,
                       fields: &[(Mm, Field)],
                       of: &[LayerSpan]| {
            for (depth, field) in fields {
                let made = make(field, of)?.into_iter();
                let places = offsets_of_slab[first..].iter_mut();
                places.zip(made).for_each(|(p, o)| p.push((*depth, o.area)));
            }
            Ok::<_, FieldError>(())
        };
        match wall_fields {
            WallFields::None => {}
            WallFields::Alike(fields) => add(below, fields, of_part)?,
            WallFields::ByHeight => {
                let mut first = below;
                let alike = |a: &LayerSpan, b: &LayerSpan| {
                    (a.height() - b.height()).abs() < SAME_HEIGHT
                };
                for run in of_part.chunk_by(alike) {
                    limits::check();
                    let spacing = self.settings.sample_spacing;
                    let tree = &self.model.tree;
                    let make = |d: Mm| {
                        crate::contour::field(tree, d, self.rect, spacing)
                    };
                    let fields =
                        by_depth(run[0].height(), self.settings, make)?;
                    add(first, &fields, run)?;
                    first += run.len();
                }
            }
        }
        let mut layers: Vec<Layer> = Vec::with_capacity(spans.len());
        let found = outlines_of_slab.into_iter().zip(offsets_of_slab);
        for (&span, (outline, mut offsets)) in spans.iter().zip(found) {
            if !needed.contains(&span.index) {
                continue;
            }
            let moving = |span: &LayerSpan| {
                Compensation::new(span, self.settings, self.growth())
            };
            let moved = moving(&span);
            let alike = |below: &&Layer| {
                moving(&below.span).is_like(&moved) && *below.found == outline
            };
            if offsets.is_empty()
                && let Some(below) = layers.last().filter(alike)
            {
                layers.push(Layer {
                    span,
                    ..below.clone()
                });
                continue;
            }
            let found = outline;
            let outline = Solid::new(found.area.clone());
            let (changed, squeezed) =
                self.timings.time(Stage::Walls, || {
                    let changed = moved.apply(&outline, &mut offsets)?;
                    let squeezed = moved.squeezed(&found.area)?;
                    Ok::<_, VaryError>((changed, squeezed))
                })?;
            let outline = changed.map_or(outline, Solid::new);
            let same = layers.last().filter(|b| b.area() == outline.area());
            let (outline, rough) = match same {
                Some(below) => (below.outline.clone(), below.rough.clone()),
                None => {
                    let rough = self.timings.time(Stage::Skin, || {
                        rough(outline.area(), self.settings)
                    });
                    (Arc::new(outline), Arc::new(rough))
                }
            };
            layers.push(Layer {
                span,
                found: Arc::new(found),
                outline,
                rough,
                offsets: Arc::new(offsets.into_iter().map(|o| o.1).collect()),
                squeezed: squeezed.map(|area| Arc::new(Solid::new(area))),
                inside: None,
            });
        }
        Ok(layers)
    }

    /// True if layer `i` of the window needs walls of its own: it is seen from
    /// above, and tops have fewer walls.
    pub(super) fn divides(&self, layers: &VecDeque<Layer>, i: usize) -> bool {
        let covered = |above: &Layer| above.same_outline(&layers[i]);
        self.settings.top_walls() < self.settings.walls
            && !layers.get(i + 1).is_some_and(covered)
    }

    /// The walls of layer `i` of the window and what they leave.
    pub(super) fn inside(&self, layers: &VecDeque<Layer>, i: usize) -> Inside {
        let nothing = Area::EMPTY;
        let above = layers.get(i + 1).map_or(&nothing, Layer::area);
        let above = self.divides(layers, i).then_some(above);
        self.inside_below(&layers[i], above)
    }

    /// A layer's walls and what they leave. There are fewer walls around what
    /// the outline `above` leaves open.
    fn inside_below(&self, layer: &Layer, above: Option<&Area>) -> Inside {
        if self.spiral_at(layer.span.index).is_some() {
            return Inside {
                walls: Walls::default(),
                roomy: Area::default(),
            };
        }
        let height = layer.span.height();
        let walls = self.timings.time(Stage::Walls, || {
            let outline = layer.area();
            let mut walls = if layer.offsets.is_empty() {
                walls_below(outline, above, height, self.settings)
            } else {
                let areas = layer.offsets.to_vec();
                field_walls(outline, areas, height, self.settings)
            };
            walls::thin(&mut walls, self.settings);
            walls
        });
        let roomy = self
            .timings
            .time(Stage::Skin, || roomy(&walls.fill, self.settings));
        Inside { walls, roomy }
    }

    /// The accuracy of the `k`th layer of the run, if the layer is to be
    /// measured.
    pub(super) fn figures(
        &self,
        layer: &Layer,
        walls: &Walls,
        k: usize,
    ) -> Result<Option<LayerFigures>, ReportError> {
        // A turn of a climbing wall is nowhere at the height of its layer's
        // outline.
        let number = layer.span.index;
        if self.spiral_at(number).is_some() || number < self.raft_layers {
            return Ok(None);
        }
        let rounded;
        let walls = if self.settings.arcs() {
            rounded = walls::rounded(walls, self.settings);
            &rounded
        } else {
            walls
        };
        let parts = LayerParts {
            span: layer.span,
            z: layer.span.sample_z() + self.bed,
            outline: &layer.found,
            printed: &layer.outline,
            walls,
        };
        self.timings
            .time(Stage::Report, || self.gauge.layer(parts, k))
    }

    /// How layer `i` of the window lies over the layer below. None if their
    /// outlines are equal, or if layer `i` is the first.
    pub(super) fn look(
        &self,
        layers: &VecDeque<Layer>,
        i: usize,
    ) -> Option<Look> {
        let (here, below) = (&layers[i], layers.get(i.checked_sub(1)?)?);
        let span = here.span;
        // A raft holds all that is on it.
        if here.same_outline(below) || self.is_on_raft(span.index) {
            return None;
        }
        Some(self.timings.time(Stage::Hang, || {
            Look::new(
                &here.outline,
                &below.outline,
                span.index,
                span.height(),
                self.settings,
            )
        }))
    }

    /// Everything there is to print in layer `i` of the window, and where it
    /// has sparse infill.
    pub(super) fn beads(
        &self,
        layers: &VecDeque<Layer>,
        i: usize,
        Inside { walls, roomy }: &Inside,
    ) -> Result<(LayerBeads, FillAreas), SliceError> {
        let Layer { span, outline, .. } = &layers[i];
        let (number, height) = (span.index, span.height());
        let solid = outline.grid();
        let beside = match number {
            0 => self.support_area(number),
            _ => None,
        };
        let beside = beside.map(|area| union(&area, outline.area()));
        let skirt = loops(
            number,
            beside.as_ref().unwrap_or(outline.area()),
            height,
            self.skirt.as_ref(),
            self.settings,
        );
        let turns =
            self.timings.time(Stage::Walls, || self.turns(layers, i))?;
        if !turns.is_empty() {
            let beads = LayerBeads {
                skirt,
                turns,
                ..LayerBeads::default()
            };
            return Ok((beads, FillAreas::default()));
        }
        let (areas, mut skin) = self.timings.time(Stage::Skin, || {
            let window = window(layers, i);
            let areas = self.exposure.split(&walls.fill, roomy, &window);
            let skin = skin::patches(
                &areas.skin,
                faces(layers, i),
                number,
                height,
                self.settings,
            );
            (areas, skin)
        });
        if self.is_on_raft(number) {
            // The skin's underside lies over the air above the raft.
            let down = of_skin(&mut skin);
            for bead in down.filter(|b| b.role == Role::BottomSkin) {
                bead.role = Role::Bridge;
            }
        }
        let small = self.settings.speed.small_wall_length;
        let mut walls = if self.settings.interlocks() {
            walls::interlocked(walls, height, small)
        } else {
            walls::beads(walls, height, small)
        };
        let sites = self.timings.time(Stage::Walls, || {
            self.seams.sites(&walls, number, span.sample_z(), solid)
        })?;
        if let Some(fuzzy) = &self.fuzzy {
            self.timings.time(Stage::Walls, || {
                fuzzy.apply(&mut walls, number, span.sample_z(), solid)
            })?;
        }
        let mut beads = LayerBeads {
            support: self.timings.time(Stage::Support, || {
                match (&self.raft, self.support()) {
                    (Some(raft), _) if number < self.raft_layers => {
                        raft.beads(span)
                    }
                    (_, Some(support)) => support.beads(span),
                    _ => Ok(Vec::new()),
                }
            })?,
            support_last: !number.is_multiple_of(2),
            skirt,
            turns: Vec::new(),
            walls,
            sites,
            infill: self.infill_in(&areas.sparse, &layers[i])?,
            skin,
        };
        // The walls have been thinned already.
        self.timings.time(Stage::Infill, || {
            let all = beads.skirt.iter_mut().chain(&mut beads.support);
            self.thin(all.chain(&mut beads.infill));
            self.thin(of_skin(&mut beads.skin));
        });
        Ok((beads, areas))
    }

    /// A layer's sparse infill.
    fn infill_in(
        &self,
        sparse: &Area,
        layer: &Layer,
    ) -> Result<Vec<Bead>, InfillError> {
        let target = infill::Target {
            number: layer.span.index,
            z: layer.span.sample_z(),
            height: layer.span.height(),
        };
        let solid = layer.outline.grid();
        self.timings.time(Stage::Infill, || {
            if self.settings.spiral {
                Ok(Vec::new())
            } else {
                self.infill.beads(sparse, target, Some(solid))
            }
        })
    }

    /// Thins beads as far as their roles permit.
    fn thin<'b>(&self, beads: impl Iterator<Item = &'b mut Bead>) {
        for bead in beads {
            let role = bead.role;
            thin(bead, role, self.settings);
        }
    }

    /// True if skin over sparse infill becomes internal bridges.
    pub(super) fn bridges_infill(&self) -> bool {
        self.settings.internal_bridges && !self.settings.spiral
    }

    /// How many layers below the first of a block have to be filled, since its
    /// internal bridges lie on their infill or on their bridges.
    pub(super) fn rehearsed_bridges(&self) -> usize {
        let layers = self.settings.internal_bridge_layers;
        match (self.bridges_infill(), layers) {
            (false, _) => 0,
            (true, Some(layers)) => layers as usize,
            (true, None) => 2,
        }
    }

    /// Layer `i` of the window with internal bridges over the infill of the
    /// layer below, and over its bridges `levels`, if there are any. `areas` are
    /// those of layer `i`.
    pub(super) fn over_infill(
        &self,
        layers: &VecDeque<Layer>,
        i: usize,
        areas: &FillAreas,
        under: Under<'_>,
        levels: &[Below],
    ) -> Result<Option<OverInfill>, SliceError> {
        let faces = faces(layers, i);
        let Some(above) = faces.above else {
            return Ok(None);
        };
        let layer = &layers[i];
        let height = layer.span.height();
        let over = Over {
            skin: &areas.skin,
            sparse: &areas.sparse,
            above,
            height,
        };
        let made = self.timings.time(Stage::Skin, || {
            let bridged = bridged(over, under, levels, self.settings)?;
            let number = layer.span.index;
            let rest = &bridged.skin;
            let mut skin =
                skin::patches(rest, faces, number, height, self.settings);
            skin.extend(bridged.patches);
            self.thin(of_skin(&mut skin));
            Some((skin, bridged.sparse, bridged.levels))
        });
        let Some((skin, sparse, levels)) = made else {
            return Ok(None);
        };
        let mut infill = self.infill_in(&sparse, layer)?;
        self.timings
            .time(Stage::Infill, || self.thin(infill.iter_mut()));
        Ok(Some(OverInfill {
            skin,
            infill,
            sparse,
            levels,
        }))
    }

    /// Number of the part's layers up to the highest one that has something to
    /// print. The bounds may reach higher than the part, and what is thinner
    /// than any line is left out.
    ///
    /// # Errors
    /// If hardly any of the part can be printed: see [`super::sound`].
    pub(super) fn printed(
        &self,
        pool: &ThreadPool,
        spans: &[LayerSpan],
    ) -> Result<usize, SliceError> {
        // Mostly the last layer is the highest that prints. If it does not
        // print, the others are looked at slab by slab.
        let (below, last) = spans.split_at(spans.len().saturating_sub(1));
        let slabs = below.rchunks(self.slab_layers());
        let mut sampled = false;
        for slab in std::iter::once(last).chain(slabs) {
            limits::check();
            let looked = pool.install(|| self.look_at(slab))?;
            let highest = looked.iter().rposition(|l| l.prints);
            let thin = looked.iter().any(|l| l.found.is_suspicious());
            if thin && !sampled {
                let found_in = |window: Rect, span: &LayerSpan| {
                    self.found_in(window, span)
                };
                let line = self.settings.thinnest_line();
                sound::sample(pool, self.rect, spans, line, found_in)?;
                sampled = true;
            }
            if let Some(highest) = highest {
                return Ok(slab.first().map_or(0, |s| s.index) + highest + 1);
            }
        }
        Ok(0)
    }

    /// What there is to print in some layers.
    fn look_at(&self, spans: &[LayerSpan]) -> Result<Vec<Looked>, SliceError> {
        let layers = self.layers(spans, &(0..usize::MAX))?.into_par_iter();
        let look = |layer: Layer| {
            let inside = self.inside_below(&layer, None);
            let found = found(&layer, &inside);
            if layer.area().is_empty() {
                let prints = false;
                return Ok(Looked { prints, found });
            }
            let alone = VecDeque::from([layer]);
            let (beads, _) = self.beads(&alone, 0, &inside)?;
            let prints = !(beads.walls.is_empty()
                && beads.infill.is_empty()
                && beads.skin.is_empty());
            Ok(Looked { prints, found })
        };
        layers.map(look).collect()
    }

    /// What a nozzle can make of a window of a layer.
    ///
    /// # Errors
    /// Those of [`Stages::layers`].
    fn found_in(
        &self,
        window: Rect,
        span: &LayerSpan,
    ) -> Result<Found, SliceError> {
        let spacing = self.settings.sample_spacing;
        let field = field_in(&self.model.tree, window, spacing)?;
        let span = std::slice::from_ref(span);
        let none = &WallFields::None;
        let layers = self.layers_of(&field, none, span, &(0..usize::MAX))?;
        let layer = layers.first();
        Ok(layer.map_or(Found::default(), |l| {
            found(l, &self.inside_below(l, None))
        }))
    }
}

/// A layer's number and heights without the raft's.
fn without_raft(span: LayerSpan, (layers, height): (usize, Mm)) -> LayerSpan {
    LayerSpan {
        index: span.index - layers,
        bottom: span.bottom - height,
        top: span.top - height,
    }
}

/// True if layers may be kept. Then the number of their points is taken from
/// `left`.
fn keep(layers: &[Layer], left: &AtomicUsize) -> bool {
    let mut points = 0;
    for (k, layer) in layers.iter().enumerate() {
        let below = k.checked_sub(1).map(|below| &layers[below]);
        if !below.is_some_and(|below| layer.same_outline(below)) {
            let rings = layer.area().rings.iter();
            points += rings.map(|ring| ring.len()).sum::<usize>();
        }
    }
    let take = |left: usize| left.checked_sub(points);
    left.fetch_update(Ordering::Relaxed, Ordering::Relaxed, take)
        .is_ok()
}

/// The beads of some skin.
fn of_skin(skin: &mut [Patch]) -> impl Iterator<Item = &mut Bead> {
    skin.iter_mut().flat_map(|patch| {
        let fills = patch.fills.iter_mut().flat_map(|f| &mut f.lines);
        patch.rings.iter_mut().chain(fills)
    })
}

/// What replaces parts of a layer that has internal bridges.
pub(super) struct OverInfill {
    pub skin: Vec<Patch>,
    pub infill: Vec<Bead>,
    pub sparse: Area,
    pub levels: Vec<Level>,
}

/// What is known of a layer that was looked at without its neighbours.
struct Looked {
    /// True if there is something to print.
    prints: bool,
    found: Found,
}

/// What a nozzle can make of a layer.
fn found(layer: &Layer, inside: &Inside) -> Found {
    let dropped = layer.found.dropped_rings;
    Found::new(layer.area().content(), dropped, &inside.walls)
}
