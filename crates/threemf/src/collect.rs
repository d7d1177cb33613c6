//! Triangles of objects.

use crate::marks::Marks;
use crate::model::{Model, Object};
use glam::DAffine3;
use isoslice_mesh::{Collector, MeshError, Triangles};

/// Triangles between two questions whether to go on.
const ASK: usize = 1 << 16;

/// The mesh of an object as it is in the file.
pub(crate) fn triangles(
    model: &Model,
    path: &str,
    id: u32,
) -> Result<Triangles, MeshError> {
    mesh_of(model, path, id, DAffine3::IDENTITY)
}

/// The mesh of an object where `by` puts it.
pub(crate) fn mesh_of(
    model: &Model,
    path: &str,
    id: u32,
    by: DAffine3,
) -> Result<Triangles, MeshError> {
    let place = format!("{path}, object {id}");
    let Some(object) = model.objects.get(&id) else {
        return Err(MeshError::at(place, "it is named, and is not there"));
    };
    let mut all = Collector::default();
    collect(&place, id, object, by, None, &mut all)?;
    all.finish().map_err(|e| match e {
        MeshError::Empty => MeshError::at(place, "it has no triangles"),
        other => other,
    })
}

/// Adds the triangles of an object where `by` puts them. Returned: what of it is
/// no part of the body.
pub(crate) fn collect(
    place: &str,
    id: u32,
    object: &Object,
    by: DAffine3,
    marks: Option<&Marks>,
    all: &mut Collector,
) -> Result<Vec<&'static str>, MeshError> {
    let place = |what: &str, i: usize| format!("{place}, {what} {i}");
    // A vertex of beams alone takes no part in the mesh.
    let seen = if object.triangles.is_empty() {
        &[][..]
    } else {
        &object.vertices[..]
    };
    let vertices: Vec<u32> = seen
        .iter()
        .enumerate()
        .map(|(i, v)| {
            let p = by.transform_point3(*v);
            all.vertex(p, || place("vertex", i))
        })
        .collect::<Result<_, _>>()?;
    let mirrors = by.matrix3.determinant() < 0.0;
    let mut left_out = Vec::new();
    for (i, corners) in object.triangles.iter().enumerate() {
        if i % ASK == 0 {
            isoslice_base::limits::go_on()?;
        }
        if let Some(what) = marks.and_then(|m| m.of_triangle(id, i)) {
            if !left_out.contains(&what) {
                left_out.push(what);
            }
            continue;
        }
        let corner = |k: usize| vertices.get(corners[k] as usize).copied();
        let (Some(a), Some(b), Some(c)) = (corner(0), corner(1), corner(2))
        else {
            let count = vertices.len();
            let what = format!(
                "it names a vertex that there is not; there are {count}, and \
                 the first is 0"
            );
            return Err(MeshError::at(place("triangle", i), what));
        };
        all.triangle(if mirrors { [a, c, b] } else { [a, b, c] })?;
    }
    Ok(left_out)
}
