//! What the split of the area inside walls follows from.

use crate::walls::WallPlan;
use isoslice_base::units::{Mm, Mm2};
use isoslice_settings::{Settings, SkinWhere};

/// Solid layers on one side of what is seen.
#[derive(Clone, Copy, Debug)]
pub struct ShellPlan {
    /// Their number, if that is given.
    pub layers: Option<usize>,
    /// Their thickness otherwise, mm.
    pub thickness: Mm,
}

/// Which part of the fill is skin.
#[derive(Clone, Copy, Debug)]
pub struct ExposurePlan {
    /// The walls around the fill.
    pub walls: WallPlan,
    /// What lies below faces that are seen from above.
    pub top: ShellPlan,
    /// What lies above faces that are seen from below.
    pub bottom: ShellPlan,
    /// True if the whole first and last layers are skin, and no others.
    pub ends_alone: bool,
    /// True if all layers above the first have one height.
    pub uniform: bool,
    /// Number of the raft's layers.
    pub raft_layers: usize,
    /// True if no place is sparse.
    pub solid: bool,
    /// Line width of sparse infill, mm.
    pub infill: Mm,
    /// Content below which an area is too small for sparse infill, mm².
    pub least: Mm2,
    /// How far skin reaches into the sparse infill beside it, mm.
    pub overlap: Mm,
    /// How far bridges reach onto what holds them, mm, if there are bridges.
    pub anchor: Option<Mm>,
}

impl ExposurePlan {
    /// The plan that settings ask for.
    pub fn of(settings: &Settings) -> ExposurePlan {
        let shell = |layers: Option<u32>, thickness| ShellPlan {
            layers: layers.map(|count| count as usize),
            thickness,
        };
        ExposurePlan {
            walls: WallPlan::of(settings),
            top: shell(settings.top_layers.layers(), settings.top_thickness()),
            bottom: shell(
                settings.bottom_layers.layers(),
                settings.bottom_thickness(),
            ),
            ends_alone: settings.skin_where == SkinWhere::Ends,
            uniform: settings.is_uniform(),
            raft_layers: settings.raft_layers(),
            solid: settings.is_solid(),
            infill: settings.infill_width(),
            least: settings.skin_min_area,
            overlap: settings.skin_overlap(),
            anchor: settings.bridges().then_some(settings.bridge_anchor),
        }
    }
}
