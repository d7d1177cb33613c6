//! What speeds, cooling and time need of the settings.

use super::motion::{Limits, Planner};
use isoslice_base::units::{
    Celsius, Mm, Mm2, Mm3PerSec, Mm3PerSec2, MmPerSec, PerSec, Percent,
    filament_area,
};
use isoslice_layer::resolution::Resolution;
use isoslice_planar::bead::Role;
use isoslice_settings::{
    Acceleration, Cooling, Range, Retract, Settings, Speed, Varying,
};

/// How fast, how wide and how cool beads are printed, and how the head moves
/// between them.
#[derive(Clone, Debug)]
pub struct PacePlan {
    /// Speeds of beads.
    pub(super) speed: Speed,
    /// Accelerations of beads; 0 for the machine's.
    pub(super) acceleration: Acceleration,
    /// The fan, and the times of layers.
    pub(super) cooling: Cooling,
    /// Lengths and speeds of retractions.
    pub(super) retract: Retract,
    /// What the machine can do.
    pub(super) limits: Limits,
    /// Greatest speed in the plane, and that of travels.
    pub(super) max_speed: MmPerSec,
    pub(super) travel_speed: MmPerSec,
    /// How many moves a second the firmware takes.
    pub(super) max_moves: PerSec,
    /// Greatest height of the nozzle, mm.
    pub(super) height: Mm,
    /// Cross-section of the filament.
    pub(super) filament_area: Mm2,
    /// Greatest flow of plastic, and how fast it may change along a stroke; 0
    /// for no limit.
    pub(super) max_flow: Mm3PerSec,
    pub(super) max_flow_change: Mm3PerSec2,
    /// Material extruded for all beads, as a share of their volume; one share
    /// multiplies the other.
    pub(super) flow: Varying<Percent>,
    pub(super) filament_flow: Percent,
    /// What of it is extruded for beads of some roles.
    pub(super) flows: [(Role, Percent); 5],
    /// Width of the part's beads, as a share of what is meant.
    pub(super) bead_width: Varying<Percent>,
    /// Temperatures of the nozzle on the first layer and above it, and those
    /// that an expression may give.
    pub(super) first_temperature: Celsius,
    pub(super) temperature: Varying<Celsius>,
    pub(super) temperatures: Range,
    /// How near paths come to what is meant, and whether they become arcs.
    pub(super) resolution: Resolution,
}

impl PacePlan {
    /// The plan that settings ask for.
    pub fn of(s: &Settings) -> PacePlan {
        let (printer, filament) = (&s.printer, &s.filament);
        PacePlan {
            speed: s.speed.clone(),
            acceleration: s.acceleration.clone(),
            cooling: s.cooling.clone(),
            retract: s.retract.clone(),
            limits: limits(s),
            max_speed: printer.max_speed,
            travel_speed: s.travel_speed(),
            max_moves: s.max_moves_per_second(),
            height: printer.height,
            filament_area: filament_area(filament.diameter),
            max_flow: filament.max_flow,
            max_flow_change: filament.max_flow_change,
            flow: s.flow.clone(),
            filament_flow: filament.flow,
            flows: [
                (Role::Bridge, s.bridge_flow),
                (Role::InternalBridge, s.internal_bridge_flow),
                (Role::Support, s.support.flow),
                (Role::SupportInterface, s.support.interface_flow),
                (Role::Ironing, s.ironing_flow()),
            ],
            bead_width: s.bead_width.clone(),
            first_temperature: s.first_layer_nozzle_temperature(),
            temperature: filament.nozzle_temperature.clone(),
            temperatures: Range::between(
                s.min_nozzle_temperature(),
                printer.max_nozzle_temperature.unwrap_or(f64::INFINITY),
            ),
            resolution: Resolution::of(s),
        }
    }
}

/// What the printer of the default settings can do.
impl Default for Limits {
    fn default() -> Limits {
        limits(&Settings::default())
    }
}

/// What the printer of these settings can do.
pub fn limits(settings: &Settings) -> Limits {
    let printer = &settings.printer;
    Limits {
        planner: Planner::new(
            settings.gcode.flavour,
            printer.square_corner_velocity,
            printer.acceleration,
        ),
        acceleration: printer.acceleration,
        travel_acceleration: settings.travel_acceleration(),
        speed_z: printer.max_speed_z,
        acceleration_z: printer.max_acceleration_z,
        filament_acceleration: printer.retract_acceleration,
    }
}
