//! Signals: what asks the process to end removes what is half-written first.
//!
//! Guaranteed on Linux: a signal that whoever started us ignores, as `nohup`
//! and shells' background jobs do with some, stays ignored, and the others
//! clean up all the same. A file that may not grow any further (`ulimit -f`)
//! is an error of writing. Elsewhere what is ignored cannot be seen: there, of
//! all these, only Ctrl-C and a request to end clean up. Not guaranteed: that
//! what cannot be caught leaves no hidden file.

use super::output;
use anyhow::Context;
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

/// Exit code of a command that was interrupted: as shells write it for the
/// signal of Ctrl-C.
const INTERRUPTED: i32 = 130;

/// Signals that end a process which does not care for them.
const ENDING: [i32; 10] = [
    SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGXCPU, SIGALRM, SIGUSR1, SIGUSR2,
    SIGVTALRM, SIGPROF,
];

/// From now on a request to end removes what is half-written first.
///
/// # Errors
/// If the system does not let us.
pub(super) fn end_cleanly_when_asked() -> anyhow::Result<()> {
    let heeded = |signal: &i32| match ignored() {
        Some(ignored) => ignored >> (signal - 1) & 1 == 0,
        None => matches!(*signal, SIGINT | SIGTERM),
    };
    if heeded(&SIGXFSZ) {
        // Whoever catches it is told by what was written.
        flag::register(SIGXFSZ, Arc::default())?;
    }
    let ending: Vec<i32> = ENDING.into_iter().filter(heeded).collect();
    let mut signals = Signals::new(ending)?;
    let waiting = thread::Builder::new().name("signals".into());
    waiting
        .spawn(move || {
            if signals.forever().next().is_some() {
                let _pending = output::discard_all();
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
