use super::*;
use crate::number::tests::everything;
use fidget::context::{Context, Tree};
use fidget::eval::{Function, MathFunction, TracingEvaluator};
use fidget::var::Var;

/// A function of its own for an expression.
pub(crate) fn function(tree: &Tree) -> VmFunction {
    let mut ctx = Context::new();
    let root = ctx.import(tree);
    VmFunction::new(&ctx, &[root]).unwrap()
}

fn slots(f: &VmFunction) -> [Option<usize>; 3] {
    [Var::X, Var::Y, Var::Z].map(|v| f.vars().get(&v))
}

/// The function's value at a place.
pub(crate) fn value(f: &VmFunction, p: [f32; 3]) -> f32 {
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
    let mut ranges = Boxes::default();
    let mut rng = fastrand::Rng::with_seed(5);
    let mut random = || rng.f32();
    let mut simplified = 0;
    for (k, tree) in everything().iter().enumerate() {
        let f = function(tree);
        let s = slots(&f);
        for _ in 0..200 {
            let size = 3.0 * random() * random();
            let lo: [f32; 3] = std::array::from_fn(|_| 8.0 * random() - 4.0);
            let input = |i: usize| {
                let axis = s.iter().position(|s| *s == Some(i)).unwrap();
                let lo = lo[axis];
                Interval::new(f64::from(lo), f64::from(lo + size))
            };
            let (range, trace) = ranges.range(&f, &input);
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
    let (range, _) = Boxes::default().range(&f, &|_| Interval::new(0.5, 2.0));
    assert!(range.nan && range.lo <= 0.5 && range.hi == f64::INFINITY);
}
