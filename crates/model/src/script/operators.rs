//! The operators of scripts, for numbers and fields.
//!
//! Whole numbers are numbers: 3 / 2 is 1.5, and 4 / 2 is the whole number 2,
//! which counts and indexes. `%` is never negative, as it is in fields. rhai's
//! own operators of whole numbers would come first in its fast mode, so that
//! mode is off.

use super::bodies::Bodies;
use super::shape::{Outcome, shape, term, value};
use super::tokens::SIGNED_POWER;
use crate::functions::whole;
use crate::term::Term;
use fidget::context::Tree;
use rhai::{Dynamic, Engine};
use std::any::TypeId;
use std::ops::{Range, RangeInclusive};

type Two = fn(Term, Term) -> Term;

/// Operators with a meaning of their own for numbers. Others are rhai's.
const OF_NUMBERS: &[(&str, Two)] = &[
    ("/", |a, b| a / b),
    ("%", Term::modulo),
    ("**", Term::raised),
    (SIGNED_POWER, signed_power),
];

/// Operators of fields.
const OF_FIELDS: &[(&str, Two)] = &[
    ("+", |a, b| a + b),
    ("-", |a, b| a - b),
    ("*", |a, b| a * b),
    ("/", |a, b| a / b),
    ("%", Term::modulo),
    ("**", Term::raised),
    (SIGNED_POWER, signed_power),
    ("|", Term::min),
    ("&", Term::max),
];

/// -a ** b, of which `negative` is -a.
fn signed_power(negative: Term, exponent: Term) -> Term {
    -(-negative).raised(exponent)
}

/// Makes the operators known to scripts.
pub(super) fn add_operators(engine: &mut Engine, bodies: &Bodies) {
    engine.set_fast_operators(false);
    add_numbers(engine);
    add_fields(engine, bodies);
    add_comparisons(engine);
    add_ranges(engine);
}

fn add_numbers(engine: &mut Engine) {
    let kinds = [TypeId::of::<i64>(), TypeId::of::<f64>()];
    for &(name, of) in OF_NUMBERS {
        for types in kinds.iter().flat_map(|a| kinds.map(|b| [*a, b])) {
            engine.register_raw_fn(name, types, move |_, given| {
                of_numbers(name, of, given)
            });
            if name == SIGNED_POWER {
                // No text has an assignment of it.
                continue;
            }
            let assign = format!("{name}=");
            engine.register_raw_fn(assign, types, move |_, given| {
                let result = of_numbers(name, of, given)?;
                if let Some(target) = given.first_mut() {
                    **target = result;
                }
                Ok(())
            });
        }
    }
}

fn of_numbers(
    name: &str,
    of: Two,
    given: &mut [&mut Dynamic],
) -> Outcome<Dynamic> {
    let [a, b] = given else {
        return Err("an operator has two operands".into());
    };
    let of_whole = a.is_int() && b.is_int();
    let by_zero = b.as_int() == Ok(0) && matches!(name, "/" | "%");
    if of_whole && by_zero {
        return Err(format!("{a} {name} {b}: division by zero").into());
    }
    if let (Ok(a), Ok(b)) = (a.as_int(), b.as_int())
        && let Some(exact) = of_whole_numbers(name, a, b)
    {
        return Ok(value(Term::Number(exact as f64), whole));
    }
    let (Some(a), Some(b)) = (term(a), term(b)) else {
        return Err(format!("`{name}` does not work on this").into());
    };
    Ok(value(of(a, b), |v| whole(v).filter(|_| of_whole)))
}

/// The result for whole numbers where it is one, too. They may be too large for
/// the digits of other numbers.
fn of_whole_numbers(name: &str, a: i64, b: i64) -> Option<i64> {
    let rest = a.checked_rem_euclid(b)?;
    match name {
        "%" => Some(rest),
        "/" if rest == 0 => a.checked_div(b),
        _ => None,
    }
}

fn add_fields(engine: &mut Engine, bodies: &Bodies) {
    let (field, any) = (TypeId::of::<Tree>(), TypeId::of::<Dynamic>());
    for &(name, of) in OF_FIELDS {
        for types in [[field, field], [field, any], [any, field]] {
            let bodies = bodies.clone();
            engine.register_raw_fn(name, types, move |_, given| {
                of_fields(name, of, given, &bodies)
            });
        }
    }
    engine
        .register_fn("-", |a: Tree| a.neg())
        .register_fn("+", |a: Tree| a);
    let marks = bodies.clone();
    engine.register_fn("!", move |a: Tree| marks.mark(a.neg()));
}

fn of_fields(
    name: &str,
    of: Two,
    given: &mut [&mut Dynamic],
    bodies: &Bodies,
) -> Outcome<Tree> {
    let [a, b] = given else {
        return Err("an operator has two operands".into());
    };
    let operands = (term(a), term(b));
    let (Some(first), Some(second)) = operands else {
        return Err(format!(
            "`{name}` works on shapes and numbers, not on {} and {}",
            super::shape::describe(a),
            super::shape::describe(b)
        )
        .into());
    };
    let is_body = |v: &Dynamic| shape(v).is_some_and(|tree| bodies.has(&tree));
    let whole = [&*a, &*b].map(|v| is_body(v));
    let word = match name {
        "+" => "union",
        "-" => "difference",
        _ => "",
    };
    if whole == [true, true] && !word.is_empty() {
        return Err(format!(
            "a {name} b of two bodies is no {word}: it would calculate with \
             the fields' values. Write {word}(a, b){}; where the values are \
             meant, write a {name} 1 * b",
            if name == "+" { " or a | b" } else { "" }
        )
        .into());
    }
    let made = of(first, second).tree();
    let number = |v: &Dynamic| v.is_int() || v.is_float();
    let keeps = match name {
        "|" | "&" => whole == [true, true],
        // The body is grown or shrunk.
        "+" | "-" => whole[0] && number(b),
        _ => false,
    };
    Ok(if keeps { bodies.mark(made) } else { made })
}

/// Comparisons of fields, which are refused, since a script runs once, before
/// any place is known.
fn add_comparisons(engine: &mut Engine) {
    fn refused<A, B>(_: A, _: B) -> Outcome<bool> {
        const REMEDY: &str = "a field cannot be compared: the script runs \
            once, and x, y and z have no values yet. Write what `if` would \
            do as a field: max(f, g) is where both are, min(f, g) where \
            either is, max(f, -x) is f where x > 0, step(0, x) is 0 or 1, \
            and compare(x, 0) is -1, 0 or 1";
        Err(REMEDY.into())
    }
    for operator in ["==", "!=", "<", ">", "<=", ">="] {
        engine
            .register_fn(operator, refused::<Tree, Tree>)
            .register_fn(operator, refused::<Tree, i64>)
            .register_fn(operator, refused::<Tree, f64>)
            .register_fn(operator, refused::<i64, Tree>)
            .register_fn(operator, refused::<f64, Tree>);
    }
}

/// Ranges from or to numbers that are whole, but were not made as such.
fn add_ranges(engine: &mut Engine) {
    fn end(v: f64) -> Outcome<i64> {
        whole(v).ok_or_else(|| {
            format!(
                "a loop counts in whole numbers, and {v} is none: write \
                 floor(…) or round(…), and step: 1 for a parameter that counts"
            )
            .into()
        })
    }
    fn open(a: f64, b: f64) -> Outcome<Range<i64>> {
        Ok(end(a)?..end(b)?)
    }
    fn closed(a: f64, b: f64) -> Outcome<RangeInclusive<i64>> {
        Ok(end(a)?..=end(b)?)
    }
    engine
        .register_fn("..", open)
        .register_fn("..", |a: i64, b: f64| open(a as f64, b))
        .register_fn("..", |a: f64, b: i64| open(a, b as f64))
        .register_fn("..=", closed)
        .register_fn("..=", |a: i64, b: f64| closed(a as f64, b))
        .register_fn("..=", |a: f64, b: i64| closed(a, b as f64));
}
