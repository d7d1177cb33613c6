//! The stages, over a window of layers that moves up the part.
//!
//! ```text
//!   slabs of layers, in parallel     layers, in parallel      in order
//!   field → contour              ──► walls, skin, infill  ──► order, travel,
//!                                    (needs neighbours)       pace, G-code
//! ```
//!
//! While some layers are ordered and written, the next ones are made. Only the
//! window is kept, and nothing of what has been written, so memory does not
//! grow with the part's height. A part with supports is an exception: they are
//! planned from the top down, and their plan has coarse areas for all layers.
//! The result does not depend on the number of threads: every layer is computed
//! in one way whoever does it, and everything that passes from layer to layer
//! (the head's place, seams, filament) does so in the ordered stages.
//!
//! A layer's text does not depend on which layers a run is asked for, either.
//! What passes from layer to layer is forgotten at the beginning of every block
//! of slabs. So a run that begins in the middle of a part gets to the right
//! state if it rehearses the layers of one block at most. Parts too large for
//! one machine are sliced in ranges of layers whose texts are then joined.
//!
//! | file | what it does |
//! |---|---|
//! | `layer` | what is known of a layer on its way |
//! | `raft` | layers between the bed and the part |
//! | `sound` | notices early that next to nothing can be printed |
//! | `stages` | what can be done for many layers at a time |
//! | `supply` | runs `stages` for a window of layers ahead of those that are written |
//! | `part` | what is done in order for each part |
//! | `hanging` | follows what hangs, also when no bead is laid |
//! | `exit` | what is done in order for all parts |
//! | `split` | divides layers into ranges of about equal cost |
//! | `fingerprint` | what files of ranges of one print have in common |
//! | `tally` | counts over all layers, and warnings that follow from the counts |

#[cfg(test)]
mod estimates;
mod exit;
mod fingerprint;
mod hanging;
mod layer;
mod part;
mod raft;
mod sound;
mod split;
mod stages;
mod supply;
mod supported;
mod tally;

use crate::adhesion::{Skirt, brim_reach, hull};
use crate::check::{Alongside, Kind, Rules, Severity, Verdict};
use crate::contour::{FieldError, remedy};
use crate::gcode::{
    Format, Header, Standing, Thumbnail, WriteError, Writer, needs_outline,
    thick_beads,
};
use crate::hang::Hanging;
use crate::heights::{Heights, HeightsError, Steps, heights};
use crate::infill::InfillError;
use crate::layers::{LayerRange, LayerSpan, PlanError};
use crate::limits;
use crate::model::Model;
use crate::pace::rates::Rater;
use crate::plane::offset::offset;
use crate::plane::{Area, Rect, Ring};
use crate::plate::{Part, Plate};
use crate::preview::{PictureError, Pictures, outline_from_above, thumbnails};
use crate::reader::ReadError;
use crate::relief::{Relief, ReliefError};
use crate::report::{Figures, Gauge, Report, ReportError, RoleSum};
use crate::settings::{DraftShield, LayerHeights, Settings, Supports, Varying};
use crate::spiral::{Spiral, SpiralError};
use crate::timings::Stage;
use crate::units::{Mm, Mm2, Seconds, filament_area};
use crate::vary::{Surroundings, VaryError};
use exit::Exit;
use fingerprint::fingerprint;
use glam::{DVec2, DVec3};
pub use hanging::{Survey, survey};
use isocontour::{ExpandError, SLAB};
use part::{PartDone, PartExit, Passed};
use rayon::ThreadPool;
pub use split::{Share, split};
use stages::Stages;
use std::collections::BTreeMap;
use std::io;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::time::SystemTime;
use supply::Supplies;
use supported::Fills;

/// How a run is made, as opposed to what is printed.
pub struct Options<'a> {
    /// Number of threads; none for as many as the machine has.
    pub threads: Option<usize>,
    /// Which of the part's layers to write.
    pub layers: LayerRange,
    /// Folder for a picture of each layer.
    pub svg_dir: Option<&'a Path>,
    /// Measure everything, for a report, and not only a few points.
    pub report: bool,
    /// When the file is written, for its first line. Without it that line has
    /// no time.
    pub timestamp: Option<SystemTime>,
    /// Format of the file.
    pub format: Format,
    /// Check the G-code while it is written. Whatever could hurt the printer is
    /// then an error.
    pub check: bool,
    /// Called with the number of layers written, and that of all layers.
    pub on_layer: &'a (dyn Fn(usize, usize) + Sync),
}

impl Default for Options<'_> {
    /// The whole part on all of the machine's threads, and nothing else.
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

/// The results of a run.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Summary {
    /// Extent of the part.
    pub size: DVec3,
    /// Indices of the layers printed.
    pub layers: Range<usize>,
    /// How many layers the part has.
    pub layer_count: usize,
    /// Number of the lowest layers that are a raft's.
    pub raft_layers: usize,
    /// What layers of different heights amount to; none for uniform layers.
    pub steps: Option<Steps>,
    /// Estimated print time, without heating and homing.
    pub time: Seconds,
    /// Filament used.
    pub filament_length: Mm,
    /// Filament used, grams.
    pub filament_mass_g: f64,
    /// Filament used for supports.
    pub support_length: Mm,
    /// What the beads of each role amount to, by the role's name. Roles without
    /// beads are left out.
    pub roles: BTreeMap<&'static str, RoleSum>,
    /// Area of gaps between walls that nothing fills, all layers together.
    pub unfilled_area: Mm2,
    /// Area of all layers' outlines together.
    pub solid_area: Mm2,
    /// Number of moves that print.
    pub printing_moves: usize,
    /// Number of moves that are slower than asked for, because the printer
    /// takes only so many in a second.
    pub slowed_moves: usize,
    /// Islands and holes left out because they are smaller than a quarter of
    /// the outer wall's width.
    pub dropped_rings: usize,
    /// What nothing holds while it is printed.
    pub hanging: Hanging,
    /// Distance of the outlines from f = 0, µm, if there are outlines. Without
    /// a report it is measured at a few points.
    pub outline_error: Option<Figures>,
    /// Distance of the outer beads' edges from the outline, µm.
    pub wall_error: Option<Figures>,
    /// The report, if it was asked for.
    pub report: Option<Report>,
    /// The results of each part. Equal parts count as copies of one.
    pub parts: Vec<PartSummary>,
    /// The verdict of the check of the G-code, if there was a check. It has no
    /// faults.
    pub verdict: Option<Verdict>,
    /// What the user should know.
    pub warnings: Vec<String>,
    /// Where the processor time went, added up over all threads.
    pub timings: Vec<(Stage, Seconds)>,
}

/// The results of a part of a plate.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct PartSummary {
    /// Name of the part's model.
    pub name: String,
    /// Number of places in which the part stands.
    pub copies: usize,
    /// Extent of the part.
    pub size: DVec3,
    /// Number of the part's layers.
    pub layer_count: usize,
    /// Filament that each copy takes, with its supports and its brim.
    pub filament_length: Mm,
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
    /// The expression is too large.
    #[error(transparent)]
    Expression(#[from] ExpandError),
    /// The infill cannot be laid.
    #[error(transparent)]
    Infill(#[from] InfillError),
    /// The G-code cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// The part does not fit under the printer's top on its raft.
    #[error(
        "on its raft of {lift:.3} mm the part is {:.3} mm too high: its top is \
         at {top:.3} mm, and the printer has {most} mm; lower raft.layers, or \
         make the part smaller with --size or --scale",
        top - most
    )]
    RaftTooHigh {
        /// Height of the raft and of the air above it, mm.
        lift: Mm,
        /// Height of the part's top, mm.
        top: Mm,
        /// Greatest height of a print, mm.
        most: Mm,
    },
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
    /// Hardly any of the part is as thick as a line.
    #[error(
        "next to nothing to print: in {looked} places looked at, all over the \
         part, {share:.0} % of its area is thinner than any line ({line:.2} mm, \
         thin_min of the outer wall's width); make it thicker, scale it up \
         with --size or --scale, or lower thin_min or outer_wall_width"
    )]
    TooThin {
        /// Number of the places looked at that had something in them.
        looked: usize,
        /// The share that is too thin, %.
        share: f64,
        /// Width of the thinnest line, mm.
        line: Mm,
    },
    /// One part of several cannot be sliced.
    #[error("{name}: {error}")]
    OfPart {
        /// Name of the part's model.
        name: String,
        /// The part's error.
        error: Box<SliceError>,
    },
    /// There is nothing on the plate.
    #[error("there are no parts on the plate; give it one")]
    NoParts,
    /// Several parts cannot be measured.
    #[error(
        "--report measures one part, and there are several on the plate; \
         leave it out, or slice the parts one by one for their reports"
    )]
    ReportOfSeveral,
    /// A range of layers where there is none.
    #[error(
        "--layers takes layers of all parts together, and plate.sequence = \
         \"one-by-one\" prints one part after the other; leave it out, or set \
         plate.sequence = \"all-at-once\""
    )]
    RangeOneByOne,
    /// A range of layers for a file that holds whole prints.
    #[error(
        "a plate for Bambu Lab's printers (.gcode.3mf) holds a whole print, and \
         --layers asks for a part of it; write the ranges as .gcode"
    )]
    RangeInPlate,
    /// The parts are too many or too large for layers whose heights follow the
    /// surfaces.
    #[error(
        "layer_heights: the parts' expressions are too large together for \
         layers that follow all of their surfaces; set it to \"uniform\", or \
         slice the parts one by one"
    )]
    TooLargeTogether,
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
    /// The thread that hands out work to the threads cannot be started.
    #[error(
        "cannot start the worker threads; try --threads 1, or raise what the \
         system allows (ulimit -v, ulimit -u)"
    )]
    LayersThread(#[source] io::Error),
    /// The thread that checks the G-code cannot be started.
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

/// Number of layers whose seams and travels depend on each other. At a block's
/// beginning seams may jump, and there is a travel from anywhere, so blocks
/// should be few. A run of a range has to rehearse up to a whole block.
const BLOCK: usize = 4 * SLAB;

/// Accuracy of heights, mm.
const FIT: Mm = 1e-3;

/// Heights that differ by less do so by rounding only, mm.
const ROUNDED: Mm = 1e-6;

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
    slice_plate(&Plate::of(model, settings), options, out)
}

/// Slices all parts of a plate and writes their G-code.
///
/// # Errors
/// Those of [`slice()`], and an error if the options ask for something that a
/// plate of several parts does not have.
pub fn slice_plate(
    plate: &Plate,
    options: &Options<'_>,
    out: &mut dyn io::Write,
) -> Result<Summary, SliceError> {
    if options.report && plate.place_count() > 1 {
        return Err(SliceError::ReportOfSeveral);
    }
    if options.layers != LayerRange::ALL {
        if plate.turns().is_some() {
            return Err(SliceError::RangeOneByOne);
        }
        if options.format == Format::Plate {
            return Err(SliceError::RangeInPlate);
        }
    }
    let pool = pool(options.threads)?;
    let on_bed = plate;
    let plate = &plate.raised()?;
    let (spans, steps) = pool.install(|| layers_of(plate))?;
    let tallest = spans.iter().max_by_key(|spans| spans.len());
    let all = tallest.map_or(&[][..], |spans| spans.as_slice());
    let layers = options.layers.indices(all.len())?;
    let mut checker = None;
    if options.check {
        let rules = Rules {
            // A range of layers continues what other files have printed.
            base: all.get(layers.start).map_or(0.0, |span| span.bottom),
            ..Rules::new(&plate.settings)
        };
        checker = Some(Alongside::new(rules).map_err(SliceError::CheckThread)?);
    }
    let mut copy = |text: &[u8]| {
        if let Some(checker) = &mut checker {
            checker.read(text);
        }
    };
    let run = Run {
        plate,
        on_bed,
        options,
        pool: &pool,
        spans: &spans,
        layers,
    };
    let mut summary = write(&run, out, &mut copy)?;
    summary.steps = steps;
    if let Some(report) = &mut summary.report {
        report.steps = steps;
        report.roles = summary.roles.clone();
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
    // The summary tells of islands in the air. Printers that heat in their
    // macros are as they should be. Whoever calls a macro knows what it is, and
    // whoever wrote a template was told of its lines.
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

/// A pool of so many threads, or as many as the machine has, under the watch of
/// this thread.
fn pool(
    threads: Option<usize>,
) -> Result<ThreadPool, rayon::ThreadPoolBuildError> {
    let watch = limits::Watch::current();
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads.unwrap_or(0))
        .start_handler(move |_| limits::Watch::adopt(watch.as_ref()))
        .build()
}

/// The layers of each part, from the bed. Parts of uniform layers share them.
/// If heights follow the surface, they follow the surfaces of all parts.
fn layers_of(
    plate: &Plate,
) -> Result<(Vec<Vec<LayerSpan>>, Option<Steps>), SliceError> {
    let uniform = plate.settings.layer_heights
        == Varying::Constant(LayerHeights::Uniform);
    if let (false, [_, _, ..]) = (uniform, plate.parts.as_slice()) {
        let Some(whole) = plate.of_each() else {
            return Err(SliceError::TooLargeTogether);
        };
        let Heights { spans, steps } = heights(&whole, &plate.settings)?;
        let of_part = |part: &Part| {
            let top = part.model.printed_bounds().max.z;
            let has = |s: &&LayerSpan| s.sample_z() < top;
            spans.iter().take_while(has).copied().collect()
        };
        return Ok((plate.parts.iter().map(of_part).collect(), steps));
    }
    let mut all = Vec::new();
    let mut steps = None;
    for part in &plate.parts {
        let found = heights(&part.model, &part.settings)
            .map_err(|e| plate.named(part, e.into()))?;
        all.push(found.spans);
        steps = found.steps;
    }
    Ok((all, steps))
}

impl Plate {
    /// The plate with its parts on their rafts, if they have any.
    fn raised(&self) -> Result<Plate, SliceError> {
        let lift = self.settings.raft_height();
        let mut raised = self.clone();
        if lift == 0.0 {
            return Ok(raised);
        }
        let most = self.settings.printer.height;
        for part in &mut raised.parts {
            part.model = part.model.raised(lift);
            let top = part.model.printed_bounds().max.z;
            if top > most + FIT {
                let error = SliceError::RaftTooHigh { lift, top, most };
                return Err(self.named(part, error));
            }
        }
        Ok(raised)
    }

    /// An error of a part, with the part's name if there are several.
    fn named(&self, part: &Part, error: SliceError) -> SliceError {
        match self.parts.len() {
            1 => error,
            _ => SliceError::OfPart {
                name: part.model.name.clone(),
                error: Box::new(error),
            },
        }
    }

    /// A warning about a part, with the part's name if there are several.
    fn told(&self, part: &Part, warning: String) -> String {
        match self.parts.len() {
            1 => warning,
            _ => format!("{}: {warning}", part.model.name),
        }
    }
}

/// What a run has to do.
struct Run<'a> {
    plate: &'a Plate,
    /// The plate without rafts, for pictures.
    on_bed: &'a Plate,
    options: &'a Options<'a>,
    pool: &'a ThreadPool,
    /// All layers of each part.
    spans: &'a [Vec<LayerSpan>],
    /// The layers to be written.
    layers: Range<usize>,
}

/// What the stages of a part need.
struct Base<'a> {
    part: &'a Part,
    spans: &'a [LayerSpan],
    around: Surroundings<'a>,
    fills: Fills,
    raft_fills: raft::Fills,
}

/// Slices and writes. `copy` gets the text as it is composed.
fn write(
    run: &Run<'_>,
    out: &mut dyn io::Write,
    copy: &mut dyn FnMut(&[u8]),
) -> Result<Summary, SliceError> {
    let Run {
        plate,
        on_bed,
        options,
        pool,
        spans,
        ref layers,
    } = *run;
    let settings = &plate.settings;
    let (low, high) = plate.reach();
    let bases = plate.parts.iter().zip(spans).map(|(part, spans)| Base {
        part,
        spans,
        around: Surroundings::new(&part.model),
        fills: Fills::new(&part.settings),
        raft_fills: raft::Fills::new(&part.settings),
    });
    let bases: Vec<Base<'_>> = bases.collect();
    let mut all = Vec::new();
    for base in &bases {
        let make = || stages_of(base, layers, options, pool);
        all.push(make().map_err(|e| plate.named(base.part, e))?);
    }
    // There are as many layers as the highest part has.
    let count = all.iter().map(|(_, spans)| spans.len()).max().unwrap_or(0);
    let layers = options.layers.indices(count)?;
    for ((stages, spans), base) in all.iter_mut().zip(&bases) {
        plan(stages, spans, base, pool)
            .map_err(|e| plate.named(base.part, e))?;
    }
    let skirt = pool.install(|| skirt_round(plate, &all))?;
    let raters = bases.iter().map(|base| {
        rater_of(&base.part.settings, base)
            .map_err(|e| plate.named(base.part, e.into()))
    });
    let raters: Vec<Rater<'_>> = raters.collect::<Result<_, SliceError>>()?;
    let Some(first) = bases.first() else {
        return Err(SliceError::NoParts);
    };
    let rater = rater_of(settings, first)?;
    // The check comes before hours of work, not after them.
    let tallest = all.iter().map(|(_, spans)| *spans);
    let spans = tallest.max_by_key(|spans| spans.len()).unwrap_or(&[]);
    for span in &spans[layers.clone()] {
        rater.temperature(span)?;
    }
    let turns = plate.turns();
    // Of parts that are printed one by one the layers add up.
    let count = match &turns {
        Some(_) => plate.shifts().iter().map(|&(k, _)| all[k].1.len()).sum(),
        None => spans.len(),
    };
    let layers = options.layers.indices(count)?;
    let timings = &all[0].0.timings;
    let pictures = pool.install(|| {
        // Only the first range's pictures come into the joined file.
        timings.time(Stage::Picture, || match layers.start {
            0 => pictures_of(on_bed, settings),
            _ => Ok(Some(Vec::new())),
        })
    })?;
    let no_picture = pictures.is_none().then(|| {
        "the file has no picture of the part, as drawing this expression would \
         take too long; gcode.thumbnails = \"\" asks for none"
            .to_owned()
    });
    let header = Header {
        model_name: plate.name.clone(),
        layer_count: count,
        layers: layers.clone(),
        timestamp: options.timestamp,
        nozzle_temperature: match spans.get(layers.start) {
            Some(span) => rater.temperature(span)?,
            None => settings.filament.first_layer_nozzle_temperature,
        },
        part_min: low,
        part_max: high,
        parts: pool.install(|| {
            timings.time(Stage::Picture, || standing(plate, settings))
        })?,
        thumbnails: pictures.unwrap_or_default(),
        format: options.format,
        fingerprint: if layers.len() < spans.len() {
            let of_parts = all.iter().map(|(_, spans)| *spans);
            Some(fingerprint(plate, of_parts)?)
        } else {
            None
        },
        one_by_one: turns.is_some(),
    };
    let frame = Rect {
        min: low.truncate(),
        max: high.truncate(),
    };
    let drawings = options
        .svg_dir
        .map(|dir| {
            Pictures::new(dir, frame, &layers, count)
                .map_err(|e| SliceError::Picture(dir.to_owned(), e))
        })
        .transpose()?;
    let writer = Writer::new(out, settings, &header, copy)?;
    let mut of_templates = writer.warnings().to_vec();
    if turns.is_some() && !settings.gcode.layer.trim().is_empty() {
        of_templates.push(
            "gcode.layer is run at the height of each layer, while finished \
             parts stand beside it (plate.sequence = \"one-by-one\"): it must \
             not move the head, nor call a macro that does"
                .to_owned(),
        );
    }
    // The parts' lines may be wider than those of the plate's settings.
    let of_parts = plate.parts.iter().filter_map(|p| thick_beads(&p.settings));
    for warning in of_parts {
        if !of_templates.contains(&warning) {
            of_templates.push(warning);
        }
    }
    let mut parts = Vec::new();
    for ((stages, spans), base) in all.iter().zip(&bases) {
        let Base { part, around, .. } = base;
        let relief = Relief::new(&part.model, &part.settings, around, pool)
            .map_err(|e| plate.named(part, e.into()))?;
        let spiral = stages.spiral.as_ref();
        parts.push(PartExit::new(
            part,
            &stages.timings,
            match &turns {
                Some(_) => 0..spans.len(),
                None => layers.clone(),
            },
            spans.len(),
            spiral,
            relief,
        ));
    }
    let mut exit = Exit::new(
        timings,
        parts,
        &raters,
        &rater,
        plate.shifts(),
        skirt,
        layers.clone(),
        options,
        drawings,
        writer,
    );
    match &turns {
        Some(turns) => one_by_one(&mut exit, turns, plate, &all, pool)?,
        None => {
            let supplied = all.iter().map(|(stages, spans)| (stages, *spans));
            Supplies::new(supplied, pool, &layers)
                .each(pool, |ready| exit.layer(ready))?;
        }
    }
    let done = exit.finish()?;
    let mut warnings = of_templates;
    warnings.extend(no_picture);
    warnings.extend(done.warnings);
    let totals = done.totals;
    let (outline_error, wall_error) = done.figures.accuracy();
    let report = match (spans.get(layers.start), spans.get(layers.end - 1)) {
        (Some(first), Some(last)) if options.report => {
            let stages = &all[0].0;
            let lift = settings.raft_height();
            let bed = plate.parts[0].model.offset.z;
            let z = [first.bottom.max(lift), last.top.max(lift)];
            let z = z.map(|z| z - bed);
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
    let per_mm = filament_area(settings.filament.diameter);
    let mut summary = Summary {
        size: plate.size(),
        layers,
        layer_count: count,
        raft_layers: settings.raft_layers(),
        steps: None,
        time: totals.time,
        filament_length: totals.filament_length,
        filament_mass_g: totals.filament_mass_g,
        support_length: 0.0,
        roles: done.roles,
        unfilled_area: 0.0,
        solid_area: 0.0,
        printing_moves: done.printing,
        slowed_moves: done.slowed,
        dropped_rings: 0,
        hanging: Hanging::default(),
        outline_error,
        wall_error,
        report,
        parts: Vec::new(),
        verdict: None,
        warnings: Vec::new(),
        timings: all[0].0.timings.report(),
    };
    let mut place = 0;
    let mut beads = 0;
    for ((stages, spans), (part, done_part)) in
        all.iter().zip(plate.parts.iter().zip(done.parts))
    {
        let copies = part.places.len();
        beads += done_part.beads;
        let of_part =
            summed(stages, spans, part, done_part, &mut summary, per_mm);
        warnings.extend(of_part.into_iter().map(|w| plate.told(part, w)));
        summary.parts.push(PartSummary {
            name: part.model.name.clone(),
            copies,
            size: part.model.bounds.size(),
            layer_count: spans.len(),
            filament_length: done.extruded[place] / per_mm,
        });
        place += copies;
        if !std::ptr::eq(stages, &all[0].0) {
            let more = stages.timings.report();
            for ((_, sum), (_, more)) in summary.timings.iter_mut().zip(more) {
                *sum += more;
            }
        }
    }
    if beads == 0 {
        warnings.push("there is nothing to print in these layers".into());
    }
    summary.warnings = warnings;
    Ok(summary)
}

/// Prints parts one by one, in the order of `turns`. Parts in several places
/// are sliced once: the paths of all of their layers are kept.
fn one_by_one(
    exit: &mut Exit<'_, '_>,
    turns: &[usize],
    plate: &Plate,
    all: &[(Stages<'_>, &[LayerSpan])],
    pool: &ThreadPool,
) -> Result<(), SliceError> {
    let shifts = plate.shifts();
    let of_place = |place: usize| shifts[place].0;
    let mut below = 0.0;
    // Equal parts have equal heights, and so come one after the other.
    for alike in turns.chunk_by(|&a, &b| of_place(a) == of_place(b)) {
        let Some((&first, copies)) = alike.split_first() else {
            continue;
        };
        let part = of_place(first);
        let (stages, spans) = &all[part];
        let layers = 0..spans.len();
        exit.begin(first, below);
        below = spans.last().map_or(0.0, |span| span.top);
        let mut kept: Vec<Passed> = Vec::new();
        Supplies::new([(stages, *spans)], pool, &layers).each(
            pool,
            |ready| {
                for (_, ready) in ready {
                    let passed = exit.pass(part, ready)?;
                    exit.print_turn(part, &passed)?;
                    if !copies.is_empty() {
                        kept.push(passed);
                    }
                }
                Ok(())
            },
        )?;
        for &place in copies {
            exit.begin(place, below);
            for passed in &kept {
                exit.print_turn(part, passed)?;
            }
        }
    }
    Ok(())
}

/// The rates of a part, or of the plate, by its settings.
fn rater_of<'a>(
    settings: &'a Settings,
    base: &'a Base<'a>,
) -> Result<Rater<'a>, VaryError> {
    Rater::new(settings, &base.part.model, &base.around)
}

/// The stages of a part, and its layers up to the highest that prints.
fn stages_of<'a>(
    base: &'a Base<'a>,
    layers: &Range<usize>,
    options: &Options<'_>,
    pool: &ThreadPool,
) -> Result<(Stages<'a>, &'a [LayerSpan]), SliceError> {
    let Base {
        part,
        spans,
        around,
        ..
    } = base;
    let (model, settings) = (&part.model, &part.settings);
    let count = layers.end.min(spans.len()).saturating_sub(layers.start);
    let gauge = Gauge::new(model, settings, count.max(1), options.report)?;
    let stages = Stages::new(model, settings, around, gauge, spans)?;
    let printed = stages.printed(pool, spans)?;
    if printed == 0 {
        return Err(SliceError::NothingToPrint {
            layers: spans.len(),
            line: settings.outer_wall_width(),
        });
    }
    Ok((stages, &spans[..printed]))
}

/// Plans what needs all of a part at once: its climbing wall and its supports.
fn plan<'a>(
    stages: &mut Stages<'a>,
    spans: &'a [LayerSpan],
    base: &'a Base<'a>,
    pool: &ThreadPool,
) -> Result<(), SliceError> {
    let Base {
        part,
        around,
        fills,
        raft_fills,
        ..
    } = base;
    let settings = &part.settings;
    stages.plan_spiral(pool, spans)?;
    if settings.supports != Supports::Off && !settings.spiral {
        stages.plan_supports(pool, spans, around, fills, part.room())?;
    }
    stages.plan_raft(spans, around, raft_fills, part.room())?;
    if settings.draft_shield != DraftShield::Off {
        let reach = settings.reach();
        let outline = pool.install(|| outline_of(&part.model, reach))?;
        stages.plan_shield(spans, &outline);
    }
    Ok(())
}

/// Number of layers that have the draft shield.
fn shielded(spans: &[LayerSpan], settings: &Settings) -> usize {
    let height = settings.draft_shield.height();
    spans.partition_point(|span| span.top <= height + ROUNDED)
}

/// The skirt or the draft shield round several parts, if there is one.
fn skirt_round(
    plate: &Plate,
    all: &[(Stages<'_>, &[LayerSpan])],
) -> Result<Option<Skirt>, SliceError> {
    let settings = &plate.settings;
    let skirt = &settings.skirt;
    let shield = settings.draft_shield != DraftShield::Off;
    let any = shield || (skirt.loops > 0 && skirt.layers > 0);
    if plate.place_count() == 1 || !any {
        return Ok(None);
    }
    let mut areas = Vec::new();
    for ((stages, spans), part) in all.iter().zip(&plate.parts) {
        let beside = match shield {
            true => {
                let reach = part.settings.reach();
                let outline = outline_of(&part.model, reach)?;
                stages.seen_from_above(spans, &outline)
            }
            // A higher one would be in the way of the head.
            false if plate.turns().is_some() => stages.beside(spans, 1)?,
            false => stages.beside(spans, skirt.layers as usize)?,
        };
        // The hull of the parts' hulls is the hull of them all.
        let hulls: Vec<Ring> = beside.iter().map(hull).collect();
        for place in &part.places {
            let by = part.model.offset.truncate() + place.shift;
            let moved = |ring: &Ring| ring.iter().map(|p| *p + by).collect();
            let rings = hulls.iter().map(moved).collect();
            areas.push(Area { rings });
        }
    }
    // The skirt goes round the widest brim.
    let mut widest = settings.clone();
    let brims = plate.parts.iter().map(|part| &part.settings);
    let brims = brims.max_by(|a, b| brim_reach(a).total_cmp(&brim_reach(b)));
    if let Some(brim) = brims {
        widest.brim = brim.brim.clone();
    }
    if !shield {
        if plate.turns().is_some() {
            widest.skirt.layers = 1;
        }
        return Ok(Some(Skirt::new(&areas, &widest)));
    }
    let layers = all.iter().map(|(_, spans)| shielded(spans, settings));
    let layers = layers.max().unwrap_or(0);
    Ok(Some(Skirt::shield(&areas, layers, &widest)))
}

/// The parts, for their labels.
fn standing(
    plate: &Plate,
    settings: &Settings,
) -> Result<Vec<Standing>, PictureError> {
    let mut all = Vec::new();
    for part in &plate.parts {
        let outline = if needs_outline(settings) {
            outline_of(&part.model, part.settings.reach())?
        } else {
            Vec::new()
        };
        let (low, high) = part.reach();
        for place in &part.places {
            all.push(Standing {
                name: place.name.clone(),
                min: low.truncate() + place.shift,
                max: high.truncate() + place.shift,
                outline: outline.iter().map(|p| *p + place.shift).collect(),
            });
        }
    }
    Ok(all)
}

/// Adds the results of a part to the summary, with what the user should know of
/// it.
fn summed(
    stages: &Stages<'_>,
    spans: &[LayerSpan],
    part: &Part,
    done: PartDone,
    summary: &mut Summary,
    per_mm: Mm2,
) -> Vec<String> {
    let settings = &part.settings;
    let copies = part.places.len();
    let top = spans.last().map_or(0.0, |span| span.top);
    let mut warnings = Vec::new();
    warnings.extend(stages.spiral.iter().flat_map(Spiral::warnings));
    warnings.extend(done.warnings);
    let mut hanging = done.hanging;
    if let Some(supported) = stages.support() {
        // The plan of the supports has seen to what hangs, and says what it
        // could not hold.
        hanging = Hanging::default();
        let first = part.places.first().map_or(DVec2::ZERO, |p| p.shift);
        let offset = part.model.offset.truncate() + first;
        warnings.extend(supported.warnings(offset, settings));
    }
    hanging.foot = done.foot.filter(|foot| top > foot.holds);
    warnings.extend(hanging.warnings(top, settings));
    let tally = done.tally;
    tally.warn(&mut warnings);
    let times = copies as f64;
    summary.hanging.add(&hanging, copies);
    summary.support_length += times * tally.support / per_mm;
    summary.unfilled_area += times * tally.gap;
    summary.solid_area += times * tally.solid;
    summary.dropped_rings += copies * tally.dropped_rings;
    warnings
}

/// A convex ring around what is printed, which reaches `reach` beyond the part.
fn outline_of(model: &Model, reach: Mm) -> Result<Vec<DVec2>, PictureError> {
    /// Tolerance of the ring's round corners, mm.
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
    plate: &Plate,
    settings: &Settings,
) -> Result<Option<Vec<Thumbnail>>, PictureError> {
    let sizes = settings.gcode.thumbnails.all();
    if sizes.is_empty() {
        return Ok(Some(Vec::new()));
    }
    let Some(whole) = plate.whole() else {
        return Ok(None);
    };
    Ok(thumbnails(&whole, sizes)?.map(|files| {
        let pictures = sizes.iter().zip(files);
        pictures
            .map(|(&size, file)| Thumbnail { size, file })
            .collect()
    }))
}
