//! What each kind of node makes of its inputs.

use super::inverse::inverse;
use super::value::{Type, Value, constant, number};
use fidget::context::{BinaryOpcode, Tree, TreeOp, UnaryOpcode};
use std::f64::consts::{LN_2, LN_10};

/// Whole exponents up to this are multiplied out, so that they work for negative
/// bases.
const MOST_MULTIPLIED: f64 = 1024.0;

/// A kind of node that is the same for each part of its inputs.
struct Each {
    name: &'static str,
    inputs: &'static [&'static str],
    make: fn(&[Tree]) -> Tree,
}

const A: &[&str] = &["A"];
const AB: &[&str] = &["A", "B"];

const fn each(
    name: &'static str,
    inputs: &'static [&'static str],
    make: fn(&[Tree]) -> Tree,
) -> Each {
    Each { name, inputs, make }
}

const EACH: &[Each] = &[
    each("addition", AB, |v| v[0].clone() + v[1].clone()),
    each("subtraction", AB, |v| v[0].clone() - v[1].clone()),
    each("multiplication", AB, |v| v[0].clone() * v[1].clone()),
    each("division", AB, |v| divided(&v[0], &v[1])),
    each("sin", A, |v| v[0].sin()),
    each("cos", A, |v| v[0].cos()),
    each("tan", A, |v| v[0].tan()),
    each("arcsin", A, |v| v[0].asin()),
    each("arccos", A, |v| v[0].acos()),
    each("arctan", A, |v| v[0].atan()),
    each("arctan2", AB, |v| v[0].atan2(v[1].clone())),
    each("min", AB, |v| v[0].min(v[1].clone())),
    each("max", AB, |v| v[0].max(v[1].clone())),
    each("abs", A, |v| v[0].abs()),
    each("fmod", AB, |v| fmod(&v[0], &v[1])),
    each("mod", AB, |v| modulo(&v[0], &v[1])),
    each("pow", AB, |v| power(&v[0], &v[1])),
    each("sqrt", A, |v| v[0].sqrt()),
    each("exp", A, |v| v[0].exp()),
    each("log", A, |v| v[0].ln()),
    each("log2", A, |v| v[0].ln() * number(1.0 / LN_2)),
    each("log10", A, |v| v[0].ln() * number(1.0 / LN_10)),
    each("select", &["A", "B", "C", "D"], |v| {
        select(&v[0], &v[1], &v[2], &v[3])
    }),
    each("clamp", &["A", "min", "max"], |v| {
        v[1].max(v[0].min(v[2].clone()))
    }),
    each("cosh", A, |v| {
        (v[0].exp() + (-v[0].clone()).exp()) * number(0.5)
    }),
    each("sinh", A, |v| {
        (v[0].exp() - (-v[0].clone()).exp()) * number(0.5)
    }),
    each("tanh", A, |v| {
        let square = (v[0].clone() * number(2.0)).exp();
        number(1.0) - number(2.0) / (square + number(1.0))
    }),
    each("round", A, |v| v[0].round()),
    each("ceil", A, |v| v[0].ceil()),
    each("floor", A, |v| v[0].floor()),
    each("sign", A, |v| sign(&v[0])),
    each("fract", A, |v| v[0].clone() - v[0].floor()),
];

/// The names of the inputs of a kind of node, of those that need nothing but
/// their inputs. None for others.
pub(crate) fn inputs(name: &str) -> Option<&'static [&'static str]> {
    if let Some(each) = EACH.iter().find(|each| each.name == name) {
        return Some(each.inputs);
    }
    match name {
        "composevector" => Some(&["x", "y", "z"]),
        "vectorfromscalar" | "decomposevector" | "transpose" | "inverse"
        | "length" => Some(A),
        "composematrix" => Some(&[
            "m00", "m01", "m02", "m03", "m10", "m11", "m12", "m13", "m20",
            "m21", "m22", "m23", "m30", "m31", "m32", "m33",
        ]),
        "matrixfromcolumns" | "matrixfromrows" => Some(&["A", "B", "C", "D"]),
        "dot" | "cross" => Some(AB),
        "matvecmultiplication" | "matrixvectormultiplication" => Some(AB),
        _ => None,
    }
}

/// What a kind of node makes of its inputs. None if they are not of its types.
pub(super) fn make(name: &str, given: &[Value]) -> Option<Value> {
    if let Some(each) = EACH.iter().find(|each| each.name == name) {
        return by_parts(each, given);
    }
    let kinds: Vec<Type> = given.iter().map(Value::kind).collect();
    let all = |kind: Type| kinds.iter().all(|k| *k == kind);
    let part = |i: usize, k: usize| given[i].parts()[k].clone();
    match name {
        "composevector" | "composematrix" if all(Type::Scalar) => {
            let parts: Vec<Tree> =
                (0..given.len()).map(|i| part(i, 0)).collect();
            let kind = if name == "composevector" {
                Type::Vector
            } else {
                Type::Matrix
            };
            Some(Value::Numbers(kind, parts))
        }
        "vectorfromscalar" if all(Type::Scalar) => {
            Some(Value::vector([0; 3].map(|_| part(0, 0))))
        }
        // Its links take their parts.
        "decomposevector" if all(Type::Vector) => Some(given[0].clone()),
        "transpose" if all(Type::Matrix) => Some(Value::matrix(
            (0..16).map(|i| part(0, 4 * (i % 4) + i / 4)).collect(),
        )),
        "inverse" if all(Type::Matrix) => {
            Some(Value::matrix(inverse(given[0].parts())))
        }
        "length" if all(Type::Vector) => {
            let v = given[0].parts();
            Some(Value::scalar(dot(v, v).sqrt()))
        }
        "dot" if all(Type::Vector) => {
            Some(Value::scalar(dot(given[0].parts(), given[1].parts())))
        }
        "cross" if all(Type::Vector) => {
            let at = |i: usize, k: usize| part(i, k % 3);
            Some(Value::vector([0, 1, 2].map(|k| {
                at(0, k + 1) * at(1, k + 2) - at(0, k + 2) * at(1, k + 1)
            })))
        }
        "matrixfromcolumns" | "matrixfromrows" if all(Type::Vector) => {
            let by_rows = name == "matrixfromrows";
            let at = |line: usize, k: usize| match (k, line) {
                (3, 3) => number(1.0),
                (3, _) => number(0.0),
                _ => part(line, k),
            };
            let element = |i: usize| {
                let (row, column) = (i / 4, i % 4);
                if by_rows {
                    at(row, column)
                } else {
                    at(column, row)
                }
            };
            Some(Value::matrix((0..16).map(element).collect()))
        }
        "matvecmultiplication" | "matrixvectormultiplication"
            if kinds == [Type::Matrix, Type::Vector] =>
        {
            Some(transformed(given[0].parts(), given[1].parts()))
        }
        _ => None,
    }
}

/// A kind of node that does the same with each part. All inputs are of one type.
fn by_parts(each: &Each, given: &[Value]) -> Option<Value> {
    let kind = given.first()?.kind();
    let fits = kind != Type::Resource && given.iter().all(|v| v.kind() == kind);
    fits.then(|| {
        let count = given[0].parts().len();
        let part = |k: usize| -> Tree {
            let parts: Vec<Tree> =
                given.iter().map(|v| v.parts()[k].clone()).collect();
            (each.make)(&parts)
        };
        Value::Numbers(kind, (0..count).map(part).collect())
    })
}

fn dot(a: &[Tree], b: &[Tree]) -> Tree {
    let products = a.iter().zip(b).map(|(a, b)| a.clone() * b.clone());
    let sum = products.reduce(|a, b| a + b);
    sum.unwrap_or_else(|| number(0.0))
}

/// A place where a matrix puts it: it moves by the last column.
fn transformed(m: &[Tree], v: &[Tree]) -> Value {
    Value::vector(
        [0, 1, 2].map(|r| dot(&m[4 * r..4 * r + 3], v) + m[4 * r + 3].clone()),
    )
}

fn divided(a: &Tree, b: &Tree) -> Tree {
    if constant(a) == Some(1.0) {
        b.recip()
    } else {
        a.clone() / b.clone()
    }
}

fn sign(a: &Tree) -> Tree {
    match &**a {
        // The order of two numbers needs no difference.
        TreeOp::Binary(BinaryOpcode::Sub, a, b) => {
            let (a, b) = (a.clone(), b.clone());
            TreeOp::Binary(BinaryOpcode::Compare, a, b).into()
        }
        _ => a.compare(number(0.0)),
    }
}

/// True for an absolute value.
fn is_size(a: &Tree) -> bool {
    matches!(&**a, TreeOp::Unary(UnaryOpcode::Abs, _))
}

/// a − b · trunc(a / b). It has the sign of a.
fn fmod(a: &Tree, b: &Tree) -> Tree {
    // The remainder of positive numbers is exact.
    a.compare(number(0.0)) * a.abs().modulo(b.abs())
}

/// a − b · floor(a / b). It has the sign of b.
fn modulo(a: &Tree, b: &Tree) -> Tree {
    if is_size(b) {
        return a.modulo(b.clone());
    }
    let sign = b.compare(number(0.0));
    sign.clone() * (sign * a.clone()).modulo(b.abs())
}

fn power(a: &Tree, b: &Tree) -> Tree {
    match constant(b) {
        Some(b) if b.fract() == 0.0 && b.abs() <= MOST_MULTIPLIED => {
            a.pow(b as i64)
        }
        Some(0.5) => a.sqrt(),
        _ => (a.ln() * b.clone()).exp(),
    }
}

/// c where a is below b, else d. What is not taken may be undefined.
fn select(a: &Tree, b: &Tree, c: &Tree, d: &Tree) -> Tree {
    if constant(a) == Some(0.0) && is_size(b) {
        return unless_zero(b, c, d);
    }
    // `and` gives its first number if that is 0, else the second one.
    let is_below = (-a.compare(b.clone())).max(number(0.0));
    is_below.not().and(d.clone()) + is_below.and(c.clone())
}

/// `then` where an absolute value is not 0, else `other`.
fn unless_zero(size: &Tree, then: &Tree, other: &Tree) -> Tree {
    let is_zero = || size.not();
    match (&**size, constant(then), constant(other)) {
        (TreeOp::Unary(_, a), ..) if std::ptr::eq(&**a, then.as_ptr()) => {
            then.or(other.clone())
        }
        (_, Some(0.0), Some(1.0)) => is_zero(),
        (_, _, Some(0.0)) => size.and(then.clone()),
        _ => is_zero().and(other.clone()) + size.and(then.clone()),
    }
}
