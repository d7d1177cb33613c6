//! `isoslice settings`: all settings, as TOML that can be fed back.

use super::args::SettingsSource;
use clap::Args;
use std::io::{Write, stdout};

const EXAMPLES: &str = "\
Examples:
  isoslice settings > my.toml           all defaults, to edit
  isoslice settings --config my.toml --set walls=3 > mine.toml";

/// Arguments of `isoslice settings`.
#[derive(Args, Debug)]
#[command(after_help = EXAMPLES)]
pub(super) struct SettingsArgs {
    #[command(flatten)]
    source: SettingsSource,
}

pub(super) fn run(args: &SettingsArgs) -> anyhow::Result<()> {
    let settings = args.source.read()?;
    stdout().lock().write_all(settings.to_toml().as_bytes())?;
    Ok(())
}
