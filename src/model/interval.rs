//! Interval arithmetic in f64, for the search for bounds and for proofs.
//!
//! In: boxes of values. Out: an interval that holds every number the
//! operation can return, and whether it can return NaN.
//!
//! Guarantees: no operation panics, whatever its operands (fidget's own
//! intervals do, and abort the process from compiled code, when one end
//! becomes NaN); NaN is a flag beside the numbers, so `sqrt(x)` over
//! [-1, 4] is "[0, 2] or NaN" and not "anything".
//!
//! Not guaranteed: outward rounding. The ends are rounded to nearest, so a
//! bound may be wrong by a few parts in 10^16, ten orders of magnitude below
//! the tolerance of the search.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// A closed range of numbers, and whether NaN is possible beside them.
///
/// `lo > hi` (`EMPTY`) means that no number is possible.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Interval {
    pub lo: f64,
    pub hi: f64,
    pub nan: bool,
}

impl Interval {
    /// Every number, and NaN: nothing is known.
    pub const ANYTHING: Self = Self {
        lo: f64::NEG_INFINITY,
        hi: f64::INFINITY,
        nan: true,
    };

    /// No number: certainly NaN.
    pub const EMPTY: Self = Self {
        lo: f64::INFINITY,
        hi: f64::NEG_INFINITY,
        nan: true,
    };

    /// Every number, but never NaN.
    pub const REALS: Self = Self {
        lo: f64::NEG_INFINITY,
        hi: f64::INFINITY,
        nan: false,
    };

    pub const ZERO: Self = Self {
        lo: 0.0,
        hi: 0.0,
        nan: false,
    };

    pub fn point(v: f64) -> Self {
        if v.is_nan() {
            return Self::EMPTY;
        }
        Self {
            lo: v,
            hi: v,
            nan: false,
        }
    }

    pub fn new(lo: f64, hi: f64) -> Self {
        Self { lo, hi, nan: false }
    }

    /// The interval with ends that arithmetic may have made NaN.
    fn sane(lo: f64, hi: f64, nan: bool) -> Self {
        let lost = lo.is_nan() || hi.is_nan();
        Self {
            lo: if lo.is_nan() { f64::NEG_INFINITY } else { lo },
            hi: if hi.is_nan() { f64::INFINITY } else { hi },
            nan: nan || lost,
        }
    }

    pub fn is_empty(self) -> bool {
        self.lo > self.hi
    }

    pub fn is_finite(self) -> bool {
        self.lo.is_finite() && self.hi.is_finite()
    }

    pub fn contains(self, v: f64) -> bool {
        self.lo <= v && v <= self.hi
    }

    /// Largest absolute value.
    pub fn magnitude(self) -> f64 {
        self.lo.abs().max(self.hi.abs())
    }

    pub fn hull(self, other: Self) -> Self {
        Self {
            lo: self.lo.min(other.lo),
            hi: self.hi.max(other.hi),
            nan: self.nan || other.nan,
        }
    }

    pub fn or_nan(self, nan: bool) -> Self {
        Self {
            nan: self.nan || nan,
            ..self
        }
    }

    /// A monotone rising function applied to both ends.
    fn rising(self, f: impl Fn(f64) -> f64) -> Self {
        if self.is_empty() {
            return Self::EMPTY;
        }
        Self::sane(f(self.lo), f(self.hi), self.nan)
    }

    pub fn neg(self) -> Self {
        if self.is_empty() {
            return Self::EMPTY;
        }
        Self {
            lo: -self.hi,
            hi: -self.lo,
            nan: self.nan,
        }
    }

    pub fn abs(self) -> Self {
        if self.is_empty() || self.lo >= 0.0 {
            self
        } else if self.hi <= 0.0 {
            self.neg()
        } else {
            Self {
                lo: 0.0,
                hi: self.magnitude(),
                nan: self.nan,
            }
        }
    }

    pub fn square(self) -> Self {
        let a = self.abs();
        a.rising(|v| v * v)
    }

    pub fn recip(self) -> Self {
        if self.is_empty() {
            return Self::EMPTY;
        }
        let (lo, hi) = (self.lo, self.hi);
        if lo > 0.0 || hi < 0.0 {
            Self::sane(1.0 / hi, 1.0 / lo, self.nan)
        } else if lo == 0.0 && hi > 0.0 {
            // 1/-0 is -inf, but an infinite value is never a surface.
            Self::sane(1.0 / hi, f64::INFINITY, self.nan)
        } else if hi == 0.0 && lo < 0.0 {
            Self::sane(f64::NEG_INFINITY, 1.0 / lo, self.nan)
        } else {
            Self::REALS.or_nan(self.nan)
        }
    }

    pub fn sqrt(self) -> Self {
        if self.hi < 0.0 || self.is_empty() {
            return Self::EMPTY;
        }
        Self::sane(
            self.lo.max(0.0).sqrt(),
            self.hi.sqrt(),
            self.nan || self.lo < 0.0,
        )
    }

    pub fn ln(self) -> Self {
        if self.hi < 0.0 || self.is_empty() {
            return Self::EMPTY;
        }
        Self::sane(
            self.lo.max(0.0).ln(),
            self.hi.ln(),
            self.nan || self.lo < 0.0,
        )
    }

    pub fn exp(self) -> Self {
        self.rising(f64::exp)
    }

    pub fn atan(self) -> Self {
        self.rising(f64::atan)
    }

    pub fn floor(self) -> Self {
        self.rising(f64::floor)
    }

    pub fn ceil(self) -> Self {
        self.rising(f64::ceil)
    }

    pub fn round(self) -> Self {
        self.rising(f64::round)
    }

    /// The part of the interval within [-1, 1], for asin and acos.
    fn unit_domain(self) -> Self {
        if self.is_empty() || self.lo > 1.0 || self.hi < -1.0 {
            return Self::EMPTY;
        }
        Self {
            lo: self.lo.max(-1.0),
            hi: self.hi.min(1.0),
            nan: self.nan || self.lo < -1.0 || self.hi > 1.0,
        }
    }

    pub fn asin(self) -> Self {
        self.unit_domain().rising(f64::asin)
    }

    pub fn acos(self) -> Self {
        // acos falls: negate the argument, and pi - acos(-v) = acos(v).
        let d = self.unit_domain();
        if d.is_empty() {
            return d;
        }
        Self::sane(d.hi.acos(), d.lo.acos(), d.nan)
    }

    pub fn sin(self) -> Self {
        if self.is_empty() {
            return Self::EMPTY;
        }
        // The sine of an infinity is NaN.
        let nan = self.nan || !self.is_finite();
        // Negated so that an infinite or NaN width is a full turn as well.
        let within_a_turn = self.hi - self.lo < TAU;
        if !within_a_turn {
            return Self::new(-1.0, 1.0).or_nan(nan);
        }
        let (a, b) = (self.lo.sin(), self.hi.sin());
        // Is there a k with `peak` + k·TAU inside?
        let reaches = |peak: f64| {
            let k = ((self.lo - peak) / TAU).ceil();
            peak + k * TAU <= self.hi
        };
        let hi = if reaches(FRAC_PI_2) { 1.0 } else { a.max(b) };
        let lo = if reaches(-FRAC_PI_2) { -1.0 } else { a.min(b) };
        Self::sane(lo, hi, nan)
    }

    pub fn cos(self) -> Self {
        self.add(Self::point(FRAC_PI_2)).sin()
    }

    pub fn tan(self) -> Self {
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

    pub fn not(self) -> Self {
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

    #[inline]
    pub fn add(self, o: Self) -> Self {
        let (lo, hi) = (self.lo + o.lo, self.hi + o.hi);
        // Nearly always: then no end is infinite, and neither is empty.
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

    pub fn sub(self, o: Self) -> Self {
        self.add(o.neg())
    }

    /// The range of four finite numbers, be they products or quotients of
    /// ends; nothing if one is not finite.
    #[inline]
    fn of_four(p: [f64; 4], nan: bool) -> Option<Self> {
        let least = |a: f64, b: f64| if a < b { a } else { b };
        let most = |a: f64, b: f64| if a > b { a } else { b };
        // No negative zero.
        ((p[0] + p[1]) + (p[2] + p[3])).is_finite().then(|| Self {
            lo: least(least(p[0], p[1]), least(p[2], p[3])) + 0.0,
            hi: most(most(p[0], p[1]), most(p[2], p[3])) + 0.0,
            nan,
        })
    }

    #[inline]
    pub fn mul(self, o: Self) -> Self {
        let p = [
            self.lo * o.lo,
            self.lo * o.hi,
            self.hi * o.lo,
            self.hi * o.hi,
        ];
        // Nearly always: then no end is infinite, and neither is empty.
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
        let p = [
            product(self.lo, o.lo),
            product(self.lo, o.hi),
            product(self.hi, o.lo),
            product(self.hi, o.hi),
        ];
        let nan = self.nan
            || o.nan
            || (!self.is_finite() && o.contains(0.0))
            || (!o.is_finite() && self.contains(0.0));
        Self::sane(
            p[0].min(p[1]).min(p[2].min(p[3])),
            p[0].max(p[1]).max(p[2].max(p[3])),
            nan,
        )
    }

    pub fn div(self, o: Self) -> Self {
        if self.is_empty() || o.is_empty() {
            return Self::EMPTY;
        }
        let undefined = self.contains(0.0) && o.contains(0.0)
            || !self.is_finite() && !o.is_finite();
        let q = if o.lo > 0.0 || o.hi < 0.0 {
            // Direct, not by the reciprocal: exact ends stay exact.
            let q = [
                self.lo / o.lo,
                self.lo / o.hi,
                self.hi / o.lo,
                self.hi / o.hi,
            ];
            let nan = self.nan || o.nan;
            if let Some(q) = Self::of_four(q, nan) {
                return q;
            }
            Self::sane(
                q[0].min(q[1]).min(q[2].min(q[3])),
                q[0].max(q[1]).max(q[2].max(q[3])),
                nan,
            )
        } else {
            self.mul(o.recip())
        };
        q.or_nan(undefined)
    }

    pub fn min(self, o: Self) -> Self {
        if self.is_empty() || o.is_empty() {
            return Self::EMPTY;
        }
        Self {
            lo: self.lo.min(o.lo),
            hi: self.hi.min(o.hi),
            nan: self.nan || o.nan,
        }
    }

    pub fn max(self, o: Self) -> Self {
        if self.is_empty() || o.is_empty() {
            return Self::EMPTY;
        }
        Self {
            lo: self.lo.max(o.lo),
            hi: self.hi.max(o.hi),
            nan: self.nan || o.nan,
        }
    }

    /// Angle of (x = `x`, y = `self`).
    pub fn atan2(self, x: Self) -> Self {
        if self.is_empty() || x.is_empty() {
            return Self::EMPTY;
        }
        let nan = self.nan || x.nan;
        // The angle jumps across the negative x axis.
        if self.contains(0.0) && x.lo < 0.0 {
            return Self::new(-PI, PI).or_nan(nan);
        }
        let c = [
            self.lo.atan2(x.lo),
            self.lo.atan2(x.hi),
            self.hi.atan2(x.lo),
            self.hi.atan2(x.hi),
        ];
        Self::sane(
            c[0].min(c[1]).min(c[2].min(c[3])),
            c[0].max(c[1]).max(c[2].max(c[3])),
            nan,
        )
    }

    /// Euclidean remainder, as fidget's `modulo`.
    pub fn modulo(self, o: Self) -> Self {
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

    /// Whether all of `self` lies in one period of the constant `o`, so
    /// that the remainder is continuous.
    pub fn same_period(self, o: Self) -> bool {
        o.lo == o.hi
            && o.lo != 0.0
            && o.is_finite()
            && self.is_finite()
            // Beyond this f64 cannot tell one period from the next.
            && self.magnitude() < 1e15 * o.lo.abs()
            && (self.lo / o.lo.abs()).floor() == (self.hi / o.lo.abs()).floor()
    }

    /// -1, 0 or 1.
    pub fn compare(self, o: Self) -> Self {
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
    pub fn and(self, o: Self) -> Self {
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
    pub fn or(self, o: Self) -> Self {
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Values that have broken interval arithmetic before.
    const AWKWARD: [f64; 13] = [
        f64::NEG_INFINITY,
        -1e300,
        -7.5,
        -2.0,
        -1.0,
        -0.3,
        0.0,
        0.3,
        1.0,
        2.0,
        7.5,
        1e300,
        f64::INFINITY,
    ];

    fn intervals() -> Vec<Interval> {
        let mut all = vec![Interval::EMPTY, Interval::ANYTHING];
        for (i, &lo) in AWKWARD.iter().enumerate() {
            for &hi in &AWKWARD[i..] {
                all.push(Interval::new(lo, hi));
            }
        }
        all
    }

    /// Points inside an interval: its ends and a few between.
    fn members(i: Interval) -> Vec<f64> {
        AWKWARD
            .iter()
            .copied()
            .chain([i.lo, i.hi, 0.5 * (i.lo + i.hi)])
            .filter(|v| i.contains(*v))
            .collect()
    }

    fn check(name: &str, out: Interval, v: f64, of: &str) {
        if v.is_nan() {
            assert!(out.nan, "{name} of {of}: NaN, but {out:?}");
        } else {
            let slack = 1e-12 * v.abs().min(1e300) + 1e-12;
            assert!(
                out.lo - slack <= v && v <= out.hi + slack,
                "{name} of {of}: {v} is not in {out:?}"
            );
        }
    }

    #[test]
    fn unary_results_hold_every_value() {
        type Unary = (&'static str, fn(Interval) -> Interval, fn(f64) -> f64);
        let all: [Unary; 16] = [
            ("neg", Interval::neg, |v| -v),
            ("abs", Interval::abs, f64::abs),
            ("square", Interval::square, |v| v * v),
            ("recip", Interval::recip, f64::recip),
            ("sqrt", Interval::sqrt, f64::sqrt),
            ("ln", Interval::ln, f64::ln),
            ("exp", Interval::exp, f64::exp),
            ("floor", Interval::floor, f64::floor),
            ("ceil", Interval::ceil, f64::ceil),
            ("round", Interval::round, f64::round),
            ("sin", Interval::sin, f64::sin),
            ("cos", Interval::cos, f64::cos),
            ("tan", Interval::tan, f64::tan),
            ("asin", Interval::asin, f64::asin),
            ("acos", Interval::acos, f64::acos),
            ("atan", Interval::atan, f64::atan),
        ];
        for (name, f, exact) in all {
            for i in intervals() {
                let out = f(i);
                for v in members(i) {
                    if v == 0.0 && name == "recip" {
                        continue; // ±inf: never a surface
                    }
                    if v.abs() >= 1e300 && matches!(name, "sin" | "cos") {
                        continue; // no argument reduction worth the name
                    }
                    check(name, out, exact(v), &format!("{v} in {i:?}"));
                }
            }
        }
    }

    #[test]
    fn binary_results_hold_every_value() {
        type Binary = (
            &'static str,
            fn(Interval, Interval) -> Interval,
            fn(f64, f64) -> f64,
        );
        let all: [Binary; 8] = [
            ("add", Interval::add, |a, b| a + b),
            ("sub", Interval::sub, |a, b| a - b),
            ("mul", Interval::mul, |a, b| a * b),
            ("div", Interval::div, |a, b| a / b),
            ("min", Interval::min, f64::min),
            ("max", Interval::max, f64::max),
            ("atan2", Interval::atan2, f64::atan2),
            ("mod", Interval::modulo, f64::rem_euclid),
        ];
        for (name, f, exact) in all {
            for a in intervals() {
                for b in intervals() {
                    let out = f(a, b);
                    for v in members(a) {
                        for w in members(b) {
                            if name == "div" && w == 0.0 {
                                continue; // ±inf: never a surface
                            }
                            check(
                                name,
                                out,
                                exact(v, w),
                                &format!("{v}, {w} in {a:?}, {b:?}"),
                            );
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn sine_is_tight() {
        let s = Interval::new(0.1, 1.2).sin();
        assert_eq!((s.lo, s.hi), (0.1f64.sin(), 1.2f64.sin()));
        let s = Interval::new(1.0, 2.0).sin();
        assert_eq!((s.lo, s.hi), (1.0f64.sin(), 1.0));
        let s = Interval::new(100.0, 107.0).sin();
        assert_eq!((s.lo, s.hi), (-1.0, 1.0));
    }

    #[test]
    fn a_root_of_a_negative_part_is_nan_beside_the_rest() {
        let s = Interval::new(-1.0, 4.0).sqrt();
        assert_eq!((s.lo, s.hi, s.nan), (0.0, 2.0, true));
        assert!(Interval::new(-4.0, -1.0).sqrt().is_empty());
    }
}
