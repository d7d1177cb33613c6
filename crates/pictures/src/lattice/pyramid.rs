//! The least and the greatest number in any box of a lattice.
//!
//! Blocks of 2ᵏ numbers along each axis keep the least and the greatest of
//! them, at several k. A box is looked up at the level at which it meets three
//! blocks along each axis at most. Small boxes are looked at number by number.

use isoslice_base::parallel;

/// Two numbers between which others are.
pub(crate) type Range = [f64; 2];

/// No number.
pub(crate) const NONE: Range = [f64::INFINITY, f64::NEG_INFINITY];

/// The range of two ranges' numbers.
pub(crate) fn both([a, b]: Range, [c, d]: Range) -> Range {
    [a.min(c), b.max(d)]
}

/// The most numbers that are looked at one by one: as many as a box of eight
/// along each axis has.
const FEW: usize = 512;

#[derive(Debug)]
pub(crate) struct Pyramid {
    /// How many numbers there are along each axis.
    size: [usize; 3],
    levels: Vec<Level>,
}

#[derive(Debug)]
struct Level {
    /// Blocks are of 2ᵏ numbers along each axis.
    k: u32,
    blocks: [usize; 3],
    ranges: Vec<[f32; 2]>,
}

impl Level {
    /// The range of the blocks from one to another.
    fn range(&self, from: [usize; 3], to: [usize; 3]) -> Range {
        scan(from, to, |[i, j, k]| {
            let [a, b, _] = self.blocks;
            let range = self.ranges.get((k * b + j) * a + i);
            range
                .map_or(NONE, |[least, most]| [(*least).into(), (*most).into()])
        })
    }
}

/// The range of what stands from one place to another.
fn scan(
    from: [usize; 3],
    to: [usize; 3],
    mut get: impl FnMut([usize; 3]) -> Range,
) -> Range {
    let mut range = NONE;
    for k in from[2]..=to[2] {
        for j in from[1]..=to[1] {
            for i in from[0]..=to[0] {
                range = both(range, get([i, j, k]));
            }
        }
    }
    range
}

/// The nearest numbers of 32 bits that are not within.
fn outward([a, b]: Range) -> [f32; 2] {
    let (mut least, mut most) = (a as f32, b as f32);
    if f64::from(least) > a {
        least = least.next_down();
    }
    if f64::from(most) < b {
        most = most.next_up();
    }
    [least, most]
}

impl Pyramid {
    /// Of the numbers that `get` returns.
    pub(crate) fn new(
        size: [usize; 3],
        get: impl Fn([usize; 3]) -> f64 + Sync,
    ) -> Pyramid {
        // A picture's blocks of 4 × 4, and a volume's of 8 × 8 × 8, take half
        // a byte and a sixty-fourth for each number.
        let first = if size.contains(&1) { 2 } else { 3 };
        let mut levels = vec![lowest(first, size, get)];
        while let Some(last) = levels.last()
            && last.blocks.iter().any(|n| *n > 3)
        {
            let finer = last.blocks;
            let next =
                level(1, finer, |from, to| last.range(from, to)).coarser(last);
            levels.push(next);
        }
        Pyramid { size, levels }
    }

    /// The range of the numbers from one place to another.
    pub(crate) fn range(
        &self,
        from: [usize; 3],
        to: [usize; 3],
        get: impl Fn([usize; 3]) -> f64,
    ) -> Range {
        let to = std::array::from_fn(|a| to[a].min(self.size[a] - 1));
        let count: usize = (0..3).map(|a| to[a] + 1 - from[a]).product();
        let few =
            |k: u32| (0..3).all(|a: usize| (to[a] >> k) - (from[a] >> k) < 3);
        let level = self.levels.iter().find(|level| few(level.k));
        match level.or(self.levels.last()) {
            Some(level) if count > FEW => {
                let at = |p: [usize; 3]| p.map(|i| i >> level.k);
                level.range(at(from), at(to))
            }
            _ => scan(from, to, |at| {
                let value = get(at);
                [value, value]
            }),
        }
    }

    /// The range of all numbers.
    pub(crate) fn all(&self) -> Range {
        self.levels.last().map_or(NONE, |level| {
            level.range([0; 3], level.blocks.map(|n| n - 1))
        })
    }

    /// Its memory, bytes.
    pub(crate) fn bytes(&self) -> usize {
        let ranges = |level: &Level| size_of_val(level.ranges.as_slice());
        self.levels.iter().map(ranges).sum()
    }
}

impl Level {
    fn coarser(self, finer: &Level) -> Level {
        Level {
            k: self.k + finer.k,
            ..self
        }
    }
}

/// Blocks of 2ᵏ numbers along each axis. The numbers are taken row by row, since
/// there may be 60 million of them.
fn lowest(
    k: u32,
    size: [usize; 3],
    get: impl Fn([usize; 3]) -> f64 + Sync,
) -> Level {
    let blocks = size.map(|n| n.div_ceil(1 << k));
    let [_, b, c] = blocks;
    let some = |block: usize, n: usize| block << k..((block + 1) << k).min(n);
    let row = |row: usize| {
        let mut columns = vec![NONE; size[0]];
        for z in some(row / b, size[2]) {
            for y in some(row % b, size[1]) {
                for (x, range) in columns.iter_mut().enumerate() {
                    let value = get([x, y, z]);
                    *range = both(*range, [value, value]);
                }
            }
        }
        let blocks = columns.chunks(1 << k);
        let range = |block: &[Range]| block.iter().copied().fold(NONE, both);
        blocks.map(|b| outward(range(b))).collect::<Vec<_>>()
    };
    let ranges = rows(b * c, row);
    Level { k, blocks, ranges }
}

/// Blocks of 2ᵏ of what a lattice of some size holds.
fn level(
    k: u32,
    size: [usize; 3],
    range: impl Fn([usize; 3], [usize; 3]) -> Range + Sync,
) -> Level {
    let blocks = size.map(|n| n.div_ceil(1 << k));
    let [a, b, c] = blocks;
    let row = |row: usize| {
        let (j, l) = (row % b, row / b);
        let range = &range;
        (0..a).map(move |i| {
            let from = [i << k, j << k, l << k];
            let to = std::array::from_fn(|axis| {
                (from[axis] + (1 << k) - 1).min(size[axis] - 1)
            });
            outward(range(from, to))
        })
    };
    let ranges = rows(b * c, row);
    Level { k, blocks, ranges }
}

/// What `row` makes of each of some rows, one after the other. Pyramids are made
/// while others wait for them, so they are made apart.
fn rows<I: IntoIterator<Item = [f32; 2]>>(
    count: usize,
    row: impl Fn(usize) -> I + Sync,
) -> Vec<[f32; 2]> {
    /// Rows that one thread makes at a time: enough that handing them out costs
    /// nothing, few enough that all threads have some.
    const AT_ONCE: usize = 16;
    let some = |part: usize| -> Vec<[f32; 2]> {
        let first = part * AT_ONCE;
        (first..(first + AT_ONCE).min(count))
            .flat_map(&row)
            .collect()
    };
    parallel::map_apart(count.div_ceil(AT_ONCE), some).concat()
}

/// A range a little wider, by `by` on each side.
pub(crate) fn widened(range: Range, by: f64) -> Range {
    [range[0] - by, range[1] + by]
}
