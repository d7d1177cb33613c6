//! The functions that scripts have beside shapes and arithmetic: `draw`,
//! `param`, `remap`, places.

use super::bodies::Bodies;
use super::shape::{Outcome, describe, number, shape, term};
use crate::allowed::Said;
use crate::data::{Files, Given, KINDS, Options};
use crate::param::{ParamError, Table};
use crate::term::Term;
use crate::value::Value;
use fidget::context::Tree;
use fidget::shapes::types::{Vec2, Vec3};
use rhai::{Dynamic, Engine, ImmutableString, Map};
use std::sync::{Arc, Mutex, PoisonError};

/// What a script hands out while it runs.
#[derive(Default)]
pub(super) struct Shared {
    /// What was passed to `draw`.
    pub drawn: Vec<Tree>,
    /// What was passed to `param`.
    pub parameters: Table,
    /// What was wrong with a parameter. rhai itself keeps only the error's
    /// text.
    pub error: Option<ParamError>,
}

/// `draw(shape)`, which also takes an array of shapes.
pub(super) fn add_draw(engine: &mut Engine, shared: &Arc<Mutex<Shared>>) {
    /// Greatest number of shapes drawn, so that a `draw` in an endless loop
    /// stays small.
    const MAX_DRAWN: usize = 100_000;
    let shared = shared.clone();
    engine.register_fn("draw", move |value: Dynamic| -> Outcome<()> {
        let Some(tree) = shape(&value) else {
            return Err(format!(
                "draw() takes a shape or an array of shapes, not {}",
                describe(&value)
            )
            .into());
        };
        let mut state = shared.lock().unwrap_or_else(PoisonError::into_inner);
        if state.drawn.len() >= MAX_DRAWN {
            return Err(format!(
                "draw() was called more than {MAX_DRAWN} times"
            )
            .into());
        }
        state.drawn.push(tree);
        Ok(())
    });
}

/// `param(name, default)`, which also takes a description, and bounds.
pub(super) fn add_param(engine: &mut Engine, shared: &Arc<Mutex<Shared>>) {
    type Text = ImmutableString;
    let shared = shared.clone();
    let declare = move |name: &str,
                        default: &Dynamic,
                        text: &str,
                        bounds: Map|
          -> Outcome<Dynamic> {
        let Some(default) = value(default) else {
            return Err(format!(
                "the default of the parameter `{name}` must be a number, \
                 true or false, not {}",
                describe(default)
            )
            .into());
        };
        let bounds = said(name, bounds)?;
        let mut state = shared.lock().unwrap_or_else(PoisonError::into_inner);
        match state.parameters.declare(name, default, text, &bounds) {
            Ok(Value::Int(v)) => Ok(v.into()),
            Ok(Value::Float(v)) => Ok(v.into()),
            Ok(Value::Bool(v)) => Ok(v.into()),
            Err(error) => {
                let message = error.to_string();
                state.error = Some(error);
                Err(message.into())
            }
        }
    };
    let (plain, with_text) = (declare.clone(), declare.clone());
    let with_bounds = declare.clone();
    engine
        .register_fn("param", move |name: Text, default: Dynamic| {
            plain(&name, &default, "", Map::new())
        })
        .register_fn(
            "param",
            move |name: Text, default: Dynamic, text: Text| {
                with_text(&name, &default, &text, Map::new())
            },
        )
        .register_fn(
            "param",
            move |name: Text, default: Dynamic, bounds: Map| {
                with_bounds(&name, &default, "", bounds)
            },
        )
        .register_fn(
            "param",
            move |name: Text, default: Dynamic, text: Text, bounds: Map| {
                declare(&name, &default, &text, bounds)
            },
        );
    // The likeliest mistakes in calls of `param` get plain messages.
    engine.register_fn("param", |_: Text| -> Outcome<Dynamic> {
        Err("param() needs a default: param(\"name\", 10.0, \
                 \"description\")"
            .into())
    });
}

/// `mesh`, `svg`, `text`, `image` and others, which read files beside the
/// script. A text and perhaps options are their values.
pub(super) fn add_data(
    engine: &mut Engine,
    files: &Arc<Files>,
    bodies: &Bodies,
) {
    type Text = ImmutableString;
    for kind in KINDS {
        let (files, bodies) = (files.clone(), bodies.clone());
        let made = move |text: &str, options: Map| -> Outcome<Tree> {
            let mut read = Options::new();
            for (name, value) in options {
                let given = given(&value).ok_or_else(|| {
                    format!(
                        "{}: {name} is {}; options are numbers, texts, and \
                         lists of them",
                        kind.name,
                        describe(&value)
                    )
                })?;
                read.insert(name.into(), given);
            }
            let tree = files.call(kind, text, &read)?;
            Ok(if kind.is_body {
                bodies.mark(tree)
            } else {
                tree
            })
        };
        let plain = made.clone();
        engine
            .register_fn(kind.name, move |text: Text| plain(&text, Map::new()))
            .register_fn(kind.name, move |text: Text, options: Map| {
                made(&text, options)
            })
            .register_fn(
                kind.name,
                |_: Text, other: Dynamic| -> Outcome<Tree> {
                    Err(format!(
                        "{}: options are a map, as in #{{width: 60}}, not {}",
                        kind.name,
                        describe(&other)
                    )
                    .into())
                },
            )
            .register_fn(kind.name, |other: Dynamic| -> Outcome<Tree> {
                let (other, example) = (describe(&other), kind.example);
                let what = if kind.of_file {
                    "a file's name"
                } else {
                    "a text"
                };
                Err(format!(
                    "{} takes {what}, as in {example}, not {other}",
                    kind.name
                )
                .into())
            });
    }
}

/// An option's value.
fn given(value: &Dynamic) -> Option<Given> {
    if let Some(v) = number(value) {
        return Some(Given::Number(v));
    }
    if let Ok(text) = value.clone().into_immutable_string() {
        return Some(Given::Text(text.into()));
    }
    let all = value.as_array_ref().ok()?;
    all.iter()
        .map(given)
        .collect::<Option<_>>()
        .map(Given::List)
}

/// `axes`, `remap`, and the places of fidget.
pub(super) fn add_places(engine: &mut Engine) {
    fidget::rhai::types::register(engine);
    engine
        .register_type_with_name::<Tree>("Tree")
        .register_fn("to_string", |_: &mut Tree| "a shape".to_owned())
        .register_fn("axes", || {
            let (x, y, z) = Tree::axes();
            let all = [("x", x), ("y", y), ("z", z)];
            let all =
                all.map(|(name, tree)| (name.into(), Dynamic::from(tree)));
            all.into_iter().collect::<Map>()
        })
        .register_fn("remap", |f: Dynamic, x: Dynamic, y: Dynamic| {
            remapped(&f, [&x, &y, &Dynamic::from(Tree::z())])
        })
        .register_fn(
            "remap",
            |f: Dynamic, x: Dynamic, y: Dynamic, z: Dynamic| {
                remapped(&f, [&x, &y, &z])
            },
        )
        .register_fn("vec2", |x: Dynamic, y: Dynamic| {
            let [x, y] = coordinates("vec2", [&x, &y])?;
            Outcome::Ok(Vec2 { x, y })
        })
        .register_fn("vec3", |x: Dynamic, y: Dynamic, z: Dynamic| {
            let [x, y, z] = coordinates("vec3", [&x, &y, &z])?;
            Outcome::Ok(Vec3 { x, y, z })
        });
}

fn remapped(f: &Dynamic, to: [&Dynamic; 3]) -> Outcome<Tree> {
    const HOW: &str = "write for example f.remap(x, y, z / 2)";
    let f = shape(f).ok_or_else(|| {
        format!("remap needs a shape, not {}; {HOW}", describe(f))
    })?;
    let field = |v: &Dynamic| {
        term(v).map(Term::tree).ok_or_else(|| {
            format!("remap does not take {}; {HOW}", describe(v))
        })
    };
    let [x, y, z] = to;
    Ok(f.remap_xyz(field(x)?, field(y)?, field(z)?))
}

/// The coordinates of a place.
fn coordinates<const N: usize>(
    name: &str,
    given: [&Dynamic; N],
) -> Outcome<[f32; N]> {
    let mut all = [0.0; N];
    for (to, from) in all.iter_mut().zip(given) {
        *to = number(from).ok_or_else(|| {
            let field = shape(from).map_or("", |_| {
                ", as x, y and z are; length(x, y, z) is the distance from \
                 the origin"
            });
            format!(
                "{name} takes numbers, as in {name}({}), not {}{field}",
                ["1", "2", "3"][..N.min(3)].join(", "),
                describe(from)
            )
        })? as f32;
    }
    Ok(all)
}

/// A number, or true or false.
fn value(given: &Dynamic) -> Option<Value> {
    let int = given.as_int().map(Value::Int);
    let float = || given.as_float().map(Value::Float);
    int.or_else(|_| float())
        .or_else(|_| given.as_bool().map(Value::Bool))
        .ok()
}

/// The bounds of a parameter, in the order of their names.
fn said(parameter: &str, bounds: Map) -> Outcome<Vec<(String, Said)>> {
    let one = |(name, given): (String, Dynamic)| {
        let found = match given.as_array_ref() {
            Ok(array) => array
                .iter()
                .map(value)
                .collect::<Option<_>>()
                .map(Said::Many),
            Err(_) => value(&given).map(Said::One),
        };
        let refused = || {
            format!(
                "the parameter `{parameter}`: {name} must be a number, and \
                 choices an array of numbers"
            )
        };
        let found = found.ok_or_else(refused)?;
        Ok((name, found))
    };
    bounds
        .into_iter()
        .map(|(name, given)| (name.to_string(), given))
        .map(one)
        .collect()
}
