//! `isoslice new`: a model and settings to start from.
//!
//! Guaranteed: no existing file is overwritten, and either both files are
//! written completely, or neither.

use super::{plain, terminal};
use anyhow::bail;
use clap::{Args, ValueEnum};
use isoslice::files::Output;
use isoslice::settings::Settings;
use std::fs;
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  isoslice new part                     writes part.rhai and part.toml
  isoslice slice part.rhai --config part.toml
  isoslice new lamp --template vase";

/// What a script may begin with.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum Template {
    /// A ball on a plate with a hole: shapes, put together and cut
    Part,
    /// A round box filled with a gyroid
    Lattice,
    /// A fluted vase, printed as one wall that climbs
    Vase,
    /// A surface from a formula, made printable
    Formula,
}

impl Template {
    /// The script; `NAME` stands for the part's name.
    fn script(self) -> &'static str {
        match self {
            Template::Part => include_str!("starters/part.rhai"),
            Template::Lattice => include_str!("starters/lattice.rhai"),
            Template::Vase => include_str!("starters/vase.rhai"),
            Template::Formula => include_str!("starters/formula.rhai"),
        }
    }

    /// The settings that the script needs to be what it is meant to be.
    fn settings(self) -> &'static str {
        match self {
            Template::Vase => {
                "# One wall that climbs without a break, on a solid bottom.\n\
                 spiral = true\n\n"
            }
            _ => "",
        }
    }
}

/// The settings that people are likeliest to change.
const USEFUL: &[&str] = &[
    "layer_height",
    "walls",
    "top_layers",
    "bottom_layers",
    "infill",
    "infill_density",
    "seam",
    "speed.outer_wall",
    "speed.inner_wall",
    "speed.sparse_infill",
    "speed.first_layer",
    "skirt.loops",
    "cooling.fan_speed",
    "filament.nozzle_temperature",
    "filament.first_layer_nozzle_temperature",
    "filament.bed_temperature",
    "filament.first_layer_bed_temperature",
    "filament.max_flow",
    "retract.length",
    "printer.bed_x",
    "printer.bed_y",
    "printer.height",
    "printer.nozzle_diameter",
    "gcode.flavour",
];

/// Arguments of `isoslice new`.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(super) struct NewArgs {
    /// Name of the part, and of the files; may begin with a folder
    name: PathBuf,

    /// What the script begins with
    #[arg(long, value_enum, default_value = "part")]
    template: Template,
}

pub(super) fn run(args: &NewArgs) -> anyhow::Result<()> {
    let given = args.name.display();
    // The script's own file name is taken for the part's name.
    let base = match args.name.extension() {
        Some(extension) if extension == "rhai" => args.name.with_extension(""),
        _ => args.name.clone(),
    };
    let Some(stem) = base.file_name().and_then(|name| name.to_str()) else {
        bail!("{given} is no name for a file; write part, for example");
    };
    // The name is written into both files, where such characters could end the
    // line or hide in it.
    if stem.contains(plain::is_obeyed) {
        bail!("{given} has characters that no editor shows; write part");
    }
    // A name may have a point in it, at which `with_extension` would cut it.
    let beside =
        |extension: &str| base.with_file_name(format!("{stem}.{extension}"));
    let (script, settings) = (beside("rhai"), beside("toml"));
    let texts = [
        (&script, args.template.script().replace("NAME", stem)),
        (&settings, config(stem, args.template)),
    ];
    let mut outputs = Vec::new();
    for (path, text) in &texts {
        let mut output = Output::create_new(path)?;
        output.put(text.as_bytes())?;
        outputs.push(output);
    }
    // Both files are complete before either is put in its place.
    for (k, output) in outputs.into_iter().enumerate() {
        if let Err(error) = output.finish() {
            for (ours, _) in &texts[..k] {
                // This run wrote that file a moment ago.
                let _ = fs::remove_file(ours);
            }
            return Err(error.into());
        }
    }
    if !terminal::is_quiet() {
        let script = plain::value(script.display());
        let settings = plain::value(settings.display());
        plain::print(&format!(
            "{script}\n{settings}\n\n\
             Next: isoslice slice {script} --config {settings}\n\
             or, to see it while you edit it:\n      \
             isoslice watch {script} --config {settings} --open\n"
        ))?;
    }
    Ok(())
}

fn config(name: &str, template: Template) -> String {
    format!(
        "# Settings for {name}:\n\
         #\n\
         #   isoslice slice {name}.rhai --config {name}.toml\n\
         #\n\
         # Take the # off a line to set it; what is here is the default. \
         These are the\n\
         # most useful ones, `isoslice settings` prints all. --printer, \
         --filament and\n\
         # --preset start from profiles, which `isoslice profiles` lists; \
         what is set\n\
         # here wins over them.\n\n{}{}",
        template.settings(),
        Settings::suggestions(USEFUL)
    )
}
