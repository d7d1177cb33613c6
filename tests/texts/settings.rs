//! The settings table as a whole, and what its users read when they err.

use crate::common::{self, number, text};
use isoslice::settings::{Builder, Key, Settings, SettingsError, keys};
use std::collections::{BTreeMap, BTreeSet};

fn read(text: &str) -> Result<Settings, SettingsError> {
    let mut builder = Builder::new();
    builder.toml("my.toml", text)?;
    builder.finish().map(|(settings, _)| settings)
}

fn set(assignments: &[&str]) -> Result<(Settings, Vec<String>), SettingsError> {
    let mut builder = Builder::new();
    for assignment in assignments {
        builder.set(assignment)?;
    }
    builder.finish()
}

/// The message for a file that must be refused.
fn refused(text: &str) -> String {
    read(text).map_or_else(|e| e.to_string(), |_| "accepted".to_owned())
}

/// Compares `text` with the stored one of that name.
fn snapshot(name: &str, text: String) {
    insta::with_settings!({ omit_expression => true }, {
        insta::assert_snapshot!(name, text);
    });
}

/// Inputs above the messages they lead to.
fn listing(messages: impl IntoIterator<Item = (String, String)>) -> String {
    messages
        .into_iter()
        .map(|(input, message)| format!("{input}\n    {message}\n"))
        .collect()
}

/// The message for assignments that must be refused.
fn refused_set(assignments: &[&str]) -> String {
    set(assignments).map_or_else(|e| e.to_string(), |_| "accepted".to_owned())
}

/// Some allowed value that is not the default, as it is written in TOML.
fn another_value(key: &Key) -> String {
    let default = key.default();
    if let Some(range) = key.range {
        // A number that has no short decimal form, where the type allows it.
        let third = range.min + (range.max - range.min) / 3.0;
        let whole = !default.contains('.') && key.unit.is_empty();
        return if whole {
            format!("{}", third.ceil())
        } else {
            format!("{third}")
        };
    }
    let allowed = key.allowed();
    if allowed == "any text" {
        return "\"\"\"\na \\\"quoted\\\" {name} \\\\ \\u0007\tb\n\n\"\"\""
            .to_owned();
    }
    if allowed.starts_with("off, or shares") {
        return "\"12.5: 40, 100: 0.5\"".to_owned();
    }
    let other = allowed
        .split([',', ' '])
        .filter(|word| !word.is_empty() && *word != "or")
        .find(|word| *word != default.trim_matches('"'))
        .unwrap_or_default();
    match other {
        "true" | "false" => other.to_owned(),
        word => format!("\"{word}\""),
    }
}

#[test]
fn every_key_is_documented_and_named_once() {
    let mut names = BTreeSet::new();
    for key in keys() {
        assert!(names.insert(key.name), "{} twice", key.name);
        let description = key.description();
        assert!(description.ends_with('.'), "{}: {description}", key.name);
        assert!(!key.allowed().is_empty(), "{}", key.name);
        assert!(!key.section().is_empty(), "{}", key.name);
        assert!(
            key.unit.is_empty() || key.range.is_some(),
            "{} has a unit but no range",
            key.name
        );
    }
    assert!(names.contains("layer_height"));
    assert!(names.contains("speed.outer_wall"));
}

#[test]
fn every_default_is_within_its_range() {
    for key in keys() {
        let (Some(range), Ok(default)) = (key.range, key.default().parse())
        else {
            continue;
        };
        assert!(range.contains(default), "{} = {default}", key.name);
    }
    let (settings, warnings) = Builder::new().finish().unwrap();
    assert_eq!((settings, warnings.len()), (Settings::default(), 0));
}

#[test]
fn every_key_can_be_set_and_read_back() {
    for key in keys() {
        let value = another_value(key);
        let mut from_file = Builder::new();
        from_file
            .toml("my.toml", &format!("{} = {value}", key.name))
            .unwrap_or_else(|e| panic!("{e}"));
        let mut from_command_line = Builder::new();
        if !value.contains("\"\"\"") {
            from_command_line
                .set(&format!("{}={value}", key.name))
                .unwrap_or_else(|e| panic!("{e}"));
            assert_eq!(
                from_file.settings(),
                from_command_line.settings(),
                "{}",
                key.name
            );
        }
        let got = key.get(from_file.settings());
        assert_eq!(got, value, "{}", key.name);
        let changed = keys()
            .iter()
            .filter(|k| k.get(from_file.settings()) != k.default());
        assert_eq!(
            changed.map(|k| k.name).collect::<Vec<_>>(),
            [key.name],
            "setting one key must change that one only"
        );
    }
}

#[test]
fn every_number_outside_its_range_is_refused() {
    for key in keys() {
        let Some(range) = key.range else { continue };
        let low = range.min - 1.0;
        let low = if range.contains(low) {
            0.5 * range.min
        } else {
            low
        };
        for bad in [low, range.max + 1.0] {
            let message = refused_set(&[&format!("{}={bad}", key.name)]);
            assert!(message.contains("is out of range"), "{message}");
            assert!(message.contains(&key.allowed()), "{message}");
        }
        for bad in ["nan", "inf", "-inf"] {
            let message = refused_set(&[&format!("{}={bad}", key.name)]);
            assert!(message.starts_with("--set: "), "{message}");
        }
    }
}

/// Klipper refuses `M204 S0`, and 50 mm of filament at a time.
#[test]
fn klipper_refuses_nothing_that_settings_allow() {
    assert_eq!(
        refused_set(&["acceleration.outer_wall=0.00002"]),
        "--set: acceleration.outer_wall = 0.00002 is out of range; use 0 or 1 \
         to 100000 mm/s²"
    );
    for back in [
        &["retract.length=50"][..],
        &["retract.length=46", "retract.extra_prime=5"],
        &["retract.length=50", "retract.firmware=true"],
    ] {
        let klipper = [back, &["gcode.flavour=klipper"]].concat();
        let message = refused_set(&klipper);
        assert!(message.contains("max_extrude_only_distance"), "{message}");
        // No other firmware has such a limit.
        let marlin = [back, &["gcode.flavour=marlin"]].concat();
        let mut builder = Builder::new();
        marlin.iter().for_each(|set| builder.set(set).unwrap());
        assert!(builder.finish().is_ok());
    }
}

#[test]
fn printed_settings_read_back_as_the_same() {
    let defaults = Settings::default();
    assert_eq!(read(&defaults.to_toml()).ok(), Some(defaults));

    let mut all_changed = Builder::new();
    for key in keys() {
        let line = format!("{} = {}", key.name, another_value(key));
        all_changed
            .toml("", &line)
            .unwrap_or_else(|e| panic!("{e}"));
    }
    let mut again = Builder::new();
    again
        .toml("", &all_changed.settings().to_toml())
        .unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(again.settings(), all_changed.settings());
}

#[test]
fn lengths_follow_the_nozzle() {
    let lengths = |given: &[&str]| {
        let (settings, warnings) = set(given).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(warnings, [""; 0], "{given:?}");
        let all = keys().iter();
        all.filter_map(|key| Some((key.name, key.length(&settings)?)))
            .collect::<BTreeMap<_, _>>()
    };
    // These are the exact values: the G-code of defaults must not depend on how
    // they are found.
    let expected = [
        ("first_layer_height", 0.2),
        ("infill_width", 0.45),
        ("inner_wall_width", 0.45),
        ("ironing_spacing", 0.1),
        ("layer_height", 0.2),
        ("layer_height_max", 0.3),
        ("layer_height_min", 0.08),
        ("outer_wall_width", 0.45),
        ("skin_overlap", 0.6),
        ("skin_width", 0.45),
        ("slit_closing", 0.02),
        ("top_skin_width", 0.45),
    ];
    assert_eq!(lengths(&[]), BTreeMap::from(expected));
    for nozzle in [0.1, 0.25, 0.6, 0.8, 2.0] {
        let given = format!("printer.nozzle_diameter={nozzle}");
        for (name, length) in lengths(&[&given]) {
            let usual = expected.iter().find(|(n, _)| *n == name).unwrap().1;
            let off = length - usual * nozzle / 0.4;
            assert!(off.abs() < 1e-12, "{name} = {length} mm");
        }
    }
    // What is given in millimetres stays; what is a share follows.
    let wide = lengths(&[
        "printer.nozzle_diameter=0.8",
        "layer_height=0.3",
        "skin_width=100%",
        "infill_width= 70 %",
    ]);
    assert_eq!((wide["layer_height"], wide["skin_width"]), (0.3, 0.8));
    assert_eq!((wide["top_skin_width"], wide["infill_width"]), (0.8, 0.56));
    assert_eq!(wide["outer_wall_width"], 0.9);
}

#[test]
fn descriptions_say_what_auto_is() {
    let defaults = Settings::default();
    for key in keys() {
        let Some(length) = key.length(&defaults) else {
            continue;
        };
        let share =
            100.0 * length / number(&defaults, "printer.nozzle_diameter");
        let said =
            format!("auto is {}% of the nozzle's diameter", share as f32);
        let text = key.description();
        let other = text.split("auto takes ").nth(1).is_some_and(|name| {
            let name = name.split([',', '.']).next();
            let taken = keys().iter().find(|key| Some(key.name) == name);
            taken.and_then(|key| key.length(&defaults)) == Some(length)
        });
        assert!(text.contains(&said) || other, "{}: {text}", key.name);
    }
}

#[test]
fn shares_read_back_as_the_same() {
    let mut builder = Builder::new();
    builder.toml("a", "outer_wall_width = '110 %'").unwrap();
    let (settings, _) = builder.finish().unwrap();
    let text = settings.to_toml();
    assert!(text.contains("\nouter_wall_width = \"110%\"\n"));
    assert_eq!(read(&text).ok(), Some(settings));
}

#[test]
fn the_last_one_wins() {
    let mut builder = Builder::new();
    builder.toml("a", "walls = 3\nseam = 'rear'").ok();
    builder.toml("b", "walls = 4\nskirt.loops = 0").ok();
    builder.set("walls=5").ok();
    let settings = builder.settings();
    assert_eq!(text(settings, "walls"), "5");
    assert_eq!(text(settings, "skirt.loops"), "0");
    assert_eq!(text(settings, "seam"), "\"rear\"");
}

#[test]
fn values_are_read_as_their_type_asks() {
    let (s, _) = set(&[
        "infill_density=25%",
        "flow = 98 %",
        "infill_overlap=30",
        "top_layers=5",
        "bottom_layers=auto",
        "infill=grid",
        "gcode.relative_e=true",
        "gcode.start=START_PRINT A=1 ; go",
        "gcode.end=\"M84\\nM107\"",
        "retract.extra_prime=-0.1",
    ])
    .unwrap_or_else(|e| panic!("{e}"));
    for (name, value) in [
        ("infill_density", "25"),
        ("flow", "98"),
        ("infill_overlap", "30"),
        ("top_layers", "5"),
        ("bottom_layers", "\"auto\""),
        ("infill", "\"grid\""),
        ("gcode.relative_e", "true"),
        ("gcode.start", "\"START_PRINT A=1 ; go\""),
        ("gcode.end", "\"\"\"\nM84\nM107\"\"\""),
        ("retract.extra_prime", "-0.1"),
    ] {
        assert_eq!(text(&s, name), value, "{name}");
    }

    let s = read(
        "infill_density = '25%'\ntop_layers = 'auto'\n[gcode]\n\
         start = \"\"\"\nG28\nG1 Z5\n\"\"\"",
    )
    .unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(number(&s, "infill_density"), 25.0);
    assert_eq!(text(&s, "gcode.start"), "\"\"\"\nG28\nG1 Z5\n\"\"\"");
}

#[test]
fn a_file_from_windows_reads_the_same() {
    let unix = "walls = 3\n[gcode]\nstart = \"\"\"\nG28\nG1 Z5\n\"\"\"\n";
    let windows = format!("\u{feff}{}", unix.replace('\n', "\r\n"));
    assert_eq!(read(&windows).ok(), read(unix).ok());
    assert!(read(unix).is_ok());
    assert!(refused("\r\n\r\nwalls = -1").starts_with("my.toml:3: "));
}

#[test]
fn refusals_name_place_key_value_and_remedy() {
    snapshot(
        "refused_files",
        listing(
            [
                "walls = 2\n\nlayer_hieght = 0.2",
                "[sped]\nouter_wall = 30",
                "[speed]\nouterwall = 30",
                "outer_wall = 30",
                "nozzle_temperature = 200",
                "perimeter_generator = 'arachne'",
                "[nothing]",
                "speed = 40",
                "\"speed.travel\" = 40",
                "layer_height = 9",
                "layer_height = nan",
                "layer_height = '0.2'",
                "layer_height = '20 percent'",
                "layer_height = '%'",
                "layer_height = 'nan%'",
                "walls = 2.5",
                "walls = -1",
                "walls = 99999999999999999999",
                "[walls]\ncount = 2",
                "infill_density = 'much'",
                "top_layers = 'automatic'",
                "seam = 'front'",
                "[gcode]\nrelative_e = 'yes'\n",
                "[gcode]\nstart = 5",
                "layer_height = [0.2]",
                "walls = 2\nwalls = 3",
                "walls = ",
                // The error is the first one in the file, not in the alphabet.
                "walls = 'many'\naccuracy = 9",
            ]
            .map(|text| (text.to_owned(), refused(text))),
        ),
    );
    snapshot(
        "refused_assignments",
        listing(
            [
                "layer_height",
                "=3",
                "layer_height=thin",
                "layer_height=0.2mm",
                "walls=99999999999999999999",
                "infill-density=20%",
                "filament.density=heavy",
                "gcode.flavour=sailfish",
                "speed=50",
                "speed.wall=50",
                "fan=50",
                "gcode.flavor=klipper",
                "gcode.start=\"a\" b\"",
            ]
            .map(|given| (given.to_owned(), refused_set(&[given]))),
        ),
    );
}

#[test]
fn settings_that_do_not_work_together_are_refused() {
    snapshot(
        "conflicts",
        listing(
            [
                &["layer_height=0.5"][..],
                &["first_layer_height=0.41"],
                &["outer_wall_width=0.1"],
                &["infill_width=2.5"],
                &["skin_width=0.25", "layer_height=0.26"],
                &["layer_height=1%"],
                &["layer_height=110%"],
                &["skin_width=600%", "printer.nozzle_diameter=1"],
                &["skin_width=600%", "printer.nozzle_diameter=2"],
                &["outer_wall_width=-90%"],
                &["accuracy=0.1"],
                &[
                    "accuracy=0.1",
                    "outer_wall_width=0.19",
                    "layer_height=0.1",
                    "first_layer_height=0.1",
                ],
                &["retract.extra_prime=-1"],
                &[
                    "retract.extra_prime=-0.1",
                    "retract.firmware=true",
                    "gcode.flavour=klipper",
                ],
                &[
                    "retract.prime_speed=0.5",
                    "retract.firmware=true",
                    "gcode.flavour=klipper",
                ],
                &[
                    "printer.height=1",
                    "printer.nozzle_diameter=2",
                    "outer_wall_width=2",
                    "inner_wall_width=2",
                    "skin_width=2",
                    "infill_width=2",
                    "layer_height=1.1",
                ],
                &[
                    "walls=0",
                    "infill_density=0",
                    "top_layers=0",
                    "bottom_layers=0",
                ],
                &["filament.nozzle_temperature=20"],
                &["filament.first_layer_nozzle_temperature=169"],
                &["printer.max_nozzle_temperature=200"],
                &[
                    "filament.nozzle_temperature=216",
                    "printer.max_nozzle_temperature=215",
                ],
                &["filament.nozzle_temperature=500"],
                &["printer.max_bed_temperature=50"],
                &["filament.bed_temperature=220"],
            ]
            .map(|given| (given.join(" "), refused_set(given))),
        ),
    );
    assert_eq!(
        refused("walls = 2\nlayer_height = 0.5"),
        "layer_height = 0.5 mm is more than printer.nozzle_diameter = 0.4 mm: \
         the bead would not touch what is below; use at most 0.32 mm \
         (layer_height from my.toml:2)"
    );
}

#[test]
fn unwise_settings_are_warned_of() {
    let warnings = |assignments: &[&str]| {
        set(assignments).map_or_else(|e| vec![e.to_string()], |(_, w)| w)
    };
    assert!(warnings(&["layer_height=0.32"]).is_empty());
    snapshot(
        "warnings",
        listing(
            [
                &["layer_height=0.33"][..],
                &[
                    "skin_width=0.19",
                    "layer_height=0.1",
                    "first_layer_height=0.15",
                ],
                &["outer_wall_width=1.3"],
                &["sample_spacing=0.5"],
                &["flow=150"],
                &["infill_density=0.15"],
                &["speed.sparse_infill=200"],
                &["speed.first_layer=90"],
                &["cooling.min_speed=100"],
                &["cooling.full_fan_layer=1"],
                &["cooling.long_layer_time=8"],
                &["retract.min_travel=40"],
                &["retract.length=0", "retract.z_hop=0.4"],
                &["ironing=true", "top_layers=0"],
                &["contour_z=100", "contour_z_angle=25"],
                &["internal_bridges=false", "internal_bridge_flow=90"],
                &["internal_bridges=true", "walls=0"],
                &["skin_wall_overlap=10", "walls=0"],
                &["skin_pattern=bottom: unordered-lines"],
                &["layer_heights=adaptive 0.1", "layer_height=0.15"],
                &["layer_height_min=0.1"],
                &["seam_scarf=10 from 20%", "contour_z=100"],
                &["infill_mode=solid"],
                &[
                    "infill=expr: sin(x)",
                    "infill_density=30",
                    "infill_angle=10",
                ],
                &[
                    "infill=expr: sin(x)",
                    "infill_mode=solid",
                    "infill_angle=10",
                ],
                &["fuzzy.grain=0.3", "fuzzy.holes=true"],
                &["ironing_spacing=0.1", "speed.ironing=15"],
                &["support.z_gap=0.3", "support.density=20"],
                &["skirt.loops=0", "skirt.distance=4"],
            ]
            .map(|given| (given.join(" "), warnings(given).join("\n    "))),
        ),
    );
}

/// People write templates as the files of PrusaSlicer have them.
#[test]
fn templates_have_lines_without_quotes() {
    let text = |given: &str| {
        let (settings, _) = set(&[given]).unwrap_or_else(|e| panic!("{e}"));
        common::text(&settings, given.split_once('=').unwrap().0)
    };
    for key in ["gcode.start", "gcode.end", "gcode.layer"] {
        let lines = text(&format!("{key}=G28\\nG1 Z5"));
        assert!(lines.contains("G28\nG1 Z5"), "{lines}");
        assert_eq!(text(&format!("{key}=\"G28\\nG1 Z5\"")), lines);
    }
    assert_eq!(text("printer.model=a\\nb"), r#""a\\nb""#);
}

#[test]
fn a_number_with_a_unit_is_refused_in_words() {
    for given in ["nozzle_temperature=210C", "nozzle_temperature=210 °C"] {
        let said = refused_set(&[&format!("filament.{given}")]);
        assert!(said.contains("without its unit: 210"), "{said}");
    }
    let said = refused_set(&["filament.nozzle_temperature=warm"]);
    assert!(!said.contains("unit"), "{said}");
}

#[test]
fn old_names_are_understood_with_a_hint() {
    let mut builder = Builder::new();
    builder
        .toml("my.toml", "[speed]\nsmall_perimeter = 12")
        .unwrap();
    builder.set("speed.small_perimeter_length=7").unwrap();
    let (settings, warnings) = builder.finish().unwrap();
    assert_eq!(number(&settings, "speed.small_wall"), 12.0);
    assert_eq!(number(&settings, "speed.small_wall_length"), 7.0);
    assert_eq!(
        warnings,
        [
            "my.toml:2: speed.small_perimeter is now called speed.small_wall",
            "--set: speed.small_perimeter_length is now called \
             speed.small_wall_length",
        ]
    );
    assert_eq!(
        refused_set(&["speed.small_perimeter=0"]),
        "--set: speed.small_wall = 0 is out of range; use 0.1 to 2000 mm/s"
    );
}

#[test]
fn what_nobody_asked_for_is_not_warned_of() {
    // The default speeds are too much for this filament, which slows them.
    let (slow, warnings) =
        set(&["filament.max_flow=3"]).unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(warnings, Vec::<String>::new());
    let notes = slow.notes().join("\n");
    let expected = "filament.max_flow = 3 mm³/s slows speed.outer_wall from \
                    40 to 37, speed.inner_wall from 60 to 37, ";
    assert!(notes.starts_with(expected), "{notes}");
    // 0.45 × 0.2 mm with round ends.
    let area = 0.25 * 0.2 + 0.01 * std::f64::consts::PI;
    assert!((3.0 / area - 36.8).abs() < 0.1);
    assert!(Settings::default().notes().is_empty());
}

/// `isoslice settings` writes all settings, and asks for none.
#[test]
fn a_file_with_all_defaults_is_not_warned_of() {
    let warnings = |text: &str| {
        let mut builder = Builder::new();
        builder.toml("my.toml", text).unwrap();
        builder.finish().unwrap().1
    };
    let all = Settings::default().to_toml();
    assert_eq!(warnings(&all), Vec::<String>::new());
    assert!(all.contains("\nz_gap = 0.2\n"));
    let other = all.replace("\nz_gap = 0.2\n", "\nz_gap = 0.3\n");
    assert_eq!(warnings(&other).len(), 1);
}

#[test]
fn the_printed_settings_are_pleasant_to_read() {
    snapshot("settings", Settings::default().to_toml());
}

#[test]
fn errors_name_the_setting_that_takes_the_value() {
    for (given, other) in [
        ("layer_height = \"expr: 0.1 + z/100\"", "set layer_heights,"),
        ("layer_height = \"adaptive\"", "set layer_heights,"),
        ("layer_heights = 0.2", "set layer_height,"),
        ("first_layer_height = \"expr: 0.3\"", "no expression"),
        ("walls = \"expr: 3\"", "no expression"),
    ] {
        let said = refused(given);
        assert!(said.contains(given), "{said}");
        assert!(said.contains(other), "{said}");
        assert!(said.starts_with("my.toml:1:"), "{said}");
    }
    let said = refused_set(&["layer_height=expr: 0.1 + z/100"]);
    assert!(said.contains("layer_height = expr: 0.1"), "{said}");
    assert!(said.contains("set layer_heights,"), "{said}");
}

/// A plate of 0.8 mm that stands on its edge hides a hole of 0.3 mm from the
/// nodes of a coarse lattice.
#[test]
fn no_lattice_is_so_coarse_that_a_hole_is_overlooked() {
    let made = |at: f64, spacing: &str| {
        let text = format!(
            "max(max(max(abs(y) - 0.4, abs(x) - 5), abs(z - 0.3) - 0.3), \
             0.15 - hypot(x - {at}, y))"
        );
        let settings = common::settings(&[spacing, "skirt.loops=0"]);
        let model = common::formula(&text, &settings);
        let (gcode, _) = common::slice(&model, &settings, 2);
        let moves = gcode.lines().filter(|line| !line.starts_with(';'));
        moves.map(str::to_owned).collect::<Vec<_>>()
    };
    let plate = made(20.0, "sample_spacing=0.225");
    for at in [-0.9, -0.3, 0.2, 0.7] {
        let half_a_line = made(at, "sample_spacing=0.225");
        assert!(half_a_line != plate, "the hole at {at} is overlooked");
        assert_eq!(made(at, "sample_spacing=2"), half_a_line);
    }
}
