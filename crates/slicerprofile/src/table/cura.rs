//! Keys of Cura.

use super::PresetKind::{Filament, Print, Printer};
use super::{
    As, CURA, EXACT, FLOW, JERK, Outcome, RAFT, Row, Rule, SEVERAL, SUPPORTS,
    made, make, patterns,
};
use crate::given::{Given, Value};
use crate::values::parse;
use Rule::{Ignored, Lost, To};
use make::{lost, nothing};

pub(super) static ROWS: &[Row] = rows! {
    CURA Printer {
        "machine_width" => To("printer.bed_x", As::Positive);
        "machine_depth" => To("printer.bed_y", As::Positive);
        "machine_height" => To("printer.height", As::Positive);
        "machine_nozzle_size" => To("printer.nozzle_diameter", As::Positive);
        "machine_gcode_flavor"
            => To("gcode.flavour", As::Words(pairs! {
                "reprap (marlin/sprinter)", "marlin" => "marlin";
                "reprap (reprap)" => "rrf";
                "repetier" => "marlin";
            }));
        "machine_start_gcode" => To("gcode.start", As::Template);
        "machine_end_gcode" => To("gcode.end", As::Template);
        "machine_acceleration" => To("printer.acceleration", As::Positive);
        "machine_max_acceleration_z"
            => To("printer.max_acceleration_z", As::Positive);
        "machine_max_acceleration_e"
            => To("printer.retract_acceleration", As::Positive);
        "machine_max_feedrate_x", "machine_max_feedrate_y"
            => made(make::max_speed, &["printer.max_speed"],
                "the least of both");
        "machine_max_feedrate_z" => To("printer.max_speed_z", As::Positive);
        "machine_max_jerk_xy"
            => To("printer.square_corner_velocity", As::Positive);
        "relative_extrusion" => To("gcode.relative_e", As::Switch);
        "machine_firmware_retract" => To("retract.firmware", As::Switch);
        "machine_center_is_zero"
            => Lost(&["false", "False", "0"],
                "isoslice's zero is the bed's front left corner: G-code of \
                 this profile would print in the wrong place. Set the \
                 firmware's zero, or shift it in gcode.start (G92)");
    }
    CURA Filament {
        "material_diameter" => To("filament.diameter", As::Positive);
        "material_flow" => To("filament.flow", As::Percent);
        "material_print_temperature", "default_material_print_temperature",
            "material_print_temperature_layer_0"
            => made(
                |given| temperatures(given, "print", [
                    "filament.nozzle_temperature",
                    "filament.first_layer_nozzle_temperature",
                ]),
                &["filament.nozzle_temperature",
                  "filament.first_layer_nozzle_temperature"],
                "the first layer's is the other if it is not given");
        "material_bed_temperature", "default_material_bed_temperature",
            "material_bed_temperature_layer_0"
            => made(
                |given| temperatures(given, "bed", [
                    "filament.bed_temperature",
                    "filament.first_layer_bed_temperature",
                ]),
                &["filament.bed_temperature",
                  "filament.first_layer_bed_temperature"],
                "the first layer's is the other if it is not given");
        "cool_fan_enabled", "cool_fan_speed", "cool_fan_speed_min",
            "cool_fan_speed_max", "bridge_fan_speed"
            => made(fan,
                &["cooling.fan_speed", "cooling.short_layer_fan_speed",
                  "cooling.bridge_fan_speed",
                  "cooling.internal_bridge_fan_speed",
                  "cooling.overhang_fan_speed"],
                "0 if the fan is off; bridges without a fan of their own, and \
                 overhangs, have that of layers");
        "cool_fan_full_layer" => To("cooling.full_fan_layer", As::Number);
        "cool_min_layer_time" => To("cooling.min_layer_time", As::Number);
        "cool_min_layer_time_fan_speed_max"
            => To("cooling.long_layer_time", As::Number);
        "cool_min_speed" => To("cooling.min_speed", As::Positive);
    }
    CURA Printer {
        "retraction_enable", "retraction_amount"
            => made(
                |given| when(given, "retraction_enable", "retraction_amount",
                    "retract.length"),
                &["retract.length"], "0 if retraction is off");
        "retraction_hop_enabled", "retraction_hop"
            => made(
                |given| when(given, "retraction_hop_enabled", "retraction_hop",
                    "retract.z_hop"),
                &["retract.z_hop"], "0 if lifting is off");
        "retraction_retract_speed", "retraction_speed"
            => To("retract.speed", As::Positive);
        "retraction_prime_speed" => To("retract.prime_speed", As::Positive);
        "retraction_min_travel" => To("retract.min_travel", As::Number);
        "retraction_extra_prime_amount"
            => made(extra_prime, &["retract.extra_prime"],
                "the length of filament of material_diameter, or 1.75 mm, with \
                 that volume");
    }
    CURA Print {
        "layer_height" => To("layer_height", As::Positive);
        "layer_height_0" => To("first_layer_height", As::Positive);
        "wall_line_count", "wall_thickness"
            => made(walls, &["walls"],
                "as many lines as the thickness takes, unless it says how \
                 many");
        "magic_spiralize" => To("spiral", As::Switch);
        "line_width", "wall_line_width", "wall_line_width_0",
            "wall_line_width_x", "infill_line_width", "skin_line_width",
            "roofing_line_width"
            => made(widths,
                &["outer_wall_width", "inner_wall_width", "infill_width",
                  "skin_width", "top_skin_width"],
                "those that are not given follow from others, as in Cura");
        "top_bottom_thickness", "top_thickness", "top_layers",
            "bottom_thickness", "bottom_layers"
            => made(skins, &["top_layers", "bottom_layers"],
                "layers come before a thickness");
        "infill_sparse_density" => To("infill_density", As::Percent);
        "infill_pattern" => To("infill", patterns::INFILL_OF_CURA);
        "infill_overlap" => To("infill_overlap", As::Percent);
        "top_bottom_pattern" => To("skin_pattern", patterns::SKIN_OF_CURA);
        "z_seam_type"
            => To("seam", As::Words(pairs! {
                "sharpest_corner" => "aligned";
                "back" => "rear";
                "shortest" => "nearest";
                "random" => "random";
            }));
        "outer_inset_first", "inset_direction"
            => To("wall_order", As::Words(pairs! {
                "true", "1" => "outer-first";
                "false", "0", "inside_out" => "inner-first";
                "outside_in" => "outer-first";
            }));
        "xy_offset" => To("xy_compensation", As::Number);
        "ironing_enabled", "ironing_flow"
            => made(ironing, &["ironing"], "the flow if it is on");
        "ironing_line_spacing" => To("ironing_spacing", As::Positive);
        "speed_ironing" => To("speed.ironing", As::Positive);
        "speed_print", "speed_wall", "speed_wall_0", "speed_wall_x",
            "speed_infill", "speed_topbottom", "speed_roofing", "speed_layer_0",
            "speed_print_layer_0", "skirt_brim_speed", "speed_support",
            "speed_support_interface"
            => made(speeds,
                &["speed.outer_wall", "speed.inner_wall", "speed.sparse_infill",
                  "speed.internal_skin", "speed.bottom_skin", "speed.top_skin",
                  "speed.first_layer", "speed.skirt", "speed.support",
                  "speed.support_interface"],
                "those that are not given follow from others, as in Cura: \
                 speed_wall is half of speed_print, speed_wall_x twice \
                 speed_wall");
        "wall_overhang_angle", "wall_overhang_speed_factor",
            "wall_overhang_speed_factors"
            => made(overhang_speed, &["speed.overhang"],
                "shares of a wall's width from the angle on, with the \
                 profile's layers and lines");
        "bridge_skin_speed" => To("speed.bridge", As::Positive);
        "speed_travel" => To("speed.travel", As::Positive);
        "acceleration_enabled", "acceleration_print", "acceleration_wall",
            "acceleration_wall_0", "acceleration_wall_x", "acceleration_infill",
            "acceleration_topbottom", "acceleration_roofing",
            "acceleration_layer_0", "acceleration_travel"
            => made(accelerations,
                &["printer.acceleration", "acceleration.outer_wall",
                  "acceleration.inner_wall", "acceleration.sparse_infill",
                  "acceleration.internal_skin", "acceleration.bottom_skin",
                  "acceleration.top_skin", "acceleration.first_layer",
                  "printer.travel_acceleration"], "if accelerations are on");
        "jerk_enabled", "jerk_print"
            => made(jerk, &["printer.square_corner_velocity"], "if jerk is on");
        "adhesion_type", "brim_width", "brim_line_count", "skirt_line_count",
            "raft_surface_layers", "raft_interface_layers", "raft_base_layers",
            "raft_airgap", "raft_margin"
            => made(adhesion,
                &["skirt.loops", "brim.place", "brim.width", "raft.layers",
                  "raft.gap", "raft.expansion"],
                "a skirt, a brim, a raft, or none");
        "skirt_gap" => To("skirt.distance", As::Number);
        "brim_gap" => To("brim.gap", As::Number);
        "support_enable", "support_type"
            => made(supports, &["supports"],
                "auto, or plate for those on the bed only");
        "support_structure"
            => To("support.style", As::Words(pairs! {
                "normal" => "snug";
                "tree" => "tree";
            }));
        "support_angle" => To("support.angle", As::Number);
        "support_tree_angle" => To("support.branch_angle", As::Number);
        "support_xy_distance" => To("support.xy_gap", As::Positive);
        "support_top_distance", "support_z_distance"
            => To("support.z_gap", As::Number);
        "support_bottom_distance" => To("support.z_gap_bottom", As::Number);
        "support_infill_rate" => To("support.density", As::Percent);
        "support_interface_density"
            => To("support.interface_density", As::Percent);
        "retraction_combing", "retraction_combing_max_distance"
            => made(combing,
                &["travel.combing", "retract.when_crossing",
                    "retract.max_unretracted"],
                "off: all travels retract; a distance of 0 is any");
        "magic_fuzzy_skin_enabled", "magic_fuzzy_skin_thickness"
            => made(
                |given| when(given, "magic_fuzzy_skin_enabled",
                    "magic_fuzzy_skin_thickness", "fuzzy.thickness"),
                &["fuzzy.thickness"], "0 if it is off");
        "adaptive_layer_height_enabled"
            => To("layer_heights", As::Words(pairs! {
                "true", "1" => "adaptive";
                "false", "0" => "uniform";
            }));
        "xy_offset_layer_0"
            => made(elephant_foot, &["elephant_foot"], "what it draws in");
        "draft_shield_enabled", "draft_shield_height_limitation",
            "draft_shield_height", "draft_shield_dist"
            => made(draft_shield, &["draft_shield", "skirt.distance"],
                "if there is one");
        "infill_material_flow", "skin_material_flow", "wall_0_material_flow",
            "wall_x_material_flow"
            => Lost(&["100"], FLOW);
        "mold_enabled", "magic_mesh_surface_mode", "wire_frame_enabled",
            "conical_overhang_enabled", "ooze_shield_enabled"
            => Lost(&["false", "False", "0", "normal"],
                "isoslice has nothing like it; change the model instead");
    }
    CURA Printer {
        "machine_name", "machine_heated_bed", "machine_extruder_count",
            "machine_head_with_fans_polygon", "machine_head_polygon",
            "gantry_height", "machine_shape", "machine_disallowed_areas",
            "machine_steps_per_mm_x", "machine_steps_per_mm_y",
            "machine_steps_per_mm_z", "machine_steps_per_mm_e",
            "machine_nozzle_head_distance", "machine_nozzle_heat_up_speed",
            "machine_nozzle_cool_down_speed",
            "machine_min_cool_heat_time_window",
            "machine_use_extruder_offset_to_offset_coords",
            "machine_nozzle_tip_outer_diameter",
            "machine_nozzle_expansion_angle", "machine_heat_zone_length",
            "machine_filament_park_distance", "machine_heated_build_volume",
            "machine_show_variants", "machine_endstop_positive_direction_x",
            "machine_endstop_positive_direction_y",
            "machine_endstop_positive_direction_z",
            "machine_feeder_wheel_diameter", "machine_minimum_feedrate",
            "machine_max_acceleration_x", "machine_max_acceleration_y",
            "machine_max_jerk_e", "machine_max_jerk_z",
            "machine_max_feedrate_e", "material_bed_temp_wait",
            "material_print_temp_wait", "material_bed_temp_prepend",
            "material_print_temp_prepend", "machine_extruders_share_heater",
            "machine_extruders_share_nozzle", "machine_buildplate_type",
            "machine_scale_fan_speed_zero_to_one", "material_guid",
            "material_name"
            => Ignored(
                "it describes parts of the machine that isoslice does not \
                 drive, or that the firmware knows");
    }
    CURA Print {
        "prime_tower_enable", "prime_tower_size", "prime_tower_position_x",
            "prime_tower_position_y", "prime_tower_min_volume",
            "prime_tower_wipe_enabled", "prime_tower_flow",
            "prime_tower_line_width", "prime_tower_brim_enable",
            "speed_prime_tower", "acceleration_prime_tower", "jerk_prime_tower",
            "switch_extruder_retraction_amount",
            "switch_extruder_retraction_speeds", "switch_extruder_prime_speed",
            "material_standby_temperature",
            "material_initial_print_temperature",
            "material_final_print_temperature", "prime_blob_enable",
            "extruder_prime_pos_x", "extruder_prime_pos_y",
            "multiple_mesh_overlap", "ooze_shield_angle",
            "extruder_prime_pos_abs", "extruder_prime_pos_z",
            "switch_extruder_retraction_speed", "adhesion_extruder_nr",
            "wall_0_extruder_nr", "wall_extruder_nr", "infill_extruder_nr",
            "top_bottom_extruder_nr", "support_extruder_nr"
            => Ignored(SEVERAL);
        "support_interface_enable", "support_interface_height",
            "support_interface_pattern", "support_use_towers",
            "support_roof_enable", "support_bottom_enable",
            "support_xy_overrides_z", "support_xy_distance_overhang",
            "support_offset", "support_wall_count", "support_connect_zigzags",
            "support_interface_skip_height", "support_interface_line_width",
            "support_line_width", "support_join_distance",
            "minimum_support_area", "acceleration_support",
            "acceleration_support_interface", "acceleration_support_infill",
            "jerk_support", "jerk_support_interface", "speed_support_infill",
            "zig_zaggify_support", "support_brim_line_count",
            "support_brim_enable", "support_brim_width",
            "minimum_interface_area", "gradual_support_infill_steps",
            "gradual_support_infill_step_height", "support_bottom_height",
            "support_roof_height", "support_bottom_pattern",
            "support_roof_pattern", "support_tree_enable",
            "acceleration_support_roof", "acceleration_support_bottom",
            "jerk_support_infill", "speed_support_roof", "speed_support_bottom",
            "jerk_support_roof", "jerk_support_bottom",
            "support_infill_sparse_thickness", "support_interface_offset",
            "support_infill_angles", "support_roof_density"
            => Ignored(SUPPORTS);
        "jerk_travel_enabled"
            => Ignored(JERK);
        "optimize_wall_printing_order", "fill_outline_gaps",
            "fill_perimeter_gaps",
            "travel_compensate_overlapping_walls_enabled",
            "travel_compensate_overlapping_walls_0_enabled",
            "filter_out_tiny_gaps", "wall_min_flow", "infill_before_walls",
            "infill_wipe_dist", "wall_0_wipe_dist", "skin_overlap",
            "z_seam_corner", "z_seam_x", "z_seam_y", "z_seam_relative",
            "retraction_hop_only_when_collides", "retraction_count_max",
            "retraction_extrusion_window",
            "travel_avoid_other_parts", "travel_avoid_supports",
            "travel_avoid_distance", "limit_support_retractions",
            "skirt_brim_minimal_length", "skin_no_small_gaps_heuristic",
            "zig_zaggify_infill", "connect_infill_polygons",
            "infill_multiplier", "infill_line_distance", "min_infill_area",
            "expand_skins_expand_distance", "top_skin_expand_distance",
            "bottom_skin_expand_distance", "minimum_polygon_circumference",
            "skirt_height", "cool_fan_full_at_height",
            "bridge_settings_enabled", "skin_preshrink", "top_skin_preshrink",
            "bottom_skin_preshrink", "gradual_infill_step_height",
            "infill_sparse_thickness", "coasting_volume",
            "brim_outside_only", "brim_replaces_support",
            "wall_transition_angle", "beading_strategy_type", "speed_z_hop",
            "adaptive_layer_height_variation",
            "adaptive_layer_height_variation_step",
            "adaptive_layer_height_threshold",
            "infill_enable_travel_optimization", "bridge_wall_coast",
            "bridge_wall_speed", "bridge_skin_speed_2", "bridge_skin_speed_3",
            "bridge_skin_density_2", "bridge_skin_density_3",
            "bridge_skin_material_flow_2", "bridge_skin_material_flow_3",
            "bridge_wall_min_length", "bridge_sparse_infill_max_density",
            "bridge_skin_support_threshold", "skirt_brim_line_width",
            "layer_start_x", "layer_start_y", "max_skin_angle_for_expansion",
            "min_skin_width_for_expansion", "speed_equalize_flow_enabled",
            "speed_equalize_flow_max", "speed_equalize_flow_width_factor",
            "small_hole_max_size", "top_bottom_pattern_0",
            "travel_compensate_overlapping_walls_x_enabled",
            "acceleration_ironing", "acceleration_skirt_brim",
            "flow_rate_max_extrusion_offset"
            => Ignored("isoslice has rules of its own for it");
        "infill_offset_x", "infill_offset_y"
            => Lost(&["0", "0.0"],
                "patterns are laid out from the middle of the part: write an \
                 infill of your own, with an x or y that is moved");
        "initial_layer_line_width_factor"
            => Lost(&["100", "100.0"],
                "lines have the width of their kind in the first layer, too");
        "speed_slowdown_layers"
            => Lost(&["0", "1", "2"],
                "the layers above the first have their own speeds at once; a \
                 speed may be a formula of z");
        "speed_travel_layer_0", "acceleration_travel_layer_0",
            "acceleration_print_layer_0"
            => Lost(&[],
                "the first layer has one speed and one acceleration: \
                 speed.first_layer, acceleration.first_layer");
        "skin_outline_count"
            => Lost(&["0", "1"], "skins have no walls of their own: walls");
        "skin_alternate_rotation", "alternate_extra_perimeter",
            "cool_lift_head", "coasting_enable", "bridge_enable_more_layers",
            "infill_support_enabled", "retract_at_layer_change",
            "travel_retract_before_outer_wall"
            => Lost(&["0", "False", "false"], "isoslice has no such thing");
        "roofing_layer_count", "gradual_infill_steps"
            => Lost(&["0"],
                "infill_density may be a formula of the place; tops have one \
                 kind of skin");
        "jerk_travel", "jerk_wall", "jerk_wall_0", "jerk_wall_x",
            "jerk_topbottom", "jerk_layer_0", "jerk_travel_layer_0",
            "jerk_infill", "jerk_roofing", "jerk_print_layer_0",
            "jerk_skirt_brim", "jerk_ironing"
            => Lost(&[], JERK);
        "bridge_skin_density", "bridge_skin_material_flow",
            "bridge_wall_material_flow", "material_flow_layer_0"
            => Lost(&["100", "100.0"],
                "bridges have one flow, bridge_flow; walls and skin have flow, \
                 which may be a formula of the place");
        "ironing_pattern" => Lost(&["zigzag"], "ironing runs in lines");
        "ironing_inset", "wall_0_inset"
            => Lost(&["0", "0.0"], "isoslice has no such thing");
        "cool_fan_speed_0"
            => Lost(&["0", "0.0"],
                "the fan is off in the first layers: cooling.fan_off_layers");
        "skin_angles" => Lost(&["[]", "[ ]"], "skin_angle is one angle");
        "support_pattern"
            => Lost(&["zigzag", "lines", "grid"],
                "supports are filled by their style: support.style");
        "support_fan_enable", "support_conical_enabled"
            => Lost(&["0", "False", "false"],
                "supports have settings of their own: the group support");
        "meshfix_maximum_resolution", "meshfix_maximum_deviation",
            "meshfix_maximum_travel_resolution", "meshfix_union_all",
            "meshfix_keep_open_polygons", "meshfix_extensive_stitching",
            "slicing_tolerance", "carve_multiple_volumes", "print_sequence"
            => Ignored(EXACT);
        "raft_surface_thickness", "raft_surface_line_width",
            "raft_surface_line_spacing", "raft_base_thickness",
            "raft_base_line_width", "raft_base_line_spacing",
            "raft_interface_thickness", "raft_interface_line_width",
            "raft_interface_line_spacing", "raft_speed", "raft_smoothing",
            "raft_fan_speed", "layer_0_z_overlap", "raft_base_speed",
            "raft_interface_speed", "raft_surface_speed", "raft_acceleration",
            "raft_jerk"
            => Ignored(RAFT);
    }
};

/// The temperatures above the first layer and on it, of the printing nozzle
/// (`print`) or of the `bed`.
fn temperatures(
    given: &Given<'_>,
    of: &str,
    names: [&'static str; 2],
) -> Outcome {
    let one = |key: String| given.number(&key);
    let above = one(format!("material_{of}_temperature"))
        .or_else(|| one(format!("default_material_{of}_temperature")));
    let first = one(format!("material_{of}_temperature_layer_0"));
    if above.or(first).is_none() {
        return lost("it is a formula: write its value");
    }
    Outcome::known([(names[0], above.or(first)), (names[1], first.or(above))])
}

/// A number, or 0 if its switch is off.
fn when(
    given: &Given<'_>,
    switch: &str,
    key: &str,
    name: &'static str,
) -> Outcome {
    if given.off(switch) {
        return Outcome::set(name, 0.0);
    }
    let number = given.number(key);
    Outcome::known([(name, number)])
}

fn fan(given: &Given<'_>) -> Outcome {
    let one = |key| given.number(key);
    let off = given.off("cool_fan_enabled");
    let or_off = |speed: Option<f64>| if off { Some(0.0) } else { speed };
    let speed = one("cool_fan_speed_min").or(one("cool_fan_speed"));
    let own = !given.off("bridge_settings_enabled");
    let bridge = one("bridge_fan_speed").filter(|_| own).or(speed);
    Outcome::known([
        ("cooling.fan_speed", or_off(speed)),
        (
            "cooling.short_layer_fan_speed",
            or_off(one("cool_fan_speed_max")),
        ),
        ("cooling.bridge_fan_speed", or_off(bridge)),
        ("cooling.internal_bridge_fan_speed", or_off(bridge)),
        ("cooling.overhang_fan_speed", or_off(speed)),
    ])
}

fn extra_prime(given: &Given<'_>) -> Outcome {
    let diameter = given.positive("material_diameter").unwrap_or(1.75);
    let area = std::f64::consts::PI * diameter * diameter / 4.0;
    let volume = given.number("retraction_extra_prime_amount");
    Outcome::known([("retract.extra_prime", volume.map(|v| v / area))])
}

/// The width of outer and of inner walls, if the profile says them.
fn wall_widths(given: &Given<'_>) -> [Option<f64>; 2] {
    let one = |key| given.positive(key);
    let wall = one("wall_line_width").or(one("line_width"));
    ["wall_line_width_0", "wall_line_width_x"].map(|key| one(key).or(wall))
}

fn widths(given: &Given<'_>) -> Outcome {
    let one = |key| given.positive(key);
    let [outer, inner] = wall_widths(given);
    let line = one("line_width");
    let skin = one("skin_line_width").or(line);
    Outcome::known([
        ("outer_wall_width", outer),
        ("inner_wall_width", inner),
        ("infill_width", one("infill_line_width").or(line)),
        ("skin_width", skin),
        ("top_skin_width", one("roofing_line_width").or(skin)),
    ])
}

fn walls(given: &Given<'_>) -> Outcome {
    let by_thickness = |thickness: f64| {
        let nozzle = given.positive("machine_nozzle_size").unwrap_or(0.4);
        let [outer, inner] = wall_widths(given).map(|w| w.unwrap_or(nozzle));
        if thickness > 0.0 {
            (((thickness - outer) / inner).round() + 1.0).max(1.0)
        } else {
            0.0
        }
    };
    let count = given.number("wall_line_count");
    let thickness = given.number("wall_thickness");
    Outcome::known([("walls", count.or(thickness.map(by_thickness)))])
}

fn skins(given: &Given<'_>) -> Outcome {
    let one = |key| given.number(key);
    let both = one("top_bottom_thickness");
    let (top, bottom) = (one("top_layers"), one("bottom_layers"));
    let of = |key, layers: Option<f64>| match layers {
        Some(_) => None,
        None => one(key).or(both),
    };
    let shell = |name, layers: Option<f64>, thickness: Option<f64>| {
        let value = layers.map(Into::into);
        let thick = || Some(format!("{} mm", thickness?).into());
        Some((name, value.or_else(thick)?))
    };
    let both = [
        shell("top_layers", top, of("top_thickness", top)),
        shell("bottom_layers", bottom, of("bottom_thickness", bottom)),
    ];
    Outcome::of(both.into_iter().flatten().collect())
}

fn speeds(given: &Given<'_>) -> Outcome {
    let one = |key| given.positive(key);
    let print = one("speed_print");
    let half = print.map(|v| v / 2.0);
    let wall = one("speed_wall").or(half);
    let skin = one("speed_topbottom").or(half);
    let first = one("speed_print_layer_0").or(one("speed_layer_0")).or(half);
    let support = one("speed_support").or(print);
    Outcome::known([
        ("speed.outer_wall", one("speed_wall_0").or(wall)),
        (
            "speed.inner_wall",
            one("speed_wall_x").or(wall.map(|v| 2.0 * v)),
        ),
        ("speed.sparse_infill", one("speed_infill").or(print)),
        ("speed.internal_skin", skin),
        ("speed.bottom_skin", skin),
        ("speed.top_skin", one("speed_roofing").or(skin)),
        ("speed.first_layer", first),
        (
            "speed.skirt",
            one("skirt_brim_speed").or(one("speed_layer_0")).or(half),
        ),
        ("speed.support", support),
        (
            "speed.support_interface",
            one("speed_support_interface").or(support.map(|v| v / 1.5)),
        ),
    ])
}

/// Walls that lean by more than an angle are slower by a factor, or by several in
/// equal steps from that angle to 90°.
fn overhang_speed(given: &Given<'_>) -> Outcome {
    let list = given.values.first("wall_overhang_speed_factors");
    let factors: Vec<f64> = match list {
        Some(list) => {
            let all = list.trim_matches(['[', ']']).split(',');
            all.filter_map(parse).collect()
        }
        None => given
            .number("wall_overhang_speed_factor")
            .into_iter()
            .collect(),
    };
    let angle = given.number("wall_overhang_angle").unwrap_or(90.0);
    let slows = factors.iter().any(|factor| *factor < 100.0);
    if !slows || !(0.0..90.0).contains(&angle) {
        return nothing("overhangs are as fast as other walls");
    }
    let [outer, _] = wall_widths(given);
    let (Some(width), Some(height)) = (outer, given.positive("layer_height"))
    else {
        return lost(
            "the profile does not say how high layers and how wide lines are: \
             set speed.overhang",
        );
    };
    let mut steps: Vec<String> = Vec::new();
    let mut last = 0.0;
    let mut before = 100.0;
    for (i, factor) in factors.iter().enumerate() {
        let part = i as f64 / factors.len() as f64;
        let leans = angle + part * (90.0 - angle);
        let reach = 100.0 * height * leans.to_radians().tan() / width;
        let reach = (reach * 10.0).round() / 10.0;
        // The speed changes at once, as it does in Cura.
        let (from, to) = (reach.max(last + 0.1), reach.max(last + 0.1) + 0.1);
        if to > 100.0 {
            break;
        }
        let factor = factor.clamp(1.0, 100.0);
        steps.push(format!("{from:.1}: {before}%, {to:.1}: {factor}%"));
        (last, before) = (to, factor);
    }
    if steps.is_empty() {
        return nothing("no wall with these lines leans as far");
    }
    Outcome::set("speed.overhang", steps.join(", "))
}

fn accelerations(given: &Given<'_>) -> Outcome {
    if !given.on("acceleration_enabled") {
        return nothing("accelerations are off");
    }
    let one = |key| given.positive(key);
    let wall = one("acceleration_wall");
    let skin = one("acceleration_topbottom");
    let all = [
        ("printer.acceleration", one("acceleration_print")),
        (
            "acceleration.outer_wall",
            one("acceleration_wall_0").or(wall),
        ),
        (
            "acceleration.inner_wall",
            one("acceleration_wall_x").or(wall),
        ),
        ("acceleration.sparse_infill", one("acceleration_infill")),
        ("acceleration.internal_skin", skin),
        ("acceleration.bottom_skin", skin),
        (
            "acceleration.top_skin",
            one("acceleration_roofing").or(skin),
        ),
        ("acceleration.first_layer", one("acceleration_layer_0")),
        ("printer.travel_acceleration", one("acceleration_travel")),
    ];
    Outcome::known(all)
}

fn ironing(given: &Given<'_>) -> Outcome {
    match given.switch("ironing_enabled") {
        Some(on) => {
            let value = make::ironed(given, on, &["ironing_flow"]);
            Outcome::set("ironing", value)
        }
        None => nothing("whether to iron is not said"),
    }
}

fn elephant_foot(given: &Given<'_>) -> Outcome {
    match given.number("xy_offset_layer_0") {
        Some(x) if x <= 0.0 => Outcome::set("elephant_foot", -x),
        _ => lost("the first layer can only be drawn in"),
    }
}

fn combing(given: &Given<'_>) -> Outcome {
    /// The least length of a travel that retracts, mm, if none is given.
    const USUAL_LEAST: f64 = 1.5;
    let way = match given.values.first("retraction_combing") {
        Some("off") => {
            return Outcome::known([
                ("travel.combing", Some(Value::from("off"))),
                ("retract.when_crossing", Some(false.into())),
            ]);
        }
        Some("all") => Some("everywhere"),
        Some("noskin" | "no_outer_surfaces") => Some("not-over-top-skin"),
        Some("infill") => Some("within-infill"),
        Some(word) => return lost(format!("{word} is not known")),
        None => None,
    };
    let least = given.number("retraction_min_travel").unwrap_or(USUAL_LEAST);
    let most = given.number("retraction_combing_max_distance").map(|most| {
        if most > 0.0 {
            // isoslice refuses a bound below the least length: it would never count.
            most.max(least).min(make::ANY_LENGTH)
        } else {
            make::ANY_LENGTH
        }
    });
    Outcome::known([
        ("travel.combing", way.map(Value::from)),
        ("retract.max_unretracted", most.map(Value::from)),
    ])
}

fn jerk(given: &Given<'_>) -> Outcome {
    let jerk = given.positive("jerk_print");
    match jerk.filter(|_| given.on("jerk_enabled")) {
        Some(v) => Outcome::set("printer.square_corner_velocity", v),
        None => nothing("jerk is off"),
    }
}

fn adhesion(given: &Given<'_>) -> Outcome {
    /// The line's width where the profile names none: that of a nozzle of 0.4 mm.
    const USUAL_LINE: f64 = 0.4;
    let word = given.values.first("adhesion_type").unwrap_or("skirt");
    let word = word.trim_matches('\'');
    let loops = given.number("skirt_line_count").unwrap_or(1.0);
    let loops = if word == "skirt" { loops } else { 0.0 };
    let place = if word == "brim" { "outer" } else { "none" };
    let mut out =
        vec![("skirt.loops", loops.into()), ("brim.place", place.into())];
    // Cura takes the number of lines from the width, unless it is given.
    let lines = given.positive("brim_line_count").map(|count| {
        let own = given.positive("skirt_brim_line_width");
        let width = own.or(given.positive("line_width"));
        count * width.unwrap_or(USUAL_LINE)
    });
    if word == "brim"
        && let Some(width) = lines.or(given.positive("brim_width"))
    {
        out.push(("brim.width", width.into()));
    }
    if word == "raft" {
        let count = |key, usual| given.number(key).unwrap_or(usual);
        let layers = count("raft_surface_layers", 2.0)
            + count("raft_interface_layers", 1.0)
            + count("raft_base_layers", 1.0);
        out.push(("raft.layers", layers.into()));
        let more = [
            ("raft.gap", "raft_airgap"),
            ("raft.expansion", "raft_margin"),
        ];
        for (name, key) in more {
            if let Some(x) = given.number(key) {
                out.push((name, x.into()));
            }
        }
    }
    Outcome::of(out)
}

fn draft_shield(given: &Given<'_>) -> Outcome {
    if !given.on("draft_shield_enabled") {
        return nothing("there is no draft shield");
    }
    let limit = given.values.first("draft_shield_height_limitation");
    let height = given.positive("draft_shield_height");
    let height = match height.filter(|_| limit == Some("limited")) {
        Some(height) => height.into(),
        None => "full".into(),
    };
    let mut out = vec![("draft_shield", height)];
    if let Some(gap) = given.positive("draft_shield_dist") {
        out.push(("skirt.distance", gap.into()));
    }
    Outcome::of(out)
}

fn supports(given: &Given<'_>) -> Outcome {
    let Some(on) = given.switch("support_enable") else {
        return nothing("whether to print supports is not said");
    };
    let plate = given.values.first("support_type") == Some("buildplate");
    make::supported(on, plate)
}
