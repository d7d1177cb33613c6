//! The heights at which supports are printed.
//!
//! ```text
//!       part ┌────────   bottom(i)
//!            │  gap      support.z_gap, whatever the layer height
//!   ▒▒▒▒▒▒▒▒▒▒▒▒▒▒▒▒▒▒   top(j), at most the top of layer j
//! ────────────────────   top of layer j
//! ```
//!
//! In: the layers of the part, and `support.z_gap`. Out: for each layer, the
//! height to which its supports reach: `support.z_gap` below a face of the part.
//! Of all faces it is the highest one for which supports end at the layer's top
//! or lower, because travels only clear what is no higher than that top. Where
//! the supports of a layer would be very thin, the layer has none, and those of
//! the layer above it are thicker.
//!
//! Guaranteed: the heights rise with the layers, and supports lie on each
//! other without gaps. If `support.z_gap` is a number of whole layers, supports
//! have the heights of the layers.

use super::plan::SupportPlan;
use isoslice_base::units::Mm;
use isoslice_settings::layers::LayerSpan;
use std::ops::Range;

/// Heights closer than this differ by rounding only, mm.
const ROUNDED: Mm = 1e-6;
/// Supports in the first layer would be too thin below this share of the layer's
/// height: they become as high as the layer.
const FIRST: f64 = 0.6;
/// Supports in another layer would be too thin below this share of the layer's
/// height: the layer has none.
const LEAST: f64 = 0.4;
/// A gap below a support is as asked for if it is wider by no more than this, mm.
const SLOPPY: Mm = 0.02;
/// Greatest distance of a pad from the layer that it holds, mm, unless
/// `support.z_gap` is less: the layer sags by that much.
const SAG: Mm = 0.3;

/// The heights of a part's layers and of their supports.
#[derive(Clone, Debug, Default)]
pub struct Heights {
    spans: Vec<LayerSpan>,
    /// Top of the supports by layer: never above the layer's own top.
    tops: Vec<Mm>,
    /// Gap between the part and a support that stands on it.
    gap_bottom: Mm,
    /// Gap between a support and the part above it.
    gap_top: Mm,
    /// Greatest height of a bead of supports.
    most: Mm,
}

impl Heights {
    /// The heights for a part's layers, from the bed.
    pub fn new(spans: Vec<LayerSpan>, plan: &SupportPlan) -> Heights {
        let most = plan.highest_bead;
        let gap_top = plan.gap_top;
        let mut tops: Vec<Mm> = Vec::with_capacity(spans.len());
        let mut faces = spans.iter().map(|s| s.bottom - gap_top).peekable();
        let mut face = f64::NEG_INFINITY;
        for span in &spans {
            while let Some(next) =
                faces.next_if(|&next| next <= span.top + ROUNDED)
            {
                face = next;
            }
            let top = if (face - span.top).abs() <= ROUNDED {
                span.top
            } else {
                face
            };
            tops.push(match tops.last() {
                None if top < span.bottom + FIRST * span.height() => span.top,
                None => top,
                Some(&below) if top < below + LEAST * span.height() => below,
                // A layer of the part's own height is never too high.
                Some(&below) => top.min(below + most.max(span.height())),
            });
        }
        Heights {
            spans,
            tops,
            gap_bottom: plan.gap_bottom,
            gap_top,
            most,
        }
    }

    /// The layers of the part.
    pub fn spans(&self) -> &[LayerSpan] {
        &self.spans
    }

    /// Height at which supports in layer `j` begin.
    fn bottom(&self, j: usize) -> Mm {
        match j.checked_sub(1) {
            Some(below) => self.tops[below],
            None => self.spans[0].bottom,
        }
    }

    /// The bottom and the top of supports in layer `j`, with the layer's
    /// number; nothing if the layer has no supports.
    pub fn span(&self, j: usize) -> Option<LayerSpan> {
        let (layer, bottom) = (*self.spans.get(j)?, self.bottom(j));
        let span = LayerSpan {
            index: j,
            bottom,
            top: self.tops[j],
        };
        if span.top - bottom <= ROUNDED {
            return None;
        }
        let as_layer = (bottom - layer.bottom).abs() <= ROUNDED
            && (span.top - layer.top).abs() <= ROUNDED;
        Some(if as_layer { layer } else { span })
    }

    /// The bottom and the top of the supports of each layer. A layer without
    /// supports has its own bottom and top here.
    pub fn own(&self) -> impl Iterator<Item = LayerSpan> {
        let layers = self.spans.iter().enumerate();
        layers.map(|(j, &layer)| self.span(j).unwrap_or(layer))
    }

    /// The layer whose supports end `support.z_gap` below layer `i`. If none end
    /// there, it is the layer with the next lower end.
    pub fn below(&self, i: usize) -> Option<usize> {
        let highest = self.spans.get(i)?.bottom - self.gap_top + ROUNDED;
        let tops = &self.tops[..i];
        let j = tops.partition_point(|&top| top <= highest).checked_sub(1)?;
        // Of layers with equal tops only the lowest one has supports.
        let own = tops.partition_point(|&top| top < tops[j] - ROUNDED);
        Some(own)
    }

    /// The layers above the first that are so near to the bed that no supports end
    /// `support.z_gap` below them, and that supports in the first layer hold all
    /// the same.
    pub(super) fn low(&self) -> Range<usize> {
        let air = self.gap_top.min(SAG);
        let highest = self.tops.first().map_or(0.0, |top| top + air);
        let is_low = |span: &LayerSpan| span.bottom < highest - ROUNDED;
        1..self.spans.partition_point(is_low).max(1)
    }

    /// The layer of the part on which a support in layer `j` can stand: the
    /// highest one whose top is at least `support.z_gap_bottom` below that
    /// support, or the layer above it if thinner beads leave that gap more exactly.
    /// There is none right above the bed.
    pub fn stands_on(&self, j: usize) -> Option<usize> {
        self.in_gap(j).start.checked_sub(1)
    }

    /// The layers below layer `j` that are in the gap between a support in layer
    /// `j` and what it stands on, so that the part keeps away from the support.
    pub(super) fn in_gap(&self, j: usize) -> Range<usize> {
        let lowest = self.bottom(j) - self.gap_bottom + ROUNDED;
        let usual = self.spans[..j].partition_point(|span| span.top <= lowest);
        usual + usize::from(self.is_thinner(j, usual))..j
    }

    /// The layers below layer `j`, from the one on which a support in layer `j`
    /// stands. There are none if it cannot stand on the part.
    pub(super) fn gap_below(&self, j: usize) -> Range<usize> {
        self.stands_on(j).unwrap_or(j)..j
    }

    /// True if beads in layer `j` that stand on the layer of the part with the
    /// number `above` are thinner than others, and leave `support.z_gap_bottom`
    /// below them. On the layer below it, the highest beads would leave more.
    fn is_thinner(&self, j: usize, above: usize) -> bool {
        let Some(on) = above.checked_sub(1) else {
            return false;
        };
        let most = self.most.max(self.tops[j] - self.bottom(j));
        let height =
            |k: usize| self.tops[j] - self.gap_bottom - self.spans[k].top;
        above < j
            && height(on) > most + SLOPPY
            && self.spans[above].top <= self.bottom(j) + ROUNDED
            && height(above) >= LEAST * self.spans[j].height()
    }

    /// The layer of the part that is less than `support.z_gap_bottom` below usual
    /// beads in layer `j`, while those that stand on it are thinner.
    pub(super) fn stands_close(&self, j: usize) -> Option<usize> {
        self.stands_on(j).filter(|_| self.deeper(j) < 0.0)
    }

    /// By how much beads in layer `j` that stand on the part reach farther down
    /// than other beads, so that `support.z_gap_bottom` is left below them, or a
    /// little more if they would be too high. It is less than 0 if they reach less
    /// far down.
    pub(super) fn deeper(&self, j: usize) -> Mm {
        let Some(on) = self.stands_on(j) else {
            return 0.0;
        };
        let air = self.bottom(j) - self.gap_bottom - self.spans[on].top;
        let room = self.most - (self.tops[j] - self.bottom(j));
        let deeper = air.min(room.max(0.0));
        if deeper.abs() > ROUNDED { deeper } else { 0.0 }
    }

    /// The layers of the part that lie beside supports in layer `j`.
    pub(super) fn beside(&self, j: usize) -> Range<usize> {
        let (bottom, top) = (self.bottom(j), self.tops[j]);
        let from = |s: &LayerSpan| s.top <= bottom + ROUNDED;
        let to = |s: &LayerSpan| s.bottom < top - ROUNDED;
        let first = self.spans.partition_point(from);
        first.min(j)..self.spans.partition_point(to).max(j + 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use isoslice_settings::testing::plan_with;

    /// Layers of 0.2 mm on a first one of 0.3 mm, or of some heights.
    fn layers(heights: impl IntoIterator<Item = Mm>) -> Vec<LayerSpan> {
        let mut top = 0.0;
        let span = |(index, height)| {
            let bottom = top;
            top += height;
            LayerSpan { index, bottom, top }
        };
        heights.into_iter().enumerate().map(span).collect()
    }

    fn uniform() -> Vec<LayerSpan> {
        layers(std::iter::once(0.3).chain([0.2; 60]))
    }

    fn heights(spans: Vec<LayerSpan>, gap: Mm) -> Heights {
        let plan = plan_with(SupportPlan::of, |s| {
            s.support.z_gap = gap;
            s.support.z_gap_bottom = gap;
        });
        Heights::new(spans, &plan)
    }

    #[test]
    fn a_gap_of_whole_layers_leaves_supports_in_the_layers() {
        for gap in [0.0, 0.2, 0.4] {
            let heights = heights(uniform(), gap);
            for (j, layer) in heights.spans().iter().enumerate().skip(1) {
                if j + 3 < heights.spans().len() {
                    assert_eq!(heights.span(j).as_ref(), Some(layer), "{gap}");
                    assert_eq!(heights.deeper(j), 0.0);
                    assert_eq!(heights.beside(j), j..j + 1);
                }
            }
        }
    }

    #[test]
    fn every_gap_is_as_asked_for() {
        for gap in [0.05, 0.08, 0.13, 0.15, 0.19, 0.25, 0.28, 0.33, 0.57] {
            let heights = heights(uniform(), gap);
            let mut last = 0.0;
            for i in 10..60 {
                let j = heights.below(i).unwrap();
                let span = heights.span(j).unwrap();
                let air = heights.spans()[i].bottom - span.top;
                assert!((air - gap).abs() < 1e-9, "{gap}: {air} at {i}");
                assert!(span.top > last && span.top < heights.spans()[j].top);
                assert!((span.height() - 0.2).abs() < 1e-9);
                last = span.top;
                // Below a support that stands on the part as well.
                let on = heights.spans()[heights.stands_on(j).unwrap()];
                let below = span.bottom - heights.deeper(j) - on.top;
                assert!((below - gap).abs() < 1e-9, "{gap}: {below} under {j}");
            }
        }
    }

    #[test]
    fn thin_beads_stand_on_the_part_where_high_ones_would_be_too_high() {
        // Layers of 0.3 mm, in which beads are up to 0.4 mm high.
        let heights = heights(layers([0.3; 40]), 0.2);
        for j in 4..35 {
            let span = heights.span(j).unwrap();
            let on = heights.stands_on(j).unwrap();
            assert_eq!(heights.stands_close(j), Some(on));
            let bottom = span.bottom - heights.deeper(j);
            let air = bottom - heights.spans()[on].top;
            assert!((air - 0.2).abs() < 1e-9, "{air} under {j}");
            assert!((span.top - bottom - 0.2).abs() < 1e-9);
            // Layers above that one are beside the support.
            assert_eq!(heights.in_gap(j).start, on + 1);
            assert_eq!(heights.beside(j).start, on + 1);
        }
        // Beads of 0.3 mm, and deeper ones of up to 0.4 mm, leave the gap.
        for gap in [0.3, 0.25] {
            let heights = super::tests::heights(layers([0.3; 40]), gap);
            assert!(
                (0..40).all(|j| heights.stands_close(j).is_none()),
                "{gap}"
            );
        }
    }

    #[test]
    fn right_above_the_bed_nothing_stands_on_the_part() {
        let cases = [
            (0.2, 2, 1..2),
            (0.15, 3, 1..2),
            (0.5, 4, 1..2),
            (3.0, 16, 1..3),
        ];
        for (gap, from, low) in cases {
            let heights = heights(uniform(), gap);
            let stands = |j| heights.stands_on(j).is_some();
            let first = (0..20).find(|&j| stands(j));
            assert_eq!(first, Some(from), "{gap}");
            assert!((0..from).all(|j| heights.in_gap(j) == (0..j)));
            assert!((0..from).all(|j| heights.gap_below(j).is_empty()));
            assert_eq!(heights.low(), low, "{gap}");
            assert!(low.clone().all(|i| heights.below(i).is_none()));
        }
    }

    #[test]
    fn supports_lie_on_each_other_in_layers_of_any_height() {
        // Heights between 0.08 and 0.3 mm, without a pattern.
        let height = |k: u32| 0.08 + 0.22 * f64::from(k * k * 37 % 101) / 100.0;
        for gap in [0.1, 0.2, 0.27, 0.6] {
            let heights = heights(layers((0..200).map(height)), gap);
            let (mut at, mut exact) = (0.0, 0);
            for (j, layer) in heights.spans().iter().enumerate() {
                let Some(span) = heights.span(j) else {
                    continue;
                };
                assert!((span.bottom - at).abs() < 1e-9, "{gap}, layer {j}");
                assert!(span.top <= layer.top + 1e-9);
                assert!(span.height() < 0.41 && span.height() > 0.019);
                assert!(heights.beside(j).contains(&j));
                at = span.top;
            }
            for i in 10..200 {
                let j = heights.below(i).unwrap();
                let top = heights.span(j).unwrap().top;
                let air = heights.spans()[i].bottom - top;
                assert!(air > gap - 1e-6 && air < gap + 0.45, "{air}");
                exact += usize::from(air < gap + 1e-6);
            }
            assert!(exact > 95, "{gap}: {exact} of 190");
        }
    }

    #[test]
    fn the_first_layer_is_not_squeezed() {
        // 0.05 mm would be left of the first layer, and of the second.
        let heights = heights(layers([0.2; 20]), 0.15);
        let tops = |j| heights.span(j).map(|span| span.top);
        assert_eq!(tops(0), Some(0.2));
        assert!((tops(1).unwrap_or(0.25) - 0.25).abs() < 1e-9);
        assert!((tops(2).unwrap() - 0.45).abs() < 1e-9);
        assert_eq!(heights.below(1), None);
    }
}
