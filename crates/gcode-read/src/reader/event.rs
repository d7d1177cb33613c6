//! What the lines of a file do.

use super::problem::Problem;
use super::role::Role;
use glam::DVec3;
use isoslice_base::units::{
    Celsius, Mm, Mm2, MmPerSec, Percent, Seconds, filament_area,
};

/// Length below which a move of the head does not count, mm: 0.001 of the last
/// decimal that files have.
const STILL: Mm = 1e-6;

/// What a line, or a part of one, does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Event {
    /// The head or the filament moves.
    Move(Move),
    /// A layer begins. In a file that marks its layers, the number starts again
    /// from 1 at the first mark: what was printed before is no layer.
    Layer {
        /// Line, from 1.
        line: u64,
        /// Number of the layer, from 1.
        number: u32,
    },
    /// The firmware pulls filament back or pushes it forward again.
    FirmwareRetract {
        /// Line, from 1.
        line: u64,
        /// True for back (G10), false for forward (G11).
        back: bool,
    },
    /// A temperature is set.
    Heat {
        /// Line, from 1.
        line: u64,
        /// What is heated.
        heater: Heater,
        /// The temperature; 0 turns the heater off.
        to: Celsius,
        /// True if the printer waits until the temperature is reached.
        wait: bool,
    },
    /// A fan's speed is set.
    Fan {
        /// Line, from 1.
        line: u64,
        /// Number of the fan; 0 is the one that cools the part.
        fan: u32,
        /// The fan's speed.
        speed: Percent,
    },
    /// The printer waits for temperatures.
    WaitForHeat {
        /// Line, from 1.
        line: u64,
        /// The heater waited for; none means all heaters that have been set.
        heater: Option<Heater>,
        /// The least temperature waited for, if the command names one.
        least: Option<Celsius>,
    },
    /// All heaters are turned off.
    HeatersOff {
        /// Line, from 1.
        line: u64,
    },
    /// The printer waits.
    Dwell {
        /// Line, from 1.
        line: u64,
        /// Duration of the wait.
        time: Seconds,
    },
    /// The printer finds its zero.
    Home {
        /// Line, from 1.
        line: u64,
    },
    /// Another tool is taken.
    Tool {
        /// Line, from 1.
        line: u64,
        /// The tool's number.
        tool: u32,
    },
    /// A command that has no event of its own;
    /// [`Reader::words`](super::Reader::words) has its words until the next
    /// event.
    Other {
        /// Line, from 1.
        line: u64,
        /// G, M or T.
        letter: char,
        /// The command's number in tenths: 382 for G38.2.
        tenths: u32,
    },
    /// A command that is a name: one of Klipper's or a macro of the printer.
    /// The command is in [`Reader::named`](super::Reader::named). If the name
    /// is empty, a header tells the printer to begin and end by itself, as
    /// Ultimaker's do.
    Macro {
        /// Line, from 1.
        line: u64,
    },
    /// The reader has passed over something.
    Problem {
        /// Line, from 1.
        line: u64,
        /// Why it was passed over.
        problem: Problem,
    },
}

/// A part of the printer that is heated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Heater {
    /// The nozzle of a tool; of the tool in use, if none is named.
    Nozzle(Option<u32>),
    /// The bed.
    Bed,
    /// The chamber round the part.
    Chamber,
}

/// A straight move of the head, or a move of filament alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Move {
    /// Line, from 1; the chords of an arc share one.
    pub line: u64,
    /// Where the head was, in the machine's coordinates, mm.
    pub from: DVec3,
    /// Where the head goes, in the machine's coordinates, mm.
    pub to: DVec3,
    /// Length of filament fed; negative if it is pulled back.
    pub filament: Mm,
    /// Speed of the head, or of the filament if nothing else moves; 0 until the
    /// file sets one.
    pub speed: MmPerSec,
    /// What the move prints, if it prints.
    pub role: Role,
    /// Number of the layer, from 1; 0 before the first layer.
    pub layer: u32,
    /// Width of the bead, if it prints.
    pub width: Mm,
    /// True if comments say this width; else it is that of a bead of this plastic.
    pub says_width: bool,
    /// Height of the bead, if it prints.
    pub height: Mm,
    /// The tool in use.
    pub tool: u32,
    /// True if comments say that the move wipes the nozzle.
    pub wipe: bool,
    /// True for G0, which some slicers write for all travels.
    pub rapid: bool,
}

impl Move {
    /// Length of the head's way.
    pub fn length(&self) -> Mm {
        self.from.distance(self.to)
    }

    /// True if the head moves.
    pub fn travels(&self) -> bool {
        self.from.distance_squared(self.to) > STILL * STILL
    }

    /// True if the move leaves a bead: the head moves and filament is fed.
    pub fn prints(&self) -> bool {
        self.filament > 0.0 && self.travels()
    }

    /// Cross-section of the bead, from filament of this diameter.
    pub fn area(&self, filament_diameter: Mm) -> Mm2 {
        if self.prints() {
            self.filament * filament_area(filament_diameter) / self.length()
        } else {
            0.0
        }
    }
}
