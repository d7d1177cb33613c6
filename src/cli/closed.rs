//! Finds out whether the program was started without a standard output (`>&-`).
//!
//! Before `main` begins, Rust's runtime opens `/dev/null` in the place of a
//! closed standard stream. Whatever is written there vanishes without an error,
//! and `main` cannot tell it from a `/dev/null` that the user asked for. On
//! Linux a function that is called while the program is loaded can still tell.
//! On other systems no stream counts as closed.

use anyhow::bail;
use std::fs;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

static OUTPUT: AtomicBool = AtomicBool::new(false);

#[cfg(target_os = "linux")]
#[used]
#[expect(unsafe_code, reason = "the section's name is the linker's business")]
// SAFETY: the section is a list of functions without results, which need none
// of their arguments. `look` is such a function.
#[unsafe(link_section = ".init_array")]
static AT_LOADING: extern "C" fn() = look;

#[cfg(target_os = "linux")]
extern "C" fn look() {
    let there = |path: &str| fs::symlink_metadata(path).is_ok();
    // Without /proc a stream does not count as closed.
    let closed = there("/proc/self/fd") && !there("/proc/self/fd/1");
    OUTPUT.store(closed, Ordering::Relaxed);
}

/// Makes sure that standard output leads somewhere.
///
/// # Errors
/// If standard output is closed.
pub(super) fn need_output() -> anyhow::Result<()> {
    if OUTPUT.load(Ordering::Relaxed) {
        bail!("there is no standard output to write to: it is closed (>&-)");
    }
    Ok(())
}

/// True if a path names standard output.
pub(super) fn is_output(path: &Path) -> bool {
    ["/dev/stdout", "/dev/fd/1", "/proc/self/fd/1"]
        .iter()
        .any(|name| path == Path::new(name))
}
