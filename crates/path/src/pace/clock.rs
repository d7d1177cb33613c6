//! Times the moves of a text.
//!
//! In: moves, as the reader gives them. Out: the time of each, in their order,
//! by the [motion model](super::motion), with the accelerations that the text
//! sets, or the printer's own.

use super::motion::{Limits, Motion, Planner};
use glam::DVec3;
use isoslice_base::units::{MmPerSec, Seconds};
use isoslice_gcode_read::reader::{Event, MachineState, Move, Reader};
use isoslice_settings::Flavour;

/// Speed of moves before the file sets one.
const FIRST_SPEED: MmPerSec = 25.0;
/// Number of moves after which the model comes to rest, so that a file without
/// layers does not need endless memory. The stop costs a fraction of a second.
const LONGEST_CHAIN: usize = 1 << 17;

/// Moves that wait for their times. `T` says what a move is.
#[derive(Debug)]
pub struct Clock<T> {
    motion: Motion,
    limits: Limits,
    waiting: Vec<T>,
}

impl<T> Clock<T> {
    /// A clock for a printer.
    pub fn new(limits: Limits) -> Self {
        Self {
            motion: Motion::new(limits, limits.acceleration),
            limits,
            waiting: Vec::new(),
        }
    }

    /// Adds a move that is made in this state of the machine.
    pub fn push(&mut self, step: &Move, state: &MachineState, what: T) {
        let before = self.motion.segments().len();
        let speed = match step.speed {
            speed if speed > 0.0 => speed,
            _ => FIRST_SPEED,
        };
        if step.travels() {
            let prints = step.prints();
            let set = if prints {
                state.acceleration
            } else {
                state.travel_acceleration
            };
            let acceleration = set.unwrap_or(self.limits.acceleration);
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

    /// True if it is time for [`Clock::rest`].
    pub fn is_full(&self) -> bool {
        self.waiting.len() >= LONGEST_CHAIN
    }

    /// Comes to rest, and tells the time of every move since the last rest.
    pub fn rest(
        &mut self,
        state: &MachineState,
        mut tell: impl FnMut(T, Seconds),
    ) {
        let times = self.motion.times(|s| s.speed);
        for (what, time) in self.waiting.drain(..).zip(times) {
            tell(what, time);
        }
        self.motion.clear();
        // Only Klipper has a command for this speed.
        let Some(corner) = state.square_corner_velocity else {
            return;
        };
        let limits = Limits {
            planner: Planner::new(
                Flavour::Klipper,
                corner,
                self.limits.acceleration,
            ),
            ..self.limits
        };
        if limits != self.limits {
            self.limits = limits;
            self.motion = Motion::new(limits, self.limits.acceleration);
        }
    }
}

/// How long a text takes on a printer, from rest to rest, and
/// where the head is in the end. Moves and pauses count, heating and homing do
/// not.
pub fn time_of(text: &[u8], limits: Limits) -> (Seconds, DVec3) {
    let mut clock = Clock::new(limits);
    let mut reader = Reader::new(text);
    let mut total = 0.0;
    while let Some(Ok(event)) = reader.next() {
        match event {
            Event::Move(step) => clock.push(&step, reader.state(), ()),
            Event::Dwell { time, .. } => total += time,
            _ => {}
        }
        if clock.is_full() {
            clock.rest(reader.state(), |(), time| total += time);
        }
    }
    clock.rest(reader.state(), |(), time| total += time);
    (total, reader.state().position)
}
