//! What a file has to have, though the body does not need it.
//!
//! Colours and names are not read. A file in which they are wrong was damaged,
//! or made by a program that errs, and its shape is not to be trusted either.

use crate::space::Space;
use crate::xml::Element;
use isoslice_mesh::MeshError;
use std::collections::BTreeSet;

/// Greatest number of resources and names.
const MOST: usize = 1_000_000;

/// Elements of resources, whose numbers are all different.
const RESOURCES: [(Space, &str); 11] = [
    (Space::Core, "object"),
    (Space::Core, "basematerials"),
    (Space::Material, "colorgroup"),
    (Space::Material, "texture2d"),
    (Space::Material, "texture2dgroup"),
    (Space::Material, "compositematerials"),
    (Space::Material, "multiproperties"),
    (Space::Volumetric, "image3d"),
    (Space::Volumetric, "functionfromimage3d"),
    (Space::Volumetric, "volumedata"),
    (Space::Implicit, "implicitfunction"),
];

/// Attributes that elements have to have.
const REQUIRED: [(Space, &str, &str); 8] = [
    (Space::Core, "metadata", "name"),
    (Space::Material, "color", "color"),
    (Space::Material, "texture2d", "path"),
    (Space::Material, "texture2d", "contenttype"),
    (Space::Material, "texture2dgroup", "texid"),
    (Space::Material, "compositematerials", "matid"),
    (Space::Material, "compositematerials", "matindices"),
    (Space::Material, "multiproperties", "pids"),
];

/// What was seen of a model file.
#[derive(Debug, Default)]
pub(crate) struct Sound {
    resources: BTreeSet<u32>,
}

impl Sound {
    /// Looks at an element.
    pub(crate) fn see(&mut self, element: &Element) -> Result<(), MeshError> {
        let is = (element.space(), element.name());
        // Nearly all elements are of these two kinds.
        if matches!(is, (Space::Core, "vertex" | "triangle")) {
            return Ok(());
        }
        for (space, name, attribute) in REQUIRED {
            if is == (space, name) && element.text(attribute)?.is_none() {
                return Err(element.wrong(format!(
                    "there is no attribute {attribute}, which each {name} has"
                )));
            }
        }
        if !RESOURCES.contains(&is) {
            return Ok(());
        }
        let id = element.number("id")?;
        if self.resources.len() >= MOST {
            return Err(element.wrong("more resources than a file has"));
        }
        if !self.resources.insert(id) {
            return Err(element.wrong(format!("a second resource {id}")));
        }
        Ok(())
    }
}
