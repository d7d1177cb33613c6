//! The steps of a run, one after the other: the plan, the file's start, its
//! layers, its end, and the sums of it all.

use super::ahead::with_threads;
use super::exit::Exit;
use super::head::header;
use super::job::{Base, Job, Run};
use super::options::Extent;
use super::pacing::{Pacing, Rates};
use super::part::{PartPaths, Passed};
use super::skirt::skirt_round;
use super::sums::PartSums;
use super::supply::plate::Supplies;
use super::{SliceError, Summary};
use crate::report::{Report, RunFigures};
use isoslice_base::units::Mm3;
use isoslice_gcode::{Writer, WriterPlan};
use isoslice_path::pace::PacePlan;
use isoslice_planar::Rect;
use isoslice_preview::Pictures;
use rayon::ThreadPool;
use std::io;

/// Number of threads from which on the stages that run in order have threads of
/// their own. Fewer are kept busy by the other stages alone, and layers that
/// wait between stages would only take memory.
const APART: usize = 4;

/// Slices and writes. `copy` gets the text as it is composed.
pub(super) fn write(
    run: &Run<'_>,
    out: &mut dyn io::Write,
    copy: &mut dyn FnMut(&[u8]),
) -> Result<Summary, SliceError> {
    let (plate, pool) = (run.plate, run.pool);
    let bases = plate.parts.iter().zip(run.spans);
    let bases: Vec<Base<'_>> =
        bases.map(|(part, spans)| Base::new(part, spans)).collect();
    let job = Job::new(run, &bases)?;
    let skirt = pool.install(|| skirt_round(&job))?;
    let pace = PacePlan::of(&plate.settings);
    let rates = Rates::new(plate, &pace, &bases)?;
    // The check comes before hours of work, not after them.
    let printed = match job.turns {
        Some(_) => job.spans,
        None => &job.spans[job.extent.layers.clone()],
    };
    for span in printed {
        rates.plate.temperature(span)?;
    }
    let (header, no_picture) = header(run, &job, &rates.plate)?;
    let pictures = pictures(run, &job)?;
    let plan = WriterPlan::of(&plate.settings);
    let writer = Writer::new(out, plan, &header, copy)?;
    let mut warnings = told_of_writing(&job, writer.warnings());
    warnings.extend(no_picture);
    let parts = job.parts.iter().zip(&bases);
    let parts =
        parts.map(|(part, base)| PartPaths::new(&job, part, base, pool));
    let parts: Vec<PartPaths<'_>> = parts.collect::<Result<_, SliceError>>()?;
    let sums = parts.iter().map(|paths| {
        let layers = match job.turns {
            Some(_) => 0..paths.planned.spans.len(),
            None => job.extent.layers.clone(),
        };
        PartSums::new(paths.planned, layers)
    });
    let pacing = Pacing::new(&job, &rates, skirt, pictures, pool);
    let mut exit = Exit::new(&job, sums.collect(), pacing, run.options, writer);
    match &job.turns {
        Some(turns) => one_by_one(&mut exit, turns, &job, &parts, pool)?,
        None => {
            let supplies = Supplies::new(&parts, pool, &job.extent)?;
            let apart = pool.current_num_threads() >= APART;
            with_threads(|threads| {
                exit.layers(supplies.ahead(pool, threads)?, threads, apart)
            })?;
        }
    }
    let mut done = exit.finish()?;
    let figures = std::mem::take(&mut done.figures);
    let extruded = done.totals.filament_volume;
    let mut summary = Summary::new(&job, done, warnings);
    (summary.outline_error, summary.wall_error) = figures.accuracy();
    if run.options.report {
        summary.report = report(&job, figures, extruded, pool)?;
    }
    summary.timings = job.timings();
    Ok(summary)
}

/// The folder for pictures of the layers, if they are asked for.
fn pictures(
    run: &Run<'_>,
    job: &Job<'_>,
) -> Result<Option<Pictures>, SliceError> {
    let Some(dir) = run.options.svg_dir else {
        return Ok(None);
    };
    let (low, high) = job.plate.reach();
    let frame = Rect::new(low.truncate(), high.truncate());
    let made = Pictures::new(dir, frame, &job.extent.layers, job.count);
    Ok(Some(
        made.map_err(|e| SliceError::Picture(dir.to_owned(), e))?,
    ))
}

/// What the user should know of templates and of widths of lines. `of_writer`
/// are the warnings of the writer.
fn told_of_writing(job: &Job<'_>, of_writer: &[String]) -> Vec<String> {
    let plate = job.plate;
    let mut all = of_writer.to_vec();
    if job.turns.is_some() && !plate.settings.gcode.layer.trim().is_empty() {
        all.push(
            "gcode.layer is run at the height of each layer, while finished \
             parts stand beside it (plate.sequence = \"one-by-one\"): it must \
             not move the head, nor call a macro that does"
                .to_owned(),
        );
    }
    // The parts' lines may be wider than those of the plate's settings.
    let of_parts = plate.parts.iter();
    let of_parts =
        of_parts.filter_map(|p| WriterPlan::of(&p.settings).thick_beads());
    for warning in of_parts {
        if !all.contains(&warning) {
            all.push(warning);
        }
    }
    all
}

/// Prints parts one by one, in the order of `turns`. Parts in several places
/// are sliced once: the paths of all of their layers are kept.
fn one_by_one(
    exit: &mut Exit<'_, '_>,
    turns: &[usize],
    job: &Job<'_>,
    parts: &[PartPaths<'_>],
    pool: &ThreadPool,
) -> Result<(), SliceError> {
    let shifts = job.plate.shifts();
    let of_place = |place: usize| shifts[place].0;
    let mut below = 0.0;
    // Equal parts have equal heights, and so come one after the other.
    for alike in turns.chunk_by(|&a, &b| of_place(a) == of_place(b)) {
        let Some((&first, copies)) = alike.split_first() else {
            continue;
        };
        let part = of_place(first);
        let paths = &parts[part];
        let spans = paths.planned.spans;
        exit.pacing.begin(first, below);
        below = spans.last().map_or(0.0, |span| span.top);
        let mut kept: Vec<Passed> = Vec::new();
        let extent = Extent::of_all(spans.len());
        let paths = std::slice::from_ref(paths);
        let supplies = Supplies::new(paths, pool, &extent)?;
        with_threads(|threads| {
            for layer in supplies.ahead(pool, threads)? {
                for (_, laid) in layer?.parts {
                    let passed = exit.count(part, laid);
                    exit.print_turn(part, &passed)?;
                    if !copies.is_empty() {
                        kept.push(passed);
                    }
                }
            }
            Ok(())
        })?;
        for &place in copies {
            exit.pacing.begin(place, below);
            for passed in &kept {
                exit.print_turn(part, passed)?;
            }
        }
    }
    Ok(())
}

/// The report on a single part, of which this volume was extruded.
fn report(
    job: &Job<'_>,
    figures: RunFigures,
    extruded: Mm3,
    pool: &ThreadPool,
) -> Result<Option<Report>, SliceError> {
    let (spans, layers) = (job.spans, &job.extent.layers);
    let (Some(first), Some(last)) =
        (spans.get(layers.start), spans.get(layers.end - 1))
    else {
        return Ok(None);
    };
    let (plate, stages) = (job.plate, &job.parts[0].stages);
    let lift = plate.settings.raft_height();
    let bed = plate.parts[0].model.offset.z;
    let z = [first.bottom.max(lift), last.top.max(lift)];
    let z = z.map(|z| z - bed);
    let volume = pool.install(|| stages.gauge.volume(z, &stages.timings))?;
    Ok(Some(figures.report(
        &stages.gauge,
        spans.len(),
        volume,
        extruded,
    )))
}
