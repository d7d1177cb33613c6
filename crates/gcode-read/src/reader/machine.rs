//! What a printer would know after each line: modes, positions, temperatures.
//!
//! In: the words of commands. Out: where the head and the filament go. As in
//! Klipper, G91 makes the filament relative, too, and G90 does not undo M83.
//! Other firmware differs; slicers write files for which the difference does
//! not matter.

use super::named::Named;
use super::words::Words;
use glam::DVec3;
use isoslice_base::units::{
    Celsius, Mm, Mm2, MmPerSec, MmPerSec2, Percent, filament_area,
};

/// Greatest coordinate of any machine, mm.
const REACH: Mm = 1e5;
/// Millimetres in an inch (G20).
const INCH: Mm = 25.4;

/// What the commands so far have set. A value that no command has set is none.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MachineState {
    /// Where the head is, in the machine's coordinates, which G92 does not
    /// change, mm.
    pub position: DVec3,
    /// Speed of moves (F); 0 until the file sets one.
    pub speed: MmPerSec,
    /// Temperature that the nozzle is to have.
    pub nozzle: Option<Celsius>,
    /// Temperature that the bed is to have.
    pub bed: Option<Celsius>,
    /// Speed of the part's fan.
    pub fan: Percent,
    /// The tool in use.
    pub tool: u32,
    /// Acceleration of printing moves.
    pub acceleration: Option<MmPerSec2>,
    /// Acceleration of travels.
    pub travel_acceleration: Option<MmPerSec2>,
    /// Speed through a right-angled corner (Klipper).
    pub square_corner_velocity: Option<MmPerSec>,
    /// True if positions count from where the head is (G91).
    pub relative: bool,
    /// True if the filament's positions count from where it is (M83 or G91).
    pub relative_e: bool,
    /// Filament that firmware has pulled back (G10).
    pub firmware_retracted: bool,
}

/// The machine itself.
#[derive(Clone, Debug)]
pub(super) struct Machine {
    pub state: MachineState,
    /// Millimetres in a unit of the file.
    unit: Mm,
    /// Where G92 has put the machine's zero.
    offset: DVec3,
    /// The filament's position, as the file counts.
    e: Mm,
    /// True after M83.
    e_mode_relative: bool,
    /// The filament's cross-section if E is a volume, mm³ (M200).
    volumetric: Option<Mm2>,
    /// Share of F at which moves are made (M220), and the saved share (M220 B).
    speed_factor: [f64; 2],
    /// Share of E that each tool feeds (M221).
    flow_factors: [f64; FLOWS],
    /// What Klipper's SET_GCODE_OFFSET adds to every position.
    gcode_offset: DVec3,
}

/// Number of tools with a share of E of their own. All others share that of the
/// last one.
const FLOWS: usize = 8;

/// A tool's index among the shares of E.
fn flow_of(tool: u32) -> usize {
    (tool as usize).min(FLOWS - 1)
}

/// What a move is to do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Target {
    pub to: DVec3,
    /// Filament fed.
    pub filament: Mm,
}

impl Default for Machine {
    fn default() -> Self {
        Self {
            state: MachineState::default(),
            unit: 1.0,
            offset: DVec3::ZERO,
            e: 0.0,
            e_mode_relative: false,
            volumetric: None,
            speed_factor: [1.0; 2],
            flow_factors: [1.0; FLOWS],
            gcode_offset: DVec3::ZERO,
        }
    }
}

impl Machine {
    pub(super) fn set_inches(&mut self, inches: bool) {
        self.unit = if inches { INCH } else { 1.0 };
    }

    pub(super) fn set_relative(&mut self, relative: bool) {
        self.state.relative = relative;
        self.state.relative_e = relative || self.e_mode_relative;
    }

    pub(super) fn set_relative_e(&mut self, relative: bool) {
        self.e_mode_relative = relative;
        self.state.relative_e = relative || self.state.relative;
    }

    /// A length of the file in millimetres.
    pub(super) fn length(&self, words: &Words, letter: u8) -> Option<Mm> {
        words.get(letter).map(|n| n * self.unit)
    }

    /// M200: E is a volume of filament of this diameter, or a length if the
    /// diameter is 0.
    pub(super) fn set_volumetric(&mut self, diameter: Mm) {
        let area = filament_area(diameter);
        self.volumetric = (area > 1e-3).then_some(area);
    }

    /// The E of a line as a length in millimetres.
    fn filament(&self, words: &Words) -> Option<Mm> {
        match self.volumetric {
            Some(area) => words.get(b'E').map(|volume| volume / area),
            None => self.length(words, b'E'),
        }
    }

    /// Takes in a move's feed rate, and tells where the move leads. If no
    /// machine reaches that place, the result is none, and only the speed has
    /// changed.
    pub(super) fn aim(&mut self, words: &Words) -> Option<Target> {
        let (relative, offset) = (self.state.relative, self.offset);
        self.aim_from(words, relative, offset)
    }

    /// Does what [`Machine::aim`] does, for a line that counts from the
    /// machine's own zero (G53).
    pub(super) fn aim_from_zero(&mut self, words: &Words) -> Option<Target> {
        self.aim_from(words, false, DVec3::ZERO)
    }

    fn aim_from(
        &mut self,
        words: &Words,
        relative: bool,
        offset: DVec3,
    ) -> Option<Target> {
        if let Some(rate) = self.length(words, b'F') {
            self.state.speed = rate.max(0.0) / 60.0;
        }
        let at = self.state.position;
        let axis = |letter, at: Mm, offset: Mm| match self.length(words, letter)
        {
            Some(by) if relative => at + by,
            Some(to) => to + offset,
            None => at,
        };
        let to = DVec3::new(
            axis(b'X', at.x, offset.x),
            axis(b'Y', at.y, offset.y),
            axis(b'Z', at.z, offset.z),
        );
        if to.abs().max_element() > REACH {
            return None;
        }
        let filament = match self.filament(words) {
            Some(by) if self.state.relative_e => by,
            Some(to) => to - self.e,
            None => 0.0,
        };
        self.e += filament;
        let filament = filament * self.flow_factors[flow_of(self.state.tool)];
        Some(Target { to, filament })
    }

    /// Speed of a move made now.
    pub(super) fn speed(&self) -> MmPerSec {
        self.state.speed * self.speed_factor[0]
    }

    /// M220: percentage of every speed. Marlin and Prusa save it with B and
    /// restore it with R.
    pub(super) fn set_speed_factor(&mut self, words: &Words) {
        if words.has(b'B') {
            self.speed_factor[1] = self.speed_factor[0];
        }
        if words.has(b'R') {
            self.speed_factor[0] = self.speed_factor[1];
        }
        if let Some(percent) = words.get(b'S').filter(|s| *s > 0.0) {
            self.speed_factor[0] = 0.01 * percent;
        }
    }

    /// M221: percentage of all filament of a tool: that of Marlin's T, of
    /// RepRapFirmware's D, or the tool in use.
    pub(super) fn set_flow_factor(&mut self, words: &Words) {
        let tool = words.get(b'T').or_else(|| words.get(b'D'));
        let tool = tool.map_or(self.state.tool, |tool| tool as u32);
        if let Some(percent) = words.get(b'S').filter(|s| *s >= 0.0) {
            self.flow_factors[flow_of(tool)] = 0.01 * percent;
        }
    }

    /// Klipper's SET_GCODE_OFFSET: an offset added to positions from now on.
    /// With MOVE=1 the head moves by it at once; then the target is returned.
    pub(super) fn set_gcode_offset(&mut self, named: &Named) -> Option<DVec3> {
        let mut by = DVec3::ZERO;
        for (i, axis) in ["X", "Y", "Z"].into_iter().enumerate() {
            let adjust = named.number(&format!("{axis}_ADJUST"));
            let to = named
                .number(axis)
                .or(adjust.map(|a| self.gcode_offset[i] + a));
            let to = to.unwrap_or(self.gcode_offset[i]).clamp(-REACH, REACH);
            by[i] = to - self.gcode_offset[i];
            self.gcode_offset[i] = to;
        }
        self.offset += by;
        let to = self.state.position + by;
        let moves = named.number("MOVE").is_some_and(|m| m != 0.0);
        (moves && to.abs().max_element() <= REACH).then_some(to)
    }

    /// G92: the head's position gets these coordinates; without any, it is
    /// zero.
    pub(super) fn set_position(&mut self, words: &Words) {
        if !b"XYZE".iter().any(|l| words.has(*l)) {
            self.e = 0.0;
            self.offset = self.state.position;
        }
        if let Some(e) = self.filament(words) {
            self.e = e;
        }
        let at = self.state.position;
        if let Some(x) = self.length(words, b'X') {
            self.offset.x = at.x - x;
        }
        if let Some(y) = self.length(words, b'Y') {
            self.offset.y = at.y - y;
        }
        if let Some(z) = self.length(words, b'Z') {
            self.offset.z = at.z - z;
        }
    }

    /// G28: the named axes, or all, go to zero.
    pub(super) fn home(&mut self, words: &Words) {
        let all = ![b'X', b'Y', b'Z'].iter().any(|l| words.has(*l));
        for (i, letter) in b"XYZ".iter().enumerate() {
            if all || words.has(*letter) {
                self.state.position[i] = 0.0;
                self.offset[i] = self.gcode_offset[i];
            }
        }
    }

    /// M204: Marlin's S for all, P for printing, T for travels.
    pub(super) fn set_acceleration(&mut self, words: &Words) {
        let word = |l| words.get(l).filter(|a| *a > 0.0);
        let (all, state) = (word(b'S'), &mut self.state);
        state.acceleration = word(b'P').or(all).or(state.acceleration);
        state.travel_acceleration =
            word(b'T').or(all).or(state.travel_acceleration);
    }

    /// Klipper's SET_VELOCITY_LIMIT.
    pub(super) fn set_velocity_limit(&mut self, named: &Named) {
        let number = |key| named.number(key).filter(|n| *n > 0.0);
        if let Some(limit) = number("ACCEL") {
            self.state.acceleration = Some(limit);
            self.state.travel_acceleration = Some(limit);
        }
        if let Some(speed) = number("SQUARE_CORNER_VELOCITY") {
            self.state.square_corner_velocity = Some(speed);
        }
    }

    /// M106: 0 to 255, or 0 to 1 in RepRapFirmware.
    pub(super) fn fan_speed(words: &Words) -> Percent {
        let speed = words.get(b'S').unwrap_or(255.0);
        let share = match speed {
            s if s > 0.0 && s <= 1.0 => s,
            s => s / 255.0,
        };
        100.0 * share.clamp(0.0, 1.0)
    }
}
