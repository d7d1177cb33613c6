//! Calls of data in an expression, evaluated before the expression that reads
//! them.
//!
//! ```text
//!   max(mesh(2x, y, z), wave(x))      A variable stands for each call in the
//!        ╲                            expression, as it does for parts of one
//!   max(  v,            wave(x))      coordinate. For points and boxes, what
//!         v = mesh(2x, y, z)          the arguments are is evaluated first,
//!                                     then the data, then the rest.
//! ```
//!
//! An argument may read calls that come before its own.

use super::boxes::Boxes;
use super::hoist::{in_order, rest};
use super::lanes::{Lanes, Seed, Slopes};
use super::repeat::Repeat;
use super::source::Source;
use super::{FieldError, bug};
use crate::data::{Data, call_of, range_over};
use crate::interval::Interval;
use fidget::context::{Context, Node, Tree};
use fidget::eval::{Function, MathFunction};
use fidget::var::Var;
use fidget::vm::VmFunction;
use glam::DVec3;
use std::collections::{HashMap, VecDeque};
use std::sync::Arc;

/// How many boxes back it is known over what data was asked: a row of a block has
/// four leaves, and those above it are often the same to a picture that is seen
/// along y.
const LAST_BOXES: usize = 4;

/// An expression in which variables stand for the calls of data.
pub(super) struct Called {
    pub context: Context,
    pub root: Node,
    pub calls: Vec<Call>,
    /// For each variable, where its value is from.
    pub sources: HashMap<Var, Source>,
}

/// A call of data.
#[derive(Clone)]
pub(super) struct Call {
    data: Arc<dyn Data>,
    at: [Argument; 3],
    /// For each coordinate, whether the call depends on it, perhaps by calls in
    /// its arguments.
    reads: [bool; 4],
}

/// A coordinate of the place at which data is asked.
#[derive(Clone)]
struct Argument {
    f: VmFunction,
    /// For each input of the function, where its value is from.
    sources: Vec<Source>,
}

impl Called {
    /// Takes the calls out of the expression `root`. A `fourth` variable counts
    /// as one more coordinate.
    ///
    /// # Errors
    /// If it has variables that stand for nothing, or fidget refuses it.
    pub(super) fn new(
        ctx: Context,
        root: Node,
        fourth: Option<Var>,
    ) -> Result<Called, FieldError> {
        let mut sources: HashMap<Var, Source> = [Var::X, Var::Y, Var::Z]
            .into_iter()
            .chain(fourth)
            .enumerate()
            .map(|(axis, v)| (v, Source::Coordinate(axis)))
            .collect();
        let mut taken = HashMap::new();
        let order = in_order(&ctx, root, &taken);
        let mut calls = Vec::new();
        for &node in &order {
            let Some(call) = call_of(&ctx, node) else {
                continue;
            };
            let argument = |node| -> Result<Argument, FieldError> {
                let order = in_order(&ctx, node, &taken);
                let rest = rest(&ctx, &order, &taken);
                let (f, sources) = function(&rest, &sources)?;
                Ok(Argument { f, sources })
            };
            let [x, y, z] = call.at;
            let at = [argument(x)?, argument(y)?, argument(z)?];
            let data = call.data;
            let var = Var::new();
            taken.insert(node, var);
            sources.insert(var, Source::Call(calls.len()));
            let read = at.iter().flat_map(|a| &a.sources);
            let reads = [0, 1, 2, 3]
                .map(|c| read.clone().any(|source| reads(&calls, *source, c)));
            calls.push(Call { data, at, reads });
        }
        let (context, root) = if calls.is_empty() {
            (ctx, root)
        } else {
            let mut context = Context::new();
            let order = in_order(&ctx, root, &taken);
            let root = context.import(&rest(&ctx, &order, &taken));
            (context, root)
        };
        let called = Called {
            context,
            root,
            calls,
            sources,
        };
        called.function()?;
        Ok(called)
    }

    /// The expression as a function, and for each of its inputs where its value
    /// is from.
    ///
    /// # Errors
    /// Those of [`Called::new`].
    pub(super) fn function(
        &self,
    ) -> Result<(VmFunction, Vec<Source>), FieldError> {
        function_of(&self.context, self.root, &self.sources)
    }
}

/// An expression as a function, and for each of its inputs where its value is
/// from, as `known` says of the variables.
pub(super) fn function(
    tree: &Tree,
    known: &HashMap<Var, Source>,
) -> Result<(VmFunction, Vec<Source>), FieldError> {
    let mut context = Context::new();
    let root = context.import(tree);
    function_of(&context, root, known)
}

/// Does what [`function`] does.
fn function_of(
    context: &Context,
    root: Node,
    known: &HashMap<Var, Source>,
) -> Result<(VmFunction, Vec<Source>), FieldError> {
    let f = VmFunction::new(context, &[root]).map_err(bug)?;
    let mut sources = vec![Source::Coordinate(0); f.vars().len()];
    for (var, slot) in f.vars().iter() {
        let source = known.get(&var).copied();
        let source =
            source.ok_or_else(|| bug("it has variables besides x, y and z"))?;
        if let Some(s) = sources.get_mut(slot) {
            *s = source;
        }
    }
    Ok((f, sources))
}

/// True if what is from a source depends on a coordinate.
pub(super) fn reads(calls: &[Call], source: Source, coordinate: usize) -> bool {
    match source {
        Source::Coordinate(a) | Source::Part(a, _) => a == coordinate,
        Source::Call(k) => calls[k].reads[coordinate],
    }
}

/// What calls are at points and over boxes, for one thread.
pub(super) struct Calls<'a> {
    all: &'a [Call],
    /// The calls that have to be evaluated.
    needed: Vec<bool>,
    lanes: Lanes,
    alone: Boxes,
    /// For each argument, its values at the points, and with slopes.
    numbers: [Vec<f32>; 3],
    duals: [Vec<[f32; 3]>; 3],
    /// For each call, what it is at each point or over each box.
    values: Vec<Vec<f32>>,
    slopes: Vec<[Vec<f32>; 2]>,
    ranges: Vec<Vec<Interval>>,
}

impl<'a> Calls<'a> {
    pub(super) fn new(all: &'a [Call]) -> Self {
        let n = all.len();
        Calls {
            all,
            needed: vec![false; n],
            lanes: Lanes::default(),
            alone: Boxes::default(),
            numbers: Default::default(),
            duals: Default::default(),
            values: vec![Vec::new(); n],
            slopes: vec![Default::default(); n],
            ranges: vec![Vec::new(); n],
        }
    }

    /// Marks the calls that a function with these sources reads. False if there
    /// are none.
    fn need(&mut self, read: impl Iterator<Item = Source>) -> bool {
        self.needed.fill(false);
        for source in read {
            if let Source::Call(k) = source {
                self.needed[k] = true;
            }
        }
        for k in (0..self.all.len()).rev() {
            if !self.needed[k] {
                continue;
            }
            let arguments = self.all[k].at.iter().flat_map(|a| &a.sources);
            for source in arguments {
                if let Source::Call(k) = *source {
                    self.needed[k] = true;
                }
            }
        }
        self.needed.contains(&true)
    }

    /// True if a call depends on z.
    pub(super) fn reads_z(&self, k: usize) -> bool {
        reads(self.all, Source::Call(k), 2)
    }

    /// About how many operations the calls that are read take at a point.
    pub(super) fn cost(&mut self, read: impl Iterator<Item = Source>) -> u64 {
        /// A look into a tree of boxes takes about as long as so many operations
        /// of an expression.
        const LOOK: u64 = 200;
        let of = |c: &Call| {
            let arguments = c.at.iter().map(|a| a.f.size() as u64);
            LOOK + arguments.sum::<u64>()
        };
        self.need(read);
        let all = self.all.iter().zip(&self.needed);
        all.filter(|(_, needed)| **needed).map(|(c, _)| of(c)).sum()
    }

    /// Evaluates the calls that are read at points.
    pub(super) fn at(
        &mut self,
        read: impl Iterator<Item = Source>,
        points: &[&[f32]],
    ) {
        if !self.need(read) {
            return;
        }
        for k in 0..self.all.len() {
            self.ask(k, points, None);
        }
    }

    /// Evaluates the calls that are read at all nodes of leaves.
    pub(super) fn at_nodes(
        &mut self,
        read: impl Iterator<Item = Source>,
        points: [&[f32]; 3],
    ) {
        if !self.need(read) {
            return;
        }
        for k in 0..self.all.len() {
            self.ask(k, &points, Repeat::of(self.all[k].reads));
        }
    }

    /// Evaluates a call at points if it is needed, those before it having been
    /// evaluated. With `repeat`, the points are the nodes of leaves.
    fn ask(&mut self, k: usize, points: &[&[f32]], repeat: Option<Repeat>) {
        if !self.needed[k] {
            return;
        }
        let (before, own) = self.values.split_at_mut(k);
        let call = &self.all[k];
        for (numbers, a) in self.numbers.iter_mut().zip(&call.at) {
            let all = a.sources.iter().map(|s| match *s {
                Source::Coordinate(a) | Source::Part(a, _) => points[a],
                Source::Call(k) => &before[k],
            });
            let gathered: Vec<Vec<f32>>;
            let inputs: Vec<&[f32]> = match &repeat {
                None => all.collect(),
                Some(repeat) => {
                    gathered = all.map(|v| repeat.gather(v)).collect();
                    gathered.iter().map(Vec::as_slice).collect()
                }
            };
            let count = match &repeat {
                None => points[0].len(),
                Some(repeat) => repeat.count(points[0].len()),
            };
            numbers.clear();
            self.lanes.eval(&a.f, &inputs, count, numbers);
        }
        let [x, y, z] = &self.numbers;
        own[0].clear();
        call.data.values([x, y, z], &mut own[0]);
        if let Some(repeat) = repeat {
            own[0] = repeat.spread(&own[0]);
        }
    }

    /// A call's values at the points.
    pub(super) fn values(&self, k: usize) -> &[f32] {
        &self.values[k]
    }

    /// Evaluates the calls that are read at points, with their derivatives
    /// along two axes. `along` has the numbers, 0 or 1, of the coordinates
    /// along which the derivatives are, and 2 for the other one.
    pub(super) fn at_with_slopes(
        &mut self,
        read: impl Iterator<Item = Source>,
        points: [&[f32]; 3],
        along: [usize; 3],
    ) {
        if !self.need(read) {
            return;
        }
        let count = points[0].len();
        for k in (0..self.all.len()).filter(|k| self.needed[*k]) {
            let (before, own) = self.values.split_at_mut(k);
            let (slopes_before, own_slopes) = self.slopes.split_at_mut(k);
            let call = &self.all[k];
            for (duals, a) in self.duals.iter_mut().zip(&call.at) {
                let seeds: Vec<Seed<'_>> = a
                    .sources
                    .iter()
                    .map(|s| match *s {
                        Source::Coordinate(a) | Source::Part(a, _) => Seed {
                            values: points[a],
                            slopes: Slopes::Coordinate(along[a]),
                        },
                        Source::Call(k) => Seed {
                            values: &before[k],
                            slopes: both(&slopes_before[k]),
                        },
                    })
                    .collect();
                duals.clear();
                self.lanes.slopes(&a.f, &seeds, count, duals);
            }
            let [du, dv] = &mut own_slopes[0];
            own[0].clear();
            du.clear();
            dv.clear();
            let [x, y, z] = &self.duals;
            for ((x, y), z) in x.iter().zip(y).zip(z) {
                let p = DVec3::new(x[0].into(), y[0].into(), z[0].into());
                let (v, g) = if p.is_finite() {
                    call.data.at(p)
                } else {
                    (f64::NAN, DVec3::ZERO)
                };
                let along = |d: usize| {
                    let moved = [x[d], y[d], z[d]].map(f64::from);
                    g.dot(DVec3::from_array(moved)) as f32
                };
                own[0].push(v as f32);
                du.push(along(1));
                dv.push(along(2));
            }
        }
    }

    /// A call's derivatives at the points.
    pub(super) fn slopes(&self, k: usize) -> Slopes<'_> {
        both(&self.slopes[k])
    }

    /// Evaluates the calls that are read over boxes.
    pub(super) fn over(
        &mut self,
        read: impl Iterator<Item = Source>,
        boxes: impl Iterator<Item = [Interval; 3]> + Clone,
    ) {
        if !self.need(read) {
            return;
        }
        for k in (0..self.all.len()).filter(|k| self.needed[*k]) {
            let (before, own) = self.ranges.split_at_mut(k);
            let call = &self.all[k];
            own[0].clear();
            let mut asked = VecDeque::with_capacity(LAST_BOXES);
            for (n, extent) in boxes.clone().enumerate() {
                let at = [0, 1, 2].map(|i| {
                    let a = &call.at[i];
                    let input = |slot: usize| match a.sources[slot] {
                        Source::Coordinate(a) | Source::Part(a, _) => extent[a],
                        Source::Call(k) => before[k][n],
                    };
                    self.alone.range(&a.f, &input).0
                });
                let range = match asked.iter().position(|past| *past == at) {
                    Some(back) => own[0][n - 1 - back],
                    None => range_over(&*call.data, at),
                };
                own[0].push(range);
                asked.truncate(LAST_BOXES - 1);
                asked.push_front(at);
            }
        }
    }

    /// A call's range over a box.
    pub(super) fn range(&self, k: usize, n: usize) -> Interval {
        self.ranges[k].get(n).copied().unwrap_or(Interval::ANYTHING)
    }
}

fn both([x, y]: &[Vec<f32>; 2]) -> Slopes<'_> {
    Slopes::Both([x, y])
}
