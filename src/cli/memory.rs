//! Gives large blocks of memory back to the system as soon as they are free.
//!
//! The outlines, grids and sweeps of a large layer take megabytes, and come and
//! go on every thread. At first the GNU C library's allocator asks the system
//! for each such block. After it has freed the first ones it takes blocks of up
//! to 32 MB from its heaps. Blocks in use between them then keep the heaps from
//! shrinking. On layers of 300 mm this took about a third of all memory, and
//! saved no time.
//!
//! Smaller blocks come and go with every slab. Heaps keep some room for them,
//! so that the program does not ask the system for the same pages again and
//! again.

/// Least size of a block that comes from the system and goes back to it, bytes.
#[cfg(all(target_os = "linux", target_env = "gnu"))]
const LARGE: i32 = 4 << 20;

/// Room that a heap may keep free at its end, bytes.
#[cfg(all(target_os = "linux", target_env = "gnu"))]
const ROOM: i32 = 4 << 20;

/// Sets these limits, so that the allocator does not change them.
#[cfg_attr(
    all(target_os = "linux", target_env = "gnu"),
    expect(unsafe_code, reason = "the allocator's settings are C's")
)]
pub(super) fn return_large_blocks() {
    // If this fails, the program only takes more memory.
    #[cfg(all(target_os = "linux", target_env = "gnu"))]
    // SAFETY: takes and returns numbers, and changes under the allocator's own
    // lock when blocks that are not yet allocated come from the system.
    let _ = unsafe {
        libc::mallopt(libc::M_MMAP_THRESHOLD, LARGE);
        libc::mallopt(libc::M_TRIM_THRESHOLD, ROOM)
    };
}
