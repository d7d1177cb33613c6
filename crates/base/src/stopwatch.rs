//! Processor time of a thread.
//!
//! Neither other work of the machine nor waiting counts.

use cpu_time::ThreadTime;
use std::time::Duration;

/// Processor time of one thread. The thread that starts the watch has to read
/// it.
#[derive(Clone, Copy, Debug)]
pub struct Stopwatch(Option<ThreadTime>);

impl Stopwatch {
    /// Starts a watch. It stays at 0 on a system that does not tell processor
    /// time.
    pub fn start() -> Stopwatch {
        Stopwatch(ThreadTime::try_now().ok())
    }

    /// Time since the start.
    pub fn elapsed(&self) -> Duration {
        self.0
            .and_then(|start| start.try_elapsed().ok())
            .unwrap_or_default()
    }
}
