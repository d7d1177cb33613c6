//! A layer and the layers around it, as any stage sees them.

use isoslice_planar::{Area, Solid};
use isoslice_settings::layers::LayerSpan;
use std::sync::OnceLock;

/// What lies under the walls of what rises from a layer, once it was asked for.
/// All who ask have to have the same layer above, and the same plan of walls.
#[derive(Debug, Default)]
pub struct Risen(pub(crate) OnceLock<Area>);

/// A layer whose outline is known.
#[derive(Clone, Copy, Debug)]
pub struct LayerFace<'a> {
    /// Its number and its heights.
    pub span: LayerSpan,
    /// Its outline. Lines change their role right at its edge.
    pub outline: &'a Solid<'a>,
    /// Its outline, as exact as areas need it.
    pub rough: &'a Solid<'a>,
    /// What the layer above stands on.
    pub top: &'a Solid<'a>,
    /// Where what rises from the layer is kept, if more than one layer asks.
    pub risen: Option<&'a Risen>,
}

impl LayerFace<'_> {
    /// True if both layers share one outline, as equal ones do.
    pub fn is_like(&self, other: &LayerFace<'_>) -> bool {
        self.outline.is(other.outline)
    }
}

/// A layer and the layers around it, as far as they matter. More do no harm.
#[derive(Clone, Debug)]
pub struct LayerView<'a> {
    /// The layer.
    pub here: LayerFace<'a>,
    /// The layers above it, the nearest first.
    pub above: Vec<LayerFace<'a>>,
    /// The layers below it, the nearest first.
    pub below: Vec<LayerFace<'a>>,
}

#[cfg(test)]
impl<'a> LayerView<'a> {
    /// The layer of a number among layers that are all 0.2 mm high.
    pub(crate) fn of(
        number: usize,
        here: &'a Solid<'a>,
        above: &[&'a Solid<'a>],
        below: &[&'a Solid<'a>],
    ) -> LayerView<'a> {
        let face = |index: usize, solid: &'a Solid<'a>| LayerFace {
            span: LayerSpan {
                index,
                bottom: 0.2 * index as f64,
                top: 0.2 * (index + 1) as f64,
            },
            outline: solid,
            rough: solid,
            top: solid,
            risen: None,
        };
        let above = above.iter().zip(number + 1..);
        let below = below.iter().zip(1..);
        LayerView {
            here: face(number, here),
            above: above.map(|(solid, i)| face(i, solid)).collect(),
            below: below
                .map(|(solid, k)| face(number.saturating_sub(k), solid))
                .collect(),
        }
    }
}
