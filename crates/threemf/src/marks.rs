//! What slicers say of parts of a mesh: which are no part of the body.
//!
//! ```text
//! PrusaSlicer, Metadata/Slic3r_PE_model.config: triangles of an object
//!   <object id="1"> <volume firstid="0" lastid="11">
//!     <metadata key="volume_type" value="ParameterModifier"/>
//! Bambu Studio, OrcaSlicer, Metadata/model_settings.config: components
//!   <object id="2"> <part id="1" subtype="modifier_part">
//! ```

use crate::package::Package;
use crate::xml::{self, Element, Event};
use isoslice_mesh::MeshError;
use std::collections::BTreeMap;
use std::io::{Read, Seek};

const OF_PRUSA: &str = "Metadata/Slic3r_PE_model.config";
const OF_BAMBU: &str = "Metadata/model_settings.config";

/// Greatest number of marks. Projects have a dozen.
const MOST: usize = 100_000;

/// What is no part of the body.
#[derive(Debug, Default)]
pub(crate) struct Marks {
    /// By object: the first triangle, the last one, and what they are.
    triangles: BTreeMap<u32, Vec<(usize, usize, &'static str)>>,
    /// By object and component.
    parts: BTreeMap<(u32, u32), &'static str>,
}

impl Marks {
    pub(crate) fn read<R: Read + Seek>(
        package: &mut Package<R>,
    ) -> Result<Marks, MeshError> {
        let mut marks = Marks::default();
        for name in [OF_PRUSA, OF_BAMBU] {
            let (mut object, mut volume) = (0, (1, 0));
            package.with(name, |bytes| {
                xml::read(name, bytes, |event| match event {
                    Event::Start(element) => {
                        marks.see(&element, &mut object, &mut volume)
                    }
                    _ => Ok(()),
                })
            })?;
        }
        Ok(marks)
    }

    fn see(
        &mut self,
        element: &Element,
        object: &mut u32,
        volume: &mut (usize, usize),
    ) -> Result<(), MeshError> {
        if self.parts.len() + self.triangles.len() > MOST {
            return Err(element.wrong("more parts than a project has"));
        }
        let text = |name: &str| -> Result<String, MeshError> {
            Ok(element.text(name)?.unwrap_or_default())
        };
        match element.name() {
            "object" => *object = element.number("id")?,
            "volume" => {
                *volume =
                    (element.number("firstid")?, element.number("lastid")?);
            }
            "metadata" => {
                let (key, value) = (text("key")?, text("value")?);
                let what = match key.as_str() {
                    "volume_type" => kind(&value),
                    "modifier" if value == "1" => Some("a modifier"),
                    _ => None,
                };
                if let Some(what) = what {
                    let (first, last) = *volume;
                    let list = self.triangles.entry(*object).or_default();
                    // Both keys may say the same.
                    list.retain(|mark| (mark.0, mark.1) != (first, last));
                    list.push((first, last, what));
                    if list.len() > MOST / 100 {
                        return Err(
                            element.wrong("more parts than an object has")
                        );
                    }
                }
            }
            "part" => {
                let subtype = text("subtype")?;
                if let Some(what) = kind(&subtype) {
                    self.parts.insert((*object, element.number("id")?), what);
                }
            }
            _ => {}
        }
        Ok(())
    }

    /// What a triangle of an object is, if it is no part of the body.
    pub(crate) fn of_triangle(
        &self,
        object: u32,
        triangle: usize,
    ) -> Option<&'static str> {
        let list = self.triangles.get(&object)?;
        let mark = list
            .iter()
            .find(|(first, last, _)| (*first..=*last).contains(&triangle));
        mark.map(|(_, _, what)| *what)
    }

    /// What a component of an object is, if it is no part of the body.
    pub(crate) fn of_part(
        &self,
        object: u32,
        component: u32,
    ) -> Option<&'static str> {
        self.parts.get(&(object, component)).copied()
    }
}

/// A kind of volumes, if it is no part of the body.
fn kind(name: &str) -> Option<&'static str> {
    match name {
        "ParameterModifier" | "modifier_part" => Some("a modifier"),
        "NegativeVolume" | "negative_part" => Some("a negative volume"),
        "SupportBlocker" | "support_blocker" => Some("a support blocker"),
        "SupportEnforcer" | "support_enforcer" => Some("a support enforcer"),
        _ => None,
    }
}
