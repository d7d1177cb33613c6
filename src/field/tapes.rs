//! A function and its tapes, compiled or interpreted, whichever suits it.

use super::lanes::Lanes;
use super::ranges::Readable;
use super::tape::calls;
use super::{FieldError, bug};
use fidget::eval::{BulkEvaluator, Function, MathFunction};
use fidget::jit::JitFunction;
use fidget::vm::{VmFunction, VmTrace};

/// What fidget must offer of a back end.
pub(super) trait Evaluable:
    MathFunction<Trace = VmTrace> + Readable + Send + Sync
{
    /// Whether fidget compiles it; else [`Lanes`] interprets it.
    const COMPILED: bool;
}

impl Evaluable for VmFunction {
    const COMPILED: bool = false;
}

impl Evaluable for JitFunction {
    const COMPILED: bool = true;
}

pub(super) type FloatTape<F> =
    <<F as Function>::FloatSliceEval as BulkEvaluator>::Tape;

/// A function and those of its tapes that were asked for.
pub(super) struct Tapes<F: Function> {
    pub f: F,
    /// Compiled, once that was asked for.
    pub float: Option<FloatTape<F>>,
    /// Whether it calls functions, once known.
    calls: Option<bool>,
    /// The inputs it reads, once known.
    pub inputs: Option<Vec<usize>>,
}

impl<F: Function> Tapes<F> {
    pub(super) fn new(f: F) -> Self {
        Tapes {
            f,
            float: None,
            calls: None,
            inputs: None,
        }
    }
}

impl<F: Evaluable> Tapes<F> {
    /// Whether to run native code. Not where it would call functions: those
    /// of the system may round otherwise than ours, and it is slow there.
    pub(super) fn is_native(&mut self) -> bool {
        let calls = || calls(self.f.operations());
        F::COMPILED && !*self.calls.get_or_insert_with(calls)
    }
}

/// Evaluates batches of points, one way or the other.
pub(super) struct Runner<F: Function> {
    float: F::FloatSliceEval,
    pub lanes: Lanes,
}

impl<F: Evaluable> Runner<F> {
    pub(super) fn new() -> Self {
        Runner {
            float: F::new_float_slice_eval(),
            lanes: Lanes::default(),
        }
    }

    /// Appends a function's values at `count` points to `out`; if it has to
    /// be compiled to `tape`, for its `native` code, `spare` is memory for it.
    pub(super) fn run(
        &mut self,
        (f, tape): (&F, &mut Option<FloatTape<F>>),
        native: bool,
        vars: &[&[f32]],
        count: usize,
        spare: &mut Vec<F::TapeStorage>,
        out: &mut Vec<f32>,
    ) -> Result<(), FieldError> {
        if !native {
            self.lanes.eval(f, vars, count, out);
            return Ok(());
        }
        let tape = tape.get_or_insert_with(|| {
            f.float_slice_tape(spare.pop().unwrap_or_default())
        });
        let values = self.float.eval(tape, vars).map_err(bug)?;
        out.extend_from_slice(&values[0]);
        Ok(())
    }
}
