//! Keys of filaments.

use super::PresetKind::Filament;
use super::{
    As, BOTH, LIFTED, ORCA, PRUSA, Row, Rule, SEVERAL, SHOWN, made, make,
};
use Rule::{Ignored, Lost, To};

const SHORT: &str = "isoslice has rules of its own for which beads of a short \
                     layer are slowed";
const ANOTHER_FAN: &str = "isoslice drives the part's fan only: M106 P in \
                           gcode.start sets another one";

pub(super) static ROWS: &[Row] = rows! {
    BOTH Filament {
        "filament_type" => To("filament.material", As::Name);
        "filament_diameter" => To("filament.diameter", As::Positive);
        "filament_density" => To("filament.density", As::Positive);
        "filament_cost" => To("filament.cost", As::Number);
        "extrusion_multiplier", "filament_flow_ratio"
            => To("filament.flow", As::Ratio);
        "filament_max_volumetric_speed"
            => made(make::max_flow, &["filament.max_flow"],
                "0 is no limit, 500 mm³/s");
        "temperature", "nozzle_temperature", "first_layer_temperature",
            "nozzle_temperature_initial_layer",
            "nozzle_temperature_intial_layer"
            => made(make::nozzle_temperatures,
                &["filament.nozzle_temperature",
                  "filament.first_layer_nozzle_temperature"],
                "the first layer's is the other if it is 0");
        "bed_temperature", "first_layer_bed_temperature", "hot_plate_temp",
            "hot_plate_temp_initial_layer", "cool_plate_temp",
            "cool_plate_temp_initial_layer", "eng_plate_temp",
            "eng_plate_temp_initial_layer", "textured_plate_temp",
            "textured_plate_temp_initial_layer", "supertack_plate_temp",
            "supertack_plate_temp_initial_layer", "textured_cool_plate_temp",
            "textured_cool_plate_temp_initial_layer", "epoxy_resin_plate_temp",
            "epoxy_resin_plate_temp_initial_layer", "customized_plate_temp",
            "customized_plate_temp_initial_layer"
            => made(make::bed_temperatures,
                &["filament.bed_temperature",
                  "filament.first_layer_bed_temperature"],
                "of the plate that the profile names, or the smooth hot one, \
                 or the first that may be used");
        "pressure_advance", "enable_pressure_advance"
            => made(make::advance, &["filament.pressure_advance"],
                "if it is on");
        "start_filament_gcode", "filament_start_gcode"
            => made(make::filament_start, &["filament.pressure_advance"],
                "a single M900 K, M572 S or SET_PRESSURE_ADVANCE with a plain \
                 number");
        "cooling", "fan_always_on", "reduce_fan_stop_start_freq",
            "min_fan_speed", "fan_min_speed", "max_fan_speed", "fan_max_speed",
            "fan_below_layer_time", "fan_cooling_layer_time"
            => made(make::fan,
                &["cooling.fan_speed", "cooling.short_layer_fan_speed",
                  "cooling.long_layer_time"],
                "the least speed is that of long layers, the greatest that of \
                 short ones");
        "bridge_fan_speed", "overhang_fan_speed", "enable_overhang_bridge_fan",
            "enable_dynamic_fan_speeds", "overhang_fan_speed_0",
            "overhang_fan_speed_1", "overhang_fan_speed_2",
            "overhang_fan_speed_3"
            => made(make::overhang_fan,
                &["cooling.bridge_fan_speed", "cooling.overhang_fan_speed",
                  "cooling.internal_bridge_fan_speed"],
                "the fan at each quarter of overlap becomes a step; if \
                 overhangs have no fan of their own, that of layers");
    }
    PRUSA Filament {
        "overhangs_fan_speed"
            => made(
                |given| make::fan_unless_negative(given,
                    &["overhangs_fan_speed"],
                    "cooling.overhang_fan_speed"),
                &["cooling.overhang_fan_speed"], "-1 leaves it");
    }
    BOTH Filament {
        "internal_bridge_fan_speed", "bridge_internal_fan_speed"
            => made(
                |given| make::fan_unless_negative(given,
                    &["internal_bridge_fan_speed", "bridge_internal_fan_speed"],
                    "cooling.internal_bridge_fan_speed"),
                &["cooling.internal_bridge_fan_speed"], "-1 leaves it");
        "support_material_interface_fan_speed"
            => made(
                |given| make::fan_unless_negative(given,
                    &["support_material_interface_fan_speed"],
                    "cooling.support_interface_fan_speed"),
                &["cooling.support_interface_fan_speed"], "-1 leaves it");
        "disable_fan_first_layers", "close_fan_the_first_x_layers"
            => To("cooling.fan_off_layers", As::Number);
        "full_fan_speed_layer", "full_fan_speed_layers"
            => To("cooling.full_fan_layer", As::Number);
        "slowdown_below_layer_time", "slow_down_layer_time",
            "slow_down_for_layer_cooling"
            => made(make::min_layer_time, &["cooling.min_layer_time"],
                "0 if layers are not to be slowed down");
        "min_print_speed", "slow_down_min_speed"
            => To("cooling.min_speed", As::Positive);
        "filament_retract_length", "filament_retraction_length"
            => To("retract.length", As::Number);
        "filament_retract_speed", "filament_retraction_speed",
            "filament_deretract_speed", "filament_deretraction_speed"
            => made(|given| make::retract_speeds(given, "filament_"),
                &["retract.speed", "retract.prime_speed"],
                "0 for pushing forward is as fast as pulling back");
        "filament_retract_before_travel", "filament_retraction_minimum_travel"
            => To("retract.min_travel", As::Number);
        "filament_retract_before_wipe"
            => To("retract.before_wipe", As::Percent);
        "filament_retract_restart_extra"
            => To("retract.extra_prime", As::Number);
        "filament_retract_lift", "filament_z_hop",
            "filament_travel_ramping_lift", "filament_travel_max_lift"
            => made(|given| make::z_hop(given, "filament_"), &["retract.z_hop"],
                "of lifts that ramp up the greatest");
        "filament_wipe", "filament_wipe_distance"
            => made(|given| make::wipe(given, "filament_"), &["retract.wipe"],
                "2 mm if no distance is given");
        "filament_shrink", "filament_shrinkage_compensation_xy",
            "filament_shrinkage_compensation_z"
            => Lost(&["100%", "100", "0%", "0"],
                "scale the model with --scale; of a compensation of 0.2 % by \
                 1.002");
        "chamber_temperature", "chamber_temperatures",
            "chamber_minimal_temperature", "box_temperature",
            "activate_chamber_temp_control"
            => Lost(&["0"],
                "isoslice heats no chamber by itself: M141 and M191 in \
                 gcode.start do");
        "filament_end_gcode", "end_filament_gcode"
            => made(make::filament_end, &[], "add what it does to gcode.end");
        "additional_cooling_fan_speed_unseal", "activate_air_filtration",
            "complete_print_exhaust_fan_speed",
            "enable_special_area_additional_cooling_fan",
            "close_additional_fan_first_x_layers",
            "additional_fan_full_speed_layer", "enable_auxiliary_fan_unseal",
            "cool_cds_fan_start_at_height", "cool_special_cds_fan_speed",
            "enable_volume_fan", "disable_rapid_cooling_fan_first_layers",
            "seal_print", "first_x_layer_fan_speed"
            => Ignored(ANOTHER_FAN);
        "overhang_fan_threshold"
            => Ignored(
                "the fan has a speed for layers, bridges, overhangs and the \
                 tops of supports; overhang_share says what an overhang is");
        "adaptive_pressure_advance_bridges", "adaptive_pressure_advance_model",
            "adaptive_pressure_advance_overhangs", "enable_advance_pressure"
            => Ignored("there is one pressure advance for all speeds");
        "nozzle_temperature_range_high", "nozzle_temperature_range_low",
            "temperature_vitrification", "bed_temperature_difference",
            "box_temperature_range_high", "box_temperature_range_low",
            "filament_abrasive", "impact_strength_z",
            "filament_adhesiveness_category", "filament_extruder_compatibility",
            "filament_velocity_adaptation_factor",
            "volumetric_speed_coefficients", "pellet_flow_coefficient"
            => Ignored("it warns or advises, and changes no line");
        "filament_infill_max_crossing_speed", "filament_infill_max_speed",
            "filament_max_speed", "filament_adaptive_volumetric_speed"
            => Ignored("filament.max_flow is the filament's limit");
        "filament_retract_lift_enforce", "filament_travel_slope",
            "filament_travel_lift_before_obstacle", "filament_seam_gap",
            "filament_wipe_advanced_pigment", "filament_wipe_extra_perimeter",
            "filament_wipe_only_crossing", "filament_wipe_speed",
            "filament_scarf_seam_type", "filament_scarf_gap",
            "filament_scarf_height", "filament_scarf_length"
            => Ignored(LIFTED);
        "filament_colour", "default_filament_colour", "filament_vendor",
            "filament_notes", "filament_settings_id", "filament_id",
            "filament_ids", "filament_spool_weight", "filament_colour_type",
            "filament_multi_colour", "compatible_prints",
            "compatible_prints_condition",
            "compatible_prints_condition_cummulative",
            "filament_custom_variables", "filament_map", "filament_is_support",
            "filament_soluble", "filament_metal_stickiness",
            "filament_printable"
            => Ignored(SHOWN);
        "filament_loading_speed", "filament_loading_speed_start",
            "filament_unloading_speed", "filament_unloading_speed_start",
            "filament_load_time", "filament_unload_time",
            "filament_toolchange_delay", "filament_cooling_moves",
            "filament_cooling_initial_speed", "filament_cooling_final_speed",
            "filament_ramming_parameters",
            "filament_minimal_purge_on_wipe_tower",
            "filament_multitool_ramming", "filament_multitool_ramming_flow",
            "filament_multitool_ramming_volume", "filament_stamping_distance",
            "filament_stamping_loading_speed", "filament_purge_multiplier",
            "filament_retract_length_toolchange",
            "filament_retract_restart_extra_toolchange",
            "filament_prime_volume", "filament_long_retractions_when_cut",
            "filament_retraction_distances_when_cut",
            "filament_long_retractions_when_ec",
            "filament_retraction_distances_when_ec",
            "filament_cooling_before_tower",
            "filament_preheat_temperature_delta",
            "filament_tower_interface_pre_extrusion_dist",
            "filament_tower_interface_pre_extrusion_length",
            "filament_tower_ironing_area",
            "filament_tower_interface_purge_volume",
            "filament_tower_interface_print_temp", "filament_flush_temp",
            "filament_flush_temp_fast", "filament_flush_volumetric_speed",
            "filament_ramming_travel_time", "filament_ramming_volumetric_speed",
            "filament_pre_cooling_temperature", "filament_change_length",
            "filament_extruder_variant", "filament_self_index",
            "filament_cooling_zone_pause", "filament_melt_zone_pause",
            "filament_enable_toolchange_part_fan",
            "filament_enable_toolchange_temp",
            "filament_toolchange_part_fan_speed", "filament_toolchange_temp",
            "filament_dip_extraction_speed", "filament_dip_insertion_speed",
            "filament_max_overlap", "filament_max_wipe_tower_speed",
            "filament_skinnydip_distance", "filament_use_fast_skinnydip",
            "filament_use_skinnydip", "idle_temperature",
            "filament_dev_ams_drying_ams_limitations",
            "filament_dev_ams_drying_temperature",
            "filament_dev_ams_drying_time",
            "filament_dev_drying_softening_temperature",
            "filament_dev_ams_drying_heat_distortion_temperature",
            "filament_dev_drying_cooling_temperature",
            "filament_dev_chamber_drying_bed_temperature",
            "filament_dev_chamber_drying_time"
            => Ignored(SEVERAL);
    }
    ORCA Filament {
        "long_retractions_when_ec", "retraction_distances_when_ec"
            => Ignored(SEVERAL);
    }
    BOTH Filament {
        "additional_cooling_fan_speed", "during_print_exhaust_fan_speed",
            "enable_auxiliary_fan"
            => Lost(&["0"],
                "isoslice drives one fan: set others in gcode.layer");
        "external_perimeter_fan_speed", "top_fan_speed", "ironing_fan_speed"
            => Lost(&["-1"],
                "the fan has a speed for layers, bridges, overhangs and the \
                 tops of supports");
        "dont_slow_down_outer_wall", "no_slow_down_for_cooling_on_outwalls",
            "cooling_perimeter_transition_distance"
            => Lost(&["0"], SHORT);
        "cooling_slowdown_logic"
            => Lost(&["uniform_cooling", "uniform", "0"], SHORT);
        // SuperSlicer's default is 90 (%): beads slowed so far run at about
        // cooling.min_speed, so nothing is lost.
        "max_speed_reduction"
            => Lost(&["90", "90%", "100", "100%"], SHORT);
        "adaptive_pressure_advance"
            => Lost(&["0"],
                "there is one pressure advance for all speeds: \
                 filament.pressure_advance");
        "filament_retract_layer_change", "filament_retract_when_changing_layer"
            => Lost(&["0"],
                "isoslice decides by what a travel crosses where to retract");
        "filament_retract_lift_above", "filament_retract_lift_below"
            => Lost(&["0"],
                "lifts are the same at all heights: retract.z_hop_when");
        "filament_z_hop_types"
            => Lost(&["Normal Lift", "normal"],
                "isoslice lifts straight up: retract.z_hop");
    }
    PRUSA Filament {
        "filament_load_unload_time" => Ignored(SEVERAL);
    }
};
