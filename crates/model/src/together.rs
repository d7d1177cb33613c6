//! Several placed models as one: for pictures, and for layers that suit them
//! all.

use super::placement::Model;
use super::script::union;
use fidget::context::Tree;
use glam::{DVec2, DVec3};
use isocontour::Bounds;

/// Greatest number of operations of all models. The picture of a larger one is
/// not worth the time.
const MOST_OPERATIONS: usize = 300_000;

/// Models as they stand on the bed, each moved in the plane, as one model in
/// the printer's coordinates. None if there are no models, or if their
/// expressions are too large together.
pub fn together<'a>(
    name: &str,
    models: impl IntoIterator<Item = (&'a Model, DVec2)>,
) -> Option<Model> {
    let mut trees = Vec::new();
    let (mut data, mut files) = (Vec::new(), Vec::new());
    let mut bounds: Option<Bounds> = None;
    let mut size = 0;
    let mut lift: f64 = 0.0;
    for (model, shift) in models {
        // The sum counts the models' own operations, those that move them, and
        // one minimum each.
        size += model.expression_size + 4;
        data.extend(model.data.iter().cloned());
        files.extend(model.files.iter().cloned());
        if size > MOST_OPERATIONS {
            return None;
        }
        // All parts of a plate stand on one raft, or on none.
        lift = lift.max(model.lift);
        let by = model.offset + shift.extend(0.0);
        let (x, y, z) = Tree::axes();
        let at = by.as_vec3();
        trees.push(model.tree.remap_xyz(x - at.x, y - at.y, z - at.z));
        let own = model.bounds.moved(by);
        bounds = Some(bounds.map_or(own, |all| all.union(own)));
    }
    Some(Model {
        name: name.to_owned(),
        tree: union(trees)?,
        data,
        files,
        bounds: bounds?,
        offset: DVec3::ZERO,
        lift,
        origin: DVec3::ZERO,
        laid: None,
        parameters: Vec::new(),
        warnings: Vec::new(),
        expression_size: size,
    })
}
