//! What is shown: a model, or the parts of a plate file.
//!
//! In: the command line, the settings, and what the page's user has changed.
//! Out: a plate, which is a single part for a model, and what pages are told of
//! it. Parameters of a plate's parts have the part's number in front: `2.hole` is
//! `hole` of the second `[[part]]`.

use super::choice::Choice;
use super::job::Job;
use crate::cli::args::Gathered;
use crate::cli::excerpt::of_loading;
use crate::cli::info::{JsonParameter, parameter};
use crate::cli::plates::{self, PlateArgs};
use isoslice::model::{LoadError, Model, ParamError, ScriptError};
use isoslice::plate::{Part, Plate, PlateFile, Wanted};
use serde::Serialize;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// The settings, and the plate file, if one is shown.
pub(super) struct Read {
    /// The settings; those of the whole plate, for a plate file.
    pub gathered: Gathered,
    plate: Option<PlateFile>,
}

/// What is shown.
pub(super) struct Subject {
    pub plate: Plate,
    /// What is drawn; none if the parts' expressions are too large together.
    pub drawn: Option<Model>,
    /// What a plate file wants of each part; nothing for a model.
    wanted: Vec<Wanted>,
}

/// A parameter as the page gets it.
#[derive(Serialize)]
struct Told<'a> {
    #[serde(flatten)]
    parameter: JsonParameter<'a>,
    /// The name under which the page changes it.
    key: String,
    /// The part of a plate file, in words.
    #[serde(skip_serializing_if = "Option::is_none")]
    part: Option<&'a str>,
}

impl Read {
    /// Reads the settings, and the plate file.
    pub(super) fn new(job: &Job, choice: &Choice) -> anyhow::Result<Read> {
        let source = choice.settings(&job.settings);
        let mut gathered = source.read()?;
        let alone = PlateArgs::default();
        let plate = plates::file(&job.model, &alone, &gathered, &source.set)?;
        if let Some(file) = &plate {
            gathered.settings = file.builder.settings().clone();
            gathered.builder = file.builder.clone();
            gathered.warnings.clone_from(&file.warnings);
        }
        Ok(Read { gathered, plate })
    }

    /// The files that were read, and those that are still to be read.
    pub(super) fn files(&self, job: &Job) -> Vec<PathBuf> {
        let own = job.model.inputs(&self.gathered).into_iter();
        let models = self.plate.iter().flat_map(|file| &file.models);
        own.map(Path::to_owned).chain(models.cloned()).collect()
    }

    /// Loads what is shown. If `lenient`, changes of parameters that a script
    /// does not have are left out.
    pub(super) fn load(
        &self,
        job: &Job,
        choice: &Choice,
        lenient: bool,
    ) -> anyhow::Result<Subject> {
        let mut choice = choice.clone();
        loop {
            match self.load_with(job, &choice) {
                Err(error) if lenient => {
                    let before = choice.define.len();
                    leave_out_unknown(
                        &mut choice,
                        &error,
                        self.plate.is_some(),
                    );
                    if choice.define.len() == before {
                        return Err(error);
                    }
                }
                loaded => return loaded,
            }
        }
    }

    fn load_with(&self, job: &Job, choice: &Choice) -> anyhow::Result<Subject> {
        let (mut file, mut model) = (self.plate.clone(), job.model.clone());
        match &mut file {
            Some(file) => change(&mut file.parts, choice),
            None => model = choice.model(&model),
        }
        let wanted = file.as_ref().map(|file| file.parts.clone());
        let plate = PlateArgs::default()
            .job(&model, file, &self.gathered)?
            .plate;
        Ok(Subject {
            drawn: plate.whole().or_else(|| plate.of_each()),
            wanted: wanted.unwrap_or_default(),
            plate,
        })
    }
}

/// Gives the parts of a plate file the parameters that the page has changed.
fn change(parts: &mut [Wanted], choice: &Choice) {
    for (key, value) in &choice.define {
        let Some((number, name)) = key.split_once('.') else {
            continue;
        };
        let index = number.parse::<usize>().ok().and_then(|n| n.checked_sub(1));
        if let Some(part) = index.and_then(|index| parts.get_mut(index)) {
            part.defines.retain(|(known, _)| known != name);
            part.defines.push((name.to_owned(), value.clone()));
        }
    }
}

/// Leaves out changes of parameters that a script does not have, if that is the
/// error.
fn leave_out_unknown(choice: &mut Choice, error: &anyhow::Error, plate: bool) {
    let error = match of_loading(error) {
        Some(LoadError::Param { error, .. }) => &**error,
        Some(LoadError::Script { error, .. }) => match &**error {
            ScriptError::Param { error, .. } => error,
            _ => return,
        },
        _ => return,
    };
    let ParamError::Unknown { name, known, .. } = error else {
        return;
    };
    choice.define.retain(|key, _| {
        // The parts of a plate have other parameters than this one.
        let lacks = match key.split_once('.').filter(|_| plate) {
            Some((_, of_part)) => of_part == name,
            None => !known.contains(key),
        };
        !lacks
    });
}

impl Subject {
    /// What pages are told, except for the revision.
    pub(super) fn told(&self) -> anyhow::Result<Value> {
        let headings = self.wanted.iter().enumerate();
        let headings: Vec<String> =
            headings.map(|(k, wanted)| heading(k, wanted)).collect();
        let mut parameters = Vec::new();
        for (k, heading) in headings.iter().enumerate() {
            let of_part = self.part(k).into_iter();
            for one in of_part.flat_map(|part| &part.model.parameters) {
                parameters.push(Told {
                    key: format!("{}.{}", k + 1, one.name),
                    part: Some(heading),
                    parameter: parameter(one),
                });
            }
        }
        if headings.is_empty() {
            let of_model = self.plate.parts.iter();
            let of_model = of_model.flat_map(|part| &part.model.parameters);
            parameters.extend(of_model.map(|one| Told {
                key: one.name.clone(),
                part: None,
                parameter: parameter(one),
            }));
        }
        let corners = self.plate.printed_bounds();
        let corners = corners.map(|b| [b.min.to_array(), b.max.to_array()]);
        Ok(json!({
            "box": corners,
            "size": self.plate.size().to_array(),
            "parameters": serde_json::to_value(parameters)?,
            "warnings": self.plate.warnings(),
        }))
    }

    /// The files that models read beside their own.
    pub(super) fn data_files(&self) -> impl Iterator<Item = PathBuf> {
        let parts = self.plate.parts.iter();
        parts.flat_map(|part| part.model.files.iter().cloned())
    }

    /// The part of the plate that was made of a `[[part]]`.
    fn part(&self, index: usize) -> Option<&Part> {
        self.plate.parts.iter().find(|p| p.wanted.contains(&index))
    }
}

/// A heading for a `[[part]]`, from what it asks for.
fn heading(index: usize, wanted: &Wanted) -> String {
    let copies = match wanted.copies {
        1 => String::new(),
        count => format!(", {count} times"),
    };
    format!("{}. {}{copies}", index + 1, wanted.source.name())
}

#[cfg(test)]
mod tests {
    use super::*;
    use isoslice::model::{Placement, Source};
    use isoslice::settings::Builder;

    #[test]
    fn each_part_gets_its_own_changes() {
        let wanted = Wanted {
            source: Source::formula("a", "x"),
            defines: vec![("hole".into(), "5".into())],
            placement: Placement::default(),
            settings: Builder::new().settings().clone(),
            at: None,
            copies: 1,
            asked: String::new(),
        };
        let mut parts = vec![wanted.clone(), wanted];
        let mut choice = Choice::default();
        for key in ["2.hole", "2.wall", "3.hole", "0.hole", "hole", "x.hole"] {
            choice.define.insert(key.into(), "7".into());
        }
        change(&mut parts, &choice);
        let pair =
            |name: &str, value: &str| (name.to_owned(), value.to_owned());
        assert_eq!(parts[0].defines, [pair("hole", "5")]);
        assert_eq!(parts[1].defines, [pair("hole", "7"), pair("wall", "7")]);
    }
}
