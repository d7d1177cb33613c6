//! Many slices in one process: no memory is kept, and none disturbs another.

#![allow(
    clippy::panic,
    clippy::unwrap_used,
    reason = "helpers of tests may fail, too"
)]

mod common;

use std::sync::Mutex;

/// Tests run one at a time, since memory is the whole process's.
static ALONE: Mutex<()> = Mutex::new(());

/// Memory of this process that is in use, where the system tells.
fn resident_bytes() -> Option<u64> {
    memory_stats::memory_stats().map(|stats| stats.physical_mem as u64)
}

/// A small part with walls, skin, infill, a hole and a bridge.
const PART: &str = "max(max(max(abs(x) - 4, abs(y) - 4), abs(z) - 1.5), \
                    0.8 - max(abs(x), abs(z)))";

const COARSE: [&str; 6] = [
    "sample_spacing=0.225",
    "layer_height=0.3",
    "first_layer_height=0.3",
    "top_layers=2",
    "bottom_layers=2",
    "infill=gyroid",
];

#[test]
fn two_hundred_slices_in_a_row_keep_no_memory() {
    /// What an allocator may come to hold on to in 190 slices, whatever it
    /// was asked for: a twentieth of what a slice of this part takes, each.
    const SLACK: u64 = 8 << 20;
    let _alone = ALONE.lock().unwrap();
    let Some(_) = resident_bytes() else {
        eprintln!("skipped: the system does not tell the memory in use");
        return;
    };
    let mut first: Option<String> = None;
    let mut after_ten = 0;
    for round in 0..200 {
        // Each slice begins with the model's text.
        let (model, settings) = common::part(PART, &COARSE);
        let gcode = common::slice(&model, &settings, 2).0;
        assert!(gcode.len() > 10_000);
        match &first {
            Some(first) => assert!(*first == gcode, "slice {round} differs"),
            None => first = Some(gcode),
        }
        if round == 9 {
            after_ten = resident_bytes().unwrap();
        }
    }
    let grown = resident_bytes().unwrap().saturating_sub(after_ten);
    assert!(
        grown < SLACK,
        "{grown} bytes more than the {after_ten} after the tenth slice"
    );
}

#[test]
fn eight_at_once_are_the_same() {
    let _alone = ALONE.lock().unwrap();
    let (model, settings) = common::part(PART, &COARSE);
    let alone = common::slice(&model, &settings, 2).0;
    let all: Vec<String> = std::thread::scope(|scope| {
        let threads: Vec<_> = (0..8)
            .map(|_| {
                let (model, settings) = (&model, &settings);
                scope.spawn(move || common::slice(model, settings, 2).0)
            })
            .collect();
        threads.into_iter().map(|t| t.join().unwrap()).collect()
    });
    for (k, gcode) in all.iter().enumerate() {
        assert!(*gcode == alone, "number {k} differs");
    }
}
