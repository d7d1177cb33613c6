//! From an archive to text.
//!
//! In: the bytes of an archive. Out: the text of its plate, byte by byte. The
//! archive's checksum and the MD5 sum beside the text are compared at its end.

use super::pack::hex;
use flate2::read::DeflateDecoder;
use isoslice_base::archive::Headers;
use md5::{Digest, Md5};
use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom, Take};
use zip::result::ZipError;
use zip::{CompressionMethod, ZipArchive};

/// Greatest length of an archive, bytes. Plates have some megabytes.
const LARGEST: u64 = 1 << 31;

/// Greatest number of entries. Plates have a dozen, and a few for each model.
const MOST_ENTRIES: usize = 10_000;

/// Greatest ratio of the text's length to its packed one, beyond
/// [`ALWAYS_UNPACKED`]: a few megabytes must not become gigabytes that take minutes
/// to read.
const LIKELY: u64 = 64;
/// A text that is no longer than this is unpacked whatever the ratio, bytes.
const ALWAYS_UNPACKED: u64 = 1 << 24;

/// Why there is no G-code in an archive.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Broken {
    /// The archive is longer than any plate.
    #[error("it is an archive of more than 2 GB")]
    TooLong,
    /// The file is no archive, or a damaged one.
    #[error("its archive is damaged ({0}); copy it again, or export it again")]
    Archive(String),
    /// There is no G-code in the archive.
    #[error(
        "it is an archive without G-code (Metadata/plate_1.gcode); slice the \
         plate, and export the sliced file (.gcode.3mf)"
    )]
    NoGcode,
    /// There are several plates in the archive.
    #[error(
        "there are {0} sliced plates in it; export them one by one, each as a \
         file of its own"
    )]
    Plates(usize),
    /// The text cannot be decompressed.
    #[error("its G-code is packed in an unknown way, or cut off")]
    Packed,
    /// The text claims to be longer than is likely.
    #[error("its G-code claims to be far longer than it is")]
    Bomb,
    /// Bytes have changed.
    #[error(
        "the checksum of its G-code is not that of its contents; copy it \
         again, or slice again"
    )]
    Checksum,
    /// The MD5 sum is not the text's, so the printer refuses the file.
    #[error(
        "the MD5 sum beside its G-code is not the text's, so that a printer \
         refuses it; slice again, or pack it again with the right sum"
    )]
    Sum,
}

impl From<Broken> for io::Error {
    fn from(why: Broken) -> io::Error {
        io::Error::new(io::ErrorKind::InvalidData, why)
    }
}

/// The text of a plate in an archive.
#[derive(Debug)]
pub(crate) struct Opened {
    text: Text,
    /// What is left of the length that the archive names.
    left: u64,
    crc: crc32fast::Hasher,
    expected: u32,
    md5: Md5,
    /// The sum beside the text, if there is one.
    sum: Option<String>,
    ended: bool,
}

#[derive(Debug)]
enum Text {
    Stored(Take<File>),
    Deflated(DeflateDecoder<Take<File>>),
}

impl Opened {
    /// Opens an archive, which is read to its end first.
    ///
    /// # Errors
    /// If the archive cannot be read, or does not hold exactly one plate.
    pub(crate) fn new(input: &mut dyn Read) -> io::Result<Opened> {
        let mut file = tempfile::tempfile()?;
        let (mut count, mut headers) = (0, Headers::default());
        let mut piece = vec![0; 1 << 18];
        loop {
            // A pipe may have no end.
            isoslice_base::limits::io_goes_on()?;
            let read = match input.read(&mut piece) {
                Err(e) if e.kind() == io::ErrorKind::Interrupted => continue,
                read => read?,
            };
            if read == 0 {
                break;
            }
            count += read as u64;
            if count > LARGEST {
                return Err(Broken::TooLong.into());
            }
            headers.see(&piece[..read]);
            if headers.count() > MOST_ENTRIES {
                let what = format!("more than {MOST_ENTRIES} entries");
                return Err(Broken::Archive(what).into());
            }
            io::Write::write_all(&mut file, &piece[..read])?;
        }
        let damaged = |e: ZipError| match e {
            ZipError::Io(e) => e,
            other => Broken::Archive(other.to_string()).into(),
        };
        file.rewind()?;
        let mut archive =
            ZipArchive::new(file.try_clone()?).map_err(|e| match e {
                // The end is not where it should be.
                ZipError::Io(e) => Broken::Archive(e.to_string()).into(),
                other => damaged(other),
            })?;
        let plates: Vec<String> = archive
            .file_names()
            .filter(|name| is_plate(name))
            .map(str::to_owned)
            .collect();
        let name = match plates.as_slice() {
            [] => return Err(Broken::NoGcode.into()),
            [name] => name,
            several => return Err(Broken::Plates(several.len()).into()),
        };
        let sum = match archive.by_name(&format!("{name}.md5")) {
            Ok(entry) => {
                let mut sum = String::new();
                // A sum has 32 characters.
                entry
                    .take(64)
                    .read_to_string(&mut sum)
                    .map_err(|_| io::Error::from(Broken::Sum))?;
                Some(sum.trim().to_ascii_uppercase())
            }
            Err(ZipError::FileNotFound) => None,
            Err(e) => return Err(damaged(e)),
        };
        let entry = archive.by_name(name).map_err(damaged)?;
        let (packed, length) = (entry.compressed_size(), entry.size());
        if length
            > packed
                .saturating_mul(LIKELY)
                .saturating_add(ALWAYS_UNPACKED)
        {
            return Err(Broken::Bomb.into());
        }
        let method = entry.compression();
        let (start, expected) = (entry.data_start(), entry.crc32());
        let start = start.ok_or(Broken::Packed)?;
        drop(entry);
        drop(archive);
        file.seek(SeekFrom::Start(start))?;
        let bytes = file.take(packed);
        let text = match method {
            CompressionMethod::Stored => Text::Stored(bytes),
            CompressionMethod::Deflated => {
                Text::Deflated(DeflateDecoder::new(bytes))
            }
            _ => return Err(Broken::Packed.into()),
        };
        Ok(Opened {
            text,
            left: length,
            crc: crc32fast::Hasher::new(),
            expected,
            md5: Md5::new(),
            sum,
            ended: false,
        })
    }

    /// Compares the sums, once all has been read.
    fn end(&mut self) -> io::Result<()> {
        self.ended = true;
        if self.left > 0 {
            return Err(Broken::Packed.into());
        }
        if self.crc.clone().finalize() != self.expected {
            return Err(Broken::Checksum.into());
        }
        let md5 = hex(&self.md5.clone().finalize());
        match &self.sum {
            Some(sum) if *sum != md5 => Err(Broken::Sum.into()),
            _ => Ok(()),
        }
    }
}

impl Read for Opened {
    fn read(&mut self, out: &mut [u8]) -> io::Result<usize> {
        if out.is_empty() || self.ended {
            return Ok(0);
        }
        let read = match &mut self.text {
            Text::Stored(bytes) => bytes.read(out),
            Text::Deflated(bytes) => bytes.read(out),
        };
        let count = match read {
            Err(e) if e.kind() == io::ErrorKind::Interrupted => return Err(e),
            Err(_) => return Err(Broken::Packed.into()),
            Ok(count) => count,
        };
        if count == 0 {
            self.end()?;
            return Ok(0);
        }
        if count as u64 > self.left {
            return Err(Broken::Bomb.into());
        }
        self.left -= count as u64;
        self.crc.update(&out[..count]);
        self.md5.update(&out[..count]);
        Ok(count)
    }
}

/// True for `Metadata/plate_1.gcode`, and with other numbers.
fn is_plate(name: &str) -> bool {
    let number = name
        .strip_prefix("Metadata/plate_")
        .and_then(|rest| rest.strip_suffix(".gcode"));
    number
        .is_some_and(|n| !n.is_empty() && n.bytes().all(|b| b.is_ascii_digit()))
}
