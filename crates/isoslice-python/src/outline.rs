//! Outlines of layers.
//!
//! In: a field, or a model on the printer, and heights. Out: for each height
//! the islands, each as closed rings, first the outer one and then those of its
//! holes: numbers in native byte order, x and y in turn. Python makes lists or
//! arrays of them.

use crate::request::{Keywords, Request, bounds};
use crate::value::Field as Given;
use crate::work::at_work;
use anyhow::Context;
use fidget::context::Tree;
use isocontour::{
    Area, Bounds, Detail, Field, Ring, SLAB, SearchOptions, find_bounds,
    outlines as find_outlines,
};
use isoslice::limits::{Limits, Watch, doing};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyBytes;

/// The rings of each height's islands.
type Bytes<'py> = Vec<Vec<Vec<Bound<'py, PyBytes>>>>;

/// Outlines of a field in its own coordinates.
#[pyfunction]
pub(crate) fn rings<'py>(
    py: Python<'py>,
    of: Given,
    z: Vec<f64>,
    accuracy: f64,
    spacing: f64,
    within: Option<[[f64; 3]; 2]>,
) -> PyResult<Bytes<'py>> {
    positive("accuracy", accuracy)?;
    positive("spacing", spacing)?;
    heights(&z)?;
    let within = within.map(bounds);
    let detail = Detail {
        accuracy,
        smallest: spacing,
    };
    let found = at_work(py, Limits::of_slicing(), None, move |_| {
        let options = SearchOptions {
            within,
            ..SearchOptions::default()
        };
        let found = find_bounds(&of.0, &options, &Watch::hook());
        let found = doing("bounds", || found)?.bounds;
        look(&of.0, &found, spacing, &z, detail)
    })?;
    Ok(as_bytes(py, &found))
}

/// Outlines of a model as it is printed: in the printer's coordinates, by the
/// settings.
#[pyfunction]
pub(crate) fn outlines<'py>(
    model: &Bound<'py, PyAny>,
    z: Vec<f64>,
    keywords: Keywords<'py>,
) -> PyResult<Bytes<'py>> {
    let py = model.py();
    heights(&z)?;
    let request = Request::new(model, &keywords)?;
    let limits = request.limits;
    let progress = keywords.progress.as_ref();
    let found = at_work(py, limits, progress, move |_| {
        let model = request.model()?;
        let detail = Detail {
            accuracy: request.length("accuracy")?,
            // What is smaller cannot be printed.
            smallest: 0.25 * request.length("outer_wall_width")?,
        };
        let spacing = request.settings.lattice_spacing();
        // Below the bed nothing is printed.
        let above = |z: &f64| *z >= 0.0;
        let at: Vec<f64> = z.iter().map(|z| z - model.offset.z).collect();
        let mut found = look(&model.tree, &model.bounds, spacing, &at, detail)
            .with_context(|| format!("cannot slice {}", model.name))?;
        for (z, area) in z.iter().zip(&mut found) {
            if !above(z) {
                area.rings.clear();
            }
            for point in area.rings.iter_mut().flatten() {
                *point += model.offset.truncate();
            }
        }
        Ok(found)
    })?;
    Ok(as_bytes(py, &found))
}

/// The outlines at heights in any order.
fn look(
    tree: &Tree,
    bounds: &Bounds,
    spacing: f64,
    z: &[f64],
    detail: Detail,
) -> anyhow::Result<Vec<Area>> {
    let rect = bounds.from_above();
    let field =
        Field::new(tree, 0.0, rect, spacing)?.with_cancel(Watch::hook());
    let mut order: Vec<usize> = (0..z.len()).collect();
    order.sort_by(|a, b| z[*a].total_cmp(&z[*b]));
    let mut all = vec![Area::EMPTY; z.len()];
    for slab in order.chunks(SLAB) {
        let heights: Vec<f64> = slab.iter().map(|i| z[*i]).collect();
        let found = find_outlines(&field, &heights, detail);
        // Work that was stopped ends here.
        let found = doing("contour", || found)?;
        for (i, outline) in slab.iter().zip(found) {
            all[*i] = outline.area;
        }
    }
    Ok(all)
}

fn as_bytes<'py>(py: Python<'py>, areas: &[Area]) -> Bytes<'py> {
    let one = |ring: &Ring| {
        let numbers = ring.iter().flat_map(|p| [p.x, p.y]);
        let bytes: Vec<u8> = numbers.flat_map(f64::to_ne_bytes).collect();
        PyBytes::new(py, &bytes)
    };
    let rings = |area: &Area| area.rings.iter().map(one).collect();
    let islands = |area: &Area| area.islands().iter().map(rings).collect();
    areas.iter().map(islands).collect()
}

fn positive(name: &str, value: f64) -> PyResult<()> {
    if value > 0.0 && value.is_finite() {
        return Ok(());
    }
    Err(PyValueError::new_err(format!(
        "{name} = {value}: use a number of more than 0, in mm"
    )))
}

fn heights(z: &[f64]) -> PyResult<()> {
    match z.iter().find(|z| !z.is_finite()) {
        None => Ok(()),
        Some(z) => Err(PyValueError::new_err(format!(
            "z = {z}: use a height in mm"
        ))),
    }
}
