//! An expression in the form in which it is evaluated: whole, or simplified for
//! a tile.

use super::source::Source;
use fidget::compiler::RegOp;
use fidget::vm::VmFunction;
use std::sync::OnceLock;

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
