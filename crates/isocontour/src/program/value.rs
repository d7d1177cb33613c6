//! Values of single operations at a point.
//!
//! As fidget defines them, but in f64.

use super::Step;
use fidget::context::{BinaryOpcode, UnaryOpcode};

pub(super) fn unary_value(op: UnaryOpcode, a: f64) -> f64 {
    match op {
        UnaryOpcode::Neg => -a,
        UnaryOpcode::Abs => a.abs(),
        UnaryOpcode::Recip => 1.0 / a,
        UnaryOpcode::Sqrt => a.sqrt(),
        UnaryOpcode::Square => a * a,
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
        // Defined by their bits or by exact zeros: fidget's own, in f32.
        UnaryOpcode::Not | UnaryOpcode::Rand => f64::from(op.eval(a as f32)),
    }
}

pub(super) fn binary_value(op: BinaryOpcode, a: f64, b: f64) -> f64 {
    match op {
        BinaryOpcode::Add => a + b,
        BinaryOpcode::Sub => a - b,
        BinaryOpcode::Mul => a * b,
        BinaryOpcode::Div => a / b,
        BinaryOpcode::Atan => a.atan2(b),
        // NaN wins in fidget's min and max, unlike in f64's.
        BinaryOpcode::Min | BinaryOpcode::Max if a.is_nan() || b.is_nan() => {
            f64::NAN
        }
        BinaryOpcode::Min => a.min(b),
        BinaryOpcode::Max => a.max(b),
        BinaryOpcode::Mod => a.rem_euclid(b),
        BinaryOpcode::Compare => match a.partial_cmp(&b) {
            Some(order) => f64::from(order as i8),
            None => f64::NAN,
        },
        BinaryOpcode::And => {
            if a == 0.0 {
                a
            } else {
                b
            }
        }
        BinaryOpcode::Or => {
            if a != 0.0 {
                a
            } else {
                b
            }
        }
        BinaryOpcode::Mix => f64::from(op.eval(a as f32, b as f32)),
    }
}

/// What a step is asked that has no answer, in words.
pub(super) fn no_number(step: &Step, operands: &[f64]) -> String {
    let shown = |i: usize| match operands.get(i) {
        // As few digits as tell it: what is just out of range must not be
        // rounded into it.
        Some(v) if *v == 0.0 => "0".to_owned(),
        Some(v) if (1e-4..1e5).contains(&v.abs()) => format!("{}", *v as f32),
        Some(v) => format!("{v:.3e}"),
        None => String::new(),
    };
    let (a, b) = (shown(0), shown(1));
    match step {
        Step::Unary(op, _) => match op {
            UnaryOpcode::Sqrt => format!("the square root of {a}"),
            UnaryOpcode::Ln => format!("the logarithm of {a}"),
            UnaryOpcode::Asin => format!("the arc sine of {a}"),
            UnaryOpcode::Acos => format!("the arc cosine of {a}"),
            op => format!("{op:?}({a})").to_lowercase(),
        },
        Step::Binary(op, ..) => match op {
            BinaryOpcode::Add => format!("{a} + {b}"),
            BinaryOpcode::Sub => format!("{a} - {b}"),
            BinaryOpcode::Mul => format!("{a} · {b}"),
            BinaryOpcode::Div => format!("{a} / {b}"),
            BinaryOpcode::Mod => format!("{a} mod {b}"),
            op => format!("{op:?}({a}, {b})").to_lowercase(),
        },
        Step::Axis(_) => "a coordinate".to_owned(),
        Step::Const(_) => "a constant of NaN".to_owned(),
    }
}
