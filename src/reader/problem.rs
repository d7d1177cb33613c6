//! What cannot be made sense of in a file.

use std::fmt;

/// Why a line, or a part of one, was passed over.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Problem {
    /// A letter without a number, as in `G1 X Y10`; it is passed over. A
    /// number that is too large to be one counts as none.
    MissingNumber(char),
    /// A position beyond any machine's reach; the line is passed over.
    OutOfReach,
    /// An arc that has no centre; it is taken as a straight move.
    BadArc,
    /// An arc that is not in the plane of x and y (after G18 or G19); it is
    /// taken as a straight move.
    UprightArc,
    /// Signs that are no words in a line that moves.
    Stray,
    /// A line too long to be a command; its end is passed over.
    LongLine,
    /// A curve (G5); it is taken as a straight move.
    Curve,
    /// Two commands in one line, of which most firmware takes the first.
    TwoCommands,
    /// A heater's temperature that is no number.
    NoTemperature,
    /// A line that is neither a command nor a name.
    NoCommand,
    /// A carriage return ends the line: not for every firmware.
    CarriageReturn,
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Problem::MissingNumber(letter) => {
                write!(f, "{letter} without a number")
            }
            Problem::OutOfReach => {
                write!(f, "a position beyond any machine's reach")
            }
            Problem::BadArc => write!(f, "an arc without a centre"),
            Problem::UprightArc => {
                write!(f, "an arc that is not in the plane of x and y")
            }
            Problem::Stray => write!(f, "signs that are no command"),
            Problem::LongLine => write!(f, "a line too long to be a command"),
            Problem::Curve => write!(f, "a curve, which is not followed"),
            Problem::TwoCommands => write!(f, "two commands in one line"),
            Problem::NoTemperature => {
                write!(f, "a temperature that is no number")
            }
            Problem::NoCommand => write!(f, "a line that is no command"),
            Problem::CarriageReturn => write!(
                f,
                "a carriage return without a line feed: Marlin and \
                 RepRapFirmware begin a line there, Klipper does not"
            ),
        }
    }
}

/// Problems of each kind: where the first one is, and how many there are.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Problems {
    /// In the order in which they were met first.
    found: Vec<(Problem, u64, u64)>,
}

impl Problems {
    /// Counts a problem; true if its kind has not been met before.
    pub(super) fn count(&mut self, problem: Problem, line: u64) -> bool {
        for (known, _, count) in &mut self.found {
            if *known == problem {
                *count += 1;
                return false;
            }
        }
        self.found.push((problem, line, 1));
        true
    }

    /// Every kind met, with the line of the first and how many there are.
    pub fn iter(&self) -> impl Iterator<Item = (Problem, u64, u64)> + '_ {
        self.found.iter().copied()
    }

    /// The same, as sentences; `name` is the file's.
    pub fn warnings(&self, name: &str) -> Vec<String> {
        self.iter()
            .map(|(problem, line, count)| match count {
                1 => format!("{name}:{line}: {problem}"),
                _ => format!(
                    "{name}:{line}: {problem}, the first of {count} such lines"
                ),
            })
            .collect()
    }
}
