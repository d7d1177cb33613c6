//! Transforms, as files write them.

use crate::xml::Element;
use glam::DAffine3;
use isoslice_mesh::MeshError;

/// The transform of an element, if it has one. `wrong` says that it cannot be read.
pub(crate) fn transform(
    element: &Element,
    wrong: &str,
) -> Result<DAffine3, MeshError> {
    match element.text("transform")? {
        None => Ok(DAffine3::IDENTITY),
        Some(text) => of_text(&text).ok_or_else(|| element.wrong(wrong)),
    }
}

/// Twelve numbers: where the axes go, and where the origin goes.
fn of_text(text: &str) -> Option<DAffine3> {
    let numbers: Vec<f64> = text
        .split_whitespace()
        .map(|word| word.parse().ok().filter(|x: &f64| x.is_finite()))
        .collect::<Option<_>>()?;
    let numbers: [f64; 12] = numbers.try_into().ok()?;
    Some(DAffine3::from_cols_array(&numbers))
}
