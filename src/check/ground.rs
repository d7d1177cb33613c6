//! What the beads of a layer stand on.
//!
//! The plane is divided into cells; a layer's islands are the connected groups
//! of cells that beads run through, and one of them stands on something if
//! any of its cells, or a neighbour, has a bead in the layer below.

use crate::units::Mm;
use glam::{DVec2, DVec3, IVec2};
use std::collections::BTreeMap;

/// Size of a cell: a line's width or so, so that neighbouring lines are in
/// neighbouring cells.
const CELL: Mm = 0.5;

/// Cells along one side of a tile.
const SIDE: i32 = 32;

/// Cells that something is in.
#[derive(Default)]
struct Cells {
    /// Where the tiles are in `bits`.
    tiles: BTreeMap<(i32, i32), usize>,
    bits: Vec<[u32; SIDE as usize]>,
    /// The tile asked for last.
    last: Option<((i32, i32), usize)>,
}

impl Cells {
    fn split(cell: IVec2) -> ((i32, i32), usize, u32) {
        let tile = (cell.x.div_euclid(SIDE), cell.y.div_euclid(SIDE));
        let row = cell.y.rem_euclid(SIDE) as usize;
        (tile, row, 1 << cell.x.rem_euclid(SIDE))
    }

    /// Marks a cell; true if it was not marked before.
    fn mark(&mut self, cell: IVec2) -> bool {
        let (tile, row, bit) = Self::split(cell);
        let index = match self.last {
            Some((last, index)) if last == tile => index,
            _ => {
                let bits = &mut self.bits;
                *self.tiles.entry(tile).or_insert_with(|| {
                    bits.push([0; SIDE as usize]);
                    bits.len() - 1
                })
            }
        };
        self.last = Some((tile, index));
        let word = &mut self.bits[index][row];
        let new = *word & bit == 0;
        *word |= bit;
        new
    }

    fn has(&self, cell: IVec2) -> bool {
        let (tile, row, bit) = Self::split(cell);
        self.tiles
            .get(&tile)
            .is_some_and(|&index| self.bits[index][row] & bit != 0)
    }

    /// All marked cells, from the lowest row of tiles up.
    fn all(&self) -> impl Iterator<Item = IVec2> + '_ {
        self.tiles.iter().flat_map(move |(&(x, y), &index)| {
            (0..SIDE).flat_map(move |row| {
                let word = self.bits[index][row as usize];
                (0..SIDE).filter(move |&k| word & (1 << k) != 0).map(
                    move |column| IVec2::new(x * SIDE + column, y * SIDE + row),
                )
            })
        })
    }

    fn is_empty(&self) -> bool {
        self.tiles.is_empty()
    }
}

/// The cell and its eight neighbours.
fn around(cell: IVec2) -> impl Iterator<Item = IVec2> {
    (-1..=1).flat_map(move |y| (-1..=1).map(move |x| cell + IVec2::new(x, y)))
}

/// The layer being printed, and the one below.
#[derive(Default)]
pub(super) struct Ground {
    here: Cells,
    below: Option<Cells>,
    z: Mm,
}

impl Ground {
    /// A bead runs from `a` to `b`, places on a bed, in the layer being
    /// printed.
    pub fn bead(&mut self, a: DVec2, b: DVec2, z: Mm) {
        self.z = z;
        let way = b - a;
        let length = way.length();
        let steps = (length / CELL).ceil().max(1.0) as u32;
        for k in 0..=steps {
            let p = a + way * (f64::from(k) / f64::from(steps));
            self.here.mark((p / CELL).floor().as_ivec2());
        }
    }

    /// Ends a layer; `found` is told where islands begin in the air.
    pub fn next_layer(&mut self, mut found: impl FnMut(DVec3)) {
        if self.here.is_empty() {
            return;
        }
        let here = std::mem::take(&mut self.here);
        if let Some(below) = &self.below {
            let mut seen = Cells::default();
            let mut left = Vec::new();
            for first in here.all() {
                if !seen.mark(first) {
                    continue;
                }
                let mut stands = false;
                left.push(first);
                while let Some(cell) = left.pop() {
                    for near in around(cell) {
                        stands |= below.has(near);
                        if here.has(near) && seen.mark(near) {
                            left.push(near);
                        }
                    }
                }
                if !stands {
                    let p = (first.as_dvec2() + 0.5) * CELL;
                    found(p.extend(self.z));
                }
            }
        }
        self.below = Some(here);
    }
}
