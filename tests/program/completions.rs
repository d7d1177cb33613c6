//! What shells offer while a command is typed.

use crate::program::isoslice;
use std::fs;
use std::path::Path;
use std::process::Command;
use tempfile::TempDir;

const SCRIPT: &str = "let w = param(\"width\", 10.0, \"of the box\");\n\
                      let kind = param(\"wall\", 1, \"\", #{choices: [1, 2]});\n\
                      draw(box(#{lower: [0, 0, 0], upper: [w, 8, 6]}));\n";

/// A folder with a script, a profile and a host.
fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    fs::write(path.join("part.rhai"), SCRIPT).unwrap();
    fs::create_dir_all(path.join("profiles/printers")).unwrap();
    let mine = "description = \"Mine\"\ninherits = \"ender-3\"\n";
    fs::write(path.join("profiles/printers/ender-mine.toml"), mine).unwrap();
    let added = isoslice(path)
        .args(["printers", "add", "workshop", "--host", "octoprint"])
        .args(["--url", "http://127.0.0.1:1", "--no-key"])
        .write_stdin("")
        .output()
        .unwrap();
    assert!(added.status.success(), "{added:?}");
    folder
}

/// What a shell is offered for the last of these words.
fn offered(shell: &str, folder: &Path, words: &[&str]) -> Vec<String> {
    let mut command = isoslice(folder);
    command
        .env("ISOSLICE_COMPLETE", shell)
        .env("_CLAP_IFS", "\n")
        .env("_CLAP_COMPLETE_INDEX", words.len().to_string())
        .env("_CLAP_COMPLETE_COMP_TYPE", "9")
        .env("_CLAP_COMPLETE_SPACE", "false")
        .args(["--", "isoslice"])
        .args(words);
    let output = command.output().unwrap();
    assert!(output.status.success(), "{output:?}");
    let text = String::from_utf8(output.stdout).unwrap();
    // What follows a tab or, in zsh, a colon describes the word.
    let end = |line: &str| match shell {
        "zsh" => line
            .replace("\\:", "\u{0}")
            .split(':')
            .next()
            .map(str::to_owned),
        _ => line.split('\t').next().map(str::to_owned),
    };
    text.lines().filter_map(end).collect()
}

#[test]
fn settings_profiles_hosts_and_parameters_are_offered_to_every_shell() {
    let folder = folder();
    let path = folder.path();
    for shell in ["bash", "zsh", "fish"] {
        for (words, expected) in [
            (
                &["slice", "part.rhai", "--set", "gcode.flavour=b"][..],
                &["gcode.flavour=bambu"][..],
            ),
            (
                &["info", "--set", "plate.sequence="],
                &["plate.sequence=all-at-once", "plate.sequence=one-by-one"],
            ),
            (
                &["settings", "--printer", "bambu-x1c-0.6"],
                &["bambu-x1c-0.6-nozzle"],
            ),
            (&["slice", "--filament", "pet"], &["petg"]),
            (&["slice", "--preset", "fi"], &["fine"]),
            (&["send", "part.gcode", "--to", "w"], &["workshop"]),
            (&["slice", "part.rhai", "-D", "w"], &["width=", "wall="]),
            (&["info", "part.rhai", "-D", "wall="], &["wall=1", "wall=2"]),
            // A formula may stand there as well.
            (&["slice", "--set", "seam=r"], &["seam=rear", "seam=random"]),
        ] {
            let found = offered(shell, path, words);
            assert_eq!(found, expected, "{shell}: {words:?}");
        }
        // The user's own profiles as well.
        let printers = offered(shell, path, &["slice", "--printer", "ender-"]);
        for name in ["ender-3", "ender-mine"] {
            assert!(
                printers.iter().any(|p| p == name),
                "{shell}: {printers:?}"
            );
        }
        let settings = offered(shell, path, &["slice", "--set", "infill_"]);
        assert!(settings.iter().any(|s| s == "infill_density="));
        assert!(settings.iter().all(|s| s.starts_with("infill_")));
        let commands = offered(shell, path, &["pr"]);
        for name in ["preview", "printers", "profiles"] {
            assert!(
                commands.iter().any(|c| c == name),
                "{shell}: {commands:?}"
            );
        }
    }
}

#[test]
fn what_cannot_be_read_offers_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    fs::write(path.join("wrong.rhai"), "let a = ; loop {}").unwrap();
    fs::write(path.join("endless.rhai"), "loop {}").unwrap();
    for script in ["wrong.rhai", "endless.rhai", "missing.rhai"] {
        let words = ["slice", script, "-D", ""];
        let found = offered("bash", path, &words);
        assert!(found.is_empty(), "{script}: {found:?}");
    }
    let hosts = offered("bash", path, &["send", "a.gcode", "--to", ""]);
    assert!(hosts.is_empty(), "{hosts:?}");
}

#[test]
fn scripts_call_this_program_back() {
    let folder = tempfile::tempdir().unwrap();
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let output = isoslice(folder.path())
            .args(["completions", shell])
            .output()
            .unwrap();
        assert!(output.status.success(), "{shell}");
        let script = String::from_utf8(output.stdout).unwrap();
        assert!(script.contains("ISOSLICE_COMPLETE"), "{shell}: {script}");
        assert!(script.contains("isoslice"), "{shell}: {script}");
    }
}

/// The script works in the shell that it is for.
#[cfg(unix)]
#[test]
fn bash_completes_a_line() {
    let folder = folder();
    let bin = Path::new(env!("CARGO_BIN_EXE_isoslice")).parent().unwrap();
    let path = format!("{}:{}", bin.display(), std::env::var("PATH").unwrap());
    // bash gives the words cut at `=`, the one at the cursor without the sign,
    // and takes what is to stand behind the sign.
    let line = "\
        source <(isoslice completions bash) || exit 3\n\
        compopt() { :; }\n\
        ask() { local found=$(complete -p isoslice); found=${found#*-F }; \
            ${found%% *} isoslice \"$1\" \"$2\"; echo ${COMPREPLY[*]}; }\n\
        of() { COMP_LINE=$1 COMP_POINT=${#1} COMP_TYPE=9; shift; COMP_WORDS=(\"$@\"); \
            COMP_CWORD=$(($# - 1)); local last=${COMP_WORDS[COMP_CWORD]}; \
            ask \"${last#=}\" \"${COMP_WORDS[COMP_CWORD-1]}\"; }\n\
        of 'isoslice slice part.rhai -D wi' isoslice slice part.rhai -D wi\n\
        of 'isoslice slice --set gcode.flavour=b' isoslice slice --set gcode.flavour = b\n\
        of 'isoslice slice --set plate.sequence=' isoslice slice --set plate.sequence =\n\
        of 'isoslice slice --set=gcode.flavour=b' isoslice slice --set = gcode.flavour = b\n\
        of 'isoslice info --set walls=3 part.rhai -D wall=' \
            isoslice info --set walls = 3 part.rhai -D wall =\n";
    let output = Command::new("bash")
        .args(["--norc", "-c", line])
        .current_dir(folder.path())
        .env("PATH", path)
        .env("ISOSLICE_PROFILES", folder.path().join("profiles"))
        .output();
    let output = match output {
        Ok(output) => output,
        Err(error) => {
            eprintln!("skipped: no bash ({error})");
            return;
        }
    };
    let text = String::from_utf8_lossy(&output.stdout);
    let expected = "width=\nbambu\nall-at-once one-by-one\nbambu\n1 2";
    assert_eq!(text.trim(), expected, "{output:?}");
}
