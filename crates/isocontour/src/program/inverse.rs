//! Sums, products and quotients with a constant, from the result to the operand.

use crate::interval::Interval;
use fidget::context::BinaryOpcode;

/// The one value that a step has all over a box.
pub(super) fn only(range: Interval) -> Option<f64> {
    (range.lo == range.hi && !range.nan).then_some(range.lo)
}

/// The number of the operand that is no constant, and what it is where the
/// operation has some result.
pub(super) fn inverse(
    op: BinaryOpcode,
    constants: [Option<f64>; 2],
) -> Option<(usize, impl Fn(f64) -> f64)> {
    use BinaryOpcode::{Add, Div, Mul, Sub};
    let (operand, c) = match (op, constants) {
        (Add | Sub, [_, Some(c)]) => (0, c),
        (Add | Sub, [Some(c), _]) => (1, c),
        (Mul | Div, [_, Some(c)]) if c != 0.0 => (0, c),
        (Mul, [Some(c), _]) if c != 0.0 => (1, c),
        _ => return None,
    };
    let of = move |result: f64| match (op, operand) {
        (Add, _) => result - c,
        (Sub, 0) => result + c,
        (Sub, _) => c - result,
        (Mul, _) => result / c,
        _ => result * c,
    };
    Some((operand, of))
}
