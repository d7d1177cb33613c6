//! The preview and the G-code reader, as a user meets them: our own files are
//! read back, and pages made by the real program.
//!
//! What a browser makes of a page is tested by `tests/browser/run.sh`.

use crate::program::isoslice;
use isoslice::preview::Toolpath;
use isoslice::reader::{Event, Reader, Role};
use isoslice::settings::Builder;
use predicates::prelude::*;
use predicates::str::{contains, is_empty};
use std::f64::consts::PI;
use std::fs;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// A cylinder of 10 mm and 3 mm height.
const CYLINDER: &str = "max(sqrt(x^2 + y^2) - 5, abs(z - 1.5) - 1.5)";

fn data(name: &str) -> PathBuf {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    root.join("tests/data").join(name)
}

fn sliced(folder: &TempDir, options: &[&str]) -> String {
    isoslice(folder)
        .args(["slice", "-e", CYLINDER, "-o", "c.gcode", "-q"])
        .args(options)
        .assert()
        .success();
    fs::read_to_string(folder.path().join("c.gcode")).unwrap()
}

fn toolpath(text: &str) -> Toolpath {
    Toolpath::read(Reader::new(text.as_bytes())).unwrap()
}

#[test]
fn our_own_files_are_read_as_they_were_meant() {
    let folder = tempfile::tempdir().unwrap();
    for flavour in ["marlin", "klipper"] {
        let option = format!("gcode.flavour={flavour}");
        let text = sliced(&folder, &["--set", &option]);
        let mut reader = Reader::new(text.as_bytes());
        let (mut outer, mut layers) = (Vec::new(), 0);
        for event in reader.by_ref() {
            match event.unwrap() {
                Event::Move(step) if step.prints() => {
                    assert_ne!(step.role, Role::Unknown, "{step:?}");
                    // What comments say of the bead is what the filament
                    // makes: (w − h)·h + π(h/2)².
                    let (w, h) = (step.width, step.height);
                    let bead = (w - h) * h + PI * h * h / 4.0;
                    let volume = bead * step.length();
                    let fed = step.filament * filament_area(1.75);
                    // Half a unit of the last decimal, 1e-5 mm of filament,
                    // at both ends, and a width told in 1e-4 mm.
                    let slack =
                        1e-5 * filament_area(1.75) + 1e-4 * h * step.length();
                    // Widths that change by less than 4 % on the way are not
                    // told, but where they are the part's edge.
                    let untold = match step.role {
                        Role::OuterWall => 0.0,
                        _ => 0.04 * w * h * step.length(),
                    };
                    let slack = slack + untold;
                    assert!((volume - fed).abs() < slack, "{step:?}");
                    if step.role == Role::OuterWall {
                        outer.push(step);
                    }
                }
                Event::Layer { number, .. } => {
                    layers += 1;
                    assert_eq!(number, layers);
                }
                Event::Problem { line, problem } => {
                    panic!("line {line}: {problem}");
                }
                _ => {}
            }
        }
        assert_eq!(layers, 15);
        // A ring of 10 mm less a width, in each of 15 layers; chords of
        // 5 µm accuracy. It ends 0.087 mm early, as a way leads to its beginning.
        let length: f64 = outer.iter().map(|m| m.length()).sum();
        let expected = 15.0 * (PI * (10.0 - outer[0].width) - 0.087);
        assert!((length / expected - 1.0).abs() < 2e-3, "{length}");
        assert!(reader.info().generator.as_deref().is_some_and(|name| {
            name == concat!("isoslice ", env!("CARGO_PKG_VERSION"))
        }));
    }
}

#[test]
fn figures_of_our_own_files_agree_with_the_slicer() {
    let folder = tempfile::tempdir().unwrap();
    let text = sliced(&folder, &["--set", "skirt.loops=0"]);
    let path = toolpath(&text);
    let s = path.statistics();
    // The comments at the end of the file, by the writer itself.
    let said = |key: &str| -> f64 {
        let start = format!("; {key} = ");
        let line = text.lines().find_map(|l| l.strip_prefix(&start));
        line.unwrap().parse().unwrap()
    };
    // The last retraction is not primed again.
    let filament = said("filament used [mm]");
    assert!((s.filament - filament).abs() < 2.0, "{}", s.filament);
    let volume: f64 = s.roles.iter().map(|r| r.volume).sum();
    let expected = filament * filament_area(1.75);
    assert!((volume / expected - 1.0).abs() < 0.01, "{volume}");
    // The time is estimated from the moves alone, with the accelerations of the
    // file.
    assert!(
        (s.time / s.said_time.unwrap() - 1.0).abs() < 0.05,
        "{}",
        s.time
    );
    // 10 mm across and 3 mm high, to 10 µm.
    let [min, max] = s.part.unwrap();
    for (axis, size) in [10.0, 10.0, 3.0].into_iter().enumerate() {
        assert!((max[axis] - min[axis] - size).abs() < 0.01, "{axis}");
    }
}

#[test]
fn other_slicers_files_are_read() {
    let cura = fs::read_to_string(data("cura.gcode")).unwrap();
    let cura = toolpath(&cura);
    assert_eq!(cura.layer_count(), 4);
    assert_eq!(cura.statistics().said_time, Some(93.0));
    // Four rings of 4 · 19.6 mm.
    let share =
        |path: &Toolpath, role: Role| path.statistics().roles[role as usize];
    let outer = share(&cura, Role::OuterWall);
    assert!((outer.length - 4.0 * 4.0 * 19.6).abs() < 1e-6);
    assert_eq!(outer.moves, 16);
    // The purge before the first layer has no part in the size.
    assert!((share(&cura, Role::Custom).length - 50.0).abs() < 1e-6);
    assert_eq!(share(&cura, Role::Unknown).moves, 0);
    let [min, max] = cura.statistics().part.unwrap();
    // No width is written there: it follows from the filament.
    assert!((max[0] - min[0] - 20.02).abs() < 0.01);

    let orca = fs::read_to_string(data("orca.gcode")).unwrap();
    let orca = toolpath(&orca);
    assert_eq!(orca.layer_count(), 3);
    assert_eq!(orca.statistics().said_time, Some(125.0));
    // Three circles of 10 mm radius, as arcs; chords within 10 µm.
    let outer = share(&orca, Role::OuterWall).length;
    assert!((outer / (3.0 * 2.0 * PI * 10.0) - 1.0).abs() < 1e-3);
    for role in [Role::TopSkin, Role::BottomSkin, Role::SparseInfill] {
        assert!(share(&orca, role).length > 100.0, "{role:?}");
    }
}

#[test]
fn a_page_is_written_beside_the_file_and_is_the_same_each_time() {
    let folder = tempfile::tempdir().unwrap();
    fs::copy(data("cura.gcode"), folder.path().join("part.gcode")).unwrap();
    isoslice(&folder)
        .args(["preview", "part.gcode"])
        .assert()
        .success()
        .stdout(contains("part.html").and(contains("Cura SteamEngine 5.9.0")))
        .stderr(is_empty());
    let page = fs::read_to_string(folder.path().join("part.html")).unwrap();
    assert!(page.contains("<title>part.gcode</title>"));
    let mut expected = Vec::new();
    let text = fs::read_to_string(data("cura.gcode")).unwrap();
    toolpath(&text)
        .write_html(&mut expected, "part.gcode")
        .unwrap();
    assert!(page.into_bytes() == expected);
    // Read from standard input, the file differs in its name only.
    isoslice(&folder)
        .args(["preview", "-", "-o", "piped.html", "-q"])
        .pipe_stdin(folder.path().join("part.gcode"))
        .unwrap()
        .assert()
        .success()
        .stdout(is_empty());
    let piped = fs::read(folder.path().join("piped.html")).unwrap();
    let mut expected = Vec::new();
    toolpath(&text)
        .write_html(&mut expected, "preview")
        .unwrap();
    assert!(piped == expected);
}

#[test]
fn a_model_is_sliced_first() {
    let folder = tempfile::tempdir().unwrap();
    let text = sliced(&folder, &["--set", "walls=3"]);
    isoslice(&folder)
        .args(["preview", "-e", CYLINDER, "--set", "walls=3", "-q"])
        .assert()
        .success();
    let page = fs::read(folder.path().join("formula.html")).unwrap();
    let mut expected = Vec::new();
    // The settings know the bed; no file of ours tells it.
    let path = toolpath(&text).with_settings(Builder::new().settings());
    path.write_html(&mut expected, "formula").unwrap();
    assert!(page == expected);
}

#[test]
fn the_parts_of_a_plate_file_are_sliced_first() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(
        folder.path().join("rod.rhai"),
        "max(sqrt(x*x + y*y) - 4, abs(z - 1) - 1)",
    )
    .unwrap();
    let plate = "[[part]]\nmodel = \"rod.rhai\"\ncopies = 3\n";
    fs::write(folder.path().join("plate.toml"), plate).unwrap();
    isoslice(&folder)
        .args(["preview", "plate.toml", "-q"])
        .assert()
        .success();
    assert!(folder.path().join("plate.html").exists());
    // A model of the plate is not written over.
    isoslice(&folder)
        .args(["preview", "plate.toml", "-q", "-o", "rod.rhai"])
        .assert()
        .failure();
    isoslice(&folder)
        .args(["preview", "plate.toml", "-q", "-D", "r=1"])
        .assert()
        .failure()
        .stderr(contains("is a plate file"));
}

#[test]
fn mistakes_are_explained_and_leave_nothing_behind() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    fs::write(at("poem.gcode"), "Roses are red,\nviolets are blue\n").unwrap();
    fs::write(at("part.bgcode"), b"GCDE\x01\x00\x00\x00").unwrap();
    fs::write(at("odd.gcode"), "G1 X Y5\nG1 X5 E1\nG1 X1 %\n").unwrap();
    for (args, message) in [
        (&["preview", "none.gcode"][..], "cannot read none.gcode"),
        (&["preview", "poem.gcode"], "poem.gcode prints nothing"),
        (&["preview", "part.bgcode"], "binary G-code"),
        (&["preview", "part.step"], "is a drawing"),
        (&["preview", "odd.gcode", "--size", "9"], "for models"),
        (&["preview", "odd.gcode", "--set", "walls=1"], "for models"),
        (
            &["preview", "odd.gcode", "-o", "odd.gcode"],
            "also an input",
        ),
    ] {
        isoslice(&folder)
            .args(args)
            .assert()
            .code(1)
            .stderr(contains(message));
    }
    let pages = fs::read_dir(folder.path()).unwrap().flatten();
    assert_eq!(pages.count(), 3);
    // What is passed over is said, once for each kind, with its line.
    isoslice(&folder)
        .args(["preview", "odd.gcode", "-q"])
        .assert()
        .success()
        .stderr(
            contains("odd.gcode:1: X without a number")
                .and(contains("odd.gcode:3: characters that are no command")),
        );
}

/// Cross-section of a filament.
fn filament_area(diameter: f64) -> f64 {
    0.25 * std::f64::consts::PI * diameter * diameter
}
