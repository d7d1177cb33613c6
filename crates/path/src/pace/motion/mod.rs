//! The motion model: how long a machine with limited acceleration takes for a
//! chain of straight moves.
//!
//! In: straight moves with a speed and an acceleration each. Out: the time that
//! they take from rest to rest by the rules of the firmware's planner.
//!
//! Guarantees: a move follows a trapezoid of speed (speeds up, cruises, slows
//! down, each at its constant acceleration); the speed at a junction of two
//! moves never exceeds what the [`Planner`]'s rule for corners allows, nor
//! what can be reached from the start or braked away before the end.
//!
//! ```text
//!   speed  ╭────────╮   cruise         two moves that meet at a corner:
//!         ╱          ╲
//!        ╱            ╲  junction            ●───────────┐ junction speed
//!   ────●              ●────── time                      │ from the angle
//! ```
//!
//! A move of z or of the filament alone, and a move that pulls filament back on
//! its way, are as fast as the axis of z or of the filament allows.
//!
//! Not modelled: pressure advance, input shaping, limits of single motors, and
//! a host or a card that is too slow to keep the firmware's buffer full (Marlin
//! then stretches short moves to 20 ms).
//!
//! | file | what it does |
//! |---|---|
//! | `planner` | each firmware's rules |
//! | `ramps` | speeds along a chain, and times |

mod planner;
mod ramps;

pub use planner::Planner;

use glam::{DVec3, DVec4};
use isoslice_base::units::{Mm, MmPerSec, MmPerSec2, Seconds};
use planner::Leg;
use ramps::Ramps;
use std::ops::Range;

/// Length below which a move does not count, mm: 0.001 of what the G-code
/// resolves, so that no division by a length overflows.
const MIN_LENGTH: Mm = 1e-6;

/// What the machine can do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// The firmware's rules.
    pub planner: Planner,
    /// Acceleration of moves, unless another one is asked for.
    pub acceleration: MmPerSec2,
    /// Acceleration of moves that do not print.
    pub travel_acceleration: MmPerSec2,
    /// Greatest speed of the z axis.
    pub speed_z: MmPerSec,
    /// Greatest acceleration of the z axis.
    pub acceleration_z: MmPerSec2,
    /// Greatest acceleration of the filament while nothing is printed.
    pub filament_acceleration: MmPerSec2,
}

/// One straight move at one nominal speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment {
    /// Length of the move, or of filament if nothing else moves.
    pub length: Mm,
    /// Cruising speed that is asked for.
    pub speed: MmPerSec,
    /// Greatest acceleration.
    pub acceleration: MmPerSec2,
    /// The gentler acceleration that limits its speed among short moves
    /// ([`Planner::gentle`]).
    gentle: MmPerSec2,
    /// True if the move prints and may be slowed for cooling.
    pub prints: bool,
    /// True if the move is slowed only when all others are.
    pub spared: bool,
}

/// A chain of moves from rest to rest.
#[derive(Clone, Debug)]
pub struct Motion {
    limits: Limits,
    segments: Vec<Segment>,
    /// Square of the greatest speed that the corner at each segment's start
    /// allows, whatever the moves' own speeds.
    corner: Vec<f64>,
    /// The last move.
    last: Option<Leg>,
    /// The acceleration that the firmware was told last.
    told: MmPerSec2,
    ramps: Ramps,
}

impl Motion {
    /// An empty chain for a machine with these limits that was told this
    /// acceleration.
    pub fn new(limits: Limits, told: MmPerSec2) -> Self {
        Self {
            limits,
            segments: Vec::new(),
            corner: Vec::new(),
            last: None,
            told,
            ramps: Ramps::default(),
        }
    }

    /// Forgets all moves.
    pub fn clear(&mut self) {
        self.segments.clear();
        self.corner.clear();
        self.last = None;
    }

    /// Tells the firmware an acceleration.
    pub fn tell(&mut self, acceleration: MmPerSec2) {
        self.told = acceleration;
    }

    /// Length of the straight moves into which the firmware cuts an arc.
    pub fn chord(&self, radius: Mm) -> Mm {
        self.limits.planner.chord(radius)
    }

    /// The moves so far.
    pub fn segments(&self) -> &[Segment] {
        &self.segments
    }

    /// Lets some of the moves give way last if moves have to be slowed.
    pub fn spare(&mut self, which: Range<usize>) {
        for segment in
            self.segments.iter_mut().take(which.end).skip(which.start)
        {
            segment.spared = true;
        }
    }

    /// Adds a move of the head by `step` that feeds `filament` mm of filament
    /// for each mm, at an acceleration that the firmware is told. The limits of
    /// z and of the filament hold, too.
    pub fn push(
        &mut self,
        step: DVec3,
        speed: MmPerSec,
        acceleration: MmPerSec2,
        filament: f64,
        prints: bool,
    ) {
        let length = step.length();
        // A length that is NaN is skipped, too; the writer reports it.
        if length.is_nan() || length < MIN_LENGTH {
            return;
        }
        self.told = acceleration;
        let course = (step / length).extend(filament);
        let Limits {
            speed_z,
            acceleration_z,
            filament_acceleration,
            ..
        } = self.limits;
        // Without a rise these limits are infinite.
        let rise = course.z.abs();
        let mut least = acceleration.min(acceleration_z / rise);
        if filament < 0.0 || (course.x == 0.0 && course.y == 0.0) {
            least = least.min(filament_acceleration / filament.abs());
        }
        self.add(
            length,
            speed.min(speed_z / rise),
            Leg {
                course,
                length,
                acceleration: least,
                told: acceleration,
                prints,
            },
        );
    }

    /// Adds a move of the filament alone, in or out.
    pub(crate) fn push_filament(&mut self, length: Mm, speed: MmPerSec) {
        if length.is_nan() || length.abs() < MIN_LENGTH {
            return;
        }
        let leg = Leg {
            course: DVec4::W * length.signum(),
            length: length.abs(),
            acceleration: self.limits.filament_acceleration,
            told: self.told,
            prints: false,
        };
        self.add(length.abs(), speed, leg);
    }

    fn add(&mut self, length: Mm, speed: MmPerSec, leg: Leg) {
        let corner = match &self.last {
            Some(last) => self.limits.planner.corner(last, &leg, &self.limits),
            None => 0.0,
        };
        self.corner.push(corner);
        let acceleration = leg.acceleration;
        self.segments.push(Segment {
            length,
            speed,
            acceleration,
            gentle: self.limits.planner.gentle(leg.told).min(acceleration),
            prints: leg.prints,
            spared: false,
        });
        self.last = Some(leg);
    }

    /// Time of the chain if each segment cruises at `speed(segment)`.
    pub fn time(&mut self, speed: impl Fn(&Segment) -> MmPerSec) -> Seconds {
        self.times(speed).sum()
    }

    /// Times of the segments if each cruises at `speed(segment)`.
    pub fn times(
        &mut self,
        speed: impl Fn(&Segment) -> MmPerSec,
    ) -> impl Iterator<Item = Seconds> + '_ {
        let Self {
            limits,
            segments,
            corner,
            ramps,
            ..
        } = self;
        ramps.plan(segments, corner, &limits.planner, speed);
        ramps.times(segments)
    }
}

#[cfg(test)]
mod tests;
