//! Shapes and operations beside fidget's, called in the same way as fidget's.
//!
//! `cylinder(#{radius: 5, height: 20})` names its values; without names they
//! are told apart by what they are (a place, a number, a shape) and numbers
//! by their order: `cylinder(5, 20)`, `cylinder([0, 0, 10], 5, 20)`. What has
//! a default may be left out. An operation is also a method: `f.twist(40)`.
//! docs/shapes.md is the list for users.
//!
//! Guaranteed: lengths that must be positive are positive, and numbers are
//! finite. Shapes whose row says `exact` are distances in mm.

mod convex;
mod rows;
#[cfg(test)]
mod tests;

use super::shape::Outcome;
use super::shape::{describe, shape};
use fidget::context::Tree;
use glam::DVec3;
use rhai::{Dynamic, Engine, Map, NativeCallContext};
use rows::ROWS;
use std::any::TypeId;

/// What an argument is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    /// A length of more than 0, or another number of more than 0.
    Positive,
    /// A length that may be 0.
    Length,
    /// Any number.
    Number,
    /// A place, or three lengths: `[x, y]` or `[x, y, z]`.
    Place,
    /// A shape, or an array of shapes.
    Shape,
    /// Places in the plane: `[[x, y], …]`.
    Points,
}

impl Kind {
    fn is_number(self) -> bool {
        matches!(self, Kind::Positive | Kind::Length | Kind::Number)
    }

    fn wanted(self) -> &'static str {
        match self {
            Kind::Positive => "a number above 0",
            Kind::Length => "a number of 0 or more",
            Kind::Number => "a number",
            Kind::Place => "a place such as [0, 0, 10]",
            Kind::Shape => "a shape",
            Kind::Points => "three places or more, [[0, 0], [10, 0], [0, 5]]",
        }
    }
}

/// A value that was given.
#[derive(Clone, Debug)]
enum Value {
    Number(f64),
    Place(DVec3),
    Shape(Tree),
    Points(Vec<[f64; 2]>),
}

/// An argument.
struct Argument {
    name: &'static str,
    kind: Kind,
    /// The default of a number. Places default to the origin.
    default: Option<f64>,
}

/// A shape or an operation.
struct Row {
    name: &'static str,
    arguments: &'static [Argument],
    /// A call that works, for messages.
    example: &'static str,
    build: fn(&Given) -> Result<Tree, String>,
}

/// The values of a call, one for each argument of the row.
struct Given(Vec<Value>);

impl Given {
    fn number(&self, at: usize) -> f64 {
        match self.0.get(at) {
            Some(Value::Number(number)) => *number,
            _ => f64::NAN,
        }
    }

    fn place(&self, at: usize) -> DVec3 {
        match self.0.get(at) {
            Some(Value::Place(place)) => *place,
            _ => DVec3::NAN,
        }
    }

    fn shape(&self, at: usize) -> Tree {
        match self.0.get(at) {
            Some(Value::Shape(tree)) => tree.clone(),
            _ => Tree::constant(f32::NAN),
        }
    }

    fn points(&self, at: usize) -> &[[f64; 2]] {
        match self.0.get(at) {
            Some(Value::Points(points)) => points,
            _ => &[],
        }
    }
}

/// Makes the shapes known to scripts.
pub(super) fn add_shapes(engine: &mut Engine) {
    for row in ROWS {
        for count in 1..=row.arguments.len() {
            // The values may be of any type: they tell which call is meant.
            let types = vec![TypeId::of::<Dynamic>(); count];
            engine.register_raw_fn(
                row.name,
                types,
                move |_: NativeCallContext, given: &mut [&mut Dynamic]| {
                    let given = given.iter().map(|d| (**d).clone()).collect();
                    call(row, given)
                },
            );
        }
    }
}

/// A call of a function of this folder that works, for messages.
pub(super) fn example(name: &str) -> Option<&'static str> {
    let row = ROWS.iter().find(|row| row.name == name);
    row.map(|row| row.example)
}

/// The names of all shapes and operations.
pub(super) fn names() -> impl Iterator<Item = &'static str> {
    ROWS.iter().map(|row| row.name)
}

fn call(row: &Row, mut given: Vec<Dynamic>) -> Outcome<Tree> {
    let wrong = |why: String| -> Outcome<Tree> {
        Err(
            format!("{}: {why}; write for example {}", row.name, row.example)
                .into(),
        )
    };
    let mut values: Vec<Option<Value>> = vec![None; row.arguments.len()];
    // Names come last: a shape may stand before them.
    let named = if given.last().is_some_and(Dynamic::is_map) {
        given.pop().and_then(Dynamic::try_cast::<Map>)
    } else {
        None
    };
    for (name, value) in named.unwrap_or_default() {
        let found = row.arguments.iter().position(|a| a.name == name.as_str());
        let Some(at) = found else {
            let all: Vec<_> = row.arguments.iter().map(|a| a.name).collect();
            return wrong(format!(
                "there is no {name:?}; there are {}",
                all.join(", ")
            ));
        };
        match read(row.arguments[at].kind, &value) {
            Some(value) => values[at] = Some(value),
            None => {
                return wrong(format!(
                    "{name} must be {}, not {}",
                    row.arguments[at].kind.wanted(),
                    describe(&value)
                ));
            }
        }
    }
    for value in &given {
        let free = row
            .arguments
            .iter()
            .zip(&values)
            .position(|(a, v)| v.is_none() && may_be(a.kind, value));
        let Some(at) = free else {
            return wrong(format!("it does not take {}", describe(value)));
        };
        let argument = &row.arguments[at];
        match read(argument.kind, value) {
            Some(value) => values[at] = Some(value),
            None => {
                return wrong(format!(
                    "{} must be {}, not {}",
                    argument.name,
                    argument.kind.wanted(),
                    describe(value)
                ));
            }
        }
    }
    let mut all = Vec::with_capacity(values.len());
    for (argument, value) in row.arguments.iter().zip(values) {
        all.push(match (value, argument.default, argument.kind) {
            (Some(value), ..) => value,
            (None, Some(number), Kind::Place) => {
                Value::Place(DVec3::splat(number))
            }
            (None, Some(number), _) => Value::Number(number),
            (None, None, _) => {
                return wrong(format!("{} is missing", argument.name));
            }
        });
    }
    (row.build)(&Given(all)).or_else(wrong)
}

/// True if a value without a name is of this kind, whether or not it is
/// allowed.
fn may_be(kind: Kind, value: &Dynamic) -> bool {
    let number = value.is_int() || value.is_float();
    match kind {
        Kind::Shape => !number && shape(value).is_some(),
        Kind::Place => place(value).is_some(),
        Kind::Points => value.is_array(),
        _ => number,
    }
}

fn read(kind: Kind, value: &Dynamic) -> Option<Value> {
    match kind {
        Kind::Shape => shape(value).map(Value::Shape),
        Kind::Place => place(value).map(Value::Place),
        Kind::Points => points(value).map(Value::Points),
        _ => number(value)
            .map(Value::Number)
            .filter(|v| match (kind, v) {
                (Kind::Positive, Value::Number(n)) => *n > 0.0,
                (Kind::Length, Value::Number(n)) => *n >= 0.0,
                _ => kind.is_number(),
            }),
    }
}

fn number(value: &Dynamic) -> Option<f64> {
    let number = match value.as_int() {
        Ok(whole) => whole as f64,
        Err(_) => value.as_float().ok()?,
    };
    // The field computes with f32.
    (number as f32).is_finite().then_some(number)
}

fn place(value: &Dynamic) -> Option<DVec3> {
    use fidget::shapes::types::{Vec2, Vec3};
    if let Some(v) = value.clone().try_cast::<Vec3>() {
        return Some(DVec3::new(v.x.into(), v.y.into(), v.z.into()));
    }
    if let Some(v) = value.clone().try_cast::<Vec2>() {
        return Some(DVec3::new(v.x.into(), v.y.into(), 0.0));
    }
    let list = value.clone().try_cast::<rhai::Array>()?;
    let numbers: Option<Vec<f64>> = list.iter().map(number).collect();
    match numbers?.as_slice() {
        [x, y] => Some(DVec3::new(*x, *y, 0.0)),
        [x, y, z] => Some(DVec3::new(*x, *y, *z)),
        _ => None,
    }
}

fn points(value: &Dynamic) -> Option<Vec<[f64; 2]>> {
    let list = value.clone().try_cast::<rhai::Array>()?;
    let all = list.iter().map(|p| place(p).map(|p| [p.x, p.y]));
    let all: Vec<_> = all.collect::<Option<_>>()?;
    (all.len() >= 3).then_some(all)
}
