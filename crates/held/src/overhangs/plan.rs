//! What tells which places hang.

use isoslice_base::units::{Degrees, Mm};
use isoslice_layer::walls::{THINNEST_PLACE, WallPlan};
use isoslice_settings::Settings;

/// How far layers hold what is above them.
#[derive(Clone, Copy, Debug)]
pub struct OverhangPlan {
    /// A face that leans by up to this from the vertical holds itself.
    pub angle: Degrees,
    /// True if skin over a gap turns so that its lines bridge the gap.
    pub bridges: bool,
    /// True if lines of skin that run across a gap count as bridges where `bridge_max`
    /// is 0. They sag, so supports do not count them.
    pub by_skin: bool,
    /// Greatest length of a bridge, mm.
    pub bridge_max: Mm,
    /// Directions of skin's lines in even and in odd layers.
    pub directions: [Degrees; 2],
    /// The walls.
    pub walls: WallPlan,
    /// Thickness of the thinnest place that gets a line, mm.
    pub thinnest: Mm,
    /// Height of the thickest layers above the first, mm.
    pub thickest_layer: Mm,
    /// Number of the raft's layers.
    pub raft_layers: usize,
    /// True if the part is a vase, which has no supports.
    pub vase: bool,
}

/// Longest lines of skin across a gap that count as bridges if `bridge_max` is 0,
/// mm. It is the default of `bridge_max`.
const SKIN_SPAN: Mm = 10.0;

impl OverhangPlan {
    /// The plan that settings ask for.
    pub fn of(settings: &Settings) -> OverhangPlan {
        OverhangPlan {
            angle: settings.support.angle,
            bridges: settings.bridges(),
            by_skin: true,
            bridge_max: if settings.bridges() {
                settings.bridge_max
            } else {
                SKIN_SPAN
            },
            directions: [0, 1].map(|layer| settings.skin_direction(layer)),
            walls: WallPlan::of(settings),
            thinnest: THINNEST_PLACE * settings.thinnest_line(),
            thickest_layer: settings.thickest_layer(),
            raft_layers: settings.raft_layers(),
            vase: settings.is_vase(),
        }
    }

    /// How far a layer of a height sticks out along a face that leans by just the
    /// angle.
    pub(super) fn slope(&self, height: Mm) -> Mm {
        height * self.angle.to_radians().tan()
    }

    /// Direction of the skin's lines in a layer.
    pub(super) fn direction(&self, layer: usize) -> Degrees {
        self.directions[layer % 2]
    }
}
