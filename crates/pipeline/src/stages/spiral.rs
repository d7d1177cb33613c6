//! The climbing wall of a part.

use super::Stages;
use super::outlines::WallFields;
use crate::SliceError;
use isoslice_base::limits;
use isoslice_layer::view::LayerView;
use isoslice_layer::walls::Support;
use isoslice_path::spiral::Spiral;
use isoslice_planar::Solid;
use isoslice_planar::bead::Bead;
use isoslice_settings::layers::LayerSpan;
use rayon::ThreadPool;

impl<'a> Stages<'a> {
    /// Plans the climbing wall of the layers to be printed, if there is one. It
    /// takes all of their outlines, one slab after another, since each turn
    /// begins where the turn below ends.
    pub(crate) fn plan_spiral(
        &mut self,
        pool: &ThreadPool,
        spans: &[LayerSpan],
    ) -> Result<(), SliceError> {
        if !self.plans.vase {
            return Ok(());
        }
        let mut spiral = Spiral::new(self.model, self.plans.spiral, spans)?;
        let last_flat = spiral.first() - 1;
        let all = last_flat..spans.len();
        for slab in self.slabs(spans, &all)? {
            limits::go_on()?;
            // Offset fields are not asked for.
            let none = &WallFields::None;
            let made = || self.layers_of(&self.field, none, slab, &all);
            for layer in pool.install(made)? {
                spiral.add(&layer.span, layer.area())?;
            }
        }
        self.spiral = Some(spiral);
        Ok(())
    }

    /// The turns of a layer's climbing walls; none if it is flat.
    pub(super) fn turns(
        &self,
        view: &LayerView<'_>,
    ) -> Result<Vec<Bead>, SliceError> {
        let LayerView { here, below, .. } = view;
        match (self.spiral_at(here.span.index), below.first()) {
            (Some(spiral), Some(below)) => {
                let plan = &self.plans.walls;
                let ground = spiral.ground(&below.span, below.outline.area());
                let ground = Solid::new(ground);
                let support = Support::new(&ground, here.outline, plan);
                let layers = [here, below];
                let spans = layers.map(|layer| &layer.span);
                let outlines = layers.map(|layer| layer.outline.area());
                Ok(spiral.turns(spans, outlines, support.as_ref())?)
            }
            _ => Ok(Vec::new()),
        }
    }

    /// The climbing wall, if a layer is part of it.
    pub(crate) fn spiral_at(&self, layer: usize) -> Option<&Spiral> {
        self.spiral.as_ref().filter(|spiral| spiral.has(layer))
    }
}
