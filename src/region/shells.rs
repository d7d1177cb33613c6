//! How many layers a shell of a thickness has.
//!
//! Where layers are alike, or their number is set, the number is the same
//! everywhere. Otherwise it is what fits into the thickness, layer by layer.

use crate::layers::LayerSpan;
use crate::units::Mm;

/// Layers of the shells on one side.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Shells {
    /// This many layers, everywhere.
    Alike(usize),
    /// For each layer, this many layers from it on, counting itself.
    Each(Vec<usize>),
}

impl Shells {
    /// The layers that fit into `thickness`, from each layer upwards (or else
    /// downwards); 1 at least, unless the thickness is 0.
    pub(super) fn of_thickness(
        spans: &[LayerSpan],
        thickness: Mm,
        upwards: bool,
    ) -> Shells {
        // A share of a layer so small counts as nothing, as it does where all
        // layers have one height.
        const SLACK: f64 = 1e-4;
        if thickness <= 0.0 {
            return Shells::Alike(0);
        }
        let fit = |i: usize| {
            let all = &spans[i];
            let within = thickness + SLACK * all.height();
            let others: &mut dyn Iterator<Item = &LayerSpan> = if upwards {
                &mut spans[i..].iter()
            } else {
                &mut spans[..=i].iter().rev()
            };
            let fits = |other: &&LayerSpan| {
                if upwards {
                    other.top - all.bottom <= within
                } else {
                    all.top - other.bottom <= within
                }
            };
            others.take_while(fits).count().max(1)
        };
        Shells::Each((0..spans.len()).map(fit).collect())
    }

    /// The layers of a shell from a layer on.
    pub(super) fn at(&self, number: usize) -> usize {
        match self {
            Shells::Alike(count) => *count,
            Shells::Each(counts) => counts.get(number).copied().unwrap_or(1),
        }
    }

    /// The greatest number of layers.
    pub(super) fn most(&self) -> usize {
        match self {
            Shells::Alike(count) => *count,
            Shells::Each(counts) => counts.iter().copied().max().unwrap_or(0),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn spans(heights: &[Mm]) -> Vec<LayerSpan> {
        let mut top = 0.0;
        let spans = heights.iter().enumerate().map(|(index, height)| {
            let bottom = top;
            top += height;
            LayerSpan { index, bottom, top }
        });
        spans.collect()
    }

    #[test]
    fn layers_of_one_height_are_counted_as_ever() {
        let alike = Shells::of_thickness(&spans(&[0.2; 20]), 0.8, true);
        assert_eq!(alike.at(0), 4);
        assert_eq!(alike.at(16), 4);
        // The part ends: all layers left are in the shell.
        assert_eq!(alike.at(18), 2);
    }

    #[test]
    fn thin_layers_make_shells_of_more_of_them() {
        let mut heights = vec![0.3; 10];
        heights.extend([0.1; 10]);
        let spans = spans(&heights);
        let up = Shells::of_thickness(&spans, 0.8, true);
        assert_eq!([0, 8, 9, 10].map(|i| up.at(i)), [2, 4, 6, 8]);
        let down = Shells::of_thickness(&spans, 0.8, false);
        assert_eq!([9, 10, 19].map(|i| down.at(i)), [2, 3, 8]);
        assert_eq!(up.most(), 8);
        let thick = Shells::of_thickness(&spans, 0.05, true);
        assert_eq!(thick.at(0), 1);
        assert_eq!(Shells::of_thickness(&spans, 0.0, true).most(), 0);
    }
}
