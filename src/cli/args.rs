//! Arguments that several commands share, and what they mean.

use super::folder::ProfilesSource;
use super::output::is_stream;
use super::{complete, plain, terminal};
use anyhow::{Context, anyhow, bail};
use clap::{Args, ValueEnum};
use clap_complete::engine::ArgValueCompleter;
use glam::DVec3;
use isoslice::files;
use isoslice::model::{
    self, Bounds, BuildVolume, Expression, LoadError, Loaded, Model, Placement,
    Source, SourceKind,
};
use isoslice::plate::Wanted;
use isoslice::settings::{
    Builder, GivenIn, Origin, ProfileKind, Settings, SettingsError, keys,
};
use isoslice_base::units::human_list;
use slicerprofile::Counterpart;
use std::path::{Path, PathBuf};

/// Name of a model that is given as a formula.
pub(super) const FORMULA: &str = "formula";

/// Name of a model that comes from standard input.
const STDIN: &str = "stdin";

/// Which model, and how it is placed.
#[derive(Args, Clone, Debug, PartialEq)]
pub(super) struct ModelArgs {
    /// The model: a Rhai script (.rhai), a mesh (.stl, .obj, .ply, .3mf) or
    /// fidget's text format (.vm); - is standard input
    #[arg(
        value_name = "MODEL",
        required_unless_present = "expression",
        conflicts_with = "expression"
    )]
    pub(super) model: Option<PathBuf>,

    /// Instead of MODEL: one formula in x, y and z, in mm, negative inside
    #[arg(
        short = 'e',
        long = "expression",
        value_name = "FORMULA",
        allow_hyphen_values = true,
        help_heading = "Model"
    )]
    pub(super) expression: Option<String>,

    /// What comes from standard input
    #[arg(
        long,
        value_name = "FORMAT",
        value_enum,
        default_value_t = Format::Rhai,
        help_heading = "Model"
    )]
    format: Format,

    /// Set a parameter of the model's script; `info` lists them
    #[arg(
        short = 'D',
        long = "define",
        value_name = "NAME=VALUE",
        value_parser = define,
        add = ArgValueCompleter::new(complete::parameters),
        help_heading = "Model"
    )]
    pub(super) defines: Vec<(String, String)>,

    /// Cut the model with this box, in its own coordinates, mm; without it the
    /// bounds are found
    #[arg(
        long,
        value_name = "X0,Y0,Z0:X1,Y1,Z1",
        allow_hyphen_values = true,
        value_parser = bounds,
        help_heading = "Model"
    )]
    bounds: Option<Bounds>,

    /// Scale so that the largest side measures S mm
    #[arg(
        long,
        value_name = "S",
        conflicts_with = "scale",
        allow_hyphen_values = true,
        value_parser = positive,
        help_heading = "Placement"
    )]
    size: Option<f64>,

    /// Scale by a factor
    #[arg(
        long,
        value_name = "FACTOR",
        allow_hyphen_values = true,
        value_parser = positive,
        help_heading = "Placement"
    )]
    scale: Option<f64>,

    /// Raise a drawing, a model that does not depend on z, to H mm; --size is
    /// then the drawing's larger side
    #[arg(
        long,
        value_name = "H",
        allow_hyphen_values = true,
        value_parser = positive,
        help_heading = "Placement"
    )]
    height: Option<f64>,

    /// Lay a mesh on its largest flat side, before it is rotated
    #[arg(long, help_heading = "Placement")]
    lay: bool,

    /// Rotate about the x axis, degrees; x first, then y, then z
    #[arg(
        long,
        value_name = "A",
        default_value = "0",
        hide_default_value = true,
        allow_hyphen_values = true,
        value_parser = finite,
        help_heading = "Placement"
    )]
    rotate_x: f64,

    /// Rotate about the y axis, degrees
    #[arg(
        long,
        value_name = "A",
        default_value = "0",
        hide_default_value = true,
        allow_hyphen_values = true,
        value_parser = finite,
        help_heading = "Placement"
    )]
    rotate_y: f64,

    /// Rotate about the z axis, degrees
    #[arg(
        long,
        value_name = "A",
        default_value = "0",
        hide_default_value = true,
        allow_hyphen_values = true,
        value_parser = finite,
        help_heading = "Placement"
    )]
    rotate_z: f64,

    /// Centre the part at X,Y of the bed, mm [default: the bed's centre]
    #[arg(
        long,
        value_name = "X,Y",
        conflicts_with = "keep_position",
        allow_hyphen_values = true,
        value_parser = point,
        help_heading = "Placement"
    )]
    at: Option<(f64, f64)>,

    /// Take the model's coordinates as the printer's
    #[arg(long, help_heading = "Placement")]
    keep_position: bool,
}

/// Format of a model that has no file name.
#[derive(Clone, Copy, Debug, PartialEq, ValueEnum)]
enum Format {
    // The option describes these formats; descriptions here would make clap
    // print a list.
    Rhai,
    Vm,
    Formula,
}

impl ModelArgs {
    /// How the model is placed.
    fn placement(&self, settings: &Settings) -> Placement {
        Placement {
            scale: self.scale,
            size: self.size,
            lay: self.lay,
            rotate: [self.rotate_x, self.rotate_y, self.rotate_z],
            at: self.at,
            keep_position: self.keep_position,
            bounds: self.bounds,
            height: self.height,
            margin: settings.reach(),
        }
    }

    /// True if the model's parameters or its placement are given.
    pub(super) fn places(&self) -> bool {
        let given = Placement {
            margin: 0.0,
            ..self.placement(&Settings::default())
        };
        !self.defines.is_empty() || given != Placement::default()
    }

    /// The model for a plate, where a place is found for it.
    pub(super) fn wanted(&self, settings: &Settings) -> anyhow::Result<Wanted> {
        if self.at.is_some() {
            bail!(
                "--at is for a single part; tell where several stand in a \
                 plate file (docs/plates.md), or leave it out to have them \
                 arranged"
            );
        }
        let source = self.source()?;
        let asked = source.to_string();
        Ok(Wanted {
            source,
            defines: self.defines.clone(),
            placement: self.placement(settings),
            settings: settings.clone(),
            at: None,
            copies: 1,
            asked,
        })
    }

    /// Loads the model and puts it on the printer.
    pub(super) fn load(&self, settings: &Settings) -> anyhow::Result<Model> {
        let loaded = self.loaded()?;
        let placement = self.placement(settings);
        let volume = BuildVolume::of(settings);
        Ok(model::place(&loaded, &placement, volume)?)
    }

    /// Loads the model and turns and scales it, for a printer of any size.
    pub(super) fn load_anywhere(&self) -> anyhow::Result<Model> {
        if self.at.is_some() {
            bail!(
                "--at is for printing; here the model keeps the coordinates in \
                 which it is drawn"
            );
        }
        let loaded = self.loaded()?;
        let placement = Placement {
            keep_position: false,
            margin: 0.0,
            ..self.placement(&Settings::default())
        };
        Ok(model::place(&loaded, &placement, BuildVolume::ANY)?)
    }

    fn loaded(&self) -> anyhow::Result<Loaded> {
        if let Some(path) = self.model.as_deref().filter(|p| is_plate(p)) {
            bail!(
                "{} is a plate file or a file of settings, not a model; `slice`, \
                 `info`, `preview`, `watch` and `render` take plate files, \
                 --config takes settings",
                path.display()
            );
        }
        let loaded = model::load(&self.source()?, &self.defines);
        Ok(loaded.map_err(|error| self.with_height(error))?)
    }

    /// The advice for a drawing that was given as a model, with the height that was
    /// given.
    fn with_height(&self, error: LoadError) -> LoadError {
        let LoadError::NoModel {
            file,
            found,
            mut advice,
        } = error
        else {
            return error;
        };
        if let Some(height) = self.height {
            let given = format!("--height {height}");
            advice = advice.replace("--height 2", &given);
        }
        LoadError::NoModel {
            file,
            found,
            advice,
        }
    }

    /// The files that a command with these settings reads. No output may be one
    /// of them.
    pub(super) fn inputs<'a>(
        &'a self,
        settings: &'a Gathered,
    ) -> Vec<&'a Path> {
        self.model
            .iter()
            .chain(&settings.files)
            .map(PathBuf::as_path)
            .collect()
    }

    /// The model's name with another extension, beside the model.
    pub(super) fn beside(&self, extension: &str) -> PathBuf {
        match &self.model {
            _ if self.is_stdin() => Path::new(STDIN).with_extension(extension),
            Some(model) => model.with_extension(extension),
            None => Path::new(FORMULA).with_extension(extension),
        }
    }

    /// True if the model is read from standard input.
    pub(super) fn is_stdin(&self) -> bool {
        self.model.as_deref().is_some_and(is_stream)
    }

    fn source(&self) -> anyhow::Result<Source> {
        Ok(match (&self.model, &self.expression) {
            (Some(_), _) if self.is_stdin() => Source::Text {
                name: STDIN.to_owned(),
                kind: match self.format {
                    Format::Rhai => SourceKind::Script,
                    Format::Vm => SourceKind::Vm,
                    Format::Formula => SourceKind::Formula,
                },
                text: standard_input()?,
            },
            (Some(path), _) => Source::File(path.clone()),
            (None, text) => {
                Source::formula(FORMULA, text.clone().unwrap_or_default())
            }
        })
    }
}

/// True for the name of a plate file.
pub(super) fn is_plate(path: &Path) -> bool {
    path.extension()
        .is_some_and(|e| e.eq_ignore_ascii_case("toml"))
}

fn standard_input() -> anyhow::Result<String> {
    /// Size of the largest kind of file, bytes. Loading refuses a file that is
    /// too large for its own kind.
    const MAX_BYTES: u64 = 64 << 20;
    files::read_standard_input(MAX_BYTES)
        .context("cannot read the model from standard input")
}

/// Where settings come from.
#[derive(Args, Clone, Debug, PartialEq)]
#[command(next_help_heading = "Settings")]
pub(super) struct SettingsSource {
    /// Settings for this printer; `isoslice profiles` lists them
    #[arg(
        long,
        value_name = "NAME",
        add = ArgValueCompleter::new(complete::printers)
    )]
    pub(super) printer: Option<String>,

    /// Settings for this filament
    #[arg(
        long,
        value_name = "NAME",
        add = ArgValueCompleter::new(complete::filaments)
    )]
    pub(super) filament: Option<String>,

    /// Settings for this kind of print
    #[arg(
        long,
        value_name = "NAME",
        add = ArgValueCompleter::new(complete::presets)
    )]
    pub(super) preset: Option<String>,

    #[command(flatten)]
    pub(super) profiles: ProfilesSource,

    /// Read settings from a TOML file; wins over profiles; may be given several
    /// times, and the last one wins
    #[arg(long, value_name = "FILE")]
    pub(super) config: Vec<PathBuf>,

    /// Set one setting, as in layer_height=0.15 or speed.outer_wall=30;
    /// wins over all others; `isoslice settings` lists them
    #[arg(
        long,
        value_name = "KEY=VALUE",
        add = ArgValueCompleter::new(complete::settings)
    )]
    pub(super) set: Vec<String>,
}

/// Settings with their warnings and origins.
pub(super) struct Gathered {
    pub(super) settings: Settings,
    pub(super) warnings: Vec<String>,
    /// The files that the settings were read from.
    pub(super) files: Vec<PathBuf>,
    /// The builder that knows where each setting is from.
    pub(super) builder: Builder,
}

impl SettingsSource {
    /// Reads the settings, and shows their warnings to the user.
    pub(super) fn gather(&self) -> anyhow::Result<Gathered> {
        let gathered = self.read()?;
        terminal::warn(&gathered.warnings);
        terminal::note(&gathered.settings.notes());
        Ok(gathered)
    }

    /// Reads the settings.
    pub(super) fn read(&self) -> anyhow::Result<Gathered> {
        self.gathered().map_err(|error| {
            error.downcast().map_or_else(|e| e, |e| explained(e).into())
        })
    }

    fn gathered(&self) -> anyhow::Result<Gathered> {
        let profiles = self.profiles.find()?;
        let mut builder = Builder::new();
        let mut files = self.config.clone();
        for (kind, name) in [
            (ProfileKind::Printer, &self.printer),
            (ProfileKind::Filament, &self.filament),
            (ProfileKind::Preset, &self.preset),
        ] {
            if let Some(name) = name {
                let read = builder
                    .profile(&profiles, kind, name)
                    .map_err(|error| of_file(error, Path::new(name)))?;
                files.extend(read.into_iter().filter_map(|p| match p.origin {
                    Origin::File(path) => Some(path),
                    Origin::Shipped => None,
                }));
            }
        }
        for path in &self.config {
            builder.file(path).map_err(|error| of_file(error, path))?;
        }
        for assignment in &self.set {
            builder.set(assignment)?;
        }
        let (settings, warnings) = builder.clone().finish()?;
        formulas_of_files(&builder)?;
        if let Some(path) = settings.infill_script() {
            files.push(path.into());
        }
        Ok(Gathered {
            settings,
            warnings,
            files,
            builder,
        })
    }
}

/// Looks at the formulas that files give, since only here their places are known.
/// Those of infill may be more than formulas.
fn formulas_of_files(builder: &Builder) -> anyhow::Result<()> {
    for key in keys().iter().filter(|key| key.name != "infill") {
        let value = key.get(builder.settings());
        let text = value.strip_prefix("\"expr: ");
        let text = text.and_then(|text| text.strip_suffix('"'));
        let (Some(text), Some(place @ GivenIn::File { .. })) =
            (text, builder.place(key))
        else {
            continue;
        };
        let parsed = if key.name == "xy_compensation" {
            Expression::of_outline(text)
        } else {
            Expression::parse(text)
        };
        if let Err(error) = parsed {
            bail!("{place}: {} = {value}: {error}", key.name);
        }
    }
    Ok(())
}

/// An error about a file of settings, which may be another slicer's.
fn of_file(error: SettingsError, path: &Path) -> anyhow::Error {
    /// The ends of names of files that `isoslice profiles import` reads.
    const IMPORTED: [&str; 5] = ["ini", "json", "curaprofile", "3mf", "gcode"];
    let is_imported = path.extension().is_some_and(|extension| {
        IMPORTED.iter().any(|of| extension.eq_ignore_ascii_case(of))
    });
    if !is_imported || !path.is_file() {
        return error.into();
    }
    let path = plain::value(path.display());
    anyhow!(
        "{path} is no settings file of isoslice's, which is TOML; if it is \
         another slicer's, `isoslice profiles import {path}` makes profiles of \
         it, for --printer, --filament and --preset"
    )
}

/// An error that says what another slicer's name of a setting is here.
fn explained(error: SettingsError) -> SettingsError {
    let SettingsError::UnknownKey { place, key, hint } = error else {
        return error;
    };
    if matches!(key.as_str(), "description" | "inherits") {
        let hint = "it is a profile's: give the file with --printer, --filament or \
                    --preset";
        return SettingsError::UnknownKey {
            place,
            key,
            hint: hint.to_owned(),
        };
    }
    let known = isoslice_settings::foreign_name(&key).is_some()
        || isoslice_settings::instead(&key).is_some();
    let hint = match slicerprofile::counterpart(&key) {
        Some(Counterpart::Keys(names)) if !known => {
            format!("did you mean {}?", either(&names))
        }
        Some(Counterpart::None(why)) if !known => {
            format!("it is another slicer's: {why}")
        }
        _ => hint,
    };
    SettingsError::UnknownKey { place, key, hint }
}

/// Some names, of which one is meant.
pub(super) fn either(names: &[&str]) -> String {
    /// More names than this help nobody.
    const MOST: usize = 5;
    human_list(&names[..names.len().min(MOST)], "or")
}

fn define(given: &str) -> Result<(String, String), String> {
    match given.split_once('=') {
        Some((name, value)) if !name.trim().is_empty() => {
            Ok((name.trim().to_owned(), value.trim().to_owned()))
        }
        _ => Err("write it as name=value, as in cell=8".to_owned()),
    }
}

fn finite(given: &str) -> Result<f64, String> {
    match given.trim().parse::<f64>() {
        Ok(number) if number.is_finite() => Ok(number),
        _ => Err(format!(
            "{given:?} is not a number; write it without a unit, as in 50 or \
             0.5"
        )),
    }
}

fn positive(given: &str) -> Result<f64, String> {
    match finite(given)? {
        number if number > 0.0 => Ok(number),
        _ => Err("it must be more than 0".to_owned()),
    }
}

/// Reads `N` numbers such as `1,2,3`.
fn numbers<const N: usize>(
    given: &str,
    form: &str,
) -> Result<[f64; N], String> {
    let numbers: Vec<f64> =
        given.split(',').map(finite).collect::<Result<_, _>>()?;
    <[f64; N]>::try_from(numbers).map_err(|_| format!("write it as {form}"))
}

fn point(given: &str) -> Result<(f64, f64), String> {
    numbers(given, "X,Y, as in 110,110").map(|[x, y]| (x, y))
}

fn bounds(given: &str) -> Result<Bounds, String> {
    const FORM: &str = "X0,Y0,Z0:X1,Y1,Z1, as in -5,-5,0:5,5,20";
    let (min, max) = given
        .split_once(':')
        .ok_or_else(|| format!("write it as {FORM}"))?;
    let min = DVec3::from_array(numbers(min, FORM)?);
    let max = DVec3::from_array(numbers(max, FORM)?);
    if min.cmplt(max).all() {
        Ok(Bounds { min, max })
    } else {
        Err("each of X1, Y1, Z1 must be more than X0, Y0, Z0".to_owned())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boxes_and_points_are_read_with_signs_and_spaces() {
        assert_eq!(point("-5, 10.5"), Ok((-5.0, 10.5)));
        let b = bounds("-5,-5,0: 5,5,2e1").ok();
        assert_eq!(b.map(|b| b.size()), Some(DVec3::new(10.0, 10.0, 20.0)));
    }

    #[test]
    fn malformed_numbers_are_refused() {
        for bad in ["", "1", "1,2,3", "1,nan", "a,b", "1,,2"] {
            assert!(point(bad).is_err(), "{bad}");
        }
        for bad in ["1,2,3", "0,0,0:1,1", "0,0,0:1,1,0", "0,0,0:1,1,1:2,2,2"] {
            assert!(bounds(bad).is_err(), "{bad}");
        }
        for bad in ["0", "-1", "inf", "x"] {
            assert!(positive(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn values_of_defines_may_hold_anything() {
        assert_eq!(define("a=b=-1"), Ok(("a".to_owned(), "b=-1".to_owned())));
        assert!(define("=1").is_err());
        assert!(define("a").is_err());
    }
}
