//! Moves the corners of a thinned path to where they fit the path best.

use super::points::{Joint, Points};
use crate::Length;
use glam::DVec2;

/// Number of rounds in which each corner is fitted to its neighbours. Each
/// round leaves a quarter of the error, since a corner weighs twice as much as
/// both neighbours.
const ROUNDS: usize = 8;

/// Number of tries to fit the corners. After them all corners are held back.
const TRIES: usize = 16;

/// A point of the path, seen from the edge that replaces it: how far along the
/// edge it lies, from 0 to 1, and how far to the left.
type Seen = (f64, Length);

/// Moves each corner across the path so that the squares of the distances
/// between the path and its edges are least.
///
/// Corners that stay do not move. Corners beside an edge that would be farther
/// from the path than `tolerance` move by at most `least`. So edges that are
/// off by no more than the difference remain within the tolerance. The first
/// corner of a closed path is listed again at the end.
pub(super) fn settle(
    points: &Points<'_>,
    joints: &mut [Joint],
    tolerance: Length,
    least: Length,
) {
    let mut fit = Fit::new(points, joints);
    fit.solve();
    let mut tries = 0;
    while fit.hold_where_off(tolerance, least) {
        tries += 1;
        // Holding back one corner after another would take time by the square
        // of their number.
        if tries == TRIES {
            fit.hold_all(least);
        }
        fit.solve();
    }
    fit.apply(joints);
}

/// How far a corner moves, and in which direction.
#[derive(Clone, Copy)]
struct Move {
    /// Direction in which a move by one unit takes both edges a unit to their
    /// left, as far as the angle between them permits.
    way: DVec2,
    by: Length,
    /// Greatest way of the corner to either side.
    most: Length,
    /// The best move if the corner's neighbours do not move.
    best: Length,
    /// By how much the best move is less for each unit by which the corner
    /// before it moves, and the corner after it.
    less: [f64; 2],
}

/// What an edge contributes to the moves of the corners at its ends.
#[derive(Clone, Copy)]
struct Edge {
    left: DVec2,
    length: Length,
    /// How far the path is to the left of the edge, summed over its length, and
    /// weighted by the nearness of its beginning, and of its end.
    off: [f64; 2],
    /// Where the points that it replaces end in [`Fit::seen`].
    end: usize,
}

/// The corners and edges of a path, and how far the corners move.
struct Fit {
    /// One move for each corner. The first corner of a closed path is not
    /// repeated.
    moves: Vec<Move>,
    /// Edge `i` goes from corner `i` to the next corner.
    edges: Vec<Edge>,
    /// The points that edges replace, edge by edge.
    seen: Vec<Seen>,
}

impl Fit {
    fn new(points: &Points<'_>, joints: &[Joint]) -> Self {
        let mut seen: Vec<Seen> =
            Vec::with_capacity(points.all.len() + 2 * joints.len());
        let edges: Vec<Edge> = joints
            .windows(2)
            .map(|ends| {
                let along = ends[1].at - ends[0].at;
                let mut off = [0.0; 2];
                let begin = seen.len();
                seen.extend(replaced(points, &ends[0], &ends[1]));
                for step in seen[begin..].windows(2) {
                    let ((u, d), (v, e)) = (step[0], step[1]);
                    // Simpson's rule is exact for a product of two linear
                    // functions.
                    let share = (v - u) * along.length() / 6.0;
                    let (middle, mean) = (0.5 * (u + v), 0.5 * (d + e));
                    let end = u * d + 4.0 * middle * mean + v * e;
                    off[0] += share * (6.0 * mean - end);
                    off[1] += share * end;
                }
                Edge {
                    left: along.perp().normalize_or_zero(),
                    length: along.length(),
                    off,
                    end: seen.len(),
                }
            })
            .collect();
        let corners = joints.len() - usize::from(points.closed);
        let ways: Vec<DVec2> = (0..corners)
            .map(|i| {
                let after = i.min(edges.len() - 1);
                let [u, v] =
                    [before(i, &edges), after].map(|edge| edges[edge].left);
                (u + v) / (1.0 + u.dot(v)).max(1.0)
            })
            .collect();
        let moves = (0..corners)
            .map(|i| {
                let before = before(i, &edges);
                let after = (i + 1) % corners;
                let (mut weight, mut asked) = (0.0, 0.0);
                let mut less = [0.0; 2];
                // For each edge beside the corner: the corner at the edge's
                // other end, and the end at which this corner is.
                for (edge, other, end) in [(before, before, 1), (i, after, 0)] {
                    let Some(edge) = edges.get(edge) else {
                        continue;
                    };
                    let leftwards = ways[i].dot(edge.left);
                    let theirs = ways[other].dot(edge.left);
                    weight += leftwards * leftwards * edge.length / 3.0;
                    asked += leftwards * edge.off[end];
                    less[1 - end] = leftwards * theirs * edge.length / 6.0;
                }
                let share = if weight > 0.0 { 1.0 / weight } else { 0.0 };
                Move {
                    way: ways[i],
                    by: 0.0,
                    most: if joints[i].stays { 0.0 } else { f64::INFINITY },
                    best: share * asked,
                    less: less.map(|l| share * l),
                }
            })
            .collect();
        Fit { moves, edges, seen }
    }

    /// Finds the moves by the method of Gauss and Seidel.
    fn solve(&mut self) {
        let n = self.moves.len();
        for _ in 0..ROUNDS {
            let mut before = self.moves.last().map_or(0.0, |m| m.by);
            for i in 0..n {
                let after = self.moves[if i + 1 < n { i + 1 } else { 0 }].by;
                let m = &mut self.moves[i];
                if m.most > 0.0 {
                    let by = m.best - m.less[0] * before - m.less[1] * after;
                    m.by = by.clamp(-m.most, m.most);
                }
                before = m.by;
            }
        }
    }

    /// The corner that follows corner `i`.
    fn after(&self, i: usize) -> usize {
        (i + 1) % self.moves.len()
    }

    /// Holds back the corners beside edges that are farther from the path than
    /// the tolerance: they move by at most `least`. True if one of them could
    /// move farther before.
    fn hold_where_off(&mut self, tolerance: Length, least: Length) -> bool {
        let mut held = false;
        let mut begin = 0;
        for (i, edge) in self.edges.iter().enumerate() {
            let seen =
                &self.seen[std::mem::replace(&mut begin, edge.end)..edge.end];
            let ends = [i, self.after(i)];
            if ends.iter().all(|&k| self.moves[k].most <= least) {
                continue;
            }
            let [from, to] = ends
                .map(|k| self.moves[k].by * self.moves[k].way.dot(edge.left));
            let far =
                |&(u, d): &Seen| (d - from - u * (to - from)).abs() > tolerance;
            if seen.iter().any(far) {
                held = true;
                for k in ends {
                    let m = &mut self.moves[k];
                    m.most = m.most.min(least);
                }
            }
        }
        held
    }

    /// Holds all corners back.
    fn hold_all(&mut self, least: Length) {
        for m in &mut self.moves {
            m.most = m.most.min(least);
        }
    }

    fn apply(&self, joints: &mut [Joint]) {
        let n = self.moves.len();
        for (i, joint) in joints.iter_mut().enumerate() {
            let m = &self.moves[i % n];
            joint.at += m.by * m.way;
        }
    }
}

/// The edge before a corner.
fn before(i: usize, edges: &[Edge]) -> usize {
    (i + edges.len() - 1) % edges.len()
}

/// The points of the path from one corner to another, seen from the edge between
/// them.
fn replaced(
    points: &Points<'_>,
    from: &Joint,
    to: &Joint,
) -> impl Iterator<Item = Seen> {
    let along = to.at - from.at;
    let (start, length) = (from.at, along.length());
    let on = along.normalize_or_zero();
    let inner = (from.place as usize + 1)..(to.place.ceil() as usize);
    let (points, ends) = (*points, [from, to].map(|c| points.place(c.place)));
    std::iter::once(ends[0])
        .chain(inner.map(move |k| points.at(k)))
        .chain([ends[1]])
        .map(move |p| {
            let p = p - start;
            let share = p.dot(on) / length.max(f64::MIN_POSITIVE);
            (share.clamp(0.0, 1.0), on.perp_dot(p))
        })
}
