//! Slicing, and its results as an object.

use crate::error::{Error, plain};
use crate::output::{Output, Written};
use crate::request::{
    Kept, Keywords, PartGiven, Request, format, format_of, layers, settings_of,
};
use crate::value::from_json;
use crate::work::{Progress, at_work};
use anyhow::Context;
use isoslice::limits::Limits;
use isoslice::pipeline::{self, Options, Summary};
use isoslice::preview::Toolpath;
use isoslice::reader::Reader;
use isoslice::{Format, human_time};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs::File;
use std::io::{Cursor, Read};
use std::path::{Path, PathBuf};

/// The results of a run: the G-code, how long it prints, what it takes, and how
/// accurate it is.
#[pyclass(frozen, module = "isoslice")]
#[derive(Serialize, Deserialize)]
pub(crate) struct Sliced {
    /// Name of the model.
    #[pyo3(get)]
    name: String,
    /// Extent of the part along x, y and z, mm.
    #[pyo3(get)]
    size: (f64, f64, f64),
    /// Number of the part's layers.
    #[pyo3(get)]
    layer_count: usize,
    /// First and last layer that were written, from 1.
    #[pyo3(get)]
    layers: (usize, usize),
    /// Number of the lowest layers that are a raft's.
    #[pyo3(get)]
    raft_layers: usize,
    /// Estimated print time, s, without heating and homing.
    #[pyo3(get)]
    time: f64,
    /// Filament used, mm.
    #[pyo3(get)]
    filament_length: f64,
    /// Filament used, g.
    #[pyo3(get)]
    filament_mass: f64,
    /// Price of the filament, if filament.cost is set, else None.
    #[pyo3(get)]
    filament_cost: Option<f64>,
    /// Filament used for supports, mm.
    #[pyo3(get)]
    support_length: f64,
    /// Area of gaps between walls that nothing fills, mm², all layers together.
    #[pyo3(get)]
    unfilled_area: f64,
    /// Area of all layers' outlines together, mm².
    #[pyo3(get)]
    solid_area: f64,
    /// Number of moves that print.
    #[pyo3(get)]
    printing_moves: usize,
    /// Number of moves that are slower than asked for, because the printer
    /// takes only so many in a second.
    #[pyo3(get)]
    slowed_moves: usize,
    /// Islands and holes left out because they are smaller than a quarter of
    /// the outer wall's width.
    #[pyo3(get)]
    dropped_rings: usize,
    /// True if the G-code was checked, and found safe for the printer.
    #[pyo3(get)]
    checked: bool,
    /// Warnings, in sentences.
    #[pyo3(get)]
    warnings: Vec<String>,
    /// Notes on what the settings lead to unasked, in sentences.
    #[pyo3(get)]
    notes: Vec<String>,
    /// What the beads of each role amount to, by the role's name: length_mm,
    /// filament_mm, time_s.
    #[pyo3(get)]
    roles: Table,
    /// Distance of the outlines from f = 0, µm: points (how many were
    /// measured), min, mean and max with their signs, p50, p95 and p99 of the
    /// size. None if there are no outlines.
    #[pyo3(get)]
    outline_error: Table,
    /// Distance of the outer beads' edges from the outline, µm, as
    /// outline_error has it.
    #[pyo3(get)]
    wall_error: Table,
    /// All that was measured (docs/accuracy.md), if report was asked for, else
    /// None.
    #[pyo3(get)]
    report: Table,
    /// What nothing holds while it is printed, by kind; the keys are those of
    /// the command line's --json.
    #[pyo3(get)]
    hanging: Table,
    /// Time that the print takes longer than at the speeds asked for, s, by its
    /// cause: cooling, flow of the hot end, moves that the printer takes, and
    /// acceleration. Where several causes slow a bead, the strongest one counts.
    #[pyo3(get)]
    time_lost: Table,
    /// Processor time by stage, s, added up over all threads.
    #[pyo3(get)]
    timings: Table,
    /// The settings that were used, by name, as TOML has them.
    #[pyo3(get)]
    settings: BTreeMap<String, String>,
    #[serde(skip, default = "Gcode::nowhere")]
    gcode: Gcode,
}

/// Where the G-code is.
enum Gcode {
    Bytes(Py<PyBytes>),
    File(PathBuf),
    /// The file went through a pipe, from which it cannot be read again.
    Stream(PathBuf),
}

impl Gcode {
    /// No bytes, until others take their place.
    fn nowhere() -> Gcode {
        Gcode::Stream(PathBuf::new())
    }
}

/// Slices a model, or the parts of a plate, to a file, or to bytes.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "Python has names for them")]
pub(crate) fn slice<'py>(
    py: Python<'py>,
    model: Option<Bound<'py, PyAny>>,
    parts: Vec<PartGiven<'py>>,
    output: Option<PathBuf>,
    layer_range: Option<Bound<'py, PyAny>>,
    format_name: Option<String>,
    report: bool,
    check: bool,
    svg: Option<PathBuf>,
    keywords: Keywords<'py>,
) -> PyResult<Sliced> {
    let range = layers(layer_range.as_ref())?;
    let request = match &model {
        Some(model) => Request::new(model, &keywords)?,
        None => Request::of_parts(parts, &keywords)?,
    };
    let format = match (&output, format_name) {
        (Some(_), Some(_)) => {
            return Err(PyValueError::new_err(
                "format is for bytes; the name of a file says its format",
            ));
        }
        (Some(path), None) => format_of(path)?,
        (None, Some(name)) => format(&name)?,
        // Plates hold whole prints.
        (None, None) if layer_range.is_some() => Format::Text,
        (None, None) => Format::usual_for(request.settings.gcode.flavour),
    };
    let limits = request.limits;
    let kept = Kept::of(&request);
    let unusual = format.unusual_for(request.settings.gcode.flavour);
    let mut warnings = request.warnings.clone();
    let progress = keywords.progress.as_ref();
    let work = move |progress: &Progress| {
        let mut output = Output::create(output, &request.inputs())?;
        let plate = request.plate()?;
        if let Some(folder) = &svg {
            std::fs::create_dir_all(folder).with_context(|| {
                format!("cannot make the folder {}", folder.display())
            })?;
        }
        let options = Options {
            threads: request.threads,
            layers: range,
            glimpse: None,
            svg_dir: svg.as_deref(),
            report,
            check,
            timestamp: None,
            format,
            on_layer: &|done, all| progress.tell(done, all),
        };
        let summary = pipeline::slice_plate(&plate, &options, &mut output)
            .with_context(|| format!("cannot slice {}", plate.name))?;
        let of_models = plate.warnings();
        Ok((plate.name, of_models, summary, output.finish()?))
    };
    let (name, of_model, summary, written) =
        at_work(py, limits, progress, work)?;
    warnings.extend(of_model);
    warnings.extend(summary.warnings.iter().cloned());
    warnings.extend(unusual);
    let gcode = match written {
        Written::Bytes(bytes) => {
            Gcode::Bytes(PyBytes::new(py, &bytes).unbind())
        }
        Written::File(path) => Gcode::File(path),
        Written::Stream(path) => Gcode::Stream(path),
    };
    Sliced::new(name, summary, kept, warnings, gcode)
}

impl Sliced {
    fn new(
        name: String,
        summary: Summary,
        kept: Kept,
        warnings: Vec<String>,
        gcode: Gcode,
    ) -> PyResult<Sliced> {
        let timings = summary.timings.iter();
        let timings: BTreeMap<_, _> =
            timings.map(|(stage, s)| (stage.name(), s)).collect();
        Ok(Sliced {
            name,
            size: summary.size.into(),
            layer_count: summary.layer_count,
            layers: (summary.layers.start + 1, summary.layers.end),
            raft_layers: summary.raft_layers,
            time: summary.time,
            filament_length: summary.filament_length,
            filament_mass: summary.filament_mass_g,
            filament_cost: kept
                .filament_cost
                .map(|cost| summary.filament_mass_g * cost / 1000.0),
            support_length: summary.support_length,
            unfilled_area: summary.unfilled_area,
            solid_area: summary.solid_area,
            printing_moves: summary.printing_moves,
            slowed_moves: summary.slowed_moves,
            dropped_rings: summary.dropped_rings,
            checked: summary.verdict.is_some(),
            warnings,
            notes: kept.notes,
            roles: Table::of(&summary.roles)?,
            outline_error: Table::of(&summary.outline_error)?,
            wall_error: Table::of(&summary.wall_error)?,
            report: Table::of(&summary.report)?,
            hanging: Table::of(&summary.hanging)?,
            time_lost: Table::of(&summary.time_lost)?,
            timings: Table::of(&timings)?,
            settings: kept.texts,
            gcode,
        })
    }

    /// Name of the G-code's file, for titles.
    fn title(&self) -> String {
        match &self.gcode {
            Gcode::File(path) | Gcode::Stream(path) => {
                let name = path.file_name().unwrap_or_default();
                name.to_string_lossy().into_owned()
            }
            Gcode::Bytes(_) => self.name.clone(),
        }
    }
}

#[pymethods]
impl Sliced {
    /// The G-code, as bytes. If it was written to a file, that is read.
    #[getter]
    fn gcode<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        match &self.gcode {
            Gcode::Stream(path) => Err(went(path)),
            Gcode::Bytes(bytes) => Ok(bytes.bind(py).clone()),
            Gcode::File(path) => {
                let read = py.detach(|| std::fs::read(path));
                let read = read
                    .with_context(|| format!("cannot read {}", path.display()));
                let read = read.map_err(|e| crate::error::exception(&e))?;
                Ok(PyBytes::new(py, &read))
            }
        }
    }

    /// The file that the G-code was written to, or None.
    #[getter]
    fn path(&self) -> Option<&PathBuf> {
        match &self.gcode {
            Gcode::File(path) | Gcode::Stream(path) => Some(path),
            Gcode::Bytes(_) => None,
        }
    }

    /// What pickle writes: how the results are made again. G-code that is in a
    /// file stays there, and only its name is written.
    fn __reduce__<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<(Bound<'py, PyAny>, Pickled)> {
        let again =
            py.import("isoslice._native")?.getattr("unpickled_sliced")?;
        let own = serde_json::to_string(self).map_err(plain)?;
        let (bytes, path, stream) = match &self.gcode {
            Gcode::Bytes(bytes) => (Some(bytes.clone_ref(py)), None, false),
            Gcode::File(path) => (None, Some(path.clone()), false),
            Gcode::Stream(path) => (None, Some(path.clone()), true),
        };
        Ok((again, (own, bytes, path, stream)))
    }

    /// The page of `isoslice preview`, as text: one HTML file that needs
    /// nothing else.
    fn preview_html(&self, py: Python<'_>) -> PyResult<String> {
        let gcode: Box<dyn Read + Send> = match &self.gcode {
            Gcode::Stream(path) => return Err(went(path)),
            Gcode::Bytes(bytes) => {
                Box::new(Cursor::new(bytes.as_bytes(py).to_vec()))
            }
            Gcode::File(path) => {
                let file = File::open(path)
                    .with_context(|| format!("cannot read {}", path.display()));
                Box::new(file.map_err(|e| crate::error::exception(&e))?)
            }
        };
        let title = self.title();
        let settings = settings_of(&self.settings)?;
        let warnings = self.warnings.clone();
        let page = at_work(py, Limits::of_slicing(), None, move |_| {
            let toolpath = Toolpath::read(Reader::new(gcode))?;
            let problems = toolpath.problems().warnings(&title);
            let toolpath = toolpath
                .with_settings(settings.settings())
                .with_warnings(&[warnings, problems].concat());
            let mut page = Vec::new();
            toolpath.write_html(&mut page, &title)?;
            Ok(page)
        })?;
        String::from_utf8(page)
            .map_err(|e| PyValueError::new_err(e.to_string()))
    }

    fn __repr__(&self) -> String {
        format!(
            "Sliced({:?}: {:.1} × {:.1} × {:.1} mm, {} layers, {}, {:.2} m of \
             filament)",
            self.title(),
            self.size.0,
            self.size.1,
            self.size.2,
            self.layer_count,
            human_time(self.time),
            self.filament_length / 1000.0
        )
    }
}

/// The error for G-code that is nowhere any more.
fn went(path: &Path) -> PyErr {
    Error::new_err(format!(
        "the G-code went into {}, which is no file, and cannot be read again",
        path.display()
    ))
}

/// Results that are not a single number, which Python gets in its own types.
#[derive(Serialize, Deserialize)]
struct Table(Value);

impl Table {
    fn of(results: &impl Serialize) -> PyResult<Table> {
        Ok(Table(serde_json::to_value(results).map_err(plain)?))
    }
}

impl<'py> IntoPyObject<'py> for &Table {
    type Target = PyAny;
    type Output = Bound<'py, PyAny>;
    type Error = PyErr;

    fn into_pyobject(self, py: Python<'py>) -> PyResult<Self::Output> {
        from_json(py, &self.0)
    }
}

/// Results as pickle has them: all but the G-code as JSON, then its bytes or
/// its file, and whether that is a stream.
type Pickled = (String, Option<Py<PyBytes>>, Option<PathBuf>, bool);

/// Results that pickle has read.
#[pyfunction]
pub(crate) fn unpickled_sliced(
    own: &str,
    bytes: Option<Py<PyBytes>>,
    path: Option<PathBuf>,
    stream: bool,
) -> PyResult<Sliced> {
    let read: Sliced = serde_json::from_str(own).map_err(plain)?;
    let gcode = match (bytes, path) {
        (Some(bytes), _) => Gcode::Bytes(bytes),
        (None, Some(path)) if stream => Gcode::Stream(path),
        (None, Some(path)) => Gcode::File(path),
        (None, None) => Gcode::nowhere(),
    };
    Ok(Sliced { gcode, ..read })
}
