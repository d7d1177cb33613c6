//! Intervals, and their derivatives.

use super::{Component, Number};
use crate::interval::Interval;

macro_rules! own {
    ($($name:ident)*) => {
        $(#[inline]
        fn $name(self) -> Self {
            Interval::$name(self)
        })*
    };
    ($($name:ident($o:ident))*) => {
        $(#[inline]
        fn $name(self, $o: Self) -> Self {
            Interval::$name(self, $o)
        })*
    };
}

/// The one value that a range holds.
fn only(range: Interval) -> Option<f64> {
    (range.lo == range.hi && !range.nan).then_some(range.lo)
}

impl Number for Interval {
    own!(neg abs recip sqrt square floor ceil round sin cos tan asin acos atan
        exp ln not);
    own!(add(o) sub(o) mul(o) div(o) atan2(o) modulo(o) compare(o) min(o)
        max(o) and(o) or(o));

    fn splat(v: f32) -> Self {
        Interval::point(v.into())
    }
    fn rand(self) -> Self {
        match only(self) {
            Some(v) => Interval::point(v.rand()),
            None => Interval::new(0.0, 1.0),
        }
    }
    fn scale(self, by: f32) -> Self {
        self.mul(Interval::point(by.into()))
    }
    fn mix(self, o: Self) -> Self {
        match (only(self), only(o)) {
            (Some(a), Some(b)) => Interval::point(a.mix(b)),
            _ => Interval::ANYTHING,
        }
    }
}

/// True if nothing changes along the axis of the derivative.
fn is_flat(d: Interval) -> bool {
    d == Interval::ZERO
}

impl Component for Interval {
    #[inline]
    fn along(self, by: Self) -> Self {
        // Otherwise 0 · ∞ would be any number.
        if is_flat(self) { self } else { self.mul(by) }
    }
    #[inline]
    fn choose(a: Self, b: Self, x: Self, y: Self) -> Self {
        if a.nan || b.nan {
            x.hull(y)
        } else if a.hi <= b.lo {
            x
        } else if b.hi <= a.lo {
            y
        } else {
            x.hull(y)
        }
    }
    fn choose_zero(a: Self, x: Self, y: Self) -> Self {
        match only(a) {
            Some(0.0) => x,
            _ if a.nan || a.contains(0.0) => Interval::ANYTHING,
            _ => y,
        }
    }
    fn step(self, a: Self, b: Self) -> Self {
        if only(self).is_some() || is_flat(a) && is_flat(b) {
            Interval::ZERO
        } else {
            Interval::ANYTHING
        }
    }
    fn leap(self, x: Self, along: Self) -> Self {
        // The angle jumps across the negative x axis, on which `self` is zero.
        if self.contains(0.0) && x.lo <= 0.0 && !is_flat(along) {
            Interval::ANYTHING
        } else {
            Interval::ZERO
        }
    }
    fn wrap(self, o: Self, a: Self, b: Self) -> Self {
        if self.same_period(o) || is_flat(a) && is_flat(b) {
            a
        } else {
            Interval::ANYTHING
        }
    }
}
