//! `isoslice send`: sends G-code to the program that runs a printer.

use super::folder::ProfilesSource;
use super::formats::is_sliced_plate;
use super::hosts::{self, Printer, Sending, Sent};
use super::patience::Patience;
use super::{complete, plain, printers, terminal};
use anyhow::{Context, bail};
use clap::Args;
use clap_complete::engine::ArgValueCompleter;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

const EXAMPLES: &str = "\
Examples:
  isoslice send part.gcode --to workshop
  isoslice send part.gcode --to workshop --start
  isoslice slice part.rhai --printer prusa-mk4 --send workshop";

/// Arguments of `isoslice send`.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(super) struct SendArgs {
    /// The G-code, as text or binary
    file: PathBuf,

    /// The printer, as `isoslice printers` lists it
    #[arg(
        long,
        value_name = "PRINTER",
        add = ArgValueCompleter::new(complete::hosts)
    )]
    to: String,

    /// Print the file, once all of it has arrived
    #[arg(long)]
    start: bool,

    /// Name of the file on the printer [default: the file's own]
    #[arg(long, value_name = "NAME")]
    name: Option<String>,

    /// Send it even if it was made for another printer
    #[arg(long)]
    force: bool,

    #[command(flatten)]
    folder: ProfilesSource,
}

pub(super) fn run(args: &SendArgs) -> anyhow::Result<()> {
    let book = printers::book(&args.folder)?;
    let printer = book.find(&args.to)?;
    let shown = args.file.display();
    if !args.file.is_file() {
        bail!("there is no file {shown}; check its name");
    }
    let ending = args.file.extension().and_then(|e| e.to_str());
    let ending = ending.unwrap_or_default().to_ascii_lowercase();
    if is_sliced_plate(&args.file) {
        bail!(
            "{shown} is a plate for Bambu Lab's printers, which none of these \
             hosts runs; copy it to the printer's card, or open it in Bambu \
             Studio or Bambu Connect and send it from there"
        );
    }
    if !["gcode", "gco", "g", "bgcode"].contains(&&*ending) {
        bail!(
            "{shown} does not end in .gcode or .bgcode; isoslice slice makes \
             G-code of models"
        );
    }
    if !args.force {
        check_model(printer, &args.file)?;
    }
    send(printer, &args.file, args.name.as_deref(), args.start)
}

/// Sends a file, with a bar on a terminal, and says what became of it.
pub(super) fn send(
    printer: &Printer,
    file: &Path,
    name: Option<&str>,
    start: bool,
) -> anyhow::Result<()> {
    let of_file = file.file_name().map(|name| name.to_string_lossy());
    let of_file = of_file.unwrap_or_default();
    let target = if terminal::is_quiet() {
        ProgressDrawTarget::hidden()
    } else {
        ProgressDrawTarget::stderr()
    };
    let bar = ProgressBar::with_draw_target(None, target);
    if let Ok(style) =
        ProgressStyle::with_template("{bar:30} {bytes} of {total_bytes}")
    {
        bar.set_style(style);
    }
    let came = Arc::new((AtomicU64::new(0), AtomicU64::new(0)));
    let _patience = {
        let came = came.clone();
        let to = plain::line(&printer.name).into_owned();
        Patience::with_host(move || {
            let [sent, all] = [&came.0, &came.1]
                .map(|count| count.load(Ordering::Relaxed) as f64 / 1e6);
            if sent < all {
                format!("{sent:.1} of {all:.1} MB are sent to {to}")
            } else {
                format!("{to} has still to answer")
            }
        })
    };
    let sent = hosts::send(
        printer,
        file,
        &Sending {
            name: name.unwrap_or(&of_file),
            start,
            on_progress: &|sent, total| {
                came.0.store(sent, Ordering::Relaxed);
                came.1.store(total, Ordering::Relaxed);
                bar.set_length(total);
                bar.set_position(sent);
            },
        },
    );
    bar.finish_and_clear();
    let sent = sent.with_context(|| {
        format!("cannot send {} to {}", file.display(), printer.name)
    })?;
    if !terminal::is_quiet() {
        plain::print(&format!("{}\n", outcome(printer, &sent)))?;
    }
    Ok(())
}

/// What became of a file, in words.
pub(super) fn outcome(printer: &Printer, sent: &Sent) -> String {
    let what = if sent.started {
        "is being printed on"
    } else {
        "is stored on"
    };
    format!("{} {what} {}", sent.name, printer.name)
}

/// Checks that a file was made for a printer, if the printer's entry tells of
/// its model.
pub(super) fn check_model(
    printer: &Printer,
    file: &Path,
) -> anyhow::Result<()> {
    let Some(wanted) = &printer.model else {
        return Ok(());
    };
    let cannot = || format!("cannot read {}", file.display());
    let mut open = File::open(file).with_context(cannot)?;
    let said = said_model(&mut open).with_context(cannot)?;
    let made = match said {
        Some(said) if said == *wanted => return Ok(()),
        Some(said) => {
            format!("was made for another printer, {}", plain::line(&said))
        }
        None => "does not say for which printer it was made".to_owned(),
    };
    bail!(
        "{} {made}, and {} is {wanted}; slice it with the right --printer, or \
         send it with --force",
        file.display(),
        printer.name
    )
}

/// The printer's model, which slicers write at the end or at the beginning of
/// their files, and binary files as text at the beginning.
fn said_model(file: &mut File) -> std::io::Result<Option<String>> {
    const PART: u64 = 1 << 17;
    let length = file.metadata()?.len();
    for start in [0, length.saturating_sub(PART)] {
        file.seek(SeekFrom::Start(start))?;
        let mut bytes = Vec::new();
        Read::by_ref(file).take(PART).read_to_end(&mut bytes)?;
        let text = String::from_utf8_lossy(&bytes);
        let said = text.lines().find_map(|line| {
            let line = line.trim_start_matches(['\0', ';', ' ']);
            let (before, value) = line.split_once("printer_model")?;
            // In a binary file a header comes before the word. In other lines
            // the word is part of a condition.
            if !before.is_empty() && !before.ends_with(char::is_control) {
                return None;
            }
            let value = value.trim_start().strip_prefix('=')?.trim();
            (!value.is_empty()).then(|| value.to_owned())
        });
        if said.is_some() {
            return Ok(said);
        }
    }
    Ok(None)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write;

    #[test]
    fn the_model_is_found_at_either_end() {
        let filler = "G1 X1 E1\n".repeat(50_000);
        for (text, model) in [
            ("; printer_model = MK4\nG28\n".to_owned(), Some("MK4")),
            (format!("{filler}; printer_model = XL\n"), Some("XL")),
            (
                "GCDE\0\u{1}printer_model=MINI\nx=1\n".to_owned(),
                Some("MINI"),
            ),
            ("; printer_model =\nG28\n".to_owned(), None),
            (filler.clone(), None),
        ] {
            let mut file = tempfile::tempfile().unwrap();
            file.write_all(text.as_bytes()).unwrap();
            let said = said_model(&mut file).unwrap();
            assert_eq!(said.as_deref(), model);
        }
    }
}
