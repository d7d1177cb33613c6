//! Contract only: the names and defaults the other stages rely on.
use crate::units::*;

macro_rules! group {
    ($name:ident { $($field:ident : $ty:ty = $default:expr),* $(,)? }) => {
        #[allow(missing_docs)]
        #[derive(Clone, Debug, PartialEq)]
        pub struct $name { $(pub $field: $ty),* }
        impl Default for $name { fn default() -> Self { Self { $($field: $default),* } } }
    };
}

group!(Settings {
    layer_height: Mm = 0.2,
    first_layer_height: Mm = 0.2,
    walls: u32 = 2,
    outer_wall_width: Mm = 0.45,
    inner_wall_width: Mm = 0.45,
    wall_order: WallOrder = WallOrder::InnerFirst,
    wall_offset: WallOffset = WallOffset::Distance,
    accuracy: Mm = 0.005,
    sample_spacing: Mm = 0.1,
    seam: Seam = Seam::Aligned,
    top_thickness: Mm = 0.8,
    bottom_thickness: Mm = 0.6,
    top_layers: Option<u32> = None,
    bottom_layers: Option<u32> = None,
    skin_width: Mm = 0.45,
    skin_angle: Degrees = 45.0,
    skin_overlap: Mm = 0.6,
    skin_min_area: Mm2 = 2.0,
    infill_density: Percent = 15.0,
    infill_pattern: InfillPattern = InfillPattern::Rectilinear,
    infill_width: Mm = 0.45,
    infill_angle: Degrees = 45.0,
    infill_overlap: Percent = 25.0,
    flow: Percent = 100.0,
    speed: Speed = Speed::default(),
    retract: Retract = Retract::default(),
    skirt: Skirt = Skirt::default(),
    cooling: Cooling = Cooling::default(),
    filament: Filament = Filament::default(),
    printer: Printer = Printer::default(),
    gcode: Gcode = Gcode::default(),
});
group!(Speed {
    outer_wall: MmPerSec = 40.0,
    inner_wall: MmPerSec = 60.0,
    sparse_infill: MmPerSec = 80.0,
    internal_skin: MmPerSec = 60.0,
    top_skin: MmPerSec = 40.0,
    bottom_skin: MmPerSec = 40.0,
    skirt: MmPerSec = 30.0,
    first_layer: MmPerSec = 20.0,
    travel: MmPerSec = 150.0,
});
group!(Retract {
    length: Mm = 0.8,
    speed: MmPerSec = 35.0,
    prime_speed: MmPerSec = 35.0,
    min_travel: Mm = 1.5,
    max_unretracted: Mm = 30.0,
    extra_prime: Mm = 0.0,
    z_hop: Mm = 0.0,
});
group!(Skirt {
    loops: u32 = 1,
    distance: Mm = 6.0,
    layers: u32 = 1,
});
group!(Cooling {
    fan_speed: Percent = 100.0,
    fan_off_layers: u32 = 1,
    min_layer_time: Seconds = 8.0,
    min_speed: MmPerSec = 10.0,
});
group!(Filament {
    diameter: Mm = 1.75,
    density: f64 = 1.24,
    flow: Percent = 100.0,
    max_flow: Mm3PerSec = 12.0,
    nozzle_temperature: Celsius = 210.0,
    first_layer_nozzle_temperature: Celsius = 215.0,
    bed_temperature: Celsius = 60.0,
    first_layer_bed_temperature: Celsius = 60.0,
});
group!(Printer {
    bed_x: Mm = 220.0,
    bed_y: Mm = 220.0,
    height: Mm = 250.0,
    nozzle_diameter: Mm = 0.4,
    acceleration: MmPerSec2 = 1000.0,
    travel_acceleration: MmPerSec2 = 1500.0,
    square_corner_velocity: MmPerSec = 5.0,
    max_speed_z: MmPerSec = 10.0,
});
group!(Gcode {
    flavour: Flavour = Flavour::Marlin,
    relative_e: bool = false,
    start: String = String::new(),
    end: String = String::new(),
});

/// Firmware.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Flavour {
    /// Marlin 2.
    Marlin,
    /// Klipper.
    Klipper,
}
/// Order of walls.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WallOrder {
    /// Inner walls first.
    InnerFirst,
    /// Outer wall first.
    OuterFirst,
}
/// How walls are offset.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WallOffset {
    /// In-plane millimetres.
    Distance,
    /// The expression itself.
    Field,
}
/// Seam.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Seam {
    /// One line up the part.
    Aligned,
    /// At the back.
    Rear,
    /// Nearest to the head.
    Nearest,
}
/// Sparse pattern.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InfillPattern {
    /// Lines, turned every layer.
    Rectilinear,
    /// Both directions in every layer.
    Grid,
}
