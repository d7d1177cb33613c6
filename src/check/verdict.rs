//! What a check found.

use glam::DVec3;
use std::collections::BTreeMap;

/// Findings of a kind that are kept; the others are counted.
const KEPT: u64 = 3;

/// How bad a kind of finding is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// It can hurt the printer or the print.
    Fault,
    /// It should be looked at.
    Warning,
}

/// What can be wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Kind {
    /// The head would leave the printer.
    OutOfReach,
    /// Filament is pushed into a cold nozzle.
    Cold,
    /// Filament goes back while the head moves, outside of a wipe.
    Backwards,
    /// More filament is pulled back than a nozzle can bear.
    LongRetraction,
    /// A bead begins without its filament.
    Unprimed,
    /// A bead of more plastic than the nozzle can lay.
    ThickBead,
    /// More filament in one move than the firmware takes.
    LongFeed,
    /// Faster than the printer: its firmware will take its time.
    TooFast,
    /// A start or end template lays or pushes more than the firmware takes
    /// unless it is told otherwise.
    Purge,
    /// A bead too far above all others.
    Jump,
    /// A line that makes no sense.
    Senseless,
    /// A line that is too long for some firmware.
    LongLine,
    /// A move before any speed was set.
    NoSpeed,
    /// A travel below the top of the print.
    Low,
    /// An island that stands on nothing.
    InTheAir,
    /// What only the printer knows.
    Unknown,
}

impl Kind {
    /// How bad it is.
    pub fn severity(self) -> Severity {
        match self {
            Kind::LongLine
            | Kind::NoSpeed
            | Kind::Jump
            | Kind::TooFast
            | Kind::Purge
            | Kind::Low
            | Kind::InTheAir
            | Kind::Unknown => Severity::Warning,
            _ => Severity::Fault,
        }
    }

    /// Name for machines.
    pub fn name(self) -> &'static str {
        match self {
            Kind::OutOfReach => "out-of-reach",
            Kind::Cold => "cold",
            Kind::Backwards => "backwards",
            Kind::LongRetraction => "long-retraction",
            Kind::Unprimed => "unprimed",
            Kind::ThickBead => "thick-bead",
            Kind::LongFeed => "long-feed",
            Kind::TooFast => "too-fast",
            Kind::Purge => "purge",
            Kind::Jump => "jump",
            Kind::Senseless => "senseless",
            Kind::LongLine => "long-line",
            Kind::NoSpeed => "no-speed",
            Kind::Low => "low-travel",
            Kind::InTheAir => "in-the-air",
            Kind::Unknown => "unknown",
        }
    }
}

/// One finding.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// What is wrong.
    pub kind: Kind,
    /// Line, from 1; 0 if it is not about one.
    pub line: u64,
    /// Where, mm; not a number if it is nowhere.
    pub at: DVec3,
    /// What is wrong, as a sentence.
    pub message: String,
}

/// What a check found in a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Verdict {
    /// The first findings of each kind, in the order of the file.
    pub findings: Vec<Finding>,
    /// How many there are of each kind.
    pub counts: BTreeMap<Kind, u64>,
    /// Lines of the file.
    pub lines: u64,
    /// Moves in it.
    pub moves: u64,
    /// Layers in it.
    pub layers: u32,
    /// What the file says made it.
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

    /// True if nothing can hurt.
    pub fn is_safe(&self) -> bool {
        self.count(Severity::Fault) == 0
    }

    /// The findings of this severity as sentences; `name` is the file's.
    pub fn sentences(&self, name: &str, severity: Severity) -> Vec<String> {
        self.sentences_of(name, |kind| kind.severity() == severity)
    }

    /// The findings of these kinds as sentences; `name` is the file's.
    pub fn sentences_of(
        &self,
        name: &str,
        of: impl Fn(Kind) -> bool,
    ) -> Vec<String> {
        let mut all: Vec<String> = self
            .findings
            .iter()
            .filter(|f| of(f.kind))
            .map(|f| match f.line {
                0 => format!("{name}: {}", f.message),
                line => format!("{name}:{line}: {}", f.message),
            })
            .collect();
        for (kind, &count) in &self.counts {
            if of(*kind) && count > KEPT {
                let more = count - KEPT;
                all.push(format!("{name}: {more} more of {}", kind.name()));
            }
        }
        all
    }

    pub(super) fn add(
        &mut self,
        kind: Kind,
        line: u64,
        at: DVec3,
        message: impl FnOnce() -> String,
    ) {
        let count = self.counts.entry(kind).or_insert(0);
        *count += 1;
        if *count <= KEPT {
            self.findings.push(Finding {
                kind,
                line,
                at,
                message: message(),
            });
        }
    }
}
