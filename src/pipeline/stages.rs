//! What is done for many layers at a time, on any thread.
//!
//! In: a slab's spans. Out: the shells of its layers, and, once a layer's
//! neighbours are known, its beads. Nothing here depends on the order in
//! which layers are worked on.

use super::shell::{Inside, Shell};
use super::{BLOCK, SliceError};
use crate::adhesion::{Skirt, brim};
use crate::contour::{Detail, Field, FieldError, Outline, field, outlines};
use crate::fuzzy::Fuzzy;
use crate::hang::Look;
use crate::infill::{self, Infill};
use crate::layers::LayerSpan;
use crate::limits;
use crate::model::Model;
use crate::order::LayerBeads;
use crate::plane::grid::EdgeGrid;
use crate::plane::{Area, Rect};
use crate::region::compensate::{CELL, Compensation};
use crate::region::cover::{Cover, Rough};
use crate::region::exposure::{Slope, roomy, slope_layers, split};
use crate::region::{OUTLINE_SHARE, Walls, field_walls, wall_depths, walls};
use crate::report::{Gauge, LayerFigures, LayerParts, ReportError};
use crate::seam::Seams;
use crate::settings::{Settings, SkinWhere, WallOffset};
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
    field: Field,
    /// The fields of the walls by their depths, if they are offsets of the
    /// expression.
    wall_fields: Vec<(Mm, Field)>,
    seams: Seams<'a>,
    fuzzy: Option<Fuzzy<'a>>,
    /// The skirt, if it is not of the first layer alone.
    skirt: Option<Skirt>,
    /// Height of the bed in the model's coordinates.
    bed: Mm,
    top_layers: usize,
    bottom_layers: usize,
    /// Layers of the part.
    layer_count: usize,
    infill: Infill<'a>,
    pub timings: Timings,
    pub gauge: Gauge<'a>,
}

impl<'a> Stages<'a> {
    pub fn new(
        model: &Model,
        settings: &'a Settings,
        around: &'a Surroundings<'a>,
        gauge: Gauge<'a>,
        spans: &[LayerSpan],
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
                let height = settings.layer_height;
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
            field,
            wall_fields,
            seams: Seams::new(settings, around)?,
            fuzzy: Fuzzy::new(settings, around)?,
            skirt: None,
            bed: -model.offset.z,
            top_layers: settings.top_layers() as usize,
            bottom_layers: settings.bottom_layers() as usize,
            layer_count: spans.len(),
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
                self.shells(std::slice::from_ref(span), &(0..usize::MAX))?;
            areas.extend(of_span.into_iter().map(|s| s.outline));
        }
        let areas = areas.iter().map(|outline| &outline.area);
        Ok(Skirt::new(areas, self.settings))
    }

    /// Layers whose field is walked at a time.
    pub fn slab_layers(&self) -> usize {
        self.field.slab_layers()
    }

    /// The layers whose shells a run needs that writes `layers` of `count`:
    /// those to be rehearsed, and the neighbours of all of these.
    pub fn needed(&self, layers: &Range<usize>, count: usize) -> Range<usize> {
        let first = layers.start - layers.start % BLOCK;
        let below = first.saturating_sub(self.reach_below());
        below..(layers.end + self.reach_above()).min(count)
    }

    /// How many layers have to cover a layer from above, lest it get skin.
    fn layers_above(&self) -> usize {
        match self.settings.skin_where {
            SkinWhere::Exposed => self.top_layers,
            SkinWhere::Ends => 0,
        }
    }

    /// How many have to from below.
    fn layers_below(&self) -> usize {
        match self.settings.skin_where {
            SkinWhere::Exposed => self.bottom_layers,
            SkinWhere::Ends => 0,
        }
    }

    /// True if a layer is skin all over, whatever covers it.
    fn is_end(&self, layer: usize) -> bool {
        self.settings.skin_where == SkinWhere::Ends
            && (layer < self.bottom_layers
                || layer + self.top_layers >= self.layer_count)
    }

    /// How many layers above a layer it has to know.
    pub fn reach_above(&self) -> usize {
        slope_layers(self.layers_above()).max(1)
    }

    /// How many layers below a layer it has to know.
    pub fn reach_below(&self) -> usize {
        slope_layers(self.layers_below()).max(1)
    }

    /// Outlines of a slab's layers, as far as they are needed.
    pub fn shells(
        &self,
        spans: &[LayerSpan],
        needed: &Range<usize>,
    ) -> Result<Vec<Shell>, FieldError> {
        let z: Vec<Mm> =
            spans.iter().map(|s| s.sample_z() + self.bed).collect();
        let detail = Detail {
            accuracy: self.settings.accuracy * OUTLINE_SHARE,
            smallest: PRINTABLE * self.settings.outer_wall_width,
        };
        let make = |f: &Field| outlines(f, &z, detail, &self.timings);
        let outlines_of_slab = make(&self.field)?;
        // For walls that are offsets of the expression: by depth, by layer.
        let mut offset_outlines = self
            .wall_fields
            .iter()
            .map(|(depth, f)| Ok((*depth, make(f)?.into_iter())))
            .collect::<Result<Vec<_>, FieldError>>()?;
        let mut shells: Vec<Shell> = Vec::with_capacity(spans.len());
        for (&span, outline) in spans.iter().zip(outlines_of_slab) {
            let mut offsets: Vec<(Mm, Area)> = offset_outlines
                .iter_mut()
                .filter_map(|(d, o)| o.next().map(|o| (*d, o.area)))
                .collect();
            if !needed.contains(&span.index) {
                continue;
            }
            let moved = Compensation::new(&span, self.settings);
            let alike = |below: &&Shell| {
                Compensation::new(&below.span, self.settings) == moved
                    && *below.truth() == outline
            };
            if offsets.is_empty()
                && let Some(below) = shells.last().filter(alike)
            {
                shells.push(Shell {
                    span,
                    ..below.clone()
                });
                continue;
            }
            let grid = EdgeGrid::new(&outline.area, CELL);
            let changed = self.timings.time(Stage::Walls, || {
                moved.apply(&outline.area, &grid, &mut offsets)
            });
            let (outline, grid, truth) = match changed {
                None => (outline, grid, None),
                Some(area) => {
                    let grid = EdgeGrid::new(&area, CELL);
                    let printed = Outline {
                        area,
                        ..outline.clone()
                    };
                    (printed, grid, Some(Arc::new(outline)))
                }
            };
            let same = shells.last().filter(|below| *below.outline == outline);
            let solid = match same {
                Some(below) => below.solid.clone(),
                None => Arc::new(grid),
            };
            let rough = match same {
                Some(below) => below.rough.clone(),
                None => Arc::new(self.timings.time(Stage::Skin, || {
                    Rough::new(&outline.area, self.settings)
                })),
            };
            let outline = match same {
                Some(below) => below.outline.clone(),
                None => Arc::new(outline),
            };
            shells.push(Shell {
                span,
                outline,
                truth,
                solid,
                rough,
                offsets: Arc::new(offsets.into_iter().map(|o| o.1).collect()),
                inside: None,
            });
        }
        Ok(shells)
    }

    /// A layer's walls and what they leave.
    pub fn inside(&self, shell: &Shell) -> Inside {
        let height = shell.span.height();
        let walls = self.timings.time(Stage::Walls, || {
            let outline = &shell.outline.area;
            match shell.offsets.is_empty() {
                true => walls(outline, height, self.settings),
                false => {
                    let areas = shell.offsets.to_vec();
                    field_walls(outline, areas, height, self.settings)
                }
            }
        });
        let roomy = self
            .timings
            .time(Stage::Skin, || roomy(&walls.fill, self.settings));
        Inside { walls, roomy }
    }

    /// How far the `k`th layer of the run is off, if it is to be measured.
    pub fn figures(
        &self,
        shell: &Shell,
        walls: &Walls,
        k: usize,
    ) -> Result<Option<LayerFigures>, ReportError> {
        let parts = LayerParts {
            span: shell.span,
            z: shell.span.sample_z() + self.bed,
            outline: shell.truth(),
            edges: &shell.solid,
            walls,
        };
        self.timings
            .time(Stage::Report, || self.gauge.layer(parts, k))
    }

    /// How layer `i` of the window lies over the one below, unless they are
    /// the same or it is the first.
    pub fn look(&self, window: &VecDeque<Shell>, i: usize) -> Option<Look> {
        let (here, below) = (&window[i], window.get(i.checked_sub(1)?)?);
        if Arc::ptr_eq(&here.outline, &below.outline) {
            return None;
        }
        let span = here.span;
        Some(self.timings.time(Stage::Hang, || {
            Look::new(
                here.cover(),
                below.cover(),
                span.index,
                span.height(),
                self.settings,
            )
        }))
    }

    /// Everything there is to print in layer `i` of the window, and where it
    /// has sparse infill.
    pub fn beads(
        &self,
        window: &VecDeque<Shell>,
        i: usize,
        inside: &Inside,
    ) -> Result<(LayerBeads, Area), SliceError> {
        let shell = &window[i];
        let Inside { walls, roomy } = inside;
        let span = shell.span;
        let height = span.height();
        // A neighbour that is the same as the layer, or as another of its
        // neighbours, covers nothing less.
        let mut seen: Vec<&Arc<Outline>> = vec![&shell.outline];
        let mut cover = |k: Option<usize>| -> Option<Option<Cover<'_>>> {
            let Some(near) = k.and_then(|k| window.get(k)) else {
                return Some(None);
            };
            if seen.iter().any(|s| Arc::ptr_eq(s, &near.outline)) {
                return None;
            }
            seen.push(&near.outline);
            Some(Some(near.rough.cover()))
        };
        let mut above: Vec<_> = (1..=self.layers_above())
            .filter_map(|k| cover(i.checked_add(k)))
            .collect();
        let below: Vec<_> = (1..=self.layers_below())
            .filter_map(|k| cover(i.checked_sub(k)))
            .collect();
        let layer = span.index;
        if self.is_end(layer) {
            above.push(None);
        }
        let (areas, skin) = self.timings.time(Stage::Skin, || {
            // The layers right above and below, the latter if it may not hold
            // all of this one.
            let next = |k: Option<usize>| {
                let near = k.and_then(|k| window.get(k))?;
                Some(near.face())
            };
            let faces = skin::Faces {
                above: next(i.checked_add(1)),
                below: next(i.checked_sub(1)),
            };
            let support = i
                .checked_sub(1)
                .filter(|&k| !Arc::ptr_eq(&window[k].outline, &shell.outline))
                .map(|k| window[k].rough.cover());
            let slope =
                |layers: usize, step: &dyn Fn(usize) -> Option<usize>| {
                    let near = |k: usize| {
                        let shell = window.get(step(k)?)?;
                        Some(shell.rough.cover())
                    };
                    let same = |k: usize| {
                        let shell_k = step(k).and_then(|k| window.get(k));
                        shell_k.is_some_and(|s| {
                            Arc::ptr_eq(&s.outline, &shell.outline)
                        })
                    };
                    let all = slope_layers(layers);
                    Slope {
                        last: near(layers),
                        beyond: (layers + 1..=all)
                            .filter(|&k| !same(k))
                            .map(near)
                            .collect(),
                        reach: (all - layers) as f64 * height,
                    }
                };
            let slopes = [
                slope(self.layers_above(), &|k| i.checked_add(k)),
                slope(self.layers_below(), &|k| i.checked_sub(k)),
            ];
            let areas = split(
                &walls.fill,
                roomy,
                &above,
                &below,
                support,
                &shell.rough.area,
                &slopes,
                self.settings,
            );
            let skin =
                skin::patches(&areas.skin, faces, layer, height, self.settings);
            (areas, skin)
        });
        let mut walls =
            walls::beads(walls, height, self.settings.speed.small_wall_length);
        let sites = self.timings.time(Stage::Walls, || {
            self.seams
                .sites(&walls, layer, span.sample_z(), &shell.solid)
        })?;
        if let Some(fuzzy) = &self.fuzzy {
            self.timings.time(Stage::Walls, || {
                fuzzy.apply(&mut walls, layer, span.sample_z(), &shell.solid)
            })?;
        }
        let outline = &shell.outline.area;
        let mut around = match &self.skirt {
            _ if layer >= self.settings.skirt.layers as usize => Vec::new(),
            Some(skirt) => skirt.beads(height),
            None => Skirt::new([outline], self.settings).beads(height),
        };
        if layer == 0 {
            around.extend(brim(outline, height, self.settings));
        }
        let beads = LayerBeads {
            skirt: around,
            walls,
            sites,
            infill: self.timings.time(Stage::Infill, || {
                let place = infill::Place {
                    number: layer,
                    z: span.sample_z(),
                    height,
                };
                self.infill.beads(&areas.sparse, place, Some(&shell.solid))
            })?,
            skin,
        };
        Ok((beads, areas.sparse))
    }
    /// How many of the part's layers there are up to the highest one that
    /// has something to print. The bounds may reach higher than the part, and
    /// what is thinner than any line is left out.
    pub fn printed(
        &self,
        pool: &ThreadPool,
        spans: &[LayerSpan],
    ) -> Result<usize, SliceError> {
        // Mostly it is the last one. If it is not, slab by slab.
        let (below, last) = spans.split_at(spans.len().saturating_sub(1));
        let slabs = below.rchunks(self.slab_layers());
        for slab in std::iter::once(last).chain(slabs) {
            limits::check();
            let prints = pool.install(|| self.prints(slab))?;
            if let Some(highest) = prints.iter().rposition(|p| *p) {
                return Ok(slab.first().map_or(0, |s| s.index) + highest + 1);
            }
        }
        Ok(0)
    }

    /// Which of some layers have something to print.
    fn prints(&self, spans: &[LayerSpan]) -> Result<Vec<bool>, SliceError> {
        let shells = self.shells(spans, &(0..usize::MAX))?.into_par_iter();
        let prints = |shell: Shell| {
            if shell.outline.area.is_empty() {
                return Ok(false);
            }
            let inside = self.inside(&shell);
            let window = VecDeque::from([shell]);
            let (beads, _) = self.beads(&window, 0, &inside)?;
            Ok(!(beads.walls.is_empty()
                && beads.infill.is_empty()
                && beads.skin.is_empty()))
        };
        shells.map(prints).collect()
    }
}
