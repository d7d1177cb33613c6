//! Contract only; see the helper's implementation.
use fidget::context::Tree;
use glam::DVec3;
/// Box.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Lower corner.
    pub min: DVec3,
    /// Upper corner.
    pub max: DVec3,
}
impl Bounds {
    /// Size.
    pub fn size(&self) -> DVec3 {
        self.max - self.min
    }
}
/// A model placed on the printer.
#[derive(Clone)]
pub struct Model {
    /// Name.
    pub name: String,
    /// Field, in model coordinates.
    pub tree: Tree,
    /// Tight box.
    pub bounds: Bounds,
    /// Print coordinates = model coordinates + offset.
    pub offset: DVec3,
}
