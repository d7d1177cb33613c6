//! The walls of layers and what they leave, and how layers lie over others.

use super::Stages;
use crate::layer::{Inside, Layer};
use crate::report::{LayerFigures, LayerParts, ReportError};
use isoslice_base::timings::Stage;
use isoslice_held::overhangs::LayerOverhang;
use isoslice_layer::view::{LayerFace, LayerView};
use isoslice_layer::walls;
use isoslice_layer::walls::{Walls, field_walls, walls};
use isoslice_planar::Area;

impl Stages<'_> {
    /// True if a layer needs walls of its own: it is seen from above, and tops
    /// have fewer walls.
    pub(crate) fn divides(&self, view: &LayerView<'_>) -> bool {
        let covered = |above: &LayerFace<'_>| above.is_like(&view.here);
        self.may_divide() && !view.above.first().is_some_and(covered)
    }

    /// True if walls may depend on the layer above.
    pub(crate) fn may_divide(&self) -> bool {
        self.plans.walls.around_tops < self.plans.walls.count
    }

    /// The walls of a layer and what they leave.
    pub(crate) fn inside(&self, layer: &Layer, view: &LayerView<'_>) -> Inside {
        let nothing = Area::EMPTY;
        let above = view.above.first();
        let above = above.map_or(&nothing, |above| above.outline.area());
        self.inside_below(layer, self.divides(view).then_some(above))
    }

    /// A layer's walls and what they leave. There are fewer walls around what
    /// the outline `above` leaves open.
    pub(crate) fn inside_below(
        &self,
        layer: &Layer,
        above: Option<&Area>,
    ) -> Inside {
        if self.spiral_at(layer.span.index).is_some() {
            return Inside {
                walls: Walls::default(),
                roomy: Area::default(),
            };
        }
        let height = layer.span.height();
        let walls = self.timings.time(Stage::Walls, || {
            let (outline, plan) = (layer.area(), &self.plans.walls);
            let mut walls = if layer.offsets.is_empty() {
                walls(outline, above, height, plan)
            } else {
                let areas = layer.offsets.to_vec();
                field_walls(outline, areas, height, plan)
            };
            walls::thin(&mut walls, self.plans.resolution);
            walls
        });
        let roomy = self
            .timings
            .time(Stage::Skin, || self.exposure.roomy(&walls.fill));
        Inside { walls, roomy }
    }

    /// The accuracy of the `k`th layer of the run, if the layer is to be
    /// measured.
    pub(crate) fn figures(
        &self,
        layer: &Layer,
        walls: &Walls,
        k: usize,
    ) -> Result<Option<LayerFigures>, ReportError> {
        // A turn of a climbing wall is nowhere at the height of its layer's
        // outline.
        let number = layer.span.index;
        if self.spiral_at(number).is_some() || number < self.plans.raft.layers {
            return Ok(None);
        }
        let rounded;
        let resolution = self.plans.resolution;
        let walls = if resolution.arcs {
            rounded = walls::rounded(walls, resolution);
            &rounded
        } else {
            walls
        };
        let parts = LayerParts {
            span: layer.span,
            z: layer.span.sample_z() + self.bed,
            outline: layer.found(),
            nan_samples: layer.met.nan_samples,
            forced_rings: layer.met.forced_rings,
            printed: &layer.outline,
            walls,
        };
        self.timings
            .time(Stage::Report, || self.gauge.layer(parts, k))
    }

    /// How a layer lies over the layer below. None if supports are planned, which see
    /// to what hangs, or if the layer is the first.
    pub(crate) fn look(&self, view: &LayerView<'_>) -> Option<LayerOverhang> {
        let below = view.below.first()?;
        if self.support().is_some() {
            return None;
        }
        self.look_over(&view.here, below)
    }

    /// How a layer lies over the layer below. None if their outlines are equal, or
    /// if they are on a raft, which holds all that is on it.
    pub(super) fn look_over(
        &self,
        here: &LayerFace<'_>,
        below: &LayerFace<'_>,
    ) -> Option<LayerOverhang> {
        let number = here.span.index;
        if here.is_like(below) || self.is_on_raft(number) {
            return None;
        }
        let heights = [here, below].map(|layer| layer.span.height());
        let outlines = [here, below].map(|layer| layer.outline);
        let look = || {
            let plan = &self.plans.overhangs;
            let look = LayerOverhang::new(outlines, number, heights, plan);
            // Turns of a climbing wall have neither holes nor ceilings.
            match self.spiral_at(number) {
                Some(_) => look.of_a_wall_around(),
                None => look,
            }
        };
        Some(self.timings.time(Stage::Hang, look))
    }
}
