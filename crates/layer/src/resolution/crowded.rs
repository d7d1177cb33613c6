//! Thins a path more where its moves would be short.
//!
//! ```text
//!   •────────────•─•─•────────────•──────────•   thinned alike everywhere
//!   A                             B          C
//!   •─────────────•───────────────•──────────•   thinned more from A to B
//! ```
//!
//! In: the points of a path. Out: fewer of them. Guaranteed: the path is within
//! the greater tolerance, and within the smaller one where all moves are long.

use glam::DVec2;
use isoslice_base::units::Mm;
use isoslice_planar::simplify::simplify_line;

/// Length, mm, below which moves are short: at 60 mm/s they come at 200 a second,
/// which is what the slowest printers take. Circles of more than 7.5 mm across have
/// longer ones if they are within the usual tolerance of what shows.
const SHORT: Mm = 0.3;

/// Moves too many, for their length, from which on a stretch is thinned more. The
/// short rest where a circle closes is less.
const TOO_MANY: f64 = 0.7;

/// Share of the greater tolerance that a stretch between long moves may be off. With
/// all of it 99 % of the walls of a scan are within 8.1 µm of it, not 6.8, and take
/// 1 % fewer moves.
const STRETCH: f64 = 0.8;

/// A path that is thinned.
struct Thinned<'a> {
    path: &'a [DVec2],
    closed: bool,
    /// Its points, each with the number of the path's point for which it stands.
    points: Vec<(DVec2, usize)>,
}

/// A path with few points: within `fine` of it, but within `coarse` where its moves
/// would be short.
pub(super) fn thinned(
    path: &[DVec2],
    closed: bool,
    fine: Mm,
    coarse: Mm,
) -> Vec<DVec2> {
    let points = simplify_line(path, closed, fine);
    let thinned = Thinned {
        path,
        closed,
        points,
    };
    thinned.eased(coarse.max(fine), (STRETCH * coarse).max(fine))
}

impl Thinned<'_> {
    fn at(&self, k: usize) -> DVec2 {
        self.points[k % self.points.len()].0
    }

    /// Length of the move from a point to the next one.
    fn length(&self, k: usize) -> Mm {
        self.at(k).distance(self.at(k + 1))
    }

    /// True for a point between two long moves, and for the ends of an open path.
    fn stays(&self, k: usize) -> bool {
        let n = self.points.len();
        let is_end = !self.closed && (k == 0 || k == n - 1);
        is_end || (self.length(k + n - 1) >= SHORT && self.length(k) >= SHORT)
    }

    /// The path with fewer points: within one tolerance if there are no long moves
    /// that meet, else within another one between them.
    fn eased(&self, whole: Mm, stretch: Mm) -> Vec<DVec2> {
        let n = self.points.len();
        let more = || alone(simplify_line(self.path, self.closed, whole));
        let Some(first) = (0..n).find(|&k| self.stays(k)) else {
            return more();
        };
        let last = if self.closed { first + n } else { n - 1 };
        let mut out = vec![self.at(first)];
        let mut from = first;
        while from < last {
            let next = (from + 1..last).find(|&k| self.stays(k % n));
            let to = next.unwrap_or(last);
            if self.is_crowded(from, to) {
                let run = self.run(from, to);
                let run = alone(simplify_line(&run, false, stretch));
                out.extend(&run[1..]);
            } else {
                out.extend((from + 1..=to).map(|k| self.at(k)));
            }
            from = to;
        }
        if self.closed {
            out.pop();
        }
        // A ring narrower than the tolerance may fold over.
        if self.closed && out.len() < 3 {
            return alone(self.points.clone());
        }
        out
    }

    /// True if the moves between two points are too many for their length. The
    /// first and the last move of an open path do not count: the path ends where
    /// it should, and so a rest is left.
    fn is_crowded(&self, from: usize, to: usize) -> bool {
        let rest = self.points.len().saturating_sub(2);
        let counts = |k: &usize| self.closed || (*k != 0 && *k != rest);
        let short = |k| (1.0 - self.length(k) / SHORT).max(0.0);
        (from..to).filter(counts).map(short).sum::<f64>() > TOO_MANY
    }

    /// The path between two of the points that are left, with these as its ends.
    fn run(&self, from: usize, to: usize) -> Vec<DVec2> {
        let n = self.path.len();
        let place = |k: usize| self.points[k % self.points.len()].1;
        let (begin, end) = (place(from), place(to));
        let is_whole = to - from == self.points.len();
        let count = if is_whole { n } else { (end + n - begin) % n };
        let mut run = vec![self.at(from)];
        run.extend((1..count).map(|k| self.path[(begin + k) % n]));
        run.push(self.at(to));
        run
    }
}

/// The points alone.
fn alone(points: Vec<(DVec2, usize)>) -> Vec<DVec2> {
    points.into_iter().map(|(point, _)| point).collect()
}
