//! Fuzzy skin: outer walls moved in and out, as a texture to look at and to
//! hold.
//!
//! In: a layer's wall beads. Out: the beads, of which the outer walls are moved
//! along their in-plane normals by a noise that depends on the place only. So a
//! part always gets one texture, and neighbouring layers get similar ones. The
//! distance is a setting that may differ from place to place.

use crate::view::LayerFace;
use glam::{DVec2, DVec3};
use isoslice_base::random::{mix, share};
use isoslice_base::units::Mm;
use isoslice_model::Place;
use isoslice_model::expressions::{Quantity, QuantityError, Surroundings};
use isoslice_planar::bead::{Bead, Role};
use isoslice_planar::signed_area;
use isoslice_settings::FuzzySkin;

/// Number of points of a fuzzy wall for each grain.
const POINTS: f64 = 4.0;

/// The texture of a run.
pub struct Fuzzy<'a> {
    skin: &'a FuzzySkin,
    thickness: Quantity,
    around: &'a Surroundings<'a>,
}

impl<'a> Fuzzy<'a> {
    /// The texture that is asked for, if any.
    ///
    /// # Errors
    /// If the expression of its thickness has a mistake.
    pub fn new(
        skin: &'a FuzzySkin,
        around: &'a Surroundings<'a>,
    ) -> Result<Option<Fuzzy<'a>>, QuantityError> {
        let thickness = Quantity::new("fuzzy.thickness", &skin.thickness)?;
        Ok((thickness.constant() != Some(0.0)).then_some(Fuzzy {
            skin,
            thickness,
            around,
        }))
    }

    /// Moves the outer walls of a layer. The first layer stays smooth, since it
    /// has to stick.
    ///
    /// # Errors
    /// If the thickness has no value somewhere.
    pub fn apply(
        &self,
        beads: &mut [Bead],
        layer: &LayerFace<'_>,
    ) -> Result<(), QuantityError> {
        if layer.span.index == 0 {
            return Ok(());
        }
        for bead in beads {
            if isoslice_base::limits::is_stopped() {
                break;
            }
            let hole = signed_area(&bead.stroke.points) < 0.0;
            let meant = bead.stroke.closed && (self.skin.holes || !hole);
            if bead.role == Role::OuterWall && meant {
                self.roughen(bead, layer)?;
            }
        }
        Ok(())
    }

    fn roughen(
        &self,
        bead: &mut Bead,
        layer: &LayerFace<'_>,
    ) -> Result<(), QuantityError> {
        let z = layer.span.sample_z();
        let grain = self.skin.grain;
        let dense = resampled(bead, grain / POINTS);
        let mut places: Vec<Place> = Vec::with_capacity(dense.len());
        self.around.places(
            dense.iter().map(|p| p.at),
            z,
            self.thickness.uses_depth(),
            Some(layer.outline.grid()),
            &mut places,
        )?;
        let mut thickness = Vec::with_capacity(dense.len());
        self.thickness.evaluate(&places, &mut thickness)?;
        bead.stroke.points = dense
            .iter()
            .zip(&thickness)
            .map(|(p, t)| {
                let bump = noise(p.at.extend(z) / grain);
                p.at + p.normal * (t * bump)
            })
            .collect();
        if !bead.stroke.widths.is_empty() {
            bead.stroke.widths = dense.iter().map(|p| p.width).collect();
        }
        Ok(())
    }
}

/// A point of a wall.
struct Dense {
    at: DVec2,
    /// Direction outwards, of length 1 along an edge, shorter at a corner.
    normal: DVec2,
    width: Mm,
}

/// The points of a closed bead, with more between them so that none are farther
/// apart than `step`.
fn resampled(bead: &Bead, step: Mm) -> Vec<Dense> {
    let n = bead.stroke.points.len();
    let width = |i: usize| bead.stroke.width_at(i);
    let out = |i: usize| -> DVec2 {
        let (a, b) =
            (bead.stroke.points[i % n], bead.stroke.points[(i + 1) % n]);
        -(b - a).perp().normalize_or_zero()
    };
    let mut dense = Vec::new();
    for (i, (a, b)) in bead.stroke.segments().enumerate() {
        let before = out((i + n - 1) % n);
        dense.push(Dense {
            at: a,
            normal: 0.5 * (before + out(i)),
            width: width(i),
        });
        let count = (a.distance(b) / step).ceil().max(1.0);
        for k in 1..count as usize {
            let t = k as f64 / count;
            dense.push(Dense {
                at: a.lerp(b, t),
                normal: out(i),
                width: width(i) + t * (width(i + 1) - width(i)),
            });
        }
    }
    dense
}

/// Smooth noise from -1 to 1 with bumps about a unit wide: random values at
/// whole coordinates, blended between them (value noise, K. Perlin's fade
/// 6t⁵ - 15t⁴ + 10t³).
fn noise(p: DVec3) -> f64 {
    let cell = p.floor();
    let t = p - cell;
    let fade = t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
    let corner = |dx: f64, dy: f64, dz: f64| {
        let at = cell + DVec3::new(dx, dy, dz);
        let mut bits = 0_u64;
        for value in at.to_array() {
            bits = mix(bits ^ (value as i64 as u64));
        }
        2.0 * share(bits) - 1.0
    };
    let blend = |a: f64, b: f64, t: f64| a + (b - a) * t;
    let row = |dy, dz| blend(corner(0.0, dy, dz), corner(1.0, dy, dz), fade.x);
    let plane = |dz| blend(row(0.0, dz), row(1.0, dz), fade.y);
    blend(plane(0.0), plane(1.0), fade.z)
}

#[cfg(test)]
mod tests {
    use super::*;
    use isoslice_planar::bead::Stroke;

    #[test]
    fn noise_is_smooth_and_fills_its_range() {
        let at = |i: i32| noise(DVec3::new(f64::from(i) * 0.013, 3.7, -20.2));
        let values: Vec<f64> = (-40_000..40_000).map(at).collect();
        let jump = values.windows(2).map(|w| (w[1] - w[0]).abs());
        assert!(jump.fold(0.0, f64::max) < 0.06);
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        assert!(mean.abs() < 0.05, "{mean}");
        let (low, high) = values
            .iter()
            .fold((0.0_f64, 0.0_f64), |(a, b), v| (a.min(*v), b.max(*v)));
        assert!((-1.0..-0.6).contains(&low) && (0.6..1.0).contains(&high));
    }

    #[test]
    fn walls_keep_their_corners_and_get_points_between() {
        let ring = [(0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (0.0, 4.0)]
            .map(DVec2::from)
            .to_vec();
        let mut square =
            Bead::new(Role::OuterWall, Stroke::new(ring, true, 0.45), 0.2);
        square.stroke.widths = vec![0.4, 0.5, 0.5, 0.4];
        let dense = resampled(&square, 0.5);
        assert_eq!(dense.len(), 32);
        assert!((dense[4].width - 0.45).abs() < 1e-12);
        // Outwards is to the right of a ring that runs counter-clockwise.
        assert_eq!(dense[4].normal, DVec2::new(0.0, -1.0));
        let diagonal = dense[8].normal;
        assert!((diagonal - DVec2::new(0.5, -0.5)).length() < 1e-12);
    }
}
