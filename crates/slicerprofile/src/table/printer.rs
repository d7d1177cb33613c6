//! Keys of printers.

use super::PresetKind::Printer;
use super::{
    As, BOTH, LIFTED, ORCA, PRUSA, Row, Rule, SEVERAL, SHOWN, made, make,
};
use Rule::{Ignored, Lost, To};

const ONE_PART: &str = "it is for several parts one after the other";
const FIRMWARE: &str = "the firmware keeps its own limit";

pub(super) static ROWS: &[Row] = rows! {
    BOTH Printer {
        "bed_shape", "printable_area"
            => made(make::bed, &["printer.bed_x", "printer.bed_y"],
                "the greatest x and y of its corners");
        "max_print_height", "printable_height"
            => To("printer.height", As::Positive);
        "nozzle_diameter" => To("printer.nozzle_diameter", As::Positive);
        "gcode_flavor"
            => made(make::flavour, &["gcode.flavour"],
                "marlin and marlin2 of Prusa's printers are prusa, of Bambu \
                 Lab's bambu");
        "printer_model"
            => made(make::model, &["printer.model"],
                "of Prusa's printers, as the start G-code checks it, and of \
                 Bambu Lab's");
        "use_relative_e_distances" => To("gcode.relative_e", As::Switch);
        "start_gcode", "machine_start_gcode" => To("gcode.start", As::Template);
        "end_gcode", "machine_end_gcode" => To("gcode.end", As::Template);
        "before_layer_gcode", "before_layer_change_gcode", "layer_gcode",
            "layer_change_gcode"
            => made(make::layer, &["gcode.layer"],
                "both together, without marks and G92 E0");
        "machine_max_acceleration_extruding", "machine_max_acceleration_x",
            "machine_max_acceleration_y", "machine_max_acceleration_travel"
            => made(make::accelerations,
                &["printer.acceleration", "printer.travel_acceleration"],
                "the least of the limits for printing, and for travels");
        "machine_max_acceleration_z"
            => To("printer.max_acceleration_z", As::Positive);
        "machine_max_acceleration_retracting"
            => To("printer.retract_acceleration", As::Positive);
        "machine_max_feedrate_x", "machine_max_feedrate_y",
            "machine_max_speed_x", "machine_max_speed_y"
            => made(make::max_speed, &["printer.max_speed"],
                "the least of both");
        "machine_max_feedrate_z", "machine_max_speed_z"
            => To("printer.max_speed_z", As::Positive);
        "machine_max_jerk_x", "machine_max_jerk_y",
            "machine_max_junction_deviation"
            => made(make::corner, &["printer.square_corner_velocity"],
                "the least jerk; of a junction deviation the speed through a \
                 right angle");
        "machine_limits_usage"
            => To("gcode.set_limits", As::Words(pairs! {
                "emit_to_gcode" => "true";
                "time_estimate_only", "ignore" => "false";
            }));
        "emit_machine_limits_to_gcode" => To("gcode.set_limits", As::Switch);
        "remaining_times"
            => To("gcode.progress", As::Words(&[("1", "on"), ("0", "off")]));
        "disable_m73"
            => To("gcode.progress", As::Words(&[("1", "off"), ("0", "")]));
        "thumbnails", "thumbnails_format", "thumbnail_size"
            => made(make::thumbnails, &["gcode.thumbnails"],
                "PNG, QOI and JPG; COLPIC and the like are left out");
        "min_layer_height" => To("layer_height_min", As::Width);
        "max_layer_height" => To("layer_height_max", As::Width);
        "retract_length", "retraction_length"
            => To("retract.length", As::Number);
        "retract_speed", "retraction_speed", "deretract_speed",
            "deretraction_speed", "detraction_speed"
            => made(|given| make::retract_speeds(given, ""),
                &["retract.speed", "retract.prime_speed"],
                "0 for pushing forward is as fast as pulling back");
        "retract_before_travel", "retraction_minimum_travel"
            => To("retract.min_travel", As::Number);
        "retract_before_wipe" => To("retract.before_wipe", As::Percent);
        "retract_restart_extra" => To("retract.extra_prime", As::Number);
        "retract_lift", "z_hop", "travel_ramping_lift", "travel_max_lift"
            => made(|given| make::z_hop(given, ""), &["retract.z_hop"],
                "of lifts that ramp up the greatest");
        "wipe", "wipe_distance"
            => made(|given| make::wipe(given, ""), &["retract.wipe"],
                "2 mm if no distance is given");
        "use_firmware_retraction", "use_firmwware_retraction"
            => To("retract.firmware", As::Switch);
        "default_bed_type", "curr_bed_type", "bed_type"
            => Ignored("it chooses among the temperatures of the bed");
        "use_volumetric_e"
            => Lost(&["0"],
                "isoslice gives the filament's length, not its volume: set the \
                 firmware to lengths (M200 D0)");
        "z_offset"
            => Lost(&["0", "0.0"],
                "isoslice moves no heights: set it in the printer");
        "bed_exclude_area", "head_wrap_detect_zone"
            => Lost(&["0x0", "0", ""],
                "isoslice knows no forbidden places: keep parts off them with \
                 --at");
        "printer_technology"
            => Lost(&["FFF"], "isoslice prints with filament only");
        "extruder_offset", "extruders_count", "single_extruder_multi_material",
            "retract_length_toolchange", "retract_restart_extra_toolchange",
            "toolchange_gcode", "change_filament_gcode",
            "parking_pos_retraction", "cooling_tube_length",
            "cooling_tube_retraction", "extra_loading_move",
            "high_current_on_filament_swap", "multimaterial_purging",
            "purge_in_prime_tower", "enable_filament_ramming",
            "machine_load_filament_time", "machine_unload_filament_time",
            "machine_tool_change_time", "manual_filament_change",
            "enable_long_retraction_when_cut", "long_retractions_when_cut",
            "retraction_distances_when_cut", "creality_flush_time",
            "master_extruder_id", "physical_extruder_map", "extruder_type",
            "extruder_variant_list", "printer_extruder_id",
            "printer_extruder_variant", "default_nozzle_volume_type",
            "nozzle_volume_type", "extruder_printable_area",
            "extruder_printable_height", "extruder_ams_count",
            "extruder_max_nozzle_count", "machine_hotend_change_time",
            "machine_switch_extruder_time", "group_algo_with_time",
            "support_fast_purge_mode", "prime_tower_position_type",
            "is_support_multi_box", "box_id", "support_box_temp_control",
            "wipe_device", "etruder_offset", "hotend_cooling_rate",
            "hotend_heating_rate", "nozzle_flush_dataset",
            "apply_relative_flush", "grab_length", "wrapping_detection_layers",
            "wrapping_detection_path", "machine_prepare_compensation_time",
            "tool_name"
            => Ignored(SEVERAL);
        "extruder_colour", "bed_model", "bed_texture", "bed_custom_model",
            "bed_custom_texture", "hotend_model", "family", "model_id",
            "machine_tech", "image_bed_type", "url", "default_materials",
            "printer_variant", "printer_settings_id", "renamed_from",
            "renamed_From", "upward_compatible_machine",
            "default_print_profile", "default_filament_profile", "name",
            "printer_vendor", "setting_id", "settings_id", "instantiation",
            "from", "version", "is_custom_defined", "type", "inherits",
            "inherits_group", "extruder_clearance_height_to_cover",
            "thumbnails_color", "thumbnails_custom_color",
            "thumbnails_with_bed", "preferred_orientation", "best_object_pos",
            "physical_printer_settings_id", "default_sla_material_profile",
            "default_sla_print_profile", "thumbnails_end_file", "printer_agent",
            "support_multi_bed_types", "variable_layer_height", "is_artillery"
            => Ignored(SHOWN);
        "printer_notes", "printer_notes_id"
            => Ignored(
                "it is a note; conditions in G-code that ask for it are \
                 decided by it");
        "host_type", "print_host", "print_host_webui", "printhost_apikey",
            "printhost_authorization_type", "printhost_cafile",
            "printhost_password", "printhost_port",
            "printhost_ssl_ignore_revoke", "printhost_user", "octoprint_apikey",
            "octoprint_host", "serial_port", "serial_speed",
            "bbl_use_printhost", "is_support_mqtt", "is_support_timelapse",
            "use_3mf"
            => Ignored("where files are sent: isoslice printers add");
        "machine_max_jerk_e", "machine_max_jerk_z",
            "machine_max_acceleration_e", "machine_max_feedrate_e",
            "machine_max_speed_e", "machine_min_extruding_rate",
            "machine_min_travel_rate", "machine_max_force_Y",
            "machine_bed_mass_Y", "machine_max_printed_mass", "silent_mode",
            "z_step", "machine_max_acceleration_retracting_silent"
            => Ignored(FIRMWARE);
        "extruder_clearance_radius", "extruder_clearance_max_radius",
            "extruder_clearance_height", "extruder_clearance_height_to_rod"
            => made(make::clearances,
                &["printer.head_clearance_radius", "printer.gantry_height"],
                "the greatest radius, and the least height");
        "extruder_clearance_height_to_lid", "extruder_clearance_dist_to_rod",
            "between_objects_gcode", "printing_by_object_gcode", "nozzle_height"
            => Ignored(ONE_PART);
        "retract_layer_change", "retract_when_changing_layer"
            => Lost(&["0"],
                "isoslice decides by what a travel crosses where to retract");
        "retract_lift_above", "retract_lift_below"
            => Lost(&["0"],
                "lifts are the same at all heights: retract.z_hop_when");
        "z_hop_types", "z_lift_type"
            => Lost(&["Normal Lift", "normal"],
                "isoslice lifts straight up: retract.z_hop");
        "pause_print_gcode", "machine_pause_gcode", "pause_gcode",
            "color_change_gcode", "template_custom_gcode", "start_gcode_manual"
            => Ignored("it is for pauses that one puts in by hand");
        "change_extrusion_role_gcode"
            => Lost(&[""], "isoslice has no template between kinds of lines");
        "time_lapse_gcode", "timelapse_gcode", "wrapping_detection_gcode",
            "file_start_gcode"
            => Lost(&[""], "if you take pictures, add it to gcode.layer");
        "retract_lift_enforce", "retract_lift_top", "retract_lift_first_layer",
            "travel_slope", "travel_lift_before_obstacle",
            "retract_on_top_layer", "wipe_advanced", "wipe_advanced_algo",
            "wipe_advanced_multiplier", "wipe_advanced_nozzle_melted_volume",
            "wipe_extra_perimeter"
            => Ignored(LIFTED);
        "nozzle_type", "nozzle_hrc", "nozzle_volume", "nozzle_high_flow",
            "printer_structure", "machine_LED_light_exist",
            "pellet_modded_printer", "machine_platform_motion_enable",
            "fan_direction", "scan_first_layer", "required_nozzle_HRC",
            "is_support_3mf", "is_support_polar_cooler",
            "support_air_filtration", "support_chamber_temp_control",
            "auxiliary_fan", "chamber_fan", "support_cooling_filter",
            "cooling_filter_enabled", "fan_kickstart", "fan_speedup_overhangs",
            "fan_speedup_time", "fan_speedup_travel",
            "support_object_skip_flush"
            => Ignored(
                "it describes parts of the machine that isoslice does not \
                 drive");
        "bed_mesh_max", "bed_mesh_min", "bed_mesh_probe_distance",
            "adaptive_bed_mesh_margin"
            => Ignored(
                "it is for the probing in the start G-code, which names \
                 it");
        "time_cost", "time_estimation_compensation"
            => Ignored(
                "isoslice's own estimate of the time needs no \
                 correction");
        "binary_gcode" => Ignored("-o FILE.bgcode writes binary G-code");
    }
    PRUSA Printer {
        "autoemit_temperature_commands"
            => Ignored("isoslice heats what the start G-code does not");
    }
    BOTH Printer {
        "prefer_clockwise_movements", "min_resonance_avoidance_speed",
            "max_resonance_avoidance_speed", "resonance_avoidance",
            "input_shaping_emit", "input_shaping_type"
            => Ignored("the firmware shapes its moves by itself");
    }
    ORCA Printer {
        "support_parallel_printheads" => Ignored(SEVERAL);
    }
};
