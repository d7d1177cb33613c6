//! Profiles: those of the program, and a user's beside them.

use crate::common::{number, text};
use isoslice::layers::LayerRange;
use isoslice::model::{self, BuildVolume, Placement, Source};
use isoslice::pipeline::{self, Options};
use isoslice::settings::{
    Builder, Origin, Profile, ProfileKind, Profiles, Settings, SettingsError,
    keys,
};
use std::fs;
use std::path::Path;
use tempfile::TempDir;

fn shipped(kind: ProfileKind) -> Vec<Profile> {
    let (all, wrong) = Profiles::default().list(kind);
    assert!(wrong.is_empty(), "{wrong:?}");
    all
}

fn cost_and_density(builder: &Builder) -> (f64, f64) {
    let of = |name| number(builder.settings(), name);
    (of("filament.cost"), of("filament.density"))
}

/// Settings of a printer, a filament and a preset.
fn build(names: [&str; 3]) -> Result<(Settings, Vec<String>), SettingsError> {
    let mut builder = Builder::new();
    for (kind, name) in ProfileKind::ALL.into_iter().zip(names) {
        builder
            .profile(&Profiles::default(), kind, name)
            .unwrap_or_else(|e| panic!("{e}"));
    }
    builder.finish()
}

fn of(names: [&str; 3]) -> (Settings, Vec<String>) {
    build(names).unwrap_or_else(|e| panic!("{names:?}: {e}"))
}

/// A folder of profiles: kind's folder and name, and text.
fn folder(files: &[(&str, &str)]) -> (TempDir, Profiles) {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in files {
        let path = folder.path().join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    }
    let profiles = Profiles::new(Some(folder.path().to_owned()));
    (folder, profiles)
}

fn with(profiles: &Profiles, name: &str) -> Result<Builder, String> {
    let mut builder = Builder::new();
    builder
        .profile(profiles, ProfileKind::Filament, name)
        .map_err(|e| e.to_string())?;
    Ok(builder)
}

/// The message for a filament that must be refused, its folder left out.
fn refused(files: &[(&str, &str)], name: &str) -> String {
    let (folder, profiles) = folder(files);
    let message = with(&profiles, name).err().unwrap_or_default();
    let root = format!("{}/", folder.path().display());
    message
        .replace('\\', "/")
        .replace(&root.replace('\\', "/"), "")
}

#[test]
fn every_file_is_part_of_the_program() {
    let root =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("crates/settings/src");
    let mut counts = Vec::new();
    for kind in ProfileKind::ALL {
        let files = fs::read_dir(root.join("profiles").join(kind.folder()));
        let mut files: Vec<String> = files
            .unwrap()
            .map(|entry| entry.unwrap().path())
            .map(|path| path.file_stem().unwrap().to_string_lossy().into())
            .collect();
        files.sort();
        let mut profiles = shipped(kind);
        profiles.retain(|p| !p.is_another_nozzle());
        let names: Vec<_> = profiles.iter().map(|p| p.name.clone()).collect();
        assert_eq!(names, files, "crates/settings/src/shipped.rs lists them");
        counts.push(files.len());
    }
    assert!(counts[0] >= 32 && counts[1] >= 8 && counts[2] >= 5);
}

#[test]
fn every_profile_says_what_it_is_and_sets_only_what_is_its_business() {
    // A preset that set a temperature would undo the filament's.
    let business: [&[&str]; 3] = [
        &["printer", "gcode", "retract", "speed", "acceleration"],
        &["filament", "cooling"],
        &["", "speed"],
    ];
    let mut names = std::collections::BTreeSet::new();
    for (kind, groups) in ProfileKind::ALL.into_iter().zip(business) {
        for profile in shipped(kind) {
            assert!(!profile.description.is_empty(), "{}", profile.name);
            assert!(profile.description.len() < 80, "{}", profile.name);
            assert_eq!(profile.origin, Origin::Shipped);
            // `profiles show NAME` means one of them.
            assert!(names.insert(profile.name.clone()), "{}", profile.name);
            let mut builder = Builder::new();
            builder
                .profile(&Profiles::default(), kind, &profile.name)
                .unwrap_or_else(|e| panic!("{e}"));
            for key in keys().iter().filter(|k| builder.place(k).is_some()) {
                // It is as much the machine's as the material's.
                if key.name == "filament.pressure_advance" {
                    continue;
                }
                let group = key.name.split_once('.').map_or("", |(g, _)| g);
                let name = &profile.name;
                assert!(groups.contains(&group), "{name} sets {}", key.name);
            }
        }
    }
}

#[test]
fn a_printer_says_all_that_depends_on_the_machine() {
    for printer in shipped(ProfileKind::Printer) {
        let mut builder = Builder::new();
        builder
            .profile(&Profiles::default(), ProfileKind::Printer, &printer.name)
            .unwrap_or_else(|e| panic!("{e}"));
        for name in [
            "printer.bed_x",
            "printer.bed_y",
            "printer.height",
            "printer.nozzle_diameter",
            "printer.acceleration",
            "printer.travel_acceleration",
            "printer.square_corner_velocity",
            "printer.max_speed_z",
            "printer.max_acceleration_z",
            "retract.length",
            "retract.speed",
            "gcode.flavour",
        ] {
            let key = keys().iter().find(|key| key.name == name).unwrap();
            assert!(builder.place(key).is_some(), "{}: {name}", printer.name);
        }
    }
}

#[test]
fn every_printer_has_profiles_with_other_nozzles() {
    let printers = shipped(ProfileKind::Printer);
    let (others, own): (Vec<_>, Vec<_>) =
        printers.iter().partition(|p| p.is_another_nozzle());
    assert_eq!(others.len(), 3 * own.len());
    for printer in own {
        let (usual, _) = of([&printer.name, "pla", "standard"]);
        assert_eq!(
            number(&usual, "printer.nozzle_diameter"),
            0.4,
            "{}",
            printer.name
        );
        for nozzle in [0.25, 0.6, 0.8] {
            let name = format!("{}-{nozzle}-nozzle", printer.name);
            let (settings, _) = of([&name, "pla", "standard"]);
            let advance = text(&settings, "filament.pressure_advance");
            let mut expected = Builder::new();
            expected.toml("usual", &usual.to_toml()).unwrap();
            let diameter = format!("printer.nozzle_diameter={nozzle}");
            expected.set(&diameter).unwrap();
            // The wider the nozzle, the less there is to push ahead.
            let own = format!("filament.pressure_advance={advance}");
            expected.set(&own).unwrap();
            let expected = expected.finish().unwrap().0;
            let usual = text(&usual, "filament.pressure_advance");
            if let (Ok(advance), Ok(usual)) =
                (advance.parse::<f64>(), usual.parse::<f64>())
            {
                assert!(nozzle < 0.4 || advance < usual, "{name}: {advance}");
            }
            assert_eq!(settings, expected, "{name}");
            let width = settings.outer_wall_width();
            assert!((width - 1.125 * nozzle).abs() < 1e-12, "{name}: {width}");
        }
    }
}

#[test]
fn every_printer_and_preset_goes_with_a_raft() {
    for printer in shipped(ProfileKind::Printer) {
        for preset in shipped(ProfileKind::Preset) {
            let mut builder = Builder::new();
            for (kind, name) in [
                (ProfileKind::Printer, &printer.name),
                (ProfileKind::Preset, &preset.name),
            ] {
                builder.profile(&Profiles::default(), kind, name).unwrap();
            }
            builder.set("raft.layers=3").unwrap();
            builder.set("supports=auto").unwrap();
            let names = format!("{} {}", printer.name, preset.name);
            let (settings, told) =
                builder.finish().unwrap_or_else(|e| panic!("{names}: {e}"));
            assert!(!told.concat().contains("raft"), "{names}: {told:?}");
            // The first lines reach down to the raft.
            let first = settings.raft_gap() + settings.part_first_height();
            let nozzle = number(&settings, "printer.nozzle_diameter");
            assert!(first <= nozzle + 1e-9, "{names}: {first}");
        }
    }
}

/// The default suits a slow printer.
#[test]
fn a_printer_that_has_speeds_of_its_own_has_one_for_gap_fill() {
    for printer in shipped(ProfileKind::Printer) {
        let mut builder = Builder::new();
        builder
            .profile(&Profiles::default(), ProfileKind::Printer, &printer.name)
            .unwrap_or_else(|e| panic!("{e}"));
        let given = |name: &str| {
            let key = keys().iter().find(|key| key.name == name).unwrap();
            builder.place(key).is_some()
        };
        let (walls, gaps) = ("speed.inner_wall", "speed.gap_fill");
        assert_eq!(given(walls), given(gaps), "{}", printer.name);
    }
}

#[test]
fn the_plainest_profiles_are_the_defaults() {
    let (settings, _) = of(["generic-marlin", "pla", "standard"]);
    assert_eq!(settings, Settings::default());
}

#[test]
fn all_combinations_print_except_what_a_hot_end_cannot_melt() {
    let (mut combinations, mut refused) = (0, Vec::new());
    for printer in shipped(ProfileKind::Printer) {
        for filament in shipped(ProfileKind::Filament) {
            for preset in shipped(ProfileKind::Preset) {
                let names = [&*printer.name, &*filament.name, &*preset.name];
                combinations += 1;
                match (build(names), preset.name == "standard") {
                    (Ok((_, warnings)), _) => {
                        assert_eq!(warnings, Vec::<String>::new(), "{names:?}");
                    }
                    (Err(error), true) => refused
                        .push(format!("{} {} {error}", names[0], names[1])),
                    // A preset makes no difference.
                    (Err(error), false) => {
                        let standard = build([names[0], names[1], "standard"]);
                        let standard = standard.unwrap_err().to_string();
                        assert_eq!(error.to_string(), standard, "{names:?}");
                    }
                }
            }
        }
    }
    assert!(combinations >= 128 * 8 * 5);
    // A bed of 80 °C is too cold for these, whatever the nozzle.
    let cold: Vec<String> = refused
        .extract_if(.., |error| error.starts_with("bambu-a1-mini"))
        .collect();
    assert_eq!(cold.len(), 16, "{cold:#?}");
    for error in &cold {
        let filament = error.split(' ').nth(1);
        assert!(
            filament
                .is_some_and(|f| { ["abs", "asa", "pc", "petg"].contains(&f) })
        );
        assert!(
            error.contains("printer.max_bed_temperature = 80 °C"),
            "{error}"
        );
    }
    // PTFE in the hot end: polycarbonate is out of reach of these, whatever
    // the nozzle.
    assert_eq!(refused.len(), 8, "{refused:#?}");
    for (i, error) in refused.iter().enumerate() {
        let printer = ["ender-3", "ender-3-v2"][i / 4];
        let nozzle = ["", "-0.25-nozzle", "-0.6-nozzle", "-0.8-nozzle"][i % 4];
        let expected = format!(
            "{printer}{nozzle} pc filament.nozzle_temperature = 260 °C is \
             more than printer.max_nozzle_temperature = 255 °C"
        );
        assert!(error.starts_with(&expected), "{error}");
    }
}

#[test]
fn an_example_slices_for_every_printer() {
    let example = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("examples")
        .join("threaded-knob.rhai");
    let loaded = model::load(&Source::File(example), &[]).unwrap();
    let all = shipped(ProfileKind::Printer).into_iter();
    // Other nozzles make the same difference to all.
    let few = all.filter(|p| {
        !p.is_another_nozzle() || p.name.starts_with("generic-marlin")
    });
    for printer in few {
        // One of these printers has a bed of 80 °C.
        let (filament, bed, nozzle) = match &*printer.name {
            "bambu-a1-mini" => ("pla", "60", "215"),
            _ => ("petg", "85", "235"),
        };
        let (settings, _) = of([&printer.name, filament, "draft"]);
        let volume = BuildVolume::of(&settings);
        let placed = model::place(&loaded, &Placement::default(), volume)
            .unwrap_or_else(|e| panic!("{}: {e}", printer.name));
        let mut gcode = Vec::new();
        let options = Options {
            threads: Some(1),
            layers: "1..3".parse::<LayerRange>().unwrap(),
            ..Options::default()
        };
        pipeline::slice(&placed, &settings, &options, &mut gcode)
            .unwrap_or_else(|e| panic!("{}: {e}", printer.name));
        let gcode = String::from_utf8(gcode).unwrap();
        let gcode = gcode.replace("; CHANGE_LAYER", ";LAYER_CHANGE");
        let name = &printer.name;
        assert_eq!(gcode.matches(";LAYER_CHANGE").count(), 3, "{name}");
        // What a range's file says of itself for joining is a comment.
        let mut commands = gcode.lines().filter(|l| !l.starts_with(';'));
        let left = commands.find(|line| line.contains(['{', '}']));
        assert_eq!(left, None, "{name}: a placeholder is left");
        // Hot before the first bead, and homed.
        let start = gcode.split(";LAYER_CHANGE").next().unwrap();
        let at = |command: &str| {
            let found = start.lines().position(|l| l.starts_with(command));
            found.unwrap_or_else(|| panic!("{name}: no {command}\n{start}"))
        };
        // The macros of some makers' firmware home and heat by themselves.
        let given_to_a_macro = start.lines().any(|line| {
            (line.starts_with("START_PRINT ")
                || line.starts_with("PRINT_START "))
                && line.contains(&format!("={bed}"))
                && line.contains(&format!("={nozzle}"))
        });
        if !given_to_a_macro {
            let bed = at(&format!("M190 S{bed}"));
            assert!(bed < start.lines().count());
            assert!(at(&format!("M109 S{nozzle}")) > 0 && at("G28") > 0);
        }
        assert!(gcode.contains("\nM104 S0") && gcode.contains("\nM140 S0"));
        if text(&settings, "gcode.flavour") == "\"klipper\"" {
            for unknown in ["G29", "M420", "G80", "M900", "M201", "M109 R"] {
                let line = format!("\n{unknown}");
                assert!(!gcode.contains(&line), "{name} has {unknown}");
            }
        }
        // All moves are on the bed.
        for line in gcode.lines().filter(|l| l.starts_with("G1 ")) {
            for word in line.split_whitespace() {
                let value = word.get(1..).and_then(|v| v.parse::<f64>().ok());
                let most = match &word[..1] {
                    "X" => volume.x,
                    "Y" => volume.y,
                    "Z" => volume.z,
                    _ => continue,
                };
                let inside = value.is_some_and(|v| (0.0..=most).contains(&v));
                assert!(inside, "{name}: {line}");
            }
        }
    }
}

#[test]
fn later_layers_win() {
    let (_folder, profiles) = folder(&[
        ("filaments/mine.toml", "filament.density = 2\nwalls = 7"),
        ("presets/mine.toml", "walls = 8\nlayer_height = 0.1"),
    ]);
    let mut builder = Builder::new();
    for (kind, name) in [
        (ProfileKind::Printer, "ender-3"),
        (ProfileKind::Filament, "mine"),
        (ProfileKind::Preset, "mine"),
    ] {
        builder.profile(&profiles, kind, name).unwrap();
    }
    assert_eq!(number(builder.settings(), "walls"), 8.0);
    builder
        .toml("a.toml", "walls = 9\nskirt.loops = 2")
        .unwrap();
    builder.toml("b.toml", "walls = 10").unwrap();
    assert_eq!(number(builder.settings(), "walls"), 10.0);
    builder.set("walls=11").unwrap();
    let origin = |name: &str| {
        let key = keys().iter().find(|key| key.name == name).unwrap();
        builder.place(key).map(ToString::to_string)
    };
    assert_eq!(origin("walls").as_deref(), Some("--set"));
    assert_eq!(origin("skirt.loops").as_deref(), Some("a.toml:2"));
    let density = origin("filament.density").unwrap();
    assert!(density.ends_with("mine.toml:1"), "{density}");
    assert_eq!(
        origin("retract.length").as_deref(),
        Some("shipped printers/ender-3.toml:34")
    );
    assert_eq!(origin("seam"), None);
}

#[test]
fn ones_own_profile_goes_before_and_may_start_from_the_shipped_one() {
    let (_folder, profiles) = folder(&[
        (
            "filaments/petg.toml",
            "inherits = 'petg'\nfilament.cost = 19",
        ),
        (
            "filaments/cheap.toml",
            "inherits = 'petg'\nfilament.cost = 9",
        ),
        ("filaments/notes.txt", "not a profile"),
    ]);
    let petg = with(&profiles, "petg").unwrap();
    assert_eq!(cost_and_density(&petg), (19.0, 1.27));
    let cheap = with(&profiles, "cheap").unwrap();
    assert_eq!(cost_and_density(&cheap), (9.0, 1.27));
    let listed = profiles.list(ProfileKind::Filament).0;
    let own = listed.iter().filter(|p| p.origin != Origin::Shipped);
    let own: Vec<_> = own.map(|p| p.name.as_str()).collect();
    assert_eq!(own, ["cheap", "petg"]);
    let count = shipped(ProfileKind::Filament).len();
    assert_eq!(listed.len(), count + 1);
}

/// Such a name used to be unknown, and was itself proposed as the most similar
/// one.
#[test]
fn a_profile_that_is_no_file_is_said_to_be_none() {
    let error = refused(&[("filaments/odd.toml/a.txt", "")], "odd");
    assert!(error.contains("odd.toml"), "{error}");
    assert!(!error.contains("did you mean"), "{error}");
}

#[test]
fn a_profile_may_be_a_file_anywhere() {
    let (folder, profiles) = folder(&[(
        "elsewhere/odd.toml",
        "inherits = 'tpu'\nfilament.cost = 1",
    )]);
    let path = folder.path().join("elsewhere").join("odd.toml");
    let filament = with(&profiles, &path.display().to_string()).unwrap();
    assert_eq!(cost_and_density(&filament), (1.0, 1.21));
}

/// A path in a profile starts from the profile's folder, from wherever it is
/// read.
#[test]
fn a_path_in_a_profile_starts_from_its_folder() {
    let (folder, profiles) = folder(&[
        ("filaments/a.toml", "inherits = '../more/b.toml'"),
        ("more/b.toml", "inherits = './c.toml'\nfilament.cost = 2"),
        ("more/c.toml", "inherits = 'tpu'\nfilament.cost = 1"),
        // The same file by ever longer names.
        ("more/round.toml", "inherits = '../more/round.toml'"),
    ]);
    let filament = with(&profiles, "a").unwrap();
    assert_eq!(cost_and_density(&filament), (2.0, 1.21));
    let round = folder.path().join("more/round.toml");
    let refused = with(&profiles, &round.display().to_string()).unwrap_err();
    assert!(refused.contains("which inherits"), "{refused}");
}

#[test]
fn refusals_name_file_line_and_remedy() {
    let listing: String = [
        (&[][..], "petgg"),
        (&[], "marble"),
        (&[("filaments/a.toml", "\ninherits = 'pettg'")], "a"),
        (
            &[
                ("filaments/a.toml", "inherits = 'b'"),
                ("filaments/b.toml", "# b\ninherits = 'c'"),
                ("filaments/c.toml", "inherits = 'a'"),
            ],
            "a",
        ),
        (&[("filaments/a.toml", "inherits = 'a'")], "a"),
        (&[("filaments/a.toml", "walls = 2\ninherits = 3")], "a"),
        (&[("filaments/a.toml", "inherits = 'pla'\nwals = 3")], "a"),
        (&[("filaments/a.toml", "walls = = 3")], "a"),
        (
            &[
                ("filaments/a.toml", "inherits = 'b'"),
                ("filaments/b.toml", "# b\n[speed]\ntravel = -1"),
            ],
            "a",
        ),
    ]
    .map(|(files, name)| {
        let files: &[(&str, &str)] = files;
        let texts: Vec<_> = files.iter().map(|f| f.1.trim()).collect();
        let given = texts.join(" | ").replace('\n', "; ");
        format!("{name}: {given}\n    {}\n", refused(files, name))
    })
    .concat();
    insta::with_settings!({ omit_expression => true }, {
        insta::assert_snapshot!("refused_profiles", listing);
    });
    let missing = refused(&[], "no/such.toml");
    assert!(missing.starts_with("cannot read the settings file no/such.toml"));
    // A settings file is no profile.
    let mut builder = Builder::new();
    let error = builder.toml("my.toml", "walls = 3\ninherits = 'pla'");
    assert_eq!(
        error.unwrap_err().to_string(),
        "my.toml:2: there is no setting \"inherits\"; only profiles have it, \
         which are named with --printer, --filament or --preset"
    );
}

/// No head or beam hits a finished part: what the makers draw of their printers, the
/// lowest beam or hose across the bed, and the farthest corner of the head below it.
#[test]
fn heads_and_beams_are_as_the_makers_draw_them() {
    for (name, beam, corner) in [
        ("prusa-mk3s", 11.0, [-45.0, 69.0]),
        ("prusa-mk4", 11.0, [40.0, 44.0]),
        ("prusa-mk4s", 11.0, [-48.0, 66.0]),
        ("prusa-mini", 22.0, [-10.0, -88.0]),
        ("prusa-xl", 19.0, [-43.0, 66.0]),
        ("prusa-core-one", 33.0, [-37.0, -98.0_f64]),
    ] {
        let (settings, _) = of([name, "pla", "standard"]);
        let figure = |name| number(&settings, name);
        let height = figure("printer.gantry_height");
        assert!((beam - 2.0..=beam).contains(&height), "{name}");
        let reach = corner[0].hypot(corner[1]);
        let radius = figure("printer.head_clearance_radius");
        assert!(radius >= reach && radius < reach + 1.0, "{name}: {reach}");
    }
}
