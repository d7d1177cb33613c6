//! Writes triangles.

use super::error::ExportError;
use glam::DVec3;
use isocontour::{Bounds, Data};
use isoslice_mesh::Mesh;
use std::any::Any;
use std::io::Write;

/// Lines between two questions whether to go on.
const ASK: usize = 1 << 16;

/// The sides of a box, counter-clockwise as seen from outside. Bit k of a corner's
/// number says on which end of axis k it is.
pub(crate) const SIDES: [[u32; 4]; 6] = [
    [0, 2, 3, 1],
    [4, 5, 7, 6],
    [0, 1, 5, 4],
    [2, 6, 7, 3],
    [0, 4, 6, 2],
    [1, 3, 7, 5],
];

/// Number of vertices and triangles of a box.
pub(super) const CUBOID: usize = 8 + 2 * SIDES.len();

/// The mesh that data is, if it is one.
pub(super) fn mesh_of(data: &dyn Data) -> Option<&Mesh> {
    let data: &dyn Any = data;
    data.downcast_ref()
}

/// Writes a box.
pub(super) fn cuboid(
    bounds: &Bounds,
    out: &mut dyn Write,
) -> Result<(), ExportError> {
    let ends = [bounds.min, bounds.max];
    let corner =
        |i: usize| DVec3::from_array([0, 1, 2].map(|k| ends[i >> k & 1][k]));
    let corners: Vec<DVec3> = (0..8).map(corner).collect();
    let halves = |[a, b, c, d]: [u32; 4]| [[a, b, c], [a, c, d]];
    let faces: Vec<[u32; 3]> = SIDES.into_iter().flat_map(halves).collect();
    all(&corners, &faces, out)
}

/// Writes a mesh.
pub(super) fn triangles(
    mesh: &Mesh,
    out: &mut dyn Write,
) -> Result<(), ExportError> {
    let (vertices, corners) = mesh.triangles();
    all(vertices, corners, out)
}

fn all(
    vertices: &[DVec3],
    corners: &[[u32; 3]],
    out: &mut dyn Write,
) -> Result<(), ExportError> {
    writeln!(out, "<mesh><vertices>")?;
    for (i, v) in vertices.iter().enumerate() {
        if i % ASK == 0 {
            isoslice_base::limits::go_on()?;
        }
        let DVec3 { x, y, z } = v;
        writeln!(out, "<vertex x=\"{x}\" y=\"{y}\" z=\"{z}\"/>")?;
    }
    writeln!(out, "</vertices><triangles>")?;
    for (i, [a, b, c]) in corners.iter().enumerate() {
        if i % ASK == 0 {
            isoslice_base::limits::go_on()?;
        }
        writeln!(out, "<triangle v1=\"{a}\" v2=\"{b}\" v3=\"{c}\"/>")?;
    }
    writeln!(out, "</triangles></mesh>")?;
    Ok(())
}
