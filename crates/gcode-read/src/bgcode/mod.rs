//! Binary G-code, the format of Prusa's printers: packs text into it, and
//! unpacks it.
//!
//! In: G-code as text, what is known of the print, and pictures. Out: a file
//! with tables of keys, the pictures, and the text in compressed blocks. Any
//! such file can be turned back into text.
//!
//! The format is that of Prusa's specification (github.com/prusa3d/libbgcode,
//! doc/specifications.md): a head of ten bytes, then blocks, each with its
//! kind, how it is compressed, its length and a checksum. All numbers are
//! little-endian.
//!
//! Guarantees: equal text gives equal bytes; unpacking them gives back every
//! byte of the text; memory grows neither with the length of the text nor with
//! what a damaged file says about itself.
//!
//! | file | what it does |
//! |---|---|
//! | `pack` | from text to blocks |
//! | `unpack` | from blocks to text |
//! | `heatshrink` | the compression that printers can undo |
//! | `meatpack` | characters of four bits, as other slicers write them |

mod heatshrink;
mod meatpack;
mod pack;
mod unpack;

pub use pack::{About, Key, Packer};
pub(crate) use unpack::Damaged;
pub use unpack::Unpacked;
pub use unpack::pictures;

use isoslice_settings::ImageFormat;

/// The first bytes of a file.
pub const MAGIC: [u8; 4] = *b"GCDE";
/// The version of the format.
const VERSION: u32 = 1;
/// Length of a block's text, bytes. Printers decompress a block piece by piece,
/// and begin again at a block after a power failure.
const BLOCK: usize = 1 << 16;
/// Number of bits of the distances in compressed text. [`LENGTH`] is that of
/// the lengths.
const WINDOW: u8 = 12;
const LENGTH: u8 = 4;

/// What a block holds, by its number in the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum BlockKind {
    /// Who made the file.
    File = 0,
    /// A piece of the text.
    Gcode = 1,
    /// The slicer's settings.
    Slicer = 2,
    /// What the printer asks for.
    Printer = 3,
    /// What the print takes.
    Print = 4,
    /// A picture.
    Thumbnail = 5,
}

impl BlockKind {
    fn of(number: u16) -> Option<BlockKind> {
        let all = [
            BlockKind::File,
            BlockKind::Gcode,
            BlockKind::Slicer,
            BlockKind::Printer,
            BlockKind::Print,
            BlockKind::Thumbnail,
        ];
        all.get(usize::from(number)).copied()
    }

    /// Bytes between the block's head and its data.
    fn parameters(self) -> usize {
        match self {
            BlockKind::Thumbnail => 6,
            _ => 2,
        }
    }
}

/// How a block's data are compressed, by its number in the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Compression {
    None = 0,
    Deflate = 1,
    /// Heatshrink with a window of 11 bits.
    Heatshrink11 = 2,
    /// Heatshrink with a window of 12 bits.
    Heatshrink12 = 3,
}

impl Compression {
    fn of(number: u16) -> Option<Compression> {
        let all = [
            Compression::None,
            Compression::Deflate,
            Compression::Heatshrink11,
            Compression::Heatshrink12,
        ];
        all.get(usize::from(number)).copied()
    }
}

/// A picture's format, by its number in the file.
fn number_of(format: ImageFormat) -> u16 {
    match format {
        ImageFormat::Png => 0,
        ImageFormat::Jpg => 1,
        ImageFormat::Qoi => 2,
    }
}

#[cfg(test)]
mod tests;
