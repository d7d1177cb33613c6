//! The convex hull of points in space.
//!
//! In: some hundred points. Out: its triangles, seen from outside
//! counter-clockwise. Each point that lies outside of what there is so far takes
//! the place of the triangles that it sees.

use glam::DVec3;
use std::collections::BTreeSet;

/// A triangle of the hull, by its corners' numbers.
pub(super) type Face = [usize; 3];

/// The triangles of the hull, or none if all points are within `slack` of a
/// plane.
pub(super) fn hull(points: &[DVec3], slack: f64) -> Vec<Face> {
    let Some(mut faces) = tetrahedron(points, slack) else {
        return Vec::new();
    };
    for (i, p) in points.iter().enumerate() {
        add(&mut faces, points, i, *p, 1e-6 * slack);
    }
    faces
}

/// The direction out of a triangle; as long as twice its area.
pub(super) fn out_of(points: &[DVec3], [a, b, c]: Face) -> DVec3 {
    let [a, b, c] = [a, b, c].map(|i| points[i]);
    (b - a).cross(c - a)
}

/// The number of the point for which a number is greatest, if it is more than
/// `slack`.
fn farthest(
    points: &[DVec3],
    slack: f64,
    of: impl Fn(DVec3) -> f64,
) -> Option<usize> {
    let all = points.iter().map(|p| of(*p)).enumerate();
    let far = all.max_by(|a, b| a.1.total_cmp(&b.1));
    far.filter(|(_, far)| *far > slack).map(|(i, _)| i)
}

fn tetrahedron(points: &[DVec3], slack: f64) -> Option<Vec<Face>> {
    let first = *points.first()?;
    let a = farthest(points, slack, |p| p.distance(first))?;
    let from = points[a];
    let b = farthest(points, slack, |p| p.distance(from))?;
    let along = (points[b] - from).normalize_or_zero();
    let c = farthest(points, slack, |p| (p - from).cross(along).length())?;
    let out = along.cross(points[c] - from).normalize_or_zero();
    let d = farthest(points, slack, |p| (p - from).dot(out).abs())?;
    // The last corner is to lie behind the first triangle.
    let behind = (points[d] - from).dot(out) < 0.0;
    let [a, b] = if behind { [a, b] } else { [b, a] };
    Some(vec![[a, b, c], [b, a, d], [c, b, d], [a, c, d]])
}

/// Adds a point, unless it is in the hull.
fn add(
    faces: &mut Vec<Face>,
    points: &[DVec3],
    new: usize,
    p: DVec3,
    slack: f64,
) {
    let sees = |face: &Face| {
        let out = out_of(points, *face);
        out.dot(p - points[face[0]]) > slack * out.length()
    };
    let (seen, rest): (Vec<Face>, Vec<Face>) =
        faces.iter().partition(|face| sees(face));
    if seen.is_empty() || rest.is_empty() {
        return;
    }
    let sides = |[a, b, c]: &Face| [(*a, *b), (*b, *c), (*c, *a)];
    let all: BTreeSet<(usize, usize)> = seen.iter().flat_map(sides).collect();
    *faces = rest;
    let border = all.iter().filter(|(a, b)| !all.contains(&(*b, *a)));
    faces.extend(border.map(|(a, b)| [*a, *b, new]));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_points_are_within_the_hull() {
        let mut rng = fastrand::Rng::with_seed(7);
        for n in [4, 5, 8, 50, 400] {
            let mut number = || 20.0 * rng.f64() - 10.0;
            let points: Vec<DVec3> = (0..n)
                .map(|_| DVec3::new(number(), number(), number()))
                .collect();
            let faces = hull(&points, 1e-6);
            let sides = 3 * faces.len() / 2;
            let corners: BTreeSet<usize> =
                faces.iter().flatten().copied().collect();
            // Euler's formula: the hull is closed.
            assert_eq!(corners.len() + faces.len(), sides + 2);
            for face in &faces {
                let out = out_of(&points, *face).normalize();
                let level = out.dot(points[face[0]]);
                assert!(points.iter().all(|p| out.dot(*p) < level + 1e-9));
            }
        }
    }

    #[test]
    fn points_of_a_plane_have_no_hull() {
        let points = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::ONE.with_z(0.0)];
        assert!(hull(&points, 1e-6).is_empty());
        assert!(hull(&points[..2], 1e-6).is_empty());
        assert!(hull(&[], 1e-6).is_empty());
    }
}
