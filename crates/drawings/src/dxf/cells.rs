//! Cells of a square grid, in which what is near a place is found.

use glam::DVec2;

pub(super) type Cell = [i64; 2];

/// The cell of a grid in which a place is.
pub(super) fn cell(p: DVec2, size: f64) -> Cell {
    (p / size).floor().to_array().map(|v| v as i64)
}

/// A cell and those around it.
pub(super) fn around([x, y]: Cell) -> impl Iterator<Item = Cell> {
    (-1..=1).flat_map(move |i| (-1..=1).map(move |j| [x + i, y + j]))
}
