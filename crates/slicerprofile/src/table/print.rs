//! Keys of kinds of print.

use super::PresetKind::Print;
use super::{
    As, BOTH, EXACT, FLOW, JERK, ORCA, PRUSA, RAFT, Row, Rule, SEVERAL, SHOWN,
    SUPPORTS, made, make, patterns,
};
use Rule::{Ignored, Lost, To};

const THIN: &str = "isoslice measures how thick thin places are: thin_min and \
                    thin_max";
const TOWER: &str = "without a second material there is no tower";
const COMBINED: &str = "infill is printed in every layer, and solid layers are \
                        not put between";
const SHAPE: &str = "isoslice prints the shape as it is: change the model";
const LOCKED: &str = "isoslice has no infill of two zones";

pub(super) static ROWS: &[Row] = rows! {
    BOTH Print {
        "layer_height" => To("layer_height", As::Width);
        "first_layer_height", "initial_layer_print_height",
            "inital_layer_height"
            => To("first_layer_height", As::Width);
        "perimeters", "wall_loops", "wall_count" => To("walls", As::Number);
        "spiral_vase", "spiral_mode" => To("spiral", As::Switch);
        "extrusion_width", "line_width", "external_perimeter_extrusion_width",
            "outer_wall_line_width", "perimeter_extrusion_width",
            "inner_wall_line_width", "infill_extrusion_width",
            "sparse_infill_line_width", "solid_infill_extrusion_width",
            "internal_solid_infill_line_width", "top_infill_extrusion_width",
            "top_surface_line_width"
            => made(make::widths,
                &["outer_wall_width", "inner_wall_width", "infill_width",
                  "skin_width", "top_skin_width"],
                "0 takes the width of all lines; shares of the nozzle stay \
                 shares, those of the layer's height become lengths");
        "top_solid_layers", "top_shell_layers", "top_solid_min_thickness",
            "top_shell_thickness"
            => made(
                |given| make::shell(given,
                    &["top_solid_layers", "top_shell_layers"],
                    &["top_solid_min_thickness", "top_shell_thickness"],
                    "top_layers"),
                &["top_layers"],
                "whichever is more with the profile's layers");
        "bottom_solid_layers", "bottom_shell_layers",
            "bottom_solid_min_thickness", "bottom_shell_thickness"
            => made(
                |given| make::shell(given,
                    &["bottom_solid_layers", "bottom_shell_layers"],
                    &["bottom_solid_min_thickness", "bottom_shell_thickness"],
                    "bottom_layers"),
                &["bottom_layers"],
                "whichever is more with the profile's layers");
        "fill_density", "sparse_infill_density"
            => To("infill_density", As::Percent);
        "fill_pattern", "sparse_infill_pattern"
            => To("infill", patterns::INFILL);
        "fill_angle", "infill_direction"
            => made(make::angle, &["infill_angle", "skin_angle"],
                "one angle for both");
        "infill_overlap", "infill_wall_overlap"
            => made(make::overlap, &["infill_overlap"],
                "lengths become shares of the line's width");
        "top_fill_pattern", "top_surface_pattern", "external_fill_pattern"
            => To("skin_pattern", patterns::TOP);
        "bottom_fill_pattern", "bottom_surface_pattern", "bottom_fill_patter"
            => To("skin_pattern", patterns::BOTTOM);
        "solid_fill_pattern", "internal_solid_infill_pattern"
            => To("skin_pattern", patterns::INTERNAL);
        "solid_infill_below_area", "minimum_sparse_infill_area"
            => To("skin_min_area", As::Number);
        "seam_position"
            => To("seam", As::Words(pairs! {
                "aligned" => "aligned";
                "aligned_back" => "rear";
                "nearest", "near", "cost" => "nearest";
                "rear", "back" => "rear";
                "random" => "random";
            }));
        "seam_gap" => To("seam_gap", As::Length);
        "seam_slope_type", "seam_slope_min_length", "scarf_seam_placement",
            "scarf_seam_length", "seam_slope_start_height",
            "scarf_seam_start_height"
            => made(make::scarf, &["seam_scarf"],
                "the slope's length, if walls have one; heights become shares \
                 of the layer's");
        "external_perimeters_first", "wall_sequence", "wall_infill_order"
            => made(make::wall_order, &["wall_order"],
                "whether the outer wall comes first");
        "xy_size_compensation", "xy_contour_compensation"
            => To("xy_compensation", As::Number);
        "elefant_foot_compensation", "elefant_foot_compensation_layers"
            => made(make::elephant_foot, &["elephant_foot"],
                "with the number of layers");
        "slice_closing_radius" => To("slit_closing", As::Number);
        "ironing", "ironing_type", "ironing_flowrate", "ironing_flow"
            => made(make::ironing, &["ironing"],
                "whichever tops it is for; the flow if it is on");
        "ironing_spacing" => To("ironing_spacing", As::Width);
        "ironing_speed" => To("speed.ironing", As::Amount);
        "bridge_flow_ratio", "bridge_flow" => To("bridge_flow", As::Ratio);
        "internal_bridge_flow", "over_bridge_flow_ratio"
            => To("internal_bridge_flow", As::Ratio);
        "print_flow_ratio" => To("flow", As::Ratio);
        "overhangs", "detect_overhang_wall"
            => To("overhang_share", As::Words(&[("1", ""), ("0", "100")]));
        "external_perimeter_speed", "outer_wall_speed"
            => To("speed.outer_wall", As::Amount);
        "perimeter_speed", "inner_wall_speed"
            => To("speed.inner_wall", As::Amount);
        "infill_speed", "sparse_infill_speed"
            => To("speed.sparse_infill", As::Amount);
        "solid_infill_speed", "internal_solid_infill_speed"
            => made(
                |given| make::same_for(given,
                    &["solid_infill_speed", "internal_solid_infill_speed"],
                    ["speed.internal_skin", "speed.bottom_skin"]),
                &["speed.internal_skin", "speed.bottom_skin"],
                "shares become numbers; 0 leaves it");
        "top_solid_infill_speed", "top_surface_speed"
            => To("speed.top_skin", As::Amount);
        "gap_fill_speed", "gap_infill_speed"
            => To("speed.gap_fill", As::Amount);
        "bridge_speed" => To("speed.bridge", As::Amount);
        "internal_bridge_speed", "bridge_speed_internal",
            "ineternal_bridge_speed", "over_bridge_speed"
            => To("speed.internal_bridge", As::Amount);
        "small_perimeter_speed" => To("speed.small_wall", As::Amount);
        "small_perimeter_threshold", "small_perimeter_max_length"
            => made(make::small_length, &["speed.small_wall_length"],
                "the circumference of that radius");
    }
    PRUSA Print {
        "overhangs_speed" => To("speed.overhang", As::Amount);
    }
    BOTH Print {
        "enable_dynamic_overhang_speeds", "overhang_speed_0",
            "overhang_speed_1", "overhang_speed_2", "overhang_speed_3",
            "dynamic_overhang_speeds", "enable_overhang_speed",
            "overhang_1_4_speed", "overhang_2_4_speed", "overhang_3_4_speed",
            "overhang_4_4_speed"
            => made(make::overhang_speed, &["speed.overhang"],
                "at 25, 50, 75 and 100 % of the width that reaches out; 0 is \
                 the wall's own speed");
    }
    ORCA Print {
        "support_flow_ratio", "support_interface_flow_ratio",
            "set_other_flow_ratios"
            => made(make::support_flow,
                &["support.flow", "support.interface_flow"],
                "1 becomes 100 %; only if flows are set one by one");
    }
    BOTH Print {
        "support_material_speed", "support_speed"
            => To("speed.support", As::Amount);
        "support_material_interface_speed", "support_interface_speed"
            => To("speed.support_interface", As::Amount);
        "first_layer_speed", "initial_layer_speed"
            => To("speed.first_layer", As::Amount);
        "skirt_speed", "brim_speed" => To("speed.skirt", As::Amount);
        "travel_speed" => To("speed.travel", As::Amount);
        "travel_speed_z" => To("printer.max_speed_z", As::Positive);
        "default_acceleration" => To("printer.acceleration", As::Amount);
        "external_perimeter_acceleration", "outer_wall_acceleration"
            => To("acceleration.outer_wall", As::Amount);
        "perimeter_acceleration", "inner_wall_acceleration"
            => To("acceleration.inner_wall", As::Amount);
        "infill_acceleration", "sparse_infill_acceleration"
            => To("acceleration.sparse_infill", As::Amount);
        "solid_infill_acceleration", "internal_solid_infill_acceleration"
            => made(
                |given| make::same_for(given,
                    &["solid_infill_acceleration",
                      "internal_solid_infill_acceleration"],
                    ["acceleration.internal_skin",
                      "acceleration.bottom_skin"]),
                &["acceleration.internal_skin", "acceleration.bottom_skin"],
                "shares become numbers; 0 leaves it");
        "top_solid_infill_acceleration", "top_surface_acceleration"
            => To("acceleration.top_skin", As::Amount);
        "bridge_acceleration" => To("acceleration.bridge", As::Amount);
        "first_layer_acceleration", "initial_layer_acceleration"
            => To("acceleration.first_layer", As::Amount);
        "travel_acceleration" => To("printer.travel_acceleration", As::Amount);
        "default_jerk" => To("printer.square_corner_velocity", As::Positive);
        "skirts", "skirt_loops" => To("skirt.loops", As::Number);
        "skirt_distance" => To("skirt.distance", As::Number);
        "skirt_height" => To("skirt.layers", As::Positive);
        "brim_type", "brim_width", "brim_ears", "brim_ears_max_angle"
            => made(make::brim, &["brim.place", "brim.width", "brim.ear_angle"],
                "the width is the radius of ears; a part on a raft has none; \
                 auto_brim and painted have no counterpart");
        "brim_separation", "brim_object_gap", "brim_offset"
            => To("brim.gap", As::Number);
        "support_material", "support_material_auto",
            "support_material_buildplate_only", "enable_support",
            "support_on_build_plate_only", "support_type"
            => made(make::supports, &["supports"],
                "auto, or plate for those on the bed only; by hand is off");
        "support_material_threshold", "support_threshold_angle"
            => made(make::support_angle, &["support.angle"],
                "90° less it; 0 leaves it");
    }
    ORCA Print {
        // In both slicers a bridge up to this length gets no supports.
        "max_bridge_length"
            => made(make::bridge_max, &["bridge_max"],
                "0.1 to 1000 mm: bridges are printed in any case");
    }
    BOTH Print {
        "support_material_xy_spacing", "support_object_xy_distance"
            => To("support.xy_gap", As::Amount);
        "support_material_contact_distance", "support_top_z_distance",
            "support_material_contact_distance_top"
            => To("support.z_gap", As::Number);
        "support_material_bottom_contact_distance", "support_bottom_z_distance",
            "support_material_contact_distance_bottom"
            => To("support.z_gap_bottom", As::Positive);
        "support_material_spacing", "support_base_pattern_spacing",
            "support_material_extrusion_width", "support_line_width",
            "support_material_interface_spacing", "support_interface_spacing"
            => made(make::support_density,
                &["support.density", "support.interface_density"],
                "line's width by its distance");
        "support_material_interface_layers", "support_interface_top_layers"
            => To("support.interface_layers", As::Number);
        "support_material_style", "support_style"
            => To("support.style", As::Words(pairs! {
                "grid" => "grid";
                "snug" => "snug";
                "organic", "tree", "tree_slim", "tree_strong" => "tree";
                "tree_hybrid" => "auto";
                "default" => "";
            }));
        "support_tree_angle", "tree_support_branch_angle",
            "tree_support_branch_angle_organic"
            => To("support.branch_angle", As::Number);
        "arc_fitting", "enable_arc_fitting"
            => To("gcode.arcs", As::Words(pairs! {
                "1", "emit_center", "emit_radius", "bambu" => "true";
                "0", "disabled" => "";
            }));
        "gcode_label_objects", "exclude_object", "label_printed_objects"
            => To("gcode.labels", As::Words(pairs! {
                "1", "octoprint" => "";
                "firmware" => "on";
                "0", "disabled" => "";
            }));
        "avoid_crossing_perimeters", "reduce_crossing_wall"
            => To("travel.combing", As::Words(pairs! {
                "1" => "not-over-top-skin";
                "0" => "";
            }));
        "avoid_crossing_perimeters_max_detour", "max_travel_detour_distance"
            => To("travel.max_detour", As::Amount);
        "only_retract_when_crossing_perimeters", "reduce_infill_retraction"
            => made(make::hidden_travels,
                &["retract.when_crossing", "retract.max_unretracted"],
                "hidden travels of any length do without");
        "fuzzy_skin", "fuzzy_skin_thickness", "fuzzy_skin_point_dist",
            "fuzzy_skin_point_distance"
            => made(make::fuzzy,
                &["fuzzy.thickness", "fuzzy.grain", "fuzzy.holes"],
                "if walls are fuzzy");
        "raft_layers", "raft_contact_distance", "raft_expansion"
            => made(make::raft, &["raft.layers", "raft.gap", "raft.expansion"],
                "if there is a raft");
        "draft_shield"
            => made(make::draft_shield, &["draft_shield"],
                "full, as far off as the skirt; limited is a skirt of many \
                 layers");
        "overhang_reverse", "overhangs_reverse"
            => To("overhang_reverse", As::Switch);
        "support_material_interface_pattern", "support_interface_pattern"
            => To("support.interface_pattern", patterns::INTERFACE);
        "xy_hole_compensation", "xy_inner_size_compensation"
            => Lost(&["0", "0.0"],
                "xy_compensation moves holes by themselves if it is a formula \
                 of their curvature");
        "post_process"
            => Lost(&[""],
                "isoslice runs no programs: run it on the file yourself");
        "gcode_substitutions"
            => Lost(&[""], "isoslice changes no text in its G-code");
        "bridge_angle", "internal_bridge_angle"
            => Lost(&["0"], "isoslice lays bridges along the shortest span");
        "top_solid_infill_flow_ratio", "bottom_solid_infill_flow_ratio"
            => Lost(&["1", "1.0", "1.00"], FLOW);
        "only_one_perimeter_top", "only_one_wall_top", "top_one_perimeter_type",
            "top_one_wall_type"
            => To("top_walls", As::Words(pairs! {
                "1" => "1";
                "0" => "";
                "top", "all top" => "1";
                "topmost", "none", "not apply" => "";
            }));
        "min_width_top_surface", "top_area_threshold"
            => Ignored(
                "a top is what is wider than two lines; bottoms keep their \
                 walls");
        "infill_every_layers" => Lost(&["0", "1"], COMBINED);
        "infill_combination", "automatic_infill_combination",
            "solid_infill_every_layers"
            => Lost(&["0"], COMBINED);
        "infill_combination_max_layer_height",
            "automatic_infill_combination_max_layer_height"
            => Ignored(
                "it matters only where the infill of layers is \
                 combined");
        "make_overhang_printable", "hole_to_polyhole",
            "enable_circle_compensation"
            => Lost(&["0"], SHAPE);
        "make_overhang_printable_angle", "make_overhang_printable_hole_size",
            "hole_to_polyhole_threshold", "hole_to_polyhole_twisted",
            "circle_compensation_manual_offset", "overhang_reverse_threshold",
            "overhang_reverse_internal_only"
            => Ignored(
                "it matters only with the switch that it is named \
                 after");
        "alternate_extra_wall"
            => Lost(&["0"],
                "isoslice has as many walls in every layer: set \
                 walls");
        "skin_infill_line_width", "skeleton_infill_line_width"
            => Ignored(
                "lines have the width of their kind in the first layer, too");
        "first_layer_speed_over_raft", "first_layer_acceleration_over_raft"
            => Ignored(
                "the first layer has one speed, the layers above their \
                 own");
        "max_print_speed", "max_volumetric_speed"
            => Ignored(
                "filament.max_flow and printer.max_speed are the \
                 limits");
        "max_volumetric_extrusion_rate_slope"
            => To("filament.max_flow_change", As::Amount);
        "max_volumetric_extrusion_rate_slope_negative",
            "max_volumetric_extrusion_rate_slope_positive",
            "max_volumetric_extrusion_rate_slope_segment_length"
            => Ignored(
                "filament.max_flow_change holds for more and for less flow, in \
                 steps of its own");
        "accel_to_decel_enable", "accel_to_decel_factor" => Ignored(JERK);
        "travel_short_distance_acceleration", "wipe_tower_acceleration",
            "travel_acceleration_outer"
            => Ignored("travels have one acceleration");
        "resolution", "gcode_resolution", "smooth_coefficient",
            "smooth_speed_discontinuity_area", "slicing_mode",
            "exact_last_layer_height", "allow_empty_layers"
            => Ignored(EXACT);
        "thin_walls", "detect_thin_wall", "detect_thin_walls",
            "thin_perimeters", "thin_walls_speed", "gap_fill_enabled",
            "gap_fill", "gap_fill_target", "filter_out_gap_fill",
            "gap_fill_flow_match_perimeter", "perimeter_generator",
            "wall_generator", "min_bead_width", "min_feature_size",
            "initial_layer_min_bead_width", "wall_transition_angle",
            "wall_transition_filter_deviation", "wall_transition_length",
            "wall_distribution_count", "min_length_factor",
            "detect_narrow_internal_solid_infill", "perimeter_overlap",
            "perimeter_bonding", "perimeter_round_corners",
            "precise_outer_wall", "wall_maximum_deviation",
            "wall_maximum_resolution"
            => Ignored(THIN);
        "ensure_vertical_shell_thickness", "detect_floating_vertical_shell",
            "vertical_shell_speed", "interface_shells",
            "embedding_wall_into_infill", "z_direction_outwall_speed_continuous"
            => Ignored(
                "isoslice puts skin wherever the layers above or below do not \
                 cover one");
        "wipe_speed", "role_based_wipe_speed", "seam_slope_inner_walls",
            "seam_slope_conditional", "seam_slope_entire_loop",
            "seam_slope_steps", "seam_slope_gap", "scarf_joint_speed",
            "scarf_angle_threshold", "scarf_overhang_threshold",
            "scarf_seam_entire_loop", "scarf_seam_max_segment_length",
            "scarf_seam_on_inner_perimeters", "scarf_seam_only_on_smooth",
            "override_filament_scarf_seam_setting",
            "seam_placement_away_from_overhangs",
            "reduce_infill_retraction_mode",
            "avoid_crossing_wall_includes_support",
            "avoid_crossing_curled_overhangs", "print_order",
            "toolchange_ordering", "has_scarf_joint_seam"
            => Ignored(
                "isoslice has rules of its own for the order and for \
                 seams");
        "top_bottom_infill_wall_overlap", "external_infill_margin",
            "bridge_infill_margin", "infill_only_where_needed",
            "monotonic_travel_into_wall", "infill_shift_step",
            "symmetric_infill_y_axis", "infill_instead_top_bottom_surfaces",
            "solid_infill_direction", "ai_infill",
            "sparse_infill_lattice_angle_1", "sparse_infill_lattice_angle_2",
            "lattice_angle_1", "lattice_angle_2", "infill_overhang_angle",
            "align_infill_direction_to_model", "lightning_overhang_angle",
            "lightning_prune_angle", "lightning_straightening_angle"
            => Ignored(
                "isoslice anchors lines by rules of its own: skin_overlap, \
                 skin_ring_gap, skin_wall_overlap, infill_overlap");
        "skin_infill_density", "skeleton_infill_density", "skin_infill_depth",
            "infill_lock_depth", "locked_skin_infill_pattern",
            "locked_skeleton_infill_pattern"
            => Ignored(LOCKED);
        "dont_filter_internal_bridges", "dont_support_bridges",
            "bridge_no_support", "internal_bridge_support_thickness",
            "relative_bridge_angle"
            => Ignored(
                "isoslice anchors bridges at both ends and says which are too \
                 long: bridge_anchor, bridge_max, internal_bridges");
        "overhang_totally_speed", "overhangs_dynamic_speed", "overhangs_width",
            "overhangs_width_speed", "detect_overhang_wall_filter",
            "overhang_threshold_participating_cooling"
            => Ignored(
                "speeds of overhangs are steps by how far they reach out: \
                 speed.overhang");
        "support_material_interface_contact_loops",
            "support_interface_loop_pattern", "support_material_with_sheath",
            "support_material_synchronize_layers",
            "independent_support_layer_height",
            "support_material_closing_radius",
            "support_material_bottom_interface_layers",
            "support_interface_bottom_layers",
            "support_bottom_interface_spacing", "support_expansion",
            "support_tree_tip_diameter", "tree_support_tip_diameter",
            "support_tree_branch_diameter", "tree_support_branch_diameter",
            "tree_support_branch_diameter_organic",
            "support_tree_branch_diameter_angle",
            "tree_support_branch_diameter_angle",
            "tree_support_bramch_diameter_angle",
            "tree_support_branch_diameter_double_wall",
            "support_tree_branch_diameter_double_wall",
            "support_tree_branch_distance", "tree_support_branch_distance",
            "tree_support_branch_distance_organic", "support_tree_angle_slow",
            "tree_support_angle_slow", "support_tree_top_rate",
            "tree_support_top_rate", "tree_support_adaptive_layer_height",
            "tree_support_auto_brim", "tree_support_brim_width",
            "tree_support_wall_count", "tree_support_with_infill",
            "support_object_first_layer_gap",
            "support_material_solid_first_layer", "support_ironing_pattern",
            "support_ironing_speed", "support_ironing_flow",
            "support_ironing_spacing", "support_ironing_inset",
            "support_ironing_direction", "auto_generated_supports",
            "support_threshold_overlap", "support_material_layer_height",
            "support_air_filtration_print", "support_cooling"
            => Ignored(SUPPORTS);
        "raft_first_layer_density", "raft_layer_height",
            "raft_interface_layer_height"
            => Ignored(RAFT);
        "ironing_angle_fixed", "ironing_support_layer", "ironing_direction"
            => Ignored("ironing runs across the lines below");
        "fuzzy_skin_scale", "fuzzy_skin_octaves", "fuzzy_skin_persistence",
            "fuzzy_skin_ripples_per_layer", "fuzzy_skin_ripple_offset"
            => Ignored("fuzzy skin has one texture, of bumps of fuzzy.grain");
        "skirt_start_angle", "single_loop_draft_shield",
            "brim_ears_detection_length", "brim_use_efc_outline",
            "brim_inside_holes", "brim_width_interior", "brim_ears_exclude",
            "combine_brims", "complete_objects_one_skirt"
            => Ignored(
                "skirts and brims have settings of their own: the groups skirt \
                 and brim");
        "adaptive_layer_height", "spiral_mode_smooth",
            "spiral_mode_max_xy_smoothing"
            => Ignored(
                "isoslice makes these of the function: layer_heights, spiral");
        "small_area_infill_flow_compensation_model",
            "small_perimeter_min_length", "extrusion_spacing",
            "first_layer_extrusion_spacing", "perimeter_extrusion_spacing",
            "external_perimeter_extrusion_spacing", "infill_extrusion_spacing",
            "solid_infill_extrusion_spacing", "top_infill_extrusion_spacing",
            "apply_top_surface_compensation"
            => Ignored(FLOW);
        "acceleration_limit_mess", "speed_limit_to_height",
            "material_flow_temp_graph", "slowdown_start_height",
            "slowdown_start_speed", "slowdown_start_acc", "slowdown_end_height",
            "slowdown_end_speed", "slowdown_end_acc"
            => Ignored(
                "speeds that depend on the height are formulas of z in \
                 isoslice");
    }
    PRUSA Print {
        "complete_objects"
            => To("plate.sequence", As::Words(pairs! {
                "1" => "one-by-one";
                "0" => "all-at-once";
            }));
    }
    ORCA Print {
        "print_sequence"
            => To("plate.sequence", As::Words(pairs! {
                "by object" => "one-by-one";
                "by layer" => "all-at-once";
            }));
    }
    BOTH Print {
        "complete_objects_sort", "clip_multipart_objects",
            "output_filename_format", "filename_format", "notes", "description",
            "compatible_printers", "compatible_printers_condition",
            "compatible_printers_condition_cummulative", "print_settings_id",
            "threads", "gcode_comments", "gcode_add_line_number",
            "print_host_upload", "custom", "print_custom_variables",
            "printer_custom_variables", "different_settings_to_system",
            "print_compatible_printers", "print_temperature",
            "print_bed_temperature", "inherits_cummulative",
            "default_print_settings_id", "prusaslicer_config",
            "gcode_substitutions_id", "extruder", "profile_vendor",
            "profile_version", "wiping_volumes_use_custom_matrix",
            "print_extruder_id", "print_extruder_variant",
            "first_layer_sequence_choice", "other_layers_sequence_choice",
            "bed_temperature_formula"
            => Ignored(SHOWN);
        "wipe_tower", "enable_prime_tower", "wipe_tower_x", "wipe_tower_y",
            "wipe_tower_width", "prime_tower_width",
            "wipe_tower_rotation_angle", "wipe_tower_bridging",
            "wipe_tower_brim_width", "prime_tower_brim_width",
            "wipe_tower_no_sparse_layers", "wipe_tower_cone_angle",
            "wipe_tower_extra_spacing", "wipe_tower_extra_flow",
            "wipe_tower_extruder", "wipe_tower_filament",
            "wipe_tower_wall_type", "wipe_tower_max_purge_speed",
            "wipe_tower_fillet_wall", "wipe_tower_rib_width",
            "wipe_tower_extra_rib_length", "prime_volume",
            "prime_tower_enhance_type", "prime_tower_flat_ironing",
            "prime_tower_enable_framework", "prime_tower_infill_gap",
            "prime_tower_lift_height", "prime_tower_lift_speed",
            "prime_tower_max_speed", "prime_tower_rib_wall",
            "prime_tower_rib_width", "prime_tower_fillet_wall",
            "prime_tower_extra_rib_length", "prime_tower_skip_points",
            "enable_tower_interface_features",
            "enable_tower_interface_cooldown_during_tower",
            "purge_in_prime_tower_print"
            => Ignored(TOWER);
        "single_extruder_multi_material_priming", "support_material_extruder",
            "support_material_interface_extruder", "support_filament",
            "support_interface_filament", "support_interface_not_for_body",
            "perimeter_extruder", "infill_extruder", "solid_infill_extruder",
            "wall_filament", "sparse_infill_filament", "solid_infill_filament",
            "bottom_color_penetration_layers", "top_color_penetration_layers",
            "standby_temperature_delta", "ooze_prevention", "preheat_time",
            "preheat_steps", "flush_into_infill", "flush_into_objects",
            "flush_into_support", "flush_multiplier", "flush_volumes_matrix",
            "flush_volumes_vector", "mmu_segmented_region_interlocking_depth",
            "mmu_segmented_region_max_width", "wiping_volumes_extruders",
            "wiping_volumes_matrix", "interlocking_beam",
            "interlocking_beam_layer_count", "interlocking_beam_width",
            "interlocking_boundary_avoidance", "interlocking_depth",
            "interlocking_orientation", "enable_wrapping_detection",
            "wrapping_exclude_area", "prime_volume_mode",
            "nozzle_volume_type_print"
            => Ignored(SEVERAL);
        "first_layer_extrusion_width", "initial_layer_line_width",
            "skirt_extrusion_width"
            => Lost(&["0", "0%", "100%"],
                "lines have the width of their kind in the first layer, too: \
                 outer_wall_width and its like");
        "slow_down_layers"
            => Lost(&["0", "1"],
                "the layers above the first have their own speeds at once; a \
                 speed may be a formula of z");
        "first_layer_infill_speed", "initial_layer_infill_speed",
            "first_layer_min_speed"
            => Lost(&["0"], "the first layer has one speed: speed.first_layer");
        "initial_layer_travel_speed", "first_layer_travel_speed",
            "initial_layer_travel_acceleration"
            => Lost(&["0", "100%"],
                "travels of the first layer are as fast as others: \
                 speed.travel");
        "extra_perimeters", "extra_perimeters_on_overhangs",
            "extra_perimeters_overhangs"
            => Lost(&["0"],
                "isoslice puts skin there, and no more walls: set walls");
        "only_one_wall_first_layer" => Lost(&["0"], "bottoms keep their walls");
        "bridge_density", "internal_bridge_density"
            => Lost(&["100", "100%", "0"], "bridges are dense");
        "thick_bridges", "thick_internal_bridges", "enable_extra_bridge_layer",
            "counterbore_hole_bridging"
            => Lost(&["0", "disabled", "none"],
                "bridges are one layer of the layer's height: bridge_flow \
                 makes their lines thicker");
        "ironing_angle", "ironing_inset"
            => Lost(&["0", "-1", "-1%"],
                "ironing runs across the lines below, up to the walls");
        "ironing_pattern"
            => Lost(&["rectilinear", "zig-zag", "zigzag", "line", "monotonic"],
                "ironing runs in lines");
        "fuzzy_skin_noise_type", "fuzzy_skin_mode"
            => Lost(&["classic", "displacement"],
                "fuzzy skin has one texture, of bumps of fuzzy.grain");
        "fuzzy_skin_first_layer"
            => Lost(&["0"], "the first layer has no fuzzy skin");
        "skirt_per_object", "skirt_type"
            => Lost(&["0", "combined"], "a skirt goes round all parts");
        "min_skirt_length"
            => Lost(&["0"], "a skirt has as many loops as skirt.loops says");
        "internal_solid_infill_flow_ratio", "outer_wall_flow_ratio",
            "inner_wall_flow_ratio", "overhang_flow_ratio",
            "sparse_infill_flow_ratio", "first_layer_flow_ratio",
            "gap_fill_flow_ratio", "fill_top_flow_ratio", "scarf_joint_flow",
            "scarf_joint_flow_ratio", "spiral_starting_flow_ratio",
            "spiral_finishing_flow_ratio", "spiral_vase_flow"
            => Lost(&["1", "1.0", "1.00", "100%"], FLOW);
        "small_area_infill_flow_compensation" => Lost(&["0"], FLOW);
        "outer_wall_jerk", "inner_wall_jerk", "infill_jerk",
            "initial_layer_jerk", "top_surface_jerk", "travel_jerk",
            "default_junction_deviation"
            => Lost(&["0"], JERK);
        "enable_height_slowdown", "acceleration_limit_mess_enable",
            "speed_limit_to_height_enable",
            "material_flow_dependent_temperature"
            => Lost(&["0"],
                "write a formula of z as the speed or the temperature");
        "infill_anchor", "infill_anchor_max", "sparse_infill_anchor"
            => Lost(&[],
                "isoslice joins lines of infill along the walls by rules of \
                 its own");
        "top_surface_density", "bottom_surface_density"
            => Lost(&["100", "100%"], "skins are dense");
        "infill_rotate_step", "sparse_infill_rotate_template",
            "solid_infill_rotate_template"
            => Lost(&["0", ""], "infill_angle may be a formula of z");
        "fill_multiline" => Lost(&["1"], "lines of infill are single");
        "print_in_clockwise", "wall_direction"
            => Lost(&["0", "auto", "ccw", "counter_clockwise"],
                "walls run counter-clockwise round a part");
        "infill_first", "is_infill_first"
            => Lost(&["0"], "isoslice has an order of its own");
        "wipe_on_loops", "wipe_before_external_loop", "staggered_inner_seams"
            => Lost(&["0"],
                "isoslice has rules of its own for the ends of walls: \
                 seam_gap, retract.wipe");
        "support_material_pattern", "support_base_pattern"
            => Lost(&["default", "auto", "rectilinear", "grid"],
                "supports are filled by their style: support.style");
        "support_material_angle", "support_angle"
            => Lost(&["0"], "lines of supports have no angle of their own");
        "support_material_enforce_layers", "enforce_support_layers",
            "support_remove_small_overhang", "support_critical_regions_only",
            "support_ironing", "enable_support_ironing",
            "raft_first_layer_expansion"
            => Lost(&["0", "2"],
                "supports and rafts have settings of their own: the groups \
                 support and raft");
        "timelapse_type"
            => Lost(&["0"],
                "isoslice makes no room for pictures: if you take any, add it \
                 to gcode.layer");
        "overhang_speed_classic", "slowdown_for_curled_perimeters"
            => Lost(&["0"],
                "speeds of overhangs are steps by how far they reach out: \
                 speed.overhang");
    }
    PRUSA Print {
        "automatic_extrusion_widths" => Ignored(THIN);
    }
    ORCA Print {
        "is_custom_print" => Ignored(SHOWN);
    }
};
