//! Notices early that a file is no G-code, even if it has no end.
//!
//! In: how many lines were commands so far. Out: why the file is no G-code.
//!
//! A file of G-code has thousands of commands before it has 10,000 lines that
//! are no commands: text that is no comment stands at its start or end, and
//! where macros name an object or a layer there are moves as well. A file that
//! is refused here would also be refused at its end, but a stream may have no
//! end. A file also never has millions of commands in a row that leave the head
//! where it is: whatever repeats such a command for ever is no print.

use std::io;

/// By how many a file's lines without a command may exceed those with one.
const LINES: u64 = 10_000;

/// Bytes that a file may have before its first code. Pictures and settings in
/// comments at the head take about 1 % of that.
const BYTES: u64 = 1 << 26;

/// Commands in a row that may leave the head where it is.
const IDLE: u64 = 2_000_000;

/// How many lines are commands, and how many are not. Lines that are blank or a
/// comment count as neither.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    /// A letter with a number, as in G1.
    pub codes: u64,
    /// A name, which may be a macro's.
    pub names: u64,
    /// Neither.
    pub senseless: u64,
    /// Codes since the head was last moved.
    pub idle: u64,
}

/// Why a file is no G-code.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NoGcode {
    /// A line is too long.
    #[error("line {line} is longer than {megabytes} MB")]
    LongLine {
        /// The line's number.
        line: u64,
        /// The length that it exceeds.
        megabytes: u64,
    },
    /// The file begins with too many comments, blank lines and names.
    #[error("there is no command in its first {megabytes} MB")]
    NoCommand {
        /// Length of that beginning, MB.
        megabytes: u64,
    },
    /// Most lines make no sense.
    #[error("{none} of its first {lines} lines are no commands")]
    OtherLines {
        /// Number of lines that are no commands, or perhaps names of macros.
        none: u64,
        /// Number of lines that are no comments.
        lines: u64,
    },
    /// The head stands still for too long.
    #[error("the last {commands} commands do not move the head")]
    Idle {
        /// Number of commands.
        commands: u64,
    },
    /// The file has to be unpacked first.
    #[error("it is {what}")]
    Packed {
        /// What the file is, and what to do.
        what: &'static str,
    },
}

impl From<NoGcode> for io::Error {
    fn from(why: NoGcode) -> io::Error {
        io::Error::new(io::ErrorKind::InvalidData, why)
    }
}

/// Returns an error if a file's first line shows that the file is something
/// else.
pub(super) fn first_line(text: &[u8]) -> Result<(), NoGcode> {
    // The first bytes of each format's files.
    let what = match text {
        [0x1f, 0x8b, ..] => {
            "compressed; unpack it first, as in `zcat FILE | isoslice check -`"
        }
        _ => return Ok(()),
    };
    Err(NoGcode::Packed { what })
}

/// Returns an error if too few of the lines in the first `bytes` bytes were
/// commands.
pub(super) fn so_far(tally: &Tally, bytes: u64) -> Result<(), NoGcode> {
    let none = tally.senseless + tally.names;
    if none > tally.codes.saturating_add(LINES) {
        let lines = none + tally.codes;
        return Err(NoGcode::OtherLines { none, lines });
    }
    if tally.idle > IDLE {
        return Err(NoGcode::Idle { commands: IDLE });
    }
    if tally.codes == 0 && bytes > BYTES {
        let megabytes = BYTES >> 20;
        return Err(NoGcode::NoCommand { megabytes });
    }
    Ok(())
}
