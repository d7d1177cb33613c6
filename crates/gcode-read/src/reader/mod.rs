//! Reads G-code of any slicer.
//!
//! In: bytes. Out: [`Event`]s in the order of the lines, each with its line's
//! number: moves with positions, filament, speed, role, layer, width and
//! height; temperatures, fans and tools; and problems.
//!
//! Understood: G0 to G3 (arcs in the plane become straight moves), G4, G10,
//! G11, G17 to G21, G28, G53, G90 to G92, M82, M83, M104, M106, M107, M109,
//! M116, M140, M141, M190, M191, M200, M204, M220, M221, M568, T, Klipper's
//! SET_VELOCITY_LIMIT, SET_HEATER_TEMPERATURE, TEMPERATURE_WAIT,
//! TURN_OFF_HEATERS, SET_GCODE_OFFSET and ACTIVATE_EXTRUDER, and the comments
//! of PrusaSlicer, OrcaSlicer, BambuStudio and Cura. Every other command is
//! an event, too.
//!
//! Binary G-code is unpacked ([`crate::bgcode`]), and so are the plates of Bambu
//! Lab's printers ([`crate::package`]); their lines count from the first one of
//! the text.
//!
//! Guarantees:
//! - any bytes can be read: a line that makes no sense is passed over, reported
//!   ([`Event::Problem`]) and counted ([`Reader::problems`]);
//! - every number is finite, and positions are within 300 m;
//! - memory does not grow with the file, whatever is in it;
//! - input that is no G-code is an error after some megabytes
//!   ([`ReadError::NoGcode`]), even if it has no end;
//! - what is read depends on the bytes alone.
//!
//! Not guaranteed: that firmware does what the reader says. To the reader,
//! homing leads to zero, macros of the printer do nothing, and roles and widths
//! are what comments say.
//!
//! ```
//! use isoslice_gcode_read::reader::{Event, Reader, Role};
//!
//! let text = "G1 Z0.2 F600\n;TYPE:WALL-OUTER\nG1 X10 E0.3 F1200\n";
//! let mut printed = 0.0;
//! for event in Reader::new(text.as_bytes()) {
//!     if let Event::Move(step) = event?
//!         && step.prints()
//!     {
//!         assert_eq!((step.line, step.role), (3, Role::OuterWall));
//!         printed += step.length();
//!     }
//! }
//! assert_eq!(printed, 10.0);
//! # Ok::<(), isoslice_gcode_read::reader::ReadError>(())
//! ```
//!
//! | file | what it does |
//! |---|---|
//! | `event` | what lines do |
//! | `lines` | lines, in memory that does not grow |
//! | `words` | letters and numbers |
//! | `named` | commands that are names |
//! | `machine` | modes and places |
//! | `arc` | arcs as straight moves |
//! | `comments`, `role`, `info` | what slicers say in comments |
//! | `layering` | layers, widths and heights |
//! | `peek` | what is known before the file is read |
//! | `problem` | what makes no sense |
//! | `nothing` | files that are no G-code |
//! | `parser` | from lines to events |

mod arc;
mod comments;
mod event;
mod info;
mod layering;
mod lines;
mod machine;
mod named;
mod nothing;
mod parser;
mod peek;
mod problem;
mod role;
mod words;

pub use event::{Event, Heater, Move};
pub use info::Info;
pub use machine::MachineState;
pub use named::Named;
pub use named::number;
pub use nothing::{NoGcode, Tally};
pub use peek::{filament_diameter, range_bottom};
pub use problem::{Problem, Problems};
pub use role::Role;
pub use words::Words;

use crate::bgcode::Damaged;
use crate::package::Broken;
use isoslice_base::units::Mm;
use lines::Lines;
use parser::Parser;
use std::io::{self, Read};

/// Diameter of the filament if neither the file nor the caller names one.
pub const USUAL_FILAMENT: Mm = 1.75;

/// Why a file cannot be read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReadError {
    /// The input failed.
    #[error("cannot read on after line {line}")]
    Io {
        /// The last line read.
        line: u64,
        /// What the system says.
        source: io::Error,
    },
    /// The file is damaged binary G-code.
    #[error("the binary G-code cannot be read: {0}")]
    Binary(Damaged),
    /// The file is a damaged plate of Bambu Lab's.
    #[error("the G-code in the archive cannot be read: {0}")]
    Archive(Broken),
    /// The file is no G-code.
    #[error("this is no G-code: {0}")]
    NoGcode(NoGcode),
}

impl ReadError {
    /// The error for input that fails after a line.
    fn new(line: u64, source: io::Error) -> Self {
        let source = match source.downcast() {
            Ok(damaged) => return ReadError::Binary(damaged),
            Err(source) => source,
        };
        let source = match source.downcast() {
            Ok(broken) => return ReadError::Archive(broken),
            Err(source) => source,
        };
        match source.downcast() {
            Ok(nothing) => ReadError::NoGcode(nothing),
            Err(source) => ReadError::Io { line, source },
        }
    }
}

impl From<NoGcode> for ReadError {
    fn from(why: NoGcode) -> Self {
        ReadError::NoGcode(why)
    }
}

/// Reads a file, event by event.
#[derive(Debug)]
pub struct Reader<R> {
    lines: Lines<R>,
    parser: Parser,
    failed: bool,
}

impl<R: Read> Reader<R> {
    /// A reader of `input`, which needs no buffer of its own.
    pub fn new(input: R) -> Self {
        Self {
            lines: Lines::new(input),
            parser: Parser::new(),
            failed: false,
        }
    }

    /// Sets the filament's diameter, whatever the file says. It matters only if
    /// the file does not tell the width of its beads.
    #[must_use]
    pub fn filament_diameter(mut self, diameter: Mm) -> Self {
        self.parser.filament_diameter = Some(diameter);
        self
    }

    /// Sets the height of what the first layer lies on, in a file that continues a
    /// part. It matters only if the file does not tell the height of its beads.
    #[must_use]
    pub fn base(mut self, base: Mm) -> Self {
        self.parser.layering.set_base(base);
        self
    }

    /// What the printer knows after the line of the last event.
    pub fn state(&self) -> &MachineState {
        &self.parser.machine.state
    }

    /// The words of the command read last.
    pub fn words(&self) -> &Words {
        &self.parser.words
    }

    /// The command of the last [`Event::Macro`], until the next event.
    pub fn named(&self) -> &Named {
        &self.parser.named
    }

    /// What the file has said about itself so far. Slicers write much of it
    /// at the end.
    pub fn info(&self) -> &Info {
        &self.parser.info
    }

    /// The problems so far.
    pub fn problems(&self) -> &Problems {
        &self.parser.problems
    }

    /// How many lines are commands, and how many are not.
    pub fn tally(&self) -> Tally {
        self.parser.tally
    }

    /// True if the last line read has no end.
    pub fn is_unfinished(&self) -> bool {
        self.parser.unfinished
    }

    /// Number of lines read so far.
    pub fn lines(&self) -> u64 {
        self.lines.number()
    }

    fn read(&mut self) -> Result<Option<Event>, ReadError> {
        loop {
            if let Some(event) = self.parser.next_pending() {
                return Ok(Some(event));
            }
            let number = self.lines.number();
            nothing::so_far(&self.parser.tally, self.lines.bytes())?;
            let failed = |source| ReadError::new(number, source);
            let line = self.lines.next().map_err(failed)?;
            let Some(line) = line else {
                return Ok(None);
            };
            if number == 0 {
                nothing::first_line(line.text)?;
            }
            self.parser.take(number + 1, &line);
        }
    }
}

impl<R: Read> Iterator for Reader<R> {
    type Item = Result<Event, ReadError>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.failed {
            return None;
        }
        let read = self.read();
        self.failed = read.is_err();
        read.transpose()
    }
}

#[cfg(test)]
mod tests;
