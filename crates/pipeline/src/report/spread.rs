//! The distribution of a measured quantity, in little memory.
//!
//! In: values in micrometres. Out: their mean, extremes and quantiles. Values
//! are counted in bins 2 % wide, so quantiles are right to 2 % or 0.01 µm; mean
//! and extremes are exact.

use super::tidy;
use serde::Serialize;
use std::collections::BTreeMap;

/// Size below which values share one bin, µm.
const LEAST: f64 = 0.01;
/// Ratio of the ends of a bin.
const RATIO: f64 = 1.02;

/// Signed values and the quantiles of their size.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Spread {
    count: u64,
    sum: f64,
    least: f64,
    greatest: f64,
    /// Counts of sizes, by number of the bin.
    bins: BTreeMap<u16, u64>,
}

/// A [`Spread`] as the report writes it, µm. `min`, `mean` and `max` are
/// signed; `p50`, `p95` and `p99` are quantiles of the size.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Figures {
    /// Number of values.
    pub points: u64,
    /// Least value.
    pub min: f64,
    /// Mean of the values.
    pub mean: f64,
    /// Size that half of the values do not exceed.
    pub p50: f64,
    /// Size that 95 % of the values do not exceed.
    pub p95: f64,
    /// Size that 99 % of the values do not exceed.
    pub p99: f64,
    /// Greatest value.
    pub max: f64,
}

impl Spread {
    /// Counts a value; NaN is left out.
    pub(crate) fn add(&mut self, value: f64) {
        if !value.is_finite() {
            return;
        }
        self.count_in(1, value, [value; 2]);
        // A cast of a number out of range gives the nearest one within it.
        let bin = (value.abs() / LEAST).ln() / RATIO.ln();
        *self.bins.entry(bin.ceil().max(0.0) as u16).or_default() += 1;
    }

    /// Adds the values that another spread has counted.
    pub(crate) fn merge(&mut self, other: &Spread) {
        if other.count == 0 {
            return;
        }
        let ends = [other.least, other.greatest];
        self.count_in(other.count, other.sum, ends);
        for (bin, count) in &other.bins {
            *self.bins.entry(*bin).or_default() += count;
        }
    }

    /// Adds values to all but the bins. `ends` are the least and the greatest.
    fn count_in(&mut self, count: u64, sum: f64, ends: [f64; 2]) {
        let [least, greatest] = ends;
        if self.count == 0 {
            [self.least, self.greatest] = ends;
        }
        self.least = self.least.min(least);
        self.greatest = self.greatest.max(greatest);
        self.count += count;
        self.sum += sum;
    }

    /// The greatest size, 0 if there is none.
    pub(crate) fn worst(&self) -> f64 {
        self.greatest.abs().max(self.least.abs())
    }

    /// The size that the share `q` of the values does not exceed.
    fn quantile(&self, q: f64) -> f64 {
        let goal = (q * self.count as f64).ceil() as u64;
        let mut seen = 0;
        for (bin, count) in &self.bins {
            seen += count;
            if seen >= goal {
                let size = LEAST * RATIO.powi(i32::from(*bin));
                return size.min(self.worst());
            }
        }
        self.worst()
    }

    /// The figures for the report, if there are any values.
    pub(crate) fn figures(&self) -> Option<Figures> {
        (self.count > 0).then(|| Figures {
            points: self.count,
            min: tidy(self.least, 3),
            mean: tidy(self.sum / self.count as f64, 3),
            p50: tidy(self.quantile(0.5), 3),
            p95: tidy(self.quantile(0.95), 3),
            p99: tidy(self.quantile(0.99), 3),
            max: tidy(self.greatest, 3),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_good_to_two_per_cent() {
        let (mut even, mut odd) = (Spread::default(), Spread::default());
        for i in 1..=1000 {
            let sign = if i % 3 == 0 { -1.0 } else { 1.0 };
            let half = if i % 2 == 0 { &mut even } else { &mut odd };
            half.add(sign * f64::from(i));
        }
        odd.add(f64::NAN);
        even.merge(&odd);
        let f = even.figures().unwrap();
        assert_eq!((f.points, f.min, f.max), (1000, -999.0, 1000.0));
        for (got, want) in [(f.p50, 500.0), (f.p95, 950.0), (f.p99, 990.0)] {
            assert!((got / want - 1.0).abs() < 0.02, "{got} for {want}");
        }
        // Σ i − 2·Σ of the multiples of three, by 1000.
        assert_eq!(f.mean, 166.834);
        assert_eq!(Spread::default().figures(), None);
    }

    #[test]
    fn nothing_is_nothing_and_beyond_measure_is_the_last_bin() {
        let mut s = Spread::default();
        s.add(0.0);
        let f = s.figures().unwrap();
        assert_eq!((f.p50, f.max), (0.0, 0.0));
        s.add(-1e30);
        assert_eq!(s.figures().unwrap().min, -1e30);
        assert_eq!(s.worst(), 1e30);
    }
}
