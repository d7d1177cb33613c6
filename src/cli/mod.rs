//! The command line: its arguments and commands.
//!
//! In: arguments. Out: calls of the library, and text for people: results on
//! standard output; progress, warnings and errors on the error stream. This
//! module decides on no geometry and on no setting's default. It sees the library
//! as any other program does, by its name.
//!
//! Exit codes: 0 done; 1 something is wrong with the input; 2 the command line
//! is wrong; 130 interrupted; 141 the reader of standard output has closed it
//! before the end, which needs no message.

// Comments on arguments are the help that a terminal shows.
#![allow(rustdoc::bare_urls, reason = "a terminal has no links")]

mod args;
mod check;
mod closed;
mod complete;
mod excerpt;
mod export;
mod folder;
mod formats;
mod hosts;
mod import;
mod info;
mod join;
mod limits;
mod manual;
mod memory;
mod new;
mod output;
mod parse;
mod patience;
mod plain;
mod plate_info;
mod plates;
mod preview;
mod printers;
mod profiles;
mod render;
mod rows;
mod send;
mod settings;
#[cfg(unix)]
mod signals;
mod slice;
mod split;
mod summary;
mod terminal;
mod watch;

use clap::{Parser, Subcommand};
use std::io::ErrorKind::BrokenPipe;
use std::process::ExitCode;

/// Exit code that shells have for the signal of a pipe that nobody reads.
const BROKEN_PIPE: u8 = 141;

const EXAMPLES: &str = "\
Examples:
  isoslice new part                               a first part.rhai, part.toml
  isoslice slice part.rhai                        writes part.gcode beside it
  isoslice slice -e 'sqrt(x^2+y^2+z^2) - 15' -o ball.gcode
  isoslice slice part.vm --size 60 --set layer_height=0.15 --set walls=3
  isoslice slice part.rhai --printer prusa-mk4 --filament petg --preset fine
  isoslice slice part.rhai lid.rhai --copies 3    a plate of six parts
  isoslice preview part.gcode                     a page that shows it in 3D
  isoslice watch part.rhai --open                 a page to edit it beside
  isoslice info part.rhai                         size, layers, parameters
  isoslice profiles                               printers, filaments, presets
  isoslice render part.rhai                       a picture, part.png
  isoslice export part.rhai                       its function, part.3mf
  isoslice send part.gcode --to workshop          to OctoPrint, Klipper, Prusa
  isoslice settings > my.toml                     to edit, for --config my.toml

Exit codes:
  0    done
  1    something is wrong with the model, the settings or a file
  2    something is wrong with the command line
  130  interrupted by a signal
  141  what reads the output has closed it before the end

Environment:
  ISOSLICE_PROFILES  folder of your own profiles
  NO_COLOR           if set, no colours";

/// From a function f(x, y, z), negative inside, to G-code without a mesh.
#[derive(Parser, Debug)]
#[command(
    name = "isoslice",
    version,
    after_help = EXAMPLES,
    max_term_width = 100,
    // Without a command the help is shown.
    arg_required_else_help = true
)]
pub(crate) struct Cli {
    #[command(subcommand)]
    command: Command,

    #[command(flatten)]
    verbosity: terminal::Verbosity,
}

#[derive(Subcommand, Debug)]
enum Command {
    /// Slice a model to G-code
    Slice(Box<slice::SliceArgs>),
    /// Divide a part's layers into ranges of about equal cost, to slice
    /// separately
    Split(Box<split::SplitArgs>),
    /// Join the files of ranges of layers into the file of a single run
    Join(join::JoinArgs),
    /// Make a page that shows G-code, or a sliced model, in 3D
    Preview(Box<preview::PreviewArgs>),
    /// Serve a page that shows a model, sliced again whenever it is edited
    Watch(Box<watch::WatchArgs>),
    /// Check G-code, of any slicer, against what the printer can do
    Check(check::CheckArgs),
    /// Show a model's bounds, size, layers and parameters
    Info(Box<info::InfoArgs>),
    /// Draw a shaded picture of a model and its supports, as PNG
    Render(Box<render::RenderArgs>),
    /// Write a model as a 3MF file whose shape is a function, not a mesh
    Export(Box<export::ExportArgs>),
    /// Send G-code to a printer: OctoPrint, Moonraker (Klipper), PrusaLink
    Send(send::SendArgs),
    /// List, add, remove and test the printers that files are sent to
    Printers(printers::PrintersArgs),
    /// Print all settings as commented TOML
    Settings(settings::SettingsArgs),
    /// List printers, filaments and presets, show one, or import one
    Profiles(profiles::ProfilesArgs),
    /// Write a starter script, and settings for it
    New(new::NewArgs),
    /// Print a script for the shell that completes commands and options
    Completions(manual::CompletionsArgs),
    /// Print the manual page
    Man(manual::ManArgs),
}

/// The whole program: parses its arguments, runs the command and reports what went
/// wrong.
#[must_use]
pub fn main() -> ExitCode {
    complete::answer();
    match run(parse::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) if is_broken_pipe(&error) => ExitCode::from(BROKEN_PIPE),
        Err(error) => {
            terminal::report_error(&error);
            ExitCode::FAILURE
        }
    }
}

fn is_broken_pipe(error: &anyhow::Error) -> bool {
    error.chain().any(|cause| {
        cause
            .downcast_ref::<std::io::Error>()
            .is_some_and(|e| e.kind() == BrokenPipe)
    })
}

/// Carries out a command.
fn run(cli: Cli) -> anyhow::Result<()> {
    cli.verbosity.apply();
    memory::return_large_blocks();
    #[cfg(unix)]
    signals::end_cleanly_when_asked()?;
    match cli.command {
        Command::Slice(args) => slice::run(&args),
        Command::Split(args) => split::run(&args),
        Command::Join(args) => join::run(&args),
        Command::Preview(args) => preview::run(&args),
        Command::Watch(args) => watch::run(*args),
        Command::Check(args) => check::run(&args),
        Command::Info(args) => plate_info::run(&args),
        Command::Render(args) => render::run(&args),
        Command::Export(args) => export::run(&args),
        Command::Send(args) => send::run(&args),
        Command::Printers(args) => printers::run(&args),
        Command::Settings(args) => settings::run(&args),
        Command::Profiles(args) => profiles::run(&args),
        Command::New(args) => new::run(&args),
        Command::Completions(args) => manual::completions(&args),
        Command::Man(args) => manual::man(&args),
    }
}

/// Prints a result as JSON.
fn print_json(result: &impl serde::Serialize) -> anyhow::Result<()> {
    let mut text = plain::json(&serde_json::to_string_pretty(result)?);
    text.push('\n');
    output::print(text.as_bytes())
}
