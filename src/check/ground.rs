//! What the beads of a layer stand on.
//!
//! The plane is divided into cells. A layer's islands are the connected groups
//! of cells that beads run through. An island stands on something if a bead
//! below runs through one of its cells or a neighbouring cell. Such a bead is
//! in the part's layer below, or in a support within a gap. Islands of supports
//! may stand on the part with a gap as well.

use crate::reader::{Move, Role};
use crate::units::Mm;
use glam::{DVec3, IVec2};
use std::collections::{BTreeMap, VecDeque};

/// Size of a cell, about a line's width: neighbouring lines are in neighbouring
/// cells.
const CELL: Mm = 0.5;

/// Number of cells on the negative side, beyond which no bead reaches.
const BELOW: i32 = 1 << 12;

/// Cells along one side of a tile.
const SIDE: i32 = 32;

/// A set of cells.
#[derive(Clone, Default)]
struct Cells {
    /// Where the tiles are in `bits`.
    tiles: BTreeMap<(i32, i32), usize>,
    bits: Vec<[u32; SIDE as usize]>,
    /// The tile that was asked for last, and where it is in `bits`.
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

    /// The rows of a tile, with the last row of the tile below and the first
    /// row of the tile above.
    fn rows(&self, (x, y): (i32, i32)) -> [u32; SIDE as usize + 2] {
        const END: usize = SIDE as usize;
        let mut rows = [0; END + 2];
        let tile = |y| self.tiles.get(&(x, y)).map(|&i| &self.bits[i]);
        if let Some(below) = tile(y - 1) {
            rows[0] = below[END - 1];
        }
        if let Some(here) = tile(y) {
            rows[1..=END].copy_from_slice(here);
        }
        if let Some(above) = tile(y + 1) {
            rows[END + 1] = above[0];
        }
        rows
    }

    /// The cells of a tile that are marked, or have a marked neighbour.
    fn near(&self, (x, y): (i32, i32)) -> [u32; SIDE as usize] {
        let columns = [x - 1, x, x + 1].map(|x| self.rows((x, y)));
        std::array::from_fn(|row| {
            let [left, here, right] =
                columns.map(|rows| rows[row] | rows[row + 1] | rows[row + 2]);
            let sides = here << 1 | here >> 1;
            let beside = left >> (SIDE - 1) | right << (SIDE - 1);
            here | sides | beside
        })
    }

    /// Removes the cells that are marked in `below` or have a marked neighbour
    /// there, and returns them.
    fn take_near(&mut self, below: &Cells) -> Cells {
        let mut taken = Cells::default();
        self.last = None;
        self.tiles.retain(|&tile, &mut index| {
            let near = below.near(tile);
            let here = &mut self.bits[index];
            let mut both = [0; SIDE as usize];
            let mut left = 0;
            for ((here, near), both) in here.iter_mut().zip(near).zip(&mut both)
            {
                *both = *here & near;
                *here &= !near;
                left |= *here;
            }
            taken.tiles.insert(tile, taken.bits.len());
            taken.bits.push(both);
            left != 0
        });
        taken
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

    /// Tells of the first cell of each island that has nothing of `below` under
    /// it.
    fn begin(&self, below: &[&Cells], found: &mut impl FnMut(IVec2)) {
        // Most cells are above others, so few remain to be searched.
        let mut hanging = self.clone();
        let below = below.iter().filter(|cells| !cells.is_empty());
        let standing: Vec<Cells> =
            below.map(|cells| hanging.take_near(cells)).collect();
        let stands = |cell| standing.iter().any(|cells| cells.has(cell));
        let mut seen = Cells::default();
        let mut left = Vec::new();
        for first in hanging.all() {
            if !seen.mark(first) {
                continue;
            }
            let mut stood = false;
            left.push(first);
            while let Some(cell) = left.pop() {
                for near in around(cell) {
                    stood |= stands(near);
                    if hanging.has(near) && seen.mark(near) {
                        left.push(near);
                    }
                }
            }
            if !stood {
                found(first);
            }
        }
    }
}

/// The cell and its eight neighbours.
fn around(cell: IVec2) -> impl Iterator<Item = IVec2> {
    (-1..=1).flat_map(move |y| (-1..=1).map(move |x| cell + IVec2::new(x, y)))
}

/// Greatest gap between a support and what it holds above it, and between a
/// support and what it stands on.
const GAP: Mm = 0.6;

/// Number of layers that are kept. Supports may be layers of their own, between
/// those of the part.
const KEPT: usize = 16;

/// Heights closer than this differ by rounding only.
const ROUNDED: Mm = 1e-3;

/// A layer: its beads, and how high it lies.
#[derive(Default)]
struct Layer {
    part: Cells,
    support: Cells,
    /// From the lowest point of its beads to the highest.
    z: Option<(Mm, Mm)>,
}

/// The layer being printed, and those below.
#[derive(Default)]
pub(super) struct Ground {
    here: Layer,
    below: VecDeque<Layer>,
    /// The lowest point of all beads: the bed.
    bed: Option<Mm>,
}

impl Ground {
    /// Tiles that the layer being printed takes.
    #[cfg(test)]
    pub(super) fn tiles(&self) -> usize {
        self.here.part.bits.len()
    }

    /// Takes in a bead, as seen from above, in the layer being printed.
    pub(super) fn bead(&mut self, step: &Move) {
        let (a, b) = (step.from.truncate(), step.to.truncate());
        let top = step.from.z.max(step.to.z);
        let low = top - step.height;
        let (lowest, highest) = self.here.z.unwrap_or((low, top));
        self.here.z = Some((lowest.min(low), highest.max(top)));
        let cells = match step.role {
            Role::Support | Role::SupportInterface => &mut self.here.support,
            _ => &mut self.here.part,
        };
        let way = b - a;
        let length = way.length();
        let steps = (length / CELL).ceil().max(1.0) as u32;
        for k in 0..=steps {
            let p = a + way * (f64::from(k) / f64::from(steps));
            // This rounds down as the slower `floor()` does, since no bead is
            // that far below zero.
            let cell = (p / CELL + f64::from(BELOW)).as_ivec2();
            cells.mark(cell - BELOW);
        }
    }

    /// Ends a layer; `found` is told where islands begin in the air.
    pub(super) fn next_layer(&mut self, mut found: impl FnMut(DVec3)) {
        let here = std::mem::take(&mut self.here);
        let Some((low, top)) = here.z else { return };
        let bed = self.bed.map_or(low, |bed| bed.min(low));
        self.bed = Some(bed);
        let mut found = |cell: IVec2| {
            let p = (cell.as_dvec2() + 0.5) * CELL;
            found(p.extend(top));
        };
        // A file may print one object after another, and supports after what is
        // beside them.
        let lower = self.below.iter().rev();
        let lower = lower.filter(|l| l.z.is_some_and(|z| z.1 < top - ROUNDED));
        let near = |layer: &&Layer| layer.z.is_some_and(|z| z.1 > low - GAP);
        let (mut under_part, mut under_support) = (Vec::new(), Vec::new());
        for (k, layer) in lower.clone().enumerate() {
            if k == 0 || near(&layer) {
                under_part.push(&layer.support);
                under_support.extend([&layer.support, &layer.part]);
            }
        }
        let part = lower.clone().map(|layer| &layer.part);
        under_part.extend(part.clone().find(|part| !part.is_empty()));
        // Supports may be lower than the part beside them, which stands on the
        // bed as well.
        let on_bed = low <= bed + ROUNDED;
        if !on_bed && lower.clone().next().is_some() {
            here.part.begin(&under_part, &mut found);
            here.support.begin(&under_support, &mut found);
        }
        self.below.push_back(here);
        if self.below.len() > KEPT {
            self.below.pop_front();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn cells(places: &[(i32, i32)]) -> Cells {
        let mut cells = Cells::default();
        for &(x, y) in places {
            cells.mark(IVec2::new(x, y));
        }
        cells
    }

    proptest! {
        /// Tiles give the same neighbours as single cells.
        #[test]
        fn neighbours_are_found_across_tiles(
            here in prop::collection::vec((-40..40, -40..40), 0..300),
            below in prop::collection::vec((-40..40, -40..40), 0..60),
        ) {
            let below = cells(&below);
            let mut hanging = cells(&here);
            let standing = hanging.take_near(&below);
            for (x, y) in here {
                let cell = IVec2::new(x, y);
                let stands = around(cell).any(|near| below.has(near));
                prop_assert_eq!(standing.has(cell), stands);
                prop_assert_eq!(hanging.has(cell), !stands);
            }
        }
    }
}
