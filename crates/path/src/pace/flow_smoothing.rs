//! Keeps the flow of plastic from changing faster than the filament can be
//! pushed (`filament.max_flow_change`).
//!
//! ```text
//!   flow │        ┌──────        In front of the nozzle the pressure follows
//!        │      ┌─┘              the filament late. Where a stroke asks for a
//!        │    ┌─┘                sudden change, the faster side is cut, and
//!        │────┘                  its beginning or end runs in steps.
//!        └─────────────── way
//! ```
//!
//! In: the beads of a stroke, one after another without a break. Out: the same
//! beads, cut where their speed changes; none is faster than before.
//!
//! Guaranteed: from one move to the next the flow changes by at most the limit
//! times the duration of the move with the lesser flow, or times [`TAU`] if
//! that is shorter. Not guaranteed: that the limit is kept after cooling, which
//! slows some beads down to `cooling.min_speed` and others less.

use super::move_rate::Rated;
use super::moves::Cause;
use isoslice_base::units::{Mm, Mm2, Mm3PerSec, Mm3PerSec2, MmPerSec, Seconds};

/// Duration of a step, s: at usual speeds a step is 1 to 2 mm long.
const TAU: Seconds = 0.02;

/// Least length of a step, mm.
const SHORTEST: Mm = 0.2;

/// Least speed of a step, mm/s.
const SLOWEST: MmPerSec = 1.0;

/// One move of a bead.
struct One {
    /// Number of the bead of the stroke that the move is part of.
    of: usize,
    rated: Rated,
    length: Mm,
    /// Plastic per length of the way.
    area: Mm2,
}

impl One {
    fn flow(&self) -> Mm3PerSec {
        self.area * self.rated.rates.speed
    }

    fn time(&self) -> Seconds {
        self.length / self.rated.rates.speed
    }

    /// The move's first `way` and the rest, or its last `way` if moves are gone
    /// through backwards. The first part runs at a speed of its own.
    fn cut(
        self,
        way: Mm,
        speed: MmPerSec,
        backwards: bool,
    ) -> (One, Option<One>) {
        let slow = |one: One| {
            let mut one = one;
            one.rated.slow(speed, Cause::Flow);
            one
        };
        if way > self.length - SHORTEST {
            return (slow(self), None);
        }
        let share = way / self.length;
        let at = if backwards { 1.0 - share } else { share };
        let (before, after) = self.rated.halves(at);
        let (near, far) = if backwards {
            (after, before)
        } else {
            (before, after)
        };
        let part = |rated, length| One {
            rated,
            length,
            ..self
        };
        (slow(part(near, way)), Some(part(far, self.length - way)))
    }
}

/// The beads at speeds at which the flow changes by at most `most` in a second.
/// If `most` is 0, nothing changes.
pub(super) fn smoothed(chain: Vec<Rated>, most: Mm3PerSec2) -> Vec<Rated> {
    if most <= 0.0 {
        return chain;
    }
    let mut moves: Vec<One> = Vec::new();
    for (of, rated) in chain.iter().enumerate() {
        let level = rated.bead.stroke.levels.is_empty();
        let whole = rated.bead.area();
        for (i, length) in rated.lengths().enumerate() {
            let area = if level {
                whole
            } else {
                rated.bead.area_along(i)
            };
            moves.push(One {
                of,
                rated: rated.part(i, i + 1),
                length,
                area: area * rated.rates.flow,
            });
        }
    }
    let sudden = |pair: &[One]| {
        let (a, b) = (&pair[0], &pair[1]);
        let slower = if a.flow() < b.flow() { a } else { b };
        (a.flow() - b.flow()).abs() > most * slower.time().min(TAU)
    };
    if !moves.windows(2).any(sudden) {
        return chain;
    }
    let moves = climbing(moves, most, false);
    let moves = climbing(moves, most, true);
    joined(moves)
}

/// The moves at speeds at which no flow is too far above the flow of the move
/// before, or of the move after if they are gone through backwards.
fn climbing(moves: Vec<One>, most: Mm3PerSec2, backwards: bool) -> Vec<One> {
    let mut out: Vec<One> = Vec::with_capacity(moves.len());
    let mut moves: Box<dyn Iterator<Item = One>> = if backwards {
        Box::new(moves.into_iter().rev())
    } else {
        Box::new(moves.into_iter())
    };
    out.extend(moves.next());
    for one in moves {
        let mut rest = Some(one);
        while let Some(one) = rest.take() {
            let allowed = out.last().map_or(f64::INFINITY, |last| {
                last.flow() + most * last.time().min(TAU)
            });
            let speed = (allowed / one.area).max(SLOWEST);
            if one.flow() <= allowed || speed >= one.rated.rates.speed {
                out.push(one);
                continue;
            }
            let way = (speed * TAU).max(SHORTEST);
            let (near, far) = one.cut(way, speed, backwards);
            out.push(near);
            rest = far;
        }
    }
    if backwards {
        out.reverse();
    }
    out
}

/// The beads made of the moves: moves of one bead and one speed are one piece
/// again.
fn joined(moves: Vec<One>) -> Vec<Rated> {
    let mut out: Vec<(usize, Rated)> = Vec::new();
    for One { of, rated, .. } in moves {
        match out.last_mut() {
            Some((last, whole))
                if *last == of && whole.rates.speed == rated.rates.speed =>
            {
                whole.append(rated);
            }
            _ => out.push((of, rated)),
        }
    }
    out.into_iter().map(|o| o.1).collect()
}

#[cfg(test)]
mod tests {
    use super::super::rates::Rates;
    use super::*;
    use glam::DVec2;
    use isoslice_planar::arc;
    use isoslice_planar::bead::{Bead, Role, Stroke};

    fn rated(points: &[DVec2], width: Mm, speed: MmPerSec) -> Rated {
        let stroke = Stroke::new(points.to_vec(), false, width);
        Rated {
            bead: Bead::new(Role::OuterWall, stroke, 0.2),
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

    /// A way along x, in steps.
    fn along(from: Mm, to: Mm, count: usize) -> Vec<DVec2> {
        let at = |i| from + (to - from) * i as f64 / count as f64;
        (0..=count).map(|i| DVec2::new(at(i), 0.0)).collect()
    }

    /// For each move: its flow, duration, and beginning and end.
    fn moves(chain: &[Rated]) -> Vec<(f64, f64, DVec2, DVec2)> {
        let of_bead = |r: &Rated| {
            let lengths: Vec<Mm> = r.lengths().collect();
            let (v, area) = (r.rates.speed, r.bead.area());
            let points: Vec<DVec2> = r.bead.stroke.path().collect();
            (0..lengths.len())
                .map(|i| {
                    let time = lengths[i] / v;
                    (area * v, time, points[i], points[i + 1])
                })
                .collect::<Vec<_>>()
        };
        chain.iter().flat_map(of_bead).collect()
    }

    fn check(before: &[Rated], most: f64) -> Vec<Rated> {
        let after = smoothed(before.to_vec(), most);
        let all = moves(&after);
        for pair in all.windows(2) {
            let ((qa, ta, _, end), (qb, tb, begin, _)) = (pair[0], pair[1]);
            assert!(end.distance(begin) < 1e-9);
            let time = if qa < qb { ta } else { tb };
            let most = most * time.min(TAU);
            assert!((qa - qb).abs() <= most * 1.000_001, "{qa} {qb} {time}");
        }
        let length =
            |c: &[Rated]| -> f64 { c.iter().flat_map(Rated::lengths).sum() };
        assert!((length(before) - length(&after)).abs() < 1e-9);
        after
    }

    #[test]
    fn sudden_changes_become_ramps_and_the_rest_keeps_its_speed() {
        let before = [
            rated(&along(0.0, 20.0, 1), 0.4, 20.0),
            rated(&along(20.0, 60.0, 7), 0.4, 80.0),
            rated(&along(60.0, 61.0, 5), 0.4, 30.0),
            rated(&along(61.0, 90.0, 1), 0.6, 60.0),
        ];
        for most in [20.0, 100.0, 500.0] {
            let after = check(&before, most);
            // A ramp of Δq takes the time Δq / most. Only during this time does
            // the plastic come more slowly.
            let time = |c: &[Rated]| moves(c).iter().map(|m| m.1).sum::<f64>();
            let extra = time(&after) - time(&before);
            let q = |v: f64, w: f64| {
                v * rated(&along(0.0, 1.0, 1), w, v).bead.area()
            };
            let (a, b, c, d) =
                (q(20.0, 0.4), q(80.0, 0.4), q(30.0, 0.4), q(60.0, 0.6));
            // While the flow climbs from a to b in the time T, (b - a) T / 2
            // less is laid than at b, and is laid at b later.
            let late =
                |low: f64, high: f64| 0.5 * (high - low).powi(2) / most / high;
            let exact = late(a, b) + late(c, b) + late(c, d);
            let steps = 3.0 * 2.0 * TAU;
            assert!((extra - exact).abs() < steps, "{extra} for {exact}");
            let fastest = moves(&after).iter().map(|m| m.0).fold(0.0, f64::max);
            assert!((fastest - d).abs() < 1e-9 || most < 100.0);
        }
    }

    #[test]
    fn even_flow_stays() {
        let before = vec![
            rated(&along(0.0, 20.0, 1), 0.4, 40.0),
            rated(&along(20.0, 60.0, 7), 0.4, 41.0),
        ];
        let after = smoothed(before.clone(), 100.0);
        assert_eq!(moves(&after), moves(&before));
        assert_eq!(after.len(), 2);
        assert_eq!(smoothed(before, 0.0).len(), 2);
    }

    #[test]
    fn arcs_are_cut_on_their_circle() {
        let circle = |i: i32| {
            DVec2::from_angle(0.02 * f64::from(i)) * 10.0
                - DVec2::new(10.0, 0.0)
        };
        let line: Vec<DVec2> = (0..100).map(circle).collect();
        let (points, turns) = arc::fit(&line, 0.01);
        assert!(turns.iter().any(Option::is_some));
        let mut round = rated(&points, 0.4, 80.0);
        round.turns = turns;
        let before = [rated(&along(-5.0, 0.0, 1), 0.4, 10.0), round];
        let after = check(&before, 20.0);
        assert!(after.len() > 4);
        let centre = DVec2::new(-10.0, 0.0);
        for (_, _, a, b) in moves(&after).split_off(1) {
            for p in [a, b] {
                assert!((p.distance(centre) - 10.0).abs() < 0.02, "{p}");
            }
        }
    }
}
