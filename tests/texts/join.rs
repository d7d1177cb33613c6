//! Files of ranges of layers make the file of a single run, whatever the
//! firmware and the format; and what is no such set of files is refused.

use crate::common;
use crate::common::program::isoslice;
use crate::common::{join, settings, wanted};
use isoslice::model::Model;
use isoslice::pipeline::{Options, slice_plate};
use isoslice::plate::Plate;
use isoslice::{Format, JoinError, split};
use std::fs;
use std::time::{Duration, UNIX_EPOCH};

/// 140 layers, with skin in the middle and islands that come and go.
const PART: &str = "min(max(abs(x) - 7, max(abs(y) - 5, abs(z - 14) - 14)), \
                    max(sqrt((x - 14)^2 + y^2) - 3, abs(z - 20) - 4))";

fn plate_of(text: &str, assignments: &[&str]) -> Plate {
    let (model, settings) = common::part(text, assignments);
    Plate::of(&model, &settings)
}

/// The file of some layers of a plate.
fn file(plate: &Plate, layers: &str, format: Format) -> Vec<u8> {
    let options = Options {
        threads: Some(2),
        layers: layers.parse().unwrap(),
        format,
        timestamp: Some(UNIX_EPOCH + Duration::from_secs(1_700_000_000)),
        ..Options::default()
    };
    let mut out = Vec::new();
    slice_plate(plate, &options, &mut out).unwrap();
    out
}

const RANGES: [&str; 4] = ["1", "2..100", "101..128", "129.."];

#[track_caller]
fn assert_joins(plate: &Plate, format: Format) {
    let whole = file(plate, "..", format);
    let mut files: Vec<Vec<u8>> = RANGES
        .iter()
        .map(|layers| file(plate, layers, format))
        .collect();
    files.rotate_left(1);
    let joined = join(&files).unwrap();
    assert_eq!(whole.len(), joined.len());
    assert!(whole == joined);
}

#[test]
fn every_firmware_and_every_dialect_of_comments() {
    for flavour in ["marlin", "klipper", "rrf", "prusa", "bambu"] {
        for comments in ["prusa", "orca", "cura", "none"] {
            let asked = &[
                &format!("gcode.flavour={flavour}"),
                &format!("gcode.comments={comments}"),
                "gcode.labels=on",
                "gcode.progress=on",
                "gcode.thumbnails=16x16",
                "sample_spacing=0.225",
            ];
            assert_joins(&plate_of(PART, asked), Format::Text);
        }
    }
}

#[test]
fn binary_files_with_pictures_of_every_format() {
    let asked = &[
        "gcode.flavour=prusa",
        "gcode.thumbnails=16x16, 24x20/QOI, 20x20/JPG",
        "sample_spacing=0.225",
    ];
    assert_joins(&plate_of(PART, asked), Format::Binary);
}

/// The end template names what is known at the end only. The firmware retracts
/// by itself, and temperatures depend on the height.
#[test]
fn totals_in_templates() {
    let asked = &[
        "retract.firmware=true",
        "retract.extra_prime=0.03",
        "filament.nozzle_temperature=expr: 200 + z/4",
        "filament.cost=25",
        "sample_spacing=0.225",
        "gcode.end=M117 \"{{ print_time }}\" {{ filament_length }}\n\
         G4 S{{ (print_seconds / 100) | round }}",
        "gcode.layer=M117 {{ layer }} of {{ layer_count }}",
    ];
    let plate = plate_of(PART, asked);
    assert_joins(&plate, Format::Text);
    let text = String::from_utf8(file(&plate, "..", Format::Text)).unwrap();
    assert!(text.contains("\nM117 \""), "{}", &text[text.len() - 900..]);
}

/// Between two pieces of a part only the shield is printed, in several layers.
#[test]
fn a_draft_shield_beside_nothing() {
    let settings =
        settings(&["draft_shield=full", "sample_spacing=0.225", "walls=1"]);
    let pieces = "max(sqrt(x^2 + y^2) - 6, \
                  min(abs(z - 9.5) - 9.5, abs(z - 24.5) - 3.5))";
    let all = [wanted("pieces", pieces, 2, &settings)];
    let plate = Plate::new("both", &all, &settings).unwrap();
    assert_joins(&plate, Format::Text);
}

#[test]
fn plates_of_several_parts() {
    let settings = settings(&[
        "gcode.flavour=klipper",
        "sample_spacing=0.225",
        "infill_density=30",
    ]);
    let all = [
        wanted("bar", PART, 2, &settings),
        wanted("low", "max(sqrt(x^2 + y^2) - 6, abs(z) - 4)", 1, &settings),
    ];
    let plate = Plate::new("both", &all, &settings).unwrap();
    assert_joins(&plate, Format::Text);
}

fn coarse(model: &str, assignments: &[&str], layers: &str) -> Vec<u8> {
    let mut all = vec!["sample_spacing=0.225", "infill_density=0"];
    all.extend(assignments);
    file(&plate_of(model, &all), layers, Format::Text)
}

const BALL: &str = "sqrt(x^2 + y^2 + z^2) - 3";

#[test]
fn gaps_and_overlaps_are_refused() {
    let of = |layers: &str| coarse(BALL, &[], layers);
    let why = |ranges: &[&str]| {
        let files: Vec<Vec<u8>> = ranges.iter().map(|r| of(r)).collect();
        join(&files).unwrap_err()
    };
    let gap = |first, last| {
        move |e: &JoinError| {
            matches!(e, JoinError::Gap { first: f, last: l, count: 30, .. }
            if (*f, *l) == (first, last))
        }
    };
    assert!(gap(11, 20)(&why(&["1..10", "21..30"])));
    assert!(gap(1, 10)(&why(&["11..30"])));
    assert!(gap(30, 30)(&why(&["1..29"])));
    let error = why(&["21..30", "1..10"]).to_string();
    assert!(error.contains("--layers 11..20"), "{error}");
    let overlap = |first, last| {
        move |e: &JoinError| {
            matches!(e, JoinError::Overlap { first: f, last: l, .. }
            if (*f, *l) == (first, last))
        }
    };
    assert!(overlap(10, 10)(&why(&["1..10", "10..30"])));
    assert!(overlap(5, 7)(&why(&["1..20", "5..7", "21..30"])));
    assert!(overlap(1, 10)(&why(&["1..10", "1..10", "11..30"])));
    assert!(matches!(join(&[] as &[Vec<u8>]), Err(JoinError::Nothing)));
}

#[test]
fn other_prints_are_refused() {
    let first = coarse(BALL, &[], "1..10");
    let why = |second: Vec<u8>| match join(&[first.clone(), second]) {
        Err(JoinError::Differs { what, .. }) => what,
        other => panic!("{other:?}"),
    };
    let other = "sqrt(x^2 + y^2 + z^2) - 3.001";
    assert_eq!(why(coarse(other, &[], "11..30")), "model");
    assert_eq!(why(coarse(BALL, &["walls=3"], "11..30")), "settings");
    assert_eq!(
        why(coarse(BALL, &["layer_height=0.21"], "11..")),
        "settings"
    );
    let text = String::from_utf8(coarse(BALL, &[], "11..30")).unwrap();
    // As long as before, so that the manifest is found where it was.
    let version =
        text.replace("\"version\":\"isoslice 0", "\"version\":\"isoslice 9");
    assert!(version != text);
    assert_eq!(why(version.into_bytes()), "version or build of isoslice");
    let binary = file(
        &plate_of(BALL, &["sample_spacing=0.225", "infill_density=0"]),
        "11..30",
        Format::Binary,
    );
    let error = join(&[first.clone(), binary]).unwrap_err();
    assert!(matches!(error, JoinError::Formats { .. }), "{error}");
}

#[test]
fn half_written_and_changed_files_are_refused() {
    let first = coarse(BALL, &[], "1..15");
    let second = coarse(BALL, &[], "16..");
    let whole = coarse(BALL, &[], "..");
    assert!(join(&[&first, &second]).unwrap() == whole);
    // A whole file does not say that it is a range's.
    let error = join(&[&whole]).unwrap_err();
    assert!(matches!(error, JoinError::NoRange(_)), "{error}");
    for k in 0..100 {
        let cut = second.len() * k / 100;
        assert!(join(&[&first[..], &second[..cut]]).is_err(), "{cut}");
        let cut = second.len() - 1 - k;
        assert!(join(&[&first[..], &second[..cut]]).is_err(), "{cut}");
    }
    // Anywhere a digit, a letter or a line is another one.
    let step = second.len() / 150;
    let end = second.len() - 400..second.len();
    for at in (0..second.len()).step_by(step).chain(end) {
        let mut changed = second.clone();
        changed[at] ^= 1;
        assert!(join(&[&first, &changed]).is_err(), "byte {at}");
    }
    let text = String::from_utf8(second.clone()).unwrap();
    let faster = text.replacen(" F9000", " F8000", 1);
    assert!(faster != text);
    let error = join(&[first.as_slice(), faster.as_bytes()]).unwrap_err();
    assert!(matches!(error, JoinError::Changed(_)), "{error}");
    let more = text.clone() + "M117 done\n";
    let error = join(&[first.as_slice(), more.as_bytes()]).unwrap_err();
    assert!(matches!(error, JoinError::NoRange(_)), "{error}");
    // The line ends are those of another system.
    let ends = text.replace('\n', "\r\n");
    assert!(join(&[first.as_slice(), ends.as_bytes()]).is_err());
}

#[test]
fn ranges_begin_with_slabs_and_have_every_layer() {
    let settings = settings(&["sample_spacing=0.225", "layer_height=0.05"]);
    // This part is wide below and thin above.
    let part = "max(sqrt(x^2 + y^2) - 20 + 0.45*z, max(-z, z - 40))";
    let model: Model = common::formula(part, &settings);
    let plate = Plate::of(&model, &settings);
    let shares = split(&plate, 3, Some(2)).unwrap();
    assert_eq!(shares.len(), 3);
    assert_eq!(shares[0].layers.start, 0);
    for pair in shares.windows(2) {
        assert_eq!(pair[0].layers.end, pair[1].layers.start);
        assert_eq!(pair[1].layers.start % 32, 0);
        // Layers above are smaller, so there are more of them.
        assert!(pair[0].layers.len() < pair[1].layers.len() + 32);
    }
    // 40 mm, with a first layer of 0.2 mm.
    assert_eq!(shares[2].layers.end, 797);
    let sum: f64 = shares.iter().map(|share| share.cost).sum();
    assert!((sum - 1.0).abs() < 1e-9);
    assert!(shares[0].layers.len() < 300);
    assert!(shares.iter().all(|share| share.cost < 0.5));
    assert_eq!(shares, split(&plate, 3, Some(1)).unwrap());
    // There are 25 slabs.
    assert_eq!(split(&plate, 40, Some(2)).unwrap().len(), 25);
}

/// The commands are those of docs/large-parts.md.
#[test]
fn on_the_command_line() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let model = "max(sqrt(x^2 + y^2) - 4, max(-z, z - 28))";
    let of = |command: &str, more: &[&str]| {
        let words = [
            command,
            "-e",
            model,
            "--set",
            "sample_spacing=0.225",
            "--set",
            "gcode.thumbnails=",
        ];
        let out = isoslice(folder)
            .args([&words[..], more].concat())
            .output()
            .unwrap();
        let error = String::from_utf8_lossy(&out.stderr).into_owned();
        assert!(out.status.success(), "{error}");
        (String::from_utf8(out.stdout).unwrap(), error)
    };
    let (ranges, warning) = of("split", &["--parts", "8"]);
    assert_eq!(ranges, "1..32\n33..64\n65..96\n97..128\n129..140\n");
    assert!(warning.contains("which make 5 ranges, not 8"), "{warning}");
    let (json, _) = of("split", &["--parts", "2", "--json"]);
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert_eq!(json["ranges"][1]["first_layer"], 65);
    of("slice", &["-o", "whole.gcode"]);
    for (k, range) in ranges.lines().enumerate() {
        let name = format!("part.{k}.gcode");
        of("slice", &["--layers", range, "-o", &name]);
    }
    let join = |args: &[&str]| {
        let out = isoslice(folder)
            .args([&["join"], args].concat())
            .output()
            .unwrap();
        let text = String::from_utf8_lossy(&out.stdout).into_owned()
            + &String::from_utf8_lossy(&out.stderr);
        (out.status.code(), text)
    };
    let files = [4, 1, 0, 2, 3].map(|k| format!("part.{k}.gcode"));
    let files: Vec<&str> = files.iter().map(String::as_str).collect();
    let (code, text) = join(&[&files[..], &["-o", "joined.gcode"]].concat());
    assert_eq!(code, Some(0), "{text}");
    assert!(
        text.starts_with("joined.gcode: 140 layers of 5 files"),
        "{text}"
    );
    let read = |name: &str| fs::read(folder.join(name)).unwrap();
    assert!(read("joined.gcode") == read("whole.gcode"));
    // An input is no output, and no other format is promised.
    let (code, text) = join(&[&files[..], &["-o", "part.0.gcode"]].concat());
    assert_eq!(code, Some(1), "{text}");
    let (code, text) = join(&[&files[..], &["-o", "joined.bgcode"]].concat());
    assert_eq!(code, Some(1), "{text}");
    assert!(text.contains("ends in .gcode"), "{text}");
    assert!(!folder.join("joined.bgcode").exists());
    let (code, text) = join(&["part.0.gcode", "-o", "new.gcode"]);
    assert_eq!(code, Some(1), "{text}");
    assert!(
        text.contains("layers 33 to 140 of 140 are missing"),
        "{text}"
    );
    assert!(!folder.join("new.gcode").exists());
    let (code, text) = join(&["whole.gcode", "-o", "new.gcode"]);
    assert_eq!(code, Some(1), "{text}");
}
