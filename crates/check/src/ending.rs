//! Tells whether a file is whole.
//!
//! In: what each line does. Out: whether the file was cut off in the middle of
//! the print.
//!
//! A print has ended where a heater is turned off, or a macro called, after the
//! last bead. A file without such an end is cut off if it stops with a bead or
//! within a line, or if its slicer marks the end of the last layer and the mark
//! is missing.

use isoslice_gcode_read::reader::{Info, Move, Role};

/// The kind of the last command.
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
    /// True if something of the part was printed.
    printed: bool,
    /// True if a nozzle was turned off or a macro called after the last bead.
    ended: bool,
    /// True if a macro was called after the last bead.
    pub by_macro: bool,
}

impl Ending {
    /// True if something of the part has been printed.
    pub(super) fn has_printed(&self) -> bool {
        self.printed
    }

    /// Takes in a move.
    pub(super) fn step(&mut self, step: &Move) {
        self.last = Last::Move;
        if step.prints() && step.layer > 0 && step.role != Role::Custom {
            *self = Ending {
                last: Last::Bead,
                printed: true,
                ..Ending::default()
            };
        }
    }

    /// Takes in a command that is neither a move nor one of the next two kinds.
    pub(super) fn other(&mut self) {
        self.last = Last::Other;
    }

    /// Takes in that a nozzle is turned off.
    pub(super) fn off(&mut self) {
        self.last = Last::Other;
        self.ended = true;
    }

    /// Takes in the call of a macro, which may turn everything off.
    pub(super) fn macro_called(&mut self) {
        self.off();
        self.by_macro = true;
    }

    /// What shows that the file was cut off; none if it was not. `unfinished`
    /// is true if the last line of the file has no end.
    pub(super) fn cut_off(
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
