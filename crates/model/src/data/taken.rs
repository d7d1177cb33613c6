//! What the making of data takes, which no script is blamed for.
//!
//! A mesh of some millions of triangles takes longer, and more memory, than a
//! script may. Data has limits of its own, on the sizes of files above all.

use super::lock;
use isoslice_base::limits::resident_bytes;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

/// What the making of data took so far, of one model.
#[derive(Clone, Default)]
pub(crate) struct Taken(Arc<Mutex<Sums>>);

#[derive(Default)]
struct Sums {
    bytes: u64,
    time: Duration,
    /// When the making began that is under way.
    since: Option<Instant>,
}

impl Taken {
    /// The memory that the process grew by, bytes; none while data is being
    /// made, when nobody knows yet.
    pub(crate) fn bytes(&self) -> Option<u64> {
        let sums = lock(&self.0);
        sums.since.is_none().then_some(sums.bytes)
    }

    /// The time on the clock.
    pub(crate) fn time(&self) -> Duration {
        let sums = lock(&self.0);
        let now = sums.since.map_or(Duration::ZERO, |since| since.elapsed());
        sums.time + now
    }

    /// Makes data, and takes in what that takes.
    pub(super) fn making<T>(&self, make: impl FnOnce() -> T) -> T {
        let before = resident_bytes();
        lock(&self.0).since = Some(Instant::now());
        let made = make();
        let after = resident_bytes();
        let grown = before.zip(after).map(|(a, b)| b.saturating_sub(a));
        let mut sums = lock(&self.0);
        let since = sums.since.take();
        sums.time += since.map_or(Duration::ZERO, |since| since.elapsed());
        sums.bytes = sums.bytes.saturating_add(grown.unwrap_or(0));
        made
    }
}
