//! Finds settings that were asked for and that other settings deprive of their
//! effect.

use super::round;
use crate::settings::{InfillMode, Settings, Varying};

/// Warns of settings without effect.
pub(super) fn without_effect(
    s: &Settings,
    given: &dyn Fn(&str) -> bool,
    warnings: &mut Vec<String>,
) {
    let mut warn = |key: &str, idle: bool, message: String| {
        if idle && given(key) {
            warnings.push(message);
        }
    };
    let speed = &s.speed;
    let fastest = [
        &speed.outer_wall,
        &speed.inner_wall,
        &speed.gap_fill,
        &speed.sparse_infill,
        &speed.internal_skin,
        &speed.top_skin,
        &speed.bottom_skin,
        &Varying::Constant(speed.skirt),
    ]
    .into_iter()
    .map(|speed| speed.constant().unwrap_or(f64::INFINITY))
    .fold(0.0, f64::max);
    warn(
        "speed.first_layer",
        speed.first_layer > fastest,
        format!(
            "speed.first_layer = {} mm/s is more than any printing speed, so \
             it limits nothing: the first layer is printed at up to {fastest} \
             mm/s; lower it, or raise the others",
            speed.first_layer,
        ),
    );
    warn(
        "cooling.min_speed",
        s.cooling.min_speed > fastest && s.cooling.min_layer_time > 0.0,
        format!(
            "cooling.min_speed = {} mm/s is more than any printing speed, so \
             no layer can be slowed down to take cooling.min_layer_time; \
             lower it",
            s.cooling.min_speed,
        ),
    );
    let cooling = &s.cooling;
    warn(
        "cooling.full_fan_layer",
        (1..=cooling.fan_off_layers).contains(&cooling.full_fan_layer),
        format!(
            "cooling.full_fan_layer = {} has no effect, since the fan is off \
             on the first cooling.fan_off_layers = {} layers; set it to a \
             later one",
            cooling.full_fan_layer, cooling.fan_off_layers,
        ),
    );
    warn(
        "cooling.long_layer_time",
        cooling.long_layer_time <= cooling.min_layer_time,
        format!(
            "cooling.long_layer_time = {} s is not more than \
             cooling.min_layer_time = {} s, so there is nothing between short \
             and long layers; raise it",
            cooling.long_layer_time, cooling.min_layer_time,
        ),
    );
    for (key, value) in [
        ("retract.z_hop", s.retract.z_hop),
        ("retract.extra_prime", s.retract.extra_prime),
    ] {
        warn(
            key,
            s.retract.length == 0.0 && value != 0.0,
            format!(
                "{key} = {value} mm has no effect, since retract.length = 0 \
                 turns retraction off; give it a length, 0.8 mm say"
            ),
        );
    }
    warn(
        "gcode.set_limits",
        !s.gcode.set_limits && s.acceleration.by_role(),
        "gcode.set_limits = false keeps the accelerations by role from the \
         printer: they only count for the estimate; set it to true, or the \
         accelerations to 0"
            .to_owned(),
    );
    warn(
        "ironing",
        s.ironing && s.top_layers() == 0,
        "ironing = true has no effect without solid tops; set top_layers or \
         top_thickness to more than 0"
            .to_owned(),
    );
    let height = s.layer_height();
    let full = s.contour_z_full_angle(height);
    warn(
        "contour_z_angle",
        !s.contour_z.is(0.0) && full < s.contour_z_angle,
        format!(
            "contour_z_angle = {}° has no effect beyond {}° in layers of {} \
             mm, where the nozzle's flat end ({} mm) cuts as deep into the \
             lines beside as contour_z_gouge allows; raise contour_z_gouge, \
             or tell printer.nozzle_flat if it is less",
            s.contour_z_angle,
            round(full),
            round(height),
            round(s.nozzle_flat()),
        ),
    );
    for key in [
        "internal_bridge_flow",
        "speed.internal_bridge",
        "cooling.internal_bridge_fan_speed",
    ] {
        warn(
            key,
            !s.internal_bridges,
            format!(
                "{key} has no effect, since internal_bridges = false prints \
                 no internal bridges; set it to true"
            ),
        );
    }
    for key in ["contour_z_angle", "contour_z_gouge"] {
        warn(
            key,
            s.contour_z.is(0.0),
            format!(
                "{key} has no effect, since contour_z = 0% leaves the layers' \
                 steps; set contour_z to 100"
            ),
        );
    }
    for key in [
        "walls",
        "infill",
        "infill_density",
        "top_layers",
        "top_thickness",
        "ironing",
        "contour_z",
        "internal_bridges",
        "fuzzy_skin",
        "supports",
    ] {
        warn(
            key,
            s.spiral,
            format!(
                "{key} has no effect above the flat layers, since spiral = \
                 true prints one plain wall there; leave one of them out"
            ),
        );
    }
    infill_without_effect(s, &mut warn);
}

/// Warns of settings for patterns if infill is an expression, and the reverse.
fn infill_without_effect(
    s: &Settings,
    warn: &mut dyn FnMut(&str, bool, String),
) {
    warn(
        "infill_mode",
        s.infill_is_pattern() && s.infill_mode != InfillMode::Surface,
        format!(
            "infill_mode = {} has no effect: it says what an expression of \
             infill is, and infill is a pattern; set infill to \"expr: ...\"",
            s.infill_mode.word(),
        ),
    );
    let surface = s.infill_mode == InfillMode::Surface;
    for (key, idle, remedy) in [
        (
            "infill_density",
            true,
            "make its lines lie closer or farther apart",
        ),
        ("infill_angle", surface, "turn x and y in it"),
        ("infill_phase", true, "add to x and y in it"),
        ("infill_centre", true, "add to x and y in it"),
    ] {
        warn(
            key,
            idle && !s.infill_is_pattern(),
            format!(
                "{key} has no effect: it is for patterns, and infill is an \
                 expression of its own; {remedy}, or set infill to a pattern",
            ),
        );
    }
}
