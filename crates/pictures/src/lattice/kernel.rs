//! Weights of the samples around a place, along one axis.

use super::border::{Border, floor};

/// How to go from sample to sample.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Interpolation {
    /// The value of the nearest sample. It jumps.
    Nearest,
    /// Straight from sample to sample along each axis: bilinear, trilinear.
    /// Never beyond the samples' values; with creases.
    #[default]
    Linear,
    /// Smoothly through all samples: Catmull–Rom splines along each axis
    /// (bicubic, tricubic). Beside steps it goes beyond the samples' values, by
    /// at most an eighth of the step for each axis.
    Cubic,
}

/// Does the same for each interpolation, with its number of samples as `$n`.
macro_rules! with_taps {
    ($how:expr, $n:ident, $known:ident => $body:expr) => {
        match $how {
            Interpolation::Nearest => {
                const $n: usize = 1;
                let $known = Interpolation::Nearest;
                $body
            }
            Interpolation::Linear => {
                const $n: usize = 2;
                let $known = Interpolation::Linear;
                $body
            }
            Interpolation::Cubic => {
                const $n: usize = 4;
                let $known = Interpolation::Cubic;
                $body
            }
        }
    };
}
pub(crate) use with_taps;

/// Weights of Catmull–Rom splines: the coefficients of 1, t, t² and t³ of each
/// of the four samples around t = 0..1.
const CUBIC: [[f64; 4]; 4] = [
    [0.0, -0.5, 1.0, -0.5],
    [1.0, 0.0, -2.5, 1.5],
    [0.0, 0.5, 2.0, -1.5],
    [0.0, 0.0, -0.5, 0.5],
];

/// Weights of straight lines: the coefficients of 1 and t.
const LINEAR: [[f64; 4]; 2] = [[1.0, -1.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0]];

impl Interpolation {
    /// The polynomials that weigh the samples.
    fn weights(self) -> &'static [[f64; 4]] {
        match self {
            Interpolation::Nearest => &[[1.0, 0.0, 0.0, 0.0]],
            Interpolation::Linear => &LINEAR,
            Interpolation::Cubic => &CUBIC,
        }
    }

    /// The samples before and after the one at or before a place that count.
    pub(crate) fn reach(self) -> [i64; 2] {
        match self {
            Interpolation::Nearest => [0, 0],
            Interpolation::Linear => [0, 1],
            Interpolation::Cubic => [-1, 2],
        }
    }

    /// The sum of the negative weights at most, of values and of differences,
    /// in `axes` axes. Σ|w| is 5/4 for values and 3/2 for differences, both at
    /// the middle between two samples.
    pub(crate) fn overshoot(self, axes: i32) -> [f64; 2] {
        if self != Interpolation::Cubic || axes == 0 {
            return [0.0; 2];
        }
        let all = 1.25_f64.powi(axes);
        [0.5 * (all - 1.0), 0.5 * (all * 1.2 - 1.0)]
    }
}

/// Samples along one axis with their weights. `N` is how many an interpolation
/// weighs, known where the code is made: a picture is asked many million times.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Taps<const N: usize> {
    /// How many there are: `N`, or 1 on an axis of one sample.
    pub(crate) n: usize,
    /// The numbers of the samples.
    pub(crate) sample: [usize; N],
    /// Their weights.
    pub(crate) weight: [f64; N],
    /// The derivatives of the weights.
    pub(crate) slope: [f64; N],
}

impl<const N: usize> Taps<N> {
    /// The samples around the coordinate `u` on an axis of `n` samples.
    #[inline(always)]
    pub(crate) fn new(
        how: Interpolation,
        border: Border,
        u: f64,
        n: usize,
    ) -> Taps<N> {
        let mut taps = Taps {
            n: 1,
            sample: [0; N],
            weight: [0.0; N],
            slope: [0.0; N],
        };
        if n == 1 {
            taps.weight[0] = 1.0;
            return taps;
        }
        let u = border.near(u, n);
        let (cell, t) = if how == Interpolation::Nearest {
            (floor(u + 0.5), 0.0)
        } else {
            let cell = floor(u);
            (cell, u - cell as f64)
        };
        let first = cell + how.reach()[0];
        taps.n = N;
        for (k, [a, b, c, d]) in how.weights().iter().take(N).enumerate() {
            taps.sample[k] = border.sample(first + k as i64, n);
            taps.weight[k] = a + t * (b + t * (c + t * d));
            taps.slope[k] = b + t * (2.0 * c + t * (3.0 * d));
        }
        taps
    }
}

/// The weights of a stretch of a cell as Bézier points: no value in the stretch
/// is beyond them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stretched {
    /// For each Bézier point the weights of the samples.
    pub(crate) value: [[f64; 4]; 4],
    /// The same of the derivative, which has one point less.
    pub(crate) slope: [[f64; 4]; 3],
}

impl Stretched {
    /// Of the stretch from `a` to `b` of a cell.
    pub(crate) fn new(how: Interpolation, a: f64, b: f64) -> Stretched {
        let mut all = Stretched {
            value: [[0.0; 4]; 4],
            slope: [[0.0; 4]; 3],
        };
        for (k, [c0, c1, c2, c3]) in how.weights().iter().enumerate() {
            let ends = [[a, a, a], [a, a, b], [a, b, b], [b, b, b]];
            for (point, [u, v, w]) in all.value.iter_mut().zip(ends) {
                point[k] = c0
                    + c1 * (u + v + w) / 3.0
                    + c2 * (u * v + v * w + w * u) / 3.0
                    + c3 * u * v * w;
            }
            let ends = [[a, a], [a, b], [b, b]];
            for (point, [u, v]) in all.slope.iter_mut().zip(ends) {
                point[k] = c1 + c2 * (u + v) + 3.0 * c3 * u * v;
            }
        }
        all
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_sum_to_one_and_negative_ones_are_bounded() {
        for i in 0..=1000 {
            let u = 5.0 + f64::from(i) / 1000.0;
            let taps =
                Taps::<4>::new(Interpolation::Cubic, Border::Clamp, u, 99);
            let sum: f64 = taps.weight.iter().sum();
            assert!((sum - 1.0).abs() < 1e-15);
            let below: f64 = taps.weight.iter().map(|w| w.min(0.0)).sum();
            let [most, steps] = Interpolation::Cubic.overshoot(1);
            assert!(-below <= most + 1e-15, "{u}");
            // The slope as a sum of differences.
            let [a, _, c, d] = taps.slope;
            let weights = [-a, c + d, d];
            assert!((weights.iter().sum::<f64>() - 1.0).abs() < 1e-15);
            let below: f64 = weights.iter().map(|w| w.min(0.0)).sum();
            assert!(-below <= steps + 1e-15, "{u} {below}");
        }
    }
}
