//! What is done for many layers at a time, on any thread.
//!
//! In: a slab's spans. Out: the outlines of its layers, and, once a layer's
//! neighbours are known, its beads. Nothing here depends on the order in
//! which layers are worked on.

use super::layer::{Inside, Layer, faces, window};
use super::sound::{self, Found};
use super::supported::{Fills, Supported};
use super::{BLOCK, SliceError};
use crate::adhesion::{Skirt, loops};
use crate::bead::Bead;
use crate::contour::{Detail, Field, FieldError, field, field_in, outlines};
use crate::fuzzy::Fuzzy;
use crate::hang::Look;
use crate::infill::{self, Infill, InfillError};
use crate::layers::LayerSpan;
use crate::limits;
use crate::model::Model;
use crate::order::LayerBeads;
use crate::plane::clip::union;
use crate::plane::{Area, Rect, Solid};
use crate::region::compensate::Compensation;
use crate::region::cover::rough;
use crate::region::exposure::{Exposure, FillAreas, roomy};
use crate::region::{OUTLINE_SHARE, Walls, field_walls, wall_depths, walls};
use crate::report::{Gauge, LayerFigures, LayerParts, ReportError};
use crate::resolution::thin;
use crate::seam::Seams;
use crate::settings::{Settings, WallOffset};
use crate::skin::Patch;
use crate::skin::over_infill::{Over, Under, bridged};
use crate::spiral::Spiral;
use crate::support::{Parts, Plan};
use crate::timings::{Stage, Timings};
use crate::units::Mm;
use crate::vary::Surroundings;
use crate::{skin, walls};
use glam::DVec2;
use rayon::ThreadPool;
use rayon::prelude::*;
use std::collections::VecDeque;
use std::ops::Range;
use std::sync::Arc;

/// Extent below which an island or a hole is left out, as a share of the
/// outer wall's width.
const PRINTABLE: f64 = 0.25;

/// A high skirt stands round the outlines of so many layers, about: it keeps
/// a distance that what is between them will not bridge.
const SKIRT_SAMPLES: usize = 64;

/// What the layers have in common.
pub(super) struct Stages<'a> {
    settings: &'a Settings,
    model: &'a Model,
    /// The part's box in the plane.
    rect: Rect,
    field: Field,
    /// The fields of the walls by their depths, if they are offsets of the
    /// expression.
    wall_fields: Vec<(Mm, Field)>,
    seams: Seams<'a>,
    fuzzy: Option<Fuzzy<'a>>,
    /// The skirt, if it is not of the first layer alone.
    skirt: Option<Skirt>,
    /// The supports, once they are planned.
    support: Option<Supported<'a>>,
    /// Height of the bed in the model's coordinates.
    bed: Mm,
    /// The climbing wall, if there is to be one.
    pub spiral: Option<Spiral<'a>>,
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
            WallOffset::Distance => Vec::new(),
            WallOffset::Field => {
                let height = settings.layer_height();
                let (mut depths, border) = wall_depths(height, settings);
                depths.push(border);
                depths
                    .into_iter()
                    .map(|d| Ok((d, make(d)?)))
                    .collect::<Result<_, FieldError>>()?
            }
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
            bed: -model.offset.z,
            spiral: None,
            exposure: Exposure::new(settings, spans),
            infill: Infill::new(settings, around, site)?,
            timings: Timings::default(),
            gauge,
        };
        if settings.skirt.loops > 0 && settings.skirt.layers > 1 {
            stages.skirt = Some(stages.skirt_round(spans)?);
        }
        Ok(stages)
    }

    /// The skirt round all layers that stand beside it, or, if it is high,
    /// some of them.
    fn skirt_round(&self, spans: &[LayerSpan]) -> Result<Skirt, FieldError> {
        let beside =
            &spans[..spans.len().min(self.settings.skirt.layers as usize)];
        let step = beside.len().div_ceil(SKIRT_SAMPLES).max(1);
        let mut areas = Vec::new();
        for span in beside.iter().step_by(step).chain(beside.last()) {
            let of_span =
                self.layers(std::slice::from_ref(span), &(0..usize::MAX))?;
            areas.extend(of_span.into_iter().map(|l| l.outline));
        }
        let areas = areas.iter().map(|outline| outline.area());
        let slice = |s: &LayerSpan| self.support.as_ref()?.slice(s.index);
        let support = beside.iter().filter_map(slice);
        let support = support.flat_map(|s| [&s.body, &s.interface]);
        Ok(Skirt::new(areas.chain(support), self.settings))
    }

    /// Plans the supports of the whole part, `spans`. `fills` are the settings
    /// by which supports and their dense tops are filled.
    ///
    /// # Errors
    /// If the part's outlines cannot be found.
    pub(super) fn plan_supports(
        &mut self,
        pool: &ThreadPool,
        spans: &'a [LayerSpan],
        around: &'a Surroundings<'a>,
        fills: &'a Fills,
    ) -> Result<(), SliceError> {
        let slabs = spans.par_chunks(self.slab_layers());
        let stages: &Stages<'a> = self;
        let outlines = pool.install(|| {
            let made = slabs.map(|slab| {
                let layers = stages.layers(slab, &(0..usize::MAX))?;
                let areas = layers.iter().map(|l| l.area().clone());
                Ok(areas.collect::<Vec<Area>>())
            });
            made.collect::<Vec<Result<Vec<Area>, FieldError>>>()
        });
        let outlines: Vec<Vec<Area>> =
            outlines.into_iter().collect::<Result<_, _>>()?;
        let outlines = outlines.concat();
        let offset = self.model.offset.truncate();
        let printer = &self.settings.printer;
        let parts = Parts {
            spans,
            outlines: &outlines,
            bed: Rect {
                min: -offset,
                max: DVec2::new(printer.bed_x, printer.bed_y) - offset,
            },
        };
        let plan = pool.install(|| {
            let plan = || Plan::new(parts, self.settings);
            self.timings.time(Stage::Support, plan)
        });
        let site = infill::Site {
            part: self.rect,
            height: self.model.bounds.size().z,
            bed: 0.5 * (parts.bed.min + parts.bed.max),
            origin: self.model.origin.truncate(),
        };
        self.support = Some(Supported::new(plan, fills, around, site)?);
        if self.skirt.is_some() {
            self.skirt = Some(self.skirt_round(spans)?);
        }
        Ok(())
    }

    /// The supports, once they are planned.
    pub(super) fn support(&self) -> Option<&Supported<'a>> {
        self.support.as_ref()
    }

    /// Where a layer has supports.
    pub(super) fn support_area(&self, layer: usize) -> Option<Area> {
        self.support()?.area(layer)
    }

    /// Plans the climbing wall of the layers to be printed, if there is to be
    /// one. It takes all of their outlines, one slab after another, since each
    /// turn begins where the one below ends.
    pub(super) fn plan_spiral(
        &mut self,
        pool: &ThreadPool,
        spans: &[LayerSpan],
    ) -> Result<(), SliceError> {
        if !self.settings.spiral {
            return Ok(());
        }
        let mut spiral = Spiral::new(self.model, self.settings)?;
        let last_flat = Spiral::first(self.settings) - 1;
        let all = last_flat..spans.len();
        for slab in spans.chunks(self.slab_layers()) {
            limits::check();
            for layer in pool.install(|| self.layers(slab, &all))? {
                spiral.add(&layer.span, layer.area())?;
            }
        }
        self.spiral = Some(spiral);
        Ok(())
    }

    /// The turn of a layer's climbing wall, if it has one.
    fn turn(
        &self,
        layers: &VecDeque<Layer>,
        i: usize,
    ) -> Result<Option<Bead>, SliceError> {
        let Layer { span, outline, .. } = &layers[i];
        let below = i.checked_sub(1).map(|k| layers[k].span);
        match (self.spiral_at(span.index), below) {
            (Some(spiral), Some(below)) => {
                Ok(Some(spiral.turn(span, &below, outline.area())?))
            }
            _ => Ok(None),
        }
    }

    /// The climbing wall, if a layer is part of it.
    pub(super) fn spiral_at(&self, layer: usize) -> Option<&Spiral<'a>> {
        self.spiral.as_ref().filter(|spiral| spiral.has(layer))
    }

    /// Layers whose field is walked at a time.
    pub(super) fn slab_layers(&self) -> usize {
        self.field.slab_layers()
    }

    /// The layers whose outlines a run needs that writes `layers` of `count`:
    /// those to be rehearsed, and the neighbours of all of these.
    pub(super) fn needed(
        &self,
        layers: &Range<usize>,
        count: usize,
    ) -> Range<usize> {
        let first = layers.start - layers.start % BLOCK;
        let below = first.saturating_sub(self.reach_below());
        below..(layers.end + self.reach_above()).min(count)
    }

    /// How many layers above a layer it has to know.
    pub(super) fn reach_above(&self) -> usize {
        self.exposure.reach_above()
    }

    /// How many layers below a layer it has to know.
    pub(super) fn reach_below(&self) -> usize {
        // A turn lies on a layer that has to be known.
        let below = usize::from(self.settings.spiral);
        // Internal bridges lie on infill, which has to be known as well.
        let infill = usize::from(self.bridges_infill());
        self.exposure.reach_below().max(below) + infill
    }

    /// Outlines of a slab's layers, as far as they are needed.
    pub(super) fn layers(
        &self,
        spans: &[LayerSpan],
        needed: &Range<usize>,
    ) -> Result<Vec<Layer>, FieldError> {
        self.layers_of(&self.field, &self.wall_fields, spans, needed)
    }

    /// As [`Stages::layers`], of a field and those of its walls, if walls are
    /// offsets of the expression.
    fn layers_of(
        &self,
        field: &Field,
        wall_fields: &[(Mm, Field)],
        spans: &[LayerSpan],
        needed: &Range<usize>,
    ) -> Result<Vec<Layer>, FieldError> {
        let z: Vec<Mm> =
            spans.iter().map(|s| s.sample_z() + self.bed).collect();
        let detail = Detail {
            accuracy: self.settings.accuracy * OUTLINE_SHARE,
            smallest: PRINTABLE * self.settings.outer_wall_width(),
        };
        let make = |f: &Field| outlines(f, &z, detail, &self.timings);
        let outlines_of_slab = make(field)?;
        // For walls that are offsets of the expression: by depth, by layer.
        let mut offset_outlines = wall_fields
            .iter()
            .map(|(depth, f)| Ok((*depth, make(f)?.into_iter())))
            .collect::<Result<Vec<_>, FieldError>>()?;
        let mut layers: Vec<Layer> = Vec::with_capacity(spans.len());
        for (&span, outline) in spans.iter().zip(outlines_of_slab) {
            let mut offsets: Vec<(Mm, Area)> = offset_outlines
                .iter_mut()
                .filter_map(|(d, o)| o.next().map(|o| (*d, o.area)))
                .collect();
            if !needed.contains(&span.index) {
                continue;
            }
            let moved = Compensation::new(&span, self.settings);
            let alike = |below: &&Layer| {
                Compensation::new(&below.span, self.settings) == moved
                    && *below.found == outline
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
            let changed = self
                .timings
                .time(Stage::Walls, || moved.apply(&outline, &mut offsets));
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
                inside: None,
            });
        }
        Ok(layers)
    }

    /// A layer's walls and what they leave.
    pub(super) fn inside(&self, layer: &Layer) -> Inside {
        if self.spiral_at(layer.span.index).is_some() {
            return Inside {
                walls: Walls::default(),
                roomy: Area::default(),
            };
        }
        let height = layer.span.height();
        let walls = self.timings.time(Stage::Walls, || {
            let outline = layer.area();
            let mut walls = match layer.offsets.is_empty() {
                true => walls(outline, height, self.settings),
                false => {
                    let areas = layer.offsets.to_vec();
                    field_walls(outline, areas, height, self.settings)
                }
            };
            walls::thin(&mut walls, self.settings);
            walls
        });
        let roomy = self
            .timings
            .time(Stage::Skin, || roomy(&walls.fill, self.settings));
        Inside { walls, roomy }
    }

    /// How far the `k`th layer of the run is off, if it is to be measured.
    pub(super) fn figures(
        &self,
        layer: &Layer,
        walls: &Walls,
        k: usize,
    ) -> Result<Option<LayerFigures>, ReportError> {
        // A turn is nowhere at the height of its layer's outline.
        if self.spiral_at(layer.span.index).is_some() {
            return Ok(None);
        }
        let rounded;
        let walls = match self.settings.arcs() {
            true => {
                rounded = walls::rounded(walls, self.settings);
                &rounded
            }
            false => walls,
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

    /// How layer `i` of the window lies over the one below, unless they are
    /// the same or it is the first.
    pub(super) fn look(
        &self,
        layers: &VecDeque<Layer>,
        i: usize,
    ) -> Option<Look> {
        let (here, below) = (&layers[i], layers.get(i.checked_sub(1)?)?);
        if here.same_outline(below) {
            return None;
        }
        let span = here.span;
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
        let turn = self.timings.time(Stage::Walls, || self.turn(layers, i))?;
        if turn.is_some() {
            let beads = LayerBeads {
                skirt,
                turn,
                ..LayerBeads::default()
            };
            return Ok((beads, FillAreas::default()));
        }
        let (areas, skin) = self.timings.time(Stage::Skin, || {
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
        let mut walls =
            walls::beads(walls, height, self.settings.speed.small_wall_length);
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
                match self.support() {
                    Some(support) => support.beads(span),
                    None => Ok(Vec::new()),
                }
            })?,
            support_last: !number.is_multiple_of(2),
            skirt,
            turn: None,
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
        let place = infill::Place {
            number: layer.span.index,
            z: layer.span.sample_z(),
            height: layer.span.height(),
        };
        let solid = layer.outline.grid();
        self.timings
            .time(Stage::Infill, || match self.settings.spiral {
                true => Ok(Vec::new()),
                false => self.infill.beads(sparse, place, Some(solid)),
            })
    }

    /// Thins beads to what their roles permit.
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

    /// Layer `i` of the window with internal bridges over the infill of the
    /// layer below, if it has any; `areas` are its own.
    pub(super) fn over_infill(
        &self,
        layers: &VecDeque<Layer>,
        i: usize,
        areas: &FillAreas,
        under: Under<'_>,
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
            let bridged = bridged(over, under, self.settings)?;
            let number = layer.span.index;
            let rest = &bridged.skin;
            let mut skin =
                skin::patches(rest, faces, number, height, self.settings);
            skin.extend(bridged.patches);
            self.thin(of_skin(&mut skin));
            Some((skin, bridged.sparse))
        });
        let Some((skin, sparse)) = made else {
            return Ok(None);
        };
        let mut infill = self.infill_in(&sparse, layer)?;
        self.timings
            .time(Stage::Infill, || self.thin(infill.iter_mut()));
        Ok(Some(OverInfill {
            skin,
            infill,
            sparse,
        }))
    }

    /// How many of the part's layers there are up to the highest one that
    /// has something to print. The bounds may reach higher than the part, and
    /// what is thinner than any line is left out.
    ///
    /// # Errors
    /// If next to nothing of the part can be printed: see [`super::sound`].
    pub(super) fn printed(
        &self,
        pool: &ThreadPool,
        spans: &[LayerSpan],
    ) -> Result<usize, SliceError> {
        // Mostly it is the last one. If it is not, slab by slab.
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
                let line = self.thinnest();
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
            let inside = self.inside(&layer);
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
    /// As [`Stages::layers`].
    fn found_in(
        &self,
        window: Rect,
        span: &LayerSpan,
    ) -> Result<Found, FieldError> {
        let spacing = self.settings.sample_spacing;
        let field = field_in(&self.model.tree, window, spacing)?;
        let span = std::slice::from_ref(span);
        let layers = self.layers_of(&field, &[], span, &(0..usize::MAX))?;
        let layer = layers.first();
        Ok(layer.map_or(Found::default(), |l| found(l, &self.inside(l))))
    }

    /// Width of the thinnest line.
    fn thinnest(&self) -> Mm {
        self.settings.thin_min / 100.0 * self.settings.outer_wall_width()
    }
}

/// The beads of some skin.
fn of_skin(skin: &mut [Patch]) -> impl Iterator<Item = &mut Bead> {
    skin.iter_mut().flat_map(|patch| {
        let fills = patch.fills.iter_mut().flat_map(|f| &mut f.lines);
        patch.rings.iter_mut().chain(fills)
    })
}

/// What a layer with internal bridges has in place of what it had.
pub(super) struct OverInfill {
    pub skin: Vec<Patch>,
    pub infill: Vec<Bead>,
    pub sparse: Area,
}

/// What is known of a layer that was looked at alone.
struct Looked {
    /// There is something to print.
    prints: bool,
    found: Found,
}

/// What a nozzle can make of a layer.
fn found(layer: &Layer, inside: &Inside) -> Found {
    let dropped = layer.found.dropped_rings;
    Found::new(layer.area().content(), dropped, &inside.walls)
}
