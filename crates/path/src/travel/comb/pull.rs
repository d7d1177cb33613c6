//! Pulls ways tight: from each point straight to the farthest one in sight.

use super::{Comb, Stop};

impl Comb<'_> {
    /// The way without avoidable detours: from each point straight to the
    /// farthest point that it sees. None if a point does not see the next one.
    pub(super) fn pulled(&self, way: &[Stop]) -> Option<Vec<Stop>> {
        let mut out = vec![*way.first()?];
        let mut i = 0;
        while i + 1 < way.len() {
            // The strides double, then halve.
            let mut seen = i;
            let mut stride = 1;
            let mut unseen = way.len();
            while i + stride < way.len() {
                if self.sees(way[i], way[i + stride]) {
                    seen = i + stride;
                    stride *= 2;
                } else {
                    unseen = i + stride;
                    break;
                }
            }
            if seen > i && unseen == way.len() {
                // The end is nearer than the next stride.
                if self.sees(way[i], way[way.len() - 1]) {
                    seen = way.len() - 1;
                }
            }
            while unseen > seen + 1 {
                let middle = seen + (unseen - seen) / 2;
                if self.sees(way[i], way[middle]) {
                    seen = middle
                } else {
                    unseen = middle
                }
            }
            if seen == i && self.passes(way[i], way[i + 1]) {
                seen = i + 1;
            }
            if seen == i {
                return None;
            }
            out.push(way[seen]);
            i = seen;
        }
        Some(out)
    }

    /// The way with points added where a point does not see the next one: down
    /// to the outline, along it, and up again. None if that does not help.
    pub(super) fn joined(&self, way: &[Stop]) -> Option<Vec<Stop>> {
        /// Halvings of the distance from the outline.
        const TRIALS: usize = 9;
        let mut out = vec![*way.first()?];
        for pair in way.windows(2) {
            let (mut low, mut high) = (vec![pair[0]], vec![pair[1]]);
            loop {
                let (a, b) = (low[low.len() - 1], high[high.len() - 1]);
                if self.passes(a, b) {
                    break;
                }
                if low.len() > TRIALS {
                    return None;
                }
                low.push(self.stop_near(a));
                high.push(self.stop_near(b));
            }
            out.extend(&low[1..]);
            out.extend(high.iter().rev());
        }
        Some(out)
    }

    /// A stop half as far from the outline.
    fn stop_near(&self, stop: Stop) -> Stop {
        Stop {
            base: stop.base,
            ..self.stop(0.5 * (stop.at + stop.base))
        }
    }

    /// The way, turned round, with a point in the middle of each line.
    pub(super) fn denser(&self, way: &[Stop]) -> Vec<Stop> {
        let mut out = Vec::with_capacity(2 * way.len());
        for pair in way.windows(2) {
            out.push(pair[0]);
            out.push(self.stop(0.5 * (pair[0].at + pair[1].at)));
        }
        out.extend(way.last());
        out.reverse();
        out
    }
}
