//! The guide's commands, run as a reader would: each page in a folder of its
//! own, with the files that the page shows. Bash, in which a pipe fails if any
//! part of it does, and no other profiles than the page's.
//!
//! ````text
//! ```toml name.toml    is written to a file of that name
//! ```sh                each line is a command, which must succeed
//! ````
#![cfg(unix)]
#![allow(
    clippy::panic,
    clippy::unwrap_used,
    reason = "helpers of tests may fail, too"
)]

use crate::program::isoslice;
use std::path::{Path, PathBuf};
use std::process::Command;

/// A block between two lines of three backquotes.
struct Block {
    /// What stands behind the first of them.
    info: String,
    text: String,
    /// Line of the page on which it begins, from 1.
    line: usize,
}

fn blocks(page: &str) -> Vec<Block> {
    let mut found: Vec<Block> = Vec::new();
    let mut open = false;
    for (i, line) in page.lines().enumerate() {
        match (line.strip_prefix("```"), open) {
            (Some(info), false) => {
                open = true;
                found.push(Block {
                    info: info.trim().to_owned(),
                    text: String::new(),
                    line: i + 2,
                });
            }
            (Some(_), true) => open = false,
            (None, true) => {
                let block = found.last_mut().unwrap();
                block.text.push_str(line);
                block.text.push('\n');
            }
            (None, false) => {}
        }
    }
    assert!(!open, "a block is not closed");
    found
}

/// Runs a page; returns how many commands it had.
fn run(page: &Path) -> usize {
    let text = std::fs::read_to_string(page).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let binary = Path::new(env!("CARGO_BIN_EXE_isoslice"));
    let path = format!(
        "{}:{}",
        binary.parent().unwrap().display(),
        std::env::var("PATH").unwrap_or_default()
    );
    let mut commands = 0;
    for block in blocks(&text) {
        let words: Vec<&str> = block.info.split_whitespace().collect();
        match words[..] {
            ["sh"] => {}
            [_, name] => {
                let file = folder.path().join(name);
                std::fs::create_dir_all(file.parent().unwrap()).unwrap();
                std::fs::write(file, block.text).unwrap();
                continue;
            }
            _ => continue,
        }
        for (i, line) in block.text.lines().enumerate() {
            let output = Command::new("bash")
                // Each part of a pipe must succeed.
                .args(["-o", "pipefail", "-c", line])
                .current_dir(folder.path())
                .env("PATH", &path)
                // No profiles but those of the binary.
                .env("XDG_CONFIG_HOME", folder.path())
                .env_remove("ISOSLICE_PROFILES")
                .output()
                .unwrap();
            assert!(
                output.status.success(),
                "{}:{}: {line}\n{}",
                page.display(),
                block.line + i,
                String::from_utf8_lossy(&output.stderr)
            );
            commands += 1;
        }
    }
    commands
}

fn pages() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs");
    let mut pages: Vec<PathBuf> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|e| e == "md"))
        .collect();
    pages.sort();
    pages
}

#[test]
fn every_command_of_the_guide_works() {
    let commands: usize = pages().iter().map(|page| run(page)).sum();
    assert!(commands > 10, "{commands}");
}

#[test]
fn links_lead_somewhere() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    for page in pages().into_iter().chain([root.join("README.md")]) {
        let text = std::fs::read_to_string(&page).unwrap();
        for link in text.split("](").skip(1) {
            let link = link.split([')', ' ']).next().unwrap_or_default();
            if link.contains("://") {
                continue;
            }
            let (target, heading) = link.split_once('#').unwrap_or((link, ""));
            let file = match target {
                "" => page.clone(),
                _ => page.parent().unwrap().join(target),
            };
            assert!(file.exists(), "{}: {target}", page.display());
            if !heading.is_empty() {
                let there = std::fs::read_to_string(&file).unwrap();
                let heads = there.lines().filter(|line| line.starts_with('#'));
                let found = heads.map(anchor).any(|head| head == heading);
                assert!(found, "{}: {link}", page.display());
            }
        }
    }
}

/// What a link says for a line that is a heading.
fn anchor(heading: &str) -> String {
    let words = heading.trim_start_matches('#').trim().to_lowercase();
    let kept = |c: &char| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_');
    words
        .chars()
        .filter(kept)
        .collect::<String>()
        .replace(' ', "-")
}

/// Fails on options of a command, and of the commands below it, that no page names.
fn all_named(command: &[&str], guide: &str) {
    let word = |l: &str| l.split([' ', '.', '[']).next().unwrap().to_owned();
    let mut help = isoslice(Path::new("."));
    let help = help.args(command).arg("--help").env("COLUMNS", "200");
    let help = String::from_utf8(help.output().unwrap().stdout).unwrap();
    for line in help.lines() {
        let line = line.trim_start();
        let long = line.find("--").filter(|at| [0, 4].contains(at));
        let Some(option) = long.map(|at| word(&line[at..])) else {
            continue;
        };
        let own = ["--help", "--version"].contains(&&*option);
        assert!(own || guide.contains(&option), "{command:?} {option}");
    }
    let listed = help.split("\nCommands:\n").nth(1).unwrap_or("");
    let listed = listed.split("\n\n").next().unwrap().lines();
    for name in listed.map(|l| word(l.trim_start())) {
        let more = [command, &[&*name]].concat();
        if name != "help" {
            assert!(guide.contains(&name), "{more:?}");
            all_named(&more, guide);
        }
    }
}

#[test]
fn every_option_is_named() {
    let read = |page: &PathBuf| std::fs::read_to_string(page).unwrap();
    let guide: String = pages().iter().map(read).collect();
    all_named(&[], &guide);
}
