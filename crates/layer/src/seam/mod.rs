//! Where closed outer walls begin and end, and how.
//!
//! In: a layer's walls before any texture. Out: for each wall the places where
//! its seam may be, as far as the layer alone tells ([`Site`]); the seam's
//! place, given where it is expected ([`follow()`]); and how the wall begins and
//! ends there ([`ending`]).
//!
//! ```text
//!      ╭──────╮      An aligned seam is in a concave corner (●), where it
//!      │   ╭──╯      hides and stays from layer to layer; else in a convex
//!      │   ●         one; else where the line from the middle to the back
//!      ╰───┴──╮      (+y) leaves the ring. Of places alike, those over
//!                    solid ground come first.
//! ```
//!
//! A wall's site depends on its ring only. A [`Guide`], which is made before the
//! first layer, says where seams are expected.
//!
//! The walls are polygons that stand for curves. A seam lies on a smooth curve
//! through the polygon's corners (`lowest`), so that it does not jump from one
//! corner to the next.

mod corners;
pub mod ending;
mod follow;
mod guide;
mod lowest;
mod plan;
mod scarf;

use crate::view::LayerFace;
use corners::Corners;
pub use follow::{Below, Ground, follow};
use glam::DVec2;
pub use guide::Guide;
use isoslice_base::random::{mix, share};
use isoslice_base::units::Mm;
use isoslice_model::Place;
use isoslice_model::expressions::{Quantity, QuantityError, Surroundings};
use isoslice_planar::along::point_at;
use isoslice_planar::bead::{Bead, Role};
use isoslice_planar::path_length;
use isoslice_settings::{SeamRule, Varying};
use lowest::lowest;
pub use plan::EndingPlan;

/// Where the seam of a wall may be.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Site {
    /// Where the seam is if it is expected nowhere and nothing hangs; none if it
    /// may be anywhere.
    pub at: Option<DVec2>,
    /// True if the seam is where it is expected.
    pub follows: bool,
    /// The corners that the seam may be in.
    pub corners: Vec<DVec2>,
    /// Those that are about as sharp as the sharpest.
    pub sharp: Vec<DVec2>,
}

/// The direction to the back. It points slightly to the right, so that rounding
/// does not pick the end of a level edge.
pub const BACK: DVec2 = DVec2::new(0.02, 1.0);
/// The rule for a run's seams.
pub struct Seams<'a> {
    rule: Varying<SeamRule>,
    expression: Option<Quantity>,
    around: &'a Surroundings<'a>,
    accuracy: Mm,
}

impl<'a> Seams<'a> {
    /// The seams of a rule. Rings are exact to `accuracy`.
    ///
    /// # Errors
    /// If the rule is an expression with a mistake.
    pub fn new(
        rule: &Varying<SeamRule>,
        accuracy: Mm,
        around: &'a Surroundings<'a>,
    ) -> Result<Seams<'a>, QuantityError> {
        let expression = rule.expression().map(|text| {
            Quantity::new("seam", &Varying::Expression(text.to_owned()))
        });
        Ok(Seams {
            rule: rule.clone(),
            expression: expression.transpose()?,
            around,
            accuracy,
        })
    }

    /// What plans the seams of a part, if they are in lines.
    pub fn guide(&self) -> Option<Guide> {
        let aligned = self.rule == Varying::Constant(SeamRule::Aligned);
        aligned.then(|| Guide::new(self.accuracy))
    }

    /// The sites of a layer's walls. Walls that are not closed outer ones have
    /// empty sites.
    ///
    /// # Errors
    /// If an expression has no value somewhere.
    pub fn sites(
        &self,
        walls: &[Bead],
        layer: &LayerFace<'_>,
    ) -> Result<Vec<Site>, QuantityError> {
        let own = |(number, wall): (usize, &Bead)| {
            let outer = wall.stroke.closed && wall.role == Role::OuterWall;
            if outer && wall.stroke.points.len() > 2 {
                self.site(&wall.stroke.points, number, layer)
            } else {
                Ok(Site::default())
            }
        };
        walls.iter().enumerate().map(own).collect()
    }

    fn site(
        &self,
        ring: &[DVec2],
        number: usize,
        layer: &LayerFace<'_>,
    ) -> Result<Site, QuantityError> {
        let at = match (&self.rule, &self.expression) {
            (Varying::Constant(SeamRule::Aligned), _) => {
                return Ok(aligned(ring, self.accuracy));
            }
            (Varying::Constant(SeamRule::Rear), _) => rear(ring, self.accuracy),
            (Varying::Constant(SeamRule::Random), _) => {
                random(ring, [layer.span.index, number])
            }
            (Varying::Expression(_), Some(value)) => {
                let measure = value.uses_depth();
                let mut places: Vec<Place> = Vec::new();
                lowest(ring, self.accuracy, |points, out| {
                    places.clear();
                    self.around.places(
                        points.iter().copied(),
                        layer.span.sample_z(),
                        measure,
                        Some(layer.outline.grid()),
                        &mut places,
                    )?;
                    value.evaluate(&places, out)
                })?
            }
            _ => None,
        };
        Ok(Site {
            at,
            ..Site::default()
        })
    }
}

/// Where an aligned seam may be.
fn aligned(ring: &[DVec2], accuracy: Mm) -> Site {
    let corners = Corners::new(ring, accuracy);
    let mut found = corners.concave();
    if found.is_empty() {
        found = corners.convex();
    }
    /// Share of the sharpest corner's turn from which others are as sharp.
    const ALIKE: f64 = 0.8;
    let sharpest = found.iter().map(|c| c.turn).fold(0.0, f64::max);
    let sharp = found.iter().filter(|c| c.turn >= ALIKE * sharpest);
    let sharp: Vec<DVec2> = sharp.map(|c| c.at).collect();
    Site {
        at: sharp.first().copied().or_else(|| behind(ring)),
        follows: true,
        corners: found.iter().map(|c| c.at).collect(),
        sharp,
    }
}

/// The point of a ring that is farthest back.
fn rear(ring: &[DVec2], accuracy: Mm) -> Option<DVec2> {
    let back = lowest(ring, accuracy, |points, out| {
        out.extend(points.iter().map(|p| -BACK.dot(*p)));
        Ok::<(), std::convert::Infallible>(())
    });
    match back {
        Ok(point) => point,
        Err(never) => match never {},
    }
}

/// Where the line from the centre of a ring's area to the back leaves the ring.
/// The point moves as smoothly as the ring does.
fn behind(ring: &[DVec2]) -> Option<DVec2> {
    let origin = *ring.first()?;
    let edges = || (0..ring.len()).map(|i| (i, (i + 1) % ring.len()));
    let (mut area, mut moment) = (0.0, DVec2::ZERO);
    for (i, k) in edges() {
        let (a, b) = (ring[i] - origin, ring[k] - origin);
        area += a.perp_dot(b);
        moment += a.perp_dot(b) * (a + b) / 3.0;
    }
    let x = origin.x + moment.x / area;
    edges()
        .map(|(i, k)| (ring[i], ring[k]))
        .filter(|(a, b)| (a.x < x) != (b.x < x))
        .map(|(a, b)| a.lerp(b, (x - a.x) / (b.x - a.x)))
        .max_by(|p, q| p.y.total_cmp(&q.y))
        .or(Some(origin))
}

/// A point that depends on the numbers of layer and wall only.
fn random(ring: &[DVec2], [layer, number]: [usize; 2]) -> Option<DVec2> {
    let share = share(mix(mix(layer as u64) ^ number as u64));
    along(ring, share * path_length(ring, true))
}

/// The point of a ring at a length after its first point.
fn along(ring: &[DVec2], length: Mm) -> Option<DVec2> {
    let line = ring.iter().chain(ring.first()).copied();
    point_at(line, length).or(ring.first().copied())
}

#[cfg(test)]
mod tests;
