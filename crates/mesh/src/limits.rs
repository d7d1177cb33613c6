//! Limits on what is read.

/// Greatest number of triangles. They take 4 GB, and far more are scans that
/// somebody forgot to reduce.
pub const MOST_TRIANGLES: usize = 50_000_000;

/// Greatest number of struts. They take 1 GB, and lattices of printers have some
/// hundred thousand.
pub const MOST_STRUTS: usize = 10_000_000;

/// Greatest distance of a vertex from the origin along an axis, mm. Products of
/// four such lengths, as squares of areas are, have a place in f32.
pub(crate) const FARTHEST: f64 = 1e8;
