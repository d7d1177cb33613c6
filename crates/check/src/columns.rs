//! How high what is printed reaches, cell by cell.
//!
//! In: beads, in order. Out: for each cell the top of the layers below and that
//! of all that is printed, and how deep the beads of the layer reach there.
//!
//! Only cells in which something is printed take memory, and no more than
//! [`MOST_TILES`] of their tiles do: 134 MB, for 2 m² that are printed on. Nothing
//! is known of what is printed on more than that.

use super::cells::{Bits, Cells, Place, SIDE, Tiles, around, split};
use glam::IVec2;
use std::cell::Cell;
use std::ops::RangeInclusive;

/// Greatest number of tiles.
const MOST_TILES: usize = 1 << 13;

/// Nothing is printed here.
const NOTHING: f32 = f32::NEG_INFINITY;

/// Bits of a stamp besides the layer's number: is the top a support's, and is
/// what is below?
const TOP_SUPPORT: u32 = 1;
const BELOW_SUPPORT: u32 = 2;
const FLAGS: u32 = 2;

/// What is printed in a cell, from the layer on in which it was printed last.
#[derive(Clone, Copy)]
struct Column {
    /// Top of the layers below that one.
    below: f32,
    /// Top of all.
    top: f32,
    /// How deep the beads of that layer reach.
    low: f32,
    /// That layer's number, and the flags.
    stamp: u32,
}

impl Column {
    const EMPTY: Column = Column {
        below: NOTHING,
        top: NOTHING,
        low: f32::INFINITY,
        stamp: 0,
    };

    /// The column as a layer finds it. If beads were laid in it in earlier layers
    /// only, their top is now what lies below.
    fn at(mut self, layer: u32) -> Column {
        if self.stamp >> FLAGS != layer {
            let support = self.stamp & TOP_SUPPORT;
            self.stamp = layer << FLAGS | support | support << 1;
            self.below = self.top;
            self.low = f32::INFINITY;
        }
        self
    }
}

/// What is known of a cell in the layer being printed. Nothing is printed where
/// a height is not finite.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seen {
    /// Top of the layers below.
    pub below: f64,
    /// True if that is the top of a support.
    pub on_support: bool,
    /// Top of all.
    pub top: f64,
    /// How deep the layer's own beads reach.
    pub low: f64,
}

/// From where to where a bead reaches: up to `top`, and down to `low` if something
/// is there, or else to `deep`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reach {
    pub low: f32,
    pub deep: f32,
    pub top: f32,
    pub support: bool,
}

/// Cells side by side, and the beads of the layer that is printed in them.
struct Tile {
    columns: [[Column; SIDE as usize]; SIDE as usize],
    /// The layer of the marks.
    layer: u32,
    part: Bits,
    support: Bits,
    /// Cells whose beads reach down to what lies below them.
    held: Bits,
}

impl Tile {
    fn new() -> Tile {
        Tile {
            columns: [[Column::EMPTY; SIDE as usize]; SIDE as usize],
            layer: 0,
            part: Bits::default(),
            support: Bits::default(),
            held: Bits::default(),
        }
    }

    /// The cells of supports, or of the part.
    fn of(&self, support: bool) -> &Bits {
        if support { &self.support } else { &self.part }
    }
}

/// The columns of all cells.
pub(super) struct Columns {
    places: Tiles<usize>,
    tiles: Vec<Tile>,
    /// The tile that was asked for last.
    last: Cell<Option<(Place, usize)>>,
    /// Number of the layer being printed, from 1.
    layer: u32,
    /// The tiles in which it is printed.
    touched: Vec<(Place, usize)>,
}

impl Default for Columns {
    fn default() -> Self {
        Columns {
            places: Tiles::default(),
            tiles: Vec::new(),
            last: Cell::new(None),
            layer: 1,
            touched: Vec::new(),
        }
    }
}

impl Columns {
    /// Number of tiles that take memory.
    #[cfg(test)]
    pub(super) fn tiles(&self) -> usize {
        self.tiles.len()
    }

    /// Takes in a part of a bead. Returns the top of the layers below it, and of all
    /// that was printed there before.
    #[inline]
    pub(super) fn lay(&mut self, cell: IVec2, bead: Reach) -> Option<[f64; 2]> {
        let Reach {
            low,
            deep,
            top,
            support,
        } = bead;
        let (place, row, column) = split(cell);
        let index = self.tile(place)?;
        let layer = self.layer;
        let tile = &mut self.tiles[index];
        if tile.layer != layer {
            tile.part = Bits::default();
            tile.support = Bits::default();
            tile.held = Bits::default();
            tile.layer = layer;
            self.touched.push((place, index));
        }
        let of = if support {
            &mut tile.support
        } else {
            &mut tile.part
        };
        of.mark(row, column);
        let own = &mut tile.columns[row][column];
        *own = own.at(layer);
        let before = own.top;
        let low = if own.below >= low { low } else { deep };
        if low < own.low {
            own.low = low;
        }
        if own.below >= low {
            tile.held.mark(row, column);
        }
        if top >= own.top {
            own.top = top;
            own.stamp = own.stamp & !TOP_SUPPORT | u32::from(support);
        }
        Some([own.below, before].map(f64::from))
    }

    /// What is known of a cell; nothing where nothing was ever printed.
    pub(super) fn at(&self, cell: IVec2) -> Option<Seen> {
        let (place, row, column) = split(cell);
        self.seen(self.known(place)?.columns[row][column])
    }

    /// The top of the layers below in a cell, and whether it is that of a support;
    /// none where nothing is below.
    pub(super) fn below(&self, cell: IVec2) -> Option<(f64, bool)> {
        let (place, row, column) = split(cell);
        let own = self.known(place)?.columns[row][column].at(self.layer);
        let support = own.stamp & BELOW_SUPPORT != 0;
        (own.below > NOTHING).then_some((own.below.into(), support))
    }

    /// Those of some cells that are as `is` says.
    pub(super) fn which(
        &self,
        cells: &Cells,
        is: impl Fn(IVec2, &Seen) -> bool,
    ) -> Cells {
        self.sifted(cells, |cell, own| {
            self.seen(own).is_some_and(|seen| is(cell, &seen))
        })
    }

    fn sifted(
        &self,
        cells: &Cells,
        is: impl Fn(IVec2, Column) -> bool,
    ) -> Cells {
        let all = cells.tiles().filter_map(|(place, bits)| {
            let columns = &self.known(place)?.columns;
            let is = |cell: IVec2, row: usize, column: usize| {
                is(cell, columns[row][column])
            };
            Some((place, bits.which(place, is)))
        });
        Cells::of(all)
    }

    /// Those of some cells in which the top of the layers below lies within a range,
    /// which is another one for tops of supports.
    pub(super) fn within(
        &self,
        cells: &Cells,
        range: impl Fn(bool) -> RangeInclusive<f64>,
    ) -> Cells {
        let ranges = [false, true].map(range);
        self.sifted(cells, |_, own| {
            let own = own.at(self.layer);
            let support = own.stamp & BELOW_SUPPORT != 0;
            ranges[usize::from(support)].contains(&own.below.into())
        })
    }

    /// Of some cells of the layer, the deepest and highest reach of beads, and the
    /// highest and lowest: what lies between both holds all of their beads.
    pub(super) fn spread(&self, cells: &Cells) -> Option<[Seen; 2]> {
        let of_tile = |(place, bits): (Place, &Bits)| {
            let tile = self.known(place)?;
            let seen = move |(row, column): (usize, usize)| {
                self.seen(tile.columns[row][column])
            };
            Some(bits.places().filter_map(seen))
        };
        let mut all = cells.tiles().filter_map(of_tile).flatten();
        let first = all.next()?;
        Some(all.fold([first; 2], |[deep, high], seen| {
            let (low, top) = (deep.low.min(seen.low), deep.top.max(seen.top));
            let deep = Seen { low, top, ..deep };
            let (low, top) = (high.low.max(seen.low), high.top.min(seen.top));
            [deep, Seen { low, top, ..high }]
        }))
    }

    /// True if one of a cell and its eight neighbours is as `is` says.
    pub(super) fn any_around(
        &self,
        cell: IVec2,
        is: impl Fn(&Seen) -> bool,
    ) -> bool {
        let (place, row, column) = split(cell);
        let inner = 1..SIDE as usize - 1;
        // Most cells are in one tile with all of their neighbours.
        if inner.contains(&row) && inner.contains(&column) {
            return self.known(place).is_some_and(|tile| {
                let rows = &tile.columns[row - 1..=row + 1];
                let near =
                    rows.iter().flat_map(|r| &r[column - 1..=column + 1]);
                near.filter_map(|&of| self.seen(of)).any(|seen| is(&seen))
            });
        }
        let mut near = around(cell);
        near.any(|near| self.at(near).is_some_and(|seen| is(&seen)))
    }

    /// The tile at a place, if something was printed there. Mostly it is the one that
    /// was asked for last.
    #[inline]
    fn known(&self, place: Place) -> Option<&Tile> {
        let index = match self.last.get() {
            Some((last, index)) if last == place => index,
            _ => self.look_up(place)?,
        };
        Some(&self.tiles[index])
    }

    /// The number of the tile at a place, if something was printed there.
    fn look_up(&self, place: Place) -> Option<usize> {
        let index = *self.places.get(&place)?;
        self.last.set(Some((place, index)));
        Some(index)
    }

    fn seen(&self, column: Column) -> Option<Seen> {
        let own = column.at(self.layer);
        (own.top > NOTHING).then(|| Seen {
            below: f64::from(own.below),
            on_support: own.stamp & BELOW_SUPPORT != 0,
            top: f64::from(own.top),
            low: f64::from(own.low),
        })
    }

    /// The cells of the layer's part, or of its supports.
    pub(super) fn printed(&self, support: bool) -> Cells {
        Cells::of(
            self.touched
                .iter()
                .map(|&(place, index)| (place, *self.tiles[index].of(support))),
        )
    }

    /// Those cells of the layer's part, or of its supports, whose beads do not
    /// reach down to what lies below them.
    pub(super) fn not_held(&self, support: bool) -> Cells {
        Cells::of(self.touched.iter().map(|&(place, index)| {
            let tile = &self.tiles[index];
            (place, tile.of(support).without(&tile.held))
        }))
    }

    /// Begins the next layer.
    pub(super) fn next_layer(&mut self) {
        // Beyond all numbers, what is printed counts as one layer.
        self.layer = (self.layer + 1).min(u32::MAX >> FLAGS);
        self.touched.clear();
    }

    /// The tile at a place, which is made if there is room for it.
    #[inline]
    fn tile(&mut self, place: Place) -> Option<usize> {
        match self.last.get() {
            Some((last, index)) if last == place => Some(index),
            _ => self.look_up(place).or_else(|| self.make(place)),
        }
    }

    /// Makes the tile at a place, if there is room for it.
    fn make(&mut self, place: Place) -> Option<usize> {
        let index = self.tiles.len();
        if index >= MOST_TILES {
            return None;
        }
        self.tiles.push(Tile::new());
        self.places.insert(place, index);
        self.last.set(Some((place, index)));
        Some(index)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A bead that reaches from one height up to another.
    fn reach(low: f32, top: f32, support: bool) -> Reach {
        let deep = low;
        Reach {
            low,
            deep,
            top,
            support,
        }
    }

    #[test]
    fn a_layer_lies_on_those_below_and_not_on_itself() {
        let mut columns = Columns::default();
        let cell = IVec2::new(-3, 70);
        assert!(columns.at(cell).is_none());
        let [below, _] = columns.lay(cell, reach(0.0, 0.2, true)).unwrap();
        assert!(below.is_infinite());
        let [below, _] = columns.lay(cell, reach(0.3, 0.5, false)).unwrap();
        assert!(below.is_infinite(), "one layer");
        let seen = columns.at(cell).unwrap();
        assert!((seen.low, seen.on_support) == (0.0, false), "{seen:?}");
        columns.next_layer();
        let seen = columns.at(cell).unwrap();
        assert_eq!((seen.below, seen.top), (0.5, 0.5));
        assert!(!seen.on_support && seen.low.is_infinite());
        assert_eq!(columns.lay(cell, reach(0.5, 0.7, true)), Some([0.5; 2]));
        columns.next_layer();
        columns.next_layer();
        let seen = columns.at(cell).unwrap();
        assert!(seen.on_support && (seen.below - 0.7).abs() < 1e-6);
        assert!(columns.at(IVec2::new(-3, 69)).is_none());
    }

    #[test]
    fn memory_has_a_bound() {
        let mut columns = Columns::default();
        for k in 0..2 * MOST_TILES as i32 {
            let cell = IVec2::new(SIDE * (k % 128), SIDE * (k / 128));
            let known = columns.lay(cell, reach(0.0, 0.2, false)).is_some();
            assert_eq!(known, k < MOST_TILES as i32);
        }
        assert_eq!(columns.tiles(), MOST_TILES);
        assert!(size_of::<Tile>() * MOST_TILES < 140 << 20);
    }
}
