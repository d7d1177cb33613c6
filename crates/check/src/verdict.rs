//! What a check found.

use glam::DVec3;
use isoslice_base::named;
use std::collections::BTreeMap;

/// Number of places of a finding that are kept; further ones are counted.
const KEPT: usize = 3;

/// Number of findings of one kind about different things. Further ones are
/// reported as one.
const APART: usize = 40;

/// What the findings beyond [`APART`] are about.
const OTHERS: &str = "others";

/// What a file without a name is called.
const THE_FILE: &str = "the G-code";

/// How bad a kind of finding is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// The finding can hurt the printer or the print.
    Fault,
    /// The finding should be looked at.
    Warning,
}

named! {
    /// What can be wrong.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
    pub enum FindingKind {
        /// The head would leave the printer.
        OutOfReach = "out-of-reach",
        /// Filament is pushed into a cold nozzle.
        Cold = "cold",
        /// Filament goes back while the head moves, outside of a wipe.
        Backwards = "backwards",
        /// More filament is pulled back than a nozzle can bear.
        LongRetraction = "long-retraction",
        /// A bead begins without its filament.
        Unprimed = "unprimed",
        /// A bead has more plastic than the nozzle can lay.
        ThickBead = "thick-bead",
        /// A move has more filament than the firmware takes.
        LongFeed = "long-feed",
        /// A move is faster than the printer, whose firmware will slow it down.
        TooFast = "too-fast",
        /// A start or end template lays or pushes more than the firmware takes
        /// unless it is told otherwise.
        Purge = "purge",
        /// A bead is too far above all others.
        Jump = "jump",
        /// A line makes no sense.
        Senseless = "senseless",
        /// A line is too long for some firmware.
        LongLine = "long-line",
        /// A move comes before any speed was set.
        NoSpeed = "no-speed",
        /// A travel leads below the top of the print, or through what is printed.
        Low = "low-travel",
        /// A bead is laid into what is printed below it.
        Sunk = "sunk-bead",
        /// The head would hit a part that is finished.
        Collision = "collision",
        /// An island stands on nothing, or a bead that rises has nothing below it.
        InTheAir = "in-the-air",
        /// Something depends on what only the printer knows.
        Unknown = "unknown",
        /// A heater is told more than it bears.
        TooHot = "too-hot",
        /// A heater is told more than is usual, and its limit is not set.
        Hot = "hot",
        /// A command has no place in a print.
        Harmful = "harmful",
        /// A command changes what the check takes for granted.
        Changed = "changed",
        /// A command is not known.
        UnknownWord = "unknown-word",
        /// The head moves before it knows where it is.
        NotHomed = "not-homed",
        /// A heater is on when the file ends.
        LeftOn = "left-on",
        /// The file ends in the middle of the print.
        CutOff = "cut-off",
        /// The file is no G-code.
        NoGcode = "no-gcode",
        /// A line ends in a way that not all firmware knows.
        LineEnd = "line-end",
        /// Filament is pushed while the head stands, in the middle of the print.
        Blob = "blob",
        /// A move in the middle of a bead feeds no filament.
        Gap = "gap",
        /// A layer has much more or less plastic than fits into it.
        Flow = "flow",
        /// The head moves on, and nothing is printed.
        Empty = "empty",
        /// The first layer does not lie on the bed, or the nozzle does.
        OffBed = "off-bed",
        /// The nozzle goes down into what is printed, straight or on a travel.
        Dive = "dive",
        /// A layer hangs in the air far from what stands.
        Adrift = "adrift",
        /// Beads are laid twice.
        Again = "again",
        /// The file takes a tool that the printer does not have.
        NoTool = "no-tool",
    }
}

impl FindingKind {
    /// How bad findings of this kind are.
    pub fn severity(self) -> Severity {
        match self {
            FindingKind::LongLine
            | FindingKind::NoSpeed
            | FindingKind::Jump
            | FindingKind::TooFast
            | FindingKind::Purge
            | FindingKind::Low
            | FindingKind::Sunk
            | FindingKind::InTheAir
            | FindingKind::Adrift
            | FindingKind::Unknown
            | FindingKind::Hot
            | FindingKind::Changed
            | FindingKind::UnknownWord
            | FindingKind::NotHomed
            | FindingKind::LeftOn
            | FindingKind::LineEnd => Severity::Warning,
            _ => Severity::Fault,
        }
    }
}

/// One finding, with all of its places.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// The kind of the fault.
    pub kind: FindingKind,
    /// The command, heater or axis that it is about, if the kind has several;
    /// else empty.
    pub about: String,
    /// Line of the first place, from 1; 0 if the finding is not about a line.
    pub line: u64,
    /// Position of the first place, mm; NaN if it has none.
    pub at: DVec3,
    /// What is wrong at the first place, as a sentence.
    pub message: String,
    /// Number of places.
    pub count: u64,
    /// Lines of the first few places.
    pub lines: Vec<u64>,
}

impl Finding {
    /// The finding as a sentence. `name` is that of the file, or empty for a
    /// file that has none yet.
    fn sentence(&self, name: &str) -> String {
        let place = match self.line {
            0 if name.is_empty() => THE_FILE.to_owned(),
            0 => name.to_owned(),
            line if name.is_empty() => format!("{THE_FILE}, line {line}"),
            line => format!("{name}:{line}"),
        };
        let more = self.count - 1;
        let again: Vec<String> =
            self.lines.iter().skip(1).map(u64::to_string).collect();
        let again = match again.as_slice() {
            _ if self.line == 0 => String::new(),
            [] => String::new(),
            [one] => format!(", in line {one}"),
            several => format!(", next in lines {}", several.join(" and ")),
        };
        match more {
            0 => format!("{place}: {}", self.message),
            _ => format!("{place}: {} ({more} more{again})", self.message),
        }
    }
}

/// What a check found in a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Verdict {
    /// Everything that was found, once each, in the order of the file.
    pub findings: Vec<Finding>,
    /// Number of findings of each kind.
    pub counts: BTreeMap<FindingKind, u64>,
    /// Number of lines in the file.
    pub lines: u64,
    /// Number of moves in the file.
    pub moves: u64,
    /// Number of layers in the file.
    pub layers: u32,
    /// The program that made the file, as the file says.
    pub generator: Option<String>,
}

impl Verdict {
    /// Number of findings of this severity.
    pub fn count(&self, severity: Severity) -> u64 {
        self.counts
            .iter()
            .filter(|(kind, _)| kind.severity() == severity)
            .map(|(_, count)| count)
            .sum()
    }

    /// True if nothing that the check understands can hurt.
    pub fn is_safe(&self) -> bool {
        self.count(Severity::Fault) == 0
    }

    /// Unknown commands, with the number of their places.
    pub fn unknown_words(&self) -> impl Iterator<Item = (&str, u64)> {
        self.findings
            .iter()
            .filter(|f| f.kind == FindingKind::UnknownWord)
            .map(|f| (f.about.as_str(), f.count))
    }

    /// The findings of this severity as sentences; `name` is the file's, or
    /// empty if it has none yet.
    pub fn sentences(&self, name: &str, severity: Severity) -> Vec<String> {
        self.sentences_of(name, |kind| kind.severity() == severity)
    }

    /// The findings of these kinds as sentences. `name` is the file's, or empty
    /// if it has none yet. All unknown commands share one sentence.
    pub fn sentences_of(
        &self,
        name: &str,
        of: impl Fn(FindingKind) -> bool,
    ) -> Vec<String> {
        let mut all: Vec<String> = self
            .findings
            .iter()
            .filter(|f| of(f.kind) && f.kind != FindingKind::UnknownWord)
            .map(|f| f.sentence(name))
            .collect();
        if of(FindingKind::UnknownWord) {
            all.extend(self.unknown_sentence(name));
        }
        all
    }

    fn unknown_sentence(&self, name: &str) -> Option<String> {
        let words: Vec<String> = self
            .findings
            .iter()
            .filter(|f| f.kind == FindingKind::UnknownWord)
            .map(|f| match f.count {
                1 => format!("{} (line {})", f.about, f.line),
                n => format!("{} ({n} times from line {})", f.about, f.line),
            })
            .collect();
        let name = if name.is_empty() { THE_FILE } else { name };
        (!words.is_empty()).then(|| {
            format!(
                "{name}: not known, so nothing is said of what they do: {}",
                words.join(", ")
            )
        })
    }

    pub(super) fn add(
        &mut self,
        kind: FindingKind,
        line: u64,
        at: DVec3,
        message: impl FnOnce() -> String,
    ) {
        self.add_about(kind, "", line, at, message);
    }

    /// Adds a finding of a kind that is about several things.
    pub(super) fn add_about(
        &mut self,
        kind: FindingKind,
        about: &str,
        line: u64,
        at: DVec3,
        message: impl FnOnce() -> String,
    ) {
        let known = self.counts.entry(kind).or_insert(0);
        *known += 1;
        let kinds = || self.findings.iter().filter(|f| f.kind == kind);
        let about = if *known as usize > APART
            && kinds().count() >= APART
            && kinds().all(|f| f.about != about)
        {
            OTHERS
        } else {
            about
        };
        let same = |f: &&mut Finding| f.kind == kind && f.about == about;
        if let Some(found) = self.findings.iter_mut().find(same) {
            found.count += 1;
            if found.lines.len() < KEPT && found.lines.last() != Some(&line) {
                found.lines.push(line);
            }
            return;
        }
        self.findings.push(Finding {
            kind,
            about: about.to_owned(),
            line,
            at,
            message: message(),
            count: 1,
            lines: vec![line],
        });
    }
}
