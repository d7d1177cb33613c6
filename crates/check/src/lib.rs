//! Checks whether G-code is safe to run, and whether everything in it stands on
//! something.
//!
//! In: a file's bytes, and the [`Rules`] of a printer. Out: a [`Verdict`]:
//! faults, which can hurt the printer or the print, and warnings, each once
//! with its count and its first places.
//!
//! | rule | kind |
//! |---|---|
//! | the head stays where the printer can go | [`FindingKind::OutOfReach`] |
//! | plastic is pushed only through a nozzle that is hot enough for it | [`FindingKind::Cold`] |
//! | no heater is told more than it bears | [`FindingKind::TooHot`], [`FindingKind::Hot`] |
//! | the head knows where it is before it moves | [`FindingKind::NotHomed`] |
//! | filament goes back in retractions and wipes only, and not too far | [`FindingKind::Backwards`], [`FindingKind::LongRetraction`] |
//! | pulled-back filament is pushed forward before a bead begins | [`FindingKind::Unprimed`] |
//! | no more than that is pushed while the head stands | [`FindingKind::Blob`] |
//! | beads are not interrupted, and layers get the plastic that fits into them | [`FindingKind::Gap`], [`FindingKind::Flow`], [`FindingKind::Empty`] |
//! | no bead is thicker than the nozzle can lay | [`FindingKind::ThickBead`] |
//! | no move of filament alone is longer than firmware takes | [`FindingKind::LongFeed`] |
//! | nothing is faster than the printer | [`FindingKind::TooFast`], [`FindingKind::NoSpeed`] |
//! | z rises by layers | [`FindingKind::Jump`] |
//! | the first layer lies on the bed | [`FindingKind::OffBed`] |
//! | nothing is led or laid through what is printed, or laid twice | [`FindingKind::Low`], [`FindingKind::Dive`], [`FindingKind::Sunk`], [`FindingKind::Again`] |
//! | the head does not come near parts that are finished, where parts are printed one by one | [`FindingKind::Collision`] |
//! | every island, and every bead that rises, stands on something | [`FindingKind::InTheAir`], [`FindingKind::Adrift`] |
//! | every line makes sense, and ends where any firmware ends it | [`FindingKind::Senseless`], [`FindingKind::LongLine`], [`FindingKind::LineEnd`] |
//! | no command breaks what the check takes for granted (`words` is the table) | [`FindingKind::Harmful`], [`FindingKind::Changed`] |
//! | the printer has the tools that are taken | [`FindingKind::NoTool`] |
//! | the print is whole, and everything is off at the end | [`FindingKind::CutOff`], [`FindingKind::LeftOn`] |
//! | the file is G-code | [`FindingKind::NoGcode`] |
//! | the check tells what it does not know | [`FindingKind::Unknown`], [`FindingKind::UnknownWord`] |
//!
//! What start and end templates do is the user's own choice. Their moves are
//! those of role `Custom` and those before the first layer. Only the rules
//! about heat, reach, speed and sense hold there, and reach has a margin, since
//! printers purge beside their beds. More plastic than firmware takes by
//! default is a warning there ([`FindingKind::Purge`]).
//!
//! Filament that goes back while the head moves, or goes back too far, is a
//! fault only if something is printed after it, since end codes unload
//! filament.
//!
//! Not guaranteed: that macros of the printer's firmware do what their names
//! say. A macro that may have heated the nozzle is taken to have done so,
//! unless the temperature that it is given says otherwise.

#![warn(unreachable_pub)]

mod again;
mod alongside;
mod away;
mod bed;
mod cells;
mod columns;
mod commands;
mod ending;
mod filament;
mod finished;
mod flow;
mod gap;
mod ground;
mod heat;
mod held;
mod rise;
mod rules;
mod tools;
mod verdict;
mod words;

pub use alongside::Alongside;
pub use rules::Rules;
pub use verdict::{Finding, FindingKind, Severity, Verdict};

use again::Again;
use away::Away;
use ending::Ending;
use filament::WayBack;
use finished::Finished;
use flow::Flow;
use gap::Gaps;
use glam::{DVec2, DVec3};
use ground::{Adrift, Ground, PLOUGH, Wrong};
use heat::{Heat, Readiness};
use held::Held;
use isoslice_base::units::{Mm, human_list};
use isoslice_gcode_read::reader::{
    Event, Heater, Info, Move, ReadError, Reader, Role,
};
use rules::ROUNDING;
use std::io::Read;
use tools::Tools;

/// How far beside the bed templates may go to purge and to wipe, mm.
const BESIDE: Mm = 15.0;

/// Share of a speed by which rounding may exceed it: files have whole mm/min,
/// or few decimals.
const SPEED_ROUNDING: f64 = 1e-3;

/// A bit for each axis that has been homed, from x.
const HOMED: u8 = 0b111;

/// Number of tools that are told apart; all others count as one.
const TOOLS: u32 = 64;

/// Moves in the plane without a bead after which a file is no print, or no
/// longer one. No start, end or travel has as many.
const IDLE_MOVES: u64 = 100;

/// Checks a file.
///
/// # Errors
/// If the file cannot be read or is not text.
pub fn check(input: impl Read, rules: &Rules) -> Result<Verdict, ReadError> {
    let mut reader = Reader::new(input)
        .filament_diameter(rules.filament_diameter)
        .base(rules.base);
    let mut checker = Checker::new(rules);
    let nothing = loop {
        match reader.next() {
            Some(Ok(event)) => checker.take(event, &reader),
            Some(Err(ReadError::NoGcode(why))) => break Some(why),
            Some(Err(error)) => return Err(error),
            None => break None,
        }
    };
    match nothing {
        Some(why) => checker.no_gcode(&why.to_string()),
        None => checker.finish(&reader),
    }
    let mut verdict = checker.verdict;
    verdict.lines = reader.lines();
    verdict.generator = reader.info().generator.clone();
    Ok(verdict)
}

/// What the check knows after each line.
struct Checker<'a> {
    rules: &'a Rules,
    verdict: Verdict,
    ground: Ground,
    heat: Heat,
    homed: u8,
    ending: Ending,
    /// True if the printer begins and ends prints by itself, as Ultimaker's
    /// printers do.
    own_start: bool,
    /// Findings that count only if something is printed after them.
    held: Vec<Held>,
    /// A command that has moved the head elsewhere.
    away: Option<Away>,
    /// True from a homing or a macro on, until a move gives z again: the head may be
    /// at any height.
    z_lost: bool,
    /// Where the last move has led.
    at: DVec2,
    /// Line of a command that has homed z since the last bead, with something
    /// printed where the nozzle or the probe comes down.
    homed_over: Option<u64>,
    /// The tool in use.
    tool: u32,
    /// A bit for each tool that RepRapFirmware has been told to let cool.
    asleep: u64,
    tools: Tools,
    /// True until a tool that was just taken begins a bead.
    fresh_tool: bool,
    /// Filament of each tool that is pulled back.
    back: [Mm; TOOLS as usize],
    /// A bit for each tool whose filament the firmware has pulled back.
    firmware_back: u64,
    /// Filament pushed since the head last moved sideways, beyond what was
    /// pulled back.
    pushed: Mm,
    /// Filament that goes back while the head moves, and may be a wipe.
    way_back: Option<WayBack>,
    gaps: Gaps,
    flow: Flow,
    again: Again,
    /// Line of the first move in the plane after the last bead, and number of
    /// such moves.
    idle: (u64, u64),
    /// Filament of all beads.
    laid: Mm,
    /// Greatest height of a bead of the print so far.
    top: Mm,
    /// Parts that were printed before this one.
    finished: Finished,
    /// Height of the first bead of this layer and of the layer before, skirts
    /// and supports left out.
    begun: Option<Mm>,
    begun_before: Option<Mm>,
    layer: u32,
    /// True if beads climb in a file that does not say what they are for: it does not
    /// tell either which layer they belong to, nor what irons.
    untold: bool,
    /// Length of the beads of the first layer, up to the last one, that have air
    /// between them and the bed.
    air_below: Mm,
    /// Line of the layer's first bead.
    layer_line: Option<u64>,
    /// The layer that lies on the bed.
    lowest_layer: u32,
}

impl<'a> Checker<'a> {
    fn new(rules: &'a Rules) -> Self {
        Checker {
            rules,
            verdict: Verdict::default(),
            ground: Ground::new(rules.gap, rules.nozzle),
            heat: Heat::new(rules.least_heat),
            homed: 0,
            ending: Ending::default(),
            own_start: false,
            held: Vec::new(),
            away: None,
            z_lost: false,
            at: DVec2::ZERO,
            homed_over: None,
            tool: 0,
            asleep: 0,
            tools: Tools::default(),
            fresh_tool: false,
            back: [0.0; TOOLS as usize],
            firmware_back: 0,
            pushed: 0.0,
            way_back: None,
            gaps: Gaps::new(rules.travel),
            flow: Flow::new(rules.base, rules.nozzle),
            again: Again::default(),
            idle: (0, 0),
            laid: 0.0,
            top: rules.base,
            finished: Finished::default(),
            begun: None,
            begun_before: None,
            layer: 0,
            untold: false,
            air_below: 0.0,
            layer_line: None,
            lowest_layer: 1,
        }
    }

    fn take<R: Read>(&mut self, event: Event, reader: &Reader<R>) {
        let words = reader.words();
        match event {
            Event::Move(step) => {
                self.away(&step, words);
                return self.step(&step);
            }
            Event::Layer { number, .. } => {
                self.next_layer(reader.info().calls_overhangs);
                // What was purged before the first layer holds nothing.
                if number == 1 {
                    self.ground.clear();
                }
                self.layer = number;
                self.verdict.layers = self.verdict.layers.max(number);
                return;
            }
            Event::Problem { line, problem } => {
                return self.problem(line, problem);
            }
            _ => self.ending.other(),
        }
        match event {
            Event::Heat {
                line,
                heater,
                to,
                wait,
            } => {
                self.heat.set(heater, self.tool, to, wait);
                if let Heater::Nozzle(tool) = heater {
                    self.asleep &= !bit(tool.unwrap_or(self.tool));
                    tool.into_iter().for_each(|tool| self.tools.know(tool));
                }
                if matches!(heater, Heater::Nozzle(_)) && to <= 0.0 {
                    self.ending.off();
                }
                if heater == Heater::Bed && to <= 0.0 {
                    let named = "SET_HEATER_TEMPERATURE";
                    let word = match wait {
                        _ if reader.named().is(named) => named,
                        true => "M190",
                        false => "M140",
                    };
                    self.bed_off(line, word);
                }
                self.limit_heat(line, heater, to);
                // The command may name a standby temperature, too.
                if let (true, Some(standby)) =
                    (words.has(b'S'), words.get(b'R'))
                {
                    self.limit_heat(line, heater, standby);
                }
            }
            Event::WaitForHeat { heater, least, .. } => {
                self.heat.wait(heater, least);
            }
            Event::HeatersOff { .. } => {
                self.heat.off();
                self.ending.off();
            }
            Event::Tool { line, tool } => self.take_tool(line, tool),
            Event::Dwell { line, time } => self.dwell(line, time),
            Event::FirmwareRetract { back, .. } => {
                if back {
                    self.firmware_back |= bit(self.tool)
                } else {
                    self.firmware_back &= !bit(self.tool)
                }
            }
            Event::Home { line } => self.home(line, words),
            Event::Fan { line, .. } => self.code(line, 'M', 1060, words),
            Event::Macro { line } => self.named(line, reader),
            Event::Other {
                line,
                letter,
                tenths,
            } => self.code(line, letter, tenths, words),
            _ => {}
        }
    }

    fn step(&mut self, step: &Move) {
        self.verdict.moves += 1;
        self.at = step.to.truncate();
        self.ending.step(step);
        let template = step.layer == 0 || step.role == Role::Custom;
        self.reach(step, template);
        self.speed(step);
        self.homed(step);
        self.heat(step);
        self.filament(step, template);
        self.tools.several |= step.role == Role::PrimeTower;
        if !template {
            self.gap(step);
        }
        if step.prints() && sideways(step) {
            self.idle = (0, 0);
            self.homed_over = None;
            self.laid += if template { 0.0 } else { step.filament };
            self.bead(step, template);
        } else if step.travels() && !template {
            self.travel(step);
            self.dive(step);
        } else if step.travels() && self.ending.has_printed() && !self.z_lost {
            // A template may lead below the print's top beside the print.
            self.through(step);
            self.dive(step);
        }
        self.z_lost &= step.to.z == step.from.z;
        if !step.prints() && sideways(step) {
            self.idle.0 = if self.idle.1 == 0 {
                step.line
            } else {
                self.idle.0
            };
            self.idle.1 += 1;
        }
        self.collide(step);
    }

    /// Reports a move without filament in the middle of a bead.
    fn gap(&mut self, step: &Move) {
        let back = *self.back(step) > self.rules.missing
            || self.firmware_back & bit(step.tool) != 0;
        if let Some(gap) = self.gaps.step(step, back) {
            let kind = FindingKind::Gap;
            self.verdict.add(kind, gap.line, step.from, || {
                format!(
                    "{:.2} mm without filament in the middle of a bead, up to \
                     {}",
                    gap.length,
                    place(step.from)
                )
            });
        }
    }

    /// Takes in what a bead adds to the layer.
    fn laid(&mut self, step: &Move, area: f64) {
        self.layer_line.get_or_insert(step.line);
        if self.within(step) {
            self.flow.bead(step, area, &self.ground);
        }
        self.untold |= step.role == Role::Unknown && step.from.z != step.to.z;
        // Towers and ironing go where they went before.
        if self.untold || matches!(step.role, Role::Ironing | Role::PrimeTower)
        {
            return;
        }
        let middle = step.from.midpoint(step.to);
        let height = self.flow.height(middle, step.height, &self.ground);
        // Beads with more flow are thicker. What a formula asks for here is unknown.
        let [least, most] = self.rules.flow;
        let flow = if least == most { most.max(1.0) } else { 1.0 };
        let usual = flow * self.rules.usual_width(step.role) * height;
        if let Some(line) = self.again.bead(step, area, usual) {
            self.verdict.add(FindingKind::Again, line, step.from, || {
                format!(
                    "the same beads are laid again, at the same place and \
                     height: {}",
                    place(step.from)
                )
            });
        }
    }

    /// Reports a move that leads where the head cannot go.
    fn reach(&mut self, step: &Move, template: bool) {
        let margin = if template { BESIDE } else { ROUNDING };
        let rules = self.rules;
        if !rules.reach(step.to, margin) {
            self.verdict.add(FindingKind::OutOfReach, step.line, step.to, || {
                format!(
                    "the head goes to {}; the printer reaches from 0 to {} × \
                     {} × {} mm",
                    place(step.to),
                    rules.bed.x,
                    rules.bed.y,
                    rules.height
                )
            });
        }
    }

    fn speed(&mut self, step: &Move) {
        let rules = self.rules;
        if step.from == step.to {
            return;
        }
        if step.speed <= 0.0 {
            self.verdict
                .add(FindingKind::NoSpeed, step.line, step.to, || {
                    "a move before any speed was set".into()
                });
            return;
        }
        // The z axis does not move, and no other one is faster than the head.
        if step.from.z == step.to.z && step.speed <= rules.speed {
            return;
        }
        let way = (step.to - step.from).abs() / step.length() * step.speed;
        let over =
            |speed: f64, most: f64| speed > most * (1.0 + SPEED_ROUNDING);
        let plane = way.truncate().length();
        let kind = FindingKind::TooFast;
        if over(way.z, rules.speed_z) {
            self.verdict.add_about(kind, "z", step.line, step.to, || {
                format!(
                    "z moves at {:.1} mm/s; the printer can {}",
                    way.z, rules.speed_z
                )
            });
        } else if over(plane, rules.speed) {
            self.verdict.add(kind, step.line, step.to, || {
                format!("{plane:.1} mm/s; the printer can {}", rules.speed)
            });
        }
    }

    /// Reports a move before the head knows where it is.
    fn homed(&mut self, step: &Move) {
        if self.homed == HOMED {
            return;
        }
        // Start codes often lift the nozzle before homing, and move to the
        // place where z is homed.
        let moved = (step.to - step.from).abs();
        let axes = [moved.x, moved.y, moved.z];
        let needed = (0..3)
            .filter(|&i| step.prints() || (i < 2 && axes[i] > 0.0))
            .fold(0, |needed, i| needed | 1 << i);
        if needed & !self.homed == 0 {
            return;
        }
        let names: Vec<&str> = ["x", "y", "z"]
            .into_iter()
            .enumerate()
            .filter(|(i, _)| self.homed & 1 << i == 0)
            .map(|(_, name)| name)
            .collect();
        // The finding names all axes, so it is reported once.
        self.homed = HOMED;
        self.verdict
            .add(FindingKind::NotHomed, step.line, step.to, || {
                let was = if names.len() > 1 { "were" } else { "was" };
                format!(
                    "the head moves, and {} {was} not homed (G28), or not \
                     since the motors were turned off",
                    human_list(&names, "and")
                )
            });
    }

    fn heat(&mut self, step: &Move) {
        if step.filament <= 0.0 {
            return;
        }
        let least = self.rules.least_heat;
        let why = match self.heat.readiness(step.tool) {
            Readiness::Hot => return,
            Readiness::Unknown => {
                self.verdict.add(FindingKind::Unknown, step.line, step.to, || {
                    "no command waits for the nozzle's heat before filament \
                     is pushed; a macro of the printer's may"
                        .into()
                });
                // A tool is reported once.
                return self.heat.trust(step.tool);
            }
            Readiness::Told(to) if to > 0.0 => format!(
                "filament is pushed through a nozzle that is told {to} °C; \
                 the least is {least} (filament.min_nozzle_temperature)"
            ),
            Readiness::Told(_) => {
                "filament is pushed after the nozzle was turned off".into()
            }
            Readiness::NotAwaited => format!(
                "filament is pushed before any command has waited for the \
                 nozzle to have {least} °C or more"
            ),
            Readiness::Never => {
                "filament is pushed before any command has heated the nozzle"
                    .into()
            }
        };
        self.verdict
            .add(FindingKind::Cold, step.line, step.to, || why);
    }

    /// Reports a head that would hit a finished part.
    fn collide(&mut self, step: &Move) {
        let room = self.rules.head_room.as_ref();
        let hit = room.and_then(|room| self.finished.hit(step, room));
        if let Some(what) = hit {
            self.verdict.add(
                FindingKind::Collision,
                step.line,
                step.to,
                || what,
            );
        }
    }

    /// Reports a travel that leads through what is printed.
    fn travel(&mut self, step: &Move) {
        let (low, top) = (step.from.z.min(step.to.z), self.top);
        if !sideways(step) || low >= top - PLOUGH {
            return;
        }
        if low < top - self.rules.nozzle {
            self.verdict.add(FindingKind::Low, step.line, step.to, || {
                format!(
                    "the head moves at z = {low:.3}, below the top of what is \
                     printed, {top:.3}"
                )
            });
        } else {
            self.through(step);
        }
    }

    /// Reports a travel that leads through what is printed, cell by cell.
    fn through(&mut self, step: &Move) {
        if sideways(step)
            && self.within(step)
            && let Some(Wrong { at, top, .. }) = self.ground.travel(step)
        {
            let sinks = step.to.z < step.from.z;
            let kind = match self.ploughs(top - at.z) {
                FindingKind::Dive if sinks => FindingKind::Dive,
                _ => FindingKind::Low,
            };
            self.verdict.add(kind, step.line, at, || {
                format!(
                    "the head leads through what is printed: at {}, where \
                     that reaches up to {top:.3}",
                    place(at)
                )
            });
        }
    }

    /// True if a move stays where the head may be. Any other one has been
    /// reported, and might take any number of cells.
    fn within(&self, step: &Move) -> bool {
        [step.from, step.to]
            .into_iter()
            .all(|p| self.rules.reach(p, BESIDE))
    }

    /// Ends a layer. `calls` is true if the file tells overhangs from other
    /// walls.
    fn next_layer(&mut self, calls: bool) {
        self.begun_before = self.begun.take().or(self.begun_before);
        let verdict = &mut self.verdict;
        let layer = self.layer;
        let line = self.layer_line.take().unwrap_or(0);
        let adrift = self.ground.next_layer(calls, |at| {
            verdict.add(FindingKind::InTheAir, line, at, || {
                format!("layer {layer}: an island begins at {}", place(at))
            });
        });
        let adrift = adrift.map(|adrift| match adrift {
            Adrift::Reaches(at, reach) => {
                let to = place(at);
                (at, format!("reaches {reach:.0} mm into the air, to {to}"))
            }
            Adrift::Walls(at, length) => {
                let what = format!(
                    "has {length:.0} mm of outer wall in the air which the file \
                     does not call an overhang, at {}",
                    place(at)
                );
                (at, what)
            }
        });
        if let Some((at, what)) = adrift {
            verdict.add(FindingKind::Adrift, line, at, || {
                format!(
                    "layer {layer} {what}: what is printed from there on may \
                     be shifted, or need supports"
                )
            });
        }
        let rise = self.flow.rise(layer, self.rules.flow);
        let flow = self.flow.next_layer(self.rules.flow, self.rules.widths);
        if let Some(flow) = flow.filter(|_| !self.untold) {
            verdict.add(FindingKind::Flow, flow.line, DVec3::NAN, || {
                format!(
                    "layer {layer} has {:.2} times the plastic that its beads \
                     have room for",
                    flow.share
                )
            });
            return;
        }
        match rise {
            // A bead that is too far above all others has been reported.
            Some(rise::Wrong::Left { rise, .. })
                if rise > self.rules.nozzle + ROUNDING => {}
            Some(rise::Wrong::Left { rise, before }) => {
                verdict.add(FindingKind::Jump, line, DVec3::NAN, || {
                    format!(
                        "layer {layer} lies {rise:.2} mm above the one below it, \
                         with the plastic of {before:.2} mm: a layer may be \
                         missing below it"
                    )
                });
            }
            Some(rise::Wrong::Thick { share }) => {
                verdict.add(FindingKind::Flow, line, DVec3::NAN, || {
                    format!(
                        "layer {layer} has {share:.2} times the plastic of the \
                         same beads in the layer below"
                    )
                });
            }
            None => {}
        }
    }

    /// Reports a file whose beads take much more filament than it says.
    fn compare_filament(&mut self, info: &Info) {
        /// Share of what the file says from which on it is no rounding, and no
        /// purge that only one of both counts.
        const MUCH: f64 = 1.5;
        let (said, laid) = (info.filament_length, self.laid);
        if let Some(said) = said.filter(|said| laid > MUCH * said) {
            self.verdict.add(FindingKind::Flow, 0, DVec3::NAN, || {
                format!(
                    "the beads take {:.2} m of filament; the file says {:.2} m",
                    1e-3 * laid,
                    1e-3 * said
                )
            });
        }
    }

    /// Makes the verdict that the file is no G-code.
    fn no_gcode(&mut self, why: &str) {
        // Other findings about such a file help nobody.
        self.verdict = Verdict::default();
        self.verdict.add(FindingKind::NoGcode, 0, DVec3::NAN, || {
            format!(
                "this is no G-code: {why}; name the file that a slicer has \
                 written"
            )
        });
    }

    fn finish<R: Read>(&mut self, reader: &Reader<R>) {
        self.next_layer(reader.info().calls_overhangs);
        let tally = reader.tally();
        let commands = tally.codes + tally.names;
        if commands == 0 || tally.senseless > commands {
            let senseless = tally.senseless;
            let lines = commands + senseless;
            return self.no_gcode(&match (commands, senseless) {
                (0, 0) => "there is no command in it".to_owned(),
                _ => format!("{senseless} of {lines} lines are no commands"),
            });
        }
        self.missing_tools(reader.info().filaments);
        self.compare_filament(reader.info());
        let (line, nowhere) = (reader.lines(), DVec3::NAN);
        let (from, moves) = self.idle;
        if moves > IDLE_MOVES {
            self.verdict.add(FindingKind::Empty, from, nowhere, || {
                format!(
                    "nothing is printed from here on, in {moves} moves: there \
                     is no filament in them"
                )
            });
        }
        if let Some(line) = self.homed_over {
            let kind = FindingKind::Changed;
            self.verdict.add_about(kind, "G28", line, nowhere, || {
                "G28 homes z with the print on the bed: the nozzle or the probe \
                 meets the print, unless z is homed beside it or at its upper \
                 end; home x and y alone, as in G28 X Y"
                    .to_owned()
            });
        }
        let unfinished = reader.is_unfinished();
        if let Some(why) = self.ending.cut_off(reader.info(), unfinished) {
            self.verdict
                .add(FindingKind::CutOff, line, nowhere, || why.to_owned());
        } else if !self.ending.by_macro && !self.own_start {
            for (name, to) in self.heat.on() {
                let kind = FindingKind::LeftOn;
                self.verdict.add_about(kind, name, line, nowhere, || {
                    format!("the file ends, and the {name} stays at {to} °C")
                });
            }
        }
    }
}

/// True if the head moves in the plane. Filament that is fed while only z moves
/// primes the nozzle.
fn sideways(step: &Move) -> bool {
    step.from.truncate() != step.to.truncate()
}

/// The bit of a tool in a mask.
fn bit(tool: u32) -> u64 {
    1 << tool.min(TOOLS - 1)
}

/// A place, as people read it.
fn place(p: DVec3) -> String {
    format!("x = {:.2}, y = {:.2}, z = {:.2}", p.x, p.y, p.z)
}

#[cfg(test)]
mod tests;
