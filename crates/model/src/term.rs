//! What functions are applied to: numbers, which are computed at once, and
//! fields.

use super::power::{power, power_of};
use fidget::context::Tree;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A number, or a function of x, y, z.
#[derive(Clone, Debug)]
pub(super) enum Term {
    Number(f64),
    Field(Tree),
}

impl Term {
    pub(super) fn tree(self) -> Tree {
        match self {
            Self::Number(v) => Tree::constant(v as f32),
            Self::Field(t) => t,
        }
    }

    /// A function of this term. A number makes a number.
    pub(super) fn map(
        self,
        number: impl Fn(f64) -> f64,
        field: impl Fn(&Tree) -> Tree,
    ) -> Self {
        match self {
            Self::Number(v) => Self::Number(number(v)),
            Self::Field(t) => Self::Field(field(&t)),
        }
    }

    /// A function of this term and another. Two numbers make a number.
    pub(super) fn with(
        self,
        other: Self,
        number: impl Fn(f64, f64) -> f64,
        field: impl Fn(Tree, Tree) -> Tree,
    ) -> Self {
        match (self, other) {
            (Self::Number(a), Self::Number(b)) => Self::Number(number(a, b)),
            (a, b) => Self::Field(field(a.tree(), b.tree())),
        }
    }

    /// The remainder, which is not negative.
    pub(super) fn modulo(self, other: Self) -> Self {
        self.with(other, f64::rem_euclid, |a, b| a.modulo(b))
    }

    /// This term to the power of another.
    pub(super) fn raised(self, exponent: Self) -> Self {
        match (self, exponent) {
            (Self::Number(a), Self::Number(b)) => Self::Number(a.powf(b)),
            (Self::Field(a), Self::Number(b)) => Self::Field(power(&a, b)),
            (a, Self::Field(b)) => Self::Field(power_of(&a.tree(), &b)),
        }
    }

    /// The lesser of two. NaN wins, as it does in fields.
    pub(super) fn min(self, other: Self) -> Self {
        self.with(other, |a, b| unless_nan(a, b, f64::min), |a, b| a.min(b))
    }

    /// The greater of two. NaN wins, as it does in fields.
    pub(super) fn max(self, other: Self) -> Self {
        self.with(other, |a, b| unless_nan(a, b, f64::max), |a, b| a.max(b))
    }

    /// -1, 0 or 1, as this term is less than another, equal or more.
    pub(super) fn compare(self, other: Self) -> Self {
        let number = |a: f64, b: f64| {
            a.partial_cmp(&b)
                .map_or(f64::NAN, |order| f64::from(order as i8))
        };
        self.with(other, number, |a, b| a.compare(b))
    }
}

fn unless_nan(a: f64, b: f64, of: fn(f64, f64) -> f64) -> f64 {
    if a.is_nan() || b.is_nan() {
        f64::NAN
    } else {
        of(a, b)
    }
}

macro_rules! operator {
    ($trait:ident $name:ident) => {
        impl $trait for Term {
            type Output = Term;
            fn $name(self, other: Term) -> Term {
                self.with(other, f64::$name, Tree::$name)
            }
        }
    };
}

operator!(Add add);
operator!(Sub sub);
operator!(Mul mul);
operator!(Div div);

impl Neg for Term {
    type Output = Term;
    fn neg(self) -> Term {
        self.map(|v| -v, Tree::neg)
    }
}

impl From<f64> for Term {
    fn from(number: f64) -> Term {
        Term::Number(number)
    }
}
