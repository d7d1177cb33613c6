//! Functions of two intervals.

use super::Interval;
use std::f64::consts::PI;

impl Interval {
    #[inline]
    pub(crate) fn add(self, o: Self) -> Self {
        let (lo, hi) = (self.lo + o.lo, self.hi + o.hi);
        // This is nearly always so. Then no end is infinite, and no operand is
        // empty.
        if lo.is_finite() && hi.is_finite() {
            let nan = self.nan || o.nan;
            return Self { lo, hi, nan };
        }
        self.add_infinite(o)
    }

    /// A sum with an infinite end.
    fn add_infinite(self, o: Self) -> Self {
        if self.is_empty() || o.is_empty() {
            return Self::EMPTY;
        }
        // inf - inf
        let (low, high) = (f64::NEG_INFINITY, f64::INFINITY);
        let undefined = (self.lo == low && o.hi == high)
            || (self.hi == high && o.lo == low);
        Self::sane(
            self.lo + o.lo,
            self.hi + o.hi,
            self.nan || o.nan || undefined,
        )
    }

    pub(crate) fn sub(self, o: Self) -> Self {
        self.add(o.neg())
    }

    /// A function of each end of one interval and each of the other.
    #[inline(always)]
    fn of_ends(self, o: Self, f: impl Fn(f64, f64) -> f64) -> [f64; 4] {
        [
            f(self.lo, o.lo),
            f(self.lo, o.hi),
            f(self.hi, o.lo),
            f(self.hi, o.hi),
        ]
    }

    /// The range of four finite numbers, which are products or quotients of
    /// ends; none if one is not finite.
    #[inline]
    fn of_four(p: [f64; 4], nan: bool) -> Option<Self> {
        let least = |a: f64, b: f64| if a < b { a } else { b };
        let most = |a: f64, b: f64| if a > b { a } else { b };
        // This avoids a negative zero.
        ((p[0] + p[1]) + (p[2] + p[3])).is_finite().then(|| Self {
            lo: least(least(p[0], p[1]), least(p[2], p[3])) + 0.0,
            hi: most(most(p[0], p[1]), most(p[2], p[3])) + 0.0,
            nan,
        })
    }

    /// The range of four numbers, which arithmetic may have made NaN.
    fn around(p: [f64; 4], nan: bool) -> Self {
        Self::sane(
            p[0].min(p[1]).min(p[2].min(p[3])),
            p[0].max(p[1]).max(p[2].max(p[3])),
            nan,
        )
    }

    #[inline]
    pub(crate) fn mul(self, o: Self) -> Self {
        let p = self.of_ends(o, |a, b| a * b);
        // This is nearly always so. Then no end is infinite, and no operand is
        // empty.
        Self::of_four(p, self.nan || o.nan)
            .unwrap_or_else(|| self.mul_infinite(o))
    }

    /// A product with an infinite end.
    fn mul_infinite(self, o: Self) -> Self {
        if self.is_empty() || o.is_empty() {
            return Self::EMPTY;
        }
        // 0 · inf at an end comes from an end that is only an estimate.
        let product = |a: f64, b: f64| {
            if a == 0.0 || b == 0.0 { 0.0 } else { a * b }
        };
        let nan = self.nan
            || o.nan
            || (!self.is_finite() && o.contains(0.0))
            || (!o.is_finite() && self.contains(0.0));
        Self::around(self.of_ends(o, product), nan)
    }

    pub(crate) fn div(self, o: Self) -> Self {
        if self.is_empty() || o.is_empty() {
            return Self::EMPTY;
        }
        let undefined = self.contains(0.0) && o.contains(0.0)
            || !self.is_finite() && !o.is_finite();
        let q = if o.lo > 0.0 || o.hi < 0.0 {
            // The quotient is computed directly, not by the reciprocal, so that
            // exact ends stay exact.
            let q = self.of_ends(o, |a, b| a / b);
            let nan = self.nan || o.nan;
            Self::of_four(q, nan).unwrap_or_else(|| Self::around(q, nan))
        } else {
            self.mul(o.recip())
        };
        q.or_nan(undefined)
    }

    /// The range of the lesser or greater of two numbers.
    fn either(self, o: Self, pick: impl Fn(f64, f64) -> f64) -> Self {
        if self.is_empty() || o.is_empty() {
            return Self::EMPTY;
        }
        Self::new(pick(self.lo, o.lo), pick(self.hi, o.hi))
            .or_nan(self.nan || o.nan)
    }

    pub(crate) fn min(self, o: Self) -> Self {
        self.either(o, f64::min)
    }

    pub(crate) fn max(self, o: Self) -> Self {
        self.either(o, f64::max)
    }

    /// Angle of (x = `x`, y = `self`).
    pub(crate) fn atan2(self, x: Self) -> Self {
        if self.is_empty() || x.is_empty() {
            return Self::EMPTY;
        }
        let nan = self.nan || x.nan;
        // The angle jumps across the negative x axis.
        if self.contains(0.0) && x.lo < 0.0 {
            return Self::new(-PI, PI).or_nan(nan);
        }
        Self::around(self.of_ends(x, f64::atan2), nan)
    }

    /// Euclidean remainder, as fidget's `modulo`.
    pub(crate) fn modulo(self, o: Self) -> Self {
        if self.is_empty() || o.is_empty() {
            return Self::EMPTY;
        }
        let nan = self.nan || o.nan || o.contains(0.0) || !self.is_finite();
        if self.same_period(o) {
            return Self::sane(
                self.lo.rem_euclid(o.lo),
                self.hi.rem_euclid(o.lo),
                nan,
            );
        }
        Self::sane(0.0, o.magnitude(), nan)
    }

    /// True if all of `self` lies in one period of the constant `o`, so that
    /// the remainder is continuous.
    pub(crate) fn same_period(self, o: Self) -> bool {
        o.lo == o.hi
            && o.lo != 0.0
            && o.is_finite()
            && self.is_finite()
            // Beyond this, f64 cannot tell one period from the next.
            && self.magnitude() < 1e15 * o.lo.abs()
            && (self.lo / o.lo.abs()).floor() == (self.hi / o.lo.abs()).floor()
    }

    /// -1, 0 or 1, as in [`Number::compare`](crate::number::Number::compare).
    pub(crate) fn compare(self, o: Self) -> Self {
        if self.is_empty() || o.is_empty() {
            return Self::EMPTY;
        }
        let nan = self.nan || o.nan;
        if self.hi < o.lo {
            Self::point(-1.0).or_nan(nan)
        } else if self.lo > o.hi {
            Self::point(1.0).or_nan(nan)
        } else {
            Self::new(-1.0, 1.0).or_nan(nan)
        }
    }

    /// `a` where `a` is 0, else `b`.
    pub(crate) fn and(self, o: Self) -> Self {
        let nan = self.nan || o.nan;
        if self.is_empty() || (o.is_empty() && !self.contains(0.0)) {
            Self::ANYTHING
        } else if self.lo == 0.0 && self.hi == 0.0 {
            Self::ZERO.or_nan(nan)
        } else if !self.contains(0.0) {
            o.or_nan(nan)
        } else {
            o.hull(Self::ZERO).or_nan(nan)
        }
    }

    /// `a` where `a` is not 0, else `b`.
    pub(crate) fn or(self, o: Self) -> Self {
        let nan = self.nan || o.nan;
        if self.is_empty() {
            Self::ANYTHING
        } else if !self.contains(0.0) {
            self.or_nan(nan)
        } else if self.lo == 0.0 && self.hi == 0.0 {
            o.or_nan(nan)
        } else {
            self.hull(o).or_nan(nan)
        }
    }
}
