//! `isoslice printers`: the printers that files are sent to.

use super::folder::ProfilesSource;
use super::hosts::{self, HostKind, Key, Printer, PrinterBook, Status};
use super::patience::Patience;
use super::{complete, plain, terminal};
use anyhow::{Context, bail};
use clap::{Args, Subcommand};
use clap_complete::engine::ArgValueCompleter;
use isoslice::files;
use std::fmt::Write as _;
use std::io::{IsTerminal, stdin};
use std::path::PathBuf;

const EXAMPLES: &str = "\
Examples:
  isoslice printers add workshop --host octoprint --url http://octopi.local
  isoslice printers add mk4 --host prusalink --url http://192.168.1.30 < key.txt
  isoslice printers add voron --host moonraker --url http://voron.local:7125
  isoslice printers test workshop
  isoslice send part.gcode --to workshop";

/// Greatest length of a key, bytes.
const LONGEST_KEY: u64 = 4096;

/// Arguments of `isoslice printers`.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES, args_conflicts_with_subcommands = true)]
pub(super) struct PrintersArgs {
    #[command(subcommand)]
    command: Option<Command>,

    #[command(flatten)]
    folder: ProfilesSource,
}

#[derive(Subcommand, Debug)]
enum Command {
    /// List the printers, without their keys; this is the default
    List(FolderArgs),
    /// Make a printer known; its key is read from standard input
    Add(Box<AddArgs>),
    /// Forget a printer
    Remove(OneArgs),
    /// Ask a printer's host for its state
    Test(OneArgs),
}

#[derive(Args, Debug)]
struct FolderArgs {
    #[command(flatten)]
    folder: ProfilesSource,
}

#[derive(Args, Debug)]
struct OneArgs {
    /// Name of the printer
    #[arg(add = ArgValueCompleter::new(complete::hosts))]
    name: String,

    #[command(flatten)]
    folder: ProfilesSource,
}

#[derive(Args, Debug)]
struct AddArgs {
    /// Name of the printer: letters, digits, - and _
    name: String,

    /// The program that runs it
    #[arg(long, value_name = "PROGRAM", value_enum)]
    host: HostKind,

    /// The program's address, as in http://octopi.local
    #[arg(long, value_name = "URL")]
    url: String,

    /// Read the key from this environment variable each time, and store none
    #[arg(long, value_name = "VARIABLE", conflicts_with = "no_key")]
    key_env: Option<String>,

    /// The host needs no key
    #[arg(long)]
    no_key: bool,

    /// Only send G-code whose printer_model is this one
    #[arg(long, value_name = "MODEL")]
    model: Option<String>,

    /// Trust only the certificates in this file (PEM), for https
    #[arg(long, value_name = "FILE")]
    ca: Option<PathBuf>,

    /// Where PrusaLink is to store files, as in usb
    #[arg(long, value_name = "NAME")]
    storage: Option<String>,

    /// Replace a printer of this name
    #[arg(long)]
    replace: bool,

    #[command(flatten)]
    folder: ProfilesSource,
}

/// Opens the file of printers, and warns if others may read it.
pub(super) fn book(folder: &ProfilesSource) -> anyhow::Result<PrinterBook> {
    let folder = folder.folder().context(
        "the system has no folder for settings; name one with --profiles",
    )?;
    let book = PrinterBook::open(&folder)?;
    if book.is_open_to_others() {
        let path = book.path().display();
        terminal::warn(&[format!(
            "others can read the keys in {path}: chmod 600 {path}"
        )]);
    }
    Ok(book)
}

pub(super) fn run(args: &PrintersArgs) -> anyhow::Result<()> {
    match &args.command {
        None => list(&args.folder),
        Some(Command::List(args)) => list(&args.folder),
        Some(Command::Add(args)) => add(args),
        Some(Command::Remove(args)) => {
            Ok(book(&args.folder)?.remove(&args.name)?)
        }
        Some(Command::Test(args)) => {
            let book = book(&args.folder)?;
            let printer = book.find(&args.name)?;
            let to = plain::line(&printer.name).into_owned();
            let _patience = Patience::with_host(move || {
                format!("{to} has still to answer")
            });
            let status = hosts::status(printer)?;
            plain::print(&describe(printer, &status)?)
        }
    }
}

fn list(folder: &ProfilesSource) -> anyhow::Result<()> {
    let book = book(folder)?;
    let mut text = String::new();
    for printer in book.printers() {
        let (name, host) = (&printer.name, printer.kind.name());
        writeln!(text, "{name:<16}  {host:<10}  {}", printer.url)?;
    }
    if text.is_empty() {
        text.push_str("no printers yet; isoslice printers add --help\n");
    }
    plain::print(&text)
}

fn add(args: &AddArgs) -> anyhow::Result<()> {
    let mut book = book(&args.folder)?;
    if !args.replace && book.find(&args.name).is_ok() {
        bail!(
            "there is a printer {} already; --replace puts this one in its \
             place",
            args.name
        );
    }
    let key = if args.no_key || args.key_env.is_some() {
        None
    } else {
        Some(read_key(args.host)?)
    };
    let ca = args.ca.as_ref().map(std::fs::canonicalize).transpose();
    let printer = Printer {
        name: args.name.clone(),
        kind: args.host,
        url: args.url.clone(),
        key,
        key_env: args.key_env.clone(),
        model: args.model.clone(),
        ca: ca.context("cannot read the certificate named by --ca")?,
        storage: args.storage.clone(),
    };
    book.add(printer)?;
    if !terminal::is_quiet() {
        plain::print(&format!(
            "{} is known; next: isoslice printers test {0}\n",
            args.name
        ))?;
    }
    Ok(())
}

/// Reads a key from standard input. Other users can see a program's arguments,
/// and shells remember them.
fn read_key(kind: HostKind) -> anyhow::Result<Key> {
    let text = if stdin().is_terminal() {
        plain::print(&format!("Key of {} (it is shown): ", kind.name()))?;
        let mut line = String::new();
        stdin()
            .read_line(&mut line)
            .context("cannot read the key")?;
        line
    } else {
        files::read_standard_input(LONGEST_KEY)
            .context("cannot read the key from standard input")?
    };
    if text.trim().is_empty() {
        bail!(
            "there is no key on standard input; for a host that needs none \
             give --no-key"
        );
    }
    Ok(Key::new(&text))
}

fn describe(printer: &Printer, status: &Status) -> anyhow::Result<String> {
    let mut text = String::new();
    writeln!(text, "{}", printer.name)?;
    writeln!(text, "  program  {} at {}", status.program, printer.url)?;
    writeln!(text, "  printer  {}", status.state)?;
    if let Some(free) = status.free {
        writeln!(text, "  free     {:.1} GB", free as f64 / 1e9)?;
    }
    let ready = if status.ready { "yes" } else { "no" };
    writeln!(text, "  ready    {ready}")?;
    Ok(text)
}
