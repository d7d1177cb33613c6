//! How far beads reach beyond the layer below.
//!
//! ```text
//!          ├─ width ─┤
//!          ╭─────────╮
//!          ╰─────────╯
//!   ▒▒▒▒▒▒▒▒▒▒├ air ─┤     here 70 % of the width lie over nothing
//! ```
//!
//! In: the solid of the layer below, and where supports stand under a layer.
//! Out: for each place of a bead the share of its width that lies over nothing,
//! measured straight across the bead. What lies over a support is held, but
//! with a gap below it, and counts as [`OVER_SUPPORT`].

use glam::DVec2;
use isoslice_planar::grid::EdgeGrid;

/// Weight of a reach over a support, where a reach over nothing has 1.
const OVER_SUPPORT: f64 = 0.5;

/// The areas that hold the beads of a layer.
#[derive(Clone, Copy)]
pub struct Reach<'a> {
    below: &'a EdgeGrid,
    support: Option<&'a EdgeGrid>,
}

impl<'a> Reach<'a> {
    /// The areas that hold a layer on the solid `below`, with the supports
    /// under it.
    pub fn new(
        below: &'a EdgeGrid,
        support: Option<&'a EdgeGrid>,
    ) -> Reach<'a> {
        Reach { below, support }
    }

    /// The share of a line from `a` to `b` that lies over nothing.
    pub fn share(&self, a: DVec2, b: DVec2) -> f64 {
        let mut cuts = self.below.crossings(a, b);
        let over = self.support.map(|s| s.crossings(a, b));
        cuts.extend(over.into_iter().flatten());
        cuts.push(1.0);
        cuts.sort_by(f64::total_cmp);
        let (mut from, mut sum) = (0.0, 0.0);
        for to in cuts {
            if to > from {
                let middle = a.lerp(b, 0.5 * (from + to));
                sum += (to - from) * self.counts(middle);
                from = to;
            }
        }
        sum
    }

    /// How far a place counts as lying on nothing: 0 on the solid, 1 in the
    /// air.
    fn counts(&self, p: DVec2) -> f64 {
        if self.below.contains(p) {
            return 0.0;
        }
        if self.support.is_some_and(|s| s.contains(p)) {
            OVER_SUPPORT
        } else {
            1.0
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use isoslice_planar::Area;
    use isoslice_planar::shapes::rect_ring;

    #[test]
    fn shares_are_measured_across() {
        let grid = |rings| EdgeGrid::new(&Area { rings }, 1.0);
        let below = grid(vec![
            rect_ring(0.0, 0.0, 10.0, 10.0),
            rect_ring(20.0, 0.0, 20.1, 10.0),
        ]);
        let under = grid(vec![rect_ring(10.2, 0.0, 15.0, 10.0)]);
        let alone = Reach::new(&below, None);
        let held = Reach::new(&below, Some(&under));
        let at = |reach: Reach<'_>, x: f64| {
            reach.share(DVec2::new(x - 0.2, 5.0), DVec2::new(x + 0.2, 5.0))
        };
        for (x, over_air, over_support) in [
            (5.0, 0.0, 0.0),
            (9.8, 0.0, 0.0),
            (9.9, 0.25, 0.25),
            (10.0, 0.5, 0.5),
            // 0.3 mm lie beyond the edge, 0.1 mm of them on the support.
            (10.1, 0.75, 0.625),
            (10.4, 1.0, 0.5),
            (16.0, 1.0, 1.0),
            // A strip thinner than the bead holds its middle.
            (20.05, 0.75, 0.75),
        ] {
            assert!((at(alone, x) - over_air).abs() < 1e-9, "{x}");
            assert!((at(held, x) - over_support).abs() < 1e-9, "{x}");
        }
    }
}
