//! The one-coordinate parts of the expression, evaluated along the lattice.
//!
//! In: the parts of one coordinate and its nodes (columns, rows or layers).
//! Out: their values and slopes at the nodes, their ranges over tiles, blocks
//! and leaves, and their values anywhere else on request.

use super::FieldError;
use super::lanes::Lanes;
use super::ranges::range_of;
use super::tapes::bug;
use crate::model::Interval;
use fidget::eval::{BulkEvaluator, Function};
use fidget::types::Grad;
use fidget::vm::VmFunction;

/// The three sizes of box that are proved.
#[derive(Clone, Copy)]
pub(super) enum Level {
    /// A tile of a slab.
    Tile = 0,
    /// A block of a tile.
    Block = 1,
    /// A leaf, in one layer.
    Leaf = 2,
}

/// How the nodes of an axis are grouped into boxes of one level: box number
/// b reaches from node b·step − pad to node b·step + reach + pad.
#[derive(Clone, Copy)]
pub(super) struct Grouping {
    pub step: usize,
    pub reach: usize,
    pub pad: usize,
}

impl Grouping {
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
    /// By level, by box.
    ranges: [Vec<Interval>; 3],
}

/// The nodes of one axis and the parts that depend on it alone.
pub(super) struct Axis {
    nodes: Vec<f32>,
    groupings: [Grouping; 3],
    /// Nodes per millimetre if they are evenly spaced, else 0.
    density: f64,
    columns: Vec<Column>,
}

/// Points along an axis, found among its nodes.
#[derive(Default)]
pub(super) struct Located {
    /// The node each point is on, or `OFF`.
    on: Vec<u32>,
    /// The points that are on none.
    missing: Vec<f32>,
}

/// No node.
const OFF: u32 = u32::MAX;

/// Evaluators of one thread, for the points that are not on the lattice.
#[derive(Default)]
pub(super) struct Scratch {
    lanes: Lanes,
    grads: <VmFunction as Function>::GradSliceEval,
    fresh: Vec<f32>,
    seeds: Vec<Grad>,
    dual: Vec<Grad>,
}

impl Axis {
    /// Evaluates the parts at the nodes; `nodes` must not be empty.
    ///
    /// # Errors
    /// If the evaluator fails, which is a bug.
    pub(super) fn new(
        nodes: Vec<f32>,
        density: f64,
        groupings: [Grouping; 3],
        parts: &[VmFunction],
    ) -> Result<Axis, FieldError> {
        let mut scratch = Scratch::default();
        let n = nodes.len();
        let columns = parts.iter().map(|f| {
            let mut grads = Vec::new();
            scratch.dual(f, &nodes, &mut grads)?;
            let ranges = groupings.map(|g| {
                (0..n.div_ceil(g.step))
                    .map(|b| {
                        let [lo, hi] = g.ends(b, n);
                        range_of(
                            f,
                            Interval::new(nodes[lo].into(), nodes[hi].into()),
                        )
                    })
                    .collect()
            });
            let mut values = Vec::new();
            scratch.values(f, &nodes, &mut values);
            Ok(Column {
                values,
                slopes: grads.iter().map(|g| g.dx).collect(),
                ranges,
            })
        });
        let columns = columns.collect::<Result<_, FieldError>>()?;
        Ok(Axis {
            nodes,
            groupings,
            density,
            columns,
        })
    }

    /// Box `b`'s extent, mm.
    pub(super) fn extent(&self, level: Level, b: usize) -> Interval {
        let [lo, hi] = self.groupings[level as usize].ends(b, self.nodes.len());
        Interval::new(self.nodes[lo].into(), self.nodes[hi].into())
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

    /// Which node a point is on, if any: of two points on a lattice edge
    /// one coordinate always is. `hint` is a guess.
    fn node_at(&self, point: f32, hint: usize) -> Option<usize> {
        if self.nodes.get(hint) == Some(&point) {
            return Some(hint);
        }
        if self.density == 0.0 {
            return self.nodes.binary_search_by(|v| v.total_cmp(&point)).ok();
        }
        let from = f64::from(*self.nodes.first()?);
        let guess = (f64::from(point) - from) * self.density + 0.5;
        let guess = guess as usize;
        (self.nodes.get(guess) == Some(&point)).then_some(guess)
    }

    /// Finds the points among the nodes.
    pub(super) fn locate(&self, points: &[f32], located: &mut Located) {
        let mut hint = 0;
        located.on.clear();
        located.missing.clear();
        for &p in points {
            match self.node_at(p, hint) {
                Some(node) => {
                    hint = node;
                    located.on.push(node as u32);
                }
                None => {
                    located.on.push(OFF);
                    located.missing.push(p);
                }
            }
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
        if at.missing.is_empty() {
            out.extend(at.on.iter().map(|&n| known[n as usize]));
            return;
        }
        let mut fresh = std::mem::take(&mut scratch.fresh);
        scratch.values(f, &at.missing, &mut fresh);
        let mut next = fresh.iter().copied();
        out.extend(at.on.iter().map(|&n| match n {
            OFF => next.next().unwrap_or(f32::NAN),
            n => known[n as usize],
        }));
        scratch.fresh = fresh;
    }

    /// A part's values and slopes at located points, as changing with
    /// coordinate `axis`.
    ///
    /// # Errors
    /// If the evaluator fails, which is a bug.
    pub(super) fn grads_at(
        &self,
        part: usize,
        f: &VmFunction,
        axis: usize,
        at: &Located,
        scratch: &mut Scratch,
        out: &mut Vec<Grad>,
    ) -> Result<(), FieldError> {
        let Column { values, slopes, .. } = &self.columns[part];
        let mut fresh = std::mem::take(&mut scratch.dual);
        scratch.dual(f, &at.missing, &mut fresh)?;
        let mut next = fresh.iter();
        out.clear();
        out.extend(at.on.iter().map(|&n| {
            let (v, d) = match n {
                OFF => {
                    next.next().map_or((f32::NAN, f32::NAN), |g| (g.v, g.dx))
                }
                n => (values[n as usize], slopes[n as usize]),
            };
            match axis {
                0 => Grad::new(v, d, 0.0, 0.0),
                1 => Grad::new(v, 0.0, d, 0.0),
                _ => Grad::new(v, 0.0, 0.0, d),
            }
        }));
        scratch.dual = fresh;
        Ok(())
    }
}

impl Scratch {
    fn values(&mut self, f: &VmFunction, points: &[f32], out: &mut Vec<f32>) {
        out.clear();
        self.lanes.eval(f, &[points], points.len(), out);
    }

    /// Values, and derivatives as dx.
    fn dual(
        &mut self,
        f: &VmFunction,
        points: &[f32],
        out: &mut Vec<Grad>,
    ) -> Result<(), FieldError> {
        out.clear();
        if points.is_empty() {
            return Ok(());
        }
        let tape = f.grad_slice_tape(Default::default());
        self.seeds.clear();
        let seeds = points.iter().map(|&p| Grad::new(p, 1.0, 0.0, 0.0));
        self.seeds.extend(seeds);
        let vars: &[&[Grad]] = &[&self.seeds];
        let grads = self.grads.eval(&tape, vars).map_err(bug)?;
        out.extend_from_slice(&grads[0]);
        Ok(())
    }
}
