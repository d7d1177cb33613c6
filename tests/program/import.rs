//! Profiles of other slicers become profiles of isoslice.

use crate::program::isoslice;
use isoslice::settings::keys;
use slicerprofile::{Rule, Slicer, rows};
use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::fs;
use std::io::Write as _;
use std::path::Path;
use tempfile::TempDir;

/// A folder with files, in which commands run.
fn folder(files: &[(&str, &str)]) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in files {
        let path = folder.path().join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    }
    folder
}

fn output(folder: &Path, args: &[&str]) -> String {
    let done = isoslice(folder).args(args).assert().success();
    String::from_utf8(done.get_output().stdout.clone()).unwrap()
}

fn refused(folder: &Path, args: &[&str]) -> String {
    let done = isoslice(folder).args(args).assert().failure();
    String::from_utf8(done.get_output().stderr.clone()).unwrap()
}

/// The line of a profile that sets a leaf.
#[track_caller]
fn assert_has(text: &str, lines: &[&str]) {
    for line in lines {
        let found = text.lines().any(|l| {
            let l = l.split(" # ").next().unwrap_or("");
            l == *line
        });
        assert!(found, "{line} is missing in\n{text}");
    }
}

const CONFIG: &str = r#"# a whole configuration
bed_shape = 0x0,250x0,250x210,0x210
max_print_height = 220
nozzle_diameter = 0.4
gcode_flavor = marlin2
printer_model = MK4
printer_notes = A note.\nHAS_PROBE
start_gcode = M862.3 P "[printer_model]"\nG28\n{if printer_notes=~/.*HAS_PROBE.*/}G29{endif}\nM109 S[first_layer_temperature]\nG1 Z{wipe_height+1}
wipe_height = 3
end_gcode = M104 S0\nG1 X0
before_layer_gcode = ;BEFORE_LAYER_CHANGE\nG92 E0.0
machine_max_acceleration_extruding = 4000,2500
machine_max_jerk_x = 8,8
machine_max_jerk_y = 9,9
retract_length = 0.7
retract_speed = 35
deretract_speed = 0
thumbnails = 16x16/QOI, 300x200/PNG
filament_type = PETG
temperature = 240
first_layer_temperature = 230
bed_temperature = 90
first_layer_bed_temperature = 85
extrusion_multiplier = 0.98
filament_max_volumetric_speed = 8
min_fan_speed = 30
max_fan_speed = 50
fan_always_on = 1
cooling = 1
slowdown_below_layer_time = 12
fan_below_layer_time = 20
start_filament_gcode = "M900 K0.05 ; advance"
filament_shrinkage_compensation_xy = 0.3%
layer_height = 0.2
extrusion_width = 0.45
external_perimeter_extrusion_width = 0
perimeters = 3
top_solid_layers = 5
top_solid_min_thickness = 0.7
bottom_solid_layers = 2
bottom_solid_min_thickness = 0.5
fill_density = 15%
fill_pattern = 3dhoneycomb
perimeter_speed = 80
external_perimeter_speed = 50%
infill_speed = 100
solid_infill_speed = 80%
top_solid_infill_speed = 50%
support_material = 1
support_material_buildplate_only = 1
support_material_threshold = 40
infill_overlap = 0.09
infill_extrusion_width = 0.45
threads = 4
a_key_of_tomorrow = 7
"#;

#[test]
fn a_configuration_of_prusaslicer_becomes_three_profiles() {
    let dir = folder(&[("my config.ini", CONFIG)]);
    let text = output(
        dir.path(),
        &["profiles", "import", "my config.ini", "--all"],
    );
    assert!(text.contains("threads = 4: "), "{text}");
    assert!(
        text.contains("a_key_of_tomorrow = 7: isoslice does not"),
        "{text}"
    );
    assert!(text.contains("0.3%: scale the model"), "{text}");
    let read = |kind: &str| {
        let path = format!("profiles/{kind}/my-config.toml");
        fs::read_to_string(dir.path().join(path)).unwrap()
    };
    let printer = read("printers");
    assert!(printer.starts_with("# Imported by isoslice"), "{printer}");
    assert_has(
        &printer,
        &[
            "bed_x = 250",
            "bed_y = 210",
            "height = 220",
            "model = \"MK4\"",
            "flavour = \"prusa\"",
            "acceleration = 4000",
            "square_corner_velocity = 8",
            "prime_speed = 35",
            "thumbnails = \"16x16/QOI, 300x200\"",
        ],
    );
    assert!(!printer.contains("G92 E0"), "{printer}");
    let filament = read("filaments");
    assert_has(
        &filament,
        &[
            "material = \"PETG\"",
            "flow = 98",
            "pressure_advance = 0.05",
            "fan_speed = 30",
            "short_layer_fan_speed = 50",
            "min_layer_time = 12",
        ],
    );
    let preset = read("presets");
    assert_has(
        &preset,
        &[
            "outer_wall = 40",
            "internal_skin = 80",
            "top_skin = 40",
            "outer_wall_width = 0.45",
            "top_layers = 5",
            "bottom_layers = \"0.5 mm\"",
            "infill = \"cubic\"",
            "infill_overlap = 20",
            "supports = \"plate\"",
            "angle = 50",
        ],
    );
    // The imported profile works at once, and the conditions in its start are
    // decided.
    let options = ["my-config"; 3];
    let gcode = output(
        dir.path(),
        &[
            "slice",
            "-e",
            "sqrt(x^2+y^2+z^2) - 3",
            "-o",
            "-",
            "--printer",
            options[0],
            "--filament",
            options[1],
            "--preset",
            options[2],
        ],
    );
    for line in ["M862.3 P \"MK4\"", "G29", "M109 S230", "G1 Z4", "G1 X0"] {
        assert!(gcode.lines().any(|l| l == line), "{line}");
    }
    // Nothing of the user's is overwritten unasked.
    let again = ["profiles", "import", "my config.ini"];
    let error = refused(dir.path(), &again);
    assert!(error.contains("--as NAME"), "{error}");
    output(
        dir.path(),
        &["profiles", "import", "my config.ini", "--force"],
    );
}

#[test]
fn the_end_of_gcode_is_a_configuration() {
    let tail: String =
        CONFIG.lines().skip(1).map(|l| format!("; {l}\n")).collect();
    let gcode = format!("G28\nG1 X1 E1\n{tail}");
    let dir = folder(&[("part.gcode", &gcode)]);
    output(
        dir.path(),
        &["profiles", "import", "part.gcode", "-o", "all.toml"],
    );
    let text = fs::read_to_string(dir.path().join("all.toml")).unwrap();
    assert_has(&text, &["walls = 3", "bed_x = 250", "flow = 98"]);
    output(
        dir.path(),
        &[
            "info",
            "-e",
            "sqrt(x^2+y^2+z^2) - 3",
            "--printer",
            "./all.toml",
        ],
    );
    let dir = folder(&[("part.gcode", "G28\n; a = b\n")]);
    let error = refused(dir.path(), &["profiles", "import", "part.gcode"]);
    assert!(error.contains("no configuration"), "{error}");
}

const BUNDLE: &str = "[vendor]\nname = Us\n\
[print:*common*]\nperimeters = 2\nfill_density = 10%\nlayer_height = 0.3\n\
[print:*fine*]\nlayer_height = 0.1\n\
[print:0.10 mm]\ninherits = *common*; *fine*\nperimeters = 4\n\
[filament:Blue]\ntemperature = 200\n\
[printer:One]\nbed_shape = 0x0,180x0,180x180,0x180\nnozzle_diameter = 0.4\n\
[printer:Delta]\nbed_shape = -90x-90,90x-90,90x90,-90x90\nnozzle_diameter = 0.4\n";

#[test]
fn bundles_are_listed_and_chosen_from() {
    let dir = folder(&[("us.ini", BUNDLE)]);
    let import = |more: &[&str]| {
        let mut args = vec!["profiles", "import", "us.ini"];
        args.extend(more);
        args.into_iter().map(ToOwned::to_owned).collect::<Vec<_>>()
    };
    let run = |more: &[&str]| {
        let args = import(more);
        output(
            dir.path(),
            &args.iter().map(String::as_str).collect::<Vec<_>>(),
        )
    };
    let fails = |more: &[&str]| {
        let args = import(more);
        refused(
            dir.path(),
            &args.iter().map(String::as_str).collect::<Vec<_>>(),
        )
    };
    let listed = run(&["--list"]);
    assert_eq!(
        listed,
        "printer:Delta\nprinter:One\nfilament:Blue\nprint:0.10 mm\n"
    );
    assert!(fails(&[]).contains("2 printers, 1 filaments"));
    assert!(fails(&["--name", "on"]).contains("there are \"One\""));
    let two = fails(&["--name", "One", "--name", "Delta"]);
    assert!(two.contains("two names of the kind printer"), "{two}");
    let text = run(&["--name", "0.10 mm", "-o", "-"]);
    assert_has(
        &text,
        &["layer_height = 0.1", "walls = 4", "infill_density = 10"],
    );
    let delta = run(&["--name", "Delta", "-o", "delta.toml"]);
    assert!(delta.contains("not at its front left corner"), "{delta}");
}

#[test]
fn profiles_of_orcaslicer_inherit_from_the_files_beside_them() {
    let dir = folder(&[
        (
            "sys/machine/base.json",
            r#"{"type": "machine", "name": "base", "gcode_flavor": "klipper",
                "printable_area": ["0x0", "220x0", "220x220", "0x220"],
                "printable_height": "250", "retraction_length": ["0.8"],
                "machine_max_speed_x": ["500", "200"]}"#,
        ),
        (
            "sys/machine/K9 0.4.json",
            r#"{"type": "machine", "name": "K9 0.4", "inherits": "base",
                "nozzle_diameter": ["0.4"], "retraction_length": ["0.5"],
                "machine_start_gcode":
                 "START_PRINT BED=[bed_temperature_initial_layer_single]\nM104 S{nozzle_temperature_initial_layer[0]}",
                "layer_change_gcode": ";LAYER\nTAKE_FRAME"}"#,
        ),
        (
            "user/process/mine.json",
            r#"{"name": "mine", "inherits": "0.20 @K9", "wall_loops": "5"}"#,
        ),
        (
            "sys/process/0.20 @K9.json",
            r#"{"type": "process", "name": "0.20 @K9", "layer_height": "0.2",
                "outer_wall_speed": "200", "bridge_acceleration": "50%",
                "default_acceleration": "12000", "line_width": "105%",
                "seam_gap": "10%", "outer_wall_acceleration": "5000"}"#,
        ),
        (
            "PLA.json",
            r#"{"type": "filament", "name": "PLA", "hot_plate_temp": ["0"],
                "textured_plate_temp": ["65"],
                "textured_plate_temp_initial_layer": ["70"],
                "nozzle_temperature": ["220"],
                "filament_start_gcode": ["M142 P1"]}"#,
        ),
        ("round.json", r#"{"name": "round", "inherits": "round"}"#),
    ]);
    let machine = ["profiles", "import", "sys/machine/K9 0.4.json"];
    output(dir.path(), &machine);
    let path = dir.path().join("profiles/printers/k9-0.4.toml");
    let text = fs::read_to_string(path).unwrap();
    assert_has(
        &text,
        &[
            "bed_x = 220",
            "length = 0.5",
            "max_speed = 500",
            "flavour = \"klipper\"",
            "layer = \"TAKE_FRAME\"",
        ],
    );
    let import = ["profiles", "import", "user/process/mine.json"];
    let error = refused(dir.path(), &import);
    assert!(error.contains("--beside"), "{error}");
    let mut import = import.to_vec();
    import.extend(["--beside", "sys", "-o", "-"]);
    let text = output(dir.path(), &import);
    assert_has(
        &text,
        &["walls = 5", "bridge = 2500", "outer_wall_width = \"105%\""],
    );
    let text = output(dir.path(), &["profiles", "import", "PLA.json"]);
    assert!(text.contains("M142 P1: isoslice has one start"), "{text}");
    let path = dir.path().join("profiles/filaments/pla.toml");
    let text = fs::read_to_string(path).unwrap();
    assert_has(
        &text,
        &["bed_temperature = 65", "first_layer_bed_temperature = 70"],
    );
    let error = refused(dir.path(), &["profiles", "import", "round.json"]);
    assert!(error.contains("circle"), "{error}");
}

#[test]
fn rafts_ears_shields_and_steps_are_settings_that_isoslice_takes() {
    let dir = folder(&[
        (
            "raft.ini",
            "perimeters = 2\nraft_layers = 3\nraft_contact_distance = 0.1\n\
             raft_expansion = 2\nenable_dynamic_overhang_speeds = 1\n\
             overhang_speed_0 = 15\noverhang_speed_1 = 20\n\
             overhang_speed_2 = 60%\noverhang_speed_3 = 0\n\
             draft_shield = enabled\nskirt_distance = 4\n",
        ),
        (
            "ears.json",
            r#"{"name": "ears", "type": "process", "inherits": "base",
                "brim_type": "brim_ears", "overhang_reverse": "1",
                "support_interface_pattern": "concentric",
                "max_bridge_length": "12"}"#,
        ),
        (
            "deep/base.json",
            r#"{"name": "base", "type": "process", "brim_width": "6",
                "max_bridge_length": "100000",
                "brim_ears_max_angle": "120", "seam_slope_type": "all",
                "seam_slope_min_length": "10",
                "seam_slope_start_height": "20%"}"#,
        ),
    ]);
    for (file, lines) in [
        (
            "raft.ini",
            &[
                "layers = 3",
                "gap = 0.1",
                "expansion = 2",
                "overhang = \"25: 100%, 50: 60%, 75: 20, 100: 15\"",
                "draft_shield = \"full\"",
                "distance = 4",
            ][..],
        ),
        (
            "ears.json",
            &[
                "place = \"ears\"",
                "width = 6",
                "ear_angle = 120",
                "bridge_max = 12",
                "overhang_reverse = true",
                "interface_pattern = \"concentric\"",
                "seam_scarf = \"10 mm from 20%\"",
            ],
        ),
        ("deep/base.json", &["bridge_max = 1000"]),
    ] {
        let import = ["profiles", "import", file, "-o", "-"];
        assert_has(&output(dir.path(), &import), lines);
    }
}

#[test]
fn a_template_that_is_not_understood_is_kept_as_a_comment() {
    let config = "bed_shape = 0x0,200x0,200x200,0x200\n\
        start_gcode = G28\\nG1 X{random(1,5)}\nend_gcode = M84\n";
    let dir = folder(&[("p.ini", config)]);
    let text = output(dir.path(), &["profiles", "import", "p.ini"]);
    assert!(text.contains("as a comment only"), "{text}");
    assert!(text.contains("the function random"), "{text}");
    let path = dir.path().join("profiles/printers/p.toml");
    let text = fs::read_to_string(path).unwrap();
    assert!(text.contains("#   G1 X{random(1,5)}"), "{text}");
    assert_has(&text, &["end = \"M84\""]);
    output(
        dir.path(),
        &["info", "-e", "sqrt(x^2+y^2+z^2) - 3", "--printer", "p"],
    );
}

/// Another slicer's start in a settings file of isoslice's own: a print refuses
/// it and says how, and the import translates it.
#[test]
fn a_start_of_another_slicer_is_translated_once() {
    let theirs = "walls = 3\n[gcode]\nstart = '''\nG28\n\
                  M109 S[first_layer_temperature]\n\
                  {if layer_height > 0.15}G29{else}G4 P1{endif}\n'''\n";
    let dir = folder(&[("mine.toml", theirs)]);
    let part = ["slice", "-e", "max(abs(x), abs(y), abs(z)) - 3", "-o", "-"];
    let slice = |of, file| [&part[..], &[of, file]].concat();
    let said = refused(dir.path(), &slice("--config", "mine.toml"));
    assert!(said.contains("gcode.start, line 2, column 7"), "{said}");
    assert!(said.contains("isoslice profiles import"), "{said}");
    let import = ["profiles", "import", "mine.toml", "-o", "ours.toml"];
    output(dir.path(), &import);
    let ours = fs::read_to_string(dir.path().join("ours.toml")).unwrap();
    let lines = [
        "walls = 3",
        "M109 S{{ first_layer_nozzle_temperature }}",
        "{%+ if (layer_height > 0.15) +%}G29{%+ else +%}G4 P1{%+ endif +%}",
    ];
    assert_has(&ours, &lines);
    let gcode = output(dir.path(), &slice("--preset", "ours.toml"));
    assert_has(&gcode, &["G28", "M109 S215", "G29"]);
}

/// What an import cannot take over from a settings file is told, and so is what is
/// wrong with the file.
#[test]
fn settings_files_lose_nothing_without_a_word() {
    let given = "inherits = \"mine\"\nwalls = [3]\nskin_width = 0.5\n";
    let long = format!("walls = 3 # {}", "x".repeat(2 << 20));
    let dir = folder(&[
        ("given.toml", given),
        ("wrong.toml", "walls = 3\nskin_width = \n"),
        ("long.toml", &long),
    ]);
    let import = |file| ["profiles", "import", file, "-o", "new.toml"];
    let has = |said: &str, parts: &[&str]| {
        for part in parts {
            assert!(said.contains(part), "{part} is missing in\n{said}");
        }
    };
    let said = output(dir.path(), &import("given.toml"));
    has(
        &said,
        &["inherits = \"mine\": write it into the new profile"],
    );
    has(&said, &["walls = [3]: write 0 to 1000"]);
    let said = refused(dir.path(), &import("wrong.toml"));
    has(&said, &["wrong.toml:2", "`skin_width =`"]);
    let said = refused(dir.path(), &import("long.toml"));
    has(&said, &["cannot read long.toml", "1 MB"]);
    let said = refused(dir.path(), &import("none.toml"));
    has(&said, &["cannot read none.toml", "check its name"]);
}

#[test]
fn a_template_that_grows_without_an_end_is_left_out() {
    let start = "[wipe_height]".repeat(20_000);
    let long = "3".repeat(1000);
    let config = format!(
        "bed_shape = 0x0,200x0,200x200,0x200\nwipe_height = {long}\n\
         start_gcode = {start}\n"
    );
    let dir = folder(&[("p.ini", &config)]);
    let text = output(dir.path(), &["profiles", "import", "p.ini"]);
    assert!(text.contains("longer than 512 kB"), "{text}");
    let path = dir.path().join("profiles/printers/p.toml");
    let text = fs::read_to_string(path).unwrap();
    assert!(text.contains("#   [wipe_height][wipe_height]"));
    assert_has(&text, &["bed_x = 200"]);
}

/// The settings that differ from the defaults are in the file's tail, so that
/// it can be sliced once more years later.
#[test]
fn a_file_of_isoslice_s_own_is_read_back_whole() {
    const START: &str = "G28\n; say \"hello\"\nM117 {{ model_name }}\n";
    let config = format!(
        "walls = 4\nlayer_height = 0.25\ninfill_density = 'expr: 10 + z'\n\
         [speed]\novershoot = 1\n[gcode]\nstart = '''\n{START}'''\n"
    );
    let config = config.replace("overshoot = 1", "outer_wall = 33.5");
    let dir = folder(&[("a.toml", &config)]);
    let part = ["slice", "-e", "max(abs(x), abs(y), abs(z)) - 3", "-q"];
    let slice = |more: &[&str], to: &str| {
        output(dir.path(), &[&part[..], more, &["-o", to]].concat());
        fs::read_to_string(dir.path().join(to)).unwrap()
    };
    let before = slice(
        &[
            "--printer",
            "prusa-mk4s",
            "--filament",
            "petg",
            "--config",
            "a.toml",
        ],
        "a.gcode",
    );
    assert!(before.contains("\n; bed_shape = 0x0,250x0,250x210,0x210\n"));
    let import = ["profiles", "import", "a.gcode"];
    let said =
        output(dir.path(), &[&import[..], &["-o", "same.toml"]].concat());
    assert!(said.contains("settings that differ"), "{said}");
    assert_eq!(slice(&["--printer", "same.toml"], "b.gcode"), before);
    // As three profiles, too.
    let more = ["--as", "own", "--profiles", "mine"];
    output(dir.path(), &[&import[..], &more].concat());
    let own = ["--printer", "own", "--filament", "own", "--preset", "own"];
    let own = [&own[..], &["--profiles", "mine"]].concat();
    assert_eq!(slice(&own, "c.gcode"), before);
    // The settings of earlier versions are not lost without a word.
    let now = "; isoslice walls = 4\n";
    let old = "; isoslice top_thickness = 1.6\n\
               ; isoslice speed.small_perimeter = 9\n";
    let was = before.replace(now, old);
    assert_ne!(was, before);
    fs::write(dir.path().join("was.gcode"), was).unwrap();
    let import = ["profiles", "import", "was.gcode", "-o", "was.toml"];
    let said = output(dir.path(), &import);
    let told = "top_thickness = 1.6: write the thickness";
    assert!(said.contains(told), "{said}");
    let was = fs::read_to_string(dir.path().join("was.toml")).unwrap();
    assert!(was.contains("small_wall = 9"), "{was}");
    // A file without these lines says that it has few.
    let tail = "; isoslice settings";
    let (few, _) = before.split_once(tail).unwrap();
    fs::write(dir.path().join("few.gcode"), few).unwrap();
    let import = ["profiles", "import", "few.gcode", "-o", "few.toml"];
    let said = output(dir.path(), &import);
    assert!(said.contains("left only a few of its settings"), "{said}");
}

#[test]
fn keys_that_make_no_setting_are_named() {
    let dir = folder(&[
        ("known.ini", "layer_height = -inf\n"),
        ("unknown.ini", "no_such_key = 1\n"),
    ]);
    let why = |file| {
        let import = ["profiles", "import", file, "-o", "-"];
        refused(dir.path(), &import)
    };
    let known = why("known.ini");
    assert!(known.contains("(layer_height = -inf: "), "{known}");
    let unknown = why("unknown.ini");
    assert!(unknown.contains("knows none of its keys"), "{unknown}");
}

#[test]
fn keys_are_lost_once_and_only_if_no_setting_is_made_of_them() {
    let config = "retract_speed = 30\nderetract_speed = 1e9\n\
        solid_infill_speed = 1e9\nbed_shape = 0x0,200x0,200x200,0x200\n";
    let dir = folder(&[("p.ini", config)]);
    let import = ["profiles", "import", "p.ini", "-o", "-"];
    let done = isoslice(&dir).args(import).assert().success();
    let said = String::from_utf8(done.get_output().stderr.clone()).unwrap();
    let text = String::from_utf8(done.get_output().stdout.clone()).unwrap();
    assert_has(&text, &["speed = 30"]);
    assert!(
        text.contains("# 3 keys became 3 settings, 0 are not needed, 1 has no"),
        "{text}"
    );
    // Two settings are made of this key.
    assert_eq!(said.matches("solid_infill_speed: ").count(), 1, "{said}");
    // Remarks are there although the profile goes to standard output.
    assert!(said.contains("retract.prime_speed was left out"), "{said}");
}

#[test]
fn of_several_profiles_all_are_written_or_none() {
    let dir = folder(&[("my config.ini", CONFIG), ("profiles/presets", "")]);
    refused(dir.path(), &["profiles", "import", "my config.ini"]);
    for kind in ["printers", "filaments"] {
        let path = dir.path().join("profiles").join(kind);
        let files = fs::read_dir(path).into_iter().flatten().count();
        assert_eq!(files, 0, "{kind}");
    }
}

/// A `.curaprofile` with one file of that text.
fn zipped(path: &Path, text: &[u8]) {
    entry(path, "fine", text);
}

/// An archive with one entry.
fn entry(path: &Path, name: &str, text: &[u8]) {
    let mut zip = zip::ZipWriter::new(fs::File::create(path).unwrap());
    let options = zip::write::SimpleFileOptions::default()
        .compression_method(zip::CompressionMethod::Deflated);
    zip.start_file(name, options).unwrap();
    zip.write_all(text).unwrap();
    zip.finish().unwrap();
}

#[test]
fn projects_and_what_the_head_needs_are_taken_over() {
    let dir = folder(&[(
        "one.ini",
        "bed_shape = 0x0,200x0,200x200,0x200\n\
         extruder_clearance_radius = 45\nextruder_clearance_height = 13\n\
         complete_objects = 1\nperimeters = 3\n",
    )]);
    let project = r#"{"printer_model": "Bambu Lab A1", "gcode_flavor": "marlin",
        "printable_area": ["0x0", "256x0", "256x256", "0x256"],
        "extruder_clearance_radius": "57", "extruder_clearance_max_radius": "73",
        "extruder_clearance_height_to_rod": "25", "wall_loops": "4",
        "print_sequence": "by object"}"#;
    let settings = "Metadata/project_settings.config";
    entry(&dir.path().join("p.3mf"), settings, project.as_bytes());
    let imported = |file: &str| {
        let args = ["profiles", "import", file, "-o", "same.toml", "--force"];
        output(dir.path(), &args);
        fs::read_to_string(dir.path().join("same.toml")).unwrap()
    };
    let bambu = imported("p.3mf");
    for line in [
        "flavour = \"bambu\"",
        "model = \"Bambu Lab A1\"",
        "head_clearance_radius = 73",
        "gantry_height = 25",
        "sequence = \"one-by-one\"",
        "walls = 4",
        "bed_x = 256",
    ] {
        assert!(bambu.contains(line), "{line}: {bambu}");
    }
    // PrusaSlicer's projects have what its G-code ends with.
    let text = "; perimeters = 5\n; layer_height = 0.25\n; fill_density = 12%\n\
                ; bed_shape = 0x0,200x0,200x200,0x200\n; temperature = 215\n\
                ; first_layer_temperature = 220\n; brim_width = 0\n; skirts = 1\n\
                ; top_solid_layers = 4\n; bottom_solid_layers = 3\n";
    entry(
        &dir.path().join("q.3mf"),
        "Metadata/Slic3r_PE.config",
        text.as_bytes(),
    );
    let project = imported("q.3mf");
    assert!(project.contains("walls = 5"), "{project}");
    let prusa = imported("one.ini");
    for line in [
        "head_clearance_radius = 45",
        "gantry_height = 13",
        "sequence = \"one-by-one\"",
    ] {
        assert!(prusa.contains(line), "{line}: {prusa}");
    }
}

#[test]
fn profiles_and_printers_of_cura_are_read() {
    let dir = folder(&[
        (
            "one.def.json",
            r#"{"name": "One", "inherits": "base_one", "overrides":
                {"machine_width": {"default_value": 235},
                 "machine_start_gcode":
                    {"default_value": "G28\nM109 S{material_print_temperature_layer_0}"}}}"#,
        ),
        (
            "base_one.def.json",
            r#"{"inherits": "fdmprinter", "overrides":
                {"machine_depth": {"default_value": 230},
                 "speed_wall_0": {"value": "speed_print / 2"},
                 "machine_gcode_flavor":
                    {"default_value": "RepRap (Marlin/Sprinter)"}}}"#,
        ),
    ]);
    zipped(
        &dir.path().join("fine.curaprofile"),
        b"[general]\nversion = 4\n[values]\nlayer_height = 0.12\n\
          infill_pattern = gyroid\nspeed_print = 60\nspeed_wall_0 = =speed_print/2\n\
          adhesion_type = brim\nbrim_width = 8\nbrim_line_count = 30\n",
    );
    let printer = ["profiles", "import", "one.def.json", "-o", "-"];
    let text = output(dir.path(), &printer);
    assert_has(
        &text,
        &["bed_x = 235", "bed_y = 230", "flavour = \"marlin\""],
    );
    let quality = ["profiles", "import", "fine.curaprofile"];
    output(dir.path(), &quality);
    let path = dir.path().join("profiles/presets/fine.toml");
    let text = fs::read_to_string(path).unwrap();
    assert_has(
        &text,
        &[
            "layer_height = 0.12",
            "infill = \"gyroid\"",
            "sparse_infill = 60",
            "outer_wall = 30",
            // The number of lines counts, each of 0.4 mm.
            "width = 12",
        ],
    );
}

#[test]
fn hostile_files_end_in_errors() {
    let dir = folder(&[
        ("deep.json", &"[".repeat(100_000)),
        (
            "circle.ini",
            "[print:a]\ninherits = b\n[print:b]\ninherits = a\n",
        ),
        ("text.ini", "What a day.\nIt rains.\na = b\n"),
        ("bad.def.json", "{\"inherits\": \"../../etc\"}"),
    ]);
    let big = fs::File::create(dir.path().join("big.ini")).unwrap();
    big.set_len(100 << 20).unwrap();
    let big = fs::File::create(dir.path().join("big.gcode")).unwrap();
    big.set_len(500 << 20).unwrap();
    // 100 MB of zeros in 100 kB.
    zipped(&dir.path().join("bomb.curaprofile"), &vec![0; 100 << 20]);
    for name in ["no.curaprofile", "no.3mf"] {
        fs::write(dir.path().join(name), b"PK\x03\x04 nothing").unwrap();
    }
    let settings = "Metadata/project_settings.config";
    entry(
        &dir.path().join("bomb.3mf"),
        settings,
        &vec![b'{'; 100 << 20],
    );
    entry(
        &dir.path().join("models.3mf"),
        "3D/3dmodel.model",
        b"<model/>",
    );
    for (file, words) in [
        ("deep.json", "no profile that isoslice knows"),
        ("circle.ini", "inherits from itself"),
        ("text.ini", "no profile that isoslice knows"),
        ("bad.def.json", "too far away"),
        ("big.ini", "larger than 16 MB"),
        ("big.gcode", "no configuration"),
        ("bomb.curaprofile", "larger than 1 MB unpacked"),
        ("no.curaprofile", "its archive"),
        ("missing.ini", "cannot read"),
        ("bomb.3mf", "larger than 4 MB unpacked"),
        ("models.3mf", "no configuration in it"),
        ("no.3mf", "its archive"),
        ("part.bgcode", "no profiles from such files"),
    ] {
        let mut args = vec!["profiles", "import", file];
        if file == "circle.ini" {
            args.extend(["--name", "a"]);
        }
        let started = std::time::Instant::now();
        let error = refused(dir.path(), &args);
        assert!(error.contains(words), "{file}: {error}");
        assert!(started.elapsed().as_secs() < 10, "{file}");
    }
}

/// Every setting that the table names is one of isoslice's.
#[test]
fn the_table_names_settings_that_there_are() {
    let known: BTreeSet<&str> = keys().iter().map(|k| k.name).collect();
    for row in rows() {
        let named: &[&str] = match &row.rule {
            Rule::To(name, _) => &[name],
            Rule::Made { settings, .. } => settings,
            Rule::Ignored(_) | Rule::Lost(..) => &[],
        };
        for name in named {
            assert!(known.contains(name), "{name} of {:?}", row.keys);
        }
    }
}

/// The tables of the guide, as the program's table says.
fn tables() -> String {
    let mut out = String::new();
    let of = |slicers: &[Slicer]| {
        let names = slicers.iter().map(|s| s.name());
        names.collect::<Vec<_>>().join(", ")
    };
    let code = |keys: &[&str]| {
        let keys = keys.iter().map(|key| format!("`{key}`"));
        keys.collect::<Vec<_>>().join(", ")
    };
    out.push_str("### Keys that become settings\n\n");
    out.push_str("| of | keys | settings | how |\n|---|---|---|---|\n");
    for row in rows() {
        let (settings, how) = match &row.rule {
            Rule::To(name, how) => (code(&[name]), how.says()),
            Rule::Made { settings, how, .. } => {
                (code(settings), (*how).to_owned())
            }
            _ => continue,
        };
        let keys = code(row.keys);
        writeln!(out, "| {} | {keys} | {settings} | {how} |", of(row.of))
            .unwrap();
    }
    out.push_str("\n### Keys without a counterpart\n\n");
    out.push_str(
        "| of | keys | no matter if | otherwise |\n|---|---|---|---|\n",
    );
    for row in rows() {
        if let Rule::Lost(neutral, why) = &row.rule {
            let neutral: Vec<&str> =
                neutral.iter().copied().filter(|n| !n.is_empty()).collect();
            let (keys, neutral) = (code(row.keys), code(&neutral));
            writeln!(out, "| {} | {keys} | {neutral} | {why} |", of(row.of))
                .unwrap();
        }
    }
    out.push_str("\n### Keys that are not needed\n\n");
    out.push_str("| of | keys | why |\n|---|---|---|\n");
    for row in rows() {
        if let Rule::Ignored(why) = &row.rule {
            let keys = code(row.keys);
            writeln!(out, "| {} | {keys} | {why} |", of(row.of)).unwrap();
        }
    }
    out
}

/// `ISOSLICE_UPDATE_DOCS=1 cargo test --release --test program import::` writes
/// the page anew.
#[test]
fn the_guide_has_the_table() {
    const MARK: &str =
        "<!-- The tables below are made by tests/program/import.rs. -->\n\n";
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/importing.md");
    let page = fs::read_to_string(&path).unwrap();
    let (head, found) = page.split_once(MARK).unwrap();
    let expected = tables();
    if std::env::var_os("ISOSLICE_UPDATE_DOCS").is_some() {
        fs::write(&path, format!("{head}{MARK}{expected}")).unwrap();
    } else {
        let hint = "run with ISOSLICE_UPDATE_DOCS=1";
        assert!(found == expected, "docs/importing.md is old: {hint}");
    }
}
