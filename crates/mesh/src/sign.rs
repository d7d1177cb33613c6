//! Inside or outside.
//!
//! A place is inside where the winding number is above one half. Triangles
//! without a rim have whole winding numbers, which a ray counts exactly. Those
//! with a rim are closed by caps: the ray counts both. Small caps are taken for
//! what is missing. What large ones cover of the sphere of sight is taken off
//! again. So the cost is that of a ray and of the large holes.

use crate::caps::{Caps, caps};
use crate::ray::Direction;
use crate::rim::RimEdge;
use crate::shell::Shell;
use crate::tree::{Child, child, gap};
use crate::winding::Winding;
use glam::DVec3;
use isocontour::Bounds;
use std::f64::consts::PI;

/// How winding numbers of a mesh are found.
#[derive(Debug)]
pub(crate) struct Sign {
    /// The small caps.
    pub small: Option<Caps>,
    large: Large,
}

/// What small caps do not close.
#[derive(Debug)]
enum Large {
    Nothing,
    Capped {
        caps: Shell,
        winding: Winding,
        /// For each node of the caps, the length of the rim below it.
        lengths: Vec<f64>,
    },
    /// The rim is about as long as all edges together.
    Loose(Winding),
}

impl Sign {
    pub(crate) fn new(shell: &Shell, rim: &[RimEdge]) -> Sign {
        if rim.is_empty() {
            return Sign {
                small: None,
                large: Large::Nothing,
            };
        }
        let (small, large) = caps(shell, rim);
        let Some(large) = large else {
            return Sign {
                small,
                large: Large::Nothing,
            };
        };
        if large.shell.corners.len() > shell.corners.len() / 2 {
            return Sign {
                small: None,
                large: Large::Loose(Winding::new(shell)),
            };
        }
        let large = Large::Capped {
            winding: Winding::new(&large.shell),
            lengths: lengths(&large.shell),
            caps: large.shell,
        };
        Sign { small, large }
    }

    /// What closes the triangles, if winding numbers change at triangles and at
    /// these only.
    pub(crate) fn cap(&self) -> Option<Option<&Shell>> {
        matches!(self.large, Large::Nothing)
            .then(|| self.small.as_ref().map(|caps| &caps.shell))
    }

    /// True if winding numbers change at triangles only.
    pub(crate) fn is_closed(&self) -> bool {
        self.small.is_none() && matches!(self.large, Large::Nothing)
    }

    /// The number of edges of the rim that small caps do not close.
    pub(crate) fn wide_open(&self) -> usize {
        match &self.large {
            Large::Nothing => 0,
            Large::Capped { caps, .. } => caps.corners.len(),
            Large::Loose(_) => usize::MAX,
        }
    }

    /// The winding number of `shell` at a place.
    pub(crate) fn winding(
        &self,
        shell: &Shell,
        bounds: &Bounds,
        p: DVec3,
    ) -> f64 {
        let way = outwards(bounds, p);
        let count = |shell: &Shell| shell.crossings(p, way, |_| true);
        let small = self.small.as_ref().map_or(0, |caps| count(&caps.shell));
        match &self.large {
            Large::Nothing => (count(shell) + small) as f64,
            Large::Capped { caps, winding, .. } => {
                let all = count(shell) + small + count(caps);
                all as f64 - winding.at(caps, p)
            }
            Large::Loose(winding) => winding.at(shell, p),
        }
    }

    /// True if the sign may change within a distance of a box at a place that is
    /// on no triangle.
    pub(crate) fn may_change(&self, over: &Bounds, within: f64) -> bool {
        let margin = DVec3::splat(within);
        let grown = Bounds {
            min: over.min - margin,
            max: over.max + margin,
        };
        !matches!(self.large, Large::Nothing) || self.is_capped(&grown)
    }

    /// True if a small cap may meet a box.
    fn is_capped(&self, over: &Bounds) -> bool {
        let Some(caps) = &self.small else {
            return false;
        };
        let mut meets = false;
        let near = |node: &crate::tree::Node| {
            [0, 1, 2, 3].map(|i| gap(over, &node.bounds(i)) == 0.0)
        };
        caps.shell.tree.visit(near, |_, _| meets = true);
        meets
    }

    /// By how much the winding number may differ from that in the middle of a
    /// box, at places in the box, if no triangle meets it.
    ///
    /// Its gradient is that of a current along the rim (Biot and Savart): a
    /// piece changes it by no more than its length by the square of its
    /// distance, by 4π.
    pub(crate) fn change(&self, over: &Bounds) -> f64 {
        if self.is_capped(over) {
            return f64::INFINITY;
        }
        match &self.large {
            Large::Nothing => 0.0,
            Large::Loose(_) => f64::INFINITY,
            Large::Capped { caps, lengths, .. } => {
                let mut sum = 0.0;
                let mut todo = vec![0];
                while let Some(at) = todo.pop() {
                    let node = &caps.tree.nodes[at];
                    for i in 0..4 {
                        let bounds = node.bounds(i);
                        let gap = gap(over, &bounds);
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

    /// Memory, bytes.
    pub(crate) fn bytes(&self) -> usize {
        let small = self.small.as_ref().map_or(0, |caps| {
            caps.shell.bytes() + caps.numbers.capacity() * size_of::<u32>()
        });
        let large = match &self.large {
            Large::Nothing => 0,
            Large::Capped {
                caps,
                winding,
                lengths,
            } => {
                caps.bytes()
                    + winding.bytes()
                    + lengths.capacity() * size_of::<f64>()
            }
            Large::Loose(winding) => winding.bytes(),
        };
        small + large
    }
}

/// What the edge of a cap's rim adds, at most, to a gradient in a box.
fn at_edge(over: &Bounds, [_, a, b]: [DVec3; 3]) -> f64 {
    let edge = Bounds {
        min: a.min(b),
        max: a.max(b),
    };
    let gap = gap(over, &edge);
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
