//! A part of a formula, and arithmetic on such parts.

use crate::model::power::{power, power_of};
use fidget::context::Tree;

/// A part of the formula: constant, or a function of x, y, z.
pub(super) enum Value {
    Number(f64),
    Field(Tree),
}

impl Value {
    pub(super) fn tree(self) -> Tree {
        match self {
            Self::Number(v) => Tree::constant(v as f32),
            Self::Field(t) => t,
        }
    }

    /// A function of this part. It is computed at once if the part is constant.
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

    /// A function of this part and another. It is computed at once if both are
    /// constant.
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

    /// This part to the power of another.
    pub(super) fn raised(self, exponent: Self) -> Self {
        match (self, exponent) {
            (Self::Number(a), Self::Number(b)) => Self::Number(a.powf(b)),
            (Self::Field(a), Self::Number(b)) => Self::Field(power(&a, b)),
            (a, Self::Field(b)) => Self::Field(power_of(&a.tree(), &b)),
        }
    }
}
