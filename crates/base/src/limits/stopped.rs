//! Work that was stopped: why, how far it had come, and what to do about it.

use super::{Limits, space};
use crate::units::human_bytes;
use std::fmt;

/// Why work was stopped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reason {
    /// The time was up.
    Time,
    /// The processor time was used up.
    Work,
    /// The memory was used up.
    Memory,
    /// Nearly all the address space that the system allows was taken.
    Space,
    /// The work made hardly any progress ([`Limits::slow`]).
    Slow,
    /// Somebody called [`Watch::cancel`](super::Watch::cancel).
    Cancelled,
}

impl Reason {
    pub(super) const ALL: [Reason; 6] = [
        Reason::Time,
        Reason::Memory,
        Reason::Work,
        Reason::Slow,
        Reason::Cancelled,
        Reason::Space,
    ];

    /// The number of the reason, as the flag holds it. 0 is for work that may
    /// go on.
    pub(super) fn number(self) -> u8 {
        match self {
            Reason::Time => 1,
            Reason::Memory => 2,
            Reason::Cancelled => 3,
            Reason::Space => 4,
            Reason::Slow => 5,
            Reason::Work => 6,
        }
    }
}

/// What a run has done until now, for people.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Activity {
    /// The stages by name, with their shares of the time so far, the largest
    /// first.
    pub shares: Vec<(&'static str, f64)>,
    /// The stage in which most threads are.
    pub now: Option<&'static str>,
    /// Number of layers written, and of all layers, once that is known.
    pub layers: Option<(usize, usize)>,
}

impl Activity {
    /// How to make the stage that took most of the time cheaper.
    pub fn remedy(&self) -> &'static str {
        remedy(self.shares.first().map(|(name, _)| *name))
    }
}

/// Work that was stopped before it was done.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub struct Stopped {
    /// Why the work was stopped.
    pub reason: Reason,
    /// The limits of the work.
    pub limits: Limits,
    /// How far the work had come. It is boxed, since results should be small.
    pub activity: Box<Activity>,
}

impl fmt::Display for Stopped {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Limits {
            time,
            memory_bytes,
            work,
            slow,
        } = self.limits;
        match (self.reason, time, memory_bytes) {
            (Reason::Work, ..) => write!(
                f,
                "stopped after {} h of processor time",
                work.unwrap_or_default().as_secs_f64() / 3600.0
            )?,
            (Reason::Time, Some(time), _) => write!(
                f,
                "stopped after {} s, the time limit (--time-limit)",
                time.as_secs_f64()
            )?,
            (Reason::Memory, _, Some(bytes)) => write!(
                f,
                "stopped at {} of memory, the limit (--memory-limit)",
                human_bytes(bytes)
            )?,
            (Reason::Slow, ..) => write!(
                f,
                "stopped, since next to nothing came of the last {} s of \
                 processor time",
                slow.map_or(0.0, |slow| slow.work.as_secs_f64())
            )?,
            (Reason::Space, ..) => write!(
                f,
                "stopped short of the {} MB of address space that the system \
                 allows (ulimit -v)",
                space::allowed().unwrap_or_default() >> 20
            )?,
            _ => write!(f, "stopped")?,
        }
        if let Some((done, all)) = self.activity.layers {
            write!(f, ", with {done} of {all} layers done")?;
        }
        let mut slow = false;
        for (name, share) in self.activity.shares.iter().take(2) {
            let percent = 100.0 * share;
            if !slow {
                write!(f, "; {percent:.0} % of the time went into {name}")?;
                slow = true;
            } else if percent >= 10.0 {
                write!(f, ", {percent:.0} % into {name}")?;
            }
        }
        if self.reason == Reason::Cancelled {
            return Ok(());
        }
        let or = match self.reason {
            Reason::Slow | Reason::Work => {
                "give it the time that it may take: --time-limit 8h"
            }
            _ => "raise the limit",
        };
        write!(f, ". {}, or {or}", self.activity.remedy())
    }
}

/// How to make a stage cheaper.
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
            "Slice some layers at a time (--layers), set sample_spacing to \
             half of outer_wall_width, or make the expression simpler"
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
            "Slice some layers at a time (--layers), or give the part \
             fewer details"
        }
    }
}
