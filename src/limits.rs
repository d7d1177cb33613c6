//! Bounds on a run's time and memory, and a way to stop it from outside.
//!
//! In: how long a piece of work may take, how much memory the process may
//! hold. Out: the work's result, or [`Stopped`], which says what the time went
//! into. [`Watch::run`] does the work under such a watch: a second thread
//! looks at the clock and at the memory and raises a flag; [`check`], called
//! in the loops of every stage, sees the flag of the watch that its thread
//! works under, and unwinds to [`Watch::run`]. No stage has to hand a token or
//! an error through, and without a watch `check` does nothing.
//!
//! Unwinding is not a panic: no hook is called and nothing is printed, and
//! what was being made is dropped. (Build systems and language servers cancel
//! their queries the same way.) A program that is built with
//! `panic = "abort"` would end instead.
//!
//! Guarantees: results do not depend on the watch, only whether there are any.
//! Between two looks there may be `EVERY` and what one step of a stage
//! takes, so a limit is overrun by a fraction of a second. For the rest,
//! [`Watch::last_resort`] names what is done if the work has not ended some
//! seconds after it was stopped.
//!
//! Not guaranteed: memory is the whole process's, whatever else it does, and
//! is not bounded where the system does not tell it. A single allocation that
//! the system refuses ends the process.

use std::cell::{Cell, RefCell};
use std::fmt;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::atomic::{AtomicU8, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Time between looks at the clock and the memory.
const EVERY: Duration = Duration::from_millis(20);

/// How much a run may use.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Limits {
    /// Wall time; none for as long as it takes.
    pub time: Option<Duration>,
    /// Memory of the whole process, bytes; none for what the machine has.
    pub memory_bytes: Option<u64>,
}

/// Why work was stopped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reason {
    /// The time was up.
    Time,
    /// The memory was used up.
    Memory,
    /// Somebody called [`Watch::cancel`].
    Cancelled,
}

impl Reason {
    const ALL: [Reason; 3] = [Reason::Time, Reason::Memory, Reason::Cancelled];

    /// As the flag holds it; 0 is for work that may go on.
    fn number(self) -> u8 {
        match self {
            Reason::Time => 1,
            Reason::Memory => 2,
            Reason::Cancelled => 3,
        }
    }
}

/// What a run did until now, for people.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Activity {
    /// What is being done, by name, with its share of the time up to now;
    /// the largest first.
    pub shares: Vec<(&'static str, f64)>,
    /// What most threads are doing now.
    pub now: Option<&'static str>,
    /// Layers written, and how many there are, once that is known.
    pub layers: Option<(usize, usize)>,
}

/// Work that was stopped before it was done.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub struct Stopped {
    /// Why.
    pub reason: Reason,
    /// The limits it had.
    pub limits: Limits,
    /// How far it had come.
    pub activity: Activity,
}

impl fmt::Display for Stopped {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.reason, self.limits.time, self.limits.memory_bytes) {
            (Reason::Time, Some(time), _) => write!(
                f,
                "stopped after {} s, the time limit (--time-limit)",
                time.as_secs_f64()
            )?,
            (Reason::Memory, _, Some(bytes)) => write!(
                f,
                "stopped at {} MB of memory, the limit (--memory-limit)",
                bytes >> 20
            )?,
            _ => write!(f, "stopped")?,
        }
        if let Some((done, all)) = self.activity.layers {
            write!(f, ", with {done} of {all} layers done")?;
        }
        let mut slow: Option<&'static str> = None;
        for (name, share) in self.activity.shares.iter().take(2) {
            let percent = 100.0 * share;
            if slow.is_none() {
                write!(f, "; {percent:.0} % of the time went into {name}")?;
                slow = Some(name);
            } else if percent >= 10.0 {
                write!(f, ", {percent:.0} % into {name}")?;
            }
        }
        if self.reason == Reason::Cancelled {
            return Ok(());
        }
        write!(f, ". {}, or raise the limit", remedy(slow))
    }
}

/// What makes a stage cheaper.
fn remedy(stage: Option<&str>) -> &'static str {
    match stage {
        Some("script") => "Build fewer parts in loops",
        Some("bounds") => "Give the model's box with --bounds",
        Some("picture") => {
            "Draw fewer pixels (--pixels, or gcode.thumbnails), or make the \
             expression simpler"
        }
        Some("reading") => "Give it a shorter file",
        Some("field" | "contour") => {
            "Slice some layers at a time (--layers), raise sample_spacing, \
             or make the expression simpler"
        }
        Some("infill") => {
            "Slice some layers at a time (--layers), or lower infill_density \
             or take another pattern of infill"
        }
        Some("travel") => {
            "Slice some layers at a time (--layers), or set \
             travel.combing=off"
        }
        _ => {
            "Slice some layers at a time (--layers), or make the part, or \
             its details, fewer"
        }
    }
}

/// Watches over work, on as many threads as take part in it.
#[derive(Clone, Debug)]
pub struct Watch(Arc<Shared>);

#[derive(Debug)]
struct Shared {
    limits: Limits,
    started: Instant,
    /// Why to stop; 0 while there is no reason to.
    stop: AtomicU8,
    state: Mutex<State>,
    /// Told when the work is done.
    done: Condvar,
}

#[derive(Debug, Default)]
struct State {
    stages: Vec<Doing>,
    layers: Option<(usize, usize)>,
    finished: bool,
}

/// A stage, as the watching thread sees it.
#[derive(Debug)]
struct Doing {
    name: &'static str,
    /// Threads that are in it.
    threads: usize,
    /// How many were found there, over all looks.
    seen: usize,
}

thread_local! {
    /// The watch that this thread works under.
    static CURRENT: RefCell<Option<Arc<Shared>>> =
        const { RefCell::new(None) };
    /// What this thread is doing.
    static STAGE: Cell<Option<&'static str>> = const { Cell::new(None) };
}

/// What unwinds from [`check`] to [`Watch::run`].
struct Unwinding;

/// What to do when work that was stopped goes on: the program's own end, most
/// likely.
pub type LastResort<'a> = &'a (dyn Fn(&Stopped) + Sync);

impl Watch {
    /// The clock starts now.
    pub fn new(limits: Limits) -> Watch {
        Watch(Arc::new(Shared {
            limits,
            started: Instant::now(),
            stop: AtomicU8::new(0),
            state: Mutex::new(State::default()),
            done: Condvar::new(),
        }))
    }

    /// Stops the work, from any thread.
    pub fn cancel(&self) {
        self.0.stop_for(Reason::Cancelled);
    }

    /// What the work is at.
    pub fn activity(&self) -> Activity {
        self.0.activity()
    }

    /// Works under this watch, unless the time is up before the end.
    ///
    /// # Errors
    /// If the work was stopped.
    pub fn run<T>(&self, work: impl FnOnce() -> T) -> Result<T, Stopped> {
        self.last_resort(Duration::MAX, &|_| {}, work)
    }

    /// As [`Watch::run`]; and if the work has not ended `grace` after it was
    /// stopped, does what is the last resort.
    ///
    /// # Errors
    /// If the work was stopped.
    pub fn last_resort<T>(
        &self,
        grace: Duration,
        resort: LastResort<'_>,
        work: impl FnOnce() -> T,
    ) -> Result<T, Stopped> {
        let shared = &self.0;
        shared.lock().finished = false;
        std::thread::scope(|scope| {
            let looking = std::thread::Builder::new()
                .name("limits".to_owned())
                .spawn_scoped(scope, || shared.look(grace, resort));
            let outer = CURRENT.replace(Some(shared.clone()));
            let result = catch_unwind(AssertUnwindSafe(work));
            CURRENT.set(outer);
            shared.lock().finished = true;
            shared.done.notify_all();
            // Without a second thread the work goes unwatched.
            drop(looking);
            match result {
                Ok(value) => Ok(value),
                Err(payload) if payload.is::<Unwinding>() => {
                    Err(shared.stopped())
                }
                Err(payload) => resume_unwind(payload),
            }
        })
    }
}

impl Shared {
    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The first reason counts.
    fn stop_for(&self, reason: Reason) {
        let _ = self.stop.compare_exchange(
            0,
            reason.number(),
            Ordering::Relaxed,
            Ordering::Relaxed,
        );
    }

    fn reason(&self) -> Option<Reason> {
        let number = self.stop.load(Ordering::Relaxed);
        Reason::ALL.into_iter().find(|r| r.number() == number)
    }

    /// Looks at the clock and the memory until the work is done.
    fn look(&self, grace: Duration, resort: LastResort<'_>) {
        let mut stopped_at = None;
        let mut state = self.lock();
        while !state.finished {
            for stage in &mut state.stages {
                stage.seen += stage.threads;
            }
            drop(state);
            self.measure();
            if self.reason().is_some() {
                let since = *stopped_at.get_or_insert_with(Instant::now);
                if since.elapsed() > grace {
                    return resort(&self.stopped());
                }
            }
            let locked = self.lock();
            if locked.finished {
                return;
            }
            state = match self.done.wait_timeout(locked, EVERY) {
                Ok((state, _)) => state,
                Err(poisoned) => poisoned.into_inner().0,
            };
        }
    }

    fn measure(&self) {
        if let Some(limit) = self.limits.time
            && self.started.elapsed() > limit
        {
            self.stop_for(Reason::Time);
        }
        if let Some(limit) = self.limits.memory_bytes
            && resident_bytes().is_some_and(|bytes| bytes > limit)
        {
            self.stop_for(Reason::Memory);
        }
    }

    fn stopped(&self) -> Stopped {
        Stopped {
            reason: self.reason().unwrap_or(Reason::Cancelled),
            limits: self.limits,
            activity: self.activity(),
        }
    }

    fn activity(&self) -> Activity {
        let state = self.lock();
        let all: usize = state.stages.iter().map(|s| s.seen).sum();
        let share = |s: &Doing| (s.name, s.seen as f64 / all.max(1) as f64);
        let mut shares: Vec<_> = state
            .stages
            .iter()
            .filter(|s| s.seen > 0)
            .map(share)
            .collect();
        shares.sort_by(|a, b| b.1.total_cmp(&a.1));
        let busy = state.stages.iter().filter(|s| s.threads > 0);
        Activity {
            shares,
            now: busy.max_by_key(|s| s.threads).map(|s| s.name),
            layers: state.layers,
        }
    }

    /// A thread goes from one stage to another.
    fn moves(&self, from: Option<&str>, to: Option<&'static str>) {
        let mut state = self.lock();
        if let Some(from) = from
            && let Some(stage) =
                state.stages.iter_mut().find(|s| s.name == from)
        {
            stage.threads = stage.threads.saturating_sub(1);
        }
        let Some(name) = to else { return };
        match state.stages.iter_mut().find(|s| s.name == name) {
            Some(stage) => stage.threads += 1,
            None => state.stages.push(Doing {
                name,
                threads: 1,
                seen: 0,
            }),
        }
    }
}

/// Ends this thread's work if its watch says so. To be called in every loop
/// that may take longer than some tenths of a second; it costs a few
/// nanoseconds.
#[inline]
pub fn check() {
    let stop = CURRENT.with(|current| {
        let current = current.borrow();
        let shared = current.as_ref();
        shared.is_some_and(|s| s.stop.load(Ordering::Relaxed) != 0)
    });
    // What is dropped on the way out may look as well.
    if stop && !std::thread::panicking() {
        resume_unwind(Box::new(Unwinding));
    }
}

/// The watch of this thread, for handing it to others.
pub fn current() -> Option<Watch> {
    CURRENT.with(|current| current.borrow().clone().map(Watch))
}

/// Puts this thread under a watch for good. What unwinds from it has to reach
/// [`Watch::run`] through whoever waits for the thread.
pub fn work_under(watch: Option<&Watch>) {
    CURRENT.set(watch.map(|watch| watch.0.clone()));
}

/// Does `work` and lets the watch know what it is called.
pub fn doing<T>(stage: &'static str, work: impl FnOnce() -> T) -> T {
    /// Tells the end also when unwinding.
    struct Back(Arc<Shared>, &'static str, Option<&'static str>);
    impl Drop for Back {
        fn drop(&mut self) {
            let Back(shared, stage, outer) = self;
            shared.moves(Some(stage), *outer);
            STAGE.set(*outer);
        }
    }
    let shared = CURRENT.with(|current| current.borrow().clone());
    let Some(shared) = shared else {
        return work();
    };
    let outer = STAGE.replace(Some(stage));
    shared.moves(outer, Some(stage));
    let _back = Back(shared, stage, outer);
    check();
    work()
}

/// Tells the watch how many layers are done, of how many.
pub fn layers_done(done: usize, all: usize) {
    CURRENT.with(|current| {
        if let Some(shared) = &*current.borrow() {
            shared.lock().layers = Some((done, all));
        }
    });
}

/// Memory of this process that is in use, where the system tells.
pub fn resident_bytes() -> Option<u64> {
    memory_stats::memory_stats().map(|stats| stats.physical_mem as u64)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Works until it is stopped.
    fn endless() {
        loop {
            check();
            std::thread::sleep(Duration::from_millis(1));
        }
    }

    fn within(milliseconds: u64) -> Watch {
        Watch::new(Limits {
            time: Some(Duration::from_millis(milliseconds)),
            memory_bytes: None,
        })
    }

    #[test]
    fn work_that_is_done_in_time_has_its_result() {
        assert_eq!(within(60_000).run(|| 7), Ok(7));
        // Nothing is left of the watch.
        check();
        assert!(current().is_none());
    }

    #[test]
    fn work_without_end_is_stopped_and_says_what_it_was_at() {
        let stopped = within(100)
            .run(|| {
                layers_done(3, 40);
                doing("infill", endless);
            })
            .unwrap_err();
        assert_eq!(stopped.reason, Reason::Time);
        let text = stopped.to_string();
        assert!(text.contains("0.1 s"), "{text}");
        assert!(text.contains("3 of 40 layers"), "{text}");
        assert!(
            text.contains("100 % of the time went into infill"),
            "{text}"
        );
        assert!(text.contains("infill_density"), "{text}");
    }

    #[test]
    fn threads_of_a_pool_stop_with_it() {
        use rayon::prelude::*;
        let stopped = within(100).run(|| {
            let watch = current();
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(3)
                .start_handler(move |_| work_under(watch.as_ref()))
                .build()
                .unwrap();
            pool.install(|| {
                (0..8).into_par_iter().for_each(|_| doing("walls", endless));
            });
        });
        assert_eq!(stopped.unwrap_err().reason, Reason::Time);
    }

    #[test]
    fn too_much_memory_stops_it() {
        let watch = Watch::new(Limits {
            time: Some(Duration::from_secs(60)),
            memory_bytes: Some(1),
        });
        let stopped = watch.run(endless).unwrap_err();
        if resident_bytes().is_some() {
            assert_eq!(stopped.reason, Reason::Memory);
            assert!(stopped.to_string().contains("--memory-limit"));
        }
    }

    #[test]
    fn another_thread_can_stop_it() {
        let watch = within(60_000);
        let other = watch.clone();
        let stopper = std::thread::spawn(move || {
            std::thread::sleep(Duration::from_millis(50));
            other.cancel();
        });
        let stopped = watch.run(endless).unwrap_err();
        assert_eq!(stopped.reason, Reason::Cancelled);
        stopper.join().unwrap();
    }

    #[test]
    fn the_last_resort_comes_when_nothing_looks() {
        let (sender, receiver) = std::sync::mpsc::channel();
        let sender = Mutex::new(sender);
        let resort = |stopped: &Stopped| {
            sender.lock().unwrap().send(stopped.reason).unwrap();
        };
        // Waits for the resort without ever looking.
        let result =
            within(50).last_resort(Duration::from_millis(50), &resort, || {
                receiver.recv_timeout(Duration::from_secs(60))
            });
        assert_eq!(result, Ok(Ok(Reason::Time)));
    }

    #[test]
    fn a_real_panic_stays_one() {
        let watch = within(60_000);
        let result = catch_unwind(AssertUnwindSafe(|| {
            let _ = watch.run(|| resume_unwind(Box::new(5_i32)));
        }));
        assert_eq!(result.unwrap_err().downcast_ref(), Some(&5_i32));
    }
}
