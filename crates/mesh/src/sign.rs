//! Inside or outside.
//!
//! A place is inside where the winding number is above one half. Triangles
//! without a rim have whole winding numbers, which a ray counts exactly. A rim
//! that repairs have left is closed by a cover, if that changes nothing of what
//! is inside (see `cover.rs`). Otherwise it is closed by caps: the ray counts
//! both, and what the caps cover of the sphere of sight is taken off again. So
//! the cost is that of a ray and of the holes.
//!
//! ```text
//!     ______               the caps (dotted) make it closed: the ray counts 1,
//!    /      \   p inside   the cap covers c of the sphere of sight at p, so
//!   |   p →  |             the winding number at p is 1 − c
//!    \......./
//! ```

use crate::cover::Cover;
use crate::error::MeshError;
use crate::ray::Direction;
use crate::rim::{RimEdge, caps};
use crate::shell::Shell;
use crate::tree::{Child, child};
use crate::winding::Winding;
use glam::DVec3;
use isocontour::Bounds;
use std::f64::consts::PI;

/// How winding numbers of a mesh are found.
#[derive(Debug)]
pub(crate) enum Sign {
    /// There is no rim.
    Closed,
    /// There is a rim, and what is inside is as with a cover over it.
    Covered(Box<Cover>),
    /// There is a rim, and caps that close it.
    Capped {
        caps: Box<Shell>,
        winding: Winding,
        /// For each node of the caps, the length of the rim below it.
        lengths: Vec<f64>,
    },
    /// The rim is about as long as all edges together.
    Loose(Winding),
}

impl Sign {
    pub(crate) fn new(
        shell: &Shell,
        bounds: &Bounds,
        rim: &[RimEdge],
    ) -> Result<Sign, MeshError> {
        if rim.is_empty() {
            return Ok(Sign::Closed);
        }
        let open = Sign::open(shell, rim);
        let (cover, places) = Cover::new(shell, rim)?;
        let agrees = cover.agrees(
            shell,
            &places,
            |p| outwards(bounds, p),
            |p| open.winding(shell, bounds, p),
        );
        Ok(if agrees {
            Sign::Covered(Box::new(cover))
        } else {
            open
        })
    }

    /// Of triangles that stay open.
    pub(crate) fn open(shell: &Shell, rim: &[RimEdge]) -> Sign {
        let edges: u64 = rim.iter().map(|e| u64::from(e.times)).sum();
        if edges > shell.corners.len() as u64 / 2 {
            return Sign::Loose(Winding::new(shell));
        }
        let caps = Box::new(caps(shell, rim));
        let winding = Winding::new(&caps);
        let lengths = lengths(&caps);
        Sign::Capped {
            caps,
            winding,
            lengths,
        }
    }

    /// True if winding numbers change at triangles only.
    pub(crate) fn is_closed(&self) -> bool {
        matches!(self, Sign::Closed)
    }

    /// The winding number of `shell` at a place.
    pub(crate) fn winding(
        &self,
        shell: &Shell,
        bounds: &Bounds,
        p: DVec3,
    ) -> f64 {
        let direction = outwards(bounds, p);
        match self {
            Sign::Closed => shell.crossings(p, direction, |_| true) as f64,
            Sign::Covered(cover) => cover.winding(shell, p, direction) as f64,
            Sign::Capped { caps, winding, .. } => {
                let all = shell.crossings(p, direction, |_| true)
                    + caps.crossings(p, direction, |_| true);
                all as f64 - winding.at(caps, p)
            }
            Sign::Loose(winding) => winding.at(shell, p),
        }
    }

    /// True if the rim, or what closes it, may be within a distance of a box.
    pub(crate) fn may_be_near_rim(&self, over: &Bounds, within: f64) -> bool {
        match self {
            Sign::Closed => false,
            Sign::Covered(cover) => cover.meets(&over.grown(within)),
            Sign::Capped { .. } | Sign::Loose(_) => true,
        }
    }

    /// True if the sign may change in a box at a place that is on no triangle.
    pub(crate) fn may_change(&self, over: &Bounds) -> bool {
        match self {
            Sign::Closed => false,
            Sign::Covered(cover) => cover.is_alone(over),
            Sign::Capped { .. } | Sign::Loose(_) => true,
        }
    }

    /// By how much the winding number may differ from that in the middle of a
    /// box, at places in the box, if no triangle meets it.
    ///
    /// Its gradient is that of a current along the rim (Biot and Savart): a
    /// piece changes it by no more than its length by the square of its
    /// distance, by 4π.
    pub(crate) fn change(&self, over: &Bounds) -> f64 {
        match self {
            Sign::Closed => 0.0,
            Sign::Covered(cover) if cover.is_alone(over) => f64::INFINITY,
            Sign::Covered(_) => 0.0,
            Sign::Loose(_) => f64::INFINITY,
            Sign::Capped { caps, lengths, .. } => {
                let mut sum = 0.0;
                let mut todo = vec![0];
                while let Some(at) = todo.pop() {
                    let node = &caps.tree.nodes[at];
                    for i in 0..4 {
                        let bounds = node.bounds(i);
                        let gap = over.gap(&bounds);
                        match child(node.link(i)) {
                            Child::Nothing => {}
                            // What is nearer than it is large is looked into.
                            Child::Node(next)
                                if gap < bounds.size().length() =>
                            {
                                todo.push(next);
                            }
                            Child::Node(next) => {
                                sum += lengths[next] / (gap * gap);
                            }
                            Child::Leaf(first, end) => {
                                sum += (first..end)
                                    .map(|t| at_edge(over, caps.triangle(t)))
                                    .sum::<f64>();
                            }
                        }
                    }
                }
                sum / (4.0 * PI) * 0.5 * over.size().length()
            }
        }
    }

    /// What closes the triangles, in sections as for the sign.
    pub(crate) fn cover(&self) -> Option<&Cover> {
        match self {
            Sign::Covered(cover) => Some(cover),
            _ => None,
        }
    }

    /// True if winding numbers are whole, and change at triangles only and at
    /// those of the cover.
    pub(crate) fn is_whole(&self) -> bool {
        matches!(self, Sign::Closed | Sign::Covered(_))
    }

    /// Memory, bytes.
    pub(crate) fn bytes(&self) -> usize {
        match self {
            Sign::Closed => 0,
            Sign::Covered(cover) => cover.bytes(),
            Sign::Capped {
                caps,
                winding,
                lengths,
            } => {
                caps.bytes()
                    + winding.bytes()
                    + lengths.capacity() * size_of::<f64>()
            }
            Sign::Loose(winding) => winding.bytes(),
        }
    }
}

/// What the edge of a cap's rim adds, at most, to a gradient in a box.
fn at_edge(over: &Bounds, [_, a, b]: [DVec3; 3]) -> f64 {
    let gap = over.gap(&Bounds::new(a.min(b), a.max(b)));
    a.distance(b) / (gap * gap)
}

/// The lengths of rim below the nodes of caps.
fn lengths(caps: &Shell) -> Vec<f64> {
    let nodes = &caps.tree.nodes;
    let mut lengths = vec![0.0; nodes.len()];
    for at in (0..nodes.len()).rev() {
        lengths[at] = (0..4)
            .map(|i| match child(nodes[at].link(i)) {
                Child::Nothing => 0.0,
                Child::Node(next) => lengths[next],
                Child::Leaf(first, end) => (first..end)
                    .map(|t| {
                        let [_, a, b] = caps.triangle(t);
                        a.distance(b)
                    })
                    .sum(),
            })
            .sum();
    }
    lengths
}

/// The direction to the nearest side of a box.
pub(crate) fn outwards(bounds: &Bounds, p: DVec3) -> Direction {
    let mut best = (
        f64::INFINITY,
        Direction {
            axis: 2,
            is_up: true,
        },
    );
    for axis in 0..3 {
        let ways = [
            (p[axis] - bounds.min[axis], false),
            (bounds.max[axis] - p[axis], true),
        ];
        for (way, is_up) in ways {
            if way < best.0 {
                best = (way, Direction { axis, is_up });
            }
        }
    }
    best.1
}
