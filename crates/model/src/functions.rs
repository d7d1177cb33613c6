//! The functions and constants that models are written with, by their names.
//!
//! In: a name, and numbers or fields. Out: a number if all of them are numbers,
//! else a field. Scripts, formulas and Python all ask this table, so a name
//! means the same in each of them, and docs/functions.md lists what is here.
//!
//! Guarantees: a function of numbers has the value that the function of equal
//! constant fields has, but for the rounding to 32 bits. Where there is no value
//! (the root of -1), the result is NaN.

use super::term::Term;
use fidget::context::Tree;
use fidget::types::FloatExt;
use std::f64::consts;

/// A function of numbers or fields.
pub(super) struct Function {
    pub(super) name: &'static str,
    /// Least and greatest number of values that it takes.
    pub(super) takes: (usize, usize),
    /// Its results are whole numbers.
    rounds: bool,
    /// A call that works, for messages.
    pub(super) example: &'static str,
    of: fn(&[Term]) -> Term,
}

/// As many values as somebody gives.
const ANY: usize = usize::MAX;

/// Greatest size of a result that is made a whole number, so that products of
/// two results are whole numbers, too.
const MOST_WHOLE: f64 = i32::MAX as f64;

impl Function {
    /// Its value, or how many values it takes.
    pub(super) fn apply(&self, values: &[Term]) -> Result<Term, String> {
        let (least, most) = self.takes;
        if (least..=most).contains(&values.len()) {
            return Ok((self.of)(values));
        }
        let takes = match self.takes {
            (1, 1) => "1 argument".to_owned(),
            (least, ANY) => format!("{least} or more arguments"),
            (least, most) if least == most => format!("{least} arguments"),
            (least, most) => format!("{least} or {most} arguments"),
        };
        Err(format!(
            "`{}` takes {takes}, not {}",
            self.name,
            values.len()
        ))
    }

    /// Its result as a whole number, which counts and indexes, if it is one
    /// and either `of_whole` numbers or rounded.
    pub(super) fn whole(&self, result: f64, of_whole: bool) -> Option<i64> {
        whole(result).filter(|_| of_whole || self.rounds)
    }
}

/// A number that is whole and not too large to calculate with.
pub(super) fn whole(number: f64) -> Option<i64> {
    let whole = number.fract() == 0.0 && number.abs() <= MOST_WHOLE;
    whole.then_some(number as i64)
}

/// The function of a name.
pub(super) fn function(name: &str) -> Option<&'static Function> {
    FUNCTIONS.iter().find(|f| f.name == name)
}

/// The constant of a name: pi, tau and e, also in capitals, and fidget's.
pub(super) fn constant(name: &str) -> Option<f64> {
    match name {
        "pi" | "\u{3c0}" => Some(consts::PI),
        "tau" => Some(consts::TAU),
        "e" => Some(consts::E),
        "phi" => Some(consts::GOLDEN_RATIO),
        _ => fidget::rhai::constants::get_constant(name),
    }
}

macro_rules! functions {
    ($($name:literal $takes:tt $($rounds:ident)? $example:literal
       |$a:ident| $value:expr;)*) => {
        &[$(Function {
            name: $name,
            takes: functions!(takes $takes),
            rounds: functions!(rounds $($rounds)?),
            example: $example,
            of: |$a| $value,
        }),*]
    };
    (takes ($one:literal)) => { ($one, $one) };
    (takes ($least:literal, $most:expr)) => { ($least, $most) };
    (rounds) => { false };
    (rounds rounds) => { true };
}

/// All functions, in the order of docs/functions.md.
pub(super) const FUNCTIONS: &[Function] = functions![
    "sqrt" (1) "sqrt(x)" |a| of(a, f64::sqrt, Tree::sqrt);
    "cbrt" (1) "cbrt(x)" |a| at(a, 0).compare(0.0.into())
        * exp(ln(abs(at(a, 0))) / 3.0.into());
    "square" (1) "square(x)" |a| of(a, |v| v * v, Tree::square);
    "pow" (2) "pow(x, 3)" |a| at(a, 0).raised(at(a, 1));
    "exp" (1) "exp(x)" |a| exp(at(a, 0));
    "exp2" (1) "exp2(x)" |a| exp(at(a, 0) * consts::LN_2.into());
    "ln" (1) "ln(x)" |a| ln(at(a, 0));
    "log" (1) "log(x)" |a| ln(at(a, 0));
    "log2" (1) "log2(x)" |a| ln(at(a, 0)) / consts::LN_2.into();
    "log10" (1) "log10(x)" |a| ln(at(a, 0)) / consts::LN_10.into();
    "sin" (1) "sin(x)" |a| of(a, f64::sin, Tree::sin);
    "cos" (1) "cos(x)" |a| of(a, f64::cos, Tree::cos);
    "tan" (1) "tan(x)" |a| of(a, f64::tan, Tree::tan);
    "asin" (1) "asin(x)" |a| of(a, f64::asin, Tree::asin);
    "acos" (1) "acos(x)" |a| of(a, f64::acos, Tree::acos);
    "atan" (1) "atan(x)" |a| of(a, f64::atan, Tree::atan);
    "atan2" (2) "atan2(y, x)" |a|
        at(a, 0).with(at(a, 1), f64::atan2, |y, x| y.atan2(x));
    "sinh" (1) "sinh(x)" |a|
        (exp(at(a, 0)) - exp(-at(a, 0))) / 2.0.into();
    "cosh" (1) "cosh(x)" |a|
        (exp(at(a, 0)) + exp(-at(a, 0))) / 2.0.into();
    "tanh" (1) "tanh(x)" |a| one()
        - Term::from(2.0) / (exp(at(a, 0) * 2.0.into()) + one());
    "degrees" (1) "degrees(x)" |a| at(a, 0) * (180.0 / consts::PI).into();
    "radians" (1) "radians(x)" |a| at(a, 0) * (consts::PI / 180.0).into();
    "abs" (1) "abs(x)" |a| abs(at(a, 0));
    "sign" (1) rounds "sign(x)" |a| at(a, 0).compare(0.0.into());
    "floor" (1) rounds "floor(x)" |a| floor(at(a, 0));
    "ceil" (1) rounds "ceil(x)" |a| of(a, f64::ceil, Tree::ceil);
    "round" (1) rounds "round(x)" |a| of(a, f64::round, Tree::round);
    "trunc" (1) rounds "trunc(x)" |a|
        at(a, 0).compare(0.0.into()) * floor(abs(at(a, 0)));
    "fract" (1) "fract(x)" |a| at(a, 0) - floor(at(a, 0));
    "mod" (2) "mod(x, 10)" |a| at(a, 0).modulo(at(a, 1));
    "recip" (1) "recip(x)" |a| of(a, f64::recip, Tree::recip);
    "neg" (1) "neg(x)" |a| -at(a, 0);
    "min" (1, ANY) "min(f, g)" |a| fold(a, Term::min);
    "max" (1, ANY) "max(f, g)" |a| fold(a, Term::max);
    "clamp" (3) "clamp(x, lowest, highest)" |a|
        clamp(at(a, 0), at(a, 1), at(a, 2));
    "mix" (3) "mix(a, b, t)" |a|
        at(a, 0) * (one() - at(a, 2)) + at(a, 1) * at(a, 2);
    "step" (2) rounds "step(edge, x)" |a|
        (at(a, 1).compare(at(a, 0)) + one()).min(one());
    "smoothstep" (3) "smoothstep(lowest, highest, x)" |a|
        smoothstep(at(a, 0), at(a, 1), at(a, 2));
    "length" (1, ANY) "length(x, y, z)" |a| length(a);
    "hypot" (1, ANY) "hypot(x, y)" |a| length(a);
    "compare" (2) rounds "compare(f, g)" |a| at(a, 0).compare(at(a, 1));
    "and" (2) "and(f, g)" |a| both(a);
    "or" (2) "or(f, g)" |a| either(a);
    "not" (1) rounds "not(f)" |a| not(a);
    "logical_and" (2) "logical_and(f, g)" |a| both(a);
    "logical_or" (2) "logical_or(f, g)" |a| either(a);
    "logical_not" (1) rounds "logical_not(f)" |a| not(a);
    "rand" (1) "rand(x)" |a|
        of(a, |v| FloatExt::rand(v as f32).into(), Tree::rand);
    "hash" (2) "hash(x, y)" |a| at(a, 0).with(
        at(a, 1),
        |a, b| FloatExt::mix(a as f32, b as f32).into(),
        |a, b| a.mix(b),
    );
];

/// A value that was given; the number of values has been looked at before.
fn at(values: &[Term], index: usize) -> Term {
    values.get(index).cloned().unwrap_or(Term::Number(f64::NAN))
}

fn of(
    values: &[Term],
    number: fn(f64) -> f64,
    field: fn(&Tree) -> Tree,
) -> Term {
    at(values, 0).map(number, field)
}

fn one() -> Term {
    Term::Number(1.0)
}

fn exp(a: Term) -> Term {
    a.map(f64::exp, Tree::exp)
}

fn ln(a: Term) -> Term {
    a.map(f64::ln, Tree::ln)
}

fn abs(a: Term) -> Term {
    a.map(f64::abs, Tree::abs)
}

fn floor(a: Term) -> Term {
    a.map(f64::floor, Tree::floor)
}

fn fold(values: &[Term], by: fn(Term, Term) -> Term) -> Term {
    let all = values.iter().cloned();
    all.reduce(by).unwrap_or(Term::Number(f64::NAN))
}

fn clamp(a: Term, lowest: Term, highest: Term) -> Term {
    a.min(highest).max(lowest)
}

/// 0 below a lowest value, 1 above a highest one, and without a kink between.
fn smoothstep(lowest: Term, highest: Term, a: Term) -> Term {
    let way = (a - lowest.clone()) / (highest - lowest);
    let t = clamp(way, 0.0.into(), one());
    t.clone() * t.clone() * (Term::from(3.0) - t * 2.0.into())
}

/// The root of the sum of the squares.
fn length(values: &[Term]) -> Term {
    let square = |a: &Term| a.clone().map(|v| v * v, Tree::square);
    let sum = values.iter().map(square).reduce(|a, b| a + b);
    sum.unwrap_or(0.0.into()).map(f64::sqrt, Tree::sqrt)
}

fn both(values: &[Term]) -> Term {
    let number = |a: f64, b: f64| if a == 0.0 { a } else { b };
    at(values, 0).with(at(values, 1), number, |a, b| a.and(b))
}

fn either(values: &[Term]) -> Term {
    let number = |a: f64, b: f64| if a == 0.0 { b } else { a };
    at(values, 0).with(at(values, 1), number, |a, b| a.or(b))
}

fn not(values: &[Term]) -> Term {
    of(values, |v| f64::from(u8::from(v == 0.0)), Tree::not)
}

#[cfg(test)]
mod tests {
    use super::super::files::Files;
    use super::super::formula::parse_formula;
    use super::super::script::{ScriptLimits, run_script};
    use super::*;
    use fidget::context::Context;
    use std::sync::Arc;

    /// Values that give every function something to do, and are exact in 32
    /// bits.
    const VALUES: [[f32; 3]; 4] = [
        [0.75, 0.25, 0.5],
        [-1.5, 2.0, 0.125],
        [2.5, -0.75, 3.0],
        [0.0, 0.5, 1.0],
    ];

    fn at(tree: &Tree, [x, y, z]: [f32; 3]) -> f32 {
        let mut context = Context::new();
        let node = context.import(tree);
        context.eval_xyz(node, x, y, z).unwrap()
    }

    fn script(text: &str) -> Tree {
        let limits = ScriptLimits {
            memory_bytes: u64::MAX,
            ..ScriptLimits::default()
        };
        let script = run_script(text, &[], &limits, &Arc::default());
        script
            .unwrap_or_else(|error| panic!("{text}: {error}"))
            .tree
    }

    fn same(a: f32, b: f32) -> bool {
        a.is_nan() && b.is_nan()
            || a == b
            || (a - b).abs() <= 1e-5 * (1.0 + a.abs())
    }

    /// A name means the same in scripts and formulas, for fields and numbers,
    /// whole or not.
    #[test]
    fn a_name_has_one_meaning() {
        for function in FUNCTIONS {
            let count = function.takes.0.max(function.takes.1.min(3));
            for values in VALUES {
                let fields = ["x", "y", "z"][..count].join(", ");
                let numbers: Vec<_> =
                    values.iter().map(|v| format!("{v:?}")).collect();
                let numbers = numbers[..count].join(", ");
                let name = function.name;
                let wanted = at(
                    &parse_formula(
                        &format!("{name}({fields})"),
                        &Files::default(),
                    )
                    .unwrap(),
                    values,
                );
                for text in [
                    format!("{name}({fields}) + 0*x"),
                    format!("{name}({numbers}) + 0*x"),
                ] {
                    // With an exponent that varies, a negative base has none.
                    if name == "pow" && wanted.is_nan() {
                        continue;
                    }
                    let formula = at(
                        &parse_formula(&text, &Files::default()).unwrap(),
                        values,
                    );
                    assert!(
                        same(formula, wanted),
                        "{text}: {formula}, {wanted}"
                    );
                    let script = at(&script(&text), values);
                    assert!(same(script, wanted), "{text}: {script}, {wanted}");
                }
            }
        }
    }

    #[test]
    fn values_are_those_of_the_words() {
        for (text, wanted) in [
            ("mix(2, 4, 0.25)", 2.5),
            ("clamp(5, 1, 3)", 3.0),
            ("clamp(-5, 1, 3)", 1.0),
            ("step(2, 1.9)", 0.0),
            ("step(2, 2)", 1.0),
            ("step(2, 2.1)", 1.0),
            ("smoothstep(2, 4, 1)", 0.0),
            ("smoothstep(2, 4, 3)", 0.5),
            ("smoothstep(2, 4, 2.5)", 0.15625),
            ("smoothstep(2, 4, 9)", 1.0),
            ("smoothstep(4, 2, 2.5)", 0.84375),
            ("length(3, 4)", 5.0),
            ("length(1, 2, 2)", 3.0),
            ("hypot(3, -4)", 5.0),
            ("fract(2.75)", 0.75),
            ("fract(-0.25)", 0.75),
            ("trunc(-2.75)", -2.0),
            ("sign(-3)", -1.0),
            ("sign(0)", 0.0),
            ("log(e)", 1.0),
            ("ln(E)", 1.0),
            ("log2(8)", 3.0),
            ("log10(1000)", 3.0),
            ("tanh(0.5)", 0.462_117_17),
            ("tanh(99)", 1.0),
            ("tanh(-99)", -1.0),
            ("sinh(1)", 1.175_201_2),
            ("cosh(1)", 1.543_080_6),
            ("cbrt(-27)", -3.0),
            ("exp2(3)", 8.0),
            ("atan2(1, 0)", std::f64::consts::FRAC_PI_2),
            ("degrees(pi)", 180.0),
            ("radians(180) - PI", 0.0),
            ("tau - TAU", 0.0),
            ("mod(-1, 3)", 2.0),
            ("pow(2, -1)", 0.5),
            ("2^3 - 2**3", 0.0),
            ("-2^2", -4.0),
            ("round(-2.5)", -3.0),
            ("compare(2, 3)", -1.0),
            ("and(0, 5) + or(0, 5) + not(0)", 6.0),
        ] {
            let text = format!("{text} + 0*x");
            for tree in [
                parse_formula(&text, &Files::default()).unwrap(),
                script(&text),
            ] {
                let found = at(&tree, [0.0; 3]);
                assert!(same(found, wanted as f32), "{text}: {found}");
            }
        }
    }

    /// docs/functions.md has a row for each function.
    #[test]
    fn the_page_has_every_name() {
        let page = include_str!("../../../docs/functions.md");
        for function in FUNCTIONS {
            let call = format!("`{}(", function.name);
            assert!(page.contains(&call), "{} is not there", function.name);
        }
    }
}
