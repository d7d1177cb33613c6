//! A model file: objects, and what is to be built of them.

use crate::functions::Function;
use crate::functions::graph;
use crate::functions::image::{ImageFunction, Stack};
use crate::lattice::Lattice;
use crate::level::LevelSet;
use crate::package::{Held, Package};
use crate::sound::Sound;
use crate::space::Space;
use crate::transform::transform;
use crate::xml::{self, Element, Event};
use glam::{DAffine3, DVec3};
use isoslice_mesh::{MOST_TRIANGLES, MeshError};
use std::collections::{BTreeMap, BTreeSet};
use std::io::{Read, Seek};
use std::rc::Rc;

/// The units of lengths, as files name them, mm.
const UNITS: &[(&str, f64)] = &[
    ("micron", 1e-3),
    ("millimeter", 1.0),
    ("centimeter", 10.0),
    ("inch", 25.4),
    ("foot", 304.8),
    ("meter", 1e3),
];

/// An object at a place.
#[derive(Clone, Debug)]
pub(crate) struct Reference {
    /// The file that has it, if it is another one.
    pub path: Option<String>,
    pub id: u32,
    pub transform: DAffine3,
}

#[derive(Clone, Debug)]
pub(crate) struct Item {
    pub reference: Reference,
    pub is_printable: bool,
}

/// A mesh, objects at places, or both.
#[derive(Debug, Default)]
pub(crate) struct Object {
    pub vertices: Vec<DVec3>,
    pub triangles: Vec<[u32; 3]>,
    pub components: Vec<Reference>,
    pub lattice: Option<Lattice>,
    pub level: Option<LevelSet>,
    /// Why it is no part of the body, if it is none.
    pub left_out: Option<&'static str>,
}

impl Object {
    /// True for a mesh that may clip a lattice.
    fn is_plain_mesh(&self) -> bool {
        self.components.is_empty()
            && self.lattice.is_none()
            && self.level.is_none()
            && self.left_out.is_none()
    }
}

#[derive(Debug)]
pub(crate) struct Model {
    /// The unit of lengths, mm.
    pub unit: f64,
    pub objects: BTreeMap<u32, Rc<Object>>,
    pub items: Vec<Item>,
    pub functions: BTreeMap<u32, Function>,
    pub stacks: BTreeMap<u32, Stack>,
    /// True if something varies inside bodies, such as their colour.
    pub has_volume_data: bool,
    /// What is painted on its triangles.
    pub painted: BTreeSet<&'static str>,
}

/// Greatest number of objects that are placed. Plates hold some hundreds.
pub(crate) const MOST_PLACED: usize = 100_000;

/// Greatest number of vertices, triangles, beams and balls in all files of an archive:
/// twice as many triangles as there may be.
pub(crate) const MOST_SHAPES: usize = if cfg!(test) {
    1_000_000
} else {
    2 * MOST_TRIANGLES
};

/// Greatest number of nodes, inputs and outputs in all files of an archive. Each
/// takes some 100 bytes. The largest function that is written has 1.6 million.
const MOST_NODES: usize = if cfg!(test) { 1_300_000 } else { 4_000_000 };

/// An object of a type that must not be built.
pub(crate) const OTHER: &str = "an object that is not to be printed";

/// What Cura calls meshes that are no part of the body.
const OF_CURA: [(&str, &str); 4] = [
    ("cura:infill_mesh", "a modifier"),
    ("cura:cutting_mesh", "a modifier"),
    ("cura:support_mesh", "a support"),
    ("cura:anti_overhang_mesh", "a support blocker"),
];

/// What slicers paint on triangles, by the attribute's name. PrusaSlicer's have
/// the prefix slic3rpe.
fn painted(attribute: &str) -> Option<&'static str> {
    match attribute {
        "custom_supports" | "paint_supports" => Some("painted supports"),
        "custom_seam" | "paint_seam" => Some("painted seams"),
        "mmu_segmentation" | "paint_color" => Some("painted filaments"),
        "fuzzy_skin" | "paint_fuzzy_skin" => Some("painted fuzzy skin"),
        _ => None,
    }
}

/// Reads a model file of an archive.
pub(crate) fn read<R: Read + Seek>(
    package: &mut Package<R>,
    path: &str,
) -> Result<Model, MeshError> {
    let mut reading = Reading {
        model: Model {
            unit: 1.0,
            objects: BTreeMap::new(),
            items: Vec::new(),
            functions: BTreeMap::new(),
            stacks: BTreeMap::new(),
            has_volume_data: false,
            painted: BTreeSet::new(),
        },
        image: None,
        function: None,
        is_model: false,
        object: None,
        is_in_lattice: false,
        sound: Sound::default(),
        says: None,
        is_in_build: false,
        references: 0,
        held: package.held,
    };
    let found = package.with(path, |bytes| {
        xml::read(path, bytes, |event| reading.see(event))
    })?;
    package.held = reading.held;
    if found.is_none() {
        return Err(MeshError::File(format!(
            "there is no {path} in its archive; is it a 3MF file?"
        )));
    }
    if !reading.is_model {
        return Err(MeshError::at(path, "there is no model in it"));
    }
    Ok(reading.model)
}

struct Reading {
    model: Model,
    /// True once the first element was read.
    is_model: bool,
    object: Option<(u32, Object)>,
    is_in_lattice: bool,
    sound: Sound,
    /// The number of a stack of pictures, and the stack once it is there.
    image: Option<(u32, Option<Stack>)>,
    function: Option<(u32, graph::Reading)>,
    /// What a text says of the object, if it is true.
    says: Option<&'static str>,
    is_in_build: bool,
    /// Number of items and components.
    references: usize,
    /// What this file, and those that were read before it, hold.
    held: Held,
}

impl Reading {
    fn see(&mut self, event: Event) -> Result<(), MeshError> {
        match event {
            Event::Start(element) => self.start(&element),
            Event::End(space, name) => {
                self.end(space, name);
                Ok(())
            }
            Event::Text(text) => {
                if let (Some(what), Some((_, object))) =
                    (self.says, &mut self.object)
                    && text.trim().eq_ignore_ascii_case("true")
                {
                    object.left_out = Some(what);
                }
                Ok(())
            }
        }
    }

    fn start(&mut self, element: &Element) -> Result<(), MeshError> {
        if !self.is_model {
            return self.root(element);
        }
        self.sound.see(element)?;
        // Published examples have materials of a prefix that they do not declare.
        let is_resource = self.sound.is_past_head()
            && self.object.is_none()
            && !self.is_in_build;
        if element.space() == Space::Undeclared && !is_resource {
            return Err(element.undeclared());
        }
        self.hold(element)?;
        match element.space() {
            Space::Core => self.core(element),
            Space::Beams | Space::Balls => self.lattice(element),
            Space::Volumetric => self.volumetric(element),
            Space::Implicit => self.implicit(element),
            _ => Ok(()),
        }
    }

    /// Counts what takes memory.
    fn hold(&mut self, element: &Element) -> Result<(), MeshError> {
        match (element.space(), element.name()) {
            (Space::Core, "vertex" | "triangle")
            | (Space::Beams | Space::Balls, _) => self.held.shapes += 1,
            (Space::Implicit, _) => self.held.nodes += 1,
            _ => {}
        }
        let (what, most) = if self.held.shapes > MOST_SHAPES {
            ("vertices, triangles and beams", MOST_SHAPES)
        } else if self.held.nodes > MOST_NODES {
            ("nodes, inputs and outputs", MOST_NODES)
        } else {
            return Ok(());
        };
        Err(element.wrong(format!(
            "more than {} million {what} in the file; save what is to be built \
             alone",
            most / 1_000_000
        )))
    }

    /// An element of the volumetric extension.
    fn volumetric(&mut self, element: &Element) -> Result<(), MeshError> {
        match element.name() {
            "image3d" => {
                let id = element.number("id")?;
                self.image = Some((id, None));
            }
            "imagestack" => match &mut self.image {
                Some((_, stack @ None)) => *stack = Some(Stack::new(element)?),
                _ => return Err(element.wrong("it is part of no image3d")),
            },
            "imagesheet" => match &mut self.image {
                Some((_, Some(stack))) => stack.add(element)?,
                _ => return Err(element.wrong("it is part of no stack")),
            },
            "functionfromimage3d" => {
                let id = element.number("id")?;
                let function = ImageFunction::new(element)?;
                if !self.model.stacks.contains_key(&function.image) {
                    return Err(element.wrong(format!(
                        "there is no image3d {} above it",
                        function.image
                    )));
                }
                let function = Function::Image(function);
                self.model.functions.insert(id, function);
            }
            "levelset" => {
                let Some((id, object)) = &mut self.object else {
                    return Err(element.wrong("it is part of no object"));
                };
                if object.level.is_some() {
                    return Err(
                        element.wrong("a second level set in an object")
                    );
                }
                let level = LevelSet::new(element)?;
                if level.mesh == *id {
                    return Err(element.wrong("it lies in its own object"));
                }
                object.level = Some(level);
            }
            "boundary" => {
                return Err(element.wrong(
                    "a boundary of an earlier draft, which is not read; save \
                     the part as a level set",
                ));
            }
            "volumedata" => self.model.has_volume_data = true,
            _ => {}
        }
        Ok(())
    }

    /// An element of a function of nodes.
    fn implicit(&mut self, element: &Element) -> Result<(), MeshError> {
        if element.name() == "implicitfunction" {
            if self.function.is_some() {
                return Err(element.wrong("a function inside a function"));
            }
            let id = element.number("id")?;
            self.function = Some((id, graph::Reading::default()));
            return Ok(());
        }
        match &mut self.function {
            Some((_, reading)) => reading.see(element),
            None => Err(element.wrong("it is part of no function")),
        }
    }

    /// An element of a beam lattice.
    fn lattice(&mut self, element: &Element) -> Result<(), MeshError> {
        let Some((id, object)) = &mut self.object else {
            return Err(element.wrong("it is part of no object"));
        };
        if element.name() != "beamlattice" {
            return match &mut object.lattice {
                Some(lattice) if self.is_in_lattice => {
                    lattice.see(element, object.vertices.len())
                }
                _ => Err(element.wrong("it is part of no lattice")),
            };
        }
        if object.lattice.is_some() {
            return Err(element.wrong("a second lattice in an object"));
        }
        let lattice = Lattice::new(element)?;
        if let Some((clip, _)) = lattice.clipped {
            let other = self.model.objects.get(&clip);
            let is_mesh = other.is_some_and(|o| o.is_plain_mesh());
            if !is_mesh || clip == *id {
                return Err(element.wrong(format!(
                    "it is clipped by object {clip}, which is no mesh without \
                     a lattice that stands above it"
                )));
            }
        }
        object.lattice = Some(lattice);
        self.is_in_lattice = true;
        Ok(())
    }

    fn core(&mut self, element: &Element) -> Result<(), MeshError> {
        match (element.name(), &mut self.object) {
            ("object", _) => self.object(element),
            ("vertex", Some((_, object))) => {
                let p = DVec3::new(
                    element.number("x")?,
                    element.number("y")?,
                    element.number("z")?,
                );
                object.vertices.push(p);
                within(object.vertices.len() / 3)
            }
            ("triangle", Some((_, object))) => {
                let corners = [
                    element.number("v1")?,
                    element.number("v2")?,
                    element.number("v3")?,
                ];
                object.triangles.push(corners);
                self.model.painted.extend(element.among_attributes(painted));
                within(object.triangles.len())
            }
            ("component", Some((_, object))) => {
                object.components.push(reference(element)?);
                self.references += 1;
                few(self.references)
            }
            ("metadata", Some(_)) => {
                let name = element.text("name")?.unwrap_or_default();
                let known = OF_CURA.into_iter().find(|(n, _)| *n == name);
                self.says = known.map(|(_, what)| what);
                Ok(())
            }
            ("build", _) => {
                self.is_in_build = true;
                Ok(())
            }
            ("item", _) if self.is_in_build => {
                let printable = element.text("printable")?;
                self.model.items.push(Item {
                    reference: reference(element)?,
                    is_printable: !matches!(
                        printable.as_deref(),
                        Some("0" | "false")
                    ),
                });
                self.references += 1;
                few(self.references)
            }
            _ => Ok(()),
        }
    }

    fn end(&mut self, space: Space, name: &str) {
        match (space, name) {
            (Space::Core, "object") => {
                if let Some((id, object)) = self.object.take() {
                    self.model.objects.insert(id, Rc::new(object));
                }
            }
            (Space::Core, "metadata") => self.says = None,
            (Space::Core, "build") => self.is_in_build = false,
            (Space::Beams, "beamlattice") => self.is_in_lattice = false,
            (Space::Volumetric, "image3d") => {
                if let Some((id, Some(stack))) = self.image.take() {
                    self.model.stacks.insert(id, stack);
                }
            }
            (Space::Implicit, name) => {
                if let Some((id, reading)) = &mut self.function
                    && let Some(graph) = reading.end(name)
                {
                    let function = Function::Graph(graph);
                    self.model.functions.insert(*id, function);
                    self.function = None;
                }
            }
            _ => {}
        }
    }

    fn root(&mut self, element: &Element) -> Result<(), MeshError> {
        if (element.space(), element.name()) != (Space::Core, "model") {
            return Err(element.wrong("the first element is no model"));
        }
        self.is_model = true;
        self.sound.root(element)?;
        if let Some(mm) = element.word("unit", "unit", UNITS)? {
            self.model.unit = mm;
        }
        let required = element.text("requiredextensions")?.unwrap_or_default();
        let prefixes = element.prefixes();
        for prefix in required.split_whitespace() {
            let named = prefixes.iter().find(|(p, _)| p == prefix);
            let Some((_, namespace)) = named else {
                return Err(element.wrong(format!(
                    "it requires an extension {prefix:?} without naming it"
                )));
            };
            if Space::of(namespace) == Space::Other {
                return Err(element.wrong(format!(
                    "it requires the extension {namespace}, which is not read; \
                     export the part as a mesh of triangles"
                )));
            }
        }
        Ok(())
    }

    fn object(&mut self, element: &Element) -> Result<(), MeshError> {
        let id = element.number("id")?;
        if self.object.is_some() {
            return Err(element.wrong("an object inside an object"));
        }
        let types = [
            ("model", None),
            ("surface", None),
            ("support", Some("a support")),
            ("solidsupport", Some("a support")),
            ("other", Some(OTHER)),
        ];
        let object = Object {
            left_out: element
                .word("type", "type of objects", &types)?
                .flatten(),
            ..Object::default()
        };
        self.object = Some((id, object));
        Ok(())
    }
}

fn within(triangles: usize) -> Result<(), MeshError> {
    if triangles > MOST_TRIANGLES {
        Err(MeshError::TooMany)
    } else {
        Ok(())
    }
}

fn few(references: usize) -> Result<(), MeshError> {
    if references > MOST_PLACED {
        return Err(MeshError::File(format!(
            "more than {MOST_PLACED} objects are placed; save fewer of them on \
             a plate"
        )));
    }
    Ok(())
}

/// The object that an item or a component names.
fn reference(element: &Element) -> Result<Reference, MeshError> {
    let path = element.text_of_any("path")?;
    let wrong =
        "its transform is not twelve finite numbers; save the file again";
    Ok(Reference {
        path,
        transform: transform(element, wrong)?,
        id: element.number("objectid")?,
    })
}
