//! How a file ends: whole, and with everything off?
//!
//! In: what each line does. Out, at the end: whether the file was cut off in
//! the middle of the print.
//!
//! A print has ended where a heater was turned off, or a macro called, behind
//! the last bead. A file that has not ended so is cut off if the mark is
//! missing that its slicer sets behind the last layer, or if it stops with a
//! bead, or within a line.

use crate::reader::{Info, Move, Role};

/// What the last command was.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
enum Last {
    #[default]
    Other,
    Move,
    Bead,
}

/// What is known of the end so far.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Ending {
    last: Last,
    /// Something of the part was printed.
    printed: bool,
    /// Behind the last bead a nozzle was turned off, or a macro was called.
    ended: bool,
    /// Behind the last bead a macro was called.
    pub by_macro: bool,
}

impl Ending {
    /// Has something of the part been printed?
    pub fn has_printed(&self) -> bool {
        self.printed
    }

    /// A move is made.
    pub fn step(&mut self, step: &Move) {
        self.last = Last::Move;
        if step.prints() && step.layer > 0 && step.role != Role::Custom {
            *self = Ending {
                last: Last::Bead,
                printed: true,
                ..Ending::default()
            };
        }
    }

    /// Anything else is done.
    pub fn other(&mut self) {
        self.last = Last::Other;
    }

    /// A nozzle is turned off.
    pub fn off(&mut self) {
        self.last = Last::Other;
        self.ended = true;
    }

    /// A macro is called, which may turn everything off.
    pub fn macro_called(&mut self) {
        self.off();
        self.by_macro = true;
    }

    /// What shows that the file was cut off, if it was. `unfinished` tells
    /// that its last line has no end.
    pub fn cut_off(
        &self,
        info: &Info,
        unfinished: bool,
    ) -> Option<&'static str> {
        let ours = info.generator.as_ref();
        let ours = ours.is_some_and(|name| name.starts_with("isoslice"));
        let stops =
            self.last == Last::Bead || (unfinished && self.last == Last::Move);
        if !self.printed || (self.ended && !ours) {
            None
        } else if info.ended == Some(false) {
            Some(
                "what the slicer writes behind the last layer is missing: \
                 the file was cut off; slice or copy it again",
            )
        } else if stops && !self.ended {
            Some(
                "the file stops in the middle of printing: it was cut off; \
                 slice or copy it again",
            )
        } else {
            None
        }
    }
}
