//! The cells of marching squares: which edges the outline joins, given the
//! corners that are inside.
//!
//! ```text
//!   tl ──N── tr      Corner bits: bl 1, br 2, tr 4, tl 8.
//!   │        │       A segment runs from edge to edge with the inside on its
//!   W        E       left.
//!   │        │
//!   bl ──S── br
//! ```

const S: u8 = 0;
const E: u8 = 1;
const N: u8 = 2;
const W: u8 = 3;

/// Segments of each case. In the ambiguous cases 5 and 10 the cell's centre
/// counts as outside.
const CASES: [&[(u8, u8)]; 16] = [
    &[],
    &[(S, W)],
    &[(E, S)],
    &[(E, W)],
    &[(N, E)],
    &[(S, W), (N, E)],
    &[(N, S)],
    &[(N, W)],
    &[(W, N)],
    &[(S, N)],
    &[(E, S), (W, N)],
    &[(E, N)],
    &[(W, E)],
    &[(S, E)],
    &[(W, S)],
    &[],
];

/// Segments of the ambiguous cases with the centre inside.
const JOINED_5: &[(u8, u8)] = &[(N, W), (S, E)];
const JOINED_10: &[(u8, u8)] = &[(W, S), (E, N)];

/// The segments of a case. In the ambiguous ones it is asked whether the cell's
/// centre is inside.
pub(crate) fn segments(
    case: usize,
    mut is_joined: impl FnMut() -> bool,
) -> &'static [(u8, u8)] {
    match case {
        5 if is_joined() => JOINED_5,
        10 if is_joined() => JOINED_10,
        _ => CASES[case],
    }
}

/// A cell of a batch: its leaf, and its column and row in the leaf.
pub(crate) type Place = (usize, [usize; 2]);

/// The numbers of the bits that are set.
pub(crate) fn bits(mut mask: u16) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        if mask == 0 {
            return None;
        }
        let i = mask.trailing_zeros() as usize;
        mask &= mask - 1;
        Some(i)
    })
}
