//! Slows a layer down until it takes long enough to cool.
//!
//! In: a layer's moves, and how long the layer is to take. Out: the greatest
//! speeds of its beads, and the time that the layer then takes.
//!
//! The fastest beads give way first, since they gain least from their speed: all
//! get one greatest speed. The outer walls give way when all others are as slow
//! as they may be. So they look alike in layers that differ in what is inside.

use super::motion::{Motion, Segment};
use isoslice_base::units::{MmPerSec, Seconds};
use isoslice_settings::Cooling;

/// How near a slowed layer's time comes to `cooling.min_layer_time`, as a share
/// of that time.
pub(super) const LAYER_TIME_TOLERANCE: f64 = 1e-3;

/// Greatest number of trials. Five are usual, and each is a pass over the
/// layer.
const MAX_TRIALS: usize = 16;

/// How beads are slowed.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slowing {
    /// Greatest speed of outer walls.
    outer: MmPerSec,
    /// Greatest speed of all other beads.
    others: MmPerSec,
}

impl Slowing {
    /// The greatest speed of outer walls, if `spared` is true, or of all others.
    fn cap(&mut self, spared: bool) -> &mut MmPerSec {
        if spared {
            &mut self.outer
        } else {
            &mut self.others
        }
    }

    /// The slowed speed of a bead. `spared` is true for outer walls.
    pub(super) fn apply(&self, speed: MmPerSec, spared: bool) -> MmPerSec {
        speed.min(if spared { self.outer } else { self.others })
    }

    /// The slowed speed of a move.
    pub(super) fn speed(&self, segment: &Segment) -> MmPerSec {
        if segment.prints {
            self.apply(segment.speed, segment.spared)
        } else {
            segment.speed
        }
    }

    /// The time of each move.
    pub(super) fn times(
        self,
        motion: &mut Motion,
    ) -> impl Iterator<Item = Seconds> + '_ {
        motion.times(move |s| self.speed(s))
    }
}

/// How much to slow the layer's beads for the layer to take
/// `cooling.min_layer_time`, and the time that it then takes.
pub(super) fn slow_down(
    motion: &mut Motion,
    cooling: &Cooling,
) -> (Slowing, Seconds) {
    let mut slowing = Slowing {
        outer: f64::INFINITY,
        others: f64::INFINITY,
    };
    let mut time = slowing.times(motion).sum();
    for spared in [false, true] {
        if time >= cooling.min_layer_time {
            break;
        }
        let of_kind = |s: &&Segment| s.prints && s.spared == spared;
        let speeds = motion.segments().iter().filter(of_kind);
        let fastest = speeds.map(|s| s.speed).fold(0.0, f64::max);
        let slowest = 1.0 / cooling.min_speed;
        if fastest * slowest <= 1.0 || !slowest.is_finite() {
            continue;
        }
        let at = |slowness: f64| {
            let mut slower = slowing;
            *slower.cap(spared) = 1.0 / slowness;
            slower
        };
        let (found, taken) = long_enough(
            (1.0 / fastest, time),
            slowest,
            cooling.min_layer_time,
            |slowness| at(slowness).times(motion).sum(),
        );
        (slowing, time) = (at(found), taken);
    }
    (slowing, time)
}

/// The least slowness, up to `slowest`, at which a layer takes a time `target`,
/// and the time that it then takes. `low` has a slowness at which the layer is
/// too short, and its time there.
///
/// The time grows with the slowness: at first slowly, while few beads are
/// faster, then linearly. A search by false position finds the slowness in a few
/// trials. Where one side stays, its weight is halved (Illinois).
fn long_enough(
    low: (f64, Seconds),
    slowest: f64,
    target: Seconds,
    mut time: impl FnMut(f64) -> Seconds,
) -> (f64, Seconds) {
    let mut high = (slowest, time(slowest));
    if high.1 < target {
        return high;
    }
    // The search aims a little above the target, so that `high`, which is the
    // answer, moves. The layer is too short at `low`, and long enough at `high`.
    let aim = target * (1.0 + 0.5 * LAYER_TIME_TOLERANCE);
    let (mut low, short) = low;
    let mut off = [short - aim, high.1 - aim];
    let mut last = None;
    for _ in 0..MAX_TRIALS {
        if high.1 - target <= LAYER_TIME_TOLERANCE * target {
            break;
        }
        let share = off[0] / (off[0] - off[1]);
        let mut guess = low + share * (high.0 - low);
        if !(guess > low && guess < high.0) {
            guess = 0.5 * (low + high.0);
        }
        let found = time(guess);
        let side = usize::from(found >= target);
        if side == 1 {
            high = (guess, found);
        } else {
            low = guess;
        }
        off[side] = found - aim;
        if last == Some(side) {
            off[1 - side] *= 0.5;
        }
        last = Some(side);
    }
    high
}
