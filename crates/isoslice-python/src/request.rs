//! What `slice` and its like are asked for: their keywords, read and put
//! together as the command line does it.

use crate::error::plain;
use crate::value::{assignments, expr, parameters};
use anyhow::bail;
use glam::DVec3;
use isocontour::{Bounds, expand};
use isoslice::layers::LayerRange;
use isoslice::limits::Limits;
use isoslice::model::{
    self, BuildVolume, LoadError, Model, Placement, Source, SourceKind,
};
use isoslice::settings::{Builder, ProfileKind, Profiles, Settings};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Name of a model that is given as a formula, or made by a program.
const FORMULA: &str = "formula";

/// The keywords that say what is printed, and how.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Keywords<'py> {
    params: Option<Bound<'py, PyDict>>,
    name: Option<String>,
    settings: Option<Bound<'py, PyDict>>,
    more: Bound<'py, PyDict>,
    printer: Option<PathBuf>,
    filament: Option<PathBuf>,
    preset: Option<PathBuf>,
    profiles: Option<PathBuf>,
    config: Option<Files>,
    size: Option<f64>,
    scale: Option<f64>,
    height: Option<f64>,
    rotate: Option<[f64; 3]>,
    at: Option<(f64, f64)>,
    keep_position: bool,
    bounds: Option<[[f64; 3]; 2]>,
    threads: Option<usize>,
    time_limit: Option<f64>,
    memory_limit: Option<f64>,
    pub(crate) progress: Option<Bound<'py, PyAny>>,
}

/// A file, or several.
#[derive(FromPyObject)]
enum Files {
    #[pyo3(transparent)]
    One(PathBuf),
    #[pyo3(transparent)]
    Many(Vec<PathBuf>),
}

/// Which model is meant.
enum Given {
    Source(Source, Vec<(String, String)>),
    Loaded(model::Loaded),
}

/// A request that has been read, and can be worked on without Python.
pub(crate) struct Request {
    given: Given,
    placement: Placement,
    pub(crate) settings: Settings,
    /// What the user should know of the settings.
    pub(crate) warnings: Vec<String>,
    /// The files of settings.
    files: Vec<PathBuf>,
    pub(crate) threads: Option<usize>,
    pub(crate) limits: Limits,
}

impl Request {
    /// Reads keywords, and the settings that they name.
    pub(crate) fn new(
        model: &Bound<'_, PyAny>,
        keywords: &Keywords<'_>,
    ) -> PyResult<Request> {
        let defines = parameters(keywords.params.as_ref())?;
        let given = match expr(model)? {
            Some(expr) if defines.is_empty() => {
                let expr = expr.get();
                let name = keywords.name.clone().or(expr.name.clone());
                Given::Loaded(model::Loaded {
                    name: name.unwrap_or_else(|| FORMULA.to_owned()),
                    tree: expr.tree.clone(),
                    parameters: expr.parameters.clone(),
                    // The size is counted when it is asked for.
                    expression_size: 0,
                })
            }
            Some(_) => {
                return Err(PyTypeError::new_err(
                    "params are for models that are read from a file: give \
                     them to isoslice.load or isoslice.script",
                ));
            }
            None => {
                let path: PathBuf = model.extract().map_err(|_| {
                    PyTypeError::new_err(
                        "a model is an isoslice.Expr, or the name of a .rhai \
                         or .vm file",
                    )
                })?;
                if keywords.name.is_some() {
                    return Err(PyTypeError::new_err(
                        "name is for models that are no files",
                    ));
                }
                Given::Source(Source::File(path), defines)
            }
        };
        let (settings, warnings) = keywords.gather()?;
        Ok(Request {
            given,
            placement: keywords.placement(&settings)?,
            warnings,
            files: keywords.files().to_vec(),
            threads: keywords.threads()?,
            limits: keywords.limits()?,
            settings,
        })
    }

    /// The files that are read. No output may be one of them.
    pub(crate) fn inputs(&self) -> Vec<&Path> {
        let model = match &self.given {
            Given::Source(Source::File(path), _) => Some(path),
            _ => None,
        };
        model.into_iter().chain(&self.files).map(|p| &**p).collect()
    }

    /// The model on the printer. This may take long.
    pub(crate) fn model(&self) -> anyhow::Result<Model> {
        let loaded = match &self.given {
            Given::Source(source, defines) => loaded(source, defines)?,
            Given::Loaded(loaded) => {
                let counted = expand(&loaded.tree);
                let file = loaded.name.clone();
                let (context, _) = counted
                    .map_err(|error| LoadError::Expression { file, error })?;
                model::Loaded {
                    expression_size: context.len(),
                    ..loaded.clone()
                }
            }
        };
        let volume = BuildVolume::of(&self.settings);
        Ok(model::place(&loaded, &self.placement, volume)?)
    }
}

/// A model as it was written.
pub(crate) fn loaded(
    source: &Source,
    defines: &[(String, String)],
) -> anyhow::Result<model::Loaded> {
    Ok(model::load(source, defines)?)
}

/// A file, or text of a kind.
pub(crate) fn source(
    kind: &str,
    text: &Bound<'_, PyAny>,
    name: &str,
) -> PyResult<Source> {
    let kind = match kind {
        "script" => SourceKind::Script,
        "vm" => SourceKind::Vm,
        "formula" => SourceKind::Formula,
        _ => return Ok(Source::File(text.extract()?)),
    };
    Ok(Source::Text {
        name: name.to_owned(),
        kind,
        text: text.extract()?,
    })
}

impl Keywords<'_> {
    fn gather(&self) -> PyResult<(Settings, Vec<String>)> {
        let mut given = Vec::new();
        for group in self.settings.iter().chain([&self.more]) {
            assignments(group, "", 0, &mut given)?;
        }
        let gather = || -> anyhow::Result<_> {
            let profiles = folder(self.profiles.clone())?;
            let mut builder = Builder::new();
            for (kind, name) in [
                (ProfileKind::Printer, &self.printer),
                (ProfileKind::Filament, &self.filament),
                (ProfileKind::Preset, &self.preset),
            ] {
                if let Some(name) = name {
                    let name = name.to_string_lossy();
                    builder.profile(&profiles, kind, &name)?;
                }
            }
            for file in self.files() {
                builder.file(file)?;
            }
            for assignment in &given {
                builder.set(assignment)?;
            }
            Ok(builder.finish()?)
        };
        gather().map_err(|error| crate::error::exception(&error))
    }

    /// The files of settings.
    fn files(&self) -> &[PathBuf] {
        match &self.config {
            None => &[],
            Some(Files::One(file)) => std::slice::from_ref(file),
            Some(Files::Many(files)) => files,
        }
    }

    fn placement(&self, settings: &Settings) -> PyResult<Placement> {
        let both = |first: bool, second: bool, names: &str| {
            if first && second {
                return Err(PyTypeError::new_err(format!(
                    "{names} cannot be given together; drop one of them"
                )));
            }
            Ok(())
        };
        both(self.size.is_some(), self.scale.is_some(), "size and scale")?;
        let fixed = self.keep_position;
        both(self.at.is_some(), fixed, "at and keep_position")?;
        Ok(Placement {
            scale: self.scale,
            size: self.size,
            rotate: self.rotate.unwrap_or_default(),
            at: self.at,
            keep_position: self.keep_position,
            bounds: self.bounds.map(bounds),
            height: self.height,
            margin: settings.reach(),
        })
    }

    fn threads(&self) -> PyResult<Option<usize>> {
        match self.threads {
            Some(n) if !(1..=1024).contains(&n) => Err(PyValueError::new_err(
                format!("threads = {n}: use 1 to 1024"),
            )),
            threads => Ok(threads),
        }
    }

    fn limits(&self) -> PyResult<Limits> {
        let mut limits = Limits::of_slicing();
        if let Some(seconds) = self.time_limit {
            limits.slow = None;
            limits.time = limit("time_limit", seconds)?
                .map(Duration::try_from_secs_f64)
                .transpose()
                .map_err(|_| not_positive("time_limit", seconds))?;
        }
        if let Some(bytes) = self.memory_limit {
            let bytes = limit("memory_limit", bytes)?;
            limits.memory_bytes = bytes.map(|bytes| bytes as u64);
        }
        Ok(limits)
    }
}

/// A limit; none if it is infinite.
fn limit(name: &str, value: f64) -> PyResult<Option<f64>> {
    if value > 0.0 {
        Ok(Some(value).filter(|value| value.is_finite()))
    } else {
        Err(not_positive(name, value))
    }
}

fn not_positive(name: &str, value: f64) -> PyErr {
    PyValueError::new_err(format!(
        "{name} = {value}: use a number of more than 0; math.inf is no limit"
    ))
}

/// A box, by two of its corners. The library says which are none.
pub(crate) fn bounds([min, max]: [[f64; 3]; 2]) -> Bounds {
    Bounds {
        min: DVec3::from_array(min),
        max: DVec3::from_array(max),
    }
}

/// The profiles of the program and of a folder.
pub(crate) fn folder(given: Option<PathBuf>) -> anyhow::Result<Profiles> {
    // The usual folder may be missing, but not one that was named.
    if let Some(folder) = &given
        && !folder.is_dir()
    {
        bail!("there is no folder {} (--profiles)", folder.display());
    }
    Ok(Profiles::new(given.or_else(Profiles::usual_folder)))
}

/// Layers, as the command line writes them, or a number, or the first and the
/// last one.
pub(crate) fn layers(given: Option<&Bound<'_, PyAny>>) -> PyResult<LayerRange> {
    let Some(given) = given else {
        return Ok(LayerRange::ALL);
    };
    let text = if let Ok((first, last)) = given.extract::<(usize, usize)>() {
        format!("{first}..{last}")
    } else if let Ok(only) = given.extract::<usize>() {
        only.to_string()
    } else {
        given.extract::<String>().map_err(|_| {
            PyTypeError::new_err(
                "layers is to be a text such as \"10..20\", a number, or the \
                 first and the last one",
            )
        })?
    };
    text.parse().map_err(|why: String| {
        PyValueError::new_err(format!("layers = {text}: {why}"))
    })
}

/// The format of a name such as "bgcode".
pub(crate) fn format(name: &str) -> PyResult<isoslice::Format> {
    use isoslice::Format;
    let all = [Format::Text, Format::Binary, Format::Plate];
    all.into_iter()
        .find(|format| format.extension() == name)
        .ok_or_else(|| {
            PyValueError::new_err(format!(
                "format = {name:?}: use \"gcode\", \"bgcode\" or \"gcode.3mf\""
            ))
        })
}

/// The format of a file of a name.
pub(crate) fn format_of(path: &Path) -> PyResult<isoslice::Format> {
    isoslice::Format::of_name(path).map_err(plain)
}
