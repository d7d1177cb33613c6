//! From text to an archive.

use super::{About, GCODE, SUM, entries, head};
use md5::{Digest, Md5};
use std::fs::File;
use std::io::{self, BufReader, BufWriter, Read, Seek, SeekFrom, Write};
use zip::result::ZipError;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

/// Bytes that are written or read at a time.
const BUFFER: usize = 1 << 18;

/// Length of the text within which its blank head ends, bytes.
const HEAD: u64 = 1 << 12;

/// Packs the text that is written to it. The head of the text is known only
/// after it, so the text waits in a temporary file.
#[derive(Debug)]
pub struct Packer<W> {
    out: W,
    text: BufWriter<File>,
}

impl<W: Write> Packer<W> {
    /// Begins a file.
    ///
    /// # Errors
    /// If there can be no temporary file.
    pub fn new(out: W) -> io::Result<Self> {
        let text = BufWriter::with_capacity(BUFFER, tempfile::tempfile()?);
        Ok(Packer { out, text })
    }

    /// Writes the file.
    ///
    /// # Errors
    /// If the output or a temporary file cannot be written.
    pub fn finish(mut self, about: &About) -> io::Result<()> {
        let text = self.text.into_inner().map_err(|e| e.into_error())?;
        // Writing an archive goes back to earlier places, which a stream cannot
        // do.
        let archive = tempfile::tempfile()?;
        let archive = BufWriter::with_capacity(BUFFER, archive);
        let mut zip = ZipWriter::new(archive);
        let sum = write_text(&mut zip, text, about)?;
        write_entry(&mut zip, SUM, sum.as_bytes())?;
        for (name, text) in [
            ("[Content_Types].xml", entries::content_types()),
            ("_rels/.rels", entries::root_relationships(about)),
            ("3D/3dmodel.model", entries::model(about)),
            (
                "Metadata/model_settings.config",
                entries::model_settings(about),
            ),
            (
                "Metadata/_rels/model_settings.config.rels",
                entries::plate_relationships(),
            ),
            ("Metadata/slice_info.config", entries::slice_info(about)),
            (entries::PLATE, entries::plate(about)),
        ] {
            write_entry(&mut zip, name, text.as_bytes())?;
        }
        let by_size: Vec<_> = about
            .pictures
            .iter()
            .map(|(size, file)| (size.pixels[0] * size.pixels[1], file))
            .collect();
        let largest = by_size.iter().max_by_key(|(size, _)| *size);
        let smallest = by_size.iter().min_by_key(|(size, _)| *size);
        for (name, picture) in
            [(entries::PICTURE, largest), (entries::SMALL, smallest)]
        {
            if let Some((_, file)) = picture {
                write_entry(&mut zip, name, file)?;
            }
        }
        let archive = zip.finish().map_err(io_error)?;
        let mut archive = archive.into_inner().map_err(|e| e.into_error())?;
        archive.rewind()?;
        io::copy(&mut archive, &mut self.out)?;
        self.out.flush()
    }
}

impl<W: Write> Write for Packer<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.text.write(bytes)
    }

    /// Does nothing: [`Packer::finish`] writes.
    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// Writes the text with its head, and returns its sum.
fn write_text(
    zip: &mut ZipWriter<BufWriter<File>>,
    mut text: File,
    about: &About,
) -> io::Result<String> {
    let length = text.metadata()?.len();
    let mut first = Vec::new();
    text.rewind()?;
    Read::by_ref(&mut text).take(HEAD).read_to_end(&mut first)?;
    let end = memchr::memmem::find(&first, head::END.as_bytes());
    let blank = end.map_or(0, |at| at + head::END.len());
    text.seek(SeekFrom::Start(blank as u64))?;
    // Longer entries need other fields.
    let options = options().large_file(length > u64::from(u32::MAX / 2));
    zip.start_file(GCODE, options).map_err(io_error)?;
    let mut both = Summed {
        out: zip,
        sum: Md5::new(),
    };
    if blank > 0 {
        both.write_all(head::head(about).as_bytes())?;
    }
    io::copy(&mut BufReader::with_capacity(BUFFER, text), &mut both)?;
    Ok(hex(&both.sum.finalize()))
}

/// A sum as Bambu Studio writes it.
pub(super) fn hex(sum: &[u8]) -> String {
    sum.iter().map(|byte| format!("{byte:02X}")).collect()
}

/// Adds up what is written.
struct Summed<W> {
    out: W,
    sum: Md5,
}

impl<W: Write> Write for Summed<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let count = self.out.write(bytes)?;
        self.sum.update(&bytes[..count]);
        Ok(count)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}

fn write_entry(
    zip: &mut ZipWriter<BufWriter<File>>,
    name: &str,
    bytes: &[u8],
) -> io::Result<()> {
    zip.start_file(name, options()).map_err(io_error)?;
    zip.write_all(bytes)
}

/// Entries have no dates, so that equal input gives equal bytes.
fn options() -> SimpleFileOptions {
    SimpleFileOptions::default()
        .compression_method(CompressionMethod::Deflated)
        .last_modified_time(zip::DateTime::default())
}

fn io_error(error: ZipError) -> io::Error {
    match error {
        ZipError::Io(error) => error,
        other => io::Error::other(other),
    }
}
