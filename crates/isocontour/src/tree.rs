//! The operations of fidget's expressions.

use fidget::context::{BinaryOpcode, Tree, TreeOp, UnaryOpcode};
use std::ops::{Add, Div, Mul, Sub};

/// fidget's operations on one operand, by their names in its text format.
pub const UNARY: [(&str, UnaryOpcode); 18] = [
    ("abs", UnaryOpcode::Abs),
    ("neg", UnaryOpcode::Neg),
    ("sqrt", UnaryOpcode::Sqrt),
    ("square", UnaryOpcode::Square),
    ("floor", UnaryOpcode::Floor),
    ("ceil", UnaryOpcode::Ceil),
    ("round", UnaryOpcode::Round),
    ("sin", UnaryOpcode::Sin),
    ("cos", UnaryOpcode::Cos),
    ("tan", UnaryOpcode::Tan),
    ("asin", UnaryOpcode::Asin),
    ("acos", UnaryOpcode::Acos),
    ("atan", UnaryOpcode::Atan),
    ("ln", UnaryOpcode::Ln),
    ("not", UnaryOpcode::Not),
    ("rand", UnaryOpcode::Rand),
    ("exp", UnaryOpcode::Exp),
    ("recip", UnaryOpcode::Recip),
];

/// fidget's operations on two operands, by their names in its text format.
pub const BINARY: [(&str, BinaryOpcode); 12] = [
    ("add", BinaryOpcode::Add),
    ("mul", BinaryOpcode::Mul),
    ("min", BinaryOpcode::Min),
    ("max", BinaryOpcode::Max),
    ("div", BinaryOpcode::Div),
    ("atan2", BinaryOpcode::Atan),
    ("sub", BinaryOpcode::Sub),
    ("compare", BinaryOpcode::Compare),
    ("mod", BinaryOpcode::Mod),
    ("and", BinaryOpcode::And),
    ("or", BinaryOpcode::Or),
    ("mix", BinaryOpcode::Mix),
];

/// What an operation works on.
pub fn operands(op: &TreeOp) -> impl Iterator<Item = &TreeOp> {
    let all = match op {
        TreeOp::Input(_) | TreeOp::Const(_) => [None; 4],
        TreeOp::Unary(_, a) | TreeOp::RemapAffine { target: a, .. } => {
            [Some(a), None, None, None]
        }
        TreeOp::Binary(_, a, b) => [Some(a), Some(b), None, None],
        TreeOp::RemapAxes { target, x, y, z } => [target, x, y, z].map(Some),
    };
    all.into_iter().flatten().map(|op| &**op)
}

/// Calls the method of an operation on one operand, which has the same name on
/// expressions and on numbers.
macro_rules! with_one {
    ($op:expr, $a:expr) => {
        match $op {
            UnaryOpcode::Neg => $a.neg(),
            UnaryOpcode::Abs => $a.abs(),
            UnaryOpcode::Recip => $a.recip(),
            UnaryOpcode::Sqrt => $a.sqrt(),
            UnaryOpcode::Square => $a.square(),
            UnaryOpcode::Floor => $a.floor(),
            UnaryOpcode::Ceil => $a.ceil(),
            UnaryOpcode::Round => $a.round(),
            UnaryOpcode::Sin => $a.sin(),
            UnaryOpcode::Cos => $a.cos(),
            UnaryOpcode::Tan => $a.tan(),
            UnaryOpcode::Asin => $a.asin(),
            UnaryOpcode::Acos => $a.acos(),
            UnaryOpcode::Atan => $a.atan(),
            UnaryOpcode::Exp => $a.exp(),
            UnaryOpcode::Ln => $a.ln(),
            UnaryOpcode::Not => $a.not(),
            UnaryOpcode::Rand => $a.rand(),
        }
    };
}
pub(crate) use with_one;

/// Calls the method of an operation on two operands.
macro_rules! with_two {
    ($op:expr, $a:expr, $b:expr) => {
        match $op {
            BinaryOpcode::Add => $a.add($b),
            BinaryOpcode::Sub => $a.sub($b),
            BinaryOpcode::Mul => $a.mul($b),
            BinaryOpcode::Div => $a.div($b),
            BinaryOpcode::Atan => $a.atan2($b),
            BinaryOpcode::Min => $a.min($b),
            BinaryOpcode::Max => $a.max($b),
            BinaryOpcode::Compare => $a.compare($b),
            BinaryOpcode::Mod => $a.modulo($b),
            BinaryOpcode::And => $a.and($b),
            BinaryOpcode::Or => $a.or($b),
            BinaryOpcode::Mix => $a.mix($b),
        }
    };
}
pub(crate) use with_two;

/// The expression of an operation on another one.
pub fn unary(op: UnaryOpcode, a: &Tree) -> Tree {
    with_one!(op, a)
}

/// The expression of an operation on two others.
pub fn binary(op: BinaryOpcode, a: Tree, b: Tree) -> Tree {
    with_two!(op, a, b)
}
