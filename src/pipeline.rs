//! The stages, over a window of layers that moves up the part.
//!
//! ```text
//!   slabs of layers, in parallel     layers, in parallel      in order
//!   field → contour → walls      ──► skin, infill         ──► order, travel,
//!                                    (needs neighbours)       pace, G-code
//! ```
//!
//! While one chunk of layers is ordered and written, the next one's outlines
//! are made. What is kept is the window and nothing of what has been written,
//! so memory does not grow with the part's height. The result does not depend
//! on the number of threads: every layer is computed the same way whoever
//! does it, and everything that passes from layer to layer (the head's place,
//! seams, filament) does so in the ordered stages.

use crate::adhesion::skirt;
use crate::contour::{Outline, outlines};
use crate::field::{Field, FieldError, SLAB};
use crate::gcode::{Header, WriteError, Writer};
use crate::layers::{LayerSpan, PlanError, plan};
use crate::model::Model;
use crate::order::{Head, LayerBeads, order};
use crate::pace::Pacer;
use crate::plane::grid::EdgeGrid;
use crate::plane::{Area, Rect};
use crate::preview::layer_svg;
use crate::region::cover::Cover;
use crate::region::exposure::{roomy, split};
use crate::region::{OUTLINE_SHARE, Walls, field_walls, wall_depths, walls};
use crate::settings::{Settings, WallOffset};
use crate::timings::{Stage, Timings};
use crate::travel::connect;
use crate::units::{Mm, Mm2, Seconds};
use crate::{infill, skin, walls};
use glam::{DVec2, DVec3};
use rayon::prelude::*;
use std::collections::VecDeque;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// How a run is made, as opposed to what is printed.
pub struct Options<'a> {
    /// Threads to use; all of the machine's if not given.
    pub threads: Option<usize>,
    /// Folder for a picture of each layer.
    pub svg_dir: Option<&'a Path>,
    /// Told about progress: layers written, layers in all.
    pub on_layer: &'a (dyn Fn(usize, usize) + Sync),
}

/// What came of a run.
#[derive(Clone, Debug)]
pub struct Summary {
    /// Extent of the part.
    pub size: DVec3,
    /// Layers printed.
    pub layers: usize,
    /// Estimated print time, without heating and homing.
    pub time: Seconds,
    /// Filament used.
    pub filament_length: Mm,
    /// Filament used, grams.
    pub filament_mass_g: f64,
    /// Area of gaps between walls that nothing fills, all layers together.
    pub unfilled_area: Mm2,
    /// Area of all layers' outlines together.
    pub solid_area: Mm2,
    /// What the user should know.
    pub warnings: Vec<String>,
    /// Where the time went, added up over all threads.
    pub timings: Vec<(Stage, Seconds)>,
}

/// Why a run failed.
#[derive(Debug, thiserror::Error)]
pub enum SliceError {
    /// No layers can be made of the part.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// The field cannot be evaluated.
    #[error(transparent)]
    Field(#[from] FieldError),
    /// The G-code cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// No layer has anything in it that a nozzle could print.
    #[error(
        "nothing to print: the part is thinner than a line everywhere; scale \
         it up with --size or --scale, or lower outer_wall_width"
    )]
    NothingToPrint,
    /// A layer's picture cannot be written.
    #[error("cannot write the picture {}", .0.display())]
    Picture(PathBuf, #[source] io::Error),
    /// The threads cannot be started.
    #[error("cannot start the worker threads; try --threads 1")]
    Threads(#[from] rayon::ThreadPoolBuildError),
}

/// Layers that are filled before they are written.
const BATCH: usize = 8;

/// Heights closer than this differ by rounding only, mm.
const SAME_HEIGHT: Mm = 1e-9;

/// A layer whose outline and walls are known. Layers that are the same as
/// the one below, as those of a prism are, share all of it.
struct Shell {
    span: LayerSpan,
    outline: Arc<Outline>,
    /// The outline again, for asking what is where.
    solid: Arc<EdgeGrid>,
    walls: Arc<Walls>,
    /// What sparse infill fits into.
    roomy: Arc<Area>,
}

/// Slices a placed model and writes its G-code.
///
/// # Errors
/// If there is nothing to print, or it cannot be evaluated or written.
pub fn slice(
    model: &Model,
    settings: &Settings,
    options: &Options<'_>,
    out: &mut dyn io::Write,
) -> Result<Summary, SliceError> {
    let bounds = model.bounds;
    let (low, high) = (bounds.min + model.offset, bounds.max + model.offset);
    let spans =
        plan(high.z, settings.first_layer_height, settings.layer_height)?;
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(options.threads.unwrap_or(0))
        .build()?;
    let stages = Stages::new(model, settings)?;
    let header = Header {
        model_name: model.name.clone(),
        layer_count: spans.len(),
        part_min: low,
        part_max: high,
    };
    let mut exit = Exit {
        settings,
        options,
        offset: model.offset.truncate(),
        frame: Rect {
            min: low.truncate(),
            max: high.truncate(),
        },
        head: Head::default(),
        pacer: Pacer::new(settings),
        writer: Writer::new(out, settings, &header)?,
        written: 0,
        timings: &stages.timings,
        total: spans.len(),
        beads: 0,
        warnings: Vec::new(),
    };
    let mut tally = Tally::default();

    // As many slabs at a time as there are threads. A slab is the unit in
    // which the field is walked, so the division must not depend on them.
    let slabs: Vec<&[LayerSpan]> = spans.chunks(SLAB).collect();
    let chunks: Vec<&[&[LayerSpan]]> =
        slabs.chunks(pool.current_num_threads()).collect();
    let make = |chunk: &[&[LayerSpan]]| -> Result<Vec<Shell>, FieldError> {
        pool.install(|| {
            let slabs: Result<Vec<Vec<Shell>>, FieldError> =
                chunk.par_iter().map(|s| stages.shells(s)).collect();
            Ok(slabs?.into_iter().flatten().collect())
        })
    };
    let mut window: VecDeque<Shell> = VecDeque::new();
    let mut next = Some(match chunks.first() {
        Some(chunk) => make(chunk),
        None => Ok(Vec::new()),
    });
    for k in 0..chunks.len() {
        let Some(shells) = next.take() else { break };
        for mut shell in shells? {
            tally.add(&shell);
            // Also where one slab ends and the next begins.
            if let Some(below) = window.back()
                && below.outline == shell.outline
            {
                shell.outline = below.outline.clone();
            }
            window.push_back(shell);
        }
        let last = k + 1 == chunks.len();
        let mut write =
            || stages.write_ready(&pool, &mut window, last, &mut exit);
        if last {
            write()?;
        } else if pool.current_num_threads() == 1 {
            write()?;
            next = Some(make(chunks[k + 1]));
        } else {
            let mut result = Ok(());
            pool.in_place_scope(|scope| {
                scope.spawn(|_| next = Some(make(chunks[k + 1])));
                result = write();
            });
            result?;
        }
    }
    if exit.beads == 0 {
        return Err(SliceError::NothingToPrint);
    }
    tally.warn(&mut exit.warnings);
    let totals = exit.writer.finish()?;
    Ok(Summary {
        size: bounds.size(),
        layers: spans.len(),
        time: totals.time,
        filament_length: totals.filament_length,
        filament_mass_g: totals.filament_mass_g,
        unfilled_area: tally.gap,
        solid_area: tally.solid,
        warnings: exit.warnings,
        timings: stages.timings.report(),
    })
}

/// What the layers have in common.
struct Stages<'a> {
    settings: &'a Settings,
    field: Field,
    /// The fields of the walls, if they are offsets of the expression.
    wall_fields: Vec<Field>,
    /// Height of the bed in the model's coordinates.
    bed: Mm,
    top_layers: usize,
    bottom_layers: usize,
    timings: Timings,
}

impl<'a> Stages<'a> {
    fn new(model: &Model, settings: &'a Settings) -> Result<Self, FieldError> {
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
        })
    }

    /// Outlines and walls of a slab's layers.
    fn shells(&self, spans: &[LayerSpan]) -> Result<Vec<Shell>, FieldError> {
        let z: Vec<Mm> =
            spans.iter().map(|s| s.sample_z() + self.bed).collect();
        let accuracy = self.settings.accuracy * OUTLINE_SHARE;
        let make = |f: &Field| outlines(f, &z, accuracy, &self.timings);
        let outlines_of_slab = make(&self.field)?;
        // For walls that are offsets of the expression: by depth, by layer.
        let mut offset_outlines = self
            .wall_fields
            .iter()
            .map(|f| Ok(make(f)?.into_iter()))
            .collect::<Result<Vec<_>, FieldError>>()?;
        let mut shells: Vec<Shell> = Vec::with_capacity(spans.len());
        for (&span, outline) in spans.iter().zip(outlines_of_slab) {
            let height = span.height();
            let areas: Vec<Area> = offset_outlines
                .iter_mut()
                .filter_map(|o| o.next().map(|o| o.area))
                .collect();
            if let Some(below) = shells.last()
                && *below.outline == outline
                && (below.span.height() - height).abs() < SAME_HEIGHT
                && areas.is_empty()
            {
                let same = Shell {
                    span,
                    outline: below.outline.clone(),
                    solid: below.solid.clone(),
                    walls: below.walls.clone(),
                    roomy: below.roomy.clone(),
                };
                shells.push(same);
                continue;
            }
            let walls = self.timings.time(Stage::Walls, || {
                let outline = &outline.area;
                match areas.is_empty() {
                    true => walls(outline, height, self.settings),
                    false => field_walls(outline, areas, height, self.settings),
                }
            });
            let roomy = self
                .timings
                .time(Stage::Skin, || roomy(&walls.fill, self.settings));
            shells.push(Shell {
                span,
                solid: Arc::new(EdgeGrid::new(&outline.area, 1.0)),
                outline: Arc::new(outline),
                walls: Arc::new(walls),
                roomy: Arc::new(roomy),
            });
        }
        Ok(shells)
    }

    /// Fills, orders and writes the window's layers whose upper neighbours
    /// are known, and drops those that no later layer looks at.
    fn write_ready(
        &self,
        pool: &rayon::ThreadPool,
        window: &mut VecDeque<Shell>,
        last: bool,
        exit: &mut Exit<'_, '_>,
    ) -> Result<(), SliceError> {
        // Roles look at the next layer, whatever the skin's thickness.
        let hidden = if last { 0 } else { self.top_layers.max(1) };
        let keep = self.bottom_layers.max(1);
        loop {
            // A few layers at a time: their beads take as much memory as
            // their outlines.
            let first = window.front().map_or(0, |s| s.span.index);
            let from = exit.written - first;
            let end = window.len().saturating_sub(hidden);
            let ready = from..end.min(from + BATCH);
            if ready.is_empty() {
                return Ok(());
            }
            let shells: &VecDeque<Shell> = window;
            let beads: Vec<LayerBeads> = pool.install(|| {
                ready
                    .clone()
                    .into_par_iter()
                    .map(|i| self.beads(shells, i))
                    .collect()
            });
            for (i, beads) in ready.zip(beads) {
                exit.layer(&window[i], beads)?;
            }
            let keep = exit.written.saturating_sub(keep);
            while window.front().is_some_and(|s| s.span.index < keep) {
                window.pop_front();
            }
        }
    }

    /// Everything there is to print in layer `i` of the window.
    fn beads(&self, window: &VecDeque<Shell>, i: usize) -> LayerBeads {
        let shell = &window[i];
        let Shell { span, walls, .. } = shell;
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
            Some(Some(Cover {
                area: &near.outline.area,
                grid: &near.solid,
            }))
        };
        let above: Vec<_> = (1..=self.top_layers)
            .filter_map(|k| cover(i.checked_add(k)))
            .collect();
        let below: Vec<_> = (1..=self.bottom_layers)
            .filter_map(|k| cover(i.checked_sub(k)))
            .collect();
        let layer = span.index;
        let (areas, skin) = self.timings.time(Stage::Skin, || {
            let areas =
                split(&walls.fill, &shell.roomy, &above, &below, self.settings);
            let solid = |k: Option<usize>| {
                k.and_then(|k| window.get(k)).map(|s| &*s.solid)
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

/// The stages that run in order.
struct Exit<'a, 'w> {
    settings: &'a Settings,
    options: &'a Options<'a>,
    /// From the model's coordinates to the bed's.
    offset: DVec2,
    /// The part's box on the bed.
    frame: Rect,
    head: Head,
    pacer: Pacer<'a>,
    writer: Writer<'a, &'w mut dyn io::Write>,
    written: usize,
    timings: &'a Timings,
    total: usize,
    beads: usize,
    warnings: Vec<String>,
}

impl Exit<'_, '_> {
    fn layer(
        &mut self,
        shell: &Shell,
        mut beads: LayerBeads,
    ) -> Result<(), SliceError> {
        self.drop_skirt_off_the_bed(&mut beads);
        let from = self.head.at;
        let outline = &shell.outline.area;
        let path = self.timings.time(Stage::Travel, || {
            let beads = order(beads, outline, &mut self.head, self.settings);
            self.beads += beads.len();
            connect(
                shell.span,
                beads,
                &shell.solid,
                from,
                self.offset,
                self.settings,
            )
        });
        if let Some(dir) = self.options.svg_dir {
            let name = format!("layer-{:05}.svg", shell.span.index);
            let file = dir.join(name);
            std::fs::create_dir_all(dir)
                .and_then(|()| {
                    std::fs::write(&file, layer_svg(&path, self.frame))
                })
                .map_err(|e| SliceError::Picture(file, e))?;
        }
        let paced = self.timings.time(Stage::Pace, || self.pacer.layer(path));
        self.timings
            .time(Stage::Gcode, || self.writer.layer(&paced))?;
        self.written += 1;
        (self.options.on_layer)(self.written, self.total);
        Ok(())
    }

    fn drop_skirt_off_the_bed(&mut self, beads: &mut LayerBeads) {
        let printer = &self.settings.printer;
        let bed = Rect {
            min: DVec2::ZERO,
            max: DVec2::new(printer.bed_x, printer.bed_y),
        };
        let before = beads.skirt.len();
        beads.skirt.retain(|b| {
            let half = DVec2::splat(0.5 * b.width);
            b.points.iter().all(|&p| {
                let p = p + self.offset;
                bed.contains(p - half) && bed.contains(p + half)
            })
        });
        if beads.skirt.len() < before && self.written == 0 {
            self.warnings.push(
                "the skirt does not fit on the bed and is left out; lower \
                 skirt.distance or set skirt.loops = 0"
                    .into(),
            );
        }
    }
}

/// What is counted over all layers.
#[derive(Default)]
struct Tally {
    gap: Mm2,
    solid: Mm2,
    nan_samples: usize,
    nan_layers: usize,
    forced_rings: usize,
    /// Layers seen, those without anything in them since the last one that
    /// had, and those that something comes after.
    layers: usize,
    empty: usize,
    bridged: usize,
}

impl Tally {
    fn add(&mut self, shell: &Shell) {
        self.gap += shell.walls.gap;
        self.solid += shell.outline.area.content();
        self.nan_samples += shell.outline.nan_samples;
        self.nan_layers += usize::from(shell.outline.nan_samples > 0);
        self.forced_rings += shell.outline.forced_rings;
        self.layers += 1;
        if shell.outline.area.is_empty() {
            self.empty += 1;
        } else {
            self.bridged += std::mem::take(&mut self.empty);
        }
    }

    fn warn(&self, warnings: &mut Vec<String>) {
        if self.bridged > 0 {
            warnings.push(format!(
                "{} of {} layers are empty and others follow above them: the \
                 part is not in one piece, or does not stand on the bed",
                self.bridged, self.layers
            ));
        }
        if self.gap > 0.02 * self.solid {
            warnings.push(format!(
                "{:.0} % of the part is thinner than any line and is left \
                 out; scale it up, or lower outer_wall_width or thin_min",
                100.0 * self.gap / self.solid
            ));
        }
        if self.nan_samples > 0 {
            warnings.push(format!(
                "the field is not a number at {} samples in {} layers; they \
                 count as outside (look for a root or logarithm of a negative \
                 number, or 0/0, in the model)",
                self.nan_samples, self.nan_layers
            ));
        }
        if self.forced_rings > 0 {
            warnings.push(format!(
                "{} outlines did not close and were closed by straight \
                 lines: please report this with the model",
                self.forced_rings
            ));
        }
    }
}
