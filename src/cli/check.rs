//! `isoslice check`: checks whether G-code is safe to run on a printer.

use super::args::SettingsSource;
use super::limits::{LimitArgs, watched};
use super::rows::counted;
use super::{plain, terminal};
use anyhow::{Context, bail};
use clap::Args;
use isoslice::check::{Rules, Severity, Verdict, check};
use isoslice::limits;
use isoslice::reader::filament_diameter;
use isoslice_gcode_read::reader::range_bottom;
use serde_json::json;
use std::fs::File;
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};

const EXAMPLES: &str = "\
Examples:
  isoslice check part.gcode
  isoslice check part.gcode --set printer.bed_x=180 --set gcode.flavour=klipper
  zcat part.gcode.gz | isoslice check -

Faults make the exit code 1; warnings do not.";

/// Arguments of `isoslice check`.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(super) struct CheckArgs {
    /// G-code of any slicer; - for standard input
    #[arg(value_name = "FILE")]
    file: PathBuf,

    #[command(flatten)]
    settings: SettingsSource,

    #[command(flatten)]
    limits: LimitArgs,

    /// Print the verdict as JSON
    #[arg(long, help_heading = "Output")]
    json: bool,
}

pub(super) fn run(args: &CheckArgs) -> anyhow::Result<()> {
    watched(&args.limits.watch(), || look_through(args))
}

fn look_through(args: &CheckArgs) -> anyhow::Result<()> {
    let settings = args.settings.gather()?.settings;
    let mut rules = Rules::new(&settings);
    let (name, verdict) = if args.file == Path::new("-") {
        let name = "standard input".to_owned();
        let verdict = judge(io::stdin().lock(), &name, &rules)?;
        (name, verdict)
    } else {
        let name = args.file.display().to_string();
        if args.file.is_dir() {
            bail!("{name} is a folder; name a file in it");
        }
        let mut file = File::open(&args.file)
            .with_context(|| format!("cannot read {name}: check its name"))?;
        // Its E is the length of the filament that it was made for.
        if let Some(diameter) = filament_diameter(&mut file) {
            rules.filament_diameter = diameter;
        }
        // A range of layers continues a part.
        if let Some(bottom) = range_bottom(&mut file) {
            rules.base = bottom;
        }
        let verdict = judge(file, &name, &rules)?;
        (name, verdict)
    };
    let mut out = io::stdout().lock();
    if args.json {
        let text = format!("{:#}", described(&name, &verdict));
        writeln!(out, "{}", plain::json(&text))?;
    } else {
        for fault in verdict.sentences(&name, Severity::Fault) {
            writeln!(out, "fault: {}", plain::line(&fault))?;
        }
        terminal::warn(&verdict.sentences(&name, Severity::Warning));
        if !terminal::is_quiet() {
            let count = |severity, what| {
                counted(verdict.count(severity) as usize, what)
            };
            writeln!(
                out,
                "{}: {} moves in {} layers, {}, {}{}",
                plain::line(&name),
                verdict.moves,
                verdict.layers,
                count(Severity::Fault, "fault"),
                count(Severity::Warning, "warning"),
                unknown(&verdict)
            )?;
        }
    }
    out.flush()?;
    if !verdict.is_safe() {
        bail!("{name} should not be run on this printer as it is");
    }
    Ok(())
}

/// The sentence about unknown commands, which the counts leave out.
fn unknown(verdict: &Verdict) -> String {
    match verdict.unknown_words().count() as u64 {
        0 => String::new(),
        1 => " in all but a command that is not known".into(),
        n => format!(" in all but {n} commands that are not known"),
    }
}

fn judge(
    input: impl Read,
    name: &str,
    rules: &Rules,
) -> anyhow::Result<Verdict> {
    limits::doing("reading", || check(input, rules))
        .with_context(|| name.to_owned())
}

fn described(name: &str, verdict: &Verdict) -> serde_json::Value {
    let severity = |s: Severity| match s {
        Severity::Fault => "fault",
        Severity::Warning => "warning",
    };
    let findings: Vec<_> = verdict
        .findings
        .iter()
        .map(|f| {
            json!({
                "kind": f.kind.name(),
                "about": (!f.about.is_empty()).then_some(&f.about),
                "severity": severity(f.kind.severity()),
                "line": (f.line > 0).then_some(f.line),
                "at": f.at.is_finite().then(|| f.at.to_array()),
                "message": f.message,
                "count": f.count,
                "lines": f.lines.iter().filter(|l| **l > 0).collect::<Vec<_>>(),
            })
        })
        .collect();
    let counts: serde_json::Map<String, serde_json::Value> = verdict
        .counts
        .iter()
        .map(|(kind, &count)| (kind.name().to_owned(), count.into()))
        .collect();
    let unknown: serde_json::Map<String, serde_json::Value> = verdict
        .unknown_words()
        .map(|(word, count)| (word.to_owned(), count.into()))
        .collect();
    json!({
        "file": name,
        "safe": verdict.is_safe(),
        "generator": verdict.generator,
        "lines": verdict.lines,
        "moves": verdict.moves,
        "layers": verdict.layers,
        "counts": counts,
        "unknown": unknown,
        "findings": findings,
    })
}
