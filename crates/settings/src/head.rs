//! The room that a printer's head needs beside finished parts.

use super::Printer;
use isoslice_base::units::Mm;

/// What the head needs beside finished parts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeadRoom {
    /// Radius of the head around the nozzle.
    pub radius: Mm,
    /// How far the head is empty upwards from the nozzle's tip.
    pub free_below: Mm,
    /// Height of what moves across the whole bed.
    pub gantry: Mm,
    /// How far in front of the nozzle what is higher may stand.
    pub front: Option<Mm>,
}

impl Printer {
    /// The room that the head needs, if that is known.
    pub fn head_room(&self) -> Option<HeadRoom> {
        let clearance = self.head_clearance_radius?;
        Some(HeadRoom {
            radius: clearance.radius,
            free_below: clearance.free_below,
            gantry: self.gantry_height?,
            front: self.front_clearance,
        })
    }
}
