//! The motion model: how long a machine with limited acceleration takes for a
//! chain of straight moves.
//!
//! In: straight segments with a speed and an acceleration each. Out: the time
//! they take from rest to rest.
//!
//! Guarantees: a move follows a trapezoid of speed (speeds up, cruises, slows
//! down, each at its constant acceleration); the speed at a junction of two
//! moves never exceeds what the corner allows, nor what can be reached from
//! the start or braked away before the end.
//!
//! ```text
//!   speed  ╭────────╮   cruise         two moves that meet at a corner:
//!         ╱          ╲
//!        ╱            ╲  junction            ●───────────┐ junction speed
//!   ────●              ●────── time                      │ from the angle
//! ```
//!
//! The formulas are those Klipper documents (docs/Kinematics.md, "Trapezoid
//! generator", "Look-ahead", "Smoothed look-ahead" and the page it refers to
//! for the approximated centripetal acceleration; the option names and their
//! defaults in docs/Config_Reference.md):
//!
//! - v² = v₀² + 2·a·d along a move;
//! - a junction is taken as an arc that leaves the corner by at most
//!   δ = v_sc²·(√2 − 1)/a: v² = a·δ·s/(1 − s) with s the sine of half the
//!   angle between the moves, so that a right angle has v = v_sc, the square
//!   corner velocity;
//! - nor may the arc that touches both moves at their middles need more than
//!   the moves' acceleration: v² = a·d/2·t, t the tangent of half the angle;
//! - the filament's speed may jump by at most [`FILAMENT_JUMP`];
//! - moves of the filament alone start and end at rest;
//! - with `cruise_acceleration` below 1 (Klipper's minimum cruise ratio) short
//!   zigzags are limited to the speed a gentler acceleration would reach.
//!
//! Not modelled: Marlin's jerk and its look-ahead of a few moves only,
//! pressure advance, input shaping, and limits of single motors.

use crate::settings::{Flavour, Settings};
use crate::units::{Mm, MmPerSec, MmPerSec2, Seconds, filament_area};
use glam::DVec3;

/// Greatest sudden change of the filament's speed at a junction, mm/s:
/// Klipper's default of `instantaneous_corner_velocity`.
pub const FILAMENT_JUMP: MmPerSec = 1.0;

/// Below this length (mm) a move is no move: a thousandth of what the G-code
/// can resolve, so that no division by a length can overflow.
const MIN_LENGTH: Mm = 1e-6;

/// What the machine can do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Speed through a right-angled corner.
    pub square_corner_velocity: MmPerSec,
    /// Acceleration of moves of the filament alone.
    pub filament_acceleration: MmPerSec2,
    /// Share of the acceleration that short zigzags may count on when they
    /// choose their speed: 1 switches this off, Klipper's default is 0.5.
    pub cruise_acceleration: f64,
}

impl Limits {
    /// The limits of the printer in `settings`.
    pub fn new(settings: &Settings) -> Self {
        let printer = &settings.printer;
        let (filament_acceleration, cruise_acceleration) =
            match settings.gcode.flavour {
                Flavour::Marlin | Flavour::Rrf | Flavour::Prusa => {
                    (printer.acceleration, 1.0)
                }
                // By default Klipper lets the filament alone accelerate as it
                // would when printing a bead of 4·nozzle² cross-section with
                // the greatest acceleration of its configuration, which must
                // be that of travels, if they are faster.
                Flavour::Klipper => (
                    printer.acceleration.max(printer.travel_acceleration)
                        * 4.0
                        * printer.nozzle_diameter.powi(2)
                        / filament_area(settings.filament.diameter),
                    0.5,
                ),
            };
        Self {
            square_corner_velocity: printer.square_corner_velocity,
            filament_acceleration,
            cruise_acceleration,
        }
    }
}

/// One straight move at one nominal speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment {
    /// Length of the move; of filament, if nothing but filament moves.
    pub length: Mm,
    /// Cruising speed it is to have.
    pub speed: MmPerSec,
    /// Greatest acceleration.
    pub acceleration: MmPerSec2,
    /// True if it prints, and may be slowed for cooling.
    pub prints: bool,
}

/// A chain of moves from rest to rest.
#[derive(Clone, Debug)]
pub struct Motion {
    limits: Limits,
    segments: Vec<Segment>,
    /// Greatest square of the speed at each segment's start that the corner
    /// allows, whatever the moves' own speeds.
    corner: Vec<f64>,
    /// Direction and filament per length of the last move, if it was not one
    /// of filament alone.
    heading: Option<(DVec3, f64)>,
    /// Squares of the speeds at the segments' starts and at the last one's
    /// end; kept to save the allocation.
    joints: Vec<f64>,
    peaks: Vec<f64>,
}

impl Motion {
    /// An empty chain for a machine with these limits.
    pub fn new(limits: Limits) -> Self {
        Self {
            limits,
            segments: Vec::new(),
            corner: Vec::new(),
            heading: None,
            joints: Vec::new(),
            peaks: Vec::new(),
        }
    }

    /// Forgets all moves.
    pub fn clear(&mut self) {
        self.segments.clear();
        self.corner.clear();
        self.heading = None;
    }

    /// The moves so far.
    pub fn segments(&self) -> &[Segment] {
        &self.segments
    }

    /// Adds a move of the head by `step`, feeding `filament` mm of filament
    /// for each mm.
    pub fn push(
        &mut self,
        step: DVec3,
        speed: MmPerSec,
        acceleration: MmPerSec2,
        filament: f64,
        prints: bool,
    ) {
        let length = step.length();
        // Also skips a length that is not a number: the writer reports it.
        if length.is_nan() || length < MIN_LENGTH {
            return;
        }
        let segment = Segment {
            length,
            speed,
            acceleration,
            prints,
        };
        let direction = step / length;
        let corner = match (self.segments.last(), self.heading) {
            (Some(last), Some((from, fed))) => self
                .corner_limit(last, &segment, from.dot(direction))
                .min((FILAMENT_JUMP / (filament - fed).abs()).powi(2)),
            _ => 0.0,
        };
        self.corner.push(corner);
        self.segments.push(segment);
        self.heading = Some((direction, filament));
    }

    /// Adds a move of the filament alone, in or out, from rest to rest.
    pub fn push_filament(&mut self, length: Mm, speed: MmPerSec) {
        let length = length.abs();
        if length.is_nan() || length < MIN_LENGTH {
            return;
        }
        self.corner.push(0.0);
        self.segments.push(Segment {
            length,
            speed,
            acceleration: self.limits.filament_acceleration,
            prints: false,
        });
        self.heading = None;
    }

    /// Square of the greatest speed through the corner between `a` and `b`,
    /// whose directions have the scalar product `cos`.
    fn corner_limit(&self, a: &Segment, b: &Segment, cos: f64) -> f64 {
        use std::f64::consts::SQRT_2;
        // Half the angle enclosed by the moves: π/2 straight on, 0 back.
        let sin = (0.5 * (1.0 + cos)).clamp(0.0, 1.0).sqrt();
        let cosine = (0.5 * (1.0 - cos)).clamp(0.0, 1.0).sqrt();
        // Acceleration cancels out of a·δ.
        let deviation =
            self.limits.square_corner_velocity.powi(2) * (SQRT_2 - 1.0);
        // Straight on both are divisions by zero: infinite, no limit.
        if cosine <= 1e-6 {
            return f64::INFINITY;
        }
        let arc = deviation * sin / (1.0 - sin);
        let reach = (a.length * a.acceleration).min(b.length * b.acceleration);
        arc.min(0.5 * reach * sin / cosine)
    }

    /// Time of the chain if each segment cruises at `speed(segment)`.
    pub fn time(&mut self, speed: impl Fn(&Segment) -> MmPerSec) -> Seconds {
        self.times(speed).sum()
    }

    /// The same, segment by segment.
    pub fn times(
        &mut self,
        speed: impl Fn(&Segment) -> MmPerSec,
    ) -> impl Iterator<Item = Seconds> + '_ {
        let Self {
            limits,
            segments,
            corner,
            joints,
            peaks,
            ..
        } = self;
        peaks.clear();
        peaks.extend(segments.iter().map(|s| speed(s).powi(2)));
        if limits.cruise_acceleration < 1.0 {
            let share = limits.cruise_acceleration;
            look_ahead(segments, corner, peaks, share, joints);
            calm(segments, joints, share, peaks);
        }
        look_ahead(segments, corner, peaks, 1.0, joints);
        segments
            .iter()
            .zip(peaks.iter())
            .zip(joints.windows(2))
            .map(|((s, &peak), ends)| {
                trapezoid(s.length, s.acceleration, ends[0], peak, ends[1])
            })
    }
}

/// Squares of the speeds at the joints of the chain, `joints[i]` at the start
/// of segment i: as fast as corners and cruising speeds allow, reachable from
/// the rest before and the rest after with `share` of the acceleration.
fn look_ahead(
    segments: &[Segment],
    corner: &[f64],
    peaks: &[f64],
    share: f64,
    joints: &mut Vec<f64>,
) {
    let n = segments.len();
    let gain =
        |i: usize| 2.0 * share * segments[i].acceleration * segments[i].length;
    joints.clear();
    joints.resize(n + 1, 0.0);
    for i in (1..n).rev() {
        let limit = corner[i].min(peaks[i - 1]).min(peaks[i]);
        joints[i] = limit.min(joints[i + 1] + gain(i));
    }
    for i in 1..n {
        joints[i] = joints[i].min(joints[i - 1] + gain(i - 1));
    }
}

/// Lowers the cruising speeds to what the gentler acceleration reaches: a run
/// of moves that only speed up, and the run after it that only slow down,
/// share the speed of the place where one turns into the other.
fn calm(segments: &[Segment], joints: &[f64], share: f64, peaks: &mut [f64]) {
    let mut peak = f64::INFINITY;
    // Moves behind `i` that only slow down and wait for their peak.
    let mut slowing = 0;
    for i in (0..segments.len()).rev() {
        let gain = 2.0 * share * segments[i].acceleration * segments[i].length;
        let (start, end) = (joints[i], joints[i + 1]);
        let slack = 1e-9 * (start + end + gain);
        if start >= end + gain - slack {
            slowing += 1;
            continue;
        }
        if start + gain > end + slack || slowing > 0 {
            peak = peaks[i].min(0.5 * (start + end + gain));
        }
        for p in &mut peaks[i..=i + slowing] {
            *p = p.min(peak);
        }
        slowing = 0;
    }
}

/// Time of a move of `length` whose speeds at start, cruise and end have the
/// squares `start`, `cruise` and `end`; a cruise that cannot be reached is cut
/// to a peak.
fn trapezoid(
    length: Mm,
    acceleration: MmPerSec2,
    start: f64,
    cruise: f64,
    end: f64,
) -> Seconds {
    let top = 0.5 * (start + end) + acceleration * length;
    let peak = cruise.min(top).max(start).max(end);
    let v = peak.sqrt();
    let ramps = (2.0 * v - start.sqrt() - end.sqrt()) / acceleration;
    let cruised = length - (2.0 * peak - start - end) / (2.0 * acceleration);
    ramps + cruised.max(0.0) / v
}

#[cfg(test)]
mod tests {
    use super::*;

    const A: f64 = 1000.0;

    fn motion() -> Motion {
        Motion::new(Limits {
            square_corner_velocity: 5.0,
            filament_acceleration: A,
            cruise_acceleration: 1.0,
        })
    }

    fn close(a: f64, b: f64) {
        assert!((a - b).abs() < 1e-9 * (1.0 + b.abs()), "{a} is not {b}");
    }

    #[test]
    fn a_single_move_is_a_trapezoid() {
        let mut m = motion();
        m.push(DVec3::new(30.0, 40.0, 0.0), 100.0, A, 0.0, false);
        // d/v + v/a
        close(m.time(|s| s.speed), 50.0 / 100.0 + 100.0 / A);
    }

    #[test]
    fn a_short_move_is_a_triangle() {
        let mut m = motion();
        m.push(DVec3::X, 100.0, A, 0.0, false);
        close(m.time(|s| s.speed), 2.0 * (1.0 / A).sqrt());
    }

    #[test]
    fn a_right_angle_is_taken_at_the_square_corner_velocity() {
        let mut m = motion();
        m.push(DVec3::X * 50.0, 100.0, A, 0.03, true);
        m.push(DVec3::Y * 50.0, 100.0, A, 0.03, true);
        // Each move: one ramp from rest, one to the corner's 5 mm/s.
        let (v, c) = (100.0, 5.0);
        let ramps = v / A + (v - c) / A;
        let on_ramps = (v * v + v * v - c * c) / (2.0 * A);
        close(m.time(|s| s.speed), 2.0 * (ramps + (50.0 - on_ramps) / v));
    }

    #[test]
    fn straight_on_is_one_move_and_back_is_a_stop() {
        let mut one = motion();
        one.push(DVec3::X * 50.0, 100.0, A, 0.0, false);
        let whole = one.time(|s| s.speed);
        let mut cut = motion();
        for _ in 0..500 {
            cut.push(DVec3::X * 0.1, 100.0, A, 0.0, false);
        }
        close(cut.time(|s| s.speed), whole);
        one.push(DVec3::X * -50.0, 100.0, A, 0.0, false);
        close(one.time(|s| s.speed), 2.0 * whole);
    }

    #[test]
    fn a_small_circle_is_limited_by_its_centripetal_acceleration() {
        // Finely cut, v² = a·r on the circle.
        let (r, n) = (1.0, 2000);
        let at = |i: i32| {
            let t = std::f64::consts::TAU * f64::from(i) / f64::from(n);
            DVec3::new(r * t.cos(), r * t.sin(), 0.0)
        };
        let mut m = motion();
        for turn in 0..20 * n {
            m.push(at(turn + 1) - at(turn), 500.0, A, 0.0, true);
        }
        let v = (A * r).sqrt();
        let expected = 20.0 * std::f64::consts::TAU * r / v + v / A;
        let time = m.time(|s| s.speed);
        assert!((time / expected - 1.0).abs() < 1e-3, "{time} {expected}");
    }

    #[test]
    fn filament_moves_stop_the_head() {
        let mut m = motion();
        m.push(DVec3::X * 50.0, 100.0, A, 0.0, false);
        let half = m.time(|s| s.speed);
        m.push_filament(-0.8, 35.0);
        m.push(DVec3::X * 50.0, 100.0, A, 0.0, false);
        // 0.8 mm is too short for 35 mm/s at 1000 mm/s²: a triangle.
        let retraction = 2.0 * (0.8 / A).sqrt();
        close(m.time(|s| s.speed), 2.0 * half + retraction);
    }

    #[test]
    fn a_jump_of_the_filament_limits_a_straight_junction() {
        let mut m = motion();
        m.push(DVec3::X * 50.0, 100.0, A, 0.0, true);
        m.push(DVec3::X * 50.0, 100.0, A, 0.1, true);
        let (v, c) = (100.0, 10.0);
        let ramps = v / A + (v - c) / A;
        let on_ramps = (v * v + v * v - c * c) / (2.0 * A);
        close(m.time(|s| s.speed), 2.0 * (ramps + (50.0 - on_ramps) / v));
    }

    #[test]
    fn the_minimum_cruise_ratio_slows_short_moves_only() {
        let mut m = motion();
        m.limits.cruise_acceleration = 0.5;
        m.push(DVec3::X * 50.0, 100.0, A, 0.0, false);
        close(m.time(|s| s.speed), 0.6);
        // A move of 1 mm: at half the acceleration its peak is v² = a/2·d.
        m.clear();
        m.push(DVec3::X, 100.0, A, 0.0, false);
        let v = (0.5 * A).sqrt();
        close(m.time(|s| s.speed), 1.0 / v + v / A);
        // Cutting the move changes nothing: the run shares its peak.
        m.clear();
        for _ in 0..10 {
            m.push(DVec3::X * 0.1, 100.0, A, 0.0, false);
        }
        close(m.time(|s| s.speed), 1.0 / v + v / A);
    }

    #[test]
    fn the_filament_alone_accelerates_as_the_firmware_lets_it() {
        let mut s = Settings::default();
        s.printer.acceleration = 3000.0;
        s.printer.travel_acceleration = 5000.0;
        let alone = |s: &Settings| Limits::new(s).filament_acceleration;
        close(alone(&s), 3000.0);
        s.gcode.flavour = Flavour::Klipper;
        // 0.64 mm² of bead to 1.75 mm of filament.
        close(
            alone(&s),
            5000.0 * 0.64 / (0.25 * std::f64::consts::PI * 3.0625),
        );
    }

    #[test]
    fn nothing_takes_no_time() {
        assert_eq!(motion().time(|s| s.speed), 0.0);
        let mut m = motion();
        m.push(DVec3::ZERO, 100.0, A, 0.0, false);
        m.push(DVec3::X * f64::NAN, 100.0, A, 0.0, false);
        m.push_filament(0.0, 35.0);
        assert_eq!(m.time(|s| s.speed), 0.0);
    }
}
