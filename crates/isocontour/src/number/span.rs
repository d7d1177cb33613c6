//! Ranges of values over eight boxes at a time.
//!
//! Interval arithmetic for eight boxes in step, in vector instructions. Where
//! the result may be NaN, or depends on cases, a box drops out: its ends become
//! NaN, and it has to be evaluated on its own, as an [`Interval`]. Few boxes
//! drop out.

use super::Number;
use super::wide::{self, Turn};
use crate::interval::Interval;
use std::f64::consts::{FRAC_PI_2, TAU};

/// Boxes in a [`Span`].
pub(crate) const BOXES: usize = 8;

/// Greatest errors of exp and ln, as a share of the result, and of sin.
const FUNCTION_ERROR: f64 = 2e-9;

type Ends = [f64; BOXES];

/// Some ranges. Both ends of a range are NaN if it is unknown.
#[derive(Clone, Copy, Debug)]
#[repr(align(32))]
pub(crate) struct Span {
    lo: Ends,
    hi: Ends,
}

#[inline(always)]
fn map(mut a: Ends, f: impl Fn(f64) -> f64) -> Ends {
    for v in &mut a {
        *v = f(*v);
    }
    a
}

#[inline(always)]
fn zip(mut a: Ends, b: Ends, f: impl Fn(f64, f64) -> f64) -> Ends {
    for (v, w) in a.iter_mut().zip(b) {
        *v = f(*v, w);
    }
    a
}

/// The lesser number; NaN if both are NaN.
#[inline(always)]
fn least(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

/// The greater number; NaN if both are NaN.
#[inline(always)]
fn most(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

impl Span {
    /// Unknown ranges.
    pub(crate) const UNKNOWN: Span = Span {
        lo: [f64::NAN; BOXES],
        hi: [f64::NAN; BOXES],
    };

    /// Sets the range of one box.
    #[inline(always)]
    pub(crate) fn set(&mut self, k: usize, range: Interval) {
        let known = !range.nan;
        self.lo[k] = if known { range.lo } else { f64::NAN };
        self.hi[k] = if known { range.hi } else { f64::NAN };
    }

    /// The range of one box, if it is known.
    pub(crate) fn get(&self, k: usize) -> Option<Interval> {
        let (lo, hi) = (self.lo[k], self.hi[k]);
        (lo <= hi).then_some(Interval::new(lo, hi))
    }

    /// The ranges, with both ends NaN where one end is.
    #[inline(always)]
    fn sane(lo: Ends, hi: Ends) -> Span {
        let mut out = Span { lo, hi };
        for k in 0..BOXES {
            let known = lo[k] <= hi[k];
            out.lo[k] = if known { lo[k] } else { f64::NAN };
            out.hi[k] = if known { hi[k] } else { f64::NAN };
        }
        out
    }

    /// The range of a function that rises, and whose values may be off by a
    /// share of themselves.
    #[inline(always)]
    fn rising(self, f: impl Fn(f64) -> f64) -> Span {
        let (lo, hi) = (map(self.lo, &f), map(self.hi, &f));
        Span::sane(
            map(lo, |v| v - FUNCTION_ERROR * v.abs()),
            map(hi, |v| v + FUNCTION_ERROR * v.abs()),
        )
    }

    /// The ranges that a function of intervals gives, box by box.
    #[inline(always)]
    fn each(self, o: Span, f: impl Fn(Interval, Interval) -> Interval) -> Span {
        let mut out = Span::UNKNOWN;
        for k in 0..BOXES {
            if self.lo[k] <= self.hi[k] && o.lo[k] <= o.hi[k] {
                let a = Interval::new(self.lo[k], self.hi[k]);
                let b = Interval::new(o.lo[k], o.hi[k]);
                out.set(k, f(a, b));
            }
        }
        out
    }
}

// Functions that rise in steps.
macro_rules! stepped {
    ($($name:ident)*) => {
        $(#[inline(always)]
        fn $name(self) -> Self {
            Span {
                lo: map(self.lo, f64::$name),
                hi: map(self.hi, f64::$name),
            }
        })*
    };
}

// Functions that are left to intervals, box by box.
macro_rules! box_by_box {
    ($($name:ident)*) => {
        $(#[inline(always)]
        fn $name(self) -> Self {
            self.each(self, |a, _| a.$name())
        })*
    };
    ($($name:ident($o:ident))*) => {
        $(#[inline(always)]
        fn $name(self, $o: Self) -> Self {
            self.each($o, Interval::$name)
        })*
    };
}

impl Number for Span {
    stepped!(floor ceil round);
    box_by_box!(tan asin acos atan not);
    box_by_box!(atan2(o) modulo(o) compare(o) and(o) or(o));

    #[inline(always)]
    fn splat(v: f32) -> Self {
        Span {
            lo: [v.into(); BOXES],
            hi: [v.into(); BOXES],
        }
    }
    #[inline(always)]
    fn neg(self) -> Self {
        Span {
            lo: map(self.hi, |v| -v),
            hi: map(self.lo, |v| -v),
        }
    }
    #[inline(always)]
    fn abs(self) -> Self {
        let inner = zip(self.lo, self.hi, |lo, hi| most(lo, -hi));
        Span {
            lo: map(inner, |v| most(0.0, v)),
            hi: zip(self.lo, self.hi, |lo, hi| most(lo.abs(), hi.abs())),
        }
    }
    #[inline(always)]
    fn recip(self) -> Self {
        let mut out = Span::UNKNOWN;
        for k in 0..BOXES {
            let (lo, hi) = (self.lo[k], self.hi[k]);
            let (a, b) = (1.0 / hi, 1.0 / lo);
            // Both ends have the same sign.
            let known = (lo > 0.0) | (hi < 0.0);
            out.lo[k] = if known { a } else { f64::NAN };
            out.hi[k] = if known { b } else { f64::NAN };
        }
        out
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        // Below zero the result is NaN.
        Span::sane(map(self.lo, f64::sqrt), map(self.hi, f64::sqrt))
    }
    #[inline(always)]
    fn square(self) -> Self {
        let a = self.abs();
        Span {
            lo: map(a.lo, |v| v * v),
            hi: map(a.hi, |v| v * v),
        }
    }
    #[inline(always)]
    fn sin(self) -> Self {
        let mut out = Span::UNKNOWN;
        for k in 0..BOXES {
            let (lo, hi) = (self.lo[k], self.hi[k]);
            let (a, b) = (Turn::of(lo).sin, Turn::of(hi).sin);
            // True if the range has a peak inside. Peaks are 2π apart.
            let reaches = |peak: f64| {
                let turns = ((lo - peak) / TAU).ceil();
                peak + turns * TAU <= hi
            };
            let top = if reaches(FRAC_PI_2) {
                1.0
            } else {
                most(a, b) + FUNCTION_ERROR
            };
            let low = if reaches(-FRAC_PI_2) {
                -1.0
            } else {
                least(a, b) - FUNCTION_ERROR
            };
            let known =
                (lo > -Turn::GREATEST_ANGLE) & (hi < Turn::GREATEST_ANGLE);
            out.lo[k] = if known { low } else { f64::NAN };
            out.hi[k] = if known { top } else { f64::NAN };
        }
        out
    }
    #[inline(always)]
    fn cos(self) -> Self {
        Span {
            lo: map(self.lo, |v| v + FRAC_PI_2),
            hi: map(self.hi, |v| v + FRAC_PI_2),
        }
        .sin()
    }
    #[inline(always)]
    fn exp(self) -> Self {
        // The result is unknown where the series does not hold.
        self.rising(|v| {
            if v.abs() < 700.0 {
                wide::exp(v)
            } else {
                f64::NAN
            }
        })
    }
    #[inline(always)]
    fn ln(self) -> Self {
        let normal = |v: f64| (v > 1e-300) & (v < 1e300);
        self.rising(|v| if normal(v) { wide::ln(v) } else { f64::NAN })
    }
    #[inline(always)]
    fn rand(self) -> Self {
        self.each(self, |_, _| Interval::new(0.0, 1.0))
    }
    #[inline(always)]
    fn add(self, o: Self) -> Self {
        Span::sane(
            zip(self.lo, o.lo, |a, b| a + b),
            zip(self.hi, o.hi, |a, b| a + b),
        )
    }
    #[inline(always)]
    fn sub(self, o: Self) -> Self {
        self.add(o.neg())
    }
    #[inline(always)]
    fn mul(self, o: Self) -> Self {
        let mut out = Span::UNKNOWN;
        for k in 0..BOXES {
            let (a, b) = (self.lo[k] * o.lo[k], self.lo[k] * o.hi[k]);
            let (c, d) = (self.hi[k] * o.lo[k], self.hi[k] * o.hi[k]);
            // Infinite ends may make a product that is NaN.
            let known = !((a + b) + (c + d)).is_nan();
            let lo = least(least(a, b), least(c, d));
            let hi = most(most(a, b), most(c, d));
            out.lo[k] = if known { lo } else { f64::NAN };
            out.hi[k] = if known { hi } else { f64::NAN };
        }
        out
    }
    #[inline(always)]
    fn scale(self, by: f32) -> Self {
        let by = f64::from(by);
        let (a, b) = (map(self.lo, |v| v * by), map(self.hi, |v| v * by));
        if by < 0.0 {
            Span::sane(b, a)
        } else {
            Span::sane(a, b)
        }
    }
    #[inline(always)]
    fn div(self, o: Self) -> Self {
        self.mul(o.recip())
    }
    #[inline(always)]
    fn mix(self, _: Self) -> Self {
        Span::UNKNOWN
    }
    #[inline(always)]
    fn min(self, o: Self) -> Self {
        // Where one operand is unknown, the result is unknown, too.
        let ends = |a: f64, b: f64| least(a, b) + 0.0 * (a + b);
        Span::sane(zip(self.lo, o.lo, ends), zip(self.hi, o.hi, ends))
    }
    #[inline(always)]
    fn max(self, o: Self) -> Self {
        let ends = |a: f64, b: f64| most(a, b) + 0.0 * (a + b);
        Span::sane(zip(self.lo, o.lo, ends), zip(self.hi, o.hi, ends))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::boxes::Boxes;
    use crate::field::lanes::Lanes;
    use crate::number::tests::everything;
    use fidget::context::Context;
    use fidget::eval::MathFunction;
    use fidget::vm::VmFunction;

    /// A box among others gets the range that it gets alone.
    #[test]
    fn ranges_are_those_of_the_boxes_on_their_own() {
        let mut rng = fastrand::Rng::with_seed(3);
        let mut random = || rng.f64();
        let mut known = 0;
        for tree in everything() {
            let mut ctx = Context::new();
            let root = ctx.import(&tree);
            let f = VmFunction::new(&ctx, &[root]).unwrap();
            let boxes: Vec<[Interval; 3]> = (0..75)
                .map(|_| {
                    let size = 3.0 * random() * random();
                    std::array::from_fn(|_| {
                        let lo = 8.0 * random() - 4.0;
                        Interval::new(lo, lo + size)
                    })
                })
                .collect();
            let mut found = Vec::new();
            let mut lanes = Lanes::default();
            let over = |slot: usize, k: usize| boxes[k][slot];
            lanes.ranges(&f, boxes.len(), &over, &mut found);
            assert_eq!(found.len(), boxes.len());
            // The two agree but for rounding.
            let same = |a: Interval, b: Interval| {
                let near = |a: f64, b: f64| {
                    a == b || (a - b).abs() < 1e-7 * (1.0 + a.abs())
                };
                !a.nan && !b.nan && near(a.lo, b.lo) && near(a.hi, b.hi)
            };
            for (k, b) in boxes.iter().enumerate() {
                let (alone, _) = Boxes::default().range(&f, &|slot| b[slot]);
                if let Some(found) = found[k] {
                    known += 1;
                    assert!(same(found, alone), "{found:?}, {alone:?}");
                }
            }
        }
        assert!(known > 300, "{known}");
    }
}
