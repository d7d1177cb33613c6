//! Bounds on distances over boxes.
//!
//! The distance to a triangle is convex. So its greatest value in a box is at a
//! corner, and it is at least what the plane through the closest point, across
//! the way to it, says: the whole triangle is behind that plane.
//!
//! ```text
//!        ┌───────┐
//!        │   c   │         c to the triangle: d
//!        └───┼───┘         the box reaches r along that way
//!   - - - - -┼- - - - -    the triangle is below the plane, so it is at
//!          __/\__          least d − r away from the box
//! ```

use crate::closest::{Near, closest};
use crate::mesh::Mesh;
use crate::shell::Shell;
use crate::tree::{Child, child, corners};
use glam::DVec3;
use isocontour::Bounds;

/// What roundings, those of values in f32 too, may take off or add: this share of
/// the distance.
const ROUNDING: f64 = 2e-7;

/// If a ball around a box leaves this share of the way to the closest triangle,
/// no closer look is taken at the box.
const ENOUGH: f64 = 0.25;

/// The distances from a box to triangles.
struct Distances {
    /// No place in the box is nearer than this. 0 if the box may meet one.
    least: f64,
    /// No place in the box is farther from the closest triangle.
    greatest: f64,
    /// From the middle of the box.
    middle: f64,
}

impl Shell {
    /// A bound from below on the distance of a box and all triangles, given that
    /// `sure` is one, and that one triangle allows no more than `least`.
    fn least(&self, over: &Bounds, sure: f64, mut least: f64) -> f64 {
        let mut todo: Vec<(f64, u32)> = vec![(0.0, 0)];
        while let Some((at, link)) = todo.pop() {
            if at >= least || least <= sure {
                continue;
            }
            match child(link) {
                Child::Nothing => {}
                Child::Leaf(first, end) => {
                    for i in first..end {
                        least = least.min(self.apart(i, over));
                    }
                }
                Child::Node(node) => {
                    let node = &self.tree.nodes[node];
                    for i in 0..4 {
                        let gap = over.gap(&node.bounds(i));
                        if gap < least {
                            todo.push((gap, node.link(i)));
                        }
                    }
                }
            }
        }
        least.max(sure)
    }

    /// A bound from below on the distance of a box and a triangle.
    pub(crate) fn apart(&self, triangle: usize, over: &Bounds) -> f64 {
        let [a, b, c] = self.triangle(triangle);
        let around = Bounds::around([a, b, c]);
        let centre = over.centre();
        let way = closest(centre, [a, b, c]) - centre;
        let distance = way.length();
        let plane = if distance > 0.0 {
            distance - (way / distance).abs().dot(0.5 * over.size())
        } else {
            0.0
        };
        over.gap(&around).max(plane)
    }
}

impl Mesh {
    fn distances(&self, over: &Bounds) -> Distances {
        let near = self.nearest(over.centre());
        let middle = near.square.sqrt();
        // The box reaches no farther from its middle than half its diagonal.
        let half = 0.5 * over.size().length();
        let mut least = (middle - half).max(0.0);
        if least < ENOUGH * middle {
            let apart = self.shell.apart(near.triangle, over);
            least = self.shell.least(over, least, apart);
        }
        Distances {
            least,
            greatest: self.greatest_of(&near, over).min(middle + half),
            middle,
        }
    }

    /// No place in a box is farther than this from the closest triangle.
    pub(crate) fn greatest(&self, over: &Bounds) -> f64 {
        self.greatest_of(&self.nearest(over.centre()), over)
    }

    /// The same, of one triangle.
    fn greatest_of(&self, near: &Near, over: &Bounds) -> f64 {
        let triangle = self.shell.triangle(near.triangle);
        corners(over)
            .map(|p| p.distance_squared(closest(p, triangle)))
            .into_iter()
            .fold(0.0, f64::max)
            .sqrt()
    }

    /// Two numbers between which all values in a box are.
    pub(crate) fn range_over(&self, over: &Bounds) -> [f64; 2] {
        // The deepest place is at most this far from a triangle.
        let deepest = 0.5 * self.bounds.size().length();
        let meets = over.gap(&self.bounds) == 0.0;
        let lowest = if meets { -deepest } else { 0.0 };
        if over.min.is_nan() || over.max.is_nan() {
            return [f64::NEG_INFINITY, f64::INFINITY];
        }
        let reach = over.min.abs().max(over.max.abs()).max_element();
        if reach > 1e12 {
            return [lowest - deepest * 1e-3, f64::INFINITY];
        }
        let d = self.distances(over);
        let slack = f64::EPSILON * 64.0 * (reach + deepest);
        let (least, greatest) = (
            (d.least * (1.0 - ROUNDING) - slack).max(0.0),
            d.greatest * (1.0 + ROUNDING) + slack,
        );
        if !meets {
            return [least, greatest];
        }
        if least > 0.0 {
            return match self.side_of(over) {
                Some(true) => [-greatest, -least],
                Some(false) => [least, greatest],
                None => [-greatest, greatest],
            };
        }
        if !self.sign.is_closed() {
            return [-greatest, greatest];
        }
        // It changes by no more than the way.
        let half = 0.5 * over.size().length() * (1.0 + ROUNDING);
        let middle = if self.is_inside(over.centre()) {
            -d.middle
        } else {
            d.middle
        };
        let slack = slack + ROUNDING * d.middle;
        [
            (middle - half - slack).max(-greatest),
            (middle + half + slack).min(greatest),
        ]
    }

    /// True if a box that no triangle meets is inside, false if it is outside.
    /// None if it may be either or both.
    fn side_of(&self, over: &Bounds) -> Option<bool> {
        if self.sign.is_closed() {
            return Some(self.is_inside(over.centre()));
        }
        let within = |p: DVec3| self.bounds.contains(p);
        let above = self.winding(over.centre()) - 0.5;
        // Winding numbers of what is far are off by some thousandths.
        let change = self.sign.change(over) + 0.02;
        if above < -change {
            Some(false)
        } else if above > change && within(over.min) && within(over.max) {
            Some(true)
        } else {
            None
        }
    }
}
