//! Plates for Bambu Lab's printers, as the program writes and reads them.

use crate::program::isoslice;
use std::fs;
use std::io::Read;
use std::path::Path;
use tempfile::TempDir;

const BALL: &str = "sqrt(x^2 + y^2 + (z - 4)^2) - 5";

#[track_caller]
fn done(folder: &Path, args: &[&str]) -> String {
    let output = isoslice(folder).args(args).output().unwrap();
    assert!(output.status.success(), "{args:?}: {output:?}");
    String::from_utf8(output.stdout).unwrap()
}

fn folder() -> TempDir {
    tempfile::tempdir().unwrap()
}

#[test]
fn each_printer_gets_a_plate_that_the_check_takes() {
    let folder = folder();
    let path = folder.path();
    for (printer, model) in [
        ("bambu-a1", "N2S"),
        ("bambu-a1-mini", "N1"),
        ("bambu-p1s", "C12"),
        ("bambu-x1c", "BL-P001"),
    ] {
        let args = ["slice", "-e", BALL, "--printer", printer, "--json"];
        let summary = done(path, &args);
        let summary: serde_json::Value =
            serde_json::from_str(&summary).unwrap();
        assert_eq!(summary["output"], "formula.gcode.3mf");
        let bytes = fs::read(path.join("formula.gcode.3mf")).unwrap();
        // The same input gives the same bytes.
        done(path, &[&args[..], &["-o", "2.gcode.3mf"]].concat());
        assert_eq!(fs::read(path.join("2.gcode.3mf")).unwrap(), bytes);
        let file = fs::File::open(path.join("formula.gcode.3mf")).unwrap();
        let mut zip = zip::ZipArchive::new(file).unwrap();
        let mut text = |name: &str| {
            let mut text = String::new();
            let mut entry = zip.by_name(name).unwrap();
            entry.read_to_string(&mut text).unwrap();
            text
        };
        let info = text("Metadata/slice_info.config");
        let id = format!("key=\"printer_model_id\" value=\"{model}\"");
        assert!(info.contains(&id), "{info}");
        let time = summary["print_time_s"].as_f64().unwrap();
        let prediction = format!("key=\"prediction\" value=\"{time:.0}\"");
        assert!(info.contains(&prediction), "{info}");
        // The text is what `-o part.gcode` writes, behind its own head.
        let gcode = text("Metadata/plate_1.gcode");
        let plain = [&args[..], &["-o", "plain.gcode"]].concat();
        done(path, &plain);
        let plain = fs::read_to_string(path.join("plain.gcode")).unwrap();
        let body = |text: &str| {
            let from = text.find("\nM220").unwrap();
            text[from..text.find("; end of layers").unwrap()].to_owned()
        };
        assert!(body(&gcode) == body(&plain), "{printer}");
        let check = ["check", "formula.gcode.3mf", "--printer", printer];
        let said = done(path, &check);
        assert!(said.contains("0 faults, 0 warnings"), "{printer}: {said}");
    }
    let page = ["preview", "formula.gcode.3mf", "-o", "page.html"];
    done(path, &page);
    assert!(fs::metadata(path.join("page.html")).unwrap().len() > 10_000);
}

#[test]
fn other_printers_are_warned_and_damaged_plates_refused() {
    let folder = folder();
    let path = folder.path();
    let args = ["slice", "-e", BALL, "-o", "part.gcode.3mf"];
    let output = isoslice(path).args(args).output().unwrap();
    let told = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{told}");
    assert!(told.contains("is for Bambu Lab's printers"), "{told}");
    let mut bytes = fs::read(path.join("part.gcode.3mf")).unwrap();
    bytes[2000] ^= 1;
    fs::write(path.join("bad.gcode.3mf"), bytes).unwrap();
    fs::write(path.join("no.gcode.3mf"), "PK\x03\x04 and no more").unwrap();
    for (file, words) in [
        ("bad.gcode.3mf", "archive cannot be read"),
        ("no.gcode.3mf", "archive"),
    ] {
        let output = isoslice(path).args(["check", file]).output().unwrap();
        let told = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(1), "{told}");
        assert!(told.contains(words), "{told}");
    }
    let output = isoslice(path)
        .args(["slice", "-e", BALL, "-o", "part.3mf"])
        .output()
        .unwrap();
    let told = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(told.contains(".gcode.3mf"), "{told}");
    let args = ["slice", "-e", BALL, "--printer", "bambu-a1", "--set"];
    let firmware = [&args[..], &["retract.firmware=true"]].concat();
    let output = isoslice(path).args(firmware).output().unwrap();
    let told = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(told.contains("\"bambu\" has no retraction"), "{told}");
}

#[test]
fn what_is_on_a_plate_is_told() {
    let folder = folder();
    let path = folder.path();
    let script = "let w = param(\"w\", 10.0);\n\
                  draw(box(#{lower: [0, 0, 0], upper: [w, 8, 6]}));\n";
    fs::write(path.join("part.rhai"), script).unwrap();
    let plate = "settings = { plate.sequence = \"one-by-one\" }\n\
                 [[part]]\nmodel = \"part.rhai\"\ncopies = 2\n\
                 [[part]]\nmodel = \"part.rhai\"\nparams = { w = 30 }\n\
                 at = [30, 40]\nsettings = { walls = 3 }\n";
    fs::write(path.join("plate.toml"), plate).unwrap();
    let args = ["info", "plate.toml", "--printer", "bambu-a1"];
    let text = done(path, &args);
    for line in [
        "  parts       3",
        "  one by one  part_1, part_2, part_3",
        "part, 2 times",
        "  size        30.00 × 8.00 × 6.00 mm",
        "  layers      30 planned",
        "  at          30.00, 40.00 mm  part_3",
    ] {
        assert!(text.lines().any(|l| l == line), "{line}: {text}");
    }
    let json = done(path, &[&args[..], &["--json", "--supports"]].concat());
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert_eq!(json["parts"][1]["places"][0]["at_mm"][1], 40.0);
    assert_eq!(json["order"].as_array().unwrap().len(), 3);
    assert_eq!(json["parts"][0]["needs_support"]["area_mm2"], 0.0);
    // Editors know what such a file may hold.
    let schema = done(path, &["settings", "--schema=plate"]);
    let schema: serde_json::Value = serde_json::from_str(&schema).unwrap();
    let part = &schema["properties"]["part"]["items"]["properties"];
    let keys: Vec<&String> = part.as_object().unwrap().keys().collect();
    let known = [
        "at", "copies", "lay", "model", "params", "rotate", "scale",
        "settings", "size",
    ];
    let mut sorted = keys.clone();
    sorted.sort();
    assert_eq!(sorted, known);
    let of_part = &part["settings"]["properties"];
    assert!(of_part["walls"].is_object() && of_part["support"].is_object());
    // All parts share these.
    for shared in ["printer", "filament", "layer_height"] {
        assert!(of_part[shared].is_null(), "{shared}");
        let of_all = &schema["properties"]["settings"]["properties"][shared];
        assert!(of_all.is_object(), "{shared}");
    }
    assert!(of_part["speed"]["properties"]["travel"].is_null());
    assert!(of_part["speed"]["properties"]["outer_wall"].is_object());
}

/// Names that a shell, an archive or a host could trip over, and many parts.
#[test]
fn hostile_names_and_a_thousand_models_are_bounded() {
    let folder = folder();
    let path = folder.path();
    let names = ["a\"><b", "..%2f", "; M112", "ü 'x' & y", "\u{202e}x"];
    let mut plate = String::new();
    for name in names {
        let file = format!("{name}.rhai");
        let script = "draw(box(#{lower: [0, 0, 0], upper: [2, 2, 1]}));";
        fs::write(path.join(&file), script).unwrap();
        let model = toml::Value::String(file).to_string();
        plate += &format!("[[part]]\nmodel = {model}\n");
    }
    fs::write(path.join("plate.toml"), &plate).unwrap();
    let args = ["slice", "plate.toml", "--printer", "bambu-a1"];
    done(path, &args);
    let said =
        done(path, &["check", "plate.gcode.3mf", "--printer", "bambu-a1"]);
    assert!(said.contains("0 faults"), "{said}");
    done(
        path,
        &["slice", "plate.toml", "--set", "gcode.flavour=klipper"],
    );
    let gcode = fs::read_to_string(path.join("plate.gcode")).unwrap();
    let lines = gcode.lines().map(|l| l.split(';').next().unwrap().trim());
    for line in lines.filter(|line| line.starts_with("EXCLUDE_OBJECT_START")) {
        let name = line.rsplit('=').next().unwrap();
        let plain = |c: char| c.is_ascii_alphanumeric() || c == '_';
        assert!(name.chars().all(plain), "{line}");
    }
    // As many different parts as there may be, and one more.
    let part = |i: usize| {
        format!(
            "[[part]]\nmodel = \"p.rhai\"\nparams = {{ w = {} }}\n",
            1.0 + i as f64 * 1e-4
        )
    };
    let script = "let w = param(\"w\", 1.0);\n\
                  draw(box(#{lower: [0, 0, 0], upper: [w, 1, 0.4]}));\n";
    fs::write(path.join("p.rhai"), script).unwrap();
    let many: String = (0..1001).map(part).collect();
    fs::write(path.join("many.toml"), &many).unwrap();
    let output = isoslice(path).args(["info", "many.toml"]).output().unwrap();
    let told = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(told.contains("at most 1000"), "{told}");
    let many: String = (0..1000).map(part).collect();
    let many = format!("settings = {{ plate.spacing = 1.5 }}\n{many}");
    fs::write(path.join("many.toml"), &many).unwrap();
    done(path, &["slice", "many.toml", "-o", "many.gcode"]);
    let gcode = fs::read_to_string(path.join("many.gcode")).unwrap();
    assert_eq!(gcode.matches(";LAYER_CHANGE").count(), 2);
}

/// What an archive says of itself is what is in it.
#[test]
fn nothing_is_said_to_be_there_that_is_not() {
    let folder = folder();
    let path = folder.path();
    let entries = |name: &str| {
        let file = fs::File::open(path.join(name)).unwrap();
        let mut zip = zip::ZipArchive::new(file).unwrap();
        let mut all = Vec::new();
        for i in 0..zip.len() {
            let mut entry = zip.by_index(i).unwrap();
            let mut bytes = Vec::new();
            entry.read_to_end(&mut bytes).unwrap();
            let text = String::from_utf8_lossy(&bytes).into_owned();
            all.push((entry.name().to_owned(), text));
        }
        all
    };
    let args = ["slice", "-e", BALL, "--printer", "bambu-a1", "--set"];
    let jpg = ["gcode.thumbnails=64x64/JPG", "-o", "jpg.gcode.3mf"];
    done(path, &[&args[..], &jpg].concat());
    let all = entries("jpg.gcode.3mf");
    assert!(!all.iter().any(|(name, _)| name.ends_with(".png")));
    let told = |(name, text): &(String, String)| {
        !name.ends_with(".gcode") && text.contains("plate_1.png")
    };
    assert!(!all.iter().any(told), "{all:?}");
    // Supports of one part are supports; none where nothing needs one.
    fs::write(
        path.join("tee.rhai"),
        "min(max(max(abs(x) - 2, abs(y) - 3), abs(z - 5) - 5), \
         max(max(abs(x) - 9, abs(y) - 3), abs(z - 11) - 1))",
    )
    .unwrap();
    for (name, supports, used) in
        [("with", "auto", "true"), ("without", "off", "false")]
    {
        let plate = format!(
            "[[part]]\nmodel = \"tee.rhai\"\n\
             settings = {{ supports = \"{supports}\", bridge_max = 5 }}\n"
        );
        fs::write(path.join(format!("{name}.toml")), plate).unwrap();
        let (from, to) = (format!("{name}.toml"), format!("{name}.gcode.3mf"));
        done(path, &["slice", &from, "--printer", "bambu-a1", "-o", &to]);
        let all = entries(&to);
        let is =
            |(name, _): &&(String, String)| name.ends_with("slice_info.config");
        let info = &all.iter().find(is).unwrap().1;
        let said = format!("key=\"support_used\" value=\"{used}\"");
        assert!(info.contains(&said), "{name}: {info}");
    }
}
