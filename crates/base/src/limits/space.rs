//! The address space that the system allows the process (`ulimit -v`).
//!
//! If an allocation fails for lack of address space, the process is aborted at
//! once. So the space is checked before that can happen.

use std::fs;
use std::sync::OnceLock;

/// Address space that a command needs, bytes: the program, the stacks of a few
/// threads, and each thread's heap, for which the C library reserves far more
/// than is used.
const NEEDED: u64 = 400 << 20;

/// Address space that must be left, bytes: as much as a run takes between two
/// looks.
const ROOM: u64 = 24 << 20;

/// There is too little address space to begin.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "the system allows only {} MB of address space (ulimit -v), and isoslice \
     needs at least {} MB; raise that limit, and bound its memory with \
     --memory-limit",
    .allowed >> 20, NEEDED >> 20
)]
pub struct TooLittleSpace {
    /// The address space that the system allows, bytes.
    pub allowed: u64,
}

/// Checks that there is enough address space to begin.
///
/// # Errors
/// If there is too little.
pub fn enough_space() -> Result<(), TooLittleSpace> {
    match allowed() {
        Some(allowed) if allowed < NEEDED => Err(TooLittleSpace { allowed }),
        _ => Ok(()),
    }
}

/// True if nearly all of the address space is taken.
pub(super) fn is_used_up() -> bool {
    allowed().is_some_and(|allowed| {
        memory_stats::memory_stats()
            .is_some_and(|m| m.virtual_mem as u64 > allowed - ROOM.min(allowed))
    })
}

/// Address space that the process may have, bytes, if there is a limit and the
/// system tells it.
pub(super) fn allowed() -> Option<u64> {
    static ALLOWED: OnceLock<Option<u64>> = OnceLock::new();
    *ALLOWED.get_or_init(|| soft_limit(&fs::read_to_string(LIMITS).ok()?))
}

/// The file in which Linux tells the limit.
const LIMITS: &str = "/proc/self/limits";

fn soft_limit(limits: &str) -> Option<u64> {
    let mut lines = limits.lines();
    let line = lines.find_map(|l| l.strip_prefix("Max address space"))?;
    line.split_whitespace().next()?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_limit_is_read_if_there_is_one() {
        let with = |value: &str| {
            soft_limit(&format!(
                "Limit             Soft Limit  Hard Limit  Units\n\
                 Max cpu time      unlimited   unlimited   seconds\n\
                 Max address space {value}     unlimited   bytes\n"
            ))
        };
        assert_eq!(with("40960000"), Some(40_960_000));
        assert_eq!(with("unlimited"), None);
        assert_eq!(soft_limit(""), None);
    }
}
