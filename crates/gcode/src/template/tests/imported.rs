//! Templates of other slicers, translated as imports do it and filled in.

use super::*;
use isoslice_settings::testing::settings;
use slicerprofile::{Place, foreign_names, translated};

fn ours(source: &str, place: Place) -> Result<String, String> {
    let name = match place {
        Place::Start => START,
        Place::Layer => LAYER,
        Place::End => END,
    };
    let ours = translated(source, place, &|own| is_placeholder(name, own));
    ours.map_err(|wrong| format!("{name}, {wrong}"))
}

fn templates(start: &str, layer: &str, end: &str) -> Result<String, String> {
    let s = settings(&["filament.first_layer_bed_temperature=65"]);
    let [begin, every, last] = [
        ours(start, Place::Start)?,
        ours(layer, Place::Layer)?,
        ours(end, Place::End)?,
    ];
    let mut plan = WriterPlan::of(&s);
    plan.templates = [&begin, &last, &every];
    let moment = crate::placeholders::Moment {
        number: 3,
        bottom: 0.0,
        z: 0.6,
        height: 0.2,
    };
    Templates::new(&plan, &header())
        .and_then(|t| match (start, layer) {
            ("", "") => t.try_end(),
            ("", _) => t.layer(moment).map(Option::unwrap_or_default),
            _ => t.start(),
        })
        .map_err(|e| e.to_string())
}

#[track_caller]
fn assert_start(source: &str, expected: &str) {
    assert_eq!(
        templates(source, "", "").as_deref(),
        Ok(expected),
        "{source}"
    );
}

#[test]
fn the_usual_placeholders_of_other_slicers_are_ours() {
    for (theirs, ours) in [
        ("M104 S[first_layer_temperature]", "M104 S215"),
        ("M104 S{first_layer_temperature[0]}", "M104 S215"),
        (
            "M104 S{first_layer_temperature[initial_extruder]}",
            "M104 S215",
        ),
        ("M104 S[nozzle_temperature_initial_layer]", "M104 S215"),
        ("M104 S{material_print_temperature_layer_0}", "M104 S215"),
        (
            "M109 S{material_print_temperature_layer_0, initial_extruder_nr}",
            "M109 S215",
        ),
        ("M109 S{temperature[0]}", "M109 S210"),
        ("M190 S[bed_temperature_initial_layer_single]", "M190 S65"),
        ("M140 S{bed_temperature}", "M140 S60"),
        ("M140 S[ bed_temperature ]", "M140 S60"),
        ("G1 Z{max_layer_z + 0.5}", "G1 Z30.5"),
        (
            "G1 X{print_bed_max[0]} Y{print_bed_max[1]/2}",
            "G1 X220 Y110",
        ),
        ("T[initial_tool]", "T0"),
        ("START LAYERS={total_layer_count}", "START LAYERS=12"),
        ("M117 [input_filename_base]", "M117 gyroid ball"),
        ("G1 X{first_layer_print_min[0]}", "G1 X95"),
        ("M104 S{first_layer_temperature[0] / 4}", "M104 S53"),
        ("G1 F{travel_speed*60}", "G1 F9000"),
        (
            "M104 S{min(max(first_layer_temperature[0] - 70, 120), 150)}",
            "M104 S145",
        ),
        (
            "G1 E{int(0.4*7)} F{round(12.6)} Z{-(1.5)}",
            "G1 E2 F13 Z-1.5",
        ),
        ("G4 P{bed_temperature[0] > 50 ? 100 : 5}", "G4 P100"),
        (
            "M201 X{interpolate_table(0.2*5, (0,7000), (2,4000), (3,2000))} \
             Y{interpolate_table(9, (0,7000), (2-1,1))} \
             Z{interpolate_table(-9, (0.5,7000), (2,1))}",
            "M201 X5500 Y1 Z7000",
        ),
        ("M117 {1}", "M117 1"),
        ("G28 ; [first_layer_temperature]", "G28 ; 215"),
    ] {
        assert_start(theirs, &format!("{ours}\n"));
    }
    let layer = "M117 [layer_num] {layer_z} {if layer_num==2}yes{endif}\nM400";
    let filled = templates("", layer, "");
    assert_eq!(filled.as_deref(), Ok("M117 2 0.6 yes\nM400\n"));
    let end =
        templates("", "", "G1 Z{min(max_layer_z + 50, max_print_height)}");
    assert_eq!(end.as_deref(), Ok("G1 Z80\n"));
    // At the end the last layer is meant.
    let end = templates("", "", "G1 Z{layer_z + 1} ; [layer_num]");
    assert_eq!(end.as_deref(), Ok("G1 Z31 ; 11\n"));
}

#[test]
fn conditions_of_other_slicers_are_ours() {
    let source = "G28\n\
        {if bed_temperature[0] > 90 && filament_type[0] == \"ABS\"}\n\
        M141 S50\n\
        {elsif !(layer_height >= 0.3) or false}\n\
        M190 S[bed_temperature]\n\
        {else}\n\
        G4 S1\n\
        {endif}\n\
        G29";
    assert_start(source, "G28\nM190 S60\nG29\n");
    for (condition, holds) in [
        ("filament_type[0]=~/.*LA.*/", true),
        ("filament_type[0] !~ /.*LA.*/", false),
        ("filament_type[0]=~/(PETG|PLA)/", true),
        ("filament_type[0]=~/LA/", false),
        ("filament_type[0]=~/.*PET.*/ or false", false),
        ("is_extruder_used[0] and !is_extruder_used[3]", true),
    ] {
        let source = format!("{{if {condition}}}G28{{else}}G29{{endif}}");
        assert_start(&source, if holds { "G28\n" } else { "G29\n" });
    }
    // Within a line nothing else goes with them.
    assert_start(
        "M104 S{if layer_height > 0.25}220{else}200{endif} T0\nG1{if true \
         \n} F100{endif}\nG28",
        "M104 S200 T0\nG1 F100\nG28\n",
    );
    let e = templates("G28\n{endif}", "", "").unwrap_err();
    assert!(e.contains("line 2, column 1: {endif}"), "{e}");
    let e = templates("G28\n{if true}\nG29", "", "").unwrap_err();
    assert!(e.contains("syntax error"), "{e}");
}

#[track_caller]
fn assert_refused(source: &str, words: &[&str]) {
    let e = templates(source, "", "").unwrap_err();
    for words in words {
        assert!(e.contains(words), "{source}: {e}");
    }
    assert!(e.contains("{% raw %}"), "{source}: {e}");
}

#[test]
fn what_is_not_known_is_named_and_does_not_reach_the_printer() {
    assert_refused(
        "G28\nM104 S[first_layer_nozzle_temp]",
        &["gcode.start, line 2, column 7: [first_layer_nozzle_temp]"],
    );
    assert_refused("M141 S{chamber_temperature[0]}", &["heats no chamber"]);
    assert_refused("M104 S{temperature[1]}", &["one extruder", "[1]"]);
    assert_refused("M104 S{temperature[0}", &["`]` is missing"]);
    assert_refused("G1 X{print_bed_max}", &["print_bed_max[0]"]);
    assert_refused("{if filament_type[0]=~/P.A/}\nG28", &["patterns of words"]);
    assert_refused("{if filament_type[0]=~/.*P/}\nG28", &["patterns of words"]);
    assert_refused("{if filament_type[0]=~PLA}\nG28", &["needs a /pattern/"]);
    assert_refused("{if printer_notes=~/.*X.*/}\nG28", &["no notes"]);
    assert_refused("M104 S{random(1, 5)}", &["the function random"]);
    assert_refused("{local a = 5}G1 X{a}", &["{% set name"]);
    assert_refused("M117 [{layer_zz}]", &["{layer_zz}"]);
    assert_refused("RESPOND MSG=\"[info] hi\"", &["column 14: [info]"]);
    assert_refused("SAVE VALUE={'a': 1}", &["column 12"]);
    assert_refused("M117 { [100]", &["has no }"]);
    assert_refused("{print_time}", &["gcode.end only"]);
    let nested = format!("G1 X{{{}1{}}}", "(".repeat(900), ")".repeat(900));
    assert_refused(&nested, &["nested too deeply"]);
    let e = templates("M117 {layer_z}", "", "").unwrap_err();
    assert!(e.contains("layer_z is known in gcode.layer only"), "{e}");
}

#[test]
fn text_that_is_no_placeholder_is_left_alone() {
    for plain in [
        "G1 X1 ; {any} [thing] { [\n",
        "M117 [100] [0.5, 1] ] }\n",
        "; {if you like} {endif}\nG28\n",
    ] {
        assert_start(plain, plain);
    }
    // The way out; the next command stays in a line of its own.
    assert_start(
        "RESPOND MSG=\"{% raw %}[info] {x}{% endraw %}\"\nG28",
        "RESPOND MSG=\"[info] {x}\"\nG28\n",
    );
    assert_start("M117 {% raw %}[hi]{% endraw %}\nG28", "M117 [hi]\nG28\n");
    assert_start("G1 Z5{% if true %} F9{% endif %}\nG28", "G1 Z5 F9\nG28\n");
}

/// Every name leads to names there are, or to the reason why not.
#[test]
fn all_that_is_translated_can_be_filled_in() {
    let mut seen = std::collections::BTreeSet::new();
    for name in foreign_names() {
        assert!(seen.insert(name), "{name} twice");
        for theirs in [format!("[{name}]"), format!("{{{name}[1]}}")] {
            for place in [Place::Layer, Place::End] {
                if ours(&theirs, place).is_err() {
                    continue;
                }
                let filled = match place {
                    Place::Layer => templates("", &theirs, ""),
                    _ => templates("", "", &theirs),
                };
                assert!(filled.is_ok(), "{filled:?}");
            }
        }
        if !slicerprofile::understands(name) {
            assert_refused(&format!("[{name}]"), &[name]);
        }
    }
}

/// A print does not translate placeholders. Its error says what does.
#[test]
fn placeholders_of_other_slicers_are_mistakes_in_a_print() {
    let s = settings(&[]);
    let refused = |source: &str| {
        let mut plan = WriterPlan::of(&s);
        plan.templates[0] = source;
        let error = Templates::new(&plan, &header()).unwrap_err().to_string();
        assert!(error.contains("{% raw %}"), "{source}: {error}");
        error
    };
    let e = refused("G28 ; [a] {b}\nM104 S[first_layer_nozzle_temperature]");
    assert!(
        e.starts_with("gcode.start, line 2, column 7: [first"),
        "{e}"
    );
    assert!(e.contains("`isoslice profiles import`"), "{e}");
    assert!(e.contains("{{ first_layer_nozzle_temperature }}"), "{e}");
    // What is only alike may mean another thing.
    let e = refused("M104 S{material_print_temperature_layer_0}");
    assert!(!e.contains("isoslice's own"), "{e}");
    let e = refused("; { [x]\n{if layer_num==1}\nG28{endif}");
    assert!(e.starts_with("gcode.start, line 2, column 1: {if"), "{e}");
    let e = refused("M117 {{ layer_count }}[{layer_zz}]");
    assert!(e.contains("column 24: {layer_zz}"), "{e}");
    let e = refused("M117 { [100]");
    assert!(e.contains("has no }"), "{e}");
    // A search that began anew at every sign would take minutes.
    for piece in ["[ ", "[1]", "; {a}\n"] {
        let text = piece.repeat(900_000 / piece.len());
        let pieces = pieces(&text);
        assert_eq!(foreign(&text, &pieces, Scope::All), None, "{piece}");
    }
}

#[test]
fn a_macro_that_is_given_the_temperature_waits_for_it() {
    use crate::scan::{Heating, heating};
    let source = "START_PRINT EXTRUDER_TEMP=[first_layer_temperature]";
    let ours = ours(source, Place::Start).unwrap();
    let rendered = "START_PRINT EXTRUDER_TEMP=215\n";
    let names = ["first_layer_nozzle_temperature"];
    let found = heating(&ours, rendered, "M104", "M109", &names);
    assert_eq!(found, Heating::Waits);
}

/// Templates that repeat one piece up to the greatest length are translated or
/// refused. A search that began anew at every piece would take minutes here, so
/// that a test as slow as that has found one.
#[test]
fn long_templates_are_translated_or_refused() {
    let many = |piece: &str| piece.repeat(900_000 / piece.len());
    for text in [
        format!("G28 ; {}", many("[ ")),
        format!("G28 ; {}", many("{ ")),
        format!("G28 {}", many("[1]")),
        format!("M109 S{{1{}}}", many("+1")),
        format!("; {{1{}}}", "+1".repeat(900)),
        format!("G28 ; {}", many("{if 1==1}{endif}")),
    ] {
        let _ = ours(&text, Place::Start);
    }
    // Tables in tables.
    let row = "interpolate_table(1,(1,";
    let nested =
        format!("M109 S{{{}1{}}}", row.repeat(30), "),(2,3))".repeat(30));
    let error = templates(&nested, "", "").unwrap_err();
    assert!(
        error.contains("in interpolate_table is too long"),
        "{error}"
    );
    let unknown: String =
        (0..60_000).map(|i| format!("{{{{a{i}}}}}")).collect();
    let error = templates(&format!("; {unknown}"), "", "").unwrap_err();
    assert!(error.contains("{{ a0 }}"), "{}", &error[..200]);
    let long = format!("M109 S{{1{}}}", "+1".repeat(1100));
    let error = templates(&long, "", "").unwrap_err();
    assert!(error.contains("{ has no } within 2048 bytes"), "{error}");
}
