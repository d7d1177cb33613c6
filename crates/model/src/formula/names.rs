//! What names mean: coordinates, constants and functions.

use super::FormulaError;
use crate::functions::{FUNCTIONS, constant as number, function};
use crate::param::nearest;
use crate::term::Term;
use fidget::context::Tree;
use isoslice_base::pairs;

/// Names without parentheses in a model's formula.
pub(super) const CONSTANTS: &[&str] = &["x", "y", "z", "pi", "e", "tau"];

/// The name of a fourth variable.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Name {
    /// Distance to the nearest surface, mm.
    Depth,
    /// Curvature of an outline, 1/mm.
    Curvature,
}

impl Name {
    /// The name.
    pub(crate) fn text(self) -> &'static str {
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

/// The value of a name without parentheses, if it is one of `known`.
pub(super) fn constant(
    name: &str,
    column: usize,
    known: &[&str],
) -> Result<Term, FormulaError> {
    match name {
        "x" => return Ok(Term::Field(Tree::x())),
        "y" => return Ok(Term::Field(Tree::y())),
        "z" => return Ok(Term::Field(Tree::z())),
        _ => {}
    }
    if let Some(value) = number(name) {
        return Ok(Term::Number(value));
    }
    let Some(called) = function(name) else {
        return unknown(name, column, known);
    };
    let message = format!("`{name}` is a function: write {}", called.example);
    Err(FormulaError::at(column, message))
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

/// Names of shapes and of what is done with them, each with a formula.
const SHAPES: &[(&str, &str)] = pairs! {
    "sphere", "ball" => "sqrt(x^2 + y^2 + z^2) - 10";
    "cylinder", "circle", "disc", "disk"
        => "max(sqrt(x^2 + y^2) - 5, abs(z) - 10)";
    "box", "cube", "cuboid", "block", "rectangle", "square_prism"
        => "max(abs(x) - 15, abs(y) - 10, abs(z) - 5)";
    "torus", "ring" => "sqrt((sqrt(x^2 + y^2) - 15)^2 + z^2) - 4";
    "gyroid" => "sin(x)*cos(y) + sin(y)*cos(z) + sin(z)*cos(x)";
    "union" => "min(f, g)";
    "intersection", "intersect" => "max(f, g)";
    "difference", "subtract" => "max(f, -g)";
};

/// What to write instead of the name of a shape.
fn shape(name: &str) -> Option<String> {
    let name = name.to_lowercase();
    let found = SHAPES.iter().find(|(known, _)| *known == name)?;
    Some(format!(
        "; write {}, or a script, which has shapes by name",
        found.1
    ))
}

fn unknown(
    name: &str,
    column: usize,
    known: &[&str],
) -> Result<Term, FormulaError> {
    let meant = powers(name)
        .or_else(|| nearest(name, known.iter().copied()).map(str::to_owned))
        .map(|meant| format!("; did you mean `{meant}`?"));
    let meant = shape(name).or(meant).unwrap_or_default();
    let known = known.join(", ");
    let message = format!("unknown name `{name}`{meant} (known: {known})");
    Err(FormulaError::at(column, message))
}

/// The value of a name with parentheses.
pub(super) fn call(
    name: &str,
    arguments: &[Term],
    column: usize,
) -> Result<Term, FormulaError> {
    if let Some(function) = function(name) {
        return function.apply(arguments).map_err(|takes| {
            let message = format!("{takes}: write {}", function.example);
            FormulaError::at(column, message)
        });
    }
    if CONSTANTS.contains(&name) {
        let message =
            format!("`{name}` is not a function; write multiplication as `*`");
        return Err(FormulaError::at(column, message));
    }
    let known: Vec<&str> = FUNCTIONS.iter().map(|f| f.name).collect();
    unknown(name, column, &known)
}
