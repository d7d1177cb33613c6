//! Gives smooth unions branches, so that proofs can rule parts of them out.
//!
//! −ln(eᵘ + eᵛ) blends two parts where they meet, and equals one of them nearly
//! everywhere else: there one exponential is less than the last bit of the
//! other. But a sum has no branch that interval arithmetic could rule out, so
//! all parts of such a model would be computed everywhere.
//!
//! ```text
//!    eᵘ ──────╲      ╱────── eᵛ     Each summand b is replaced by one that is
//!              ╲    ╱               cut off where it is too small to count:
//!   ────────────╲──╱──────────      max(0, min(b, t·∞)), with t = v − u + 20.
//!         t < 0  ╲╱  t > 0
//! ```
//!
//! In: an expression. Out: an expression with the same values, bit for bit, in
//! which `min` and `max` choose. The values are also equal where exponentials
//! overflow, since a shell or an offset made of the sum compares it with other
//! numbers.

use super::hoist::{Term, in_order, rebuilt};
use fidget::context::{BinaryOpcode, Context, Node, Op, TreeOp, UnaryOpcode};
use std::collections::HashMap;
use std::sync::Arc;

/// Difference of two exponents from which on the lesser power does not count:
/// e⁻²⁰ is less than an eighth of the last bit of an `f32`.
const APART: f32 = 20.0;
/// This number's square is infinite, and so is its product with the least lead
/// that occurs: e⁻²⁰ is compared at steps of 2·10⁻⁶. Infinity itself would turn
/// a lead of 0 into NaN.
const MUCH: f32 = 1.5e38;
/// Stands for an infinite exponent, since two such numbers can be compared.
const FARTHEST: f32 = 1e30;

/// The expression `root` with branches in sums of two exponentials.
pub(super) fn branched(ctx: &mut Context, root: Node) -> Node {
    let exponent = |n: &Node| match ctx.get_op(*n) {
        Some(Op::Unary(UnaryOpcode::Exp, u)) => Some(*u),
        _ => None,
    };
    let order = in_order(ctx, root, &HashMap::new());
    let mut any = false;
    let tree = rebuilt(ctx, &order, |node, of| match ctx.get_op(node) {
        Some(Op::Binary(BinaryOpcode::Add, a, b)) => {
            let exponents = [&exponent(a)?, &exponent(b)?];
            any = true;
            Some(blend([a, b].map(of), exponents.map(of)))
        }
        _ => None,
    });
    if any { ctx.import(&tree) } else { root }
}

/// The sum of two exponentials, each cut off where it is too small to count.
fn blend([a, b]: [Term; 2], exponents: [Term; 2]) -> TreeOp {
    use BinaryOpcode::{Add, Max, Min, Mul, Sub};
    let [u, v] = exponents.map(|u| {
        let low = binary(Max, u, number(-FARTHEST));
        binary(Min, low, number(FARTHEST))
    });
    let kept = |summand: Term, own: &Term, other: &Term| {
        let lead = binary(Sub, own.clone(), other.clone());
        let lead = binary(Add, lead, number(APART));
        let bound = binary(Mul, lead, number(MUCH));
        let bound = binary(Mul, bound, number(MUCH));
        binary(Max, binary(Min, summand, bound), number(0.0))
    };
    TreeOp::Binary(Add, kept(a, &u, &v), kept(b, &v, &u))
}

fn number(v: f32) -> Term {
    Arc::new(TreeOp::Const(v))
}

fn binary(op: BinaryOpcode, a: Term, b: Term) -> Term {
    Arc::new(TreeOp::Binary(op, a, b))
}

#[cfg(test)]
mod tests {
    use super::super::boxes::Boxes;
    use super::*;
    use crate::interval::Interval;
    use fidget::compiler::RegOp;
    use fidget::context::Tree;
    use fidget::eval::{BulkEvaluator, Function, MathFunction};
    use fidget::var::Var;
    use fidget::vm::VmFunction;

    /// A ball and another one `apart`, blended.
    fn balls(apart: f32) -> Tree {
        let (x, y, z) = Tree::axes();
        let ball = |at: f32| {
            let off = (x.clone() - at).square() + y.square() + z.square();
            (off.sqrt() - 5.0) * -4.0
        };
        (ball(0.0).exp() + ball(apart).exp()).ln() / -4.0
    }

    fn functions(tree: &Tree) -> [VmFunction; 2] {
        let mut ctx = Context::new();
        let root = ctx.import(tree);
        let with = branched(&mut ctx, root);
        [root, with].map(|n| VmFunction::new(&ctx, &[n]).unwrap())
    }

    fn values(f: &VmFunction, points: &[Vec<f32>; 3]) -> Vec<f32> {
        let mut vars: [&[f32]; 3] = [&points[0]; 3];
        for (v, list) in [Var::X, Var::Y, Var::Z].iter().zip(points) {
            vars[f.vars().get(v).unwrap()] = list;
        }
        let tape = f.float_slice_tape(Default::default());
        let mut eval = VmFunction::new_float_slice_eval();
        eval.eval(&tape, &vars).unwrap()[0].to_vec()
    }

    #[test]
    fn values_are_the_same_to_the_last_bit() {
        let mut rng = fastrand::Rng::with_seed(11);
        let mut random = || rng.f32();
        for apart in [3.0, 9.0, 14.0, 20.0] {
            let [plain, with] = functions(&balls(apart));
            let points: [Vec<f32>; 3] = std::array::from_fn(|_| {
                (0..20_000).map(|_| 34.0 * random() - 10.0).collect()
            });
            let (a, b) = (values(&plain, &points), values(&with, &points));
            for (a, b) in a.iter().zip(b) {
                assert_eq!(a.to_bits(), b.to_bits(), "{a} {b}");
            }
        }
    }

    #[test]
    fn each_part_is_alone_where_the_other_is_far() {
        let [plain, with] = functions(&balls(30.0));
        let over = |f: &VmFunction, x: f64| {
            let x = Interval::new(x - 0.5, x + 0.5);
            let slot = f.vars().get(&Var::X).unwrap();
            let rest = Interval::new(-0.5, 0.5);
            let mut ranges = Boxes::default();
            let input = |s: usize| if s == slot { x } else { rest };
            let (range, trace) = ranges.range(f, &input);
            let simpler = trace.map(|trace| {
                let (storage, mut ws) = Default::default();
                f.simplify(trace, storage, &mut ws).unwrap()
            });
            let is_exp = |op: &&RegOp| matches!(op, RegOp::ExpReg(..));
            let left = simpler.as_ref().unwrap_or(f).data().asm();
            (range, left.iter().filter(is_exp).count())
        };
        for x in [5.0, 25.0] {
            assert_eq!(over(&plain, x).1, 2);
            let (range, exponentials) = over(&with, x);
            assert!(range.contains(0.0) && range.is_finite());
            assert_eq!(exponentials, 1);
        }
        // Half way between the balls neither is cut off.
        assert_eq!(over(&with, 15.0).1, 2);
    }

    /// Exponentials overflow from a depth of 2.8 on. Shells and offsets compare
    /// the result with other numbers.
    #[test]
    fn overflow_stays_overflow() {
        let (x, y, z) = Tree::axes();
        let union = |k: f32| {
            let ball = |at: f32| {
                let off = (x.clone() - at).square() + y.square() + z.square();
                (off.sqrt() - 5.0) * k
            };
            (ball(0.0).exp() + ball(4.0).exp()).ln() / k
        };
        let inside = union(-32.0);
        let shell = inside.clone().max(-(inside + 3.0));
        let random = |n: u32| {
            (0..20_000u32).map(move |i| {
                let hash = (i * 3 + n).wrapping_mul(2_654_435_761);
                (hash >> 8) as f32 / (1 << 24) as f32 * 40.0 - 20.0
            })
        };
        let points: [Vec<f32>; 3] =
            [0, 1, 2].map(|n| random(n).chain([0.0, 2.0, 1e9]).collect());
        for tree in [shell, union(32.0) - 3.0] {
            let [plain, with] = functions(&tree);
            let (a, b) = (values(&plain, &points), values(&with, &points));
            assert!(a.iter().any(|f| f.is_infinite()));
            for (a, b) in a.iter().zip(b) {
                assert_eq!(a.to_bits(), b.to_bits(), "{a} {b}");
            }
        }
    }

    #[test]
    fn what_has_no_such_sum_is_left_alone() {
        let mut ctx = Context::new();
        let (x, y, _) = Tree::axes();
        let root = ctx.import(&(x.exp() + y.sin()));
        assert_eq!(branched(&mut ctx, root), root);
    }
}
