//! Whether we were started without a standard output (`>&-`).
//!
//! Before `main` begins, Rust's runtime opens `/dev/null` in the place of a
//! standard stream that is closed: what is written there vanishes without an
//! error, and later nobody can tell it from a `/dev/null` that was asked for.
//! So the question is asked before that, where programs for Linux let functions
//! be called as they are loaded. Elsewhere it has no answer, and none is closed.

use anyhow::bail;
use std::fs;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

static OUTPUT: AtomicBool = AtomicBool::new(false);

#[cfg(target_os = "linux")]
#[used]
#[expect(unsafe_code, reason = "the section's name is the linker's business")]
// SAFETY: the section is a list of functions that take nothing they need and
// return nothing, which is what it holds.
#[unsafe(link_section = ".init_array")]
static AT_LOADING: extern "C" fn() = look;

#[cfg(target_os = "linux")]
extern "C" fn look() {
    let there = |path: &str| fs::symlink_metadata(path).is_ok();
    // Where there is no /proc, nothing is known.
    let closed = there("/proc/self/fd") && !there("/proc/self/fd/1");
    OUTPUT.store(closed, Ordering::Relaxed);
}

/// Makes sure that what is written to standard output gets somewhere.
///
/// # Errors
/// If it is closed.
pub(super) fn need_output() -> anyhow::Result<()> {
    if OUTPUT.load(Ordering::Relaxed) {
        bail!("there is no standard output to write to: it is closed (>&-)");
    }
    Ok(())
}

/// True if a path is a name of standard output.
pub(super) fn is_output(path: &Path) -> bool {
    ["/dev/stdout", "/dev/fd/1", "/proc/self/fd/1"]
        .iter()
        .any(|name| path == Path::new(name))
}
