//! `isoslice export`: writes a model as a 3MF file whose shape is a function.

use super::args::ModelArgs;
use super::limits::{LimitArgs, watched};
use super::output::{self, is_stream};
use super::terminal;
use anyhow::{Context, bail};
use clap::Args;
use std::path::{Path, PathBuf};

const EXAMPLES: &str = "\
Examples:
  isoslice export part.rhai                 writes part.3mf beside it
  isoslice export part.rhai -D cell=8 --size 60 -o small.3mf
  isoslice export -e 'sqrt(x^2+y^2+z^2) - 15' -o ball.3mf
  isoslice slice ball.3mf

The shape in the file is a function of nodes, not a mesh, as the implicit
extension of 3MF has it. Few other programs read that. Meshes, pictures and
volumes that the model reads go along; drawings and other data cannot.";

/// Arguments of `isoslice export`.
#[derive(Args, Debug)]
#[command(
    after_help = EXAMPLES,
    override_usage = "isoslice export [OPTIONS] <MODEL>\n       \
                      isoslice export [OPTIONS] -e <FORMULA>",
    // The model keeps its coordinates.
    mut_arg("at", |arg| arg.hide(true)),
    mut_arg("keep_position", |arg| arg.hide(true))
)]
pub(super) struct ExportArgs {
    #[command(flatten)]
    model: ModelArgs,

    /// 3MF file to write, - for standard output [default: the model's name
    /// with .3mf, beside it; formula.3mf for -e]
    #[arg(short, long, value_name = "FILE", help_heading = "Output")]
    output: Option<PathBuf>,

    #[command(flatten)]
    limits: LimitArgs,
}

pub(super) fn run(args: &ExportArgs) -> anyhow::Result<()> {
    watched(&args.limits.watch(), || export(args))
}

fn export(args: &ExportArgs) -> anyhow::Result<()> {
    let given = args.output.clone();
    let path = given.unwrap_or_else(|| args.model.beside("3mf"));
    if !is_3mf(&path) {
        bail!(
            "cannot write {}: export writes 3MF files; name it FILE.3mf",
            path.display()
        );
    }
    let model = args.model.load_anywhere()?;
    // A script may read a mesh of its own name, part.3mf for part.rhai, which is
    // known once it has run.
    let inputs = args.model.model.iter().chain(&model.files);
    let inputs: Vec<&Path> = inputs.map(PathBuf::as_path).collect();
    let mut output = output::create(&path, &inputs)?;
    terminal::warn(&model.warnings);
    let bytes = model
        .to_3mf()
        .with_context(|| format!("cannot export {}", model.name))?;
    output.put(&bytes)?;
    Ok(output.finish()?)
}

/// False if a name promises another kind of file.
fn is_3mf(path: &Path) -> bool {
    let has = |end: &str| {
        let own = path.extension();
        own.is_some_and(|own| own.eq_ignore_ascii_case(end))
    };
    let inner = path.file_stem().map(Path::new).and_then(Path::extension);
    let is_gcode = inner.is_some_and(|end| end.eq_ignore_ascii_case("gcode"));
    is_stream(path) || has("3mf") && !is_gcode
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_those_of_3mf_files() {
        for good in ["-", "a.3mf", "b/a.3MF"] {
            assert!(is_3mf(Path::new(good)), "{good}");
        }
        for bad in ["a", "a.stl", "a.gcode.3mf", "a.3mf.gz"] {
            assert!(!is_3mf(Path::new(bad)), "{bad}");
        }
    }
}
