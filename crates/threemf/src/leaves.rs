//! Meshes that functions ask for, each made once, and channels of stacks of
//! pictures, each made once for each way to read between its pixels.

use crate::collect::triangles;
use crate::functions::evaluate::Leaves;
use crate::functions::image::{Channel, ImageFunction};
use crate::model::Model;
use crate::package::Package;
use fidget::context::Tree;
use isocontour::{Data, call};
use isoslice_mesh::{Mesh, MeshError};
use std::collections::BTreeMap;
use std::io::{Read, Seek};
use std::sync::Arc;

/// Greatest number of meshes and stacks.
pub(crate) const MOST: usize = 1000;
/// Greatest memory of them all, bytes: as much as a whole run may take.
const MOST_BYTES: u64 = 4 << 30;

/// Data by file, number, and what of it is asked for.
#[derive(Default)]
pub(crate) struct Known(BTreeMap<(String, u32, String), Arc<dyn Data>>);

/// The data of a model file.
pub(crate) struct Files<'a, R> {
    /// How messages call the archive.
    pub name: &'a str,
    pub path: &'a str,
    pub model: &'a Model,
    pub package: &'a mut Package<R>,
    pub known: &'a mut Known,
    /// All data that was made.
    pub data: &'a mut Vec<Arc<dyn Data>>,
}

impl<R> Files<'_, R> {
    fn known_or_made(
        &mut self,
        id: u32,
        what: String,
        make: impl FnOnce(&mut Self) -> Result<Arc<dyn Data>, MeshError>,
    ) -> Result<Arc<dyn Data>, MeshError> {
        let key = (self.path.to_owned(), id, what);
        if let Some(data) = self.known.0.get(&key) {
            return Ok(data.clone());
        }
        if self.known.0.len() >= MOST {
            return Err(MeshError::File(format!(
                "functions ask for more than {MOST} meshes and pictures"
            )));
        }
        let data = make(self)?;
        let known = self.known.0.values();
        let bytes = known.chain([&data]).map(|data| data.bytes() as u64);
        if bytes.sum::<u64>() > MOST_BYTES {
            return Err(MeshError::File(
                "the meshes and pictures that its functions ask for take more \
                 than 4 GB; scale the pictures down"
                    .to_owned(),
            ));
        }
        self.data.push(data.clone());
        self.known.0.insert(key, data.clone());
        Ok(data)
    }
}

impl<R: Read + Seek> Leaves for Files<'_, R> {
    fn mesh(&mut self, id: u32, at: [Tree; 3]) -> Result<Tree, MeshError> {
        let data = self.known_or_made(id, "mesh".to_owned(), |files| {
            let triangles = triangles(files.model, files.path, id)?;
            Ok(Arc::new(Mesh::new(files.name, triangles)?))
        })?;
        Ok(call(&data, at))
    }

    fn image(
        &mut self,
        image: &ImageFunction,
        channel: Channel,
        at: [Tree; 3],
    ) -> Result<Tree, MeshError> {
        let what = image.read_as(channel);
        let data = self.known_or_made(image.image, what, |files| {
            let Some(stack) = files.model.stacks.get(&image.image) else {
                return Err(MeshError::File("there is no stack".to_owned()));
            };
            let (name, package) = (files.name, &mut *files.package);
            Ok(Arc::new(stack.channel(name, package, image, channel)?))
        })?;
        Ok(call(&data, at))
    }
}
