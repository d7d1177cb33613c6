//! Values of an expression at points anywhere, by fidget's interpreter.

use super::calls::{Call, Called, Calls, reads};
use super::source::Source;
use super::{FieldError, bug};
use fidget::context::{Context, Tree};
use fidget::eval::{BulkEvaluator, Function, TracingEvaluator};
use fidget::var::Var;
use fidget::vm::VmFunction;
use std::cell::RefCell;

type Eval = <VmFunction as Function>::FloatSliceEval;

/// An expression of x, y, z and perhaps one more variable, prepared for values
/// at points.
#[derive(Clone)]
pub struct Values {
    f: VmFunction,
    tape: <Eval as BulkEvaluator>::Tape,
    /// For each input of the function, where its value is from.
    sources: Vec<Source>,
    calls: Vec<Call>,
}

impl Values {
    /// Prepares an expression of x, y, z and perhaps a `fourth` variable.
    ///
    /// # Errors
    /// If it has other variables, or fidget refuses it.
    pub fn new(tree: &Tree, fourth: Option<Var>) -> Result<Values, FieldError> {
        let mut ctx = Context::new();
        let root = ctx.import(tree);
        let called = Called::new(ctx, root, fourth)?;
        let (f, sources) = called.function()?;
        Ok(Values {
            tape: f.float_slice_tape(Default::default()),
            f,
            sources,
            calls: called.calls,
        })
    }

    /// True if the values depend on x (0), y (1), z (2) or the fourth variable
    /// (3).
    pub fn depend_on(&self, variable: usize) -> bool {
        let mut sources = self.sources.iter();
        sources.any(|&source| reads(&self.calls, source, variable))
    }

    /// Writes the values at points to `out`. `inputs` has x, y, z and perhaps
    /// the fourth variable of each point.
    ///
    /// # Errors
    /// If fidget fails, which is a bug.
    pub fn at(
        &self,
        inputs: &[&[f32]],
        out: &mut Vec<f32>,
    ) -> Result<(), FieldError> {
        thread_local! {
            static EVAL: RefCell<Eval> =
                RefCell::new(VmFunction::new_float_slice_eval());
        }
        out.clear();
        let count = inputs.first().map_or(0, |x| x.len());
        if count == 0 {
            return Ok(());
        }
        if self.sources.is_empty() {
            out.resize(count, self.constant()?);
            return Ok(());
        }
        let mut calls = Calls::new(&self.calls);
        calls.at(self.sources.iter().copied(), inputs);
        let arguments: Vec<&[f32]> = self
            .sources
            .iter()
            .map(|s| match *s {
                Source::Coordinate(a) | Source::Part(a, _) => inputs[a],
                Source::Call(k) => calls.values(k),
            })
            .collect();
        EVAL.with_borrow_mut(|eval| {
            let values = eval.eval(&self.tape, &arguments).map_err(bug)?;
            out.extend_from_slice(&values[0]);
            Ok(())
        })
    }

    /// The value of an expression that depends on nothing.
    fn constant(&self) -> Result<f32, FieldError> {
        let none: [f32; 0] = [];
        let tape = self.f.point_tape(Default::default());
        let mut eval = VmFunction::new_point_eval();
        let (values, _) = eval.eval(&tape, &none[..]).map_err(bug)?;
        Ok(values[0])
    }
}
