//! The operations of fidget's expressions.

use fidget::context::{BinaryOpcode, Tree, TreeOp, UnaryOpcode};

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

/// The expression of an operation on another one.
pub fn unary(op: UnaryOpcode, a: &Tree) -> Tree {
    match op {
        UnaryOpcode::Neg => a.neg(),
        UnaryOpcode::Abs => a.abs(),
        UnaryOpcode::Recip => a.recip(),
        UnaryOpcode::Sqrt => a.sqrt(),
        UnaryOpcode::Square => a.square(),
        UnaryOpcode::Floor => a.floor(),
        UnaryOpcode::Ceil => a.ceil(),
        UnaryOpcode::Round => a.round(),
        UnaryOpcode::Sin => a.sin(),
        UnaryOpcode::Cos => a.cos(),
        UnaryOpcode::Tan => a.tan(),
        UnaryOpcode::Asin => a.asin(),
        UnaryOpcode::Acos => a.acos(),
        UnaryOpcode::Atan => a.atan(),
        UnaryOpcode::Exp => a.exp(),
        UnaryOpcode::Ln => a.ln(),
        UnaryOpcode::Not => a.not(),
        UnaryOpcode::Rand => a.rand(),
    }
}

/// The expression of an operation on two others.
pub fn binary(op: BinaryOpcode, a: Tree, b: Tree) -> Tree {
    match op {
        BinaryOpcode::Add => a + b,
        BinaryOpcode::Sub => a - b,
        BinaryOpcode::Mul => a * b,
        BinaryOpcode::Div => a / b,
        BinaryOpcode::Atan => a.atan2(b),
        BinaryOpcode::Min => a.min(b),
        BinaryOpcode::Max => a.max(b),
        BinaryOpcode::Compare => a.compare(b),
        BinaryOpcode::Mod => a.modulo(b),
        BinaryOpcode::And => a.and(b),
        BinaryOpcode::Or => a.or(b),
        BinaryOpcode::Mix => a.mix(b),
    }
}
