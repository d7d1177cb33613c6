//! Makes events of commands and comments.

use super::USUAL_FILAMENT;
use super::arc::Arc;
use super::comments::{Tag, tag};
use super::event::{Event, Heater, Move};
use super::info::Info;
use super::layering::Layering;
use super::lines::{Line, LineEnd};
use super::machine::{Machine, Target};
use super::named::{Named, number};
use super::nothing::Tally;
use super::problem::{LONGEST_COMMAND, Problem, Problems};
use super::role::Role;
use super::words::{Command, Words, parse};
use glam::DVec2;
use isoslice_base::units::{Celsius, Mm};
use std::collections::VecDeque;

/// What the lines so far have said, and the events of the last one.
#[derive(Debug, Default)]
pub(super) struct Parser {
    line: u64,
    pub words: Words,
    pub named: Named,
    pub tally: Tally,
    pub unfinished: bool,
    pub machine: Machine,
    pub layering: Layering,
    role: Role,
    wipe: bool,
    /// True while a G0 is taken in.
    rapid: bool,
    pub filament_diameter: Option<Mm>,
    pub info: Info,
    pub problems: Problems,
    /// Events of the line read last.
    pending: VecDeque<Event>,
    /// True if arcs lie in the plane of x and y (G17).
    flat_arcs: bool,
    /// The arc that the events are walking along, and the filament of each of
    /// its chords.
    arc: Option<(Arc, Mm)>,
}

impl Parser {
    /// The parser before the first line.
    pub(super) fn new() -> Self {
        Self {
            layering: Layering::new(),
            flat_arcs: true,
            ..Self::default()
        }
    }

    /// The next event of the last line, if there is one left.
    pub(super) fn next_pending(&mut self) -> Option<Event> {
        let event = self.pending.pop_front();
        if event.is_some() || self.arc.is_none() {
            return event;
        }
        let (arc, filament) = self.arc.as_mut()?;
        let (next, filament) = (arc.next(), *filament);
        match next {
            Some(to) => self.step(Target { to, filament }),
            None => self.arc = None,
        }
        self.pending.pop_front()
    }

    /// Takes in the line with a number.
    pub(super) fn take(&mut self, number: u64, line: &Line<'_>) {
        self.line = number;
        self.unfinished = line.end == LineEnd::File;
        if line.end == LineEnd::Return {
            self.problem(Problem::CarriageReturn);
        }
        let text = match number {
            1 => without_mark(line.text),
            _ => line.text,
        };
        let parsed = parse(text, &mut self.words);
        match parsed.command {
            Command::Blank => {}
            Command::Text => self.name(text, line.whole),
            Command::Code(letter, tenths) => {
                self.tally.codes += 1;
                self.tally.idle += 1;
                if !line.whole {
                    self.problem(Problem::LongLine);
                }
                // Text for people is no harm if it is cut.
                if parsed.end > LONGEST_COMMAND && !self.words.has_text() {
                    self.problem(Problem::Overflow);
                }
                self.command(letter, tenths, parsed.stray);
            }
        }
        if let (Command::Blank, Some(at)) = (parsed.command, parsed.comment) {
            self.comment(&text[at..]);
        }
    }

    /// Takes in a line that is no letter with a number.
    fn name(&mut self, text: &[u8], whole: bool) {
        if !self.named.take(text) {
            self.tally.senseless += 1;
            self.problem(Problem::NoCommand);
            return;
        }
        self.tally.names += 1;
        if !whole || self.named.is_cut() {
            self.problem(Problem::LongLine);
        }
        if self.named.is("SET_GCODE_OFFSET") {
            self.check_offset();
        }
        let line = self.line;
        let named = &self.named;
        let event = if named.is("SET_VELOCITY_LIMIT") {
            self.machine.set_velocity_limit(named);
            Event::Macro { line }
        } else if named.is("SET_GCODE_OFFSET") {
            if let Some(to) = self.machine.set_gcode_offset(named) {
                let filament = 0.0;
                self.step(Target { to, filament });
            }
            Event::Macro { line }
        } else if named.is("TURN_OFF_HEATERS") {
            self.machine.state.nozzle = Some(0.0);
            self.machine.state.bed = Some(0.0);
            Event::HeatersOff { line }
        } else if named.is("SET_HEATER_TEMPERATURE") {
            // Without a target the heater is turned off.
            let to = named.get("TARGET").map_or(Some(0.0), number);
            match (named.get("HEATER").and_then(heater), to) {
                (Some(heater), Some(to)) => self.heat(heater, to, false),
                (_, None) => return self.problem(Problem::NoTemperature),
                (None, _) => Event::Macro { line },
            }
        } else if named.is("TEMPERATURE_WAIT") {
            match named.get("SENSOR").and_then(heater) {
                Some(heater) => Event::WaitForHeat {
                    line,
                    heater: Some(heater),
                    // Without a minimum the printer waits for cooling.
                    least: Some(named.number("MINIMUM").unwrap_or(0.0)),
                },
                None => Event::Macro { line },
            }
        } else if named.is("ACTIVATE_EXTRUDER") {
            let heater = named.get("EXTRUDER").and_then(heater);
            match heater {
                Some(Heater::Nozzle(Some(tool))) => {
                    self.machine.state.tool = tool;
                    Event::Tool { line, tool }
                }
                _ => Event::Macro { line },
            }
        } else {
            Event::Macro { line }
        };
        self.pending.push_back(event);
    }

    fn comment(&mut self, comment: &[u8]) {
        match tag(comment) {
            Some(Tag::Role(role)) => {
                if role == Role::OuterWall {
                    self.info.outer_wall(comment);
                }
                self.role = role;
            }
            Some(Tag::Wipe(wipe)) => self.wipe = wipe,
            Some(Tag::Volumetric) => {
                let diameter = self.diameter();
                self.machine.set_volumetric(diameter);
            }
            Some(Tag::OwnStart { volumetric }) => {
                if volumetric {
                    let diameter = self.diameter();
                    self.machine.set_volumetric(diameter);
                }
                self.named.clear();
                self.pending.push_back(Event::Macro { line: self.line });
            }
            Some(Tag::Preheat(heater, to)) => {
                let event = self.heat(heater, to, true);
                self.pending.push_back(event);
            }
            Some(tag) => {
                if tag == Tag::Layer {
                    self.info.layer_mark();
                }
                if self.layering.tag(tag) {
                    self.begin_layer();
                }
            }
            None => self.info.comment(comment),
        }
    }

    fn begin_layer(&mut self) {
        self.pending.push_back(Event::Layer {
            line: self.line,
            number: self.layering.number,
        });
    }

    fn problem(&mut self, problem: Problem) {
        let line = self.line;
        self.problems.count(problem, line);
        self.pending.push_back(Event::Problem { line, problem });
    }

    fn command(&mut self, letter: u8, tenths: u32, stray: bool) {
        let line = self.line;
        self.rapid = (letter, tenths) == (b'G', 0);
        let event = match (letter, tenths) {
            (b'G', 0 | 10) => {
                self.check_move(b"XYZEF", stray);
                return self.go();
            }
            (b'G', 20 | 30) => {
                self.check_move(b"XYZEFIJR", stray);
                return self.arc(tenths == 20);
            }
            (b'G', 40) => {
                let milliseconds = self.words.get(b'P').unwrap_or(0.0);
                let seconds = self.words.get(b'S').unwrap_or(0.0);
                let time = (seconds + 1e-3 * milliseconds).max(0.0);
                Event::Dwell { line, time }
            }
            // RepRapFirmware's G10 sets a tool's temperatures and offsets.
            (b'G', 100) if self.sets_a_tool() => self.tool_heating(tenths),
            (b'M', 5680) => self.tool_heating(tenths),
            (b'M', 1160) => Event::WaitForHeat {
                line,
                heater: None,
                least: None,
            },
            (b'G', 170..=190) if tenths.is_multiple_of(10) => {
                self.flat_arcs = tenths == 170;
                other(line, letter, tenths)
            }
            (b'M', 2000) => {
                let diameter = self.words.get(b'D').unwrap_or(0.0);
                let off = self.words.get(b'S') == Some(0.0);
                let diameter = if off { 0.0 } else { diameter };
                self.machine.set_volumetric(diameter);
                other(line, letter, tenths)
            }
            (b'G', 100 | 110) => {
                let back = tenths == 100;
                self.machine.state.firmware_retracted = back;
                Event::FirmwareRetract { line, back }
            }
            (b'G', 50 | 51) => {
                self.problem(Problem::Curve);
                return self.go();
            }
            // G53 makes this line count from the machine's own zero. A G1 may
            // follow it in the line.
            (b'G', 530) => {
                self.check(b"XYZEF", stray);
                if b"XYZE".iter().any(|l| self.words.has(*l)) {
                    let target = self.machine.aim_from_zero(&self.words);
                    return self.go_to(target);
                }
                other(line, letter, tenths)
            }
            (b'M', 2200) => {
                self.machine.set_speed_factor(&self.words);
                other(line, letter, tenths)
            }
            (b'M', 2210) => {
                self.machine.set_flow_factor(&self.words);
                other(line, letter, tenths)
            }
            (b'G', 200 | 210) => {
                self.machine.set_inches(tenths == 200);
                other(line, letter, tenths)
            }
            (b'G', 280) => {
                self.machine.home(&self.words);
                Event::Home { line }
            }
            (b'G', 900 | 910) => {
                self.machine.set_relative(tenths == 910);
                other(line, letter, tenths)
            }
            (b'G', 920) => {
                self.check(b"XYZE", stray);
                self.machine.set_position(&self.words);
                other(line, letter, tenths)
            }
            (b'M', 820 | 830) => {
                self.machine.set_relative_e(tenths == 830);
                other(line, letter, tenths)
            }
            (b'M', 1040 | 1041 | 1090 | 1400 | 1410 | 1900 | 1910) => {
                self.check(b"SR", false);
                self.heating(tenths)
            }
            (b'M', 1060 | 1070) => {
                let fan = self.words.get(b'P').unwrap_or(0.0) as u32;
                let speed = match tenths {
                    1060 => Machine::fan_speed(&self.words),
                    _ => 0.0,
                };
                if fan == 0 {
                    self.machine.state.fan = speed;
                }
                Event::Fan { line, fan, speed }
            }
            (b'M', 2040) => {
                self.machine.set_acceleration(&self.words);
                other(line, letter, tenths)
            }
            // Bambu Lab's printers take these numbers to mean no tool.
            (b'T', 2550 | 10_000 | 10_010 | 11_000 | 652_790 | 655_350) => {
                other(line, letter, tenths)
            }
            (b'T', _) if tenths.is_multiple_of(10) => {
                let tool = tenths / 10;
                self.machine.state.tool = tool;
                Event::Tool { line, tool }
            }
            _ => other(line, letter, tenths),
        };
        self.pending.push_back(event);
    }

    /// Adds a problem if something is wrong with a command of these letters.
    fn check(&mut self, letters: &[u8], stray: bool) {
        if let Some(bare) = self.words.bare_among(letters) {
            self.problem(Problem::MissingNumber(char::from(bare)));
        }
        if stray {
            self.problem(Problem::Stray);
        }
    }

    /// Adds a problem for each offset that is no number.
    fn check_offset(&mut self) {
        for axis in ['X', 'Y', 'Z'] {
            let keys = [axis.to_string(), format!("{axis}_ADJUST")];
            let senseless = |key: &String| {
                self.named.get(key).is_some_and(|n| number(n).is_none())
            };
            if keys.iter().any(senseless) {
                self.problem(Problem::MissingNumber(axis));
            }
        }
    }

    /// Adds a problem if something is wrong with a move. Firmware that takes
    /// one command from each line passes over a second one.
    fn check_move(&mut self, letters: &[u8], stray: bool) {
        self.check(letters, stray);
        if self.words.has(b'G') || self.words.has(b'M') {
            self.problem(Problem::TwoCommands);
        }
    }

    fn heating(&mut self, tenths: u32) -> Event {
        let wait = matches!(tenths, 1090 | 1900 | 1910);
        let heater = match tenths {
            1040 | 1041 | 1090 => {
                Heater::Nozzle(self.words.get(b'T').map(|t| t as u32))
            }
            1410 | 1910 => Heater::Chamber,
            _ => Heater::Bed,
        };
        // With R the printer also waits for cooling.
        let to = self.words.get(b'S').or_else(|| self.words.get(b'R'));
        match to {
            Some(to) => self.heat(heater, to, wait),
            None => other(self.line, b'M', tenths),
        }
    }

    /// True if a G10 is about a tool, and is no retraction. A retraction may
    /// have S0 or S1, which tells whether it is a long one.
    fn sets_a_tool(&self) -> bool {
        let words = &self.words;
        words.has(b'P')
            || words.has(b'R')
            || words.get(b'S').is_some_and(|s| s > 1.0)
    }

    /// RepRapFirmware's G10 and M568: the temperature of a tool.
    fn tool_heating(&mut self, tenths: u32) -> Event {
        let tool = self.words.get(b'P').map(|t| t as u32);
        match self.words.get(b'S') {
            Some(to) => self.heat(Heater::Nozzle(tool), to, false),
            None if tenths == 100 => other(self.line, b'G', tenths),
            None => other(self.line, b'M', tenths),
        }
    }

    fn heat(&mut self, heater: Heater, to: Celsius, wait: bool) -> Event {
        let state = &mut self.machine.state;
        match heater {
            Heater::Chamber => {}
            Heater::Bed => state.bed = Some(to),
            Heater::Nozzle(tool) => {
                if tool.is_none_or(|t| t == state.tool) {
                    state.nozzle = Some(to);
                }
            }
        }
        Event::Heat {
            line: self.line,
            heater,
            to,
            wait,
        }
    }

    /// Diameter of the filament.
    fn diameter(&self) -> Mm {
        self.filament_diameter
            .or(self.info.filament_diameter)
            .unwrap_or(USUAL_FILAMENT)
    }

    fn go(&mut self) {
        let target = self.machine.aim(&self.words);
        self.go_to(target);
    }

    fn go_to(&mut self, target: Option<Target>) {
        match target {
            Some(target) => self.step(target),
            None => self.problem(Problem::OutOfReach),
        }
    }

    fn arc(&mut self, clockwise: bool) {
        let from = self.machine.state.position;
        let Some(target) = self.machine.aim(&self.words) else {
            return self.problem(Problem::OutOfReach);
        };
        if !self.flat_arcs {
            self.problem(Problem::UprightArc);
            return self.step(target);
        }
        let length = |letter| self.machine.length(&self.words, letter);
        let arc = match length(b'R') {
            Some(radius) => {
                Arc::with_radius(from, target.to, radius, clockwise)
            }
            None => {
                let offset = DVec2::new(
                    length(b'I').unwrap_or(0.0),
                    length(b'J').unwrap_or(0.0),
                );
                Arc::around(from, target.to, offset, clockwise)
            }
        };
        match arc {
            Some(arc) => {
                let filament = target.filament * arc.share();
                self.arc = Some((arc, filament));
            }
            None => {
                self.problem(Problem::BadArc);
                self.step(target);
            }
        }
    }

    /// Adds a straight move to a target.
    fn step(&mut self, target: Target) {
        let Target { to, filament } = target;
        let from = self.machine.state.position;
        let mut step = Move {
            line: self.line,
            from,
            to,
            filament,
            speed: self.machine.speed(),
            role: self.role,
            layer: self.layering.number,
            width: 0.0,
            says_width: false,
            height: 0.0,
            tool: self.machine.state.tool,
            wipe: self.wipe,
            rapid: self.rapid,
        };
        if step.prints() {
            if self.layering.print(from, to, self.role) {
                self.begin_layer();
            }
            let diameter = self.diameter();
            step.layer = self.layering.number;
            step.width = self.layering.width(step.area(diameter));
            step.says_width = self.layering.says_width();
            step.height = self.layering.height();
        }
        if to != from {
            self.tally.idle = 0;
        }
        self.machine.state.position = to;
        self.pending.push_back(Event::Move(step));
    }
}

/// A line without the byte-order mark with which some editors begin a file. The
/// mark stays if a command follows, since firmware stumbles over it.
fn without_mark(line: &[u8]) -> &[u8] {
    match line.strip_prefix("\u{feff}".as_bytes()) {
        Some(rest) if rest.first().is_none_or(|b| *b == b';') => rest,
        _ => line,
    }
}

/// The heater by its name in Klipper: `extruder`, `extruder1`, `heater_bed`,
/// `heater_generic chamber`.
fn heater(name: &[u8]) -> Option<Heater> {
    let name = name.trim_ascii().to_ascii_lowercase();
    if let Some(number) = name.strip_prefix(b"extruder") {
        let number = std::str::from_utf8(number).ok()?;
        let tool = if number.is_empty() { "0" } else { number };
        return Some(Heater::Nozzle(Some(tool.parse().ok()?)));
    }
    if name == b"heater_bed" {
        return Some(Heater::Bed);
    }
    let chamber = memchr::memmem::find(&name, b"chamber").is_some();
    chamber.then_some(Heater::Chamber)
}

/// The event of a command that has no event of its own.
pub(super) fn other(line: u64, letter: u8, tenths: u32) -> Event {
    Event::Other {
        line,
        letter: char::from(letter),
        tenths,
    }
}
