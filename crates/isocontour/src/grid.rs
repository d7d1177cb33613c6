//! Parallel lines of samples.

use glam::DVec3;

/// Samples in front of a viewer: columns, rows, and along each line of sight
/// towards the viewer.
#[derive(Clone, Copy, Debug)]
pub struct Grid {
    /// The first sample of the first column and row: the farthest one.
    pub origin: DVec3,
    /// The steps from one column, row or sample to the next.
    pub steps: [DVec3; 3],
    /// Number of columns, of rows, and of samples along a line.
    pub size: [usize; 3],
}
