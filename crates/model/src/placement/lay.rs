//! The side on which a body lies best: the largest flat one of its convex hull.
//!
//! In: the corners of a body, millions perhaps. Out: the direction out of that
//! side, and its area. The area of a table's feet is that of the hull around all four.
//!
//! The hull is that of the corners that are farthest in 386 directions.
//! Its largest side is right if no other corner is beyond it; one that is joins
//! the hull, and the search goes on.

use super::PlaceError;
use super::hull::{Face, hull, out_of};
use fidget::context::Tree;
use glam::{DMat3, DVec2, DVec3};
use isocontour::{Solid, solid};
use isoslice_base::limits;

/// The flat side on which a part lies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Side {
    /// The direction out of it, of length 1, in the model's own coordinates.
    pub(super) out: DVec3,
    /// Its area, mm², in the model's own size.
    pub(super) area: f64,
}

/// How far from its plane a side's corners may be, as a share of the part's size:
/// 0.01 mm of 100. With 0.001, the bottom of a bulging teapot is still no side, and
/// sides are less exact.
const FLAT: f64 = 1e-4;
/// Directions are from the middle of a cube to the points of a lattice on it, so many
/// from the middle of a face to its border.
const HALF: i32 = 4;
/// The most corners that join the hull one by one: a bound on time. The side that is
/// largest by then is laid down, and may be a little aslant.
const ROUNDS: usize = 200;
/// Sides whose areas differ by less than this share are equally large. Of them
/// the one that faces down most already is taken.
const ALIKE: f64 = 1e-3;
/// Components of a direction that are less than this are those of numbers that
/// were rounded to 24 bits.
const ROUNDING: f64 = 1e-6;

/// The largest flat side of a model that is made of meshes.
///
/// # Errors
/// If it has no corners, or they are all in a plane.
pub(super) fn largest_side(tree: &Tree) -> Result<Side, PlaceError> {
    let mut corners = Vec::new();
    let known = solid(tree).is_some_and(|solid| add(&solid, &mut corners));
    if !known {
        return Err(PlaceError::NoSides);
    }
    side_of(&corners).ok_or(PlaceError::NoSides)
}

/// Adds the corners of data and of unions of it. False if there is anything else.
fn add(solid: &Solid, corners: &mut Vec<DVec3>) -> bool {
    match solid {
        Solid::Data { data, place } => match data.corners() {
            Some(all) => {
                let back = place.inverse();
                let all = all.iter().map(|p| back.transform_point3(*p));
                corners.extend(all);
                back.is_finite()
            }
            None => false,
        },
        Solid::Union(both) => both.iter().all(|one| add(one, corners)),
        _ => false,
    }
}

fn side_of(corners: &[DVec3]) -> Option<Side> {
    let first = *corners.first()?;
    let start = (first, first);
    let (min, max) = corners
        .iter()
        .fold(start, |(a, b), p| (a.min(*p), b.max(*p)));
    let slack = FLAT * (max - min).max_element();
    let mut chosen = extremes(corners);
    let mut best = None;
    for _ in 0..ROUNDS {
        // The search for bounds, which comes next, tells of the stop.
        if limits::is_stopped() {
            break;
        }
        let faces = hull(&chosen, slack);
        let out = largest(&faces, &chosen, slack)?;
        let level = farthest(&chosen, out).dot(out);
        let beyond = farthest(corners, out);
        best = Some((out, beyond.dot(out)));
        if beyond.dot(out) <= level + slack {
            break;
        }
        chosen.push(beyond);
    }
    let (out, level) = best?;
    let on = corners.iter().filter(|p| p.dot(out) > level - 2.0 * slack);
    let (u, v) = out.any_orthonormal_pair();
    let flat = on.map(|p| DVec2::new(p.dot(u), p.dot(v)));
    let area = isoslice_planar::signed_area(&isoslice_planar::hull(flat));
    Some(Side {
        out,
        area: area.abs(),
    })
}

/// The corner that is farthest in a direction.
fn farthest(corners: &[DVec3], out: DVec3) -> DVec3 {
    let far = |far: DVec3, p: &DVec3| {
        if p.dot(out) > far.dot(out) { *p } else { far }
    };
    let first = corners.first().copied().unwrap_or_default();
    corners.iter().fold(first, far)
}

/// The corners that are farthest in directions all around.
fn extremes(corners: &[DVec3]) -> Vec<DVec3> {
    let all = -HALF..=HALF;
    let mut found: Vec<DVec3> = Vec::new();
    for [i, j, k] in all
        .clone()
        .flat_map(|i| all.clone().map(move |j| [i, j]))
        .flat_map(|[i, j]| all.clone().map(move |k| [i, j, k]))
    {
        if [i, j, k].iter().all(|n| n.abs() < HALF) {
            continue;
        }
        if limits::is_stopped() {
            break;
        }
        let out = DVec3::new(i.into(), j.into(), k.into());
        let p = farthest(corners, out);
        if !found.contains(&p) {
            found.push(p);
        }
    }
    found
}

/// The direction out of the largest side.
fn largest(faces: &[Face], points: &[DVec3], slack: f64) -> Option<DVec3> {
    let sides: Vec<(f64, DVec3)> = faces
        .iter()
        .filter_map(|face| {
            let out = out_of(points, *face).try_normalize()?;
            let level = out.dot(points[face[0]]);
            let beside =
                |i: &usize| (points[*i].dot(out) - level).abs() < slack;
            let on = faces.iter().filter(|other| other.iter().all(beside));
            // Triangles at the rim may be aslant; they are small.
            let all: DVec3 = on.map(|f| out_of(points, *f)).sum();
            Some((all.length(), straight(all.try_normalize()?)))
        })
        .collect();
    let most = sides.iter().map(|side| side.0).fold(0.0, f64::max);
    let alike = sides.iter().filter(|s| s.0 >= most * (1.0 - ALIKE));
    let lowest = alike.min_by(|a, b| a.1.z.total_cmp(&b.1.z));
    lowest.map(|side| side.1)
}

/// A direction along an axis or in the plane of two, if it nearly is that.
fn straight(out: DVec3) -> DVec3 {
    let kept = out
        .to_array()
        .map(|c| if c.abs() < ROUNDING { 0.0 } else { c });
    DVec3::from_array(kept).normalize_or(out)
}

/// The shortest turn that brings a direction down.
pub(super) fn down(out: DVec3) -> DMat3 {
    let cosine = -out.z;
    if cosine <= -1.0 {
        return DMat3::from_diagonal(DVec3::new(1.0, -1.0, -1.0));
    }
    // Rodrigues' formula about the cross product of both directions.
    let axis = out.cross(DVec3::NEG_Z);
    let cross = DMat3::from_cols(
        DVec3::new(0.0, axis.z, -axis.y),
        DVec3::new(-axis.z, 0.0, axis.x),
        DVec3::new(axis.y, -axis.x, 0.0),
    );
    DMat3::IDENTITY + cross + cross * cross * (1.0 / (1.0 + cosine))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn block(size: [f64; 3]) -> Vec<DVec3> {
        (0..8)
            .map(|i| [i & 1, i >> 1 & 1, i >> 2].map(f64::from))
            .map(|p| DVec3::from_array(p) * DVec3::from_array(size))
            .collect()
    }

    #[test]
    fn a_block_lies_on_its_largest_face() {
        for (size, axis, area) in [
            ([1.0, 20.0, 30.0], 0, 600.0),
            ([20.0, 1.0, 30.0], 1, 600.0),
            ([20.0, 30.0, 1.0], 2, 600.0),
        ] {
            let side = side_of(&block(size)).unwrap();
            assert_eq!(side.out[axis].abs(), 1.0, "{side:?}");
            assert!((side.area - area).abs() < 1e-9);
            let turned = down(side.out);
            assert_eq!(turned * side.out, DVec3::NEG_Z);
        }
        // What lies well already is not turned.
        let side = side_of(&block([20.0, 30.0, 1.0])).unwrap();
        assert_eq!(down(side.out), DMat3::IDENTITY);
        let cube = side_of(&block([10.0; 3])).unwrap();
        assert_eq!(cube.out, DVec3::NEG_Z);
    }

    #[test]
    fn a_table_lies_on_its_feet_or_its_top() {
        // Four feet of single points, and a top that is less wide.
        let mut corners = Vec::new();
        for (x, y) in [(0.0, 0.0), (30.0, 0.0), (30.0, 30.0), (0.0, 30.0)] {
            corners.push(DVec3::new(x, y, 20.0));
            corners.push(DVec3::new(5.0 + 0.6 * x, 5.0 + 0.6 * y, 0.0));
        }
        let side = side_of(&corners).unwrap();
        assert_eq!(side.out, DVec3::Z);
        assert!((side.area - 900.0).abs() < 1e-9);
        let turned = down(side.out);
        assert_eq!(turned * DVec3::Z, DVec3::NEG_Z);
        assert_eq!(turned.determinant(), 1.0);
    }

    #[test]
    fn corners_beyond_the_first_hull_are_found() {
        // A round body of many corners with one cut.
        let mut rng = fastrand::Rng::with_seed(3);
        let cut = DVec3::new(1.0, 2.0, -3.0).normalize();
        let mut corners = Vec::new();
        for _ in 0..20_000 {
            let mut number = || 2.0 * rng.f64() - 1.0;
            let way = DVec3::new(number(), number(), number());
            let p = way.normalize_or(DVec3::X) * 40.0;
            let above = p.dot(cut) - 25.0;
            corners.push(p - cut * above.max(0.0));
        }
        let side = side_of(&corners).unwrap();
        assert!(side.out.dot(cut) > 1.0 - 1e-9, "{side:?}");
        let turned = down(side.out) * cut;
        assert!(turned.distance(DVec3::NEG_Z) < 1e-4, "{turned}");
        // The cut is a disc with a radius of √(40² − 25²), and few corners are at its
        // rim.
        let disc = std::f64::consts::PI * (40.0 * 40.0 - 25.0 * 25.0);
        assert!((side.area / disc - 1.0).abs() < 0.02, "{}", side.area);
    }

    #[test]
    fn flat_things_have_no_side() {
        assert_eq!(side_of(&[]), None);
        assert_eq!(side_of(&block([3.0, 2.0, 0.0])), None);
    }
}
