//! The greatest layer height that is allowed at each height.
//!
//! The limit is a polyline over the height, no steeper than [`SLOPE`]. So
//! neighbouring layers differ little.

use isoslice_base::units::Mm;

/// Greatest change of the limit, per length of height. Neighbouring layers
/// between two level faces differ by that share at most.
pub(super) const SLOPE: f64 = 0.25;

/// Limits at heights of equal distances. Below the lowest and above the highest
/// of these heights the limit is constant.
#[derive(Clone, Debug)]
pub(super) struct Limit {
    bottom: Mm,
    step: Mm,
    at: Vec<Mm>,
}

impl Limit {
    /// A limit from limits in bins of the height `step`, the first of which
    /// begins at `bottom`.
    pub(super) fn new(bottom: Mm, step: Mm, bins: &[Mm]) -> Limit {
        let of = |i: usize| bins.get(i).copied().unwrap_or(Mm::INFINITY);
        let at = (0..=bins.len())
            .map(|i| of(i).min(of(i.wrapping_sub(1))))
            .collect();
        let mut limit = Limit { bottom, step, at };
        limit.smooth();
        limit
    }

    /// Lowers the limit until it is nowhere too steep.
    fn smooth(&mut self) {
        let rise = SLOPE * self.step;
        for i in 1..self.at.len() {
            self.at[i] = self.at[i].min(self.at[i - 1] + rise);
        }
        for i in (1..self.at.len()).rev() {
            self.at[i - 1] = self.at[i - 1].min(self.at[i] + rise);
        }
    }

    /// Multiplies the limit within each span by the span's share, and lowers it
    /// around until it is nowhere too steep.
    pub(super) fn lower(&mut self, spans: &[(Mm, Mm, f64)]) {
        let last = self.at.len() - 1;
        let shares = spans.iter().map(|&(lo, hi, share)| {
            let from = ((lo - self.bottom) / self.step).max(0.0) as usize;
            let to = ((hi - self.bottom) / self.step).max(0.0).ceil() as usize;
            (from.min(last)..to.min(last) + 1, share)
        });
        let mut lowered = self.at.clone();
        for (nodes, share) in shares {
            for i in nodes {
                lowered[i] = lowered[i].min(share * self.at[i]);
            }
        }
        self.at = lowered;
        self.smooth();
    }

    /// The limit at a height.
    fn value(&self, z: Mm) -> Mm {
        let place = ((z - self.bottom) / self.step).max(0.0);
        let last = self.at.len() - 1;
        let i = (place as usize).min(last);
        let next = self.at[(i + 1).min(last)];
        let t = (place - i as f64).clamp(0.0, 1.0);
        self.at[i] + t * (next - self.at[i])
    }

    /// Where a layer ends that begins at `z` and is as high as `share` of the
    /// least limit within it.
    pub(super) fn end(&self, z: Mm, share: f64) -> Mm {
        let mut least = self.value(z);
        let (mut from, mut at_from) = (z, least);
        let place = ((z - self.bottom) / self.step).max(0.0);
        let mut node = place as usize + 1;
        while node < self.at.len() {
            let to = self.bottom + node as f64 * self.step;
            let at_to = self.at[node];
            if to > from {
                if to - z > share * least.min(at_to) {
                    return z + self.within(
                        (from - z, at_from),
                        (to - z, at_to),
                        least,
                        share,
                    );
                }
                least = least.min(at_to);
                (from, at_from) = (to, at_to);
            }
            node += 1;
        }
        z + share * least
    }

    /// Height of a layer that ends between two nodes.
    fn within(
        &self,
        (from, at_from): (Mm, Mm),
        (to, at_to): (Mm, Mm),
        least: Mm,
        share: f64,
    ) -> Mm {
        let flat = share * least;
        let slope = (at_to - at_from) / (to - from);
        if slope >= 0.0 {
            return flat;
        }
        // h = share · (at_from + slope · (h − from))
        let falling = share * (at_from - slope * from) / (1.0 - share * slope);
        flat.min(falling).clamp(from.min(flat), to)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn layers_are_as_high_as_the_least_limit_in_them() {
        let bins: Vec<Mm> = (0..400)
            .map(|i| 0.1 + 0.15 * (0.5 + 0.5 * (0.09 * f64::from(i)).sin()))
            .collect();
        let limit = Limit::new(1.0, 0.01, &bins);
        let mut z = 1.0;
        while z < 4.5 {
            for share in [1.0, 0.7] {
                let end = limit.end(z, share);
                let least = (0..=1000)
                    .map(|k| limit.value(z + (end - z) * f64::from(k) / 1e3))
                    .fold(Mm::INFINITY, Mm::min);
                let h = end - z;
                assert!((h - share * least).abs() < 1e-6, "{z} {h} {least}");
            }
            z += 0.0037;
        }
    }

    #[test]
    fn neighbours_differ_by_the_slope_at_most() {
        let bins: Vec<Mm> = (0..300)
            .map(|i| if i / 60 % 2 == 0 { 0.3 } else { 0.08 })
            .collect();
        let limit = Limit::new(0.0, 0.01, &bins);
        let (mut z, mut last): (Mm, Mm) = (0.0, 0.0);
        while z < 3.0 {
            let h = limit.end(z, 1.0) - z;
            if last > 0.0 {
                let ratio = h.max(last) / h.min(last);
                assert!(ratio <= 1.0 + SLOPE + 1e-9, "{ratio} at {z}");
            }
            (z, last) = (z + h, h);
        }
    }
}
