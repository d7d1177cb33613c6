//! How hot heaters are, and how hot they may be.
//!
//! In: what commands ask of heaters. Out: whether a nozzle can push filament,
//! and whether a temperature is more than the printer bears.
//!
//! A nozzle is as hot as the last command says that waited for it, or colder if
//! it was told to cool down since. After a macro of the printer its temperature
//! is unknown.

use super::TOOLS;
use isoslice_base::units::Celsius;
use isoslice_gcode_read::reader::{Heater, Named, number};

/// Least temperature among the parameters of macros. A lower number is
/// something else: a tool, a layer, yes or no.
const WARM: Celsius = 20.0;

/// How hot a heater may be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct HeatLimit {
    /// A higher temperature is a warning.
    pub usual: Celsius,
    /// A higher temperature is a fault.
    pub most: Celsius,
    /// The setting that gives the limit; it may be unset.
    pub setting: &'static str,
}

impl HeatLimit {
    /// The limit from the setting. Without a setting there are two limits: a
    /// usual temperature, and one that hardly any printer bears.
    pub(super) fn new(
        setting: &'static str,
        said: Option<Celsius>,
        usual: Celsius,
        most: Celsius,
    ) -> Self {
        HeatLimit {
            usual: said.unwrap_or(usual),
            most: said.unwrap_or(most),
            setting,
        }
    }
}

/// Whether a nozzle can push filament, or why not.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Readiness {
    Hot,
    /// Only the printer's macros know whether the nozzle is hot.
    Unknown,
    /// No command has heated the nozzle.
    Never,
    /// The nozzle has been told this temperature, which is too low.
    Told(Celsius),
    /// The nozzle is being heated, and no command has waited.
    NotAwaited,
}

/// What is known of a nozzle.
#[derive(Clone, Copy, Debug, Default)]
struct Nozzle {
    /// The temperature that it was told last.
    target: Option<Celsius>,
    /// The least temperature that it must have reached.
    reached: Celsius,
    /// True if a macro may have heated it.
    unknown: bool,
}

/// Index of the nozzle that all tools share, after those of the tools.
const SHARED: usize = TOOLS as usize;

/// What is known of the heaters.
#[derive(Debug)]
pub(super) struct Heat {
    /// Least temperature for pushing filament.
    least: Celsius,
    /// The nozzle of each tool, and the nozzle that they may share. Until a
    /// command names a tool it is not known which of them exist.
    nozzles: [Nozzle; SHARED + 1],
    /// True if a command has named a tool other than the first. Then each tool
    /// has its own nozzle. Otherwise all share one, as on printers that change
    /// the filament before the nozzle.
    apart: bool,
    /// The temperature for the nozzle that was given to a macro.
    macro_told: Option<Celsius>,
    pub bed: Celsius,
    pub chamber: Celsius,
}

impl Heat {
    pub(super) fn new(least: Celsius) -> Self {
        Heat {
            least,
            nozzles: [Nozzle::default(); SHARED + 1],
            apart: false,
            macro_told: None,
            bed: 0.0,
            chamber: 0.0,
        }
    }

    /// Takes in that a heater is told a temperature. `tool` is the tool in use.
    pub(super) fn set(
        &mut self,
        heater: Heater,
        tool: u32,
        to: Celsius,
        wait: bool,
    ) {
        let of = match heater {
            Heater::Bed => return self.bed = to,
            Heater::Chamber => return self.chamber = to,
            Heater::Nozzle(of) => {
                self.apart |= of.is_some_and(|of| of > 0);
                of.unwrap_or(tool)
            }
        };
        let least = self.least;
        for i in [place(of), SHARED] {
            let nozzle = &mut self.nozzles[i];
            nozzle.target = Some(to);
            if wait {
                nozzle.reached = to;
                nozzle.unknown = false;
            } else if to < least {
                nozzle.reached = nozzle.reached.min(to);
                nozzle.unknown = false;
            }
        }
    }

    /// The nozzle of a tool.
    fn nozzle(&self, tool: u32) -> &Nozzle {
        if self.apart {
            &self.nozzles[place(tool)]
        } else {
            &self.nozzles[SHARED]
        }
    }

    /// Takes in that all heaters are turned off.
    pub(super) fn off(&mut self) {
        let cold = Nozzle {
            target: Some(0.0),
            ..Nozzle::default()
        };
        *self = Heat {
            nozzles: [cold; SHARED + 1],
            apart: self.apart,
            ..Heat::new(self.least)
        };
    }

    /// Takes in that the printer waits for a heater, or for all.
    pub(super) fn wait(
        &mut self,
        heater: Option<Heater>,
        least: Option<Celsius>,
    ) {
        let one = match heater {
            None => None,
            Some(Heater::Nozzle(tool)) => Some(place(tool.unwrap_or(0))),
            Some(_) => return,
        };
        for (i, nozzle) in self.nozzles.iter_mut().enumerate() {
            if one.is_some_and(|one| i != one && i != SHARED) {
                continue;
            }
            let awaited = least.or(nozzle.target).unwrap_or(0.0);
            if awaited >= self.least {
                nozzle.reached = awaited;
                nozzle.unknown = false;
            }
        }
    }

    /// Takes in the call of a macro, which may heat.
    pub(super) fn macro_called(&mut self, named: &Named) {
        for nozzle in &mut self.nozzles {
            nozzle.unknown = true;
            nozzle.target = nozzle.target.filter(|to| *to >= self.least);
        }
        for (heater, to) in told(named) {
            if to > WARM && matches!(heater, Heater::Nozzle(_)) {
                self.macro_told = Some(to);
            }
        }
    }

    /// Whether a tool can push filament.
    pub(super) fn readiness(&self, tool: u32) -> Readiness {
        let nozzle = self.nozzle(tool);
        match nozzle.target {
            Some(to) if to < self.least => Readiness::Told(to),
            _ if nozzle.reached >= self.least => Readiness::Hot,
            _ if nozzle.unknown => match self.macro_told {
                Some(to) if to < self.least => Readiness::Told(to),
                _ => Readiness::Unknown,
            },
            Some(_) => Readiness::NotAwaited,
            None => Readiness::Never,
        }
    }

    /// Takes a tool for hot until it is told a temperature.
    pub(super) fn trust(&mut self, tool: u32) {
        for i in [place(tool), SHARED] {
            self.nozzles[i].reached = f64::INFINITY;
        }
    }

    /// The heaters that are on, with the temperatures that they were told.
    pub(super) fn on(&self) -> impl Iterator<Item = (&'static str, Celsius)> {
        let there = if self.apart {
            &self.nozzles[..SHARED]
        } else {
            &self.nozzles[SHARED..]
        };
        let targets = there.iter().filter_map(|nozzle| nozzle.target);
        let hottest = targets.fold(0.0, f64::max);
        [
            ("nozzle", hottest),
            ("bed", self.bed),
            ("chamber", self.chamber),
        ]
        .into_iter()
        .filter(|(_, to)| *to > 0.0)
    }
}

/// A tool's index among the nozzles.
fn place(tool: u32) -> usize {
    tool.min(TOOLS - 1) as usize
}

/// The temperatures that a macro is told, by the names of its parameters:
/// BED=60, EXTRUDER_TEMP=210, T_BED=60, CHAMBER=40.
pub(super) fn told(named: &Named) -> impl Iterator<Item = (Heater, Celsius)> {
    named
        .pairs()
        .filter_map(|(key, value)| Some((heater_of(key)?, number(value)?)))
}

/// The heater whose temperature a macro's parameter sets. The parameter's name
/// consists of words about heat alone.
fn heater_of(key: &[u8]) -> Option<Heater> {
    const WORDS: [&str; 16] = [
        "TEMPERATURE",
        "TEMP",
        "EXTRUDER",
        "HOTEND",
        "NOZZLE",
        "CHAMBER",
        "BED",
        "TOOL",
        "FIRST",
        "INITIAL",
        "LAYER",
        "START",
        "TARGET",
        "PRINT",
        "T",
        "_",
    ];
    let mut rest = key.trim_ascii_end();
    let mut seen = [false; WORDS.len()];
    while !rest.is_empty() {
        let digit = rest[0].is_ascii_digit();
        let word = WORDS.iter().position(|word| {
            rest.get(..word.len())
                .is_some_and(|r| r.eq_ignore_ascii_case(word.as_bytes()))
        });
        match word {
            Some(i) => {
                seen[i] = true;
                rest = &rest[WORDS[i].len()..];
            }
            None if digit => rest = &rest[1..],
            None => return None,
        }
    }
    let has = |word| WORDS.iter().zip(seen).any(|(w, s)| s && *w == word);
    let heat = has("TEMP") || has("TEMPERATURE");
    let nozzle = ["EXTRUDER", "HOTEND", "NOZZLE"].into_iter().any(has);
    if has("CHAMBER") {
        Some(Heater::Chamber)
    } else if has("BED") {
        Some(Heater::Bed)
    } else if nozzle || heat {
        Some(Heater::Nozzle(None))
    } else {
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parameters_of_macros_are_known_by_their_words() {
        let nozzle = Some(Heater::Nozzle(None));
        for (key, heater) in [
            ("BED", Some(Heater::Bed)),
            ("bed_temp", Some(Heater::Bed)),
            ("T_BED", Some(Heater::Bed)),
            ("BEDTEMP", Some(Heater::Bed)),
            ("FIRST_LAYER_BED_TEMPERATURE", Some(Heater::Bed)),
            ("CHAMBER", Some(Heater::Chamber)),
            ("EXTRUDER", nozzle),
            ("EXTRUDER_TEMP", nozzle),
            ("T_EXTRUDER", nozzle),
            ("NOZZLE_TEMP", nozzle),
            ("HOTEND", nozzle),
            ("TOOL_TEMP", nozzle),
            ("TEMP", nozzle),
            ("EXTRUDER1_TEMP", nozzle),
            ("TOOL", None),
            ("NOZZLE_DIAMETER", None),
            ("BED_TYPE", None),
            ("BED_MESH", None),
            ("LAYER", None),
            ("T", None),
            ("FAN", None),
            ("", None),
            ("\u{fffd}BED", None),
        ] {
            assert_eq!(heater_of(key.as_bytes()), heater, "{key}");
        }
    }
}
