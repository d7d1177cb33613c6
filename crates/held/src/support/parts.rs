//! The part that supports hold.

use super::heights::Heights;
use isoslice_planar::{Area, Rect};
use isoslice_settings::layers::LayerSpan;

/// A part's layers, from the bed.
#[derive(Clone, Copy, Debug)]
pub(super) struct Parts<'a> {
    /// The heights of the layers, and of supports in them.
    pub heights: &'a Heights,
    /// The outline of each layer.
    pub outlines: &'a [Area],
    /// The ends of each layer's outline that are too thin to be printed.
    pub ends: &'a [Area],
    /// The part at the middle of each layer of supports. That is the outline
    /// where supports have the heights of the layers.
    pub sections: &'a [Area],
    /// The bed, in the model's coordinates.
    pub bed: Rect,
}

impl<'a> Parts<'a> {
    /// Layers whose supports have the same heights, in the middle of a bed of
    /// 100 mm.
    #[cfg(test)]
    pub(super) fn in_layers(
        heights: &'a Heights,
        outlines: &'a [Area],
        ends: &'a [Area],
    ) -> Parts<'a> {
        Parts {
            heights,
            outlines,
            ends,
            sections: outlines,
            bed: isoslice_planar::rect(-50.0, -50.0, 50.0, 50.0).bounds(),
        }
    }

    /// The layers.
    pub(super) fn spans(self) -> &'a [LayerSpan] {
        self.heights.spans()
    }
}
