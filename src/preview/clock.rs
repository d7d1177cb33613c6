//! How long each move of a file takes.
//!
//! In: moves, as read. Out: times for each, in the same order, by the motion
//! model of [`crate::pace::motion`] with the accelerations that the file
//! sets; what it does not set is as in our own settings' defaults.

use crate::pace::motion::{Limits, Motion};
use crate::reader::{Move, State};
use crate::settings::Settings;
use crate::units::{MmPerSec, MmPerSec2, Seconds};

/// Speed of moves before the file sets one.
const FIRST_SPEED: MmPerSec = 25.0;
/// Moves after which the model is brought to rest, lest a file without
/// layers need memory without end; the stop costs a fraction of a second.
const LONGEST_CHAIN: usize = 1 << 17;

/// Moves that wait for their time. `T` says what a move is.
#[derive(Debug)]
pub(super) struct Clock<T> {
    motion: Motion,
    limits: Limits,
    acceleration: MmPerSec2,
    waiting: Vec<T>,
}

impl<T> Clock<T> {
    pub fn new() -> Self {
        let settings = Settings::default();
        let limits = Limits::new(&settings);
        Self {
            motion: Motion::new(limits),
            limits,
            acceleration: settings.printer.acceleration,
            waiting: Vec::new(),
        }
    }

    /// Adds a move, made in this state of the machine.
    pub fn push(&mut self, step: &Move, state: &State, what: T) {
        let before = self.motion.segments().len();
        let speed = match step.speed {
            speed if speed > 0.0 => speed,
            _ => FIRST_SPEED,
        };
        if step.travels() {
            let prints = step.prints();
            let set = match prints {
                true => state.acceleration,
                false => state.travel_acceleration,
            };
            let acceleration = set.unwrap_or(self.acceleration);
            let way = step.to - step.from;
            let filament = step.filament / step.length();
            self.motion.push(way, speed, acceleration, filament, prints);
        } else {
            self.motion.push_filament(step.filament, speed);
        }
        if self.motion.segments().len() > before {
            self.waiting.push(what);
        }
    }

    /// True if the moves had better be told their times.
    pub fn is_full(&self) -> bool {
        self.waiting.len() >= LONGEST_CHAIN
    }

    /// Comes to rest: tells every move since the last rest its time.
    pub fn rest(&mut self, state: &State, mut tell: impl FnMut(T, Seconds)) {
        let times = self.motion.times(|s| s.speed);
        for (what, time) in self.waiting.drain(..).zip(times) {
            tell(what, time);
        }
        self.motion.clear();
        let corner = state.square_corner_velocity;
        let limits = Limits {
            square_corner_velocity: corner
                .unwrap_or(self.limits.square_corner_velocity),
            ..self.limits
        };
        if limits != self.limits {
            self.limits = limits;
            self.motion = Motion::new(limits);
        }
    }
}
