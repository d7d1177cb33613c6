//! What differs between firmwares, in one place.
//!
//! In: the firmware. Out: its words, and the start and end templates used if
//! the settings give none.
//!
//! Klipper knows none of M201, M203, M205, M900, M862, M486, G29 and, with one
//! extruder, no `T0`; its M204 takes `S`, one acceleration for every move.

use crate::settings::Flavour;

/// Home, then wait off the bed for the heaters.
const START: &str = "\
G28
G1 Z5 F{feed_rate_z}
";

/// Heaters off first, so that they are off even if a move is refused; then
/// off the part before aside, which shows it. The writer turns the fan off.
const END: &str = "\
M104 S0
M140 S0
G1 Z{park_z} F{feed_rate_z}
G1 X0 Y{bed_y} F{feed_rate_travel}
M84
";

/// The start template of a firmware, used if the settings' is empty. The
/// writer adds the heating before and after it.
pub fn default_start(flavour: Flavour) -> &'static str {
    match flavour {
        Flavour::Marlin | Flavour::Klipper | Flavour::Rrf | Flavour::Prusa => {
            START
        }
    }
}

/// The end template of a firmware, used if the settings' is empty.
pub fn default_end(flavour: Flavour) -> &'static str {
    match flavour {
        Flavour::Marlin | Flavour::Klipper | Flavour::Rrf | Flavour::Prusa => {
            END
        }
    }
}

/// True if the firmware keeps one acceleration for printing and travelling,
/// which then has to be set before each change from one to the other.
pub(super) fn one_acceleration(flavour: Flavour) -> bool {
    match flavour {
        Flavour::Marlin | Flavour::Rrf | Flavour::Prusa => false,
        Flavour::Klipper => true,
    }
}

/// True if the firmware keeps statistics of the print that hosts read the
/// layer's number from.
pub(super) fn print_stats(flavour: Flavour) -> bool {
    match flavour {
        Flavour::Marlin | Flavour::Rrf | Flavour::Prusa => false,
        Flavour::Klipper => true,
    }
}
