//! What strangers wrote, on its way to a terminal, and what users are told of
//! usual mistakes: the real program is run.

use crate::program::isoslice;
use std::fs;
use tempfile::TempDir;

const BALL: &str = "sqrt(x^2 + y^2 + z^2) - 3";

fn write(folder: &TempDir, name: &str, bytes: impl AsRef<[u8]>) {
    let path = folder.path().join(name);
    fs::create_dir_all(path.parent().unwrap()).unwrap();
    fs::write(path, bytes).unwrap();
}

/// Both streams of a run, which must hold nothing that a terminal obeys and
/// be of a length that people read.
#[track_caller]
fn shown(folder: &TempDir, args: &[&str]) -> String {
    let output = isoslice(folder).args(args).output().unwrap();
    let text = [output.stdout, output.stderr].concat();
    let text = String::from_utf8(text).unwrap();
    let obeyed = |c: char| {
        c.is_control() && c != '\n' || "\u{202e}\u{2028}\u{feff}".contains(c)
    };
    assert!(!text.contains(obeyed), "{args:?}: {text:?}");
    assert!(text.len() < 6000, "{args:?}: {} bytes", text.len());
    text
}

#[test]
fn what_strangers_wrote_is_shown_and_not_obeyed() {
    let folder = tempfile::tempdir().unwrap();
    let evil = "\u{1b}]0;owned\u{7}\r\u{9b}2J\u{202e}\u{2028}";
    write(&folder, "throw.rhai", format!("throw \"a{evil}b\""));
    let text = shown(&folder, &["info", "throw.rhai"]);
    assert!(text.contains("\\u{1b}]0;owned\\u{7}\\r\\u{9b}2J"), "{text}");

    let script =
        format!("param(\"r\", 3.0, `of{evil}\nnobody`); x*x+y*y+z*z-9");
    write(&folder, "param.rhai", &script);
    let text = shown(&folder, &["info", "param.rhai"]);
    assert!(text.contains("\\nnobody"), "{text}");
    let text = shown(&folder, &["info", "param.rhai", "--json"]);
    let json: serde_json::Value = serde_json::from_str(&text).unwrap();
    let description = json["parameters"][0]["description"].as_str().unwrap();
    assert_eq!(description, format!("of{evil}\nnobody"));

    write(&folder, "nul.rhai", "x\0\0y");
    shown(&folder, &["info", "nul.rhai"]);
    shown(&folder, &["info", "-e", "sqrt(\u{1b}[31m)"]);
    shown(&folder, &["info", "no\n\u{1b}[31msuch.rhai"]);
    shown(&folder, &["slice", "-e", BALL, "--set", "walls=\u{1b}[31m"]);
    shown(&folder, &["slice", "--\u{1b}[31m\u{202e}"]);
    shown(&folder, &["check", "\u{1b}[31m.gcode"]);
    write(
        &folder,
        "evil.gcode",
        format!("G28\nM{evil} X\nG1 X1 Y\u{1b}[31m\n"),
    );
    shown(&folder, &["check", "evil.gcode"]);
    shown(&folder, &["check", "evil.gcode", "--json"]);
    shown(&folder, &["preview", "evil.gcode"]);
    // A name with a line's end makes no line of its own.
    write(&folder, "a\nwarning: b.rhai", "x*x+y*y+z*z-9");
    let text = shown(&folder, &["slice", "a\nwarning: b.rhai"]);
    assert!(text.contains("a\\nwarning: b.gcode"), "{text}");
}

#[test]
fn what_is_long_is_shortened() {
    let folder = tempfile::tempdir().unwrap();
    let long = "a".repeat(1 << 20);
    write(&folder, "long.toml", format!("walls = \"{long}\""));
    shown(&folder, &["info", "-e", BALL, "--config", "long.toml"]);
    write(&folder, "key.toml", format!("{long} = 1"));
    shown(&folder, &["info", "-e", BALL, "--config", "key.toml"]);
    write(&folder, "long.rhai", format!("x - {long}"));
    shown(&folder, &["info", "long.rhai"]);
    write(&folder, "long.vm", format!("{long} {long}"));
    shown(&folder, &["info", "long.vm"]);
    let start = format!("[gcode]\nstart = \"G1 {{{long}}}\"");
    write(&folder, "start.toml", start);
    shown(&folder, &["slice", "-e", BALL, "--config", "start.toml"]);
}

#[test]
fn one_unreadable_profile_hides_no_other() {
    let folder = tempfile::tempdir().unwrap();
    let good = "description = \"fine\\u001b[31m\"\n";
    write(&folder, "profiles/printers/good.toml", good);
    write(&folder, "profiles/printers/broken.toml", "walls = = 3");
    write(&folder, "profiles/printers/bytes.toml", b"a = \"\xff\"");
    let text = shown(&folder, &["profiles"]);
    assert!(
        text.contains("good") && text.contains("fine\\u{1b}"),
        "{text}"
    );
    assert!(text.contains("prusa-mk4"), "{text}");
    assert!(text.contains("broken.toml:1"), "{text}");
    assert!(text.contains("bytes.toml"), "{text}");
    isoslice(&folder).args(["profiles"]).assert().success();
    isoslice(&folder)
        .args(["info", "-e", BALL, "--printer", "broken"])
        .assert()
        .code(1);
}

#[test]
fn a_byte_order_mark_is_skipped_and_other_encodings_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let text = "x*x + y*y + z*z - 9";
    write(&folder, "a.rhai", format!("\u{feff}{text}"));
    write(
        &folder,
        "a.vm",
        "\u{feff}_0 var-x\n_1 var-y\n_2 var-z\n\
        _3 square _0\n_4 square _1\n_5 square _2\n_6 add _3 _4\n\
        _7 add _6 _5\n_8 const 9\n_9 sub _7 _8\n",
    );
    write(&folder, "a.toml", "\u{feff}walls = 3\n");
    write(
        &folder,
        "profiles/presets/mine.toml",
        "\u{feff}description = \"d\"\ngcode.start = \"\u{feff}G28\"\n",
    );
    let formula = format!("\u{feff}{BALL}");
    for model in [&["a.rhai"][..], &["a.vm"], &["-e", &formula]] {
        isoslice(&folder)
            .arg("slice")
            .args(model)
            .args(["--config", "a.toml", "--preset", "mine", "-o", "a.gcode"])
            .assert()
            .success();
    }
    let gcode = fs::read_to_string(folder.path().join("a.gcode")).unwrap();
    assert!(!gcode.contains('\u{feff}') && gcode.contains("\nG28\n"));
    isoslice(&folder)
        .args(["info", "-"])
        .write_stdin(format!("\u{feff}{text}"))
        .assert()
        .success();

    let wide: Vec<u8> = "\u{feff}walls = 3"
        .encode_utf16()
        .flat_map(u16::to_le_bytes)
        .collect();
    write(&folder, "wide.rhai", &wide);
    write(&folder, "wide.toml", &wide);
    for args in [
        &["info", "wide.rhai"][..],
        &["info", "-e", BALL, "--config", "wide.toml"],
    ] {
        let text = shown(&folder, args);
        assert!(text.contains("UTF-16"), "{text}");
    }
    let stdin = isoslice(&folder)
        .args(["info", "-"])
        .write_stdin(wide)
        .output();
    let text = String::from_utf8(stdin.unwrap().stderr).unwrap();
    assert!(text.contains("UTF-16"), "{text}");
}

#[test]
fn usual_mistakes_are_told_what_to_write() {
    let folder = tempfile::tempdir().unwrap();
    for (args, words) in [
        (&["--supports"][..], "--set supports=auto"),
        (&["--layer-height", "0.1"], "--set layer_height=0.1"),
        (&["--infill=30"], "--set infill_density=30%"),
        (&["--nozzle-temperature=1"], "filament.nozzle_temperature"),
        (
            &["--set", "temperature=200"],
            "filament.nozzle_temperature or filament.first_layer_nozzle",
        ),
        (
            &["--set", "outer_wall=30"],
            "speed.outer_wall or acceleration",
        ),
        (&["--repotr", "a"], "--report"),
    ] {
        let args = [&["slice", "-e", BALL][..], args].concat();
        let text = shown(&folder, &args);
        assert!(text.contains(words), "{args:?}: {text}");
        assert!(!text.contains("'--layers'"), "{args:?}: {text}");
    }
}
