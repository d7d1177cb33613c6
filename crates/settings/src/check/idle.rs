//! Finds settings that were asked for and that other settings deprive of their
//! effect.

use super::round;
use crate::{
    BrimPlace, ByNozzle, DraftShield, InfillMode, LayerHeights, Settings,
    Supports, Varying, WallOrder,
};

/// Heights that differ by less than this count as equal, mm.
const ROUNDED: f64 = 1e-6;

/// Collects warnings of settings that were given and have no effect.
struct Idle<'a> {
    given: &'a dyn Fn(&str) -> bool,
    warnings: &'a mut Vec<String>,
}

impl Idle<'_> {
    /// Warns of a setting that was given, if it is idle.
    fn warn(&mut self, key: &str, idle: bool, message: String) {
        if (self.given)(key) && idle {
            self.warnings.push(message);
        }
    }

    /// Warns of settings that were given, if they are idle. `since` says why,
    /// and what to do.
    fn all(&mut self, keys: &[&str], idle: bool, since: &str) {
        for key in keys {
            let message = format!("{key} has no effect, since {since}");
            self.warn(key, idle, message);
        }
    }
}

/// Warns of settings without effect.
pub(super) fn without_effect(
    s: &Settings,
    given: &dyn Fn(&str) -> bool,
    warnings: &mut Vec<String>,
) {
    let idle = &mut Idle { given, warnings };
    slowing_without_effect(s, idle);
    for (key, value) in [
        ("retract.z_hop", s.retract.z_hop),
        ("retract.extra_prime", s.retract.extra_prime),
    ] {
        idle.warn(
            key,
            s.retract.length == 0.0 && value != 0.0,
            format!(
                "{key} = {value} mm has no effect, since retract.length = 0 \
                 turns retraction off; give it a length, 0.8 mm say"
            ),
        );
    }
    idle.warn(
        "gcode.set_limits",
        !s.gcode.set_limits && s.acceleration.by_role(),
        "gcode.set_limits = false keeps the accelerations by role from the \
         printer: they only count for the estimate; set it to true, or the \
         accelerations to 0"
            .to_owned(),
    );
    idle.warn(
        "ironing",
        s.ironing.is_on() && s.top_layers() == 0,
        "ironing has no effect without solid tops; set top_layers to more than \
         0"
            .to_owned(),
    );
    let height = s.thickest_layer();
    let full = s.contour_z_full_angle().at(height);
    idle.warn(
        "contour_z_angle",
        !s.contour_z.is(0.0) && full < s.contour_z_angle,
        format!(
            "contour_z_angle = {}° has no effect beyond {}° in layers of {} \
             mm, where the nozzle's flat end ({} mm) cuts as deep into the \
             lines beside as they bear; set printer.nozzle_flat if yours is \
             smaller",
            s.contour_z_angle,
            round(full),
            round(height),
            round(s.nozzle_flat()),
        ),
    );
    heights_without_effect(s, idle);
    overhangs_without_effect(s, idle);
    scarfs_without_effect(s, idle);
    interlocking_without_effect(s, idle);
    top_walls_without_effect(s, idle);
    let of_internal_bridges = [
        "internal_bridge_flow",
        "speed.internal_bridge",
        "cooling.internal_bridge_fan_speed",
    ];
    idle.all(
        &of_internal_bridges,
        !s.internal_bridges.is_on(),
        "internal_bridges = false prints no internal bridges; set it to \
         true",
    );
    idle.all(
        &of_internal_bridges,
        s.internal_bridges.is_on() && s.walls == 0 && !s.is_vase(),
        "the ends of internal bridges need walls; set walls to 1 or more",
    );
    idle.warn(
        "skin_wall_overlap",
        s.skin_wall_overlap > 0.0 && s.walls == 0,
        "skin_wall_overlap has no effect, since walls = 0 leaves none to reach \
         into; set walls to 1 or more"
            .to_owned(),
    );
    idle.warn(
        "internal_bridges",
        s.internal_bridges.is_on() && s.walls == 0 && !s.is_vase(),
        "internal_bridges has no effect, since the ends of bridges need \
         walls; set walls to 1 or more"
            .to_owned(),
    );
    idle.all(
        &["contour_z_angle", "contour_z_below"],
        s.contour_z.is(0.0),
        "contour_z = 0% leaves the layers' steps; set contour_z to 100",
    );
    spiral_without_effect(s, idle);
    supports_without_effect(s, idle);
    adhesion_without_effect(s, idle);
    infill_without_effect(s, idle);
}

/// Warns of speeds, and of times of layers, that limit nothing.
fn slowing_without_effect(s: &Settings, idle: &mut Idle<'_>) {
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
    idle.warn(
        "speed.first_layer",
        speed.first_layer > fastest,
        format!(
            "speed.first_layer = {} mm/s is more than any printing speed, so \
             it limits nothing: the first layer is printed at up to {fastest} \
             mm/s; lower it, or raise the others",
            speed.first_layer,
        ),
    );
    idle.warn(
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
    idle.warn(
        "cooling.full_fan_layer",
        (1..=cooling.fan_off_layers).contains(&cooling.full_fan_layer),
        format!(
            "cooling.full_fan_layer = {} has no effect, since the fan is off \
             on the first cooling.fan_off_layers = {} layers; set it to a \
             later one",
            cooling.full_fan_layer, cooling.fan_off_layers,
        ),
    );
    idle.warn(
        "cooling.long_layer_time",
        cooling.long_layer_time <= cooling.min_layer_time,
        format!(
            "cooling.long_layer_time = {} s is not more than \
             cooling.min_layer_time = {} s, so there is nothing between short \
             and long layers; raise it",
            cooling.long_layer_time, cooling.min_layer_time,
        ),
    );
}

/// Warns of settings that one climbing wall leaves no place for.
fn spiral_without_effect(s: &Settings, idle: &mut Idle<'_>) {
    for key in [
        "walls",
        "top_walls",
        "infill",
        "infill_density",
        "top_layers",
        "ironing",
        "fuzzy.thickness",
    ] {
        idle.warn(
            key,
            s.is_vase(),
            format!(
                "{key} has no effect above the flat layers, since spiral \
                 prints plain walls there, as many as it says; leave one of \
                 them out"
            ),
        );
    }
    idle.all(
        &[
            "contour_z",
            "internal_bridges",
            "supports",
            "overhang_reverse",
            "walls_interlocked",
        ],
        s.is_vase(),
        "spiral prints flat layers and plain walls only; leave one \
         of them out",
    );
    idle.warn(
        "wall_order",
        s.is_vase() && s.wall_order == WallOrder::OuterFirstUnlessOverhang,
        "wall_order has no effect on overhangs, since spiral prints flat layers \
         and plain walls only; leave one of them out"
            .to_owned(),
    );
}

/// Warns of settings of brims, shields, skirts and rafts that are not printed.
fn adhesion_without_effect(s: &Settings, idle: &mut Idle<'_>) {
    idle.all(
        &["brim.ear_angle"],
        s.brim.place != BrimPlace::Ears,
        &format!(
            "brim.place = {} makes no ears; set it to \"ears\"",
            s.brim.place.word()
        ),
    );
    if let DraftShield::UpTo(height) = s.draft_shield {
        let first = s.bed_layer_height();
        idle.warn(
            "draft_shield",
            height < first - ROUNDED,
            format!(
                "draft_shield = {height} mm has no effect, since it is less \
                 than the first layer's height of {} mm: no layer has it; set \
                 it to that or more, or to \"full\"",
                round(first),
            ),
        );
    }
    let shield = s.draft_shield != DraftShield::Off;
    idle.all(
        &["skirt.loops", "skirt.layers"],
        shield,
        "the draft shield takes the skirt's place; set draft_shield to \"off\"",
    );
    idle.all(
        &["raft.gap", "raft.expansion"],
        s.raft.layers == 0,
        "raft.layers = 0 prints no raft; set it to 3, say",
    );
    idle.all(
        &["elephant_foot", "first_layer_height"],
        s.raft.layers > 0,
        &format!(
            "the part stands on a raft (raft.layers = {}) and not on the bed; \
         leave one of them out",
            s.raft.layers
        ),
    );
}

/// Warns of settings of supports that are not printed.
fn supports_without_effect(s: &Settings, idle: &mut Idle<'_>) {
    for key in ["support.interface_density", "support.interface_pattern"] {
        idle.warn(
            key,
            s.supports == Supports::Off || s.support.interface_layers == 0,
            format!(
                "{key} has no effect without dense layers of supports; set \
                 supports to \"auto\" or \"plate\", and \
                 support.interface_layers to 1 or more"
            ),
        );
    }
    idle.all(
        &["support.style", "support.where", "support.interface_shape"],
        s.supports == Supports::Off,
        "supports = off prints none; set supports to \"auto\" or \"plate\"",
    );
    idle.all(
        &[
            "support.flow",
            "support.interface_flow",
            "cooling.support_interface_fan_speed",
        ],
        s.supports == Supports::Off && s.raft.layers == 0,
        "neither supports nor a raft are printed; set supports to \"auto\" \
         or \"plate\"",
    );
}

/// Warns of settings of heights that `layer_heights` does not use.
fn heights_without_effect(s: &Settings, idle: &mut Idle<'_>) {
    // Rafts and supports go by the height of uniform layers in any case.
    let part_alone = s.raft.layers == 0 && s.supports == Supports::Off;
    let by_step = s.layer_heights == LayerHeights::Adaptive(ByNozzle::Auto);
    let inside = s.layer_height_min() < s.layer_height()
        && s.layer_height() < s.layer_height_max();
    idle.all(
        &["layer_height"],
        !s.is_uniform() && part_alone && inside && !by_step,
        "layer_heights gives each layer a height of its own, between \
         layer_height_min and layer_height_max; set these, or layer_heights \
         to \"uniform\"",
    );
    idle.all(
        &["layer_height_min", "layer_height_max"],
        s.is_uniform(),
        "layer_heights = uniform makes all layers as high as layer_height; \
         set layer_heights to \"adaptive\"",
    );
}

/// Warns if walls are to interlock and cannot.
fn interlocking_without_effect(s: &Settings, idle: &mut Idle<'_>) {
    let (highest, nozzle) =
        (s.highest_interlocked(), s.printer.nozzle_diameter);
    let why = if s.walls < 2 {
        "walls is less than 2, and the outer wall stays in its layer; set \
         walls to 3 or more"
            .to_owned()
    } else if !s.contour_z.is(0.0) {
        "contour_z leads walls along the surface; leave one of them out"
            .to_owned()
    } else if highest > nozzle {
        format!(
            "the highest beads of such walls, one and a half layers, would be \
             {} mm high, and the nozzle is {nozzle} mm wide; lower \
             layer_height, first_layer_height or layer_height_max",
            round(highest),
        )
    } else {
        return;
    };
    idle.warn(
        "walls_interlocked",
        s.walls_interlocked && !s.is_vase(),
        format!("walls_interlocked = true has no effect, since {why}"),
    );
}

/// Warns if tops are to have fewer walls and cannot.
fn top_walls_without_effect(s: &Settings, idle: &mut Idle<'_>) {
    let Some(tops) = s.top_walls else {
        return;
    };
    let why = if tops >= s.walls {
        format!("walls = {}, which is no more", s.walls)
    } else if s.interlocks() {
        "walls_interlocked = true leads each wall along those of the layers \
         beside it; leave one of them out"
            .to_owned()
    } else {
        "wall_offset = \"field\" takes all walls from the expression; set it to \
         \"distance\""
            .to_owned()
    };
    idle.warn(
        "top_walls",
        !s.is_vase() && s.top_walls() == s.walls,
        format!("top_walls = {tops} has no effect, since {why}"),
    );
}

/// Warns of settings for scarfs that rise.
fn scarfs_without_effect(s: &Settings, idle: &mut Idle<'_>) {
    let scarf = s.seam_scarf;
    let why = if s.is_vase() {
        "spiral prints walls without seams; leave one of them out"
    } else {
        "contour_z leads walls along the surface, where a scarf stays level; \
         leave one of them out"
    };
    idle.warn(
        "seam_scarf",
        scarf.length > 0.0
            && scarf.start < 100.0
            && (s.is_vase() || !s.contour_z.is(0.0)),
        format!("seam_scarf rises nowhere, since {why}"),
    );
    idle.warn(
        "seam_gap",
        scarf.length > 0.0 && s.scarf_rises() && s.seam_gap >= scarf.length,
        format!(
            "seam_gap = {} mm takes away all of the scarf's end (seam_scarf = \
             {} mm), so nothing covers its beginning, which rises from below; \
             lower seam_gap, or set seam_scarf = {1}",
            s.seam_gap, scarf.length,
        ),
    );
}

/// Warns of settings for walls that hang over the layer below.
fn overhangs_without_effect(s: &Settings, idle: &mut Idle<'_>) {
    let unless = WallOrder::OuterFirstUnlessOverhang;
    for (key, value, on) in [
        ("wall_order", unless.word(), s.wall_order == unless),
        ("overhang_reverse", "true", s.overhang_reverse),
    ] {
        idle.warn(
            key,
            on && s.overhang_share >= 100.0,
            format!(
                "{key} = {value} has no effect, since overhang_share = 100% \
                 leaves no wall that counts as an overhang; lower it"
            ),
        );
    }
}

/// Warns of settings for patterns if infill is an expression, and of settings
/// for expressions if infill is a pattern.
fn infill_without_effect(s: &Settings, idle: &mut Idle<'_>) {
    idle.warn(
        "infill_mode",
        s.infill_is_pattern() && s.infill_mode != InfillMode::Surface,
        "infill_mode has no effect: it says what an expression of infill is, \
         and infill is a pattern; set infill to \"expr: ...\""
            .to_owned(),
    );
    let surface = s.infill_mode == InfillMode::Surface;
    for (key, unused, remedy) in [
        (
            "infill_density",
            true,
            "make its lines lie closer or farther apart",
        ),
        ("infill_angle", surface, "turn x and y in it"),
    ] {
        idle.warn(
            key,
            unused && !s.infill_is_pattern(),
            format!(
                "{key} has no effect: it is for patterns, and infill is an \
                 expression of its own; {remedy}, or set infill to a pattern",
            ),
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::keys;

    #[test]
    fn all_settings_that_are_asked_for_are_there() {
        let asked = std::cell::Cell::new(0);
        let given = |key: &str| {
            assert!(keys().iter().any(|known| known.name == key), "{key}");
            asked.set(asked.get() + 1);
            false
        };
        without_effect(&Settings::default(), &given, &mut Vec::new());
        assert!(asked.get() > 50, "{}", asked.get());
    }
}
