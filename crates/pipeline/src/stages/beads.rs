//! The beads of a layer, before they have their order.

use super::Stages;
use crate::SliceError;
use crate::layer::Inside;
use isoslice_base::timings::Stage;
use isoslice_layer::exposure::FillAreas;
use isoslice_layer::infill::{self, InfillError};
use isoslice_layer::skin;
use isoslice_layer::skin::Patch;
use isoslice_layer::view::{LayerFace, LayerView};
use isoslice_layer::walls;
use isoslice_path::order::{LayerBeads, supports_last};
use isoslice_planar::Area;
use isoslice_planar::bead::{Bead, Role};

impl Stages<'_> {
    /// Everything there is to print in a layer but for the beads of its skin, and
    /// where it has skin and sparse infill.
    pub(crate) fn beads(
        &self,
        view: &LayerView<'_>,
        Inside { walls, roomy }: &Inside,
    ) -> Result<(LayerBeads, FillAreas), SliceError> {
        let LayerView { here, .. } = view;
        let span = &here.span;
        let (number, height) = (span.index, span.height());
        let skirt = self.loops(here);
        let turns = self.timings.time(Stage::Walls, || self.turns(view))?;
        if !turns.is_empty() {
            let beads = LayerBeads {
                skirt,
                turns,
                ..LayerBeads::default()
            };
            return Ok((beads, FillAreas::default()));
        }
        let mut areas = self.timings.time(Stage::Skin, || {
            let mut areas = self.exposure.split(&walls.fill, roomy, view);
            infill::fill_small(&mut areas, &self.plans.infill);
            areas
        });
        let infill = self.infill_in(&areas.sparse, here)?;
        self.timings.time(Stage::Skin, || {
            infill::fill_bare(&mut areas, &infill, &self.plans.infill);
        });
        let mut walls = if self.plans.interlocked {
            walls::interlocked(walls, height)
        } else {
            walls::beads(walls, height)
        };
        let sites = self
            .timings
            .time(Stage::Walls, || self.seams.sites(&walls, here))?;
        if let Some(fuzzy) = &self.fuzzy {
            self.timings
                .time(Stage::Walls, || fuzzy.apply(&mut walls, here))?;
        }
        let support = self.support_beads(span)?;
        let radius = 0.5 * self.plans.nozzle_flat;
        let low = self.has_low_supports(span).then_some(radius);
        let support_last = supports_last(number, here.outline, &support, low);
        let mut beads = LayerBeads {
            support,
            support_last,
            skirt,
            turns: Vec::new(),
            walls,
            sites,
            infill,
            skin: Vec::new(),
        };
        // The walls have been thinned already.
        self.timings.time(Stage::Infill, || {
            let all = beads.skirt.iter_mut().chain(&mut beads.support);
            self.thin(all.chain(&mut beads.infill));
        });
        Ok((beads, areas))
    }

    /// The beads of a layer's skin, which lies beside `sparse` infill.
    pub(super) fn patches(
        &self,
        own: &Area,
        sparse: &Area,
        view: &LayerView<'_>,
    ) -> Vec<Patch> {
        let supported = self.is_supported(&view.here, view.below.first());
        skin::patches(own, sparse, view, supported, &self.plans.skin)
    }

    /// The beads of a layer's skin.
    pub(crate) fn skin(
        &self,
        view: &LayerView<'_>,
        areas: &FillAreas,
    ) -> Vec<Patch> {
        self.timings.time(Stage::Skin, || {
            let (own, sparse) = (&areas.skin, &areas.sparse);
            let mut skin = self.patches(own, sparse, view);
            if self.is_on_raft(view.here.span.index) {
                // The skin's underside lies over the air above the raft.
                let down = of_skin(&mut skin);
                for bead in down.filter(|b| b.role == Role::BottomSkin) {
                    bead.role = Role::Bridge;
                }
            }
            self.thin(of_skin(&mut skin));
            skin
        })
    }

    /// A layer's sparse infill.
    pub(super) fn infill_in(
        &self,
        sparse: &Area,
        layer: &LayerFace<'_>,
    ) -> Result<Vec<Bead>, InfillError> {
        let solid = layer.outline.grid();
        self.timings.time(Stage::Infill, || {
            if self.plans.vase {
                Ok(Vec::new())
            } else {
                self.infill.beads(sparse, &layer.span, Some(solid))
            }
        })
    }

    /// Thins beads as far as their roles permit.
    pub(super) fn thin<'b>(&self, beads: impl Iterator<Item = &'b mut Bead>) {
        for bead in beads {
            let role = bead.role;
            self.plans.resolution.thin(&mut bead.stroke, role);
        }
    }
}

/// The beads of some skin.
pub(super) fn of_skin(skin: &mut [Patch]) -> impl Iterator<Item = &mut Bead> {
    skin.iter_mut().flat_map(|patch| {
        let fills = patch.fills.iter_mut().flat_map(|f| &mut f.lines);
        patch.rings.iter_mut().chain(fills)
    })
}
