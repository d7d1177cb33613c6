//! The configuration that slicers leave in their G-code: `; key = value`.
//!
//! PrusaSlicer writes it at the end, OrcaSlicer at the end or, as Bambu
//! Studio, at the beginning. Only the ends of a file are looked at.

use crate::ini;
use crate::values::Values;

/// Bytes at the beginning and at the end of a file that are looked at.
pub(crate) const EACH_END: u64 = 4 << 20;
/// Fewest keys of a configuration: a file of anything else has fewer.
const FEWEST: usize = 10;

/// The configuration in a G-code's text; nothing if there is none.
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
