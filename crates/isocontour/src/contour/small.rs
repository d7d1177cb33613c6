//! Leaves out islands and holes that are too small, and counts them.
//!
//! ```text
//!    ___________________________        Where two surfaces touch they leave a
//!   |                            \      crack that tapers off. Where the crack
//!   |   outside  ________________/      is thinner than the distance of a cell's
//!   |___________/   ·· · — ·· ·  crack  finest samples, only pieces are found.
//! ```
//!
//! A ring is too small if it is shorter than the smallest feature, or if it is
//! thinner than the accuracy. Without a thin ring the outline is just as
//! accurate, and the ring only tells where the samples happened to be. Pieces
//! that lie together count as one.

use super::Detail;
use super::link::Joined;
use crate::plane::{Rect, Ring, edges, ring_length, signed_area};
use glam::DVec2;

/// True if a ring is to be left out.
fn is_small(ring: &[DVec2], detail: Detail) -> bool {
    let r = Rect::around(ring);
    let extent = r.size().max_element();
    if extent < detail.smallest {
        return true;
    }
    // A ring's content is about its width times half its length. Most rings
    // have more than this limit even with the sum of their steps along both
    // axes as length.
    let least = 0.5 * detail.accuracy;
    let content = signed_area(ring).abs();
    let steps: f64 =
        edges(ring).map(|(a, b)| (b - a).abs().element_sum()).sum();
    content < least * steps && content < least * ring_length(ring)
}

/// Takes out the rings that are too small, and returns the number of places
/// where there were any.
pub(super) fn leave_out(rings: &mut Vec<Joined>, detail: Detail) -> usize {
    let mut small: Vec<Ring> = Vec::new();
    rings.retain_mut(|ring| {
        let leave = is_small(&ring.points, detail);
        if leave {
            small.push(std::mem::take(&mut ring.points));
        }
        !leave
    });
    places(&small, 2.0 * detail.smallest)
}

/// The number of groups of rings. Rings form a group if they lie in one square
/// of a given size, or in neighbouring squares.
fn places(rings: &[Ring], size: f64) -> usize {
    if size <= 0.0 {
        return rings.len();
    }
    let square = |p: DVec2| {
        let k = (p / size).floor();
        (k.x as i64, k.y as i64)
    };
    let points = rings.iter().flat_map(|r| edges(r)).flat_map(|(a, b)| {
        let steps = (a.distance(b) / size).ceil().max(1.0);
        (0..steps as usize).map(move |k| a.lerp(b, k as f64 / steps))
    });
    let mut free: Vec<(i64, i64)> = points.map(square).collect();
    free.sort_unstable();
    free.dedup();
    let mut seen = vec![false; free.len()];
    let mut count = 0;
    let mut todo = Vec::new();
    for first in 0..free.len() {
        if seen[first] {
            continue;
        }
        count += 1;
        seen[first] = true;
        todo.push(first);
        while let Some(k) = todo.pop() {
            let (x, y) = free[k];
            for i in x.saturating_sub(1)..=x.saturating_add(1) {
                for j in y.saturating_sub(1)..=y.saturating_add(1) {
                    if let Ok(n) = free.binary_search(&(i, j))
                        && !seen[n]
                    {
                        seen[n] = true;
                        todo.push(n);
                    }
                }
            }
        }
    }
    count
}

#[cfg(test)]
mod tests {
    use super::*;

    fn block(x: f64, y: f64, w: f64, h: f64) -> Joined {
        let points = [(0.0, 0.0), (w, 0.0), (w, h), (0.0, h)];
        let points = points.map(|(a, b)| DVec2::new(x + a, y + b));
        Joined {
            points: points.to_vec(),
            fixed: vec![true; 4],
        }
    }

    #[test]
    fn specks_and_cracks_are_left_out_and_counted_by_place() {
        let detail = Detail {
            accuracy: 0.005,
            smallest: 0.11,
        };
        let mut rings = vec![
            block(0.0, 0.0, 5.0, 5.0),
            // This ring is thin, but not as thin as the accuracy.
            block(1.0, 1.0, 2.0, 0.012),
            // These are a crack in three pieces.
            block(1.0, 3.0, 0.4, 0.002),
            block(1.6, 3.0, 0.05, 0.001),
            block(1.9, 3.0, 0.9, 0.004),
            // These specks are far from the crack and from each other.
            block(7.0, 0.0, 0.1, 0.1),
            block(9.0, 0.0, 0.1, 0.1),
        ];
        assert_eq!(leave_out(&mut rings, detail), 3);
        assert_eq!(rings.len(), 2);
    }
}
