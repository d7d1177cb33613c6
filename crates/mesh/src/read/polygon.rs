//! Makes triangles of faces with more corners.
//!
//! In: the corners of a face, as numbers of vertices. Out: triangles, two fewer
//! than corners. A convex face becomes a fan. Of others, ears are cut off: corners
//! that turn left, with no other corner in their triangle.

use crate::error::MeshError;
use crate::triangles::Collector;
use glam::{DVec2, DVec3};

/// A face with more corners that is not convex becomes a fan, too: cutting ears
/// takes the square of their number.
const MOST_EARS: usize = 256;

/// A face. The memory is used again for the next one.
#[derive(Debug, Default)]
pub(super) struct Face {
    pub corners: Vec<u32>,
    flat: Vec<DVec2>,
    left: Vec<usize>,
}

/// Adds the triangles of a face, and empties it. Faces of less than three corners
/// are points or lines, and no part of a surface.
pub(super) fn add(
    all: &mut Collector,
    face: &mut Face,
) -> Result<(), MeshError> {
    face.corners.dedup();
    if face.corners.len() > 1 && face.corners.first() == face.corners.last() {
        face.corners.pop();
    }
    match face.corners[..] {
        [] | [_] | [_, _] => {}
        [a, b, c] => all.triangle([a, b, c])?,
        _ => {
            flatten(all.vertices(), face);
            if is_convex(&face.flat) || face.corners.len() > MOST_EARS {
                let first = face.corners[0];
                for pair in face.corners[1..].windows(2) {
                    all.triangle([first, pair[0], pair[1]])?;
                }
            } else {
                cut(all, face)?;
            }
        }
    }
    face.corners.clear();
    Ok(())
}

/// The corners of a face as seen from outside, along its mean normal.
fn flatten(vertices: &[DVec3], face: &mut Face) {
    let corner =
        |i: usize| vertices[face.corners[i % face.corners.len()] as usize];
    let first = corner(0);
    let normal: DVec3 = (1..face.corners.len())
        .map(|i| (corner(i) - first).cross(corner(i + 1) - first))
        .sum();
    let normal = normal.try_normalize().unwrap_or(DVec3::Z);
    let (x, y) = normal.any_orthonormal_pair();
    face.flat.clear();
    for i in 0..face.corners.len() {
        let p = corner(i) - first;
        face.flat.push(DVec2::new(p.dot(x), p.dot(y)));
    }
    // The pair and the normal may be left-handed.
    if x.cross(y).dot(normal) < 0.0 {
        for p in &mut face.flat {
            p.y = -p.y;
        }
    }
}

/// True if all corners turn left, and the face goes round once.
fn is_convex(flat: &[DVec2]) -> bool {
    let n = flat.len();
    let edge = |i: usize| flat[(i + 1) % n] - flat[i % n];
    let mut falls = 0;
    for i in 0..n {
        let (a, b) = (edge(i), edge(i + 1));
        if a.perp_dot(b) < 0.0 {
            return false;
        }
        falls += usize::from(a.y >= 0.0 && b.y < 0.0);
    }
    falls <= 1
}

/// Cuts off ears.
fn cut(all: &mut Collector, face: &mut Face) -> Result<(), MeshError> {
    isoslice_base::limits::go_on()?;
    let left = &mut face.left;
    left.clear();
    left.extend(0..face.corners.len());
    let mut at = 0;
    let mut misses = 0;
    while left.len() > 3 {
        let n = left.len();
        let [a, b, c] = [at, at + 1, at + 2].map(|i| left[i % n]);
        // A face that crosses itself may have no ear: then any corner serves.
        if is_ear(&face.flat, left, [a, b, c]) || misses > n {
            all.triangle([a, b, c].map(|i| face.corners[i]))?;
            left.remove((at + 1) % n);
            misses = 0;
            at %= left.len();
        } else {
            misses += 1;
            at = (at + 1) % n;
        }
    }
    if let [a, b, c] = left[..] {
        all.triangle([a, b, c].map(|i| face.corners[i]))?;
    }
    Ok(())
}

/// True if the corner `b` turns left and no other corner is in its triangle.
fn is_ear(flat: &[DVec2], left: &[usize], [a, b, c]: [usize; 3]) -> bool {
    let [p, q, r] = [a, b, c].map(|i| flat[i]);
    let turn = |a: DVec2, b: DVec2, c: DVec2| (b - a).perp_dot(c - b);
    turn(p, q, r) > 0.0
        && left.iter().all(|&i| {
            let x = flat[i];
            [p, q, r].contains(&x)
                || turn(p, q, x) < 0.0
                || turn(q, r, x) < 0.0
                || turn(r, p, x) < 0.0
        })
}
