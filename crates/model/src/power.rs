//! Powers of fields with the cheapest exact operations.

use fidget::context::Tree;

/// Largest whole exponent that is multiplied out. Above it, and for exponents
/// that are not whole, the power is exp(b·ln a), which is NaN for negative
/// bases.
const MAX_MULTIPLIED: f64 = 1024.0;

/// `base` to the power of a constant.
///
/// Whole exponents are repeated multiplications and work for negative bases.
/// Halves (0.5, 1.5, -0.5) use the square root.
pub(super) fn power(base: &Tree, exponent: f64) -> Tree {
    let whole = exponent.trunc();
    let rest = exponent - whole;
    if whole.abs() > MAX_MULTIPLIED || !exponent.is_finite() {
        return power_of(base, &Tree::constant(exponent as f32));
    }
    if rest == 0.0 {
        return base.pow(whole as i64);
    }
    if rest.abs() == 0.5 {
        let root = base.sqrt();
        let root = if rest < 0.0 { root.recip() } else { root };
        return if whole == 0.0 {
            root
        } else {
            base.pow(whole as i64) * root
        };
    }
    power_of(base, &Tree::constant(exponent as f32))
}

/// `base` to the power of a field: exp(b·ln a).
pub(super) fn power_of(base: &Tree, exponent: &Tree) -> Tree {
    (base.ln() * exponent.clone()).exp()
}

#[cfg(test)]
mod tests {
    use super::*;
    use fidget::context::Context;

    #[test]
    fn powers_of_a_number() {
        for (base, exponent) in [
            (3.0f64, 2.0f64),
            (3.0, 0.0),
            (3.0, -2.0),
            (4.0, 0.5),
            (4.0, -0.5),
            (4.0, 1.5),
            (4.0, -2.5),
            (2.0, 0.3),
            (-3.0, 3.0),
            (1.0, 5000.0),
        ] {
            let mut context = Context::new();
            let node = context.import(&power(&Tree::x(), exponent));
            let got = context.eval_xyz(node, base as f32, 0.0, 0.0).unwrap();
            let want = base.powf(exponent) as f32;
            assert!(
                (got - want).abs() <= 1e-5 * want.abs(),
                "{base}^{exponent}: {got} is not {want}"
            );
        }
    }
}
