//! The shapes among a script's values, and what functions return to scripts.

use crate::term::Term;
use fidget::context::Tree;
use fidget::shapes::types::{Vec2, Vec3};
use isoslice_base::units::human_number;
use rhai::{Dynamic, EvalAltResult};

/// What a function that scripts call returns.
pub(super) type Outcome<T> = Result<T, Box<EvalAltResult>>;

/// The least of all fields, as a balanced tree, since a chain of 10,000 bodies
/// would be a deep tree.
pub(crate) fn union(mut trees: Vec<Tree>) -> Option<Tree> {
    while trees.len() > 1 {
        let pairs = trees.chunks(2).map(|pair| match pair {
            [a, b] => a.min(b.clone()),
            _ => pair[0].clone(),
        });
        trees = pairs.collect();
    }
    trees.pop()
}

/// A shape, or the union of an array of shapes.
pub(super) fn shape(value: &Dynamic) -> Option<Tree> {
    if let Some(tree) = value.clone().try_cast::<Tree>() {
        return Some(tree);
    }
    let mut trees = Vec::new();
    // The arrays are walked on an own stack, since they may nest to any depth.
    let mut todo = vec![value.clone()];
    while let Some(value) = todo.pop() {
        if let Some(tree) = value.clone().try_cast::<Tree>() {
            trees.push(tree);
        } else {
            todo.extend(value.try_cast::<rhai::Array>()?.into_iter().rev());
        }
    }
    union(trees)
}

/// A finite number.
pub(super) fn number(value: &Dynamic) -> Option<f64> {
    let number = match value.as_int() {
        Ok(whole) => whole as f64,
        Err(_) => value.as_float().ok()?,
    };
    // Fields compute with f32.
    (number as f32).is_finite().then_some(number)
}

/// A number, a shape, or an array of shapes, to calculate with.
pub(super) fn term(value: &Dynamic) -> Option<Term> {
    if let Ok(whole) = value.as_int() {
        return Some(Term::Number(whole as f64));
    }
    let number = value.as_float().ok().map(Term::Number);
    number.or_else(|| shape(value).map(Term::Field))
}

/// What a script gets. `whole` tells which numbers are whole numbers.
pub(super) fn value(term: Term, whole: impl Fn(f64) -> Option<i64>) -> Dynamic {
    match term {
        Term::Field(tree) => Dynamic::from(tree),
        Term::Number(v) => whole(v).map_or_else(|| v.into(), Dynamic::from),
    }
}

/// The coordinates of a place, which may be fields.
pub(super) fn components(value: &Dynamic) -> Option<Vec<Dynamic>> {
    let all = |all: &[f32]| all.iter().map(|&v| f64::from(v).into()).collect();
    if let Some(v) = value.clone().try_cast::<Vec2>() {
        return Some(all(&[v.x, v.y]));
    }
    if let Some(v) = value.clone().try_cast::<Vec3>() {
        return Some(all(&[v.x, v.y, v.z]));
    }
    let list = value.as_array_ref().ok()?;
    (!list.is_empty()).then(|| list.to_vec())
}

/// A value as the user knows it.
pub(super) fn describe(value: &Dynamic) -> String {
    if value.is_unit() {
        "nothing".to_owned()
    } else if let Ok(v) = value.as_int() {
        format!("the number {v}")
    } else if let Ok(v) = value.as_float() {
        format!("the number {}", human_number(v))
    } else if value.is::<Tree>() {
        "a shape".to_owned()
    } else if value.is_array() {
        match components(value).as_deref() {
            Some(all)
                if all.len() < 4 && all.iter().all(|v| number(v).is_some()) =>
            {
                let all: Vec<_> = all.iter().map(Dynamic::to_string).collect();
                format!("[{}]", all.join(", "))
            }
            _ => "an array that does not hold shapes only".to_owned(),
        }
    } else if value.is_map() {
        "a map".to_owned()
    } else if value.is_bool() {
        format!("{value}")
    } else if value.is::<rhai::FnPtr>() {
        "a function, as |z| makes one (the absolute value is abs(z))".to_owned()
    } else {
        format!("a {}", value.type_name())
    }
}
