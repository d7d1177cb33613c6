//! Values of parameters: whole numbers, numbers, and true or false.

use super::functions::whole;
use std::fmt;

/// Value of a parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Value {
    Int(i64),
    Float(f64),
    Bool(bool),
}

impl fmt::Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Int(v) => write!(f, "{v}"),
            // The number has its point, which shows its type, and that 2.5 is
            // allowed.
            Self::Float(v) => write!(f, "{v:?}"),
            Self::Bool(v) => write!(f, "{v}"),
        }
    }
}

impl Value {
    /// The text as a value for a parameter whose default is `self`. A default
    /// that is a whole number takes fractions, too.
    pub(super) fn parse_like(self, text: &str) -> Result<Self, &'static str> {
        let text = text.trim();
        let number = || {
            let number = text.parse().ok().filter(|v: &f64| v.is_finite());
            number.map(Self::Float).ok_or("a number")
        };
        match self {
            Self::Int(_) => match text.parse() {
                Ok(whole) => Ok(Self::Int(whole)),
                Err(_) => number().map(Self::simple),
            },
            Self::Float(_) => number(),
            Self::Bool(_) => {
                text.parse().map(Self::Bool).map_err(|_| "true or false")
            }
        }
    }

    /// The value as a number, if it can be compared.
    pub(super) fn number(self) -> Option<f64> {
        match self {
            Self::Int(v) => Some(v as f64),
            Self::Float(v) => Some(v).filter(|v| !v.is_nan()),
            Self::Bool(_) => None,
        }
    }

    /// The value as a whole number, if it is one.
    fn simple(self) -> Self {
        match self {
            Self::Float(v) => whole(v).map_or(self, Self::Int),
            _ => self,
        }
    }

    /// The value as a value for a parameter with this default. Whole numbers
    /// may stand for other numbers, and other numbers for whole ones.
    pub(super) fn like(self, default: Self) -> Option<Self> {
        match (self, default) {
            (Self::Int(v), Self::Float(_)) => Some(Self::Float(v as f64)),
            (Self::Float(_), Self::Int(_)) => Some(self.simple()),
            (Self::Int(_), Self::Int(_))
            | (Self::Float(_), Self::Float(_))
            | (Self::Bool(_), Self::Bool(_)) => Some(self),
            _ => None,
        }
    }
}
