//! The smooth pieces of the operations that jump.
//!
//! `floor`, `mod`, `atan2` and similar operations are smooth between their
//! jumps. Over a box that a jump crosses, a range has to hold what is on both
//! sides and all that lies between, and tells nothing however small the box
//! gets. So the box is looked at once for each side: with a smooth piece in
//! place of the operation, and the condition under which that piece is the true
//! one. The condition rules out the part of the box on the other side.
//!
//! All angles meet around the pole of `atan2`, and a range tells nothing there,
//! either. There the pieces are sectors, in each of which the angle is known to
//! a sixty-fourth of a turn.

use super::Step;
use super::slot::Slot;
use crate::cell::Cell;
use crate::interval::Interval;
use crate::number::{Number, binary, unary};
use fidget::context::{BinaryOpcode, UnaryOpcode};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Greatest number of periods. Beyond it, f64 cannot tell one period from the
/// next.
const MOST_PERIODS: f64 = 1e15;

/// Number of sectors around the pole of `atan2`. If a part winds k times around
/// its middle on its way round the pole, its turn is known to k/64 in each.
const SECTORS: f64 = 64.0;

/// Number of the first sector among the pieces of `atan2`: the two sides of its
/// jump come before it.
const FIRST_SECTOR: f64 = 2.0;

/// One piece of one step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct StepPiece {
    pub step: u32,
    /// Number of the piece among the step's pieces.
    pub index: f64,
}

/// What must hold for a piece to be the true one: a value within limits.
struct Condition {
    slot: Slot,
    lo: f64,
    hi: f64,
}

/// A piece over a box.
pub(super) struct Over {
    /// What replaces the step. It may also hold beyond the condition.
    pub slot: Slot,
    /// True if the piece is the true one at the centre of the box.
    pub at_centre: bool,
    /// Largest |partial derivative| of what decides where the piece is the true
    /// one; 0 if it is the true one all over the box.
    pub steepness: [f64; 3],
}

/// True if a point's operands lie in a piece.
pub(super) fn holds(step: &Step, index: f64, a: f64, b: f64) -> bool {
    if is_sector(step, index) {
        sector(a.atan2(b)) == index
    } else {
        piece_at(step, a, b) == index
    }
}

/// True if a piece is a sector around the pole of `atan2`.
fn is_sector(step: &Step, index: f64) -> bool {
    matches!(step, Step::Binary(BinaryOpcode::Atan, ..))
        && index >= FIRST_SECTOR
}

/// The sector in which an angle lies.
fn sector(angle: f64) -> f64 {
    let number = ((angle + PI) * (SECTORS / TAU)).floor();
    FIRST_SECTOR + number.clamp(0.0, SECTORS - 1.0)
}

/// Limits between which all angles of a sector lie.
fn angles(sector: f64) -> (f64, f64) {
    /// More than what rounding makes of a limit.
    const ROUNDED_ANGLE: f64 = 1e-15;
    let number = sector - FIRST_SECTOR;
    let angle = |number: f64| number * (TAU / SECTORS) - PI;
    (
        angle(number) - ROUNDED_ANGLE,
        angle(number + 1.0) + ROUNDED_ANGLE,
    )
}

/// The piece in which a point's operands lie, where sectors do not count.
fn piece_at(step: &Step, a: f64, b: f64) -> f64 {
    let side = |v: f64| if v >= 0.0 { 1.0 } else { 0.0 };
    match step {
        Step::Unary(op, _) => match op {
            UnaryOpcode::Floor => a.floor(),
            UnaryOpcode::Ceil => a.ceil(),
            UnaryOpcode::Round => a.round(),
            UnaryOpcode::Tan => ((a + FRAC_PI_2) / PI).floor(),
            _ => side(a),
        },
        Step::Binary(op, ..) => match op {
            BinaryOpcode::Mod => (a / b.abs()).floor(),
            BinaryOpcode::Atan => side(a),
            BinaryOpcode::Compare => binary(*op, a, b),
            _ => side(b),
        },
        _ => 0.0,
    }
}

/// The pieces of a step that a box may meet: two or three. None if the step
/// does not jump there, or jumps too often.
pub(super) fn pieces_of(step: &Step, a: &Slot, b: &Slot) -> Vec<f64> {
    let (first, last) = match step {
        Step::Unary(op, _) => {
            let r = a.range;
            match op {
                UnaryOpcode::Floor
                | UnaryOpcode::Ceil
                | UnaryOpcode::Round
                | UnaryOpcode::Tan => {
                    (piece_at(step, r.lo, 0.0), piece_at(step, r.hi, 0.0))
                }
                UnaryOpcode::Recip if r.lo < 0.0 && r.hi > 0.0 => (0.0, 1.0),
                _ => return Vec::new(),
            }
        }
        Step::Binary(op, ..) => match op {
            BinaryOpcode::Mod if !b.range.contains(0.0) => {
                let periods = a.range.div(b.range.abs());
                (periods.lo.floor(), periods.hi.floor())
            }
            BinaryOpcode::Atan
                if a.range.lo < 0.0
                    && a.range.hi >= 0.0
                    && b.range.hi < 0.0 =>
            {
                (0.0, 1.0)
            }
            BinaryOpcode::Div if b.range.lo < 0.0 && b.range.hi > 0.0 => {
                (0.0, 1.0)
            }
            BinaryOpcode::Compare => {
                let r = a.range.compare(b.range);
                if r.lo == r.hi {
                    return Vec::new();
                }
                // If the two operands are equal on a surface only, the piece
                // between has no thickness.
                return if grows(&a.sub(*b)) {
                    vec![-1.0, 1.0]
                } else {
                    vec![-1.0, 0.0, 1.0]
                };
            }
            _ => return Vec::new(),
        },
        _ => return Vec::new(),
    };
    if last - first == 1.0 && first.abs().max(last.abs()) < MOST_PERIODS {
        vec![first, last]
    } else {
        Vec::new()
    }
}

/// The sectors around the pole of a step that a box may meet. None if the step
/// has no pole there.
pub(super) fn sectors_of(step: &Step, a: &Slot, b: &Slot) -> Vec<f64> {
    let has_pole = matches!(step, Step::Binary(BinaryOpcode::Atan, ..))
        && a.range.contains(0.0)
        && b.range.contains(0.0);
    if !has_pole {
        return Vec::new();
    }
    let all = a.range.atan2(b.range);
    let (first, last) = (sector(all.lo), sector(all.hi));
    let count = (last - first) as usize;
    (0..=count).map(|k| first + k as f64).collect()
}

/// A piece of a step over a box with this centre; `None` if the step has
/// another piece everywhere in the box.
pub(super) fn over(
    step: &Step,
    index: f64,
    a: &Slot,
    b: &Slot,
) -> Option<Over> {
    let condition = condition(step, index, a, b);
    let range = condition.slot.range;
    if range.hi < condition.lo || range.lo > condition.hi {
        return None;
    }
    // A range that only touches the piece from outside touches it on a surface.
    let touches = range.hi == condition.lo || range.lo == condition.hi;
    if touches && grows(&condition.slot) {
        return None;
    }
    let everywhere = range.lo >= condition.lo && range.hi <= condition.hi;
    let steepness = if everywhere {
        [0.0; 3]
    } else {
        condition.slot.slope.map(Interval::magnitude)
    };
    let at_centre = holds(step, index, a.centre, b.centre);
    let mut slot = piece_slot(step, index, a, b);
    // There is no way past a pole.
    let pole = is_sector(step, index)
        || matches!(
            step,
            Step::Unary(UnaryOpcode::Tan | UnaryOpcode::Recip, _)
                | Step::Binary(BinaryOpcode::Div, ..)
        );
    if pole && !at_centre {
        slot.centre = f64::NAN;
    }
    Some(Over {
        slot,
        at_centre,
        steepness,
    })
}

/// Removes from `cell` what fails the condition of a piece, as far as the
/// slopes tell. `cell` is a part of the box `whole`, which the operands are
/// about.
pub(super) fn contract(
    step: &Step,
    index: f64,
    a: &Slot,
    b: &Slot,
    whole: &Cell,
    cell: &mut Cell,
) {
    let Condition { slot, lo, hi } = condition(step, index, a, b);
    keep_above(&slot, lo, whole, cell);
    keep_above(&slot.neg(), -hi, whole, cell);
}

/// Removes from `cell` the places where the value of `slot` is less than
/// `least`.
fn keep_above(slot: &Slot, least: f64, whole: &Cell, cell: &mut Cell) {
    if !slot.is_known() || !least.is_finite() {
        return;
    }
    let centre = whole.centre();
    let reach = |i: usize| slot.slope[i].magnitude() * 0.5 * whole.width(i);
    for (i, &middle) in centre.iter().enumerate() {
        let others: f64 = (0..3).filter(|&j| j != i).map(reach).sum();
        // The difference that a way along this axis must make to the value.
        let rise = least - slot.centre - others;
        let g = slot.slope[i];
        let slack = 1e-13 * (1.0 + middle.abs());
        if g.lo > 0.0 {
            let way = rise / if rise > 0.0 { g.hi } else { g.lo };
            cell.lo[i] = cell.lo[i].max(middle + way - slack);
        } else if g.hi < 0.0 {
            let way = rise / if rise > 0.0 { g.lo } else { g.hi };
            cell.hi[i] = cell.hi[i].min(middle + way + slack);
        }
    }
}

/// True if a value changes along some axis all over the box. Then it has any
/// one value on a surface only.
fn grows(slot: &Slot) -> bool {
    !slot.range.nan && slot.slope.iter().any(|g| g.lo > 0.0 || g.hi < 0.0)
}

fn condition(step: &Step, index: f64, a: &Slot, b: &Slot) -> Condition {
    let side = |slot: Slot, up: bool| {
        if up {
            (slot, 0.0, f64::INFINITY)
        } else {
            (slot, f64::NEG_INFINITY, 0.0)
        }
    };
    let (slot, lo, hi) = match step {
        Step::Unary(op, _) => match op {
            UnaryOpcode::Floor => (*a, index, index + 1.0),
            UnaryOpcode::Ceil => (*a, index - 1.0, index),
            UnaryOpcode::Round => (*a, index - 0.5, index + 0.5),
            UnaryOpcode::Tan => (*a, (index - 0.5) * PI, (index + 0.5) * PI),
            _ => side(*a, index > 0.0),
        },
        Step::Binary(BinaryOpcode::Mod, ..) => {
            (remainder(index, a, b), 0.0, b.range.magnitude())
        }
        Step::Binary(BinaryOpcode::Atan, ..) if is_sector(step, index) => {
            let (lo, hi) = angles(index);
            (angle(index, a, b), lo, hi)
        }
        Step::Binary(BinaryOpcode::Atan, ..) => side(*a, index > 0.0),
        Step::Binary(BinaryOpcode::Compare, ..) => match index {
            0.0 => (a.sub(*b), 0.0, 0.0),
            _ => side(a.sub(*b), index > 0.0),
        },
        _ => side(*b, index > 0.0),
    };
    Condition { slot, lo, hi }
}

/// a - index·|b|: the remainder in that period, continued beyond it.
fn remainder(index: f64, a: &Slot, b: &Slot) -> Slot {
    a.sub(b.abs().mul(Slot::constant(index)))
}

/// The angle of b and a in a sector, continued beyond it where it jumps.
fn angle(sector: f64, a: &Slot, b: &Slot) -> Slot {
    if b.range.hi < 0.0 {
        left_of_pole(sector - FIRST_SECTOR >= 0.5 * SECTORS, a, b)
    } else {
        binary(BinaryOpcode::Atan, *a, *b)
    }
}

/// The angle of b and a left of the pole, ±π + atan(a / b), on one side of its
/// jump.
fn left_of_pole(is_above: bool, a: &Slot, b: &Slot) -> Slot {
    let turn = if is_above { PI } else { -PI };
    a.div(*b).atan().add(Slot::constant(turn))
}

fn piece_slot(step: &Step, index: f64, a: &Slot, b: &Slot) -> Slot {
    let constant = |value: f64, nan: bool| Slot {
        range: Interval::point(value).or_nan(nan),
        centre: value,
        slope: super::slot::FLAT,
    };
    // The part of an operand's range on its side of a pole.
    let beside = |slot: &Slot| {
        let mut slot = *slot;
        if index > 0.0 {
            slot.range.lo = slot.range.lo.max(0.0)
        } else {
            slot.range.hi = slot.range.hi.min(0.0)
        }
        slot
    };
    match step {
        Step::Unary(op, _) => match op {
            UnaryOpcode::Tan => {
                let mut within = *a;
                // f64 knows the poles to their last digits only, so the ends of
                // the range are on the safe side.
                let (lo, hi) = ((index - 0.5) * PI, (index + 0.5) * PI);
                let (low, high) = (a.range.lo <= lo, a.range.hi >= hi);
                within.range.lo = a.range.lo.max(lo + 1e-9);
                within.range.hi = a.range.hi.min(hi - 1e-9);
                let mut out = unary(*op, within);
                if low {
                    out.range.lo = f64::NEG_INFINITY;
                }
                if high {
                    out.range.hi = f64::INFINITY;
                }
                if low || high {
                    out.slope = out.slope.map(|g| {
                        if g == Interval::ZERO {
                            g
                        } else {
                            Interval::REALS
                        }
                    });
                }
                out
            }
            UnaryOpcode::Recip => unary(*op, beside(a)),
            _ => constant(index, a.range.nan),
        },
        Step::Binary(op, ..) => match op {
            BinaryOpcode::Mod => remainder(index, a, b),
            BinaryOpcode::Atan if is_sector(step, index) => {
                let (lo, hi) = angles(index);
                let mut slot = angle(index, a, b);
                slot.range.lo = slot.range.lo.max(lo);
                slot.range.hi = slot.range.hi.min(hi);
                slot
            }
            BinaryOpcode::Atan => left_of_pole(index > 0.0, a, b),
            BinaryOpcode::Div => binary(*op, *a, beside(b)),
            _ => constant(index, a.range.nan || b.range.nan),
        },
        _ => *a,
    }
}
