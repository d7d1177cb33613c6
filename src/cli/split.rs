//! `isoslice split`: divides a part's layers into ranges of about equal cost.

use super::args::{ModelArgs, SettingsSource};
use super::limits::{LimitArgs, ThreadArgs, watched};
use super::plates::{self, PlateArgs};
use super::rows::counted;
use super::{plain, print_json, terminal};
use anyhow::Context;
use clap::Args;
use isoslice::{Share, split};
use serde_json::json;

const EXAMPLES: &str = "\
Examples:
  isoslice split part.rhai --parts 8
  isoslice split part.rhai -D cell=4 --set layer_height=0.1 --parts 40 --json

Each line is for one `isoslice slice --layers`, with the same model, settings
and options; `isoslice join` then makes one file of them. docs/large-parts.md
has scripts for clusters.";

/// Arguments of `isoslice split`.
#[derive(Args, Debug)]
#[command(
    after_help = EXAMPLES,
    override_usage = "isoslice split [OPTIONS] --parts <N> <MODEL> [MORE]...\n       \
                      isoslice split [OPTIONS] --parts <N> -e <FORMULA>"
)]
pub(super) struct SplitArgs {
    #[command(flatten)]
    model: ModelArgs,

    #[command(flatten)]
    plate: PlateArgs,

    #[command(flatten)]
    settings: SettingsSource,

    /// Number of ranges. There are fewer if the part has not enough layers: a
    /// range begins with layer 1, 33, 65 and so on
    #[arg(
        long,
        value_name = "N",
        value_parser = clap::value_parser!(u16).range(1..=10_000),
        help_heading = "Output"
    )]
    parts: u16,

    /// Print JSON, with each range's share of the work
    #[arg(long, help_heading = "Output")]
    json: bool,

    #[command(flatten, next_help_heading = "Output")]
    threads: ThreadArgs,

    #[command(flatten)]
    limits: LimitArgs,
}

pub(super) fn run(args: &SplitArgs) -> anyhow::Result<()> {
    watched(&args.limits.watch(), || divide(args))
}

fn divide(args: &SplitArgs) -> anyhow::Result<()> {
    let gathered = args.settings.gather()?;
    let sets = &args.settings.set;
    let file = plates::file(&args.model, &args.plate, &gathered, sets)?;
    let job = args.plate.job(&args.model, file, &gathered)?;
    let plate = &job.plate;
    let parts = usize::from(args.parts);
    let shares = split(plate, parts, args.threads.count())
        .with_context(|| format!("cannot divide {}", plate.name))?;
    if shares.len() < parts {
        let count = shares.last().map_or(0, |share| share.layers.end);
        terminal::warn(&[format!(
            "{} has {count} layers, which make {}, not {parts}: a range \
             begins with layer 1, 33, 65 and so on",
            plate.name,
            counted(shares.len(), "range")
        )]);
    }
    let ends = |share: &Share| (share.layers.start + 1, share.layers.end);
    if args.json {
        let of_share = |share: &Share| {
            let (first, last) = ends(share);
            json!({
                "first_layer": first,
                "last_layer": last,
                "share_of_work": (1e4 * share.cost).round() / 1e4,
            })
        };
        let all: Vec<serde_json::Value> = shares.iter().map(of_share).collect();
        return print_json(&json!({ "model": plate.name, "ranges": all }));
    }
    let line = |share: &Share| {
        let (first, last) = ends(share);
        format!("{first}..{last}\n")
    };
    plain::print(&shares.iter().map(line).collect::<String>())
}
