//! Tells the user who waits for a long run what the run is doing, how long it
//! will take, and how to make it shorter; or which host is waited for.
//!
//! A message comes on the error stream after 10 seconds, and then at ever
//! longer intervals. There is no message if a bar shows the progress. The time
//! that is left is estimated from the layers that are done.

use super::terminal;
use isoslice::limits::{Activity, Watch};
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::thread;
use std::time::{Duration, Instant};

/// Time of the first message.
const FIRST: Duration = Duration::from_secs(10);
/// Ratio of the times of two messages in a row.
const NEXT: u32 = 3;
/// Time between two looks at the run.
const EVERY: Duration = Duration::from_millis(250);

/// Writes messages until it is dropped.
pub(super) struct Patience {
    /// The thread ends when this sender is dropped. Nothing is ever sent.
    _alive: Option<Sender<()>>,
}

impl Patience {
    /// Messages about the work under a watch, which begins now.
    pub(super) fn new(watch: &Watch) -> Self {
        let watch = watch.clone();
        let mut begun = None;
        Self::telling(move |due| {
            let activity = watch.activity();
            if let (None, Some((done, _))) = (begun, activity.layers) {
                begun = Some((Instant::now(), done));
            }
            let left = begun
                .and_then(|(at, done)| left(&activity, at.elapsed(), done));
            due.map(|after| word(after, &activity, left))
        })
    }

    /// Messages about a host that is waited for from now on; `what` says what
    /// for.
    pub(super) fn with_host(
        mut what: impl FnMut() -> String + Send + 'static,
    ) -> Self {
        Self::telling(move |due| {
            let after = spoken(due?);
            Some(format!("after {after} {}. Ctrl-C ends it", what()))
        })
    }

    /// Messages that `look` makes when one is due after some time. It is called
    /// in between as well.
    fn telling(
        mut look: impl FnMut(Option<Duration>) -> Option<String> + Send + 'static,
    ) -> Self {
        if terminal::is_quiet() {
            return Patience { _alive: None };
        }
        let (alive, gone) = channel();
        let wait = move || {
            let started = Instant::now();
            let mut next = FIRST;
            while gone.recv_timeout(EVERY) == Err(RecvTimeoutError::Timeout) {
                let due = started.elapsed() >= next;
                if let Some(message) = look(due.then_some(next)) {
                    terminal::progress(&message);
                    next *= NEXT;
                }
            }
        };
        let name = thread::Builder::new().name("patience".into());
        // Without a thread there are no messages, which is no reason to fail.
        let spawned = name.spawn(wait);
        Patience {
            _alive: spawned.is_ok().then_some(alive),
        }
    }
}

/// How long the remaining layers will take, if the layers since `before` took
/// `time`.
fn left(
    activity: &Activity,
    took: Duration,
    before: usize,
) -> Option<Duration> {
    let (done, all) = activity.layers?;
    let share =
        all.checked_sub(done)? as f64 / done.checked_sub(before)? as f64;
    Duration::try_from_secs_f64(share * took.as_secs_f64()).ok()
}

/// The message after some time.
fn word(
    after: Duration,
    activity: &Activity,
    left: Option<Duration>,
) -> String {
    let mut text = format!("still at work after {}", spoken(after));
    if let Some(now) = activity.now {
        text += &format!(", now at {now}");
    }
    if let Some((done, all)) = activity.layers {
        text += &format!(", with {done} of {all} layers done");
    }
    if let Some(left) = left {
        text += &format!(", about {} to go", spoken(left));
    }
    let remedy = activity.remedy();
    text += &format!(
        ". Ctrl-C ends it and leaves no file; --time-limit bounds it. \
         {remedy}, to have it sooner"
    );
    text
}

/// Writes a time as `40 s`, `3 min` or `2.5 h`.
fn spoken(time: Duration) -> String {
    match time.as_secs_f64() {
        s if s < 100.0 => format!("{s:.0} s"),
        s if s < 6000.0 => format!("{:.0} min", s / 60.0),
        s => format!("{:.1} h", s / 3600.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_run_is_told_of() {
        let mut activity = Activity {
            shares: vec![("bounds", 0.9)],
            now: Some("bounds"),
            layers: None,
        };
        let ten = Duration::from_secs(10);
        assert_eq!(left(&activity, ten, 0), None);
        let text = word(ten, &activity, None);
        assert!(text.contains("after 10 s, now at bounds. Ctrl-C"), "{text}");
        assert!(text.contains("--bounds"), "{text}");
        activity.layers = Some((30, 330));
        let estimate = left(&activity, ten, 10);
        assert_eq!(estimate, Some(Duration::from_secs(150)));
        let text = word(ten, &activity, estimate);
        assert!(text.contains("30 of 330 layers done, about 2 min to go"));
        // No layer was finished since then.
        assert_eq!(left(&activity, ten, 30), None);
    }
}
