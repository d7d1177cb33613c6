//! Triangles with the same corners.
//!
//! Of those that go round the same way one is enough. Of two that go round
//! opposite ways one is kept if the others need it: if more edges of the pairs
//! that hang together have an odd number of other triangles than an even one. If
//! they do not, as where two bodies touch, both are left out. A surface that is
//! given from both sides everywhere has no others, and one side is kept.

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

/// Leaves out pairs that the others do not need.
fn leave_out_pairs(corners: &[[u32; 3]], vertices: usize, kinds: &mut [Kind]) {
    let mut sets = Sets::new(corners.len());
    let mut votes = Vec::new();
    each_edge(corners, vertices, |edge| {
        let mut pair = None;
        let mut others = 0;
        for triangle in edge.sides().map(|s| s.triangle as usize) {
            match (kinds[triangle], pair) {
                (Kind::Single, _) => others += 1,
                (Kind::Pair, None) => pair = Some(triangle),
                (Kind::Pair, Some(first)) => _ = sets.join(first, triangle),
                (Kind::Left, _) => {}
            }
        }
        if let (Some(pair), 1..) = (pair, others) {
            votes.push((pair, if others % 2 == 1 { 1 } else { -1 }));
        }
    });
    let mut needs = vec![0; corners.len()];
    for (pair, vote) in votes {
        needs[sets.of(pair)] += vote;
    }
    for (i, kind) in kinds.iter_mut().enumerate() {
        if *kind == Kind::Pair && needs[sets.of(i)] < 0 {
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
