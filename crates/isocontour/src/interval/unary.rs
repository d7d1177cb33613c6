//! Functions of one interval.

use super::Interval;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

impl Interval {
    /// The range of a function that rises: its values at both ends.
    fn rising(self, f: impl Fn(f64) -> f64) -> Self {
        if self.is_empty() {
            return Self::EMPTY;
        }
        Self::sane(f(self.lo), f(self.hi), self.nan)
    }

    pub(crate) fn neg(self) -> Self {
        if self.is_empty() {
            return Self::EMPTY;
        }
        Self::new(-self.hi, -self.lo).or_nan(self.nan)
    }

    pub(crate) fn abs(self) -> Self {
        if self.is_empty() || self.lo >= 0.0 {
            self
        } else if self.hi <= 0.0 {
            self.neg()
        } else {
            Self::new(0.0, self.magnitude()).or_nan(self.nan)
        }
    }

    pub(crate) fn square(self) -> Self {
        let a = self.abs();
        a.rising(|v| v * v)
    }

    pub(crate) fn recip(self) -> Self {
        if self.is_empty() {
            return Self::EMPTY;
        }
        let (lo, hi) = (self.lo, self.hi);
        if lo > 0.0 || hi < 0.0 {
            Self::sane(1.0 / hi, 1.0 / lo, self.nan)
        } else if lo == 0.0 && hi > 0.0 {
            // 1/-0 is -inf, but no surface is where a value is infinite.
            Self::sane(1.0 / hi, f64::INFINITY, self.nan)
        } else if hi == 0.0 && lo < 0.0 {
            Self::sane(f64::NEG_INFINITY, 1.0 / lo, self.nan)
        } else {
            Self::REALS.or_nan(self.nan)
        }
    }

    /// The range of a function that rises from 0 on, and is NaN below 0.
    fn rising_from_zero(self, f: impl Fn(f64) -> f64) -> Self {
        if self.hi < 0.0 || self.is_empty() {
            return Self::EMPTY;
        }
        let nan = self.nan || self.lo < 0.0;
        Self::sane(f(self.lo.max(0.0)), f(self.hi), nan)
    }

    pub(crate) fn sqrt(self) -> Self {
        self.rising_from_zero(f64::sqrt)
    }

    pub(crate) fn ln(self) -> Self {
        self.rising_from_zero(f64::ln)
    }

    pub(crate) fn exp(self) -> Self {
        self.rising(f64::exp)
    }

    pub(crate) fn atan(self) -> Self {
        self.rising(f64::atan)
    }

    pub(crate) fn floor(self) -> Self {
        self.rising(f64::floor)
    }

    pub(crate) fn ceil(self) -> Self {
        self.rising(f64::ceil)
    }

    pub(crate) fn round(self) -> Self {
        self.rising(f64::round)
    }

    /// The part of the interval within [-1, 1], for asin and acos.
    fn unit_domain(self) -> Self {
        if self.is_empty() || self.lo > 1.0 || self.hi < -1.0 {
            return Self::EMPTY;
        }
        let nan = self.nan || self.lo < -1.0 || self.hi > 1.0;
        Self::new(self.lo.max(-1.0), self.hi.min(1.0)).or_nan(nan)
    }

    pub(crate) fn asin(self) -> Self {
        self.unit_domain().rising(f64::asin)
    }

    pub(crate) fn acos(self) -> Self {
        // acos falls, so the argument is negated: pi - acos(-v) = acos(v).
        let d = self.unit_domain();
        if d.is_empty() {
            return d;
        }
        Self::sane(d.hi.acos(), d.lo.acos(), d.nan)
    }

    pub(crate) fn sin(self) -> Self {
        if self.is_empty() {
            return Self::EMPTY;
        }
        // The sine of an infinity is NaN.
        let nan = self.nan || !self.is_finite();
        // The condition is negated so that a width that is infinite or NaN is a
        // full turn as well.
        let within_a_turn = self.hi - self.lo < TAU;
        if !within_a_turn {
            return Self::new(-1.0, 1.0).or_nan(nan);
        }
        let (a, b) = (self.lo.sin(), self.hi.sin());
        // True if `peak` + k·TAU is inside for some whole k.
        let reaches = |peak: f64| {
            let k = ((self.lo - peak) / TAU).ceil();
            peak + k * TAU <= self.hi
        };
        let hi = if reaches(FRAC_PI_2) { 1.0 } else { a.max(b) };
        let lo = if reaches(-FRAC_PI_2) { -1.0 } else { a.min(b) };
        Self::sane(lo, hi, nan)
    }

    pub(crate) fn cos(self) -> Self {
        self.add(Self::point(FRAC_PI_2)).sin()
    }

    pub(crate) fn tan(self) -> Self {
        if self.is_empty() {
            return Self::EMPTY;
        }
        let branch = |v: f64| ((v + FRAC_PI_2) / PI).floor();
        if self.is_finite() && branch(self.lo) == branch(self.hi) {
            let (a, b) = (self.lo.tan(), self.hi.tan());
            if a <= b {
                return Self::sane(a, b, self.nan);
            }
        }
        Self::REALS.or_nan(self.nan || !self.is_finite())
    }

    pub(crate) fn not(self) -> Self {
        if self.is_empty() || self.nan {
            // fidget's `not` of NaN is 0.
            return Self::new(0.0, 1.0);
        }
        if !self.contains(0.0) {
            Self::ZERO
        } else if self.lo == 0.0 && self.hi == 0.0 {
            Self::point(1.0)
        } else {
            Self::new(0.0, 1.0)
        }
    }
}
