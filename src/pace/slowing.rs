//! Slows a layer down until it takes long enough to cool.
//!
//! In: a layer's moves, and how long the layer is to take. Out: how much slower
//! its beads become, and the time that the layer then takes.

use super::motion::Motion;
use crate::settings::Cooling;
use crate::units::{MmPerSec, Seconds};

/// How near a slowed layer's time comes to `cooling.min_layer_time`, as a share
/// of that time.
pub(super) const LAYER_TIME_TOLERANCE: f64 = 1e-3;

/// Greatest number of trials. Four are usual, and each is a pass over the
/// layer.
const MAX_TRIALS: usize = 12;

/// How beads are slowed.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slowing {
    factor: f64,
    floor: MmPerSec,
}

impl Slowing {
    /// The slowed speed. A speed below the floor stays as it is.
    pub(super) fn apply(&self, speed: MmPerSec) -> MmPerSec {
        (speed * self.factor).max(speed.min(self.floor))
    }

    fn time(self, motion: &mut Motion) -> Seconds {
        self.times(motion).sum()
    }

    /// The time of each move.
    pub(super) fn times(
        self,
        motion: &mut Motion,
    ) -> impl Iterator<Item = Seconds> + '_ {
        motion.times(move |s| {
            if s.prints {
                self.apply(s.speed)
            } else {
                s.speed
            }
        })
    }
}

/// How much to slow the layer's beads for the layer to take
/// `cooling.min_layer_time`, and the time that it then takes.
///
/// The time grows with the slowness 1/factor: at first linearly, then less, as
/// beads reach the floor. So a search by false position finds the slowness in a
/// few trials.
pub(super) fn slow_down(
    motion: &mut Motion,
    cooling: &Cooling,
) -> (Slowing, Seconds) {
    let target = cooling.min_layer_time;
    let at = |slowness: f64| Slowing {
        factor: 1.0 / slowness,
        floor: cooling.min_speed,
    };
    let full = at(1.0).time(motion);
    // Slowness at which the fastest bead, and so every bead, is at the floor.
    let slowest = motion
        .segments()
        .iter()
        .filter(|s| s.prints)
        .map(|s| s.speed / cooling.min_speed)
        .fold(1.0, f64::max);
    let too_short = |time: f64| time < target;
    if !too_short(full) || slowest <= 1.0 || !slowest.is_finite() {
        return (at(1.0), full);
    }
    let limit = at(slowest).time(motion);
    if too_short(limit) {
        return (at(slowest), limit);
    }
    // Invariant: the layer is too short at `low`, and long enough at `high`.
    let (mut low, mut high) = ((1.0, full), (slowest, limit));
    let cruising: f64 = motion
        .segments()
        .iter()
        .filter(|s| s.prints)
        .map(|s| s.length / s.speed)
        .sum();
    let mut guess = 1.0 + (target - full) / cruising;
    for _ in 0..MAX_TRIALS {
        if (high.1 - target) <= LAYER_TIME_TOLERANCE * target {
            break;
        }
        if !(guess > low.0 && guess < high.0) {
            guess = 0.5 * (low.0 + high.0);
        }
        let time = at(guess).time(motion);
        if too_short(time) {
            low = (guess, time);
        } else {
            high = (guess, time);
        }
        // The search aims a little above the target, so that `high`, which is
        // the answer, moves.
        let aim = target * (1.0 + 0.5 * LAYER_TIME_TOLERANCE);
        guess = low.0 + (aim - low.1) / (high.1 - low.1) * (high.0 - low.0);
    }
    (at(high.0), high.1)
}
