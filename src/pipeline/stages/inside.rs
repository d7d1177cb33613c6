//! The walls of layers and what they leave, and how layers lie over others.

use super::Stages;
use crate::pipeline::layer::{Inside, Layer};
use crate::report::{LayerFigures, LayerParts, ReportError};
use isoslice_base::timings::Stage;
use isoslice_layer::hang::Look;
use isoslice_layer::region::exposure::roomy;
use isoslice_layer::region::{Walls, field_walls, walls};
use isoslice_layer::walls;
use isoslice_planar::Area;
use std::collections::VecDeque;

impl Stages<'_> {
    /// True if layer `i` of the window needs walls of its own: it is seen from
    /// above, and tops have fewer walls.
    pub(in crate::pipeline) fn divides(
        &self,
        layers: &VecDeque<Layer>,
        i: usize,
    ) -> bool {
        let covered = |above: &Layer| above.same_outline(&layers[i]);
        self.may_divide() && !layers.get(i + 1).is_some_and(covered)
    }

    /// True if walls may depend on the layer above.
    pub(in crate::pipeline) fn may_divide(&self) -> bool {
        self.settings.top_walls() < self.settings.walls
    }

    /// The walls of layer `i` of the window and what they leave.
    pub(in crate::pipeline) fn inside(
        &self,
        layers: &VecDeque<Layer>,
        i: usize,
    ) -> Inside {
        let nothing = Area::EMPTY;
        let above = layers.get(i + 1).map_or(&nothing, Layer::area);
        let above = self.divides(layers, i).then_some(above);
        self.inside_below(&layers[i], above)
    }

    /// A layer's walls and what they leave. There are fewer walls around what
    /// the outline `above` leaves open.
    pub(in crate::pipeline) fn inside_below(
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
            let outline = layer.area();
            let mut walls = if layer.offsets.is_empty() {
                walls(outline, above, height, self.settings)
            } else {
                let areas = layer.offsets.to_vec();
                field_walls(outline, areas, height, self.settings)
            };
            walls::thin(&mut walls, self.settings);
            walls
        });
        let roomy = self
            .timings
            .time(Stage::Skin, || roomy(&walls.fill, self.settings));
        Inside { walls, roomy }
    }

    /// The accuracy of the `k`th layer of the run, if the layer is to be
    /// measured.
    pub(in crate::pipeline) fn figures(
        &self,
        layer: &Layer,
        walls: &Walls,
        k: usize,
    ) -> Result<Option<LayerFigures>, ReportError> {
        // A turn of a climbing wall is nowhere at the height of its layer's
        // outline.
        let number = layer.span.index;
        if self.spiral_at(number).is_some() || number < self.raft_layers {
            return Ok(None);
        }
        let rounded;
        let walls = if self.settings.arcs() {
            rounded = walls::rounded(walls, self.settings);
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

    /// How layer `i` of the window lies over the layer below. None if supports are
    /// planned, which see to what hangs, or if layer `i` is the first.
    pub(in crate::pipeline) fn look(
        &self,
        layers: &VecDeque<Layer>,
        i: usize,
    ) -> Option<Look> {
        let below = layers.get(i.checked_sub(1)?)?;
        if self.support().is_some() {
            return None;
        }
        self.look_over(&layers[i], below)
    }

    /// How a layer lies over the layer below. None if their outlines are equal, or
    /// if they are on a raft, which holds all that is on it.
    pub(super) fn look_over(
        &self,
        here: &Layer,
        below: &Layer,
    ) -> Option<Look> {
        let number = here.span.index;
        if here.same_outline(below) || self.is_on_raft(number) {
            return None;
        }
        let heights = [here, below].map(|layer| layer.span.height());
        let outlines = [here, below].map(|layer| layer.outline.as_ref());
        let look = || Look::new(outlines, number, heights, self.settings);
        Some(self.timings.time(Stage::Hang, look))
    }
}
