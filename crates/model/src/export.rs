//! Writes a model as a 3MF file whose shape is a function.
//!
//! In: a placed model. Out: an archive, in the coordinates in which the model was
//! drawn, turned and scaled. It says nothing of the printer's bed.

use super::placement::Model;
use isoslice_threemf::{ExportError, Part, write};

impl Model {
    /// The bytes of a 3MF file that has the model as a function of nodes, and its
    /// meshes, pictures and volumes beside it. Equal models have equal bytes.
    ///
    /// # Errors
    /// If the function has something for which 3MF has no node, such as drawings
    /// and `rand`, or more nodes than are read again.
    pub fn to_3mf(&self) -> Result<Vec<u8>, ExportError> {
        write(&Part {
            name: &self.name,
            tree: &self.tree,
            bounds: self.bounds,
            origin: self.origin,
        })
    }
}
