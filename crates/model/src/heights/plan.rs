//! What the heights of layers need of the settings.

use isoslice_base::units::Mm;
use isoslice_settings::{LayerHeights, Settings};

/// How high layers may be.
#[derive(Clone, Debug)]
pub struct HeightPlan {
    /// Equal heights, heights that follow the surface, or an expression.
    pub(super) heights: LayerHeights,
    /// Number of layers between the bed and the part.
    pub(super) raft_layers: usize,
    /// How high the part begins, mm.
    pub(super) raft_height: Mm,
    /// Height of the layer on the bed, mm.
    pub(super) on_bed: Mm,
    /// Height of the part's first layer, mm.
    pub(super) first: Mm,
    /// Height of uniform layers, mm.
    pub(super) uniform: Mm,
    /// The least and the greatest height that may be chosen, mm.
    pub(super) least: Mm,
    pub(super) most: Mm,
    /// The greatest step that a layer may make on the surface, mm.
    pub(super) step: Mm,
    /// How far the surface may be from the true one, mm.
    pub(super) accuracy: Mm,
}

impl HeightPlan {
    /// The plan that settings ask for.
    pub fn of(s: &Settings) -> HeightPlan {
        HeightPlan {
            heights: s.layer_heights.clone(),
            raft_layers: s.raft_layers(),
            raft_height: s.raft_height(),
            on_bed: s.bed_layer_height(),
            first: s.part_first_height(),
            uniform: s.layer_height(),
            least: s.layer_height_min(),
            most: s.layer_height_max(),
            step: s.step_error(),
            accuracy: s.accuracy,
        }
    }

    /// The nearest height that may be chosen, mm.
    pub(super) fn clamp(&self, height: Mm) -> Mm {
        height.max(self.least).min(self.most)
    }
}
