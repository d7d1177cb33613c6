//! Materials and colours: what of them refers to what.
//!
//! ```text
//!  basematerials ◀── compositematerials ◀─┐
//!  colorgroup ◀───────────────────────────┼── multiproperties
//!  texture2d ◀────── texture2dgroup ◀─────┘
//! ```
//!
//! They do not change the shape. What they refer to stands above them.

use crate::space::Space;
use crate::xml::Element;
use isoslice_mesh::MeshError;
use std::collections::BTreeMap;

/// Greatest number of resources.
const MOST: usize = 1_000_000;

/// Elements of resources, whose numbers are all different.
const RESOURCES: [(Space, &str); 11] = [
    (Space::Core, "object"),
    (Space::Core, BASE),
    (Space::Material, COLOURS),
    (Space::Material, TEXTURE),
    (Space::Material, "texture2dgroup"),
    (Space::Material, COMPOSITE),
    (Space::Material, MULTI),
    (Space::Volumetric, "image3d"),
    (Space::Volumetric, "functionfromimage3d"),
    (Space::Volumetric, "volumedata"),
    (Space::Implicit, "implicitfunction"),
];

const BASE: &str = "basematerials";
const COLOURS: &str = "colorgroup";
const TEXTURE: &str = "texture2d";
const COMPOSITE: &str = "compositematerials";
const MULTI: &str = "multiproperties";

/// Kinds of pictures. The last is no name of a kind, and is written by some.
const PICTURES: [&str; 3] = ["image/png", "image/jpeg", "image/jpg"];

/// The resources of a model file, by their numbers.
#[derive(Debug, Default)]
pub(crate) struct Materials(BTreeMap<u32, &'static str>);

impl Materials {
    /// Looks at an element.
    pub(crate) fn see(&mut self, element: &Element) -> Result<(), MeshError> {
        let is = (element.space(), element.name());
        let Some((_, kind)) = RESOURCES.into_iter().find(|r| *r == is) else {
            return Ok(());
        };
        match kind {
            "object" => object(element)?,
            TEXTURE => texture(element)?,
            "texture2dgroup" => self.leads_to(element, "texid", TEXTURE)?,
            COMPOSITE => self.leads_to(element, "matid", BASE)?,
            MULTI => self.multi(element)?,
            _ => {}
        }
        let id = element.number("id")?;
        if self.0.len() >= MOST {
            return Err(element.wrong(format!(
                "more than {} million resources, and no file needs so many; \
                 save the part alone",
                MOST / 1_000_000
            )));
        }
        if self.0.insert(id, kind).is_some() {
            return Err(element.wrong(format!("a second resource {id}")));
        }
        Ok(())
    }

    fn leads_to(
        &self,
        element: &Element,
        attribute: &str,
        wanted: &str,
    ) -> Result<(), MeshError> {
        let id: u32 = element.number(attribute)?;
        if self.0.get(&id) == Some(&wanted) {
            return Ok(());
        }
        Err(element.wrong(format!(
            "its {attribute} is {id}, and there is no {wanted} {id} above it"
        )))
    }

    /// Layers of several resources over one another.
    fn multi(&self, element: &Element) -> Result<(), MeshError> {
        let (mut materials, mut colours) = (0, 0);
        for word in element.text("pids")?.unwrap_or_default().split_whitespace()
        {
            let id = word.parse().ok();
            let kind = id.and_then(|id: u32| self.0.get(&id));
            match kind.copied() {
                Some(MULTI) => {
                    return Err(element.wrong(format!(
                        "its pids name {word}, which is one of its own kind"
                    )));
                }
                Some(BASE | COMPOSITE) => materials += 1,
                Some(COLOURS) => colours += 1,
                Some(_) => {}
                None => {
                    return Err(element.wrong(format!(
                        "its pids name {word:.20}, and there is no such \
                         resource above it"
                    )));
                }
            }
        }
        if materials > 1 || colours > 1 {
            return Err(element.wrong(
                "its pids name more than one material, or more than one group \
                 of colours",
            ));
        }
        Ok(())
    }
}

fn object(element: &Element) -> Result<(), MeshError> {
    let has_index = element.text("pindex")?.is_some();
    if has_index && element.text("pid")?.is_none() {
        return Err(element.wrong("an object with pindex and without pid"));
    }
    Ok(())
}

fn texture(element: &Element) -> Result<(), MeshError> {
    let kind = element.text("contenttype")?.unwrap_or_default();
    if PICTURES.iter().any(|k| kind.eq_ignore_ascii_case(k)) {
        return Ok(());
    }
    Err(element.wrong(format!(
        "its contenttype is {kind:.30?}; textures are image/png or image/jpeg"
    )))
}
