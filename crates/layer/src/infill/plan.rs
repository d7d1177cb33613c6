//! What sparse infill follows from.

use crate::walls::ThinPlan;
use isoslice_base::units::{Degrees, Mm, Percent};
use isoslice_settings::{Infill, InfillPattern, Settings, Varying};

/// How infill is laid.
#[derive(Clone, Debug)]
pub struct InfillPlan {
    /// One of the patterns, or a shape of the user's own.
    pub pattern: Infill,
    /// Share of the volume that a pattern fills, %.
    pub density: Varying<Percent>,
    /// Line width, mm.
    pub width: Mm,
    /// Share of their width by which lines reach into the walls around them, %.
    pub overlap: Percent,
    /// Direction of the pattern.
    pub angle: Degrees,
    /// True if a shape is filled, and not lines are laid along its surface.
    pub solid: bool,
    /// Number of walls around a shape that is filled.
    pub walls: u32,
    /// Distance of the ends of lines from the centre line of such a wall, mm.
    pub off_wall: Mm,
    /// Which places of such a wall get one line.
    pub thin: ThinPlan,
}

impl InfillPlan {
    /// The plan that settings ask for.
    pub fn of(settings: &Settings) -> InfillPlan {
        InfillPlan {
            pattern: settings.infill.clone(),
            density: settings.infill_density.clone(),
            width: settings.infill_width(),
            overlap: settings.infill_overlap,
            angle: settings.infill_angle,
            solid: settings.infill_mode.walls().is_some(),
            walls: settings.infill_mode.walls().unwrap_or(1),
            off_wall: 0.5 * settings.printer.nozzle_diameter,
            thin: ThinPlan::of(settings),
        }
    }

    /// Parallel lines of a width and a density instead.
    pub fn lines(&self, width: Mm, density: Percent) -> InfillPlan {
        InfillPlan {
            pattern: Infill::Pattern(InfillPattern::Rectilinear),
            density: Varying::Constant(density),
            width,
            ..self.clone()
        }
    }

    /// True if the pattern is a shape of the user's own.
    pub(super) fn is_own(&self) -> bool {
        !matches!(self.pattern, Infill::Pattern(_))
    }

    /// True if there are no lines. The density does not matter to a shape.
    pub(super) fn is_hollow(&self) -> bool {
        !self.is_own() && self.density.is(0.0)
    }
}
