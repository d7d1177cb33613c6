//! 3MF: an archive of XML files, with meshes that are built from one another.
//!
//! ```text
//!  build: item ── transform ──▶ object ── component, transform ──▶ object
//!                                                                  │
//!                                mesh: vertices, triangles  ◀──────┘
//! ```
//!
//! Read are the core specification and the production extension, by which objects
//! are in other files of the archive. Projects of PrusaSlicer, OrcaSlicer, Bambu
//! Studio and Cura hold more than the body: what they call modifiers, negative
//! volumes and supports is left out.
//!
//! Guaranteed: files in the archive are unpacked piece by piece, once each, and
//! bounded in length; objects that hold one another end in an error.

mod marks;
mod model;
mod package;
mod xml;

use crate::error::MeshError;
use crate::triangles::{Collector, Triangles};
use glam::{DAffine3, DVec3};
use marks::Marks;
use model::{Model, OTHER, Object, Reference};
use package::Package;
use std::collections::BTreeMap;
use std::io::{Read, Seek};

/// Greatest number of objects between an item and a mesh. Slicers use two.
const DEEPEST: usize = 32;
/// Greatest number of objects that are placed. Plates hold some hundreds.
const MOST_PLACED: usize = 100_000;

pub(super) fn read(source: impl Read + Seek) -> Result<Triangles, MeshError> {
    let mut package = Package::open(source)?;
    let root = package.root()?;
    let marks = Marks::read(&mut package)?;
    let model = model::read(&mut package, &root)?;
    let unit = model.unit;
    let items = model.items.clone();
    let mut building = Building {
        package,
        root: root.clone(),
        models: BTreeMap::from([(root.clone(), model)]),
        marks,
        all: Collector::new(),
        placed: 0,
        left_out: Vec::new(),
    };
    let scale = DAffine3::from_scale(DVec3::splat(unit.millimetres()));
    for item in &items {
        if !item.is_printable {
            building.leave_out("an object that is not printable");
            continue;
        }
        building.place(&root, &item.reference, scale, 0)?;
    }
    let Building { all, left_out, .. } = building;
    let mut triangles = match all.finish() {
        Err(MeshError::Empty) if items.is_empty() => {
            return Err(MeshError::at(
                root,
                "nothing is to be built in it; add the part to the plate and \
                 save it again",
            ));
        }
        other => other?,
    };
    triangles.unit = Some(unit.name());
    triangles.left_out = left_out;
    Ok(triangles)
}

struct Building<R> {
    package: Package<R>,
    root: String,
    models: BTreeMap<String, Model>,
    marks: Marks,
    all: Collector,
    placed: usize,
    left_out: Vec<String>,
}

impl<R: Read + Seek> Building<R> {
    fn leave_out(&mut self, what: &str) {
        if !self.left_out.iter().any(|w| w == what) {
            self.left_out.push(what.to_owned());
        }
    }

    /// Places an object that is named in the file `from`.
    fn place(
        &mut self,
        from: &str,
        reference: &Reference,
        by: DAffine3,
        depth: usize,
    ) -> Result<(), MeshError> {
        let path = reference.path.as_deref().unwrap_or(from);
        if depth > DEEPEST {
            let what =
                "too many objects inside one another; save the file again";
            return Err(MeshError::at(path, what));
        }
        self.placed += 1;
        if self.placed > MOST_PLACED {
            let what = format!("more than {MOST_PLACED} objects are placed");
            return Err(MeshError::at(path, what));
        }
        isoslice_base::limits::go_on()?;
        if !self.models.contains_key(path) {
            let model = model::read(&mut self.package, path)?;
            self.models.insert(path.to_owned(), model);
        }
        let object = self.models.get_mut(path);
        let object = object.and_then(|m| m.objects.get_mut(&reference.id));
        let Some(object) = object else {
            let what = format!(
                "there is no object {}, which {from} names; save the file again",
                reference.id
            );
            return Err(MeshError::at(path, what));
        };
        if object.is_open {
            let what = format!(
                "object {} holds itself; save the file again",
                reference.id
            );
            return Err(MeshError::at(path, what));
        }
        if depth == 0 && object.left_out == Some(OTHER) {
            let what = format!(
                "object {} is to be built, and is of the type `other`, which \
                 is not",
                reference.id
            );
            return Err(MeshError::at(path, what));
        }
        if let Some(what) = object.left_out {
            self.leave_out(what);
            return Ok(());
        }
        let by = by * reference.transform;
        // It is put back below.
        let opened = Object {
            is_open: true,
            ..Object::default()
        };
        let object = std::mem::replace(object, opened);
        let result = self.place_parts(path, reference.id, &object, by, depth);
        let place = self.models.get_mut(path);
        if let Some(place) =
            place.and_then(|m| m.objects.get_mut(&reference.id))
        {
            *place = object;
        }
        result
    }

    fn place_parts(
        &mut self,
        path: &str,
        id: u32,
        object: &Object,
        by: DAffine3,
        depth: usize,
    ) -> Result<(), MeshError> {
        self.place_mesh(path, id, object, by)?;
        for component in &object.components {
            let mark = self.marks.of_part(id, component.id);
            if let Some(what) = mark.filter(|_| path == self.root) {
                self.leave_out(what);
                continue;
            }
            self.place(path, component, by, depth + 1)?;
        }
        Ok(())
    }

    fn place_mesh(
        &mut self,
        path: &str,
        id: u32,
        object: &Object,
        by: DAffine3,
    ) -> Result<(), MeshError> {
        let place =
            |what: &str, i: usize| format!("{path}, object {id}, {what} {i}");
        let vertices: Vec<u32> = object
            .vertices
            .iter()
            .enumerate()
            .map(|(i, v)| {
                let p = by.transform_point3(*v);
                self.all.vertex(p, || place("vertex", i))
            })
            .collect::<Result<_, _>>()?;
        let mirrors = by.matrix3.determinant() < 0.0;
        for (i, corners) in object.triangles.iter().enumerate() {
            let mark = self.marks.of_triangle(id, i);
            if let Some(what) = mark.filter(|_| path == self.root) {
                self.leave_out(what);
                continue;
            }
            let corner = |k: usize| vertices.get(corners[k] as usize).copied();
            let (Some(a), Some(b), Some(c)) = (corner(0), corner(1), corner(2))
            else {
                let count = vertices.len();
                let what = format!(
                    "it names a vertex that there is not; there are {count}, \
                     and the first is 0"
                );
                return Err(MeshError::at(place("triangle", i), what));
            };
            self.all
                .triangle(if mirrors { [a, c, b] } else { [a, b, c] })?;
        }
        Ok(())
    }
}
