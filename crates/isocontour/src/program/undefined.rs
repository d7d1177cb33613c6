//! Says what is wrong with an operation that has no value.

use super::Step;
use fidget::context::{BinaryOpcode, UnaryOpcode};

/// What the step tries to compute, in words.
pub(super) fn no_number(step: &Step, operands: &[f64]) -> String {
    let shown = |i: usize| match operands.get(i) {
        // The number gets as few digits as suffice, but what is just out of
        // range must not be rounded into it.
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
        Step::Blend(..) => format!("the blend of {a} and {b}"),
        Step::Data(..) => {
            "data at a place of which a coordinate is infinite or NaN"
                .to_owned()
        }
        Step::Axis(_) => "a coordinate".to_owned(),
        Step::Const(_) => "a constant of NaN".to_owned(),
    }
}
