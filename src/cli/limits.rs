//! Limits on a command's time and memory.
//!
//! Guaranteed: a command ends within seconds of its limits, with an error that
//! says what it was doing, and leaves no half-written file.

use super::patience::Patience;
use super::terminal;
use anyhow::Context;
use clap::Args;
use isoslice::files::Output;
use isoslice::limits::{Limits, Watch, enough_space, processors};
use rayon::ThreadPool;
use std::process::exit;
use std::time::Duration;

/// Time that a stage has to notice that it was stopped. After that the process
/// ends without waiting for the stage.
pub(super) const GRACE: Duration = Duration::from_secs(2);

/// Limits on a command.
#[derive(Args, Debug)]
#[command(next_help_heading = "Limits")]
pub(super) struct LimitArgs {
    /// Stop with an error after this time, in seconds, or with a unit: 90,
    /// 10min, 2h; none for no limit [default: none, but 4 h of processor time,
    /// or 36 s in which next to nothing is sliced]
    #[arg(long, value_name = "TIME", value_parser = time)]
    time_limit: Option<Limit<Duration>>,

    /// Stop with an error when the program holds this much memory, as in 512MB
    /// or 8GB; none for no limit
    #[arg(
        long,
        value_name = "SIZE",
        default_value = "4GB",
        value_parser = memory
    )]
    memory_limit: Limit<u64>,
}

/// A limit as written on the command line.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Limit<T>(Option<T>);

impl LimitArgs {
    /// A watch with these limits. Its time begins now.
    pub(super) fn watch(&self) -> Watch {
        Watch::new(Limits {
            slow: None,
            ..self.limits()
        })
    }

    /// A watch over slicing. It stops work that makes hardly any progress,
    /// unless the user has set a time limit.
    pub(super) fn slicing_watch(&self) -> Watch {
        Watch::new(self.limits())
    }

    fn limits(&self) -> Limits {
        let usual = Limits {
            memory_bytes: self.memory_limit.0,
            ..Limits::of_slicing()
        };
        match self.time_limit {
            Some(limit) => usual.within(limit.0),
            None => usual,
        }
    }
}

/// How many threads work. No result depends on it.
#[derive(Args, Clone, Copy, Debug, PartialEq)]
pub(super) struct ThreadArgs {
    /// Number of threads; no result depends on it [default: all processors]
    #[arg(
        long,
        value_name = "N",
        value_parser = clap::value_parser!(u16).range(1..=1024)
    )]
    threads: Option<u16>,
}

impl ThreadArgs {
    /// The number, if one is given.
    pub(super) fn count(self) -> Option<usize> {
        self.threads.map(usize::from)
    }

    /// Threads that work under this thread's watch.
    pub(super) fn workers(self) -> anyhow::Result<ThreadPool> {
        let watch = Watch::current();
        rayon::ThreadPoolBuilder::new()
            .num_threads(self.count().unwrap_or_else(processors))
            .start_handler(move |_| Watch::adopt(watch.as_ref()))
            .build()
            .context("cannot start the worker threads; try --threads 1")
    }
}

/// Runs a command's work under a watch.
pub(super) fn watched<T>(
    watch: &Watch,
    work: impl FnOnce() -> anyhow::Result<T>,
) -> anyhow::Result<T> {
    enough_space()?;
    let _patience = Patience::new(watch);
    watch.last_resort(
        GRACE,
        &|stopped| {
            // From here on no file is put in its place.
            let _pending = Output::discard_all();
            terminal::report_error(&stopped.clone().into());
            exit(1);
        },
        work,
    )?
}

/// Reads a number and its unit; `none` is no limit.
fn number(
    given: &str,
    units: &[(&str, f64)],
    form: &str,
) -> Result<Limit<f64>, String> {
    let given = given.trim().to_ascii_lowercase();
    if given == "none" {
        return Ok(Limit(None));
    }
    let digits = given.trim_end_matches(|c: char| c.is_ascii_alphabetic());
    let unit = &given[digits.len()..];
    let factor = units.iter().find(|(name, _)| *name == unit);
    match (digits.trim().parse::<f64>(), factor) {
        (Ok(n), Some((_, factor))) if n > 0.0 && n.is_finite() => {
            Ok(Limit(Some(n * factor)))
        }
        _ => Err(format!("write it as {form}")),
    }
}

fn time(given: &str) -> Result<Limit<Duration>, String> {
    const FORM: &str = "seconds, or as in 10min or 2h, or as none";
    let units = [("", 1.0), ("s", 1.0), ("min", 60.0), ("h", 3600.0)];
    let seconds = number(given, &units, FORM)?.0;
    let duration = |s| {
        Duration::try_from_secs_f64(s)
            .map_err(|_| format!("write it as {FORM}"))
    };
    Ok(Limit(seconds.map(duration).transpose()?))
}

fn memory(given: &str) -> Result<Limit<u64>, String> {
    const FORM: &str = "512MB or 4GB, or as none";
    let units = [("mb", 1024.0 * 1024.0), ("gb", 1024.0 * 1024.0 * 1024.0)];
    let bytes = number(given, &units, FORM)?.0;
    Ok(Limit(bytes.map(|b| b as u64)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_are_read_with_their_units() {
        let seconds = |s| Ok(Limit(Some(Duration::from_secs(s))));
        assert_eq!(time("90"), seconds(90));
        assert_eq!(time(" 10 min"), seconds(600));
        assert_eq!(time("2H"), seconds(7200));
        assert_eq!(time("none"), Ok(Limit(None)));
        assert_eq!(memory("512MB"), Ok(Limit(Some(512 << 20))));
        assert_eq!(memory("1.5gb"), Ok(Limit(Some(1536 << 20))));
        assert_eq!(memory("None"), Ok(Limit(None)));
    }

    #[test]
    fn malformed_limits_are_refused() {
        for bad in ["", "0", "-1", "1d", "nan", "inf", "1e300h", "min", "1 2"] {
            assert!(time(bad).is_err(), "{bad}");
        }
        for bad in ["", "1", "0MB", "-1GB", "infGB", "MB", "1XB"] {
            assert!(memory(bad).is_err(), "{bad}");
        }
    }
}
