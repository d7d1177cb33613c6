//! The command line as a user meets it: the real program is run.

use crate::program::isoslice;
use assert_cmd::Command;
use predicates::prelude::*;
use predicates::str::{contains, is_empty, starts_with};
use std::f64::consts::PI;
use std::fs;
use std::path::Path;
use tempfile::TempDir;

/// A ball small enough to slice in no time.
const BALL: &str = "sqrt(x^2 + y^2 + z^2) - 3";

/// What there is to say of it: it stands on a dot.
const SMALL_FOOT: &str = "warning: the part stands on 1.9 mm²";

fn folder() -> TempDir {
    tempfile::tempdir().unwrap_or_else(|e| panic!("{e}"))
}

fn write(folder: &TempDir, name: &str, text: &str) {
    fs::write(folder.path().join(name), text).unwrap_or_else(|e| panic!("{e}"));
}

/// Names in a folder, hidden ones included.
fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<_> = fs::read_dir(folder)
        .into_iter()
        .flatten()
        .flatten()
        .map(|entry| entry.file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    names
}

fn stdout(command: &mut Command) -> String {
    let output = command.assert().success().get_output().stdout.clone();
    String::from_utf8_lossy(&output).into_owned()
}

#[test]
fn help_reads_well() {
    let folder = folder();
    for (name, args) in [
        ("help", &["--help"][..]),
        ("help_slice", &["slice", "--help"]),
        ("help_split", &["split", "--help"]),
        ("help_join", &["join", "--help"]),
        ("help_preview", &["preview", "--help"]),
        ("help_info", &["info", "--help"]),
        ("help_render", &["render", "--help"]),
        ("help_export", &["export", "--help"]),
        ("help_settings", &["settings", "--help"]),
        ("help_profiles", &["profiles", "--help"]),
        ("help_new", &["new", "--help"]),
        ("help_watch", &["watch", "--help"]),
        ("help_send", &["send", "--help"]),
        ("help_printers", &["printers", "--help"]),
        ("help_printers_add", &["printers", "add", "--help"]),
    ] {
        let help = stdout(isoslice(&folder).args(args));
        insta::with_settings!({ omit_expression => true }, {
            // The program's file name differs between systems.
            insta::assert_snapshot!(
                name,
                help.replace("isoslice.exe", "isoslice")
            );
        });
    }
}

#[test]
fn without_a_command_the_help_is_shown_as_usage_error() {
    isoslice(&folder())
        .assert()
        .code(2)
        .stderr(contains("Usage: isoslice"));
}

#[test]
fn slicing_a_formula_writes_beside_the_caller_and_sums_up() {
    let folder = folder();
    isoslice(&folder)
        .args(["slice", "-e", BALL])
        .assert()
        .success()
        .stdout(starts_with("formula.gcode\n"))
        .stdout(contains("mm\n  layers "))
        .stdout(contains("\n  print time  ").and(contains("s\n")))
        .stdout(contains("\n  filament    ").and(contains(" g, ")))
        .stdout(contains(" at 25 per kg\n"))
        .stdout(contains("\n  took        "))
        .stderr(contains(SMALL_FOOT));
    assert_eq!(names(folder.path()), ["formula.gcode"]);
}

#[test]
fn slicing_a_file_writes_beside_the_file() {
    let folder = folder();
    fs::create_dir(folder.path().join("sub")).ok();
    write(&folder, "sub/my.ball.rhai", "sqrt(x*x + y*y + z*z) - 3.0");
    isoslice(&folder)
        .args(["slice", "sub/my.ball.rhai", "--quiet"])
        .assert()
        .success()
        .stdout(is_empty())
        .stderr(contains(SMALL_FOOT));
    assert_eq!(
        names(&folder.path().join("sub")),
        ["my.ball.gcode", "my.ball.rhai"]
    );
}

#[test]
fn negative_numbers_are_values() {
    isoslice(&folder())
        .args(["slice", "-q", "-e", "-(3 - sqrt(x^2 + y^2 + z^2))"])
        .args(["--rotate-x", "-90", "--rotate-y=-45", "--rotate-z", "-.5"])
        .args(["--bounds", "-5,-5,-5:5,5,5", "--set", "skin_angle=-30"])
        .assert()
        .success();
    // The part is off the bed, but the text is understood.
    isoslice(&folder())
        .args(["info", "-e", BALL, "--at", "-5,-10"])
        .assert()
        .stderr(contains("--at <").not());
    for (option, value) in [
        ("--size", "-5"),
        ("--scale", "0"),
        ("--at", "-1"),
        ("--bounds", "-"),
    ] {
        isoslice(&folder())
            .args(["slice", "-e", BALL, option, value])
            .assert()
            .code(2)
            .stderr(contains(format!("for '{option} <")));
    }
}

#[test]
fn a_model_is_needed_and_one_is_enough() {
    isoslice(&folder()).arg("slice").assert().code(2);
    isoslice(&folder())
        .args(["slice", "a.rhai", "-e", BALL])
        .assert()
        .code(2)
        .stderr(contains("cannot be used with"));
    isoslice(&folder())
        .args(["slice", "-e", BALL, "--threads", "0"])
        .assert()
        .code(2);
}

#[test]
fn a_missing_model_is_named_and_leaves_nothing() {
    let folder = folder();
    isoslice(&folder)
        .args(["slice", "nowhere.rhai"])
        .assert()
        .code(1)
        .stdout(is_empty())
        .stderr(starts_with("error: ").and(contains("nowhere.rhai")));
    assert!(names(folder.path()).is_empty());
}

#[test]
fn an_unknown_parameter_is_an_error() {
    let folder = folder();
    isoslice(&folder)
        .args(["slice", "-e", BALL, "-D", "cell=8"])
        .assert()
        .code(1)
        .stderr(starts_with("error: ").and(contains("cell")));
    assert!(names(folder.path()).is_empty());
    isoslice(&folder)
        .args(["slice", "-e", BALL, "-D", "cell"])
        .assert()
        .code(2)
        .stderr(contains("name=value"));
}

#[test]
fn an_unknown_setting_is_answered_with_the_nearest() {
    isoslice(&folder())
        .args(["slice", "-e", BALL, "--set", "layer_hieght=0.1"])
        .assert()
        .code(1)
        .stderr(
            "error: --set: there is no setting \"layer_hieght\"; did you mean \
             layer_height?\n",
        );
}

#[test]
fn wrong_settings_are_named_with_file_and_line() {
    let folder = folder();
    write(&folder, "my.toml", "walls = 3\n\n[speed]\ntravel = -1\n");
    for command in ["slice", "info"] {
        isoslice(&folder)
            .args([command, "-e", BALL, "--config", "my.toml"])
            .assert()
            .code(1)
            .stderr(
                "error: my.toml:4: speed.travel = -1 is out of range; use 0.1 \
                 to 2000 mm/s\n",
            );
    }
    isoslice(&folder)
        .args(["settings", "--config", "my.toml"])
        .assert()
        .code(1)
        .stdout(is_empty());
    isoslice(&folder)
        .args(["settings", "--set", "walls=many"])
        .assert()
        .code(1)
        .stderr(
            "error: --set: walls = many is not understood; write a whole \
             number, 0 to 1000\n",
        );
    isoslice(&folder)
        .args(["settings", "--config", "none.toml"])
        .assert()
        .code(1)
        .stderr(starts_with(
            "error: cannot read the settings file none.toml",
        ))
        .stderr(contains("\n  because: "));
}

#[test]
fn warnings_go_to_the_error_stream() {
    isoslice(&folder())
        .args(["settings", "--set", "layer_height=0.35"])
        .assert()
        .success()
        .stdout(contains("\nlayer_height = 0.35\n"))
        .stderr(starts_with("warning: layer_height = 0.35 mm is more than"));
}

#[test]
fn printed_settings_can_be_fed_back() {
    let folder = folder();
    let defaults = stdout(isoslice(&folder).arg("settings"));
    write(&folder, "defaults.toml", &defaults);
    let again = stdout(isoslice(&folder).args([
        "settings",
        "--config",
        "defaults.toml",
    ]));
    assert_eq!(again, defaults);

    write(&folder, "a.toml", "walls = 4\nseam = 'rear'\n");
    write(
        &folder,
        "b.toml",
        "walls = 5\ngcode.start = '''\nA {{b}}\\n'''\n",
    );
    let mine = stdout(
        isoslice(&folder)
            .args(["settings", "--config", "a.toml", "--config", "b.toml"])
            .args(["--set", "infill_density=33.3%", "--set", "top_layers=9"]),
    );
    for line in [
        "walls = 5",
        "seam = \"rear\"",
        "infill_density = 33.3",
        "top_layers = 9",
        "start = \"A {{b}}\\\\n\"",
    ] {
        assert!(mine.contains(&format!("\n{line}\n")), "{line} is missing");
    }
    write(&folder, "mine.toml", &mine);
    let again =
        stdout(isoslice(&folder).args(["settings", "--config", "mine.toml"]));
    assert_eq!(again, mine);
}

#[test]
fn an_input_is_never_overwritten() {
    let folder = folder();
    write(&folder, "part.rhai", "draw(sphere(#{ radius: 3 }))");
    write(&folder, "my.toml", "walls = 2");
    for args in [
        &["slice", "part.rhai", "-o", "part.rhai"][..],
        &["slice", "part.rhai", "-o", "../x/../part.rhai"],
        &[
            "slice",
            "-e",
            BALL,
            "--config",
            "my.toml",
            "-o",
            "./my.toml",
        ],
    ] {
        let args = args.iter().map(|arg| {
            let here = folder.path().file_name().unwrap_or_default();
            arg.replace("../x/..", &format!("../{}", here.to_string_lossy()))
        });
        isoslice(&folder)
            .args(args)
            .assert()
            .code(1)
            .stderr(contains("is also an input and would be overwritten"));
    }
    assert_eq!(names(folder.path()), ["my.toml", "part.rhai"]);
    let kept = fs::read_to_string(folder.path().join("my.toml"));
    assert_eq!(kept.ok().as_deref(), Some("walls = 2"));
}

#[test]
fn after_an_error_the_old_output_is_still_there() {
    let folder = folder();
    write(&folder, "out.gcode", "old");
    isoslice(&folder)
        .args(["slice", "nowhere.rhai", "-o", "out.gcode"])
        .assert()
        .code(1);
    assert_eq!(names(folder.path()), ["out.gcode"]);
    let kept = fs::read_to_string(folder.path().join("out.gcode"));
    assert_eq!(kept.ok().as_deref(), Some("old"));
}

#[test]
fn an_output_that_cannot_be_is_an_error() {
    let folder = folder();
    isoslice(&folder)
        .args(["slice", "-e", BALL, "-o", "."])
        .assert()
        .code(1)
        .stderr(contains("is a folder"));
    isoslice(&folder)
        .args(["slice", "-e", BALL, "-o", "none/x.gcode"])
        .assert()
        .code(1)
        .stderr(contains("there is no folder none"));
    assert!(names(folder.path()).is_empty());
}

#[test]
fn info_tells_what_would_be_printed() {
    let folder = folder();
    isoslice(&folder)
        .args(["info", "-e", BALL, "--set", "layer_height=0.1"])
        .assert()
        .success()
        .stdout(starts_with("formula\n  size  "))
        .stdout(contains("\n  bounds      ("))
        .stdout(contains(" of 0.1 mm\n"))
        .stdout(contains("\n  expression  "));
    assert!(names(folder.path()).is_empty());
}

/// fidget's text for a ball of radius 1.
const UNIT_BALL: &str = "_0 var-x\n_1 var-y\n_2 var-z\n_3 square _0\n\
    _4 square _1\n_5 square _2\n_6 add _3 _4\n_7 add _6 _5\n_8 sqrt _7\n\
    _9 const 1\n_a sub _8 _9\n";

fn read(folder: &TempDir, name: &str) -> String {
    fs::read_to_string(folder.path().join(name))
        .unwrap_or_else(|e| panic!("{name}: {e}"))
}

#[test]
fn a_unit_model_is_brought_to_size() {
    let folder = folder();
    write(&folder, "unit.vm", UNIT_BALL);
    let summary =
        stdout(isoslice(&folder).args(["slice", "unit.vm", "--size", "6"]));
    assert!(summary.starts_with("unit.gcode\n  size        6.00 × 6.00"));
    assert!(summary.contains("\n  layers      30\n"), "{summary}");
    let gcode = read(&folder, "unit.gcode");
    assert_eq!(gcode.matches(";LAYER_CHANGE\n").count(), 30);
    assert!(gcode.ends_with('\n'));
}

#[test]
fn settings_reach_the_gcode() {
    let folder = folder();
    isoslice(&folder)
        .args(["slice", "-q", "-e", "max(max(abs(x),abs(y)),abs(z)) - 5"])
        .args(["--set", "infill_density=100%", "--set", "top_layers=0"])
        .args(["--set", "bottom_layers=0", "--set", "layer_height=0.25"])
        .args(["--set", "walls=1", "--set", "filament.flow=95%"])
        .args(["--set", "gcode.flavour=klipper", "-o", "dense.gcode"])
        .assert()
        .success();
    let gcode = read(&folder, "dense.gcode");
    assert!(gcode.contains("\n;HEIGHT:0.25\n"));
    assert!(gcode.contains("\nSET_PRINT_STATS_INFO TOTAL_LAYER=40\n"));
    assert!(gcode.contains("\n;TYPE:External perimeter\n"));
    assert!(!gcode.contains("\n;TYPE:Perimeter\n"));
    assert!(gcode.contains("\n;TYPE:Solid infill\n"));
    assert!(!gcode.contains("Internal infill"));
    // All of the cube, at 95 % of the flow.
    let used = gcode
        .lines()
        .find_map(|l| l.strip_prefix("; filament used [mm] = "))
        .and_then(|mm| mm.parse::<f64>().ok())
        .unwrap_or_default();
    let skirt_and_cube = 0.95 * 1000.0 / (0.25 * PI * 1.75 * 1.75);
    assert!((used / skirt_and_cube - 1.0).abs() < 0.04, "{used}");
}

const KNOB: &str = "let r = param(\"radius\", 4.0, \"radius, mm\");\n\
    let flat = param(\"flat\", 1.5);\n\
    (sqrt(x * x + y * y + z * z) - r).max(abs(z) - flat)\n";

#[test]
fn parameters_are_listed_and_set() {
    let folder = folder();
    write(&folder, "knob.rhai", KNOB);
    let info = stdout(isoslice(&folder).args(["info", "knob.rhai"]));
    assert!(info.starts_with("knob\n  size        8.00 × 8.00 × 3.00 mm\n"));
    assert!(info.ends_with(
        "\n  parameters (set with -D name=value)\n    \
         radius = 4.0  radius, mm\n    flat   = 1.5\n"
    ));
    let info =
        stdout(isoslice(&folder).args(["info", "knob.rhai", "-D", "radius=5"]));
    assert!(info.contains("  size        10.00 × 10.00 × 3.00 mm\n"));
    assert!(
        info.contains("radius = 5.0 (default 4.0)  radius, mm\n"),
        "{info}"
    );
    let summary = stdout(isoslice(&folder).args([
        "slice",
        "knob.rhai",
        "-D",
        "flat=0.5",
        "-D",
        "radius=3",
    ]));
    assert!(summary.contains("  size        6.00 × 6.00 × 1.00 mm\n"));
    assert!(summary.contains("  layers      5\n"), "{summary}");
    isoslice(&folder)
        .args(["slice", "knob.rhai", "-D", "radios=3"])
        .assert()
        .code(1)
        .stderr(contains("radios").and(contains("radius")));
}

#[test]
fn every_layer_has_its_picture() {
    let folder = folder();
    isoslice(&folder)
        .args(["slice", "-q", "-e", "max(sqrt(x^2+y^2) - 3, abs(z) - 0.5)"])
        .args(["--svg", "new/pictures"])
        .assert()
        .success()
        .stdout(is_empty());
    let pictures = names(&folder.path().join("new/pictures"));
    let expected: Vec<String> =
        (1..=5).map(|i| format!("layer-{i:05}.svg")).collect();
    assert_eq!(pictures, expected);
    let svg = read(&folder, "new/pictures/layer-00005.svg");
    assert!(svg.starts_with("<svg ") && svg.trim_end().ends_with("</svg>"));
    assert!(svg.contains("<polyline "));
}

#[test]
fn pictures_of_an_earlier_longer_run_are_removed() {
    let folder = folder();
    let pictures = |height: &str, more: &[&str]| {
        let ball = format!("max(sqrt(x^2 + y^2) - 3, abs(z) - {height})");
        isoslice(&folder)
            .args(["slice", "-q", "-e", &ball, "--svg", "pictures"])
            .args(["--set", "layer_height=1", "--set", "infill_density=0"])
            .args(["--set", "first_layer_height=1"])
            .args(["--set", "printer.nozzle_diameter=1.4"])
            .args(["--set", "outer_wall_width=1.5"])
            .args(["--set", "inner_wall_width=1.5"])
            .args(["--set", "skin_width=1.5", "--set", "infill_width=1.5"])
            .args(more)
            .assert()
            .success();
        names(&folder.path().join("pictures"))
    };
    let of = |layers: std::ops::RangeInclusive<usize>| -> Vec<String> {
        layers.map(|i| format!("layer-{i:05}.svg")).collect()
    };
    assert_eq!(pictures("4", &[]), of(1..=8));
    let foreign = ["layer-00007.svg.txt", "layer-7.svg", "my-layer-00007.svg"];
    for name in foreign {
        write(&folder, &format!("pictures/{name}"), "mine");
    }
    let mut left = of(1..=4);
    left.extend(foreign.map(String::from));
    left.sort();
    assert_eq!(pictures("2", &[]), left);
    // A range replaces its own pictures and leaves those of the part's other
    // layers.
    fs::remove_file(folder.path().join("pictures/layer-00001.svg")).unwrap();
    write(&folder, "pictures/layer-00002.svg", "old");
    left.remove(0);
    assert_eq!(pictures("2", &["--layers", "2..3"]), left);
    let second = read(&folder, "pictures/layer-00002.svg");
    assert!(
        second.contains("<title>layer 2 at z = 2.000 mm"),
        "{second}"
    );
}

#[test]
fn layers_can_be_chosen() {
    let folder = folder();
    let slice = |layers: &str| {
        let mut command = isoslice(&folder);
        command.args(["slice", "-e", BALL, "--layers", layers]);
        command
    };
    slice("4..")
        .assert()
        .success()
        .stdout(contains("  layers      4 to 30 of 30\n"));
    let gcode = read(&folder, "formula.gcode");
    assert_eq!(gcode.matches(";LAYER_CHANGE").count(), 27);
    assert!(gcode.contains(";LAYER_CHANGE\n;Z:0.8\n"), "{gcode:.300}");
    slice("31..40")
        .assert()
        .code(1)
        .stderr(contains("layers from 31 on were asked for"));
    for bad in ["5..4", "0..3", "x", "-1..2"] {
        slice(bad).assert().code(2);
    }
}

#[test]
fn a_report_says_how_accurate_the_print_is() {
    let folder = folder();
    let slice = |report: &str, more: &[&str]| {
        let mut command = isoslice(&folder);
        command
            .args(["slice", "-e", BALL, "--report", report])
            .args(more);
        command
    };
    slice("r.json", &["--threads", "1"])
        .assert()
        .success()
        .stdout(contains("\n  accuracy    outline within "));
    let text = read(&folder, "r.json");
    let report: serde_json::Value = serde_json::from_str(&text).unwrap();
    let number = |path: &str| {
        let found = report.pointer(path).and_then(|v| v.as_f64());
        found.unwrap_or_else(|| panic!("{path} of {text:.2000}"))
    };
    // 3.5 µm of the accuracy are the outline's. The outer wall of a small ball has
    // short moves, and may be off by 7.5 µm for fewer of them. The
    // walls behind it keep to path_accuracy, 25 µm, from where they were meant.
    assert!(number("/outline_um/points") > 1000.0);
    assert!((-5.0..-0.5).contains(&number("/outline_um/min")));
    assert!((0.5..5.0).contains(&number("/outline_um/max")));
    assert!(number("/outline_um/p99") >= number("/outline_um/p50"));
    assert!(number("/outer_wall_um/p99") < 8.0);
    assert!(number("/wall_spacing_um/p99") < 33.0);
    assert_eq!(number("/outline_lost"), 0.0);
    // The ball's volume is 36π; its layers' are less by the chords.
    let ball = 36.0 * PI;
    let uncertain = number("/volume/uncertainty_percent") / 100.0;
    assert!(uncertain < 0.02);
    let by_field = number("/volume/field_mm3");
    assert!((by_field / ball - 1.0).abs() < uncertain, "{by_field}");
    assert!((number("/volume/layers_mm3") / ball - 1.0).abs() < 0.003);
    assert!(number("/area/excess_percent").abs() < 0.5);
    assert_eq!(report["layers"].as_array().map(Vec::len), Some(30));
    assert_eq!(report["layers"][29]["layer"], 30);

    // More threads write the same file. No file is written where there was an
    // error, or over another file.
    slice("r2.json", &["--threads", "3"]).assert().success();
    assert_eq!(text, read(&folder, "r2.json"));
    slice("r3.json", &["--layers", "99.."]).assert().code(1);
    slice("./formula.gcode", &[])
        .assert()
        .code(1)
        .stderr(contains("the report and the G-code would both be"));
    let left = ["formula.gcode", "r.json", "r2.json"];
    assert_eq!(names(folder.path()), left);
}

/// A wall of one bead: its width varies, and its edges count.
#[test]
fn the_summary_measures_beads_of_varying_width() {
    let folder = folder();
    let tube = "max(abs(sqrt(x^2 + y^2) - 8) - 0.3, abs(z) - 1)";
    let mut slice = isoslice(&folder);
    slice.args(["slice", "-e", tube, "--json"]);
    let off = json(&mut slice)["outer_wall_p99_um"].as_f64().unwrap();
    assert!(off < 10.0, "{off}");
}

/// What a new user gets wrong, and what has to be done.
#[test]
fn typical_mistakes_are_told_what_to_write() {
    let folder = folder();
    write(&folder, "ok.rhai", "sqrt(x*x + y*y + z*z) - 5.0");
    write(&folder, "text.rhai", "sqrt(x*x + y*y) - \"5\"");
    write(&folder, "python.rhai", "def f(a):\n  return a\n");
    write(&folder, "unit.toml", "walls = 2\nlayer_height = 0.2mm\n");
    write(&folder, "logo.svg", "<svg/>");
    std::fs::create_dir(folder.path().join("parts")).unwrap();
    for (arguments, told) in [
        ("slice logo.svg --height 15", "(\"logo.svg\")' --height 15"),
        (
            "slice ok.rhai --set color_change=3",
            "did you mean gcode.layer, with the firmware's pause in one layer",
        ),
        (
            "slice ok.rhai --pause-at-layer 3",
            "isoslice has gcode.layer, with the firmware's pause",
        ),
        (
            "slice ok.rhai --set support.threshold_angle=40",
            "did you mean support.angle?",
        ),
        (
            "slice ok.rhai --set support_angle=40",
            "did you mean support.angle?",
        ),
        ("slice none.rhai", "cannot read none.rhai: check its name"),
        ("slice parts", "parts is a folder; "),
        ("slice ok", "did you mean ok.rhai?"),
        ("slice a.stl", "cannot read a.stl"),
        ("slice a.step", "export it as .stl, .obj, .ply or .3mf"),
        ("slice ok.gcode", "isoslice preview read that"),
        ("slice sqrt(x^2+y^2)-3", "write -e 'sqrt(x^2+y^2)-3'"),
        (
            "slice ok.rhai --set walls 3",
            "write --set walls=3, without a space",
        ),
        ("info ok.rhai b.rhai", "one model at a time"),
        ("slice ok.rhai b.rhai", "cannot read b.rhai: check its name"),
        ("slice ok.rhai --copies 1000000000", "1..=1000"),
        (
            "slice ok.rhai --copies 40 --size 90",
            "there is no place for ok_",
        ),
        (
            "slice ok.rhai --copies 2 --at 50,50",
            "--at is for a single part",
        ),
        ("slice unit.toml", "a plate file is TOML"),
        ("info unit.toml", "a plate file is TOML"),
        ("ok.rhai", "write isoslice slice ok.rhai"),
        ("slice ok.rhai --size 50mm", "without a unit, as in 50"),
        ("slice ok.rhai --config unit.toml", "unit.toml:2: "),
        (
            "slice ok.rhai --config unit.toml",
            "in `layer_height = 0.2mm`",
        ),
        ("slice ok.rhai --config unit.toml", "numbers have no unit"),
        ("slice ok.rhai --layers 99..", "ask for layers from 1 to 50"),
        ("slice ok.rhai --set infill_density=0.15", "write 15% if"),
        (
            "slice text.rhai",
            "`-` works on shapes and numbers, not on a shape and a string",
        ),
        ("slice python.rhai", "a function is fn name(a, b) { a + b }"),
        ("slice -e x2+y^2-9", "did you mean `x^2`?"),
        ("slice -e x^2+y²-9", "did you mean `y^2`?"),
        ("slice -e x^2+y^2=9", "write a - b for a < b or a = b"),
        ("render ok.rhai -o ok.jpg", "render draws PNG pictures"),
        ("slice ok.rhai --set wall=3", "did you mean walls?"),
        ("slice ok.rhai --spiral-vase", "write --set spiral=true"),
        ("slice ok.rhai --nozzle 0.6", "printer.nozzle_diameter=0.6"),
        (
            "slice ok.rhai --set sparse_infill_density=20",
            "did you mean infill_density?",
        ),
        (
            "slice ok.rhai --set wall_generator=arachne",
            "it is another slicer's: isoslice measures",
        ),
        ("slice ok.rhai --set support=auto", "did you mean supports?"),
        (
            "slice ok.rhai --set line_width=0.5",
            "did you mean outer_wall_width",
        ),
        (
            "slice ok.rhai --layers 5..1",
            "write the lower number first",
        ),
        ("slice ok.rhai --report no/r.json", "there is no folder no"),
        ("new no/part", "there is no folder no; make it"),
        ("check none.gcode", "cannot read none.gcode: check its name"),
        (
            "preview none.gcode",
            "cannot read none.gcode: check its name",
        ),
    ] {
        isoslice(&folder)
            .args(arguments.split(' '))
            .assert()
            .stderr(contains(told));
    }
}

/// Errors that tell their cause with a remedy are not followed by the cause.
#[test]
fn a_cause_is_told_once() {
    let folder = folder();
    for (formula, told) in [
        ("x", "the model is unbounded"),
        ("sqrt(x^2+y^2)-5", "the model has no height"),
        ("sin(1e6*x)+sqrt(x^2+y^2+z^2)-5", "too finely"),
    ] {
        isoslice(&folder)
            .args(["slice", "-e", formula])
            .assert()
            .code(1)
            .stderr(contains(told).count(1));
    }
    // Another cause is told.
    isoslice(&folder)
        .args(["slice", "none.rhai"])
        .assert()
        .stderr(contains("because: No such file"));
}

/// Nothing is sliced for a printer that cannot get so hot.
#[test]
fn temperatures_beyond_the_printer_are_refused_before_slicing() {
    let folder = folder();
    for (sets, told) in [
        (
            [
                "filament.nozzle_temperature=280",
                "printer.max_nozzle_temperature=250",
            ],
            "filament.nozzle_temperature = 280 °C is more than \
             printer.max_nozzle_temperature = 250 °C",
        ),
        (
            [
                "filament.bed_temperature=110",
                "printer.max_bed_temperature=100",
            ],
            "filament.bed_temperature = 110 °C is more than \
             printer.max_bed_temperature = 100 °C",
        ),
    ] {
        // Its model would not be found: settings come first.
        isoslice(&folder)
            .args(["slice", "no-such.rhai", "--set", sets[0], "--set", sets[1]])
            .assert()
            .code(1)
            .stderr(contains(told).and(contains("from --set")));
    }
    assert!(names(folder.path()).is_empty());
}

#[test]
fn threads_do_not_show_in_the_file() {
    let folder = folder();
    let slice = |threads: &str| {
        isoslice(&folder)
            .args(["slice", "-q", "-e", BALL, "--threads", threads])
            .assert()
            .success();
        read(&folder, "formula.gcode")
    };
    assert!(slice("1") == slice("3"));
}

fn json(command: &mut Command) -> serde_json::Value {
    serde_json::from_str(&stdout(command)).unwrap()
}

#[test]
fn profiles_are_listed_and_shown() {
    let folder = folder();
    write_profile(&folder, "filaments/mine.toml", "description = 'My own'\n");
    let list = stdout(isoslice(&folder).arg("profiles"));
    assert!(
        list.starts_with("printers (--printer NAME)\n  anycubic-kobra-2  ")
    );
    assert!(list.contains("\n  mine                    My own (yours)\n"));
    assert!(list.contains("\npresets (--preset NAME)\n  draft "));
    assert!(list.trim_end().ends_with("profiles"), "{list}");
    let list = stdout(isoslice(&folder).args(["profiles", "list", "presets"]));
    assert!(list.starts_with("presets (--preset NAME)\n  draft  "));
    assert!(!list.contains("ender-3"));

    let all = json(isoslice(&folder).args(["profiles", "list", "--json"]));
    let all = all.as_array().unwrap();
    let named = |name| all.iter().find(|p| p["name"] == name).unwrap();
    assert_eq!(named("ender-3-v2")["inherits"], "ender-3");
    assert_eq!(named("ender-3-v2")["kind"], "printer");
    assert!(named("ender-3")["file"].is_null());
    assert!(
        named("mine")["file"]
            .as_str()
            .unwrap()
            .ends_with("mine.toml")
    );

    isoslice(&folder)
        .args(["profiles", "show", "mine"])
        .assert()
        .success()
        .stdout("description = 'My own'\n");
    isoslice(&folder)
        .args(["profiles", "show", "prusa-mk5"])
        .assert()
        .code(1)
        .stdout(is_empty())
        .stderr(starts_with(
            "error: there is no profile \"prusa-mk5\"; did ",
        ))
        .stderr(contains("prusa-mk4"));
    isoslice(&folder)
        .args(["profiles", "--profiles", "nowhere"])
        .assert()
        .code(1)
        .stderr("error: there is no folder nowhere (--profiles)\n");
}

fn write_profile(folder: &TempDir, name: &str, text: &str) {
    let path = folder.path().join("profiles").join(name);
    fs::create_dir_all(path.parent().unwrap()).unwrap();
    fs::write(path, text).unwrap();
}

#[test]
fn settings_come_from_profiles_files_and_the_command_line_in_order() {
    let folder = folder();
    write_profile(
        &folder,
        "presets/mine.toml",
        "inherits = 'fine'\n\nwalls = 3\nseam = 'rear'\n",
    );
    write(&folder, "my.toml", "walls = 4\n");
    let args = [
        "settings",
        "--printer",
        "prusa-mini",
        "--filament=petg",
        "--preset=mine",
        "--config=my.toml",
        "--set",
        "skirt.loops=2",
        "--effective",
    ];
    let effective = stdout(isoslice(&folder).args(args));
    let line = |start: &str| {
        let found = effective.lines().find(|line| line.starts_with(start));
        found.unwrap_or_else(|| panic!("{start}: {effective}"))
    };
    assert!(
        line("layer_height = \"30%\" ")
            .ends_with(" # shipped presets/fine.toml:4: 0.120 mm")
    );
    assert!(line("walls = 4 ").ends_with(" # my.toml:1"));
    assert!(line("seam = \"rear\" ").ends_with("mine.toml:4"));
    assert!(line("bed_x = 180 ").contains("shipped printers/prusa-mini.toml"));
    assert!(line("density = 1.27 ").contains("shipped filaments/petg.toml"));
    assert!(line("loops = 2 ").ends_with(" # --set"));
    assert!(line("accuracy = 0.005 ").ends_with(" # default"));
    // What is printed can be read again.
    write(&folder, "all.toml", &effective);
    let plain = |args: &[&str]| stdout(isoslice(&folder).args(args));
    let fed_back = plain(&["settings", "--config", "all.toml"]);
    assert_eq!(fed_back, plain(&args[..args.len() - 1]));

    let mut args = args;
    args[8] = "--json";
    let told = json(isoslice(&folder).args(args));
    let walls = serde_json::json!(
        { "value": 4, "unit": "", "default": 2, "from": "my.toml:1" }
    );
    assert_eq!(told["walls"], walls);
    assert_eq!(told["retract.length"]["value"], 3.2);
    assert_eq!(told["seam"]["value"], "rear");
}

#[test]
fn an_unknown_profile_is_answered_with_the_nearest() {
    let folder = folder();
    for (command, option, wrong, right) in [
        ("slice", "--printer", "prusa-mini+", "prusa-mini"),
        ("info", "--filament", "PETG-X", "petg"),
        ("slice", "--preset", "thinwall", "thin-wall"),
        ("info", "--printer", "MK3S", "prusa-mk3s"),
    ] {
        isoslice(&folder)
            .args([command, "-e", BALL, option, wrong])
            .assert()
            .code(1)
            .stderr(starts_with(format!("error: {option} {wrong}: there is ")))
            .stderr(contains(format!("did you mean {right}")));
    }
    assert!(names(folder.path()).is_empty());
}

#[test]
fn a_profile_is_no_output() {
    let folder = folder();
    write(&folder, "mine.toml", "walls = 1\n");
    isoslice(&folder)
        .args(["slice", "-e", BALL, "--preset", "./mine.toml"])
        .args(["-o", "mine.toml"])
        .assert()
        .code(1)
        .stderr(contains("is also an input and would be overwritten"));
}

/// Only files that were read are no outputs, whatever name they were read by.
#[test]
fn files_of_profiles_are_no_outputs() {
    let folder = folder();
    fs::create_dir_all(folder.path().join("mine/filaments")).unwrap();
    let files = ["mine/filaments/mine.toml", "mine/base.toml", "wave.rhai"];
    write(&folder, files[0], "inherits = '../base.toml'\n");
    write(&folder, files[1], "infill = 'wave.rhai'\n");
    write(&folder, files[2], "sin(x)\n");
    let slice = |output: &str| {
        let mut command = isoslice(&folder);
        command
            .args(["slice", "-e", BALL, "--profiles", "mine"])
            .args(["--filament", "mine", "-o", output]);
        command.assert()
    };
    for output in files {
        let before = read(&folder, output);
        slice(output).code(1).stderr(contains("is also an input"));
        assert_eq!(read(&folder, output), before);
    }
    // A name is no file.
    write(&folder, "petg", "old");
    isoslice(&folder)
        .args(["slice", "-e", BALL, "--filament", "petg", "-o", "petg"])
        .assert()
        .success();
    assert!(read(&folder, "petg").starts_with("; generated by"));
}

#[test]
fn the_time_is_written_if_it_is_asked_for() {
    let folder = folder();
    let slice = |epoch: Option<&str>, more: &[&str]| {
        let mut command = isoslice(&folder);
        match epoch {
            Some(epoch) => command.env("SOURCE_DATE_EPOCH", epoch),
            None => command.env_remove("SOURCE_DATE_EPOCH"),
        };
        command.args(["slice", "-e", BALL, "-o", "-"]).args(more);
        command.assert()
    };
    let text = |epoch, more: &[&str]| {
        let output = slice(epoch, more).success().get_output().stdout.clone();
        String::from_utf8(output).unwrap()
    };
    let plain = text(None, &[]);
    let name = concat!("; generated by isoslice ", env!("CARGO_PKG_VERSION"));
    // The version's day, whatever the clock says.
    assert!(plain.starts_with(&format!("{name} on 2")));
    assert!(plain.lines().next().unwrap().ends_with("not of the file)"));
    assert_eq!(text(Some("1767225600"), &[]), plain);
    let with = text(Some("1767225599"), &["--timestamp"]);
    let line = format!("{name} on 2025-12-31 at 23:59:59 UTC");
    assert_eq!(with.lines().next(), Some(line.as_str()));
    let behind = |text: &str| text.split_once('\n').unwrap().1.to_owned();
    assert_eq!(behind(&with), behind(&plain));
    // The year of a clock that is set is in this range.
    let now = text(None, &["--timestamp"]);
    let first = now.lines().next().unwrap();
    let year = first.strip_prefix(&format!("{name} on ")).unwrap();
    let year: u32 = year.split('-').next().unwrap().parse().unwrap();
    assert!((2020..10_000).contains(&year), "{first}");
    for wrong in ["", "yesterday", "-1", "253402300800"] {
        slice(Some(wrong), &["--timestamp"])
            .code(1)
            .stderr(contains("SOURCE_DATE_EPOCH"));
    }
}

#[test]
fn info_advises_supports_only_where_none_are_set() {
    let folder = folder();
    // A plate of 60 mm on a post.
    let plate = "max(max(abs(x) - 30, abs(y) - 10), abs(z - 12) - 2)";
    let post = "max(max(abs(x), abs(y)) - 3, abs(z - 5) - 6)";
    let model = format!("min({plate}, {post})");
    let told = |supports: &str| {
        let mut info = isoslice(&folder);
        info.args(["info", "-e", &model, "--supports", "--set", supports]);
        let output = info.assert().success().get_output().clone();
        let [out, err] = [output.stdout, output.stderr];
        [out, err].map(|text| String::from_utf8(text).unwrap())
    };
    let [places, advice] = told("supports=off");
    assert!(advice.contains("set supports = \"auto\""), "{advice}");
    assert!(!places.contains("is set"), "{places}");
    for kind in ["auto", "plate"] {
        let [places, advice] = told(&format!("supports={kind}"));
        assert!(!advice.contains("supports"), "{advice}");
        let set = format!("supports = \"{kind}\" is set: slice the part");
        assert!(places.contains(&set), "{places}");
        assert!(places.contains("leans, reach"), "{places}");
    }
}

#[test]
fn info_and_summary_speak_json() {
    let folder = folder();
    write(&folder, "knob.rhai", KNOB);
    let args = ["knob.rhai", "-D", "radius=5", "--json"];
    let info = json(isoslice(&folder).arg("info").args(args));
    assert_eq!(info["model"], "knob");
    assert_eq!(info["layer_count"], 15);
    assert_eq!(info["size_mm"][2], 3.0);
    assert_eq!(
        info["parameters"][0],
        serde_json::json!({
            "name": "radius",
            "type": "number",
            "value": 5.0,
            "default": 4.0,
            "description": "radius, mm",
        })
    );
    let mut slice = isoslice(&folder);
    slice.arg("slice").args(args);
    slice.args(["--set", "layer_height=0.35", "--set", "filament.cost=0"]);
    let told = json(&mut slice);
    assert_eq!(told["output"], "knob.gcode");
    assert_eq!(
        (&told["first_layer"], &told["last_layer"]),
        (&serde_json::json!(1), &told["layer_count"])
    );
    assert!(told["print_time_s"].as_f64().unwrap() > 10.0);
    assert!(told["outline_p99_um"].as_f64().unwrap() < 5.0);
    assert!(told["filament_cost"].is_null());
    assert!(told.get("timings_s").is_none());
    for cause in ["cooling", "acceleration"] {
        assert!(told["time_lost_s"][cause].as_f64().unwrap() >= 0.0);
    }
    let warnings = told["warnings"].as_array().unwrap();
    assert!(
        warnings[0].as_str().unwrap().contains("0.8 ×"),
        "{warnings:?}"
    );
}

#[test]
fn standard_input_and_output_are_dashes() {
    let folder = folder();
    let from_file = {
        write(&folder, "stdin.rhai", KNOB);
        isoslice(&folder)
            .args(["slice", "-q", "stdin.rhai", "-D", "radius=3"])
            .assert()
            .success();
        read(&folder, "stdin.gcode")
    };
    let output = isoslice(&folder)
        .args(["slice", "-", "-D", "radius=3", "-o", "-"])
        .write_stdin(KNOB)
        .assert()
        .success()
        .stderr(starts_with("stdin (on standard output)\n  size  "))
        .get_output()
        .stdout
        .clone();
    assert!(from_file.as_bytes() == output, "the same bytes");
    for (format, text) in [("formula", BALL), ("vm", UNIT_BALL)] {
        isoslice(&folder)
            .args(["info", "-", "--format", format])
            .write_stdin(text)
            .assert()
            .success()
            .stdout(starts_with("stdin\n  size  "));
    }
    isoslice(&folder)
        .args(["info", "-"])
        .write_stdin("let")
        .assert()
        .code(1)
        .stderr(starts_with("error: stdin"));
    // Standard input has the limits that files have.
    for (format, megabytes) in [("rhai", 2), ("formula", 2), ("vm", 64)] {
        isoslice(&folder)
            .args(["info", "-", "--format", format])
            .write_stdin(" ".repeat((megabytes << 20) + 1))
            .assert()
            .code(1)
            .stderr(contains(format!("larger than {megabytes} MB")));
    }
    isoslice(&folder)
        .args(["preview", "-e", BALL, "-o", "-", "--open"])
        .assert()
        .code(1)
        .stdout(is_empty())
        .stderr(contains("--open"));
    isoslice(&folder)
        .args(["slice", "-e", BALL, "-o", "-", "--report", "-"])
        .assert()
        .code(1)
        .stdout(is_empty())
        .stderr(contains("would both be -"));
}

#[test]
fn one_may_ask_for_less_and_for_more() {
    let folder = folder();
    let slice = |more: &[&str]| {
        let mut command = isoslice(&folder);
        command
            .args(["slice", "-e", BALL, "--set", "layer_height=0.35"])
            .args(more);
        command
    };
    let warned = || starts_with("warning: layer_height");
    slice(&[]).assert().success().stderr(warned());
    slice(&["-q"]).assert().stdout(is_empty()).stderr(warned());
    slice(&["-qq"])
        .assert()
        .stdout(is_empty())
        .stderr(is_empty());
    slice(&["--filament", "tpu"])
        .assert()
        .stderr(contains("note:").not());
    slice(&["--filament", "tpu", "-v"])
        .assert()
        .stdout(contains("    contour ").not())
        .stderr(contains(
            "note: filament.max_flow = 3 mm³/s slows speed.outer_wall from 40 \
             to ",
        ));
    slice(&["-vv"]).assert().stdout(contains("    contour "));
    slice(&["-q", "-v"]).assert().code(2);
    // Errors are always told.
    slice(&["-qq", "--set", "walls=-1"])
        .assert()
        .code(1)
        .stderr(starts_with("error: "));
}

#[test]
fn a_starter_slices_as_it_is() {
    let folder = folder();
    isoslice(&folder)
        .args(["new", "my.part"])
        .assert()
        .success()
        .stdout(starts_with("my.part.rhai\nmy.part.toml\n"))
        .stdout(contains("slice my.part.rhai --config my.part.toml\n"));
    let script = read(&folder, "my.part.rhai");
    for shown in ["param(", "sphere(", "box(", "blend(", "my.part.toml"] {
        assert!(script.contains(shown), "{shown}");
    }
    isoslice(&folder)
        .args(["slice", "my.part.rhai", "--config", "my.part.toml"])
        .assert()
        .success()
        .stderr(is_empty());
    // Its settings are the defaults, and right once the # is taken off.
    let config = read(&folder, "my.part.toml");
    let all = config
        .lines()
        .map(|line| line.strip_prefix("# ").unwrap_or(line))
        .filter(|line| line.split(' ').nth(1) == Some("="))
        .collect::<Vec<_>>();
    assert!(all.len() > 20, "{config}");
    write(&folder, "on.toml", &all.join("\n"));
    let settings =
        |args: &[&str]| stdout(isoslice(&folder).arg("settings").args(args));
    assert_eq!(settings(&["--config", "on.toml"]), settings(&[]));
    assert_eq!(settings(&["--config", "my.part.toml"]), settings(&[]));
}

#[test]
fn every_template_slices_as_it_is() {
    for template in ["part", "lattice", "vase", "formula"] {
        let folder = folder();
        isoslice(&folder)
            .args(["new", "lamp", "--template", template])
            .assert()
            .success();
        let script = read(&folder, "lamp.rhai");
        assert!(script.starts_with("// lamp: "), "{script}");
        // The command is the one in the script's head.
        let said = script
            .lines()
            .filter_map(|line| line.strip_prefix("//   isoslice "));
        let mut count = 0;
        for line in said.map(|l| l.split("   ").next().unwrap()) {
            isoslice(&folder)
                .args(line.split_whitespace())
                .assert()
                .success()
                // On a slow machine the program says after 10 s that it is at
                // work.
                .stderr(
                    is_empty().or(starts_with("note: still at work")
                        .and(contains("\n").count(1))),
                );
            count += 1;
        }
        assert_eq!(count, 3, "{template}");
    }
    let folder = folder();
    isoslice(&folder)
        .args(["new", "lamp", "--template", "lamp"])
        .assert()
        .code(2)
        .stderr(contains("part, lattice, vase, formula"));
}

#[test]
fn a_starter_overwrites_nothing() {
    let folder = folder();
    write(&folder, "part.toml", "mine");
    for name in ["part", "part.rhai"] {
        isoslice(&folder)
            .args(["new", name])
            .assert()
            .code(1)
            .stderr(contains("part.toml is already there"));
    }
    assert_eq!(names(folder.path()), ["part.toml"]);
    assert_eq!(read(&folder, "part.toml"), "mine");
    isoslice(&folder).args(["new", ".."]).assert().code(1);
    isoslice(&folder).args(["new", "none/x"]).assert().code(1);
    assert_eq!(names(folder.path()), ["part.toml"]);
}

#[test]
fn the_manual_knows_every_command() {
    let folder = folder();
    let commands = ["slice", "info", "settings", "profiles", "new", "man"];
    let page = stdout(isoslice(&folder).arg("man"));
    assert!(page.contains(".TH isoslice 1"), "{page}");
    for section in ["EXAMPLES", "EXIT CODES", "ENVIRONMENT", "SUBCOMMANDS"] {
        assert!(page.contains(section), "{section}");
    }
    let page = stdout(isoslice(&folder).args(["man", "slice"]));
    assert!(page.contains("\\-\\-layers"), "{page}");
    isoslice(&folder).args(["man", "slize"]).assert().code(1);
    stdout(isoslice(&folder).args(["man", "--dir", "man1"]));
    let pages = names(&folder.path().join("man1"));
    assert!(pages.contains(&"isoslice.1".to_owned()), "{pages:?}");
    for command in commands {
        let name = format!("isoslice-{command}.1");
        assert!(pages.contains(&name), "{name}: {pages:?}");
    }
}

#[cfg(unix)]
mod unix {
    use super::*;
    use std::os::unix::fs::{PermissionsExt, symlink};

    fn mode(folder: &TempDir, name: &str) -> u32 {
        let data = fs::metadata(folder.path().join(name));
        data.map_or(0, |data| data.permissions().mode() & 0o777)
    }

    #[test]
    fn output_has_the_permissions_of_any_new_file() {
        let folder = folder();
        write(&folder, "new", "");
        let slice = || {
            isoslice(&folder)
                .args(["slice", "-q", "-e", BALL, "-o", "out.gcode"])
                .assert()
                .success();
        };
        slice();
        assert_eq!(mode(&folder, "out.gcode"), mode(&folder, "new"));
        // A file that replaces another one has the other one's mode.
        let private = fs::Permissions::from_mode(0o640);
        fs::set_permissions(folder.path().join("out.gcode"), private).ok();
        slice();
        assert_eq!(mode(&folder, "out.gcode"), 0o640);
    }

    #[test]
    fn a_link_stays_a_link() {
        let folder = folder();
        write(&folder, "real.gcode", "old");
        symlink("real.gcode", folder.path().join("link.gcode")).ok();
        isoslice(&folder)
            .args(["slice", "-q", "-e", BALL, "-o", "link.gcode"])
            .assert()
            .success();
        assert!(folder.path().join("link.gcode").is_symlink());
        let text = fs::read_to_string(folder.path().join("real.gcode"));
        assert_ne!(text.ok().as_deref(), Some("old"));
    }

    #[test]
    fn devices_are_written_not_replaced() {
        let folder = folder();
        isoslice(&folder)
            .args(["slice", "-e", BALL, "-o", "/dev/stdout"])
            .assert()
            .success()
            .stdout(contains("layers  ").not())
            .stderr(contains("layers  "));
        isoslice(&folder)
            .args(["slice", "-e", BALL, "-o", "/dev/null"])
            .assert()
            .success();
        assert!(!Path::new("/dev/null").is_file());
    }
}

#[test]
fn render_draws_a_picture() {
    let folder = folder();
    write(&folder, "ball.rhai", "sqrt(x*x + y*y + z*z) - 10.0");
    let size = |png: &[u8]| {
        assert!(png.starts_with(b"\x89PNG"), "no picture");
        let side =
            |i: usize| u32::from_be_bytes(png[i..i + 4].try_into().unwrap());
        [side(16), side(20)]
    };
    let read = |name: &str| fs::read(folder.path().join(name)).unwrap();
    isoslice(&folder)
        .args(["render", "ball.rhai", "--pixels", "60x40"])
        .assert()
        .success()
        .stdout("");
    let first = read("ball.png");
    assert_eq!(size(&first), [60, 40]);
    let output = isoslice(&folder)
        .args(["render", "ball.rhai", "--pixels", "60x40", "-o", "-"])
        .args(["--threads", "1"])
        .assert()
        .success();
    assert!(output.get_output().stdout == first);
    // With its supports the ball looks different, on any number of threads.
    let supported = |threads: &str| {
        let output = isoslice(&folder)
            .args(["render", "ball.rhai", "--pixels", "60x40", "-o", "-"])
            .args(["--set", "supports=auto", "--threads", threads])
            .assert()
            .success();
        output.get_output().stdout.clone()
    };
    let with = supported("1");
    assert!(with != first);
    assert!(with == supported("2"));
    isoslice(&folder)
        .args(["render", "-e", "x^2 + y^2 + z^2 - 9", "--view", "top"])
        .args(["--elevation", "80", "--background", "#102030"])
        .args(["-o", "other.png", "--pixels", "16x16"])
        .assert()
        .success();
    assert_eq!(size(&read("other.png")), [16, 16]);
    for (wrong, says) in [
        (["--view", "above"], "there are iso, front"),
        (["--pixels", "60"], "as in 800x600"),
        (["--background", "mauve"], "there are white, black"),
        (["--elevation", "up"], "from -360 to 360"),
    ] {
        isoslice(&folder)
            .args(["render", "ball.rhai"])
            .args(wrong)
            .assert()
            .code(2)
            .stderr(predicate::str::contains(says));
    }
    // The model is not overwritten.
    isoslice(&folder)
        .args(["render", "ball.rhai", "-o", "ball.rhai"])
        .assert()
        .code(1);
}

#[test]
fn what_could_hurt_the_printer_is_not_written() {
    let folder = folder();
    write(&folder, "part.gcode", "; an older file");
    let args = ["slice", "-e", BALL, "-o", "part.gcode", "--set"];
    let beyond = "gcode.end=G1 X900 F6000";
    isoslice(&folder)
        .args(args)
        .arg(beyond)
        .assert()
        .code(1)
        .stderr(contains("should not be run on this printer"))
        .stderr(contains("the head goes to x = 900.00"))
        .stderr(contains("gcode.end"))
        .stderr(contains("--no-check"));
    let kept = fs::read_to_string(folder.path().join("part.gcode")).unwrap();
    assert_eq!(kept, "; an older file");
    assert_eq!(names(folder.path()), ["part.gcode"]);
    // A stream has been written by then, but the end is an error all the same.
    isoslice(&folder)
        .args(["slice", "-e", BALL, "-o", "-", "--set", beyond])
        .assert()
        .code(1)
        .stdout(contains("G1 X900"));
    isoslice(&folder)
        .args(args)
        .args([beyond, "--no-check"])
        .assert()
        .success()
        .stdout(contains("checked").not());
    isoslice(&folder)
        .args(["check", "part.gcode"])
        .assert()
        .code(1)
        .stdout(contains("fault: part.gcode:").and(contains("1 fault,")));
}

#[test]
fn a_summary_tells_what_begins_in_the_air() {
    let folder = folder();
    // A pin hangs beside a post, from a bar that joins them.
    let model = "min(max(max(abs(x) - 2, abs(y) - 2), abs(z - 3) - 3), \
                 min(max(max(abs(x - 8) - 2, abs(y) - 2), abs(z - 4) - 2), \
                 max(max(abs(x - 4) - 6, abs(y) - 2), abs(z - 5) - 1)))";
    let slice = ["slice", "-e", model, "-o", "pin.gcode"];
    isoslice(&folder).args(slice).assert().success().stdout(
        contains("safe for this printer")
            .and(contains("16.0 mm² in 1 island that begins on nothing"))
            .and(contains("z = 2.00 mm")),
    );
    let text = stdout(isoslice(&folder).args(slice).arg("--json"));
    let json: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!(json["checked"], true);
    assert_eq!(json["islands_in_air"], 1);
    let begins = &json["hanging"]["begins_on_nothing"];
    assert_eq!(begins["count"], 1);
    assert_eq!(begins["first_mm"][2], 2.0);
    assert_eq!(json["hanging"]["leans"]["area_mm2"], 0.0);
    assert!(json["hanging"]["small_foot"].is_null());
    // The upper half alone goes on with the lower one.
    let upper = ["--layers", "20..", "--json"];
    let text = stdout(isoslice(&folder).args(slice).args(upper));
    let json: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!(json["islands_in_air"], 0);
    assert_eq!(json["warnings"], serde_json::json!([]));
}

#[test]
fn a_template_cannot_hide_a_command_or_burn_the_printer() {
    let folder = folder();
    for (set, said) in [
        ("gcode.start=G28\rG1 Z-10", "gcode.start, line 1, column 4"),
        ("gcode.start=G28\nG1\u{b} Z5", "control character U+000B"),
        (
            "gcode.end={{ \"M104 S0\\r\" }}",
            "line 1 of the filled-in text",
        ),
        ("gcode.start=G28\nM109 S500", "the nozzle is told 500 °C"),
        (
            "filament.nozzle_temperature=expr: -273",
            "filament.nozzle_temperature = \"expr: -273\" is -273.000 at z = ",
        ),
        (
            "filament.nozzle_temperature=expr: 200 - 10*z",
            "may be 170 to 600",
        ),
    ] {
        isoslice(&folder)
            .args(["slice", "-e", BALL, "-o", "a.gcode", "--set", set])
            .assert()
            .code(1)
            .stderr(contains(said));
        assert_eq!(names(folder.path()), [""; 0], "{set:?}");
    }
    let fine = "gcode.start=G28\r\nG1 Z5 F600\r\n";
    let args = ["slice", "-e", BALL, "-o", "-", "--set", fine];
    let text = stdout(isoslice(&folder).args(args));
    assert!(text.contains("G28\nG1 Z5 F600\n") && !text.contains('\r'));
}

#[test]
fn what_is_no_whole_print_is_a_fault() {
    let folder = folder();
    let text = stdout(isoslice(&folder).args(["slice", "-e", BALL, "-o", "-"]));
    let half = text.find(";LAYER_CHANGE").unwrap_or(0) + text.len() / 2;
    let half = half.min(text.find("; end of layers").unwrap_or(0));
    write(&folder, "half.gcode", &text[..half]);
    write(&folder, "empty.gcode", "");
    write(&folder, "part.rhai", "let x = axis(\"x\");\ndraw(x);\n");
    for (file, said) in [
        ("half.gcode", "was cut off"),
        ("empty.gcode", "there is no command in it"),
        ("part.rhai", "this is no G-code"),
    ] {
        isoslice(&folder)
            .args(["check", file])
            .assert()
            .code(1)
            .stdout(contains(said));
    }
    write(&folder, "whole.gcode", &text);
    let whole = stdout(isoslice(&folder).args(["check", "whole.gcode"]));
    assert!(whole.contains("0 faults, 0 warnings\n"), "{whole}");
    let macros = text.replace("G28\n", "G28\nMY_MACRO X=1\n");
    write(&folder, "macros.gcode", &macros);
    let json = ["check", "macros.gcode", "--json"];
    let json = stdout(isoslice(&folder).args(json));
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert_eq!(json["unknown"], serde_json::json!({"MY_MACRO": 1}));
    assert_eq!(json["findings"][0]["count"], 1);
}

#[test]
fn names_say_what_is_written() {
    let folder = folder();
    let slice = |output: &str| {
        let mut command = isoslice(&folder);
        command.args(["slice", "-e", BALL, "-o", output]);
        command.assert()
    };
    for text in [
        "a.gcode", "a.g", "a.gco", "a.nc", "a.ngc", "a.txt", "a", "a.B",
    ] {
        slice(text).success().stderr(contains("binary").not());
        assert!(read(&folder, text).starts_with("; generated by isoslice "));
    }
    for other in [
        "a.3mf",
        "a.STL",
        "a.obj",
        "a.step",
        "a.png",
        "a.svg",
        "a.html",
        "a.rhai",
        "a.toml",
        "a.ufp",
        "a.x3g",
        "a.ctb",
        "a.gcode.gz",
    ] {
        slice(other)
            .code(1)
            .stderr(contains(format!("cannot write {other}: ")))
            .stderr(contains("slice writes G-code, as text (.gcode)"));
        assert!(!folder.path().join(other).exists());
    }
}

#[test]
fn binary_files_are_written_and_read() {
    let folder = folder();
    let prusa = ["--printer", "prusa-mk4"];
    let slice = |output: &str, more: &[&str]| {
        let mut command = isoslice(&folder);
        command.args(["slice", "-e", BALL, "-o", output]).args(more);
        command.assert().success()
    };
    slice("a.bgcode", &prusa).stderr(contains("binary").not());
    slice("a.gcode", &prusa);
    let file = fs::read(folder.path().join("a.bgcode")).unwrap();
    assert!(file.starts_with(b"GCDE"));
    let verdict = |name: &str| {
        let mut command = isoslice(&folder);
        json(command.args(["check", name, "--json"]).args(prusa))
    };
    let (packed, text) = (verdict("a.bgcode"), verdict("a.gcode"));
    for key in ["safe", "moves", "layers", "counts", "generator"] {
        assert_eq!(packed[key], text[key], "{key}");
    }
    let mut command = isoslice(&folder);
    command.args(["preview", "a.bgcode", "-o", "a.html"]);
    command.assert().success().stdout(contains("isoslice"));
    assert!(names(folder.path()).contains(&"a.html".to_owned()));
    // Cut off, it is refused.
    fs::write(folder.path().join("b.bgcode"), &file[..file.len() / 2]).unwrap();
    let mut command = isoslice(&folder);
    command.args(["check", "b.bgcode"]);
    command
        .assert()
        .code(1)
        .stderr(contains("it is cut off in block"));
    // Other firmwares do not read it.
    slice("c.bgcode", &[]).stderr(contains("binary G-code is for Prusa's"));
}

#[test]
fn a_part_of_which_nothing_is_printed_is_an_error() {
    let folder = folder();
    for thin in [
        "max(max(abs(x) - 0.05, abs(y) - 5), abs(z) - 3)",
        "max(sqrt(x^2 + y^2) - 0.1, abs(z) - 3)",
    ] {
        isoslice(&folder)
            .args(["slice", "-e", thin, "-o", "thin.gcode"])
            .assert()
            .code(1)
            .stderr(contains("nothing to print: in"))
            .stderr(contains("thinner than any line"))
            .stderr(contains("--scale"));
        assert!(names(folder.path()).is_empty());
    }
}

/// The tip of a cone is thinner than any line.
#[test]
fn layers_end_where_the_print_does() {
    let folder = folder();
    let cone = "max(sqrt(x^2 + y^2) - 10 + z, -z)";
    // Nobody can know that before the part is sliced: `info` says what is
    // planned.
    isoslice(&folder)
        .args(["info", "-e", cone])
        .assert()
        .success()
        .stdout(contains("  layers      50 planned, of 0.2 mm\n"));
    let slice = |layers: &str| {
        let mut command = isoslice(&folder);
        command
            .args(["slice", "-e", cone, "-o", "cone.gcode", "--json"])
            .args(["--set", "gcode.flavour=klipper", "--layers", layers]);
        let summary = json(&mut command);
        (summary, read(&folder, "cone.gcode"))
    };
    let (summary, text) = slice("..");
    assert_eq!(summary["layer_count"], 49);
    assert_eq!(summary["last_layer"], 49);
    assert_eq!(text.matches(";LAYER_CHANGE").count(), 49);
    for line in [
        "SET_PRINT_STATS_INFO TOTAL_LAYER=49",
        "; total layers count = 49",
        "; max_layer_z = 9.8",
    ] {
        assert!(text.lines().any(|l| l == line), "{line}");
    }
    // A range's file says so as well.
    let (part, text_of_part) = slice("40..");
    assert_eq!(part["last_layer"], 49);
    assert!(text_of_part.contains("; layers 40 to 49 of 49\n"));
    let layers = |text: &str| {
        let from = text.find(";LAYER_CHANGE\n;Z:8\n").unwrap();
        text[from..text.find("; end of layers").unwrap()].to_owned()
    };
    // The beginning of a range is left out, as in any comparison of ranges.
    let from = |text: &str| text[text.find(";Z:9\n").unwrap()..].to_owned();
    assert_eq!(from(&layers(&text)), from(&layers(&text_of_part)));
}

#[test]
fn a_drawing_gets_a_height() {
    let folder = folder();
    isoslice(&folder)
        .args(["info", "-e", "sqrt(x^2 + y^2) - 10"])
        .assert()
        .failure()
        .stderr(contains("--height 3"))
        .stderr(contains("abs(z - 1.5) - 1.5"));
    isoslice(&folder)
        .args(["info", "-e", "sqrt(x^2 + y^2) - 10", "--height", "3"])
        .assert()
        .success()
        .stdout(contains("20.00 × 20.00 × 3.00 mm"));
    isoslice(&folder)
        .args(["info", "-e", BALL, "--height", "3"])
        .assert()
        .failure()
        .stderr(contains("has a height of its own"));
}

/// Where the ball cannot be moved to the origin, the loss of digits is told
/// first, and the error names only what followed from it.
#[test]
fn a_ball_that_lost_its_digits_is_said_to_have() {
    let folder = folder();
    let formula = "x^2 - 60000*x + 9e8 + y^2 + z^2 - 25";
    isoslice(&folder)
        .args(["slice", "-e", formula, "-o", "far.gcode"])
        .assert()
        .stderr(starts_with("warning: the part lies 30 m from the origin"));
}

/// The text is that of a ball at the origin, for which f32 has the digits.
#[test]
fn a_ball_thirty_metres_away_is_all_there() {
    let folder = folder();
    let sliced = |formula: &str, flow: &str, name: &str| {
        let flow = format!("flow=expr: {flow}");
        isoslice(&folder)
            .args(["slice", "-e", formula, "-o", name, "--set", &flow])
            .assert()
            .success();
        let text = fs::read_to_string(folder.path().join(name)).unwrap();
        let lines = text.lines().filter(|l| !l.contains("expr:"));
        lines.map(str::to_owned).collect::<Vec<_>>()
    };
    let near = sliced(BALL, "100 + x", "near.gcode");
    let far = sliced(
        "sqrt((x - 30000)^2 + y^2 + z^2) - 3",
        "100 + (x - 30000)",
        "far.gcode",
    );
    assert!(near.len() > 500);
    // The formula sees coordinates of 30 m, in f32: its last digits differ.
    let count = |lines: &[String], word: &str| {
        lines.iter().filter(|l| l.contains(word)).count()
    };
    for word in ["LAYER_CHANGE", "TYPE:", "G1 "] {
        let (a, b) = (count(&near, word), count(&far, word));
        assert!(a.abs_diff(b) <= a / 50, "{word}: {a} and {b}");
    }
}

/// No more threads are started than there are processors, whatever a variable that
/// is meant for other programs says.
#[test]
fn a_variable_of_other_programs_starts_no_threads() {
    let folder = tempfile::tempdir().unwrap();
    let ball = ["-e", "sqrt(x^2+y^2+z^2) - 3"];
    let run = |arguments: &[&str], threads: &str| {
        isoslice(folder.path())
            .env("RAYON_NUM_THREADS", threads)
            .args(arguments)
            .assert()
            .success();
    };
    let mut files = Vec::new();
    for threads in ["1", "9999", "no number"] {
        run(&[&["slice", "-o", "a.gcode"], &ball[..]].concat(), threads);
        run(&[&["info"], &ball[..]].concat(), threads);
        let small = ["render", "-o", "a.png", "--pixels", "40x40"];
        run(&[&small[..], &ball].concat(), threads);
        run(&["check", "a.gcode"], threads);
        files.push(
            ["a.gcode", "a.png"]
                .map(|name| fs::read(folder.path().join(name)).unwrap()),
        );
    }
    assert!(files[0] == files[1] && files[0] == files[2]);
}

/// A cone on its tip has no line in its first layer.
#[test]
fn a_part_on_a_point_is_refused_with_what_helps() {
    let folder = folder();
    let cone = "max(sqrt(x^2 + y^2)*2 - z, z - 10)";
    isoslice(&folder)
        .args(["slice", "-e", cone, "-o", "cone.gcode"])
        .assert()
        .code(1)
        .stderr(
            contains("hardly more than a point")
                .and(contains("supports = \"auto\"")),
        );
    assert!(!folder.path().join("cone.gcode").exists());
    isoslice(&folder)
        .args(["slice", "-e", cone, "-o", "cone.gcode"])
        .args(["--set", "supports=auto"])
        .assert()
        .success();
}

#[test]
fn layers_that_are_too_short_to_cool_are_told_of() {
    let rod = "max(sqrt(x^2 + y^2) - 2, abs(z - 4) - 4)";
    let told = |time: &str| {
        let time = format!("cooling.min_layer_time={time}");
        let args = ["slice", "-e", rod, "-o", "rod.gcode", "--set", &time];
        stdout(isoslice(&folder()).args(args))
    };
    assert!(
        told("30").contains("layers take less than cooling.min_layer_time")
    );
    assert!(!told("0").contains("min_layer_time"));
}

#[test]
fn a_profile_given_as_settings_is_told_to_be_one() {
    let folder = folder();
    write(&folder, "my.toml", "description = \"Mine\"\nwalls = 3\n");
    isoslice(&folder)
        .args(["slice", "-e", BALL, "--config", "my.toml"])
        .assert()
        .code(1)
        .stderr(contains("it is a profile's: give the file with --printer"));
}

/// The first thing that users of another slicer try.
#[test]
fn files_of_other_slicers_are_to_be_imported() {
    let folder = folder();
    write(
        &folder,
        "prusa.ini",
        "perimeters = 3\nfill_pattern = gyroid\n",
    );
    write(&folder, "orca.json", "{\"wall_loops\": \"3\"}\n");
    write(&folder, "own.toml", "walls = 3\ninherits = \"ender-3\"\n");
    for (option, file) in [
        ("--config", "prusa.ini"),
        ("--config", "orca.json"),
        ("--printer", "prusa.ini"),
        ("--filament", "./orca.json"),
    ] {
        isoslice(&folder)
            .args(["settings", option, file])
            .assert()
            .failure()
            .stderr(contains(format!("isoslice profiles import {file}")));
    }
    isoslice(&folder)
        .args(["settings", "--printer", "absent.ini"])
        .assert()
        .failure()
        .stderr(contains("profiles import").not());
    isoslice(&folder)
        .args(["settings", "--config", "own.toml"])
        .assert()
        .failure()
        .stderr(contains("own.toml:2: there is no setting \"inherits\""))
        .stderr(contains("--printer, --filament or --preset"));
    write(&folder, "part.png", "");
    isoslice(&folder)
        .args(["slice", "part.png"])
        .assert()
        .failure()
        .stderr(contains("image(\"part.png\")"));
}

/// Layers of parts that are printed one by one are counted part by part.
#[test]
fn layers_of_parts_one_by_one_are_not_compared_with_those_of_one() {
    let folder = folder();
    let ball = ["slice", "-e", BALL, "--copies", "2", "--no-check"];
    let coarse = [
        "--set",
        "layer_heights=adaptive",
        "--set",
        "raft.layers=2",
        "--set",
        "sample_spacing=0.2",
        "-o",
        "x.gcode",
    ];
    let one_by_one = [
        "--set",
        "plate.sequence=one-by-one",
        "--set",
        "printer.head_clearance_radius=20",
        "--set",
        "printer.gantry_height=20",
    ];
    let together = stdout(isoslice(&folder).args(ball).args(coarse));
    assert!(
        together.contains("the lowest 2 of them the raft's"),
        "{together}"
    );
    assert!(together.contains("than with layer_heights"), "{together}");
    let apart =
        stdout(isoslice(&folder).args(ball).args(coarse).args(one_by_one));
    assert!(
        apart.contains("4 of them rafts', 2 below each part"),
        "{apart}"
    );
    assert!(!apart.contains("than with layer_heights"), "{apart}");
}

#[test]
fn a_formula_that_is_none_is_found_in_its_file() {
    let folder = folder();
    write(
        &folder,
        "a.toml",
        "walls = 3\nlayer_heights = \"expr: 0.2 +\"\n",
    );
    isoslice(&folder)
        .args(["slice", "-e", BALL, "--config", "a.toml"])
        .assert()
        .failure()
        .stderr(contains("a.toml:2: layer_heights = \"expr: 0.2 +\": "));
    write(
        &folder,
        "b.toml",
        "layer_heights = \"expr: 0.2 + 0.01 * z\"\n\
         xy_compensation = \"expr: 0.1 * curvature\"\n\
         infill_density = \"expr: 10 + d\"\nseam = \"expr: -y\"\n",
    );
    isoslice(&folder)
        .args(["settings", "--config", "b.toml"])
        .assert()
        .success();
}
