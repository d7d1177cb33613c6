//! `isoslice slice`: makes a G-code file of a model, and prints a summary.

use super::args::{ModelArgs, SettingsSource};
use super::formats::format_of;
use super::hosts::Printer;
use super::limits::{LimitArgs, ThreadArgs, watched};
use super::output::{self, is_stream};
use super::plates::{self, PlateArgs};
use super::summary::{Sums, describe};
use super::{complete, plain, printers, send, terminal};
use anyhow::{Context, bail};
use clap::Args;
use clap_complete::engine::ArgValueCompleter;
use cpu_time::ProcessTime;
use isoslice::Format;
use isoslice::files::Output;
use isoslice::layers::LayerRange;
use isoslice::limits::Watch;
use isoslice::pipeline::{self, Options, Summary};
use std::io::{Write, stderr, stdout};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant, SystemTime};

const EXAMPLES: &str = "\
Examples:
  isoslice slice part.rhai
  isoslice slice part.rhai -D cell=8 --set infill_density=25%
  isoslice slice part.vm --size 60 --rotate-x -90 -o part.gcode
  isoslice slice -e 'sqrt(x^2+y^2+z^2) - 15' -o ball.gcode
  isoslice slice part.rhai --printer ender-3 --filament petg --preset fine
  isoslice slice part.rhai --config petg.toml --config fine.toml --svg pictures
  isoslice slice bracket.rhai plug.vm --copies 3
  isoslice slice plate.toml
  generate | isoslice slice - --size 60 -o - > part.gcode";

/// Arguments of `isoslice slice`.
#[derive(Args, Debug)]
#[command(
    after_help = EXAMPLES,
    override_usage = "isoslice slice [OPTIONS] <MODEL> [MORE]...\n       \
                      isoslice slice [OPTIONS] -e <FORMULA>"
)]
pub(super) struct SliceArgs {
    #[command(flatten)]
    model: ModelArgs,

    #[command(flatten)]
    plate: PlateArgs,

    #[command(flatten)]
    settings: SettingsSource,

    /// G-code file to write, - for standard output; binary if its name ends
    /// in .bgcode, a plate for Bambu Lab's printers if it ends in .gcode.3mf
    /// [default: the model's name with .gcode, or with .gcode.3mf for those
    /// printers, beside it; formula.gcode for -e]
    #[arg(short, long, value_name = "FILE", help_heading = "Output")]
    output: Option<PathBuf>,

    /// Slice only these layers: A..B from A to B, both included, or A.., ..B
    /// or a single number; the bed's layer is 1. Files of ranges that follow
    /// one another hold, layer for layer, what one run would write
    #[arg(
        long,
        value_name = "A..B",
        allow_hyphen_values = true,
        help_heading = "Output"
    )]
    layers: Option<LayerRange>,

    /// Also draw every layer, as an SVG picture in this folder
    #[arg(long, value_name = "DIR", help_heading = "Output")]
    svg: Option<PathBuf>,

    /// Also measure every outline and wall against the model, and write how
    /// far they are off, as JSON; docs/accuracy.md says what is in it
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    report: Option<PathBuf>,

    /// Do not check the G-code. Otherwise what could hurt the printer or the
    /// print (see `isoslice check`) is an error, and no file is written
    #[arg(long, help_heading = "Output")]
    no_check: bool,
    /// Say in the file's first line when it was written, in UTC; the same
    /// input then no longer gives the same bytes, unless SOURCE_DATE_EPOCH
    /// says what the time is, in seconds since 1970
    #[arg(long, help_heading = "Output")]
    timestamp: bool,

    /// Also send the G-code to this printer, as `isoslice send` does
    #[arg(
        long,
        value_name = "PRINTER",
        add = ArgValueCompleter::new(complete::hosts),
        help_heading = "Output"
    )]
    send: Option<String>,

    /// With --send: print it, once all of it has arrived
    #[arg(long, requires = "send", help_heading = "Output")]
    start: bool,

    #[command(flatten, next_help_heading = "Output")]
    threads: ThreadArgs,

    /// Also tell where the processor time went, by stage, added up over all
    /// threads
    #[arg(long, help_heading = "Output")]
    timings: bool,

    /// Print the summary as JSON
    #[arg(long, help_heading = "Output")]
    json: bool,

    #[command(flatten)]
    limits: LimitArgs,
}

pub(super) fn run(args: &SliceArgs) -> anyhow::Result<()> {
    let watch = args.limits.slicing_watch();
    watched(&watch, || run_watched(args, &watch))
}

fn run_watched(args: &SliceArgs, watch: &Watch) -> anyhow::Result<()> {
    let started = Instant::now();
    let gathered = args.settings.gather()?;
    let sets = &args.settings.set;
    let file = plates::file(&args.model, &args.plate, &gathered, sets)?;
    let of_file = file.as_ref().map_or(&[][..], |file| &file.models);
    let of_file = of_file.to_vec();
    let of_all = file.as_ref().map(|file| file.builder.settings());
    let of_all = of_all.unwrap_or(&gathered.settings);
    let format = match args.layers {
        // Plates hold whole prints.
        Some(_) => Format::Text,
        None => Format::usual_for(of_all.gcode.flavour),
    };
    let path = args.output_path(format);
    // Outputs are opened before the work, so that a mistaken name costs no
    // time.
    let mut inputs = args.model.inputs(&gathered);
    inputs.extend(args.plate.models());
    inputs.extend(of_file.iter().map(PathBuf::as_path));
    if args.output.is_none() && inputs.contains(&path.as_path()) {
        // If the model is G-code, the error from loading it says so.
        args.model.load(&gathered.settings)?;
    }
    let printer = args.printer()?;
    let mut output = output::create(&path, &inputs)?;
    if printer.is_some() && output.is_stream() {
        bail!("--send needs a file to send; name one with -o FILE");
    }
    let format = format_of(&path)?;
    let report = args.report_output(&output, &path, &inputs)?;
    let job = args.plate.job(&args.model, file, &gathered)?;
    // So far there was nothing else to do than to read and to place models.
    let bounds = processor_time();
    let (plate, settings) = (&job.plate, &job.plate.settings);
    // These warnings may explain why the models cannot be sliced.
    let told = job.warnings.iter().cloned();
    let before: Vec<String> = told
        .filter(|warning| !gathered.warnings.contains(warning))
        .chain(plate.warnings())
        .collect();
    terminal::warn(&before);
    if let Some(folder) = &args.svg {
        std::fs::create_dir_all(folder).with_context(|| {
            format!(
                "cannot make the folder {}: choose another with --svg",
                folder.display()
            )
        })?;
    }

    let bar = terminal::layer_progress(terminal::is_quiet(), watch);
    let options = Options {
        threads: args.threads.count(),
        layers: args.layers.unwrap_or(LayerRange::ALL),
        glimpse: None,
        svg_dir: args.svg.as_deref(),
        report: report.is_some(),
        check: !args.no_check,
        timestamp: args.timestamp.then(now).transpose()?,
        format,
        on_layer: &|done, total| {
            bar.set_length(total as u64);
            bar.set_position(done as u64);
        },
    };
    let sliced = pipeline::slice_plate(plate, &options, &mut output);
    bar.finish_and_clear();
    let summary =
        sliced.with_context(|| format!("cannot slice {}", plate.name))?;
    let mut streamed = output.is_stream();
    // Both files are complete before either is put in its place.
    let report = match (report, &summary.report) {
        (Some(mut file), Some(report)) => {
            let mut text = serde_json::to_vec_pretty(report)?;
            text.push(b'\n');
            file.put(&text)?;
            Some(file)
        }
        _ => None,
    };
    output.finish()?;
    if let Some(file) = report {
        streamed |= file.is_stream();
        file.finish()?;
    }

    let mut of_print = summary.warnings.clone();
    of_print.extend(format.unusual_for(settings.gcode.flavour));
    terminal::warn(&of_print);
    let sums = Sums {
        output: &path,
        plate,
        summary: &summary,
        took: started.elapsed(),
        timings: (args.timings || terminal::wants_timings())
            .then(|| times(&summary, bounds)),
    };
    let text = if args.json {
        let warnings = [gathered.warnings, before, of_print].concat();
        sums.to_json(&warnings)?
    } else if terminal::is_quiet() {
        String::new()
    } else {
        describe(&sums)?
    };
    if streamed {
        stderr().write_all(plain::lines(&text).as_bytes())?;
    } else {
        // The result is in the file, so it is no error if nobody reads the
        // summary.
        stdout().write_all(plain::lines(&text).as_bytes())?;
    }
    if let Some(printer) = printer {
        send::check_model(&printer, &path)?;
        send::send(&printer, &path, None, args.start)?;
    }
    Ok(())
}

impl SliceArgs {
    /// The printer to send the file to. It is looked up before the work, so
    /// that an unknown name costs no time.
    fn printer(&self) -> anyhow::Result<Option<Printer>> {
        let Some(name) = &self.send else {
            return Ok(None);
        };
        let book = printers::book(&self.settings.profiles)?;
        Ok(Some(book.find(name)?.clone()))
    }

    fn output_path(&self, format: Format) -> PathBuf {
        let extension = format.extension();
        match (&self.output, &self.model.model) {
            (Some(output), _) => output.clone(),
            (None, Some(model)) if !self.model.is_stdin() => {
                self.plate.output(model, extension)
            }
            _ => self.model.beside(extension),
        }
    }

    /// Opens the report's file, which must be neither an input nor the G-code.
    fn report_output(
        &self,
        gcode: &Output,
        gcode_path: &Path,
        inputs: &[&Path],
    ) -> anyhow::Result<Option<Output>> {
        let Some(path) = &self.report else {
            return Ok(None);
        };
        let both_streams = is_stream(path) && is_stream(gcode_path);
        if both_streams || gcode.is_at(path) {
            bail!(
                "the report and the G-code would both be {}; choose another \
                 name with --report",
                path.display()
            );
        }
        Ok(Some(output::create(path, inputs)?))
    }
}

/// Processor time of the process so far, s; 0 on a system that does not tell
/// it.
fn processor_time() -> f64 {
    let time = ProcessTime::try_now();
    time.map_or(0.0, |time| time.as_duration().as_secs_f64())
}

/// Where the processor time went, by stage: the whole of it. `bounds` is what
/// reading and placing the models took.
fn times(summary: &Summary, bounds: f64) -> Vec<(&'static str, f64)> {
    let mut rows = vec![("bounds", bounds)];
    let stages = summary.timings.iter();
    rows.extend(stages.map(|(stage, time)| (stage.name(), *time)));
    let told: f64 = rows.iter().map(|row| row.1).sum();
    rows.push(("other", (processor_time() - told).max(0.0)));
    rows
}

/// The time now, or SOURCE_DATE_EPOCH.
fn now() -> anyhow::Result<SystemTime> {
    /// The end of the year 9999, seconds since 1970.
    const LAST: u64 = 253_402_300_799;
    let Some(given) = std::env::var_os("SOURCE_DATE_EPOCH") else {
        return Ok(SystemTime::now());
    };
    let seconds = given.to_str().and_then(|text| text.parse::<u64>().ok());
    let time = seconds.filter(|seconds| *seconds <= LAST).and_then(|s| {
        SystemTime::UNIX_EPOCH.checked_add(Duration::from_secs(s))
    });
    time.with_context(|| {
        format!("SOURCE_DATE_EPOCH is {given:?}, and not a time in seconds")
    })
}
