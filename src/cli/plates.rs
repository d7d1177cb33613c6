//! Several models, copies, and plate files: what `isoslice slice` prints in one
//! go.

use super::args::{Gathered, ModelArgs, is_plate};
use anyhow::bail;
use clap::Args;
use isoslice::model::is_mesh;
use isoslice::plate::{Plate, PlateFile, Wanted};
use std::path::{Path, PathBuf};

/// The models beyond the first, and copies.
#[derive(Args, Clone, Debug, Default, PartialEq)]
pub(super) struct PlateArgs {
    /// More models for the same plate; MODEL may also be a plate file (.toml),
    /// which says for each part where it stands and how it is printed:
    /// docs/plates.md
    #[arg(value_name = "MORE", value_parser = model_file)]
    more: Vec<PathBuf>,

    /// Print N copies of each model, arranged on the bed
    #[arg(
        long,
        value_name = "N",
        value_parser = clap::value_parser!(u64).range(1..=Plate::MOST_PARTS),
        help_heading = "Placement"
    )]
    copies: Option<u64>,
}

/// A plate to print.
pub(super) struct Job {
    pub(super) plate: Plate,
    /// What the user should know of a plate file's settings.
    pub(super) warnings: Vec<String>,
}

/// A plate file that has been read, if the model is one.
pub(super) fn file(
    model: &ModelArgs,
    args: &PlateArgs,
    gathered: &Gathered,
    sets: &[String],
) -> anyhow::Result<Option<PlateFile>> {
    let Some(path) = model.model.as_deref().filter(|path| is_plate(path))
    else {
        return Ok(None);
    };
    args.refuse_beside_file(model)?;
    Ok(Some(PlateFile::read(path, gathered.builder.clone(), sets)?))
}

impl PlateArgs {
    /// Refuses what a plate file says itself, if the model is one.
    pub(super) fn refuse_beside_file(
        &self,
        model: &ModelArgs,
    ) -> anyhow::Result<()> {
        let file = model.model.as_deref().filter(|path| is_plate(path));
        let says_more =
            !self.more.is_empty() || self.copies.is_some() || model.places();
        match file {
            Some(path) if says_more => bail!(
                "{} is a plate file; write copies, parameters and places into \
                 it, and leave out other models, --copies, -D and the options \
                 of placement",
                path.display()
            ),
            _ => Ok(()),
        }
    }

    /// The models besides the first.
    pub(super) fn models(&self) -> impl Iterator<Item = &Path> {
        self.more.iter().map(PathBuf::as_path)
    }

    /// True if there is more than one part to print.
    fn several(&self) -> bool {
        !self.more.is_empty() || self.copies.is_some_and(|n| n > 1)
    }

    /// Where the G-code goes unless the user says.
    pub(super) fn output(&self, model: &Path, extension: &str) -> PathBuf {
        if self.more.is_empty() {
            model.with_extension(extension)
        } else {
            model.with_file_name(format!("plate.{extension}"))
        }
    }

    /// Reads what is to be printed from a plate file or the command line.
    pub(super) fn job(
        &self,
        model: &ModelArgs,
        file: Option<PlateFile>,
        Gathered { settings, .. }: &Gathered,
    ) -> anyhow::Result<Job> {
        if let Some(file) = file {
            let path = model.model.as_deref().and_then(Path::file_stem);
            let name = path.unwrap_or_default().to_string_lossy();
            let plate =
                Plate::new(&name, &file.parts, file.builder.settings())?;
            let warnings = file.warnings;
            return Ok(Job { plate, warnings });
        }
        if !self.several() {
            let model = model.load(settings)?;
            let plate = Plate::of(&model, settings);
            let warnings = Vec::new();
            return Ok(Job { plate, warnings });
        }
        let first = model.wanted(settings)?;
        let mut all = vec![Wanted {
            copies: self.copies.unwrap_or(1),
            ..first
        }];
        for path in self.models() {
            if is_plate(path) {
                bail!("{} is a plate file; slice it alone", path.display());
            }
            all.push(Wanted {
                source: isoslice::model::Source::File(path.to_owned()),
                asked: path.display().to_string(),
                ..all[0].clone()
            });
        }
        let name = Plate::name_of(&all);
        let plate = Plate::new(&name, &all, settings)?;
        let warnings = Vec::new();
        Ok(Job { plate, warnings })
    }
}

/// The name of a model's file. Anything else is a mistake in the command line.
fn model_file(given: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(given);
    let known = ["rhai", "vm", "toml"];
    let extension = path.extension().unwrap_or_default();
    let known = known.iter().any(|e| extension.eq_ignore_ascii_case(e));
    if known || is_mesh(&path) {
        Ok(path)
    } else {
        Err("models after the first are .rhai or .vm files, or meshes".into())
    }
}
