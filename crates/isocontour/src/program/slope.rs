//! Ranges and slopes of single operations, by the rules of calculus.

use super::slot::Slot;
use super::value::{binary_value, unary_value};
use crate::interval::Interval;
use fidget::context::{BinaryOpcode, UnaryOpcode};

fn scaled(slope: &[Interval; 3], by: Interval) -> [Interval; 3] {
    slope.map(|s| {
        // A constant stays one, however steep the outer function.
        if s == Interval::ZERO { s } else { s.mul(by) }
    })
}

fn sum(a: [Interval; 3], b: [Interval; 3]) -> [Interval; 3] {
    std::array::from_fn(|i| a[i].add(b[i]))
}

fn hull(a: &[Interval; 3], b: &[Interval; 3]) -> [Interval; 3] {
    std::array::from_fn(|i| a[i].hull(b[i]))
}

/// The slope of a step that jumps: unknown along every axis on which its
/// operands change.
fn jumping(slopes: &[&[Interval; 3]]) -> [Interval; 3] {
    std::array::from_fn(|i| {
        match slopes.iter().all(|s| s[i] == Interval::ZERO) {
            true => Interval::ZERO,
            false => Interval::REALS,
        }
    })
}

/// The value of a function that no rule describes, if its operands (twice
/// the same one, if it has one) are numbers.
fn known(value: f64, operands: [Interval; 2]) -> Option<Interval> {
    operands
        .iter()
        .all(|r| r.lo == r.hi && !r.nan)
        .then_some(Interval::point(value))
}

/// A function of one operand.
pub(super) fn unary(op: UnaryOpcode, a: &Slot) -> Slot {
    let r = a.range;
    let g = &a.slope;
    let (range, slope) = match op {
        UnaryOpcode::Neg => (r.neg(), g.map(Interval::neg)),
        UnaryOpcode::Abs => {
            let sign = if r.lo >= 0.0 {
                Interval::point(1.0)
            } else if r.hi <= 0.0 {
                Interval::point(-1.0)
            } else {
                Interval::new(-1.0, 1.0)
            };
            (r.abs(), scaled(g, sign))
        }
        UnaryOpcode::Recip => {
            let out = r.recip();
            (out, scaled(g, out.square().neg()))
        }
        UnaryOpcode::Sqrt => {
            let out = r.sqrt();
            let half_recip = Interval::point(0.5).div(out);
            (out, scaled(g, half_recip))
        }
        UnaryOpcode::Square => {
            (r.square(), scaled(g, r.mul(Interval::point(2.0))))
        }
        UnaryOpcode::Floor => (r.floor(), jumping(&[g])),
        UnaryOpcode::Ceil => (r.ceil(), jumping(&[g])),
        UnaryOpcode::Round => (r.round(), jumping(&[g])),
        UnaryOpcode::Sin => (r.sin(), scaled(g, r.cos())),
        UnaryOpcode::Cos => (r.cos(), scaled(g, r.sin().neg())),
        UnaryOpcode::Tan => {
            let out = r.tan();
            (out, scaled(g, out.square().add(Interval::point(1.0))))
        }
        UnaryOpcode::Asin | UnaryOpcode::Acos => {
            let run = Interval::point(1.0).sub(r.square()).sqrt();
            let rise = Interval::point(1.0).div(run);
            if op == UnaryOpcode::Asin {
                (r.asin(), scaled(g, rise))
            } else {
                (r.acos(), scaled(g, rise.neg()))
            }
        }
        UnaryOpcode::Atan => {
            let run = Interval::point(1.0).add(r.square());
            (r.atan(), scaled(g, Interval::point(1.0).div(run)))
        }
        UnaryOpcode::Exp => {
            let out = r.exp();
            (out, scaled(g, out))
        }
        UnaryOpcode::Ln => (r.ln(), scaled(g, Interval::point(1.0).div(r))),
        UnaryOpcode::Not => (r.not(), jumping(&[g])),
        UnaryOpcode::Rand => (
            known(unary_value(op, r.lo), [r, r])
                .unwrap_or(Interval::new(0.0, 1.0)),
            jumping(&[g]),
        ),
    };
    Slot {
        range,
        centre: unary_value(op, a.centre),
        slope,
    }
}

/// A function of two operands.
pub(super) fn binary(op: BinaryOpcode, a: &Slot, b: &Slot) -> Slot {
    let (ra, rb) = (a.range, b.range);
    let (ga, gb) = (&a.slope, &b.slope);
    let (range, slope) = match op {
        BinaryOpcode::Add => (ra.add(rb), sum(*ga, *gb)),
        BinaryOpcode::Sub => (ra.sub(rb), sum(*ga, gb.map(Interval::neg))),
        BinaryOpcode::Mul => (ra.mul(rb), sum(scaled(ga, rb), scaled(gb, ra))),
        BinaryOpcode::Div => {
            let out = ra.div(rb);
            let over = Interval::point(1.0).div(rb);
            // (a/b)' = (a' - (a/b)·b')/b
            let rest = scaled(gb, out.neg());
            (out, scaled(&sum(*ga, rest), over))
        }
        BinaryOpcode::Min | BinaryOpcode::Max => {
            let (below, above) = (ra.hi < rb.lo, rb.hi < ra.lo);
            let (range, left, right) = if op == BinaryOpcode::Min {
                (ra.min(rb), below, above)
            } else {
                (ra.max(rb), above, below)
            };
            let slope = if left {
                *ga
            } else if right {
                *gb
            } else {
                hull(ga, gb)
            };
            (range, slope)
        }
        BinaryOpcode::Atan => {
            let squared = ra.square().add(rb.square());
            let over = Interval::point(1.0).div(squared);
            let turn = sum(scaled(ga, rb), scaled(gb, ra.neg()));
            let mut slope = scaled(&turn, over);
            if ra.contains(0.0) && rb.lo < 0.0 {
                // The angle jumps where its first operand changes sign, and
                // nowhere along an axis on which that stays the same.
                for (out, jump) in slope.iter_mut().zip(jumping(&[ga])) {
                    if jump != Interval::ZERO {
                        *out = jump;
                    }
                }
            }
            (ra.atan2(rb), slope)
        }
        BinaryOpcode::Mod => {
            let slope = if ra.same_period(rb) {
                *ga
            } else {
                jumping(&[ga, gb])
            };
            (ra.modulo(rb), slope)
        }
        BinaryOpcode::Compare => (ra.compare(rb), jumping(&[ga, gb])),
        BinaryOpcode::And => (ra.and(rb), jumping(&[ga, gb])),
        BinaryOpcode::Or => (ra.or(rb), jumping(&[ga, gb])),
        BinaryOpcode::Mix => (
            known(binary_value(op, ra.lo, rb.lo), [ra, rb])
                .unwrap_or(Interval::ANYTHING),
            jumping(&[ga, gb]),
        ),
    };
    Slot {
        range,
        centre: binary_value(op, a.centre, b.centre),
        slope,
    }
}
