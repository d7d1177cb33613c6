//! Values of the field together with its in-plane slopes.
//!
//! The chain rule, operation by operation, for eight points at a time or for
//! eight boxes. At a point where an operation has no derivative (a step, |0|,
//! the tip of `min`), the slopes are those of one side, or zero; over a box
//! they are all that occur, and not known if there is a step.

use super::tape::Number;

/// Numbers that a value and its slopes can be made of.
pub(super) trait Part: Number {
    /// `x` where `a` is less than `b`, else `y`; all that it may be, where
    /// that is not certain.
    fn choose(a: Self, b: Self, x: Self, y: Self) -> Self;
    /// `x` where `a` is zero, else `y`.
    fn choose_zero(a: Self, x: Self, y: Self) -> Self;
    /// `x`, but for what is said of numbers that are none.
    fn unless_nan(self, a: Self, b: Self, instead: f32) -> Self;
    /// The slope of a value that goes in steps.
    fn step(self) -> Self;
    /// The slope that the angle of a point (x = `x`, y = `self`) has besides:
    /// none, or not known where it jumps by a turn.
    fn leap(self, x: Self) -> Self;
    /// By how many whole multiples of another it exceeds its remainder.
    fn times(self, o: Self) -> Self;
}

/// A value and its derivatives along x and y.
#[derive(Clone, Copy, Debug)]
pub(super) struct Dual<T> {
    pub v: T,
    pub dx: T,
    pub dy: T,
}

impl<T: Part> Dual<T> {
    /// With another value, and `by` times the slopes.
    #[inline(always)]
    fn chain(self, v: T, by: T) -> Self {
        Dual {
            v,
            dx: self.dx.mul(by),
            dy: self.dy.mul(by),
        }
    }

    #[inline(always)]
    fn flat(v: T) -> Self {
        Dual {
            v,
            dx: T::splat(0.0),
            dy: T::splat(0.0),
        }
    }

    /// Of something with steps.
    #[inline(always)]
    fn steps(v: T) -> Self {
        Dual {
            v,
            dx: v.step(),
            dy: v.step(),
        }
    }

    #[inline(always)]
    fn unless_nan(self, a: T, b: T) -> Self {
        Dual {
            v: self.v.unless_nan(a, b, f32::NAN),
            dx: self.dx.unless_nan(a, b, 0.0),
            dy: self.dy.unless_nan(a, b, 0.0),
        }
    }
}

impl<T: Part> Number for Dual<T> {
    #[inline(always)]
    fn splat(v: f32) -> Self {
        Dual::flat(T::splat(v))
    }
    #[inline(always)]
    fn neg(self) -> Self {
        Dual {
            v: self.v.neg(),
            dx: self.dx.neg(),
            dy: self.dy.neg(),
        }
    }
    #[inline(always)]
    fn abs(self) -> Self {
        // Where it is less than zero, its negative.
        let minus = self.neg();
        let zero = T::splat(0.0);
        let of = |a, b| T::choose(self.v, zero, a, b);
        Dual {
            v: self.v.abs(),
            dx: of(minus.dx, self.dx),
            dy: of(minus.dy, self.dy),
        }
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
        self.chain(self.v.square(), self.v.add(self.v))
    }
    #[inline(always)]
    fn floor(self) -> Self {
        Dual::steps(self.v.floor())
    }
    #[inline(always)]
    fn ceil(self) -> Self {
        Dual::steps(self.v.ceil())
    }
    #[inline(always)]
    fn round(self) -> Self {
        Dual::steps(self.v.round())
    }
    #[inline(always)]
    fn sin(self) -> Self {
        self.chain(self.v.sin(), self.v.cos())
    }
    #[inline(always)]
    fn cos(self) -> Self {
        self.chain(self.v.cos(), self.v.sin().neg())
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
        self.chain(self.v.ln(), self.v.recip())
    }
    #[inline(always)]
    fn not(self) -> Self {
        Dual::steps(self.v.not())
    }
    #[inline(always)]
    fn rand(self) -> Self {
        Dual::steps(self.v.rand())
    }
    #[inline(always)]
    fn add(self, o: Self) -> Self {
        Dual {
            v: self.v.add(o.v),
            dx: self.dx.add(o.dx),
            dy: self.dy.add(o.dy),
        }
    }
    #[inline(always)]
    fn sub(self, o: Self) -> Self {
        Dual {
            v: self.v.sub(o.v),
            dx: self.dx.sub(o.dx),
            dy: self.dy.sub(o.dy),
        }
    }
    #[inline(always)]
    fn mul(self, o: Self) -> Self {
        let d = |a: T, b: T| self.v.mul(b).add(o.v.mul(a));
        Dual {
            v: self.v.mul(o.v),
            dx: d(self.dx, o.dx),
            dy: d(self.dy, o.dy),
        }
    }
    #[inline(always)]
    fn scale(self, by: f32) -> Self {
        Dual {
            v: self.v.scale(by),
            dx: self.dx.scale(by),
            dy: self.dy.scale(by),
        }
    }
    #[inline(always)]
    fn div(self, o: Self) -> Self {
        // (a / b)' = (a' − (a / b)·b') / b
        let v = self.v.div(o.v);
        let by = o.v.recip();
        let d = |a: T, b: T| a.sub(v.mul(b)).mul(by);
        Dual {
            v,
            dx: d(self.dx, o.dx),
            dy: d(self.dy, o.dy),
        }
    }
    #[inline(always)]
    fn atan2(self, x: Self) -> Self {
        let by = self.v.square().add(x.v.square()).recip();
        let leap = self.v.leap(x.v);
        let d = |a: T, b: T| x.v.mul(a).sub(self.v.mul(b)).mul(by).add(leap);
        Dual {
            v: self.v.atan2(x.v),
            dx: d(self.dx, x.dx),
            dy: d(self.dy, x.dy),
        }
    }
    #[inline(always)]
    fn modulo(self, o: Self) -> Self {
        let times = self.v.times(o.v);
        let d = |a: T, b: T| a.sub(b.mul(times));
        Dual {
            v: self.v.modulo(o.v),
            dx: d(self.dx, o.dx),
            dy: d(self.dy, o.dy),
        }
    }
    #[inline(always)]
    fn compare(self, o: Self) -> Self {
        Dual::steps(self.v.compare(o.v))
    }
    #[inline(always)]
    fn mix(self, o: Self) -> Self {
        Dual::steps(self.v.mix(o.v))
    }
    #[inline(always)]
    fn min(self, o: Self) -> Self {
        let of = |a, b| T::choose(self.v, o.v, a, b);
        Dual {
            v: self.v.min(o.v),
            dx: of(self.dx, o.dx),
            dy: of(self.dy, o.dy),
        }
        .unless_nan(self.v, o.v)
    }
    #[inline(always)]
    fn max(self, o: Self) -> Self {
        let of = |a, b| T::choose(o.v, self.v, a, b);
        Dual {
            v: self.v.max(o.v),
            dx: of(self.dx, o.dx),
            dy: of(self.dy, o.dy),
        }
        .unless_nan(self.v, o.v)
    }
    #[inline(always)]
    fn and(self, o: Self) -> Self {
        let of = |a, b| T::choose_zero(self.v, a, b);
        Dual {
            v: self.v.and(o.v),
            dx: of(self.dx, o.dx),
            dy: of(self.dy, o.dy),
        }
    }
    #[inline(always)]
    fn or(self, o: Self) -> Self {
        let of = |a, b| T::choose_zero(self.v, b, a);
        Dual {
            v: self.v.or(o.v),
            dx: of(self.dx, o.dx),
            dy: of(self.dy, o.dy),
        }
    }
}
