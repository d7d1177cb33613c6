//! What a script may use, and why it is stopped if it uses more.

use isoslice_base::units::human_bytes;
use std::time::Duration;

/// Bounds on what a script may use.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScriptLimits {
    /// Steps of the interpreter. Default: 10⁷. A lattice of 10,000 struts needs
    /// some 10⁶.
    pub operations: u64,
    /// Processor time of the process while the script runs, but no more than
    /// the time on the clock. So neither a pause (Ctrl-Z) counts, nor what other
    /// threads do meanwhile. Default: 20 s, about ten times what the operations
    /// take.
    pub time: Duration,
    /// Growth of the process's memory while the script runs, where the system
    /// tells how much it is. Other threads of the process count as well.
    /// Default: 192 MiB.
    pub memory_bytes: u64,
}

impl Default for ScriptLimits {
    fn default() -> Self {
        Self {
            operations: 10_000_000,
            time: Duration::from_secs(20),
            memory_bytes: 192 << 20,
        }
    }
}

/// Elements of an array, all levels together.
pub(super) const MAX_ARRAY: usize = 50_000;
/// Entries of an object map, all levels together.
pub(super) const MAX_MAP: usize = 20_000;
/// Bytes of a string.
pub(super) const MAX_STRING: usize = 1 << 20;
/// Values of a call beyond which rhai does not look for a function that takes
/// values of any kind.
pub(super) const MOST_VALUES: usize = 16;
/// Variables at one time in one function.
pub(super) const MAX_VARIABLES: usize = 1000;
/// Functions of a script.
pub(super) const MAX_FUNCTIONS: usize = 1000;
/// Calls inside each other.
pub(super) const MAX_CALLS: usize = 100;
/// Nesting of expressions, outside and inside of functions.
pub(super) const MAX_DEPTH: (usize, usize) = (200, 100);

/// Why a script was stopped.
#[derive(Clone, Copy)]
pub(super) enum Stop {
    Operations,
    Time,
    Memory,
}

/// What the flag holds while there is no reason to stop.
pub(super) const GO_ON: u8 = 0;

impl Stop {
    /// The reason as the flag holds it.
    pub(super) fn number(self) -> u8 {
        match self {
            Stop::Operations => 1,
            Stop::Time => 2,
            Stop::Memory => 3,
        }
    }

    pub(super) fn from_number(number: u8) -> Option<Stop> {
        let all = [Stop::Operations, Stop::Time, Stop::Memory];
        all.into_iter().find(|stop| stop.number() == number)
    }

    /// What happened, and the remedy.
    pub(super) fn describe(self, limits: &ScriptLimits) -> String {
        match self {
            Stop::Time => format!(
                "took more than {} s and was stopped; build fewer parts in \
                 loops",
                limits.time.as_secs_f64()
            ),
            Stop::Memory => format!(
                "took more than {} of memory and was stopped; build fewer \
                 parts in loops",
                human_bytes(limits.memory_bytes)
            ),
            Stop::Operations => format!(
                "took more than {} steps and was stopped; is there a loop \
                 that never ends? Repeat parts with `%` (modulo) of a \
                 coordinate instead of loops",
                limits.operations
            ),
        }
    }
}
