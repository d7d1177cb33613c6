//! The table of what every key of the other slicers means. Both the translation
//! and the documentation follow from it.

/// Declares rows in groups of one slicer's keys of one kind. A row has some keys,
/// and what they become.
macro_rules! rows {
    ($($of:ident $kind:ident { $($($key:literal),+ => $rule:expr;)* })*) => {
        &[$($(Row { of: $of, kind: $kind, keys: &[$($key),+], rule: $rule }),*),*]
    };
}

mod cura;
mod filament;
mod make;
mod patterns;
mod print;
mod printer;

use crate::Slicer;
pub use crate::conversion::As;
use crate::given::{Given, Value};

/// The kind of a profile, or of a key.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum PresetKind {
    /// A machine.
    Printer,
    /// A material.
    Filament,
    /// A kind of print.
    Print,
}

impl PresetKind {
    /// The kind's word in bundles and on the command line.
    pub fn word(self) -> &'static str {
        match self {
            PresetKind::Printer => "printer",
            PresetKind::Filament => "filament",
            PresetKind::Print => "print",
        }
    }

    /// The kind of a word of any slicer.
    pub(crate) fn of_word(word: &str) -> Option<PresetKind> {
        match word {
            "printer" | "machine" => Some(PresetKind::Printer),
            "filament" => Some(PresetKind::Filament),
            "print" | "process" | "preset" => Some(PresetKind::Print),
            _ => None,
        }
    }
}

/// A row of the table: some keys, and what they become.
#[derive(Debug)]
pub struct Row {
    /// Slicers that have these keys.
    pub of: &'static [Slicer],
    /// The kind of the keys.
    pub kind: PresetKind,
    /// The keys. If they become one setting, the first key that is there
    /// counts.
    pub keys: &'static [&'static str],
    /// What the keys become.
    pub rule: Rule,
}

/// What a key becomes.
#[derive(Debug)]
pub enum Rule {
    /// A setting, by a conversion.
    To(&'static str, As),
    /// Several settings that depend on all keys of the row.
    Made {
        /// The settings.
        settings: &'static [&'static str],
        /// How the settings are made, in a sentence.
        how: &'static str,
        /// Makes the settings.
        make: Make,
    },
    /// Nothing, since isoslice does not need it; the reason.
    Ignored(&'static str),
    /// Nothing, although the key would change the print, unless it has one of
    /// these values; the reason, and what to do.
    Lost(&'static [&'static str], &'static str),
}

/// Makes settings from several keys.
pub struct Make(pub(crate) fn(&Given<'_>) -> Outcome);

impl std::fmt::Debug for Make {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Make")
    }
}

/// The settings that depend on all keys of a row, and how they are made, in a
/// sentence.
const fn made(
    make: fn(&Given<'_>) -> Outcome,
    settings: &'static [&'static str],
    how: &'static str,
) -> Rule {
    let make = Make(make);
    Rule::Made {
        settings,
        how,
        make,
    }
}

/// What became of the keys of a row.
pub(crate) enum Outcome {
    /// They set these settings.
    Set(Vec<(&'static str, Value)>),
    /// They set these settings to what isoslice has instead of what they ask for; the
    /// sentence that says so.
    Alike(Vec<(&'static str, Value)>, String),
    /// Nothing is needed; the reason.
    Nothing(String),
    /// The keys have no counterpart; the reason, and what to do.
    Lost(String),
}

impl Outcome {
    /// The settings, or the reason for none.
    pub(crate) fn of(settings: Vec<(&'static str, Value)>) -> Outcome {
        if settings.is_empty() {
            let why = "it leaves the choice to the slicer";
            Outcome::Nothing(why.to_owned())
        } else {
            Outcome::Set(settings)
        }
    }

    /// One setting.
    pub(crate) fn set(name: &'static str, value: impl Into<Value>) -> Outcome {
        Outcome::Set(vec![(name, value.into())])
    }

    /// Those settings that have a value.
    pub(crate) fn known<V: Into<Value>>(
        all: impl IntoIterator<Item = (&'static str, Option<V>)>,
    ) -> Outcome {
        let all = all.into_iter();
        Outcome::of(all.filter_map(|(k, v)| Some((k, v?.into()))).collect())
    }

    /// One setting, from one key.
    pub(crate) fn to(
        setting: &'static str,
        how: As,
        given: &Given<'_>,
        key: &str,
    ) -> Outcome {
        let value = match how.value(given, key) {
            Ok(Some(value)) => vec![(setting, value)],
            Ok(None) => Vec::new(),
            Err(why) => return Outcome::Lost(why),
        };
        match how.alike(given, key) {
            Some(ours) => Outcome::Alike(
                value,
                format!(
                    "isoslice has no such pattern; {ours} is the most like it"
                ),
            ),
            None => Outcome::of(value),
        }
    }
}

const BOTH: &[Slicer] = &[Slicer::Prusa, Slicer::Orca];
const PRUSA: &[Slicer] = &[Slicer::Prusa];
const ORCA: &[Slicer] = &[Slicer::Orca];
const CURA: &[Slicer] = &[Slicer::Cura];

// Reasons that the keys of several files have.

const SEVERAL: &str = "isoslice prints with one extruder and one material";
const SHOWN: &str = "it is for what the slicer shows";
const SUPPORTS: &str = "isoslice's supports are trees with settings of their \
                        own: the group support";
const EXACT: &str = "outlines are those of the function: accuracy and \
                     path_accuracy";
const RAFT: &str =
    "isoslice's rafts have settings of their own: the group raft";
const JERK: &str = "the speed through corners is one for all: \
                    printer.square_corner_velocity";
const LIFTED: &str = "isoslice decides by what a travel crosses where to \
                      retract and to lift: retract.z_hop_when";
/// Why the flows of walls, skin and infill have no counterparts.
const FLOW: &str = "walls, skin and infill have one flow: flow, which may be a \
                    formula of the place";

/// Every row, in the order in which they are carried out.
pub fn rows() -> impl Iterator<Item = &'static Row> {
    [printer::ROWS, filament::ROWS, print::ROWS, cura::ROWS]
        .into_iter()
        .flatten()
}

/// The row of a slicer's key.
pub(crate) fn row_of(slicer: Slicer, key: &str) -> Option<&'static Row> {
    let mut all = rows().filter(|row| row.of.contains(&slicer));
    all.find(|row| row.keys.contains(&key))
}

/// What a key of any slicer becomes, for people who write it as one of
/// isoslice's settings: their names, or why there is none. A key may be written as a
/// setting of a group, such as `support.threshold_angle`.
pub fn counterpart(key: &str) -> Option<Counterpart> {
    let joined = key.replace('.', "_");
    let of_key = |row: &&Row| row.keys.contains(&joined.as_str());
    let found: Vec<Counterpart> = rows()
        .filter(of_key)
        .map(|row| match &row.rule {
            Rule::To(setting, _) => Counterpart::Keys(vec![setting]),
            Rule::Made { settings, .. } => Counterpart::Keys(settings.to_vec()),
            Rule::Ignored(why) | Rule::Lost(_, why) => Counterpart::None(why),
        })
        .collect();
    // Slicers call different things alike. What there is helps more than what there is
    // not.
    let is_none = |found: &Counterpart| matches!(found, Counterpart::None(_));
    found.into_iter().min_by_key(is_none)
}

/// What stands for another slicer's key.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Counterpart {
    /// One or several settings.
    Keys(Vec<&'static str>),
    /// Nothing; the reason.
    None(&'static str),
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::values::Values;
    use crate::{Picked, Translation, translate};
    use std::collections::BTreeSet;

    fn translated(slicer: Slicer, profile: &str) -> Translation {
        let mut values = Values::default();
        for entry in profile.split("; ").filter(|e| !e.is_empty()) {
            let (key, value) = entry.split_once('=').unwrap();
            values.set(key, vec![value.to_owned()]);
        }
        translate(&Picked {
            slicer,
            names: Vec::new(),
            kinds: Vec::new(),
            values,
        })
    }

    /// The settings that a profile becomes, sorted.
    fn settings(slicer: Slicer, profile: &str) -> String {
        let all = translated(slicer, profile).settings;
        let mut all: Vec<_> = all
            .iter()
            .map(|s| match &s.value {
                Value::Number(x) => format!("{}={x}", s.name),
                Value::Switch(yes) => format!("{}={yes}", s.name),
                Value::Text(text) => format!("{}={text}", s.name),
            })
            .collect();
        all.sort();
        all.join("; ")
    }

    /// A comma or a semicolon parts the values of several extruders, but not G-code.
    #[test]
    fn gcode_may_begin_with_a_comment() {
        for (slicer, key) in [
            (Slicer::Prusa, "start_gcode"),
            (Slicer::Orca, "machine_start_gcode"),
            (Slicer::Cura, "machine_start_gcode"),
        ] {
            let of = |code: &str| settings(slicer, &format!("{key}={code}"));
            assert_eq!(of(";= A1 =\nG28"), "gcode.start=;= A1 =\nG28");
            assert_eq!(of("G28 ;home, all"), "gcode.start=G28 ;home, all");
            assert_eq!(of(""), "");
        }
    }

    /// What is only like the pattern that was asked for is said.
    #[test]
    fn patterns_that_become_others_are_named() {
        let alike = |slicer, profile: &str| {
            let all = translated(slicer, profile).alike;
            all.into_iter().map(|left| left.why).collect::<Vec<_>>()
        };
        let other = alike(Slicer::Orca, "sparse_infill_pattern=crosshatch");
        assert!(other[0].contains("gyroid is the most like it"), "{other:?}");
        assert_eq!(alike(Slicer::Prusa, "fill_pattern=stars").len(), 1);
        let painted = "support_material=1; support_material_auto=0";
        let painted = alike(Slicer::Prusa, painted);
        assert!(painted[0].contains("painted or enforced"), "{painted:?}");
        let off = "support_material=0; support_material_auto=0";
        assert_eq!(alike(Slicer::Prusa, off), [""; 0]);
        let odd =
            "nozzle_temperature=210; nozzle_temperature_initial_layer=abc";
        let odd = alike(Slicer::Orca, odd);
        assert!(odd[0].starts_with("abc is not a number"), "{odd:?}");
        assert_eq!(alike(Slicer::Cura, "infill_pattern=tetrahedral").len(), 1);
        let all = |slicer, key: &str, words: &[(&str, &str)]| {
            for (word, ours) in words {
                let found = alike(slicer, &format!("{key}={word}"));
                let ours = format!("{ours} is the most like it");
                assert_eq!(found.len(), 1, "{key}={word}");
                assert!(found[0].contains(&ours), "{found:?}");
            }
        };
        let of_orca = [
            ("TPMSFK", "schwarz-p"),
            ("alignedrectilinear", "rectilinear"),
            ("aligned-rectilinear", "rectilinear"),
            ("2dhoneycomb", "hexagons"),
            ("lateral-honeycomb", "hexagons"),
            ("lateral-lattice", "grid"),
        ];
        all(Slicer::Orca, "sparse_infill_pattern", &of_orca);
        // The lines of isoslice turn with every layer.
        let aligned = [("alignedrectilinear", "lines")];
        for key in [
            "top_fill_pattern",
            "bottom_fill_pattern",
            "solid_fill_pattern",
        ] {
            all(Slicer::Prusa, key, &aligned);
        }
        let crossed = [("grid", "lines")];
        all(
            Slicer::Prusa,
            "support_material_interface_pattern",
            &crossed,
        );
        for same in ["gyroid", "honeycomb", "line", "monotonic", "cubic"] {
            let profile = format!("fill_pattern={same}");
            assert!(alike(Slicer::Prusa, &profile).is_empty(), "{same}");
        }
        let top = "top_fill_pattern=monotonicline";
        assert!(alike(Slicer::Prusa, top).is_empty(), "{top}");
    }

    #[test]
    fn keys_together_become_what_they_mean() {
        use Slicer::{Cura, Orca, Prusa};
        let fans = |v: u32| {
            format!(
                "cooling.bridge_fan_speed={v}; cooling.fan_speed={v}; \
                 cooling.internal_bridge_fan_speed={v}; \
                 cooling.overhang_fan_speed={v}"
            )
        };
        for (slicer, profile, expected) in [
            // Fans that are off are off at bridges, too.
            (
                Orca,
                "enable_overhang_bridge_fan=0; overhang_fan_speed=90; \
                 fan_min_speed=20",
                fans(20),
            ),
            (
                Orca,
                "overhang_fan_speed=90; internal_bridge_fan_speed=-1",
                "cooling.bridge_fan_speed=90; \
                 cooling.internal_bridge_fan_speed=90; \
                 cooling.overhang_fan_speed=90"
                    .into(),
            ),
            (
                Cura,
                "cool_fan_enabled=False; bridge_fan_speed=100; \
                 cool_fan_speed=50",
                format!("{}; cooling.short_layer_fan_speed=0", fans(0)),
            ),
            (Cura, "cool_fan_speed=40", fans(40)),
            // Travels that need not retract may be of any length there.
            (
                Prusa,
                "only_retract_when_crossing_perimeters=1",
                "retract.max_unretracted=10000; retract.when_crossing=true"
                    .into(),
            ),
            (
                Orca,
                "reduce_infill_retraction=0",
                "retract.when_crossing=false".into(),
            ),
            (
                Cura,
                "retraction_combing_max_distance=0",
                "retract.max_unretracted=10000".into(),
            ),
            (
                Cura,
                "retraction_combing=off; retraction_combing_max_distance=0",
                "retract.when_crossing=false; travel.combing=off".into(),
            ),
            (
                Cura,
                "retraction_combing=noskin; retraction_combing_max_distance=30",
                "retract.max_unretracted=30; travel.combing=not-over-top-skin"
                    .into(),
            ),
            (
                Cura,
                "retraction_combing_max_distance=1; retraction_min_travel=2",
                "retract.max_unretracted=2; retract.min_travel=2".into(),
            ),
            // Rafts, ears, shields, slopes, steps.
            (
                Prusa,
                "raft_layers=3; raft_contact_distance=0.1; brim_width=5",
                "brim.place=none; raft.gap=0.1; raft.layers=3".into(),
            ),
            (Prusa, "raft_layers=0; raft_expansion=2", String::new()),
            (
                Orca,
                "brim_type=brim_ears; brim_width=6; brim_ears_max_angle=120",
                "brim.ear_angle=120; brim.place=ears; brim.width=6".into(),
            ),
            (
                Prusa,
                "draft_shield=enabled; skirt_distance=4",
                "draft_shield=full; skirt.distance=4".into(),
            ),
            (
                Orca,
                "seam_slope_type=all; seam_slope_min_length=10; \
                 seam_slope_start_height=0.05; layer_height=0.2",
                "layer_height=0.2; \
                 seam_scarf=10 mm from 25%"
                    .into(),
            ),
            (
                Prusa,
                "enable_dynamic_overhang_speeds=1; overhang_speed_0=15; \
                 overhang_speed_1=20; overhang_speed_2=50%; overhang_speed_3=0",
                "speed.overhang=25: 100%, 50: 50%, 75: 20, 100: 15".into(),
            ),
            (
                Orca,
                "overhang_1_4_speed=0; overhang_2_4_speed=50; \
                 overhang_3_4_speed=30; overhang_4_4_speed=10",
                "speed.overhang=25: 100%, 50: 50, 75: 30, 100: 10".into(),
            ),
            (
                Cura,
                "adhesion_type=raft; raft_airgap=0.3; brim_width=8",
                "brim.place=none; raft.gap=0.3; raft.layers=4; skirt.loops=0"
                    .into(),
            ),
            (
                Cura,
                "draft_shield_enabled=True; draft_shield_height=12; \
                 draft_shield_height_limitation=limited",
                "draft_shield=12".into(),
            ),
            // Some values in Cura follow from others.
            (
                Cura,
                "line_width=0.5; skin_line_width=0.6",
                "infill_width=0.5; inner_wall_width=0.5; \
                 outer_wall_width=0.5; skin_width=0.6; top_skin_width=0.6"
                    .into(),
            ),
            (
                Cura,
                "top_bottom_thickness=1; bottom_layers=3",
                "bottom_layers=3; top_layers=1 mm".into(),
            ),
            (Cura, "wall_thickness=1.2", "walls=3".into()),
            (Cura, "wall_thickness=0.2", "walls=1".into()),
            (
                Cura,
                "speed_wall=30",
                "speed.inner_wall=60; speed.outer_wall=30".into(),
            ),
            (
                Cura,
                "machine_max_feedrate_x=300; machine_max_feedrate_y=200",
                "printer.max_speed=200".into(),
            ),
            (
                Cura,
                "retraction_extra_prime_amount=1; material_diameter=2.85",
                "filament.diameter=2.85; retract.extra_prime=0.156755".into(),
            ),
            // Switches and words of one slicer.
            (Prusa, "ironing_type=top", String::new()),
            (Orca, "ironing_type=top", "ironing=true".into()),
            (
                Orca,
                "ironing_type=top; ironing_flow=15%",
                "ironing=15".into(),
            ),
            (
                Prusa,
                "ironing=0; ironing_flowrate=15%",
                "ironing=false".into(),
            ),
            (
                Cura,
                "ironing_enabled=True; ironing_flow=12",
                "ironing=12".into(),
            ),
            (
                Prusa,
                "elefant_foot_compensation=0.2",
                "elephant_foot=0.2".into(),
            ),
            (
                Orca,
                "elefant_foot_compensation=0.15; \
                 elefant_foot_compensation_layers=3",
                "elephant_foot=0.15 mm over 3 layers".into(),
            ),
            (
                Prusa,
                "top_fill_pattern=rectilinear; \
                 bottom_fill_pattern=monotonic; \
                 solid_fill_pattern=concentric",
                "skin_pattern=top: unordered-lines, bottom: lines, \
                 internal: concentric"
                    .into(),
            ),
            // A pattern that isoslice does not have leaves the others.
            (
                Prusa,
                "top_fill_pattern=hilbertcurve; \
                 bottom_fill_pattern=concentric",
                "skin_pattern=bottom: concentric".into(),
            ),
            (Orca, "max_bridge_length=0", "bridge_max=0.1".into()),
            // SuperSlicer's.
            (
                Prusa,
                "overhangs_speed=50%; bridge_speed=60; overhangs_reverse=1; \
                 overhangs_fan_speed=80",
                "cooling.overhang_fan_speed=80; overhang_reverse=true; \
                 speed.bridge=60; speed.overhang=30"
                    .into(),
            ),
            (Prusa, "overhangs_fan_speed=-1", String::new()),
            (
                Cura,
                "layer_height=0.2; line_width=0.4; wall_overhang_angle=45; \
                 wall_overhang_speed_factor=50",
                "infill_width=0.4; inner_wall_width=0.4; layer_height=0.2; \
                 outer_wall_width=0.4; skin_width=0.4; \
                 speed.overhang=50.0: 100%, 50.1: 50%; top_skin_width=0.4"
                    .into(),
            ),
            (
                Cura,
                "layer_height=0.2; wall_line_width_0=0.4; \
                 wall_overhang_angle=45; wall_overhang_speed_factors=[80, 40]",
                "layer_height=0.2; outer_wall_width=0.4; \
                 speed.overhang=50.0: 100%, 50.1: 80%"
                    .into(),
            ),
            (
                Cura,
                "wall_overhang_angle=90; wall_overhang_speed_factor=50",
                String::new(),
            ),
            (
                Orca,
                "small_perimeter_threshold=0",
                "speed.small_wall_length=0".into(),
            ),
            (Prusa, "filament_retract_length=nil,nil", String::new()),
            (
                Prusa,
                "infill_extrusion_width=150%; nozzle_diameter=0.4; \
                 layer_height=0.2; perimeter_extrusion_spacing=0.4",
                "infill_width=0.6; layer_height=0.2; \
                 printer.nozzle_diameter=0.4"
                    .into(),
            ),
            (
                Prusa,
                "infill_extrusion_width=150%; nozzle_diameter=0.4; \
                 layer_height=0.2",
                "infill_width=0.3; layer_height=0.2; \
                 printer.nozzle_diameter=0.4"
                    .into(),
            ),
        ] {
            assert_eq!(settings(slicer, profile), expected, "{profile}");
        }
    }

    #[test]
    fn what_would_change_the_print_is_lost_unless_it_is_off() {
        for key in [
            "infill_combination",
            "automatic_infill_combination",
            "solid_infill_every_layers",
            "make_overhang_printable",
            "hole_to_polyhole",
            "alternate_extra_wall",
        ] {
            let of =
                |value| translated(Slicer::Orca, &format!("{key}={value}"));
            assert_eq!(of(1).lost.len(), 1, "{key}");
            assert_eq!(of(0).ignored.len(), 1, "{key}");
        }
        for (slicer, key, on, off) in [
            (Slicer::Orca, "initial_layer_line_width", "0.5", "0"),
            (Slicer::Prusa, "first_layer_extrusion_width", "0.5", "0"),
            (Slicer::Orca, "slow_down_layers", "3", "0"),
            (Slicer::Orca, "initial_layer_infill_speed", "60", "0"),
            (Slicer::Orca, "extra_perimeters_on_overhangs", "1", "0"),
            (Slicer::Prusa, "extra_perimeters_on_overhangs", "1", "0"),
            (Slicer::Orca, "timelapse_type", "1", "0"),
            (Slicer::Orca, "dont_slow_down_outer_wall", "1", "0"),
            (Slicer::Prusa, "max_speed_reduction", "50%", "90%"),
            (Slicer::Orca, "additional_cooling_fan_speed", "70", "0"),
            (Slicer::Orca, "bridge_density", "80%", "100%"),
            (Slicer::Orca, "adaptive_pressure_advance", "1", "0"),
            (Slicer::Orca, "outer_wall_flow_ratio", "0.9", "1"),
            (Slicer::Orca, "outer_wall_jerk", "9", "0"),
            (Slicer::Orca, "only_one_wall_first_layer", "1", "0"),
            (Slicer::Orca, "z_hop_types", "Spiral Lift", "Normal Lift"),
            (Slicer::Orca, "skirt_type", "perobject", "combined"),
            (Slicer::Orca, "enable_height_slowdown", "1", "0"),
            (Slicer::Orca, "fuzzy_skin_noise_type", "perlin", "classic"),
            (Slicer::Cura, "speed_slowdown_layers", "5", "0"),
            (
                Slicer::Cura,
                "initial_layer_line_width_factor",
                "120",
                "100",
            ),
            (Slicer::Cura, "coasting_enable", "True", "False"),
            (Slicer::Cura, "infill_offset_x", "2", "0"),
        ] {
            let of = |value| translated(slicer, &format!("{key}={value}"));
            assert_eq!(of(on).lost.len(), 1, "{key}");
            assert_eq!(of(off).ignored.len(), 1, "{key}");
        }
        let sandwich = "wall_sequence=inner-outer-inner wall";
        assert_eq!(translated(Slicer::Orca, sandwich).lost.len(), 1);
        let scarf = settings(Slicer::Orca, "seam_slope_type=external");
        assert_eq!(scarf, "seam_scarf=20 mm from 10%");
        for word in ["auto_brim", "painted"] {
            let profile = format!("brim_type={word}; brim_width=5");
            assert_eq!(translated(Slicer::Orca, &profile).lost.len(), 2);
        }
    }

    #[test]
    fn a_key_is_in_one_row() {
        for slicer in [Slicer::Prusa, Slicer::Orca, Slicer::Cura] {
            let mut seen = BTreeSet::new();
            for row in rows().filter(|row| row.of.contains(&slicer)) {
                for key in row.keys {
                    assert!(seen.insert(key), "{slicer:?} {key} twice");
                }
            }
        }
    }
}
