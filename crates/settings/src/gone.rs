//! Settings that are no more.
//!
//! In: a name that a setting once had. Out: what to write instead.

use isoslice_base::pairs;

/// Names of settings that are no more, each with what to write instead.
const GONE: &[(&str, &str)] = pairs! {
    "top_thickness" => "write the thickness in top_layers, such as \"0.8 mm\"";
    "bottom_thickness"
        => "write the thickness in bottom_layers, such as \"0.6 mm\"";
    "spiral_walls" => "write the number of walls in spiral, such as spiral = 2";
    "internal_bridge_layers"
        => "write the number of layers in internal_bridges, such as \
            internal_bridges = 2";
    "draft_shield_gap"
        => "set skirt.distance to it if there is a draft shield, else leave it \
            out";
    "speed.overhang_steps"
        => "write the steps in speed.overhang, such as \"25: 80%, 50: 30, 100: \
            10\"";
    "cooling.overhang_fan_steps"
        => "write the steps in cooling.overhang_fan_speed, such as \"25: 50, \
            100: 100\"";
    "acceleration.travel" => "write printer.travel_acceleration";
    "bottom_skin_width"
        => "write skin_width, which is for bottoms and bridges as well";
    "contour_z_gouge"
        => "write printer.nozzle_flat: the smaller the nozzle's flat end, the \
            steeper the faces that are followed";
    "infill_phase"
        => "write an infill of your own, \"expr: ...\", with an x or y that is \
            moved";
    "infill_centre"
        => "write an infill of your own, \"expr: ...\"; patterns are laid out \
            from the middle of the part";
    "overhang_inner_first"
        => "write wall_order = \"outer-first-unless-overhang\"";
    "printer.takes_arcs"
        => "write gcode.arcs = true for a printer that follows arcs well";
    "retract.ooze_prime"
        => "leave it out: a travel longer than retract.max_unretracted \
            retracts";
    "seam_scarf_rise"
        => "write in seam_scarf from which height scarfs rise, such as \"20 mm \
            from 10%\"";
    "seam_scarf_start" => "write it in seam_scarf, such as \"20 mm from 10%\"";
    "elephant_foot_layers"
        => "write the number in elephant_foot, such as \"0.2 mm over 3 \
            layers\"";
    "step_error"
        => "write the step in layer_heights, such as \"adaptive 0.1 mm\"";
    "top_skin_pattern"
        => "write it in skin_pattern, such as \"top: concentric\"";
    "bottom_skin_pattern"
        => "write it in skin_pattern, such as \"bottom: concentric\"";
    "internal_skin_pattern"
        => "write it in skin_pattern, such as \"internal: concentric\"";
    "top_skin_order" => "write skin_pattern = \"top: unordered-lines\"";
    "ironing_flow" => "write the share in ironing, such as ironing = 15";
    "bridges" => "write bridge_max = 0";
    "infill_walls"
        => "write the number in infill_mode, such as infill_mode = 2";
    "support.interface_angle"
        => "write the angle in support.interface_pattern, such as \
            interface_pattern = 20";
    "brim.ear_radius" => "write the radius in brim.width";
    "printer.head_clearance_height"
        => "write the height in printer.head_clearance_radius, such as \"45 mm \
            above 7 mm\"";
    "support.interface_spacing"
        => "write the distance in support.interface_density, such as \"0.8 \
            mm\"";
};

/// What to write instead of a setting that is no more. The name may be without its
/// group.
pub fn instead(name: &str) -> Option<&'static str> {
    let is = |old: &str| {
        old == name || old.split_once('.').is_some_and(|(_, leaf)| leaf == name)
    };
    let gone = GONE.iter().find(|(old, _)| is(old));
    gone.map(|(_, instead)| *instead)
}

/// What to do about a setting that is no more. Files of all settings name it even
/// at its default; then it may be left out.
pub(super) fn advice(name: &str) -> Option<String> {
    let instead = instead(name)?;
    Some(if instead.starts_with("write") {
        format!("leave it out if it has its old default, else {instead}")
    } else {
        instead.to_owned()
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Builder, keys};

    #[test]
    fn old_names_tell_what_to_write() {
        for (old, instead) in GONE {
            let is = keys().iter().any(|key| key.name == *old);
            assert!(!is, "{old} is a setting");
            let mut builder = Builder::new();
            let error = builder.set(&format!("{old}=1")).unwrap_err();
            assert!(error.to_string().ends_with(instead), "{error}");
            // A setting of a group is found by its own name as well, unless that
            // means something else.
            let leaf = old.split('.').next_back().unwrap_or(old);
            assert!(leaf == "travel" || self::instead(leaf).is_some());
            // A settings file, where the name may be in a group.
            let error = builder.toml("a.toml", &format!("{old} = 1"));
            let error = error.unwrap_err().to_string();
            assert!(error.starts_with("a.toml:1"), "{error}");
            assert!(error.ends_with(instead), "{error}");
            // It speaks of a setting that there is.
            let named = keys().iter().any(|key| instead.contains(key.name));
            assert!(named, "{instead}");
        }
    }
}
