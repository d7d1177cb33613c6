//! Finds a short tour: which stop comes next, and which way round it is taken.
//!
//! In: stops with one or two ends, in stages, and the tour's start and end.
//! Out: every stop once, stage by stage.
//!
//! ```text
//!    ──●   ●──      nearest first leaves long ways to what it has passed by;
//!      │   │        they are shortened by turning round a part of the tour
//!    ──●   ●──      (2-opt) or by moving up to three stops (Or-opt), as long
//!                   as that helps and the work allowed lasts
//! ```
//!
//! Guaranteed: the tour is never longer than nearest first, the result is the
//! same on every machine, and the work is in proportion to the stops. Partners
//! for an exchange are looked for among near ends only, and the part that is
//! moved has a greatest length. Not guaranteed: the shortest tour.

use super::near_ends::NearEnds;
use super::nearest::Nearest;
use glam::DVec2;
use isoslice_base::units::Mm;
use std::ops::Range;

/// Something to visit.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stop {
    /// Where the stop is entered.
    pub from: DVec2,
    /// Where the stop is left.
    pub to: DVec2,
    /// True if the stop may be taken the other way round.
    pub turns: bool,
    /// The stop's stage. Stops of lower stages come first.
    pub stage: u32,
}

impl Stop {
    /// A stop that is left where it is entered.
    pub(super) fn at(place: DVec2) -> Stop {
        Stop {
            from: place,
            to: place,
            turns: false,
            stage: 0,
        }
    }
}

/// A stop of a tour.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Visit {
    /// The stop's number.
    pub stop: usize,
    /// True if the stop is taken the other way round.
    pub turned: bool,
}

/// Ways shorter than this are left as they are, mm.
const SHORT: Mm = 0.8;
/// An exchange has to save more than this, mm.
const GAIN: Mm = 0.01;
/// Number of ends that are tried around each end of a long way.
const PARTNERS: usize = 6;
/// Weight of the way to the tour's end, which is often a guess.
const END_WEIGHT: f64 = 0.7;
/// Greatest number of stops moved at a time.
const MOVED: usize = 3;
/// Greatest number of stops that are turned round or passed over.
const SPAN: usize = 1000;
/// Number of stops up to which they are searched without a tree.
const FEW: usize = 40;
/// Number of exchanges that may be tried, per stop.
const TRIALS: usize = 200;

/// A tour of the stops from `start` to `end`, either of which may be free.
pub(super) fn tour(
    stops: &[Stop],
    start: Option<DVec2>,
    end: Option<DVec2>,
) -> Vec<Visit> {
    let first = nearest_first(stops, start);
    // A tour that was stopped lacks some of them.
    if stops.len() < 2 || first.len() < stops.len() {
        return first;
    }
    let mut search = Search::new(stops, first.clone(), start, end);
    search.run();
    let better = search.tour;
    if length(stops, &better, start, end) < length(stops, &first, start, end) {
        better
    } else {
        first
    }
}

/// Length of the ways between the stops and to both ends, the last one by its
/// weight.
pub(super) fn length(
    stops: &[Stop],
    tour: &[Visit],
    start: Option<DVec2>,
    end: Option<DVec2>,
) -> Mm {
    let mut at = start;
    let mut sum = 0.0;
    for visit in tour {
        let stop = &stops[visit.stop];
        let (from, to) = if visit.turned && stop.turns {
            (stop.to, stop.from)
        } else {
            (stop.from, stop.to)
        };
        sum += at.map_or(0.0, |at| at.distance(from));
        at = Some(to);
    }
    sum + END_WEIGHT * between(at, end)
}

/// The tour that always goes to the nearest of the stops left in the stage.
fn nearest_first(stops: &[Stop], start: Option<DVec2>) -> Vec<Visit> {
    let mut stages: Vec<u32> = stops.iter().map(|s| s.stage).collect();
    stages.sort_unstable();
    stages.dedup();
    let mut tour = Vec::with_capacity(stops.len());
    let mut done = vec![false; stops.len()];
    let mut at = start;
    for stage in stages {
        let of_stage = stops.iter().enumerate().filter(|s| s.1.stage == stage);
        if of_stage.clone().count() <= FEW {
            let mut left: Vec<usize> = of_stage.map(|s| s.0).collect();
            while let Some((k, visit)) = nearest_of(stops, &left, at) {
                if isoslice_base::limits::is_stopped() {
                    break;
                }
                at = Some(if visit.turned {
                    stops[visit.stop].from
                } else {
                    stops[visit.stop].to
                });
                left.remove(k);
                tour.push(visit);
            }
            continue;
        }
        let mut left = Nearest::new(of_stage.flat_map(|(i, s)| {
            let back = s.turns.then_some((s.to, 2 * i + 1));
            std::iter::once((s.from, 2 * i)).chain(back)
        }));
        while let Some(end) = left.pop(at) {
            if isoslice_base::limits::is_stopped() {
                break;
            }
            let (stop, turned) = (end / 2, end % 2 == 1);
            if std::mem::replace(&mut done[stop], true) {
                continue;
            }
            at = Some(if turned {
                stops[stop].from
            } else {
                stops[stop].to
            });
            tour.push(Visit { stop, turned });
        }
    }
    tour
}

/// The stop nearest to `at`, or to the origin, and its index in `left`.
fn nearest_of(
    stops: &[Stop],
    left: &[usize],
    at: Option<DVec2>,
) -> Option<(usize, Visit)> {
    let at = at.unwrap_or(DVec2::ZERO);
    let ends = left.iter().enumerate().flat_map(|(k, &stop)| {
        let Stop {
            from, to, turns, ..
        } = stops[stop];
        let end = |p: DVec2, turned| {
            (p.distance_squared(at), k, Visit { stop, turned })
        };
        [Some(end(from, false)), turns.then(|| end(to, true))]
    });
    ends.flatten()
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, k, visit)| (k, visit))
}

/// Looks for exchanges that make a tour shorter.
struct Search<'a> {
    stops: &'a [Stop],
    tour: Vec<Visit>,
    /// Where in the tour each stop is.
    places: Vec<usize>,
    start: Option<DVec2>,
    end: Option<DVec2>,
    ends: NearEnds,
    /// Stops whose ways have changed.
    queue: Vec<usize>,
    queued: Vec<bool>,
    trials: usize,
}

impl<'a> Search<'a> {
    fn new(
        stops: &'a [Stop],
        tour: Vec<Visit>,
        start: Option<DVec2>,
        end: Option<DVec2>,
    ) -> Self {
        let mut places = vec![0; stops.len()];
        for (k, v) in tour.iter().enumerate() {
            places[v.stop] = k;
        }
        // The last stop in the queue is looked at first, so it begins with the
        // tour's first one.
        let queue: Vec<usize> = tour.iter().rev().map(|v| v.stop).collect();
        Search {
            stops,
            tour,
            places,
            start,
            end,
            ends: NearEnds::new(
                stops.iter().flat_map(|s| [s.from, Self::other(s)]),
            ),
            queue,
            queued: vec![true; stops.len()],
            trials: TRIALS * stops.len(),
        }
    }

    /// The end of a stop at which it is not entered. For an exchange, a stop
    /// that cannot be turned counts as one place. The way through it is
    /// neglected.
    fn other(stop: &Stop) -> DVec2 {
        if stop.turns { stop.to } else { stop.from }
    }

    /// Where the `k`th stop of the tour is entered, or the tour's end if `k` is
    /// behind the last stop.
    fn entry(&self, k: usize) -> Option<DVec2> {
        let Some(visit) = self.tour.get(k) else {
            return self.end;
        };
        let stop = &self.stops[visit.stop];
        Some(if visit.turned {
            Self::other(stop)
        } else {
            stop.from
        })
    }

    /// Where the stop before the `k`th one is left, or the tour's start if
    /// there is no such stop.
    fn exit_before(&self, k: usize) -> Option<DVec2> {
        let Some(k) = k.checked_sub(1) else {
            return self.start;
        };
        let visit = self.tour.get(k)?;
        let stop = &self.stops[visit.stop];
        Some(if visit.turned {
            stop.from
        } else {
            Self::other(stop)
        })
    }

    /// Length of the way to the `k`th stop.
    fn way(&self, k: usize) -> Mm {
        self.way_to(k, self.exit_before(k))
    }

    /// Length of the way to the `k`th stop if it began at `from`.
    fn way_to(&self, k: usize, from: Option<DVec2>) -> Mm {
        let weight = if k < self.tour.len() { 1.0 } else { END_WEIGHT };
        weight * between(from, self.entry(k))
    }

    fn stage(&self, k: usize) -> Option<u32> {
        self.tour.get(k).map(|v| self.stops[v.stop].stage)
    }

    fn run(&mut self) {
        let mut near = Vec::with_capacity(PARTNERS);
        while let Some(stop) = self.queue.pop() {
            if isoslice_base::limits::is_stopped() {
                break;
            }
            self.queued[stop] = false;
            // The ways to and from a stop are tried as long as one of them can
            // be shortened.
            while self.trials > 0
                && (0..2)
                    .any(|k| self.shorten(self.places[stop] + k, &mut near))
            {
            }
        }
    }

    /// Tries to shorten the tour by giving up the way to the `k`th stop.
    fn shorten(&mut self, k: usize, near: &mut Vec<(f64, u32)>) -> bool {
        let now = self.way(k);
        if now < SHORT {
            return false;
        }
        for forward in [true, false] {
            // The stops that could follow the stop before, or precede the `k`th
            // one.
            let here = if forward {
                self.exit_before(k)
            } else {
                self.entry(k)
            };
            let Some(here) = here else { continue };
            self.ends.near(here, now - GAIN, PARTNERS, near);
            for &(_, end) in near.iter() {
                if self.trials == 0 {
                    return false;
                }
                self.trials -= 1;
                let place = self.places[end as usize / 2];
                // True if the stop is left at this end.
                let visit = self.tour[place];
                let left = (end % 2 == 1) != visit.turned;
                // The stop that is joined begins or ends here, and what is moved
                // is turned so that the two ends meet.
                let end_at = place + usize::from(left);
                let flip = left == forward;
                let done = if forward == left {
                    self.turn(k, place + usize::from(forward))
                } else {
                    false
                };
                if done
                    || self.carry(end_at, left, k, flip)
                    || self.carry(k, forward, end_at, flip)
                {
                    return true;
                }
            }
        }
        false
    }

    /// 2-opt: gives up the ways to the `i`th and `j`th stops, and turns round
    /// what is between them.
    fn turn(&mut self, i: usize, j: usize) -> bool {
        let (i, j) = (i.min(j), i.max(j));
        if i == j || j - i > SPAN || self.stage(i) != self.stage(j - 1) {
            return false;
        }
        let old = self.way(i) + self.way(j);
        let new = between(self.exit_before(i), self.exit_before(j))
            + self.way_to(j, self.entry(i));
        if !gains(old, new) {
            return false;
        }
        self.turn_round(i, j);
        self.update(i, j);
        true
    }

    /// Or-opt: moves up to 3 stops to before the stop `to`, turned round if
    /// `turned`. The moved stops are those before the stop `from`, or those from
    /// it on.
    fn carry(
        &mut self,
        from: usize,
        before: bool,
        to: usize,
        turned: bool,
    ) -> bool {
        (1..=MOVED).any(|count| {
            self.part(from, count, before).is_some_and(|part| {
                self.shift(part.start, part.end, to, turned)
            })
        })
    }

    /// `count` stops of the tour: those before the `k`th one, or those from it
    /// on; nothing if there are not so many.
    fn part(
        &self,
        k: usize,
        count: usize,
        before: bool,
    ) -> Option<Range<usize>> {
        if before {
            Some(k.checked_sub(count)?..k)
        } else {
            Some(k..k + count).filter(|part| part.end <= self.tour.len())
        }
    }

    /// Moves the stops from `from` to `to` to before the `k`th one, perhaps
    /// turned round, if that makes the tour shorter.
    fn shift(&mut self, from: usize, to: usize, k: usize, turn: bool) -> bool {
        if (from..=to).contains(&k) {
            return false;
        }
        let (low, high) = (from.min(k), to.max(k));
        if high - low > SPAN || self.stage(low) != self.stage(high - 1) {
            return false;
        }
        let old = self.way(from) + self.way(to) + self.way(k);
        let (head, tail) = if turn {
            (self.exit_before(to), self.entry(from))
        } else {
            (self.entry(from), self.exit_before(to))
        };
        let new = self.way_to(to, self.exit_before(from))
            + between(self.exit_before(k), head)
            + self.way_to(k, tail);
        if !gains(old, new) {
            return false;
        }
        if turn {
            self.turn_round(from, to);
        }
        let count = to - from;
        if k < from {
            self.tour[low..high].rotate_right(count)
        } else {
            self.tour[low..high].rotate_left(count)
        }
        self.update(low, high);
        true
    }

    fn turn_round(&mut self, from: usize, to: usize) {
        self.tour[from..to].reverse();
        for visit in &mut self.tour[from..to] {
            visit.turned = !visit.turned;
        }
    }

    /// Queues the stops between two places, whose ways have changed.
    fn update(&mut self, from: usize, to: usize) {
        for k in from..to {
            self.places[self.tour[k].stop] = k;
        }
        let around = [from.wrapping_sub(1), from, from + 1, from + MOVED];
        let behind = [to, to - 1, to.wrapping_sub(2), to.wrapping_sub(MOVED)];
        for k in around.into_iter().chain(behind) {
            if let Some(visit) = self.tour.get(k)
                && !std::mem::replace(&mut self.queued[visit.stop], true)
            {
                self.queue.push(visit.stop);
            }
        }
    }
}

/// True if an exchange is worth it.
fn gains(old: Mm, new: Mm) -> bool {
    old - new > GAIN
}

/// Length of a way; 0 if one of its ends is free.
fn between(a: Option<DVec2>, b: Option<DVec2>) -> Mm {
    a.zip(b).map_or(0.0, |(a, b)| a.distance(b))
}

#[cfg(test)]
mod tests;
