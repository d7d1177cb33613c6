//! `isoslice info`: what a model is, without slicing it.

use super::args::{ModelArgs, SettingsSource};
use super::limits::{LimitArgs, watched};
use super::terminal;
use clap::Args;
use glam::DVec3;
use isoslice::layers;
use isoslice::model::Model;
use isoslice::settings::Settings;
use std::fmt::Write as _;
use std::io::{Write, stdout};

const EXAMPLES: &str = "\
Examples:
  isoslice info part.rhai
  isoslice info part.vm --size 60 --set layer_height=0.1";

/// Arguments of `isoslice info`.
#[derive(Args, Debug)]
#[command(
    after_help = EXAMPLES,
    override_usage = "isoslice info [OPTIONS] <MODEL>\n       \
                      isoslice info [OPTIONS] -e <FORMULA>"
)]
pub(super) struct InfoArgs {
    #[command(flatten)]
    model: ModelArgs,
    #[command(flatten)]
    settings: SettingsSource,
    #[command(flatten)]
    limits: LimitArgs,
}

pub(super) fn run(args: &InfoArgs) -> anyhow::Result<()> {
    watched(&args.limits.watch(), || show(args))
}

fn show(args: &InfoArgs) -> anyhow::Result<()> {
    let settings = args.settings.read()?;
    let model = args.model.load(&settings)?;
    terminal::warn(&model.warnings);
    let text = describe(&model, &settings)?;
    stdout().lock().write_all(text.as_bytes())?;
    Ok(())
}

fn describe(model: &Model, settings: &Settings) -> anyhow::Result<String> {
    let size = model.bounds.size();
    let layers = layers::plan(
        size.z,
        settings.first_layer_height,
        settings.layer_height,
    )?;
    let mut text = String::new();
    writeln!(text, "{}", model.name)?;
    writeln!(text, "  size        {}", dimensions(size))?;
    writeln!(
        text,
        "  bounds      {} to {} mm",
        corner(model.bounds.min),
        corner(model.bounds.max)
    )?;
    let printed = model.printed_bounds();
    writeln!(
        text,
        "  on the bed  {} to {} mm",
        corner(printed.min),
        corner(printed.max)
    )?;
    writeln!(
        text,
        "  layers      {} of {} mm",
        layers.len(),
        settings.layer_height
    )?;
    writeln!(text, "  expression  {} operations", model.expression_size)?;
    if !model.parameters.is_empty() {
        writeln!(text, "  parameters (set with -D name=value)")?;
    }
    let width = |text: &str| text.chars().count();
    let names = model.parameters.iter().map(|p| width(&p.name)).max();
    let names = names.unwrap_or(0);
    for parameter in &model.parameters {
        let mut value =
            format!("{} = {}", pad(&parameter.name, names), parameter.value);
        if parameter.value != parameter.default {
            write!(value, " (default {})", parameter.default)?;
        }
        match parameter.description.as_str() {
            "" => writeln!(text, "    {value}")?,
            description => writeln!(text, "    {value}  {description}")?,
        }
    }
    Ok(text)
}

fn pad(name: &str, width: usize) -> String {
    format!("{name:<width$}")
}

/// `60.00 × 40.00 × 12.50 mm`
pub(super) fn dimensions(size: DVec3) -> String {
    format!("{:.2} × {:.2} × {:.2} mm", size.x, size.y, size.z)
}

fn corner(p: DVec3) -> String {
    // Adding zero makes −0 a plain one, rounding first so that −0.001 is too.
    let tidy = |v: f64| (v * 100.0).round() / 100.0 + 0.0;
    format!("({:.2}, {:.2}, {:.2})", tidy(p.x), tidy(p.y), tidy(p.z))
}
