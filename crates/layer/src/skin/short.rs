//! Pieces of a path that are too short for a role of their own.
//!
//! In: a path's pieces, each of another role than the one before. Out: the
//! path's pieces again, where each short one has taken the role of the longer
//! one beside it and is joined with it. The shortest piece comes first, and a
//! piece that has grown is measured again. A heap makes that n·log n steps for
//! n pieces.

use isoslice_base::units::Mm;
use isoslice_planar::bead::{Role, Stroke};
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Pieces shorter than this go with what is beside them, mm.
const SHORT: Mm = 1.0;
/// Hidden pieces shorter than this, mm, do so, too. Over so short a line a machine
/// does not reach its speed, and the way to each such line takes time as well: on a
/// floor with walls of 2 mm around it, 10 s of 70 s for the layer.
const SHORT_HIDDEN: Mm = 4.0;

/// Length below which a piece of a role goes with what is beside it.
fn short(role: Role) -> Mm {
    if role == Role::InternalSkin {
        SHORT_HIDDEN
    } else {
        SHORT
    }
}

/// Gives short pieces the role of the longer one beside them, the shortest
/// first.
pub(super) fn join_short(pieces: Vec<(Role, Stroke)>) -> Vec<(Role, Stroke)> {
    if pieces.len() < 2 {
        return pieces;
    }
    let mut runs = Runs::new(&pieces);
    let mut waiting: BinaryHeap<Reverse<Waiting>> = (0..pieces.len())
        .map(|i| Reverse(runs.waiting(i)))
        .collect();
    while let Some(Reverse(next)) = waiting.pop() {
        if f64::from_bits(next.length) >= SHORT_HIDDEN {
            break;
        }
        if isoslice_base::limits::is_stopped() {
            break;
        }
        // An entry is out of date if its run has grown since, or is part of
        // another run.
        let run = &runs.all[next.first];
        if run.last == Some(next.last)
            && f64::from_bits(next.length) < short(run.role)
            && let Some(grown) = runs.join(next.first)
        {
            waiting.push(Reverse(runs.waiting(grown)));
        }
    }
    runs.of(pieces)
}

/// Pieces in a row that have become one. A run is known by its first piece.
struct Run {
    role: Role,
    length: Mm,
    /// The run before this one.
    before: Option<usize>,
    /// The run's last piece; nothing if the run is part of another one.
    last: Option<usize>,
}

struct Runs {
    /// The runs, by their first piece. Entries of pieces that begin no run are
    /// not looked at.
    all: Vec<Run>,
}

impl Runs {
    /// Runs of one piece each.
    fn new(pieces: &[(Role, Stroke)]) -> Runs {
        let run = |(i, (role, path)): (usize, &(Role, Stroke))| Run {
            role: *role,
            length: path.length(),
            before: i.checked_sub(1),
            last: Some(i),
        };
        Runs {
            all: pieces.iter().enumerate().map(run).collect(),
        }
    }

    fn waiting(&self, first: usize) -> Waiting {
        let run = &self.all[first];
        Waiting {
            // A sum of no lengths may be -0, whose bits are the greatest.
            length: (run.length + 0.0).to_bits(),
            first,
            last: run.last.unwrap_or(first),
        }
    }

    /// Joins a run with the longer one beside it, and with the other one if
    /// that has the same role. Returns the first piece of the joined run.
    fn join(&mut self, run: usize) -> Option<usize> {
        let before = self.all[run].before;
        let last = self.all[run].last?;
        let after = Some(last + 1).filter(|&k| k < self.all.len());
        let length = |k: Option<usize>| k.map(|k| self.all[k].length);
        let longer = if length(before) >= length(after) {
            before
        } else {
            after
        };
        let role = self.all[longer?].role;
        self.all[run].role = role;
        let mut start = run;
        if let Some(before) = before
            && self.all[before].role == role
        {
            self.unite(before, run);
            start = before;
        }
        if let Some(after) = after
            && self.all[after].role == role
        {
            self.unite(start, after);
        }
        Some(start)
    }

    /// Makes one run of a run and the run after it.
    fn unite(&mut self, run: usize, after: usize) {
        let last = self.all[after].last.take();
        self.all[run].length += self.all[after].length;
        self.all[run].last = last;
        if let Some(next) = last.and_then(|l| self.all.get_mut(l + 1)) {
            next.before = Some(run);
        }
    }

    /// The pieces, joined.
    fn of(self, pieces: Vec<(Role, Stroke)>) -> Vec<(Role, Stroke)> {
        let mut joined: Vec<(Role, Stroke)> = Vec::new();
        for (run, (_, piece)) in self.all.iter().zip(pieces) {
            match joined.last_mut() {
                Some((_, whole)) if run.last.is_none() => whole.append(&piece),
                _ => joined.push((run.role, piece)),
            }
        }
        joined
    }
}

/// A run as it was when it came to wait. The shortest one is the least, and of
/// equally short ones the first one.
#[derive(PartialEq, Eq, PartialOrd, Ord)]
struct Waiting {
    /// The bits of the length. Lengths are not negative, so bits and lengths
    /// have one order.
    length: u64,
    first: usize,
    last: usize,
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2;

    const ROLES: [Role; 3] =
        [Role::BottomSkin, Role::TopSkin, Role::InternalSkin];

    /// Straight pieces of these roles and lengths.
    fn row(of: &[(usize, f64)]) -> Vec<(Role, Stroke)> {
        let mut x = 0.0;
        let mut piece = |&(role, length): &(usize, f64)| {
            let from = x;
            x += length;
            let path = Stroke {
                points: [from, x].map(|x| DVec2::new(x, 0.0)).to_vec(),
                closed: false,
                width: 0.4,
                widths: vec![0.4 + from, 0.4 + x],
                levels: Vec::new(),
            };
            (ROLES[role], path)
        };
        of.iter().map(&mut piece).collect()
    }

    /// What `join` should do, done slowly: all pieces are looked through for
    /// each one that is joined.
    fn one_by_one(mut all: Vec<(usize, f64)>) -> Vec<(usize, f64)> {
        loop {
            let least = |i: &usize, j: &usize| all[*i].1.total_cmp(&all[*j].1);
            let is_short = |i: &usize| all[*i].1 < short(ROLES[all[*i].0]);
            let shortest = (0..all.len()).filter(is_short).min_by(least);
            let Some(i) = shortest.filter(|_| all.len() > 1) else {
                return all;
            };
            let length = |k: Option<usize>| Some(all.get(k?)?.1);
            let (before, after) = (i.checked_sub(1), Some(i + 1));
            let longer = if length(before) >= length(after) {
                before
            } else {
                after
            };
            all[i].0 = all[longer.unwrap()].0;
            let mut joined: Vec<(usize, f64)> = Vec::new();
            for (role, length) in all {
                match joined.last_mut() {
                    Some(last) if last.0 == role => last.1 += length,
                    _ => joined.push((role, length)),
                }
            }
            all = joined;
        }
    }

    #[test]
    fn the_shortest_joins_the_longer_one_beside_it() {
        let found = join_short(row(&[(0, 6.0), (1, 0.5), (2, 5.0)]));
        assert_eq!(found.len(), 2);
        assert_eq!(found[0].1.points.len(), 3);
        assert_eq!(found[0].1.widths.len(), 3);
        // Of two neighbours of equal length the one before wins; at an end
        // there is only one.
        let roles = |of: &[(usize, f64)]| -> Vec<Role> {
            join_short(row(of)).iter().map(|p| p.0).collect()
        };
        assert_eq!(
            roles(&[(0, 5.0), (1, 0.5), (2, 5.0)]),
            [ROLES[0], ROLES[2]]
        );
        assert_eq!(roles(&[(0, 0.5), (1, 2.0)]), [ROLES[1]]);
        // What nobody sees is short for longer, but not if it is alone.
        assert_eq!(roles(&[(2, 3.0), (1, 2.0)]), [ROLES[1]]);
        assert_eq!(roles(&[(2, 4.5), (1, 2.0)]), [ROLES[2], ROLES[1]]);
        assert_eq!(roles(&[(2, 3.0)]), [ROLES[2]]);
        // A piece between two of one role joins both.
        assert_eq!(roles(&[(0, 2.0), (1, 0.5), (0, 2.0)]), [ROLES[0]]);
        // Short pieces that grow long together stay.
        let all = [(0, 0.6), (1, 0.5), (2, 0.7)];
        assert_eq!(roles(&all), [ROLES[2]]);
        assert_eq!(roles(&[(1, 0.5)]), [ROLES[1]]);
        assert!(roles(&[]).is_empty());
    }

    #[test]
    fn many_pieces_are_joined_as_if_one_by_one() {
        let mut rng = fastrand::Rng::with_seed(1);
        for count in 1..300_u64 {
            let mut all: Vec<(usize, f64)> = Vec::new();
            for _ in 0..count {
                let before = all.last().map_or(0, |p| p.0);
                let role = (before + 1 + rng.usize(..2)) % 3;
                // Lengths are binary fractions, so that sums are exact; equal
                // lengths occur.
                all.push((role, f64::from(rng.u16(1..=350)) / 64.0));
            }
            let found = join_short(row(&all));
            let found: Vec<(Role, f64)> =
                found.iter().map(|(r, p)| (*r, p.length())).collect();
            let wanted: Vec<(Role, f64)> =
                one_by_one(all).iter().map(|p| (ROLES[p.0], p.1)).collect();
            assert_eq!(found, wanted);
        }
    }
}
