//! Bounds of the field and of its slopes over boxes.
//!
//! In: a tape's operations, and for each of its inputs the range of its
//! values and of its derivatives along x and y. Out: the same of its result.
//! Where both derivatives are bounded so that the field rises in one
//! direction everywhere in a box, its outline there is a single line, and the
//! box hides nothing.
//!
//! Where the field jumps or may not be a number, the derivatives may be
//! anything.

use super::ranges::{greater, lesser};
use crate::interval::Interval;
use fidget::compiler::RegOp;
use fidget::vm::{Choice, VmFunction};

/// The product of a derivative and a factor; a derivative that is zero stays
/// so whatever the factor.
#[inline]
fn times(d: Interval, by: Interval) -> Interval {
    if d.lo == 0.0 && d.hi == 0.0 {
        d
    } else {
        d.mul(by)
    }
}

/// A range and the ranges of its derivatives along x and y.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slope {
    pub value: Interval,
    pub along: [Interval; 2],
}

impl Slope {
    pub(super) fn constant(value: Interval) -> Slope {
        Slope {
            value,
            along: [Interval::ZERO; 2],
        }
    }

    /// With another value and derivatives `by` times as large.
    #[inline]
    fn scaled(self, value: Interval, by: Interval) -> Slope {
        let [x, y] = self.along;
        let along = [times(x, by), times(y, by)];
        Slope { value, along }
    }

    /// Of something with steps: flat where its value does not change.
    fn steps(value: Interval) -> Slope {
        let flat = value.lo == value.hi && !value.nan;
        let along = if flat {
            Interval::ZERO
        } else {
            Interval::ANYTHING
        };
        Slope {
            value,
            along: [along; 2],
        }
    }

    #[inline]
    fn neg(self) -> Slope {
        Slope {
            value: self.value.neg(),
            along: [self.along[0].neg(), self.along[1].neg()],
        }
    }

    #[inline]
    fn hull(self, o: Slope) -> [Interval; 2] {
        let ([a, b], [c, d]) = (self.along, o.along);
        [a.hull(c), b.hull(d)]
    }

    #[inline]
    fn abs(self) -> Slope {
        let value = self.value.abs();
        if self.value.lo >= 0.0 {
            self
        } else if self.value.hi <= 0.0 {
            self.neg()
        } else {
            Slope {
                value,
                along: self.hull(self.neg()),
            }
        }
    }

    #[inline]
    fn add(self, o: Slope) -> Slope {
        let ([a, b], [c, d]) = (self.along, o.along);
        Slope {
            value: self.value.add(o.value),
            along: [a.add(c), b.add(d)],
        }
    }

    #[inline]
    fn sub(self, o: Slope) -> Slope {
        self.add(o.neg())
    }

    #[inline]
    fn mul(self, o: Slope) -> Slope {
        let value = self.value.mul(o.value);
        let ([a, b], [c, d]) = (self.along, o.along);
        let (v, w) = (self.value, o.value);
        let along =
            [times(a, w).add(times(c, v)), times(b, w).add(times(d, v))];
        Slope { value, along }
    }

    fn div(self, o: Slope) -> Slope {
        // (a / b)' = (a' − (a / b)·b') / b
        let value = self.value.div(o.value);
        let back = o.scaled(value, value);
        let along = [0, 1].map(|k| {
            let rest = self.along[k].sub(back.along[k]);
            rest.div(o.value)
        });
        Slope { value, along }
    }

    #[inline]
    fn square(self) -> Slope {
        let by = self.value.add(self.value);
        self.scaled(self.value.square(), by)
    }

    #[inline]
    fn sqrt(self) -> Slope {
        let value = self.value.sqrt();
        self.scaled(value, value.add(value).recip())
    }

    fn recip(self) -> Slope {
        let value = self.value.recip();
        self.scaled(value, value.square().neg())
    }

    /// √(1 − v²), inverted.
    fn of_arc(self) -> Interval {
        let one = Interval::point(1.0);
        one.sub(self.value.square()).sqrt().recip()
    }

    fn unary(self, op: impl Fn(Interval) -> Interval, by: Interval) -> Slope {
        self.scaled(op(self.value), by)
    }

    fn tan(self) -> Slope {
        let value = self.value.tan();
        self.scaled(value, Interval::point(1.0).add(value.square()))
    }

    fn atan(self) -> Slope {
        let by = Interval::point(1.0).add(self.value.square()).recip();
        self.unary(Interval::atan, by)
    }

    fn exp(self) -> Slope {
        let value = self.value.exp();
        self.scaled(value, value)
    }

    fn atan2(self, x: Slope) -> Slope {
        let value = self.value.atan2(x.value);
        if self.value.contains(0.0) && x.value.lo <= 0.0 {
            return Slope::steps(value);
        }
        let norm = self.value.square().add(x.value.square());
        let (a, b) = (self.scaled(value, x.value), x.scaled(value, self.value));
        let along = [0, 1].map(|k| a.along[k].sub(b.along[k]).div(norm));
        Slope { value, along }
    }

    fn modulo(self, o: Slope) -> Slope {
        let value = self.value.modulo(o.value);
        match self.value.same_period(o.value) {
            true => Slope { value, ..self },
            false => Slope::steps(value),
        }
    }

    #[inline]
    fn least(self, o: Slope) -> Slope {
        let value = self.value.min(o.value);
        let along = match lesser(self.value, o.value) {
            Choice::Left => self.along,
            Choice::Right => o.along,
            _ => self.hull(o),
        };
        Slope { value, along }
    }

    #[inline]
    fn greatest(self, o: Slope) -> Slope {
        let value = self.value.max(o.value);
        let along = match greater(self.value, o.value) {
            Choice::Left => self.along,
            Choice::Right => o.along,
            _ => self.hull(o),
        };
        Slope { value, along }
    }

    fn and(self, o: Slope) -> Slope {
        let value = self.value.and(o.value);
        match self.value {
            v if is_zero(v) => Slope { value, ..self },
            v if v.nan || v.contains(0.0) => Slope::steps(value),
            _ => Slope { value, ..o },
        }
    }

    fn or(self, o: Slope) -> Slope {
        let value = self.value.or(o.value);
        match self.value {
            v if is_zero(v) => Slope { value, ..o },
            v if v.nan || v.contains(0.0) => Slope::steps(value),
            _ => Slope { value, ..self },
        }
    }
}

/// True of zero and nothing else.
fn is_zero(v: Interval) -> bool {
    !v.nan && v.lo == 0.0 && v.hi == 0.0
}

/// What is known of the field over a box in a layer.
#[derive(Clone, Copy, Debug)]
pub struct Bound {
    /// Least and greatest value; infinite if it may not be a number.
    pub value: [f64; 2],
    /// By axis, the least and greatest derivative.
    pub slopes: [[f64; 2]; 2],
}

impl Bound {
    /// Nothing is known.
    pub const UNKNOWN: Bound = Bound {
        value: [f64::NEG_INFINITY, f64::INFINITY],
        slopes: [[f64::NEG_INFINITY, f64::INFINITY]; 2],
    };

    pub(super) fn new(slope: Slope) -> Bound {
        let ends = |r: Interval| match r.nan {
            true => [f64::NEG_INFINITY, f64::INFINITY],
            false => [r.lo, r.hi],
        };
        Bound {
            value: ends(slope.value),
            slopes: slope.along.map(ends),
        }
    }

    /// True if the field does not change its sign in the box.
    pub fn is_uniform(&self) -> bool {
        self.value[0] >= 0.0 || self.value[1] < 0.0
    }

    /// True if the gradient keeps within 45° of one direction in the box, so
    /// that an outline there is one line that does not turn by more.
    pub fn is_simple(&self) -> bool {
        let [x, y] = self.slopes;
        let middle = [0.5 * (x[0] + x[1]), 0.5 * (y[0] + y[1])];
        let within = |dx: f64, dy: f64| {
            let along = dx * middle[0] + dy * middle[1];
            let across = dx * middle[1] - dy * middle[0];
            along > across.abs()
        };
        x.iter().all(|&dx| y.iter().all(|&dy| within(dx, dy)))
    }
}

/// Evaluates tapes over boxes. Kept between uses for its memory.
#[derive(Default)]
pub(super) struct Slopes {
    slots: Vec<Slope>,
}

impl Slopes {
    /// The bounds of the function's (first) output for given bounds of its
    /// inputs.
    pub(super) fn eval(
        &mut self,
        f: &VmFunction,
        input: impl Fn(usize) -> Slope,
    ) -> Slope {
        let tape = f.data().asm();
        let nothing = Slope {
            value: Interval::ANYTHING,
            along: [Interval::ANYTHING; 2],
        };
        self.slots.resize(tape.slot_count(), nothing);
        let v = &mut self.slots;
        let mut out = nothing;
        let point = |imm: f32| Slope::constant(Interval::point(imm.into()));
        macro_rules! at {
            ($reg:ident) => {
                v[usize::from($reg)]
            };
        }
        macro_rules! unary {
            ($o:ident = $a:ident . $method:ident) => {
                at!($o) = at!($a).$method()
            };
        }
        macro_rules! function {
            ($o:ident = $method:ident($a:ident), $by:expr) => {{
                let a: Slope = at!($a);
                let by: Interval = $by(a.value);
                at!($o) = a.unary(Interval::$method, by);
            }};
        }
        macro_rules! binary {
            ($o:ident = $a:expr, $b:expr, $method:ident) => {{
                let (a, b): (Slope, Slope) = ($a, $b);
                at!($o) = a.$method(b)
            }};
        }
        macro_rules! steps {
            ($o:ident = $e:expr) => {
                at!($o) = Slope::steps($e)
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
                TanReg(o, a) => unary!(o = a.tan),
                AtanReg(o, a) => unary!(o = a.atan),
                ExpReg(o, a) => unary!(o = a.exp),
                SinReg(o, a) => function!(o = sin(a), Interval::cos),
                CosReg(o, a) => {
                    function!(o = cos(a), |v: Interval| v.sin().neg())
                }
                LnReg(o, a) => function!(o = ln(a), Interval::recip),
                AsinReg(o, a) => {
                    let by = at!(a).of_arc();
                    at!(o) = at!(a).unary(Interval::asin, by);
                }
                AcosReg(o, a) => {
                    let by = at!(a).of_arc().neg();
                    at!(o) = at!(a).unary(Interval::acos, by);
                }
                FloorReg(o, a) => steps!(o = at!(a).value.floor()),
                CeilReg(o, a) => steps!(o = at!(a).value.ceil()),
                RoundReg(o, a) => steps!(o = at!(a).value.round()),
                NotReg(o, a) => steps!(o = at!(a).value.not()),
                RandReg(o, _) => steps!(o = Interval::new(0.0, 1.0)),
                MixRegReg(o, ..) | MixRegImm(o, ..) | MixImmReg(o, ..) => {
                    at!(o) = nothing;
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
                    steps!(o = at!(a).value.compare(at!(b).value))
                }
                CompareRegImm(o, a, b) => {
                    steps!(o = at!(a).value.compare(point(b).value))
                }
                CompareImmReg(o, b, a) => {
                    steps!(o = point(a).value.compare(at!(b).value))
                }
                MinRegReg(o, a, b) => binary!(o = at!(a), at!(b), least),
                MinRegImm(o, a, b) => binary!(o = at!(a), point(b), least),
                MaxRegReg(o, a, b) => binary!(o = at!(a), at!(b), greatest),
                MaxRegImm(o, a, b) => binary!(o = at!(a), point(b), greatest),
                AndRegReg(o, a, b) => binary!(o = at!(a), at!(b), and),
                AndRegImm(o, a, b) => binary!(o = at!(a), point(b), and),
                OrRegReg(o, a, b) => binary!(o = at!(a), at!(b), or),
                OrRegImm(o, a, b) => binary!(o = at!(a), point(b), or),
            }
        }
        out
    }
}

/// The bounds of a coordinate, number `axis`, over a box.
pub(super) fn coordinate(over: Interval, axis: usize) -> Slope {
    let mut slope = Slope::constant(over);
    if let Some(along) = slope.along.get_mut(axis) {
        *along = Interval::point(1.0);
    }
    slope
}

/// The bounds of a function of one variable, coordinate number `axis`.
pub(super) fn slope_of(f: &VmFunction, over: Interval, axis: usize) -> Slope {
    Slopes::default().eval(f, |_| coordinate(over, axis))
}

#[cfg(test)]
mod tests {
    use super::super::ranges::everything;
    use super::*;
    use fidget::context::Context;
    use fidget::eval::{Function, MathFunction, TracingEvaluator};
    use fidget::var::Var;

    /// Along any line through a box the field changes by no more than its
    /// slopes allow.
    #[test]
    fn slopes_hold_the_differences() {
        let mut seed = 7u64;
        let mut random = || {
            seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1);
            (seed >> 40) as f32 / (1u64 << 24) as f32
        };
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
                let size = [1.5 * random() * random(), random(), 0.0];
                let lo: [f32; 3] =
                    std::array::from_fn(|_| 8.0 * random() - 4.0);
                let input = |i: usize| {
                    let a = slots.iter().position(|s| *s == Some(i)).unwrap();
                    let (lo, hi) = (lo[a], lo[a] + size[a]);
                    coordinate(Interval::new(lo.into(), hi.into()), a)
                };
                let slope = Slopes::default().eval(&f, input);
                total += 1;
                if !slope.along.iter().all(|d| d.is_finite() && !d.nan) {
                    continue;
                }
                bounded += 1;
                for _ in 0..10 {
                    let mut point = || -> [f32; 3] {
                        std::array::from_fn(|a| lo[a] + size[a] * random())
                    };
                    let (p, q) = (point(), point());
                    let (a, b) = (value(p), value(q));
                    let step = [0, 1].map(|a| {
                        let d = f64::from(q[a]) - f64::from(p[a]);
                        slope.along[a].mul(Interval::point(d))
                    });
                    let change = step[0].add(step[1]);
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
