//! Transforms, as files write them.

use glam::{DAffine3, DMat3, DVec3};

/// Twelve numbers: where the axes go, and where the origin goes.
pub(crate) fn transform(text: &str) -> Option<DAffine3> {
    let numbers: Vec<f64> = text
        .split_whitespace()
        .map(|word| word.parse().ok().filter(|x: &f64| x.is_finite()))
        .collect::<Option<_>>()?;
    let [a, b, c, d, e, f, g, h, i, x, y, z] = numbers.try_into().ok()?;
    Some(DAffine3 {
        matrix3: DMat3::from_cols(
            DVec3::new(a, b, c),
            DVec3::new(d, e, f),
            DVec3::new(g, h, i),
        ),
        translation: DVec3::new(x, y, z),
    })
}
