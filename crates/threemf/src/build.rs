//! Places all that is to be built.
//!
//! In: an archive. Out: triangles, struts, and lattices that cannot be struts at
//! their places: those that are clipped, and those that are not scaled evenly.

use crate::lattice::{Lattice, Side, scale};
use crate::marks::Marks;
use crate::model::{self, Model, OTHER, Object, Reference};
use crate::package::Package;
use glam::{DAffine3, DVec3};
use isoslice_mesh::{Collector, MOST_STRUTS, MeshError, Strut, Triangles};
use std::collections::BTreeMap;
use std::io::{Read, Seek};
use std::rc::Rc;

/// Greatest number of objects between an item and a mesh. Slicers use two.
const DEEPEST: usize = 32;
/// Greatest number of objects that are placed. Plates hold some hundreds.
const MOST_PLACED: usize = 100_000;
/// Greatest number of lattices that are clipped or not scaled evenly. Each is a
/// function of its own.
const MOST_CLIPPED: usize = 1000;

/// What is to be built.
#[derive(Default)]
pub(crate) struct Parts {
    /// All triangles that are no clipping mesh's.
    pub triangles: Option<Triangles>,
    pub struts: Vec<Strut>,
    pub clipped: Vec<Clipped>,
    /// What is no part of the body, and was left out.
    pub left_out: Vec<String>,
}

/// A lattice that is clipped, or that is not scaled evenly.
pub(crate) struct Clipped {
    pub struts: Vec<Strut>,
    /// The mesh that clips it, and the side that stays.
    pub by: Option<(Triangles, Side)>,
    /// Where both are put, unless they are there.
    pub place: DAffine3,
}

pub(crate) fn read(source: impl Read + Seek) -> Result<Parts, MeshError> {
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
        parts: Parts::default(),
        placed: 0,
        open: Vec::new(),
        short: 0,
    };
    let scale = DAffine3::from_scale(DVec3::splat(unit.millimetres()));
    for item in &items {
        if !item.is_printable {
            building.leave_out("an object that is not printable");
            continue;
        }
        building.place(&root, &item.reference, scale)?;
    }
    if items.is_empty() {
        return Err(MeshError::at(
            root,
            "nothing is to be built in it; add the part to the plate and save \
             it again",
        ));
    }
    building.finish()
}

struct Building<R> {
    package: Package<R>,
    root: String,
    models: BTreeMap<String, Model>,
    marks: Marks,
    /// All triangles.
    all: Collector,
    /// All else.
    parts: Parts,
    placed: usize,
    /// The objects that hold what is placed now, with their files.
    open: Vec<(String, u32)>,
    /// Number of beams that were too short.
    short: usize,
}

impl<R: Read + Seek> Building<R> {
    fn leave_out(&mut self, what: &str) {
        if !self.parts.left_out.iter().any(|w| w == what) {
            self.parts.left_out.push(what.to_owned());
        }
    }

    fn finish(mut self) -> Result<Parts, MeshError> {
        if self.short > 0 {
            let what = format!(
                "{} beams that are shorter than their lattice allows",
                self.short
            );
            self.leave_out(&what);
        }
        let mut parts = self.parts;
        parts.triangles = match self.all.finish() {
            Ok(triangles) => Some(triangles),
            Err(MeshError::Empty) => None,
            Err(other) => return Err(other),
        };
        Ok(parts)
    }

    /// Places an object that is named in the file `from`.
    fn place(
        &mut self,
        from: &str,
        reference: &Reference,
        by: DAffine3,
    ) -> Result<(), MeshError> {
        let path = reference.path.as_deref().unwrap_or(from);
        if self.open.len() > DEEPEST {
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
        let id = reference.id;
        let object = self.models.get(path).and_then(|m| m.objects.get(&id));
        let Some(object) = object.map(Rc::clone) else {
            let what = format!(
                "there is no object {id}, which {from} names; save the file \
                 again"
            );
            return Err(MeshError::at(path, what));
        };
        let is_open = |(p, i): &(String, u32)| p == path && *i == id;
        if self.open.iter().any(is_open) {
            let what = format!("object {id} holds itself; save the file again");
            return Err(MeshError::at(path, what));
        }
        if self.open.is_empty() && object.left_out == Some(OTHER) {
            let what = format!(
                "object {id} is to be built, and is of the type `other`, which \
                 is not"
            );
            return Err(MeshError::at(path, what));
        }
        if let Some(what) = object.left_out {
            self.leave_out(what);
            return Ok(());
        }
        self.open.push((path.to_owned(), id));
        self.place_parts(path, id, &object, by * reference.transform)?;
        self.open.pop();
        Ok(())
    }

    fn place_parts(
        &mut self,
        path: &str,
        id: u32,
        object: &Object,
        by: DAffine3,
    ) -> Result<(), MeshError> {
        let marks = (path == self.root).then_some(&self.marks);
        let place = format!("{path}, object {id}");
        for what in collect(&place, id, object, by, marks, &mut self.all)? {
            self.leave_out(what);
        }
        if let Some(lattice) = &object.lattice {
            self.add_lattice(path, object, lattice, by)
                .map_err(|e| e.within(&place))?;
        }
        for component in &object.components {
            let mark = self.marks.of_part(id, component.id);
            if let Some(what) = mark.filter(|_| path == self.root) {
                self.leave_out(what);
                continue;
            }
            self.place(path, component, by)?;
        }
        Ok(())
    }

    fn add_lattice(
        &mut self,
        path: &str,
        object: &Object,
        lattice: &Lattice,
        by: DAffine3,
    ) -> Result<(), MeshError> {
        // What is not scaled evenly has no struts any more.
        let (seen, scale, place) = match scale(&by.matrix3) {
            Some(scale) => (by, scale, DAffine3::IDENTITY),
            None => (DAffine3::IDENTITY, 1.0, by),
        };
        let placed = lattice.placed(&object.vertices, &seen, scale)?;
        self.short += placed.short;
        if self.parts.struts.len() + placed.struts.len() > MOST_STRUTS {
            return Err(MeshError::TooManyStruts);
        }
        if lattice.clipped.is_none() && place == DAffine3::IDENTITY {
            self.parts.struts.extend(placed.struts);
            return Ok(());
        }
        if placed.struts.is_empty() {
            return Ok(());
        }
        if self.parts.clipped.len() >= MOST_CLIPPED {
            return Err(MeshError::File(format!(
                "more than {MOST_CLIPPED} lattices are clipped, or scaled \
                 along one axis"
            )));
        }
        if place.matrix3.determinant() == 0.0 {
            return Err(MeshError::File(
                "its transform makes it flat".to_owned(),
            ));
        }
        let by_mesh = match lattice.clipped {
            Some((clip, side)) => Some((self.mesh_of(path, clip, seen)?, side)),
            None => None,
        };
        self.parts.clipped.push(Clipped {
            struts: placed.struts,
            by: by_mesh,
            place,
        });
        Ok(())
    }

    /// The mesh of an object where `by` puts it.
    fn mesh_of(
        &self,
        path: &str,
        id: u32,
        by: DAffine3,
    ) -> Result<Triangles, MeshError> {
        let object = self.models.get(path).and_then(|m| m.objects.get(&id));
        let place = format!("{path}, object {id}");
        let Some(object) = object else {
            return Err(MeshError::at(place, "it is not there"));
        };
        let mut all = Collector::new();
        collect(&place, id, object, by, None, &mut all)?;
        all.finish().map_err(|e| e.within(&place))
    }
}

/// Adds the triangles of an object where `by` puts them. Returned: what of it is
/// no part of the body.
fn collect(
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
