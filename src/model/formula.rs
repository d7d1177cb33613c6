//! One formula of x, y and z, as given on the command line.
//!
//! In: text such as `sqrt(x^2 + y^2 + z^2) - 15`. Out: an expression tree, or
//! an error with the column.
//!
//! ```text
//! sum     = product { ("+" | "-") product }
//! product = sign { ("*" | "/" | "%") sign }
//! sign    = ("+" | "-") sign | power
//! power   = atom [ ("^" | "**") sign ]
//! atom    = number | name | name "(" sum { "," sum } ")" | "(" sum ")"
//! ```
//!
//! As in mathematics, `^` binds tighter than a sign before it and groups to
//! the right: -x^2 = -(x²), 2^3^2 = 2^9. Nesting is limited, so that hostile
//! input cannot overflow the stack. Constant parts are computed in f64.

use super::power::{power, power_of};
use fidget::context::Tree;
use std::f64::consts;

/// Why a formula is not one.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("column {column}: {message}")]
pub struct FormulaError {
    /// Column of the mistake, in characters from 1.
    pub column: usize,
    /// What is wrong, and the remedy.
    pub message: String,
}

/// Deepest nesting of parentheses, signs and powers.
const MAX_DEPTH: usize = 200;

/// Functions of one argument.
const UNARY: [&str; 20] = [
    "sqrt", "sin", "cos", "tan", "asin", "acos", "atan", "exp", "ln", "log",
    "abs", "floor", "ceil", "round", "square", "sign", "not", "recip", "neg",
    "rand",
];
/// Functions of two arguments; `min` and `max` take any number.
const BINARY: [&str; 9] = [
    "min", "max", "atan2", "mod", "pow", "compare", "and", "or", "mix",
];
const CONSTANTS: [&str; 6] = ["x", "y", "z", "pi", "e", "tau"];
const WITH_DEPTH: [&str; 7] = ["x", "y", "z", "d", "pi", "e", "tau"];

/// Parses the formula of a shape.
pub fn parse_formula(text: &str) -> Result<Tree, FormulaError> {
    match parse(text, None)? {
        Value::Field(tree) => Ok(tree),
        Value::Number(v) => Err(FormulaError {
            column: 1,
            message: format!(
                "the formula is the constant {v}; a shape needs at least \
                 one of x, y, z"
            ),
        }),
    }
}

/// Parses a formula that may be a constant, in which `d` stands for `depth`.
pub(super) fn parse_with_depth(
    text: &str,
    depth: Tree,
) -> Result<Tree, FormulaError> {
    parse(text, Some(depth)).map(Value::tree)
}

fn parse(text: &str, depth: Option<Tree>) -> Result<Value, FormulaError> {
    let mut parser = Parser {
        tokens: tokens(text)?,
        next: 0,
        end: text.chars().count() + 1,
        depth,
    };
    if parser.tokens.is_empty() {
        return Err(FormulaError {
            column: 1,
            message: "the formula is empty; example: \
                      sqrt(x^2 + y^2 + z^2) - 15"
                .to_owned(),
        });
    }
    let value = parser.sum(0)?;
    if let Some((token, column)) = parser.tokens.get(parser.next) {
        return Err(FormulaError {
            column: *column,
            message: match token {
                Token::Symbol(")") => "unmatched `)`".to_owned(),
                Token::Symbol(",") => {
                    "a `,` outside a function's parentheses".to_owned()
                }
                _ => format!(
                    "expected an operator before {token}; write \
                     multiplication as `*`"
                ),
            },
        });
    }
    Ok(value)
}

#[derive(Clone, Debug, PartialEq)]
enum Token {
    Number(f64),
    Name(String),
    Symbol(&'static str),
}

impl std::fmt::Display for Token {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Number(v) => write!(f, "`{v}`"),
            Self::Name(n) => write!(f, "`{n}`"),
            Self::Symbol(s) => write!(f, "`{s}`"),
        }
    }
}

fn tokens(text: &str) -> Result<Vec<(Token, usize)>, FormulaError> {
    let chars: Vec<char> = text.chars().collect();
    let mut out = Vec::new();
    let mut i = 0;
    while let Some(&c) = chars.get(i) {
        let column = i + 1;
        let is = |j: usize, f: fn(&char) -> bool| chars.get(j).is_some_and(f);
        if c.is_whitespace() {
            i += 1;
        } else if c.is_ascii_digit()
            || (c == '.' && is(i + 1, char::is_ascii_digit))
        {
            let start = i;
            while is(i, |c| c.is_ascii_digit() || *c == '.') {
                i += 1;
            }
            // An exponent only if digits follow: `2e` is 2 and the name e.
            if is(i, |c| matches!(c, 'e' | 'E')) {
                let sign = usize::from(is(i + 1, |c| matches!(c, '+' | '-')));
                if is(i + 1 + sign, char::is_ascii_digit) {
                    i += 1 + sign;
                    while is(i, char::is_ascii_digit) {
                        i += 1;
                    }
                }
            }
            let digits: String = chars[start..i].iter().collect();
            let value = digits
                .parse::<f64>()
                .ok()
                .filter(|v| v.abs() <= f64::from(f32::MAX));
            let Some(value) = value else {
                return Err(FormulaError {
                    column,
                    message: format!("`{digits}` is not a number in range"),
                });
            };
            out.push((Token::Number(value), column));
        } else if c.is_alphabetic() || c == '_' {
            let start = i;
            while is(i, |c| c.is_alphanumeric() || *c == '_') {
                i += 1;
            }
            let name = chars[start..i].iter().collect();
            out.push((Token::Name(name), column));
        } else {
            let power = c == '*' && is(i + 1, |c| *c == '*');
            let symbol = match c {
                _ if power => "^",
                '+' => "+",
                '-' | '\u{2212}' => "-",
                '*' | '\u{b7}' | '\u{d7}' => "*",
                '/' => "/",
                '%' => "%",
                '^' => "^",
                '(' => "(",
                ')' => ")",
                ',' => ",",
                other => {
                    return Err(FormulaError {
                        column,
                        message: format!(
                            "unexpected character `{}`",
                            other.escape_default()
                        ),
                    });
                }
            };
            i += if power { 2 } else { 1 };
            out.push((Token::Symbol(symbol), column));
        }
    }
    Ok(out)
}

/// A part of the formula: constant, or a function of x, y, z.
enum Value {
    Number(f64),
    Field(Tree),
}

impl Value {
    fn tree(self) -> Tree {
        match self {
            Self::Number(v) => Tree::constant(v as f32),
            Self::Field(t) => t,
        }
    }
}

struct Parser {
    tokens: Vec<(Token, usize)>,
    next: usize,
    /// Column after the last character.
    end: usize,
    /// What `d` stands for, if there is such a thing.
    depth: Option<Tree>,
}

impl Parser {
    fn column(&self) -> usize {
        self.tokens.get(self.next).map_or(self.end, |t| t.1)
    }

    fn error<T>(&self, message: String) -> Result<T, FormulaError> {
        Err(FormulaError {
            column: self.column(),
            message,
        })
    }

    /// Takes the next token if it is one of `symbols`.
    fn take(&mut self, symbols: &[&'static str]) -> Option<&'static str> {
        match self.tokens.get(self.next) {
            Some((Token::Symbol(s), _)) if symbols.contains(s) => {
                self.next += 1;
                Some(s)
            }
            _ => None,
        }
    }

    fn sum(&mut self, depth: usize) -> Result<Value, FormulaError> {
        let mut left = self.product(depth)?;
        while let Some(op) = self.take(&["+", "-"]) {
            let right = self.product(depth)?;
            left = combine(op, left, right);
        }
        Ok(left)
    }

    fn product(&mut self, depth: usize) -> Result<Value, FormulaError> {
        let mut left = self.sign(depth)?;
        while let Some(op) = self.take(&["*", "/", "%"]) {
            let right = self.sign(depth)?;
            left = combine(op, left, right);
        }
        Ok(left)
    }

    fn sign(&mut self, depth: usize) -> Result<Value, FormulaError> {
        if depth > MAX_DEPTH {
            return self.error(format!(
                "nested more than {MAX_DEPTH} deep; use a .rhai script with \
                 intermediate values"
            ));
        }
        match self.take(&["+", "-"]) {
            Some("-") => Ok(match self.sign(depth + 1)? {
                Value::Number(v) => Value::Number(-v),
                Value::Field(t) => Value::Field(-t),
            }),
            Some(_) => self.sign(depth + 1),
            None => self.power(depth),
        }
    }

    fn power(&mut self, depth: usize) -> Result<Value, FormulaError> {
        let base = self.atom(depth)?;
        if self.take(&["^"]).is_none() {
            return Ok(base);
        }
        let exponent = self.sign(depth + 1)?;
        Ok(raise(base, exponent))
    }

    fn atom(&mut self, depth: usize) -> Result<Value, FormulaError> {
        let column = self.column();
        let Some((token, _)) = self.tokens.get(self.next).cloned() else {
            return self.error("the formula ends too early".to_owned());
        };
        match token {
            Token::Number(v) => {
                self.next += 1;
                Ok(Value::Number(v))
            }
            Token::Symbol("(") => {
                self.next += 1;
                let value = self.sum(depth + 1)?;
                self.close(column)?;
                Ok(value)
            }
            Token::Symbol(_) => self.error(format!(
                "expected a number, a name or `(`, found {token}"
            )),
            Token::Name(name) => {
                self.next += 1;
                if self.take(&["("]).is_none() {
                    return match &self.depth {
                        Some(depth) if name == "d" => {
                            Ok(Value::Field(depth.clone()))
                        }
                        Some(_) => constant(&name, column, &WITH_DEPTH),
                        None => constant(&name, column, &CONSTANTS),
                    };
                }
                let mut arguments = Vec::new();
                if self.take(&[")"]).is_none() {
                    loop {
                        arguments.push(self.sum(depth + 1)?);
                        if self.take(&[","]).is_none() {
                            break;
                        }
                    }
                    self.close(column)?;
                }
                call(&name, arguments, column)
            }
        }
    }

    fn close(&mut self, opened: usize) -> Result<(), FormulaError> {
        if self.take(&[")"]).is_some() {
            return Ok(());
        }
        match self.tokens.get(self.next) {
            None => self.error(format!(
                "the parenthesis of column {opened} is not closed"
            )),
            Some((token, _)) => self.error(format!(
                "expected an operator or `)` before {token}; write \
                 multiplication as `*`"
            )),
        }
    }
}

fn combine(op: &str, a: Value, b: Value) -> Value {
    if let (Value::Number(a), Value::Number(b)) = (&a, &b) {
        return Value::Number(match op {
            "+" => a + b,
            "-" => a - b,
            "*" => a * b,
            "/" => a / b,
            _ => a.rem_euclid(*b),
        });
    }
    let (a, b) = (a.tree(), b.tree());
    Value::Field(match op {
        "+" => a + b,
        "-" => a - b,
        "*" => a * b,
        "/" => a / b,
        _ => a.modulo(b),
    })
}

fn raise(base: Value, exponent: Value) -> Value {
    match (base, exponent) {
        (Value::Number(a), Value::Number(b)) => Value::Number(a.powf(b)),
        (Value::Field(a), Value::Number(b)) => Value::Field(power(&a, b)),
        (a, Value::Field(b)) => Value::Field(power_of(&a.tree(), &b)),
    }
}

fn constant(
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
        _ if UNARY.contains(&name) || BINARY.contains(&name) => {
            return Err(FormulaError {
                column,
                message: format!("`{name}` is a function: write {name}(...)"),
            });
        }
        _ => return unknown(name, column, known),
    })
}

fn unknown(
    name: &str,
    column: usize,
    known: &[&str],
) -> Result<Value, FormulaError> {
    let meant = super::param::nearest(name, known.iter().copied())
        .map(|n| format!("; did you mean `{n}`?"))
        .unwrap_or_default();
    Err(FormulaError {
        column,
        message: format!(
            "unknown name `{name}`{meant} (known: {})",
            known.join(", ")
        ),
    })
}

fn call(
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
    if UNARY.contains(&name) {
        let (Some(a), None) = (arguments.next(), arguments.next()) else {
            return wrong("1 argument");
        };
        return Ok(apply_unary(name, a));
    }
    if name == "min" || name == "max" {
        let Some(first) = arguments.next() else {
            return wrong("1 or more arguments");
        };
        return Ok(arguments.fold(first, |a, b| apply_binary(name, a, b)));
    }
    if BINARY.contains(&name) {
        let (Some(a), Some(b), None) =
            (arguments.next(), arguments.next(), arguments.next())
        else {
            return wrong("2 arguments");
        };
        return Ok(apply_binary(name, a, b));
    }
    if CONSTANTS.contains(&name) {
        return Err(FormulaError {
            column,
            message: format!(
                "`{name}` is not a function; write multiplication as `*`"
            ),
        });
    }
    let known: Vec<&str> = UNARY.iter().chain(&BINARY).copied().collect();
    unknown(name, column, &known)
}

fn apply_unary(name: &str, a: Value) -> Value {
    if let Value::Number(v) = a {
        let folded = match name {
            "sqrt" => v.sqrt(),
            "sin" => v.sin(),
            "cos" => v.cos(),
            "tan" => v.tan(),
            "asin" => v.asin(),
            "acos" => v.acos(),
            "atan" => v.atan(),
            "exp" => v.exp(),
            "ln" | "log" => v.ln(),
            "abs" => v.abs(),
            "floor" => v.floor(),
            "ceil" => v.ceil(),
            "round" => v.round(),
            "square" => v * v,
            "recip" => v.recip(),
            "neg" => -v,
            // `sign`, `not`, `rand`: fidget's definitions decide.
            _ => return Value::Field(unary_tree(name, &a.tree())),
        };
        return Value::Number(folded);
    }
    Value::Field(unary_tree(name, &a.tree()))
}

fn unary_tree(name: &str, a: &Tree) -> Tree {
    match name {
        "sqrt" => a.sqrt(),
        "sin" => a.sin(),
        "cos" => a.cos(),
        "tan" => a.tan(),
        "asin" => a.asin(),
        "acos" => a.acos(),
        "atan" => a.atan(),
        "exp" => a.exp(),
        "ln" | "log" => a.ln(),
        "abs" => a.abs(),
        "floor" => a.floor(),
        "ceil" => a.ceil(),
        "round" => a.round(),
        "square" => a.square(),
        "recip" => a.recip(),
        "sign" => a.compare(0.0),
        "not" => a.not(),
        "rand" => a.rand(),
        _ => Tree::neg(a),
    }
}

fn apply_binary(name: &str, a: Value, b: Value) -> Value {
    if name == "pow" {
        return raise(a, b);
    }
    if let (Value::Number(a), Value::Number(b)) = (&a, &b) {
        match name {
            "min" => return Value::Number(a.min(*b)),
            "max" => return Value::Number(a.max(*b)),
            "atan2" => return Value::Number(a.atan2(*b)),
            "mod" => return Value::Number(a.rem_euclid(*b)),
            _ => {}
        }
    }
    let (a, b) = (a.tree(), b.tree());
    Value::Field(match name {
        "min" => a.min(b),
        "max" => a.max(b),
        "atan2" => a.atan2(b),
        "mod" => a.modulo(b),
        "compare" => a.compare(b),
        "and" => a.and(b),
        "or" => a.or(b),
        _ => a.mix(b),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use fidget::context::Context;

    fn value(text: &str, x: f32, y: f32, z: f32) -> f32 {
        let mut context = Context::new();
        let node = context.import(&parse_formula(text).unwrap());
        context.eval_xyz(node, x, y, z).unwrap()
    }

    #[test]
    fn precedence_is_that_of_mathematics() {
        assert_eq!(value("-x^2", 3.0, 0.0, 0.0), -9.0);
        assert_eq!(value("2*x^2", 3.0, 0.0, 0.0), 18.0);
        assert_eq!(value("2*x**2", 3.0, 0.0, 0.0), 18.0);
        assert_eq!(value("x+2^3^2", 0.0, 0.0, 0.0), 512.0);
        assert_eq!(value("x^-1", 4.0, 0.0, 0.0), 0.25);
        assert_eq!(value("x^0.5", 9.0, 0.0, 0.0), 3.0);
        assert_eq!(value("(-x)^2", 3.0, 0.0, 0.0), 9.0);
        assert_eq!(value("2-x-1", 3.0, 0.0, 0.0), -2.0);
        assert_eq!(value("8/x/2", 2.0, 0.0, 0.0), 2.0);
        assert_eq!(value("1 - -x", 2.0, 0.0, 0.0), 3.0);
        assert_eq!(value("(x^2)^3", 2.0, 0.0, 0.0), 64.0);
    }

    #[test]
    fn functions_and_constants() {
        assert_eq!(value("sqrt(x^2+y^2+z^2) - 15", 9.0, 0.0, 12.0), 0.0);
        assert_eq!(value("min(x, y, z, 7)", 5.0, 3.0, 4.0), 3.0);
        assert_eq!(value("max(x, y)", 5.0, 3.0, 4.0), 5.0);
        assert_eq!(value("mod(x, 3) + x % 2", 7.0, 0.0, 0.0), 2.0);
        assert_eq!(value("sign(x)", -7.0, 0.0, 0.0), -1.0);
        assert_eq!(value("x + 1e3 + .5", 0.0, 0.0, 0.0), 1000.5);
        assert!((value("cos(x*pi)", 1.0, 0.0, 0.0) + 1.0).abs() < 1e-6);
        assert!((value("ln(e) + 0*x", 1.0, 0.0, 0.0) - 1.0).abs() < 1e-6);
        assert_eq!(value("pow(x, 3)", 2.0, 0.0, 0.0), 8.0);
        assert!((value("2^x", 3.0, 0.0, 0.0) - 8.0).abs() < 1e-5);
        assert!(
            (value("atan2(y, x)", 0.0, 1.0, 0.0) - std::f32::consts::FRAC_PI_2)
                .abs()
                < 1e-6
        );
    }

    #[test]
    fn every_listed_function_parses() {
        for name in UNARY {
            parse_formula(&format!("{name}(x)")).unwrap();
            parse_formula(&format!("{name}(0.5) + x")).unwrap();
        }
        for name in BINARY {
            parse_formula(&format!("{name}(x, y)")).unwrap();
            parse_formula(&format!("{name}(1, 2) + x")).unwrap();
        }
    }

    #[test]
    fn errors_point_at_the_column() {
        for (text, column, words) in [
            ("", 1, "empty"),
            ("   ", 1, "empty"),
            ("x +", 4, "ends too early"),
            ("x + * y", 5, "found `*`"),
            ("2x", 2, "multiplication"),
            ("(x + 1", 7, "column 1 is not closed"),
            ("x)", 2, "unmatched"),
            ("x, y", 2, "outside"),
            ("sqr(x)", 1, "did you mean `sqrt`"),
            ("x + w", 5, "unknown name `w`"),
            ("sqrt(x, y)", 1, "takes 1 argument, not 2"),
            ("sqrt()", 1, "not 0"),
            ("atan2(x)", 1, "takes 2 arguments"),
            ("x(2)", 1, "not a function"),
            ("sqrt + 1", 1, "is a function"),
            ("x # 2", 3, "unexpected character"),
            ("x + 1e99", 5, "not a number in range"),
            ("1.2.3 + x", 1, "not a number"),
            ("3 + 4", 1, "constant 7"),
            ("sqrt(x 2)", 8, "expected an operator"),
        ] {
            let error = parse_formula(text).unwrap_err();
            assert_eq!(error.column, column, "{text}: {error}");
            assert!(
                error.message.contains(words),
                "{text}: {error} does not say {words}"
            );
        }
    }

    #[test]
    fn nesting_is_limited() {
        for text in [
            "(".repeat(100_000),
            "-".repeat(100_000) + "x",
            "sin(".repeat(100_000),
            "2^".repeat(100_000) + "x",
        ] {
            let error = parse_formula(&text).unwrap_err();
            assert!(error.message.contains("deep"), "{error}");
        }
        // A long formula is not a deep one.
        let text = "x + ".repeat(20_000) + "y";
        parse_formula(&text).unwrap();
    }
}
