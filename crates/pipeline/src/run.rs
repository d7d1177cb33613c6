//! A run: from a plate to its G-code, and the check of that.

use super::job::Run;
use super::start::{layers_of, pool, raised};
use super::write::write;
use super::{Options, SliceError, Summary};
use isoslice_base::timings::{self, Stage};
use isoslice_base::units::Seconds;
use isoslice_check::{Alongside, Finding, FindingKind, Rules, Severity};
use isoslice_gcode::Format;
use isoslice_model::Model;
use isoslice_plate::Plate;
use isoslice_settings::Settings;
use isoslice_settings::layers::LayerRange;
use std::io;

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
    refuse(plate, options)?;
    let pool = pool(options.threads)?;
    let on_bed = plate;
    let plate = &raised(plate)?;
    let (planned, planning) = timings::of_pool(&pool, || layers_of(plate));
    let (spans, steps) = planned?;
    let tallest = spans.iter().max_by_key(|spans| spans.len());
    let all = tallest.map_or(&[][..], |spans| spans.as_slice());
    let layers = options.indices(all)?;
    let mut checker = None;
    if options.check {
        let parts = plate.parts.iter().map(|part| &part.settings);
        let mut rules = Rules::of_plate(&plate.settings, parts);
        // A range of layers continues what other files have printed.
        rules.base = all.get(layers.start).map_or(0.0, |span| span.bottom);
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
    add_time(&mut summary, Stage::Heights, planning);
    if let Some(report) = &mut summary.report {
        report.steps = steps;
        report.roles = summary.roles.clone();
    }
    if let Some(checker) = checker {
        judge(checker, &mut summary)?;
    }
    Ok(summary)
}

/// Refuses what only some plates have.
fn refuse(plate: &Plate, options: &Options<'_>) -> Result<(), SliceError> {
    if options.report && plate.place_count() > 1 {
        return Err(SliceError::ReportOfSeveral);
    }
    if options.layers != LayerRange::ALL || options.glimpse.is_some() {
        if plate.turns().is_some() {
            return Err(SliceError::RangeOneByOne);
        }
        if options.format == Format::Plate {
            return Err(SliceError::RangeInPlate);
        }
    }
    Ok(())
}

/// Adds processor time to a stage's.
fn add_time(summary: &mut Summary, stage: Stage, time: Seconds) {
    let mut all = summary.timings.iter_mut();
    if let Some((_, sum)) = all.find(|(s, _)| *s == stage) {
        *sum += time;
    }
}

/// Adds the verdict on the G-code to a summary.
///
/// # Errors
/// If the G-code has a fault, or cannot be read.
fn judge(checker: Alongside, summary: &mut Summary) -> Result<(), SliceError> {
    let (verdict, time) = checker.finish()?;
    if !verdict.is_safe() {
        let is_fault = |f: &&Finding| f.kind.severity() == Severity::Fault;
        let mut faults = verdict.findings.iter().filter(is_fault);
        if summary.floats && faults.all(|f| f.kind == FindingKind::OffBed) {
            return Err(SliceError::Floats);
        }
        let faults = verdict.sentences("", Severity::Fault);
        return Err(SliceError::Unsafe(faults));
    }
    add_time(summary, Stage::Check, time);
    // The summary tells of what hangs in the air. Printers that heat in their
    // macros are as they should be. Whoever calls a macro knows what it is, and
    // whoever wrote a template was told of its lines.
    let told = |kind: FindingKind| {
        kind.severity() == Severity::Warning
            && !matches!(
                kind,
                FindingKind::InTheAir
                    | FindingKind::Adrift
                    | FindingKind::Unknown
                    | FindingKind::UnknownWord
                    | FindingKind::Purge
            )
    };
    summary.warnings.extend(verdict.sentences_of("", told));
    summary.verdict = Some(verdict);
    Ok(())
}
