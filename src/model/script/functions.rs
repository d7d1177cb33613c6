//! The functions that scripts have beside fidget's shapes: powers, `draw`,
//! `param`.

use super::shape::{Outcome, describe, shape};
use crate::model::allowed::Said;
use crate::model::param::{ParamError, Table};
use crate::model::power::{power, power_of};
use crate::model::value::Value;
use fidget::context::Tree;
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

/// `**` and `pow` of fields; `^` is refused.
pub(super) fn add_powers(engine: &mut Engine) {
    for name in ["**", "pow"] {
        engine
            .register_fn(name, |a: Tree, b: i64| power(&a, b as f64))
            .register_fn(name, |a: Tree, b: f64| power(&a, b))
            .register_fn(name, |a: Tree, b: Tree| power_of(&a, &b))
            .register_fn(name, |a: f64, b: Tree| {
                power_of(&Tree::constant(a as f32), &b)
            })
            .register_fn(name, |a: i64, b: Tree| {
                power_of(&Tree::constant(a as f32), &b)
            });
    }
    engine
        .register_fn("^", not_a_power::<Tree, i64>)
        .register_fn("^", not_a_power::<Tree, f64>)
        .register_fn("^", not_a_power::<Tree, Tree>)
        .register_fn("^", not_a_power::<f64, Tree>)
        .register_fn("^", not_a_power::<i64, Tree>);
}

fn not_a_power<A, B>(_: A, _: B) -> Outcome<Tree> {
    const REMEDY: &str = "`^` is not a power in scripts (it would bind \
                          weaker than `+`): write x ** 2 or square(x)";
    Err(REMEDY.into())
}

/// Comparisons of fields, which are refused, since a script runs once, before
/// any place is known.
pub(super) fn add_comparisons(engine: &mut Engine) {
    fn refused<A, B>(_: A, _: B) -> Outcome<bool> {
        const REMEDY: &str = "a field cannot be compared: the script runs \
            once, and x, y and z have no values yet. Write what `if` would \
            do as a field: max(f, g) is where both are, min(f, g) where \
            either is, max(f, -x) is f where x > 0, and compare(x, 0) is -1, \
            0 or 1";
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
