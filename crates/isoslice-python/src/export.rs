//! Fields as 3MF files whose shape is a function.

use crate::output::{Output, Written};
use crate::request::{FORMULA, loaded};
use crate::value::{Expr, files_of};
use crate::work::at_work;
use anyhow::Context;
use isoslice::limits::Limits;
use isoslice::model::{BuildVolume, Placement, Source, place};
use pyo3::prelude::*;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Writes a field to a file. Without a name the file's bytes are the result.
/// Warnings are beside them.
pub(crate) fn to_3mf(
    py: Python<'_>,
    field: &Expr,
    output: Option<PathBuf>,
) -> PyResult<(Option<Vec<u8>>, Vec<String>)> {
    let name = field.name.clone();
    let source = Source::Field {
        name: name.unwrap_or_else(|| FORMULA.to_owned()),
        tree: field.tree.clone(),
        parameters: Vec::new(),
    };
    let inputs = files_of(field);
    at_work(py, Limits::of_slicing(), None, move |_| {
        let inputs: Vec<&Path> = inputs.iter().map(PathBuf::as_path).collect();
        let mut output = Output::create(output, &inputs)?;
        let (bytes, warnings) = archive(&source)?;
        output.write_all(&bytes)?;
        let bytes = match output.finish()? {
            Written::Bytes(bytes) => Some(bytes),
            Written::File(_) | Written::Stream(_) => None,
        };
        Ok((bytes, warnings))
    })
}

/// The bytes of an archive, and warnings of the model.
fn archive(source: &Source) -> anyhow::Result<(Vec<u8>, Vec<String>)> {
    let loaded = loaded(source, &[])?;
    let model = place(&loaded, &Placement::default(), BuildVolume::ANY)?;
    let bytes = model
        .to_3mf()
        .with_context(|| format!("cannot export {}", model.name))?;
    Ok((bytes, model.warnings))
}

/// Tells warnings as `slice` does, each once.
pub(crate) fn warn(py: Python<'_>, warnings: &[String]) -> PyResult<()> {
    if warnings.is_empty() {
        return Ok(());
    }
    let category = py.import("isoslice")?.getattr("SliceWarning")?;
    let module = py.import("warnings")?;
    for (i, text) in warnings.iter().enumerate() {
        if !warnings[..i].contains(text) {
            module.call_method1("warn", (text, &category))?;
        }
    }
    Ok(())
}
