//! Bounds on the gradient over boxes.
//!
//! The gradient at a place leads away from the place of the axis that is closest.
//! Between two places that way changes by no more than the places do, so it turns
//! little in a box that is far from the axis.
//!
//! ```text
//!            ┌───┐
//!            │ c │   half its diagonal: h
//!            └───┘
//!              ╱ D   the way to c is D long, so another way in the box differs
//!   ━━━━━━━━━━●━━━━  by h at most: the angle's sine is below h / D
//! ```

use super::Struts;
use super::strut::Strut;
use crate::tree::{Child, child};
use glam::DVec3;
use isocontour::Bounds;

/// Most struts that are looked at.
const MOST: usize = 8;
/// How far gradients may be off by rounding.
const SLACK: f64 = 1e-5;

impl Struts {
    /// For each axis two numbers between which all derivatives in a box are.
    pub(super) fn slopes_over(&self, over: &Bounds) -> [[f64; 2]; 3] {
        self.gradients(over).unwrap_or([[-1.0, 1.0]; 3])
    }

    /// None if too many struts may be closest somewhere in the box, or if one
    /// may have any gradient.
    fn gradients(&self, over: &Bounds) -> Option<[[f64; 2]; 3]> {
        let reach = over.min.abs().max(over.max.abs()).max_element();
        // Also if it is not a number.
        let is_near = reach < 1e9;
        if !is_near {
            return None;
        }
        let half = 0.5 * over.size().length();
        let centre = over.centre();
        // What is farther than that is closest nowhere in the box.
        let most = self.nearest(centre, 0).distance + 2.0 * half;
        let most = most + 1e-9 * (reach + self.deepest);
        let mut slopes = [[1.0f64, -1.0]; 3];
        let mut count = 0;
        let mut todo = vec![0u32];
        while let Some(link) = todo.pop() {
            match child(link) {
                Child::Nothing => {}
                Child::Node(node) => {
                    let node = &self.tree.nodes[node];
                    let near = |i: &usize| {
                        over.gap(&node.bounds(*i)) <= (most - half).max(0.0)
                    };
                    todo.extend((0..4).filter(near).map(|i| node.link(i)));
                }
                Child::Leaf(first, end) => {
                    for strut in &self.struts[first..end] {
                        if strut.distance(centre) > most {
                            continue;
                        }
                        count += 1;
                        let (out, by) = turned(strut, centre, half)?;
                        if count > MOST {
                            return None;
                        }
                        for (slope, out) in
                            slopes.iter_mut().zip(out.to_array())
                        {
                            slope[0] = slope[0].min(out - by - SLACK);
                            slope[1] = slope[1].max(out + by + SLACK);
                        }
                    }
                }
            }
        }
        Some(slopes)
    }
}

/// The gradient of a strut at a place, and by how much that of another place may
/// differ. None if it may be any.
fn turned(strut: &Strut, p: DVec3, distance: f64) -> Option<(DVec3, f64)> {
    let way = strut.way_from_axis(p)?;
    let length = way.length();
    // The sine of the greatest angle between two ways.
    let sine = distance / length;
    // The distance of two directions at that angle.
    let chord = (2.0 * (1.0 - (1.0 - sine * sine).sqrt())).sqrt();
    (sine < 1.0).then(|| (way / length, chord))
}
