//! Limits of a bead's speed and acceleration.

use super::PacePlan;
use super::rates::Rates;
use isoslice_base::units::{MICRON, MmPerSec, MmPerSec2};
use isoslice_planar::bead::{Bead, Role};
use isoslice_settings::layers::LayerSpan;

/// Greatest speed of a bead whatever its role: the limits of the first layer
/// and of small walls.
pub(super) fn speed_limit(
    bead: &Bead,
    span: &LayerSpan,
    plan: &PacePlan,
) -> MmPerSec {
    let speed = &plan.speed;
    let first = match span.index {
        0 => speed.first_layer,
        _ => f64::INFINITY,
    };
    if bead.ring < speed.small_wall_length {
        first.min(speed.small_wall)
    } else {
        first
    }
}

/// Two speeds of a bead before cooling: the lesser of the speed that its rates
/// ask for and the printer's greatest, and what of it the filament's flow allows.
pub(super) fn print_speed(
    plan: &PacePlan,
    bead: &Bead,
    rates: &Rates,
) -> [MmPerSec; 2] {
    let area = bead.area() * rates.flow;
    let speed = rates
        .speed
        .min(plan.max_speed)
        .min(plan.limits.speed_z / steepest(bead));
    if area > 0.0 && plan.max_flow > 0.0 {
        [speed, speed.min(plan.max_flow / area)]
    } else {
        [speed; 2]
    }
}

/// Greatest rise or fall of a bead per length of its way; 0 for a flat one.
fn steepest(bead: &Bead) -> f64 {
    let flat = bead.stroke.levels.is_empty();
    let segments = bead.stroke.segments().enumerate().filter(|_| !flat);
    let slopes = segments.map(|(i, (a, b))| {
        let rise =
            (bead.stroke.level(i + 1).rise - bead.stroke.level(i).rise).abs();
        if rise <= 0.0 {
            return 0.0;
        }
        // Both ends are rounded, which may make a short move steeper.
        let (rise, way) = (rise + MICRON, (a.distance(b) - MICRON).max(0.0));
        rise / way.hypot(rise)
    });
    slopes.fold(0.0, f64::max)
}

/// Acceleration of a role's beads on a layer.
pub(super) fn acceleration(
    role: Role,
    span: &LayerSpan,
    plan: &PacePlan,
) -> MmPerSec2 {
    let by_role = &plan.acceleration;
    let asked = match role {
        Role::OuterWall => by_role.outer_wall,
        Role::InnerWall | Role::GapFill => by_role.inner_wall,
        Role::Overhang => by_role.overhang,
        Role::TopSkin | Role::Ironing => by_role.top_skin,
        Role::InternalSkin => by_role.internal_skin,
        Role::BottomSkin => by_role.bottom_skin,
        Role::Bridge | Role::InternalBridge => by_role.bridge,
        Role::SparseInfill => by_role.sparse_infill,
        Role::Skirt | Role::Brim | Role::Support | Role::SupportInterface => {
            0.0
        }
    };
    let own = if asked > 0.0 {
        asked
    } else {
        plan.limits.acceleration
    };
    if span.index == 0 && by_role.first_layer > 0.0 {
        own.min(by_role.first_layer)
    } else {
        own
    }
}
