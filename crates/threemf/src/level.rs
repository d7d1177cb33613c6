//! Level sets: objects that are where a function is below zero.

use crate::functions::value::number;
use crate::transform::transform;
use crate::xml::Element;
use fidget::context::Tree;
use glam::DAffine3;
use isocontour::Bounds;
use isoslice_mesh::MeshError;

/// A level set, as files have it.
#[derive(Debug)]
pub(crate) struct LevelSet {
    pub function: u32,
    /// The output of the function that counts.
    pub channel: String,
    /// Leads from the object to where the function is asked.
    pub transform: DAffine3,
    /// The object in which the level set lies.
    pub mesh: u32,
    /// True if it may fill the box around that mesh.
    pub is_in_box: bool,
    /// What stands where the function is undefined.
    pub fallback: f64,
}

impl LevelSet {
    pub(crate) fn new(element: &Element) -> Result<LevelSet, MeshError> {
        let channel = element.text("channel")?;
        let wrong = "its transform is not twelve finite numbers";
        let transform = transform(element, wrong)?;
        let fallback = match element.text("fallbackvalue")? {
            None => 0.0,
            Some(_) => element.number("fallbackvalue")?,
        };
        let in_box = element.text("meshbboxonly")?;
        Ok(LevelSet {
            function: element.number("functionid")?,
            channel: channel.ok_or_else(|| element.absent("channel"))?,
            transform,
            mesh: element.number("meshid")?,
            is_in_box: matches!(in_box.as_deref(), Some("true" | "1")),
            fallback,
        })
    }

    /// The function, with what stands where it is undefined. What is not inside
    /// needs no number.
    pub(crate) fn defined(&self, tree: Tree) -> Tree {
        if self.fallback >= 0.0 || self.fallback.is_nan() {
            return tree;
        }
        defined_or(&tree, self.fallback)
    }
}

/// A function, and a number where it is undefined.
pub(crate) fn defined_or(tree: &Tree, otherwise: f64) -> Tree {
    // 0, or undefined. `and` gives its first number if that is 0, else the second
    // one, and what is undefined is not 0.
    let defined = tree.compare(tree.clone());
    let is_defined = defined.not();
    is_defined.and(tree.clone()) + defined.and(number(otherwise))
}

/// A box, as a function.
pub(crate) fn cuboid(bounds: &Bounds) -> Tree {
    let (x, y, z) = Tree::axes();
    let sides = [x, y, z].into_iter().enumerate().map(|(k, axis)| {
        let above = axis.clone() - number(bounds.max[k]);
        above.max(number(bounds.min[k]) - axis)
    });
    let all = sides.reduce(|a, b| a.max(b));
    all.unwrap_or_else(|| number(-1.0))
}

/// Where an affine map leads, as expressions.
pub(crate) fn places(by: &DAffine3) -> [Tree; 3] {
    let (x, y, z) = Tree::axes();
    if *by == DAffine3::IDENTITY {
        return [x, y, z];
    }
    let rows = by.matrix3.transpose();
    [0, 1, 2].map(|k| {
        let row = rows.col(k);
        let along = |axis: &Tree, by: f64| axis.clone() * number(by);
        along(&x, row.x)
            + along(&y, row.y)
            + along(&z, row.z)
            + number(by.translation[k])
    })
}
