//! The stages, over a window of layers that moves up the part.
//!
//! ```text
//!   slabs of layers, in parallel     layers, in parallel      in order
//!   field → contour              ──► walls, skin, infill  ──► order, travel,
//!                                    (needs neighbours)       pace, G-code
//! ```
//!
//! While some layers are ordered and written, the next ones are made. What is
//! kept is the window and nothing of what has been written, so memory does not
//! grow with the part's height. The result does not depend on the number of
//! threads: every layer is computed the same way whoever does it, and
//! everything that passes from layer to layer (the head's place, seams,
//! filament) does so in the ordered stages.
//!
//! Nor does a layer's text depend on which layers a run is asked for: what
//! passes from layer to layer is forgotten at the beginning of every block of
//! slabs, so that a run which begins in the middle of a part gets to the same
//! state by rehearsing, at most, the layers of one block. Parts too large for one
//! machine are sliced in ranges of layers whose texts are then joined.
//!
//! | file | what it does |
//! |---|---|
//! | `layer` | what is known of a layer on its way |
//! | `sound` | notices early that next to nothing can be printed |
//! | `stages` | what can be done for many layers at a time |
//! | `supply` | does that, a window of layers ahead of who writes them |
//! | `exit` | what is done in order |
//! | `tally` | counts over all layers, and warnings that follow from them |

#[cfg(test)]
mod estimates;
mod exit;
mod layer;
mod sound;
mod stages;
mod supply;
mod supported;
mod tally;

use crate::check::{Alongside, Kind, Rules, Severity, Verdict};
use crate::contour::{FieldError, remedy};
use crate::gcode::{
    Format, Header, Thumbnail, WriteError, Writer, needs_outline,
};
use crate::hang::Hanging;
use crate::heights::{Heights, HeightsError, Steps, heights};
use crate::infill::InfillError;
use crate::layers::{LayerRange, LayerSpan, PlanError};
use crate::limits;
use crate::model::Model;
use crate::pace::Pacer;
use crate::pace::rates::Rater;
use crate::plane::offset::offset;
use crate::plane::{Area, Rect};
use crate::preview::{PictureError, Pictures, outline_from_above, thumbnails};
use crate::reader::ReadError;
use crate::relief::{Relief, ReliefError};
use crate::report::{Figures, Gauge, Report, ReportError};
use crate::settings::{Settings, Supports};
use crate::spiral::{Spiral, SpiralError};
use crate::timings::Stage;
use crate::units::{Mm, Mm2, Seconds, filament_area};
use crate::vary::{Surroundings, VaryError};
use exit::Exit;
use glam::{DVec2, DVec3};
use isocontour::SLAB;
use rayon::ThreadPool;
use stages::Stages;
use std::io;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::time::SystemTime;
use supply::Supply;
use supported::{Fills, Supported};

/// How a run is made, as opposed to what is printed.
pub struct Options<'a> {
    /// Threads to use; all of the machine's if not given.
    pub threads: Option<usize>,
    /// Which of the part's layers to write.
    pub layers: LayerRange,
    /// Folder for a picture of each layer.
    pub svg_dir: Option<&'a Path>,
    /// Measure everything, for a report, and not only a few points.
    pub report: bool,
    /// When the file is written, for its first line, which otherwise says
    /// nothing of it.
    pub timestamp: Option<SystemTime>,
    /// What the file is written as.
    pub format: Format,
    /// Check the G-code while it is written; what could hurt the printer is
    /// then an error.
    pub check: bool,
    /// Told about progress: layers written, layers in all.
    pub on_layer: &'a (dyn Fn(usize, usize) + Sync),
}

impl Default for Options<'_> {
    /// The whole part on all of the machine, and nothing besides.
    fn default() -> Self {
        Options {
            threads: None,
            layers: LayerRange::ALL,
            svg_dir: None,
            report: false,
            check: true,
            timestamp: None,
            format: Format::Text,
            on_layer: &|_, _| {},
        }
    }
}

/// What came of a run.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Summary {
    /// Extent of the part.
    pub size: DVec3,
    /// Indices of the layers printed.
    pub layers: Range<usize>,
    /// How many layers the part has.
    pub layer_count: usize,
    /// What layers of different heights amount to; nothing for uniform ones.
    pub steps: Option<Steps>,
    /// Estimated print time, without heating and homing.
    pub time: Seconds,
    /// Filament used.
    pub filament_length: Mm,
    /// Filament used, grams.
    pub filament_mass_g: f64,
    /// How much of it is for supports.
    pub support_length: Mm,
    /// Area of gaps between walls that nothing fills, all layers together.
    pub unfilled_area: Mm2,
    /// Area of all layers' outlines together.
    pub solid_area: Mm2,
    /// Moves that print.
    pub printing_moves: usize,
    /// How many of them are slower than asked for, because the printer takes no
    /// more in a second.
    pub slowed_moves: usize,
    /// Islands and holes left out because they are smaller than a quarter of
    /// the outer wall's width.
    pub dropped_rings: usize,
    /// What nothing holds while it is printed.
    pub hanging: Hanging,
    /// Distance of the outlines from f = 0, µm, if there are any; of a few
    /// points, unless there is a report.
    pub outline_error: Option<Figures>,
    /// Distance of the outer beads' edges from the outline, µm.
    pub wall_error: Option<Figures>,
    /// The report, if it was asked for.
    pub report: Option<Report>,
    /// What the check of the G-code found, if there was one: no faults.
    pub verdict: Option<Verdict>,
    /// What the user should know.
    pub warnings: Vec<String>,
    /// Where the processor time went, added up over all threads.
    pub timings: Vec<(Stage, Seconds)>,
}

/// Why a run failed.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SliceError {
    /// The range of layers lies above the part.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// No layers can be made of the part.
    #[error(transparent)]
    Heights(#[from] HeightsError),
    /// The field cannot be evaluated.
    #[error("{}{}", .0, remedy(.0))]
    Field(#[from] FieldError),
    /// A setting that is an expression has no value somewhere.
    #[error(transparent)]
    Vary(#[from] VaryError),
    /// The infill cannot be laid.
    #[error(transparent)]
    Infill(#[from] InfillError),
    /// The G-code cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// No layer has anything in it that a nozzle could print.
    #[error(
        "nothing to print: in each of the {layers} layers the part is \
         thinner than any line ({line:.2} mm wide); scale it up with --size \
         or --scale, or lower outer_wall_width or thin_min"
    )]
    NothingToPrint {
        /// How many layers were looked at.
        layers: usize,
        /// Width of the outer wall, mm.
        line: Mm,
    },
    /// Next to nothing of the part is as thick as a line.
    #[error(
        "next to nothing to print: in {looked} places looked at, all over the \
         part, {share:.0} % of its area is thinner than any line ({line:.2} mm, \
         thin_min of the outer wall's width); make it thicker, scale it up \
         with --size or --scale, or lower thin_min or outer_wall_width"
    )]
    TooThin {
        /// In how many of the places looked at there was something.
        looked: usize,
        /// The share that is too thin, %.
        share: f64,
        /// Width of the thinnest line, mm.
        line: Mm,
    },
    /// The layers' pictures cannot be written.
    #[error("cannot write the pictures in {}", .0.display())]
    Picture(PathBuf, #[source] io::Error),
    /// The part cannot be drawn.
    #[error(transparent)]
    Drawing(#[from] PictureError),
    /// The part cannot be one climbing wall.
    #[error(transparent)]
    Spiral(#[from] SpiralError),
    /// Beads cannot follow the surface.
    #[error(transparent)]
    Relief(#[from] ReliefError),
    /// The layers cannot be measured.
    #[error(transparent)]
    Report(#[from] ReportError),
    /// The threads cannot be started.
    #[error(
        "cannot start the worker threads; try --threads 1, or raise what the \
         system allows (ulimit -v, ulimit -u)"
    )]
    Threads(#[from] rayon::ThreadPoolBuildError),
    /// Nor the one that hands them their work.
    #[error(
        "cannot start the worker threads; try --threads 1, or raise what the \
         system allows (ulimit -v, ulimit -u)"
    )]
    LayersThread(#[source] io::Error),
    /// Nor the one that checks.
    #[error("cannot start a thread to check the G-code; try --no-check")]
    CheckThread(#[source] io::Error),
    /// The G-code cannot be read back.
    #[error("the G-code cannot be checked; --no-check leaves that out")]
    Unread(#[from] ReadError),
    /// The G-code could hurt the printer or the print.
    #[error(
        "the G-code should not be run on this printer:\n{}\nIf the lines \
         come from a template (gcode.start, gcode.end, gcode.layer), mend \
         that; if not, please report it with the model. --no-check leaves \
         the check out",
        .0.join("\n")
    )]
    Unsafe(Vec<String>),
}

/// Layers whose seams and travels hang together. At a block's beginning seams
/// may jump and there is a travel from anywhere, so blocks should be few; a
/// run of a range has to rehearse up to a block.
const BLOCK: usize = 4 * SLAB;

/// What hangs without a support is told of from this area on, mm².
const UNHELD: Mm2 = 1.0;

/// Slices a placed model and writes its G-code.
///
/// # Errors
/// If there is nothing to print, or it cannot be evaluated or written, or if
/// what was written fails its check.
pub fn slice(
    model: &Model,
    settings: &Settings,
    options: &Options<'_>,
    out: &mut dyn io::Write,
) -> Result<Summary, SliceError> {
    let watch = limits::Watch::current();
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(options.threads.unwrap_or(0))
        .start_handler(move |_| limits::Watch::adopt(watch.as_ref()))
        .build()?;
    let Heights { spans, steps } = pool.install(|| heights(model, settings))?;
    let layers = options.layers.indices(spans.len())?;
    let run = Run {
        model,
        settings,
        options,
        pool: &pool,
        spans: &spans,
        layers,
    };
    let mut checker = None;
    if options.check {
        let rules = Rules {
            // A range of layers goes on with what other files have printed.
            base: spans.get(run.layers.start).map_or(0.0, |span| span.bottom),
            ..Rules::new(settings)
        };
        checker = Some(Alongside::new(rules).map_err(SliceError::CheckThread)?);
    }
    let mut copy = |text: &[u8]| {
        if let Some(checker) = &mut checker {
            checker.read(text);
        }
    };
    let mut summary = write(&run, out, &mut copy)?;
    summary.steps = steps;
    if let Some(report) = &mut summary.report {
        report.steps = steps;
    }
    let Some(checker) = checker else {
        return Ok(summary);
    };
    let (verdict, time) = checker.finish()?;
    if !verdict.is_safe() {
        let faults = verdict.sentences("line", Severity::Fault);
        return Err(SliceError::Unsafe(faults));
    }
    let check = summary.timings.iter_mut().find(|(s, _)| *s == Stage::Check);
    if let Some((_, seconds)) = check {
        *seconds += time;
    }
    // Islands in the air are for the summary to tell, printers that heat in
    // their macros are as they should be, who calls a macro knows what it is,
    // and who wrote a template has been told of it by its lines.
    let told = |kind: Kind| {
        kind.severity() == Severity::Warning
            && !matches!(
                kind,
                Kind::InTheAir
                    | Kind::Unknown
                    | Kind::UnknownWord
                    | Kind::Purge
            )
    };
    summary.warnings.extend(verdict.sentences_of("line", told));
    summary.verdict = Some(verdict);
    Ok(summary)
}

/// What is to be done.
struct Run<'a> {
    model: &'a Model,
    settings: &'a Settings,
    options: &'a Options<'a>,
    pool: &'a ThreadPool,
    /// All layers of the part.
    spans: &'a [LayerSpan],
    /// Which of them are asked for.
    layers: Range<usize>,
}

/// Slices and writes; `copy` gets the text as it is composed.
fn write(
    run: &Run<'_>,
    out: &mut dyn io::Write,
    copy: &mut dyn FnMut(&[u8]),
) -> Result<Summary, SliceError> {
    let Run {
        model,
        settings,
        options,
        pool,
        spans,
        ref layers,
    } = *run;
    let bounds = model.bounds;
    let reach = DVec3::new(settings.reach(), settings.reach(), 0.0);
    let low = bounds.min + model.offset - reach;
    let high = bounds.max + model.offset + reach;
    let gauge = Gauge::new(model, settings, layers.len(), options.report)?;
    let around = Surroundings::new(model);
    let fills = Fills::new(settings);
    let mut stages = Stages::new(model, settings, &around, gauge, spans)?;
    let printed = stages.printed(pool, spans)?;
    if printed == 0 {
        return Err(SliceError::NothingToPrint {
            layers: spans.len(),
            line: settings.outer_wall_width(),
        });
    }
    let spans = &spans[..printed];
    let top = spans.last().map_or(0.0, |span| span.top);
    let layers = options.layers.indices(printed)?;
    stages.plan_spiral(pool, spans)?;
    if settings.supports != Supports::Off && !settings.spiral {
        stages.plan_supports(pool, spans, &around, &fills)?;
    }
    let relief = Relief::new(model, settings, &around)?;
    let rater = Rater::new(settings, model, &around)?;
    // Before hours of work, not after them.
    for span in &spans[layers.clone()] {
        rater.temperature(span)?;
    }
    let pictures = pool.install(|| {
        let timings = &stages.timings;
        timings.time(Stage::Picture, || pictures_of(model, settings))
    })?;
    let no_picture = pictures.is_none().then(|| {
        "the file has no picture of the part, as drawing this expression would \
         take too long; gcode.thumbnails = \"\" asks for none"
            .to_owned()
    });
    let header = Header {
        model_name: model.name.clone(),
        layer_count: spans.len(),
        layers: layers.clone(),
        timestamp: options.timestamp,
        nozzle_temperature: match spans.get(layers.start) {
            Some(span) => rater.temperature(span)?,
            None => settings.filament.first_layer_nozzle_temperature,
        },
        part_min: low,
        part_max: high,
        outline: match needs_outline(settings) {
            true => pool.install(|| {
                stages.timings.time(Stage::Picture, || {
                    outline_of(model, settings.reach())
                })
            })?,
            false => Vec::new(),
        },
        thumbnails: pictures.unwrap_or_default(),
        format: options.format,
    };
    let frame = Rect {
        min: low.truncate(),
        max: high.truncate(),
    };
    let drawings = options
        .svg_dir
        .map(|dir| {
            Pictures::new(dir, frame, &layers, spans.len())
                .map_err(|e| SliceError::Picture(dir.to_owned(), e))
        })
        .transpose()?;
    let writer = Writer::new(out, settings, &header, copy)?;
    let of_templates = writer.warnings().to_vec();
    let mut exit = Exit::new(
        &stages.timings,
        model.offset.truncate(),
        layers.clone(),
        spans.len(),
        options,
        drawings,
        writer,
        Pacer::new(settings, rater),
        stages.spiral.as_ref(),
        relief,
    );

    Supply::new(&stages, pool, spans, layers.clone())
        .each(|ready| exit.layer(ready))?;
    let done = exit.finish()?;
    let (tally, mut warnings) = (done.tally, of_templates);
    warnings.extend(no_picture);
    warnings.extend(stages.spiral.iter().flat_map(Spiral::warnings));
    warnings.extend(done.warnings);
    let mut hanging = done.hanging;
    if let Some(unheld) = stages.support().map(Supported::unheld) {
        // The plan has seen to what hangs, and tells what it could not hold.
        hanging = Hanging::default();
        if unheld.area > UNHELD {
            let at = unheld.worst + model.offset.truncate().extend(0.0);
            warnings.push(format!(
                "{:.1} mm² that need supports get none, the largest of it at \
                 x = {:.1}, y = {:.1}, z = {:.1} on the bed: no support \
                 reaches it from below{}",
                unheld.area,
                at.x,
                at.y,
                at.z,
                match settings.supports {
                    Supports::Plate =>
                        "; supports = auto may stand on the part",
                    _ => "; turn the part, or open what is around it",
                }
            ));
        }
    }
    hanging.foot = done.foot.filter(|foot| top > foot.holds);
    warnings.extend(hanging.warnings(top, settings));
    if done.beads == 0 {
        warnings.push("there is nothing to print in these layers".into());
    }
    tally.warn(&mut warnings);
    let totals = done.totals;
    let (outline_error, wall_error) = done.figures.accuracy();
    let report = match (spans.get(layers.start), spans.get(layers.end - 1)) {
        (Some(first), Some(last)) if options.report => {
            let z = [first.bottom, last.top].map(|z| z - model.offset.z);
            let volume =
                pool.install(|| stages.gauge.volume(z, &stages.timings))?;
            let extruded = totals.filament_volume;
            Some(done.figures.report(
                &stages.gauge,
                spans.len(),
                volume,
                extruded,
            ))
        }
        _ => None,
    };
    Ok(Summary {
        size: bounds.size(),
        layers,
        layer_count: spans.len(),
        steps: None,
        time: totals.time,
        filament_length: totals.filament_length,
        filament_mass_g: totals.filament_mass_g,
        support_length: tally.support
            / filament_area(settings.filament.diameter),
        unfilled_area: tally.gap,
        solid_area: tally.solid,
        printing_moves: tally.printing,
        slowed_moves: tally.slowed,
        dropped_rings: tally.dropped_rings,
        hanging,
        outline_error,
        wall_error,
        report,
        verdict: None,
        warnings,
        timings: stages.timings.report(),
    })
}

/// A convex ring around what is printed, which reaches that far beyond the
/// part.
fn outline_of(model: &Model, reach: Mm) -> Result<Vec<DVec2>, PictureError> {
    /// How far its round corners may be off, mm.
    const TOLERANCE: Mm = 0.02;
    let ring = outline_from_above(model)?;
    if reach <= 0.0 {
        return Ok(ring);
    }
    let grown = offset(&Area { rings: vec![ring] }, reach, TOLERANCE);
    Ok(grown.rings.into_iter().next().unwrap_or_default())
}

/// The pictures for the file's head, if they can be afforded.
fn pictures_of(
    model: &Model,
    settings: &Settings,
) -> Result<Option<Vec<Thumbnail>>, PictureError> {
    let sizes = settings.gcode.thumbnails.all();
    Ok(thumbnails(model, sizes)?.map(|files| {
        let pictures = sizes.iter().zip(files);
        pictures
            .map(|(&size, file)| Thumbnail { size, file })
            .collect()
    }))
}
