//! What skin and its bridges follow from.

use crate::walls::ThinPlan;
use isoslice_base::units::{Degrees, Mm, Percent};
use isoslice_planar::bead::Role;
use isoslice_settings::{Settings, SkinPattern};

/// How one kind of skin is filled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Look {
    /// How its lines run.
    pub pattern: SkinPattern,
    /// Line width, mm.
    pub width: Mm,
}

/// How skin is laid.
#[derive(Clone, Copy, Debug)]
pub struct SkinPlan {
    /// Skin that nobody sees, and the rings around all skin.
    pub internal: Look,
    /// Skin that is seen from below. Bridges have its width.
    pub bottom: Look,
    /// Skin that is seen from above.
    pub top: Look,
    /// Which places get one line.
    pub thin: ThinPlan,
    /// Directions of lines in even and in odd layers.
    pub directions: [Degrees; 2],
    /// Distance of the ends of lines from the centre line of the ring around
    /// them, mm.
    pub off_ring: Mm,
    /// How far skin reaches into the walls around it, mm.
    pub into_walls: Mm,
    /// True if lines that are seen from above come one beside the other.
    pub swept: bool,
    /// Distance between the lines of ironing, mm, if tops are ironed.
    pub ironing: Option<Mm>,
    /// True if lines over nothing become bridges.
    pub bridges: bool,
    /// True if bridges may lie side by side, as rings do: their beads are no thinner
    /// than others.
    pub rings_hang: bool,
    /// How far bridges reach onto what holds them, mm.
    pub anchor: Mm,
    /// Bridges over infill.
    pub internal_bridges: InternalBridgePlan,
}

/// What internal bridges lie on.
#[derive(Clone, Copy, Debug)]
pub struct InternalBridgePlan {
    /// Number of their layers, if that is given.
    pub layers: Option<u32>,
    /// Density of the infill, %, if it has one everywhere.
    pub density: Option<Percent>,
    /// Line width of the infill, mm.
    pub infill: Mm,
    /// Distance of a line from the centre line of a wall that it touches, mm.
    pub beside_wall: Mm,
}

impl SkinPlan {
    /// The plan that settings ask for.
    pub fn of(settings: &Settings) -> SkinPlan {
        let look = |pattern, width| Look { pattern, width };
        let (skin, inner) =
            (settings.skin_width(), settings.inner_wall_width());
        let wall = match settings.walls {
            0 => 0.0,
            1 => settings.outer_wall_width(),
            _ => inner,
        };
        let pressed = 0.01 * settings.skin_wall_overlap * skin;
        let density = settings.infill_density.constant();
        let patterns = settings.skin_pattern;
        SkinPlan {
            internal: look(patterns.internal, skin),
            bottom: look(patterns.bottom, skin),
            top: look(patterns.top, settings.top_skin_width()),
            thin: ThinPlan::of(settings),
            directions: [0, 1].map(|layer| settings.skin_direction(layer)),
            off_ring: settings.off_skin_ring(),
            // Skin may be wider than the wall. Half of the wall is left beside
            // it.
            into_walls: pressed.min(0.5 * wall),
            swept: patterns.top == SkinPattern::Lines,
            ironing: settings
                .ironing
                .is_on()
                .then(|| settings.ironing_spacing()),
            bridges: settings.bridges(),
            rings_hang: settings.bridge_flow >= 100.0,
            anchor: settings.bridge_anchor,
            internal_bridges: InternalBridgePlan {
                layers: settings.internal_bridges.number(),
                density: density.filter(|_| settings.infill_is_pattern()),
                infill: settings.infill_width(),
                beside_wall: 0.5 * (skin + inner),
            },
        }
    }

    /// How skin of a role is filled.
    pub(super) fn look(&self, role: Role) -> Look {
        match role {
            Role::TopSkin => self.top,
            Role::BottomSkin => self.bottom,
            _ => self.internal,
        }
    }
}
