//! Other slicers' names of placeholders, and this program's.
//!
//! Sources: for PrusaSlicer and SuperSlicer "List of placeholders" in
//! PrusaSlicer's handbook; for OrcaSlicer and Bambu Studio "Built in
//! placeholders variables" in OrcaSlicer's wiki; for Cura the keys of its
//! settings.

/// The type of an expression's value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum NumberKind {
    /// A whole number. PrusaSlicer drops the rest when it divides two of them.
    Whole,
    /// Any number.
    Number,
    /// Text or a truth value.
    Other,
}

/// What stands for another slicer's name.
#[derive(Clone, Copy, Debug)]
pub(super) enum Ours {
    /// An expression.
    Is(NumberKind, &'static str),
    /// One expression for x and one for y.
    Pair(&'static str, &'static str),
    /// One expression in `gcode.layer`, the other elsewhere.
    ByScope(NumberKind, &'static str, &'static str),
    /// One expression in `gcode.layer` and one in `gcode.end`, where the last
    /// layer is meant. Other templates do not know the name.
    OfLayer(NumberKind, &'static str, &'static str),
    /// An expression in `gcode.end`, for what is known at the end only.
    AtEnd(NumberKind, &'static str),
    /// No expression stands for the name. The text says why, or what to write
    /// instead.
    None(&'static str),
}

use NumberKind::{Number, Other, Whole};
use Ours::{AtEnd, ByScope, Is, None, OfLayer, Pair};

const NO_CHAMBER: &str =
    "isoslice heats no chamber: write its temperature as a number";
const NO_CLOCK: &str = "files of the same input are the same, so there is no \
                        clock: --timestamp puts the time into the first line";
const NO_NOTES: &str = "profiles have no notes: {{ printer.model }} and \
                        {{ gcode.flavour }} tell printers apart";
const ONE_MATERIAL: &str = "isoslice prints one material with one extruder: \
                            leave out what is for several";
/// Why [`Ours::AtEnd`] has no value in other templates.
pub(super) const AT_THE_END: &str = "it is known in gcode.end only, as {{ print_time }}, {{ filament_length }} \
     and {{ filament_mass }} are";

/// The foreign names, grouped by meaning.
pub(super) const NAMES: &[(&str, Ours)] = pairs! {
    // Heat.
    "first_layer_temperature", "nozzle_temperature_initial_layer",
        "material_print_temperature_layer_0",
        "material_initial_print_temperature", "extruder0_temperature"
        => FIRST_NOZZLE;
    "temperature", "nozzle_temperature", "material_print_temperature",
        "material_final_print_temperature", "default_material_print_temperature"
        => NOZZLE;
    "first_layer_bed_temperature", "bed_temperature_initial_layer",
        "bed_temperature_initial_layer_single",
        "bed_temperature_initial_layer_vector", "hot_plate_temp_initial_layer",
        "cool_plate_temp_initial_layer", "eng_plate_temp_initial_layer",
        "textured_plate_temp_initial_layer",
        "supertack_plate_temp_initial_layer",
        "material_bed_temperature_layer_0", "bed0_temperature" => FIRST_BED;
    "bed_temperature", "hot_plate_temp", "cool_plate_temp", "eng_plate_temp",
        "textured_plate_temp", "supertack_plate_temp",
        "material_bed_temperature", "default_material_bed_temperature" => BED;
    "chamber_temperature", "chamber_minimal_temperature",
        "overall_chamber_temperature", "build_volume_temperature"
        => None(NO_CHAMBER);
    "idle_temperature", "material_standby_temperature"
        => None("isoslice has one temperature while it waits: write a number");
    // Layers and heights.
    "layer_num" => OfLayer(Whole, "(layer - 1)", "(layer_count - 1)");
    "layer_z" => OfLayer(Number, "layer_z", "part_max_z");
    "max_layer_z" => ByScope(Number, "layer_z", "part_max_z");
    "total_layer_count", "total_layer_number", "layer_count"
        => Is(Whole, "layer_count");
    "layer_height" => Is(Number, "layer_height");
    "first_layer_height", "initial_layer_print_height", "initial_layer_height",
        "layer_height_0" => Is(Number, "first_layer_height");
    "z_offset" => Is(Number, "0");
    // The machine.
    "print_bed_max" => Pair("bed_x", "bed_y");
    "print_bed_min" => Pair("0", "0");
    "print_bed_size" => Pair("bed_x", "bed_y");
    "machine_width" => Is(Number, "bed_x");
    "machine_depth" => Is(Number, "bed_y");
    "machine_height", "max_print_height", "printable_height"
        => Is(Number, "height");
    "nozzle_diameter", "machine_nozzle_size" => Is(Number, "nozzle_diameter");
    "printer_model", "machine_name" => Is(Other, "printer.model");
    "printer_notes", "filament_notes" => None(NO_NOTES);
    "curr_bed_type" => None("profiles do not say which plate is on the bed");
    // The part.
    "first_layer_print_min" => Pair("part_min_x", "part_min_y");
    "first_layer_print_max" => Pair("part_max_x", "part_max_y");
    "first_layer_print_size"
        => Pair("(part_max_x - part_min_x)", "(part_max_y - part_min_y)");
    "first_layer_center_no_wipe_tower" => MIDDLE;
    "first_layer_print_convex_hull"
        => None("write the part's box, {{ part_min_x }} to {{ part_max_y }}");
    "input_filename_base", "input_filename", "plate_name", "jobname",
        "print_job_name" => Is(Other, "model_name");
    // Filament, retraction, speed.
    "filament_diameter", "material_diameter" => Is(Number, "filament_diameter");
    "filament_type", "material_type" => Is(Other, "filament.material");
    "filament_density" => Is(Number, "filament.density");
    "filament_cost" => Is(Number, "filament.cost");
    "filament_max_volumetric_speed" => Is(Number, "filament.max_flow");
    "retract_length", "retraction_length", "retraction_amount"
        => Is(Number, "retract_length");
    "retract_speed", "retraction_speed", "retraction_retract_speed"
        => Is(Number, "retract.speed");
    "deretract_speed", "deretraction_speed", "retraction_prime_speed"
        => Is(Number, "retract.prime_speed");
    "retract_lift", "z_hop", "retraction_hop" => Is(Number, "retract.z_hop");
    "travel_speed", "speed_travel" => Is(Number, "speed.travel");
    "travel_speed_z" => Is(Number, "printer.max_speed_z");
    "machine_max_acceleration_extruding" => ACCELERATION;
    "machine_max_acceleration_travel"
        => Is(Number, "printer.travel_acceleration");
    "default_acceleration" => ACCELERATION;
    // How it is printed.
    "perimeters", "wall_loops", "wall_line_count" => Is(Whole, "walls");
    "fill_density", "sparse_infill_density", "infill_sparse_density"
        => Is(Number, "infill_density");
    // Extruders, of which there is one.
    "initial_tool", "initial_extruder", "initial_extruder_nr",
        "initial_no_support_extruder", "current_extruder", "current_tool"
        => FIRST_TOOL;
    "num_extruders" => Is(Whole, "1");
    "total_toolchanges" => Is(Whole, "0");
    "is_extruder_used" => Is(Other, "true");
    "has_wipe_tower", "has_single_extruder_multi_material_priming"
        => Is(Other, "false");
    "next_extruder", "previous_extruder", "toolchange_z" => None(ONE_MATERIAL);
    // Values that are known at the end only.
    "print_time", "normal_print_time", "silent_print_time"
        => AtEnd(Other, "print_time");
    "used_filament", "filament_amount" => METRES;
    "extruded_volume", "extruded_volume_total" => VOLUME;
    "extruded_weight", "extruded_weight_total", "total_weight",
        "filament_weight" => MASS;
    "total_cost" => AtEnd(Number, "(filament_mass * filament.cost / 1000)");
    "timestamp", "year", "month", "day", "hour", "minute", "second", "date",
        "time" => None(NO_CLOCK);
};

const FIRST_NOZZLE: Ours = Is(Whole, "first_layer_nozzle_temperature");
const NOZZLE: Ours = Is(Whole, "nozzle_temperature");
const FIRST_BED: Ours = Is(Whole, "first_layer_bed_temperature");
const BED: Ours = Is(Whole, "bed_temperature");
const FIRST_TOOL: Ours = Is(Whole, "0");
const ACCELERATION: Ours = Is(Number, "printer.acceleration");
const METRES: Ours = AtEnd(Number, "(filament_length / 1000)");
const MASS: Ours = AtEnd(Number, "filament_mass");
const VOLUME: Ours = AtEnd(
    Number,
    "(filament_length * 0.785398163397448 * filament_diameter ** 2)",
);
const MIDDLE: Ours = Pair(
    "((part_min_x + part_max_x) / 2)",
    "((part_min_y + part_max_y) / 2)",
);

/// What stands for a foreign name.
pub(super) fn ours(name: &str) -> Option<Ours> {
    let found = NAMES.iter().find(|(theirs, _)| *theirs == name);
    found.map(|(_, ours)| *ours)
}
