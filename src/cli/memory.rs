//! Large blocks of memory go back to the system as soon as they are free.
//!
//! The outlines, grids and sweeps of a large layer take megabytes, and come and
//! go on every thread. The GNU C library's allocator begins by asking the
//! system for each such block, but learns from the first ones that are freed
//! to cut them out of its heaps, up to 32 MB: what stays in use between them
//! then keeps the heaps from shrinking. On layers of 300 mm that was about a
//! third of all memory, and it gained no time.
//!
//! What is smaller comes and goes with every slab: heaps may keep some room for
//! it, or the system is asked for the same pages again and again.

/// Bytes of a block that the system is asked for, and gets back.
#[cfg(all(target_os = "linux", target_env = "gnu"))]
const LARGE: i32 = 4 << 20;

/// Bytes that a heap may have free at its end.
#[cfg(all(target_os = "linux", target_env = "gnu"))]
const ROOM: i32 = 4 << 20;

/// Keeps the allocator from learning otherwise.
#[cfg_attr(
    all(target_os = "linux", target_env = "gnu"),
    expect(unsafe_code, reason = "the allocator's settings are C's")
)]
pub(super) fn return_large_blocks() {
    // Where it does not work, nothing is lost but memory.
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    // SAFETY: takes and returns numbers, and changes under the allocator's own
    // lock when blocks that are not yet allocated come from the system.
    let _ = unsafe {
        libc::mallopt(libc::M_MMAP_THRESHOLD, LARGE);
        libc::mallopt(libc::M_TRIM_THRESHOLD, ROOM)
    };
}
