//! Fields as plain values, which Python's pickle can write and read.
//!
//! In: a field. Out: one step for each operation, which names the steps before
//! it that it works on; the last one is the field. An operation that is used
//! twice is one step, so the field that is read again is the very same
//! expression, and leads to the same bytes.
//!
//! Guaranteed: anything that is no such list of steps leads to an exception.
//! Not guaranteed: that another version of isoslice reads the steps.

use crate::operation::{binary_of, name_of, unary_of};
use fidget::context::{Tree, TreeOp};
use fidget::var::Var;
use isocontour::operands;
use nalgebra::{Affine3, Matrix4};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use std::collections::HashMap;

/// An operation: its name, the numbers of the steps that it works on, and its
/// own numbers.
pub(crate) type Step = (String, Vec<usize>, Vec<f32>);

const AXES: [(&str, Var); 3] = [("x", Var::X), ("y", Var::Y), ("z", Var::Z)];

/// The steps of a field.
pub(crate) fn steps(tree: &Tree) -> PyResult<Vec<Step>> {
    let mut steps = Vec::new();
    let mut done: HashMap<*const TreeOp, usize> = HashMap::new();
    // Expressions may be too deep for recursion.
    let mut open: Vec<&TreeOp> = vec![tree];
    while let Some(op) = open.last().copied() {
        if done.contains_key(&std::ptr::from_ref(op)) {
            open.pop();
            continue;
        }
        let number = |of: &&TreeOp| done.get(&std::ptr::from_ref(*of)).copied();
        let of: Vec<&TreeOp> = operands(op).collect();
        let known: Vec<usize> = of.iter().filter_map(number).collect();
        if known.len() < of.len() {
            open.extend(of.iter().filter(|of| number(of).is_none()));
            continue;
        }
        let (name, numbers) = word(op)?;
        done.insert(std::ptr::from_ref(op), steps.len());
        steps.push((name, known, numbers));
        open.pop();
    }
    Ok(steps)
}

/// The name of an operation, and its numbers.
fn word(op: &TreeOp) -> PyResult<(String, Vec<f32>)> {
    let (name, numbers) = match op {
        TreeOp::Input(var) => {
            let axis = AXES.iter().find(|axis| axis.1 == *var);
            let axis = axis.ok_or_else(|| {
                PyValueError::new_err(
                    "a field of other variables than x, y and z cannot be \
                     pickled",
                )
            })?;
            (axis.0.to_owned(), Vec::new())
        }
        TreeOp::Const(value) => ("const".to_owned(), vec![*value]),
        TreeOp::Unary(op, _) => (name_of(op), Vec::new()),
        TreeOp::Binary(op, ..) => (name_of(op), Vec::new()),
        TreeOp::RemapAxes { .. } => ("remap".to_owned(), Vec::new()),
        TreeOp::RemapAffine { mat, .. } => {
            ("affine".to_owned(), mat.matrix().iter().copied().collect())
        }
    };
    Ok((name, numbers))
}

/// The field of some steps.
pub(crate) fn tree(steps: &[Step]) -> PyResult<Tree> {
    let mut trees: Vec<Tree> = Vec::with_capacity(steps.len());
    for (name, of, numbers) in steps {
        // Only steps that came before are known.
        let known = of.iter().map(|&i| trees.get(i).cloned());
        let known: Option<Vec<Tree>> = known.collect();
        let made = known.and_then(|known| made(name, &known, numbers));
        let made = made.ok_or_else(|| {
            PyValueError::new_err(format!(
                "no field of this version of isoslice: step {}, {name:?}, has \
                 {} operands and {} numbers",
                trees.len(),
                of.len(),
                numbers.len()
            ))
        })?;
        trees.push(made);
    }
    trees
        .pop()
        .ok_or_else(|| PyValueError::new_err("a field has at least one step"))
}

/// An operation on fields; nothing if there is none of this name that takes so
/// many.
fn made(name: &str, of: &[Tree], numbers: &[f32]) -> Option<Tree> {
    match (name, of, numbers) {
        ("const", [], [value]) => Some(Tree::constant(*value)),
        ("remap", [target, x, y, z], []) => {
            Some(target.remap_xyz(x.clone(), y.clone(), z.clone()))
        }
        // Column by column: the last row is that of an affine map.
        ("affine", [target], [.., a, _, _, _, b, _, _, _, c, _, _, _, d])
            if numbers.len() == 16
                && [*a, *b, *c, *d] == [0.0, 0.0, 0.0, 1.0] =>
        {
            let matrix = Matrix4::from_iterator(numbers.iter().copied());
            Some(target.remap_affine(Affine3::from_matrix_unchecked(matrix)))
        }
        (_, [], []) => {
            let axis = AXES.iter().find(|axis| axis.0 == name)?;
            Some(Tree::from(axis.1))
        }
        (_, [a], []) => unary_of(name, a),
        (_, [a, b], []) => binary_of(name, a, b),
        _ => None,
    }
}
