//! The planners of the firmwares: how fast a corner may be taken, and how far
//! the firmware looks ahead.
//!
//! In: two moves that meet. Out: the square of the greatest speed at their
//! corner.
//!
//! Moves have four dimensions; the fourth is the filament. `Δ` is the
//! difference of two moves' courses, per mm of their ways; `s` is the sine of
//! half the angle that they enclose: 1 straight on, 0 back.
//!
//! | firmware | a corner's speed v | moves ahead |
//! |---|---|---|
//! | Klipper | v² ≤ a·δ·s/(1 − s); v² ≤ a·d/2·s/√(1 − s²) of both moves; v·Δ ≤ 1 mm/s for the filament | all |
//! | Marlin 2 | v² ≤ a·J·s/(1 − s); for moves below 1 mm that turn by less than 45° v² ≤ a·d/θ | 14 |
//! | Prusa | v·Δ ≤ jerk of each axis; where an axis turns round, the faster of its two speeds counts | 14 |
//! | RepRapFirmware 3 | v·Δ ≤ jerk of each axis; at rest between moves of different kinds | 38 |
//!
//! The sources are the firmwares' own, and Klipper's docs/Kinematics.md:
//!
//! - Klipper's klippy/toolhead.py (`calc_junction`, `flush`) and
//!   kinematics/extruder.py. δ is v_sc²·(√2 − 1)/a, where a is the acceleration
//!   told last, not the limit of z. A right angle has v = v_sc, the square
//!   corner velocity. Moves of the filament alone start and end at rest. Short
//!   zigzags are limited to the speed a gentler acceleration would reach
//!   (`minimum_cruise_ratio`).
//! - Marlin's module/planner.cpp with its default `HAS_JUNCTION_DEVIATION` and
//!   `JD_HANDLE_SMALL_SEGMENTS`; θ is the angle of turn, and a the second
//!   move's acceleration, less where the corner needs more of z or of the
//!   filament than their axes have. J is what `M205 J` says.
//! - Prusa-Firmware's planner.cpp, and RepRapFirmware's Movement/DDA.cpp
//!   (`MatchSpeeds`, `InitStandardMove` with `M566 P0`), with the jerk that
//!   `M205 X Y` or `M566 X Y` sets.
//!
//! The moves ahead are those that a full buffer has beyond the move that
//! begins: of 16 blocks in Marlin and Prusa's firmware, of 40 in RepRapFirmware
//! (60 on a Duet 3).

use super::Limits;
use glam::DVec4;
use isoslice_base::units::{Mm, MmPerSec, MmPerSec2};
use isoslice_settings::Flavour;
use std::f64::consts::{FRAC_1_SQRT_2, SQRT_2, TAU};

/// Greatest sudden change of the filament's speed at a junction in Klipper,
/// mm/s: the default of `instantaneous_corner_velocity`.
const FILAMENT_JUMP: MmPerSec = 1.0;

/// Share of the acceleration that short zigzags may use in Klipper: 1 less the
/// default of `minimum_cruise_ratio`.
const GENTLE: f64 = 0.5;

/// Blocks that Marlin and Prusa's firmware know beyond the block that begins:
/// one block of a ring of 16 is always empty, and one is running.
const MARLIN_AHEAD: usize = 14;

/// Blocks that RepRapFirmware knows beyond the block that begins, of a ring of
/// 40.
const RRF_AHEAD: usize = 38;

/// Cosine of half the angle below which a corner is straight.
const STRAIGHT: f64 = 1e-6;

/// Range of the junction deviation that Marlin takes, mm.
const DEVIATION: (Mm, Mm) = (0.01, 0.3);

/// Jerk of z and of the filament in Prusa's firmware, mm/s. Files of this
/// program do not set it. It is the MK3S's `DEFAULT_ZJERK` and `DEFAULT_EJERK`.
const PRUSA_JERK: (MmPerSec, MmPerSec) = (0.4, 4.5);

/// Jerk of z and of the filament in RepRapFirmware, mm/s: `DefaultZInstantDv`
/// and `DefaultEInstantDv`.
const RRF_JERK: (MmPerSec, MmPerSec) = (10.0, 5.0);

/// How a firmware plans.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Planner {
    /// Klipper.
    Klipper {
        /// Speed through a right-angled corner.
        square_corner_velocity: MmPerSec,
    },
    /// Marlin 2.
    Marlin {
        /// Distance of the corner from an arc that replaces it.
        deviation: Mm,
    },
    /// Prusa's firmware.
    Prusa(Jerk),
    /// RepRapFirmware 3.
    Rrf(Jerk),
}

/// Greatest sudden changes of speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jerk {
    /// Jerk of x and of y.
    pub plane: MmPerSec,
    /// Jerk of z.
    pub z: MmPerSec,
    /// Jerk of the filament.
    pub filament: MmPerSec,
}

impl Jerk {
    fn of_axes(&self) -> DVec4 {
        DVec4::new(self.plane, self.plane, self.z, self.filament)
    }
}

/// A move, as a corner sees it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Leg {
    /// Way of x, y, z and the filament for each mm of length.
    pub course: DVec4,
    pub length: Mm,
    /// Acceleration of the move.
    pub acceleration: MmPerSec2,
    /// Acceleration that the firmware was told.
    pub told: MmPerSec2,
    pub prints: bool,
}

impl Leg {
    /// True if nothing but filament moves.
    fn stands(&self) -> bool {
        self.course.truncate() == glam::DVec3::ZERO
    }

    /// True if the head moves in the plane.
    fn in_plane(&self) -> bool {
        self.course.x != 0.0 || self.course.y != 0.0
    }
}

impl Planner {
    /// The planner of a firmware that takes right-angled corners at this speed
    /// with this acceleration.
    pub fn new(
        flavour: Flavour,
        corner: MmPerSec,
        acceleration: MmPerSec2,
    ) -> Self {
        let jerk = |(z, filament)| Jerk {
            plane: corner,
            z,
            filament,
        };
        match flavour {
            Flavour::Klipper => Planner::Klipper {
                square_corner_velocity: corner,
            },
            Flavour::Marlin => Planner::Marlin {
                deviation: Self::deviation(corner, acceleration),
            },
            // Bambu Lab's planner is not published. Their slicer estimates the
            // time with the jerk of each axis.
            Flavour::Prusa | Flavour::Bambu => Planner::Prusa(jerk(PRUSA_JERK)),
            Flavour::Rrf => Planner::Rrf(jerk(RRF_JERK)),
        }
    }

    /// The junction deviation at which Marlin takes a right-angled corner at
    /// this speed: v²·(√2 − 1)/a, within the range that Marlin takes.
    pub fn deviation(corner: MmPerSec, acceleration: MmPerSec2) -> Mm {
        (corner * corner * (SQRT_2 - 1.0) / acceleration)
            .clamp(DEVIATION.0, DEVIATION.1)
    }

    /// Length of the straight moves into which the firmware cuts an arc.
    ///
    /// Klipper: the default of `[gcode_arcs] resolution`. Marlin 2.1:
    /// `MIN_ARC_SEGMENT_MM`, `MAX_ARC_SEGMENT_MM` and `MIN_CIRCLE_SEGMENTS`.
    /// Prusa: `MM_PER_ARC_SEGMENT` and `MIN_ARC_SEGMENTS`. RepRapFirmware:
    /// `MaxArcDeviation` with the least and the greatest length of a segment.
    pub(super) fn chord(&self, radius: Mm) -> Mm {
        match self {
            Planner::Klipper { .. } => 1.0,
            Planner::Marlin { .. } => (TAU * radius / 72.0).clamp(0.1, 1.0),
            Planner::Prusa(_) => (TAU * radius / 24.0).min(1.0),
            Planner::Rrf(_) => {
                let deviation: Mm = 0.02;
                (8.0 * radius * deviation).sqrt().clamp(0.1, 2.0)
            }
        }
    }

    /// How many moves the firmware knows beyond the move that begins; none if
    /// all.
    pub(super) fn ahead(&self) -> Option<usize> {
        match self {
            Planner::Klipper { .. } => None,
            Planner::Marlin { .. } | Planner::Prusa(_) => Some(MARLIN_AHEAD),
            Planner::Rrf(_) => Some(RRF_AHEAD),
        }
    }

    /// True if short moves choose their speed by a gentler acceleration.
    pub(super) fn is_gentle(&self) -> bool {
        matches!(self, Planner::Klipper { .. })
    }

    /// The gentler acceleration when the firmware was told `told`.
    pub(super) fn gentle(&self, told: MmPerSec2) -> MmPerSec2 {
        if self.is_gentle() {
            GENTLE * told
        } else {
            told
        }
    }

    /// Square of the greatest speed at which `b` may follow `a`.
    pub(super) fn corner(&self, a: &Leg, b: &Leg, limits: &Limits) -> f64 {
        match self {
            Planner::Klipper {
                square_corner_velocity,
            } => klipper(a, b, *square_corner_velocity),
            Planner::Marlin { deviation } => marlin(a, b, *deviation, limits),
            Planner::Prusa(jerk) => {
                jerk_limit(jerk, a.course.to_array(), b.course.to_array(), true)
            }
            Planner::Rrf(jerk) => {
                let alike = a.prints == b.prints
                    && a.in_plane() == b.in_plane()
                    && a.stands() == b.stands();
                if alike {
                    jerk_limit(
                        jerk,
                        a.course.to_array(),
                        b.course.to_array(),
                        false,
                    )
                } else {
                    0.0
                }
            }
        }
    }
}

fn klipper(a: &Leg, b: &Leg, square_corner: MmPerSec) -> f64 {
    if a.stands() || b.stands() {
        return 0.0;
    }
    let jump = FILAMENT_JUMP / (b.course.w - a.course.w).abs();
    let cos = a.course.truncate().dot(b.course.truncate());
    let (sin, cosine) = half_angle(cos);
    // Without a turn both limits would be divisions by zero, that is no limits.
    if cosine <= STRAIGHT {
        return jump * jump;
    }
    let deviation = square_corner * square_corner * (SQRT_2 - 1.0);
    let share = (a.acceleration / a.told).min(b.acceleration / b.told);
    let arc = share * deviation * sin / (1.0 - sin);
    let reach = (a.length * a.acceleration).min(b.length * b.acceleration);
    (jump * jump).min(arc).min(0.5 * reach * sin / cosine)
}

fn marlin(a: &Leg, b: &Leg, deviation: Mm, limits: &Limits) -> f64 {
    /// Longest move that may be a part of an arc, mm.
    const SHORT: Mm = 1.0;
    /// Least angle of turn that Marlin's arc cosine tells from 0.
    const LEAST_TURN: f64 = 0.033;
    let (from, to) = (a.course.normalize(), b.course.normalize());
    let cos = from.dot(to);
    let (sin, cosine) = half_angle(cos);
    if cosine <= STRAIGHT {
        return f64::INFINITY;
    }
    let turn = (to - from).abs().normalize_or_zero();
    let acceleration = b
        .acceleration
        .min(limits.acceleration_z / turn.z)
        .min(limits.filament_acceleration / turn.w);
    let arc = acceleration * deviation * sin / (1.0 - sin);
    if b.length < SHORT && cos > FRAC_1_SQRT_2 {
        arc.min(acceleration * b.length / cos.acos().max(LEAST_TURN))
    } else {
        arc
    }
}

/// Square of the speed at which no axis's speed jumps by more than its jerk.
/// With `turns`, only the faster of the two speeds counts for an axis that
/// turns round.
fn jerk_limit(jerk: &Jerk, a: [f64; 4], b: [f64; 4], turns: bool) -> f64 {
    let jumps = a.into_iter().zip(b).map(|(from, to)| {
        let round = turns && from * to < 0.0;
        if round {
            from.abs().max(to.abs())
        } else {
            (to - from).abs()
        }
    });
    let limits = jerk.of_axes().to_array().into_iter().zip(jumps);
    let speed = limits
        .map(|(most, jump)| most / jump)
        .fold(f64::INFINITY, f64::min);
    speed * speed
}

/// Sine and cosine of half the angle that two moves enclose: (1, 0) straight
/// on, (0, 1) back. `cos` is the scalar product of their directions.
fn half_angle(cos: f64) -> (f64, f64) {
    let half = |x: f64| (0.5 * x).clamp(0.0, 1.0).sqrt();
    (half(1.0 + cos), half(1.0 - cos))
}
