//! The output of a command: a file, which is complete or not there at all, or
//! standard output.

use super::closed;
use isoslice::files::Output;
use std::io::{Write, stdout};
use std::path::Path;

/// True if `path` stands for standard input or output.
pub(super) fn is_stream(path: &Path) -> bool {
    path.as_os_str() == "-"
}

/// Starts writing to `path`, which must not be one of the `inputs`; `-` is
/// standard output.
pub(super) fn create(path: &Path, inputs: &[&Path]) -> anyhow::Result<Output> {
    if is_stream(path) || closed::is_output(path) {
        closed::need_output()?;
    }
    if is_stream(path) {
        return Ok(Output::stream(path, stdout()));
    }
    Ok(Output::create(path, inputs)?)
}

/// Writes a command's result to standard output.
///
/// # Errors
/// If standard output is closed, or does not take all of the result.
pub(super) fn print(result: &[u8]) -> anyhow::Result<()> {
    closed::need_output()?;
    let mut out = stdout().lock();
    out.write_all(result)?;
    Ok(out.flush()?)
}
