//! Proofs about the field over boxes, for the stage that samples it.
//!
//! fidget's interval evaluators are fast, but panic (the compiled ones abort
//! the process) where one end of a range becomes NaN, as ∞ − ∞ or 0 · ∞ does.
//! Ranges over a part of a box lie within those over the whole, so an
//! expression whose operations all stay bounded over the model's box is safe
//! with them; for the others there is this prover, which is slower.

use super::program::{Cell, Program, Scratch};
use fidget::context::{Context, Tree};

/// What is known of a field in a box.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// A number everywhere, and negative everywhere or nowhere.
    Uniform,
    /// Nothing, but no operation comes near an overflow.
    Bounded,
    /// Nothing at all.
    Wild,
}

/// Evaluates an expression over boxes without ever failing.
#[derive(Clone)]
pub struct Prover {
    program: Program,
}

/// Memory of one thread's proofs.
#[derive(Default)]
pub struct ProverScratch(Scratch);

impl Prover {
    /// A prover for the expression; `None` if it has variables besides x, y
    /// and z.
    pub fn new(tree: &Tree) -> Option<Prover> {
        let mut context = Context::new();
        let root = context.import(tree);
        let program = Program::new(&context, root).ok()?;
        Some(Prover { program })
    }

    /// True if no operation comes near an overflow within the box.
    pub fn bounded(&self, lo: [f64; 3], hi: [f64; 3]) -> bool {
        let mut scratch = Scratch::default();
        self.program.enclose(&Cell { lo, hi }, &mut scratch);
        self.program.bounded(&scratch)
    }

    /// What can be said of the field in the box.
    pub fn prove(
        &self,
        lo: [f64; 3],
        hi: [f64; 3],
        scratch: &mut ProverScratch,
    ) -> Verdict {
        let found = self.program.enclose(&Cell { lo, hi }, &mut scratch.0);
        let range = found.range;
        if !range.nan && (range.lo >= 0.0 || range.hi < 0.0) {
            Verdict::Uniform
        } else if self.program.bounded(&scratch.0) {
            Verdict::Bounded
        } else {
            Verdict::Wild
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn overflow_is_seen_and_proofs_hold() {
        let (x, y, _) = Tree::axes();
        let tame = (x.square() + y.square()).sqrt() - 5.0;
        let prover = Prover::new(&tame).expect("x and y only");
        assert!(prover.bounded([-9.0; 3], [9.0; 3]));
        let mut scratch = ProverScratch::default();
        let mut ask = |lo, hi| prover.prove([lo; 3], [hi; 3], &mut scratch);
        assert_eq!(ask(-1.0, 1.0), Verdict::Uniform);
        assert_eq!(ask(3.0, 6.0), Verdict::Bounded);
        assert_eq!(ask(5.0, 6.0), Verdict::Uniform);
        let wild = (x.clone() * 1000.0).exp() - (y * 1000.0).exp();
        let prover = Prover::new(&wild).expect("x and y only");
        assert!(!prover.bounded([0.0; 3], [1.0; 3]));
        // A pole is not an overflow: fidget gives up on it, and no more.
        let pole = x.recip();
        let prover = Prover::new(&pole).expect("x only");
        assert!(prover.bounded([-1.0; 3], [1.0; 3]));
        assert!(!prover.bounded([1e-35; 3], [2.0; 3]));
    }
}
