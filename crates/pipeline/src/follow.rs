//! Follows what hangs in a part from layer to layer.

use super::layer::Layer;
use glam::DVec2;
use isoslice_held::overhangs::{LayerOverhang, OverhangPlan, Tracker};

/// How layers are followed.
pub(super) struct Follow<'a> {
    /// Way from the model's coordinates to the bed's.
    pub offset: DVec2,
    /// Number of the part's layers.
    pub count: usize,
    /// True if what hangs in this layer counts.
    pub written: bool,
    pub plan: &'a OverhangPlan,
}

impl Follow<'_> {
    /// Follows what hangs to the next layer. `look` compares the layer with the
    /// one below, unless their outlines are equal.
    pub(super) fn layer(
        self,
        tracker: &mut Tracker,
        layer: &Layer,
        look: Option<&LayerOverhang>,
    ) {
        let span = layer.span;
        let place = |p: DVec2| (p + self.offset).extend(span.bottom);
        let written = self.written;
        match look {
            Some(look) => {
                tracker.layer(look, layer.outline.grid(), written, place);
            }
            None => tracker.same(span.height(), written, self.plan),
        }
        if span.index + 1 == self.count && written {
            tracker.end(self.plan);
        }
    }
}
