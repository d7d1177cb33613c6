//! Slows beads whose moves follow each other faster than the printer takes
//! them (`printer.max_moves_per_second`).
//!
//! In: the beads of a stroke, one after another without a break. Out: the same
//! beads, cut where their speed changes.
//!
//! Guaranteed: of any [`TOGETHER`] moves in a row the mean rate is at most the
//! printer's; where that alone changes the speed, it is even along 3 mm. One short
//! move among long ones is no reason to slow down, since firmware keeps moves in a
//! buffer, and neither are those before a sharp corner, where the head brakes.

use super::moves::Cause;
use super::rates::Rates;
use glam::DVec2;
use isoslice_base::units::{Mm, MmPerSec, PerSec, Seconds};
use isoslice_planar::arc::Turn;
use isoslice_planar::bead::{Bead, Stroke};

/// Moves over which the rate is a mean. Of 24 moves of 0.1 mm at 60 mm/s, 16 come
/// sooner than at 200 a second, and the smallest buffer, Marlin's, holds as many.
/// With 8, a tenth of a gyroid's print was slowed for the few short moves at tips of
/// walls.
const TOGETHER: usize = 24;

/// Length along which a speed holds, mm: where it changes more often, so does
/// the pressure in the nozzle, and each change is seen.
const EVEN: Mm = 3.0;

/// Speeds are steps of this share of what was asked for, so that they change
/// seldom.
const SPEED_STEP: f64 = 0.1;

/// A bead with what is known of how it is printed.
#[derive(Clone, Debug)]
pub(super) struct Rated {
    pub bead: Bead,
    /// For each segment of the bead's path the arc in its place; empty if the
    /// bead has no arcs.
    pub turns: Vec<Option<Turn>>,
    pub rates: Rates,
    /// The speed asked for, and what has made it less so far.
    pub wanted: MmPerSec,
    pub by: Option<Cause>,
}

impl Rated {
    /// Lengths of the moves.
    pub(super) fn lengths(&self) -> impl Iterator<Item = Mm> + '_ {
        self.bead.stroke.segments().enumerate().map(|(i, (a, b))| {
            let turn = self.turns.get(i).copied().flatten();
            turn.map_or(a.distance(b), |turn| turn.length(a))
        })
    }

    /// Lowers the speed for a cause.
    pub(super) fn slow(&mut self, speed: MmPerSec, cause: Cause) {
        if speed < self.rates.speed {
            self.rates.speed = speed;
            self.by = Some(cause);
        }
    }

    /// The part of the bead that the moves `from` to `to` make up.
    pub(super) fn part(&self, from: usize, to: usize) -> Rated {
        let own = &self.bead.stroke;
        let path = own.path().skip(from).take(to - from + 1);
        let points: Vec<DVec2> = path.collect();
        let mut stroke = Stroke::new(points, false, own.width);
        if !own.levels.is_empty() {
            stroke.levels = (from..=to).map(|i| own.level(i)).collect();
        }
        Rated {
            bead: Bead {
                stroke,
                ..self.bead
            },
            turns: self.turns.get(from..to).unwrap_or(&[]).to_vec(),
            ..*self
        }
    }

    /// The bead, which is a single move, cut after a share of its way.
    pub(super) fn halves(&self, share: f64) -> (Rated, Rated) {
        let turn = self.turns.first().copied().flatten();
        let Some(turn) = turn else {
            let half = |from: f64, to: f64| Rated {
                bead: Bead {
                    stroke: self.bead.stroke.part(from, to),
                    ..self.bead
                },
                turns: self.turns.clone(),
                ..*self
            };
            return (half(0.0, share), half(share, 1.0));
        };
        let own = &self.bead.stroke;
        let ends = [own.points[0], own.points[1]];
        let (middle, parts) = turn.halves(ends[0], share);
        let half = |from, to, turn| Rated {
            bead: Bead {
                stroke: Stroke::new(vec![from, to], false, own.width),
                ..self.bead
            },
            turns: vec![Some(turn)],
            ..*self
        };
        (
            half(ends[0], middle, parts[0]),
            half(middle, ends[1], parts[1]),
        )
    }

    /// Adds a bead that follows at the same speed.
    pub(super) fn append(&mut self, next: Rated) {
        let stroke = &mut self.bead.stroke;
        stroke.points.extend(next.bead.stroke.points.iter().skip(1));
        stroke.levels.extend(next.bead.stroke.levels.iter().skip(1));
        self.turns.extend(next.turns);
    }
}

/// The beads at speeds that ask for at most `most` moves a second. `times` tells how
/// long the moves take at the speeds asked for, with accelerations: where the head
/// turns back in a tip, moves may be short.
pub(super) fn slowed(
    chain: Vec<Rated>,
    most: PerSec,
    times: impl FnOnce(&[Rated]) -> Vec<Seconds>,
) -> Vec<Rated> {
    let lengths: Vec<Mm> = chain.iter().flat_map(Rated::lengths).collect();
    let fastest = chain.iter().map(|r| r.rates.speed).fold(0.0, f64::max);
    let all_may = |limits: &[MmPerSec]| limits.iter().all(|l| *l >= fastest);
    if all_may(&limits(&lengths, &[], most)) {
        return chain;
    }
    let limits = limits(&lengths, &times(&chain), most);
    if all_may(&limits) {
        return chain;
    }
    let mut out = Vec::with_capacity(chain.len());
    let mut limits = limits.into_iter();
    for rated in chain {
        let asked = rated.rates.speed;
        let speed = |limit: MmPerSec| match limit / asked {
            share if share < 1.0 => {
                asked * SPEED_STEP * (share / SPEED_STEP).floor().max(1.0)
            }
            _ => asked,
        };
        let n = rated.lengths().count();
        let speeds: Vec<_> = limits.by_ref().take(n).map(speed).collect();
        if speeds.iter().all(|speed| *speed == asked) {
            out.push(rated);
            continue;
        }
        let mut from = 0;
        for run in speeds.chunk_by(|a, b| a == b) {
            let to = from + run.len();
            let mut part = rated.part(from, to);
            part.slow(run[0], Cause::Moves);
            out.push(part);
            from = to;
        }
    }
    out
}

/// The greatest speed of each move at which `most` moves a second are not
/// exceeded. It is the same along at least [`EVEN`], but at an end. `times` are those
/// of the moves at the speeds asked for, if they are known.
fn limits(lengths: &[Mm], times: &[Seconds], most: PerSec) -> Vec<MmPerSec> {
    let together = TOGETHER.min(lengths.len()).max(1);
    let least = together as f64 / most;
    let rows: Vec<MmPerSec> = lengths
        .windows(together)
        .enumerate()
        .map(|(i, moves)| {
            let times = times.get(i..i + together).unwrap_or_default();
            match times.iter().sum::<Seconds>() {
                time if time >= least => f64::INFINITY,
                _ => moves.iter().sum::<Mm>() / least,
            }
        })
        .collect();
    // Each move is in several rows.
    let mut limits: Vec<MmPerSec> = (0..lengths.len())
        .map(|i| {
            let first = (i + 1).saturating_sub(together);
            let rows = rows.iter().take(i + 1).skip(first);
            rows.copied().fold(f64::INFINITY, f64::min)
        })
        .collect();
    let mut from = 0;
    while from < lengths.len() {
        let mut length = 0.0;
        let to = lengths[from..].iter().position(|step| {
            length += step;
            length >= EVEN
        });
        let to = to.map_or(lengths.len(), |k| from + k + 1);
        let least = limits[from..to].iter().copied();
        let least = least.fold(f64::INFINITY, f64::min);
        limits[from..to].fill(least);
        from = to;
    }
    limits
}

#[cfg(test)]
mod tests {
    use super::*;
    use isoslice_planar::bead::Role;

    fn rated(steps: &[Mm], speed: MmPerSec) -> Rated {
        let mut points = vec![DVec2::ZERO];
        for step in steps {
            points.extend(points.last().map(|p| p + DVec2::X * *step));
        }
        let stroke = Stroke::new(points, false, 0.4);
        Rated {
            bead: Bead::new(Role::GapFill, stroke, 0.2),
            turns: Vec::new(),
            rates: Rates {
                speed,
                flow: 1.0,
                fan: 0.0,
            },
            wanted: speed,
            by: None,
        }
    }

    /// Times of moves that need not accelerate.
    fn cruising(chain: &[Rated]) -> Vec<Seconds> {
        let times = chain
            .iter()
            .flat_map(|r| r.lengths().map(|l| l / r.rates.speed));
        times.collect()
    }

    #[test]
    fn moves_that_take_their_time_anyway_are_not_slowed() {
        let braked = |chain: &[Rated]| {
            cruising(chain).into_iter().map(|t| 5.0 * t).collect()
        };
        let chain = || vec![rated(&[0.12; 60], 50.0)];
        assert!(slowed(chain(), 100.0, cruising)[0].by.is_some());
        assert_eq!(slowed(chain(), 100.0, braked)[0].by, None);
    }

    #[test]
    fn crowded_moves_are_slower_and_others_are_not() {
        let mut steps = vec![2.0; 10];
        steps.extend([0.1; 60]);
        steps.extend([2.0; 10]);
        let whole: Mm = steps.iter().sum();
        let out = slowed(vec![rated(&steps, 50.0)], 100.0, cruising);
        let speeds: Vec<f64> = out.iter().map(|r| r.rates.speed).collect();
        assert_eq!((speeds[0], speeds[speeds.len() - 1]), (50.0, 50.0));
        let least = speeds.iter().fold(f64::INFINITY, |a, b| a.min(*b));
        assert_eq!(least, 10.0);
        let slow = out.iter().filter(|r| r.by == Some(Cause::Moves));
        let count: usize = slow.map(|r| r.lengths().count()).sum();
        assert!((60..110).contains(&count), "{count}");
        let length: Mm = out.iter().map(|r| r.bead.stroke.length()).sum();
        assert!((length - whole).abs() < 1e-9);
        for pair in out.windows(2) {
            let end = pair[0].bead.stroke.points.last().copied();
            assert_eq!(end, Some(pair[1].bead.stroke.points[0]));
        }
        // Moves in a row take no less time than the printer needs.
        let times: Vec<f64> = out
            .iter()
            .flat_map(|r| r.lengths().map(|l| l / r.rates.speed))
            .collect();
        for moves in times.windows(TOGETHER) {
            let least = TOGETHER as f64 / 100.0;
            assert!(moves.iter().sum::<f64>() >= least - 1e-9);
        }
    }

    #[test]
    fn long_moves_and_a_short_one_among_them_stay() {
        for steps in [&[5.0, 5.0][..], &[5.0, 0.1, 5.0, 5.0][..]] {
            let out = slowed(vec![rated(steps, 50.0)], 100.0, cruising);
            assert_eq!((out.len(), out[0].by), (1, None));
            assert_eq!(out[0].rates.speed, 50.0);
        }
        assert!(slowed(Vec::new(), 100.0, cruising).is_empty());
    }
}
