//! Models as 3MF files whose shape is a function: the program slices them as it
//! slices the models.

use crate::program::isoslice;
use predicates::prelude::*;
use predicates::str::contains;
use std::fs;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

fn folder() -> TempDir {
    tempfile::tempdir().unwrap()
}

fn example(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("examples")
        .join(name)
}

/// The G-code of the lowest layers.
fn gcode(folder: &TempDir, args: &[&str]) -> Vec<u8> {
    let output = isoslice(folder)
        .args(["slice", "-q", "--layers", "1..20", "-o", "-"])
        .args(args)
        .assert()
        .success();
    output.get_output().stdout.clone()
}

/// Compared are whole files but for the fingerprint of the range, which depends on
/// the order of the operations.
#[track_caller]
fn comes_back(name: &str, args: &[&str]) {
    let folder = folder();
    let model = example(name);
    let stem = model.file_stem().unwrap().to_str().unwrap();
    let model = model.to_str().unwrap();
    let file = format!("{stem}.3mf");
    isoslice(&folder)
        .args(["export", model, "-o", &file])
        .args(args)
        .assert()
        .success()
        .stdout("");
    let wanted = gcode(&folder, &[&[model], args].concat());
    let found = gcode(&folder, &[&file]);
    let lines = |bytes: &[u8]| -> Vec<String> {
        let text = String::from_utf8_lossy(bytes);
        let moves = text.split("; {\"fingerprint").next().unwrap_or_default();
        let all = moves.lines().filter(|l| !l.starts_with("; range of: "));
        all.map(str::to_owned).collect()
    };
    let (wanted, found) = (lines(&wanted), lines(&found));
    assert!(wanted.len() > 500);
    for (i, (a, b)) in wanted.iter().zip(&found).enumerate() {
        assert_eq!(a, b, "{name}, line {}", i + 1);
    }
    assert_eq!(wanted.len(), found.len());
}

#[test]
fn exported_models_are_sliced_to_the_same_gcode() {
    comes_back("gear.rhai", &[]);
    comes_back("knurled-knob.rhai", &[]);
    // Its bounds are found by a search.
    comes_back("twisted-vase.rhai", &[]);
}

/// Bounds that a search finds may differ by less than what can be printed, and the
/// places of all beads with them.
#[test]
fn turned_and_scaled_models_are_exported_so() {
    let folder = folder();
    let model = example("knurled-knob.rhai");
    let model = model.to_str().unwrap();
    let placed = ["--size", "20", "--rotate-x", "30", "--rotate-z", "20"];
    isoslice(&folder)
        .args(["export", model, "-o", "knob.3mf"])
        .args(placed)
        .assert()
        .success();
    let used = |args: &[&str]| -> f64 {
        let text = String::from_utf8(gcode(&folder, args)).unwrap();
        let line = text
            .lines()
            .find_map(|line| line.strip_prefix("; filament used [mm] = "));
        line.unwrap().parse().unwrap()
    };
    let wanted = used(&[&[model], &placed[..]].concat());
    let found = used(&["knob.3mf"]);
    assert!(wanted > 10.0, "{wanted}");
    assert!((found / wanted - 1.0).abs() < 1e-3, "{found} {wanted}");
}

/// A mesh goes along as triangles.
#[test]
fn meshes_go_along() {
    comes_back("data/pawn.stl", &["--size", "30"]);
    comes_back("data/filled-pawn.rhai", &[]);
}

#[test]
fn files_are_named_after_the_model() {
    let folder = folder();
    let has = |name: &str| folder.path().join(name).is_file();
    fs::write(
        folder.path().join("a.rhai"),
        "abs(x).max(y.abs()).max(z.abs()) - 4",
    )
    .unwrap();
    isoslice(&folder)
        .args(["export", "a.rhai"])
        .assert()
        .success();
    assert!(has("a.3mf"));
    isoslice(&folder)
        .args(["export", "-e", "x^2 + y^2 + z^2 - 9"])
        .assert()
        .success();
    assert!(has("formula.3mf"));
    let streamed = isoslice(&folder)
        .args(["export", "a.rhai", "-o", "-"])
        .assert()
        .success();
    let bytes = fs::read(folder.path().join("a.3mf")).unwrap();
    assert!(streamed.get_output().stdout == bytes);
}

/// `part.3mf` is the default name for `part.rhai`, and may be what it reads.
#[test]
fn files_that_the_model_reads_are_not_replaced() {
    let folder = folder();
    let path = |name: &str| folder.path().join(name);
    let ball = "sqrt(x^2 + y^2 + z^2) - 9";
    isoslice(&folder)
        .args(["export", "-e", ball, "-o", "part.3mf"])
        .assert()
        .success();
    let data = fs::read(path("part.3mf")).unwrap();
    fs::write(path("part.rhai"), "mesh(\"part.3mf\")").unwrap();
    let formula = "mesh(\"part.3mf\") - 1";
    let cases: [&[&str]; 3] = [
        &["part.rhai", "--size", "20"],
        &["-e", formula, "-o", "./part.3mf"],
        &["part.3mf"],
    ];
    for args in cases {
        isoslice(&folder)
            .arg("export")
            .args(args)
            .assert()
            .code(1)
            .stderr(contains("part.3mf is also an input"));
        assert!(fs::read(path("part.3mf")).unwrap() == data, "{args:?}");
    }
    isoslice(&folder)
        .args(["export", "part.rhai", "--size", "20", "-o", "other.3mf"])
        .assert()
        .success();
}

/// It does not matter how large a printer is.
#[test]
fn parts_of_any_size_are_exported() {
    isoslice(&folder())
        .args(["export", "-e", "sqrt(x^2 + y^2 + z^2) - 900"])
        .assert()
        .success();
}

#[test]
fn what_cannot_be_exported_leaves_the_old_file() {
    let folder = folder();
    let write = |name: &str, text: &str| {
        fs::write(folder.path().join(name), text).unwrap();
    };
    write("old.3mf", "old");
    write("plate.toml", "");
    let ball = "sqrt(x^2 + y^2 + z^2) - 9";
    let chance = format!("{ball} + rand(x)");
    let cases: [(&[&str], &str); 7] = [
        (&["-e", &chance, "-o", "old.3mf"], "it calls rand"),
        (&["-e", ball, "-o", "old.stl"], "name it FILE.3mf"),
        (&["-e", ball, "-o", "old.gcode.3mf"], "name it FILE.3mf"),
        (&["-e", ball, "-o", "no/a.3mf"], "there is no folder no"),
        (
            &["-e", ball, "-o", "old.3mf", "--at=1,1"],
            "--at is for printing",
        ),
        (&["plate.toml", "-o", "old.3mf"], "is a plate file"),
        (&["old.3mf", "-o", "new.3mf"], "archive is damaged"),
    ];
    for (args, why) in cases {
        isoslice(&folder)
            .arg("export")
            .args(args)
            .assert()
            .code(1)
            .stderr(contains(why));
        let left = fs::read_to_string(folder.path().join("old.3mf"));
        assert_eq!(left.unwrap(), "old");
    }
    let drawing = example("data/tag.rhai");
    isoslice(&folder)
        .args(["export", drawing.to_str().unwrap(), "-o", "tag.3mf"])
        .assert()
        .code(1)
        .stderr(contains("it reads text(").or(contains("it reads svg(")));
    assert!(!folder.path().join("tag.3mf").exists());
}
