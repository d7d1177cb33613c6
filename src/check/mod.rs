//! Checks whether G-code is safe to run, and whether everything in it stands on
//! something.
//!
//! In: a file's bytes, and the [`Rules`] of a printer. Out: a [`Verdict`]:
//! faults, which can hurt the printer or the print, and warnings, each once
//! with its count and its first places.
//!
//! | rule | kind |
//! |---|---|
//! | the head stays where the printer can go | [`Kind::OutOfReach`] |
//! | plastic is pushed only through a nozzle that is hot enough for it | [`Kind::Cold`] |
//! | no heater is told more than it bears | [`Kind::TooHot`], [`Kind::Hot`] |
//! | the head knows where it is before it moves | [`Kind::NotHomed`] |
//! | filament goes back in retractions and wipes only, and not too far | [`Kind::Backwards`], [`Kind::LongRetraction`] |
//! | pulled-back filament is pushed forward before a bead begins | [`Kind::Unprimed`] |
//! | no bead is thicker than the nozzle can lay | [`Kind::ThickBead`] |
//! | no move of filament alone is longer than firmware takes | [`Kind::LongFeed`] |
//! | nothing is faster than the printer | [`Kind::TooFast`], [`Kind::NoSpeed`] |
//! | z rises by layers | [`Kind::Jump`], [`Kind::Low`] |
//! | the head does not come near parts that are finished, where parts are printed one by one | [`Kind::Collision`] |
//! | every island stands on something | [`Kind::InTheAir`] |
//! | every line makes sense, and ends where any firmware ends it | [`Kind::Senseless`], [`Kind::LongLine`], [`Kind::LineEnd`] |
//! | no command breaks what the check takes for granted (`words` is the table) | [`Kind::Harmful`], [`Kind::Changed`] |
//! | the print is whole, and everything is off at the end | [`Kind::CutOff`], [`Kind::LeftOn`] |
//! | the file is G-code | [`Kind::NoGcode`] |
//! | the check tells what it does not know | [`Kind::Unknown`], [`Kind::UnknownWord`] |
//!
//! What start and end templates do is the user's own choice. Their moves are
//! those of role `Custom` and those before the first layer. Only the rules
//! about heat, reach, speed and sense hold there, and reach has a margin, since
//! printers purge beside their beds. More plastic than firmware takes by
//! default is a warning there ([`Kind::Purge`]).
//!
//! Filament that goes back while the head moves, or goes back too far, is a
//! fault only if something is printed after it, since end codes unload
//! filament.
//!
//! Not guaranteed: that macros of the printer's firmware do what their names
//! say. A macro that may have heated the nozzle is taken to have done so,
//! unless the temperature that it is given says otherwise.

mod alongside;
mod ending;
mod finished;
mod ground;
mod heat;
mod verdict;
mod words;

pub(crate) use alongside::Alongside;
pub(crate) use heat::HeatLimit;
pub use verdict::{Finding, Kind, Severity, Verdict};

use crate::limits;
use crate::reader::{
    Event, Heater, Move, Problem, ReadError, Reader, Role, Words,
};
use crate::settings::Settings;
use crate::units::{Celsius, Mm, Mm2, MmPerSec};
use ending::Ending;
use finished::{Finished, HeadRoom};
use glam::{DVec2, DVec3};
use ground::Ground;
use heat::{Heat, Readiness};
use std::io::Read;
use words::Effect;

/// How far beside the bed templates may go to purge and to wipe, mm.
const BESIDE: Mm = 15.0;

/// Precision of the positions in a file, mm.
const ROUNDING: Mm = 2e-3;

/// Share of a speed by which rounding may exceed it: files have whole mm/min,
/// or few decimals.
const SPEED_ROUNDING: f64 = 1e-3;

/// Pulled-back filament that does not count, since numbers are rounded and some
/// slicers push forward a little less.
const SLACK: Mm = 0.1;

/// Greatest number of findings that wait to see whether something is printed
/// after them.
const HELD: usize = 32;

/// A bit for each axis that has been homed, from x.
const HOMED: u8 = 0b111;

/// Number of tools that are told apart; all others count as one.
const TOOLS: u32 = 64;

/// What a printer can do, and what a file must keep to.
#[derive(Clone, Debug, PartialEq)]
pub struct Rules {
    /// Far corner of the bed; the near corner is zero.
    pub bed: DVec2,
    /// Greatest height of the nozzle.
    pub height: Mm,
    /// Diameter of the nozzle.
    pub nozzle: Mm,
    /// Diameter of the filament.
    pub filament_diameter: Mm,
    /// Greatest cross-section of a bead.
    pub cross_section: Mm2,
    /// Greatest length of filament pushed or pulled while the head stands.
    pub feed: Option<Mm>,
    /// Greatest length pulled back at a time.
    pub retraction: Mm,
    /// Filament that may be missing when a bead begins.
    pub missing: Mm,
    /// Height at which the file begins to print: 0 is the bed, and more if the
    /// file continues a part.
    pub base: Mm,
    /// Greatest speed in the plane.
    pub speed: MmPerSec,
    /// Greatest speed of the z axis.
    pub speed_z: MmPerSec,
    /// Least temperature of a nozzle that filament is pushed through.
    pub least_heat: Celsius,
    /// What the head needs beside finished parts, if parts are printed one by
    /// one.
    pub(crate) head_room: Option<HeadRoom>,
    /// How hot the nozzle may be.
    pub(crate) nozzle_heat: HeatLimit,
    /// How hot the bed may be.
    pub(crate) bed_heat: HeatLimit,
    /// How hot the chamber may be.
    pub(crate) chamber_heat: HeatLimit,
}

impl Rules {
    /// The rules of the printer in the settings.
    pub fn new(settings: &Settings) -> Rules {
        let printer = &settings.printer;
        let nozzle = printer.nozzle_diameter;
        // Most firmware has no limit of the cross-section, but no nozzle lays
        // more than 8 squares of itself.
        let refuses = settings.gcode.flavour.firmware().refuses;
        let section = refuses.map_or(8.0, |r| r.section);
        Rules {
            bed: DVec2::new(printer.bed_x, printer.bed_y),
            height: printer.height,
            nozzle,
            filament_diameter: settings.filament.diameter,
            cross_section: section * nozzle * nozzle,
            feed: refuses.map(|r| r.feed),
            retraction: (2.0 * settings.retract.length).max(20.0),
            // A negative `retract.extra_prime` pushes forward less than was
            // pulled back.
            missing: SLACK + (-settings.retract.extra_prime).max(0.0),
            base: 0.0,
            speed: printer.max_speed,
            speed_z: printer.max_speed_z,
            least_heat: settings.min_nozzle_temperature(),
            head_room: HeadRoom::of(settings),
            // If the printer's own limits are not set, these hold: what usual
            // hot ends, beds and chambers bear, and what hardly any bears.
            nozzle_heat: HeatLimit::new(
                "printer.max_nozzle_temperature",
                printer.max_nozzle_temperature,
                300.0,
                settings.max_nozzle_temperature(),
            ),
            bed_heat: HeatLimit::new(
                "printer.max_bed_temperature",
                printer.max_bed_temperature,
                120.0,
                settings.max_bed_temperature(),
            ),
            chamber_heat: HeatLimit::new(
                "printer.max_chamber_temperature",
                printer.max_chamber_temperature,
                80.0,
                150.0,
            ),
        }
    }

    /// How hot a heater may be, and the heater's name.
    fn heat(&self, heater: Heater) -> (&HeatLimit, &'static str) {
        match heater {
            Heater::Nozzle(_) => (&self.nozzle_heat, "nozzle"),
            Heater::Bed => (&self.bed_heat, "bed"),
            Heater::Chamber => (&self.chamber_heat, "chamber"),
        }
    }

    /// True if the head can go to `p`, give or take `margin` in the plane.
    fn reach(&self, p: DVec3, margin: Mm) -> bool {
        let low = DVec3::new(-margin, -margin, -ROUNDING);
        let high = self.bed.extend(self.height);
        let high = high + DVec3::new(margin, margin, ROUNDING);
        !(p.cmplt(low).any() || p.cmpgt(high).any())
    }
}

/// Checks a file.
///
/// # Errors
/// If the file cannot be read or is not text.
pub fn check(input: impl Read, rules: &Rules) -> Result<Verdict, ReadError> {
    let mut reader =
        Reader::new(input).filament_diameter(rules.filament_diameter);
    let mut checker = Checker::new(rules);
    let nothing = loop {
        limits::check();
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
    held: Vec<(Kind, u64, DVec3, String)>,
    /// The tool in use.
    tool: u32,
    /// Filament of each tool that is pulled back.
    back: [Mm; TOOLS as usize],
    /// A bit for each tool whose filament the firmware has pulled back.
    firmware_back: u64,
    /// Greatest height of a bead of the print so far.
    top: Mm,
    /// Parts that were printed before this one.
    finished: Finished,
    /// Height of the first bead of this layer and of the layer before, skirts
    /// left out.
    begun: Option<Mm>,
    begun_before: Option<Mm>,
    layer: u32,
}

impl<'a> Checker<'a> {
    fn new(rules: &'a Rules) -> Self {
        Checker {
            rules,
            verdict: Verdict::default(),
            ground: Ground::default(),
            heat: Heat::new(rules.least_heat),
            homed: 0,
            ending: Ending::default(),
            own_start: false,
            held: Vec::new(),
            tool: 0,
            back: [0.0; TOOLS as usize],
            firmware_back: 0,
            top: rules.base,
            finished: Finished::default(),
            begun: None,
            begun_before: None,
            layer: 0,
        }
    }

    fn take<R: Read>(&mut self, event: Event, reader: &Reader<R>) {
        let words = reader.words();
        match event {
            Event::Move(step) => return self.step(&step),
            Event::Layer { number, .. } => {
                self.next_layer();
                // What was purged before the first layer holds nothing.
                if number == 1 {
                    self.ground = Ground::default();
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
                if matches!(heater, Heater::Nozzle(_)) && to <= 0.0 {
                    self.ending.off();
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
            Event::Tool { tool, .. } => self.tool = tool,
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

    fn problem(&mut self, line: u64, problem: Problem) {
        let kind = match problem {
            Problem::LongLine => Kind::LongLine,
            Problem::CarriageReturn => Kind::LineEnd,
            _ => Kind::Senseless,
        };
        let at = DVec3::NAN;
        self.verdict.add(kind, line, at, || problem.to_string());
    }

    /// Reports a temperature that is more than the heater bears.
    fn limit_heat(&mut self, line: u64, heater: Heater, to: Celsius) {
        let (limit, name) = self.rules.heat(heater);
        if to > limit.most {
            self.verdict.add_about(
                Kind::TooHot,
                name,
                line,
                DVec3::NAN,
                || {
                    format!(
                        "the {name} is told {to} °C; {} is {}",
                        limit.setting, limit.most
                    )
                },
            );
        } else if to > limit.usual {
            self.verdict.add_about(Kind::Hot, name, line, DVec3::NAN, || {
                format!(
                    "the {name} is told {to} °C, more than most bear; set {} \
                     to what yours does",
                    limit.setting
                )
            });
        }
    }

    /// Takes in the homing of the axes that are named, or of all.
    fn home(&mut self, line: u64, words: &Words) {
        let named = |l: &u8| words.has(*l);
        let all = !b"XYZ".iter().any(named);
        // No firmware homes z before it knows x and y.
        if named(&b'Z') {
            self.homed = HOMED;
        }
        for (i, letter) in b"XYZ".iter().enumerate() {
            if all || named(letter) {
                self.homed |= 1 << i;
            }
        }
        if (all || words.has(b'Z')) && self.ending.has_printed() {
            let kind = Kind::Changed;
            self.verdict.add_about(kind, "G28", line, DVec3::NAN, || {
                "G28 homes z with a print on the bed, which the nozzle or \
                     the probe may meet"
                    .into()
            });
        }
    }

    /// Takes in a command that the reader does not follow.
    fn code(&mut self, line: u64, letter: char, tenths: u32, words: &Words) {
        match (letter, tenths) {
            // With a time (S) these commands turn the motors off later.
            ('M', 180 | 840) if !words.has(b'S') => self.motors_off(words),
            // RepRapFirmware's macro for G32 homes.
            ('G', 320) => self.homed = HOMED,
            // This sets a tool's standby temperature only.
            ('G', 100) | ('M', 5680) => {
                if let Some(standby) = words.get(b'R') {
                    self.limit_heat(line, Heater::Nozzle(None), standby);
                }
            }
            _ => {}
        }
        let effect = words::of_code(letter, tenths, words);
        if effect != Some(Effect::None) {
            self.word(line, &words::code(letter, tenths), effect);
        }
    }

    /// Takes in that motors are turned off, the named ones or all. Their
    /// positions are unknown from then on.
    fn motors_off(&mut self, words: &Words) {
        let all = !b"XYZE".iter().any(|l| words.has(*l));
        for (i, letter) in b"XYZ".iter().enumerate() {
            if all || words.has(*letter) {
                self.homed &= !(1 << i);
            }
        }
    }

    /// Takes in a command that is a name.
    fn named<R: Read>(&mut self, line: u64, reader: &Reader<R>) {
        /// Length of the longest name that is shown whole.
        const LONGEST: usize = 40;
        let named = reader.named();
        if named.name().is_empty() {
            self.own_start = true;
        } else if named.is("SET_HEATER_TEMPERATURE") {
            // The reader has made sense of all but the heater.
            let heater = named.get("HEATER").unwrap_or_default();
            let heater = &heater[..heater.len().min(LONGEST)];
            let heater = String::from_utf8_lossy(heater);
            let word = format!("SET_HEATER_TEMPERATURE HEATER={heater}");
            return self.word(line, &word, None);
        } else if let Some(effect) = words::of_name(named) {
            if effect != Effect::None {
                let name = String::from_utf8_lossy(named.name());
                self.word(line, &name.to_uppercase(), Some(effect));
            }
            return;
        }
        // A macro may heat, home and purge.
        self.heat.macro_called(named);
        self.ending.macro_called();
        self.homed = HOMED;
        for (heater, to) in heat::told(named) {
            self.limit_heat(line, heater, to);
        }
        let unfilled = |(_, value): (&[u8], &[u8])| {
            value.starts_with(b"[") || value.starts_with(b"{")
        };
        if named.pairs().any(unfilled) {
            self.verdict.add(Kind::Senseless, line, DVec3::NAN, || {
                "a placeholder that nobody has filled in".into()
            });
        }
        if !named.name().is_empty() {
            // A name consists of letters, digits and _, so it can be shown.
            let name = named.name();
            let name = &name[..name.len().min(LONGEST)];
            self.word(line, &String::from_utf8_lossy(name), None);
        }
    }

    /// Reports what a command does. Without an effect, the command is unknown.
    fn word(&mut self, line: u64, word: &str, effect: Option<Effect>) {
        let (kind, why) = match effect {
            Some(Effect::None) => return,
            Some(Effect::Warns(why)) => (Kind::Changed, why),
            Some(Effect::Harms(why)) => (Kind::Harmful, why),
            None => (Kind::UnknownWord, "is not known"),
        };
        self.verdict.add_about(kind, word, line, DVec3::NAN, || {
            format!("{word} {why}")
        });
    }

    fn step(&mut self, step: &Move) {
        self.verdict.moves += 1;
        self.ending.step(step);
        let template = step.layer == 0 || step.role == Role::Custom;
        self.reach(step, template);
        self.speed(step);
        self.homed(step);
        self.heat(step);
        self.filament(step, template);
        if step.prints() && sideways(step) {
            self.bead(step, template);
        } else if step.travels() && !template {
            self.travel(step);
        }
        self.collide(step);
    }

    /// Reports a move that leads where the head cannot go.
    fn reach(&mut self, step: &Move, template: bool) {
        let margin = if template { BESIDE } else { ROUNDING };
        let rules = self.rules;
        if !rules.reach(step.to, margin) {
            self.verdict.add(Kind::OutOfReach, step.line, step.to, || {
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
        let length = step.length();
        if length == 0.0 {
            return;
        }
        if step.speed <= 0.0 {
            self.verdict.add(Kind::NoSpeed, step.line, step.to, || {
                "a move before any speed was set".into()
            });
            return;
        }
        let way = (step.to - step.from).abs() / length * step.speed;
        let over =
            |speed: f64, most: f64| speed > most * (1.0 + SPEED_ROUNDING);
        let plane = way.truncate().length();
        let kind = Kind::TooFast;
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
        self.verdict.add(Kind::NotHomed, step.line, step.to, || {
            let (names, was) = match names.split_last() {
                Some((last, [])) => ((*last).to_owned(), "was"),
                Some((last, others)) => {
                    (format!("{} and {last}", others.join(", ")), "were")
                }
                None => (String::new(), "was"),
            };
            format!(
                "the head moves, and {names} {was} not homed (G28), or not \
                 since the motors were turned off"
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
                self.verdict.add(Kind::Unknown, step.line, step.to, || {
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
        self.verdict.add(Kind::Cold, step.line, step.to, || why);
    }

    fn filament(&mut self, step: &Move, template: bool) {
        let fed = step.filament;
        let rules = self.rules;
        if !step.travels()
            && let Some(most) = rules.feed
            && fed.abs() > most
        {
            let kind = if template {
                Kind::Purge
            } else {
                Kind::LongFeed
            };
            self.verdict.add(kind, step.line, step.to, || {
                format!(
                    "{fed:.1} mm of filament in one move; Klipper refuses \
                     more than {most} mm unless its max_extrude_only_distance \
                     says otherwise"
                )
            });
        }
        if fed < 0.0 {
            *self.back(step) -= fed;
            // A move up or down is no wipe.
            if sideways(step) && !step.wipe && !template {
                let why = format!(
                    "{:.3} mm of filament go back while the head moves and \
                     does not wipe",
                    -fed
                );
                self.hold(Kind::Backwards, step, why);
            }
            let back = *self.back(step);
            if back > rules.retraction && !template {
                let why =
                    format!("{back:.1} mm of filament are pulled back in all");
                self.hold(Kind::LongRetraction, step, why);
            }
        } else if fed > 0.0 {
            if step.prints() && sideways(step) && !template {
                self.begin(step);
            }
            let back = self.back(step);
            *back = (*back - fed).max(0.0);
        }
    }

    /// Keeps a finding that counts only if something is printed after it.
    fn hold(&mut self, kind: Kind, step: &Move, why: String) {
        if self.held.len() == HELD {
            self.let_go();
        }
        self.held.push((kind, step.line, step.to, why));
    }

    /// Makes the findings that were held count, as something is printed.
    fn let_go(&mut self) {
        for (kind, line, at, why) in self.held.drain(..) {
            self.verdict.add(kind, line, at, || why);
        }
    }

    /// Reports a bead that begins without its filament.
    fn begin(&mut self, step: &Move) {
        if !self.held.is_empty() {
            self.let_go();
        }
        let missing = *self.back(step);
        let short = missing > self.rules.missing;
        if short || self.firmware_back & bit(step.tool) != 0 {
            let kind = Kind::Unprimed;
            self.verdict.add(kind, step.line, step.from, || {
                if short {
                    format!(
                        "a bead begins with {missing:.2} mm of filament still \
                     pulled back"
                    )
                } else {
                    "a bead begins after G10, before G11".into()
                }
            });
        }
        // The missing filament counts for this bead only.
        *self.back(step) = 0.0;
    }

    /// The pulled-back filament of the tool that moves.
    fn back(&mut self, step: &Move) -> &mut Mm {
        &mut self.back[step.tool.min(TOOLS - 1) as usize]
    }

    fn bead(&mut self, step: &Move, template: bool) {
        let rules = self.rules;
        let area = step.area(rules.filament_diameter);
        if area > rules.cross_section {
            let kind = if template {
                Kind::Purge
            } else {
                Kind::ThickBead
            };
            self.verdict.add(kind, step.line, step.to, || {
                format!(
                    "{area:.2} mm² of plastic for each mm; {:.2} mm² are the \
                     most that a nozzle of {} mm can lay",
                    rules.cross_section, rules.nozzle
                )
            });
        }
        if template {
            return;
        }
        let z = step.from.z.max(step.to.z);
        if rules.head_room.is_some() {
            if self.begins_lower(step.role, z) || z < self.top - rules.nozzle {
                // The next part begins.
                self.finished.next_part();
                self.ground = Ground::default();
                self.top = rules.base;
            }
            self.finished.bead(step);
        }
        // A layer is no higher than the nozzle is wide, including the air above
        // a raft. The first layer may lie on a thick sheet.
        let most = self.top + rules.nozzle + ROUNDING;
        if z > most {
            let top = self.top;
            self.verdict.add(Kind::Jump, step.line, step.to, || {
                format!(
                    "a bead at z = {z:.3}; the highest one below it is at \
                     {top:.3}, and nothing is printed between: what holds it \
                     may be thinner than a line there; scale the model up \
                     (--scale), or make that part of it thicker"
                )
            });
        }
        self.top = self.top.max(z);
        // Skirts stand alone, and ironing lays nothing. A bead out of reach has
        // been reported, and might take any number of cells.
        let within =
            rules.reach(step.from, BESIDE) && rules.reach(step.to, BESIDE);
        if within && !matches!(step.role, Role::SkirtBrim | Role::Ironing) {
            self.ground.bead(step);
        }
    }

    /// True if a bead is the first of its layer, skirts left out, and begins no
    /// higher than the layer before: layers of one part only go up.
    fn begins_lower(&mut self, role: Role, z: Mm) -> bool {
        if role == Role::SkirtBrim || self.begun.is_some() {
            return false;
        }
        self.begun = Some(z);
        self.begun_before
            .is_some_and(|before| z < before + ROUNDING)
    }

    /// Reports a head that would hit a finished part.
    fn collide(&mut self, step: &Move) {
        let room = self.rules.head_room.as_ref();
        let hit = room.and_then(|room| self.finished.hit(step, room));
        if let Some(what) = hit {
            self.verdict
                .add(Kind::Collision, step.line, step.to, || what);
        }
    }

    /// Reports a travel that leads through what is printed.
    fn travel(&mut self, step: &Move) {
        let low = step.from.z.min(step.to.z);
        if sideways(step) && low < self.top - self.rules.nozzle {
            let top = self.top;
            self.verdict.add(Kind::Low, step.line, step.to, || {
                format!(
                    "the head moves at z = {low:.3}, below the top of what is \
                     printed, {top:.3}"
                )
            });
        }
    }

    fn next_layer(&mut self) {
        self.begun_before = self.begun.take().or(self.begun_before);
        let verdict = &mut self.verdict;
        let layer = self.layer;
        self.ground.next_layer(|line_at| {
            verdict.add(Kind::InTheAir, 0, line_at, || {
                format!("layer {layer}: an island begins at {}", place(line_at))
            });
        });
    }

    /// Makes the verdict that the file is no G-code.
    fn no_gcode(&mut self, why: &str) {
        // Other findings about such a file help nobody.
        self.verdict = Verdict::default();
        self.verdict.add(Kind::NoGcode, 0, DVec3::NAN, || {
            format!(
                "this is no G-code: {why}; name the file that a slicer has \
                 written"
            )
        });
    }

    fn finish<R: Read>(&mut self, reader: &Reader<R>) {
        self.next_layer();
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
        let (line, nowhere) = (reader.lines(), DVec3::NAN);
        let unfinished = reader.is_unfinished();
        if let Some(why) = self.ending.cut_off(reader.info(), unfinished) {
            self.verdict
                .add(Kind::CutOff, line, nowhere, || why.to_owned());
        } else if !self.ending.by_macro && !self.own_start {
            for (name, to) in self.heat.on() {
                let kind = Kind::LeftOn;
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
