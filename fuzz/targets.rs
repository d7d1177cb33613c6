//! What is fuzzed: one function per kind of input that may come from a
//! stranger. None of them may panic, whatever the bytes; what else must hold
//! is asserted.
//!
//! The fuzzer's programs include this file, and so does
//! `tests/fuzz_replay.rs`, which runs each function over its seeds.

#[path = "data.rs"]
mod data;

use glam::DVec3;
use isocontour::{Cancel, SearchOptions, find_bounds};
use isoslice::check::{Rules, check};
use isoslice::model::{
    Bounds, BuildVolume, LoadError, Placement, ScriptError, ScriptLimits,
    Source, SourceKind, load_within, parse_vm, place,
};
use isoslice::pipeline::{self, Options};
use isoslice::preview::Toolpath;
use isoslice::reader::{Event, Reader};
use isoslice::settings::Builder;
use slicerprofile::Place;
use std::time::Duration;

/// A target with its name: that of its folder of seeds.
pub type Target = (&'static str, fn(&[u8]));

/// Every target.
pub const TARGETS: [Target; 11] = [
    ("vm", vm),
    ("rhai", rhai),
    ("formula", formula),
    ("settings", settings),
    ("template", template),
    ("slice", slice),
    ("gcode", gcode),
    ("mesh", mesh),
    ("drawing", drawing),
    ("picture", picture),
    ("threemf", threemf),
];

/// Loads a model as far as its bounds, with little effort.
fn model(kind: SourceKind, text: &str) {
    let source = Source::Text {
        name: "fuzz".into(),
        kind,
        text: text.into(),
    };
    let limits = ScriptLimits {
        operations: 20_000,
        time: Duration::from_secs(2),
        memory_bytes: 192 << 20,
    };
    match load_within(&source, &[], &limits) {
        Ok(loaded) => {
            let options = SearchOptions {
                max_work: 200_000,
                ..SearchOptions::default()
            };
            if let Ok(found) =
                find_bounds(&loaded.tree, &options, &Cancel::NEVER)
            {
                assert!(found.bounds.min.is_finite());
                assert!(found.bounds.max.is_finite());
                assert!(found.bounds.size().min_element() >= 0.0);
            }
        }
        Err(LoadError::Script { error, .. }) => {
            assert!(!matches!(*error, ScriptError::Bug { .. }), "{error}");
        }
        Err(_) => {}
    }
}

/// fidget's text format, valid UTF-8 or not.
pub fn vm(data: &[u8]) {
    let lines = data.iter().filter(|b| **b == b'\n').count() + 1;
    if let Err(error) = parse_vm(data) {
        assert!((1..=lines).contains(&error.line), "{error}");
    }
    if let Ok(text) = std::str::from_utf8(data) {
        model(SourceKind::Vm, text);
    }
}

/// Scripts, up to the shape they describe.
pub fn rhai(data: &[u8]) {
    if let Ok(text) = std::str::from_utf8(data) {
        model(SourceKind::Script, text);
    }
}

/// Formulas, of models and of settings.
pub fn formula(data: &[u8]) {
    let Ok(text) = std::str::from_utf8(data) else {
        return;
    };
    model(SourceKind::Formula, text);
    let mut builder = Builder::new();
    // Refused or not: it must come back.
    let _ = builder.set(&format!("flow=expr: {text}"));
}

/// TOML settings: what is accepted can be written and read back.
pub fn settings(data: &[u8]) {
    let Ok(text) = std::str::from_utf8(data) else {
        return;
    };
    let mut builder = Builder::new();
    if builder.toml("fuzz", text).is_err() {
        return;
    }
    let Ok((settings, _)) = builder.finish() else {
        return;
    };
    let written = settings.to_toml();
    let mut again = Builder::new();
    if let Err(error) = again.toml("again", &written) {
        panic!("{error}: {written}");
    }
    assert_eq!(again.settings().to_toml(), written);
}

/// Placeholders of the start template, as they are and as imports translate
/// them.
pub fn template(data: &[u8]) {
    let Ok(text) = std::str::from_utf8(data) else {
        return;
    };
    let own = |name: &str| isoslice::is_placeholder("gcode.start", name);
    let ours = slicerprofile::translated(text, Place::Start, &own);
    for text in [Some(text.to_owned()), ours.ok()].into_iter().flatten() {
        start(&text);
    }
}

/// A part with a start template.
fn start(text: &str) {
    let source = Source::formula("fuzz", "max(abs(x), abs(y), abs(z)) - 0.6");
    let bed = BuildVolume {
        x: 9.0,
        y: 9.0,
        z: 9.0,
    };
    let mut builder = Builder::new();
    if builder.set(&format!("gcode.start={text}")).is_err() {
        return;
    }
    let settings = builder.settings().clone();
    let Ok(cube) = load_within(&source, &[], &ScriptLimits::default()) else {
        return;
    };
    let Ok(cube) = place(&cube, &Placement::default(), bed) else {
        return;
    };
    // Refused or not: it must come back.
    let _ =
        pipeline::slice(&cube, &settings, &Options::default(), &mut Vec::new());
}

/// A formula in a small box, sliced: whatever the field is, G-code or an
/// error.
pub fn slice(data: &[u8]) {
    let Ok(text) = std::str::from_utf8(data) else {
        return;
    };
    let source = Source::formula("fuzz", text);
    let Ok(loaded) = load_within(&source, &[], &ScriptLimits::default()) else {
        return;
    };
    if loaded.expression_size > 200 {
        return;
    }
    let mut builder = Builder::new();
    for assignment in [
        "sample_spacing=0.25",
        "layer_height=0.4",
        "first_layer_height=0.4",
        "outer_wall_width=0.5",
        "printer.nozzle_diameter=0.5",
        // The picture takes longer than all the rest.
        match data.len() % 16 {
            0 => "gcode.thumbnails=16x16",
            _ => "gcode.thumbnails=",
        },
    ] {
        if let Err(error) = builder.set(assignment) {
            panic!("{error}");
        }
    }
    let settings = builder.settings();
    let placement = Placement {
        bounds: Some(Bounds {
            min: DVec3::splat(-3.0),
            max: DVec3::splat(3.0),
        }),
        ..Placement::default()
    };
    let volume = BuildVolume::of(settings);
    let Ok(model) = place(&loaded, &placement, volume) else {
        return;
    };
    let options = Options {
        threads: Some(1),
        ..Options::default()
    };
    let mut gcode = Vec::new();
    if pipeline::slice(&model, settings, &options, &mut gcode).is_ok() {
        let text = String::from_utf8_lossy(&gcode);
        assert!(!text.contains("NaN") && !text.contains("inf "), "{text}");
    }
}

/// G-code of anybody's: read, checked, and shown.
pub fn gcode(bytes: &[u8]) {
    for event in Reader::new(bytes).flatten() {
        if let Event::Move(step) = event {
            assert!(step.from.is_finite() && step.to.is_finite());
            assert!(step.filament.is_finite() && step.speed.is_finite());
        }
    }
    let _ = check(bytes, &Rules::new(Builder::new().settings())).map(drop);
    if let Ok(path) = Toolpath::read(Reader::new(bytes)) {
        let mut page = Vec::new();
        if let Err(error) = path.write_html(&mut page, "fuzz") {
            panic!("{error}");
        }
    }
}

/// Meshes: STL, OBJ and PLY.
pub fn mesh(bytes: &[u8]) {
    data::mesh(bytes);
}

/// SVG and DXF drawings.
pub fn drawing(bytes: &[u8]) {
    data::drawing(bytes);
}

/// Pictures, volumes and samples.
pub fn picture(bytes: &[u8]) {
    data::picture(bytes);
}

/// Models of 3MF files.
pub fn threemf(bytes: &[u8]) {
    data::threemf(bytes);
}
