//! Fields as 3MF files whose shape is a function.

use crate::output::{Output, Written};
use crate::request::{FORMULA, loaded};
use crate::value::Expr;
use crate::work::at_work;
use anyhow::Context;
use isoslice::limits::Limits;
use isoslice::model::{BuildVolume, Placement, Source, place};
use pyo3::prelude::*;
use std::io::Write;
use std::path::PathBuf;

/// Writes a field to a file. Without a name the file's bytes are the result.
pub(crate) fn to_3mf(
    py: Python<'_>,
    field: &Expr,
    output: Option<PathBuf>,
) -> PyResult<Option<Vec<u8>>> {
    let name = field.name.clone();
    let source = Source::Field {
        name: name.unwrap_or_else(|| FORMULA.to_owned()),
        tree: field.tree.clone(),
        parameters: Vec::new(),
    };
    at_work(py, Limits::of_slicing(), None, move |_| {
        let mut output = Output::create(output, &[])?;
        output.write_all(&archive(&source)?)?;
        Ok(match output.finish()? {
            Written::Bytes(bytes) => Some(bytes),
            Written::File(_) | Written::Stream(_) => None,
        })
    })
}

fn archive(source: &Source) -> anyhow::Result<Vec<u8>> {
    let loaded = loaded(source, &[])?;
    let model = place(&loaded, &Placement::default(), BuildVolume::ANY)?;
    let bytes = model.to_3mf();
    bytes.with_context(|| format!("cannot export {}", model.name))
}
