//! `isoslice join`: makes one file of the files of all ranges of a part's
//! layers.

use super::formats::format_of;
use super::limits::{LimitArgs, watched};
use super::output;
use super::{plain, terminal};
use anyhow::{Context, bail};
use clap::Args;
use isoslice::{Format, Ranges, human_time};
use serde_json::json;
use std::io::{Write, stderr, stdout};
use std::path::{Path, PathBuf};

const EXAMPLES: &str = "\
Examples:
  isoslice split part.rhai --parts 8              ranges to slice, one a line
  isoslice slice part.rhai --layers 1..512 -o part.1.gcode
  isoslice slice part.rhai --layers 513.. -o part.2.gcode
  isoslice join part.1.gcode part.2.gcode -o part.gcode

The files may come in any order, as each says which layers it has. The joined
file is, byte for byte, that of a single run. docs/large-parts.md has scripts
for clusters.";

/// Arguments of `isoslice join`.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(super) struct JoinArgs {
    /// The files of all ranges, as `isoslice slice --layers A..B` writes them
    #[arg(value_name = "FILE", required = true)]
    files: Vec<PathBuf>,

    /// File to write, - for standard output
    #[arg(short, long, value_name = "FILE", help_heading = "Output")]
    output: PathBuf,

    /// Print the summary as JSON
    #[arg(long, help_heading = "Output")]
    json: bool,

    #[command(flatten)]
    limits: LimitArgs,
}

pub(super) fn run(args: &JoinArgs) -> anyhow::Result<()> {
    watched(&args.limits.watch(), || join(args))
}

fn join(args: &JoinArgs) -> anyhow::Result<()> {
    let path = &args.output;
    let inputs: Vec<&Path> = args.files.iter().map(PathBuf::as_path).collect();
    if let Some(folder) = inputs.iter().find(|path| path.is_dir()) {
        bail!(
            "{0} is a folder; name the files in it, as in {0}/*.gcode",
            folder.display()
        );
    }
    let mut output = output::create(path, &inputs)?;
    let ranges = Ranges::open(&args.files)?;
    check_format(path, ranges.format(), output.is_stream())?;
    let joined = ranges
        .join(&mut output)
        .with_context(|| format!("cannot write {}", path.display()))?;
    let streamed = output.is_stream();
    output.finish()?;
    let text = if args.json {
        let text = format!(
            "{:#}\n",
            json!({
                "output": path.display().to_string(),
                "files": joined.files,
                "layer_count": joined.layers,
                "print_time_s": joined.time,
                "filament_mm": joined.filament_length,
                "filament_g": joined.filament_mass_g,
            })
        );
        plain::json(&text)
    } else if terminal::is_quiet() {
        String::new()
    } else {
        format!(
            "{}: {} layers of {} files, {}, {:.2} m of filament ({:.1} g)\n",
            path.display(),
            joined.layers,
            joined.files,
            human_time(joined.time),
            joined.filament_length / 1000.0,
            joined.filament_mass_g,
        )
    };
    let text = plain::lines(&text);
    if streamed {
        stderr().write_all(text.as_bytes())?
    } else {
        stdout().write_all(text.as_bytes())?
    }
    Ok(())
}

/// Refuses a name that promises another format than that of the files.
fn check_format(
    path: &Path,
    format: Format,
    streamed: bool,
) -> anyhow::Result<()> {
    if streamed || format_of(path)? == format {
        return Ok(());
    }
    let (of_files, extension) = match format {
        Format::Text | Format::Plate => ("text", "gcode"),
        Format::Binary => ("binary", "bgcode"),
    };
    let (would_be, instead) = match format_of(path)? {
        Format::Plate => ("a plate, which is written in one run", ""),
        Format::Text => ("text", ", or slice the ranges to .gcode files"),
        Format::Binary => ("binary", ", or slice the ranges to .bgcode files"),
    };
    bail!(
        "the files are {of_files}, and {} would be {would_be}; give it a name \
         that ends in .{extension}{instead}",
        path.display()
    )
}
