//! Finds where along a ring a value is least.
//!
//! In: a ring, whose vertices stand for a curve, and values at any points. Out:
//! the point with the least value on a curve through the vertices. On the
//! polygon itself a linear function is always least at a vertex, which may be
//! half an edge away from the lowest place of the curve.
//!
//! Values are taken at most 0.5 mm apart. Of two minima that are nearer to each
//! other, one may be missed.

use super::BACK;
use glam::DVec2;
use isoslice_base::units::Mm;

/// Distance between the points that are tried first, mm.
const TRIED_STEP: Mm = 0.5;
/// Number of points that are tried between two earlier ones in each round.
const FINER: usize = 16;
/// Least distance of tried points, mm. Expressions are evaluated with 7 digits,
/// so nearer points would have equal values.
const NEAR: Mm = 0.01;
/// Difference below which two values count as equal, as a share of the greatest
/// value.
const SAME: f64 = 3e-7;

/// The point where the value is least on a ring that lies within `accuracy` of
/// the curve for which it stands. Of several such points it is the one farthest
/// back.
pub(super) fn lowest<E>(
    ring: &[DVec2],
    accuracy: Mm,
    mut values: impl FnMut(&[DVec2], &mut Vec<f64>) -> Result<(), E>,
) -> Result<Option<DVec2>, E> {
    let curve = Curve::new(ring, accuracy);
    let mut places: Vec<f64> = Vec::new();
    for i in 0..ring.len() {
        let count = (curve.edge(i) / TRIED_STEP).ceil().clamp(2.0, 1e4);
        places.extend((0..count as usize).map(|k| i as f64 + k as f64 / count));
    }
    let n = ring.len() as f64;
    let mut least = |places: &[f64]| -> Result<Option<usize>, E> {
        let points: Vec<DVec2> = places.iter().map(|&s| curve.at(s)).collect();
        let mut found = Vec::with_capacity(points.len());
        values(&points, &mut found)?;
        let low = found.iter().copied().fold(f64::INFINITY, f64::min);
        let high = found.iter().map(|v| v.abs()).fold(0.0, f64::max);
        let limit = low + SAME * high;
        let back = |i: &usize| BACK.dot(points[*i]);
        Ok((0..found.len().min(points.len()))
            .filter(|&i| found[i] <= limit)
            .max_by(|a, b| back(a).total_cmp(&back(b))))
    };
    let Some(i) = least(&places)? else {
        return Ok(None);
    };
    let count = places.len();
    let mut at = places[i];
    // Places before the first vertex follow the last one.
    let mut from = match i {
        0 => places[count - 1] - n,
        _ => places[i - 1],
    };
    let mut to = places.get(i + 1).copied().unwrap_or(n);
    while curve.at(from).distance(curve.at(at)) > NEAR
        || curve.at(to).distance(curve.at(at)) > NEAR
    {
        let half = FINER / 2;
        let share = |k: usize| k as f64 / half as f64;
        // The place itself is tried as well, since it may be a corner.
        let finer: Vec<f64> = (0..half)
            .map(|k| from + share(k) * (at - from))
            .chain((0..=half).map(|k| at + share(k) * (to - at)))
            .collect();
        let Some(i) = least(&finer)? else { break };
        let (low, high) = (i.saturating_sub(1), (i + 1).min(FINER));
        let next = (finer[low], finer[i], finer[high]);
        if next == (from, at, to) {
            break;
        }
        (from, at, to) = next;
    }
    Ok(Some(curve.at(at)))
}

/// A smooth curve through the vertices of a ring, with its corners.
struct Curve<'a> {
    ring: &'a [DVec2],
    /// Directions at both ends of each edge, as long as the edge.
    ends: Vec<(DVec2, DVec2)>,
}

/// Least turn at which a vertex is a corner, in radians (20°).
const CORNER: f64 = 0.35;

impl Curve<'_> {
    fn new(ring: &[DVec2], accuracy: Mm) -> Curve<'_> {
        let n = ring.len();
        let edge = |i: usize| ring[(i + 1) % n] - ring[i % n];
        // The direction of the circle through three vertices, at the second
        // one.
        let tangent = |i: usize| -> Option<DVec2> {
            let (a, b) = (edge(i + n - 1), edge(i));
            let (la, lb) = (a.length(), b.length());
            if a.angle_to(b).abs() > CORNER {
                return None;
            }
            (a * (lb / la) + b * (la / lb)).try_normalize()
        };
        let tangents: Vec<Option<DVec2>> = (0..n).map(tangent).collect();
        // If a curve's tangent at an end of an edge is farther off the edge than
        // this, mm, the curve is not within `accuracy` of the edge.
        let most = 6.0 * accuracy + 0.01;
        let end = |i: usize, vertex: usize| -> DVec2 {
            let own = edge(i);
            let length = own.length();
            match tangents[vertex % n] {
                Some(t) if own.perp_dot(t).abs() <= most => t * length,
                _ => own,
            }
        };
        let ends = (0..n).map(|i| (end(i, i), end(i, i + 1))).collect();
        Curve { ring, ends }
    }

    /// Length of an edge, mm.
    fn edge(&self, i: usize) -> Mm {
        self.ring[i].distance(self.ring[(i + 1) % self.ring.len()])
    }

    /// The point at a place, which counts edges from the first vertex.
    fn at(&self, place: f64) -> DVec2 {
        let n = self.ring.len();
        let place = place.rem_euclid(n as f64);
        let i = (place as usize).min(n - 1);
        let t = place - i as f64;
        let (a, b) = (self.ring[i], self.ring[(i + 1) % n]);
        let (u, v) = self.ends[i];
        // Hermite's cubic.
        let s = 1.0 - t;
        let w = t * t * (3.0 - 2.0 * t);
        a.lerp(b, w) + u * (t * s * s) - v * (t * t * s)
    }
}
