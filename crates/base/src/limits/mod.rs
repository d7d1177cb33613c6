//! Bounds on a run's time, work and memory, and a way to stop it from outside.
//!
//! In: how long work may take, how much processor time, and how much memory the
//! process may hold. Out: the work's result, or [`Stopped`], which says what
//! the time went into.
//! [`Watch::run`] does the work under a watch: a second thread looks at the
//! clock, the work and the memory and raises a flag. Loops that may take long
//! look at the flag of the watch that their thread works under:
//! - a function that can fail asks [`go_on`] and passes its error on, which is
//!   `isocontour`'s for stopped work;
//! - a function of geometry that cannot fail asks [`is_stopped`] and returns at
//!   once with what it has, valid but unfinished. Its caller that can fail asks
//!   [`go_on`] before it uses that.
//!
//! Once anybody has seen the flag, [`Watch::run`] returns [`Stopped`], whatever
//! the work returned. Without a watch nothing is ever stopped.
//!
//! Guarantees: a watch can prevent a result, but never change it. A limit is
//! overrun by a fraction of a second at most: by `EVERY`, and by the time of
//! one step of a stage. Processor time is that of the threads under the watch
//! alone: neither other programs nor a pause (Ctrl-Z) nor other work of the
//! process count. If work does not end some seconds after it was stopped,
//! [`Watch::last_resort`] does what its caller wants.
//!
//! Not guaranteed: that only this work's memory counts, since it is the memory
//! of the whole process; and that memory is bounded where the system does not
//! tell it. A single allocation that the system refuses ends the process. Where
//! the system bounds the address space, the work is stopped shortly before
//! (`space`).

mod space;
mod stopped;
#[cfg(test)]
mod tests;

pub use space::{TooLittleSpace, enough_space};
pub use stopped::{Activity, Reason, Stopped};

use crate::stopwatch::Stopwatch;
use isocontour::Cancel;
pub use isocontour::Cancelled;
use std::cell::{Cell, RefCell};
use std::io;
use std::num::NonZero;
use std::sync::atomic::{
    AtomicBool, AtomicU8, AtomicU32, AtomicU64, AtomicUsize, Ordering,
};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Greatest number of parts on a plate.
pub const MOST_PARTS: u64 = 1000;

/// Time between two looks at the clock and the memory.
const EVERY: Duration = Duration::from_millis(20);

/// How much a run may use.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Limits {
    /// Time on the clock; none for no limit. It is for users to say: how much is
    /// done in that time depends on the machine and on what else it does.
    pub time: Option<Duration>,
    /// Processor time of all threads together; none for no limit.
    pub work: Option<Duration>,
    /// Memory of the whole process, bytes; none for no limit.
    pub memory_bytes: Option<u64>,
    /// The least progress that has to be made; none for no such limit.
    pub slow: Option<Slow>,
}

impl Limits {
    /// The limits on slicing unless the user says otherwise: 4 hours of
    /// processor time, 4 GB, and an end to work that makes hardly any progress.
    ///
    /// Costly models that make sense, such as 25,600 pins in one expression,
    /// make 70,000 points in a second of processor time, and lattices twice that
    /// and more. A sum of 1,000 sines, of which nobody knows where it is
    /// positive, makes 2,500.
    pub fn of_slicing() -> Limits {
        Limits {
            time: None,
            work: Some(Duration::from_secs(4 * 3600)),
            memory_bytes: Some(4 << 30),
            slow: Some(Slow {
                work: Duration::from_secs(36),
                points: 150_000,
            }),
        }
    }

    /// The limits if the user says how long the work may take. Then it may be
    /// as slow as it is.
    #[must_use]
    pub fn within(self, time: Option<Duration>) -> Limits {
        Limits {
            time,
            work: None,
            slow: None,
            ..self
        }
    }
}

/// Work that makes fewer points of outlines and paths than these is too slow to
/// go on, unless the user asks for it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slow {
    /// Processor time. The points are counted again and again after that much.
    pub work: Duration,
    /// Least number of points in that time.
    pub points: usize,
}

/// Watches over work, on as many threads as take part in it.
#[derive(Clone, Debug)]
pub struct Watch(Arc<Shared>);

#[derive(Debug)]
struct Shared {
    limits: Limits,
    started: Instant,
    /// The number of the reason to stop; 0 while there is none.
    stop: AtomicU8,
    /// True once the work has seen that it is to stop.
    seen: AtomicBool,
    /// Number of questions whether to stop after which it is to stop; for tests.
    questions: AtomicU64,
    /// Number of points of outlines and paths that were made.
    points: AtomicUsize,
    /// Processor time that threads have told of, nanoseconds.
    work: AtomicU64,
    /// Number of looks. After each one every thread tells of its work.
    looks: AtomicU32,
    state: Mutex<State>,
    /// Signalled when the work is done.
    done: Condvar,
}

#[derive(Debug, Default)]
struct State {
    stages: Vec<Seen>,
    layers: Option<(usize, usize)>,
    /// The work at which the last stretch of [`Slow::work`] ended, and the
    /// number of points by then.
    before: (Duration, usize),
    finished: bool,
}

/// A stage, as the watching thread sees it.
#[derive(Debug)]
struct Seen {
    name: &'static str,
    /// Number of threads in the stage.
    threads: usize,
    /// Number of threads found in the stage, summed over all looks.
    seen: usize,
}

thread_local! {
    /// The watch that this thread works under.
    static CURRENT: RefCell<Option<Arc<Shared>>> =
        const { RefCell::new(None) };
    /// The look after which this thread last told of its work, and its
    /// processor time since then.
    static TOLD: Cell<Option<(u32, Stopwatch)>> = const { Cell::new(None) };
    /// What this thread is doing.
    static STAGE: Cell<Option<&'static str>> = const { Cell::new(None) };
}

/// What to do when stopped work does not end. Most likely it ends the program.
type LastResort<'a> = &'a (dyn Fn(&Stopped) + Sync);

impl Watch {
    /// A watch whose clock starts now.
    pub fn new(limits: Limits) -> Watch {
        Watch(Arc::new(Shared {
            limits,
            started: Instant::now(),
            stop: AtomicU8::new(0),
            seen: AtomicBool::new(false),
            questions: AtomicU64::new(u64::MAX),
            points: AtomicUsize::new(0),
            work: AtomicU64::new(0),
            looks: AtomicU32::new(0),
            state: Mutex::new(State::default()),
            done: Condvar::new(),
        }))
    }

    /// The watch of this thread, for handing it to other threads.
    pub fn current() -> Option<Watch> {
        CURRENT.with(|current| current.borrow().clone().map(Watch))
    }

    /// Puts this thread under a watch for good.
    pub fn adopt(watch: Option<&Watch>) {
        enter(watch.map(|watch| watch.0.clone()));
    }

    /// A cancel hook for a library. It stops the library's work when the watch
    /// of the working thread says so.
    pub fn hook() -> Cancel {
        Cancel::when(is_stopped)
    }

    /// Stops the work, from any thread.
    pub fn cancel(&self) {
        self.0.stop_for(Reason::Cancelled);
    }

    /// Stops the work when it has asked that often whether it is to stop. So a
    /// test can stop it in any place.
    pub fn cancel_after(&self, questions: u64) {
        self.0.questions.store(questions, Ordering::Relaxed);
    }

    /// What the work is doing.
    pub fn activity(&self) -> Activity {
        self.0.activity()
    }

    /// Does work under this watch.
    ///
    /// # Errors
    /// If the work was stopped.
    pub fn run<T>(&self, work: impl FnOnce() -> T) -> Result<T, Stopped> {
        self.last_resort(Duration::MAX, &|_| {}, work)
    }

    /// Does what [`Watch::run`] does, and calls `resort` if the work has not
    /// ended `grace` after it was stopped.
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
            let ends = Ends {
                shared,
                outer: enter(Some(shared.clone())),
            };
            let result = work();
            drop(ends);
            // Without a second thread the work is not watched.
            drop(looking);
            if shared.seen.load(Ordering::Relaxed) {
                Err(shared.stopped())
            } else {
                Ok(result)
            }
        })
    }
}

/// Ends the second thread's watch when the work ends, also by a panic, and puts
/// this thread back under the watch that it was under before.
struct Ends<'a> {
    shared: &'a Shared,
    outer: Option<Arc<Shared>>,
}

impl Drop for Ends<'_> {
    fn drop(&mut self) {
        enter(self.outer.take());
        self.shared.lock().finished = true;
        self.shared.done.notify_all();
    }
}

/// Puts this thread under a watch, or under none. Returns the one before.
fn enter(shared: Option<Arc<Shared>>) -> Option<Arc<Shared>> {
    TOLD.take();
    CURRENT.replace(shared)
}

impl Shared {
    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Stops the work. Only the first reason counts.
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
            self.looks.fetch_add(1, Ordering::Relaxed);
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
        if let Some(limit) = self.limits.work
            && self.work() > limit
        {
            self.stop_for(Reason::Work);
        }
        if let Some(limit) = self.limits.memory_bytes
            && resident_bytes().is_some_and(|bytes| bytes > limit)
        {
            self.stop_for(Reason::Memory);
        }
        if let Some(slow) = self.limits.slow
            && self.is_slower_than(slow)
        {
            self.stop_for(Reason::Slow);
        }
        if space::is_used_up() {
            self.stop_for(Reason::Space);
        }
    }

    /// The processor time of all threads until now.
    fn work(&self) -> Duration {
        Duration::from_nanos(self.work.load(Ordering::Relaxed))
    }

    /// Takes in the work of this thread, once after each look.
    #[inline]
    fn take_work(&self) {
        let look = self.looks.load(Ordering::Relaxed);
        let told = TOLD.get();
        if told.is_some_and(|(at, _)| at == look) {
            return;
        }
        if let Some((_, since)) = told {
            let nanos = since.elapsed().as_nanos() as u64;
            self.work.fetch_add(nanos, Ordering::Relaxed);
        }
        TOLD.set(Some((look, Stopwatch::start())));
    }

    /// Counts a question, if they are counted.
    #[inline]
    fn count_down(&self) {
        let left = self.questions.load(Ordering::Relaxed);
        if left == u64::MAX {
            return;
        }
        let left = left.saturating_sub(1);
        self.questions.store(left, Ordering::Relaxed);
        if left == 0 {
            self.stop_for(Reason::Cancelled);
        }
    }

    /// True if too few points were made by the work that has just been done.
    fn is_slower_than(&self, slow: Slow) -> bool {
        let before = &mut self.lock().before;
        let work = self.work();
        if work.saturating_sub(before.0) < slow.work {
            return false;
        }
        let points = self.points.load(Ordering::Relaxed);
        let made = points - before.1;
        *before = (work, points);
        made < slow.points
    }

    fn stopped(&self) -> Stopped {
        Stopped {
            reason: self.reason().unwrap_or(Reason::Cancelled),
            limits: self.limits,
            activity: Box::new(self.activity()),
        }
    }

    fn activity(&self) -> Activity {
        let state = self.lock();
        let all: usize = state.stages.iter().map(|s| s.seen).sum();
        let share = |s: &Seen| (s.name, s.seen as f64 / all.max(1) as f64);
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

    /// Takes in that a thread goes from one stage to another.
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
            None => state.stages.push(Seen {
                name,
                threads: 1,
                seen: 0,
            }),
        }
    }
}

/// True if this thread's watch says that its work is to stop. Every loop that
/// may take longer than some tenths of a second has to ask this, or [`go_on`].
/// An answer takes a few nanoseconds.
#[inline]
pub fn is_stopped() -> bool {
    CURRENT.with(|current| {
        let current = current.borrow();
        current.as_ref().is_some_and(|shared| {
            shared.take_work();
            shared.count_down();
            let stopped = shared.stop.load(Ordering::Relaxed) != 0;
            if stopped {
                shared.seen.store(true, Ordering::Relaxed);
            }
            stopped
        })
    })
}

/// Lets work go on unless this thread's watch says that it is to stop.
///
/// # Errors
/// If the work is to stop.
#[inline]
pub fn go_on() -> Result<(), Cancelled> {
    if is_stopped() { Err(Cancelled) } else { Ok(()) }
}

/// Lets reading or writing go on unless this thread's watch says that it is to
/// stop.
///
/// # Errors
/// If the work is to stop.
pub fn io_goes_on() -> io::Result<()> {
    go_on().map_err(io::Error::other)
}

/// A stage that this thread is in until the value is dropped.
#[derive(Debug)]
pub struct Doing(Option<(Arc<Shared>, &'static str, Option<&'static str>)>);

impl Drop for Doing {
    fn drop(&mut self) {
        if let Some((shared, stage, outer)) = &self.0 {
            shared.moves(Some(stage), *outer);
            STAGE.set(*outer);
        }
    }
}

/// Lets the watch know what this thread does from now on.
pub fn begin(stage: &'static str) -> Doing {
    let shared = CURRENT.with(|current| current.borrow().clone());
    let Some(shared) = shared else {
        return Doing(None);
    };
    let outer = STAGE.replace(Some(stage));
    shared.moves(outer, Some(stage));
    Doing(Some((shared, stage, outer)))
}

/// Does `work`, and tells the watch the name of its stage.
pub fn doing<T>(stage: &'static str, work: impl FnOnce() -> T) -> T {
    let _doing = begin(stage);
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

/// Tells the watch of points of outlines or paths that were made. Work that
/// makes hardly any points may be stopped for it ([`Slow`]).
pub fn made(points: usize) {
    CURRENT.with(|current| {
        if let Some(shared) = &*current.borrow() {
            shared.points.fetch_add(points, Ordering::Relaxed);
        }
    });
}

/// Number of the machine's processors, for as many threads. rayon would ask the
/// environment first (`RAYON_NUM_THREADS`), and start any number of them.
pub fn processors() -> usize {
    std::thread::available_parallelism().map_or(1, NonZero::get)
}

/// Memory of this process that is in use, where the system tells.
pub fn resident_bytes() -> Option<u64> {
    memory_stats::memory_stats().map(|stats| stats.physical_mem as u64)
}
