//! Problems: what makes no sense in a file.

use thiserror::Error;

/// Number of characters of a line that Marlin reads, comments left out:
/// `MAX_CMD_SIZE` is 96, and one of them ends the text.
pub(super) const LONGEST_COMMAND: usize = 95;

/// Why a line, or a part of one, was passed over.
#[derive(Clone, Copy, Debug, Error, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Problem {
    /// A letter without a number, as in `G1 X Y10`; it is passed over.
    #[error("{0} without a number")]
    MissingNumber(char),
    /// A position beyond any machine's reach; the line is passed over.
    #[error("a position beyond any machine's reach")]
    OutOfReach,
    /// An arc that has no centre; it is taken as a straight move.
    #[error("an arc without a centre")]
    BadArc,
    /// An arc that is not in the plane of x and y (after G18 or G19); it is
    /// taken as a straight move.
    #[error("an arc that is not in the plane of x and y")]
    UprightArc,
    /// A move's line has characters that are no words.
    #[error("characters that are no command")]
    Stray,
    /// A line too long to be a command; its end is passed over.
    #[error("a line too long to be a command")]
    LongLine,
    /// A curve (G5); it is taken as a straight move.
    #[error("a curve, which is not followed")]
    Curve,
    /// Two commands in one line, of which most firmware takes the first.
    #[error("two commands in one line")]
    TwoCommands,
    /// The temperature of a heater is no number.
    #[error("a temperature that is no number")]
    NoTemperature,
    /// A line that is neither a command nor a name.
    #[error("a line that is no command")]
    NoCommand,
    /// A carriage return ends the line, but not for every firmware.
    #[error(
        "a carriage return without a line feed: Marlin and RepRapFirmware \
         begin a line there, Klipper does not"
    )]
    CarriageReturn,
    /// A command ends where Marlin no longer reads it.
    #[error(
        "a command of more than {LONGEST_COMMAND} characters, blanks included: \
         Marlin leaves out what is beyond"
    )]
    Overflow,
}

/// The problems of a file: for each kind the line of the first one, and their
/// number.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Problems {
    /// The kinds in the order of their first lines.
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

    /// Every kind of problem, with the line of the first one and their number.
    pub fn iter(&self) -> impl Iterator<Item = (Problem, u64, u64)> + '_ {
        self.found.iter().copied()
    }

    /// The problems as sentences. `name` is the file's.
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
