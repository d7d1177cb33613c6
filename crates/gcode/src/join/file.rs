//! A file of a range of layers: what it says about itself, and its text, read
//! once from its beginning to its end.

use super::super::manifest::{LAST_LINE, LONGEST, Last, Manifest};
use super::super::progress::copy;
use super::super::{Format, Header, Thumbnail};
use super::error::JoinError;
use glam::DVec3;
use isoslice_base::limits;
use isoslice_gcode_read::bgcode::{self, Unpacked};
use isoslice_settings::{Builder, Settings};
use std::fs::File;
use std::io::{self, BufRead, BufReader, Read, Seek, SeekFrom, Write, sink};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::time::{Duration, UNIX_EPOCH};

/// Bytes that are read at a time.
const BUFFER: usize = 1 << 18;

#[derive(Debug)]
pub(super) struct RangeFile {
    pub path: PathBuf,
    pub manifest: Manifest,
    pub last: Last,
}

impl RangeFile {
    /// The settings of the print.
    pub(super) fn settings(&self) -> Result<Settings, JoinError> {
        let name = self.path.display().to_string();
        let mut builder = Builder::new();
        let read = builder
            .toml(&name, &self.manifest.print.settings)
            .and_then(|()| builder.finish());
        match read {
            Ok((settings, _)) => Ok(settings),
            Err(error) => {
                Err(JoinError::BadSettings(self.path.clone(), error.into()))
            }
        }
    }

    /// What templates may name of the print.
    pub(super) fn header(&self, format: Format) -> Header {
        let Manifest {
            layer_count, print, ..
        } = &self.manifest;
        let at = |s: u64| UNIX_EPOCH.checked_add(Duration::from_secs(s));
        Header {
            model_name: print.model_name.clone(),
            layer_count: *layer_count,
            layers: 0..*layer_count,
            timestamp: print.written.and_then(at),
            // The start template has been filled in.
            nozzle_temperature: 0.0,
            part_min: DVec3::from_array(print.part_min),
            part_max: DVec3::from_array(print.part_max),
            parts: Vec::new(),
            thumbnails: Vec::new(),
            format,
            fingerprint: None,
            one_by_one: false,
        }
    }

    /// Where the foot is, up to its template.
    pub(super) fn foot(&self) -> Range<u64> {
        let Manifest {
            head, texts, foot, ..
        } = &self.manifest;
        let start = texts.last().map_or(head.end, |text| text.end);
        start..foot.template
    }
}

/// A file's text.
#[derive(Debug)]
pub(super) struct Source {
    /// The text. That of a binary file is unpacked into a temporary file.
    text: File,
    pub format: Format,
}

impl Source {
    pub(super) fn open(path: &Path) -> Result<Source, JoinError> {
        let unread = |e| JoinError::Unread(path.to_owned(), e);
        let mut file = File::open(path).map_err(unread)?;
        let mut first = Vec::new();
        let magic = bgcode::MAGIC;
        (&mut file)
            .take(magic.len() as u64)
            .read_to_end(&mut first)
            .map_err(unread)?;
        file.rewind().map_err(unread)?;
        if first != magic {
            let format = Format::Text;
            return Ok(Source { text: file, format });
        }
        let mut text = tempfile::tempfile().map_err(unread)?;
        let file = BufReader::with_capacity(BUFFER, file);
        let unpacked = Unpacked::text_of(file);
        let mut unpacked = BufReader::with_capacity(BUFFER, unpacked);
        copy(&mut unpacked, u64::MAX, &mut text).map_err(unread)?;
        let format = Format::Binary;
        Ok(Source { text, format })
    }

    /// A piece of the text.
    pub(super) fn between(
        &mut self,
        path: &Path,
        place: Range<u64>,
    ) -> Result<Vec<u8>, JoinError> {
        let unread = |e| JoinError::Unread(path.to_owned(), e);
        let count = place.end.saturating_sub(place.start);
        let mut bytes = Vec::new();
        self.text
            .seek(SeekFrom::Start(place.start))
            .map_err(unread)?;
        (&mut self.text)
            .take(count)
            .read_to_end(&mut bytes)
            .map_err(unread)?;
        if bytes.len() as u64 == count {
            Ok(bytes)
        } else {
            Err(JoinError::Changed(path.to_owned()))
        }
    }

    /// What the last line says.
    pub(super) fn last(&mut self, path: &Path) -> Result<Last, JoinError> {
        let unread = |e| JoinError::Unread(path.to_owned(), e);
        let length = self.text.seek(SeekFrom::End(0)).map_err(unread)?;
        let start = length.saturating_sub(LAST_LINE);
        let end = self.between(path, start..length)?;
        Last::read(&end, length)
            .ok_or_else(|| JoinError::NoRange(path.to_owned()))
    }

    /// What the file says about itself.
    pub(super) fn manifest(
        &mut self,
        path: &Path,
        last: &Last,
    ) -> Result<Manifest, JoinError> {
        let changed = || JoinError::Changed(path.to_owned());
        let place = last.manifest.clone();
        if place.end - place.start > LONGEST {
            return Err(changed());
        }
        let lines = self.between(path, place)?;
        let lines = String::from_utf8(lines).map_err(|_| changed())?;
        let manifest = Manifest::read(&lines).ok_or_else(changed)?;
        if manifest.foot.template <= last.manifest.start {
            Ok(manifest)
        } else {
            Err(changed())
        }
    }
}

/// A file that is read from its beginning to its last line.
pub(super) struct Reading<'a> {
    file: &'a RangeFile,
    text: Summed<BufReader<File>>,
    at: u64,
}

impl<'a> Reading<'a> {
    pub(super) fn begin(file: &'a RangeFile) -> Result<Self, JoinError> {
        let unread = |e| JoinError::Unread(file.path.clone(), e);
        let Source { mut text, .. } = Source::open(&file.path)?;
        text.rewind().map_err(unread)?;
        Ok(Reading {
            file,
            text: Summed {
                inner: BufReader::with_capacity(BUFFER, text),
                sum: crc32fast::Hasher::new(),
            },
            at: 0,
        })
    }

    /// Copies the text up to a place.
    pub(super) fn pass(
        &mut self,
        to: u64,
        out: &mut impl Write,
    ) -> Result<(), JoinError> {
        let mut out = Told { out, failed: None };
        let left = copy(&mut self.text, to.saturating_sub(self.at), &mut out);
        if let Some(error) = out.failed {
            return Err(JoinError::Unwritten(error));
        }
        let path = || self.file.path.clone();
        if left.map_err(|e| JoinError::Unread(path(), e))? > 0 {
            return Err(JoinError::Changed(path()));
        }
        self.at = self.at.max(to);
        limits::go_on()?;
        Ok(())
    }

    pub(super) fn skip(&mut self, to: u64) -> Result<(), JoinError> {
        self.pass(to, &mut sink())
    }

    /// Reads what is left, and checks all that was read.
    pub(super) fn finish(mut self) -> Result<(), JoinError> {
        let Last { at, sum, .. } = self.file.last;
        self.skip(at)?;
        if self.text.sum.finalize() == sum {
            Ok(())
        } else {
            Err(JoinError::Changed(self.file.path.clone()))
        }
    }
}

/// Adds up a checksum of what is read.
struct Summed<R> {
    inner: R,
    sum: crc32fast::Hasher,
}

impl<R: BufRead> Read for Summed<R> {
    fn read(&mut self, out: &mut [u8]) -> io::Result<usize> {
        let n = self.fill_buf()?.read(out)?;
        self.consume(n);
        Ok(n)
    }
}

impl<R: BufRead> BufRead for Summed<R> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        self.inner.fill_buf()
    }

    fn consume(&mut self, n: usize) {
        // The buffer has been filled, so asking for it again costs nothing.
        if let Ok(ready) = self.inner.fill_buf() {
            self.sum.update(&ready[..n.min(ready.len())]);
        }
        self.inner.consume(n);
    }
}

/// Keeps the error of an output, so that it is not taken for an error of the
/// input.
struct Told<'a, W> {
    out: &'a mut W,
    failed: Option<io::Error>,
}

impl<W: Write> Write for Told<'_, W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.out.write(bytes).map_err(|error| {
            let kind = error.kind();
            self.failed = Some(error);
            kind.into()
        })
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}

/// The pictures of a binary file.
pub(super) fn pictures(path: &Path) -> Result<Vec<Thumbnail>, JoinError> {
    let unread = |e| JoinError::Unread(path.to_owned(), e);
    let file = File::open(path).map_err(unread)?;
    let mut file = BufReader::with_capacity(BUFFER, file);
    let all = bgcode::pictures(&mut file).map_err(unread)?;
    let all = all.into_iter();
    Ok(all.map(|(size, file)| Thumbnail { size, file }).collect())
}
