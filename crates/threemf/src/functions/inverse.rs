//! The inverse of a matrix of expressions.

use super::value::{constant, number};
use fidget::context::Tree;
use glam::DMat4;

/// The inverse of a matrix, row by row.
pub(super) fn inverse(m: &[Tree]) -> Vec<Tree> {
    let numbers: Option<Vec<f64>> = m.iter().map(constant).collect();
    if let Some(Ok(numbers)) = numbers.map(<[f64; 16]>::try_from) {
        // The inverse of what stands in columns stands in columns.
        let inverse = DMat4::from_cols_array(&numbers).inverse();
        return inverse.to_cols_array().into_iter().map(number).collect();
    }
    let cofactors: Vec<Tree> = (0..16).map(|i| cofactor(m, i)).collect();
    let det = (0..4)
        .map(|c| m[c].clone() * cofactors[c].clone())
        .reduce(|a, b| a + b)
        .unwrap_or_else(|| number(0.0));
    (0..16)
        .map(|i| cofactors[4 * (i % 4) + i / 4].clone() / det.clone())
        .collect()
}

/// The determinant of what is left without the row and the column of an element,
/// with its sign.
fn cofactor(m: &[Tree], i: usize) -> Tree {
    let others = |of: usize| (0..4).filter(move |k| *k != of);
    let rest: Vec<Tree> = others(i / 4)
        .flat_map(|r| others(i % 4).map(move |c| m[4 * r + c].clone()))
        .collect();
    let at = |r: usize, c: usize| rest[3 * r + c % 3].clone();
    let det = (0..3)
        .map(|c| {
            let minor =
                at(1, c + 1) * at(2, c + 2) - at(1, c + 2) * at(2, c + 1);
            at(0, c) * minor
        })
        .reduce(|a, b| a + b)
        .unwrap_or_else(|| number(0.0));
    if (i / 4 + i % 4).is_multiple_of(2) {
        det
    } else {
        -det
    }
}
