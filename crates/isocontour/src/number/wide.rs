//! Eight numbers at a time, and functions of them.
//!
//! Every function is a fixed sequence of additions, multiplications and
//! divisions, each rounded as IEEE 754 says, without a branch. So the compiler
//! can turn it into whatever vector instructions there are, and the result is
//! equal, bit for bit, on any processor. (The system's sine does not give equal
//! results.) Inside, the functions compute in `f64`. They return the nearest
//! `f32`, or the one next to it in one of thousands of cases.
//!
//! Sine and cosine: the kernels `__kernel_sindf` and `__kernel_cosdf` of
//! FreeBSD's msun (Bruce D. Evans), after reduction by multiples of π/2 in two
//! parts. Their notice:
//!
//! > Copyright (C) 1993 by Sun Microsystems, Inc. All rights reserved.
//! >
//! > Developed at SunPro, a Sun Microsystems, Inc. business.
//! > Permission to use, copy, modify, and distribute this
//! > software is freely granted, provided that this notice
//! > is preserved.

use super::{Component, Number};
use fidget::types::FloatExt;

/// Numbers in a [`Wide`].
pub(crate) const WIDTH: usize = 8;

/// Eight numbers, on each of which every operation works alone.
#[derive(Clone, Copy, Debug)]
#[repr(align(32))]
pub(crate) struct Wide(pub [f32; WIDTH]);

impl Wide {
    pub(crate) const ZERO: Wide = Wide([0.0; WIDTH]);

    #[inline(always)]
    pub(crate) fn map(self, f: impl Fn(f32) -> f32) -> Wide {
        let mut out = self;
        for v in &mut out.0 {
            *v = f(*v);
        }
        out
    }

    #[inline(always)]
    pub(crate) fn zip(self, o: Wide, f: impl Fn(f32, f32) -> f32) -> Wide {
        let mut out = self;
        for (v, w) in out.0.iter_mut().zip(o.0) {
            *v = f(*v, w);
        }
        out
    }

    /// The numbers of `a` where `mask` is true for the values of `self` and
    /// another, and those of `b` elsewhere.
    #[inline(always)]
    pub(crate) fn choose_by(
        self,
        o: Wide,
        mask: impl Fn(f32, f32) -> bool,
        a: Wide,
        b: Wide,
    ) -> Wide {
        let mut out = b;
        for k in 0..WIDTH {
            let yes = mask(self.0[k], o.0[k]);
            out.0[k] = if yes { a.0[k] } else { b.0[k] };
        }
        out
    }

    /// A function of an angle's sine and cosine. `rare` computes it where a
    /// number is too large for the common way.
    #[inline(always)]
    fn turn(self, f: impl Fn(Turn) -> f64, rare: impl Fn(f32) -> f32) -> Wide {
        let mut out = self.map(|v| f(Turn::of(f64::from(v))) as f32);
        let large = |v: &f32| f64::from(v.abs()) > Turn::GREATEST_ANGLE;
        if self.0.iter().any(large) {
            for (o, v) in out.0.iter_mut().zip(self.0) {
                if large(&v) {
                    *o = rare(v);
                }
            }
        }
        out
    }
}

/// Adding and subtracting this number rounds to a whole number, which stands in
/// the lowest bits of the sum.
const ROUND: f64 = 6_755_399_441_055_744.0;

/// Sine and cosine of an angle.
#[derive(Clone, Copy)]
pub(crate) struct Turn {
    pub sin: f64,
    pub cos: f64,
}

impl Turn {
    /// Greatest angle that is reduced exactly enough.
    pub(crate) const GREATEST_ANGLE: f64 = 1e8;
    /// π/2 without its last bits, so that multiples of it are exact.
    const QUARTER: f64 = 1.570_796_310_901_641_8;
    /// The rest of π/2.
    const REST: f64 = 1.589_325_477_352_819_7e-8;

    #[inline(always)]
    pub(crate) fn of(x: f64) -> Turn {
        let raised = x * std::f64::consts::FRAC_2_PI + ROUND;
        let quarters = raised - ROUND;
        let x = x - quarters * Self::QUARTER - quarters * Self::REST;
        let z = x * x;
        let w = z * z;
        let r = -1.983_933_483_609_663_2e-4 + z * 2.718_311_493_989_822e-6;
        let s = z * x;
        let sin = (x + s
            * (-1.666_666_664_162_652_4e-1 + z * 8.333_329_385_889_463e-3))
            + s * w * r;
        let r = -1.388_676_377_460_993e-3 + z * 2.439_044_879_627_741e-5;
        let cos = ((1.0 + z * -4.999_999_972_510_031e-1)
            + w * 4.166_662_332_373_906e-2)
            + (w * z) * r;
        // The quarter of the turn tells which of the two is the sine, and which
        // signs they have.
        let n = raised.to_bits();
        let swap = n & 1 != 0;
        let (a, b) = if swap { (cos, sin) } else { (sin, cos) };
        let sign =
            |v: f64, n: u64| f64::from_bits(v.to_bits() ^ (n >> 1 << 63));
        Turn {
            sin: sign(a, n),
            cos: sign(b, n.wrapping_add(1)),
        }
    }
}

/// eˣ within a part in 10⁹; right for x from −708 to 708.
#[inline(always)]
pub(crate) fn exp(x: f64) -> f64 {
    // x = n·ln 2 + r, and a series for eʳ.
    let raised = x * std::f64::consts::LOG2_E + ROUND;
    let r = x - (raised - ROUND) * std::f64::consts::LN_2;
    let q = r * r;
    let low = (1.0 + r) + q * (0.5 + r * (1.0 / 6.0));
    let high = (1.0 / 24.0 + r * (1.0 / 120.0))
        + q * ((1.0 / 720.0 + r * (1.0 / 5040.0)) + q * (1.0 / 40320.0));
    let scale = f64::from_bits(raised.to_bits().wrapping_add(1023) << 52);
    (low + q * q * high) * scale
}

/// The natural logarithm of a normal positive number, within a part in 10⁹.
#[inline(always)]
pub(crate) fn ln(v: f64) -> f64 {
    /// √½. The mantissas go from it to its double.
    const LEAST: u64 = 0x3fe6_a09e_667f_3bcd;
    const ONE: u64 = 0x3ff0_0000_0000_0000;
    const MANTISSA: u64 = (1 << 52) - 1;
    /// 2⁵², in whose lowest bits a whole number may be put.
    const WHOLE: u64 = 0x4330_0000_0000_0000;
    let bits = v.to_bits().wrapping_add(ONE - LEAST);
    let exponent = f64::from_bits((bits >> 52) | WHOLE)
        - (4_503_599_627_370_496.0 + 1023.0);
    let m = f64::from_bits((bits & MANTISSA) + LEAST);
    // ln m = 2·artanh s, by its series.
    let s = (m - 1.0) / (m + 1.0);
    let z = s * s;
    let w = z * z;
    let series = (1.0 / 3.0 + z * (1.0 / 5.0))
        + w * ((1.0 / 7.0 + z * (1.0 / 9.0))
            + w * (1.0 / 11.0 + z * (1.0 / 13.0)));
    exponent * std::f64::consts::LN_2 + 2.0 * (s + s * z * series)
}

/// eˣ of an `f32`.
#[inline(always)]
fn exp_single(v: f32) -> f32 {
    // Below and above these ends the result is zero or infinite.
    let x = f64::from(v);
    let x = if x > 90.0 { 90.0 } else { x };
    let x = if x < -110.0 { -110.0 } else { x };
    exp(x) as f32
}

/// The natural logarithm of an `f32`.
#[inline(always)]
fn ln_single(v: f32) -> f32 {
    let log = ln(f64::from(v)) as f32;
    let log = if v == 0.0 { f32::NEG_INFINITY } else { log };
    let log = if v < 0.0 { f32::NAN } else { log };
    // The number is infinite or NaN.
    if v < f32::INFINITY { log } else { v }
}

#[inline(always)]
fn min(a: f32, b: f32) -> f32 {
    let lesser = if a < b { a } else { b };
    if a.is_nan() { f32::NAN } else { lesser }
}

#[inline(always)]
fn max(a: f32, b: f32) -> f32 {
    let greater = if a > b { a } else { b };
    if a.is_nan() { f32::NAN } else { greater }
}

impl Component for Wide {
    #[inline(always)]
    fn choose(a: Self, b: Self, x: Self, y: Self) -> Self {
        a.choose_by(b, |a, b| a < b, x, y)
    }
    #[inline(always)]
    fn choose_zero(a: Self, x: Self, y: Self) -> Self {
        a.choose_by(a, |a, _| a == 0.0, x, y)
    }
    #[inline(always)]
    fn unless_nan(self, a: Self, b: Self, instead: f32) -> Self {
        let nan = |a: f32, b: f32| a.is_nan() || b.is_nan();
        a.choose_by(b, nan, Wide::splat(instead), self)
    }
    #[inline(always)]
    fn step(self, _: Self, _: Self) -> Self {
        Wide::ZERO
    }
    #[inline(always)]
    fn leap(self, _: Self, _: Self) -> Self {
        Wide::ZERO
    }
    #[inline(always)]
    fn wrap(self, o: Self, a: Self, b: Self) -> Self {
        a.sub(b.mul(self.zip(o, f32::div_euclid)))
    }
}

// An operation on each number alone, by its function of single numbers.
macro_rules! each {
    ($($name:ident = $f:expr;)*) => {
        $(#[inline(always)]
        fn $name(self) -> Self {
            self.map($f)
        })*
    };
    ($($name:ident($o:ident) = $f:expr;)*) => {
        $(#[inline(always)]
        fn $name(self, $o: Self) -> Self {
            self.zip($o, $f)
        })*
    };
}

impl Number for Wide {
    each! {
        neg = |a| -a;
        abs = f32::abs;
        recip = |a| 1.0 / a;
        sqrt = f32::sqrt;
        square = |a| a * a;
        floor = f32::floor;
        ceil = f32::ceil;
        round = f32::round;
        asin = libm::asinf;
        acos = libm::acosf;
        atan = libm::atanf;
        exp = exp_single;
        ln = ln_single;
        not = FloatExt::not;
        rand = FloatExt::rand;
    }
    each! {
        add(o) = |a, b| a + b;
        sub(o) = |a, b| a - b;
        mul(o) = |a, b| a * b;
        div(o) = |a, b| a / b;
        atan2(o) = libm::atan2f;
        modulo(o) = f32::rem_euclid;
        compare(o) = FloatExt::compare;
        mix(o) = FloatExt::mix;
        min(o) = min;
        max(o) = max;
        and(o) = |a, b| if a == 0.0 { a } else { b };
        or(o) = |a, b| if a != 0.0 { a } else { b };
    }

    #[inline(always)]
    fn splat(v: f32) -> Self {
        Wide([v; WIDTH])
    }
    #[inline(always)]
    fn sin(self) -> Self {
        self.turn(|t| t.sin, libm::sinf)
    }
    #[inline(always)]
    fn cos(self) -> Self {
        self.turn(|t| t.cos, libm::cosf)
    }
    #[inline(always)]
    fn tan(self) -> Self {
        self.turn(|t| t.sin / t.cos, libm::tanf)
    }
    #[inline(always)]
    fn scale(self, by: f32) -> Self {
        self.map(|a| a * by)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Distance of two numbers, in steps from one `f32` to the next.
    fn steps(a: f32, b: f32) -> u64 {
        if a == b || a.is_nan() && b.is_nan() {
            return 0;
        }
        let place = |v: f32| {
            let bits = i64::from(v.to_bits() & 0x7fff_ffff);
            if v < 0.0 { -bits } else { bits }
        };
        place(a).abs_diff(place(b))
    }

    #[test]
    fn functions_are_right_to_the_last_bit_or_next_to_it() {
        type Case = (&'static str, fn(Wide) -> Wide, fn(f64) -> f64, u64);
        // The last number of a case says that one in so many results may be
        // off. The tangents of very large numbers are libm's.
        let cases: [Case; 5] = [
            ("exp", Wide::exp, f64::exp, 1000),
            ("ln", Wide::ln, f64::ln, 1000),
            ("sin", Wide::sin, f64::sin, 1000),
            ("cos", Wide::cos, f64::cos, 1000),
            ("tan", Wide::tan, f64::tan, 20),
        ];
        let awkward = [
            0.0,
            -0.0,
            1.0,
            -1.0,
            1e-45,
            1e-30,
            88.8,
            -88.0,
            -103.9,
            3e38,
            -3e38,
            1e8,
            1.1e8,
            1e9,
            f32::INFINITY,
            f32::NEG_INFINITY,
            f32::NAN,
        ];
        for (name, f, exact, rare) in cases {
            let (mut off, mut count) = (0, 0);
            let mut check = |v: f32| {
                let (got, want) = (f(Wide::splat(v)).0[3], exact(v.into()));
                let d = steps(got, want as f32);
                assert!(d <= 1, "{name}({v}) is {got} and not {want}");
                off += d;
                count += 1;
            };
            awkward.into_iter().for_each(&mut check);
            let mut rng = fastrand::Rng::with_seed(1);
            for _ in 0..300_000 {
                // Half of the numbers have any bits; the other half are numbers
                // that occur.
                check(f32::from_bits(rng.u32(..)));
                check(64.0 * rng.f32() - 32.0);
            }
            assert!(rare * off < count, "{name}: {off} of {count}");
        }
    }
}
