//! Work that comes back: on a thread of its own, for so long and in so much
//! memory.
//!
//! In: work of somebody else's making. Out: its result, or what it took too
//! much of. Not guaranteed: work that is given up is left to itself, and its
//! thread goes on until it is done, or until the program ends.

use crate::limits::{check, resident_bytes};
use crate::units::Seconds;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::{Duration, Instant};

/// Longest time: thousands of times what a template takes.
const LONGEST: Seconds = 10.0;
/// Growth of the process's memory, to which other threads may add theirs.
const MOST_BYTES: u64 = 192 << 20;
/// Time between looks, after the first of which few templates are not done.
const EVERY: Duration = Duration::from_millis(2);
/// Stack of the thread.
const STACK_BYTES: usize = 16 << 20;

/// Why there is no result.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub(super) enum GivenUp {
    #[error("it takes too long; make it shorter")]
    Time,
    #[error("it takes too much memory; make it shorter")]
    Memory,
    #[error("it cannot be computed; make it simpler")]
    Failed,
    #[error(
        "there is no thread to be had for it: the system allows too little \
         memory (ulimit -v) or too few threads (ulimit -u)"
    )]
    NoThread,
}

/// Does the work.
pub(super) fn bounded<T: Send + 'static>(
    work: impl FnOnce() -> T + Send + 'static,
) -> Result<T, GivenUp> {
    within(LONGEST, MOST_BYTES, work)
}

fn within<T: Send + 'static>(
    longest: Seconds,
    most_bytes: u64,
    work: impl FnOnce() -> T + Send + 'static,
) -> Result<T, GivenUp> {
    let before = resident_bytes();
    let started = Instant::now();
    let (sender, receiver) = channel();
    std::thread::Builder::new()
        .name("template".to_owned())
        .stack_size(STACK_BYTES)
        .spawn(move || {
            // Nobody listens any more if it took too long.
            let _ = sender.send(work());
        })
        .map_err(|_| GivenUp::NoThread)?;
    loop {
        match receiver.recv_timeout(EVERY) {
            Ok(result) => return Ok(result),
            Err(RecvTimeoutError::Disconnected) => return Err(GivenUp::Failed),
            Err(RecvTimeoutError::Timeout) => check(),
        }
        if started.elapsed().as_secs_f64() > longest {
            return Err(GivenUp::Time);
        }
        if let (Some(before), Some(now)) = (before, resident_bytes())
            && now.saturating_sub(before) > most_bytes
        {
            return Err(GivenUp::Memory);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_does_not_come_back_is_given_up() {
        let sleep = || std::thread::sleep(Duration::from_secs(3600));
        assert_eq!(within(0.05, u64::MAX, sleep), Err(GivenUp::Time));
        assert_eq!(bounded(|| 7), Ok(7));
    }
}
