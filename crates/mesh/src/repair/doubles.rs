//! Triangles with the same corners.
//!
//! Of those that go round the same way one is enough. Two that go round opposite
//! ways bound nothing. They are left out together, unless all that hangs together
//! is made of such pairs: that is a surface given from both sides, of which one
//! is kept.

use crate::edges::each_edge;
use isoslice_base::sets::Sets;

/// A list of triangles with the same corners, by which of them counts.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    /// It is kept.
    Single,
    /// As many others go round the opposite way.
    Pair,
    Left,
}

/// Leaves out triangles. Returns how many.
pub(super) fn leave_out(corners: &mut Vec<[u32; 3]>, vertices: usize) -> usize {
    let mut kinds = vec![Kind::Single; corners.len()];
    let mut order: Vec<(([u32; 3], bool), u32)> = corners
        .iter()
        .enumerate()
        .map(|(i, corners)| (sorted(*corners), i as u32))
        .collect();
    order.sort_unstable_by_key(|((corners, _), i)| (*corners, *i));
    let mut pairs = false;
    for same in order.chunk_by(|a, b| a.0.0 == b.0.0) {
        if same.len() == 1 {
            continue;
        }
        let even = same.iter().filter(|t| t.0.1).count();
        let odd = same.len() - even;
        let kept = same.iter().find(|t| t.0.1 == (even > odd) || even == odd);
        for (_, i) in same {
            kinds[*i as usize] = Kind::Left;
        }
        if let Some((_, i)) = kept {
            pairs |= even == odd;
            kinds[*i as usize] = if even == odd {
                Kind::Pair
            } else {
                Kind::Single
            };
        }
    }
    drop(order);
    if pairs {
        leave_out_pairs(corners, vertices, &mut kinds);
    }
    let before = corners.len();
    let mut kinds = kinds.iter();
    corners.retain(|_| kinds.next() != Some(&Kind::Left));
    before - corners.len()
}

/// Leaves out pairs that hang together with single ones.
fn leave_out_pairs(corners: &[[u32; 3]], vertices: usize, kinds: &mut [Kind]) {
    let mut sets = Sets::new(corners.len());
    each_edge(corners, vertices, |edge| {
        let mut sides = edge.sides().map(|s| s.triangle as usize);
        if let Some(first) = sides.next() {
            sides.for_each(|other| _ = sets.join(first, other));
        }
    });
    let mut has_single = vec![false; corners.len()];
    for (i, kind) in kinds.iter().enumerate() {
        has_single[sets.of(i)] |= *kind == Kind::Single;
    }
    for (i, kind) in kinds.iter_mut().enumerate() {
        if *kind == Kind::Pair && has_single[sets.of(i)] {
            *kind = Kind::Left;
        }
    }
}

/// Corners in order, and true if that takes an even number of swaps.
fn sorted([a, b, c]: [u32; 3]) -> ([u32; 3], bool) {
    let is_even = (a < b) as u8 + (b < c) as u8 + (c < a) as u8 == 2;
    let mut corners = [a, b, c];
    corners.sort_unstable();
    (corners, is_even)
}
