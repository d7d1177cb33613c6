//! The functions of `functions`, and the constants, as scripts call them.

use super::bodies::Bodies;
use super::limits::MOST_VALUES;
use super::shape::{Outcome, components, describe, term, value};
use super::shapes::makes_body;
use crate::functions::{FUNCTIONS, Function, constant};
use crate::term::Term;
use fidget::context::Tree;
use rhai::{Dynamic, Engine};
use std::any::TypeId;

/// Makes functions, constants and coordinates known to scripts.
pub(super) fn add_names(engine: &mut Engine, bodies: &Bodies) {
    for function in FUNCTIONS {
        let (least, most) = function.takes;
        for count in least..=most.min(MOST_VALUES) {
            for types in types(count) {
                let bodies = bodies.clone();
                engine.register_raw_fn(
                    function.name,
                    types,
                    move |_, given| called(function, given, &bodies),
                );
            }
        }
    }
    #[allow(deprecated, reason = "not deprecated, but rhai may change it")]
    engine.on_var(|name, _, context| {
        if context.scope().contains(name) {
            return Ok(None);
        }
        Ok(match name {
            "x" => Some(Dynamic::from(Tree::x())),
            "y" => Some(Dynamic::from(Tree::y())),
            "z" => Some(Dynamic::from(Tree::z())),
            _ => constant(name).map(Dynamic::from),
        })
    });
}

/// The types that a call of so many values may have: any, and numbers, for
/// which rhai has functions of its own that would come first.
fn types(count: usize) -> Vec<Vec<TypeId>> {
    let (whole, number) = (TypeId::of::<i64>(), TypeId::of::<f64>());
    let mut all = vec![vec![TypeId::of::<Dynamic>(); count]];
    match count {
        1 => all.extend([vec![whole], vec![number]]),
        2 => all.extend(
            [whole, number]
                .into_iter()
                .flat_map(|a| [whole, number].map(|b| vec![a, b])),
        ),
        _ => {}
    }
    all
}

fn called(
    function: &Function,
    given: &mut [&mut Dynamic],
    bodies: &Bodies,
) -> Outcome<Dynamic> {
    let given: Vec<Dynamic> = given.iter().map(|v| (**v).clone()).collect();
    // The length of a place is that of its coordinates.
    let list = match &given[..] {
        [only] if function.takes.1 > 1 => components(only),
        _ => None,
    };
    let given = list.unwrap_or(given);
    let mut terms = Vec::with_capacity(given.len());
    for value in &given {
        terms.push(term(value).ok_or_else(|| {
            format!(
                "{} does not take {}; write for example {}",
                function.name,
                describe(value),
                function.example
            )
        })?);
    }
    let of_bodies = terms.iter().all(|term| match term {
        Term::Field(tree) => bodies.has(tree),
        Term::Number(_) => false,
    });
    let of_whole = given.iter().all(Dynamic::is_int);
    let result = function.apply(&terms)?;
    Ok(match result {
        Term::Field(tree) if makes_body(function.name, of_bodies) => {
            Dynamic::from(bodies.mark(tree))
        }
        result => value(result, |v| function.whole(v, of_whole)),
    })
}
