//! Puts back the corners that marching squares cuts off.
//!
//! ```text
//!        │          Where the field's gradients at a segment's ends differ,
//!   p ───┼─╳ c      the outline turns within the cell: the tangents at p
//!        │ │        and q meet in c, and if the field is zero there too, c
//!        │ q        is a corner.
//! ```
//!
//! After Kobbelt et al., Feature sensitive surface extraction from volume
//! data (2001), in two dimensions. A corner lies in its segment's cell, or in
//! a neighbouring cell through which no outline passes: nothing else can be
//! crossed there.

use super::march::{Scratch, Segment, Vertex};
use crate::field::{FieldError, Lattice, Sampler};
use glam::DVec2;

/// Cosine of the least angle between the gradients at a corner, 20°.
const COS_TURN: f64 = 0.94;
/// A corner's distance from the zero set, as a share of how far it stands
/// off the segment that it replaces.
const RESIDUE: f64 = 0.1;

/// Corners of the batch's segments: (segment, place), in order.
pub(super) fn corners(
    segments: &[Segment],
    vertices: &[Vertex],
    z: &[f32],
    lattice: &Lattice,
    sampler: &mut dyn Sampler,
    scratch: &mut Scratch,
) -> Result<Vec<(usize, DVec2)>, FieldError> {
    let mut found: Vec<(usize, DVec2, f64)> = Vec::new();
    for (n, s) in segments.iter().enumerate() {
        let (p, q) = (vertices[s.from as usize], vertices[s.to as usize]);
        let (Some(u), Some(v)) =
            (p.gradient.try_normalize(), q.gradient.try_normalize())
        else {
            continue;
        };
        if u.dot(v) > COS_TURN {
            continue;
        }
        // c with u·(c − p) = 0 and v·(c − q) = 0.
        let sine = u.perp_dot(v);
        if sine.abs() < 0.05 {
            continue;
        }
        let along = u.perp();
        let c = p.point + along * (v.dot(q.point - p.point) / v.dot(along));
        let chord = q.point - p.point;
        let height = chord.perp_dot(c - p.point).abs() / chord.length();
        if height.is_finite() && height > 1e-6 {
            found.push((n, c, height));
        }
    }
    found.retain(|&(n, c, _)| {
        let cell = segments[n].cell.map(|i| i as i64);
        let own = locate(lattice, c);
        (own[0] - cell[0]).abs() <= 1 && (own[1] - cell[1]).abs() <= 1
    });
    if found.is_empty() {
        return Ok(Vec::new());
    }
    // At each candidate, and at the corners of the cell it lies in.
    scratch.clear();
    for &(n, c, _) in &found {
        let z = z[segments[n].layer];
        scratch.push(c, z);
        let [i, j] = locate(lattice, c).map(|i| i.max(0) as usize);
        for (di, dj) in [(0, 0), (1, 0), (1, 1), (0, 1)] {
            let node =
                |axis: &[f32], i: usize| f64::from(axis[i.min(axis.len() - 1)]);
            let p =
                DVec2::new(node(&lattice.x, i + di), node(&lattice.y, j + dj));
            scratch.push(p, z);
        }
    }
    let s = &mut *scratch;
    sampler.values(&s.x, &s.y, &s.z, &mut s.values)?;
    let accepted = found.iter().zip(s.values.chunks_exact(5)).filter(
        |((n, c, height), f)| {
            let seg = &segments[*n];
            let own = locate(lattice, *c) == seg.cell.map(|i| i as i64);
            let inside = f[1..].iter().filter(|f| **f < 0.0).count();
            let free = own || inside == 0 || inside == 4;
            let slope = vertices[seg.from as usize]
                .gradient
                .length()
                .max(vertices[seg.to as usize].gradient.length());
            free && f64::from(f[0]).abs() <= RESIDUE * height * slope
        },
    );
    Ok(accepted.map(|((n, c, _), _)| (*n, *c)).collect())
}

/// Lattice column and row of the cell that a point lies in.
fn locate(lattice: &Lattice, p: DVec2) -> [i64; 2] {
    let find = |axis: &[f32], v: f64| {
        let first = f64::from(axis[0]);
        ((v - first) / lattice.spacing).floor() as i64
    };
    [find(&lattice.x, p.x), find(&lattice.y, p.y)]
}
