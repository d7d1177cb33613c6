//! Work without the GIL.
//!
//! In: work, its limits, and a function to call with its progress. Out: its
//! result, or an exception. The work runs on a thread of its own. The caller's
//! thread waits for it, and looks after Python meanwhile: it calls the function
//! for progress, and asks whether a signal has come. So Ctrl-C ends the work,
//! and so does an exception in that function.
//!
//! Guaranteed: the work has ended when the call returns. Not guaranteed: that
//! it ends at once, since a stage may need a moment to notice.

use crate::error::{Error, exception};
use isoslice::limits::{Limits, Watch, enough_space};
use pyo3::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::thread::{Builder, scope};
use std::time::Duration;

/// Time between two looks after Python.
const EVERY: Duration = Duration::from_millis(50);

/// Stack of the thread that works: that of a program's first thread.
const STACK_BYTES: usize = 8 << 20;

/// How far the work has come.
#[derive(Default)]
pub(crate) struct Progress {
    done: AtomicUsize,
    all: AtomicUsize,
}

impl Progress {
    /// Takes in that some layers are done, of all.
    pub(crate) fn tell(&self, done: usize, all: usize) {
        self.all.store(all, Ordering::Relaxed);
        self.done.store(done, Ordering::Relaxed);
    }

    fn told(&self) -> (usize, usize) {
        let all = self.all.load(Ordering::Relaxed);
        (self.done.load(Ordering::Relaxed), all)
    }
}

/// Does work under limits.
pub(crate) fn at_work<T: Send>(
    py: Python<'_>,
    limits: Limits,
    progress: Option<&Bound<'_, PyAny>>,
    work: impl FnOnce(&Progress) -> anyhow::Result<T> + Send,
) -> PyResult<T> {
    enough_space().map_err(|error| exception(&error.into()))?;
    let watch = Watch::new(limits);
    let told = Progress::default();
    let (sender, mut receiver) = channel::<()>();
    let mut last = (0, 0);
    let mut report = |py: Python<'_>| -> PyResult<()> {
        py.check_signals()?;
        let now = told.told();
        if let Some(progress) = progress
            && now != last
        {
            last = now;
            progress.call1(now)?;
        }
        Ok(())
    };
    let mut raised = None;
    let result = scope(|scope| {
        let working = Builder::new()
            .name("isoslice".to_owned())
            .stack_size(STACK_BYTES)
            .spawn_scoped(scope, || {
                let _done = sender;
                watch.run(|| work(&told))
            })
            .map_err(|_| {
                Error::new_err(
                    "cannot start a thread; raise what the system allows \
                     (ulimit -v, ulimit -u)",
                )
            })?;
        loop {
            let receiver = &mut receiver;
            let ended = py.detach(move || receiver.recv_timeout(EVERY));
            if ended == Err(RecvTimeoutError::Disconnected) {
                break;
            }
            if let Err(error) = report(py) {
                watch.cancel();
                raised = Some(error);
                break;
            }
        }
        Ok::<_, PyErr>(py.detach(|| working.join()))
    })?;
    if let Some(error) = raised {
        return Err(error);
    }
    match result {
        Ok(Ok(Ok(value))) => {
            report(py)?;
            Ok(value)
        }
        Ok(Ok(Err(error))) => Err(exception(&error)),
        Ok(Err(stopped)) => Err(exception(&stopped.into())),
        Err(panic) => {
            let said = panic.downcast_ref::<String>().map(String::as_str);
            let said = said.or(panic.downcast_ref::<&str>().copied());
            Err(Error::new_err(format!(
                "isoslice itself has failed ({}); this is a bug: please \
                 report it with the model",
                said.unwrap_or("it does not say why")
            )))
        }
    }
}
