//! Is G-code safe to run, and does everything in it stand on something?
//!
//! In: a file's bytes, and the [`Rules`] of a printer. Out: a [`Verdict`]:
//! faults, which can hurt the printer or the print, and warnings, each kind
//! with its first places.
//!
//! | rule | kind |
//! |---|---|
//! | the head stays where the printer can go | [`Kind::OutOfReach`] |
//! | plastic is pushed only through a nozzle that is hot | [`Kind::Cold`] |
//! | filament goes back in retractions and wipes only, and not too far | [`Kind::Backwards`], [`Kind::LongRetraction`] |
//! | and is there again when a bead begins | [`Kind::Unprimed`] |
//! | no bead is thicker than the nozzle can lay | [`Kind::ThickBead`] |
//! | no move of filament alone is longer than firmware takes | [`Kind::LongFeed`] |
//! | nothing is faster than the printer | [`Kind::TooFast`], [`Kind::NoSpeed`] |
//! | z rises by layers | [`Kind::Jump`], [`Kind::Low`] |
//! | every island stands on something | [`Kind::InTheAir`] |
//! | every line makes sense | [`Kind::Senseless`] |
//!
//! What start and end templates do (role `Custom`, and what is before the
//! first layer) is the user's own: of the rules above only heat, reach,
//! speed and sense hold there, and reach with a margin, since printers purge
//! beside their beds. More plastic than firmware takes by default is a
//! warning there ([`Kind::Purge`]).
//!
//! Not guaranteed: that macros of the printer's firmware do what their names
//! say. Where one could have heated the nozzle, it is taken to have done so.

mod alongside;
mod ground;
mod verdict;

pub use alongside::Alongside;
pub use verdict::{Finding, Kind, Severity, Verdict};

use crate::limits;
use crate::reader::{Event, Heater, Move, Problem, ReadError, Reader, Role};
use crate::settings::{Flavour, Settings};
use crate::units::{Mm, Mm2, MmPerSec};
use glam::{DVec2, DVec3};
use ground::Ground;
use std::io::Read;

/// How far beside the bed templates may go, mm: to purge and to wipe.
const BESIDE: Mm = 15.0;

/// What numbers are rounded to in a file, mm.
const ROUNDING: Mm = 2e-3;

/// Speeds are written in whole mm/min or in some decimals: share by which one
/// may be exceeded.
const SPEED_ROUNDING: f64 = 1e-3;

/// Pulled-back filament that does not count: numbers are rounded, and some
/// slicers push forward a little less.
const SLACK: Mm = 0.1;

/// Tools that are told apart; those beyond count as one.
const TOOLS: u32 = 64;

/// What a printer can do, and what is asked of a file.
#[derive(Clone, Debug, PartialEq)]
pub struct Rules {
    /// Far corner of the bed; the near one is zero.
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
    /// Height of what the print stands on: 0 is the bed; more, if the file
    /// goes on with a part.
    pub base: Mm,
    /// Greatest speed in the plane.
    pub speed: MmPerSec,
    /// Greatest speed of the z axis.
    pub speed_z: MmPerSec,
}

impl Rules {
    /// The rules of the printer in the settings.
    pub fn new(settings: &Settings) -> Rules {
        let printer = &settings.printer;
        let nozzle = printer.nozzle_diameter;
        // Klipper's defaults for `max_extrude_cross_section` and
        // `max_extrude_only_distance` (docs/Config_Reference.md); beyond the
        // first, other firmware has no limit, but no nozzle can do it, either.
        let klipper = settings.gcode.flavour == Flavour::Klipper;
        Rules {
            bed: DVec2::new(printer.bed_x, printer.bed_y),
            height: printer.height,
            nozzle,
            filament_diameter: settings.filament.diameter,
            cross_section: match klipper {
                true => 4.0 * nozzle * nozzle,
                false => 8.0 * nozzle * nozzle,
            },
            feed: klipper.then_some(50.0),
            retraction: (2.0 * settings.retract.length).max(20.0),
            // Less than was pulled back may be wanted.
            missing: SLACK + (-settings.retract.extra_prime).max(0.0),
            base: 0.0,
            speed: printer.max_speed,
            speed_z: printer.max_speed_z,
        }
    }

    /// Whether the head can go there, or `margin` beside it in the plane.
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
/// If it cannot be read, or is no text.
pub fn check(input: impl Read, rules: &Rules) -> Result<Verdict, ReadError> {
    let mut reader =
        Reader::new(input).filament_diameter(rules.filament_diameter);
    let mut state = State::new(rules);
    for event in &mut reader {
        limits::check();
        state.take(event?);
    }
    state.finish();
    let mut verdict = state.verdict;
    verdict.lines = reader.lines();
    verdict.generator = reader.info().generator.clone();
    Ok(verdict)
}

/// What is known at a line.
struct State<'a> {
    rules: &'a Rules,
    verdict: Verdict,
    ground: Ground,
    /// A bit for each tool whose nozzle is being heated, and each whose
    /// nozzle is hot.
    heated: u64,
    hot: u64,
    /// A macro may have heated it.
    macros: bool,
    /// The tool in use.
    tool: u32,
    /// Filament of each tool that is pulled back.
    back: [Mm; TOOLS as usize],
    /// A bit for each tool that the firmware has pulled it back of.
    firmware_back: u64,
    /// Greatest height of a bead of the print so far.
    top: Mm,
    layer: u32,
}

impl<'a> State<'a> {
    fn new(rules: &'a Rules) -> Self {
        State {
            rules,
            verdict: Verdict::default(),
            ground: Ground::default(),
            heated: 0,
            hot: 0,
            macros: false,
            tool: 0,
            back: [0.0; TOOLS as usize],
            firmware_back: 0,
            top: rules.base,
            layer: 0,
        }
    }

    fn take(&mut self, event: Event) {
        match event {
            Event::Move(step) => self.step(&step),
            Event::Layer { number, .. } => {
                self.next_layer();
                self.layer = number;
                self.verdict.layers = self.verdict.layers.max(number);
            }
            Event::Heat {
                heater: Heater::Nozzle(tool),
                to,
                wait,
                ..
            } => {
                let bit = bit(tool.unwrap_or(self.tool));
                if to <= 0.0 {
                    self.heated &= !bit;
                    self.hot &= !bit;
                } else {
                    self.heated |= bit;
                    self.hot |= if wait { bit } else { 0 };
                }
            }
            Event::WaitForHeat { .. } => self.hot |= self.heated,
            Event::Tool { tool, .. } => self.tool = tool,
            Event::FirmwareRetract { back, .. } => match back {
                true => self.firmware_back |= bit(self.tool),
                false => self.firmware_back &= !bit(self.tool),
            },
            // It may heat, home and purge.
            Event::Macro { .. } => self.macros = true,
            Event::Problem { line, problem } => {
                let kind = match problem {
                    Problem::LongLine => Kind::LongLine,
                    _ => Kind::Senseless,
                };
                let at = DVec3::NAN;
                self.verdict.add(kind, line, at, || problem.to_string());
            }
            _ => {}
        }
    }

    fn step(&mut self, step: &Move) {
        self.verdict.moves += 1;
        let template = step.layer == 0 || step.role == Role::Custom;
        self.reach(step, template);
        self.speed(step);
        self.heat(step);
        self.filament(step, template);
        if step.prints() {
            self.bead(step, template);
        } else if step.travels() && !template {
            self.travel(step);
        }
    }

    /// Is the place one the head can go to?
    fn reach(&mut self, step: &Move, template: bool) {
        let margin = match template {
            true => BESIDE,
            false => ROUNDING,
        };
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
        if over(way.z, rules.speed_z) {
            self.verdict.add(Kind::TooFast, step.line, step.to, || {
                format!(
                    "z moves at {:.1} mm/s; the printer can {}",
                    way.z, rules.speed_z
                )
            });
        } else if over(plane, rules.speed) {
            self.verdict.add(Kind::TooFast, step.line, step.to, || {
                format!("{plane:.1} mm/s; the printer can {}", rules.speed)
            });
        }
    }

    fn heat(&mut self, step: &Move) {
        if step.filament > 0.0 && self.hot & bit(step.tool) == 0 {
            if self.macros {
                self.verdict.add(Kind::Unknown, step.line, step.to, || {
                    "no command waits for the nozzle's heat before filament \
                     is pushed; a macro of the printer's may"
                        .into()
                });
                // Said once.
                self.hot = u64::MAX;
                return;
            }
            self.verdict.add(Kind::Cold, step.line, step.to, || {
                "filament is pushed before any command has waited for the \
                 nozzle's heat, or after it was turned off"
                    .into()
            });
        }
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
            if step.travels() && !step.wipe && !template {
                self.verdict.add(Kind::Backwards, step.line, step.to, || {
                    format!(
                        "{:.3} mm of filament go back while the head moves \
                         and does not wipe",
                        -fed
                    )
                });
            }
            let back = *self.back(step);
            if back > rules.retraction && !template {
                let kind = Kind::LongRetraction;
                self.verdict.add(kind, step.line, step.to, || {
                    format!("{back:.1} mm of filament are pulled back in all")
                });
            }
        } else if fed > 0.0 {
            if step.prints() && !template {
                self.begin(step);
            }
            let back = self.back(step);
            *back = (*back - fed).max(0.0);
        }
    }

    /// Has the nozzle what a bead needs to begin?
    fn begin(&mut self, step: &Move) {
        let missing = *self.back(step);
        let short = missing > self.rules.missing;
        if short || self.firmware_back & bit(step.tool) != 0 {
            let kind = Kind::Unprimed;
            self.verdict
                .add(kind, step.line, step.from, || match short {
                    true => format!(
                        "a bead begins with {missing:.2} mm of filament still \
                     pulled back"
                    ),
                    false => "a bead begins after G10, before G11".into(),
                });
        }
        // Whatever was missing is missing from this bead and no other.
        *self.back(step) = 0.0;
    }

    /// Filament pulled back of the tool that moves.
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
        // A layer is no higher than the nozzle is wide; the first may be on a
        // thick sheet or a raft's gap.
        let most = self.top + rules.nozzle + ROUNDING;
        if z > most {
            let top = self.top;
            self.verdict.add(Kind::Jump, step.line, step.to, || {
                format!(
                    "a bead at z = {z:.3}; the highest one below it is at \
                     {top:.3}"
                )
            });
        }
        self.top = self.top.max(z);
        // Skirts stand alone, and ironing lays nothing. What is out of reach
        // has been said to be, and there is no end to it.
        let within =
            rules.reach(step.from, BESIDE) && rules.reach(step.to, BESIDE);
        if within && !matches!(step.role, Role::SkirtBrim | Role::Ironing) {
            self.ground
                .bead(step.from.truncate(), step.to.truncate(), z);
        }
    }

    /// Does the nozzle stay above what is printed?
    fn travel(&mut self, step: &Move) {
        let low = step.from.z.min(step.to.z);
        let sideways = step.from.truncate() != step.to.truncate();
        if sideways && low < self.top - self.rules.nozzle {
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
        let verdict = &mut self.verdict;
        let layer = self.layer;
        self.ground.next_layer(|line_at| {
            verdict.add(Kind::InTheAir, 0, line_at, || {
                format!("layer {layer}: an island begins at {}", place(line_at))
            });
        });
    }

    fn finish(&mut self) {
        self.next_layer();
    }
}

/// The bit of a tool.
fn bit(tool: u32) -> u64 {
    1 << tool.min(TOOLS - 1)
}

/// A place for people.
fn place(p: DVec3) -> String {
    format!("x = {:.2}, y = {:.2}, z = {:.2}", p.x, p.y, p.z)
}

#[cfg(test)]
mod tests;
