//! Values of the field together with its in-plane slopes.
//!
//! The chain rule, operation by operation, eight points at a time. Where an
//! operation has no derivative (a step, |0|, the tip of `min`), the slopes
//! are those of one side, or zero.

use super::tape::Number;
use super::wide::Wide;

/// A value and its derivatives along x and y.
#[derive(Clone, Copy, Debug)]
pub(super) struct Dual {
    pub v: Wide,
    pub dx: Wide,
    pub dy: Wide,
}

impl Dual {
    /// With another value, and `by` times the slopes.
    #[inline(always)]
    fn chain(self, v: Wide, by: Wide) -> Dual {
        Dual {
            v,
            dx: self.dx.mul(by),
            dy: self.dy.mul(by),
        }
    }

    #[inline(always)]
    fn flat(v: Wide) -> Dual {
        Dual {
            v,
            dx: Wide::ZERO,
            dy: Wide::ZERO,
        }
    }

    /// Where `mask` is true of the values of `a` and `b`, `a`; else `b`.
    #[inline(always)]
    fn choose(a: Dual, b: Dual, mask: impl Fn(f32, f32) -> bool) -> Dual {
        let of = |p: Wide, q: Wide| a.v.choose_by(b.v, &mask, p, q);
        Dual {
            v: of(a.v, b.v),
            dx: of(a.dx, b.dx),
            dy: of(a.dy, b.dy),
        }
    }

    /// Not a number, and flat, where either value is none.
    #[inline(always)]
    fn unless_nan(self, a: Wide, b: Wide) -> Dual {
        let nan = |a: f32, b: f32| a.is_nan() || b.is_nan();
        Dual {
            v: a.choose_by(b, nan, Wide::NAN, self.v),
            dx: a.choose_by(b, nan, Wide::ZERO, self.dx),
            dy: a.choose_by(b, nan, Wide::ZERO, self.dy),
        }
    }
}

impl Number for Dual {
    #[inline(always)]
    fn splat(v: f32) -> Self {
        Dual::flat(Wide::splat(v))
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
        Dual::choose(self.neg(), self, |minus, _| minus > 0.0)
    }
    #[inline(always)]
    fn recip(self) -> Self {
        let v = self.v.recip();
        self.chain(v, v.square().neg())
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        let v = self.v.sqrt();
        self.chain(v, v.map(|v| 0.5 / v))
    }
    #[inline(always)]
    fn square(self) -> Self {
        self.chain(self.v.square(), self.v.add(self.v))
    }
    #[inline(always)]
    fn floor(self) -> Self {
        Dual::flat(self.v.floor())
    }
    #[inline(always)]
    fn ceil(self) -> Self {
        Dual::flat(self.v.ceil())
    }
    #[inline(always)]
    fn round(self) -> Self {
        Dual::flat(self.v.round())
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
        self.chain(v, v.map(|v| 1.0 + v * v))
    }
    #[inline(always)]
    fn asin(self) -> Self {
        let by = self.v.map(|v| 1.0 / (1.0 - v * v).sqrt());
        self.chain(self.v.asin(), by)
    }
    #[inline(always)]
    fn acos(self) -> Self {
        let by = self.v.map(|v| -1.0 / (1.0 - v * v).sqrt());
        self.chain(self.v.acos(), by)
    }
    #[inline(always)]
    fn atan(self) -> Self {
        let by = self.v.map(|v| 1.0 / (1.0 + v * v));
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
        Dual::flat(self.v.not())
    }
    #[inline(always)]
    fn rand(self) -> Self {
        Dual::flat(self.v.rand())
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
        let d = |a: Wide, b: Wide| self.v.mul(b).add(o.v.mul(a));
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
        let d = |a: Wide, b: Wide| a.sub(v.mul(b)).mul(by);
        Dual {
            v,
            dx: d(self.dx, o.dx),
            dy: d(self.dy, o.dy),
        }
    }
    #[inline(always)]
    fn atan2(self, x: Self) -> Self {
        let by = self.v.square().add(x.v.square()).recip();
        let d = |a: Wide, b: Wide| x.v.mul(a).sub(self.v.mul(b)).mul(by);
        Dual {
            v: self.v.atan2(x.v),
            dx: d(self.dx, x.dx),
            dy: d(self.dy, x.dy),
        }
    }
    #[inline(always)]
    fn modulo(self, o: Self) -> Self {
        let times = self.v.zip(o.v, f32::div_euclid);
        let d = |a: Wide, b: Wide| a.sub(b.mul(times));
        Dual {
            v: self.v.modulo(o.v),
            dx: d(self.dx, o.dx),
            dy: d(self.dy, o.dy),
        }
    }
    #[inline(always)]
    fn compare(self, o: Self) -> Self {
        Dual::flat(self.v.compare(o.v))
    }
    #[inline(always)]
    fn mix(self, o: Self) -> Self {
        Dual::flat(self.v.mix(o.v))
    }
    #[inline(always)]
    fn min(self, o: Self) -> Self {
        Dual::choose(self, o, |a, b| a < b).unless_nan(self.v, o.v)
    }
    #[inline(always)]
    fn max(self, o: Self) -> Self {
        Dual::choose(self, o, |a, b| a > b).unless_nan(self.v, o.v)
    }
    #[inline(always)]
    fn and(self, o: Self) -> Self {
        Dual::choose(self, o, |a, _| a == 0.0)
    }
    #[inline(always)]
    fn or(self, o: Self) -> Self {
        Dual::choose(self, o, |a, _| a != 0.0)
    }
}
