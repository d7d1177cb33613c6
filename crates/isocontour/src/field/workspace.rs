//! Evaluators and buffers: what a thread needs to prove and to sample.

use super::axis::{self, Level, Located};
use super::boxes::Boxes;
use super::calls::Calls;
use super::expr::{Expr, Simplifier};
use super::lanes::{Lanes, Seed, Slopes};
use super::source::Source;
use super::split::{Axes, Split};
use super::{FieldError, Leaf, NODES};
use crate::interval::Interval;
use fidget::vm::VmFunction;

/// Number of leaves evaluated at once. Their memory fits a core's cache.
const AT_ONCE: usize = 12;

/// What interval arithmetic says of a box.
pub(super) enum Proof {
    /// The box has no sign change.
    Uniform,
    /// The box may have a sign change. The expression is for use inside the
    /// box, if a simpler one exists.
    Ambiguous(Option<Expr>),
}

/// Evaluators and buffers of one thread.
pub(super) struct Workspace<'a> {
    parts: &'a [Vec<VmFunction>; 3],
    /// The source of each input of the tapes. Simplified tapes keep the order.
    sources: &'a [Source],
    calls: Calls<'a>,
    alone: Boxes,
    /// What is known of each box.
    found: Vec<Option<Interval>>,
    lanes: Lanes,
    simplifier: Simplifier,
    axis: axis::Scratch,
    /// For each input, its value at each point.
    values: Vec<Vec<f32>>,
    /// For each input, its slope at each point.
    slopes: Vec<Vec<f32>>,
    /// For each axis, the nodes on which the points are.
    located: [Located; 3],
}

impl<'a> Workspace<'a> {
    pub(super) fn new(split: &'a Split) -> Self {
        let sources = &split.sources;
        let slots = sources.len().max(1);
        Workspace {
            parts: &split.parts,
            sources,
            calls: Calls::new(&split.calls),
            alone: Boxes::default(),
            found: Vec::new(),
            lanes: Lanes::default(),
            simplifier: Simplifier::default(),
            axis: axis::Scratch::default(),
            values: vec![Vec::new(); slots],
            slopes: vec![Vec::new(); slots],
            located: Default::default(),
        }
    }

    /// Evaluates the calls that an expression reads over boxes.
    fn call_over(
        &mut self,
        expr: &Expr,
        axes: Axes<'_>,
        level: Level,
        boxes: &[[usize; 3]],
    ) {
        let read = expr.read(self.sources);
        let extents = boxes.iter().map(|&at| axes.extent(level, at));
        self.calls.over(read, extents);
    }

    /// Keeps the boxes in which the field may change its sign. A box is given
    /// by its numbers along the axes on a `level`.
    pub(super) fn sift(
        &mut self,
        expr: &Expr,
        axes: Axes<'_>,
        level: Level,
        boxes: &mut Vec<[usize; 3]>,
    ) -> Result<(), FieldError> {
        let mut found = std::mem::take(&mut self.found);
        found.clear();
        self.call_over(expr, axes, level, boxes);
        let (sources, calls) = (self.sources, &self.calls);
        let input = |slot: usize, k: usize| match sources.get(slot) {
            Some(&Source::Call(c)) => calls.range(c, k),
            source => axes.over(source, level, boxes[k]),
        };
        self.lanes.ranges(&expr.f, boxes.len(), &input, &mut found);
        let mut kept = 0;
        for (k, range) in found.iter().enumerate() {
            let at = boxes[k];
            let uniform = match range {
                Some(range) => range.lo >= 0.0 || range.hi < 0.0,
                None => {
                    let proof = self.prove(expr, axes, level, at, false)?;
                    matches!(proof, Proof::Uniform)
                }
            };
            if !uniform {
                boxes[kept] = at;
                kept += 1;
            }
        }
        boxes.truncate(kept);
        self.found = found;
        Ok(())
    }

    /// Evaluates over box number `at` of a level, and simplifies for it if that
    /// is wanted.
    pub(super) fn prove(
        &mut self,
        expr: &Expr,
        axes: Axes<'_>,
        level: Level,
        at: [usize; 3],
        simplify: bool,
    ) -> Result<Proof, FieldError> {
        self.call_over(expr, axes, level, &[at]);
        let (sources, calls) = (self.sources, &self.calls);
        let input = |slot: usize| match sources.get(slot) {
            Some(&Source::Call(c)) => calls.range(c, 0),
            source => axes.over(source, level, at),
        };
        let (range, trace) = if simplify {
            self.alone.range_of_sign(&expr.f, &input)
        } else {
            self.alone.range(&expr.f, &input)
        };
        // A field that is nowhere below zero has no inside, even where it
        // touches zero.
        if !range.nan && (range.lo >= 0.0 || range.hi < 0.0) {
            return Ok(Proof::Uniform);
        }
        let trace = trace.filter(|_| simplify);
        let simpler = trace.map(|trace| self.simplifier.simpler(expr, trace));
        Ok(Proof::Ambiguous(simpler.transpose()?))
    }

    /// True if an expression does not read z.
    pub(super) fn is_level(&self, expr: &Expr) -> bool {
        let reads_z = |&slot: &usize| match self.sources[slot] {
            Source::Coordinate(axis) | Source::Part(axis, _) => axis == 2,
            Source::Call(call) => self.calls.reads_z(call),
        };
        !expr.inputs().iter().any(reads_z)
    }

    /// Writes the field at the nodes of leaves to `out`.
    pub(super) fn leaves(
        &mut self,
        expr: &Expr,
        axes: Axes<'_>,
        leaves: &[Leaf],
        out: &mut Vec<f32>,
    ) {
        out.clear();
        let used = expr.inputs();
        let read = || expr.read(self.sources);
        let has_calls = read().any(|s| matches!(s, Source::Call(_)));
        let mut points: [Vec<f32>; 3] = Default::default();
        for leaves in leaves.chunks(AT_ONCE) {
            let count = leaves.len() * NODES * NODES;
            if has_calls {
                for (a, values) in points.iter_mut().enumerate() {
                    spread(axes.along(Source::Coordinate(a)), leaves, values);
                }
                let [x, y, z] = &points;
                self.calls.at_nodes(read(), [x, y, z]);
            }
            for &slot in used {
                let values = &mut self.values[slot];
                match self.sources[slot] {
                    Source::Call(c) => {
                        values.clear();
                        values.extend_from_slice(self.calls.values(c));
                    }
                    source => spread(axes.along(source), leaves, values),
                }
            }
            // Inputs that are not read may have any values, as long as there
            // are enough.
            let any = used.first().copied().unwrap_or(0);
            if used.is_empty() {
                self.values[0].resize(count, 0.0);
            }
            let mut vars: Vec<&[f32]> =
                vec![&self.values[any][..count]; self.values.len()];
            for &slot in used {
                vars[slot] = &self.values[slot];
            }
            self.lanes.eval(&expr.f, &vars, count, out);
        }
    }

    /// Finds the nodes on which the points are, for the axes that have parts.
    fn locate(&mut self, used: &[usize], axes: Axes<'_>, points: [&[f32]; 3]) {
        let found = self.located.iter_mut().zip(points).enumerate();
        for (a, (located, points)) in found {
            let of_axis = |s: &usize| matches!(self.sources[*s], Source::Part(b, _) if a == b);
            if used.iter().any(of_axis) {
                axes.0[a].locate(points, located);
            }
        }
    }

    /// Writes the field at any points to `out`.
    pub(super) fn values(
        &mut self,
        expr: &Expr,
        axes: Axes<'_>,
        points: [&[f32]; 3],
        out: &mut Vec<f32>,
    ) {
        let used = expr.inputs();
        self.locate(used, axes, points);
        let read = expr.read(self.sources);
        self.calls.at(read, &points);
        for &slot in used {
            if let Source::Part(a, p) = self.sources[slot] {
                axes.0[a].values_at(
                    p,
                    &self.parts[a][p],
                    &self.located[a],
                    &mut self.axis,
                    &mut self.values[slot],
                );
            }
        }
        let mut vars: Vec<&[f32]> = vec![points[0]; self.values.len()];
        for &slot in used {
            vars[slot] = match self.sources[slot] {
                Source::Coordinate(a) => points[a],
                Source::Part(..) => &self.values[slot],
                Source::Call(c) => self.calls.values(c),
            };
        }
        out.clear();
        let count = points[0].len();
        self.lanes.eval(&expr.f, &vars, count, out);
    }

    /// Writes value and in-plane slopes at any points to `out`.
    pub(super) fn slopes(
        &mut self,
        expr: &Expr,
        axes: Axes<'_>,
        points: [&[f32]; 3],
        out: &mut Vec<[f32; 3]>,
    ) {
        let used = expr.inputs();
        self.locate(used, axes, points);
        let read = expr.read(self.sources);
        self.calls.at_with_slopes(read, points, [0, 1, 2]);
        for &slot in used {
            if let Source::Part(a, p) = self.sources[slot] {
                axes.0[a].slopes_at(
                    p,
                    &self.parts[a][p],
                    &self.located[a],
                    &mut self.axis,
                    &mut self.values[slot],
                    &mut self.slopes[slot],
                );
            }
        }
        let seed = |values, slopes| Seed { values, slopes };
        // Inputs that are not read may have any values.
        let any = seed(points[0], Slopes::Coordinate(0));
        let mut seeds = vec![any; self.values.len()];
        for &slot in used {
            seeds[slot] = match self.sources[slot] {
                Source::Coordinate(a) => seed(points[a], Slopes::Coordinate(a)),
                Source::Part(a, _) => {
                    let slopes = Slopes::Along(a, &self.slopes[slot]);
                    seed(&self.values[slot], slopes)
                }
                Source::Call(c) => {
                    seed(self.calls.values(c), self.calls.slopes(c))
                }
            };
        }
        out.clear();
        let lanes = &mut self.lanes;
        lanes.slopes(&expr.f, &seeds, points[0].len(), out);
    }

    /// Takes back the memory of a simpler expression.
    pub(super) fn recycle(&mut self, expr: Option<Expr>) {
        self.simplifier.recycle(expr);
    }
}

/// What a source has at the nodes of leaves, from its values along an axis.
fn spread(
    (axis, nodes): (usize, &[f32]),
    leaves: &[Leaf],
    values: &mut Vec<f32>,
) {
    values.clear();
    for leaf in leaves {
        match axis {
            0 => {
                let row = &nodes[leaf.i..leaf.i + NODES];
                for _ in 0..NODES {
                    values.extend_from_slice(row);
                }
            }
            1 => {
                for &y in &nodes[leaf.j..leaf.j + NODES] {
                    values.extend([y; NODES]);
                }
            }
            _ => values.extend([nodes[leaf.layer]; NODES * NODES]),
        }
    }
}
