//! What goes wrong around a run: full disks, folders that cannot be written to,
//! interruption, death. At the final name there is nothing, what was there
//! before, or the whole output. Inputs are never touched, the exit code is not
//! 0, and temporary files are gone.
//!
//! The real program is run and the fault really made. What a machine cannot
//! do (mount, for one) is skipped with a message.

#![cfg(unix)]
#![allow(
    clippy::panic,
    clippy::unwrap_used,
    reason = "helpers of tests may fail, too"
)]

use std::fs;
use std::os::unix::fs::{PermissionsExt, symlink};
use std::os::unix::process::ExitStatusExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::sync::OnceLock;
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// A part that is sliced in a moment.
const SMALL: &str = "max(sqrt(x*x + y*y) - 3.0, abs(z) - 3.0)";
/// A part that takes a minute, more than any test waits.
const LARGE: &str = "sqrt(x*x + y*y + z*z) - 90.0";
/// What was at the final name before.
const OLD: &str = "; an older print\n";
/// How long to wait for what should take a moment.
const PATIENCE: Duration = Duration::from_secs(60);

fn folder() -> TempDir {
    tempfile::tempdir().unwrap()
}

fn program() -> PathBuf {
    assert_cmd::cargo::cargo_bin!("isoslice").to_owned()
}

/// The program, with all signals as they are by default: whoever runs the
/// tests may ignore some, in the background or under nohup, and what they start
/// would, too. GNU's `env` can do that.
fn isoslice(folder: &Path) -> Command {
    static HELPS: OnceLock<bool> = OnceLock::new();
    const BY_DEFAULT: &str = "--default-signal";
    let helps = HELPS.get_or_init(|| {
        let tried = Command::new("env")
            .args([BY_DEFAULT, "true"])
            .stderr(Stdio::null())
            .status();
        tried.is_ok_and(|status| status.success())
    });
    let mut command = if *helps {
        Command::new("env")
    } else {
        Command::new(program())
    };
    if *helps {
        command.arg(BY_DEFAULT).arg(program());
    }
    command
        .current_dir(folder)
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    command
}

/// A line of the shell, in which `$ISOSLICE` is the program.
fn shell(folder: &Path, line: &str) -> Command {
    let mut command = Command::new("sh");
    command
        .args(["-c", line])
        .current_dir(folder)
        .env("ISOSLICE", program());
    command
}

/// Names in a folder, hidden ones included.
fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<_> = fs::read_dir(folder)
        .unwrap()
        .map(|e| e.unwrap().file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    names
}

#[track_caller]
fn assert_fails(output: &Output, words: &str) {
    let text = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{text}");
    assert!(text.contains(words), "{words:?} is not in: {text}");
    assert!(!text.contains("panicked"), "{text}");
}

/// A file system of its own, unmounted when dropped.
struct Mount(TempDir);

impl Mount {
    /// None if this user, or this machine, may not mount anything.
    fn new(options: &str) -> Option<Mount> {
        let folder = folder();
        let mounted = Command::new("mount")
            .args(["-t", "tmpfs", "-o", options, "tmpfs"])
            .arg(folder.path())
            .stderr(Stdio::null())
            .status();
        mounted
            .is_ok_and(|status| status.success())
            .then(|| Mount(folder))
    }

    fn path(&self) -> &Path {
        self.0.path()
    }
}

impl Drop for Mount {
    fn drop(&mut self) {
        let _ = Command::new("umount").arg(self.path()).status();
    }
}

#[test]
fn a_full_disk_leaves_the_old_output() {
    let Some(disk) = Mount::new("size=64k") else {
        eprintln!("skipped: no right to mount a small disk");
        return;
    };
    let models = folder();
    fs::write(models.path().join("ball.rhai"), LARGE).unwrap();
    fs::write(disk.path().join("part.gcode"), OLD).unwrap();
    let output = isoslice(models.path())
        .args(["slice", "ball.rhai", "--set", "layer_height=0.4", "-o"])
        .arg(disk.path().join("part.gcode"))
        .output()
        .unwrap();
    assert_fails(&output, "No space left");
    let text = String::from_utf8_lossy(&output.stderr);
    assert!(
        text.contains("part.gcode") || text.contains("cannot"),
        "{text}"
    );
    assert_eq!(names(disk.path()), ["part.gcode"]);
    let old = fs::read_to_string(disk.path().join("part.gcode")).unwrap();
    assert_eq!(old, OLD);
}

/// Where nothing can be mounted, a limit on the size of files has to do.
#[test]
fn a_file_that_may_not_grow_is_not_there() {
    let models = folder();
    fs::write(models.path().join("ball.rhai"), LARGE).unwrap();
    let output = shell(
        models.path(),
        "trap '' XFSZ; ulimit -f 16; exec \"$ISOSLICE\" slice ball.rhai \
         --set layer_height=0.4",
    )
    .output()
    .unwrap();
    assert_fails(&output, "File too large");
    assert_eq!(names(models.path()), ["ball.rhai"]);
}

/// However full the disk is, either both files of a new part are there, or
/// none.
#[test]
fn a_new_part_is_there_or_not() {
    let mut seen = [false; 2];
    // Blocks of 512 bytes.
    for blocks in 0..20 {
        let folder = folder();
        let output = shell(
            folder.path(),
            &format!(
                "trap '' XFSZ; ulimit -f {blocks}; exec \"$ISOSLICE\" new part"
            ),
        )
        .output()
        .unwrap();
        let whole = output.status.success();
        if whole {
            assert_eq!(names(folder.path()), ["part.rhai", "part.toml"]);
        } else {
            assert_fails(&output, "cannot write part.");
            assert_eq!(names(folder.path()), [""; 0], "{blocks}");
        }
        seen[usize::from(whole)] = true;
    }
    assert_eq!(seen, [true; 2]);
}

#[cfg(target_os = "linux")]
#[test]
fn a_device_that_is_full_is_an_error() {
    let models = folder();
    fs::write(models.path().join("ball.rhai"), SMALL).unwrap();
    for arguments in [
        &["slice", "ball.rhai", "-o", "/dev/full"][..],
        &["slice", "ball.rhai", "--report", "/dev/full"],
    ] {
        let output = isoslice(models.path()).args(arguments).output().unwrap();
        assert_fails(&output, "No space left");
    }
    // The report was not complete, so neither file was put in its place.
    assert_eq!(names(models.path()), ["ball.rhai"]);
    let full = fs::File::options().write(true).open("/dev/full").unwrap();
    let output = isoslice(models.path())
        .args(["settings"])
        .stdout(full)
        .output()
        .unwrap();
    assert_fails(&output, "No space left");
}

#[test]
fn a_read_only_folder_is_an_error() {
    let models = folder();
    fs::write(models.path().join("ball.rhai"), SMALL).unwrap();
    let plain = folder();
    let closed = fs::Permissions::from_mode(0o555);
    fs::set_permissions(plain.path(), closed).unwrap();
    // The superuser writes where others may not.
    let powerful = fs::write(plain.path().join("probe"), "").is_ok();
    let mount = if powerful { Mount::new("ro") } else { None };
    let target = match (powerful, &mount) {
        (false, _) => plain.path(),
        (true, Some(mount)) => mount.path(),
        (true, None) => {
            eprintln!("skipped: a superuser that may not mount");
            return;
        }
    };
    for option in ["-o", "--report"] {
        let output = isoslice(models.path())
            .args(["slice", "ball.rhai", option])
            .arg(target.join("part"))
            .output()
            .unwrap();
        assert_fails(&output, "cannot write");
        assert_eq!(names(target), [""; 0]);
        assert_eq!(names(models.path()), ["ball.rhai"], "{option}");
    }
}

#[test]
fn paths_that_cannot_be_are_errors() {
    let models = folder();
    fs::write(models.path().join("ball.rhai"), SMALL).unwrap();
    fs::write(models.path().join("file"), OLD).unwrap();
    fs::create_dir(models.path().join("sub")).unwrap();
    symlink("nowhere/x.gcode", models.path().join("dangling")).unwrap();
    let long = "x".repeat(300);
    for path in [
        "nowhere/part.gcode",
        "file/part.gcode",
        "sub",
        "sub/",
        ".",
        "..",
        "/",
        "",
        "dangling",
        &long,
        "/proc/part.gcode",
    ] {
        let output = isoslice(models.path())
            .args(["slice", "ball.rhai", "-o", path])
            .output()
            .unwrap();
        let text = String::from_utf8_lossy(&output.stderr);
        assert!(!output.status.success(), "{path:?} was written");
        assert!(output.status.code().is_some(), "{path:?}: {text}");
        assert!(!text.contains("panicked"), "{path:?}: {text}");
        let left = names(models.path());
        assert_eq!(left, ["ball.rhai", "dangling", "file", "sub"], "{path:?}");
        assert_eq!(names(&models.path().join("sub")), [""; 0], "{path:?}");
    }
    assert_eq!(fs::read_to_string(models.path().join("file")).unwrap(), OLD);
}

#[test]
fn an_output_that_is_an_input_is_refused_by_any_name() {
    let models = folder();
    let root = models.path();
    fs::create_dir(root.join("sub")).unwrap();
    fs::write(root.join("ball.rhai"), SMALL).unwrap();
    fs::write(root.join("my.toml"), "walls = 1\n").unwrap();
    symlink("ball.rhai", root.join("link")).unwrap();
    symlink("../link", root.join("sub/link")).unwrap();
    fs::hard_link(root.join("ball.rhai"), root.join("hard")).unwrap();
    fs::hard_link(root.join("my.toml"), root.join("hard.toml")).unwrap();
    let before = names(root);
    let absolute = root.join("ball.rhai");
    for target in [
        "ball.rhai",
        "./ball.rhai",
        "sub/../ball.rhai",
        absolute.to_str().unwrap(),
        "link",
        "sub/link",
        "hard",
        "my.toml",
        "hard.toml",
    ] {
        for option in ["-o", "--report"] {
            let output = isoslice(root)
                .args(["slice", "ball.rhai", "--config", "my.toml"])
                .args([option, target])
                .output()
                .unwrap();
            assert_fails(&output, "is also an input");
            assert_eq!(names(root), before, "{option} {target}");
        }
    }
    // The model is known through a link as well.
    let output = isoslice(root)
        .args(["slice", "ball.rhai", "-o", "g", "--report", "g"])
        .output()
        .unwrap();
    assert_fails(&output, "both be");
    assert_eq!(fs::read_to_string(absolute).unwrap(), SMALL);
    let settings = fs::read_to_string(root.join("my.toml")).unwrap();
    assert_eq!(settings, "walls = 1\n");
}

#[test]
fn a_link_stays_one_and_its_target_is_replaced() {
    let models = folder();
    let root = models.path();
    fs::create_dir(root.join("prints")).unwrap();
    fs::write(root.join("ball.rhai"), SMALL).unwrap();
    fs::write(root.join("prints/old.gcode"), OLD).unwrap();
    symlink("prints/old.gcode", root.join("part.gcode")).unwrap();
    let output = isoslice(root)
        .args(["slice", "ball.rhai", "-o", "part.gcode"])
        .output()
        .unwrap();
    assert!(output.status.success());
    let link = fs::symlink_metadata(root.join("part.gcode")).unwrap();
    assert!(link.is_symlink());
    let text = fs::read_to_string(root.join("prints/old.gcode")).unwrap();
    assert!(text.contains("; end of layers"));
    assert_eq!(names(&root.join("prints")), ["old.gcode"]);
}

/// A run that is at work, with its temporary file there.
fn at_work(folder: &Path, arguments: &[&str]) -> Child {
    fs::write(folder.join("ball.rhai"), LARGE).unwrap();
    let mut child = isoslice(folder)
        .args(["slice", "ball.rhai"])
        .args(["--set", "layer_height=0.05", "--set", "sample_spacing=0.05"])
        .args(arguments)
        .spawn()
        .unwrap();
    wait_for_work(folder, &mut child);
    child
}

fn wait_for_work(folder: &Path, child: &mut Child) {
    let started = Instant::now();
    let temporary =
        || names(folder).iter().any(|n| n.starts_with(".isoslice-"));
    while !temporary() {
        assert!(started.elapsed() < PATIENCE, "it does not start");
        assert_eq!(child.try_wait().unwrap(), None, "it has ended");
        std::thread::sleep(Duration::from_millis(10));
    }
    // By then the run is slicing.
    std::thread::sleep(Duration::from_millis(500));
    assert_eq!(child.try_wait().unwrap(), None, "it has ended");
}

fn signal(child: &Child, name: &str) {
    let sent = Command::new("kill")
        .args([format!("-{name}"), child.id().to_string()])
        .status()
        .unwrap();
    assert!(sent.success());
}

#[track_caller]
fn wait(child: &mut Child) -> std::process::ExitStatus {
    let started = Instant::now();
    loop {
        if let Some(status) = child.try_wait().unwrap() {
            return status;
        }
        if started.elapsed() > PATIENCE {
            child.kill().unwrap();
            panic!("it does not end");
        }
        std::thread::sleep(Duration::from_millis(10));
    }
}

#[test]
fn an_interrupted_run_cleans_up() {
    for name in ["INT", "TERM", "HUP"] {
        let folder = folder();
        let root = folder.path();
        fs::write(root.join("ball.gcode"), OLD).unwrap();
        let mut child = at_work(root, &["--report", "ball.json"]);
        signal(&child, name);
        let status = wait(&mut child);
        assert_eq!(status.code(), Some(130), "{name}: {status}");
        assert_eq!(names(root), ["ball.gcode", "ball.rhai"], "{name}");
        let old = fs::read_to_string(root.join("ball.gcode")).unwrap();
        assert_eq!(old, OLD, "{name}");
    }
}

#[test]
fn a_run_beyond_its_limits_cleans_up() {
    for (limit, value) in [("--time-limit", "1s"), ("--memory-limit", "2MB")] {
        let folder = folder();
        let root = folder.path();
        fs::write(root.join("ball.rhai"), LARGE).unwrap();
        let output = isoslice(root)
            .args(["slice", "ball.rhai", "--set", "layer_height=0.05"])
            .args(["--set", "sample_spacing=0.05", limit, value])
            .output()
            .unwrap();
        assert_fails(&output, limit);
        assert_eq!(names(root), ["ball.rhai"], "{limit}");
    }
}

/// If a run is killed at any moment, the file of the final name is as before or
/// complete. What is left besides can be told by its name.
#[test]
fn a_killed_run_leaves_no_half_file() {
    let folder = folder();
    let root = folder.path();
    fs::write(root.join("ball.rhai"), SMALL).unwrap();
    let run = |root: &Path| {
        isoslice(root)
            .args(["slice", "ball.rhai", "-o", "part.gcode"])
            .spawn()
            .unwrap()
    };
    let started = Instant::now();
    assert!(wait(&mut run(root)).success());
    let whole_run = started.elapsed();
    let whole = fs::read_to_string(root.join("part.gcode")).unwrap();
    fs::remove_file(root.join("part.gcode")).unwrap();
    let (mut absent, mut complete) = (0, 0);
    // The moments are spread evenly, by the golden ratio, over a little more
    // than a run.
    for k in 0..40 {
        let share = (f64::from(k) * 0.618_034).fract() * 1.2;
        let mut child = run(root);
        std::thread::sleep(whole_run.mul_f64(share));
        child.kill().unwrap();
        let status = child.wait().unwrap();
        assert!(status.signal() == Some(9) || status.success());
        for name in names(root) {
            match name.as_str() {
                "ball.rhai" => {}
                "part.gcode" => {
                    let text = fs::read_to_string(root.join(&name)).unwrap();
                    assert!(text == whole, "half a file after {share} of it");
                    complete += 1;
                }
                _ => {
                    assert!(name.starts_with(".isoslice-"), "{name}");
                    assert!(name.ends_with(".tmp"), "{name}");
                }
            }
        }
        absent += u32::from(fs::remove_file(root.join("part.gcode")).is_err());
        let model = fs::read_to_string(root.join("ball.rhai")).unwrap();
        assert_eq!(model, SMALL);
    }
    eprintln!("killed: {absent} without output, {complete} with all of it");
    // What earlier runs left does not disturb a later one.
    assert!(wait(&mut run(root)).success());
    let text = fs::read_to_string(root.join("part.gcode")).unwrap();
    assert!(text == whole);
}

/// Nothing is said, and nobody can take what was written for all of it.
#[test]
fn a_reader_that_goes_away_ends_the_run_quietly() {
    let folder = folder();
    let root = folder.path();
    fs::write(root.join("ball.rhai"), SMALL).unwrap();
    for (arguments, left) in [
        ("slice ball.rhai -o /dev/stdout", vec!["ball.rhai"]),
        ("slice ball.rhai -o -", vec!["ball.rhai"]),
        ("render ball.rhai -o -", vec!["ball.rhai"]),
        // The file is whole; only the summary has no reader.
        ("slice ball.rhai", vec!["ball.gcode", "ball.rhai"]),
        ("check ball.gcode", vec!["ball.gcode", "ball.rhai"]),
        ("settings", vec!["ball.gcode", "ball.rhai"]),
        ("info ball.rhai", vec!["ball.gcode", "ball.rhai"]),
    ] {
        let mut child =
            isoslice(root).args(arguments.split(' ')).spawn().unwrap();
        drop(child.stdout.take());
        let output = child.wait_with_output().unwrap();
        let text = String::from_utf8_lossy(&output.stderr);
        assert_eq!(text, "", "{arguments}");
        assert_eq!(output.status.code(), Some(141), "{arguments}");
        assert_eq!(names(root), left, "{arguments}");
    }
}

/// A large part, sliced by a shell that first does as it is told.
fn at_work_after(folder: &Path, orders: &str) -> Child {
    fs::write(folder.join("ball.rhai"), LARGE).unwrap();
    let line = format!(
        "{orders}; exec \"$ISOSLICE\" slice ball.rhai \
         --set layer_height=0.05 --set sample_spacing=0.05"
    );
    let mut child = shell(folder, &line)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    wait_for_work(folder, &mut child);
    child
}

/// Signals that `nohup`, or a shell that starts a job in the background, lets a
/// run ignore stay ignored. A run that other signals end cleans up all the
/// same.
#[test]
fn a_signal_that_is_ignored_stays_so() {
    for (ignored, sent) in [("HUP", "TERM"), ("INT", "TERM"), ("INT", "HUP")] {
        let folder = folder();
        let root = folder.path();
        let mut child = at_work_after(root, &format!("trap '' {ignored}"));
        signal(&child, ignored);
        std::thread::sleep(Duration::from_millis(500));
        assert_eq!(child.try_wait().unwrap(), None, "it has ended");
        if sent == "HUP" && hung_up_is_ignored() {
            child.kill().unwrap();
            child.wait().unwrap();
            continue;
        }
        signal(&child, sent);
        let status = wait(&mut child);
        assert_eq!(status.code(), Some(130), "{ignored}, {sent}: {status}");
        assert_eq!(names(root), ["ball.rhai"], "{ignored}, {sent}");
    }
}

/// True if whoever runs the tests ignores the end of a terminal, as nohup does.
fn hung_up_is_ignored() -> bool {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|l| l.strip_prefix("SigIgn:"));
    let mask = mask.and_then(|m| u64::from_str_radix(m.trim(), 16).ok());
    mask.is_some_and(|mask| mask & 1 != 0)
}

/// Signals that end a program unless it handles them leave nothing, either.
#[test]
fn other_ways_to_be_ended_clean_up() {
    for name in ["QUIT", "USR1", "ALRM", "XCPU"] {
        let folder = folder();
        let root = folder.path();
        let mut child = at_work(root, &[]);
        signal(&child, name);
        let status = wait(&mut child);
        assert_eq!(status.code(), Some(130), "{name}: {status}");
        assert_eq!(names(root), ["ball.rhai"], "{name}");
    }
}

/// The signal that a limit on the size of files sends does not end the run.
#[test]
fn a_file_that_grows_too_large_is_an_error() {
    let models = folder();
    fs::write(models.path().join("ball.rhai"), LARGE).unwrap();
    let output = shell(models.path(), "ulimit -f 16; exec \"$ISOSLICE\" slice ball.rhai --set layer_height=0.4").output().unwrap();
    assert_fails(&output, "File too large");
    assert_eq!(names(models.path()), ["ball.rhai"]);
}

/// Rust's own runtime would write the output to /dev/null.
#[cfg(target_os = "linux")]
#[test]
fn a_standard_output_that_is_closed_is_an_error() {
    let folder = folder();
    let root = folder.path();
    fs::write(root.join("ball.rhai"), SMALL).unwrap();
    let run = |arguments: &str, streams: &str| {
        let line = format!("\"$ISOSLICE\" {arguments} {streams}");
        shell(root, &line).output().unwrap()
    };
    for arguments in [
        "slice ball.rhai -o -",
        "slice ball.rhai -o /dev/stdout",
        "render ball.rhai -o -",
        "info ball.rhai",
        "settings",
        "profiles",
        "man",
    ] {
        assert_fails(&run(arguments, ">&-"), "no standard output");
        assert_eq!(names(root), ["ball.rhai"], "{arguments}");
        let kept = run(arguments, ">/dev/null");
        assert!(kept.status.success(), "{arguments}: {kept:?}");
    }
    // Standard output is not needed where there is a file, nor are other
    // streams.
    for streams in [">&-", "2>&-", "<&-", "<&- >&- 2>&-"] {
        assert!(run("slice ball.rhai", streams).status.success());
        fs::remove_file(root.join("ball.gcode")).unwrap();
        assert_eq!(names(root), ["ball.rhai"], "{streams}");
    }
}

/// However little address space there is, the error says so, and nothing is
/// aborted.
#[cfg(target_os = "linux")]
#[test]
fn too_little_address_space_is_said() {
    let folder = folder();
    let root = folder.path();
    fs::write(root.join("ball.rhai"), SMALL).unwrap();
    let formula = "-e 'sqrt(x^2+y^2+z^2)-3'";
    for (kilobytes, arguments) in [
        (70_000, "slice ball.rhai"),
        (70_000, &format!("render {formula} -o ball.png")),
        (100_000, &format!("info {formula}")),
        (200_000, &format!("slice {formula}")),
    ] {
        let output = shell(
            root,
            &format!("ulimit -v {kilobytes}; exec \"$ISOSLICE\" {arguments}"),
        )
        .output()
        .unwrap();
        assert_fails(&output, "ulimit -v");
        assert_eq!(names(root), ["ball.rhai"], "{arguments}");
    }
}

/// What is no file, or has no end, is refused soon, whatever it was given as.
#[cfg(target_os = "linux")]
#[test]
fn endless_files_are_refused() {
    let folder = folder();
    let root = folder.path();
    fs::write(root.join("ball.rhai"), SMALL).unwrap();
    symlink("/dev/zero", root.join("zero.toml")).unwrap();
    symlink("/dev/zero", root.join("zero.rhai")).unwrap();
    fs::write(root.join("heir.toml"), "inherits = \"zero.toml\"\n").unwrap();
    for arguments in [
        "slice ball.rhai --config /dev/zero",
        "slice ball.rhai --config zero.toml",
        "slice ball.rhai --printer ./zero.toml",
        "slice ball.rhai --printer ./heir.toml",
        "settings --config /dev/zero",
        "slice zero.rhai",
        "slice ball.rhai --set infill=zero.rhai",
    ] {
        let output = isoslice(root)
            .args(arguments.split(' '))
            .args(if arguments.starts_with("slice") {
                &["--memory-limit", "120MB"][..]
            } else {
                &[]
            })
            .output()
            .unwrap();
        assert_fails(&output, "larger than");
        assert!(!root.join("ball.gcode").exists(), "{arguments}");
    }
}

/// Devices that are no G-code are known to be none, without any limit.
#[cfg(target_os = "linux")]
#[test]
fn the_check_refuses_what_has_no_end() {
    let folder = folder();
    for device in ["/dev/zero", "/dev/urandom"] {
        let started = Instant::now();
        let output = isoslice(folder.path())
            .args(["check", device])
            .output()
            .unwrap();
        assert_eq!(output.status.code(), Some(1), "{output:?}");
        let said = String::from_utf8(output.stdout).unwrap();
        assert!(said.contains("this is no G-code"), "{said}");
        assert!(started.elapsed() < PATIENCE, "{device}");
    }
}

/// A pipe that nobody writes to ends with the run's time.
#[test]
fn a_pipe_does_not_outlast_the_limit() {
    let folder = folder();
    let root = folder.path();
    fs::write(root.join("ball.rhai"), SMALL).unwrap();
    for name in ["pipe.rhai", "pipe.toml"] {
        let made = Command::new("mkfifo").arg(root.join(name)).status();
        assert!(made.unwrap().success());
    }
    let before = names(root);
    for arguments in [
        "slice pipe.rhai",
        "info pipe.rhai",
        "render pipe.rhai",
        "slice ball.rhai --config pipe.toml",
        "slice ball.rhai --printer ./pipe.toml",
        "slice ball.rhai --set infill=pipe.rhai",
    ] {
        let output = isoslice(root)
            .args(arguments.split(' '))
            .args(["--time-limit", "0.5"])
            .output()
            .unwrap();
        assert_fails(&output, "--time-limit");
        assert_eq!(names(root), before, "{arguments}");
    }
    // A pipe that somebody does write to is as good as a file.
    let output = shell(
        root,
        "cat ball.rhai > pipe.rhai & exec \"$ISOSLICE\" info pipe.rhai",
    )
    .output()
    .unwrap();
    assert!(output.status.success(), "{output:?}");
}

#[test]
fn profiles_do_not_inherit_for_ever() {
    let folder = folder();
    let root = folder.path();
    fs::write(root.join("ball.rhai"), SMALL).unwrap();
    for k in 0..2000 {
        let text = format!("inherits = \"p{}.toml\"\n", k + 1);
        fs::write(root.join(format!("p{k}.toml")), text).unwrap();
    }
    let output = isoslice(root)
        .args(["slice", "ball.rhai", "--preset", "p0.toml"])
        .output()
        .unwrap();
    assert_fails(&output, "p0, which inherits p1");
}

#[test]
fn reading_and_drawing_have_their_limits() {
    let folder = folder();
    let root = folder.path();
    // This field is proved neither full nor empty down to the smallest tile.
    fs::write(
        root.join("dust.rhai"),
        "sin(x*900) + sin(y*900) + sin(z*900)",
    )
    .unwrap();
    let render = "render dust.rhai --bounds=-50,-50,0:50,50,100 \
                  --pixels 4096x4096 --time-limit 0.3";
    // G-code without end, which could be a long file.
    let check = "check - --time-limit 0.3";
    for arguments in [render, check] {
        let started = Instant::now();
        let output = shell(
            root,
            &format!("yes 'G1 X1\nG1 X2' | exec \"$ISOSLICE\" {arguments}"),
        )
        .output()
        .unwrap();
        assert_fails(&output, "the time limit (--time-limit)");
        assert!(started.elapsed() < PATIENCE, "{arguments}");
        assert_eq!(names(root), ["dust.rhai"], "{arguments}");
    }
}

#[test]
fn a_model_that_cannot_be_read_is_an_error() {
    let folder = folder();
    fs::create_dir(folder.path().join("dir.rhai")).unwrap();
    symlink("loop.rhai", folder.path().join("loop.rhai")).unwrap();
    fs::write(folder.path().join("empty.rhai"), "").unwrap();
    fs::write(folder.path().join("empty.vm"), "").unwrap();
    fs::write(folder.path().join("binary.rhai"), [0xFF, 0xFE, 0]).unwrap();
    let before = names(folder.path());
    for name in [
        "dir.rhai",
        "loop.rhai",
        "empty.rhai",
        "empty.vm",
        "binary.rhai",
    ] {
        let output = isoslice(folder.path())
            .args(["slice", name])
            .output()
            .unwrap();
        assert_fails(&output, "error");
        assert_eq!(names(folder.path()), before, "{name}");
    }
}
