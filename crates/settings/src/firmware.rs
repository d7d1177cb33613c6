//! What firmware does: one row for each kind.
//!
//! In: a [`Flavour`]. Out: facts that several modules ask for. The G-code
//! commands in which firmwares differ are in `gcode/flavour.rs` and
//! `gcode/label.rs`, and how firmwares take corners is in
//! `pace/motion/planner.rs`. Every match there names all flavours, so the
//! compiler lists what a new one needs.

use super::words::Flavour;
use isoslice_base::units::{Mm, PerSec};

/// What a kind of firmware does.
#[derive(Clone, Copy, Debug)]
pub struct Firmware {
    /// Moves a second that the firmware takes; a cautious figure.
    pub moves_per_second: PerSec,
    /// Whether the firmware retracts by itself (G10 and G11).
    pub retraction: Retraction,
    /// What the firmware refuses to extrude, unless its configuration says
    /// otherwise.
    pub refuses: Option<Refusals>,
    /// True if some of the firmware's printers read binary G-code.
    pub reads_binary: bool,
    /// True if the firmware's printers read G-code packed as .gcode.3mf, and
    /// expect it.
    pub reads_plates: bool,
    /// True if the firmware keeps one acceleration for printing and travelling,
    /// which then has to be set before each change from one to the other.
    pub one_acceleration: bool,
    /// True if the firmware keeps statistics of the print, from which hosts
    /// read the layer's number.
    pub print_stats: bool,
    /// True if the firmware shows how far a print has come (M73).
    pub shows_progress: bool,
    /// True if the firmware loses track of the head's place while it leaves out
    /// a part.
    pub forgets_place: bool,
    /// True if the label of a part names the part's outline.
    pub outlines_parts: bool,
    /// True if the firmware compares the printer's model and nozzle with those
    /// that a file names (M862).
    pub asks_printer: bool,
    /// The line that selects the extruder, for firmware that starts with none
    /// selected: temperatures are for the selected one.
    pub select_tool: Option<&'static str>,
    /// What stops a print until somebody is there.
    pub pauses: Pauses,
    /// Cura's name for the firmware. Cura takes a file with an unknown name for
    /// one for Marlin.
    pub cura_name: &'static str,
}

/// Whether firmware retracts by itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Retraction {
    /// The firmware takes any lengths and speeds.
    Any,
    /// The firmware refuses low speeds, and to push less than it pulled.
    Klipper,
    /// The firmware does not retract by itself.
    None,
}

/// What firmware refuses to extrude. Klipper's are the only such limits that
/// are known, so messages about them name Klipper.
#[derive(Clone, Copy, Debug)]
pub struct Refusals {
    /// Greatest cross-section of a line, in squares of the nozzle.
    pub section: f64,
    /// Greatest length of filament that is fed while the head stands.
    pub feed: Mm,
}

/// What stops a print in the middle of a file until somebody is there. Commands that
/// the firmware does not know stop nothing: it says so at most, and prints on.
#[derive(Clone, Copy, Debug)]
pub struct Pauses {
    /// The firmware's name, as people know it.
    pub firmware: &'static str,
    /// The commands that pause, each with what it needs: the end of a sentence.
    pub known: &'static [(&'static str, &'static str)],
    /// Commands that end the print instead, though they pause elsewhere.
    pub ends: &'static [&'static str],
    /// Where a user may define commands that the firmware does not know, if it has
    /// such a place.
    pub defined_in: Option<&'static str>,
    /// What to write for a pause.
    pub advice: &'static str,
}

/// Firmware that does nothing of its own. Each of the others says in what it differs.
const PLAIN: Firmware = Firmware {
    moves_per_second: 200.0,
    retraction: Retraction::Any,
    refuses: None,
    reads_binary: false,
    reads_plates: false,
    one_acceleration: false,
    print_stats: false,
    shows_progress: false,
    forgets_place: false,
    outlines_parts: false,
    asks_printer: false,
    select_tool: None,
    pauses: Pauses {
        firmware: "the firmware",
        known: &[("M0", "")],
        ends: &[],
        defined_in: None,
        advice: "write M0",
    },
    cura_name: "Marlin",
};

/// Marlin mostly gets its lines over a serial connection: 25 bytes at 115,200
/// baud take 2 ms, and a host sends only a few lines ahead of Marlin's answers.
/// A Marlin built without M73 says that it does not know M73, and goes on.
const MARLIN: Firmware = Firmware {
    moves_per_second: 200.0,
    shows_progress: true,
    forgets_place: true,
    // What each needs stands round its line in Marlin/src/gcode/gcode.cpp. M226 waits
    // for a pin.
    pauses: Pauses {
        firmware: "Marlin",
        known: &[
            ("M0", ""),
            ("M1", ""),
            ("M25", ""),
            ("M125", ", if Marlin was built with PARK_HEAD_ON_PAUSE"),
            (
                "M600",
                ", if Marlin was built with ADVANCED_PAUSE_FEATURE, an option that \
                 is off by default: without it Marlin prints on, and M0 is the pause",
            ),
        ],
        advice: "write M0",
        ..PLAIN.pauses
    },
    ..PLAIN
};

/// Klipper plans on the host. Its limits are the defaults of
/// `max_extrude_cross_section` and `max_extrude_only_distance`
/// (docs/Config_Reference.md). Its pauses are those of klippy/extras/pause_resume.py
/// and virtual_sdcard.py; `cmd_default` of klippy/gcode.py tells of other commands, and
/// goes on.
const KLIPPER: Firmware = Firmware {
    moves_per_second: 1000.0,
    retraction: Retraction::Klipper,
    refuses: Some(Refusals {
        section: 4.0,
        feed: 50.0,
    }),
    one_acceleration: true,
    print_stats: true,
    outlines_parts: true,
    pauses: Pauses {
        firmware: "Klipper",
        known: &[
            ("M25", ", if the file is printed from [virtual_sdcard]"),
            ("PAUSE", ", if printer.cfg has [pause_resume]"),
        ],
        defined_in: Some("printer.cfg"),
        advice: "write PAUSE, which needs [pause_resume] in printer.cfg",
        ..PLAIN.pauses
    },
    ..PLAIN
};

/// RepRapFirmware 3 reads the file itself. Its pauses are in src/GCodes/GCodes2.cpp,
/// where M0 to M2 in a file end its print.
const RRF: Firmware = Firmware {
    moves_per_second: 500.0,
    select_tool: Some("T0"),
    pauses: Pauses {
        firmware: "RepRapFirmware",
        known: &[("M25", ""), ("M226", ""), ("M600", ""), ("M601", "")],
        ends: &["M0", "M1"],
        defined_in: Some("a macro of that name"),
        advice: "write M226, or M600 to change the filament",
    },
    cura_name: "RepRap",
    ..PLAIN
};

/// Prusa's 32-bit boards read the file themselves. Those from the MINI and the
/// MK3.5 on read binary G-code. M226 waits for a pin.
const PRUSA: Firmware = Firmware {
    moves_per_second: 400.0,
    reads_binary: true,
    shows_progress: true,
    forgets_place: true,
    asks_printer: true,
    pauses: Pauses {
        firmware: "Prusa's firmware",
        known: &[
            ("M0", ""),
            ("M1", ""),
            ("M25", ""),
            ("M600", ""),
            ("M601", ""),
        ],
        advice: "write M601, or M600 to change the filament",
        ..PLAIN.pauses
    },
    ..PLAIN
};

/// Bambu Lab's printers read the file themselves. What their firmware knows is not
/// published; the pause is the one that Bambu Studio's profiles have for all of them
/// (`machine_pause_gcode`).
const BAMBU: Firmware = Firmware {
    moves_per_second: 500.0,
    retraction: Retraction::None,
    reads_plates: true,
    one_acceleration: true,
    shows_progress: true,
    forgets_place: true,
    pauses: Pauses {
        firmware: "Bambu Lab's firmware",
        known: &[("M400 U1", "")],
        advice: "write M400 U1",
        ..PLAIN.pauses
    },
    ..PLAIN
};

impl Flavour {
    /// What the firmware does.
    pub fn firmware(self) -> &'static Firmware {
        match self {
            Flavour::Marlin => &MARLIN,
            Flavour::Klipper => &KLIPPER,
            Flavour::Rrf => &RRF,
            Flavour::Prusa => &PRUSA,
            Flavour::Bambu => &BAMBU,
        }
    }
}
