//! Puts the two halves of an area together that was cut along a line.
//!
//! ```text
//!      low ┆ high           The halves' borders run along the cut to and fro.
//!     ┌──→─┆─→──┐           Where they do, both are taken out, and the chains
//!     │   ↑┆↓   │           that are left are linked where they end. Rounding
//!     └──←─┆─←──┘           may leave the ends of one half some nanometres
//!                           beside those of the other: a step in the border.
//! ```
//!
//! In: the two halves' rings, whose points lie on or beyond the line exactly.
//! Out: rings around what is in either half. A ring that meets the line in single
//! points only stays as it is.

use super::joints::{Chain, Joints};
use super::{Area, Ring, edges};
use glam::DVec2;
use std::collections::BTreeMap;

/// A line along which an area was cut.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cut {
    /// The coordinate that is the same all along it: 0 for x, 1 for y.
    pub(super) axis: usize,
    pub(super) at: f64,
}

impl Cut {
    fn has(self, p: DVec2) -> bool {
        p[self.axis] == self.at
    }

    /// How far along the line a point is.
    fn along(self, p: DVec2) -> Along {
        Along(p[1 - self.axis])
    }

    fn point(self, along: Along) -> DVec2 {
        match self.axis {
            0 => DVec2::new(self.at, along.0),
            _ => DVec2::new(along.0, self.at),
        }
    }
}

/// A coordinate that can be sorted. Points are on a grid, so there is no -0.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Along(f64);

impl Eq for Along {}

impl PartialOrd for Along {
    fn partial_cmp(&self, other: &Along) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Along {
    fn cmp(&self, other: &Along) -> std::cmp::Ordering {
        self.0.total_cmp(&other.0)
    }
}

/// What is in either half.
pub(super) fn joined(halves: [Area; 2], cut: Cut) -> Area {
    let mut rings = Vec::new();
    let mut chains = Vec::new();
    let mut steps = BTreeMap::new();
    for ring in halves.into_iter().flat_map(|half| half.rings) {
        if edges(&ring).any(|(a, b)| cut.has(a) && cut.has(b)) {
            take_apart(&ring, cut, &mut chains, &mut steps);
        } else {
            rings.push(ring);
        }
    }
    chains.extend(left_over(&steps, cut));
    rings.extend(linked(&chains, cut));
    Area { rings }
}

/// Divides a ring into the chains between its edges along the cut. How often it
/// runs along the cut, more often forwards than backwards, changes at the ends
/// of these edges by `steps`.
fn take_apart(
    ring: &[DVec2],
    cut: Cut,
    chains: &mut Vec<Ring>,
    steps: &mut BTreeMap<Along, i64>,
) {
    let n = ring.len();
    let next = |i: usize| (i + 1) % n;
    let is_on = |i: usize| cut.has(ring[i]) && cut.has(ring[next(i)]);
    let Some(first) = (0..n).find(|i| is_on(*i)) else {
        return;
    };
    let mut chain = Ring::new();
    for i in (first..n).chain(0..first) {
        let (a, b) = (ring[i], ring[next(i)]);
        if is_on(i) {
            *steps.entry(cut.along(a)).or_default() += 1;
            *steps.entry(cut.along(b)).or_default() -= 1;
            if !chain.is_empty() {
                chains.push(std::mem::take(&mut chain));
            }
        } else {
            if chain.is_empty() {
                chain.push(a);
            }
            chain.push(b);
        }
    }
    if !chain.is_empty() {
        chains.push(chain);
    }
}

/// The edges along the cut that have none against them.
fn left_over(steps: &BTreeMap<Along, i64>, cut: Cut) -> Vec<Ring> {
    let mut count = 0;
    let mut all = Vec::new();
    for ((from, step), to) in steps.iter().zip(steps.keys().skip(1)) {
        count += step;
        let (a, b) = (cut.point(*from), cut.point(*to));
        let edge = if count > 0 { [a, b] } else { [b, a] };
        all.extend((0..count.unsigned_abs()).map(|_| edge.to_vec()));
    }
    all
}

/// An end of a chain at the cut: the chain, and the way from the cut.
struct End {
    chain: usize,
    begins: bool,
    way: DVec2,
}

/// The rings that chains make. As many begin at each place as end there.
fn linked(chains: &[Ring], cut: Cut) -> Vec<Ring> {
    let mut ends: BTreeMap<Along, Vec<End>> = BTreeMap::new();
    for (chain, points) in chains.iter().enumerate() {
        let [a, b, .., c, d] = both_ends(points);
        let mut add = |p: DVec2, towards: DVec2, begins| {
            let way = towards - p;
            let end = End { chain, begins, way };
            ends.entry(cut.along(p)).or_default().push(end);
        };
        add(a, b, true);
        add(d, c, false);
    }
    let mut joints = Joints::new(chains.len());
    for ends in ends.values_mut() {
        pair(ends, &mut joints);
    }
    // Rings begin at the last end of a piece, and so lead backwards.
    let ring = |chain: &Chain| -> Ring {
        let pieces = chain.pieces.iter().rev().map(|(i, _)| &chains[*i]);
        let points = pieces.flat_map(|p| p.iter().take(p.len() - 1));
        points.copied().collect()
    };
    joints
        .chains()
        .iter()
        .map(ring)
        .filter(|r| r.len() >= 3)
        .collect()
}

/// The first two and the last two points of a chain, which has two at least.
fn both_ends(points: &[DVec2]) -> [DVec2; 4] {
    match points {
        [a, b, .., c, d] => [*a, *b, *c, *d],
        [a, b, c] => [*a, *b, *b, *c],
        [a, b] => [*a, *b, *a, *b],
        _ => [DVec2::ZERO; 4],
    }
}

/// Joins each chain that ends at a place to the one that begins there next,
/// clockwise, since the inside is to the left.
fn pair(ends: &mut [End], joints: &mut Joints) {
    ends.sort_by(|a, b| turn(b.way).total_cmp(&turn(a.way)));
    let mut waiting = Vec::new();
    // Twice round: what waits at the end of the first time goes on in the second.
    let mut taken = vec![false; ends.len()];
    for (i, end) in ends.iter().enumerate().chain(ends.iter().enumerate()) {
        match (end.begins, taken[i]) {
            (_, true) => {}
            (false, false) => {
                taken[i] = true;
                waiting.push(end.chain);
            }
            (true, false) => {
                if let Some(from) = waiting.pop() {
                    taken[i] = true;
                    joints.join(2 * from + 1, 2 * end.chain);
                }
            }
        }
    }
}

/// A number that grows with the angle of a way from that along x, from -2 to 2.
fn turn(way: DVec2) -> f64 {
    let along = way.x / (way.x.abs() + way.y.abs());
    if way.y < 0.0 {
        along - 1.0
    } else {
        1.0 - along
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rect;

    const AT_2: Cut = Cut { axis: 0, at: 2.0 };

    fn area(rings: &[&[[f64; 2]]]) -> Area {
        let ring = |r: &&[[f64; 2]]| r.iter().map(|p| (*p).into()).collect();
        Area {
            rings: rings.iter().map(ring).collect(),
        }
    }

    #[test]
    fn a_rectangle_is_whole_again() {
        for (halves, cut) in [
            ([rect(0.0, 0.0, 2.0, 3.0), rect(2.0, 0.0, 5.0, 3.0)], AT_2),
            (
                [rect(0.0, 0.0, 5.0, 1.0), rect(0.0, 1.0, 5.0, 3.0)],
                Cut { axis: 1, at: 1.0 },
            ),
        ] {
            let whole = joined(halves, cut);
            assert_eq!(whole.rings.len(), 1, "{whole:?}");
            assert_eq!(whole.content(), 15.0);
        }
    }

    #[test]
    fn a_ring_around_a_hole_is_two_rings() {
        let low = area(&[&[
            [0.0, 0.0],
            [2.0, 0.0],
            [2.0, 1.0],
            [1.0, 1.0],
            [1.0, 2.0],
            [2.0, 2.0],
            [2.0, 3.0],
            [0.0, 3.0],
        ]]);
        let high = area(&[&[
            [2.0, 0.0],
            [4.0, 0.0],
            [4.0, 3.0],
            [2.0, 3.0],
            [2.0, 2.0],
            [3.0, 2.0],
            [3.0, 1.0],
            [2.0, 1.0],
        ]]);
        let whole = joined([low, high], AT_2);
        let contents: Vec<f64> =
            whole.rings.iter().map(|r| crate::signed_area(r)).collect();
        assert_eq!(contents, [-2.0, 12.0]);
    }

    #[test]
    fn what_one_half_has_more_of_stays() {
        let halves = [rect(0.0, 0.0, 2.0, 3.0), rect(2.0, 0.5, 5.0, 2.5)];
        let whole = joined(halves, AT_2);
        assert_eq!(whole.rings.len(), 1);
        assert_eq!(whole.content(), 12.0);
    }

    #[test]
    fn islands_that_meet_in_a_corner_do_not_cross() {
        // Each half has two pieces that meet in a point of the cut.
        let low: [&[[f64; 2]]; 2] = [
            &[[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 1.0]],
            &[[0.0, 3.0], [2.0, 2.0], [2.0, 4.0], [0.0, 4.0]],
        ];
        let high: [&[[f64; 2]]; 2] = [
            &[[2.0, 0.0], [4.0, 0.0], [4.0, 1.0], [2.0, 2.0]],
            &[[2.0, 2.0], [4.0, 3.0], [4.0, 4.0], [2.0, 4.0]],
        ];
        let whole = joined([area(&low), area(&high)], AT_2);
        assert_eq!(whole.rings.len(), 2, "{whole:?}");
        assert!(whole.rings.iter().all(|r| crate::signed_area(r) == 6.0));
    }

    #[test]
    fn rings_beside_the_cut_stay() {
        let low = rect(0.0, 0.0, 1.0, 1.0);
        let high = area(&[&[[2.0, 0.0], [3.0, 0.0], [3.0, 1.0]]]);
        let whole = joined([low.clone(), high.clone()], AT_2);
        let rings: Vec<Ring> =
            low.rings.into_iter().chain(high.rings).collect();
        assert_eq!(whole.rings, rings);
    }
}
