//! What the fuzzer starts from, and what it once found, on every test run.
//!
//! The targets are the fuzzer's own; CONTRIBUTING.md says how to run it.

#![allow(clippy::panic, reason = "helpers of tests may fail, too")]

#[path = "../fuzz/targets.rs"]
mod targets;

use std::fs;
use std::path::Path;

#[test]
fn every_seed_comes_through() {
    let seeds = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/seeds");
    for (name, target) in targets::TARGETS {
        let files = fs::read_dir(seeds.join(name));
        let mut files: Vec<_> = files
            .unwrap_or_else(|error| panic!("{name}: {error}"))
            .map(|entry| entry.unwrap_or_else(|e| panic!("{e}")).path())
            .collect();
        files.sort();
        assert!(files.len() > 2, "{name} has no seeds");
        for file in files {
            // Shown if it fails.
            println!("{}", file.display());
            let bytes = fs::read(&file).unwrap_or_else(|e| panic!("{e}"));
            target(&bytes);
        }
    }
}
