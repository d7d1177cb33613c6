//! Signals: a request to end removes half-written files first.
//!
//! Guaranteed on Linux: a signal that the parent process ignores, as `nohup`
//! and the background jobs of shells do, stays ignored, and all other signals
//! that end the process clean up. A file that may not grow (`ulimit -f`) is an
//! error of writing. Elsewhere a program cannot see which signals are ignored,
//! so only Ctrl-C and a request to end clean up. Not guaranteed: a signal that
//! cannot be caught may leave a hidden file.

use anyhow::Context;
use isoslice::files::Output;
use signal_hook::consts::{
    SIGALRM, SIGHUP, SIGINT, SIGPROF, SIGQUIT, SIGTERM, SIGUSR1, SIGUSR2,
    SIGVTALRM, SIGXCPU, SIGXFSZ,
};
use signal_hook::flag;
use signal_hook::iterator::Signals;
use std::fs;
use std::process::exit;
use std::sync::Arc;
use std::thread;

/// Exit code of a command that was interrupted, as shells have it for the
/// signal of Ctrl-C.
const INTERRUPTED: i32 = 130;

/// Signals that end a process that does not handle them.
const ENDING: [i32; 10] = [
    SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGXCPU, SIGALRM, SIGUSR1, SIGUSR2,
    SIGVTALRM, SIGPROF,
];

/// Makes a request to end remove half-written files first.
///
/// # Errors
/// If the system refuses it.
pub(super) fn end_cleanly_when_asked() -> anyhow::Result<()> {
    let heeded = |signal: &i32| match ignored() {
        Some(ignored) => ignored >> (signal - 1) & 1 == 0,
        None => matches!(*signal, SIGINT | SIGTERM),
    };
    if heeded(&SIGXFSZ) {
        // With this signal caught, the write fails with an error.
        flag::register(SIGXFSZ, Arc::default())?;
    }
    let ending: Vec<i32> = ENDING.into_iter().filter(heeded).collect();
    let mut signals = Signals::new(ending)?;
    let waiting = thread::Builder::new().name("signals".into());
    waiting
        .spawn(move || {
            if signals.forever().next().is_some() {
                let _pending = Output::discard_all();
                exit(INTERRUPTED);
            }
        })
        .context(
            "cannot start a thread: the system allows too little memory \
             (ulimit -v) or too few threads (ulimit -u)",
        )?;
    Ok(())
}

/// The signals that are ignored, the first in the lowest bit, where the system
/// tells.
fn ignored() -> Option<u64> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let mut lines = status.lines();
    let mask = lines.find_map(|line| line.strip_prefix("SigIgn:"))?;
    u64::from_str_radix(mask.trim(), 16).ok()
}
