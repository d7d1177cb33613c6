//! The supports of a part, layer by layer.

use crate::bead::{Bead, Role};
use crate::infill::{self, Infill, InfillError};
use crate::layers::LayerSpan;
use crate::plane::Area;
use crate::plane::clip::union;
use crate::region::walls;
use crate::settings::{self, InfillPattern, Settings, Varying, WallOffset};
use crate::support::{Plan, Slice, Unheld};
use crate::vary::Surroundings;
use crate::walls;

/// The supports of a part.
pub(super) struct Supported<'a> {
    plan: Plan,
    body: SupportFill<'a>,
    interface: SupportFill<'a>,
}

impl<'a> Supported<'a> {
    /// Those of a plan, filled by `fills`.
    pub(super) fn new(
        plan: Plan,
        fills: &'a Fills,
        around: &'a Surroundings<'a>,
        site: infill::Site,
    ) -> Result<Supported<'a>, InfillError> {
        let fill = |settings: &'a Settings, role| {
            Ok::<_, InfillError>(SupportFill {
                settings,
                infill: Infill::new(settings, around, site)?,
                role,
            })
        };
        Ok(Supported {
            plan,
            body: fill(&fills.body, Role::Support)?,
            interface: fill(&fills.interface, Role::SupportInterface)?,
        })
    }

    /// What needs a support and has none.
    pub(super) fn unheld(&self) -> Unheld {
        self.plan.unheld
    }

    /// The sparse and the dense area in a layer, if there is one.
    pub(super) fn slice(&self, layer: usize) -> Option<&Slice> {
        self.plan.slice(layer)
    }

    /// Where a layer has supports.
    pub(super) fn area(&self, layer: usize) -> Option<Area> {
        self.slice(layer).map(|s| union(&s.body, &s.interface))
    }

    /// The beads of a layer's supports.
    pub(super) fn beads(
        &self,
        span: &LayerSpan,
    ) -> Result<Vec<Bead>, InfillError> {
        let Some(slice) = self.slice(span.index) else {
            return Ok(Vec::new());
        };
        let mut beads = self.interface.beads(&slice.interface, span)?;
        beads.extend(self.body.beads(&slice.body, span)?);
        Ok(beads)
    }
}

/// The settings by which supports are filled.
pub(super) struct Fills {
    body: Settings,
    interface: Settings,
}

impl Fills {
    /// Of a run with these settings.
    pub(super) fn new(settings: &Settings) -> Fills {
        let of = |density| Settings {
            walls: 1,
            outer_wall_width: settings.infill_width().into(),
            infill: settings::Infill::Pattern(InfillPattern::Rectilinear),
            infill_density: Varying::Constant(density),
            wall_offset: WallOffset::Distance,
            ..settings.clone()
        };
        Fills {
            body: of(settings.support.density),
            interface: of(settings.support.interface_density),
        }
    }
}

/// How an area of support is filled.
struct SupportFill<'a> {
    settings: &'a Settings,
    infill: Infill<'a>,
    role: Role,
}

impl SupportFill<'_> {
    /// A wall around the area, and lines inside it.
    fn beads(
        &self,
        area: &Area,
        span: &LayerSpan,
    ) -> Result<Vec<Bead>, InfillError> {
        if area.is_empty() {
            return Ok(Vec::new());
        }
        let height = span.height();
        let mut walls = walls(area, height, self.settings);
        walls::thin(&mut walls, self.settings);
        let place = infill::Place {
            number: span.index,
            z: span.sample_z(),
            height,
        };
        let lines = self.infill.beads(&walls.fill, place, None)?;
        let small = self.settings.speed.small_wall_length;
        let mut beads = walls::beads(&walls, height, small);
        beads.extend(lines);
        for bead in &mut beads {
            bead.role = self.role;
            bead.small = false;
        }
        Ok(beads)
    }
}
