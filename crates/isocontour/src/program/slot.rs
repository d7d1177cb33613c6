//! What is known of one operation over a box, and what the box adds to it.
//!
//! The centred form cuts down the range made from the operands' ranges. A blend
//! of the two surfaces that meet cuts down the range of a `max` or `min`.

use crate::interval::Interval;
use crate::number::Number;
use crate::number::dual::Dual;
use fidget::context::BinaryOpcode;

/// No slope: the step does not change within the box.
pub(super) const FLAT: [Interval; 3] = [Interval::ZERO; 3];

/// What is known of one step over a box.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slot {
    pub range: Interval,
    /// Value at the centre of the box, perhaps NaN.
    pub centre: f64,
    /// Range of the partial derivatives; any number where unknown.
    pub slope: [Interval; 3],
}

impl Slot {
    /// A slot that does not change within the box.
    pub(super) fn constant(value: f64) -> Slot {
        Slot {
            range: Interval::point(value),
            centre: value,
            slope: FLAT,
        }
    }

    /// True if the value, its range and its slopes are known.
    pub(super) fn is_known(&self) -> bool {
        !self.range.nan
            && self.centre.is_finite()
            && self.slope.iter().all(|g| g.is_finite() && !g.nan)
    }

    fn dual(self) -> Dual<Interval, 3> {
        Dual {
            v: self.range,
            d: self.slope,
        }
    }

    fn of(dual: Dual<Interval, 3>, centre: f64) -> Slot {
        Slot {
            range: dual.v,
            centre,
            slope: dual.d,
        }
    }
}

// The trait's methods are called by name, since `min` and `max` of f64 itself
// lose NaN.
macro_rules! both {
    ($($name:ident)*) => {
        $(fn $name(self) -> Self {
            Slot::of(self.dual().$name(), Number::$name(self.centre))
        })*
    };
    ($($name:ident($o:ident))*) => {
        $(fn $name(self, $o: Self) -> Self {
            let dual = self.dual().$name($o.dual());
            Slot::of(dual, Number::$name(self.centre, $o.centre))
        })*
    };
}

impl Number for Slot {
    both!(neg abs recip sqrt square floor ceil round sin cos tan asin acos atan
        exp ln not rand);
    both!(add(o) sub(o) mul(o) div(o) atan2(o) modulo(o) compare(o) mix(o)
        min(o) max(o) and(o) or(o));

    fn splat(v: f32) -> Self {
        Slot::constant(v.into())
    }
    fn scale(self, by: f32) -> Self {
        Slot::of(self.dual().scale(by), self.centre.scale(by))
    }
}

/// The slot with its range cut down by the centred form.
pub(super) fn tightened(mut slot: Slot, half: [f64; 3]) -> Slot {
    // The mean value theorem does not hold across a hole in the domain (NaN).
    if !slot.is_known() {
        return slot;
    }
    let mut reach = 0.0;
    for (slope, half) in slot.slope.iter().zip(half) {
        reach += slope.magnitude() * half;
    }
    let lo = slot.range.lo.max(slot.centre - reach);
    let hi = slot.range.hi.min(slot.centre + reach);
    // The two ranges miss each other only by rounding.
    if lo <= hi {
        slot.range.lo = lo;
        slot.range.hi = hi;
    }
    slot
}

/// The slot of a `max` (or `min`) of two crossing surfaces with its lower
/// (upper) end cut by a blend of the two.
///
/// max(a, b) ≥ t·a + (1 - t)·b for every t in [0, 1]. Along an edge the two
/// slopes partly cancel for some t: the ridge of a roof is bounded by its
/// height, although neither slope of the roof is. Without this an oblique
/// edge of length L takes L / tolerance boxes.
pub(super) fn mixed(
    op: BinaryOpcode,
    mut slot: Slot,
    a: &Slot,
    b: &Slot,
    half: [f64; 3],
) -> Slot {
    let sign = match op {
        BinaryOpcode::Max => 1.0,
        // min(a, b) = -max(-a, -b)
        BinaryOpcode::Min => -1.0,
        _ => return slot,
    };
    let decided = a.range.hi <= b.range.lo || b.range.hi <= a.range.lo;
    if decided || !a.is_known() || !b.is_known() {
        return slot;
    }
    let middle = |g: Interval| 0.5 * (g.lo + g.hi);
    for i in 0..3 {
        let (ga, gb) = (middle(a.slope[i]), middle(b.slope[i]));
        // The share of `a` at which the slopes along this axis cancel.
        let t = gb / (gb - ga);
        if !(t > 0.0 && t < 1.0) {
            continue;
        }
        let mut reach = 0.0;
        for (j, half) in half.iter().enumerate() {
            let (ga, gb) = (a.slope[j], b.slope[j]);
            let lo = t * ga.lo + (1.0 - t) * gb.lo;
            let hi = t * ga.hi + (1.0 - t) * gb.hi;
            reach += lo.abs().max(hi.abs()) * half;
        }
        let centre = t * a.centre + (1.0 - t) * b.centre;
        let end = centre - sign * reach;
        if sign > 0.0 && end > slot.range.lo {
            slot.range.lo = end.min(slot.range.hi);
        } else if sign < 0.0 && end < slot.range.hi {
            slot.range.hi = end.max(slot.range.lo);
        }
    }
    slot
}
