//! Covers over the openings of a sheet.
//!
//! A bowl without a thickness has an opening, and winding numbers say that it
//! holds what is below a cover over it. With the cover the triangles are closed:
//! rays count exactly, and sections are whole. It is no part of the surface, and
//! distances do not know of it.
//!
//! Many sheets may bound a body together that none of them bounds alone, as the
//! triangles of a mesh with gaps at all edges do. There covers are wrong, and
//! winding numbers alone count.

use crate::error::MeshError;
use crate::fill::Filler;
use crate::loops::{Missing, loops};
use crate::ray::Direction;
use crate::rim::RimEdge;
use crate::shell::{ROUNDINGS, Shell};
use crate::tree::Node;
use glam::DVec3;
use isocontour::Bounds;
use isoslice_base::limits::{go_on, is_stopped};
use rayon::prelude::*;
use std::cell::Cell;
use std::collections::HashSet;

/// Places at which covers are compared with winding numbers. If all triangles lie
/// on one another, each takes the time of all triangles.
const LOOKS: usize = 400;
/// Triangles of a loop from which it is looked.
const BY_LOOP: usize = 16;
/// How far, as a share of the root of the area of the loop's cover. Nearer, winding
/// numbers are one half but for roundings.
const OFFSETS: [f64; 4] = [-0.3, -0.1, 0.1, 0.3];
/// The share of places that may differ. Where a rim is not flat, the surface of
/// winding number one half is not quite a cover. Where covers are wrong, about
/// half of the places differ.
const MAY_DIFFER: f64 = 0.1;

/// Triangles that close others.
#[derive(Debug)]
pub(crate) struct Cover {
    pub shell: Shell,
    /// For each vertex its number among those of the closed triangles.
    pub numbers: Vec<u32>,
    /// What of the cover does not lie on a triangle that it closes.
    alone: Shell,
}

impl Cover {
    /// Also returned: places at which it is to be compared with winding numbers.
    pub(crate) fn new(
        shell: &Shell,
        rim: &[RimEdge],
    ) -> Result<(Cover, Vec<DVec3>), MeshError> {
        let edges: Vec<Missing> = rim
            .iter()
            .flat_map(|edge| {
                let missing = Missing {
                    from: edge.to,
                    to: edge.from,
                    part: 0,
                };
                (0..edge.times).map(move |_| missing)
            })
            .collect();
        let mut filler = Filler::new(&shell.vertices);
        let mut corners = Vec::new();
        let mut places = Vec::new();
        for found in loops(&shell.vertices, &shell.corners, &edges) {
            go_on()?;
            let ring: Vec<u32> =
                found.iter().map(|e| edges[*e as usize].from).collect();
            let mut lid = filler.fill(&ring)?;
            look(&shell.vertices, &lid, &mut places);
            corners.append(&mut lid);
        }
        let alone = alone(shell, &corners);
        let mut used: Vec<u32> = corners.as_flattened().to_vec();
        used.sort_unstable();
        used.dedup();
        for corner in corners.as_flattened_mut() {
            *corner = used.partition_point(|v| v < corner) as u32;
        }
        let place = |v: &u32| shell.vertices[*v as usize];
        let vertices = used.iter().map(place).collect();
        let (cover, order) = Shell::sorted(vertices, corners);
        let numbers = order.iter().map(|v| used[*v as usize]).collect();
        let step = places.len().div_ceil(LOOKS).max(1);
        let places = places.into_iter().step_by(step).collect();
        Ok((
            Cover {
                shell: cover,
                numbers,
                alone,
            },
            places,
        ))
    }

    /// True if what is inside with the cover is so by winding numbers too.
    pub(crate) fn agrees(
        &self,
        shell: &Shell,
        places: &[DVec3],
        direction: impl Fn(DVec3) -> Direction + Sync,
        winding: impl Fn(DVec3) -> f64 + Sync,
    ) -> bool {
        let differs = |p: &&DVec3| {
            if is_stopped() {
                return false;
            }
            let whole = self.winding(shell, **p, direction(**p));
            (whole > 0) != (winding(**p) > 0.5)
        };
        let differ = places.par_iter().filter(differs).count();
        differ as f64 <= MAY_DIFFER * places.len() as f64
    }

    /// The winding number of the closed triangles.
    pub(crate) fn winding(
        &self,
        shell: &Shell,
        p: DVec3,
        direction: Direction,
    ) -> i64 {
        shell.crossings(p, direction, |_| true)
            + self.shell.crossings(p, direction, |_| true)
    }

    /// True if a box may meet a triangle of the cover.
    pub(crate) fn meets(&self, over: &Bounds) -> bool {
        meets(&self.shell, over)
    }

    /// True if a box may meet the cover at a place that is on no triangle.
    pub(crate) fn is_alone(&self, over: &Bounds) -> bool {
        meets(&self.alone, over)
    }

    /// What of the cover does not lie on a triangle that it closes.
    pub(crate) fn alone(&self) -> &Shell {
        &self.alone
    }

    /// Memory, bytes.
    pub(crate) fn bytes(&self) -> usize {
        self.shell.bytes()
            + self.alone.bytes()
            + self.numbers.capacity() * size_of::<u32>()
    }
}

/// True if a box may meet a triangle.
fn meets(shell: &Shell, over: &Bounds) -> bool {
    let own = over.min.abs().max(over.max.abs());
    let meets = Cell::new(false);
    let near = |node: &Node| {
        let left = !meets.get();
        [0, 1, 2, 3].map(|i| left && over.gap(&node.bounds(i)) == 0.0)
    };
    // The boxes around large triangles hold places that are far from them.
    shell.tree.visit(near, |first, end| {
        let touches = |i| {
            // A small box may meet a triangle whose corners are far away.
            let corners = shell.triangle(i).into_iter();
            let scale = corners.fold(own, |most, p| most.max(p.abs()));
            shell.apart(i, over) <= ROUNDINGS * scale.max_element()
        };
        meets.set(meets.get() || (first..end).any(touches));
    });
    meets.get()
}

/// What of a cover does not lie on a triangle of the shell. A loose triangle's cover
/// is its own back.
fn alone(shell: &Shell, cover: &[[u32; 3]]) -> Shell {
    let sorted = |mut corners: [u32; 3]| {
        corners.sort_unstable();
        corners
    };
    let mut left: HashSet<[u32; 3]> =
        cover.iter().copied().map(sorted).collect();
    for corners in &shell.corners {
        left.remove(&sorted(*corners));
    }
    let is_left = |corners: &&[u32; 3]| left.contains(&sorted(**corners));
    let left = cover.iter().filter(is_left);
    let triangles = left.map(|t| t.map(|v| shell.vertices[v as usize]));
    let vertices: Vec<DVec3> = triangles.flatten().collect();
    let corners =
        (0..vertices.len() as u32 / 3).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]);
    let corners = corners.collect();
    Shell::new(vertices, corners)
}

/// Adds places on both sides of the triangles over a loop.
fn look(vertices: &[DVec3], lid: &[[u32; 3]], places: &mut Vec<DVec3>) {
    let normal = |corners: &[u32; 3]| {
        let [a, b, c] = corners.map(|v| vertices[v as usize]);
        (0.5 * (b - a).cross(c - a), (a + b + c) / 3.0)
    };
    let area: f64 = lid.iter().map(|t| normal(t).0.length()).sum();
    let step = lid.len().div_ceil(BY_LOOP).max(1);
    for (normal, middle) in lid.iter().step_by(step).map(normal) {
        if let Some(across) = normal.try_normalize() {
            let at = |share| middle + across * (share * area.sqrt());
            places.extend(OFFSETS.map(at));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_boxes_meet_large_triangles_that_they_touch() {
        let mut random = fastrand::Rng::with_seed(5);
        let mut whole = || f64::from(random.i32(-1_000_000..1_000_000));
        for _ in 0..1000 {
            let [a, b] =
                [(); 2].map(|()| DVec3::new(whole(), whole(), whole()));
            // The middle of the triangle is the origin, without any rounding.
            let shell = Shell::new(vec![a, b, -a - b], vec![[0, 1, 2]]);
            let corner = 1e-3 * a.cross(b).signum();
            let over = Bounds::around([corner, DVec3::ZERO]);
            assert!(meets(&shell, &over), "{a} {b}");
            assert!(!meets(&shell, &over.moved(corner)), "{a} {b}");
        }
    }
}
