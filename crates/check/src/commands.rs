//! The rules about commands that are no moves: heat, homing, motors, macros,
//! and lines that make no sense.

use super::away::Away;
use super::words::{self, Effect};
use super::{Checker, FindingKind, HOMED, bit};
use glam::DVec3;
use isoslice_base::units::{Celsius, Mm, Seconds, human_time};
use isoslice_gcode_read::reader::{Heater, Problem, Reader, Words};
use std::io::Read;
use std::iter::once;

impl Checker<'_> {
    pub(super) fn problem(&mut self, line: u64, problem: Problem) {
        let kind = match problem {
            Problem::LongLine => FindingKind::LongLine,
            Problem::CarriageReturn => FindingKind::LineEnd,
            _ => FindingKind::Senseless,
        };
        let at = DVec3::NAN;
        self.verdict.add(kind, line, at, || problem.to_string());
    }

    /// Reports a temperature that is more than the heater bears.
    pub(super) fn limit_heat(
        &mut self,
        line: u64,
        heater: Heater,
        to: Celsius,
    ) {
        let (limit, name) = self.rules.heat(heater);
        if to > limit.most {
            self.verdict.add_about(
                FindingKind::TooHot,
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
            self.verdict.add_about(FindingKind::Hot, name, line, DVec3::NAN, || {
                format!(
                    "the {name} is told {to} °C, more than most bear; set {} \
                     to what yours does",
                    limit.setting
                )
            });
        }
    }

    /// Takes in the homing of the axes that are named, or of all.
    pub(super) fn home(&mut self, line: u64, words: &Words) {
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
        if all || words.has(b'Z') {
            self.z_lost = true;
            let why = "homes z with a print on the bed that goes on after it: \
                       the nozzle or the probe would meet the print";
            self.word(line, "G28", Some(Effect::Disturbs(why)));
            let stays = !b"XY".iter().any(named) && !all;
            self.homed_over(line, stays);
        } else {
            self.word(line, "G28", Some(Effect::Leaves(words::AWAY)));
        }
    }

    /// Takes in that z is homed after what was printed so far: at the middle of the
    /// bed, where most probes are, or where the head stands if it stays there.
    fn homed_over(&mut self, line: u64, stays: bool) {
        /// How far from the nozzle it counts that something is printed: probes are
        /// beside it.
        const BESIDE: Mm = 10.0;
        let printed = self.ending.has_printed() && !self.own_start;
        if !printed || self.homed_over.is_some() {
            return;
        }
        let middle = 0.5 * self.rules.bed;
        let mut places = once(middle).chain(stays.then_some(self.at));
        if places.any(|place| self.ground.is_printed_near(place, BESIDE)) {
            self.homed_over = Some(line);
        }
    }

    /// Takes in a command that the reader does not follow.
    pub(super) fn code(
        &mut self,
        line: u64,
        letter: char,
        tenths: u32,
        words: &Words,
    ) {
        match (letter, tenths) {
            // Bambu Lab's printers take a filament.
            ('M', 6200) => self.tools.several = true,
            // With a time (S) these commands turn the motors off later.
            ('M', 180 | 840) if !words.has(b'S') => {
                self.motors_off(line, &words::code(letter, tenths), words);
            }
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
        if let (('M', 5680), Some(state)) = ((letter, tenths), words.get(b'A'))
        {
            let tool = words.get(b'P').map_or(self.tool, |tool| tool as u32);
            // 0 is off, 1 the standby temperature, and 2 the tool's own.
            if state < 2.0 {
                self.asleep |= bit(tool);
            } else {
                self.asleep &= !bit(tool);
            }
        }
        let effect = words::of_code(letter, tenths, words);
        if effect == Some(Effect::Pauses) && (letter, tenths) == ('M', 4000) {
            // Without a U, M400 waits until all moves are made.
            self.word(line, "M400 U1", effect);
        } else if effect != Some(Effect::None) {
            self.word(line, &words::code(letter, tenths), effect);
        }
    }

    /// Reports a wait that is hardly meant.
    pub(super) fn dwell(&mut self, line: u64, time: Seconds) {
        /// Longest wait that is usual: soaking a chamber takes that long.
        const LONGEST: Seconds = 3600.0;
        if time > LONGEST {
            let kind = FindingKind::Changed;
            self.verdict.add_about(kind, "G4", line, DVec3::NAN, || {
                format!("G4 waits for {}", human_time(time))
            });
        }
    }

    /// Takes in that motors are turned off, the named ones or all. Their
    /// positions are unknown from then on.
    fn motors_off(&mut self, line: u64, word: &str, words: &Words) {
        let all = !b"XYZE".iter().any(|l| words.has(*l));
        let places = all || b"XYZ".iter().any(|l| words.has(*l));
        // Motors that are off already have lost their places, and beads after that
        // are reported.
        if self.homed == HOMED && places {
            let why = "turns motors off in the middle of the print: the head \
                       is not where it was";
            self.word(line, word, Some(Effect::Disturbs(why)));
        }
        for (i, letter) in b"XYZ".iter().enumerate() {
            if all || words.has(*letter) {
                self.homed &= !(1 << i);
            }
        }
    }

    /// Takes in that a command turns the bed off, which lets go of what is printed.
    pub(super) fn bed_off(&mut self, line: u64, word: &str) {
        let why = "turns the bed off in the middle of the print: the print may \
                   come loose from it";
        self.word(line, word, Some(Effect::Doubts(why)));
    }

    /// Takes in a command that is a name.
    pub(super) fn named<R: Read>(&mut self, line: u64, reader: &Reader<R>) {
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
        self.z_lost = true;
        for (heater, to) in super::heat::told(named) {
            self.limit_heat(line, heater, to);
        }
        let unfilled = |(_, value): (&[u8], &[u8])| {
            value.starts_with(b"[") || value.starts_with(b"{")
        };
        if named.pairs().any(unfilled) {
            self.verdict
                .add(FindingKind::Senseless, line, DVec3::NAN, || {
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
        let printed = self.ending.has_printed();
        let (kind, why) = match effect {
            Some(Effect::None) => return,
            Some(Effect::Pauses) => return self.pause(line, word),
            Some(Effect::Doubts(why)) => (FindingKind::Changed, why),
            Some(Effect::Disturbs(why)) => (FindingKind::Harmful, why),
            Some(Effect::Spoils(why)) if printed => (FindingKind::Harmful, why),
            Some(Effect::Leaves(why)) => {
                if printed {
                    self.away = Some(Away::new(word, line, why));
                }
                return;
            }
            Some(Effect::Warns(why) | Effect::Spoils(why)) => {
                return self.told(FindingKind::Changed, word, line, why);
            }
            Some(Effect::Harms(why)) => {
                return self.told(FindingKind::Harmful, word, line, why);
            }
            None => {
                let kind = FindingKind::UnknownWord;
                return self.told(kind, word, line, "is not known");
            }
        };
        // Before and after the print such commands are usual.
        if printed {
            let why = format!("{word} {why}");
            self.hold(kind, word, line, DVec3::NAN, why);
        }
    }

    /// Reports a pause, or what a pause of other firmware is here.
    fn pause(&mut self, line: u64, word: &str) {
        let pauses = &self.rules.flavour.firmware().pauses;
        let (why, ends) = words::pause(word, pauses);
        if !ends {
            self.told(FindingKind::Changed, word, line, &why);
        } else if self.ending.has_printed() {
            // Files for such firmware may end with the command.
            let why = format!("{word} {why}");
            self.hold(FindingKind::Harmful, word, line, DVec3::NAN, why);
        }
    }

    fn told(&mut self, kind: FindingKind, word: &str, line: u64, why: &str) {
        self.verdict.add_about(kind, word, line, DVec3::NAN, || {
            format!("{word} {why}")
        });
    }
}
