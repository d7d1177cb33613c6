//! `isoslice render`: draws a model straight from its function, and its
//! supports.

use super::args::{Gathered, ModelArgs, SettingsSource};
use super::limits::{LimitArgs, ThreadArgs, watched};
use super::output::{self, is_stream};
use super::plates::{self, PlateArgs};
use super::terminal;
use anyhow::{Context, bail};
use clap::Args;
use isoslice::Plate;
use isoslice::limits;
use isoslice::pipeline::supports;
use isoslice::preview::View;
use std::path::{Path, PathBuf};

const EXAMPLES: &str = "\
Examples:
  isoslice render part.rhai
  isoslice render plate.toml
  isoslice render part.rhai -o part.png --pixels 800x600 --view front
  isoslice render part.rhai --set supports=auto
  isoslice render part.rhai --azimuth 30 --elevation 20 --background none
  isoslice render -e 'sqrt(x^2+y^2+z^2) - 15' -o - > ball.png";

/// Greatest side of a picture, pixels.
const GREATEST: usize = 4096;

/// Arguments of `isoslice render`.
#[derive(Args, Debug)]
#[command(
    after_help = EXAMPLES,
    override_usage = "isoslice render [OPTIONS] <MODEL>\n       \
                      isoslice render [OPTIONS] -e <FORMULA>"
)]
pub(super) struct RenderArgs {
    #[command(flatten)]
    model: ModelArgs,

    #[command(flatten)]
    settings: SettingsSource,

    /// PNG file to write, - for standard output [default: the model's name
    /// with .png, beside it; formula.png for -e]
    #[arg(short, long, value_name = "FILE", help_heading = "Picture")]
    output: Option<PathBuf>,

    /// Width and height in pixels, up to 4096 each
    #[arg(
        long,
        value_name = "WxH",
        default_value = "800x600",
        value_parser = size,
        help_heading = "Picture"
    )]
    pixels: [usize; 2],

    /// From where to look: iso, front, back, left, right, top or bottom
    #[arg(
        long,
        value_name = "NAME",
        default_value = "iso",
        value_parser = view,
        help_heading = "Picture"
    )]
    view: View,

    /// Where the viewer stands, seen from above: degrees counter-clockwise
    /// from the x axis, -90 in front; instead of --view's
    #[arg(
        long,
        value_name = "A",
        allow_hyphen_values = true,
        value_parser = degrees,
        help_heading = "Picture"
    )]
    azimuth: Option<f64>,

    /// How far above the horizon, degrees; instead of --view's
    #[arg(
        long,
        value_name = "A",
        allow_hyphen_values = true,
        value_parser = degrees,
        help_heading = "Picture"
    )]
    elevation: Option<f64>,

    /// Colour behind the part: white, black, grey, #rrggbb, or none
    #[arg(
        long,
        value_name = "COLOUR",
        default_value = "white",
        value_parser = background,
        help_heading = "Picture"
    )]
    background: Background,

    #[command(flatten, next_help_heading = "Picture")]
    threads: ThreadArgs,

    #[command(flatten)]
    limits: LimitArgs,
}

/// The colour behind the part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Background {
    None,
    Colour([u8; 3]),
}

pub(super) fn run(args: &RenderArgs) -> anyhow::Result<()> {
    watched(&args.limits.watch(), || render(args))
}

fn render(args: &RenderArgs) -> anyhow::Result<()> {
    let gathered = args.settings.gather()?;
    let path = args.output_path();
    // The name is checked before the work, so that a mistaken one costs no
    // time.
    if !path_is_png(&path) {
        bail!(
            "cannot write {}: render draws PNG pictures; name it \
             FILE.png",
            path.display()
        );
    }
    let mut output = output::create(&path, &args.model.inputs(&gathered))?;
    let plate = args.plate(&gathered)?;
    let model = plate.whole().with_context(|| {
        format!(
            "the expressions of all parts of {} are too large together to be \
             drawn; draw the models one by one",
            plate.name
        )
    })?;
    terminal::warn(&model.warnings);
    let view = View {
        azimuth: args.azimuth.unwrap_or(args.view.azimuth),
        elevation: args.elevation.unwrap_or(args.view.elevation),
    };
    let pool = args.threads.workers()?;
    let behind = args.background.colour();
    let standing =
        supports(&plate, args.threads.count()).with_context(|| {
            format!(
                "cannot plan the supports of {}; --set supports=off draws it \
                 without them",
                plate.name
            )
        })?;
    let draw = || view.draw(&model, &standing, args.pixels, behind);
    let png = pool
        .install(|| limits::doing("picture", draw))
        .with_context(|| format!("cannot draw {}", model.name))?;
    output.put(&png)?;
    Ok(output.finish()?)
}

/// False if a name promises another kind of file.
fn path_is_png(path: &Path) -> bool {
    let end = path.extension().and_then(|end| end.to_str());
    is_stream(path) || end.is_none_or(|end| end.eq_ignore_ascii_case("png"))
}

impl RenderArgs {
    /// What is to be drawn: the model, or everything on a plate.
    fn plate(&self, gathered: &Gathered) -> anyhow::Result<Plate> {
        let alone = PlateArgs::default();
        let sets = &self.settings.set;
        let file = plates::file(&self.model, &alone, gathered, sets)?;
        let job = alone.job(&self.model, file, gathered)?;
        terminal::warn(&job.warnings);
        Ok(job.plate)
    }

    fn output_path(&self) -> PathBuf {
        let given = self.output.clone();
        given.unwrap_or_else(|| self.model.beside("png"))
    }
}

impl Background {
    fn colour(self) -> Option<[u8; 3]> {
        match self {
            Background::None => None,
            Background::Colour(colour) => Some(colour),
        }
    }
}

fn size(given: &str) -> Result<[usize; 2], String> {
    let form =
        || format!("write it as WxH, as in 800x600, each from 1 to {GREATEST}");
    let (width, height) = given.split_once(['x', 'X']).ok_or_else(form)?;
    let side = |text: &str| {
        let side = text.trim().parse().ok();
        side.filter(|n| (1..=GREATEST).contains(n)).ok_or_else(form)
    };
    Ok([side(width)?, side(height)?])
}

fn view(given: &str) -> Result<View, String> {
    let named = View::NAMED.iter().find(|(name, _)| *name == given);
    named.map(|(_, view)| *view).ok_or_else(|| {
        let names: Vec<_> = View::NAMED.iter().map(|(n, _)| *n).collect();
        format!(
            "there are {}; for others give --azimuth and --elevation",
            names.join(", ")
        )
    })
}

fn degrees(given: &str) -> Result<f64, String> {
    match given.trim().parse::<f64>() {
        Ok(angle) if angle.abs() <= 360.0 => Ok(angle),
        _ => Err("it must be a number from -360 to 360".to_owned()),
    }
}

fn background(given: &str) -> Result<Background, String> {
    let colour = |[r, g, b]: [u8; 3]| Ok(Background::Colour([r, g, b]));
    match given {
        "none" | "transparent" => return Ok(Background::None),
        "white" => return colour([255; 3]),
        "black" => return colour([0; 3]),
        "grey" | "gray" => return colour([128; 3]),
        _ => {}
    }
    let digits = given.strip_prefix('#').unwrap_or(given);
    let value = u32::from_str_radix(digits, 16).ok();
    match value.filter(|_| digits.len() == 6 && !digits.starts_with('+')) {
        Some(v) => colour([v >> 16, v >> 8, v].map(|byte| byte as u8)),
        None => Err("there are white, black, grey, none, and #rrggbb as in \
                     #1e1e1e"
            .to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_and_sizes_are_read() {
        let red = Background::Colour([255, 16, 0]);
        assert_eq!(background("#ff1000"), Ok(red));
        assert_eq!(background("FF1000"), Ok(red));
        for bad in ["", "#ff", "#+ff100", "#ff10000", "mauve"] {
            assert!(background(bad).is_err(), "{bad}");
        }
        assert_eq!(size("800x600"), Ok([800, 600]));
        for bad in ["", "800", "0x5", "5000x1", "1x-1", "axb"] {
            assert!(size(bad).is_err(), "{bad}");
        }
        assert!(view("iso").is_ok() && view("above").is_err());
    }
}
