//! From a file of blocks to text.
//!
//! In: any bytes. Out: the text of binary G-code, after comments with what the
//! file says about itself in the words of PrusaSlicer. Any other bytes come out
//! unchanged. Everything is checked before it is used, and no block may be
//! larger than [`LARGEST`].

use super::{
    BLOCK, BlockKind, Compression, MAGIC, VERSION, heatshrink, meatpack,
    number_of,
};
use crate::package::{self, Opened};
use flate2::read::ZlibDecoder;
use isoslice_settings::{ImageFormat, PictureSize};
use std::io::{self, Read};

/// Greatest length of a block, compressed or not, bytes. Slicers write blocks
/// of some 10 kB.
const LARGEST: u32 = 1 << 24;

/// Greatest ratio of the unpacked length to the packed one, of a block and of
/// the file. A few megabytes must not become gigabytes that take minutes to
/// read.
const LIKELY: u64 = 64;

/// Why packed G-code cannot be read.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Damaged {
    /// Bytes are missing at the end of the file.
    #[error("it is cut off in block {0}; copy it again, or slice again")]
    CutOff(u64),
    /// Bytes have changed.
    #[error(
        "the checksum of block {0} is not that of its contents; copy it \
         again, or slice again"
    )]
    Checksum(u64),
    /// The file breaks a rule of the format.
    #[error("block {block} breaks a rule of the format: {what}")]
    Format {
        /// Number of the block, from 1; 0 is the head.
        block: u64,
        /// The fault, in words.
        what: &'static str,
    },
    /// There is no text.
    #[error("there is no G-code in it")]
    Empty,
}

impl From<Damaged> for io::Error {
    fn from(why: Damaged) -> io::Error {
        io::Error::new(io::ErrorKind::InvalidData, why)
    }
}

/// Reads G-code as text, whether it is binary, in an archive, or text.
#[derive(Debug)]
pub struct Unpacked<R> {
    input: R,
    form: Form,
    /// Unpacked text. What stands from `at` on has not been handed out.
    ready: Vec<u8>,
    at: usize,
    /// Number of blocks begun so far, and of their packed and their unpacked
    /// bytes.
    blocks: u64,
    packed: u64,
    unpacked: u64,
    /// Number of lines before the text.
    preface: u64,
    /// What is made of the blocks before the text.
    of_blocks: OfBlocks,
}

/// What is made of blocks that are not text.
#[derive(Debug)]
enum OfBlocks {
    /// Comments of what the file says about itself.
    Comments,
    /// The block is left out.
    Nothing,
    /// Pictures are kept.
    Pictures(Vec<(PictureSize, Vec<u8>)>),
}

#[derive(Debug)]
enum Form {
    Unknown,
    Text,
    Binary {
        checksums: bool,
        has_text: bool,
    },
    /// A plate of Bambu Lab's.
    Plate(Box<Opened>),
}

impl<R: Read> Unpacked<R> {
    /// Reads from `input`.
    pub fn new(input: R) -> Self {
        Unpacked {
            input,
            form: Form::Unknown,
            ready: Vec::new(),
            at: 0,
            blocks: 0,
            packed: 0,
            unpacked: 0,
            preface: 0,
            of_blocks: OfBlocks::Comments,
        }
    }

    /// Reads the text alone, without what the file says about itself.
    pub fn text_of(input: R) -> Self {
        Unpacked {
            of_blocks: OfBlocks::Nothing,
            ..Unpacked::new(input)
        }
    }

    /// Number of lines that were put before the text.
    pub fn preface(&self) -> u64 {
        self.preface
    }

    /// Finds out by the first bytes whether the input is text or binary.
    fn begin(&mut self) -> io::Result<()> {
        let first = self.up_to(MAGIC.len())?;
        // The beginning of a file's first bytes, and nothing else, is a file that
        // was cut off.
        let alone = first.len() < MAGIC.len();
        let letters = first.trim_ascii_end();
        let is_begun = |magic: &[u8]| {
            alone && letters.len() > 1 && magic.starts_with(letters)
        };
        if is_begun(&MAGIC) {
            return Err(Damaged::CutOff(0).into());
        }
        if first == package::MAGIC || is_begun(&package::MAGIC) {
            let mut archive = first.as_slice().chain(&mut self.input);
            let opened = Opened::new(&mut archive)?;
            self.form = Form::Plate(Box::new(opened));
            return Ok(());
        }
        if first != MAGIC {
            self.form = Form::Text;
            self.ready = first;
            return Ok(());
        }
        let head = self.exactly(6)?;
        let version = u32::from_le_bytes([head[0], head[1], head[2], head[3]]);
        let format = |what| Damaged::Format { block: 0, what };
        if version > VERSION {
            return Err(format("it has a newer version than 1").into());
        }
        let checksums = match u16::from_le_bytes([head[4], head[5]]) {
            0 => false,
            1 => true,
            _ => return Err(format("its checksums are not CRC32").into()),
        };
        self.form = Form::Binary {
            checksums,
            has_text: false,
        };
        Ok(())
    }

    /// Makes the next block ready; false at the end.
    fn block(&mut self, checksums: bool, has_text: bool) -> io::Result<bool> {
        isoslice_base::limits::io_goes_on()?;
        self.blocks += 1;
        let block = self.blocks;
        let format = |what| Damaged::Format { block, what };
        let mut bytes = self.up_to(8)?;
        if bytes.is_empty() {
            return if has_text {
                Ok(false)
            } else {
                Err(Damaged::Empty.into())
            };
        }
        if bytes.len() < 8 {
            return Err(Damaged::CutOff(block).into());
        }
        let word = |at: usize| u16::from_le_bytes([bytes[at], bytes[at + 1]]);
        let kind =
            BlockKind::of(word(0)).ok_or(format("its kind is unknown"))?;
        let compression = Compression::of(word(2))
            .ok_or(format("it is compressed in an unknown way"))?;
        let size = |b: &[u8]| match b {
            &[a, b, c, d] => u32::from_le_bytes([a, b, c, d]),
            _ => u32::MAX,
        };
        let whole = size(&bytes[4..8]);
        let mut length = whole;
        if compression != Compression::None {
            bytes.extend(self.exactly(4)?);
            length = size(&bytes[8..12]);
        }
        if whole.max(length) > LARGEST {
            return Err(format("it has more than 16 MB").into());
        }
        self.packed += u64::from(length);
        self.unpacked += u64::from(whole);
        // Small blocks and small files may be packed better than `LIKELY`.
        let likely = |length: u64, small: u64| LIKELY * length + small;
        if u64::from(whole) > likely(length.into(), BLOCK as u64)
            || self.unpacked > likely(self.packed, LARGEST.into())
        {
            return Err(format("it claims to be far longer than it is").into());
        }
        let start = bytes.len() + kind.parameters();
        bytes.extend(self.exactly(kind.parameters() + length as usize)?);
        if checksums && size(&self.exactly(4)?) != crc32fast::hash(&bytes) {
            return Err(Damaged::Checksum(block).into());
        }
        let encoding = match &bytes[start - kind.parameters()..] {
            &[low, high, ..] => u16::from_le_bytes([low, high]),
            _ => u16::MAX,
        };
        if let (OfBlocks::Pictures(all), BlockKind::Thumbnail) =
            (&mut self.of_blocks, kind)
        {
            let file = bytes[start..].to_vec();
            all.push((
                picture_size(&bytes[start - kind.parameters()..start])
                    .ok_or(format("its picture has an unknown format"))?,
                file,
            ));
        }
        // Pictures are for screens, and nobody reads keys that come after the
        // text.
        let keys = matches!(self.of_blocks, OfBlocks::Comments) && !has_text;
        if kind == BlockKind::Thumbnail || (kind != BlockKind::Gcode && !keys) {
            return Ok(true);
        }
        let text = decompressed(&bytes[start..], compression, whole as usize)
            .ok_or(format("its contents cannot be decompressed"))?;
        self.at = 0;
        self.ready = match (kind, encoding) {
            (BlockKind::Gcode, 0) => text,
            (BlockKind::Gcode, 1 | 2) => meatpack::unpacked(&text),
            (BlockKind::Gcode, _) => {
                return Err(format("its text has an unknown encoding").into());
            }
            // Newer versions of PrusaSlicer write their settings twice.
            (_, 0) => comments(&text),
            _ => Vec::new(),
        };
        match kind {
            BlockKind::Gcode => {
                let has_text = true;
                self.form = Form::Binary {
                    checksums,
                    has_text,
                };
            }
            _ => {
                let lines = memchr::memchr_iter(b'\n', &self.ready);
                self.preface += lines.count() as u64;
            }
        }
        Ok(true)
    }

    /// The next `count` bytes, or as many as are left.
    fn up_to(&mut self, count: usize) -> io::Result<Vec<u8>> {
        // The buffer grows with the bytes that are there, whatever length the
        // file names.
        let mut bytes = Vec::new();
        let mut input = self.input.by_ref().take(count as u64);
        input.read_to_end(&mut bytes)?;
        Ok(bytes)
    }

    fn exactly(&mut self, count: usize) -> io::Result<Vec<u8>> {
        let bytes = self.up_to(count)?;
        if bytes.len() == count {
            Ok(bytes)
        } else {
            Err(Damaged::CutOff(self.blocks).into())
        }
    }
}

impl<R: Read> Read for Unpacked<R> {
    fn read(&mut self, out: &mut [u8]) -> io::Result<usize> {
        loop {
            let ready = &self.ready[self.at..];
            if !ready.is_empty() {
                let n = ready.len().min(out.len());
                out[..n].copy_from_slice(&ready[..n]);
                self.at += n;
                return Ok(n);
            }
            match &mut self.form {
                Form::Unknown => self.begin()?,
                Form::Text => return self.input.read(out),
                Form::Plate(text) => return text.read(out),
                &mut Form::Binary {
                    checksums,
                    has_text,
                } => {
                    if !self.block(checksums, has_text)? {
                        return Ok(0);
                    }
                }
            }
        }
    }
}

/// The pictures of binary G-code. What comes after the first piece of its text
/// is not read.
///
/// # Errors
/// If the file is damaged, or is not binary G-code.
pub fn pictures(
    input: &mut impl Read,
) -> io::Result<Vec<(PictureSize, Vec<u8>)>> {
    let mut file = Unpacked {
        of_blocks: OfBlocks::Pictures(Vec::new()),
        ..Unpacked::new(input)
    };
    let mut first = [0];
    file.read_exact(&mut first)?;
    match file.of_blocks {
        OfBlocks::Pictures(all) => Ok(all),
        OfBlocks::Comments | OfBlocks::Nothing => Ok(Vec::new()),
    }
}

/// Reads what a block says of its picture.
fn picture_size(parameters: &[u8]) -> Option<PictureSize> {
    let words = parameters.chunks_exact(2);
    let words = words.map(|w| u16::from_le_bytes([w[0], w[1]]));
    let &[format, width, height] = words.collect::<Vec<_>>().as_slice() else {
        return None;
    };
    let all = [ImageFormat::Png, ImageFormat::Jpg, ImageFormat::Qoi];
    Some(PictureSize {
        pixels: [width.into(), height.into()],
        format: all.into_iter().find(|f| number_of(*f) == format)?,
    })
}

/// The `count` bytes that a block unpacks to.
fn decompressed(
    data: &[u8],
    compression: Compression,
    count: usize,
) -> Option<Vec<u8>> {
    let text = match compression {
        Compression::None => data.to_vec(),
        Compression::Deflate => {
            let mut text = Vec::new();
            // The decoder reads one byte more than there may be, so that too
            // many are noticed.
            ZlibDecoder::new(data)
                .take(count as u64 + 1)
                .read_to_end(&mut text)
                .ok()?;
            text
        }
        Compression::Heatshrink11 => {
            heatshrink::decompressed(data, 11, 4, count)?
        }
        Compression::Heatshrink12 => {
            heatshrink::decompressed(data, 12, 4, count)?
        }
    };
    (text.len() == count).then_some(text)
}

/// Text for a comment, without carriage returns: some readers would end the
/// comment there.
fn plain(text: &[u8]) -> impl Iterator<Item = &u8> {
    text.iter().filter(|b| !b.is_ascii_control())
}

/// Lines of `key=value` as comments, with the maker's name as the head of a
/// text file has it.
fn comments(keys: &[u8]) -> Vec<u8> {
    let mut text = Vec::with_capacity(keys.len() + 64);
    for line in keys.split(|b| *b == b'\n') {
        let line = line.trim_ascii();
        let Some(at) = memchr::memchr(b'=', line) else {
            continue;
        };
        let (key, value) = (line[..at].trim_ascii(), &line[at + 1..]);
        match key {
            b"Producer" => text.extend(b"; generated by "),
            _ => {
                text.extend(b"; ");
                text.extend(plain(key));
                text.extend(b" = ");
            }
        }
        text.extend(plain(value));
        text.push(b'\n');
    }
    text
}
