//! `isoslice preview`: makes a page that shows G-code or a model.

use super::args::{FORMULA, Gathered, ModelArgs, SettingsSource, is_plate};
use super::limits::{LimitArgs, ThreadArgs, watched};
use super::output;
use super::plates::{self, PlateArgs};
use super::rows::Rows;
use super::{plain, terminal};
use anyhow::{Context, bail};
use clap::{Args, FromArgMatches};
use isoslice::human_time;
use isoslice::layers::LayerRange;
use isoslice::limits::{self, Watch};
use isoslice::model::is_mesh;
use isoslice::pipeline::{self, Options};
use isoslice::plate::{Plate, PlateFile};
use isoslice::preview::{Toolpath, ToolpathError};
use isoslice::reader::{ReadError, Reader, filament_diameter};
use std::ffi::OsStr;
use std::fs::File;
use std::io::{self, BufWriter, Read, Seek, Write};
use std::path::{Path, PathBuf};
use std::time::Instant;

const EXAMPLES: &str = "\
Examples:
  isoslice preview part.gcode                   writes part.html beside it
  isoslice preview part.gcode -o look.html --open
  isoslice preview part.rhai --set infill_density=25%
  isoslice preview plate.toml
  zcat part.gcode.gz | isoslice preview - -o part.html";

/// Arguments of `isoslice preview`.
#[derive(Args, Debug)]
#[command(
    after_help = EXAMPLES,
    override_usage = "isoslice preview [OPTIONS] <FILE>\n       \
                      isoslice preview [OPTIONS] -e <FORMULA>",
    mut_arg("model", |arg| arg.value_name("FILE").help(
        "G-code of any slicer, - for standard input; or a model (.rhai, .vm) \
         or a plate file (.toml) to slice first, which the options for models \
         and settings are for"
    )),
    mut_arg("expression", |arg| arg.help(
        "Instead of FILE: one formula in x, y and z, in mm, negative inside"
    ))
)]
pub(super) struct PreviewArgs {
    #[command(flatten)]
    source: Sliced,

    /// HTML file to write [default: the file's name with .html, beside it;
    /// formula.html for -e, preview.html for -]
    #[arg(short, long, value_name = "FILE", help_heading = "Output")]
    output: Option<PathBuf>,

    /// Show the page in the browser, too
    #[arg(long, help_heading = "Output")]
    open: bool,

    #[command(flatten)]
    limits: LimitArgs,
}

/// What is shown. All arguments but the file's name are for models.
#[derive(Args, Clone, Debug, PartialEq)]
struct Sliced {
    #[command(flatten)]
    model: ModelArgs,

    #[command(flatten)]
    settings: SettingsSource,

    /// Slice only these layers: A..B from A to B, both included, or A.., ..B
    /// or a single number; the bed's layer is 1
    #[arg(
        long,
        value_name = "A..B",
        allow_hyphen_values = true,
        help_heading = "Output"
    )]
    layers: Option<LayerRange>,

    #[command(flatten, next_help_heading = "Output")]
    threads: ThreadArgs,
}

/// The kind of the file that is named.
enum InputKind {
    /// A model, or a plate file.
    Model(Box<(Gathered, Option<PlateFile>)>),
    Gcode(PathBuf),
    Stdin,
}

pub(super) fn run(args: &PreviewArgs) -> anyhow::Result<()> {
    let watch = args.limits.slicing_watch();
    watched(&watch, || show(args, &watch))
}

fn show(args: &PreviewArgs, watch: &Watch) -> anyhow::Result<()> {
    let started = Instant::now();
    let kind = args.source.kind()?;
    let (path, name) = args.names();
    let inputs: Vec<&Path> = match &kind {
        InputKind::Stdin => Vec::new(),
        InputKind::Gcode(path) => vec![path],
        InputKind::Model(given) => {
            let (gathered, plate) = &**given;
            let models = plate.iter().flat_map(|file| &file.models);
            let mut inputs = args.source.model.inputs(gathered);
            inputs.extend(models.map(PathBuf::as_path));
            inputs
        }
    };
    // The output is opened before the work, so that a mistaken name costs no
    // time.
    let mut output = output::create(&path, &inputs)?;
    if args.open && output.is_stream() {
        bail!("--open needs a file to show; name one with -o FILE");
    }
    let file_name = args.source.file_name();
    let toolpath = match kind {
        InputKind::Model(given) => {
            let (gathered, plate) = *given;
            let source = &args.source;
            let alone = PlateArgs::default();
            let job = alone.job(&source.model, plate, &gathered)?;
            terminal::warn(&job.warnings);
            let (gcode, warnings) = args.slice(&job.plate, watch)?;
            read(Reader::new(gcode), &file_name)?
                .with_settings(&job.plate.settings)
                .with_warnings(&warnings)
        }
        InputKind::Stdin => {
            read(Reader::new(io::stdin().lock()), "standard input")?
        }
        InputKind::Gcode(path) => {
            if path.is_dir() {
                bail!("{} is a folder; name a file in it", path.display());
            }
            let mut file = File::open(&path).with_context(|| {
                format!("cannot read {}: check its name", path.display())
            })?;
            let said = filament_diameter(&mut file);
            let mut reader = Reader::new(file);
            if let Some(diameter) = said {
                reader = reader.filament_diameter(diameter);
            }
            read(reader, &file_name)?
        }
    };
    let problems = toolpath.problems().warnings(&file_name);
    terminal::warn(&problems);
    let toolpath = toolpath.with_warnings(&problems);
    let cannot = || format!("cannot write {}", path.display());
    toolpath
        .write_html(&mut output, &name)
        .with_context(cannot)?;
    let streamed = output.is_stream();
    output.finish()?;

    if !terminal::is_quiet() {
        let text = describe(&path, &toolpath, started);
        if streamed {
            io::stderr().write_all(plain::lines(&text).as_bytes())?;
        } else {
            plain::print(&text)?;
        }
    }
    if args.open {
        let page = path.canonicalize().unwrap_or_else(|_| path.clone());
        open::that_detached(page).with_context(|| {
            format!(
                "cannot start a browser; open {} in one yourself",
                path.display()
            )
        })?;
    }
    Ok(())
}

impl PreviewArgs {
    /// The page's file, and its title.
    fn names(&self) -> (PathBuf, String) {
        let input = match &self.source.model.model {
            Some(file) if file.as_os_str() == "-" => Path::new("preview"),
            Some(file) => file,
            None => Path::new(FORMULA),
        };
        let name = match input.file_name() {
            Some(name) => name.to_string_lossy().into_owned(),
            None => input.display().to_string(),
        };
        let output = self.output.clone();
        (output.unwrap_or_else(|| input.with_extension("html")), name)
    }

    /// Slices a plate into a temporary file, and tells what the user should
    /// know.
    fn slice(
        &self,
        plate: &Plate,
        watch: &Watch,
    ) -> anyhow::Result<(File, Vec<String>)> {
        let sliced = &self.source;
        let bar = terminal::layer_progress(terminal::is_quiet(), watch);
        let options = Options {
            threads: sliced.threads.count(),
            layers: sliced.layers.unwrap_or(LayerRange::ALL),
            // A model that is only shown need not be fit to print.
            check: false,
            on_layer: &|done, total| {
                bar.set_length(total as u64);
                bar.set_position(done as u64);
            },
            ..Options::default()
        };
        let file = tempfile::tempfile()
            .context("cannot make a temporary file for the G-code")?;
        let mut gcode = BufWriter::new(file);
        let summary = pipeline::slice_plate(plate, &options, &mut gcode);
        bar.finish_and_clear();
        let summary =
            summary.with_context(|| format!("cannot slice {}", plate.name))?;
        terminal::warn(&summary.warnings);
        let mut file = gcode
            .into_inner()
            .map_err(io::IntoInnerError::into_error)
            .context("cannot write the temporary file")?;
        file.rewind().context("cannot read the temporary file")?;
        Ok((file, summary.warnings))
    }
}

impl Sliced {
    /// The kind of the file, by its name. Options that would have no effect are
    /// errors.
    fn kind(&self) -> anyhow::Result<InputKind> {
        let Some(file) = &self.model.model else {
            return self.model();
        };
        let extension = file.extension().and_then(OsStr::to_str);
        let extension = extension.map(str::to_ascii_lowercase);
        if matches!(extension.as_deref(), Some("rhai" | "vm"))
            || is_plate(file)
            || is_mesh(file)
        {
            return self.model();
        }
        if let Some(kind @ ("step" | "stp")) = extension.as_deref() {
            bail!(
                "{} is a drawing (.{kind}); the preview shows G-code, models \
                 (.rhai, .vm, and meshes), and plate files",
                file.display()
            );
        }
        // The command line has these words if only the file is given.
        let words = [OsStr::new("preview"), "--".as_ref(), file.as_os_str()];
        let plain = Sliced::from_arg_matches(
            &Sliced::augment_args(clap::Command::new("preview"))
                .try_get_matches_from(words)?,
        )?;
        if *self != plain {
            bail!(
                "{} is G-code, and is shown as it is; options for models and \
                 settings are for models (.rhai, .vm) and plate files (.toml)",
                file.display()
            );
        }
        Ok(if file.as_os_str() == "-" {
            InputKind::Stdin
        } else {
            InputKind::Gcode(file.clone())
        })
    }

    fn model(&self) -> anyhow::Result<InputKind> {
        let gathered = self.settings.gather()?;
        let (alone, sets) = (PlateArgs::default(), &self.settings.set);
        let plate = plates::file(&self.model, &alone, &gathered, sets)?;
        Ok(InputKind::Model(Box::new((gathered, plate))))
    }

    /// The name for messages.
    fn file_name(&self) -> String {
        match &self.model.model {
            Some(file) => file.display().to_string(),
            None => FORMULA.to_owned(),
        }
    }
}

fn read<R: Read>(reader: Reader<R>, name: &str) -> anyhow::Result<Toolpath> {
    let read = limits::doing("reading", || Toolpath::read(reader));
    let toolpath = read.map_err(|error| match error {
        ToolpathError::Read(ReadError::Io { .. }) => {
            anyhow::Error::new(error).context(format!("cannot read {name}"))
        }
        error => anyhow::anyhow!("{name}: {error}"),
    })?;
    if toolpath.is_empty() {
        bail!(
            "{name} prints nothing: no line of it moves the head and feeds \
             filament; is it G-code?"
        );
    }
    Ok(toolpath)
}

fn describe(path: &Path, toolpath: &Toolpath, started: Instant) -> String {
    let statistics = toolpath.statistics();
    let time = statistics.said_time.unwrap_or(statistics.time);
    let mut rows = Rows::default();
    rows.plain(plain::value(path.display()));
    if let Some(generator) = &statistics.generator {
        rows.add("made by", plain::line(generator));
    }
    rows.add("layers", toolpath.layer_count());
    rows.add("moves", toolpath.len());
    rows.add("print time", human_time(time));
    let metres = statistics.filament / 1000.0;
    rows.add("filament", format!("{metres:.2} m"));
    let took = started.elapsed().as_secs_f64();
    rows.add("took", format!("{took:.1} s"));
    rows.text
}
