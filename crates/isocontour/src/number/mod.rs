//! Kinds of number that an expression can be evaluated on.
//!
//! | kind | what it is |
//! |---|---|
//! | `f64` | one value |
//! | [`Interval`](crate::interval::Interval) | all values over a box |
//! | [`Wide`](wide::Wide) | eight values, in f32 |
//! | [`Span`](span::Span) | all values over each of eight boxes |
//! | [`Dual`](dual::Dual) | an `Interval` or a `Wide`, with its derivatives |
//! | `Slot` of `program/slot.rs` | an `Interval`, its derivatives and the value in the box's middle |
//!
//! [`run`](run::run) evaluates fidget's tapes on any kind; `unary` and
//! `binary` do single operations. A new kind implements [`Number`], and
//! [`Component`] if it is to have derivatives.

pub(crate) mod dual;
mod interval;
mod real;
pub(crate) mod run;
pub(crate) mod span;
#[cfg(test)]
pub(crate) mod tests;
pub(crate) mod wide;

use crate::tree;
use fidget::context::{BinaryOpcode, UnaryOpcode};

/// Values on which fidget's operations can be carried out. The methods are
/// named after the operations, and do what fidget's evaluators do: for example,
/// a NaN in an operand of `min` or `max` makes the result NaN.
pub(crate) trait Number: Copy {
    /// The constant `v`.
    fn splat(v: f32) -> Self;
    fn neg(self) -> Self;
    fn abs(self) -> Self;
    fn recip(self) -> Self;
    fn sqrt(self) -> Self;
    fn square(self) -> Self;
    fn floor(self) -> Self;
    fn ceil(self) -> Self;
    fn round(self) -> Self;
    fn sin(self) -> Self;
    fn cos(self) -> Self;
    fn tan(self) -> Self;
    fn asin(self) -> Self;
    fn acos(self) -> Self;
    fn atan(self) -> Self;
    fn exp(self) -> Self;
    fn ln(self) -> Self;
    /// 1 where `self` is 0, else 0.
    fn not(self) -> Self;
    /// A number from 0 to 1, made of the bits of `self`.
    fn rand(self) -> Self;
    fn add(self, o: Self) -> Self;
    fn sub(self, o: Self) -> Self;
    fn mul(self, o: Self) -> Self;
    /// The product with a constant.
    fn scale(self, by: f32) -> Self;
    fn div(self, o: Self) -> Self;
    /// The angle of the point with y = `self` and x = `o`.
    fn atan2(self, o: Self) -> Self;
    /// The remainder of Euclid's division, which is never negative.
    fn modulo(self, o: Self) -> Self;
    /// -1, 0 or 1 where `self` is less than, equal to or greater than `o`.
    fn compare(self, o: Self) -> Self;
    /// A number whose bits are made of the bits of both operands.
    fn mix(self, o: Self) -> Self;
    fn min(self, o: Self) -> Self;
    fn max(self, o: Self) -> Self;
    /// `self` where it is 0, else `o`.
    fn and(self, o: Self) -> Self;
    /// `self` where it is not 0, else `o`.
    fn or(self, o: Self) -> Self;
}

/// Numbers that a value and its derivatives can be made of.
pub(crate) trait Component: Number {
    /// A derivative times a factor. A derivative that is zero stays zero where
    /// the kind can tell, however large the factor may be.
    #[inline(always)]
    fn along(self, by: Self) -> Self {
        self.mul(by)
    }
    /// `x` where `a` is less than `b`, else `y`. Where a range cannot tell, the
    /// range of both.
    fn choose(a: Self, b: Self, x: Self, y: Self) -> Self;
    /// `x` where `a` is zero, else `y`.
    fn choose_zero(a: Self, x: Self, y: Self) -> Self;
    /// `instead` where `a` or `b` is NaN, else `self`. Kinds that cannot tell
    /// keep `self`.
    #[inline(always)]
    fn unless_nan(self, _a: Self, _b: Self, _instead: f32) -> Self {
        self
    }
    /// The derivative of `self`, the value of an operation that goes in steps.
    /// `a` and `b` are the derivatives of the operands.
    fn step(self, a: Self, b: Self) -> Self;
    /// A term of the derivative of `self.atan2(x)`, added to the smooth part.
    /// It is zero, or unknown where the angle may jump by a turn. `along` is
    /// the derivative of `self`.
    fn leap(self, x: Self, along: Self) -> Self;
    /// The derivative of the remainder of `self` by `o`, whose derivatives are
    /// `a` and `b`.
    fn wrap(self, o: Self, a: Self, b: Self) -> Self;
}

/// A function of one operand.
pub(crate) fn unary<T: Number>(op: UnaryOpcode, a: T) -> T {
    tree::with_one!(op, a)
}

/// A function of two operands.
pub(crate) fn binary<T: Number>(op: BinaryOpcode, a: T, b: T) -> T {
    tree::with_two!(op, a, b)
}
