//! Expressions of settings: numbers that differ from place to place.
//!
//! In: a formula of x, y, z and d, or of x, y, z and curvature, in the models'
//! language, or the field of a shape. Out: its values at many places at a time.
//!
//! x and y are the model's coordinates and z is the height above the bed, both
//! in millimetres as printed, whatever unit the model was written in. d is the
//! distance to the nearest surface, positive inside the part. curvature is an
//! outline's, one over its radius in millimetres, negative in holes.
//!
//! Expressions are evaluated in f32 by fidget's interpreter, with equal results
//! on any machine and thread.

use crate::formula::{FormulaError, Name, parse_with};
use fidget::context::Tree;
use fidget::var::Var;
use glam::DVec3;
use isocontour::{ExpandError, Values, expand_with};

/// Where an expression is evaluated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// The point: the model's x and y, and the height above the bed.
    pub at: DVec3,
    /// The value of the fourth variable: the distance to the nearest surface,
    /// positive inside, or the outline's curvature.
    pub depth: f64,
}

/// Why a text is not an expression.
#[derive(Debug, thiserror::Error, PartialEq)]
#[non_exhaustive]
pub enum ExpressionError {
    /// The text is not a formula.
    #[error(transparent)]
    Formula(#[from] FormulaError),
    /// The expression is too large.
    #[error(transparent)]
    Size(#[from] ExpandError),
    /// The expression cannot be compiled.
    #[error("it cannot be evaluated ({0}); simplify it")]
    Compile(String),
}

/// A compiled expression.
#[derive(Clone)]
pub struct Expression {
    values: Values,
}

/// Places evaluated at a time.
const BATCH: usize = 1024;

impl Expression {
    /// Compiles a formula of x, y, z and d.
    ///
    /// # Errors
    /// If the text is not such a formula, or is too large.
    pub fn parse(text: &str) -> Result<Expression, ExpressionError> {
        Self::with(text, Name::Depth)
    }

    /// Compiles a formula of x, y, z and curvature.
    ///
    /// # Errors
    /// If the text is not such a formula, or is too large.
    pub fn of_outline(text: &str) -> Result<Expression, ExpressionError> {
        Self::with(text, Name::Curvature)
    }

    fn with(text: &str, name: Name) -> Result<Expression, ExpressionError> {
        let fourth = Var::new();
        let tree = parse_with(text, name, Tree::from(fourth))?;
        Self::compile(&tree, Some(fourth))
    }

    /// Compiles the field of a shape.
    ///
    /// # Errors
    /// If it is too large, or depends on more than x, y and z.
    pub fn of_shape(tree: &Tree) -> Result<Expression, ExpressionError> {
        Self::compile(tree, None)
    }

    fn compile(
        tree: &Tree,
        fourth: Option<Var>,
    ) -> Result<Expression, ExpressionError> {
        expand_with(tree, fourth)?;
        let values = Values::new(tree, fourth)
            .map_err(|e| ExpressionError::Compile(e.to_string()))?;
        Ok(Expression { values })
    }

    /// True if the expression depends on d.
    pub fn uses_depth(&self) -> bool {
        self.values.depend_on(3)
    }

    /// True if the expression has one value all over a layer.
    pub fn is_level(&self) -> bool {
        ![0, 1, 3].iter().any(|&v| self.values.depend_on(v))
    }

    /// Appends the value at each place, perhaps NaN.
    pub fn evaluate(&self, places: &[Place], out: &mut Vec<f64>) {
        let axes: [fn(&Place) -> f64; 4] =
            [|p| p.at.x, |p| p.at.y, |p| p.at.z, |p| p.depth];
        let mut values = Vec::new();
        for batch in places.chunks(BATCH) {
            let columns = axes.map(|axis| -> Vec<f32> {
                batch.iter().map(|p| axis(p) as f32).collect()
            });
            let inputs = columns.each_ref().map(|c| &c[..]);
            match self.values.at(&inputs, &mut values) {
                Ok(()) => out.extend(values.iter().map(|&v| f64::from(v))),
                Err(_) => out.extend(batch.iter().map(|_| f64::NAN)),
            }
        }
    }

    /// Value at one place, perhaps NaN.
    pub fn at(&self, place: Place) -> f64 {
        let mut value = Vec::with_capacity(1);
        self.evaluate(&[place], &mut value);
        value.first().copied().unwrap_or(f64::NAN)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn places() -> Vec<Place> {
        // There are more places than a batch has, and no whole number of
        // batches.
        (0..2345)
            .map(|i| {
                let t = f64::from(i);
                Place {
                    at: DVec3::new(t * 0.01, -t * 0.02, t * 0.005),
                    depth: t * 0.003,
                }
            })
            .collect()
    }

    #[test]
    fn values_are_those_of_the_formula() {
        let e = Expression::parse("10 + 60*exp(-d/3) + x - 2*y*z").unwrap();
        assert!(e.uses_depth() && !e.is_level());
        let mut values = Vec::new();
        e.evaluate(&places(), &mut values);
        assert_eq!(values.len(), 2345);
        for (p, v) in places().iter().zip(values) {
            let DVec3 { x, y, z } = p.at;
            let wanted = 10.0 + 60.0 * (-p.depth / 3.0).exp() + x - 2.0 * y * z;
            assert!((v - wanted).abs() < 1e-5 * wanted.abs(), "{v} {wanted}");
        }
    }

    #[test]
    fn what_it_depends_on_is_known() {
        let e = |text| Expression::parse(text).unwrap();
        assert!(e("230 - z").is_level() && e("7").is_level());
        assert!(!e("x").is_level() && !e("d").is_level());
        assert!(!e("x + y").uses_depth());
        assert_eq!(e("2 * 3.5").at(places()[5]), 7.0);
        let mut many = Vec::new();
        e("7").evaluate(&places(), &mut many);
        assert_eq!(many, vec![7.0; 2345]);
        // A variable that cancels out does not count. Where the expression has
        // no value, the result is NaN.
        assert!(e("ln(0 - z*z)").at(places()[9]).is_nan());
    }

    #[test]
    fn mistakes_tell_their_column() {
        let e = Expression::parse("10 + q")
            .map(|_| ())
            .unwrap_err()
            .to_string();
        assert!(e.starts_with("column 6: unknown name `q`"), "{e}");
        assert!(e.contains("x, y, z, d"), "{e}");
        // A model has no d.
        let files = crate::files::Files::default();
        assert!(crate::formula::parse_formula("x + d", &files).is_err());
    }
}
