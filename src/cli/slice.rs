//! `isoslice slice`: from a model to a G-code file, and a summary.

use super::args::{FORMULA, ModelArgs, SettingsSource};
use super::info::dimensions;
use super::limits::{LimitArgs, watched};
use super::output::{Output, same_file};
use super::terminal;
use anyhow::{Context, bail};
use clap::Args;
use isoslice::layers::LayerRange;
use isoslice::limits::Watch;
use isoslice::pipeline::{self, Options, Summary};
use isoslice::report::Figures;
use isoslice::units::human_time;
use std::fmt::Write as _;
use std::io::{Write, stderr, stdout};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

const EXAMPLES: &str = "\
Examples:
  isoslice slice part.rhai
  isoslice slice part.rhai -D cell=8 --set infill_density=25%
  isoslice slice part.vm --size 60 --rotate-x -90 -o part.gcode
  isoslice slice -e 'sqrt(x^2+y^2+z^2) - 15' -o ball.gcode
  isoslice slice part.rhai --config petg.toml --config fine.toml --svg pictures";

/// Arguments of `isoslice slice`.
#[derive(Args, Debug)]
#[command(
    after_help = EXAMPLES,
    override_usage = "isoslice slice [OPTIONS] <MODEL>\n       \
                      isoslice slice [OPTIONS] -e <FORMULA>"
)]
pub(super) struct SliceArgs {
    #[command(flatten)]
    model: ModelArgs,

    #[command(flatten)]
    settings: SettingsSource,

    /// G-code file to write [default: the model's name with .gcode, beside
    /// it; formula.gcode for -e]
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
    /// far they are off, as JSON; the README says what is in it
    #[arg(long, value_name = "FILE", help_heading = "Output")]
    report: Option<PathBuf>,

    /// Number of threads [default: all processors]; the result is the same
    #[arg(
        long,
        value_name = "N",
        value_parser = clap::value_parser!(u16).range(1..=1024),
        help_heading = "Output"
    )]
    threads: Option<u16>,

    /// Also tell where the processor time went, by stage, added up over all
    /// threads
    #[arg(long, help_heading = "Output")]
    timings: bool,

    /// Show neither progress nor summary, only warnings and errors
    #[arg(short, long, help_heading = "Output")]
    quiet: bool,

    #[command(flatten)]
    limits: LimitArgs,
}

pub(super) fn run(args: &SliceArgs) -> anyhow::Result<()> {
    let watch = args.limits.watch();
    watched(&watch, || run_watched(args, &watch))
}

fn run_watched(args: &SliceArgs, watch: &Watch) -> anyhow::Result<()> {
    let started = Instant::now();
    let settings = args.settings.read()?;
    let path = args.output_path();
    // Before the work, so that a mistaken name costs none.
    let mut output = Output::create(&path, &args.inputs())?;
    let report = args.report_output(&path)?;
    let model = args.model.load(&settings)?;
    if let Some(folder) = &args.svg {
        std::fs::create_dir_all(folder).with_context(|| {
            format!("cannot make the folder {}", folder.display())
        })?;
    }

    let bar = terminal::layer_progress(args.quiet, watch);
    let options = Options {
        threads: args.threads.map(usize::from),
        layers: args.layers.unwrap_or(LayerRange::ALL),
        svg_dir: args.svg.as_deref(),
        report: report.is_some(),
        backend: None,
        on_layer: &|done, total| {
            bar.set_length(total as u64);
            bar.set_position(done as u64);
        },
    };
    let sliced = pipeline::slice(&model, &settings, &options, &mut output);
    bar.finish_and_clear();
    let summary =
        sliced.with_context(|| format!("cannot slice {}", model.name))?;
    let streamed = output.is_stream();
    // Both are complete before either is put in its place.
    let report = match (report, &summary.report) {
        (Some((mut file, path)), Some(report)) => {
            let no_report = || format!("cannot write {}", path.display());
            serde_json::to_writer_pretty(&mut file, report)
                .map_err(std::io::Error::from)
                .and_then(|()| file.write_all(b"\n"))
                .and_then(|()| file.flush())
                .with_context(no_report)?;
            Some((file, path))
        }
        _ => None,
    };
    output
        .finish()
        .with_context(|| format!("cannot write {}", path.display()))?;
    if let Some((file, path)) = report {
        file.finish()
            .with_context(|| format!("cannot write {}", path.display()))?;
    }

    terminal::warn(&[&model.warnings[..], &summary.warnings].concat());
    if !args.quiet {
        let mut text = describe(&path, &summary, started.elapsed())?;
        if args.timings {
            for (stage, seconds) in &summary.timings {
                writeln!(text, "    {:<9} {seconds:8.2} s", stage.name())?;
            }
        }
        if streamed {
            stderr().write_all(text.as_bytes())?;
        } else {
            stdout().write_all(text.as_bytes())?;
        }
    }
    Ok(())
}

impl SliceArgs {
    fn output_path(&self) -> PathBuf {
        match (&self.output, &self.model.model) {
            (Some(output), _) => output.clone(),
            (None, Some(model)) => model.with_extension("gcode"),
            (None, None) => Path::new(FORMULA).with_extension("gcode"),
        }
    }

    /// The report's file, which must be neither an input nor the G-code.
    fn report_output(
        &self,
        gcode: &Path,
    ) -> anyhow::Result<Option<(Output, &Path)>> {
        let Some(path) = &self.report else {
            return Ok(None);
        };
        if same_file(path, gcode) {
            bail!(
                "the report and the G-code would both be {}; choose another \
                 name with --report",
                path.display()
            );
        }
        Ok(Some((Output::create(path, &self.inputs())?, path)))
    }

    fn inputs(&self) -> Vec<&Path> {
        let model = self.model.model.iter();
        model
            .chain(&self.settings.config)
            .map(PathBuf::as_path)
            .collect()
    }
}

fn describe(
    path: &Path,
    summary: &Summary,
    took: Duration,
) -> Result<String, std::fmt::Error> {
    let mut text = String::new();
    writeln!(text, "{}", path.display())?;
    writeln!(text, "  size        {}", dimensions(summary.size))?;
    let (layers, count) = (&summary.layers, summary.layer_count);
    match *layers == (0..count) {
        true => writeln!(text, "  layers      {count}")?,
        false => writeln!(
            text,
            "  layers      {} to {} of {count}",
            layers.start + 1,
            layers.end
        )?,
    }
    writeln!(text, "  print time  {}", human_time(summary.time))?;
    writeln!(
        text,
        "  filament    {:.2} m, {:.1} g",
        summary.filament_length / 1000.0,
        summary.filament_mass_g
    )?;
    let p99 =
        |f: Option<Figures>| f.map(|f| format!("{:.1} µm", f.p99.max(0.1)));
    if let Some(outline) = p99(summary.outline_error) {
        write!(text, "  accuracy    outline within {outline}")?;
        if let Some(walls) = p99(summary.wall_error) {
            write!(text, ", outer wall within {walls}")?;
        }
        writeln!(text, " (99 % of the points measured)")?;
    }
    if summary.dropped_rings > 0 {
        writeln!(
            text,
            "  left out    {} islands and holes smaller than a quarter of a \
             line's width",
            summary.dropped_rings
        )?;
    }
    // Less is what rounding leaves at sharp corners.
    if summary.unfilled_area >= 1.0 {
        writeln!(
            text,
            "  gaps        {:.1} mm² too thin for a line, of {:.0} mm² in \
             all layers",
            summary.unfilled_area, summary.solid_area
        )?;
    }
    writeln!(text, "  took        {:.1} s", took.as_secs_f64())?;
    Ok(text)
}
