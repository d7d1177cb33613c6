//! The places of the turn below from which the points of a turn go on.
//!
//! ```text
//!     p0   p1    p2   p3      the layer's middle line, which the turn ends as
//!   ───●────●────┬─●──●──
//!      ┆    ┆    │ ┆  ┆
//!   ───○────○────┴─○──○──     the middle line of the layer below
//! ```
//!
//! In: a turn's points and the line below, which begins where the turn does. Out: a
//! place on that line for each point, in the same order: a point's nearest place, or,
//! for a corner, the corner beside it. Where these lie in another order, as beside
//! corners that move along the line, those at fault share one place: the positions along
//! the line are fitted by ones that never go back (pool adjacent violators; Barlow
//! et al. 1972). A turn between two lines that run the same way does not fold back
//! on itself then.

use super::ring::{Point, along, corner, sides};
use glam::DVec2;
use isoslice_base::units::Mm;
use isoslice_planar::grid::EdgeGrid;

/// Size of the cells in which the sides of a line are looked up, mm.
const CELL: Mm = 0.5;

/// A corner goes on from one that is no farther away than this many times the distance
/// of the nearest place: as far as corners of 30° are that move towards their tips.
const CORNER_REACH: f64 = 4.0;

/// A place on the other side of a thin part is no place to go on from. One on the right
/// side is looked for no farther away than this, mm: walls that move farther from one
/// layer to the next do not lie on each other.
const OTHER_SIDE: Mm = 2.0;

/// What a corner counts where the order is mended, where a point within a side counts 1.
const CORNER_WEIGHT: f64 = 1e3;

/// What the ends of a turn count, which are known.
const END_WEIGHT: f64 = 1e6;

/// What a point counts that has no place nearby: it goes where its neighbours do.
const LOST_WEIGHT: f64 = 1e-3;

/// Positions that are fitted by one, and what they count.
struct Block {
    position: Mm,
    weight: f64,
    count: usize,
}

/// The place on a line below for each point of a turn.
pub(super) fn feet(points: &[Point], below: &[DVec2]) -> Vec<DVec2> {
    let grid = EdgeGrid::of(sides(below).map(|side| (0, side)), CELL);
    let mut ends = vec![0.0];
    let mut length = 0.0;
    for (a, b) in sides(below) {
        length += a.distance(b);
        ends.push(length);
    }
    // Corners to the right, and those to the left.
    let corners = [false, true].map(|left| {
        let turns = (0..below.len()).map(|i| (i, corner(below, i)));
        let own = turns.filter(|(_, turn)| is_left(*turn) == Some(left));
        EdgeGrid::of(own.map(|(i, _)| (i, (below[i], below[i]))), CELL)
    });
    let position = |p: &Point| -> (Mm, f64) {
        let Some((side, foot)) = foot(&grid, p) else {
            return (p.share * length, LOST_WEIGHT);
        };
        let reach = CORNER_REACH * foot.distance(p.at);
        let beside = is_left(p.corner).and_then(|left| {
            corners[usize::from(left)].nearest_within(p.at, reach)
        });
        let same_way = |i: usize| along(below, i).dot(p.along) > 0.0;
        let beside = beside.filter(|(i, _)| same_way(*i));
        match beside {
            Some((i, _)) => (ends[i], CORNER_WEIGHT),
            None => (ends[side] + below[side].distance(foot), 1.0),
        }
    };
    let last = points.len().saturating_sub(1);
    let positions = points.iter().enumerate().map(|(i, p)| match i {
        0 => (0.0, END_WEIGHT),
        i if i == last => (length, END_WEIGHT),
        _ => {
            let (at, weight) = position(p);
            // The line is closed: of the two ends of it the nearer one counts.
            let turns = (p.share - at / length).round();
            (at + turns * length, weight)
        }
    });
    let at = |position: Mm| {
        let next = ends.partition_point(|end| *end <= position);
        let side = next.clamp(1, below.len()) - 1;
        let (a, b) = (below[side], below[(side + 1) % below.len()]);
        let length = (ends[side + 1] - ends[side]).max(f64::MIN_POSITIVE);
        let share = (position - ends[side]) / length;
        a.lerp(b, share.clamp(0.0, 1.0))
    };
    in_order(positions).map(at).collect()
}

/// True for a corner to the left, false for one to the right, and none for no corner.
fn is_left(corner: f64) -> Option<bool> {
    (corner != 0.0).then_some(corner > 0.0)
}

/// The nearest place of the sides of a line that run about the same way as the turn
/// does at a point, and the number of its side.
fn foot(grid: &EdgeGrid, p: &Point) -> Option<(usize, DVec2)> {
    let same_way = |side: usize| {
        let (a, b) = grid.edge(side);
        (b - a).dot(p.along) > 0.0
    };
    let (side, foot) = grid.foot(p.at)?;
    if same_way(side) {
        return Some((side, foot));
    }
    let mut near = Vec::new();
    grid.visit_edges_near(p.at, p.at, OTHER_SIDE, |side| {
        if same_way(side) {
            near.push(side as u32);
        }
    });
    near.sort_unstable();
    near.dedup();
    grid.nearest_of(&near, p.at, OTHER_SIDE)
}

/// Positions with their weights, fitted by ones that never go back.
fn in_order(
    positions: impl Iterator<Item = (Mm, f64)>,
) -> impl Iterator<Item = Mm> {
    let mut blocks: Vec<Block> = Vec::new();
    for (position, weight) in positions {
        let mut own = Block {
            position,
            weight,
            count: 1,
        };
        while let Some(before) =
            blocks.pop_if(|before| before.position >= own.position)
        {
            let weight = before.weight + own.weight;
            let share = own.weight / weight;
            own = Block {
                position: before.position
                    + share * (own.position - before.position),
                weight,
                count: before.count + own.count,
            };
        }
        blocks.push(own);
    }
    let each = |block: Block| std::iter::repeat_n(block.position, block.count);
    blocks.into_iter().flat_map(each)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spiral::ring::{begin, points};

    fn square(half: f64, at: DVec2) -> Vec<DVec2> {
        let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
        corners.map(|p| at + half * DVec2::from(p)).to_vec()
    }

    #[track_caller]
    fn assert_in_order(feet: &[DVec2], below: &[DVec2]) {
        // The line begins and ends at one place.
        let away = |foot: &&DVec2| foot.distance(below[0]) > 1e-6;
        let positions = feet.iter().filter(away).map(|foot| {
            let mut done = 0.0;
            let mut best = (f64::INFINITY, 0.0);
            for (a, b) in sides(below) {
                let q = isoslice_planar::grid::nearest_on(*foot, a, b);
                if q.distance(*foot) < best.0 - 1e-9 {
                    best = (q.distance(*foot), done + a.distance(q));
                }
                done += a.distance(b);
            }
            best
        });
        let positions: Vec<_> = positions.collect();
        assert!(positions.iter().all(|p| p.0 < 1e-9));
        let in_order = positions.is_sorted_by(|a, b| a.1 <= b.1 + 1e-9);
        assert!(in_order, "{positions:?}");
    }

    #[test]
    fn corners_go_on_from_corners() {
        for (half, at) in [
            (4.8, DVec2::ZERO),
            (5.2, DVec2::ZERO),
            (5.0, DVec2::splat(0.3)),
        ] {
            let ring = square(5.0, DVec2::ZERO);
            let below = begin(&square(half, at), ring[0]);
            let points = points(&ring);
            let feet = feet(&points, &below);
            assert_in_order(&feet, &below);
            // Where the turn begins is known before.
            let all = points.iter().zip(&feet).skip(1);
            for (p, foot) in all.filter(|(p, _)| p.corner != 0.0) {
                let corner = at + half / 5.0 * p.at;
                assert!(foot.distance(corner) < 0.01, "{foot} {corner}");
            }
        }
    }

    /// A strip 0.3 mm wide that moves by more than half of that.
    #[test]
    fn places_on_the_other_side_are_none() {
        let strip = |y: f64| {
            let ring = [(0.0, y), (9.0, y), (9.0, y + 0.3), (0.0, y + 0.3)];
            ring.map(DVec2::from).to_vec()
        };
        let (ring, below) = (strip(0.0), strip(0.2));
        let points = points(&ring);
        let feet = feet(&points, &begin(&below, ring[0]));
        for (p, foot) in points.iter().zip(&feet) {
            assert!(p.at.distance(*foot) < 0.35, "{} {foot}", p.at);
        }
    }

    #[test]
    fn positions_that_go_back_share_one() {
        let given = [(0.0, 1.0), (3.0, 1.0), (1.0, 1.0), (4.0, 1.0)];
        let fitted: Vec<_> = in_order(given.into_iter()).collect();
        assert_eq!(fitted, [0.0, 2.0, 2.0, 4.0]);
    }
}
