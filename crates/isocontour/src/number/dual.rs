//! Values together with their derivatives along some axes.
//!
//! The chain rule, operation by operation, for eight points at a time or for a box.
//! At a point where an operation has no derivative (a step, |0|, the tip of `min`),
//! the derivatives are those of one side, or zero. Over a box they are all that
//! occur, and unknown if there is a step.

use super::{Component, Number};

/// A value and its derivatives along `D` axes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Dual<T, const D: usize> {
    pub v: T,
    pub d: [T; D],
}

impl<T: Component, const D: usize> Dual<T, D> {
    /// A number with the value `v` and `by` times the derivatives of `self`.
    #[inline(always)]
    fn chain(self, v: T, by: T) -> Self {
        self.map(v, |d| d.along(by))
    }

    #[inline(always)]
    fn map(self, v: T, f: impl Fn(T) -> T) -> Self {
        let mut d = self.d;
        for d in &mut d {
            *d = f(*d);
        }
        Dual { v, d }
    }

    #[inline(always)]
    fn zip(self, o: Self, v: T, f: impl Fn(T, T) -> T) -> Self {
        let mut d = self.d;
        for (d, o) in d.iter_mut().zip(o.d) {
            *d = f(*d, o);
        }
        Dual { v, d }
    }

    /// A number that does not change, so that its derivatives are zero.
    #[inline(always)]
    pub(crate) fn flat(v: T) -> Self {
        Dual {
            v,
            d: [T::splat(0.0); D],
        }
    }

    /// The coordinate number `axis`, whose derivative along its own axis is 1.
    #[inline(always)]
    pub(crate) fn coordinate(v: T, axis: usize) -> Self {
        let mut out = Dual::flat(v);
        if let Some(d) = out.d.get_mut(axis) {
            *d = T::splat(1.0);
        }
        out
    }

    #[inline(always)]
    fn unless_nan(self, a: T, b: T) -> Self {
        let v = self.v.unless_nan(a, b, f32::NAN);
        self.map(v, |d| d.unless_nan(a, b, 0.0))
    }
}

// Operations whose value goes in steps.
macro_rules! stepped {
    ($($name:ident)*) => {
        $(#[inline(always)]
        fn $name(self) -> Self {
            let v = self.v.$name();
            self.map(v, |a| v.step(a, a))
        })*
    };
    ($($name:ident($o:ident))*) => {
        $(#[inline(always)]
        fn $name(self, $o: Self) -> Self {
            let v = self.v.$name($o.v);
            self.zip($o, v, |a, b| v.step(a, b))
        })*
    };
}

impl<T: Component, const D: usize> Number for Dual<T, D> {
    stepped!(floor ceil round not rand);
    stepped!(compare(o) mix(o));

    #[inline(always)]
    fn splat(v: f32) -> Self {
        Dual::flat(T::splat(v))
    }
    #[inline(always)]
    fn neg(self) -> Self {
        self.map(self.v.neg(), T::neg)
    }
    #[inline(always)]
    fn abs(self) -> Self {
        // Where the value is less than zero, the derivative changes its sign.
        let zero = T::splat(0.0);
        let of = |d: T| T::choose(self.v, zero, d.neg(), d);
        self.map(self.v.abs(), of)
    }
    #[inline(always)]
    fn recip(self) -> Self {
        let v = self.v.recip();
        self.chain(v, v.square().neg())
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        let v = self.v.sqrt();
        self.chain(v, v.recip().scale(0.5))
    }
    #[inline(always)]
    fn square(self) -> Self {
        let v = self.v.square();
        self.chain(v, self.v.add(self.v))
    }
    #[inline(always)]
    fn sin(self) -> Self {
        let v = self.v.sin();
        self.chain(v, self.v.cos())
    }
    #[inline(always)]
    fn cos(self) -> Self {
        let v = self.v.cos();
        self.chain(v, self.v.sin().neg())
    }
    #[inline(always)]
    fn tan(self) -> Self {
        let v = self.v.tan();
        self.chain(v, v.square().add(T::splat(1.0)))
    }
    #[inline(always)]
    fn asin(self) -> Self {
        let by = T::splat(1.0).sub(self.v.square()).sqrt().recip();
        self.chain(self.v.asin(), by)
    }
    #[inline(always)]
    fn acos(self) -> Self {
        let by = T::splat(1.0).sub(self.v.square()).sqrt().recip().neg();
        self.chain(self.v.acos(), by)
    }
    #[inline(always)]
    fn atan(self) -> Self {
        let by = self.v.square().add(T::splat(1.0)).recip();
        self.chain(self.v.atan(), by)
    }
    #[inline(always)]
    fn exp(self) -> Self {
        let v = self.v.exp();
        self.chain(v, v)
    }
    #[inline(always)]
    fn ln(self) -> Self {
        let v = self.v.ln();
        self.chain(v, self.v.recip())
    }
    #[inline(always)]
    fn add(self, o: Self) -> Self {
        self.zip(o, self.v.add(o.v), T::add)
    }
    #[inline(always)]
    fn sub(self, o: Self) -> Self {
        self.zip(o, self.v.sub(o.v), T::sub)
    }
    #[inline(always)]
    fn mul(self, o: Self) -> Self {
        let d = |a: T, b: T| b.along(self.v).add(a.along(o.v));
        self.zip(o, self.v.mul(o.v), d)
    }
    #[inline(always)]
    fn scale(self, by: f32) -> Self {
        self.map(self.v.scale(by), |d| d.scale(by))
    }
    #[inline(always)]
    fn div(self, o: Self) -> Self {
        // (a / b)' = (a' − (a / b)·b') / b
        let v = self.v.div(o.v);
        let by = o.v.recip();
        self.zip(o, v, |a, b| a.sub(b.along(v)).along(by))
    }
    #[inline(always)]
    fn atan2(self, x: Self) -> Self {
        let y = self.v;
        let by = y.square().add(x.v.square()).recip();
        self.zip(x, y.atan2(x.v), |a, b| {
            let turn = a.along(x.v).sub(b.along(y)).along(by);
            turn.add(y.leap(x.v, a))
        })
    }
    #[inline(always)]
    fn modulo(self, o: Self) -> Self {
        let d = |a, b| self.v.wrap(o.v, a, b);
        self.zip(o, self.v.modulo(o.v), d)
    }
    #[inline(always)]
    fn min(self, o: Self) -> Self {
        let d = |a, b| T::choose(self.v, o.v, a, b);
        self.zip(o, self.v.min(o.v), d).unless_nan(self.v, o.v)
    }
    #[inline(always)]
    fn max(self, o: Self) -> Self {
        let d = |a, b| T::choose(o.v, self.v, a, b);
        self.zip(o, self.v.max(o.v), d).unless_nan(self.v, o.v)
    }
    #[inline(always)]
    fn and(self, o: Self) -> Self {
        let d = |a, b| T::choose_zero(self.v, a, b);
        self.zip(o, self.v.and(o.v), d)
    }
    #[inline(always)]
    fn or(self, o: Self) -> Self {
        let d = |a, b| T::choose_zero(self.v, b, a);
        self.zip(o, self.v.or(o.v), d)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::interval::Interval;
    use crate::number::run::run;
    use crate::number::tests::everything;
    use fidget::context::Context;
    use fidget::eval::{Function, MathFunction, TracingEvaluator};
    use fidget::var::Var;
    use fidget::vm::VmFunction;

    type Slope = Dual<Interval, 3>;

    fn slope(f: &VmFunction, input: &dyn Fn(usize) -> Slope) -> Slope {
        let tape = f.data().asm();
        let mut registers = vec![[Slope::splat(0.0)]; tape.slot_count()];
        let mut out = Slope::splat(0.0);
        run(
            tape,
            &mut registers[..],
            |slot, [slope]| *slope = input(slot),
            |[slope]| out = *slope,
            |_, _, _| {},
        );
        out
    }

    /// Along any line through a box the field changes by no more than its
    /// slopes allow.
    #[test]
    fn slopes_hold_the_differences() {
        let mut rng = fastrand::Rng::with_seed(7);
        let mut random = || rng.f32();
        let (mut bounded, mut total) = (0, 0);
        for (k, tree) in everything().iter().enumerate() {
            let mut ctx = Context::new();
            let root = ctx.import(tree);
            let f = VmFunction::new(&ctx, &[root]).unwrap();
            let slots = [Var::X, Var::Y, Var::Z].map(|v| f.vars().get(&v));
            let tape = f.point_tape(Default::default());
            let mut eval = VmFunction::new_point_eval();
            let mut value = |p: [f32; 3]| {
                let mut vars = [0.0; 3];
                for (slot, v) in slots.into_iter().zip(p) {
                    if let Some(s) = slot {
                        vars[s] = v;
                    }
                }
                let vars = &vars[..f.vars().len()];
                f64::from(eval.eval(&tape, vars).unwrap().0[0])
            };
            for _ in 0..300 {
                let size =
                    [1.5 * random() * random(), random(), 0.5 * random()];
                let lo: [f32; 3] =
                    std::array::from_fn(|_| 8.0 * random() - 4.0);
                let input = |i: usize| {
                    let a = slots.iter().position(|s| *s == Some(i)).unwrap();
                    let (lo, hi) = (lo[a], lo[a] + size[a]);
                    Dual::coordinate(Interval::new(lo.into(), hi.into()), a)
                };
                let slope = slope(&f, &input);
                total += 1;
                if !slope.d.iter().all(|d| d.is_finite() && !d.nan) {
                    continue;
                }
                bounded += 1;
                for _ in 0..10 {
                    let mut point = || -> [f32; 3] {
                        std::array::from_fn(|a| lo[a] + size[a] * random())
                    };
                    let (p, q) = (point(), point());
                    let (a, b) = (value(p), value(q));
                    let [x, y, z] = [0, 1, 2].map(|a| {
                        let d = f64::from(q[a]) - f64::from(p[a]);
                        slope.d[a].mul(Interval::point(d))
                    });
                    let change = x.add(y).add(z);
                    let slack = 1e-5 * (1.0 + a.abs() + b.abs());
                    assert!(
                        change.lo - slack <= b - a
                            && b - a <= change.hi + slack,
                        "expression {k}: {} is not in {change:?}",
                        b - a
                    );
                }
            }
        }
        assert!(3 * bounded > total, "{bounded} of {total} are bounded");
    }
}
