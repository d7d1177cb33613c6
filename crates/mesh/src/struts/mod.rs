//! Struts as a function: the distance to thousands of cones and balls.
//!
//! In: [`Strut`]s. Out: [`Struts`], which is [`isocontour::Data`]: one leaf of an
//! expression, whatever the number of struts.
//!
//! | file | what it does |
//! |---|---|
//! | `strut` | the distance to one strut, and the box around it |
//! | `range`, `slopes` | bounds over boxes |
//!
//! Guarantees: the value is the least of the distances to the struts, each
//! negative inside. Outside that is exact. Inside it is exact where struts are
//! apart, and where they meet it is that of the strut in which a place is
//! deepest. In a strut with different ends that is shorter than it is thick,
//! the surface may be deeper than the value says.

mod range;
mod slopes;
mod strut;
#[cfg(test)]
mod tests;

pub use strut::{Cap, Strut};

use crate::error::MeshError;
use crate::limits::{FARTHEST, MOST_STRUTS};
use crate::shell::Reach;
use crate::tree::{Child, Node, STACK, Tree, child};
use glam::{DAffine3, DVec3};
use isocontour::{Bounds, Data, places};
use rayon::prelude::*;

/// Places that are farther than this along an axis, mm, are so far that all
/// struts are a point.
const FAR_AWAY: f64 = 1e15;

/// Struts as a function of three coordinates, mm: the distance to the closest
/// one, negative inside.
#[derive(Debug)]
pub struct Struts {
    name: String,
    /// In the order of the tree.
    struts: Vec<Strut>,
    tree: Tree,
    bounds: Bounds,
    /// The thickest radius: no place is deeper.
    deepest: f64,
}

/// The strut that is closest to a place, and how far it is.
#[derive(Clone, Copy)]
struct Nearest {
    strut: usize,
    distance: f64,
}

/// More than what distances are rounded by, mm, up to 100 km from the origin.
const ROUNDED: f64 = 1e-6;

impl Struts {
    /// Makes a function of struts. `name` is how messages call it.
    ///
    /// # Errors
    /// If there are none or too many, or if a number is none, or is too large.
    pub fn new(name: &str, struts: Vec<Strut>) -> Result<Struts, MeshError> {
        if struts.is_empty() {
            return Err(MeshError::Empty);
        }
        if struts.len() > MOST_STRUTS {
            return Err(MeshError::TooManyStruts);
        }
        for (i, strut) in struts.iter().enumerate() {
            check(i, strut)?;
        }
        let around = |i: usize| struts[i].extent(&DAffine3::IDENTITY);
        let (tree, order) = Tree::of(struts.len(), around);
        isoslice_base::limits::go_on()?;
        let struts: Vec<Strut> =
            order.iter().map(|i| struts[*i as usize]).collect();
        let deepest = struts.iter().map(Strut::thickest).fold(0.0, f64::max);
        let mut all = Struts {
            name: name.to_owned(),
            struts,
            tree,
            bounds: Bounds::EMPTY,
            deepest,
        };
        all.bounds = all.around(&DAffine3::IDENTITY);
        Ok(all)
    }

    /// The box around all struts where `seen` puts them.
    fn around(&self, seen: &DAffine3) -> Bounds {
        let boxes = self.struts.par_iter().map(|s| s.extent(seen));
        boxes.reduce(|| Bounds::EMPTY, Bounds::union)
    }

    /// The strut that is closest to a place, or in which it is deepest; of
    /// several the first. `guess` makes the search shorter, and changes nothing.
    fn nearest(&self, p: DVec3, guess: usize) -> Nearest {
        let look = |strut: usize| Nearest {
            strut,
            distance: self.struts[strut].distance(p),
        };
        let mut best = look(guess.min(self.struts.len() - 1));
        let reach = Reach::around(p);
        // What is inside any strut is in its box.
        let limit =
            |best: &Nearest| reach.limit(best.distance.max(0.0).powi(2));
        let mut most = limit(&best);
        let mut stack = [(0.0f32, 0u32); STACK];
        let mut top = 1;
        while top > 0 {
            top -= 1;
            let (square, link) = stack[top];
            if square > most {
                continue;
            }
            match child(link) {
                Child::Nothing => {}
                Child::Leaf(first, end) => {
                    for strut in first..end {
                        let least = self.struts[strut].at_least(p);
                        if least > best.distance + ROUNDED {
                            continue;
                        }
                        let near = look(strut);
                        if near.distance < best.distance
                            || (near.distance == best.distance
                                && near.strut < best.strut)
                        {
                            best = near;
                        }
                    }
                    most = limit(&best);
                }
                Child::Node(at) => {
                    let node = &self.tree.nodes[at];
                    reach.push(node, most, &mut stack, &mut top);
                }
            }
        }
        best
    }

    fn far_away(&self, p: DVec3) -> Option<(f64, DVec3)> {
        let way = p - self.bounds.centre();
        let is_far = p.abs().max_element() > FAR_AWAY;
        is_far.then(|| (way.length(), way.normalize_or_zero()))
    }
}

fn check(i: usize, strut: &Strut) -> Result<(), MeshError> {
    let place = || format!("strut {i}");
    let [a, b] = strut.ends;
    let far = a.abs().max(b.abs()).max_element();
    let thick = strut.thickest();
    let least = strut.radii[0].min(strut.radii[1]);
    let is_finite = a.is_finite() && b.is_finite() && thick.is_finite();
    if !is_finite || far > FARTHEST || thick > FARTHEST {
        return Err(MeshError::at(
            place(),
            "it is farther than 100 km from the origin, or thicker than that; \
             is the file damaged?",
        ));
    }
    // Also if it is not a number.
    let is_sound = least >= 0.0 && thick > 0.0;
    if is_sound {
        Ok(())
    } else {
        Err(MeshError::at(place(), "its radius is not above 0"))
    }
}

impl Data for Struts {
    fn name(&self) -> &str {
        &self.name
    }

    fn at(&self, p: DVec3) -> (f64, DVec3) {
        self.far_away(p).unwrap_or_else(|| {
            let near = self.nearest(p, 0);
            let (_, out) = self.struts[near.strut].distance_and_gradient(p);
            (near.distance, out)
        })
    }

    fn value(&self, p: DVec3) -> f64 {
        match self.far_away(p) {
            Some((distance, _)) => distance,
            None => self.nearest(p, 0).distance,
        }
    }

    fn values(&self, at: [&[f32]; 3], out: &mut Vec<f32>) {
        let mut last = 0;
        let mut value = |p| match self.far_away(p) {
            Some((distance, _)) => distance as f32,
            None => {
                let near = self.nearest(p, last);
                last = near.strut;
                near.distance as f32
            }
        };
        out.extend(places(at).map(|p| p.map_or(f32::NAN, &mut value)));
    }

    fn range(&self, over: &Bounds) -> [f64; 2] {
        self.range_over(over)
    }

    fn slopes(&self, over: &Bounds) -> [[f64; 2]; 3] {
        self.slopes_over(over)
    }

    fn bytes(&self) -> usize {
        size_of::<Struts>()
            + self.struts.capacity() * size_of::<Strut>()
            + self.tree.nodes.capacity() * size_of::<Node>()
    }

    fn contents(&self, tell: &mut dyn FnMut(&[u8])) {
        for strut in &self.struts {
            for number in strut.ends.map(|e| e.to_array()).as_flattened() {
                tell(&number.to_le_bytes());
            }
            for number in strut.radii {
                tell(&number.to_le_bytes());
            }
            tell(&strut.caps.map(|cap| cap as u8));
        }
    }

    fn extent(&self, place: &DAffine3) -> Option<Bounds> {
        let all = self.around(&place.inverse());
        all.is_finite().then_some(all)
    }
}
