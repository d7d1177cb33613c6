//! A model file: objects, and what is to be built of them.

use super::package::Package;
use super::xml::{self, Element, Event};
use crate::error::MeshError;
use crate::limits::MOST_TRIANGLES;
use glam::{DAffine3, DMat3, DVec3};
use std::collections::BTreeMap;
use std::io::{Read, Seek};

/// A unit of lengths.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Unit {
    Micron,
    Millimetre,
    Centimetre,
    Inch,
    Foot,
    Metre,
}

impl Unit {
    const ALL: [Unit; 6] = [
        Unit::Micron,
        Unit::Millimetre,
        Unit::Centimetre,
        Unit::Inch,
        Unit::Foot,
        Unit::Metre,
    ];

    /// As files name it.
    pub(super) fn name(self) -> &'static str {
        match self {
            Unit::Micron => "micron",
            Unit::Millimetre => "millimeter",
            Unit::Centimetre => "centimeter",
            Unit::Inch => "inch",
            Unit::Foot => "foot",
            Unit::Metre => "meter",
        }
    }

    pub(super) fn millimetres(self) -> f64 {
        match self {
            Unit::Micron => 1e-3,
            Unit::Millimetre => 1.0,
            Unit::Centimetre => 10.0,
            Unit::Inch => 25.4,
            Unit::Foot => 304.8,
            Unit::Metre => 1e3,
        }
    }
}

/// An object at a place.
#[derive(Clone, Debug)]
pub(super) struct Reference {
    /// The file that has it, if it is another one.
    pub path: Option<String>,
    pub id: u32,
    pub transform: DAffine3,
}

#[derive(Clone, Debug)]
pub(super) struct Item {
    pub reference: Reference,
    pub is_printable: bool,
}

/// A mesh, objects at places, or both.
#[derive(Debug, Default)]
pub(super) struct Object {
    pub vertices: Vec<DVec3>,
    pub triangles: Vec<[u32; 3]>,
    pub components: Vec<Reference>,
    /// Why it is no part of the body, if it is none.
    pub left_out: Option<&'static str>,
    /// True for what stands for an object while its parts are placed.
    pub is_open: bool,
}

#[derive(Debug)]
pub(super) struct Model {
    pub unit: Unit,
    pub objects: BTreeMap<u32, Object>,
    pub items: Vec<Item>,
}

/// Extensions of which what changes the shape is read, or which do not change it,
/// by the ends of their namespaces.
const KNOWN: [&str; 4] = [
    "/core/2015/02",
    "/production/2015/06",
    "/material/2015/02",
    "/trianglesets/2021/07",
];

/// An object of a type that must not be built.
pub(super) const OTHER: &str = "an object that is not to be printed";

/// What Cura calls meshes that are no part of the body.
const OF_CURA: [(&str, &str); 4] = [
    ("cura:infill_mesh", "a modifier"),
    ("cura:cutting_mesh", "a modifier"),
    ("cura:support_mesh", "a support"),
    ("cura:anti_overhang_mesh", "a support blocker"),
];

/// Reads a model file of an archive.
pub(super) fn read<R: Read + Seek>(
    package: &mut Package<R>,
    path: &str,
) -> Result<Model, MeshError> {
    let mut reading = Reading {
        model: Model {
            unit: Unit::Millimetre,
            objects: BTreeMap::new(),
            items: Vec::new(),
        },
        prefix: None,
        object: None,
        says: None,
        is_in_build: false,
    };
    let found = package.with(path, |bytes| {
        xml::read(path, bytes, |event| reading.see(event))
    })?;
    if found.is_none() {
        return Err(MeshError::File(format!(
            "there is no {path} in its archive; is it a 3MF file?"
        )));
    }
    if reading.prefix.is_none() {
        return Err(MeshError::at(path, "there is no model in it"));
    }
    Ok(reading.model)
}

struct Reading {
    model: Model,
    /// What comes before the names of the core's elements: that of the first
    /// element, with its colon.
    prefix: Option<String>,
    object: Option<(u32, Object)>,
    /// What a text says of the object, if it is true.
    says: Option<&'static str>,
    is_in_build: bool,
}

impl Reading {
    fn see(&mut self, event: Event) -> Result<(), MeshError> {
        match event {
            Event::Start(element) => self.start(&element),
            Event::End(name) => {
                self.end(name);
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

    /// The name of a core element.
    fn core<'a>(&self, name: &'a str) -> Option<&'a str> {
        let rest = name.strip_prefix(self.prefix.as_deref()?)?;
        (!rest.contains(':')).then_some(rest)
    }

    fn start(&mut self, element: &Element) -> Result<(), MeshError> {
        if self.prefix.is_none() {
            return self.root(element);
        }
        match (self.core(element.name()), &mut self.object) {
            (Some("object"), _) => self.object(element),
            (Some("vertex"), Some((_, object))) => {
                let p = DVec3::new(
                    element.number("x")?,
                    element.number("y")?,
                    element.number("z")?,
                );
                object.vertices.push(p);
                within(object.vertices.len() / 3)
            }
            (Some("triangle"), Some((_, object))) => {
                let corners = [
                    element.number("v1")?,
                    element.number("v2")?,
                    element.number("v3")?,
                ];
                object.triangles.push(corners);
                within(object.triangles.len())
            }
            (Some("component"), Some((_, object))) => {
                object.components.push(reference(element)?);
                Ok(())
            }
            (Some("metadata"), Some(_)) => {
                let name = element.text("name")?.unwrap_or_default();
                let known = OF_CURA.into_iter().find(|(n, _)| *n == name);
                self.says = known.map(|(_, what)| what);
                Ok(())
            }
            (Some("build"), _) => {
                self.is_in_build = true;
                Ok(())
            }
            (Some("item"), _) if self.is_in_build => {
                let printable = element.text("printable")?;
                self.model.items.push(Item {
                    reference: reference(element)?,
                    is_printable: !matches!(
                        printable.as_deref(),
                        Some("0" | "false")
                    ),
                });
                Ok(())
            }
            _ => Ok(()),
        }
    }

    fn end(&mut self, name: &str) {
        match self.core(name) {
            Some("object") => {
                if let Some((id, object)) = self.object.take() {
                    self.model.objects.insert(id, object);
                }
            }
            Some("metadata") => self.says = None,
            Some("build") => self.is_in_build = false,
            _ => {}
        }
    }

    fn root(&mut self, element: &Element) -> Result<(), MeshError> {
        let name = element.name();
        let Some(prefix) = name.strip_suffix("model") else {
            return Err(element.wrong("the first element is no model"));
        };
        self.prefix = Some(prefix.to_owned());
        if let Some(name) = element.text("unit")? {
            let unit = Unit::ALL.into_iter().find(|u| u.name() == name);
            self.model.unit = unit.ok_or_else(|| {
                element.wrong(format!(
                    "{name:?} is no unit; those of 3MF are micron, millimeter, \
                     centimeter, inch, foot and meter"
                ))
            })?;
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
            if !KNOWN.iter().any(|known| namespace.ends_with(known)) {
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
        if self.model.objects.contains_key(&id) {
            return Err(element.wrong(format!("a second object {id}")));
        }
        let left_out = match element.text("type")?.as_deref() {
            Some("support" | "solidsupport") => Some("a support"),
            Some("other") => Some(OTHER),
            None | Some("model" | "surface") => None,
            Some(other) => {
                return Err(element.wrong(format!(
                    "{other:?} is no type of objects; those of 3MF are model, \
                     surface, support, solidsupport and other"
                )));
            }
        };
        self.object = Some((
            id,
            Object {
                left_out,
                ..Object::default()
            },
        ));
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

/// The object that an item or a component names.
fn reference(element: &Element) -> Result<Reference, MeshError> {
    let path = element.text_of_any("path")?;
    let transform = match element.text("transform")? {
        None => DAffine3::IDENTITY,
        Some(text) => transform(&text).ok_or_else(|| {
            element.wrong(
                "its transform is not twelve finite numbers; save the file \
                 again",
            )
        })?,
    };
    Ok(Reference {
        path,
        id: element.number("objectid")?,
        transform,
    })
}

/// Twelve numbers: where the axes go, and where the origin goes.
fn transform(text: &str) -> Option<DAffine3> {
    let numbers: Vec<f64> = text
        .split_whitespace()
        .map(|word| word.parse().ok().filter(|x: &f64| x.is_finite()))
        .collect::<Option<_>>()?;
    let [a, b, c, d, e, f, g, h, i, x, y, z] = numbers.try_into().ok()?;
    Some(DAffine3 {
        matrix3: DMat3::from_cols(
            DVec3::new(a, b, c),
            DVec3::new(d, e, f),
            DVec3::new(g, h, i),
        ),
        translation: DVec3::new(x, y, z),
    })
}
