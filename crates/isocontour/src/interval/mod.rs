//! Interval arithmetic in f64, for the search for bounds and for proofs.
//!
//! In: boxes of values. Out: an interval that holds every number the
//! operation can return, and whether it can return NaN.
//!
//! Guarantees: no operation panics, whatever its operands. (fidget's own
//! intervals panic, and abort the process from compiled code, when one end
//! becomes NaN.) NaN is a flag beside the numbers, so `sqrt(x)` over [-1, 4] is
//! "[0, 2] or NaN" and not "anything".
//!
//! Not guaranteed: outward rounding. The ends are rounded to nearest, so a
//! bound may be wrong by a few parts in 10¹⁶, ten orders of magnitude below the
//! tolerance of the search.

mod binary;
#[cfg(test)]
mod tests;
mod unary;

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
    pub(crate) const ANYTHING: Self = Self::REALS.or_nan(true);

    /// No number: certainly NaN.
    pub(crate) const EMPTY: Self =
        Self::new(f64::INFINITY, f64::NEG_INFINITY).or_nan(true);

    /// Every number, but never NaN.
    pub(crate) const REALS: Self = Self::new(f64::NEG_INFINITY, f64::INFINITY);

    pub(crate) const ZERO: Self = Self::new(0.0, 0.0);

    pub(crate) fn point(v: f64) -> Self {
        if v.is_nan() {
            return Self::EMPTY;
        }
        Self::new(v, v)
    }

    pub(crate) const fn new(lo: f64, hi: f64) -> Self {
        Self { lo, hi, nan: false }
    }

    /// The interval with ends that arithmetic may have made NaN.
    fn sane(lo: f64, hi: f64, nan: bool) -> Self {
        let lost = lo.is_nan() || hi.is_nan();
        let lo = if lo.is_nan() { f64::NEG_INFINITY } else { lo };
        let hi = if hi.is_nan() { f64::INFINITY } else { hi };
        Self::new(lo, hi).or_nan(nan || lost)
    }

    pub(crate) fn is_empty(self) -> bool {
        self.lo > self.hi
    }

    pub(crate) fn is_finite(self) -> bool {
        self.lo.is_finite() && self.hi.is_finite()
    }

    pub(crate) fn contains(self, v: f64) -> bool {
        self.lo <= v && v <= self.hi
    }

    /// Largest absolute value.
    pub(crate) fn magnitude(self) -> f64 {
        self.lo.abs().max(self.hi.abs())
    }

    pub(crate) fn hull(self, other: Self) -> Self {
        Self::new(self.lo.min(other.lo), self.hi.max(other.hi))
            .or_nan(self.nan || other.nan)
    }

    pub(crate) const fn or_nan(self, nan: bool) -> Self {
        Self {
            nan: self.nan || nan,
            ..self
        }
    }
}
