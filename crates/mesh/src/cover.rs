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
use crate::ray::Direction;
use crate::repair::fill::Filler;
use crate::repair::loops::{Missing, loops};
use crate::rim::RimEdge;
use crate::shell::Shell;
use crate::tree::{Node, gap};
use glam::DVec3;
use isocontour::Bounds;
use std::collections::BTreeMap;

/// Triangles at which covers are compared with winding numbers.
const LOOKS: usize = 500;
/// How far from a triangle, as a share of the root of its area.
const OFFSETS: [f64; 4] = [-0.3, -0.05, 0.05, 0.3];
/// The share of places that may differ. Where a rim is not flat, the surface of
/// winding number one half is not quite a cover.
const MAY_DIFFER: f64 = 0.05;

/// Triangles that close others.
#[derive(Debug)]
pub(crate) struct Cover {
    pub shell: Shell,
    /// For each vertex its number among those of the closed triangles.
    pub numbers: Vec<u32>,
}

impl Cover {
    pub(crate) fn new(
        shell: &Shell,
        rim: &[RimEdge],
    ) -> Result<Cover, MeshError> {
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
        for found in loops(&shell.vertices, &shell.corners, &edges) {
            let ring: Vec<u32> =
                found.iter().map(|e| edges[*e as usize].from).collect();
            corners.append(&mut filler.fill(&ring)?);
        }
        let mut used: Vec<u32> = corners.as_flattened().to_vec();
        used.sort_unstable();
        used.dedup();
        for corner in corners.as_flattened_mut() {
            *corner = used.partition_point(|v| v < corner) as u32;
        }
        let place = |v: &u32| shell.vertices[*v as usize];
        let bits = |p: DVec3| p.to_array().map(f64::to_bits);
        let number: BTreeMap<_, u32> =
            used.iter().map(|v| (bits(place(v)), *v)).collect();
        let cover = Shell::new(used.iter().map(place).collect(), corners);
        let numbers =
            cover.vertices.iter().map(|p| number[&bits(*p)]).collect();
        Ok(Cover {
            shell: cover,
            numbers,
        })
    }

    /// True if what is inside with the cover is so by winding numbers too.
    pub(crate) fn agrees(
        &self,
        shell: &Shell,
        direction: impl Fn(DVec3) -> Direction,
        winding: impl Fn(DVec3) -> f64,
    ) -> bool {
        let count = self.shell.corners.len();
        let looks = LOOKS.min(count);
        let mut differ = 0;
        for i in 0..looks {
            let triangle = i * count / looks;
            let [a, b, c] = self.shell.triangle(triangle);
            let normal = self.shell.normal(triangle);
            let Some(across) = normal.try_normalize() else {
                continue;
            };
            let length = (0.5 * normal.length()).sqrt();
            for offset in OFFSETS {
                let p = (a + b + c) / 3.0 + across * (offset * length);
                let whole = self.winding(shell, p, direction(p));
                differ += usize::from((whole > 0) != (winding(p) > 0.5));
            }
        }
        differ as f64 <= MAY_DIFFER * (looks * OFFSETS.len()) as f64
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
        let mut meets = false;
        let near = |node: &Node| {
            [0, 1, 2, 3].map(|i| gap(over, &node.bounds(i)) == 0.0)
        };
        self.shell.tree.visit(near, |_, _| meets = true);
        meets
    }

    /// Memory, bytes.
    pub(crate) fn bytes(&self) -> usize {
        self.shell.bytes() + self.numbers.capacity() * size_of::<u32>()
    }
}
