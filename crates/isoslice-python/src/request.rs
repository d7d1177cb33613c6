//! What `slice` and its like are asked for: their keywords, read and put
//! together as the command line does it.

use crate::error::plain;
use crate::value::{assignments, expr, parameters};
use anyhow::{Context, bail};
use glam::DVec3;
use isocontour::Bounds;
use isoslice::layers::LayerRange;
use isoslice::limits::Limits;
use isoslice::model::{
    self, BuildVolume, Model, Placement, Source, SourceKind,
};
use isoslice::plate::{Plate, PlateFile, Wanted};
use isoslice::settings::{Builder, ProfileKind, Profiles, Settings, keys};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Name of a model that is given as a formula, or made by a program.
pub(crate) const FORMULA: &str = "formula";

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
    lay: bool,
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

/// A part of a plate: the attributes of Python's class `Part`.
#[derive(FromPyObject)]
pub(crate) struct PartGiven<'py> {
    model: Bound<'py, PyAny>,
    copies: u64,
    params: Option<Bound<'py, PyDict>>,
    at: Option<(f64, f64)>,
    lay: bool,
    rotate: Option<Angles>,
    scale: Option<f64>,
    size: Option<f64>,
    settings: Option<Bound<'py, PyDict>>,
    name: Option<String>,
}

/// An angle about z, or angles about x, y and z, degrees.
#[derive(FromPyObject)]
enum Angles {
    #[pyo3(transparent)]
    All([f64; 3]),
    #[pyo3(transparent)]
    Z(f64),
}

/// What is to be printed.
enum Given {
    One(Box<Wanted>),
    Plate(Vec<Wanted>),
}

/// A request that has been read, and can be worked on without Python.
pub(crate) struct Request {
    given: Given,
    /// Name of the plate, if there may be several parts.
    name: Option<String>,
    /// What holds for the whole plate.
    pub(crate) settings: Settings,
    /// What the user should know of the settings.
    pub(crate) warnings: Vec<String>,
    /// The files that are read. No output may be one of them.
    inputs: Vec<PathBuf>,
    pub(crate) threads: Option<usize>,
    pub(crate) limits: Limits,
}

impl Request {
    /// A setting that is a length, mm.
    pub(crate) fn length(&self, name: &str) -> anyhow::Result<f64> {
        let key = keys().iter().find(|key| key.name == name);
        let key = key.with_context(|| format!("there is no setting {name}"))?;
        let length = key.length(&self.settings);
        length
            .or_else(|| key.get(&self.settings).parse().ok())
            .with_context(|| format!("{name} is no length"))
    }

    /// Reads a model, or the name of a plate file, with keywords, and the
    /// settings that they name.
    pub(crate) fn new(
        model: &Bound<'_, PyAny>,
        keywords: &Keywords<'_>,
    ) -> PyResult<Request> {
        let path = match expr(model)? {
            Some(_) => None,
            None => model.extract::<PathBuf>().ok(),
        };
        if let Some(path) = path.filter(|path| is_plate(path)) {
            return Request::of_file(&path, keywords);
        }
        let (builder, _) = keywords.builder()?;
        let (settings, warnings) = finish(&builder)?;
        let name = keywords.name.clone();
        let params = keywords.params.as_ref();
        let wanted = keywords.wanted(model, name, params, &settings)?;
        keywords.request(Given::One(wanted.into()), None, settings, warnings)
    }

    /// Reads the parts of a plate, with the keywords that hold for all of them.
    pub(crate) fn of_parts(
        parts: Vec<PartGiven<'_>>,
        keywords: &Keywords<'_>,
    ) -> PyResult<Request> {
        if keywords.at.is_some() {
            return Err(PyTypeError::new_err(
                "at is for a single part; write Part(model, at=(x, y)), or \
                 leave it out to have the parts arranged",
            ));
        }
        let (builder, _) = keywords.builder()?;
        let (settings, mut warnings) = finish(&builder)?;
        let mut all = Vec::new();
        for part in parts {
            let mut builder = builder.clone();
            let mut given = Vec::new();
            if let Some(own) = &part.settings {
                assignments(own, "", 0, &mut given)?;
            }
            for assignment in &given {
                builder.set(assignment).map_err(plain_error)?;
            }
            let (of_part, told) = finish(&builder)?;
            for warning in told {
                if !warnings.contains(&warning) {
                    warnings.push(warning);
                }
            }
            let params = part.params.as_ref().or(keywords.params.as_ref());
            let mut wanted =
                keywords.wanted(&part.model, part.name, params, &of_part)?;
            wanted.copies = part.copies;
            wanted.at = part.at;
            both(part.scale.is_some(), part.size.is_some(), "size and scale")?;
            if part.scale.is_some() || part.size.is_some() {
                wanted.placement.scale = part.scale;
                wanted.placement.size = part.size;
            }
            wanted.placement.lay |= part.lay;
            match part.rotate {
                None => {}
                Some(Angles::All(angles)) => wanted.placement.rotate = angles,
                Some(Angles::Z(z)) => wanted.placement.rotate = [0.0, 0.0, z],
            }
            all.push(wanted);
        }
        let name = keywords.name.clone();
        let name = name.unwrap_or_else(|| Plate::name_of(&all));
        keywords.request(Given::Plate(all), Some(name), settings, warnings)
    }

    fn of_file(path: &Path, keywords: &Keywords<'_>) -> PyResult<Request> {
        if keywords.places() {
            return Err(PyTypeError::new_err(format!(
                "{} is a plate file, which tells itself of parameters and \
                 places; write them there, and leave out params, name, height, \
                 bounds and what places a model",
                path.display()
            )));
        }
        let (builder, sets) = keywords.builder()?;
        let (_, mut warnings) = finish(&builder)?;
        let file =
            PlateFile::read(path, builder, &sets).map_err(plain_error)?;
        for warning in &file.warnings {
            if !warnings.contains(warning) {
                warnings.push(warning.clone());
            }
        }
        let name = path.file_stem().unwrap_or_default();
        let name = name.to_string_lossy().into_owned();
        let settings = file.builder.settings().clone();
        let given = Given::Plate(file.parts);
        let mut request =
            keywords.request(given, Some(name), settings, warnings)?;
        request.inputs.push(path.to_owned());
        Ok(request)
    }

    /// The files that are read. No output may be one of them.
    pub(crate) fn inputs(&self) -> Vec<&Path> {
        self.inputs.iter().map(|p| &**p).collect()
    }

    /// The model on the printer. This may take long.
    pub(crate) fn model(&self) -> anyhow::Result<Model> {
        match &self.given {
            Given::One(wanted) => {
                let loaded = loaded(&wanted.source, &wanted.defines)?;
                let volume = BuildVolume::of(&self.settings);
                Ok(model::place(&loaded, &wanted.placement, volume)?)
            }
            Given::Plate(_) => {
                bail!("this is a plate, and a model is wanted")
            }
        }
    }

    /// All that is to be printed, where it stands. This may take long.
    pub(crate) fn plate(&self) -> anyhow::Result<Plate> {
        let name = self.name.as_deref().unwrap_or_default();
        let all = match &self.given {
            Given::One(_) => {
                return Ok(Plate::of(&self.model()?, &self.settings));
            }
            Given::Plate(all) => all,
        };
        Ok(Plate::new(name, all, &self.settings)?)
    }
}

/// True for the name of a plate file.
fn is_plate(path: &Path) -> bool {
    let extension = path.extension();
    extension.is_some_and(|e| e.eq_ignore_ascii_case("toml"))
}

fn plain_error(error: impl Into<anyhow::Error>) -> PyErr {
    crate::error::exception(&error.into())
}

/// What results keep of the settings.
pub(crate) struct Kept {
    /// The settings' texts, by name.
    pub texts: BTreeMap<String, String>,
    /// Notes on what the settings lead to unasked.
    pub notes: Vec<String>,
    /// Price of a kilogram of filament; none if there is none.
    pub filament_cost: Option<f64>,
}

impl Kept {
    pub(crate) fn of(Request { settings, .. }: &Request) -> Kept {
        let all = keys().iter();
        let cost = settings.filament_cost();
        Kept {
            texts: all.map(|k| (k.name.to_owned(), k.get(settings))).collect(),
            notes: settings.notes(),
            filament_cost: (cost > 0.0).then_some(cost),
        }
    }
}

/// The settings that texts by name stand for.
pub(crate) fn settings_of(
    texts: &BTreeMap<String, String>,
) -> PyResult<Builder> {
    let mut builder = Builder::new();
    for (name, text) in texts {
        let set = builder.set(&format!("{name}={text}"));
        set.map_err(plain_error)?;
    }
    Ok(builder)
}

/// The settings, and what the user should know of them.
fn finish(builder: &Builder) -> PyResult<(Settings, Vec<String>)> {
    builder.clone().finish().map_err(plain_error)
}

fn both(first: bool, second: bool, names: &str) -> PyResult<()> {
    if first && second {
        return Err(PyTypeError::new_err(format!(
            "{names} cannot be given together; drop one of them"
        )));
    }
    Ok(())
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
    /// The settings that the keywords name, and those among them that are no
    /// profiles' and no files'.
    fn builder(&self) -> PyResult<(Builder, Vec<String>)> {
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
            Ok(builder)
        };
        let builder = gather().map_err(plain_error)?;
        Ok((builder, given))
    }

    /// A model, with parameters of its script. `name` is for one that is no
    /// file.
    fn wanted(
        &self,
        model: &Bound<'_, PyAny>,
        name: Option<String>,
        params: Option<&Bound<'_, PyDict>>,
        settings: &Settings,
    ) -> PyResult<Wanted> {
        let defines = parameters(params)?;
        let source = match expr(model)? {
            Some(expr) if defines.is_empty() => {
                let expr = expr.get();
                let name = name.or(expr.name.clone());
                Source::Field {
                    name: name.unwrap_or_else(|| FORMULA.to_owned()),
                    tree: expr.tree.clone(),
                    parameters: expr.parameters.clone(),
                }
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
                if name.is_some() {
                    return Err(PyTypeError::new_err(
                        "name is for models that are no files",
                    ));
                }
                Source::File(path)
            }
        };
        Ok(Wanted {
            asked: source.to_string(),
            source,
            defines,
            placement: self.placement(settings)?,
            settings: settings.clone(),
            at: None,
            copies: 1,
        })
    }

    /// A request for what is given.
    fn request(
        &self,
        given: Given,
        name: Option<String>,
        settings: Settings,
        warnings: Vec<String>,
    ) -> PyResult<Request> {
        let wanted = match &given {
            Given::One(wanted) => std::slice::from_ref(&**wanted),
            Given::Plate(all) => all,
        };
        let models = wanted.iter().filter_map(|one| match &one.source {
            Source::File(path) => Some(path.clone()),
            Source::Text { .. } | Source::Field { .. } => None,
        });
        Ok(Request {
            name,
            warnings,
            inputs: models.chain(self.files().iter().cloned()).collect(),
            threads: self.threads()?,
            limits: self.limits()?,
            settings,
            given,
        })
    }

    /// True if a keyword says which model it is, or where or how it stands.
    fn places(&self) -> bool {
        self.params.is_some()
            || self.name.is_some()
            || self.size.is_some()
            || self.scale.is_some()
            || self.height.is_some()
            || self.lay
            || self.rotate.is_some()
            || self.at.is_some()
            || self.keep_position
            || self.bounds.is_some()
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
        both(self.size.is_some(), self.scale.is_some(), "size and scale")?;
        let fixed = self.keep_position;
        both(self.at.is_some(), fixed, "at and keep_position")?;
        Ok(Placement {
            scale: self.scale,
            size: self.size,
            lay: self.lay,
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
            let time = limit("time_limit", seconds)?
                .map(Duration::try_from_secs_f64)
                .transpose()
                .map_err(|_| not_positive("time_limit", seconds))?;
            limits = limits.within(time);
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
    Bounds::new(DVec3::from_array(min), DVec3::from_array(max))
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
