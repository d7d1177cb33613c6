//! Measures where a run's time goes, by stage.
//!
//! The times are processor times, added up over all threads: two threads at
//! work count 2 seconds per second. Neither other work of the machine nor
//! waiting counts. Work that a stage gives to other threads is timed there.

use crate::limits;
use crate::named;
use crate::stopwatch::Stopwatch;
use crate::units::Seconds;
use cpu_time::ThreadTime;
use rayon::ThreadPool;
use std::sync::atomic::{AtomicU64, Ordering};

/// Does work that alone keeps a pool busy, and tells the processor time that all
/// of the pool's threads take for it.
pub fn of_pool<T: Send>(
    pool: &ThreadPool,
    work: impl FnOnce() -> T + Send,
) -> (T, Seconds) {
    let clocks = || {
        pool.broadcast(|_| {
            let clock = ThreadTime::try_now();
            clock.map_or(0.0, |now| now.as_duration().as_secs_f64())
        })
    };
    let before = clocks();
    let made = pool.install(work);
    let times = clocks().into_iter().zip(before);
    (made, times.map(|(after, before)| after - before).sum())
}

named! {
    /// A stage of the pipeline, with its name in reports.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum Stage {
        /// Heights of layers that follow the surface.
        Heights = "heights",
        /// Pictures for the file's head.
        Picture = "picture",
        /// Proofs and samples of the field.
        Field = "field",
        /// Outlines from samples.
        Contour = "contour",
        /// Offsets of the outlines.
        Walls = "walls",
        /// Exposure and the beads of the skin.
        Skin = "skin",
        /// Sparse infill.
        Infill = "infill",
        /// What hangs.
        Hang = "hanging",
        /// The plan of supports, and their beads.
        Support = "support",
        /// Order and seams.
        Order = "order",
        /// Beads on the surface above or below them.
        ZContouring = "contour_z",
        /// Travels.
        Travel = "travel",
        /// Rates and arcs of beads.
        Rates = "rates",
        /// Speeds and print time.
        Pace = "pace",
        /// The text.
        Gcode = "gcode",
        /// Accuracy of the layers, for the summary or the report.
        Report = "report",
        /// The check of the text.
        Check = "check",
    }
}

/// Nanoseconds per stage, shared between threads.
#[derive(Debug, Default)]
pub struct Timings {
    nanos: [AtomicU64; Stage::ALL.len()],
}

impl Timings {
    /// Runs `work` and adds its time to the stage's.
    pub fn time<T>(&self, stage: Stage, work: impl FnOnce() -> T) -> T {
        let _lap = self.begin(stage);
        work()
    }

    /// Runs work that alone keeps a pool busy, and adds the time of all of the
    /// pool's threads to the stage's.
    pub fn time_pool<T: Send>(
        &self,
        stage: Stage,
        pool: &ThreadPool,
        work: impl FnOnce() -> T + Send,
    ) -> T {
        let _doing = limits::begin(stage.name());
        let (made, time) = of_pool(pool, work);
        let nanos = (time * 1e9) as u64;
        self.nanos[stage as usize].fetch_add(nanos, Ordering::Relaxed);
        made
    }

    /// Begins work whose time is added to the stage's when the lap is dropped.
    pub fn begin(&self, stage: Stage) -> Lap<'_> {
        Lap {
            start: Stopwatch::start(),
            nanos: &self.nanos[stage as usize],
            _doing: limits::begin(stage.name()),
        }
    }

    /// Time of a stage so far.
    pub fn seconds(&self, stage: Stage) -> Seconds {
        let nanos = self.nanos[stage as usize].load(Ordering::Relaxed);
        nanos as f64 * 1e-9
    }
}

/// Work of a stage, from [`Timings::begin`] until this is dropped.
#[derive(Debug)]
pub struct Lap<'a> {
    start: Stopwatch,
    nanos: &'a AtomicU64,
    _doing: limits::Doing,
}

impl Drop for Lap<'_> {
    fn drop(&mut self) {
        let nanos = self.start.elapsed().as_nanos() as u64;
        self.nanos.fetch_add(nanos, Ordering::Relaxed);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    #[test]
    fn work_of_all_threads_of_a_pool_counts() {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(2);
        let pool = pool.build().unwrap();
        let t = Timings::default();
        let clock = || ThreadTime::now().as_duration().as_secs_f64();
        let busy = || {
            let start = clock();
            while clock() - start < 0.02 {}
        };
        // Each of both threads takes one half.
        let both = || rayon::broadcast(|_| busy()).len();
        assert_eq!(t.time_pool(Stage::Support, &pool, both), 2);
        let time = t.seconds(Stage::Support);
        assert!(time > 0.039, "{time}");
    }

    #[test]
    fn a_lap_adds_to_its_stage() {
        let t = Timings::default();
        let answer = t.time(Stage::Field, || {
            // The test works, since a sleep would take no processor time.
            let watch = Stopwatch::start();
            while watch.elapsed() < Duration::from_millis(2) {
                std::hint::spin_loop();
            }
            42
        });
        assert_eq!(answer, 42);
        let field = t.seconds(Stage::Field);
        assert!(field >= 0.002);
        drop(t.begin(Stage::Contour));
        assert_eq!(t.seconds(Stage::Field), field);
        assert!(t.seconds(Stage::Contour) > 0.0);
    }
}
