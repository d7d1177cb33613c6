//! Bounds on the distance to struts over boxes.
//!
//! The distance to a convex strut is convex. So its greatest value in a box is at
//! a corner, and the plane that touches it in the middle is nowhere above it.
//! That to any other strut changes by no more than the way.

use super::strut::Strut;
use super::{Nearest, Struts};
use crate::tree::{Child, child, corners};
use isocontour::Bounds;

/// What roundings, those of values in f32 too, may take off or add: this share of
/// the distance.
const ROUNDING: f64 = 2e-7;
/// If a ball around a box leaves this share of the distance of its middle, no
/// closer look is taken at the box.
const ENOUGH: f64 = 0.25;
/// Most struts of a box that are looked at. Boxes that meet more are divided
/// anyway.
const MOST: usize = 64;

impl Struts {
    /// Two numbers between which all values in a box are.
    pub(super) fn range_over(&self, over: &Bounds) -> [f64; 2] {
        if over.min.is_nan() || over.max.is_nan() {
            return [f64::NEG_INFINITY, f64::INFINITY];
        }
        let reach = over.min.abs().max(over.max.abs()).max_element();
        if reach > 1e12 {
            return [-self.deepest * (1.0 + ROUNDING), f64::INFINITY];
        }
        let near = self.nearest(over.centre(), 0);
        let half = 0.5 * over.size().length();
        let mut least = (near.distance - half).max(-self.deepest);
        if least < ENOUGH * near.distance {
            least = self.least(over, near, least);
        }
        let greatest = self.greatest(over, near).min(near.distance + half);
        let slack = 64.0 * f64::EPSILON * (reach + self.deepest);
        let low = least - ROUNDING * least.abs() - slack;
        [low, greatest + ROUNDING * greatest.abs() + slack]
    }

    /// No value in a box is above this: the strut that is closest to its middle
    /// is no farther.
    fn greatest(&self, over: &Bounds, near: Nearest) -> f64 {
        let strut = &self.struts[near.strut];
        if !strut.is_convex() {
            return f64::INFINITY;
        }
        let at_corners = corners(over).map(|p| strut.distance(p));
        at_corners.into_iter().fold(f64::NEG_INFINITY, f64::max)
    }

    /// No value in a box is below this, given that none is below `sure`.
    fn least(&self, over: &Bounds, near: Nearest, sure: f64) -> f64 {
        let mut least = least_of(&self.struts[near.strut], over);
        let mut count = 0;
        let mut todo: Vec<(f64, u32)> = vec![(0.0, 0)];
        while let Some((at, link)) = todo.pop() {
            if least <= sure || count > MOST {
                return sure;
            }
            // What a box does not meet, no value below 0 is from.
            if at > 0.0 && at >= least {
                continue;
            }
            match child(link) {
                Child::Nothing => {}
                Child::Leaf(first, end) => {
                    count += end - first;
                    for strut in &self.struts[first..end] {
                        least = least.min(least_of(strut, over));
                    }
                }
                Child::Node(node) => {
                    let node = &self.tree.nodes[node];
                    let boxes = (0..4).map(|i| (node.bounds(i), node.link(i)));
                    todo.extend(
                        boxes
                            .map(|(b, link)| (over.gap(&b), link))
                            .filter(|(gap, _)| *gap == 0.0 || *gap < least),
                    );
                }
            }
        }
        least.max(sure)
    }
}

/// No place of a box is nearer to a strut, or deeper in it, than this.
fn least_of(strut: &Strut, over: &Bounds) -> f64 {
    let centre = over.centre();
    let half = 0.5 * over.size();
    let by_plane = if strut.is_convex() {
        let (distance, out) = strut.distance_and_gradient(centre);
        distance - out.abs().dot(half)
    } else {
        strut.distance(centre) - half.length()
    };
    let around = strut.extent(&glam::DAffine3::IDENTITY);
    let apart = over.gap(&around);
    if apart > 0.0 {
        by_plane.max(apart)
    } else {
        by_plane.max(-strut.thickest())
    }
}
