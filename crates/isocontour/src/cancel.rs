//! A way to stop work from outside.

use std::fmt;
use std::sync::Arc;

/// A question whether to stop. Every thread that works asks it every few
/// milliseconds.
#[derive(Clone, Default)]
pub struct Cancel(Option<Arc<dyn Fn() -> bool + Send + Sync>>);

/// The work was stopped from outside, by its [`Cancel`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the work was stopped")]
pub struct Cancelled;

impl Cancel {
    /// The work is never stopped.
    pub const NEVER: Cancel = Cancel(None);

    /// The work is stopped when `hook` says so. The hook is called on the
    /// threads that work, and should take less than a microsecond.
    pub fn when(hook: impl Fn() -> bool + Send + Sync + 'static) -> Cancel {
        Cancel(Some(Arc::new(hook)))
    }

    /// True if the work has to stop.
    #[inline]
    pub fn is_asked(&self) -> bool {
        self.0.as_ref().is_some_and(|hook| hook())
    }

    /// Stops the work if that is asked.
    ///
    /// # Errors
    /// If the work has to stop.
    #[inline]
    pub fn check(&self) -> Result<(), Cancelled> {
        if self.is_asked() {
            Err(Cancelled)
        } else {
            Ok(())
        }
    }
}

impl fmt::Debug for Cancel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(if self.0.is_some() { "Cancel" } else { "Never" })
    }
}
