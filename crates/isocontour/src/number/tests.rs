//! Expressions that use every operation.

use fidget::context::Tree;

/// Every operation fidget has, with registers and with constants.
pub(crate) fn everything() -> Vec<Tree> {
    let (x, y, z) = Tree::axes();
    let c = |v: f32| Tree::constant(v);
    vec![
        x.neg() + y.abs() * z.clone(),
        (x.clone() + 5.0).recip() - (y.clone() * 0.25 + 3.0).sqrt(),
        x.square().floor() + y.ceil() - z.round(),
        x.sin() * y.cos() + (z.clone() * 0.2).tan(),
        (x.clone() * 0.2).asin() + (y.clone() * 0.2).acos() - z.atan(),
        x.exp() - (y.clone() + 4.0).ln() / (z.clone() + 7.0),
        (c(3.0) - x.clone()) / 2.0 + c(1.0) / (y.clone() + 8.0),
        x.atan2(y.clone()) + x.atan2(2.0) + c(2.0).atan2(y.clone()),
        x.modulo(2.0) + c(5.0).modulo(y.clone() + 6.0),
        (x.clone() + 4.0).modulo(y.clone() + 5.0),
        x.compare(y.clone()) + x.compare(0.5) + c(0.5).compare(z.clone()),
        x.min(y.clone()).min(0.3).max(z.clone() - 2.0).max(-0.5),
        x.floor().and(y.clone()) + y.floor().and(2.0),
        x.floor().or(y.clone()) + y.floor().or(2.0) + (x.floor()).not(),
        x.rand() + x.mix(y.clone()).and(1.0),
    ]
}
