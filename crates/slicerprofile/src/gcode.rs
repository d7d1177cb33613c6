//! The configuration that slicers leave in their G-code: `; key = value`.
//!
//! PrusaSlicer writes it at the end. OrcaSlicer writes it at the end, or at the
//! beginning as Bambu Studio does. Only the ends of a file are read.

use crate::ini;
use crate::values::Values;

/// Bytes at the beginning and at the end of a file that are read.
pub(crate) const EACH_END: u64 = 4 << 20;
/// Least number of keys of a configuration. A file of another kind has fewer.
const FEWEST: usize = 10;

/// The configuration in a G-code's text; none if there is no configuration.
pub(crate) fn read(text: &str) -> Option<Values> {
    let mut values = Values::default();
    for line in text.lines() {
        let Some(line) = line.strip_prefix("; ") else {
            continue;
        };
        let Some((key, value)) = line.split_once('=') else {
            continue;
        };
        let key = key.trim();
        let word =
            |c: char| c.is_ascii_lowercase() || c == '_' || c.is_numeric();
        if !key.is_empty() && key.chars().all(word) {
            values.set(key, ini::items(value.trim()));
        }
    }
    (values.len() >= FEWEST).then_some(values)
}
