//! Places all that is to be built.
//!
//! In: an archive. Out: triangles, struts, and lattices that cannot be struts at
//! their places: those that are clipped, and those that are not scaled evenly.

use crate::collect::{collect, mesh_of, triangles};
use crate::functions::evaluate::{Budget, Evaluator, Leaves};
use crate::lattice::{Lattice, Side, scale};
use crate::leaves::{Files, Known};
use crate::level::{LevelSet, cuboid, places};
use crate::marks::Marks;
use crate::model::{self, MOST_PLACED, Model, OTHER, Object, Reference};
use crate::package::Package;
use crate::relations;
use fidget::context::Tree;
use glam::{DAffine3, DVec3};
use isocontour::{Bounds, Data, SearchOptions, find_bounds};
use isoslice_base::limits::Watch;
use isoslice_mesh::{
    Collector, MOST_STRUTS, MOST_TRIANGLES, MeshError, Strut, Triangles,
};
use std::collections::{BTreeMap, BTreeSet};
use std::io::{Read, Seek};
use std::rc::Rc;
use std::sync::Arc;

/// Greatest number of objects between an item and a mesh. Slicers use two.
const DEEPEST: usize = 32;
/// Greatest number of vertices, triangles and beams that are placed, those that are
/// left out included: twice as many triangles as there may be.
const MOST_LOOKED_AT: usize = if cfg!(test) {
    1_000_000
} else {
    2 * MOST_TRIANGLES
};
/// Greatest number of lattices that are clipped or not scaled evenly. Each is a
/// function of its own.
const MOST_CLIPPED: usize = 1000;

/// Greatest number of level sets that are placed. Each is a function of its own.
const MOST_LEVELS: usize = 1000;

/// Greatest number of level sets for which is found out whether their boxes cut
/// anything off.
const MOST_UNBOXED: usize = 4;
/// Interval operations for that. The range of a mesh counts as one of them and
/// takes longer: it was 1 s for a gyroid in a mesh of 170,000 triangles, and 3 s for
/// one in four such meshes.
const UNBOXED_WORK: u64 = 4_000_000;

/// The files with the settings of a project: PrusaSlicer's, OrcaSlicer's and Bambu
/// Studio's.
const SETTINGS: [&str; 2] = [
    "Metadata/Slic3r_PE.config",
    "Metadata/project_settings.config",
];

/// What is to be built.
#[derive(Default)]
pub(crate) struct Parts {
    /// All triangles that are no clipping mesh's.
    pub triangles: Option<Triangles>,
    pub struts: Vec<Strut>,
    pub clipped: Vec<Clipped>,
    pub levels: Vec<Level>,
    /// The data of level sets.
    pub data: Vec<Arc<dyn Data>>,
    /// What is no part of the body, and was left out.
    pub left_out: Vec<String>,
    /// The file with the settings of a slicer, if the archive has one.
    pub settings: Option<&'static str>,
}

impl Parts {
    fn is_empty(&self) -> bool {
        self.triangles.is_none()
            && self.struts.is_empty()
            && self.clipped.is_empty()
            && self.levels.is_empty()
    }
}

/// A lattice that is clipped, or that is not scaled evenly.
pub(crate) struct Clipped {
    pub struts: Vec<Strut>,
    /// The mesh that clips it, and the side that stays.
    pub by: Option<(Triangles, Side)>,
    /// Where both are put, unless they are there.
    pub place: DAffine3,
}

/// A level set where it is put.
pub(crate) struct Level {
    pub tree: Tree,
    pub place: DAffine3,
}

pub(crate) fn read(
    name: &str,
    source: impl Read + Seek,
) -> Result<Parts, MeshError> {
    let mut package = Package::open(source)?;
    let root = relations::read(&mut package)?;
    let marks = Marks::read(&mut package)?;
    let model = model::read(&mut package, &root)?;
    let unit = model.unit;
    let items = model.items.clone();
    let mut building = Building {
        package,
        root: root.clone(),
        models: BTreeMap::from([(root.clone(), Rc::new(model))]),
        marks,
        all: Collector::default(),
        parts: Parts::default(),
        name: name.to_owned(),
        levels: BTreeMap::new(),
        known: Known::default(),
        budget: Budget::new(),
        placed: 0,
        looked_at: 0,
        struts: 0,
        open: Vec::new(),
        short: 0,
        thin: 0,
    };
    let scale = DAffine3::from_scale(DVec3::splat(unit));
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
    models: BTreeMap<String, Rc<Model>>,
    marks: Marks,
    /// All triangles.
    all: Collector,
    /// All else.
    parts: Parts,
    /// How messages call the file.
    name: String,
    /// Level sets by file and number, once they were made.
    levels: BTreeMap<(String, u32), Tree>,
    known: Known,
    budget: Budget,
    placed: usize,
    /// Number of vertices, triangles and beams that were placed.
    looked_at: usize,
    /// Number of struts, those that are clipped included.
    struts: usize,
    /// The objects that hold what is placed now, with their files.
    open: Vec<(String, u32)>,
    /// Number of beams that were too short.
    short: usize,
    /// Number of beams and balls of no thickness.
    thin: usize,
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
        if self.thin > 0 {
            let what = format!("{} beams or balls of no thickness", self.thin);
            self.leave_out(&what);
        }
        let models = self.models.values();
        let painted = models.flat_map(|model| model.painted.iter().copied());
        for what in painted.collect::<BTreeSet<_>>() {
            self.leave_out(what);
        }
        let names = self.package.names();
        let mut parts = self.parts;
        parts.settings = SETTINGS
            .into_iter()
            .find(|name| names.contains(&name.to_lowercase()));
        parts.triangles = match self.all.finish() {
            Ok(triangles) => Some(triangles),
            Err(MeshError::Empty) => None,
            Err(other) => return Err(other),
        };
        if self.short + self.thin > 0 && parts.is_empty() {
            return Err(MeshError::File(
                "nothing is left to build: its beams are too short or have no \
                 thickness; give them a radius, or save it with longer ones"
                    .to_owned(),
            ));
        }
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
            self.models.insert(path.to_owned(), Rc::new(model));
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
        let place = format!("{path}, object {id}");
        self.look_at(object).map_err(|e| e.within(&place))?;
        let marks = (path == self.root).then_some(&self.marks);
        for what in collect(&place, id, object, by, marks, &mut self.all)? {
            self.leave_out(what);
        }
        if let Some(lattice) = &object.lattice {
            self.add_lattice(path, object, lattice, by)
                .map_err(|e| e.within(&place))?;
        }
        if let Some(level) = &object.level {
            self.add_level(path, id, level, by)
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

    /// Counts the work of placing an object, of which nothing may be left.
    fn look_at(&mut self, object: &Object) -> Result<(), MeshError> {
        let beams = object.lattice.as_ref().map_or(0, Lattice::len);
        self.looked_at +=
            object.vertices.len() + object.triangles.len() + beams;
        if self.looked_at <= MOST_LOOKED_AT {
            return Ok(());
        }
        Err(MeshError::File(format!(
            "objects are placed so often that there are more than {} million \
             vertices, triangles and beams; place fewer",
            MOST_LOOKED_AT / 1_000_000
        )))
    }

    fn add_level(
        &mut self,
        path: &str,
        id: u32,
        level: &LevelSet,
        by: DAffine3,
    ) -> Result<(), MeshError> {
        if self.parts.levels.len() >= MOST_LEVELS {
            return Err(MeshError::File(format!(
                "more than {MOST_LEVELS} level sets are placed"
            )));
        }
        if !by.inverse().is_finite() {
            return Err(MeshError::File(
                "its transform makes it flat".to_owned(),
            ));
        }
        let key = (path.to_owned(), id);
        let tree = match self.levels.get(&key) {
            Some(tree) => tree.clone(),
            None => self.level_of(path, level)?,
        };
        self.levels.insert(key, tree.clone());
        self.parts.levels.push(Level { tree, place: by });
        Ok(())
    }

    /// A level set as it is in the file.
    fn level_of(
        &mut self,
        path: &str,
        level: &LevelSet,
    ) -> Result<Tree, MeshError> {
        let Some(model) = self.models.get(path).map(Rc::clone) else {
            return Err(MeshError::at(path, "it is not there"));
        };
        if model.has_volume_data {
            self.leave_out("what varies inside bodies, such as colours");
        }
        let around = triangles(&model, path, level.mesh)?;
        let mut leaves = Files {
            name: &self.name,
            path,
            model: &model,
            package: &mut self.package,
            known: &mut self.known,
            data: &mut self.parts.data,
        };
        let at = places(&level.transform);
        let tree = {
            let budget = &mut self.budget;
            Evaluator::new(&model.functions, path, &mut leaves, budget)
                .channel(level.function, &level.channel, at)?
        };
        let tree = level.defined(tree);
        let bounds = around.bounds();
        let within = if level.is_in_box || is_box(&around, &bounds) {
            let is_tried = self.levels.len() < MOST_UNBOXED;
            if is_tried && is_inside(&tree, &bounds)? {
                return Ok(tree);
            }
            cuboid(&bounds)
        } else {
            let (x, y, z) = Tree::axes();
            leaves.mesh(level.mesh, [x, y, z])?
        };
        Ok(tree.max(within))
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
        self.thin += placed.thin;
        self.struts += placed.struts.len();
        if self.struts > MOST_STRUTS {
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
        if !place.inverse().is_finite() {
            return Err(MeshError::File(
                "its transform makes it flat".to_owned(),
            ));
        }
        let by_mesh = match lattice.clipped {
            Some((clip, side)) => {
                let model = self.models.get(path).map(Rc::clone);
                let model = model.ok_or(MeshError::Empty)?;
                if let Some(object) = model.objects.get(&clip) {
                    self.look_at(object)?;
                }
                Some((mesh_of(&model, path, clip, seen)?, side))
            }
            None => None,
        };
        self.parts.clipped.push(Clipped {
            struts: placed.struts,
            by: by_mesh,
            place,
        });
        Ok(())
    }
}

/// True if a box surely cuts nothing off. Without the box a function is the one that
/// was written, operation by operation.
fn is_inside(tree: &Tree, around: &Bounds) -> Result<bool, MeshError> {
    let options = SearchOptions {
        max_work: UNBOXED_WORK,
        ..SearchOptions::default()
    };
    let found = find_bounds(tree, &options, &Watch::hook());
    isoslice_base::limits::go_on()?;
    Ok(found.is_ok_and(|found| {
        let Bounds { min, max } = found.bounds;
        min.cmpgt(around.min).all() && max.cmplt(around.max).all()
    }))
}

/// True if a mesh is the box around it.
fn is_box(mesh: &Triangles, bounds: &Bounds) -> bool {
    let is_at_corner = |v: &DVec3| {
        let ends = v.cmpeq(bounds.min) | v.cmpeq(bounds.max);
        ends.all()
    };
    // Corners of a triangle that lies on a side have one coordinate alike.
    let is_on_side = |corners: &[u32; 3]| {
        let [a, b, c] = corners.map(|i| mesh.vertices.get(i as usize));
        a.zip(b)
            .zip(c)
            .is_some_and(|((a, b), c)| (a.cmpeq(*b) & b.cmpeq(*c)).any())
    };
    mesh.vertices.len() == 8
        && mesh.corners.len() == 12
        && mesh.vertices.iter().all(is_at_corner)
        && mesh.corners.iter().all(is_on_side)
}
