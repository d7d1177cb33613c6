//! What is done for many layers at a time, on any thread.
//!
//! In: a slab's spans. Out: the shells of its layers, and, once a layer's
//! neighbours are known, its beads. Nothing here depends on the order in
//! which layers are worked on.

use super::exit::Exit;
use super::{BLOCK, SliceError};
use crate::adhesion::skirt;
use crate::contour::{Detail, Outline, outlines};
use crate::field::{Field, FieldError};
use crate::layers::LayerSpan;
use crate::model::Model;
use crate::order::LayerBeads;
use crate::plane::grid::EdgeGrid;
use crate::plane::{Area, Rect};
use crate::region::exposure::split;
use crate::region::{OUTLINE_SHARE, Walls, field_walls, wall_depths, walls};
use crate::report::{Gauge, LayerFigures, LayerParts, ReportError};
use crate::settings::{Settings, WallOffset};
use crate::timings::{Stage, Timings};
use crate::units::Mm;
use crate::{infill, skin, walls};
use rayon::prelude::*;
use std::collections::VecDeque;
use std::ops::Range;

/// Extent below which an island or a hole is left out, as a share of the
/// outer wall's width.
const PRINTABLE: f64 = 0.25;

/// A layer whose outline and walls are known.
pub(super) struct Shell {
    pub span: LayerSpan,
    pub outline: Outline,
    /// The outline again, for asking what is where.
    pub solid: EdgeGrid,
    pub walls: Walls,
}

/// A layer's beads, and how far it is off if it was measured.
type Done = (LayerBeads, Option<LayerFigures>);

/// What the layers have in common.
pub(super) struct Stages<'a> {
    settings: &'a Settings,
    field: Field,
    /// The fields of the walls, if they are offsets of the expression.
    wall_fields: Vec<Field>,
    /// Height of the bed in the model's coordinates.
    bed: Mm,
    top_layers: usize,
    bottom_layers: usize,
    pub timings: Timings,
    pub gauge: Gauge<'a>,
}

impl<'a> Stages<'a> {
    pub fn new(
        model: &Model,
        settings: &'a Settings,
        gauge: Gauge<'a>,
    ) -> Result<Self, FieldError> {
        let rect = Rect {
            min: model.bounds.min.truncate(),
            max: model.bounds.max.truncate(),
        };
        let heights = [model.bounds.min.z, model.bounds.max.z];
        let make = |depth: Mm, backend| {
            Field::new(
                &model.tree,
                depth,
                rect,
                settings.sample_spacing,
                heights,
                backend,
            )
        };
        let field = make(0.0, None)?;
        let wall_fields = match settings.wall_offset {
            WallOffset::Distance => Vec::new(),
            WallOffset::Field => {
                let height = settings.layer_height;
                let (mut depths, border) = wall_depths(height, settings);
                depths.push(border);
                let backend = Some(field.backend());
                depths
                    .into_iter()
                    .map(|d| make(d, backend))
                    .collect::<Result<_, _>>()?
            }
        };
        Ok(Stages {
            settings,
            field,
            wall_fields,
            bed: -model.offset.z,
            top_layers: settings.top_layers() as usize,
            bottom_layers: settings.bottom_layers() as usize,
            timings: Timings::default(),
            gauge,
        })
    }

    /// The layers whose shells a run needs that writes `layers` of `count`:
    /// those to be rehearsed, and the neighbours of all of these.
    pub fn needed(&self, layers: &Range<usize>, count: usize) -> Range<usize> {
        let first = layers.start - layers.start % BLOCK;
        let below = first.saturating_sub(self.bottom_layers.max(1));
        below..(layers.end + self.top_layers.max(1)).min(count)
    }

    /// Outlines and walls of a slab's layers, as far as they are needed.
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
            .map(|f| Ok(make(f)?.into_iter()))
            .collect::<Result<Vec<_>, FieldError>>()?;
        Ok(spans
            .iter()
            .zip(outlines_of_slab)
            .map(|(&span, outline)| {
                let areas: Vec<Area> = offset_outlines
                    .iter_mut()
                    .filter_map(|o| o.next().map(|o| o.area))
                    .collect();
                (span, outline, areas)
            })
            .filter(|(span, _, _)| needed.contains(&span.index))
            .map(|(span, outline, areas)| {
                let height = span.height();
                let walls = self.timings.time(Stage::Walls, || {
                    let outline = &outline.area;
                    match areas.is_empty() {
                        true => walls(outline, height, self.settings),
                        false => {
                            field_walls(outline, areas, height, self.settings)
                        }
                    }
                });
                Shell {
                    span,
                    solid: EdgeGrid::new(&outline.area, 1.0),
                    outline,
                    walls,
                }
            })
            .collect())
    }

    /// Fills, orders and writes the window's layers whose upper neighbours
    /// are known, and drops those that no later layer looks at.
    pub fn write_ready(
        &self,
        pool: &rayon::ThreadPool,
        window: &mut VecDeque<Shell>,
        last: bool,
        exit: &mut Exit<'_, '_>,
    ) -> Result<(), SliceError> {
        let first = window.front().map_or(0, |s| s.span.index);
        let end = match last {
            true => window.len(),
            // Roles look at the next layer, whatever the skin's thickness.
            false => window.len().saturating_sub(self.top_layers.max(1)),
        };
        let end = end.min(exit.layers().end.saturating_sub(first));
        let ready = exit.next() - first..end;
        let shells: &VecDeque<Shell> = window;
        let of_run = exit.layers();
        let done: Vec<Result<Done, ReportError>> = pool.install(|| {
            ready
                .clone()
                .into_par_iter()
                .map(|i| {
                    let index = shells[i].span.index;
                    let figures = match of_run.contains(&index) {
                        true => {
                            let k = index - of_run.start;
                            self.figures(&shells[i], k)?
                        }
                        false => None,
                    };
                    Ok((self.beads(shells, i), figures))
                })
                .collect()
        });
        for (i, done) in ready.zip(done) {
            let (beads, figures) = done?;
            exit.layer(&window[i], beads, figures)?;
        }
        let keep = exit.next().saturating_sub(self.bottom_layers.max(1));
        while window.front().is_some_and(|s| s.span.index < keep) {
            window.pop_front();
        }
        Ok(())
    }

    /// How far the `k`th layer of the run is off, if it is to be measured.
    fn figures(
        &self,
        shell: &Shell,
        k: usize,
    ) -> Result<Option<LayerFigures>, ReportError> {
        let parts = LayerParts {
            span: shell.span,
            z: shell.span.sample_z() + self.bed,
            outline: &shell.outline,
            edges: &shell.solid,
            walls: &shell.walls,
        };
        self.timings
            .time(Stage::Report, || self.gauge.layer(parts, k))
    }

    /// Everything there is to print in layer `i` of the window.
    fn beads(&self, window: &VecDeque<Shell>, i: usize) -> LayerBeads {
        let shell = &window[i];
        let Shell { span, walls, .. } = shell;
        let height = span.height();
        let none = Area::EMPTY;
        let at = |k: Option<usize>| -> &Area {
            k.and_then(|k| window.get(k))
                .map_or(&none, |s| &s.outline.area)
        };
        let above: Vec<&Area> = (1..=self.top_layers)
            .map(|k| at(i.checked_add(k)))
            .collect();
        let below: Vec<&Area> = (1..=self.bottom_layers)
            .map(|k| at(i.checked_sub(k)))
            .collect();
        let layer = span.index;
        let (areas, skin) = self.timings.time(Stage::Skin, || {
            let areas = split(&walls.fill, &above, &below, self.settings);
            let solid = |k: Option<usize>| {
                k.and_then(|k| window.get(k)).map(|s| &s.solid)
            };
            let faces = skin::Faces {
                above: solid(i.checked_add(1)),
                below: solid(i.checked_sub(1)),
            };
            let skin =
                skin::patches(&areas.skin, faces, layer, height, self.settings);
            (areas, skin)
        });
        LayerBeads {
            skirt: match layer < self.settings.skirt.layers as usize {
                true => skirt(&shell.outline.area, height, self.settings),
                false => Vec::new(),
            },
            walls: walls::beads(walls, height),
            infill: self.timings.time(Stage::Infill, || {
                infill::beads(&areas.sparse, layer, height, self.settings)
            }),
            skin,
        }
    }
}
