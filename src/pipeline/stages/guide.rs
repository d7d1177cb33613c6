//! The seams below a run that begins in the middle of a part.

use super::Stages;
use super::outlines::WallFields;
use crate::pipeline::SliceError;
use crate::pipeline::layer::Layer;
use isoslice_base::limits;
use isoslice_settings::layers::LayerSpan;
use rayon::ThreadPool;
use rayon::prelude::*;
use std::ops::Range;

impl Stages<'_> {
    /// Follows the seams up to the layer `first` of the part, with which a run
    /// begins, if they follow one another. Every run looks at the same few of
    /// the layers below.
    pub(in crate::pipeline) fn plan_guide(
        &mut self,
        pool: &ThreadPool,
        spans: &[LayerSpan],
        first: usize,
    ) -> Result<(), SliceError> {
        let Some(mut guide) = self.seams.guide(self.plans.raft.layers) else {
            return Ok(());
        };
        let flat = |&i: &usize| self.spiral_at(i).is_none();
        let below = (0..first.min(spans.len())).filter(flat);
        let looks: Vec<usize> = below.filter(|&i| guide.looks_at(i)).collect();
        // Some at a time, since a layer may take megabytes.
        for some in looks.chunks(pool.current_num_threads()) {
            limits::go_on()?;
            let pair = |&i: &usize| {
                let from = i - usize::from(!guide.is_first(i));
                self.only(spans, from..from + 2)
            };
            let made: Vec<Result<Vec<Layer>, SliceError>> =
                pool.install(|| some.par_iter().map(pair).collect());
            for (&i, layers) in some.iter().zip(made) {
                let layers = layers?;
                let at = |i: usize| layers.iter().find(|l| l.span.index == i);
                let Some(layer) = at(i) else { continue };
                let below = i.checked_sub(1).and_then(at);
                let ground = below.and_then(|below| layer.ground(below));
                layer.guide(&mut guide, ground, at(i + 1));
            }
        }
        self.guide = Some(guide);
        Ok(())
    }

    /// These layers and no others.
    fn only(
        &self,
        spans: &[LayerSpan],
        layers: Range<usize>,
    ) -> Result<Vec<Layer>, SliceError> {
        let slab = self.slab_layers();
        let slabs = layers.start / slab..layers.end.div_ceil(slab);
        let slabs = spans.chunks(slab).skip(slabs.start).take(slabs.len());
        let none = &WallFields::None;
        let made = slabs.map(|s| self.layers_of(&self.field, none, s, &layers));
        let made: Vec<Vec<Layer>> = made.collect::<Result<_, _>>()?;
        Ok(made.into_iter().flatten().collect())
    }
}
