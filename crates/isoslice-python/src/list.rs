//! What there is to choose from: settings and profiles.

use crate::error::plain;
use crate::request::folder;
use crate::value::from_json;
use isoslice::settings::{Origin, ProfileKind, keys};
use pyo3::prelude::*;
use serde_json::{Value, json};
use std::path::PathBuf;

/// All settings, each with its name, its default as TOML has it, what it takes
/// and what it is.
#[pyfunction]
pub(crate) fn settings(py: Python<'_>) -> PyResult<Bound<'_, PyAny>> {
    let all = keys().iter().map(|key| {
        json!({
            "name": key.name,
            "default": key.default(),
            "allowed": key.allowed(),
            "description": key.description(),
        })
    });
    from_json(py, &Value::Array(all.collect()))
}

/// All printers, filaments and presets.
#[pyfunction]
#[pyo3(signature = (folder_name = None))]
pub(crate) fn profiles(
    py: Python<'_>,
    folder_name: Option<PathBuf>,
) -> PyResult<Bound<'_, PyAny>> {
    let profiles = folder(folder_name).map_err(plain)?;
    let mut all = Vec::new();
    for kind in ProfileKind::ALL {
        let (found, wrong) = profiles.list(kind);
        if let Some(error) = wrong.into_iter().next() {
            return Err(plain(error));
        }
        all.extend(found.iter().map(|profile| {
            json!({
                "kind": kind.name(),
                "name": profile.name,
                "description": profile.description,
                "file": match &profile.origin {
                    Origin::Shipped => None,
                    Origin::File(path) => Some(path.display().to_string()),
                },
            })
        }));
    }
    from_json(py, &Value::Array(all))
}
