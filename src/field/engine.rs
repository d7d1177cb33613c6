//! The walk over tiles, for either of fidget's evaluators.

use super::{
    Batch, FieldError, LEAF, Lattice, Leaf, NODES, SLAB, Sampler, Visit,
};
use crate::model::{Prover, ProverScratch, Verdict};
use crate::units::{Mm, Seconds};
use fidget::eval::{BulkEvaluator, Function, MathFunction, TracingEvaluator};
use fidget::types::{Grad, Interval};
use fidget::var::Var;
use std::time::Instant;

/// Cells along the side of a slab's tiles; they span all layers of the slab.
const TILE: usize = 64;
/// Cells along the side of a tile's blocks.
const BLOCK: usize = 16;
/// Layers of a block.
const BLOCK_LAYERS: usize = 8;

/// An expression bound to one of fidget's evaluators.
pub(super) trait Engine: Send + Sync {
    fn slab(
        &self,
        lattice: &Lattice,
        z: &[f32],
        visit: &mut Visit<'_>,
    ) -> Result<(), FieldError>;

    fn leaves(
        &self,
        lattice: &Lattice,
        z: &[f32],
        leaves: &[Leaf],
        visit: &mut Visit<'_>,
    ) -> Result<(), FieldError>;
}

type IntervalTape<F> =
    <<F as Function>::IntervalEval as TracingEvaluator>::Tape;
type FloatTape<F> = <<F as Function>::FloatSliceEval as BulkEvaluator>::Tape;
type GradTape<F> = <<F as Function>::GradSliceEval as BulkEvaluator>::Tape;

pub(super) struct FidgetEngine<F: Function> {
    root: F,
    /// Where x, y and z stand among the tapes' variables. Simplified tapes
    /// keep the order.
    slots: [Option<usize>; 3],
    /// The root's tapes; clones share them.
    interval: IntervalTape<F>,
    float: FloatTape<F>,
    grad: GradTape<F>,
    /// Used for proofs instead of fidget's intervals, where those could
    /// panic.
    prover: Option<Prover>,
}

/// A function and those of its tapes that were asked for.
struct Tapes<F: Function> {
    f: F,
    interval: Option<IntervalTape<F>>,
    float: Option<FloatTape<F>>,
    grad: Option<GradTape<F>>,
    /// fidget's intervals may be used: nothing overflows where these tapes
    /// are used.
    safe: bool,
}

/// Evaluators and buffers of one thread.
struct Workspace<F: Function> {
    slots: [Option<usize>; 3],
    interval: F::IntervalEval,
    float: F::FloatSliceEval,
    grad: F::GradSliceEval,
    simplify: F::Workspace,
    prover: Option<(Prover, ProverScratch)>,
    /// Memory of functions and tapes that are done with: mapping executable
    /// memory anew for each tile would cost more than using it.
    functions: Vec<F::Storage>,
    tapes: Vec<F::TapeStorage>,
    grads: [Vec<Grad>; 3],
}

/// What interval arithmetic says of a tile.
enum Proof<F: Function> {
    /// No sign change in it.
    Uniform,
    /// May have one; the expression for use inside, if a simpler one exists.
    Ambiguous(Option<F>),
}

impl<F: MathFunction> FidgetEngine<F> {
    pub(super) fn new(root: F, prover: Option<Prover>) -> Self {
        let vars = root.vars();
        let slots = [Var::X, Var::Y, Var::Z].map(|v| vars.get(&v));
        Self {
            slots,
            interval: root.interval_tape(Default::default()),
            float: root.float_slice_tape(Default::default()),
            grad: root.grad_slice_tape(Default::default()),
            root,
            prover,
        }
    }

    fn workspace(&self) -> Workspace<F> {
        Workspace {
            slots: self.slots,
            interval: F::new_interval_eval(),
            float: F::new_float_slice_eval(),
            grad: F::new_grad_slice_eval(),
            simplify: Default::default(),
            prover: self.prover.clone().map(|p| (p, ProverScratch::default())),
            functions: Vec::new(),
            tapes: Vec::new(),
            grads: Default::default(),
        }
    }

    fn root_tapes(&self) -> Tapes<F> {
        Tapes {
            f: self.root.clone(),
            interval: Some(self.interval.clone()),
            float: Some(self.float.clone()),
            grad: Some(self.grad.clone()),
            safe: self.prover.is_none(),
        }
    }

    /// Time for a thousand samples across the lattice: the best of a few
    /// tries.
    pub(super) fn trial(
        &self,
        lattice: &Lattice,
        z: Mm,
    ) -> Result<Seconds, FieldError> {
        const SAMPLES: usize = 1024;
        let pick = |axis: &[f32], k: usize| axis[k * 7919 % axis.len()];
        let x: Vec<f32> = (0..SAMPLES).map(|k| pick(&lattice.x, k)).collect();
        let y: Vec<f32> =
            (0..SAMPLES).map(|k| pick(&lattice.y, 3 * k)).collect();
        let z = vec![z as f32; SAMPLES];
        let mut ws = self.workspace();
        let mut tapes = self.root_tapes();
        let mut out = Vec::new();
        let mut best = f64::INFINITY;
        for _ in 0..3 {
            let start = Instant::now();
            ws.values(&mut tapes, &x, &y, &z, &mut out)?;
            best = best.min(start.elapsed().as_secs_f64());
        }
        Ok(best)
    }
}

impl<F: Function> Tapes<F> {
    /// Tapes for a box in which nothing overflows.
    fn safe(f: F) -> Self {
        Tapes {
            f,
            interval: None,
            float: None,
            grad: None,
            safe: true,
        }
    }
}

impl<F: Function> Workspace<F> {
    /// Evaluates over a box and simplifies for it.
    fn prove(
        &mut self,
        tapes: &mut Tapes<F>,
        boxed: [[f32; 2]; 3],
        simplify: bool,
    ) -> Result<Proof<F>, FieldError> {
        let mut newly_safe = false;
        if let (false, Some((prover, scratch))) = (tapes.safe, &mut self.prover)
        {
            let lo = boxed.map(|[lo, _]| f64::from(lo));
            let hi = boxed.map(|[_, hi]| f64::from(hi));
            match prover.prove(lo, hi, scratch) {
                Verdict::Uniform => return Ok(Proof::Uniform),
                Verdict::Wild => return Ok(Proof::Ambiguous(None)),
                Verdict::Bounded => newly_safe = true,
            }
        }
        let mut vars = [Interval::from(0.0); 3];
        for (slot, [lo, hi]) in self.slots.iter().zip(boxed) {
            if let Some(s) = slot {
                vars[*s] = Interval::new(lo, hi);
            }
        }
        let tape = match &tapes.interval {
            Some(t) => t,
            None => {
                let storage = self.tapes.pop().unwrap_or_default();
                tapes.interval.insert(tapes.f.interval_tape(storage))
            }
        };
        let (out, trace) = self.interval.eval(tape, &vars).map_err(bug)?;
        let range = out[0];
        // Comparisons are false for NaN: it stays ambiguous. A field that is
        // nowhere below zero has no inside, even where it touches zero.
        if range.lower() >= 0.0 || range.upper() < 0.0 {
            return Ok(Proof::Uniform);
        }
        let simpler = match trace {
            Some(trace) if simplify => {
                let storage = self.functions.pop().unwrap_or_default();
                let f = tapes
                    .f
                    .simplify(trace, storage, &mut self.simplify)
                    .map_err(bug)?;
                Some(f)
            }
            // The same function, but from here on with fidget's intervals.
            None if simplify && newly_safe => Some(tapes.f.clone()),
            _ => None,
        };
        Ok(Proof::Ambiguous(simpler))
    }

    fn values(
        &mut self,
        tapes: &mut Tapes<F>,
        x: &[f32],
        y: &[f32],
        z: &[f32],
        out: &mut Vec<f32>,
    ) -> Result<(), FieldError> {
        let tape = match &tapes.float {
            Some(t) => t,
            None => {
                let storage = self.tapes.pop().unwrap_or_default();
                tapes.float.insert(tapes.f.float_slice_tape(storage))
            }
        };
        let mut vars = [x; 3];
        for (slot, axis) in self.slots.iter().zip([x, y, z]) {
            if let Some(s) = slot {
                vars[*s] = axis;
            }
        }
        let values = self.float.eval(tape, &vars).map_err(bug)?;
        out.clear();
        out.extend_from_slice(&values[0]);
        Ok(())
    }

    fn gradients(
        &mut self,
        tapes: &mut Tapes<F>,
        x: &[f32],
        y: &[f32],
        z: &[f32],
        out: &mut Vec<[f32; 2]>,
    ) -> Result<(), FieldError> {
        let tape = match &tapes.grad {
            Some(t) => t,
            None => {
                let storage = self.tapes.pop().unwrap_or_default();
                tapes.grad.insert(tapes.f.grad_slice_tape(storage))
            }
        };
        let [gx, gy, gz] = &mut self.grads;
        gx.clear();
        gx.extend(x.iter().map(|&v| Grad::new(v, 1.0, 0.0, 0.0)));
        gy.clear();
        gy.extend(y.iter().map(|&v| Grad::new(v, 0.0, 1.0, 0.0)));
        gz.clear();
        gz.extend(z.iter().map(|&v| Grad::new(v, 0.0, 0.0, 1.0)));
        let mut vars: [&[Grad]; 3] = [gx; 3];
        for (slot, axis) in self.slots.iter().zip([&*gx, &*gy, &*gz]) {
            if let Some(s) = slot {
                vars[*s] = axis;
            }
        }
        let grads = self.grad.eval(tape, &vars).map_err(bug)?;
        out.clear();
        out.extend(grads[0].iter().map(|g| [g.dx, g.dy]));
        Ok(())
    }

    /// Takes back the memory of tapes that are done with.
    fn recycle(&mut self, tapes: Tapes<F>) {
        use fidget::eval::Tape;
        self.tapes.extend(tapes.interval.and_then(Tape::recycle));
        self.tapes.extend(tapes.float.and_then(Tape::recycle));
        self.tapes.extend(tapes.grad.and_then(Tape::recycle));
        self.functions.extend(tapes.f.recycle());
    }
}

fn bug(e: impl std::fmt::Display) -> FieldError {
    FieldError::Evaluator(e.to_string())
}

/// A batch's tapes with the thread's workspace.
struct TapeSampler<'a, F: Function> {
    tapes: &'a mut Tapes<F>,
    ws: &'a mut Workspace<F>,
}

impl<F: Function> Sampler for TapeSampler<'_, F> {
    fn values(
        &mut self,
        x: &[f32],
        y: &[f32],
        z: &[f32],
        out: &mut Vec<f32>,
    ) -> Result<(), FieldError> {
        self.ws.values(self.tapes, x, y, z, out)
    }

    fn gradients(
        &mut self,
        x: &[f32],
        y: &[f32],
        z: &[f32],
        out: &mut Vec<[f32; 2]>,
    ) -> Result<(), FieldError> {
        self.ws.gradients(self.tapes, x, y, z, out)
    }
}

/// Buffers of a walk.
#[derive(Default)]
struct Buffers {
    leaves: Vec<Leaf>,
    x: Vec<f32>,
    y: Vec<f32>,
    z: Vec<f32>,
    values: Vec<f32>,
}

/// A cuboid of the lattice: cells from (i, j), `cells` along each side, and
/// layers from `k`, `layers` of them.
#[derive(Clone, Copy)]
struct Cuboid {
    i: usize,
    j: usize,
    cells: usize,
    k: usize,
    layers: usize,
}

impl Cuboid {
    /// Its extent in space, with `pad` cells added on each side in the plane.
    fn extent(
        &self,
        lattice: &Lattice,
        z: &[f32],
        pad: usize,
    ) -> [[f32; 2]; 3] {
        let span = |axis: &[f32], from: usize| {
            let last = axis.len() - 1;
            [
                axis[from.saturating_sub(pad)],
                axis[(from + self.cells + pad).min(last)],
            ]
        };
        [
            span(&lattice.x, self.i),
            span(&lattice.y, self.j),
            [z[self.k], z[self.k + self.layers - 1]],
        ]
    }

    /// Its parts of `cells` cells and `layers` layers.
    fn parts(
        self,
        lattice: &Lattice,
        cells: usize,
        layers: usize,
    ) -> impl Iterator<Item = Cuboid> {
        let (i1, j1) = (
            (self.i + self.cells).min(lattice.width()),
            (self.j + self.cells).min(lattice.height()),
        );
        let k1 = self.k + self.layers;
        let steps =
            move |from: usize, to: usize, by: usize| (from..to).step_by(by);
        steps(self.k, k1, layers).flat_map(move |k| {
            steps(self.j, j1, cells).flat_map(move |j| {
                steps(self.i, i1, cells).map(move |i| Cuboid {
                    i,
                    j,
                    cells,
                    k,
                    layers: layers.min(k1 - k),
                })
            })
        })
    }
}

impl<F: MathFunction> FidgetEngine<F> {
    /// A tile of the slab: simplify for it, then look at its blocks.
    fn tile(
        &self,
        lattice: &Lattice,
        z: &[f32],
        tile: Cuboid,
        ws: &mut Workspace<F>,
        buffers: &mut Buffers,
        visit: &mut Visit<'_>,
    ) -> Result<(), FieldError> {
        let mut root = self.root_tapes();
        // The cell around a tile belongs to the proof, so that its simpler
        // expression may be used for a corner just outside.
        let extent = tile.extent(lattice, z, 1);
        let mut own = match ws.prove(&mut root, extent, true)? {
            Proof::Uniform => return Ok(()),
            Proof::Ambiguous(simpler) => simpler.map(Tapes::safe),
        };
        let tapes = own.as_mut().unwrap_or(&mut root);
        for block in tile.parts(lattice, BLOCK, BLOCK_LAYERS) {
            self.block(lattice, z, block, tapes, ws, buffers, visit)?;
        }
        if let Some(tapes) = own {
            ws.recycle(tapes);
        }
        Ok(())
    }

    #[allow(clippy::too_many_arguments)] // the walk's state, handed down
    fn block(
        &self,
        lattice: &Lattice,
        z: &[f32],
        block: Cuboid,
        parent: &mut Tapes<F>,
        ws: &mut Workspace<F>,
        buffers: &mut Buffers,
        visit: &mut Visit<'_>,
    ) -> Result<(), FieldError> {
        let extent = block.extent(lattice, z, 1);
        let mut own = match ws.prove(parent, extent, true)? {
            Proof::Uniform => return Ok(()),
            Proof::Ambiguous(simpler) => simpler.map(Tapes::safe),
        };
        let tapes = own.as_mut().unwrap_or(parent);
        buffers.leaves.clear();
        for part in block.parts(lattice, LEAF, 1) {
            let extent = part.extent(lattice, z, 0);
            // Where fidget's intervals are not safe a proof costs more than
            // the samples it might save.
            let sampled = !tapes.safe
                || matches!(
                    ws.prove(tapes, extent, false)?,
                    Proof::Ambiguous(_)
                );
            if sampled {
                buffers.leaves.push(Leaf {
                    layer: part.k,
                    i: part.i,
                    j: part.j,
                });
            }
        }
        sample(lattice, z, tapes, ws, buffers, visit)?;
        if let Some(tapes) = own {
            ws.recycle(tapes);
        }
        Ok(())
    }
}

/// Evaluates the nodes of all leaves in the buffer at once and shows them.
fn sample<F: Function>(
    lattice: &Lattice,
    z: &[f32],
    tapes: &mut Tapes<F>,
    ws: &mut Workspace<F>,
    buffers: &mut Buffers,
    visit: &mut Visit<'_>,
) -> Result<(), FieldError> {
    if buffers.leaves.is_empty() {
        return Ok(());
    }
    buffers.x.clear();
    buffers.y.clear();
    buffers.z.clear();
    for leaf in &buffers.leaves {
        for &y in &lattice.y[leaf.j..leaf.j + NODES] {
            buffers
                .x
                .extend_from_slice(&lattice.x[leaf.i..leaf.i + NODES]);
            buffers.y.extend([y; NODES]);
        }
        buffers.z.extend([z[leaf.layer]; NODES * NODES]);
    }
    ws.values(
        tapes,
        &buffers.x,
        &buffers.y,
        &buffers.z,
        &mut buffers.values,
    )?;
    visit(Batch {
        leaves: &buffers.leaves,
        values: &buffers.values,
        sampler: &mut TapeSampler { tapes, ws },
    })
}

impl<F: MathFunction> Engine for FidgetEngine<F> {
    fn slab(
        &self,
        lattice: &Lattice,
        z: &[f32],
        visit: &mut Visit<'_>,
    ) -> Result<(), FieldError> {
        if z.is_empty() {
            return Ok(());
        }
        let mut ws = self.workspace();
        let mut buffers = Buffers::default();
        let all = Cuboid {
            i: 0,
            j: 0,
            cells: lattice.width().max(lattice.height()),
            k: 0,
            layers: z.len().min(SLAB),
        };
        for tile in all.parts(lattice, TILE, all.layers) {
            self.tile(lattice, z, tile, &mut ws, &mut buffers, visit)?;
        }
        Ok(())
    }

    fn leaves(
        &self,
        lattice: &Lattice,
        z: &[f32],
        leaves: &[Leaf],
        visit: &mut Visit<'_>,
    ) -> Result<(), FieldError> {
        let mut buffers = Buffers {
            leaves: leaves.to_vec(),
            ..Buffers::default()
        };
        let mut tapes = self.root_tapes();
        let mut ws = self.workspace();
        sample(lattice, z, &mut tapes, &mut ws, &mut buffers, visit)
    }
}
