//! The values of settings that differ from place to place.
//!
//! In: settings, some of which are expressions, and the model. Out: each such
//! setting as a [`Quantity`], whose value is asked for at many points at a
//! time.
//!
//! A value outside the setting's range becomes the nearest end of the range.
//! Only for a temperature it is an error. NaN is always an error. Both errors
//! tell the place.

pub mod depth;
pub(crate) mod expression;

use crate::{Expression, ExpressionError, Model, Place};
use depth::DepthMap;
use glam::{DVec2, DVec3};
use isoslice_base::units::Mm;
use isoslice_planar::grid::EdgeGrid;
use isoslice_settings::{Range, Varying, keys};
use std::sync::OnceLock;

/// Why a setting has no value somewhere.
#[derive(Clone, Debug, thiserror::Error, PartialEq)]
pub enum QuantityError {
    /// The expression has a mistake.
    #[error("{key} = \"expr: {text}\": {error}")]
    Bad {
        /// The setting.
        key: &'static str,
        /// The expression's text.
        text: String,
        /// What is wrong with the expression.
        error: String,
    },
    /// The expression differs within a layer, but the setting holds for whole
    /// layers.
    #[error(
        "{key} = \"expr: {text}\" differs within a layer, but holds for whole \
         layers: use z only"
    )]
    NotLevel {
        /// The setting.
        key: &'static str,
        /// The expression's text.
        text: String,
    },
    /// The expression has no value somewhere.
    #[error(
        "{key} = \"expr: {text}\" has no value at x = {:.3}, y = {:.3}, z = \
         {:.3} ({fourth} = {depth:.3}): change the expression so that it has one \
         there, for instance with max() around what is divided by or whose \
         root is taken",
        .at.x, .at.y, .at.z
    )]
    NotANumber {
        /// The setting.
        key: &'static str,
        /// The expression's text.
        text: String,
        /// The place.
        at: DVec3,
        /// Name of the fourth variable of the expression.
        fourth: &'static str,
        /// The variable's value at the place.
        depth: f64,
    },
    /// The value is outside its range somewhere.
    #[error(
        "{key} = \"expr: {text}\" is {value:.3} at z = {z:.3}, but may be \
         {range} there: change the expression, for instance with min() and \
         max() around it"
    )]
    OutOfRange {
        /// The setting.
        key: &'static str,
        /// The expression's text.
        text: String,
        /// The value.
        value: f64,
        /// The height of the place.
        z: Mm,
        /// The range of values.
        range: Range,
    },
    /// The part cannot be measured.
    #[error("the distance to the surface, d, cannot be measured: {0}")]
    Depth(String),
}

/// A setting's value at any place.
#[derive(Clone)]
pub struct Quantity {
    key: &'static str,
    /// Name of the fourth variable.
    fourth: &'static str,
    range: Option<Range>,
    value: Value,
}

#[derive(Clone)]
enum Value {
    Constant(f64),
    Varying {
        text: String,
        expression: Box<Expression>,
    },
}

impl Quantity {
    /// The setting `key`, whose value is `value`.
    ///
    /// # Errors
    /// If the setting is an expression with a mistake.
    pub fn new(
        key: &'static str,
        value: &Varying,
    ) -> Result<Quantity, QuantityError> {
        Self::with(key, value, Expression::parse)
    }

    /// Does what [`Quantity::new`] does, for a setting of outlines, whose
    /// expressions know the curvature in place of the depth.
    ///
    /// # Errors
    /// If the setting is an expression with a mistake.
    pub fn of_outline(
        key: &'static str,
        value: &Varying,
    ) -> Result<Quantity, QuantityError> {
        let mut quantity = Self::with(key, value, Expression::of_outline)?;
        quantity.fourth = "curvature";
        Ok(quantity)
    }

    fn with(
        key: &'static str,
        value: &Varying,
        parse: impl Fn(&str) -> Result<Expression, ExpressionError>,
    ) -> Result<Quantity, QuantityError> {
        let row = keys().iter().find(|k| k.name == key);
        let value = match value {
            Varying::Constant(value) => Value::Constant(*value),
            Varying::Expression(text) => {
                let bad = |e: ExpressionError| QuantityError::Bad {
                    key,
                    text: text.clone(),
                    error: e.to_string(),
                };
                let expression = Box::new(parse(text).map_err(bad)?);
                Value::Varying {
                    text: text.clone(),
                    expression,
                }
            }
        };
        let range = row.and_then(|r| r.range);
        Ok(Quantity {
            key,
            fourth: "d",
            range,
            value,
        })
    }

    /// Does what [`Quantity::new`] does, for a setting that must not differ
    /// within a layer.
    ///
    /// # Errors
    /// If the expression differs within a layer or has a mistake.
    pub fn level(
        key: &'static str,
        value: &Varying,
    ) -> Result<Quantity, QuantityError> {
        let quantity = Quantity::new(key, value)?;
        match &quantity.value {
            Value::Varying { text, expression } if !expression.is_level() => {
                Err(QuantityError::NotLevel {
                    key,
                    text: text.clone(),
                })
            }
            _ => Ok(quantity),
        }
    }

    /// The value, if it is a constant.
    pub fn constant(&self) -> Option<f64> {
        match self.value {
            Value::Constant(value) => Some(value),
            Value::Varying { .. } => None,
        }
    }

    /// True if the distance to the surface matters.
    pub fn uses_depth(&self) -> bool {
        match &self.value {
            Value::Constant(_) => false,
            Value::Varying { expression, .. } => expression.uses_depth(),
        }
    }

    /// Appends the values at some places.
    ///
    /// # Errors
    /// If one of the places has no value.
    pub fn evaluate(
        &self,
        places: &[Place],
        out: &mut Vec<f64>,
    ) -> Result<(), QuantityError> {
        let (text, expression) = match &self.value {
            Value::Constant(value) => {
                out.extend(std::iter::repeat_n(*value, places.len()));
                return Ok(());
            }
            Value::Varying { text, expression } => (text, expression),
        };
        let first = out.len();
        expression.evaluate(places, out);
        for (value, place) in out[first..].iter_mut().zip(places) {
            if value.is_nan() {
                return Err(QuantityError::NotANumber {
                    key: self.key,
                    text: text.clone(),
                    at: place.at,
                    fourth: self.fourth,
                    depth: place.depth,
                });
            }
            if let Some(range) = self.range {
                *value = value.clamp(range.min, range.max);
            }
        }
        Ok(())
    }

    /// The value at a height, for a setting that does not differ within a
    /// layer. It must lie within `range` and the setting's own range.
    ///
    /// # Errors
    /// If there is no such value.
    pub fn at_height(&self, z: Mm, range: Range) -> Result<f64, QuantityError> {
        let (text, expression) = match &self.value {
            Value::Constant(value) => return Ok(*value),
            Value::Varying { text, expression } => (text, expression),
        };
        let own = self.range.unwrap_or(range);
        let (min, max) = (range.min.max(own.min), range.max.min(own.max));
        let range = Range::between(min, max);
        let place = Place {
            at: DVec2::ZERO.extend(z),
            depth: 0.0,
        };
        let mut value = Vec::with_capacity(1);
        expression.evaluate(&[place], &mut value);
        let value = value[0];
        if value.is_nan() {
            // This call returns the error.
            return self.at(place);
        }
        if value < range.min || value > range.max {
            return Err(QuantityError::OutOfRange {
                key: self.key,
                text: text.clone(),
                value,
                z,
                range,
            });
        }
        Ok(value)
    }

    /// The value at one place.
    ///
    /// # Errors
    /// If the place has no value.
    pub fn at(&self, place: Place) -> Result<f64, QuantityError> {
        let mut value = Vec::with_capacity(1);
        self.evaluate(&[place], &mut value)?;
        Ok(value[0])
    }
}

/// What expressions know of a place besides its coordinates.
pub struct Surroundings<'a> {
    model: &'a Model,
    /// The distances, which are measured when they are first asked for.
    depth: OnceLock<Result<DepthMap, QuantityError>>,
}

impl<'a> Surroundings<'a> {
    /// The surroundings in a placed model.
    pub fn new(model: &'a Model) -> Self {
        Surroundings {
            model,
            depth: OnceLock::new(),
        }
    }

    /// Makes places of points in the model's x and y at one height above the
    /// bed. `measure` is true if their depths matter. `solid` may give the
    /// outline at that height, which makes depths near it exact.
    ///
    /// # Errors
    /// If the part cannot be measured.
    pub fn places(
        &self,
        points: impl IntoIterator<Item = DVec2>,
        z: Mm,
        measure: bool,
        solid: Option<&EdgeGrid>,
        out: &mut Vec<Place>,
    ) -> Result<(), QuantityError> {
        let map = if measure {
            Some(self.depth_map()?)
        } else {
            None
        };
        let model_z = z - self.model.offset.z;
        let origin = self.model.origin.truncate();
        out.extend(points.into_iter().map(|p| {
            let depth = map.map_or(0.0, |map| {
                let deep = map.at(p.extend(model_z));
                let beside = solid
                    .filter(|_| deep > 0.0)
                    .and_then(|s| s.nearest_within(p, 2.0 * map.step()));
                match beside {
                    Some((_, q)) => deep.min(p.distance(q)),
                    None => deep,
                }
            });
            Place {
                at: (p + origin).extend(z),
                depth,
            }
        }));
        Ok(())
    }

    fn depth_map(&self) -> Result<&DepthMap, QuantityError> {
        let made = self.depth.get_or_init(|| {
            DepthMap::new(self.model)
                .map_err(|e| QuantityError::Depth(e.to_string()))
        });
        made.as_ref().map_err(Clone::clone)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn place(x: f64, depth: f64) -> Place {
        Place {
            at: DVec3::new(x, 0.0, 1.0),
            depth,
        }
    }

    #[test]
    fn values_stay_within_the_range_of_their_setting() {
        let text = |t: &str| Varying::Expression(t.into());
        let q = Quantity::new("infill_density", &text("10 + 60*exp(-d/3)"))
            .unwrap();
        assert!(q.uses_depth() && q.constant().is_none());
        assert!((q.at(place(0.0, 0.0)).unwrap() - 70.0).abs() < 1e-4);
        let q = Quantity::new("infill_density", &text("1000*x")).unwrap();
        assert_eq!(q.at(place(1.0, 0.0)).unwrap(), 100.0);
        assert_eq!(q.at(place(-1.0, 0.0)).unwrap(), 0.0);
        let c = Quantity::new("flow", &Varying::Constant(95.0)).unwrap();
        assert_eq!(c.at(place(3.0, 1.0)).unwrap(), 95.0);
    }

    #[test]
    fn mistakes_name_the_setting_and_the_place() {
        let q = |t: &str| Quantity::new("flow", &Varying::Expression(t.into()));
        let e = q("100 + ").map(|_| ()).unwrap_err().to_string();
        assert!(e.starts_with("flow = \"expr: 100 + \": column"), "{e}");
        let e = q("sqrt(x)").unwrap().at(place(-2.0, 0.0)).unwrap_err();
        let e = e.to_string();
        assert!(e.contains("flow") && e.contains("x = -2.000"), "{e}");
        let hot = "filament.nozzle_temperature";
        let level = |t: &str| {
            Quantity::level(hot, &Varying::Expression(t.into())).is_ok()
        };
        assert!(level("230 - z/5") && !level("200 + x") && !level("200 + d"));
    }
}
