//! What names mean: coordinates, constants and functions.

use super::FormulaError;
use super::value::Value;
use crate::model::param::nearest;
use fidget::context::Tree;
use std::f64::consts;

/// Names without parentheses in a model's formula.
pub(super) const CONSTANTS: &[&str] = &["x", "y", "z", "pi", "e", "tau"];

/// The name of a fourth variable.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::model) enum Name {
    /// Distance to the nearest surface, mm.
    Depth,
    /// Curvature of an outline, 1/mm.
    Curvature,
}

impl Name {
    /// The name.
    pub(in crate::model) fn text(self) -> &'static str {
        match self {
            Name::Depth => "d",
            Name::Curvature => "curvature",
        }
    }

    /// The names without parentheses that are allowed beside the fourth
    /// variable, and its own name.
    pub(super) fn constants(self) -> &'static [&'static str] {
        match self {
            Name::Depth => &["x", "y", "z", "d", "pi", "e", "tau"],
            Name::Curvature => &["x", "y", "z", "curvature", "pi", "e", "tau"],
        }
    }
}

type Function1 = fn(Value) -> Value;
type Function2 = fn(Value, Value) -> Value;

/// Functions of one argument. `sign`, `not` and `rand` are not computed in
/// advance: fidget's definitions decide.
pub(super) const UNARY: [(&str, Function1); 20] = [
    ("sqrt", |a| a.map(f64::sqrt, Tree::sqrt)),
    ("sin", |a| a.map(f64::sin, Tree::sin)),
    ("cos", |a| a.map(f64::cos, Tree::cos)),
    ("tan", |a| a.map(f64::tan, Tree::tan)),
    ("asin", |a| a.map(f64::asin, Tree::asin)),
    ("acos", |a| a.map(f64::acos, Tree::acos)),
    ("atan", |a| a.map(f64::atan, Tree::atan)),
    ("exp", |a| a.map(f64::exp, Tree::exp)),
    ("ln", |a| a.map(f64::ln, Tree::ln)),
    ("log", |a| a.map(f64::ln, Tree::ln)),
    ("abs", |a| a.map(f64::abs, Tree::abs)),
    ("floor", |a| a.map(f64::floor, Tree::floor)),
    ("ceil", |a| a.map(f64::ceil, Tree::ceil)),
    ("round", |a| a.map(f64::round, Tree::round)),
    ("square", |a| a.map(|v| v * v, Tree::square)),
    ("sign", |a| Value::Field(a.tree().compare(0.0))),
    ("not", |a| Value::Field(a.tree().not())),
    ("recip", |a| a.map(f64::recip, Tree::recip)),
    ("neg", negated),
    ("rand", |a| Value::Field(a.tree().rand())),
];

/// Functions of two arguments. `min` and `max` take any number of arguments.
pub(super) const BINARY: [(&str, Function2); 9] = [
    ("min", |a, b| a.with(b, f64::min, |a, b| a.min(b))),
    ("max", |a, b| a.with(b, f64::max, |a, b| a.max(b))),
    ("atan2", |a, b| a.with(b, f64::atan2, |a, b| a.atan2(b))),
    ("mod", Value::modulo),
    ("pow", Value::raised),
    ("compare", |a, b| Value::Field(a.tree().compare(b.tree()))),
    ("and", |a, b| Value::Field(a.tree().and(b.tree()))),
    ("or", |a, b| Value::Field(a.tree().or(b.tree()))),
    ("mix", |a, b| Value::Field(a.tree().mix(b.tree()))),
];

/// The value with the opposite sign.
pub(super) fn negated(a: Value) -> Value {
    a.map(|v| -v, Tree::neg)
}

fn unary(name: &str) -> Option<Function1> {
    UNARY.iter().find(|f| f.0 == name).map(|f| f.1)
}

fn binary(name: &str) -> Option<Function2> {
    BINARY.iter().find(|f| f.0 == name).map(|f| f.1)
}

/// The value of a name without parentheses, if it is one of `known`.
pub(super) fn constant(
    name: &str,
    column: usize,
    known: &[&str],
) -> Result<Value, FormulaError> {
    Ok(match name {
        "x" => Value::Field(Tree::x()),
        "y" => Value::Field(Tree::y()),
        "z" => Value::Field(Tree::z()),
        "pi" | "PI" | "\u{3c0}" => Value::Number(consts::PI),
        "tau" | "TAU" => Value::Number(consts::TAU),
        "e" | "E" => Value::Number(consts::E),
        _ if unary(name).is_some() || binary(name).is_some() => {
            return Err(FormulaError {
                column,
                message: format!("`{name}` is a function: write {name}(...)"),
            });
        }
        _ => return unknown(name, column, known),
    })
}

/// How `x2` and `x²` are written in formulas.
fn powers(name: &str) -> Option<String> {
    let mut letters = name.chars();
    let variable = letters.next().filter(|c| matches!(c, 'x' | 'y' | 'z'))?;
    let power = match letters.as_str() {
        "2" | "\u{b2}" => 2,
        "3" | "\u{b3}" => 3,
        "4" | "\u{2074}" => 4,
        _ => return None,
    };
    Some(format!("{variable}^{power}"))
}

fn unknown(
    name: &str,
    column: usize,
    known: &[&str],
) -> Result<Value, FormulaError> {
    let meant = powers(name)
        .or_else(|| nearest(name, known.iter().copied()).map(str::to_owned))
        .map(|meant| format!("; did you mean `{meant}`?"))
        .unwrap_or_default();
    Err(FormulaError {
        column,
        message: format!(
            "unknown name `{name}`{meant} (known: {})",
            known.join(", ")
        ),
    })
}

/// The value of a name with parentheses.
pub(super) fn call(
    name: &str,
    arguments: Vec<Value>,
    column: usize,
) -> Result<Value, FormulaError> {
    let count = arguments.len();
    let wrong = |wants: &str| {
        Err(FormulaError {
            column,
            message: format!("`{name}` takes {wants}, not {count}"),
        })
    };
    let mut arguments = arguments.into_iter();
    if let Some(f) = unary(name) {
        let (Some(a), None) = (arguments.next(), arguments.next()) else {
            return wrong("1 argument");
        };
        return Ok(f(a));
    }
    if let Some(f) = binary(name) {
        if name == "min" || name == "max" {
            let Some(first) = arguments.next() else {
                return wrong("1 or more arguments");
            };
            return Ok(arguments.fold(first, f));
        }
        let (Some(a), Some(b), None) =
            (arguments.next(), arguments.next(), arguments.next())
        else {
            return wrong("2 arguments");
        };
        return Ok(f(a, b));
    }
    if CONSTANTS.contains(&name) {
        return Err(FormulaError {
            column,
            message: format!(
                "`{name}` is not a function; write multiplication as `*`"
            ),
        });
    }
    let (one, two) = (UNARY.iter().map(|f| f.0), BINARY.iter().map(|f| f.0));
    let known: Vec<&str> = one.chain(two).collect();
    unknown(name, column, &known)
}
