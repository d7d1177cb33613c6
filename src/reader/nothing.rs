//! Notices early that a file is no G-code, however long it goes on.
//!
//! In: how many lines were commands so far. Out: why it is none.
//!
//! A true file has thousands of commands before it has ten thousand lines that
//! are none: text that nobody made a comment is at its start or end, and a
//! macro's name for each object and layer comes with moves. What is refused
//! here is refused at the end as well; a stream may have no end.

use std::io;

/// Lines that are no commands, or names of macros, that a file may have beyond
/// as many as it has codes.
const LINES: u64 = 10_000;

/// Bytes that may pass without a single code: pictures and settings in
/// comments at the head are a hundredth of it.
const BYTES: u64 = 1 << 26;

/// How many lines are commands, and how many are none. Lines that are blank
/// or a comment are neither.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    /// A letter with a number, as in G1.
    pub codes: u64,
    /// A name, which may be a macro's.
    pub names: u64,
    /// Neither.
    pub senseless: u64,
}

/// Why a file is no G-code.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NoGcode {
    /// A line goes on and on.
    #[error("line {line} is longer than {megabytes} MB")]
    LongLine {
        /// Its number.
        line: u64,
        /// What it is longer than.
        megabytes: u64,
    },
    /// Nothing but comments, blank lines or names.
    #[error("there is no command in its first {megabytes} MB")]
    NoCommand {
        /// How many there were.
        megabytes: u64,
    },
    /// Most lines make no sense.
    #[error("{none} of its first {lines} lines are no commands")]
    OtherLines {
        /// Lines that are no commands, or may only be macros' names.
        none: u64,
        /// Lines that are no comments.
        lines: u64,
    },
    /// It has to be unpacked first.
    #[error("it is {what}")]
    Packed {
        /// What it is, and what to do.
        what: &'static str,
    },
}

impl From<NoGcode> for io::Error {
    fn from(why: NoGcode) -> io::Error {
        io::Error::new(io::ErrorKind::InvalidData, why)
    }
}

/// Errs if a file that begins with such a line is known to be something else.
pub(super) fn first_line(text: &[u8]) -> Result<(), NoGcode> {
    // The first bytes of each format's files.
    let what = match text {
        [0x1f, 0x8b, ..] => {
            "compressed; unpack it first, as in `zcat FILE | isoslice check -`"
        }
        [b'P', b'K', 3, 4, ..] => {
            "a zip archive, as 3MF and UFP files are; unpack the G-code first"
        }
        _ => return Ok(()),
    };
    Err(NoGcode::Packed { what })
}

/// Errs if, after so many bytes, too little of it was commands.
pub(super) fn so_far(tally: &Tally, bytes: u64) -> Result<(), NoGcode> {
    let none = tally.senseless + tally.names;
    if none > tally.codes.saturating_add(LINES) {
        let lines = none + tally.codes;
        return Err(NoGcode::OtherLines { none, lines });
    }
    if tally.codes == 0 && bytes > BYTES {
        let megabytes = BYTES >> 20;
        return Err(NoGcode::NoCommand { megabytes });
    }
    Ok(())
}
