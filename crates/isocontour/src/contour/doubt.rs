//! Finds the cells that may hide what their nodes do not show.
//!
//! ```text
//!   f │ \                   /        Four nodes in a row are all outside. A
//!     │   •               •          field that goes on as it comes from either
//!     │     \           /            side passes zero in between. There may be
//!     │       •       •              a wall, a slit, an island or a hole that
//!   0 ┼─────────\───/────────        is thinner than the lattice is wide.
//!     │           V
//! ```
//!
//! A field that is convex between the nodes, as it is near a thin wall, lies
//! above the two lines, so no feature that reaches the row is missed. The lines
//! count as reaching farther than that, for features that lie between two rows.
//!
//! Not guaranteed: that a feature shows where another feature's field hides it
//! from all of the nodes around it.

use super::samples::Eyes;
use crate::cells::{Place, bits};
use crate::field::{FieldError, LEAF, Leaf, NODES};
use glam::DVec2;
use pulp::{Arch, Simd, WithSimd};

/// The field is carried on from both sides with the slope that it has there,
/// each time to zero. An edge is doubtful if the ways from its nodes to these
/// two zeros add up to fewer cells than this. A sum below 1 means that the two
/// zeros have passed each other on the row itself, as they do for every feature
/// that reaches the row. A pin half a cell off the row shows by about 1.6.
const NEAR: f32 = 1.0;
const FAR: f32 = 1.6;
/// Greatest number of doubtful cells of a leaf that are looked into, where the
/// lattice is as fine as the smallest feature. A field with more is noise.
const MOST_CELLS: usize = 16;

/// A leaf's values.
type Values = [f32; NODES * NODES];

/// Looks through leaves for those with a doubtful edge. Most leaves have no
/// such edge, which is quicker to find out than which edges are doubtful.
struct Sift<'a> {
    leaves: &'a [Values],
    reach: f32,
    /// True for each leaf with a doubtful edge.
    out: &'a mut Vec<bool>,
}

/// The lines at each of a leaf's borders, from the border inwards.
const BORDERS: [[usize; 3]; 2] = [[0, 1, 2], [LEAF, LEAF - 1, LEAF - 2]];
/// How many numbers are looked at together.
const WIDTH: usize = 8;

/// Greater than zero if the field may pass zero between two neighbouring nodes
/// with values `a` and `b` of one sign; `before` and `after` are the values at
/// the nodes beside them.
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

/// Greater than zero if the field may pass zero on an edge from `a` at a leaf's
/// border inwards to `b`, whatever is at the node beyond the border. The field
/// there counts as at most four times as steep as inside.
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
    /// Looks at edges between nodes that are `step` places apart, with a node
    /// on either side. Along x some of these edges reach from one row into the
    /// next, which does no harm.
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

    /// Looks at edges from the nodes of a border to the nodes of the next line
    /// inwards.
    #[inline(always)]
    fn border(
        &self,
        [first, second, third]: [&Line; 3],
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
            for rows in [false, true] {
                let lines = lines(leaf, rows);
                for nodes in BORDERS {
                    self.border(nodes.map(|k| &lines[k]), &mut best);
                }
            }
            self.out.push(best != [0.0; WIDTH]);
        }
    }
}

/// The values along a line of a leaf's nodes.
type Line = [f32; NODES];

/// A leaf's lines, across the edges that are looked at: its columns, or its
/// rows.
fn lines(values: &Values, rows: bool) -> [Line; NODES] {
    let at = |i: usize, j: usize| values[j * NODES + i];
    std::array::from_fn(|k| {
        std::array::from_fn(|n| if rows { at(n, k) } else { at(k, n) })
    })
}

/// The places on some lines where a doubt about the values is greater than
/// zero: a bit for each place.
fn places<const N: usize>(
    lines: [&Line; N],
    doubt: impl Fn([f32; N]) -> f32,
) -> u16 {
    (0..NODES)
        .map(|k| u16::from(doubt(lines.map(|line| line[k])) > 0.0) << k)
        .sum()
}

/// An edge at a leaf's border, in doubt until the node beyond is known.
struct Border {
    leaf: usize,
    /// The values at the edge's nodes, from the border inwards, and at the node
    /// after them.
    inner: [f32; 3],
    /// The cells beside the edge, in the leaf.
    cells: [Option<[usize; 2]>; 2],
}

/// The doubtful cells of a batch, in order. If only a `few` per leaf are
/// wanted, leaves with more are left out, and returned separately.
pub(super) fn doubts(
    leaves: &[Leaf],
    values: &[f32],
    few: bool,
    eyes: &mut Eyes<'_>,
) -> Result<(Vec<Place>, Vec<usize>), FieldError> {
    let mut found: Vec<Place> = Vec::new();
    let mut borders: Vec<Border> = Vec::new();
    let reach = if few { NEAR } else { FAR };
    eyes.clear();
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
        // Edges along x come first, then those along y. `k` counts along the
        // edges, `across` counts across them.
        for flip in [false, true] {
            let lines = lines(values, flip);
            let cells = |k: usize, across: usize| {
                let cell = |across: usize| {
                    if !flip { [k, across] } else { [across, k] }
                };
                let below = across.checked_sub(1).map(cell);
                [below, (across < LEAF).then(|| cell(across))]
            };
            for k in 1..LEAF - 1 {
                let four = [k - 1, k, k + 1, k + 2].map(|k| &lines[k]);
                for across in bits(places(four, |f| doubt(f, reach))) {
                    let cells = cells(k, across).into_iter().flatten();
                    found.extend(cells.map(|c| (n, c)));
                }
            }
            let ends = [(0, -1), (LEAF - 1, LEAF as i64 + 1)];
            for (nodes, (k, beyond)) in BORDERS.into_iter().zip(ends) {
                let three = nodes.map(|k| &lines[k]);
                let may = |f| doubt_at_border(f, reach);
                for across in bits(places(three, may)) {
                    let inner = three.map(|line| line[across]);
                    let (dx, dy) = if !flip {
                        (beyond, across as i64)
                    } else {
                        (across as i64, beyond)
                    };
                    let node = |axis: &[f32], from: usize, d: i64| {
                        let last = axis.len() as i64 - 1;
                        let k = (from as i64 + d).clamp(0, last);
                        f64::from(axis[k as usize])
                    };
                    let p = DVec2::new(
                        node(&eyes.lattice.x, leaf.i, dx),
                        node(&eyes.lattice.y, leaf.j, dy),
                    );
                    eyes.push(p, eyes.z[leaf.layer]);
                    borders.push(Border {
                        leaf: n,
                        inner,
                        cells: cells(k, across),
                    });
                }
            }
        }
    }
    for (b, &beyond) in borders.iter().zip(eyes.values()?) {
        let [first, second, third] = b.inner;
        if doubt([beyond, first, second, third], reach) > 0.0 {
            let cells = b.cells.into_iter().flatten();
            found.extend(cells.map(|c| (b.leaf, c)));
        }
    }
    found.sort_unstable();
    found.dedup();
    let mut many = Vec::new();
    if few {
        let of_leaf = found.chunk_by(|a, b| a.0 == b.0);
        many.extend(of_leaf.filter(|f| f.len() > MOST_CELLS).map(|f| f[0].0));
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
