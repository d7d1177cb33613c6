//! The one-coordinate parts of the expression, evaluated along the lattice.
//!
//! In: the parts of one coordinate and its nodes (columns, rows or layers).
//! Out: their values and slopes at the nodes, their ranges over tiles, blocks
//! and leaves, and their values anywhere else on request.

use super::boxes::range_of;
use super::lanes::{Lanes, Seed, Slopes};
use crate::interval::Interval;
use fidget::vm::VmFunction;

/// The three sizes of box about which something is proved.
#[derive(Clone, Copy)]
pub(super) enum Level {
    /// A tile of a slab.
    Tile = 0,
    /// A block of a tile.
    Block = 1,
    /// A leaf, in one layer.
    Leaf = 2,
}

/// How the nodes of an axis are grouped into boxes of one level. Box number b
/// reaches from node b·step − pad to node b·step + reach + pad.
#[derive(Clone, Copy)]
pub(super) struct Grouping {
    step: usize,
    reach: usize,
    pad: usize,
}

impl Grouping {
    /// Squares with a side of so many cells, and `pad` cells around each.
    pub(super) const fn of_cells(side: usize, pad: usize) -> Grouping {
        Grouping {
            step: side,
            reach: side,
            pad,
        }
    }

    /// So many layers each.
    pub(super) const fn of_layers(count: usize) -> Grouping {
        Grouping {
            step: count,
            reach: count - 1,
            pad: 0,
        }
    }

    /// First and last node of box `b` of an axis of `count` nodes.
    pub(super) fn ends(self, b: usize, count: usize) -> [usize; 2] {
        let from = (b * self.step).saturating_sub(self.pad);
        let to = b * self.step + self.reach + self.pad;
        [from, to.min(count.saturating_sub(1))]
    }
}

/// One part along one axis.
struct Column {
    values: Vec<f32>,
    /// Derivatives by the coordinate.
    slopes: Vec<f32>,
    /// Ranges by level, then by box.
    ranges: [Vec<Interval>; 3],
}

/// The nodes of one axis and the parts that depend on it alone.
pub(super) struct Axis {
    nodes: Vec<f32>,
    groupings: [Grouping; 3],
    /// Nodes per millimetre if they are evenly spaced, or else 0.
    density: f64,
    /// How far a box reaches beyond its last nodes.
    beyond: fn(f32) -> f32,
    columns: Vec<Column>,
}

/// Points along an axis, found among its nodes.
#[derive(Default)]
pub(super) struct Located {
    /// The node on which each point is; any number for points on no node.
    on: Vec<u32>,
    /// The points that are on no node, and their coordinates.
    off: Vec<u32>,
    missing: Vec<f32>,
}

/// Evaluators of one thread, for the points that are not on the lattice.
#[derive(Default)]
pub(super) struct Scratch {
    lanes: Lanes,
    fresh: Vec<f32>,
    slopes: Vec<[f32; 3]>,
}

/// The interval from one node to another, and some way beyond both.
fn reach(
    nodes: &[f32],
    beyond: fn(f32) -> f32,
    [lo, hi]: [usize; 2],
) -> Interval {
    let (lo, hi) = (nodes[lo], nodes[hi]);
    Interval::new((lo - beyond(lo)).into(), (hi + beyond(hi)).into())
}

impl Axis {
    /// Evaluates the parts at the nodes; `nodes` must not be empty.
    pub(super) fn new(
        nodes: Vec<f32>,
        density: f64,
        groupings: [Grouping; 3],
        beyond: fn(f32) -> f32,
        parts: &[VmFunction],
    ) -> Axis {
        let mut scratch = Scratch::default();
        let n = nodes.len();
        let reach = |g: Grouping, b| reach(&nodes, beyond, g.ends(b, n));
        let columns = parts.iter().map(|f| {
            let mut slopes = Vec::new();
            scratch.slopes(f, &nodes, &mut slopes);
            let ranges = groupings.map(|g| {
                (0..n.div_ceil(g.step))
                    .map(|b| range_of(f, reach(g, b)))
                    .collect()
            });
            Column {
                values: slopes.iter().map(|s| s[0]).collect(),
                slopes: slopes.iter().map(|s| s[1]).collect(),
                ranges,
            }
        });
        let columns = columns.collect();
        Axis {
            nodes,
            groupings,
            density,
            beyond,
            columns,
        }
    }

    /// Box `b`'s extent.
    pub(super) fn extent(&self, level: Level, b: usize) -> Interval {
        let ends = self.groupings[level as usize].ends(b, self.nodes.len());
        reach(&self.nodes, self.beyond, ends)
    }

    /// Range of a part over box `b`.
    pub(super) fn range(
        &self,
        part: usize,
        level: Level,
        b: usize,
    ) -> Interval {
        self.columns[part].ranges[level as usize][b]
    }

    /// The nodes.
    pub(super) fn nodes(&self) -> &[f32] {
        &self.nodes
    }

    /// A part's values at the nodes.
    pub(super) fn values(&self, part: usize) -> &[f32] {
        &self.columns[part].values
    }

    /// Finds the points among the nodes. Of two points on a lattice edge one
    /// coordinate is always a node's.
    pub(super) fn locate(&self, points: &[f32], located: &mut Located) {
        let Located { on, off, missing } = located;
        off.clear();
        missing.clear();
        on.clear();
        on.reserve(points.len());
        let nodes = &self.nodes[..];
        let from = nodes.first().map_or(0.0, |&v| f64::from(v));
        let mut node = 0;
        for (&p, k) in points.iter().zip(0..) {
            // Often it is the node of the last point.
            if nodes.get(node) != Some(&p) {
                let guess = if self.density == 0.0 {
                    let found = nodes.binary_search_by(|v| v.total_cmp(&p));
                    found.unwrap_or(usize::MAX)
                } else {
                    // A conversion by way of `usize` takes longer.
                    let place = (f64::from(p) - from) * self.density + 0.5;
                    place as i32 as usize
                };
                if nodes.get(guess) == Some(&p) {
                    node = guess;
                } else {
                    off.push(k);
                    missing.push(p);
                }
            }
            on.push(node as u32);
        }
    }

    /// A part's values at located points.
    pub(super) fn values_at(
        &self,
        part: usize,
        f: &VmFunction,
        at: &Located,
        scratch: &mut Scratch,
        out: &mut Vec<f32>,
    ) {
        let known = &self.columns[part].values;
        out.clear();
        out.extend(at.on.iter().map(|&n| known[n as usize]));
        if at.missing.is_empty() {
            return;
        }
        let mut fresh = std::mem::take(&mut scratch.fresh);
        scratch.values(f, &at.missing, &mut fresh);
        for (&k, &v) in at.off.iter().zip(&fresh) {
            out[k as usize] = v;
        }
        scratch.fresh = fresh;
    }

    /// A part's values and slopes at located points. They overwrite `values`
    /// and `slopes`.
    pub(super) fn slopes_at(
        &self,
        part: usize,
        f: &VmFunction,
        at: &Located,
        scratch: &mut Scratch,
        values: &mut Vec<f32>,
        slopes: &mut Vec<f32>,
    ) {
        let known = &self.columns[part];
        values.clear();
        slopes.clear();
        values.extend(at.on.iter().map(|&n| known.values[n as usize]));
        slopes.extend(at.on.iter().map(|&n| known.slopes[n as usize]));
        if at.missing.is_empty() {
            return;
        }
        let mut fresh = std::mem::take(&mut scratch.slopes);
        scratch.slopes(f, &at.missing, &mut fresh);
        for (&k, &[v, d, _]) in at.off.iter().zip(&fresh) {
            values[k as usize] = v;
            slopes[k as usize] = d;
        }
        scratch.slopes = fresh;
    }
}

impl Scratch {
    fn values(&mut self, f: &VmFunction, points: &[f32], out: &mut Vec<f32>) {
        out.clear();
        self.lanes.eval(f, &[points], points.len(), out);
    }

    /// Values and derivatives along x, with no y.
    fn slopes(
        &mut self,
        f: &VmFunction,
        points: &[f32],
        out: &mut Vec<[f32; 3]>,
    ) {
        out.clear();
        let seed = Seed {
            values: points,
            slopes: Slopes::Coordinate(0),
        };
        self.lanes.slopes(f, &[seed], points.len(), out);
    }
}
