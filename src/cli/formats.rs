//! The format of a file by its name, or of standard output.

use super::output::is_stream;
use isoslice::Format;
use std::path::Path;

/// True if a file of this name is a plate for Bambu Lab's printers.
pub(super) fn is_sliced_plate(path: &Path) -> bool {
    Format::of_name(path) == Ok(Format::Plate)
}

/// The format of a file of this name.
///
/// # Errors
/// If the name promises something that is not G-code.
pub(super) fn format_of(path: &Path) -> anyhow::Result<Format> {
    if is_stream(path) {
        return Ok(Format::Text);
    }
    Ok(Format::of_name(path)?)
}
