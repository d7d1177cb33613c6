//! The same input gives the same bytes: on any number of threads, however
//! often, in whatever company, on a terminal or not, today or tomorrow, from
//! any folder.
//!
//! `tests/texts/ranges.rs` shows it for ranges of layers.

#![allow(
    clippy::panic,
    clippy::unwrap_used,
    reason = "helpers of tests may fail, too"
)]

mod common;

use isoslice::pipeline::{self, Options};

/// The settings are so coarse that all examples take seconds, with everything that
/// passes from layer to layer.
const COARSE: [&str; 6] = [
    "sample_spacing=0.3",
    "accuracy=0.1",
    "printer.nozzle_diameter=0.6",
    "layer_height=0.42",
    "first_layer_height=0.42",
    "retract.z_hop=0.3",
];

#[track_caller]
fn assert_same(expected: &str, found: &str, what: &str) {
    let differs = expected
        .lines()
        .zip(found.lines())
        .position(|(a, b)| a != b);
    if let Some(line) = differs {
        let of = |text: &str| text.lines().nth(line).unwrap().to_owned();
        panic!(
            "{what}: line {}: {} became {}",
            line + 1,
            of(expected),
            of(found)
        );
    }
    assert_eq!(expected.len(), found.len(), "{what}");
}

/// Ways to slice one example that must give equal bytes.
fn check(name: &str, extra: &[&str]) {
    let example = common::example(name);
    let mut all = COARSE.to_vec();
    all.extend(extra);
    let (model, settings) = example.place(&all);
    let first = common::slice(&model, &settings, 1).0;
    assert!(first.matches(";LAYER_CHANGE").count() > 10, "{name}");
    for threads in [2, 7] {
        let (model, settings) = example.place(&all);
        let again = common::slice(&model, &settings, threads).0;
        let what = format!("{name}, read again, {threads} threads");
        assert_same(&first, &again, &what);
    }
}

/// A test per example, so that one that differs is named and they run side by
/// side.
macro_rules! examples {
    ($($test:ident $name:literal $($set:literal)*,)*) => {
        $(#[test]
        fn $test() {
            check($name, &[$($set),*]);
        })*

        #[test]
        fn every_example_is_tested() {
            let tested = [$($name),*];
            for example in common::examples() {
                let name = example.name.as_str();
                assert!(tested.contains(&name), "{name} is not tested");
            }
        }
    };
}

examples! {
    blended_bracket "blended-bracket",
    box_with_lid "box-with-lid" "infill=grid",
    gear "gear" "seam=nearest",
    gyroid_ball "gyroid-ball",
    heat_exchanger "heat-exchanger",
    knurled_knob "knurled-knob",
    lattice_part "lattice-part" "infill=gyroid",
    threaded_knob "threaded-knob" "infill=expr: sin(x) + sin(y) + sin(z)",
    twisted_vase "twisted-vase" "wall_offset=field",
    weekend "weekend" "gcode.relative_e=true" "fuzzy.thickness=0.2",
}

/// Something is wrong in every layer above the middle. The error names the
/// lowest of these layers, not that of the fastest thread.
#[test]
fn an_error_is_the_same_on_any_number_of_threads() {
    let settings = common::settings(&["infill_density=expr: sqrt(20 - z)"]);
    let text = "max(max(abs(x), abs(y)) - 8, abs(z) - 20)";
    let model = common::formula(text, &settings);
    let error = |threads| {
        let options = Options {
            threads: Some(threads),
            ..Options::default()
        };
        let mut bytes = Vec::new();
        pipeline::slice(&model, &settings, &options, &mut bytes)
            .unwrap_err()
            .to_string()
    };
    let one = error(1);
    assert!(one.contains("20."), "{one}");
    for threads in [2, 8, 8, 8] {
        assert_eq!(error(threads), one);
    }
}

/// The program itself: where it runs and what it writes to must not show.
#[cfg(unix)]
mod program {
    use std::fs;
    use std::path::{Path, PathBuf};
    use std::process::{Command, Stdio};

    const MODEL: &str = "sqrt(x*x + y*y + z*z) - 4.0";

    fn program() -> PathBuf {
        assert_cmd::cargo::cargo_bin!("isoslice").to_owned()
    }

    /// What a run in a folder, with an environment, writes.
    fn run(folder: &Path, changes: &dyn Fn(&mut Command)) -> String {
        fs::create_dir_all(folder).unwrap();
        fs::write(folder.join("ball.rhai"), MODEL).unwrap();
        let mut command = Command::new(program());
        command
            .args(["slice", "ball.rhai", "--set", "layer_height=0.3"])
            .current_dir(folder)
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::null());
        changes(&mut command);
        assert!(command.status().unwrap().success());
        fs::read_to_string(folder.join("ball.gcode")).unwrap()
    }

    #[test]
    fn neither_clock_nor_path_nor_terminal_shows() {
        let root = tempfile::tempdir().unwrap();
        let first = run(&root.path().join("a"), &|_| {});
        let path = root.path().to_str().unwrap();
        assert!(!first.contains(path), "the path shows");
        // The second run has another folder, user, language and time of the
        // day.
        let again = run(&root.path().join("a folder/deeper"), &|c| {
            c.env("TZ", "Pacific/Auckland")
                .env("LANG", "de_DE.UTF-8")
                .env("LC_ALL", "de_DE.UTF-8")
                .env("USER", "somebody")
                .env("HOME", "/")
                .env("RAYON_NUM_THREADS", "3")
                .env("TERM", "dumb");
        });
        super::assert_same(&first, &again, "another folder");
        let by_path = run(&root.path().join("b"), &|c| {
            let model = c.get_current_dir().unwrap().join("ball.rhai");
            let args: Vec<_> = c.get_args().map(|a| a.to_owned()).collect();
            let folder = c.get_current_dir().unwrap().to_owned();
            *c = Command::new(program());
            c.arg(&args[0])
                .arg(model)
                .args(&args[2..])
                .current_dir(folder);
            c.args(["--threads", "7"]);
            c.stdout(Stdio::null()).stderr(Stdio::null());
        });
        super::assert_same(&first, &by_path, "an absolute path");
    }

    /// `script` gives the program a terminal.
    #[cfg(target_os = "linux")]
    #[test]
    fn a_terminal_does_not_show() {
        if Command::new("script").arg("--version").output().is_err() {
            eprintln!("skipped: there is no `script` to make a terminal with");
            return;
        }
        let root = tempfile::tempdir().unwrap();
        let plain = run(&root.path().join("plain"), &|_| {});
        let folder = root.path().join("terminal");
        let on_terminal = run(&folder, &|c| {
            let folder = c.get_current_dir().unwrap().to_owned();
            let program = program();
            let line = format!(
                "{} slice ball.rhai --set layer_height=0.3",
                program.to_str().unwrap()
            );
            *c = Command::new("script");
            c.args(["-q", "-e", "-c", &line, "/dev/null"])
                .env("TERM", "xterm")
                .current_dir(folder)
                .stdin(Stdio::null())
                .stdout(Stdio::null());
        });
        super::assert_same(&plain, &on_terminal, "a terminal");
    }

    /// Clock and date differ between two runs in any case. If they were
    /// written, they would show as digits of the year.
    #[test]
    fn a_later_run_is_the_same() {
        let root = tempfile::tempdir().unwrap();
        let first = run(&root.path().join("a"), &|_| {});
        std::thread::sleep(std::time::Duration::from_millis(1100));
        let later = run(&root.path().join("a"), &|_| {});
        super::assert_same(&first, &later, "a second later");
    }
}
