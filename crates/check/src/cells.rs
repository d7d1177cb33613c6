//! Cells of the plane, and sets of them.

use glam::{DVec2, IVec2};
use isoslice_base::units::Mm;
use std::collections::BTreeMap;

/// Size of a cell, about a line's width: neighbouring lines are in neighbouring
/// cells.
pub(super) const CELL: Mm = 0.5;

/// Cells along one side of a tile.
pub(super) const SIDE: i32 = 32;

/// Number of cells on the negative side, beyond which no bead reaches.
const BELOW: i32 = 1 << 12;

/// Where a tile is, in tiles.
pub(super) type Place = (i32, i32);

/// The cell of a point.
pub(super) fn cell_of(p: DVec2) -> IVec2 {
    // This rounds down as the slower `floor()` does, since no bead is that far
    // below zero.
    (p / CELL + f64::from(BELOW)).as_ivec2() - BELOW
}

/// The cell and its eight neighbours.
pub(super) fn around(cell: IVec2) -> impl Iterator<Item = IVec2> {
    (-1..=1).flat_map(move |y| (-1..=1).map(move |x| cell + IVec2::new(x, y)))
}

/// The tile of a cell, and the cell's row and column there.
pub(super) fn split(cell: IVec2) -> (Place, usize, usize) {
    let tile = (cell.x.div_euclid(SIDE), cell.y.div_euclid(SIDE));
    let within = |k: i32| k.rem_euclid(SIDE) as usize;
    (tile, within(cell.y), within(cell.x))
}

/// A bit for each cell of a tile, by rows.
#[derive(Clone, Copy, Default)]
pub(super) struct Bits([u32; SIDE as usize]);

impl Bits {
    pub(super) fn has(&self, row: usize, column: usize) -> bool {
        self.0[row] & 1 << column != 0
    }

    /// Marks a cell; true if it was not marked before.
    pub(super) fn mark(&mut self, row: usize, column: usize) -> bool {
        let new = !self.has(row, column);
        self.0[row] |= 1 << column;
        new
    }

    /// The cells that are marked here and not in `others`.
    pub(super) fn without(&self, others: &Bits) -> Bits {
        Bits(std::array::from_fn(|row| self.0[row] & !others.0[row]))
    }

    /// Number of marked cells.
    pub(super) fn count(&self) -> u32 {
        self.0.iter().map(|row| row.count_ones()).sum()
    }

    pub(super) fn is_empty(&self) -> bool {
        self.0.iter().all(|row| *row == 0)
    }

    /// The marked cells of the tile at a place, row by row.
    pub(super) fn cells(
        &self,
        (x, y): Place,
    ) -> impl Iterator<Item = IVec2> + use<> {
        let rows = (0..SIDE).zip(self.0).filter(|(_, word)| *word != 0);
        rows.flat_map(move |(row, word)| {
            let marked = (0..SIDE).filter(move |k| word & (1 << k) != 0);
            marked.map(move |k| IVec2::new(x * SIDE + k, y * SIDE + row))
        })
    }
}

/// A set of cells.
#[derive(Default)]
pub(super) struct Cells {
    tiles: BTreeMap<Place, Bits>,
}

impl Cells {
    /// Marks a cell; true if it was not marked before.
    pub(super) fn mark(&mut self, cell: IVec2) -> bool {
        let (tile, row, column) = split(cell);
        self.tiles.entry(tile).or_default().mark(row, column)
    }

    pub(super) fn has(&self, cell: IVec2) -> bool {
        let (tile, row, column) = split(cell);
        let bits = self.tiles.get(&tile);
        bits.is_some_and(|bits| bits.has(row, column))
    }

    /// All marked cells, tile by tile.
    pub(super) fn all(&self) -> impl Iterator<Item = IVec2> + '_ {
        self.tiles
            .iter()
            .flat_map(|(place, bits)| bits.cells(*place))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_are_found_on_both_sides_of_zero() {
        let mut cells = Cells::default();
        let marked = [(-33, 5), (-1, -1), (0, 0), (31, 32), (32, 31)];
        for (x, y) in marked {
            assert!(cells.mark(IVec2::new(x, y)));
            assert!(!cells.mark(IVec2::new(x, y)));
        }
        let mut all: Vec<(i32, i32)> =
            cells.all().map(|cell| (cell.x, cell.y)).collect();
        all.sort_unstable();
        assert_eq!(all, marked);
        assert!(!cells.has(IVec2::new(-33, -27)));
        let cell = cell_of(DVec2::new(-0.1, 0.6));
        assert_eq!(cell, IVec2::new(-1, 1));
    }
}
