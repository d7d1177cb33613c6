//! Models as rhai scripts, run where they can do nothing but describe a shape.
//!
//! In: the text of a script and the `-D` definitions. Out: an expression tree
//! and the script's parameters.
//!
//! The model is the union of what is passed to `draw`. Without a `draw` it is
//! the script's last value.
//!
//! | file | what scripts get from it |
//! |---|---|
//! | `named` | functions and constants, those of formulas |
//! | `operators`, `tokens` | arithmetic, in which whole numbers are numbers and powers bind as in mathematics |
//! | `shapes` | shapes and transforms |
//! | `functions` | `draw`, `param`, places |
//!
//! Guarantees, for any script: there is no file, network, environment or clock,
//! no `import` and no `eval`; operations, time, call depth, nesting and the
//! sizes of strings, arrays and maps are bounded; where the system tells it,
//! memory is bounded as well. The script runs on a thread of its own with a
//! stack that its bounded depth cannot exhaust.
//!
//! Not guaranteed: that a stopped script ends at once. If it is in the middle
//! of a single long operation, or still being parsed, nobody waits for it, but
//! its thread goes on until the operation is done, and so does the memory that
//! the operation takes.

mod bodies;
mod call;
mod error;
mod functions;
mod limits;
mod named;
mod operators;
mod sandbox;
mod shape;
mod shapes;
mod suggest;
#[cfg(test)]
mod tests;
mod tokens;

pub use call::{Argument, call};
pub use error::ScriptError;
pub use limits::ScriptLimits;
pub(crate) use shape::union;
pub use shapes::makes_body;

use super::data::Files;
use super::param::{Parameter, Table};
use bodies::Bodies;
use cpu_time::ProcessTime;
use error::explain;
use fidget::context::Tree;
use functions::{Shared, add_data, add_draw, add_param, add_places};
use isoslice_base::limits::{
    Cancelled, Watch, doing, is_stopped, resident_bytes,
};
use limits::{GO_ON, Stop};
use named::add_names;
use operators::add_operators;
use rhai::{Dynamic, Engine};
use sandbox::{add_limits, add_replace};
use shape::{describe, shape};
use shapes::add_shapes;
use std::sync::atomic::{AtomicU8, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};
use tokens::add_powers;

/// Stack of the script's thread. It is reserved, but used only if a script
/// nests to the limits (arrays of arrays are freed recursively: `MAX_ARRAY`
/// levels).
const STACK_BYTES: usize = 512 << 20;

/// Time between looks at the work and the memory. At its highest rate a script
/// can fill some MB in this time.
const EVERY: Duration = Duration::from_millis(2);

/// Time that a script has to notice that it was stopped. A script in the middle
/// of a single long operation, or still being parsed, is then left to itself,
/// and its thread ends after it.
const GRACE: Duration = Duration::from_secs(1);

/// What a script describes.
#[derive(Debug)]
pub(super) struct Script {
    pub tree: Tree,
    pub parameters: Vec<Parameter>,
}

/// Runs a script, which may read files.
pub(super) fn run_script(
    text: &str,
    defines: &[(String, String)],
    limits: &ScriptLimits,
    files: &Arc<Files>,
) -> Result<Script, ScriptError> {
    let bug = |message: &str| ScriptError::Bug {
        message: message.to_owned(),
    };
    let stop = Arc::new(AtomicU8::new(GO_ON));
    let (sender, receiver) = channel();
    let work = {
        let (text, defines) = (text.to_owned(), defines.to_vec());
        let (limits, stop) = (*limits, stop.clone());
        let (files, watch) = (files.clone(), Watch::current());
        move || {
            // Readers of data ask the watch whether to stop.
            Watch::adopt(watch.as_ref());
            let result = run_here(&text, &defines, &limits, &stop, &files);
            // Nobody receives the result if it took too long.
            let _ = sender.send(result);
        }
    };
    // Memory is measured before the thread begins, since its stack is part of
    // what the script takes.
    let before = resident_bytes();
    std::thread::Builder::new()
        .name("script".to_owned())
        .stack_size(STACK_BYTES)
        .spawn(work)
        .map_err(|_| ScriptError::Limit {
            line: None,
            what: format!(
                "cannot be run: it needs a thread and {} MB of address space \
                 for its stack; raise what the system allows (ulimit -v, \
                 ulimit -u)",
                STACK_BYTES >> 20
            ),
        })?;
    /// Stops the script when this thread leaves, for whatever reason.
    struct Leave<'a>(&'a AtomicU8);
    impl Drop for Leave<'_> {
        fn drop(&mut self) {
            self.0.store(Stop::Time.number(), Ordering::Relaxed);
        }
    }
    let _leave = Leave(&stop);
    let start = Instant::now();
    let work = ProcessTime::try_now().ok();
    let spent = || {
        let work = work.and_then(|start| start.try_elapsed().ok());
        work.map_or(start.elapsed(), |work| work.min(start.elapsed()))
    };
    let mut stopped: Option<(Stop, Instant)> = None;
    let taken = files.taken();
    doing("script", || {
        loop {
            match receiver.recv_timeout(EVERY) {
                Ok(result) => return result,
                Err(RecvTimeoutError::Disconnected) => {
                    return Err(bug("it panicked"));
                }
                Err(RecvTimeoutError::Timeout) if is_stopped() => {
                    return Err(ScriptError::Limit {
                        line: None,
                        what: Cancelled.to_string(),
                    });
                }
                Err(RecvTimeoutError::Timeout) => {}
            }
            if let Some((why, since)) = stopped {
                if since.elapsed() > GRACE {
                    return Err(ScriptError::Limit {
                        line: None,
                        what: why.describe(limits),
                    });
                }
                continue;
            }
            let grown =
                |before| resident_bytes().map(|now| now.saturating_sub(before));
            let is_beyond = |most: u64| {
                let grown = before.and_then(grown);
                grown.is_some_and(|grown| grown > most)
            };
            // What data takes is bounded by the sizes of files.
            let allowed = limits.time + taken.time();
            let memory = taken.bytes();
            let memory = memory.map(|b| limits.memory_bytes.saturating_add(b));
            let why = if spent() > allowed {
                Stop::Time
            } else if memory.is_some_and(is_beyond) {
                Stop::Memory
            } else {
                continue;
            };
            stop.store(why.number(), Ordering::Relaxed);
            stopped = Some((why, Instant::now()));
        }
    })
}

/// Runs a script on this thread.
fn run_here(
    text: &str,
    defines: &[(String, String)],
    limits: &ScriptLimits,
    stop: &Arc<AtomicU8>,
    files: &Arc<Files>,
) -> Result<Script, ScriptError> {
    let shared = Arc::new(Mutex::new(Shared {
        parameters: Table::new(defines),
        ..Shared::default()
    }));
    let bodies = Bodies::of_script();
    let mut engine = engine(limits.operations, stop, &bodies);
    add_data(&mut engine, files, &bodies);
    add_draw(&mut engine, &shared);
    add_param(&mut engine, &shared);

    let result = engine.eval::<Dynamic>(text);
    let mut state = shared.lock().unwrap_or_else(PoisonError::into_inner);
    let last = match result {
        Ok(value) => value,
        Err(error) => {
            return Err(explain(&error, state.error.take(), limits, text));
        }
    };
    let drawn = std::mem::take(&mut state.drawn);
    // An unknown -D may explain a missing model, so it is reported first.
    let parameters = std::mem::take(&mut state.parameters)
        .finish()
        .map_err(|error| ScriptError::Param { line: None, error })?;
    let tree = match union(drawn) {
        Some(tree) => tree,
        None => shape(&last).ok_or_else(|| ScriptError::NoModel {
            found: describe(&last),
        })?,
    };
    Ok(Script { tree, parameters })
}

/// An interpreter with all functions that do nothing but make shapes. A script
/// may take `most` operations.
fn engine(most: u64, stop: &Arc<AtomicU8>, bodies: &Bodies) -> Engine {
    let mut engine = Engine::new();
    engine.set_fail_on_invalid_map_property(true);
    add_limits(&mut engine, most, stop.clone());
    add_replace(&mut engine);
    add_places(&mut engine);
    add_names(&mut engine, bodies);
    add_operators(&mut engine, bodies);
    add_shapes(&mut engine, bodies);
    add_powers(&mut engine);
    engine
}
