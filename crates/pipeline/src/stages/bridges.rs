//! Internal bridges: skin over the infill of the layer below.

use super::Stages;
use super::beads::of_skin;
use crate::SliceError;
use isoslice_base::timings::Stage;
use isoslice_layer::exposure::FillAreas;
use isoslice_layer::skin::internal_bridges::{
    Below, Level, Over, Under, bridged,
};
use isoslice_layer::skin::{Patch, internal_bridges};
use isoslice_layer::view::LayerView;
use isoslice_planar::Area;
use isoslice_planar::bead::Bead;

/// What replaces parts of a layer that has internal bridges.
pub(crate) struct InternalBridges {
    pub skin: Vec<Patch>,
    pub infill: Vec<Bead>,
    pub sparse: Area,
    pub left: Area,
    pub levels: Vec<Level>,
}

impl Stages<'_> {
    /// Number of layers above infill in which its bridges may show: the bridges, and
    /// a layer over what they leave. 0 if there are no internal bridges.
    pub(crate) fn bridge_layers(&self) -> usize {
        self.plans.internal_bridges.map_or(0, |layers| 1 + layers)
    }

    /// False if no internal bridge fits where skin lies over what is `open` in the
    /// layer below.
    pub(crate) fn may_bridge(&self, areas: &FillAreas, open: &Area) -> bool {
        self.timings.time(Stage::Skin, || {
            let plan = &self.plans.skin;
            internal_bridges::may_bridge(&areas.skin, open, plan)
        })
    }

    /// A layer with internal bridges over the infill of the layer below, and over
    /// its bridges `levels`, if there are any. `areas` and `walls` are the
    /// layer's.
    pub(crate) fn internal_bridges(
        &self,
        view: &LayerView<'_>,
        areas: &FillAreas,
        walls: &[Bead],
        under: Under<'_>,
        levels: &[Below],
    ) -> Result<Option<InternalBridges>, SliceError> {
        let over = Over {
            skin: &areas.skin,
            sparse: &areas.sparse,
            walls,
            view,
        };
        let made = self.timings.time(Stage::Skin, || {
            let bridged = bridged(over, under, levels, &self.plans.skin)?;
            let (own, sparse) = (&bridged.skin, &bridged.sparse);
            let mut skin = self.patches(own, sparse, view);
            skin.extend(bridged.patches);
            self.thin(of_skin(&mut skin));
            Some((skin, bridged.sparse, bridged.left, bridged.levels))
        });
        let Some((skin, sparse, left, levels)) = made else {
            return Ok(None);
        };
        let mut infill = self.infill_in(&sparse, &view.here)?;
        self.timings
            .time(Stage::Infill, || self.thin(infill.iter_mut()));
        Ok(Some(InternalBridges {
            skin,
            infill,
            sparse,
            left,
            levels,
        }))
    }
}
