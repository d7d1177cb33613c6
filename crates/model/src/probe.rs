//! Measures how far a point is from f = 0 by asking the field directly.
//!
//! In: points of a layer's plane with a direction each. Out: signed distances
//! along the directions, found by bisection. The probe shares nothing with the
//! stages that make the outline: fidget's interpreter evaluates the whole
//! expression, which is neither simplified nor hoisted. So the probe shows a
//! fault of those stages. Inside is f < 0; NaN is outside. Where f is exactly 0,
//! inside is what is inside just above or just below. A place where f is 0 is on
//! the border only if the sign changes there: f may be 0 all over the outside.
//!
//! Not guaranteed: that no border lies nearer in another direction. A distance
//! is never less than the true one by more than [`FINEST`].

use fidget::context::Tree;
use glam::DVec2;
use isocontour::{FieldError, Values, apart};
use isoslice_base::units::Mm;

/// Distances on both sides at which a change of sign is looked for, mm.
const RADII: [Mm; 8] = [0.0005, 0.002, 0.008, 0.02, 0.05, 0.15, 0.4, 1.0];

/// Width of the bracket at which the search ends, mm.
const FINEST: Mm = 2e-5;

/// The evaluator fails, which is a bug.
#[derive(Clone, Debug, thiserror::Error, PartialEq)]
#[error("cannot evaluate the field at single points: {0}")]
pub struct ProbeError(String);

fn failed(error: FieldError) -> ProbeError {
    ProbeError(error.to_string())
}

/// A model's expression.
pub struct Probe {
    values: Values,
}

/// A point and the direction in which f = 0 is looked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spot {
    /// The point, mm.
    pub at: DVec2,
    /// The direction out of the part, of length 1.
    pub out: DVec2,
}

/// The search from one point.
struct Search {
    spot: Spot,
    inside: bool,
    /// Signed distances between which the sign changes. At the first one the
    /// field has the sign that it has at the point itself.
    bracket: Option<(Mm, Mm)>,
}

impl Probe {
    /// A probe of the space outside the field `tree`, moved down by `gap` mm: it is
    /// negative where something may be that keeps that far below the field's
    /// undersides.
    ///
    /// # Errors
    /// If fidget refuses the expression.
    pub fn below(tree: &Tree, gap: Mm) -> Result<Probe, ProbeError> {
        let (x, y, z) = Tree::axes();
        Probe::new(&-tree.remap_xyz(x, y, z + gap as f32))
    }

    /// A probe of the field `tree`.
    ///
    /// # Errors
    /// If fidget refuses the expression.
    pub fn new(tree: &Tree) -> Result<Probe, ProbeError> {
        let values = Values::new(tree, None).map_err(failed)?;
        Ok(Probe { values })
    }

    /// The field's values at points of the model's frame. Where it is 0, the
    /// lesser of its values just above and just below.
    ///
    /// # Errors
    /// If the evaluator fails, which is a bug.
    pub fn values(
        &self,
        x: &[f32],
        y: &[f32],
        z: &[f32],
    ) -> Result<Vec<f32>, ProbeError> {
        let mut values = self.plain_values(x, y, z)?;
        let zeros: Vec<usize> =
            (0..values.len()).filter(|&i| values[i] == 0.0).collect();
        let of = |all: &[f32]| -> Vec<f32> {
            zeros.iter().map(|&i| all[i]).collect()
        };
        let (x, y) = (of(x), of(y));
        for up in [-1.0, 1.0] {
            let beside = |&i: &usize| z[i] + up * apart(z[i]);
            let z: Vec<f32> = zeros.iter().map(beside).collect();
            let beside = self.plain_values(&x, &y, &z)?;
            for (&i, f) in zeros.iter().zip(beside) {
                values[i] = values[i].min(f);
            }
        }
        Ok(values)
    }

    fn plain_values(
        &self,
        x: &[f32],
        y: &[f32],
        z: &[f32],
    ) -> Result<Vec<f32>, ProbeError> {
        let mut out = Vec::with_capacity(x.len());
        self.values.at(&[x, y, z], &mut out).map_err(failed)?;
        Ok(out)
    }

    /// How far each spot of the plane at height `z`, in the model's frame, lies
    /// outside the part; negative inside. It is the distance to the nearest
    /// change of the field's sign along the spot's direction, forwards or
    /// backwards; none if there is no change within 1 mm.
    ///
    /// # Errors
    /// If the evaluator fails, which is a bug.
    pub fn distances(
        &self,
        spots: &[Spot],
        z: Mm,
    ) -> Result<Vec<Option<Mm>>, ProbeError> {
        let outside = |s: &Search| {
            let (a, b) = s.bracket?;
            let way = 0.5 * (a + b).abs();
            Some(if s.inside { -way } else { way })
        };
        let found = self.search(spots, z)?;
        Ok(found.iter().map(outside).collect())
    }

    /// Looks for the changes of sign nearest to spots.
    fn search(&self, spots: &[Spot], z: Mm) -> Result<Vec<Search>, ProbeError> {
        // The field at given distances from the spots.
        let at = |from: &[&Search], away: &dyn Fn(&Search) -> Mm| {
            let p = from.iter().map(|s| s.spot.at + away(s) * s.spot.out);
            let (x, y): (Vec<f32>, Vec<f32>) =
                p.map(|p| (p.x as f32, p.y as f32)).unzip();
            self.values(&x, &y, &vec![z as f32; x.len()])
        };
        let mut all: Vec<Search> = spots
            .iter()
            .map(|&spot| Search {
                spot,
                inside: false,
                bracket: None,
            })
            .collect();
        let own = at(&all.iter().collect::<Vec<_>>(), &|_| 0.0)?;
        for (s, f) in all.iter_mut().zip(&own) {
            s.inside = *f < 0.0;
        }
        // A point with the value 0 lies on the border itself if the sign
        // changes there.
        let zeros: Vec<usize> =
            (0..all.len()).filter(|&i| own[i] == 0.0).collect();
        let from: Vec<&Search> = zeros.iter().map(|&i| &all[i]).collect();
        let (plus, minus) = (at(&from, &|_| FINEST)?, at(&from, &|_| -FINEST)?);
        for ((i, plus), minus) in zeros.into_iter().zip(plus).zip(minus) {
            if (plus < 0.0) != (minus < 0.0) {
                all[i].bracket = Some((0.0, 0.0));
            }
        }
        let mut near = 0.0;
        for radius in RADII {
            let open: Vec<usize> = (0..all.len())
                .filter(|&i| all[i].bracket.is_none())
                .collect();
            let from: Vec<&Search> = open.iter().map(|&i| &all[i]).collect();
            let plus = at(&from, &|_| radius)?;
            let minus = at(&from, &|_| -radius)?;
            for ((i, plus), minus) in open.into_iter().zip(plus).zip(minus) {
                let s = &mut all[i];
                let (plus, minus) = (plus < 0.0, minus < 0.0);
                // A point inside is expected to have the border outwards, so
                // the search begins on that side.
                let sides = if s.inside {
                    [(1.0, plus), (-1.0, minus)]
                } else {
                    [(-1.0, minus), (1.0, plus)]
                };
                s.bracket = sides
                    .into_iter()
                    .find(|side| side.1 != s.inside)
                    .map(|(sign, _)| (sign * near, sign * radius));
            }
            near = radius;
        }
        loop {
            let wide = |s: &Search| {
                s.bracket.is_some_and(|(a, b)| (b - a).abs() > FINEST)
            };
            let open: Vec<usize> =
                (0..all.len()).filter(|&i| wide(&all[i])).collect();
            if open.is_empty() {
                break;
            }
            let from: Vec<&Search> = open.iter().map(|&i| &all[i]).collect();
            let middle =
                |s: &Search| s.bracket.map_or(0.0, |(a, b)| 0.5 * (a + b));
            let values = at(&from, &middle)?;
            for (i, f) in open.into_iter().zip(values) {
                let s = &mut all[i];
                if let Some((a, b)) = s.bracket {
                    let m = 0.5 * (a + b);
                    s.bracket = if (f < 0.0) == s.inside {
                        Some((m, b))
                    } else {
                        Some((a, m))
                    };
                }
            }
        }
        Ok(all)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn circle() -> Probe {
        let (x, y, z) = (Tree::x(), Tree::y(), Tree::z());
        let f = (x.clone() * x + y.clone() * y + z.clone() * z).sqrt() - 5.0;
        Probe::new(&f).unwrap()
    }

    #[test]
    fn distances_are_signed_and_right_to_a_tenth_of_a_micrometre() {
        // At z = 3 the ball is a disc of radius 4.
        for off in [-0.9, -0.1, -0.0123, -0.001, 0.0, 1e-4, 0.0077, 0.3] {
            let spots: Vec<Spot> = (0..40)
                .map(|k| {
                    let out = DVec2::from_angle(f64::from(k) * 0.157);
                    let at = (4.0 + off) * out;
                    Spot { at, out }
                })
                .collect();
            for d in circle().distances(&spots, 3.0).unwrap() {
                let d = d.unwrap();
                // A unit of f32's last digit at 4 is half a nanometre.
                assert!((d - off).abs() < 1e-4 * off.abs() + 1e-4, "{d} {off}");
            }
        }
    }

    /// The field is 0 all over its outside, and in the plane in which the two
    /// halves of the cylinder meet.
    #[test]
    fn zeros_are_borders_only_where_the_sign_changes() {
        let (x, y, z) = Tree::axes();
        let wall = (x.square() + y.square()).sqrt() - 5.0;
        let halves = wall.max(z.clone().min(-z).min(0.0));
        let probe = Probe::new(&halves.min(0.0)).unwrap();
        for height in [0.0, 1.0] {
            for off in [-0.3, -0.001, 0.0, 0.0077, 0.3] {
                let out = DVec2::X;
                let spot = Spot {
                    at: (5.0 + off) * out,
                    out,
                };
                let d = probe.distances(&[spot], height).unwrap()[0].unwrap();
                assert!((d - off).abs() < 1e-4, "{d} {off} {height}");
            }
        }
    }

    #[test]
    fn where_nothing_is_near_nothing_is_found() {
        let out = DVec2::X;
        let far = [DVec2::ZERO, DVec2::new(9.0, 0.0)];
        let spots = far.map(|at| Spot { at, out });
        assert_eq!(circle().distances(&spots, 3.0).unwrap(), [None, None]);
        assert_eq!(circle().distances(&[], 3.0).unwrap(), []);
    }

    #[test]
    fn jumps_and_what_is_no_number_are_borders() {
        // The field is the root of a negative number beyond x = 2.
        let f = (2.0 - Tree::x()).sqrt() - 100.0 + 0.0 * Tree::y();
        let probe = Probe::new(&f).unwrap();
        let spot = Spot {
            at: DVec2::new(1.99, 0.0),
            out: DVec2::X,
        };
        let d = probe.distances(&[spot], 0.0).unwrap()[0].unwrap();
        assert!((d + 0.01).abs() < 1e-4, "{d}");
    }
}
