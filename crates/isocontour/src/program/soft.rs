//! Narrower slopes of two operations, for callers that ask for them.
//!
//! Soft unions may be logarithms of sums of powers of e. The slope of
//! ln(exp(a₁) + exp(a₂) + …) is a mean of the slopes of a₁, a₂, …, weighted by
//! the powers. Operation by operation the weights would be independent ranges,
//! and need not add up to 1. So the slope is made of one term's slope, and of
//! the other terms' differences from it, times their weights.

use super::slot::Slot;
use super::{Program, Step};
use crate::interval::Interval;
use crate::number::{Component, Number};
use fidget::context::{BinaryOpcode, UnaryOpcode};

impl Program {
    /// The slope of the logarithm of a step, if the step is a sum of powers of
    /// e.
    pub(super) fn soft_slope(
        &self,
        of: u32,
        s: &[Slot],
    ) -> Option<[Interval; 3]> {
        /// Greatest number of terms. Each is compared with the highest one, and
        /// soft minima of more parts are rare.
        const MOST_TERMS: usize = 16;
        let mut terms: Vec<(u32, Interval)> = Vec::new();
        let mut todo = vec![of];
        while let Some(step) = todo.pop() {
            match self.steps[step as usize] {
                Step::Binary(BinaryOpcode::Add, a, b) => todo.extend([a, b]),
                Step::Unary(UnaryOpcode::Exp, a) => {
                    let range = s[a as usize].range;
                    if range.nan || !range.is_finite() {
                        return None;
                    }
                    terms.push((a, range));
                }
                _ => return None,
            }
            if terms.len() + todo.len() > MOST_TERMS {
                return None;
            }
        }
        // Powers of differences do not overflow.
        let highest = terms.iter().map(|t| t.1.hi).fold(f64::MIN, f64::max);
        let powers: Vec<[f64; 2]> = terms
            .iter()
            .map(|(_, r)| [(r.lo - highest).exp(), (r.hi - highest).exp()])
            .collect();
        let all = |end: usize| powers.iter().map(|p| p[end]).sum::<f64>();
        let (low, high) = (all(0), all(1));
        let main = (0..terms.len())
            .max_by(|&a, &b| powers[a][0].total_cmp(&powers[b][0]))?;
        let slope_of = |k: usize| s[terms[k].0 as usize].slope;
        let mut slope = slope_of(main);
        for (k, [lo, hi]) in powers.iter().enumerate() {
            if k == main {
                continue;
            }
            // The weight e / (e + others) grows with e and falls with the
            // others.
            let most = hi / (hi + (low - lo).max(0.0));
            let least = lo / (lo + (high - hi).max(0.0));
            if most.is_nan() || least.is_nan() {
                return None;
            }
            let weight = Interval::new(least, most.max(least));
            for (sum, (own, first)) in slope
                .iter_mut()
                .zip(slope_of(k).into_iter().zip(slope_of(main)))
            {
                *sum = sum.add(weight.mul(own.sub(first)));
            }
        }
        Some(slope)
    }
}

/// The slope of atan2(y, x) where y is nowhere less than 0, as |v| is. The
/// angle does not jump there, although y may be 0 where x is less than 0.
pub(super) fn turn(y: &Slot, x: &Slot) -> [Interval; 3] {
    let by = Number::recip(y.range.square().add(x.range.square()));
    [0, 1, 2].map(|i| {
        let along = y.slope[i].along(x.range);
        along.sub(x.slope[i].along(y.range)).along(by)
    })
}

/// What two ranges of one value have in common.
pub(super) fn common(a: Interval, b: Interval) -> Interval {
    if a.nan || a.is_empty() {
        return b;
    }
    let (lo, hi) = (a.lo.max(b.lo), a.hi.min(b.hi));
    // The two ranges miss each other only by rounding.
    if !b.nan && lo <= hi {
        Interval::new(lo, hi)
    } else {
        a
    }
}
