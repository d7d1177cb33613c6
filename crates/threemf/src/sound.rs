//! What a file has to have, though the body does not need it.
//!
//! Colours and names are not read. A file in which they are wrong was damaged,
//! or made by a program that errs, and its shape is not to be trusted either.

use crate::materials::Materials;
use crate::space::Space;
use crate::xml::Element;
use isoslice_mesh::MeshError;
use std::collections::BTreeSet;

/// Greatest number of names.
const MOST: usize = 10_000;

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

/// Elements that hold the shape, in which nothing unknown may stand. Slicers mark
/// single triangles with attributes of their own.
const SHAPE: [&str; 3] = ["mesh", "vertices", "triangles"];

/// What was seen of a model file.
#[derive(Debug, Default)]
pub(crate) struct Sound {
    materials: Materials,
    /// Prefixes of namespaces that are not known, and may not be ignored.
    strange: BTreeSet<String>,
    /// The names of what the file says of itself, before its resources.
    names: BTreeSet<String>,
    is_past_head: bool,
}

impl Sound {
    /// Looks at the first element.
    pub(crate) fn root(&mut self, element: &Element) -> Result<(), MeshError> {
        no_space(element)?;
        let ignorable = element.text_of_any("Ignorable")?.unwrap_or_default();
        let may_be_ignored = |prefix: &str| {
            let mut words = ignorable.split_whitespace();
            words.any(|word| word == prefix)
        };
        let strange = element.prefixes().into_iter().filter(|(prefix, of)| {
            Space::of(of) == Space::Other && !may_be_ignored(prefix)
        });
        self.strange = strange.map(|(prefix, _)| prefix).collect();
        Ok(())
    }

    /// Looks at an element.
    pub(crate) fn see(&mut self, element: &Element) -> Result<(), MeshError> {
        let is = (element.space(), element.name());
        // Nearly all elements are of these two kinds.
        if matches!(is, (Space::Core, "vertex" | "triangle")) {
            return Ok(());
        }
        no_space(element)?;
        for (space, name, attribute) in REQUIRED {
            if is == (space, name) && element.text(attribute)?.is_none() {
                return Err(element.wrong(format!(
                    "there is no attribute {attribute}, which each {name} has"
                )));
            }
        }
        match is {
            (Space::Core, "resources") => self.is_past_head = true,
            (Space::Core, "metadata") if !self.is_past_head => {
                self.name(element)?;
            }
            (Space::Core, name) if SHAPE.contains(&name) => {
                self.nothing_strange(element)?;
            }
            _ => {}
        }
        self.materials.see(element)
    }

    /// True from the resources on.
    pub(crate) fn is_past_head(&self) -> bool {
        self.is_past_head
    }

    /// A name of what the file says of itself. Some programs add a description to
    /// that which is there.
    fn name(&mut self, element: &Element) -> Result<(), MeshError> {
        let name = element.text("name")?.unwrap_or_default();
        if self.names.len() >= MOST {
            return Err(element.wrong(format!(
                "more than {MOST} names of metadata, and no file needs so \
                 many; save the part without them"
            )));
        }
        if self.names.contains(&name) && name != "Description" {
            return Err(element.wrong(format!(
                "a second metadata {name:.40}; names stand once in a file"
            )));
        }
        self.names.insert(name);
        Ok(())
    }

    fn nothing_strange(&self, element: &Element) -> Result<(), MeshError> {
        let prefixes = element.prefixes_of_attributes();
        match prefixes.iter().find(|p| self.strange.contains(*p)) {
            None => Ok(()),
            Some(prefix) => Err(element.wrong(format!(
                "an attribute of the unknown namespace {prefix:.40}, which the \
                 file does not allow to ignore, may change the shape"
            ))),
        }
    }
}

fn no_space(element: &Element) -> Result<(), MeshError> {
    match element.text("xml:space")? {
        None => Ok(()),
        Some(_) => {
            Err(element
                .wrong("the attribute xml:space, which 3MF does not allow"))
        }
    }
}
