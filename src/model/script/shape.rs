//! The shapes among a script's values, and what functions return to scripts.

use fidget::context::Tree;
use rhai::{Dynamic, EvalAltResult};

/// What a function that scripts call returns.
pub(super) type Outcome<T> = Result<T, Box<EvalAltResult>>;

/// The least of all fields, as a balanced tree, since a chain of 10,000 bodies
/// would be a deep tree.
pub(super) fn union(mut trees: Vec<Tree>) -> Option<Tree> {
    while trees.len() > 1 {
        trees = trees
            .chunks(2)
            .map(|pair| match pair {
                [a, b] => a.min(b.clone()),
                _ => pair[0].clone(),
            })
            .collect();
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

/// A value as the user knows it.
pub(super) fn describe(value: &Dynamic) -> String {
    if value.is_unit() {
        "nothing".to_owned()
    } else if let Ok(v) = value.as_int() {
        format!("the number {v}")
    } else if let Ok(v) = value.as_float() {
        format!("the number {v}")
    } else if value.is_array() {
        "an array that does not hold shapes only".to_owned()
    } else {
        format!("a {}", value.type_name())
    }
}
