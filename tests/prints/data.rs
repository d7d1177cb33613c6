//! Drawings, text, pictures, volumes and samples in models.

use crate::common::{
    OUTER_WALL, formula, parse, placed, settings, slice, slice_layers,
};
use isoslice::model::{Placement, Source, load};
use std::fs;
use std::path::Path;
use tempfile::TempDir;

/// A folder with a drawing, a picture and samples.
fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, bytes: &[u8]| {
        fs::write(folder.path().join(name), bytes).unwrap();
    };
    // A block of 30 × 20 mm with a round hole in its middle.
    let drawing = "<svg xmlns='http://www.w3.org/2000/svg' width='40mm' \
        height='30mm' viewBox='0 0 40 30'><path fill-rule='evenodd' \
        d='M5 5H35V25H5Z M14 15a6 6 0 1 0 12 0a6 6 0 1 0-12 0'/></svg>";
    write("logo.svg", drawing.as_bytes());
    let plate = "0 SECTION 2 ENTITIES 0 LWPOLYLINE 8 a 70 1 10 5 20 5 10 35 \
        20 5 10 35 20 25 10 5 20 25 0 CIRCLE 8 b 10 20 20 15 40 6 \
        0 LINE 8 open 10 1 20 2 11 3 21 4 0 ENDSEC 0 EOF";
    write("plate.dxf", plate.replace(' ', "\n").as_bytes());
    // A ramp from black to white in 11 columns.
    let mut picture = Vec::new();
    let mut encoder = png::Encoder::new(&mut picture, 11, 2);
    encoder.set_color(png::ColorType::Grayscale);
    let mut writer = encoder.write_header().unwrap();
    let row: Vec<u8> = (0..11).map(|k| k * 25).collect();
    writer.write_image_data(&[&row[..], &row].concat()).unwrap();
    drop(writer);
    write("ramp.png", &picture);
    let mut samples = "x,y,z,stress\n".to_owned();
    for k in 0..64 {
        let [x, y, z] = [k % 4, k / 4 % 4, k / 16].map(|n| n * 4);
        samples += &format!("{x},{y},{z},{}\n", x + 2 * y);
    }
    write("stress.csv", samples.as_bytes());
    folder
}

fn script(folder: &Path, text: &str) -> Source {
    let path = folder.join("part.rhai");
    fs::write(&path, text).unwrap();
    Source::File(path)
}

/// The length of the outer walls of each layer, mm.
fn outer(gcode: &str) -> Vec<f64> {
    let layers = parse(gcode);
    layers.iter().map(|l| l.length(OUTER_WALL)).collect()
}

#[test]
fn data_prints_as_the_formula_of_the_same_function() {
    let folder = folder();
    let settings = settings(&[]);
    let hole = "max(max(abs(x-20)-15, abs(y-15)-10), 6-hypot(x-20, y-15))";
    for (text, same, within) in [
        (
            "max(svg(\"logo.svg\"), abs(z - 2) - 2)",
            format!("max({hole}, abs(z-2)-2)"),
            0.001,
        ),
        (
            "max(dxf(\"plate.dxf\", #{ layers: [\"a\", \"b\"] }), \
             abs(z - 2) - 2)",
            format!("max({hole}, abs(z-2)-2)"),
            0.001,
        ),
        // The box around what is drawn gets the width, and its middle the
        // origin.
        (
            "max(svg(\"logo.svg\", #{ width: 60, anchor: \"centre\" }), \
             abs(z - 2) - 2)",
            "max(max(max(abs(x)-30, abs(y)-20), 12-hypot(x, y)), abs(z-2)-2)"
                .to_owned(),
            0.001,
        ),
        // Between the middles of the outermost pixels, 5 and 105 mm, a ramp.
        (
            "let ramp = image(\"ramp.png\", #{ width: 110 });\n\
             max(max(abs(x - 55) - 20, abs(y) - 6), \
             max(-z, z - 1 - 4 * ramp))",
            "max(max(abs(x-55)-20, abs(y)-6), max(-z, z-1-4*25/255*(x-5)/10))"
                .to_owned(),
            0.01,
        ),
        (
            "max(max(abs(x - 6) - 5, abs(y - 6) - 5), \
             max(-z, z - 2 - samples(\"stress.csv\") / 10))",
            "max(max(abs(x-6)-5, abs(y-6)-5), max(-z, z-2-(x+2*y)/10))"
                .to_owned(),
            0.01,
        ),
    ] {
        let none = Placement::default();
        let source = script(folder.path(), text);
        let data = placed(&source, &[], &none, &settings);
        let data = outer(&slice(&data, &settings, 2).0);
        let same = outer(&slice(&formula(&same, &settings), &settings, 2).0);
        assert_eq!(data.len(), same.len(), "{text}");
        for (k, (a, b)) in data.iter().zip(&same).enumerate() {
            assert!(
                (a - b).abs() < within * (1.0 + b),
                "{k}: {a}, {b}\n{text}"
            );
        }
    }
}

#[test]
fn letters_stand_on_a_plate() {
    let folder = folder();
    let settings = settings(&[]);
    let text = "let plate = box([-20, -8, 0], [20, 8, 2]);\n\
        let o = text(\"IO\", #{ size: 12, align: \"centre\", \
        vertical: \"centre\" });\n\
        union([plate, max(o, abs(z - 2) - 2)])";
    let source = script(folder.path(), text);
    let model = placed(&source, &[], &Placement::default(), &settings);
    let (gcode, summary) = slice(&model, &settings, 2);
    assert_eq!(summary.warnings, Vec::<String>::new());
    let walls = outer(&gcode);
    // 40 × 16 mm; then an I and both borders of an O, 8.75 mm high.
    assert!((walls[5] - 110.4).abs() < 1.0, "{walls:?}");
    assert!(walls[15] > 45.0 && walls[15] < 75.0, "{walls:?}");
}

/// A drawing alone has no height of its own.
#[test]
fn a_drawing_is_flat() {
    let folder = folder();
    let settings = settings(&[]);
    let source = script(folder.path(), "svg(\"logo.svg\")");
    let flat = load(&source, &[]).unwrap();
    assert!(isocontour::is_flat(&flat.tree).unwrap());
    let high = Placement {
        height: Some(3.0),
        size: Some(60.0),
        ..Placement::default()
    };
    let model = placed(&source, &[], &high, &settings);
    let size = model.bounds.size();
    assert!(
        (size - glam::dvec3(60.0, 40.0, 3.0)).length() < 1e-3,
        "{size}"
    );
}

#[test]
fn wrong_options_are_errors_with_what_is_right() {
    let folder = folder();
    for (text, words) in [
        ("svg(\"logo.svg\", #{ widht: 3 })", "did you mean width?"),
        ("svg(\"logo.svg\", #{ width: \"3\" })", "width is a number"),
        ("svg(\"logo.svg\", #{ anchor: \"top\" })", "one of \"page\""),
        ("mesh(\"logo.svg\")", "meshes are .stl"),
        (
            "dxf(\"plate.dxf\", #{ layers: 3 })",
            "a list of texts, not 3",
        ),
        (
            "dxf(\"plate.dxf\", #{ layers: \"hole\" })",
            "plate.dxf: it has no layer `hole`; it has `a`, `b`, `open`",
        ),
        (
            "dxf(\"plate.dxf\")",
            "plate.dxf: an outline ends at x = 1, y = 2 mm (line",
        ),
        ("dxf(\"logo.svg\")", "logo.svg: line 1: `<svg"),
        ("mesh(\"a.stl\", #{ unit: 1 })", "cannot read"),
        ("image(\"logo.svg\")", "logo.svg"),
        (
            "image(\"ramp.png\", #{ border: [\"clamp\"] })",
            "list of 2 words",
        ),
        (
            "volume(\"ramp.png\", #{ spacing: [1, 2] })",
            "a list of three",
        ),
        (
            "image(\"ramp.png\", #{ of: \"transparency\", paper: 0.3 })",
            "paper is what shows through",
        ),
        ("text(\"a\", #{ font: \"ramp.png\" })", "(font: "),
        ("text(\" \")", "text: it has no letter"),
        ("text(12)", "takes a text, as in text("),
        ("svg(x)", "takes a file's name"),
        (
            "text(\"a\", #{ font: \"../a.ttf\" })",
            "only what lies there",
        ),
        ("samples(\"stress.csv\", #{ column: \"strain\" })", "strain"),
    ] {
        let error = load(&script(folder.path(), text), &[]).err();
        let error = error.unwrap_or_else(|| panic!("{text}")).to_string();
        assert!(error.contains(words), "{text}: {error}");
    }
}

/// What the page on data shows is printed, all of it on two layers in ten.
#[test]
fn the_examples_are_parts() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/data");
    let settings = settings(&[
        "sample_spacing=0.225",
        "accuracy=0.05",
        "layer_height=0.3",
    ]);
    for (name, height) in [
        ("filled-pawn", 27.0),
        ("stressed-beam", 16.0),
        ("scanned-bone", 26.0),
        ("tag", 3.2),
    ] {
        let source = Source::File(folder.join(format!("{name}.rhai")));
        let model = placed(&source, &[], &Placement::default(), &settings);
        let found = model.bounds.size().z;
        assert!((found - height).abs() < 1e-3, "{name}: {found}");
        let (gcode, summary) = slice_layers(&model, &settings, "6..7", 2);
        assert_eq!(parse(&gcode).len(), 2, "{name}");
        assert!(outer(&gcode).iter().all(|l| *l > 20.0), "{name}");
        assert_eq!(summary.warnings, Vec::<String>::new(), "{name}");
    }
}
