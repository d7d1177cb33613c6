//! An expression in the form in which it is evaluated: whole, or simplified for
//! a tile.

use super::source::Source;
use super::{FieldError, bug};
use fidget::compiler::RegOp;
use fidget::eval::Function;
use fidget::vm::{VmFunction, VmTrace};
use std::sync::OnceLock;

/// Makes functions simpler, with memory of those that are no longer needed.
#[derive(Default)]
pub(super) struct Simplifier {
    workspace: <VmFunction as Function>::Workspace,
    storage: Vec<<VmFunction as Function>::Storage>,
}

impl Simplifier {
    /// The expression without the branches that a trace rules out.
    ///
    /// # Errors
    /// If fidget fails, which is a bug.
    pub(super) fn simpler(
        &mut self,
        expr: &Expr,
        trace: &VmTrace,
    ) -> Result<Expr, FieldError> {
        let storage = self.storage.pop().unwrap_or_default();
        let simpler = expr.f.simplify(trace, storage, &mut self.workspace);
        Ok(Expr::new(simpler.map_err(bug)?))
    }

    /// Takes back the memory of an expression, if there is one, that is not
    /// needed any more.
    pub(super) fn recycle(&mut self, expr: Option<Expr>) {
        self.storage.extend(expr.and_then(|expr| expr.f.recycle()));
    }
}

/// A function, and the inputs it reads.
pub(super) struct Expr {
    pub f: VmFunction,
    /// The inputs, once they have been asked for.
    inputs: OnceLock<Vec<usize>>,
}

impl Expr {
    pub(super) fn new(f: VmFunction) -> Self {
        Expr {
            f,
            inputs: OnceLock::new(),
        }
    }

    /// Where the inputs that the function reads are from, given where all are.
    pub(super) fn read<'s>(
        &'s self,
        sources: &'s [Source],
    ) -> impl Iterator<Item = Source> + 's {
        self.inputs().iter().map(|&slot| sources[slot])
    }

    /// The indices of the inputs that the function reads.
    pub(super) fn inputs(&self) -> &[usize] {
        self.inputs.get_or_init(|| {
            let operations = self.f.data().asm().iter();
            let mut used: Vec<usize> = operations
                .filter_map(|op| match op {
                    RegOp::Input(_, i) => Some(*i as usize),
                    _ => None,
                })
                .collect();
            used.sort_unstable();
            used.dedup();
            used
        })
    }
}
