//! Words of other slicers, and what they are called here.
//!
//! In: a name that no setting has, or a value that its setting does not take.
//! Out: words for a message, if it is known what is meant.

use super::table::Key;
use super::value::{Raw, ValueKind};

/// Words of other slicers for settings whose names here are too different to be
/// guessed.
const NAMES: &[(&str, &str)] = &[
    ("support.enable", SUPPORTS),
    ("support.enabled", SUPPORTS),
    ("enable_support", SUPPORTS),
    ("support_enable", SUPPORTS),
    ("supports.enable", SUPPORTS),
    ("support_material", SUPPORTS),
    ("support.type", "support.style"),
    ("vase", "spiral"),
    (
        "line_width",
        "outer_wall_width, inner_wall_width, skin_width or infill_width",
    ),
    (
        "extrusion_width",
        "outer_wall_width, inner_wall_width, skin_width or infill_width",
    ),
    ("perimeters", "walls"),
    ("wall_loops", "walls"),
    ("fill_density", "infill_density"),
    (
        "print_speed",
        "speed.outer_wall, or another one of the group speed",
    ),
];

const SUPPORTS: &str = "supports = \"auto\"";

/// What a name of other slicers is here.
pub(super) fn name(name: &str) -> Option<&'static str> {
    let known = NAMES.iter().find(|(word, _)| *word == name);
    known.map(|(_, now)| *now)
}

/// Words of other slicers, and of everyday speech, for values: the setting, the
/// words, and what they are here.
const VALUES: &[(&str, &[&str], &str)] = &[
    (
        "supports",
        &["true", "on", "yes", "1", "everywhere", "normal", "enabled"],
        "supports = \"auto\" prints them wherever they are needed",
    ),
    (
        "supports",
        &["false", "no", "0", "none"],
        "supports = \"off\" prints none",
    ),
    (
        "supports",
        &["tree", "organic", "grid", "snug"],
        "write supports = \"auto\", and the word in support.style",
    ),
    (
        "infill",
        &["honeycomb", "2dhoneycomb", "hexagon", "hexagonal"],
        "honeycombs are \"hexagons\"",
    ),
    (
        "infill",
        &["line", "lines", "zigzag", "zig-zag", "alignedrectilinear"],
        "parallel lines are \"rectilinear\"",
    ),
    (
        "infill",
        &[
            "lightning",
            "adaptivecubic",
            "adaptive-cubic",
            "supportcubic",
            "support-cubic",
            "quartercubic",
            "cubic-subdivision",
            "hilbertcurve",
            "archimedeanchords",
            "octagramspiral",
            "crosshatch",
            "cross",
            "stars",
            "3dhoneycomb",
        ],
        "there is no {} infill; a density by formula, \"expr: 8 + \
         50*exp(-d/3)\", saves as much inside",
    ),
    (
        "brim.place",
        &["true", "on", "yes", "1"],
        "the usual one is \"outer\"",
    ),
    (
        "brim.place",
        &["false", "off", "no", "0"],
        "\"none\" prints none",
    ),
    ("seam", &["back"], "the back is \"rear\""),
];

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
        *name == key.name && words.contains(&word.as_str())
    });
    known.map_or_else(String::new, |(_, _, hint)| {
        format!("; {}", hint.replace("{}", &word))
    })
}
