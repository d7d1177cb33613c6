//! What lies round a part: skirt, brim and draft shield.

use super::{ALL_LAYERS, Stages};
use crate::SliceError;
use glam::DVec2;
use isoslice_layer::adhesion::{Skirt, loops};
use isoslice_layer::view::LayerFace;
use isoslice_planar::bead::Bead;
use isoslice_planar::clip::union;
use isoslice_planar::{Area, Ring};
use isoslice_settings::layers::LayerSpan;

/// About how many layers' outlines a high skirt is laid round. It keeps a
/// distance from the part, which the layers in between do not exceed.
const SKIRT_SAMPLES: usize = 64;

impl Stages<'_> {
    /// Lays the skirt of the whole part, `spans`, after its supports and its
    /// raft, if more layers than the first have it.
    ///
    /// # Errors
    /// If the outlines beside the skirt cannot be found.
    pub(crate) fn plan_skirt(
        &mut self,
        spans: &[LayerSpan],
    ) -> Result<(), SliceError> {
        let plan = self.plans.adhesion.skirt;
        if plan.loops > 0 && plan.layers > 1 {
            let areas = self.beside(spans, plan.layers)?;
            self.skirt = Some(Skirt::new(&areas, plan));
        }
        Ok(())
    }

    /// What stands of the part and its supports in the lowest `layers`, or in
    /// some of them if they are many.
    pub(crate) fn beside(
        &self,
        spans: &[LayerSpan],
        layers: usize,
    ) -> Result<Vec<Area>, SliceError> {
        let beside = &spans[..spans.len().min(layers)];
        let step = beside.len().div_ceil(SKIRT_SAMPLES).max(1);
        let mut areas = Vec::new();
        for span in beside.iter().step_by(step).chain(beside.last()) {
            let of_span =
                self.layers(std::slice::from_ref(span), &ALL_LAYERS)?;
            areas.extend(of_span.iter().map(|l| l.area().clone()));
        }
        let slice = |s: &LayerSpan| self.support.as_ref()?.slice(s.index);
        let support = beside.iter().filter_map(slice);
        let support = support.flat_map(|s| [&s.body, &s.interface]);
        areas.extend(support.cloned());
        areas.extend(self.raft.iter().map(|raft| raft.area.clone()));
        Ok(areas)
    }

    /// The part and its supports as seen from above. `part` lies around the
    /// part, on the bed.
    pub(crate) fn seen_from_above(
        &self,
        spans: &[LayerSpan],
        part: &[DVec2],
    ) -> Vec<Area> {
        let offset = self.model.offset.truncate();
        let ring: Ring = part.iter().map(|p| p - offset).collect();
        let part = Area::from(ring);
        let supports = spans.iter();
        let supports = supports.filter_map(|s| self.support_area(s.index));
        std::iter::once(part).chain(supports).collect()
    }

    /// Plans the draft shield of the whole part, `spans`, after its supports
    /// and its raft. `part` lies around the part as seen from above, on the
    /// bed.
    pub(crate) fn plan_shield(&mut self, spans: &[LayerSpan], part: &[DVec2]) {
        let all = self.seen_from_above(spans, part);
        let plan = self.plans.adhesion.shield.among(spans);
        self.skirt = Some(Skirt::new(&all, plan));
    }

    /// The skirt and the brim of a layer.
    pub(super) fn loops(&self, layer: &LayerFace<'_>) -> Vec<Bead> {
        let number = layer.span.index;
        let beside = match number {
            0 => self.support_area(number),
            _ => None,
        };
        let outline = layer.outline.area();
        let beside = beside.map(|area| union(&area, outline));
        loops(
            number,
            beside.as_ref().unwrap_or(outline),
            layer.span.height(),
            self.skirt.as_ref(),
            &self.plans.adhesion,
        )
    }
}
