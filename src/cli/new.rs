//! `isoslice new`: a model and settings to start from.
//!
//! Guaranteed: nothing that exists is overwritten, and either both files are
//! written or none.

use super::terminal;
use anyhow::{Context, bail};
use clap::Args;
use isoslice::settings::suggestions;
use std::fs::{self, File};
use std::io::{ErrorKind, Write, stdout};
use std::path::{Path, PathBuf};

const EXAMPLES: &str = "\
Examples:
  isoslice new part                     writes part.rhai and part.toml
  isoslice slice part.rhai --config part.toml";

/// The script; `NAME` becomes the part's name.
const SCRIPT: &str = include_str!("starter.rhai");

/// The settings that one is likeliest to want to change.
const USEFUL: &[&str] = &[
    "layer_height",
    "walls",
    "top_thickness",
    "bottom_thickness",
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
    /// Name of the part, and of the files; may begin with a folder's
    name: PathBuf,
}

pub(super) fn run(args: &NewArgs) -> anyhow::Result<()> {
    let given = args.name.display();
    // Who names the script means the same as who names the part.
    let base = match args.name.extension() {
        Some(extension) if extension == "rhai" => args.name.with_extension(""),
        _ => args.name.clone(),
    };
    let Some(stem) = base.file_name().and_then(|name| name.to_str()) else {
        bail!("{given} is no name for a file; write part, for example");
    };
    // A name may have a point in it: with_extension would cut there.
    let beside =
        |extension: &str| base.with_file_name(format!("{stem}.{extension}"));
    let (script, settings) = (beside("rhai"), beside("toml"));
    write_new(&script, &SCRIPT.replace("NAME", stem))?;
    if let Err(error) = write_new(&settings, &config(stem)) {
        // It is ours, of a moment ago.
        let _ = fs::remove_file(&script);
        return Err(error);
    }
    if !terminal::is_quiet() {
        let (script, settings) = (script.display(), settings.display());
        writeln!(
            stdout(),
            "{script}\n{settings}\n\nNext: isoslice slice {script} --config \
             {settings}"
        )?;
    }
    Ok(())
}

fn config(name: &str) -> String {
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
         # here wins over them.\n\n{}",
        suggestions(USEFUL)
    )
}

fn write_new(path: &Path, text: &str) -> anyhow::Result<()> {
    let cannot = || format!("cannot write {}", path.display());
    let mut file = match File::create_new(path) {
        Ok(file) => file,
        Err(e) if e.kind() == ErrorKind::AlreadyExists => bail!(
            "{} is already there, and is left as it is; choose another name",
            path.display()
        ),
        Err(e) => return Err(e).with_context(cannot),
    };
    file.write_all(text.as_bytes()).with_context(cannot)
}
