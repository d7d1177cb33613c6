//! Proofs: what range the field has over a box, and which branches it needs.
//!
//! In: a tape's operations and the ranges of its inputs. Out: the range of
//! its result, and a trace of the branches of `min`, `max`, `and` and `or`
//! that are never taken, from which fidget makes a shorter tape.
//!
//! Why not fidget's own interval evaluator: it panics where one end of a range
//! becomes NaN, as ∞ − ∞ does. This one never fails.

use crate::interval::Interval;
use fidget::compiler::RegOp;
use fidget::vm::{Choice, VmFunction, VmTrace};

/// Evaluates tapes over boxes. Kept between uses for its memory.
#[derive(Default)]
pub(super) struct Ranges {
    slots: Vec<Interval>,
    trace: VmTrace,
}

impl Ranges {
    /// The range of the function's (first) output for given ranges of its
    /// inputs, and the trace of its choices if it rules out any branch.
    pub(super) fn eval(
        &mut self,
        f: &VmFunction,
        input: impl Fn(usize) -> Interval,
    ) -> (Interval, Option<&VmTrace>) {
        let tape = f.data().asm();
        self.slots.resize(tape.slot_count(), Interval::ANYTHING);
        self.trace.resize(f.choice_count(), Choice::Both);
        let v = &mut self.slots;
        let choices = self.trace.as_mut_slice();
        let mut chosen = 0;
        let mut simpler = false;
        let mut out = Interval::ANYTHING;
        let point = |imm: f32| Interval::point(f64::from(imm));
        macro_rules! unary {
            ($out:ident = $arg:ident . $method:ident) => {
                v[usize::from($out)] = v[usize::from($arg)].$method()
            };
        }
        macro_rules! binary {
            ($out:ident = $a:expr, $b:expr, $method:ident) => {{
                let (a, b): (Interval, Interval) = ($a, $b);
                v[usize::from($out)] = a.$method(b)
            }};
        }
        macro_rules! choose {
            ($out:ident = $a:expr, $b:expr, $method:ident, $choice:ident) => {{
                let (a, b): (Interval, Interval) = ($a, $b);
                v[usize::from($out)] = a.$method(b);
                let choice = $choice(a, b);
                simpler |= choice != Choice::Both;
                if let Some(c) = choices.get_mut(chosen) {
                    *c = choice;
                }
                chosen += 1;
            }};
        }
        macro_rules! at {
            ($reg:ident) => {
                v[usize::from($reg)]
            };
        }
        use RegOp::*;
        for &op in tape.iter().rev() {
            match op {
                Output(a, 0) => out = at!(a),
                Output(..) => {}
                Input(o, i) => at!(o) = input(i as usize),
                CopyReg(o, a) => at!(o) = at!(a),
                CopyImm(o, imm) => at!(o) = point(imm),
                Load(o, mem) => at!(o) = v[mem as usize],
                Store(a, mem) => v[mem as usize] = at!(a),
                NegReg(o, a) => unary!(o = a.neg),
                AbsReg(o, a) => unary!(o = a.abs),
                RecipReg(o, a) => unary!(o = a.recip),
                SqrtReg(o, a) => unary!(o = a.sqrt),
                SquareReg(o, a) => unary!(o = a.square),
                FloorReg(o, a) => unary!(o = a.floor),
                CeilReg(o, a) => unary!(o = a.ceil),
                RoundReg(o, a) => unary!(o = a.round),
                SinReg(o, a) => unary!(o = a.sin),
                CosReg(o, a) => unary!(o = a.cos),
                TanReg(o, a) => unary!(o = a.tan),
                AsinReg(o, a) => unary!(o = a.asin),
                AcosReg(o, a) => unary!(o = a.acos),
                AtanReg(o, a) => unary!(o = a.atan),
                ExpReg(o, a) => unary!(o = a.exp),
                LnReg(o, a) => unary!(o = a.ln),
                NotReg(o, a) => unary!(o = a.not),
                RandReg(o, _) => at!(o) = Interval::new(0.0, 1.0),
                MixRegReg(o, ..) | MixRegImm(o, ..) | MixImmReg(o, ..) => {
                    at!(o) = Interval::ANYTHING
                }
                AddRegReg(o, a, b) => binary!(o = at!(a), at!(b), add),
                AddRegImm(o, a, b) => binary!(o = at!(a), point(b), add),
                SubRegReg(o, a, b) => binary!(o = at!(a), at!(b), sub),
                SubRegImm(o, a, b) => binary!(o = at!(a), point(b), sub),
                SubImmReg(o, b, a) => binary!(o = point(a), at!(b), sub),
                MulRegReg(o, a, b) => binary!(o = at!(a), at!(b), mul),
                MulRegImm(o, a, b) => binary!(o = at!(a), point(b), mul),
                DivRegReg(o, a, b) => binary!(o = at!(a), at!(b), div),
                DivRegImm(o, a, b) => binary!(o = at!(a), point(b), div),
                DivImmReg(o, b, a) => binary!(o = point(a), at!(b), div),
                AtanRegReg(o, a, b) => binary!(o = at!(a), at!(b), atan2),
                AtanRegImm(o, a, b) => binary!(o = at!(a), point(b), atan2),
                AtanImmReg(o, b, a) => binary!(o = point(a), at!(b), atan2),
                ModRegReg(o, a, b) => binary!(o = at!(a), at!(b), modulo),
                ModRegImm(o, a, b) => binary!(o = at!(a), point(b), modulo),
                ModImmReg(o, b, a) => binary!(o = point(a), at!(b), modulo),
                CompareRegReg(o, a, b) => {
                    binary!(o = at!(a), at!(b), compare)
                }
                CompareRegImm(o, a, b) => {
                    binary!(o = at!(a), point(b), compare)
                }
                CompareImmReg(o, b, a) => {
                    binary!(o = point(a), at!(b), compare)
                }
                MinRegReg(o, a, b) => choose!(o = at!(a), at!(b), min, lesser),
                MinRegImm(o, a, b) => {
                    choose!(o = at!(a), point(b), min, lesser)
                }
                MaxRegReg(o, a, b) => choose!(o = at!(a), at!(b), max, greater),
                MaxRegImm(o, a, b) => {
                    choose!(o = at!(a), point(b), max, greater)
                }
                AndRegReg(o, a, b) => choose!(o = at!(a), at!(b), and, zero),
                AndRegImm(o, a, b) => choose!(o = at!(a), point(b), and, zero),
                OrRegReg(o, a, b) => choose!(o = at!(a), at!(b), or, nonzero),
                OrRegImm(o, a, b) => choose!(o = at!(a), point(b), or, nonzero),
            }
        }
        (out, simpler.then_some(&self.trace))
    }
}

/// The side that `min` always takes. A side that may be NaN is kept, for
/// then so is the result.
pub(super) fn lesser(a: Interval, b: Interval) -> Choice {
    if a.hi < b.lo && !b.nan {
        Choice::Left
    } else if b.hi < a.lo && !a.nan {
        Choice::Right
    } else {
        Choice::Both
    }
}

/// The side that `max` always takes.
pub(super) fn greater(a: Interval, b: Interval) -> Choice {
    lesser(a.neg(), b.neg())
}

/// The side that `and` takes: the left one where that is 0.
fn zero(a: Interval, _: Interval) -> Choice {
    if a.nan {
        Choice::Both
    } else if a.lo == 0.0 && a.hi == 0.0 {
        Choice::Left
    } else if !a.contains(0.0) {
        Choice::Right
    } else {
        Choice::Both
    }
}

/// The side that `or` takes: the left one where that is not 0.
fn nonzero(a: Interval, b: Interval) -> Choice {
    match zero(a, b) {
        Choice::Left => Choice::Right,
        Choice::Right => Choice::Left,
        other => other,
    }
}

/// The range of a function of one variable.
pub(super) fn range_of(f: &VmFunction, over: Interval) -> Interval {
    Ranges::default().eval(f, |_| over).0
}

/// Every operation fidget has, with registers and with constants.
#[cfg(test)]
pub(super) fn everything() -> Vec<fidget::context::Tree> {
    use fidget::context::Tree;
    let (x, y, z) = Tree::axes();
    let c = |v: f32| Tree::constant(v);
    vec![
        x.neg() + y.abs() * z.clone(),
        (x.clone() + 5.0).recip() - (y.clone() * 0.25 + 3.0).sqrt(),
        x.square().floor() + y.ceil() - z.round(),
        x.sin() * y.cos() + (z.clone() * 0.2).tan(),
        (x.clone() * 0.2).asin() + (y.clone() * 0.2).acos() - z.atan(),
        x.exp() - (y.clone() + 4.0).ln() / (z.clone() + 7.0),
        (c(3.0) - x.clone()) / 2.0 + c(1.0) / (y.clone() + 8.0),
        x.atan2(y.clone()) + x.atan2(2.0) + c(2.0).atan2(y.clone()),
        x.modulo(2.0) + c(5.0).modulo(y.clone() + 6.0),
        (x.clone() + 4.0).modulo(y.clone() + 5.0),
        x.compare(y.clone()) + x.compare(0.5) + c(0.5).compare(z.clone()),
        x.min(y.clone()).min(0.3).max(z.clone() - 2.0).max(-0.5),
        x.floor().and(y.clone()) + y.floor().and(2.0),
        x.floor().or(y.clone()) + y.floor().or(2.0) + (x.floor()).not(),
        x.rand() + x.mix(y.clone()).and(1.0),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use fidget::context::{Context, Tree};
    use fidget::eval::{Function, MathFunction, TracingEvaluator};
    use fidget::var::Var;

    fn function(tree: &Tree) -> VmFunction {
        let mut ctx = Context::new();
        let root = ctx.import(tree);
        VmFunction::new(&ctx, &[root]).unwrap()
    }

    fn slots(f: &VmFunction) -> [Option<usize>; 3] {
        [Var::X, Var::Y, Var::Z].map(|v| f.vars().get(&v))
    }

    fn value(f: &VmFunction, p: [f32; 3]) -> f32 {
        let mut vars = [0.0; 3];
        for (slot, v) in slots(f).into_iter().zip(p) {
            if let Some(s) = slot {
                vars[s] = v;
            }
        }
        let mut eval = VmFunction::new_point_eval();
        let tape = f.point_tape(Default::default());
        eval.eval(&tape, &vars[..f.vars().len()]).unwrap().0[0]
    }

    #[test]
    fn ranges_hold_the_values_and_simpler_tapes_agree() {
        let mut ranges = Ranges::default();
        let mut seed = 5u64;
        let mut random = || {
            seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1);
            (seed >> 40) as f32 / (1u64 << 24) as f32
        };
        let mut simplified = 0;
        for (k, tree) in everything().iter().enumerate() {
            let f = function(tree);
            let s = slots(&f);
            for _ in 0..200 {
                let size = 3.0 * random() * random();
                let lo: [f32; 3] =
                    std::array::from_fn(|_| 8.0 * random() - 4.0);
                let input = |i: usize| {
                    let axis = s.iter().position(|s| *s == Some(i)).unwrap();
                    let lo = lo[axis];
                    Interval::new(f64::from(lo), f64::from(lo + size))
                };
                let (range, trace) = ranges.eval(&f, input);
                let simpler = trace.map(|t| {
                    simplified += 1;
                    f.simplify(t, Default::default(), &mut Default::default())
                        .unwrap()
                });
                for _ in 0..10 {
                    let p: [f32; 3] =
                        std::array::from_fn(|a| lo[a] + size * random());
                    let v = value(&f, p);
                    if let Some(g) = &simpler {
                        let w = value(g, p);
                        assert!(v == w || v.is_nan() && w.is_nan(), "{k}");
                    }
                    let slack = 1e-5 * (1.0 + f64::from(v.abs()));
                    let v = f64::from(v);
                    let inside = range.lo - slack <= v && v <= range.hi + slack;
                    assert!(
                        if v.is_nan() { range.nan } else { inside },
                        "expression {k}: {v} is not in {range:?}"
                    );
                }
            }
        }
        assert!(simplified > 50, "only {simplified} were simplified");
    }

    #[test]
    fn overflow_is_no_obstacle() {
        let (x, y, _) = Tree::axes();
        // fidget's own intervals panic here: ∞ − ∞.
        let wild = (x.clone() * 1e4).exp() - (y * 1e4).exp();
        let f = function(&wild.max(x));
        let (range, _) =
            Ranges::default().eval(&f, |_| Interval::new(0.5, 2.0));
        assert!(range.nan && range.lo <= 0.5 && range.hi == f64::INFINITY);
    }
}
