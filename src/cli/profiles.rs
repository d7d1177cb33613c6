//! `isoslice profiles`: lists printers, filaments and presets.

use super::folder::ProfilesSource;
use super::{import, plain, print_json, terminal};
use anyhow::bail;
use clap::{Args, Subcommand};
use isoslice::settings::{Origin, Profile, ProfileKind, Profiles};
use serde::Serialize;
use std::fmt::Write as _;

const EXAMPLES: &str = "\
Examples:
  isoslice profiles                     all of them
  isoslice profiles list printers
  isoslice profiles show prusa-mk4      its text, to copy and change
  isoslice profiles import my.ini       another slicer's, as yours
  isoslice slice part.rhai --printer prusa-mk4 --filament petg --preset fine";

/// Arguments of `isoslice profiles`.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES, args_conflicts_with_subcommands = true)]
pub(super) struct ProfilesArgs {
    #[command(subcommand)]
    command: Option<Command>,

    #[command(flatten)]
    list: ListArgs,
}

#[derive(Subcommand, Debug)]
enum Command {
    /// List profiles with what they are; this is the default
    List(ListArgs),
    /// Show a profile's text
    Show(ShowArgs),
    /// Make profiles of those of PrusaSlicer, OrcaSlicer, Bambu Studio or Cura
    Import(import::ImportArgs),
}

#[derive(Args, Debug)]
struct ListArgs {
    /// Only this kind
    #[arg(value_parser = ["printers", "filaments", "presets"])]
    kind: Option<String>,

    /// Print JSON
    #[arg(long)]
    json: bool,

    #[command(flatten)]
    source: ProfilesSource,
}

#[derive(Args, Debug)]
struct ShowArgs {
    /// Name of the profile
    name: String,

    #[command(flatten)]
    source: ProfilesSource,
}

pub(super) fn run(args: &ProfilesArgs) -> anyhow::Result<()> {
    match &args.command {
        None => list(&args.list),
        Some(Command::List(args)) => list(args),
        Some(Command::Show(args)) => show(args),
        Some(Command::Import(args)) => import::run(args),
    }
}

/// A profile, as `--json` lists it.
#[derive(Serialize)]
struct Listed {
    kind: &'static str,
    name: String,
    description: String,
    inherits: Option<String>,
    /// The profile's file; null if it is part of the program.
    file: Option<String>,
}

impl Listed {
    fn new(profile: &Profile) -> Self {
        Listed {
            kind: profile.kind.name(),
            name: profile.name.clone(),
            description: profile.description.clone(),
            inherits: profile.inherits.clone(),
            file: match &profile.origin {
                Origin::Shipped => None,
                Origin::File(path) => Some(path.display().to_string()),
            },
        }
    }
}

fn list(args: &ListArgs) -> anyhow::Result<()> {
    let profiles = args.source.find()?;
    let wanted = |kind: &ProfileKind| {
        args.kind.as_ref().is_none_or(|name| name == kind.folder())
    };
    let mut found = Vec::new();
    for kind in ProfileKind::ALL.into_iter().filter(wanted) {
        found.push((kind, readable(&profiles, kind)));
    }
    if args.json {
        let all = found.iter().flat_map(|(_, profiles)| profiles);
        return print_json(&all.map(Listed::new).collect::<Vec<_>>());
    }
    let text = describe(&found, &args.source)?;
    plain::print(&text)
}

/// The profiles of a kind. A warning tells which cannot be read.
fn readable(profiles: &Profiles, kind: ProfileKind) -> Vec<Profile> {
    let (found, wrong) = profiles.list(kind);
    let chains = wrong.into_iter().map(|error| {
        let parts: Vec<_> = anyhow::Error::from(error)
            .chain()
            .map(ToString::to_string)
            .collect();
        format!("left out: {}", parts.join(": "))
    });
    terminal::warn(&chains.collect::<Vec<_>>());
    found
}

fn describe(
    found: &[(ProfileKind, Vec<Profile>)],
    source: &ProfilesSource,
) -> Result<String, std::fmt::Error> {
    let mut text = String::new();
    let own_line = |p: &&Profile| !p.is_another_nozzle();
    let names = found.iter().flat_map(|(_, profiles)| profiles);
    let names = names.filter(own_line);
    let length = |p: &Profile| plain::line(&p.name).chars().count();
    let width = names.map(length).max().unwrap_or(0);
    for (kind, profiles) in found {
        writeln!(text, "{} (--{} NAME)", kind.folder(), kind.name())?;
        for profile in profiles.iter().filter(own_line) {
            write!(text, "  {:<width$}", plain::line(&profile.name))?;
            if !profile.description.is_empty() {
                write!(text, "  {}", plain::line(&profile.description))?;
            }
            if profile.origin != Origin::Shipped {
                write!(text, " (yours)")?;
            }
            writeln!(text)?;
        }
        if profiles.iter().any(Profile::is_another_nozzle) {
            writeln!(
                text,
                "  All but your own also come with nozzles of 0.25, 0.6 and \
                 0.8 mm: NAME-0.6-nozzle"
            )?;
        }
        writeln!(text)?;
    }
    match source.folder() {
        Some(folder) => writeln!(
            text,
            "Your own go into the folders printers, filaments and presets of\n\
             {}",
            plain::value(folder.display())
        )?,
        None => writeln!(text, "Your own are looked for in --profiles DIR")?,
    }
    Ok(text)
}

fn show(args: &ShowArgs) -> anyhow::Result<()> {
    let profiles = args.source.find()?;
    let mut text = String::new();
    for kind in ProfileKind::ALL {
        let of_kind = readable(&profiles, kind);
        for profile in of_kind.iter().filter(|p| p.name == args.name) {
            if !text.is_empty() {
                text.push('\n');
            }
            text.push_str(&profile.text);
        }
    }
    if text.is_empty() {
        let hint = profiles.suggestion(&ProfileKind::ALL, &args.name);
        bail!("there is no profile {:?}; {hint}", args.name);
    }
    plain::print_file(&text)
}
