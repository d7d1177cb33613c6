//! Shapes and operations: fidget's, and others.
//!
//! `cylinder(#{radius: 5, height: 20})` names its values; without names they
//! are told apart by what they are (a place, a number, a shape) and numbers
//! by their order: `cylinder(5, 20)`, `cylinder([0, 0, 10], 5, 20)`. What has
//! a default may be left out. An operation is also a method: `f.twist(40)`.
//! docs/shapes.md and docs/textures.md are the lists for users.
//!
//! Guaranteed: lengths that must be positive are positive, and numbers are
//! finite. Shapes whose row says `exact` are distances in mm.

mod convex;
mod curved;
mod fidgets;
mod flush;
mod patterns;
mod read;
mod rows;
#[cfg(test)]
mod tests;
mod textured;

use super::bodies::Bodies;
use super::limits::MOST_VALUES;
use super::shape::{Outcome, describe};
use fidget::context::Tree;
use fidget::shapes::types::{Axis, Plane};
use glam::DVec3;
use read::{may_be, read};
use rhai::{Dynamic, Engine, Map, NativeCallContext};
use std::any::TypeId;

/// What an argument is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum ArgumentKind {
    /// A length of more than 0, or another number of more than 0.
    Positive,
    /// The size of a pattern. f32 has the values of smaller and larger ones,
    /// but no longer of places in them.
    Size,
    /// A length that may be 0.
    Length,
    /// Any number.
    Number,
    /// A number from 0 to 1.
    Share,
    /// true or false, as 1 or 0.
    Flag,
    /// One of these words, as its index.
    Word(&'static [&'static str]),
    /// A place, or three lengths: `[x, y]` or `[x, y, z]`.
    Place,
    /// A place in the plane: `[x, y]`.
    Spot,
    /// Three numbers other than 0, of which the last may be left out.
    Factors,
    /// A direction: `"x"`, or a place.
    Axis,
    /// A plane: `"yz"`, or a direction.
    Plane,
    /// A shape, or an array of shapes.
    Shape,
    /// Any number of shapes.
    Shapes,
    /// Places in the plane: `[[x, y], …]`.
    Points,
}

impl ArgumentKind {
    fn wanted(self) -> String {
        let plain = match self {
            ArgumentKind::Word(words) => {
                let words = words.iter().map(|word| format!("{word:?}"));
                let words: Vec<_> = words.collect();
                return format!("one of {}", words.join(", "));
            }
            ArgumentKind::Share => "a number from 0 to 1",
            ArgumentKind::Flag => "true or false",
            ArgumentKind::Positive => "a number above 0",
            ArgumentKind::Size => "a size from 0.001 to 1000000 mm",
            ArgumentKind::Length => "a number of 0 or more",
            ArgumentKind::Number => "a number",
            ArgumentKind::Place => "a place such as [0, 0, 10]",
            ArgumentKind::Spot => "a place in the plane such as [0, 10]",
            ArgumentKind::Factors => {
                "three numbers such as [1, 1, 2], none of them 0 \
                 (f.scale_uniform(2) takes one)"
            }
            ArgumentKind::Axis => "an axis such as \"z\" or [1, 1, 0]",
            ArgumentKind::Plane => "a plane such as \"yz\" or [1, 0, 0]",
            ArgumentKind::Shape => "a shape",
            ArgumentKind::Shapes => "shapes",
            ArgumentKind::Points => {
                "three places or more, [[0, 0], [10, 0], [0, 5]]"
            }
        };
        plain.to_owned()
    }
}

/// A value that was given.
#[derive(Clone, Debug)]
enum Value {
    Number(f64),
    Place(DVec3),
    Axis(Axis),
    Plane(Plane),
    Shape(Tree),
    Shapes(Vec<Tree>),
    Points(Vec<[f64; 2]>),
}

/// An argument.
struct Argument {
    name: &'static str,
    kind: ArgumentKind,
    /// The default of a number, which is that of each coordinate of a place.
    /// Axes default to z and planes to yz, if there is a number here.
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

    fn shapes(&self, at: usize) -> Vec<Tree> {
        match self.0.get(at) {
            Some(Value::Shapes(all)) => all.clone(),
            _ => Vec::new(),
        }
    }

    fn axis(&self, at: usize) -> Axis {
        match self.0.get(at) {
            Some(Value::Axis(axis)) => *axis,
            _ => Axis::Z,
        }
    }

    fn plane(&self, at: usize) -> Plane {
        match self.0.get(at) {
            Some(Value::Plane(plane)) => *plane,
            _ => Plane::YZ,
        }
    }

    fn points(&self, at: usize) -> &[[f64; 2]] {
        match self.0.get(at) {
            Some(Value::Points(points)) => points,
            _ => &[],
        }
    }
}

/// Names that arguments had, and those that they have. `from` is a word of
/// Python's, which calls the same functions.
const FORMER: [(&str, &str); 2] = [("from", "start"), ("to", "end")];

/// All shapes and operations.
fn rows() -> impl Iterator<Item = &'static Row> {
    bodies().chain(patterns::ROWS)
}

/// Those that make bodies.
fn bodies() -> impl Iterator<Item = &'static Row> {
    fidgets::ROWS.iter().chain(rows::ROWS).chain(textured::ROWS)
}

/// Makes the shapes known to scripts.
pub(super) fn add_shapes(engine: &mut Engine, bodies: &Bodies) {
    for row in rows() {
        let many = row.arguments.iter().any(|a| a.kind == ArgumentKind::Shapes);
        let most = if many {
            MOST_VALUES
        } else {
            row.arguments.len()
        };
        let least =
            usize::from(row.arguments.iter().any(|a| a.default.is_none()));
        for count in least..=most {
            // The values may be of any type: they tell which call is meant.
            let types = vec![TypeId::of::<Dynamic>(); count];
            let bodies = bodies.clone();
            engine.register_raw_fn(
                row.name,
                types,
                move |_: NativeCallContext, given: &mut [&mut Dynamic]| {
                    let given = given.iter().map(|d| (**d).clone()).collect();
                    let made = row.call(given).map_err(|why| {
                        format!(
                            "{}: {why}; write for example {}",
                            row.name, row.example
                        )
                    })?;
                    Outcome::Ok(if makes_body(row.name, false) {
                        bodies.mark(made)
                    } else {
                        made
                    })
                },
            );
        }
    }
}

/// A call of a function of this folder that works, for messages.
pub(super) fn example(name: &str) -> Option<&'static str> {
    let row = rows().find(|row| row.name == name);
    row.map(|row| row.example)
}

/// True if what a function makes is a body, and no field to calculate with: that
/// of shapes and of operations on shapes, and the least and the greatest `of_bodies`
/// alone.
pub fn makes_body(name: &str, of_bodies: bool) -> bool {
    let chosen = of_bodies && matches!(name, "min" | "max");
    chosen || bodies().any(|row| row.name == name)
}

/// A call with an array, if this is an operation on any number of shapes.
pub(super) fn of_array(name: &str) -> Option<String> {
    let row = rows().find(|row| row.name == name)?;
    let many = row
        .arguments
        .iter()
        .position(|a| a.kind == ArgumentKind::Shapes)?;
    Some(match many {
        0 => format!("{name}([a, b])"),
        _ => format!("{name}(a, [b, c])"),
    })
}

/// The names of all shapes and operations.
pub(super) fn names() -> impl Iterator<Item = &'static str> {
    rows().map(|row| row.name)
}

impl Row {
    /// The shape, or what is wrong with the values.
    fn call(&self, mut given: Vec<Dynamic>) -> Result<Tree, String> {
        let mut values: Vec<Option<Value>> = vec![None; self.arguments.len()];
        // Names come last: a shape may stand before them.
        if given.last().is_some_and(Dynamic::is_map)
            && let Some(named) = given.pop().and_then(Dynamic::try_cast::<Map>)
        {
            self.take_named(named, &mut values)?;
        }
        for value in &given {
            self.take(value, &mut values)?;
        }
        let filled = self.arguments.iter().zip(values);
        let filled = filled.map(|(argument, value)| {
            value
                .or_else(|| argument.default_value())
                .ok_or_else(|| format!("{} is missing", argument.name))
        });
        (self.build)(&Given(filled.collect::<Result<_, _>>()?))
    }

    fn take_named(
        &self,
        named: Map,
        values: &mut [Option<Value>],
    ) -> Result<(), String> {
        for (name, given) in named {
            let known =
                |name: &str| self.arguments.iter().position(|a| a.name == name);
            let other = FORMER.iter().find(|(former, _)| *former == name);
            let at = known(&name).or_else(|| known(other?.1));
            let pair = at.and_then(|at| {
                Some((self.arguments.get(at)?, values.get_mut(at)?))
            });
            let Some((argument, value)) = pair else {
                let all: Vec<_> =
                    self.arguments.iter().map(|a| a.name).collect();
                return Err(format!(
                    "there is no \"{name}\"; there are {}",
                    all.join(", ")
                ));
            };
            if value.is_some() {
                return Err(format!("{} is given twice", argument.name));
            }
            *value = Some(argument.read(&given)?);
        }
        Ok(())
    }

    /// Takes a value without a name: by its kind, and among equal kinds in
    /// order.
    fn take(
        &self,
        given: &Dynamic,
        values: &mut [Option<Value>],
    ) -> Result<(), String> {
        let mut all = self.arguments.iter().zip(values);
        let free = all.find(|(argument, value)| {
            let free = value.is_none() || argument.kind == ArgumentKind::Shapes;
            free && may_be(argument.kind, given)
        });
        let Some((argument, value)) = free else {
            return Err(format!("it does not take {}", describe(given)));
        };
        match (value.as_mut(), argument.read(given)?) {
            (Some(Value::Shapes(all)), Value::Shapes(more)) => all.extend(more),
            (_, read) => *value = Some(read),
        }
        Ok(())
    }
}

impl Argument {
    fn read(&self, given: &Dynamic) -> Result<Value, String> {
        read(self.kind, given).ok_or_else(|| {
            format!(
                "{} must be {}, not {}",
                self.name,
                self.kind.wanted(),
                describe(given)
            )
        })
    }

    fn default_value(&self) -> Option<Value> {
        let number = self.default?;
        Some(match self.kind {
            ArgumentKind::Place | ArgumentKind::Spot => {
                Value::Place(DVec3::splat(number))
            }
            ArgumentKind::Shape => Value::Shape(Tree::constant(number as f32)),
            ArgumentKind::Axis => Value::Axis(Axis::Z),
            ArgumentKind::Plane => Value::Plane(Plane::YZ),
            _ => Value::Number(number),
        })
    }
}
