//! Relationships: which files of an archive belong to which.
//!
//! ```text
//!  _rels/.rels                  the model, a picture of it
//!  3D/_rels/3dmodel.model.rels  what the model needs: textures, a print ticket
//! ```
//!
//! What they name has to be there, though the shape does not need it: a file in
//! which something is missing was damaged on its way.

use crate::package::Package;
use crate::xml::{self, Element, Event};
use isoslice_mesh::MeshError;
use std::collections::BTreeSet;
use std::io::{Read, Seek};

/// The relationships of the archive itself.
const ROOT: &str = "_rels/.rels";
/// The model of an archive without relationships.
const MODEL: &str = "3D/3dmodel.model";
/// Greatest number of relationships of a file. Projects have one for each part.
const MOST: usize = 100_000;

/// Ends of the types of what has to be there. Other programs' types are not ours to
/// judge.
const NEEDED: [&str; 4] = ["/3dmodel", "/3dtexture", "/printticket", THUMBNAIL];
const THUMBNAIL: &str = "/metadata/thumbnail";

/// Pictures that slicers name and do not write: PrusaSlicer without a window,
/// OrcaSlicer and Bambu Studio for plates without a picture.
const NAMED_IN_VAIN: [&str; 3] =
    ["metadata/thumbnail.png", "metadata/plate_", "auxiliaries/"];

/// Reads the archive's relationships, and those of its model. Returned: the name of
/// the file that has the model.
pub(crate) fn read<R: Read + Seek>(
    package: &mut Package<R>,
) -> Result<String, MeshError> {
    let names = package.names();
    let mut root = Relations::of(ROOT, "", &names);
    let found = root.read(package)?;
    let model = match root.model {
        Some(model) => model,
        None if !found => MODEL.to_owned(),
        None => {
            let what = "no relationship names the model; save the file again";
            return Err(MeshError::at(ROOT, what));
        }
    };
    let path = model.trim_start_matches('/');
    let (folder, name) = path.rsplit_once('/').unwrap_or(("", path));
    let own = format!("{folder}/_rels/{name}.rels");
    let own = own.trim_start_matches('/');
    Relations::of(own, folder, &names).read(package)?;
    Ok(model)
}

/// Relationships of a file.
struct Relations<'a> {
    /// Where they are.
    path: &'a str,
    /// The folder of the file that has them.
    folder: &'a str,
    /// The names of all files, in small letters: case does not tell them apart.
    names: &'a BTreeSet<String>,
    count: usize,
    model: Option<String>,
    has_ticket: bool,
}

impl<'a> Relations<'a> {
    fn of(
        path: &'a str,
        folder: &'a str,
        names: &'a BTreeSet<String>,
    ) -> Relations<'a> {
        Relations {
            path,
            folder,
            names,
            count: 0,
            model: None,
            has_ticket: false,
        }
    }

    /// Returned: false if there are none.
    fn read<R: Read + Seek>(
        &mut self,
        package: &mut Package<R>,
    ) -> Result<bool, MeshError> {
        let path = self.path;
        let found = package.with(path, |bytes| {
            xml::read(path, bytes, |event| match event {
                Event::Start(element) if element.name() == "Relationship" => {
                    self.see(&element)
                }
                _ => Ok(()),
            })
        })?;
        Ok(found.is_some())
    }

    fn see(&mut self, element: &Element) -> Result<(), MeshError> {
        self.count += 1;
        if self.count > MOST {
            return Err(element.wrong(format!(
                "more than {MOST} relationships, and no file needs so many; \
                 save the part alone"
            )));
        }
        let kind = element.text("Type")?.unwrap_or_default();
        if !NEEDED.iter().any(|end| kind.ends_with(end)) {
            return Ok(());
        }
        let target = element.text("Target")?.unwrap_or_default();
        let is_model = self.path == ROOT && kind.ends_with("/3dmodel");
        let mode = element.text("TargetMode")?;
        if mode.is_some_and(|mode| mode == "External") {
            let what = if is_model { "the model" } else { &target };
            return Err(element.wrong(format!("{what} is not in the archive")));
        }
        if is_model && self.model.replace(target.clone()).is_some() {
            return Err(element.wrong(
                "there are two models in the archive; save each as a file of \
                 its own",
            ));
        }
        let is_ticket = kind.ends_with("/printticket");
        if is_ticket && std::mem::replace(&mut self.has_ticket, true) {
            return Err(element.wrong("a second print ticket of one file"));
        }
        if self.is_there(&target) || is_named_in_vain(&kind, &target) {
            return Ok(());
        }
        Err(element.wrong(format!(
            "{target} is not in the archive; save the file again"
        )))
    }

    /// True if a file is there, named from the root or from the folder.
    fn is_there(&self, target: &str) -> bool {
        let target = target.to_lowercase();
        let from_root = target.trim_start_matches('/');
        let folder = self.folder.to_lowercase();
        self.names.contains(from_root)
            || self.names.contains(&joined(&folder, &target))
            // Names with characters that have to be written in other ways are
            // taken to be there.
            || target.contains('%')
    }
}

fn is_named_in_vain(kind: &str, target: &str) -> bool {
    let target = target.trim_start_matches('/').to_lowercase();
    kind.ends_with(THUMBNAIL)
        && NAMED_IN_VAIN.iter().any(|begin| target.starts_with(begin))
}

/// The place that a name leads to from a folder.
fn joined(folder: &str, target: &str) -> String {
    let mut parts: Vec<&str> =
        folder.split('/').filter(|part| !part.is_empty()).collect();
    for part in target.split('/') {
        match part {
            "" | "." => {}
            ".." => {
                parts.pop();
            }
            part => parts.push(part),
        }
    }
    parts.join("/")
}
