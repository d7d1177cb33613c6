//! Where supports are wanted, and where not, whatever the face's angle:
//! `support.where`.
//!
//! In: a layer's outline and that of the layer below. Out: the parts of its
//! underside that are to be held, and those that are to be left alone.
//!
//! The formula is evaluated on a lattice of half a line's width, near
//! undersides only, so a border may be off by some hundredths of a millimetre.
//! What sticks out over the layer below by less than outlines may be off is no
//! underside: in layers of 0.2 mm, what leans by less than 3°.

use super::plan::SupportPlan;
use glam::DVec2;
use isoslice_base::units::Mm;
use isoslice_model::expressions::{Quantity, QuantityError, Surroundings};
use isoslice_planar::clip::difference;
use isoslice_planar::offset::offset;
use isoslice_planar::zero::{Sampling, negative};
use isoslice_planar::{Area, Solid};
use isoslice_settings::Varying;
use isoslice_settings::layers::LayerSpan;

/// The setting's name.
const KEY: &str = "support.where";
/// A value nearer to 0 than this is neither positive nor negative.
const ZERO: f64 = 1e-6;
/// Distance of the lattice's nodes, as a share of a line's width.
const NODE_STEP: f64 = 0.5;
/// Borders may be off by this, mm.
const CHORD: Mm = 0.02;
/// Undersides stick out by more than so many times the outlines' accuracy.
const SURE: f64 = 2.0;

/// Where supports are wanted.
pub struct Wishes<'a> {
    value: Quantity,
    around: &'a Surroundings<'a>,
    plan: &'a SupportPlan,
}

/// The parts of a layer's underside about which there is a wish.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Wish {
    /// The part to be held, whatever its angle.
    pub held: Area,
    /// The part to be left alone.
    pub left: Area,
}

impl Wish {
    /// True if there is no wish.
    pub(super) fn is_none(&self) -> bool {
        self.held.is_empty() && self.left.is_empty()
    }
}

impl<'a> Wishes<'a> {
    /// The wishes of a plan; nothing if only the angle of faces counts.
    ///
    /// # Errors
    /// If the expression has a mistake.
    pub fn new(
        plan: &'a SupportPlan,
        around: &'a Surroundings<'a>,
    ) -> Result<Option<Wishes<'a>>, QuantityError> {
        if plan.wanted == Varying::Constant(0.0) {
            return Ok(None);
        }
        let value = Quantity::new(KEY, &plan.wanted)?;
        Ok(Some(Wishes {
            value,
            around,
            plan,
        }))
    }

    /// What is wanted of the underside of a layer whose outline is `here`.
    ///
    /// # Errors
    /// If the expression has no value somewhere.
    pub(super) fn of(
        &self,
        here: &Area,
        below: &Area,
        span: &LayerSpan,
    ) -> Result<Wish, QuantityError> {
        if isoslice_base::limits::is_stopped() {
            return Ok(Wish::default());
        }
        let slack = SURE * self.plan.overhangs.walls.accuracy;
        let under = if below.is_empty() {
            here.clone()
        } else {
            difference(here, &offset(below, slack, 0.5 * slack))
        };
        if under.is_empty() {
            return Ok(Wish::default());
        }
        if let Some(value) = self.value.constant() {
            return Ok(if value > 0.0 {
                Wish {
                    held: under,
                    ..Wish::default()
                }
            } else {
                Wish {
                    left: under,
                    ..Wish::default()
                }
            });
        }
        let measure = self.value.uses_depth();
        let solid = measure.then(|| Solid::new(here.clone()));
        let solid = solid.as_ref().map(Solid::grid);
        let sampling = Sampling {
            step: NODE_STEP * self.plan.width,
            chord: CHORD,
        };
        let mut places = Vec::new();
        let mut where_it_is = |sign: f64| {
            negative(&under, sampling, |points, out| {
                let points: &mut dyn Iterator<Item = DVec2> = points;
                places.clear();
                let z = span.bottom + self.plan.lift;
                self.around.places(points, z, measure, solid, &mut places)?;
                // Undersides are at the surface or a little outside, where
                // a depth below 0 would be no number in sqrt(d).
                for place in &mut places {
                    place.depth = place.depth.max(0.0);
                }
                let first = out.len();
                self.value.evaluate(&places, out)?;
                out[first..].iter_mut().for_each(|v| *v = ZERO - sign * *v);
                Ok::<(), QuantityError>(())
            })
        };
        Ok(Wish {
            held: where_it_is(1.0)?,
            left: where_it_is(-1.0)?,
        })
    }
}
