//! Fields and settings that nobody would want: each ends in valid G-code or in
//! an error that says why, within bounded time and memory.

use crate::common;
use crate::common::{MoveKind, number};
use glam::DVec3;
use isoslice::limits::{Limits, Watch};
use isoslice::model::{Bounds, BuildVolume, Placement, Source, load, place};
use isoslice::pipeline::{self, Options};
use isoslice::settings::{Builder, Settings, keys};
use std::time::Duration;

/// Far more than any of these runs needs, on any machine. A run that needs
/// more, or has no end, fails.
fn watch() -> Watch {
    Watch::new(Limits {
        time: Some(Duration::from_secs(900)),
        work: None,
        memory_bytes: Some(3 << 30),
        slow: None,
    })
}

/// Slices a formula, cut to a box if one is given. The error's text, or the
/// G-code.
fn slice(
    text: &str,
    bounds: Option<Bounds>,
    settings: &Settings,
) -> Result<String, String> {
    let watched = watch().run(|| {
        let source = Source::formula("hostile", text);
        let loaded = load(&source, &[]).map_err(|e| e.to_string())?;
        let placement = Placement {
            bounds,
            ..Placement::default()
        };
        let volume = BuildVolume::of(settings);
        let model =
            place(&loaded, &placement, volume).map_err(|e| e.to_string())?;
        let options = Options {
            threads: Some(2),
            ..Options::default()
        };
        let mut bytes = Vec::new();
        pipeline::slice(&model, settings, &options, &mut bytes)
            .map_err(|e| e.to_string())?;
        Ok(String::from_utf8(bytes).unwrap())
    });
    watched.unwrap_or_else(|stopped| panic!("{text}: {stopped}"))
}

/// What any G-code has to be, whatever it prints.
#[track_caller]
fn assert_valid(gcode: &str, settings: &Settings, what: &str) {
    // The reader asserts that every number is one.
    let layers = common::parse(gcode);
    let lines: Vec<&str> = gcode.lines().collect();
    let mut prints = 0;
    for m in layers.iter().flat_map(|l| &l.moves) {
        let p = m.to;
        let line = lines[m.line - 1];
        assert!(
            (p.x.is_nan()
                || (0.0..=number(settings, "printer.bed_x")).contains(&p.x))
                && (p.y.is_nan()
                    || (0.0..=number(settings, "printer.bed_y"))
                        .contains(&p.y))
                && (p.z.is_nan() || (0.0..=1e5).contains(&p.z)),
            "{what}: off the bed: {line}"
        );
        assert!(m.fed.is_finite() && m.feed > 0.0, "{what}: {line}");
        if m.kind == MoveKind::Print {
            let wipes = number(settings, "retract.wipe") > 0.0;
            assert!(m.fed > 0.0 || wipes, "{what}: backwards: {line}");
            prints += 1;
        }
    }
    assert!(prints > 0, "{what}: nothing is printed");
    assert!(gcode.contains("; end of layers"), "{what}: no end");
}

fn coarse() -> Settings {
    common::settings(&[
        "sample_spacing=0.225",
        "layer_height=0.3",
        "first_layer_height=0.3",
    ])
}

fn cube(half: f64) -> Bounds {
    Bounds {
        min: DVec3::splat(-half),
        max: DVec3::splat(half),
    }
}

/// A formula in a box of 6 mm: G-code or an error.
#[track_caller]
fn check(text: &str) -> Result<String, String> {
    let settings = coarse();
    let result = slice(text, Some(cube(3.0)), &settings);
    match &result {
        Ok(gcode) => assert_valid(gcode, &settings, text),
        Err(error) => {
            assert!(!error.contains("bug"), "{text}: {error}");
            assert!(error.len() > 20, "{text}: {error}");
        }
    }
    result
}

#[track_caller]
fn prints(text: &str) {
    check(text).unwrap_or_else(|error| panic!("{text}: {error}"));
}

#[track_caller]
fn refused(text: &str) {
    let result = check(text);
    assert!(result.is_err(), "{text} is printed");
}

#[test]
fn fields_without_a_value() {
    refused("sqrt(-1 - x^2)");
    refused("0/0");
    refused("ln(-1)");
    // A part is printed where the field has a value.
    prints("sqrt(x) + abs(y) - 2");
    prints("sqrt(x^2 + y^2) - 2 + sqrt(z)*0");
    // There is a point without a value in the middle of what is solid.
    prints("abs(x)/x*0 + sqrt(x^2 + y^2 + z^2) - 2.5");
    let _ = check("tan(x*100)*ln(y) - 1/z");
    let _ = check("asin(x) + acos(y)");
}

#[test]
fn fields_that_are_infinite() {
    refused("1/0");
    refused("-1/0");
    prints("-1/(x^2 + y^2 + z^2)");
    prints("1/(x^2 + y^2 + z^2 - 4) * -1 - 10000");
    let _ = check("exp(exp(exp(x^2))) - 2");
    let _ = check("ln(abs(x)) + ln(abs(y))");
    let _ = check("exp(1000*x) - exp(1000*y)");
}

#[test]
fn fields_that_are_constant() {
    refused("1");
    refused("0");
    refused("0*x");
    refused("x - x");
    refused("-1");
    // This formula is negative everywhere, which it does not show.
    prints("min(x, -100)");
}

#[test]
fn fields_that_jump() {
    prints("floor(x) + floor(y)^2 - 1");
    prints("floor(sqrt(x^2 + y^2)) - 1.5");
    prints("round(x*3) % 2 - 0.5");
    prints("compare(x^2 + y^2, 4)");
    prints("max(compare(x, 1), compare(-1, x))");
    let _ = check("floor(x*1000) % 2 - 0.5");
    let _ = check("atan2(y, x) - 1");
}

#[test]
fn fields_of_any_scale() {
    for scale in ["1e30", "1e-30", "1e15", "1e-15", "1e38", "1e-38", "1e-44"] {
        for part in ["sqrt(x^2 + y^2 + z^2) - 2", "x^2 + y^2 - 5"] {
            let _ = check(&format!("{scale}*({part})"));
        }
    }
    // f32 holds these numbers.
    prints("1e30*(sqrt(x^2 + y^2 + z^2) - 2)");
    prints("1e-30*(sqrt(x^2 + y^2 + z^2) - 2)");
    // Coordinates beyond any bed.
    let _ = check("sqrt((x*1e30)^2 + y^2) - 2");
    let _ = check("x*1e-30 + y*1e30 - z");
    let settings = coarse();
    let far = slice("sqrt((x-1e7)^2 + y^2 + z^2) - 2", None, &settings);
    assert!(far.is_err());
    assert!(slice("sqrt(x^2 + y^2 + z^2) - 1e30", None, &settings).is_err());
    assert!(slice("sqrt(x^2 + y^2 + z^2) - 1e-30", None, &settings).is_err());
}

#[test]
fn islands_without_number() {
    let settings = common::settings(&[
        "sample_spacing=0.1",
        "layer_height=0.3",
        "first_layer_height=0.3",
    ]);
    let small = Bounds {
        min: DVec3::new(-1.0, -1.0, 0.0),
        max: DVec3::new(1.0, 1.0, 0.6),
    };
    // The waves are 0.8 mm apart, then finer than the lattice, and finer than
    // f32 tells apart.
    for wave in ["7.854*", "31.4*", "1000*", "1e6*", "1e12*"] {
        for text in [
            format!("sin({wave}x)*sin({wave}y) + 0.2 + 0*z"),
            format!("({wave}x) % 1 - 0.5"),
        ] {
            if let Ok(gcode) = slice(&text, Some(small), &settings) {
                assert_valid(&gcode, &settings, &text);
            }
        }
    }
}

fn gyroid(k: &str) -> String {
    format!(
        "sin(x*{k})*cos(y*{k}) + sin(y*{k})*cos(z*{k}) + sin(z*{k})*cos(x*{k})"
    )
}

/// A part whose field waves so finely that nothing of it could be printed is
/// refused, with the place, before hours of work are done for it.
#[test]
fn fields_that_oscillate_finer_than_can_be_printed() {
    const CUBE: &str = "max(max(abs(x),abs(y)),abs(z)) - 6";
    let mods = (0..30).fold("x".to_owned(), |e, k| {
        format!("(({e})*3.1 + y + z*{k}) % 1.7")
    });
    // With wider slits closed, what waves is one body; with the usual ones some
    // of it falls apart into blades, which are refused for that.
    let settings = common::settings(&["slit_closing=0.05"]);
    for text in [
        "sin(1e6*x) + sqrt(x^2+y^2+z^2) - 5",
        "sin(1000*x) + sqrt(x^2+y^2+z^2) - 15",
        &format!("max(tan(x*y*z*100), {CUBE})"),
        &format!("max(sin(100*x)*sin(100*y)*sin(100*z), {CUBE})"),
        &format!("max((floor(x*50) + floor(y*50)) % 2 - 0.5, {CUBE})"),
        &format!("max({mods} - 0.8, {CUBE})"),
        // Waves whose distance is nearly that of the samples, or of those in
        // a divided cell.
        "sin(60*x) + sqrt(x^2+y^2+z^2) - 15",
        "sqrt(x^2+y^2+z^2) - 10 + 0.05*sin(1000*x)*sin(1000*y)",
        "sqrt(x^2+y^2+z^2) - 10 + 0.05*sin(1e4*x)*sin(1e4*y)",
        // Blades, most of whose area is too fine.
        &format!("max(sin(400*atan2(y,x)), {CUBE})"),
        // A rough skin, no thicker than a hair.
        "sqrt(x^2+y^2+z^2) - 8 + 0.02*sin(300*x)*sin(300*y)*sin(300*z)",
    ] {
        let error = slice(text, None, &settings).unwrap_err();
        assert!(error.contains("too finely"), "{text}: {error}");
        assert!(error.contains("near x ="), "{text}: {error}");
    }
    // The lattice makes no difference.
    for spacing in ["0.05", "0.1", "0.2"] {
        let spacing = format!("sample_spacing={spacing}");
        let settings = common::settings(&[&spacing, "slit_closing=0.05"]);
        let text = format!("max(sin(97*x)*sin(97*y)*sin(97*z), {CUBE})");
        let error = slice(&text, None, &settings).unwrap_err();
        assert!(error.contains("too finely"), "{spacing}: {error}");
    }
    let blades = format!("max(sin(100*x)*sin(100*y)*sin(100*z), {CUBE})");
    let error = slice(&blades, None, &Settings::default()).unwrap_err();
    assert!(error.contains("next to nothing to print"), "{error}");
}

/// What is fine, but no finer than a line or two, is a part.
#[test]
fn fine_lattices_are_printed() {
    let settings = common::settings(&["thin_min=10%"]);
    let cut = |f: &str| format!("max({f}, max(max(abs(x),abs(y)),abs(z)) - 3)");
    for text in [
        // Sheets of a gyroid with cells of 0.9 mm.
        cut(&format!("abs({}) - 0.6", gyroid("6.981"))),
        // Half of it inside, with cells of 0.5 mm.
        cut(&gyroid("12.566")),
        // Pins of 0.2 mm, 0.3 mm apart: whole rows in line with the lattice.
        cut("sqrt(((x+50)%0.3-0.15)^2 + ((y+50)%0.3-0.15)^2) - 0.1"),
        // Struts of 0.15 mm, 1 mm apart.
        cut("sqrt(((x+50)%1-0.5)^2 + ((y+50)%1-0.5)^2) - 0.075"),
        // Fins of 0.2 mm.
        cut("abs((x+50)%0.4 - 0.2) - 0.1"),
        // Forty blades that meet in the middle.
        "max(sin(40*atan2(y,x)), max(sqrt(x^2+y^2) - 6, abs(z) - 3))".into(),
        // Of sixty and of a hundred blades only a small share is too fine.
        "max(sin(60*atan2(y,x)), max(sqrt(x^2+y^2) - 9, abs(z) - 3))".into(),
        "max(sin(100*atan2(y,x)), max(sqrt(x^2+y^2) - 12, abs(z) - 1))".into(),
    ] {
        let gcode = slice(&text, None, &settings).unwrap();
        assert_valid(&gcode, &settings, &text);
    }
}

#[test]
fn parts_thinner_than_any_bead() {
    for thickness in ["0.2", "0.05", "0.01", "1e-3", "1e-5", "1e-9"] {
        for part in [
            format!("abs(x) - {thickness}/2"),
            format!("abs(z) - {thickness}/2"),
            format!("sqrt(x^2 + y^2) - {thickness}/2"),
            format!("abs(sqrt(x^2 + y^2) - 2) - {thickness}/2"),
            format!("abs(x + y*0.01) - {thickness}/2"),
        ] {
            let _ = check(&part);
        }
    }
}

/// Each run ends after a look at some places. All outlines of the first part
/// would take many minutes.
#[test]
fn parts_thinner_than_any_bead_nearly_everywhere() {
    let sheets = |k: &str, thick: f64, half: f64| {
        let sheet = format!("abs({}) - {thick}", gyroid(k));
        format!("max(max(abs(x), max(abs(y), abs(z))) - {half}, {sheet})")
    };
    let thin = [
        sheets("1", 0.02, 50.0),
        sheets("1", 0.004, 5.0),
        // Hardly any node meets these sheets.
        sheets("6", 0.05, 6.0),
        "max(abs(mod(x + 50, 1) - 0.5) - 0.05, \
         max(max(abs(x), abs(y)) - 20, abs(z - 10) - 10))"
            .to_owned(),
    ];
    let settings = Settings::default();
    for text in thin {
        let error = slice(&text, None, &settings).unwrap_err();
        assert!(error.contains("next to nothing"), "{text}: {error}");
        assert!(error.contains("thin_min"), "{text}: {error}");
    }
    // These parts are thin at the top, in the lower half, in half of their
    // places, and only because slits are left open.
    let thick = [
        "max(max(abs(x), abs(y)) - min(8, 0.1 + max(0, 10 - z)), abs(z - 6) - 6)",
        "min(max(max(abs(x), abs(y)) - 0.1, abs(z - 2) - 2), \
         max(max(abs(x), abs(y)) - 6, abs(z - 5) - 1))",
        "max(min(abs(mod(x + 50, 1) - 0.5) - 0.1, -x), \
         max(max(abs(x), abs(y)) - 10, abs(z - 2) - 2))",
        "max(0.02 - abs(mod(x + 50, 0.2) - 0.1), \
         max(max(abs(x), abs(y)) - 5, abs(z - 1) - 1))",
    ];
    for text in thick {
        match slice(text, None, &coarse()) {
            Ok(gcode) => assert_valid(&gcode, &coarse(), text),
            Err(e) => assert!(!e.contains("next to nothing"), "{text}: {e}"),
        }
    }
}

#[test]
fn a_plate_as_large_as_the_bed() {
    let settings = common::settings(&[
        "sample_spacing=0.225",
        "layer_height=0.3",
        "first_layer_height=0.3",
        "skirt.loops=0",
    ]);
    let bed = Bounds {
        min: DVec3::new(0.0, 0.0, 0.0),
        max: DVec3::new(220.0, 220.0, 0.6),
    };
    let gcode = slice("z - 1", Some(bed), &settings).unwrap();
    assert_valid(&gcode, &settings, "a plate");
    // Without bounds this part goes on for ever.
    assert!(slice("z - 1", None, &settings).is_err());
    let larger = Bounds {
        max: DVec3::new(221.0, 220.0, 0.6),
        ..bed
    };
    assert!(slice("z - 1", Some(larger), &settings).is_err());
}

/// A cube of 5 mm with a setting at an end of its range.
fn check_setting(key: &str, value: f64) {
    let what = format!("{key}={value}");
    let mut builder = Builder::new();
    // What is not tested is coarse, and every feature is on.
    for assignment in [
        "sample_spacing=0.225",
        "accuracy=0.02",
        "ironing=true",
        "retract.when_crossing=false",
        "retract.z_hop=0.2",
        "fuzzy.thickness=0.1",
        "infill=gyroid",
    ] {
        builder.set(assignment).unwrap();
    }
    builder
        .set(&what)
        .unwrap_or_else(|error| panic!("{what}: {error}"));
    let Ok((settings, _)) = builder.finish() else {
        // The value is at odds with another setting, which the error says.
        return;
    };
    let cube = "max(max(abs(x), abs(y)), abs(z)) - 2.5";
    match slice(cube, None, &settings) {
        Ok(gcode) => assert_valid(&gcode, &settings, &what),
        Err(error) => {
            assert!(!error.contains("bug"), "{what}: {error}");
            assert!(!error.is_empty(), "{what}");
        }
    }
}

/// The `part`th of four parts of the settings, at both ends of their ranges:
/// as several tests they run side by side.
fn check_ends(part: usize) {
    for key in keys().iter().skip(part).step_by(4) {
        let Some(range) = key.range else { continue };
        for end in [range.min, range.max] {
            let start = std::time::Instant::now();
            check_setting(key.name, end);
            // Not asserted, but shown when a test fails or is asked to.
            println!("{}={end}: {:.1?}", key.name, start.elapsed());
        }
    }
}

#[test]
fn settings_at_their_ends_1() {
    check_ends(0);
}

#[test]
fn settings_at_their_ends_2() {
    check_ends(1);
}

#[test]
fn settings_at_their_ends_3() {
    check_ends(2);
}

#[test]
fn settings_at_their_ends_4() {
    check_ends(3);
}

#[test]
fn settings_beyond_their_ends_are_refused() {
    let mut tested = 0;
    for key in keys() {
        let Some(range) = key.range else { continue };
        let wide = (range.max - range.min).abs();
        let mut values: Vec<String> = [
            range.min - 1.0,
            range.min - 1e-6 * wide.max(1e-3),
            range.min - 1e30,
            range.max + 1.0,
            range.max + 1e-6 * wide,
            range.max * 1e30,
        ]
        .iter()
        .map(f64::to_string)
        .collect();
        let words = [
            "nan", "NaN", "-nan", "inf", "-inf", "infinity", "1e999", "-1e999",
            "", "1,5", "0x10", "1 2", "--1", "1e", "\u{0661}",
        ];
        values.extend(words.map(str::to_owned));
        for value in values {
            let mut builder = Builder::new();
            let given = format!("{}={value}", key.name);
            let error = match builder.set(&given) {
                Ok(()) if range.or_zero && value == "0" => continue,
                Ok(()) => panic!("{given} is taken"),
                Err(error) => error.to_string(),
            };
            assert!(error.contains(key.name), "{given}: {error}");
            tested += 1;
        }
        // Files of settings are judged alike. TOML has numbers that are none.
        for value in ["nan", "inf", "-inf", "1e308", "-1e308"] {
            let mut builder = Builder::new();
            let text = match key.name.split_once('.') {
                Some((group, name)) => format!("[{group}]\n{name} = {value}"),
                None => format!("{} = {value}", key.name),
            };
            assert!(builder.toml("file", &text).is_err(), "{text}");
        }
    }
    assert!(tested > 1000);
}
