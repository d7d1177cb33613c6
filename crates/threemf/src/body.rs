//! One function of all that was placed.

use crate::build::{Clipped, Parts};
use crate::functions::value::number;
use crate::lattice::{Side, scale};
use crate::level::{defined_or, places};
use fidget::context::Tree;
use glam::DAffine3;
use isocontour::{Data, call};
use isoslice_mesh::{Mesh, MeshError, Struts};
use std::fmt;
use std::sync::Arc;

/// What is to be built.
pub struct Body {
    /// The function, negative inside.
    pub tree: Tree,
    /// The data in it, which whoever keeps the function has to keep.
    pub data: Vec<Arc<dyn Data>>,
    /// What its user should know: what was left out, and what was repaired.
    pub notes: Vec<String>,
}

impl fmt::Debug for Body {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let data: Vec<&str> = self.data.iter().map(|d| d.name()).collect();
        write!(f, "Body of {data:?}, {:?}", self.notes)
    }
}

/// Puts a body together.
struct Joining<'a> {
    name: &'a str,
    data: Vec<Arc<dyn Data>>,
    notes: Vec<String>,
}

/// The function of parts.
pub(crate) fn of(name: &str, parts: Parts) -> Result<Body, MeshError> {
    let mut joining = Joining {
        name,
        data: Vec::new(),
        notes: Vec::new(),
    };
    let mut trees = Vec::new();
    if let Some(triangles) = parts.triangles {
        let mesh = Mesh::new(name, triangles)?;
        joining.notes.extend(mesh.facts().repairs());
        trees.push(joining.leaf(Arc::new(mesh)));
    }
    if !parts.struts.is_empty() {
        let struts = Struts::new(name, parts.struts)?;
        trees.push(joining.leaf(Arc::new(struts)));
    }
    for clipped in parts.clipped {
        trees.push(joining.clipped(clipped)?);
    }
    let is_alone = trees.is_empty() && parts.levels.len() == 1;
    for level in parts.levels {
        let tree = put(&level.tree, &level.place);
        // The least of numbers is undefined where one of them is.
        trees.push(if is_alone {
            tree
        } else {
            defined_or(&tree, 1.0)
        });
    }
    joining.data.extend(parts.data);
    let left_out = parts.left_out.iter().map(|what| format!("left out {what}"));
    joining.notes.extend(left_out);
    joining.notes.extend(parts.settings.map(|file| {
        format!(
            "the project's own settings ({file}) are not used; isoslice profiles \
             import makes profiles of them"
        )
    }));
    let Joining { data, notes, .. } = joining;
    let tree = trees.into_iter().reduce(|a, b| a.min(b));
    let tree = tree.ok_or(MeshError::Empty)?;
    Ok(Body { tree, data, notes })
}

impl Joining<'_> {
    fn leaf(&mut self, data: Arc<dyn Data>) -> Tree {
        let (x, y, z) = Tree::axes();
        let tree = call(&data, [x, y, z]);
        self.data.push(data);
        tree
    }

    /// A lattice where it lies on its side of a mesh.
    fn clipped(&mut self, parts: Clipped) -> Result<Tree, MeshError> {
        let Clipped { struts, by, place } = parts;
        let struts = Struts::new(self.name, struts)?;
        let mut tree = self.leaf(Arc::new(struts));
        if let Some((triangles, side)) = by {
            let mesh = Mesh::new(self.name, triangles)?;
            let mesh = self.leaf(Arc::new(mesh));
            tree = match side {
                Side::Inside => tree.max(mesh),
                Side::Outside => tree.max(-mesh),
            };
        }
        Ok(put(&tree, &place))
    }
}

/// A function where `place` puts it. It tells a length that is no longer than
/// the one it told before, seen there.
fn put(tree: &Tree, place: &DAffine3) -> Tree {
    if *place == DAffine3::IDENTITY {
        return tree.clone();
    }
    let back = place.inverse();
    // Lengths before are at most so many times as long as those after.
    let norm = match scale(&back.matrix3) {
        Some(scale) => scale,
        None => {
            let columns = back.matrix3.to_cols_array();
            columns.iter().map(|x| x * x).sum::<f64>().sqrt()
        }
    };
    let [x, y, z] = places(&back);
    let tree = tree.remap_xyz(x, y, z);
    if norm == 1.0 {
        tree
    } else {
        tree / number(norm)
    }
}
