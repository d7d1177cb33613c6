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

use super::samples::Samples;
use crate::cells::{Place, bits};
use crate::field::{FieldError, LEAF, Lattice, Leaf, NODES, Sampler};
use glam::{DVec2, Vec4};
use pulp::{Arch, Simd, WithSimd};

/// Parts of the cell that the field's fall from both sides, each going on to
/// zero, may leave between them. Below 1 they cross zero on the row itself,
/// as they do for all that is wider than the lattice; a pin half a cell off
/// the row shows by about 1.6.
const NEAR: f32 = 1.0;
const FAR: f32 = 1.6;
/// Doubtful cells of a leaf that are looked into, where the lattice is as
/// fine as the smallest feature: where more are in doubt the field is noise.
const MOST: usize = 16;

/// Where the field may pass zero between two neighbouring nodes with values
/// `a` and `b` of the same sign; `before` and `after` are those beside them.
/// A bit for each of four.
fn doubtful([before, a, b, after]: [Vec4; 4], reach: f32) -> u32 {
    let side = Vec4::select(a.cmplt(Vec4::ZERO), Vec4::NEG_ONE, Vec4::ONE);
    let (a, b) = (side * a, side * b);
    let (fall, rise) = (side * before - a, side * after - b);
    b.cmpge(Vec4::ZERO).bitmask()
        & fall.cmpgt(Vec4::ZERO).bitmask()
        & rise.cmpgt(Vec4::ZERO).bitmask()
        & (a * rise + b * fall).cmplt(reach * fall * rise).bitmask()
}

/// A leaf's values.
type Values = [f32; NODES * NODES];

/// Looks through leaves for those without a doubtful edge: most have none, and
/// that is sooner told than which edges are.
struct Sift<'a> {
    leaves: &'a [Values],
    reach: f32,
    /// By leaf, whether it may have one.
    out: &'a mut Vec<bool>,
}

/// Numbers that are looked at together.
const WIDTH: usize = 8;

/// Greater than zero where an edge is [`doubtful`].
#[inline(always)]
fn doubt([before, a, b, after]: [f32; 4], reach: f32) -> f32 {
    let side = if a < 0.0 { -1.0 } else { 1.0 };
    let (a, b) = (side * a, side * b);
    let (fall, rise) = (side * before - a, side * after - b);
    let between = reach * fall * rise - (a * rise + b * fall);
    let least = if fall < rise { fall } else { rise };
    let least = if least < between { least } else { between };
    if b >= 0.0 { least } else { -1.0 }
}

/// The same of an edge from `a` at a border inwards to `b`, as long as the
/// node beyond is not known. However steep it is there: four times as steep
/// as here is the most that is thought of.
#[inline(always)]
fn doubt_at_border([a, b, c]: [f32; 3], reach: f32) -> f32 {
    let step = (c - b).abs();
    let steep = a + (4.0 * step).copysign(a);
    let least = doubt([steep, a, b, c], reach);
    if b.abs() < reach * step { least } else { -1.0 }
}

#[inline(always)]
fn some(list: &[f32], at: usize) -> [f32; WIDTH] {
    list.get(at..)
        .and_then(<[f32]>::first_chunk)
        .copied()
        .unwrap_or([1.0; WIDTH])
}

impl Sift<'_> {
    /// Edges between nodes that are `step` places apart, with a node on either
    /// side; of those along x, some reach from one row into the next.
    #[inline(always)]
    fn inner(&self, leaf: &Values, step: usize, best: &mut [f32; WIDTH]) {
        let last = NODES * NODES - 3 * step - WIDTH;
        for at in (0..last + WIDTH).step_by(WIDTH) {
            let at = at.min(last);
            let (p, q) = (some(leaf, at), some(leaf, at + step));
            let r = some(leaf, at + 2 * step);
            let s = some(leaf, at + 3 * step);
            for k in 0..WIDTH {
                let d = doubt([p[k], q[k], r[k], s[k]], self.reach);
                best[k] = if d > best[k] { d } else { best[k] };
            }
        }
    }

    /// Edges from the nodes of a border to those of the next line inwards.
    #[inline(always)]
    fn border(
        &self,
        [first, second, third]: [&[f32]; 3],
        best: &mut [f32; WIDTH],
    ) {
        for at in [0, NODES - WIDTH] {
            let (p, q) = (some(first, at), some(second, at));
            let r = some(third, at);
            for k in 0..WIDTH {
                let d = doubt_at_border([p[k], q[k], r[k]], self.reach);
                best[k] = if d > best[k] { d } else { best[k] };
            }
        }
    }
}

impl WithSimd for Sift<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        for leaf in self.leaves {
            let mut best = [0.0; WIDTH];
            self.inner(leaf, 1, &mut best);
            self.inner(leaf, NODES, &mut best);
            let row = |j: usize| &leaf[j * NODES..(j + 1) * NODES];
            let mut column = [[0.0; NODES]; 6];
            for j in 0..NODES {
                for (k, i) in [0, 1, 2, 8, 7, 6].into_iter().enumerate() {
                    column[k][j] = leaf[j * NODES + i];
                }
            }
            let [a, b, c, d, e, f] = &column;
            self.border([row(0), row(1), row(2)], &mut best);
            self.border([row(8), row(7), row(6)], &mut best);
            self.border([a, b, c], &mut best);
            self.border([d, e, f], &mut best);
            self.out.push(best != [0.0; WIDTH]);
        }
    }
}

/// The values along a line of a leaf's nodes; what is over is of no doubt.
type Line = [Vec4; NODES.div_ceil(4)];

/// A leaf's lines, across the edges that are looked at: its columns, or its
/// rows.
fn lines(values: &[f32], rows: bool) -> [Line; NODES] {
    let mut out = [[1.0; 4 * NODES.div_ceil(4)]; NODES];
    let all: &[[f32; NODES]] = values.as_chunks().0;
    for (j, row) in all.iter().enumerate().take(NODES) {
        if rows {
            out[j][..NODES].copy_from_slice(row);
        } else {
            for (line, &v) in out.iter_mut().zip(row) {
                line[j] = v;
            }
        }
    }
    let four = |line: &[f32], k: usize| Vec4::from_slice(&line[4 * k..]);
    out.map(|line| std::array::from_fn(|k| four(&line, k)))
}

/// Where `test` is true of the numbers of four lines: a bit for each place.
fn places([a, b, c, d]: [&Line; 4], test: impl Fn([Vec4; 4]) -> u32) -> u16 {
    let mut mask = 0;
    for k in 0..a.len() {
        mask |= test([a[k], b[k], c[k], d[k]]) << (4 * k);
    }
    mask as u16
}

/// An edge at a leaf's border, in doubt until the node beyond is known.
struct Border {
    leaf: usize,
    /// The edge's nodes, from the border inwards, and the one after.
    inner: [f32; 3],
    /// The cells beside it, in the leaf.
    cells: [Option<[usize; 2]>; 2],
}

/// The doubtful cells of a batch, in order, and if only a `few` are wanted per
/// leaf, the leaves with more, which are left out.
pub(super) fn doubts(
    leaves: &[Leaf],
    values: &[f32],
    z: &[f32],
    lattice: &Lattice,
    few: bool,
    sampler: &mut dyn Sampler,
    scratch: &mut Samples,
) -> Result<(Vec<Place>, Vec<usize>), FieldError> {
    let mut found: Vec<Place> = Vec::new();
    let mut borders: Vec<Border> = Vec::new();
    let reach = if few { NEAR } else { FAR };
    scratch.clear();
    let all: &[Values] = values.as_chunks().0;
    let mut sifted = Vec::with_capacity(all.len());
    Arch::new().dispatch(Sift {
        leaves: all,
        reach,
        out: &mut sifted,
    });
    for (n, (leaf, values)) in leaves.iter().zip(all).enumerate() {
        if !sifted[n] {
            continue;
        }
        // Along x, then along y: `k` runs along the edges, `across` them.
        for flip in [false, true] {
            let lines = lines(values, flip);
            let cells = |k: usize, across: usize| {
                let cell = |across: usize| match flip {
                    false => [k, across],
                    true => [across, k],
                };
                let below = across.checked_sub(1).map(cell);
                [below, (across < LEAF).then(|| cell(across))]
            };
            for k in 1..LEAF - 1 {
                let four = [k - 1, k, k + 1, k + 2].map(|k| &lines[k]);
                for across in bits(places(four, |f| doubtful(f, reach))) {
                    let cells = cells(k, across).into_iter().flatten();
                    found.extend(cells.map(|c| (n, c)));
                }
            }
            for (k, nodes, beyond) in [
                (0, [0, 1, 2], -1),
                (LEAF - 1, [LEAF, LEAF - 1, LEAF - 2], 9),
            ] {
                let [a, b, c] = nodes.map(|k| &lines[k]);
                // However steep it is on the other side; four times as steep
                // as here is the most that is thought of.
                let may = |[a, b, c, _]: [Vec4; 4]| {
                    let step = (c - b).abs();
                    let steep = a + (4.0 * step).copysign(a);
                    b.abs().cmplt(reach * step).bitmask()
                        & doubtful([steep, a, b, c], reach)
                };
                for across in bits(places([a, b, c, c], may)) {
                    let inner =
                        [a, b, c].map(|line| line[across / 4][across % 4]);
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
            let four = [beyond, first, second, third].map(Vec4::splat);
            if doubtful(four, reach) != 0 {
                let cells = b.cells.into_iter().flatten();
                found.extend(cells.map(|c| (b.leaf, c)));
            }
        }
    }
    found.sort_unstable();
    found.dedup();
    let mut many = Vec::new();
    if few {
        let of_leaf = found.chunk_by(|a, b| a.0 == b.0);
        many.extend(of_leaf.filter(|f| f.len() > MOST).map(|f| f[0].0));
        found.retain(|f| many.binary_search(&f.0).is_err());
    }
    Ok((found, many))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sifted(leaf: &Values, reach: f32) -> bool {
        let mut out = Vec::new();
        Arch::new().dispatch(Sift {
            leaves: std::slice::from_ref(leaf),
            reach,
            out: &mut out,
        });
        out[0]
    }

    #[test]
    fn the_sift_doubts_what_the_closer_look_does() {
        const SOME: [f32; 12] = [
            -3.0,
            -1.0,
            -0.1,
            -0.0,
            0.0,
            1e-40,
            0.1,
            1.0,
            3.0,
            f32::INFINITY,
            f32::NEG_INFINITY,
            f32::NAN,
        ];
        let n = SOME.len();
        let mut doubted = 0;
        for k in 0..n.pow(4) {
            let four = [0, 1, 2, 3].map(|d| SOME[k / n.pow(d) % n]);
            for reach in [NEAR, FAR] {
                let close = doubtful(four.map(Vec4::splat), reach) & 1 == 1;
                assert_eq!(doubt(four, reach) > 0.0, close, "{four:?}");
                doubted += usize::from(close);
            }
        }
        assert!(doubted > 100, "{doubted}");
    }

    #[test]
    fn a_doubtful_edge_is_found_wherever_it_is() {
        let plain: Values = [5.0; NODES * NODES];
        for reach in [NEAR, FAR] {
            assert!(!sifted(&plain, reach));
            for at in 0..NODES * NODES {
                for (step, fits) in
                    [(1, at % NODES < LEAF), (NODES, at / NODES < LEAF)]
                {
                    if fits {
                        let mut leaf = plain;
                        (leaf[at], leaf[at + step]) = (0.1, 0.1);
                        assert!(sifted(&leaf, reach), "{at} {step}");
                    }
                }
            }
        }
    }
}
