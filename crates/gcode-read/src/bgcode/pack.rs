//! From text to a file of blocks.

use super::heatshrink::compressed;
use super::{
    BLOCK, BlockKind, Compression, LENGTH, MAGIC, VERSION, WINDOW, number_of,
};
use isoslice_settings::PictureSize;
use std::fs::File;
use std::io::{self, BufWriter, Seek, Write};

/// The number of the only way in which keys are written.
const INI: u16 = 0;
/// The number of text that is not shortened before it is compressed.
const PLAIN: u16 = 0;
/// The number of the checksum in use: CRC32.
const CRC: u16 = 1;

/// A key and its value.
pub type Key = (String, String);

/// What a file has before the text.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct About {
    /// Who made the file.
    pub file: Vec<Key>,
    /// What the printer asks for.
    pub printer: Vec<Key>,
    /// What the print takes.
    pub print: Vec<Key>,
    /// How the part was sliced.
    pub slicer: Vec<Key>,
    /// Pictures of the part: size and format, and the file.
    pub pictures: Vec<(PictureSize, Vec<u8>)>,
}

/// A writer that packs text. The tables before the text are known only after
/// it, so the blocks wait in a temporary file.
#[derive(Debug)]
pub struct Packer<W> {
    out: W,
    blocks: BufWriter<File>,
    /// Text that is not yet in a block.
    text: Vec<u8>,
}

impl<W: Write> Packer<W> {
    /// Begins a file.
    ///
    /// # Errors
    /// If there can be no temporary file.
    pub fn new(out: W) -> io::Result<Self> {
        Ok(Packer {
            out,
            blocks: BufWriter::with_capacity(BLOCK, tempfile::tempfile()?),
            text: Vec::new(),
        })
    }

    /// Writes the file.
    ///
    /// # Errors
    /// If the output or the temporary file cannot be written.
    pub fn finish(mut self, about: &About) -> io::Result<()> {
        if !self.text.is_empty() {
            write_text(&mut self.blocks, &self.text)?;
        }
        let out = &mut self.out;
        out.write_all(&MAGIC)?;
        out.write_all(&VERSION.to_le_bytes())?;
        out.write_all(&CRC.to_le_bytes())?;
        write_keys(out, BlockKind::File, &about.file)?;
        write_keys(out, BlockKind::Printer, &about.printer)?;
        for (size, file) in &about.pictures {
            let [width, height] = size.pixels.map(|n| n as u16);
            let parameters = [number_of(size.format), width, height];
            write_block(out, BlockKind::Thumbnail, &parameters, file, None)?;
        }
        write_keys(out, BlockKind::Print, &about.print)?;
        write_keys(out, BlockKind::Slicer, &about.slicer)?;
        let mut blocks =
            self.blocks.into_inner().map_err(|e| e.into_error())?;
        blocks.rewind()?;
        io::copy(&mut blocks, out)?;
        out.flush()
    }
}

impl<W: Write> Write for Packer<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.text.extend_from_slice(bytes);
        while self.text.len() > BLOCK {
            // A block ends at a line's end, unless one line is longer than a
            // block.
            let end = memchr::memrchr(b'\n', &self.text[..BLOCK]);
            let rest = self.text.split_off(end.map_or(BLOCK, |at| at + 1));
            write_text(&mut self.blocks, &self.text)?;
            self.text = rest;
        }
        Ok(bytes.len())
    }

    /// Does nothing: [`Packer::finish`] writes.
    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

fn write_text(out: &mut impl Write, text: &[u8]) -> io::Result<()> {
    let small = compressed(text, WINDOW, LENGTH);
    write_block(out, BlockKind::Gcode, &[PLAIN], text, Some(&small))
}

fn write_keys(
    out: &mut impl Write,
    kind: BlockKind,
    keys: &[Key],
) -> io::Result<()> {
    let lines = keys.iter().map(|(key, value)| format!("{key}={value}\n"));
    let text: String = lines.collect();
    write_block(out, kind, &[INI], text.as_bytes(), None)
}

/// Writes a block with `data`, which may be compressed.
fn write_block(
    out: &mut impl Write,
    kind: BlockKind,
    parameters: &[u16],
    data: &[u8],
    small: Option<&[u8]>,
) -> io::Result<()> {
    let length = |bytes: &[u8]| {
        u32::try_from(bytes.len())
            .map_err(|_| io::Error::from(io::ErrorKind::FileTooLarge))
    };
    let compression = match small {
        Some(_) => Compression::Heatshrink12,
        None => Compression::None,
    };
    let mut head = Vec::with_capacity(18);
    head.extend((kind as u16).to_le_bytes());
    head.extend((compression as u16).to_le_bytes());
    head.extend(length(data)?.to_le_bytes());
    if let Some(small) = small {
        head.extend(length(small)?.to_le_bytes());
    }
    for parameter in parameters {
        head.extend(parameter.to_le_bytes());
    }
    let data = small.unwrap_or(data);
    let mut sum = crc32fast::Hasher::new();
    sum.update(&head);
    sum.update(data);
    out.write_all(&head)?;
    out.write_all(data)?;
    out.write_all(&sum.finalize().to_le_bytes())
}
