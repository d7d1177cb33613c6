//! What climbing walls need of the settings.

use isoslice_base::units::Mm;
use isoslice_settings::layers::LayerSpan;
use isoslice_settings::{Settings, THICKNESS_SLACK};

/// What walls climb, and from where.
#[derive(Clone, Copy, Debug)]
pub struct SpiralPlan {
    /// Number of walls.
    pub(super) walls: u32,
    /// Width of the outer wall and of the others, mm.
    pub(super) widths: [Mm; 2],
    /// Greatest error of what shows, mm.
    pub(super) accuracy: Mm,
    /// Number of layers that have a skirt.
    pub(super) skirt: usize,
    /// Number of flat layers at the bottom, if that was asked for, and the
    /// height below which all layers are flat otherwise, mm.
    flat: (Option<u32>, Mm),
}

impl SpiralPlan {
    /// The plan that settings ask for.
    pub fn of(s: &Settings) -> SpiralPlan {
        SpiralPlan {
            walls: s.spiral.number().unwrap_or(1),
            widths: [s.outer_wall_width(), s.inner_wall_width()],
            accuracy: s.accuracy,
            skirt: match s.skirt.loops {
                0 => 0,
                _ => s.skirt.layers as usize,
            },
            flat: (
                s.bottom_layers.layers(),
                s.bottom_thickness() - THICKNESS_SLACK,
            ),
        }
    }

    /// How many of the layers at the bottom are flat: at least one, since the
    /// nozzle cannot begin on the bed.
    pub(super) fn flat_layers(&self, spans: &[LayerSpan]) -> usize {
        let (layers, height) = self.flat;
        let layers = layers.map_or_else(
            || spans.partition_point(|span| span.bottom < height),
            |layers| layers as usize,
        );
        layers.max(1)
    }
}
