//! Steps of a run that work ahead of those that take what they make.
//!
//! In: a step, which makes one thing after the other. Out: what it makes, in that
//! order, made on a thread of its own. An error is passed on in its place, and
//! nothing follows it. So the first error that the last step sees is that of the
//! lowest layer, however fast the threads are.

use super::SliceError;
use isoslice_base::limits;
use std::cell::RefCell;
use std::panic::resume_unwind;
use std::sync::mpsc::sync_channel;
use std::thread::{self, Scope, ScopedJoinHandle};

/// What a step makes.
pub(super) type Made<T> = Result<T, SliceError>;

/// What a step makes, one after the other.
pub(super) type Steps<'s, T> = Box<dyn Iterator<Item = Made<T>> + Send + 's>;

/// The threads of steps that work ahead.
pub(super) struct Threads<'s, 'env> {
    scope: &'s Scope<'s, 'env>,
    watch: Option<limits::Watch>,
    running: RefCell<Vec<ScopedJoinHandle<'s, ()>>>,
}

impl<'s> Threads<'s, '_> {
    /// What a step makes. If it is to work `ahead`, a thread makes the next one
    /// while the last one is used; it waits until that is taken, so only one is
    /// kept.
    ///
    /// # Errors
    /// If the system has no thread to spare.
    pub(super) fn ahead<T: Send + 's>(
        &self,
        ahead: bool,
        name: &str,
        step: impl Iterator<Item = Made<T>> + Send + 's,
    ) -> Result<Steps<'s, T>, SliceError> {
        if !ahead {
            return Ok(Box::new(step));
        }
        let (hand, taken) = sync_channel(0);
        let watch = self.watch.clone();
        let work = move || {
            limits::Watch::adopt(watch.as_ref());
            for made in step {
                let failed = made.is_err();
                // Nobody takes it if a later step has failed.
                if hand.send(made).is_err() || failed {
                    break;
                }
            }
        };
        let thread = thread::Builder::new().name(name.to_owned());
        let thread = thread
            .spawn_scoped(self.scope, work)
            .map_err(SliceError::LayersThread)?;
        self.running.borrow_mut().push(thread);
        Ok(Box::new(taken.into_iter()))
    }
}

/// Does work some steps of which may run on threads of their own. What these
/// make has to be dropped when the work ends, so that they end, too.
///
/// # Errors
/// The work's.
pub(super) fn with_threads<'env, T>(
    work: impl for<'s> FnOnce(&Threads<'s, 'env>) -> Result<T, SliceError>,
) -> Result<T, SliceError> {
    let watch = limits::Watch::current();
    thread::scope(|scope| {
        let threads = Threads {
            scope,
            watch,
            running: RefCell::default(),
        };
        let done = work(&threads);
        for thread in threads.running.take() {
            if let Err(panic) = thread.join() {
                resume_unwind(panic);
            }
        }
        done
    })
}
