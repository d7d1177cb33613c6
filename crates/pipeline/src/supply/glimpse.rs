//! The layers that a glimpse of one layer needs, in the order in which they are
//! needed.
//!
//! In: a layer of a part. Out: its outline and walls, those of its neighbours'
//! outlines on which its beads depend, and no others. Where walls fill a layer,
//! as in a lattice, these are the outlines right above and below: they tell skin
//! what it shows and the walls what holds them. Farther ones only tell what of
//! the room inside the walls is sparse.

use super::super::SliceError;
use super::super::layer::{Inside, Layer};
use super::{Supply, all_or_first};
use isoslice_base::parallel;
use isoslice_settings::layers::LayerSpan;
use rayon::join;
use std::sync::Arc;

impl<'a> Supply<'a> {
    /// Finds the outlines of a glimpse, and the walls of its layer.
    pub(super) fn glimpse(&mut self) -> Result<(), SliceError> {
        let slabs = std::mem::take(&mut self.slabs);
        let spans: Vec<&'a [LayerSpan]> = slabs.into_iter().collect();
        let here = self.layers.start.saturating_sub(self.needed.start);
        let (below, rest) = spans.split_at(here.min(spans.len()));
        let Some((layer, above)) = rest.split_first() else {
            return Ok(());
        };
        let (far_below, below) = below.split_at(below.len().saturating_sub(1));
        let (above, far_above) = above.split_at(above.len().min(1));
        let beside = [below, above].concat();
        let (layer, beside) = self.pool.install(|| {
            // The walls take longer than any outline.
            join(|| self.with_walls(layer), || self.outlines(&beside))
        });
        let ((layer, inside), beside) = (layer?, beside?);
        let has_room = |inside: &Arc<Inside>| !inside.roomy.is_empty();
        let far = if self.stages.bridge_layers() > 0
            || inside.as_ref().is_none_or(has_room)
        {
            let far = [far_below, far_above].concat();
            self.pool.install(|| self.outlines(&far))?
        } else {
            Vec::new()
        };
        let mut all = [beside, far].concat();
        all.extend(layer);
        all.sort_by_key(|layer| layer.span.index);
        self.append(all);
        let of_glimpse =
            |layer: &&mut Layer| self.layers.contains(&layer.span.index);
        if let Some(layer) = self.outlines.iter_mut().find(of_glimpse) {
            layer.inside = inside;
        }
        Ok(())
    }

    /// A layer, and its walls, if they do not depend on the layer above.
    fn with_walls(
        &self,
        span: &[LayerSpan],
    ) -> Result<(Option<Layer>, Option<Arc<Inside>>), SliceError> {
        let layer = self.stages.layers(span, &self.needed)?.pop();
        let alone = layer.as_ref().filter(|_| !self.stages.may_divide());
        let inside = alone.map(|l| Arc::new(self.stages.inside_below(l, None)));
        Ok((layer, inside))
    }

    /// The layers of some spans, which are found at the same time.
    fn outlines(
        &self,
        spans: &[&[LayerSpan]],
    ) -> Result<Vec<Layer>, SliceError> {
        let stages = self.stages;
        let made = parallel::map(spans.len(), |i| {
            stages.layers(spans[i], &self.needed)
        });
        Ok(all_or_first(made)?.concat())
    }
}
