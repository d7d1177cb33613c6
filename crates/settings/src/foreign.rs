//! Words of other slicers, and what they are called here.
//!
//! In: a name that no setting has, or a value that its setting does not take.
//! Out: words for a message, if it is known what is meant.

use super::table::Key;
use super::value::{Raw, ValueKind};
use isoslice_base::pairs;

/// A setting that turns something on, for groups whose first setting leaves it
/// off.
const GROUPS: &[(&str, &str, &str)] = &[
    ("raft", "raft.layers", "3"),
    ("brim", "brim.place", "\"outer\""),
    ("skirt", "skirt.loops", "2"),
    ("fuzzy", "fuzzy.thickness", "0.3"),
];

/// A setting of a group, and a value that turns something on.
pub(super) fn example(group: &str) -> Option<(&'static str, &'static str)> {
    let found = GROUPS.iter().find(|(name, _, _)| *name == group);
    found.map(|(_, setting, value)| (*setting, *value))
}

/// Words of other slicers for settings whose names here are too different to be
/// guessed.
const NAMES: &[(&str, &str)] = pairs! {
    "support.enable", "support.enabled", "enable_support", "support_enable",
        "supports.enable", "support_material" => SUPPORTS;
    "support.type" => "support.style";
    "vase", "spiralize", "spiral_vase" => "spiral";
    "adhesion", "adhesion_type", "bed_adhesion", "plate_adhesion" => ADHESION;
    "nozzle", "nozzle_size" => "printer.nozzle_diameter";
    "print_temperature", "printing_temperature", "extruder_temperature",
        "hotend_temperature" => "filament.nozzle_temperature";
    "bed" => "filament.bed_temperature";
    "filament_type", "material", "material_type" => "--filament NAME";
    "quality" => "--preset NAME";
    "profile" => "--printer, --filament or --preset";
    "wall_thickness" => "walls, a number of lines";
    "shells" => "walls";
    "top_bottom_thickness" => "top_layers and bottom_layers";
    "pattern", "infill_pattern", "fill_pattern" => "infill";
    "density", "fill" => "infill_density";
    "adaptive", "adaptive_layers", "variable_layer_height" => ADAPTIVE;
    "overhang_angle", "support_material_threshold" => "support.angle";
    "retraction_speed" => "retract.speed";
    "retraction_amount", "retraction_distance", "retraction"
        => "retract.length";
    "fuzzy_skin" => "fuzzy.thickness";
    "flow_ratio", "extrusion_multiplier" => "filament.flow";
    "elephant_foot_compensation", "elefant_foot_compensation"
        => "elephant_foot";
    "horizontal_expansion" => "xy_compensation";
    "skirts" => "skirt.loops";
    "bed_size" => "printer.bed_x and printer.bed_y";
    "start_gcode" => "gcode.start";
    "end_gcode" => "gcode.end";
    "seam_position" => "seam";
    "gcode_flavor" => "gcode.flavour";
    "fan" => "cooling.fan_speed";
    "pause", "pauses", "pause_at_layer", "pause_layer", "pause_at_height",
        "pause_height", "pause_print", "pause_gcode", "pause_print_gcode",
        "machine_pause_gcode", "color_change", "colour_change",
        "color_change_gcode", "color_change_at_layer", "filament_change",
        "filament_change_at_layer" => PAUSE;
    "threshold_angle" => "support.angle";
    "acceleration"
        => "acceleration.outer_wall, or another one of the group acceleration";
    "line_width", "extrusion_width"
        => "outer_wall_width, inner_wall_width, skin_width or infill_width";
    "perimeters", "wall_loops" => "walls";
    "fill_density" => "infill_density";
    "print_speed" => "speed.outer_wall, or another one of the group speed";
};

const SUPPORTS: &str = "supports = \"auto\"";
const ADAPTIVE: &str = "layer_heights = \"adaptive\"";
/// docs/gcode.md says which line pauses which firmware.
const PAUSE: &str = "gcode.layer, with the firmware's pause in one layer, such as \
                     {% if layer == 25 %}M0{% endif %}";
const ADHESION: &str = "brim.place = \"outer\", skirt.loops = 2 or \
                        raft.layers = 3";

/// What a name of other slicers is here.
pub fn name(name: &str) -> Option<&'static str> {
    let known = NAMES.iter().find(|(word, _)| *word == name);
    known.map(|(_, now)| *now)
}

/// Declares rows in groups of one setting.
macro_rules! values {
    ($($setting:literal { $($($word:expr),+ => $hint:literal;)+ })+) => {
        &[$($(($setting, &[$($word),+], $hint)),+),+]
    };
}

/// Words of other slicers, and of everyday speech, for values: the setting, the
/// words, and what they are here.
const VALUES: &[(&str, &[&str], &str)] = values! {
    "supports" {
        "true", "on", "yes", "1", "everywhere", "normal", "enabled"
            => "supports = \"auto\" prints them wherever they are needed";
        "false", "no", "0", "none" => "supports = \"off\" prints none";
        "tree", "organic", "grid", "snug"
            => "write supports = \"auto\", and the word in support.style";
    }
    "infill" {
        "honeycomb", "2dhoneycomb", "hexagon", "hexagonal"
            => "honeycombs are \"hexagons\"";
        "line", "lines", "zigzag", "zig-zag", "alignedrectilinear"
            => "parallel lines are \"rectilinear\"";
        "lightning", "adaptivecubic", "adaptive-cubic", "supportcubic",
            "support-cubic", "quartercubic", "cubic-subdivision",
            "hilbertcurve", "archimedeanchords", "octagramspiral", "crosshatch",
            "cross", "stars", "3dhoneycomb"
            => "there is no {} infill; a density by formula, \"expr: 8 + \
                50*exp(-d/3)\", saves as much inside";
        A_NUMBER => "how much of it is infill_density = {}";
    }
    "brim.place" {
        "true", "on", "yes", "1" => "the usual one is \"outer\"";
        "false", "off", "no", "0" => "\"none\" prints none";
    }
    "seam" {
        "back" => "the back is \"rear\"";
        "sharpest_corner", "sharpest", "corner", "smart", "hidden"
            => "\"aligned\" takes the best corner";
    }
    "layer_heights" {
        "variable", "varying", "true", "on", "auto", "smart", "dynamic"
            => "heights that follow the surface are \"adaptive\"";
        "false", "off", "none" => "equal ones are \"uniform\"";
    }
    "infill_density" {
        "gyroid", "grid", "cubic", "triangles", "rectilinear", "hexagons",
            "concentric", "diamond", "schwarz-p", "neovius", "lidinoid"
            => "the pattern is infill = \"{}\"";
        "line", "lines", "zigzag" => "the pattern is infill = \"rectilinear\"";
        "honeycomb" => "the pattern is infill = \"hexagons\"";
    }
    "walls" {
        "arachne", "classic", "variable"
            => "it is a number of lines; their widths adapt by themselves";
        A_LENGTH
            => "it is a number of lines; their width is outer_wall_width and \
                inner_wall_width";
    }
    "top_layers" {
        "none", "off", "false", "no" => "0 prints none";
    }
    "bottom_layers" {
        "none", "off", "false", "no" => "0 prints none";
    }
    "ironing" {
        "top", "all", "topmost", "solid", "tops" => "true irons the tops";
    }
    "spiral" {
        "vase" => "true prints a vase in one line";
    }
    "gcode.flavour" {
        "reprapfirmware", "reprap", "duet", "marlin2", "marlin-2"
            => "Duet's is \"rrf\", and \"marlin\" is any Marlin's";
    }
};

/// Stands for any number, with or without %, among words.
const A_NUMBER: &str = "0%";
/// Stands for any number with mm after it.
const A_LENGTH: &str = "0mm";

/// True if a word is what a word of the table stands for.
fn stands_for(known: &str, word: &str) -> bool {
    let number = |end: char| {
        let digits = word.trim_end_matches(end).trim_end();
        digits.parse::<f64>().is_ok_and(f64::is_finite)
    };
    match known {
        A_NUMBER => number('%'),
        A_LENGTH => word.ends_with("mm") && number('m'),
        _ => known == word,
    }
}

/// What a word of other slicers is here, as the end of a sentence.
pub(super) fn value(key: &Key, raw: Raw<'_>) -> String {
    let word = match raw {
        Raw::Text(word) | Raw::Word(word) => word.to_lowercase(),
        Raw::Float(_) if key.kind() == ValueKind::Whole => {
            return ", without a point".to_owned();
        }
        Raw::Bool(_) | Raw::Integer(_) => raw.describe(),
        _ => return String::new(),
    };
    if word.parse::<f64>().is_ok_and(f64::is_finite) {
        match (raw, key.kind()) {
            (
                Raw::Text(_),
                ValueKind::Whole
                | ValueKind::Number
                | ValueKind::Varying
                | ValueKind::NumberOrAuto,
            ) => return ", without quotes".to_owned(),
            (_, ValueKind::Whole) => return ", without a point".to_owned(),
            _ => {}
        }
    }
    let comma = word.replacen(',', ".", 1);
    if word.contains(',') && comma.parse::<f64>().is_ok() {
        return format!("; numbers have a point, as in {comma}");
    }
    let known = VALUES.iter().find(|(name, words, _)| {
        *name == key.name && words.iter().any(|known| stands_for(known, &word))
    });
    known.map_or_else(String::new, |(_, _, hint)| {
        format!("; {}", hint.replace("{}", &word))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Builder;

    fn told(assignment: &str) -> String {
        let set = Builder::new().set(assignment).err();
        set.map_or_else(String::new, |error| error.to_string())
    }

    #[test]
    fn what_other_slicers_say_is_understood() {
        for (assignment, wanted) in [
            ("spiral_vase=true", "did you mean spiral?"),
            ("adhesion=brim", "brim.place = \"outer\""),
            ("nozzle=0.6", "did you mean printer.nozzle_diameter?"),
            ("adaptive_layers=true", "layer_heights = \"adaptive\""),
            ("layer_heights=variable", "are \"adaptive\""),
            ("infill=20%", "infill_density = 20%"),
            ("infill=20", "infill_density = 20"),
            ("infill_density=gyroid", "infill = \"gyroid\""),
            ("infill_density=Honeycomb", "infill = \"hexagons\""),
            ("walls=0.8mm", "outer_wall_width"),
            ("walls=arachne", "by themselves"),
            ("seam=smart", "\"aligned\""),
            ("raft=true", "raft.layers = 3"),
            ("brim=5", "brim.place = \"outer\""),
            ("support=true", "did you mean supports?"),
            ("gcode.flavour=duet", "\"rrf\""),
            ("color_change=3", "gcode.layer, with the firmware's pause"),
            ("pause_at_layer=3", "{% if layer == 25 %}M0{% endif %}"),
        ] {
            let told = told(assignment);
            assert!(told.contains(wanted), "{assignment}: {told}");
        }
    }

    /// What the tables say can be written.
    #[test]
    fn what_is_advised_exists() {
        let is_key = |name: &str| crate::keys().iter().any(|k| k.name == name);
        for (word, now) in NAMES {
            assert!(!is_key(word), "{word}");
            let first = now.split([' ', ',']).next().unwrap_or_default();
            assert!(first.starts_with("--") || is_key(first), "{word}: {now}");
        }
        for (name, words, hint) in VALUES {
            assert!(is_key(name), "{name}");
            for word in *words {
                let given = format!("{name}={word}");
                assert!(Builder::new().set(&given).is_err(), "{given}");
                let hint = hint.replace("{}", word);
                if let Some((before, value)) = hint.split_once(" = ") {
                    let key = before.rsplit(' ').next().unwrap_or_default();
                    let end = [' ', ',', ';'];
                    let value = value.split(end).next().unwrap_or_default();
                    assert_eq!(told(&format!("{key}={value}")), "", "{hint}");
                }
            }
        }
        for (_, setting, value) in GROUPS {
            assert_eq!(told(&format!("{setting}={value}")), "");
        }
    }
}
