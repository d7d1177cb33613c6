//! The command line: what may be written on it, and the commands.
//!
//! In: arguments. Out: calls of the library, and text for people on the two
//! standard streams: results on one, progress, warnings and errors on the
//! other. No geometry, and no default of a setting, is decided here.

mod args;
mod info;
mod limits;
mod output;
mod settings;
mod slice;
pub(crate) mod terminal;

use clap::{Parser, Subcommand};

const EXAMPLES: &str = "\
Examples:
  isoslice slice part.rhai                        writes part.gcode beside it
  isoslice slice -e 'sqrt(x^2+y^2+z^2) - 15' -o ball.gcode
  isoslice slice part.vm --size 60 --set layer_height=0.15 --set walls=3
  isoslice info part.rhai                         size, layers, parameters
  isoslice settings > my.toml                     to edit, for --config my.toml

Exit codes: 0 done, 1 something is wrong with the input, 2 with the command,
130 interrupted.";

/// From a function f(x, y, z), negative inside, to G-code without a mesh.
#[derive(Parser, Debug)]
#[command(
    name = "isoslice",
    version,
    after_help = EXAMPLES,
    max_term_width = 100,
    // Without a command there is nothing to do but explain.
    arg_required_else_help = true
)]
pub(crate) struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand, Debug)]
enum Command {
    /// Slice a model to G-code
    Slice(Box<slice::SliceArgs>),
    /// Show a model's bounds, size, layers and parameters
    Info(Box<info::InfoArgs>),
    /// Print all settings as commented TOML
    Settings(settings::SettingsArgs),
}

/// Carries out a command.
pub(crate) fn run(cli: Cli) -> anyhow::Result<()> {
    limits::end_cleanly_when_asked()?;
    match cli.command {
        Command::Slice(args) => slice::run(&args),
        Command::Info(args) => info::run(&args),
        Command::Settings(args) => settings::run(&args),
    }
}
