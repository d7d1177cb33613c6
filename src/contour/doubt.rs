//! Finds the cells that may hide what their nodes do not show.
//!
//! ```text
//!   f │ \                   /        Four nodes in a row, all outside: going
//!     │   •               •          on as it came from either side, the field
//!     │     \           /            passes zero in between. There may be a
//!     │       •       •              wall, a slit, an island or a hole that is
//!   0 ┼─────────\───/────────        thinner than the lattice is wide.
//!     │           V
//! ```
//!
//! For a field that is convex between the nodes (as one is near a thin wall)
//! the two lines lie below it, so nothing that reaches the row is missed; they
//! are taken to reach farther, for what lies between two rows.
//!
//! Not guaranteed: that a feature shows where another one's field hides it
//! from all of the nodes around it.

use super::march::{Scratch, bits};
use crate::field::{FieldError, LEAF, Lattice, Leaf, NODES, Sampler};
use glam::DVec2;

/// Parts of the cell that the field's fall from both sides, each going on to
/// zero, may leave between them. Below 1 they cross zero on the row itself,
/// as they do for all that is wider than the lattice; a pin half a cell off
/// the row shows by about 1.6.
const NEAR: f32 = 1.0;
const FAR: f32 = 1.6;
/// Doubtful cells of a leaf that are looked into, where the lattice is as
/// fine as what can be printed: where more are in doubt the field is noise.
const MOST: usize = 16;

/// True if the field may pass zero between two neighbouring nodes with values
/// `a` and `b` of the same sign; `before` and `after` are those beside them.
fn doubtful([before, a, b, after]: [f32; 4], reach: f32) -> bool {
    let side = if a < 0.0 { -1.0 } else { 1.0 };
    let (a, b) = (side * a, side * b);
    let (fall, rise) = (side * before - a, side * after - b);
    b >= 0.0
        && fall > 0.0
        && rise > 0.0
        && a * rise + b * fall < reach * fall * rise
}

/// An edge at a leaf's border, in doubt until the node beyond is known.
struct Border {
    leaf: usize,
    /// The edge's nodes, from the border inwards, and the one after.
    inner: [f32; 3],
    /// The cells beside it, in the leaf.
    cells: [Option<[usize; 2]>; 2],
}

/// The doubtful cells of a batch: (leaf, column, row), in order. At most a
/// few per leaf if `few`.
pub(super) fn doubts(
    leaves: &[Leaf],
    values: &[f32],
    z: &[f32],
    lattice: &Lattice,
    few: bool,
    sampler: &mut dyn Sampler,
    scratch: &mut Scratch,
) -> Result<Vec<(usize, [usize; 2])>, FieldError> {
    let mut found: Vec<(usize, [usize; 2])> = Vec::new();
    let mut borders: Vec<Border> = Vec::new();
    let reach = if few { NEAR } else { FAR };
    scratch.clear();
    for (n, leaf) in leaves.iter().enumerate() {
        let values = &values[n * NODES * NODES..(n + 1) * NODES * NODES];
        let at = |i: usize, j: usize| values[j * NODES + i];
        // Along x, then along y: `k` runs along the edges, `across` them.
        for flip in [false, true] {
            let value = |k: usize, across: usize| match flip {
                false => at(k, across),
                true => at(across, k),
            };
            let cells = |k: usize, across: usize| {
                let cell = |across: usize| match flip {
                    false => [k, across],
                    true => [across, k],
                };
                let below = across.checked_sub(1).map(cell);
                [below, (across < LEAF).then(|| cell(across))]
            };
            let rising = rising(values, flip);
            for k in 1..LEAF - 1 {
                // Where it falls before the edge and rises after it, or the
                // other way round.
                for across in bits(rising[k - 1] ^ rising[k + 1]) {
                    let line = [k - 1, k, k + 1, k + 2];
                    if doubtful(line.map(|k| value(k, across)), reach) {
                        let cells = cells(k, across).into_iter().flatten();
                        found.extend(cells.map(|c| (n, c)));
                    }
                }
            }
            for (k, nodes, beyond) in [
                (0, [0, 1, 2], -1),
                (LEAF - 1, [LEAF, LEAF - 1, LEAF - 2], 9),
            ] {
                for across in 0..NODES {
                    let inner = nodes.map(|k| value(k, across));
                    let [a, b, c] = inner;
                    // However steep it is on the other side.
                    if b.abs() >= reach * (c - b).abs() {
                        continue;
                    }
                    // Four times as steep as here is the most that is
                    // thought of.
                    let steep = a + 4.0 * (c - b).abs().copysign(a);
                    if !doubtful([steep, a, b, c], reach) {
                        continue;
                    }
                    let (dx, dy) = match flip {
                        false => (beyond, across as i64),
                        true => (across as i64, beyond),
                    };
                    let node = |axis: &[f32], from: usize, d: i64| {
                        let last = axis.len() as i64 - 1;
                        let k = (from as i64 + d).clamp(0, last);
                        f64::from(axis[k as usize])
                    };
                    let p = DVec2::new(
                        node(&lattice.x, leaf.i, dx),
                        node(&lattice.y, leaf.j, dy),
                    );
                    scratch.push(p, z[leaf.layer]);
                    borders.push(Border {
                        leaf: n,
                        inner,
                        cells: cells(k, across),
                    });
                }
            }
        }
    }
    if !borders.is_empty() {
        let s = &mut *scratch;
        sampler.values(&s.x, &s.y, &s.z, &mut s.values)?;
        for (b, &beyond) in borders.iter().zip(&s.values) {
            let [first, second, third] = b.inner;
            if doubtful([beyond, first, second, third], reach) {
                let cells = b.cells.into_iter().flatten();
                found.extend(cells.map(|c| (b.leaf, c)));
            }
        }
    }
    found.sort_unstable();
    found.dedup();
    if few {
        let counts = |n: usize| {
            let from = found.partition_point(|f| f.0 < n);
            found[from..].iter().take_while(|f| f.0 == n).count()
        };
        let noisy: Vec<bool> =
            (0..leaves.len()).map(|n| counts(n) > MOST).collect();
        found.retain(|f| !noisy[f.0]);
    }
    Ok(found)
}

/// By place along the lines, the lines on which the field is greater at the
/// next node.
fn rising(values: &[f32], flip: bool) -> [u16; LEAF] {
    let mut out = [0_u16; LEAF];
    let rows: &[[f32; NODES]] = values.as_chunks().0;
    if flip {
        for (mask, pair) in out.iter_mut().zip(rows.windows(2)) {
            for (i, (low, high)) in pair[0].iter().zip(&pair[1]).enumerate() {
                *mask |= u16::from(high > low) << i;
            }
        }
    } else {
        for (j, row) in rows.iter().enumerate() {
            for (k, mask) in out.iter_mut().enumerate() {
                *mask |= u16::from(row[k + 1] > row[k]) << j;
            }
        }
    }
    out
}
