//! Cells of the plane, and sets of them.

use glam::{DVec2, IVec2};
use isoslice_base::units::Mm;
use std::collections::HashMap;
use std::hash::{BuildHasherDefault, Hasher};

/// Size of a cell, about a line's width: neighbouring lines are in neighbouring
/// cells.
pub(super) const CELL: Mm = 0.5;

/// Cells along one side of a tile.
pub(super) const SIDE: i32 = 32;

/// Number of cells on the negative side, beyond which no bead reaches.
const BELOW: i32 = 1 << 12;

/// Where the borders of cells lie, in cells. Walls run along round numbers: along
/// such a border, a wall would be in one column in some layers, and in the next one
/// in others.
const ORIGIN: DVec2 = DVec2::new(0.274, 0.618);

/// Where a tile is, in tiles.
pub(super) type Place = (i32, i32);

/// What is known of tiles. Cells are asked for many times for each move, and a
/// tree takes four times as long as this to find a tile.
pub(super) type Tiles<T> = HashMap<Place, T, BuildHasherDefault<OfPlace>>;

/// The hash of a tile's place.
#[derive(Default)]
pub(super) struct OfPlace(u64);

impl Hasher for OfPlace {
    fn finish(&self) -> u64 {
        // Some of the highest bits tell entries apart, and the lowest ones where
        // they are. A product spreads upwards only.
        self.0.rotate_left(26)
    }

    fn write(&mut self, bytes: &[u8]) {
        bytes.iter().for_each(|&byte| self.write_i32(byte.into()));
    }

    fn write_i32(&mut self, n: i32) {
        let both = self.0.rotate_left(32) ^ u64::from(n as u32);
        // 2⁶⁴ over the golden section, an odd number.
        self.0 = both.wrapping_mul(0x9e37_79b9_7f4a_7c15);
    }
}

/// The cell of a point.
pub(super) fn cell_of(p: DVec2) -> IVec2 {
    // This rounds down as the slower `floor()` does, since no bead is that far
    // below zero.
    (p / CELL + ORIGIN + f64::from(BELOW)).as_ivec2() - BELOW
}

/// The middle of a cell.
pub(super) fn middle_of(cell: IVec2) -> DVec2 {
    (cell.as_dvec2() + 0.5 - ORIGIN) * CELL
}

/// The cell and its eight neighbours.
pub(super) fn around(cell: IVec2) -> impl Iterator<Item = IVec2> {
    (-1..=1).flat_map(move |y| (-1..=1).map(move |x| cell + IVec2::new(x, y)))
}

/// The tile of a cell, and the cell's row and column there.
pub(super) fn split(cell: IVec2) -> (Place, usize, usize) {
    // The side is a power of two, which a shift divides by as `div_euclid` does.
    let tile = cell >> SIDE.trailing_zeros();
    let within = cell & (SIDE - 1);
    ((tile.x, tile.y), within.y as usize, within.x as usize)
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

    /// The cells that are marked in both.
    pub(super) fn and(&self, others: &Bits) -> Bits {
        Bits(std::array::from_fn(|row| self.0[row] & others.0[row]))
    }

    /// The cells that are marked in one or both.
    pub(super) fn or(&self, others: &Bits) -> Bits {
        Bits(std::array::from_fn(|row| self.0[row] | others.0[row]))
    }

    /// The cells that are marked here and not in `others`.
    pub(super) fn without(&self, others: &Bits) -> Bits {
        Bits(std::array::from_fn(|row| self.0[row] & !others.0[row]))
    }

    /// Those of the marked cells of the tile at a place that are as `is` says, by
    /// their rows and columns.
    pub(super) fn which(
        &self,
        (x, y): Place,
        is: impl Fn(IVec2, usize, usize) -> bool,
    ) -> Bits {
        Bits(std::array::from_fn(|row| {
            let at = |k: i32| IVec2::new(x * SIDE + k, y * SIDE + row as i32);
            let is = |k: i32| is(at(k), row, k as usize);
            let marked = marked(self.0[row]);
            marked.filter(|&k| is(k)).fold(0, |all, k| all | 1 << k)
        }))
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
        let places = self.places();
        places.map(move |(row, column)| {
            IVec2::new(x * SIDE + column as i32, y * SIDE + row as i32)
        })
    }

    /// Rows and columns of the marked cells, row by row.
    pub(super) fn places(
        &self,
    ) -> impl Iterator<Item = (usize, usize)> + use<> {
        let rows = self.0.into_iter().enumerate();
        rows.flat_map(|(row, word)| {
            marked(word).map(move |k| (row, k as usize))
        })
    }
}

/// The numbers of a word's marked bits.
fn marked(word: u32) -> impl Iterator<Item = i32> {
    let next = |left: &u32| Some(left & (left - 1)).filter(|left| *left != 0);
    let first = Some(word).filter(|word| *word != 0);
    std::iter::successors(first, next).map(|left| left.trailing_zeros() as i32)
}

/// A set of cells.
#[derive(Clone, Default)]
pub(super) struct Cells {
    tiles: Tiles<Bits>,
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

    /// Marks all of a tile's cells that `bits` has.
    fn mark_all(&mut self, place: Place, bits: &Bits) {
        if !bits.is_empty() {
            let own = self.tiles.entry(place).or_default();
            *own = own.or(bits);
        }
    }

    /// These cells and those of `others`.
    pub(super) fn with(mut self, others: &Cells) -> Cells {
        for (place, bits) in &others.tiles {
            self.mark_all(*place, bits);
        }
        self
    }

    /// Those of these cells that are in `others`, or those that are not.
    pub(super) fn filter(mut self, others: &Cells, are_in: bool) -> Cells {
        let none = Bits::default();
        self.tiles.retain(|place, bits| {
            let of = others.tiles.get(place).unwrap_or(&none);
            *bits = if are_in {
                bits.and(of)
            } else {
                bits.without(of)
            };
            !bits.is_empty()
        });
        self
    }

    /// These cells and all of their neighbours.
    pub(super) fn grown(&self) -> Cells {
        let mut grown = Cells::default();
        for ((x, y), bits) in &self.tiles {
            // Each row with the rows beside it, and those that reach out.
            let rows = |r: usize| {
                let own = |r: usize| bits.0.get(r).copied().unwrap_or(0);
                own(r) | own(r + 1) | r.checked_sub(1).map_or(0, own)
            };
            let middle: [u32; SIDE as usize] = std::array::from_fn(rows);
            let only = |row: usize, bits: u32| {
                let mut all = [0; SIDE as usize];
                all[row] = bits;
                all
            };
            let last = SIDE as usize - 1;
            let above = only(0, bits.0[last]);
            let below = only(last, bits.0[0]);
            for (dy, rows) in [(-1, below), (0, middle), (1, above)] {
                let wide = rows.map(|row| row | row << 1 | row >> 1);
                let left = rows.map(|row| row << last);
                let right = rows.map(|row| row >> last);
                for (dx, rows) in [(-1, left), (0, wide), (1, right)] {
                    grown.mark_all((x + dx, y + dy), &Bits(rows));
                }
            }
        }
        grown
    }

    /// The first cell.
    pub(super) fn first(&self) -> Option<IVec2> {
        let first = self.tiles.iter().min_by_key(|(place, _)| **place)?;
        first.1.cells(*first.0).next()
    }

    /// The number of cells.
    pub(super) fn count(&self) -> u32 {
        self.tiles.values().map(Bits::count).sum()
    }

    /// The tiles that have cells, in no order.
    pub(super) fn tiles(&self) -> impl Iterator<Item = (Place, &Bits)> {
        self.tiles.iter().map(|(place, bits)| (*place, bits))
    }

    /// The cells of some tiles.
    pub(super) fn of(tiles: impl Iterator<Item = (Place, Bits)>) -> Cells {
        let tiles = tiles.filter(|(_, bits)| !bits.is_empty()).collect();
        Cells { tiles }
    }

    /// All marked cells, tile by tile.
    pub(super) fn all(&self) -> impl Iterator<Item = IVec2> + '_ {
        let mut all: Vec<_> = self.tiles.iter().collect();
        all.sort_unstable_by_key(|(place, _)| **place);
        all.into_iter().flat_map(|(place, bits)| bits.cells(*place))
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
        assert_eq!(cells.first().map(|c| (c.x, c.y)), Some(marked[0]));
        let mut grown: Vec<[i32; 2]> =
            cells.grown().all().map(|cell| cell.to_array()).collect();
        grown.sort_unstable();
        let each = marked.iter().map(|&(x, y)| IVec2::new(x, y));
        let mut near: Vec<[i32; 2]> =
            each.flat_map(around).map(|cell| cell.to_array()).collect();
        near.sort_unstable();
        near.dedup();
        assert_eq!(grown, near);
        assert!(!cells.has(IVec2::new(-33, -27)));
        let p = DVec2::new(-0.2, 0.6);
        let cell = cell_of(p);
        assert_eq!(cell, IVec2::new(-1, 1));
        let away = (middle_of(cell) - p).abs();
        assert!(away.max_element() <= 0.5 * CELL, "{away}");
    }
}
