//! One file of the files of all ranges of a part's layers.
//!
//! In: files of ranges, in any order. Out: the file that a single run would have
//! written.
//!
//! ```text
//! 1 to 512     head ─ layers ─ foot   manifest
//! 513 to 1024  head ─ layers ─ foot   manifest
//!               │       │        └ with the totals of all layers
//!               │       └ of each file, with lines that tell the progress
//!               └ of the first file, without what it says of its range
//! ```
//!
//! Guaranteed: the bytes are those of a single run of the same version; files of
//! other models, settings, versions or layers, gaps, overlaps, and files that
//! are cut off or were changed are errors. The layers' texts pass through a
//! buffer: memory holds the manifests, some 100 bytes for each layer and 30 for
//! each second of the print. Not guaranteed: that the output was not begun when a
//! changed file is noticed, since each file is copied in one pass.

use super::ends::{self, Said};
use super::manifest::{Head, LAST_LINE, LONGEST, Last, Manifest};
use super::progress::{Rhythm, copy, line_at, tells_progress};
use super::sink::Sink;
use super::template::Templates;
use super::{Format, Header, TemplateError, Thumbnail, Totals, facts};
use crate::bgcode::{self, Unpacked};
use crate::limits;
use crate::package;
use crate::settings::{Builder, Settings, SettingsError};
use crate::units::{Mm, Seconds};
use glam::DVec3;
use std::fs::File;
use std::io::{self, BufRead, BufReader, Read, Seek, SeekFrom, Write, sink};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::time::{Duration, UNIX_EPOCH};

/// Bytes that are read at a time.
const BUFFER: usize = 1 << 18;

/// Why files cannot be joined.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum JoinError {
    /// There are no files.
    #[error("there are no files to join; name those of all ranges")]
    Nothing,
    /// A file cannot be read.
    #[error("cannot read {}: check its name", .0.display())]
    Unread(PathBuf, #[source] io::Error),
    /// A file does not end as one of a range.
    #[error(
        "{} does not end as the file of a range of layers: it is cut off, was \
         changed, or has a whole part; slice its layers again, with \
         `isoslice slice --layers A..B`",
        .0.display()
    )]
    NoRange(PathBuf),
    /// A file was changed.
    #[error(
        "{} was changed after it was written: its text and its checksum do not \
         agree; copy it again, or slice its layers again",
        .0.display()
    )]
    Changed(PathBuf),
    /// Files are of different prints.
    #[error(
        "{} and {} are not ranges of one print: they are of another {what}; \
         slice all ranges with the same model, settings and version of isoslice",
        .one.display(), .other.display()
    )]
    Differs {
        /// A file.
        one: PathBuf,
        /// A file that differs from the first one.
        other: PathBuf,
        /// In what the files differ.
        what: &'static str,
    },
    /// Files are text and binary.
    #[error(
        "{} is {} and {} is not; write all ranges as .gcode, or all as .bgcode",
        .one.display(), kind(*.format), .other.display()
    )]
    Formats {
        /// A file.
        one: PathBuf,
        /// The format of that file.
        format: Format,
        /// A file of the other kind.
        other: PathBuf,
    },
    /// Layers are missing.
    #[error(
        "layers {first} to {last} of {count} are missing{}; slice them with \
         `isoslice slice --layers {first}..{last}`",
        match .after {
            Some(path) => format!(", after {}", path.display()),
            None => String::new(),
        }
    )]
    Gap {
        /// The first missing layer, from 1.
        first: usize,
        /// The last missing layer before the next file.
        last: usize,
        /// Number of the part's layers.
        count: usize,
        /// The file before the gap.
        after: Option<PathBuf>,
    },
    /// Layers are there twice.
    #[error(
        "layers {first} to {last} are in {} and in {}; leave one of them out, \
         or slice ranges that do not overlap",
        .one.display(), .other.display()
    )]
    Overlap {
        /// The first layer that is there twice, from 1.
        first: usize,
        /// The last layer that is there twice.
        last: usize,
        /// A file that has these layers.
        one: PathBuf,
        /// The other file that has these layers.
        other: PathBuf,
    },
    /// The settings in a file do not read back.
    #[error("the settings in {} cannot be used", .0.display())]
    Settings(PathBuf, #[source] Box<SettingsError>),
    /// A template cannot be filled in.
    #[error(transparent)]
    Template(#[from] TemplateError),
    /// The output cannot be written to.
    #[error("cannot write the G-code")]
    Unwritten(#[source] io::Error),
}

fn kind(format: Format) -> &'static str {
    match format {
        Format::Text => "text",
        Format::Binary => "binary",
        Format::Plate => "a plate",
    }
}

/// What came of joining.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Joined {
    /// Number of files.
    pub files: usize,
    /// Number of layers.
    pub layers: usize,
    /// Estimated print time, without heating and homing.
    pub time: Seconds,
    /// Filament used.
    pub filament_length: Mm,
    /// Filament used, grams.
    pub filament_mass_g: f64,
}

/// The files of all ranges of a part's layers, from the bed up.
#[derive(Debug)]
pub struct Ranges {
    format: Format,
    files: Vec<RangeFile>,
}

#[derive(Debug)]
struct RangeFile {
    path: PathBuf,
    manifest: Manifest,
    last: Last,
}

impl Ranges {
    /// Looks at files, which may come in any order: each says which layers it
    /// has.
    ///
    /// # Errors
    /// If they are not the files of all ranges of one print.
    pub fn open(paths: &[PathBuf]) -> Result<Ranges, JoinError> {
        let mut files = Vec::new();
        let mut formats = Vec::new();
        for path in paths {
            limits::check();
            let mut source = Source::open(path)?;
            let last = source.last(path)?;
            let manifest = source.manifest(path, &last)?;
            formats.push(source.format);
            let path = path.clone();
            files.push(RangeFile {
                path,
                manifest,
                last,
            });
        }
        let (Some(first), Some(&format)) = (files.first(), formats.first())
        else {
            return Err(JoinError::Nothing);
        };
        for (file, &other) in files.iter().zip(&formats) {
            if other != format {
                return Err(JoinError::Formats {
                    one: first.path.clone(),
                    format,
                    other: file.path.clone(),
                });
            }
            let fingerprint = &first.manifest.fingerprint;
            let found = &file.manifest.fingerprint;
            if let Some(what) = fingerprint.difference(found) {
                return Err(JoinError::Differs {
                    one: first.path.clone(),
                    other: file.path.clone(),
                    what,
                });
            }
        }
        files.sort_by_key(|file| file.manifest.layers.start);
        check_layers(&files)?;
        Ok(Ranges { format, files })
    }

    /// What the files are, and what the joined file will be.
    pub fn format(&self) -> Format {
        self.format
    }

    /// Writes the joined file.
    ///
    /// # Errors
    /// If a file was changed or cannot be read, or the output cannot be written.
    pub fn join(&self, out: &mut dyn Write) -> Result<Joined, JoinError> {
        let (Some(first), Some(last)) = (self.files.first(), self.files.last())
        else {
            return Err(JoinError::Nothing);
        };
        let settings = last.settings()?;
        let mut totals = Totals {
            time: first.manifest.head.time,
            ..Totals::default()
        };
        let tells = tells_progress(&settings);
        let mut rhythm = Rhythm::default();
        let mut marks: Vec<Vec<(u64, Seconds)>> = Vec::new();
        for file in &self.files {
            let mut of_file = Vec::new();
            file.manifest.add(&mut totals, |at, time| {
                if tells && rhythm.is_due(time) {
                    of_file.push((at, time));
                }
            });
            marks.push(of_file);
        }
        let mut source = Source::open(&last.path)?;
        let foot = source.between(&last.path, last.foot())?;
        let header = last.header(self.format);
        let templates = Templates::new(&settings, &header)?;
        let before = &last.manifest.foot.before;
        let end = ends::end(&mut totals, &templates, &settings, before, &foot)?;

        let written = JoinError::Unwritten;
        let mut out = Sink::new(out, self.format).map_err(written)?;
        let flavour = settings.gcode.flavour;
        let line = |time| {
            if tells {
                line_at(flavour, time, totals.time)
            } else {
                String::new()
            }
        };
        for (file, marks) in self.files.iter().zip(marks) {
            let mut reading = Reading::begin(file)?;
            let Head {
                own,
                count,
                mark,
                end,
                ..
            } = &file.manifest.head;
            if std::ptr::eq(file, first) {
                reading.pass(own.start, &mut out)?;
                reading.skip(own.end)?;
                if let Some(count) = count {
                    reading.pass(count.start, &mut out)?;
                    reading.skip(count.end)?;
                    let line = ends::layer_count(totals.layers);
                    writeln!(out, "{line}").map_err(written)?;
                }
                reading.pass(*mark, &mut out)?;
                out.write_all(line(0.0).as_bytes()).map_err(written)?;
                reading.pass(*end, &mut out)?;
            } else {
                reading.skip(*end)?;
            }
            for (at, time) in marks {
                reading.pass(at, &mut out)?;
                out.write_all(line(time).as_bytes()).map_err(written)?;
            }
            reading.pass(file.foot().start, &mut out)?;
            reading.finish()?;
        }
        let facts = facts::facts(&settings, &totals);
        let footer = match self.format {
            Format::Binary => String::new(),
            Format::Text | Format::Plate => {
                ends::footer(&settings, &totals, &facts)
            }
        };
        let whole = line(totals.time);
        for text in [&foot, end.as_bytes(), whole.as_bytes()] {
            out.write_all(text).map_err(written)?;
        }
        out.write_all(footer.as_bytes()).map_err(written)?;
        let said = match self.format {
            // Ranges are not written into plates.
            Format::Text | Format::Plate => None,
            Format::Binary => Some(Said {
                at: header.timestamp,
                thumbnails: pictures(&first.path)?,
                parts: Vec::new(),
                one_by_one: false,
            }),
        };
        let about = || ends::about(said, &facts);
        out.finish(about, package::About::default)
            .map_err(written)?;
        Ok(Joined {
            files: self.files.len(),
            layers: totals.layers,
            time: totals.time,
            filament_length: totals.filament_length,
            filament_mass_g: totals.filament_mass_g,
        })
    }
}

/// Checks that files, in their order, have every layer once.
fn check_layers(files: &[RangeFile]) -> Result<(), JoinError> {
    let Some(count) = files.first().map(|f| f.manifest.layer_count) else {
        return Ok(());
    };
    let mut before: Option<&RangeFile> = None;
    let mut next = 0;
    let gap =
        |next: usize, end: usize, before: Option<&RangeFile>| JoinError::Gap {
            first: next + 1,
            last: end,
            count,
            after: before.map(|file| file.path.clone()),
        };
    for file in files {
        let layers = &file.manifest.layers;
        if let Some(before) = before.filter(|_| layers.start < next) {
            return Err(JoinError::Overlap {
                first: layers.start + 1,
                last: next.min(layers.end),
                one: before.path.clone(),
                other: file.path.clone(),
            });
        }
        if layers.start > next {
            return Err(gap(next, layers.start, before));
        }
        next = layers.end;
        before = Some(file);
    }
    if next < count {
        Err(gap(next, count, before))
    } else {
        Ok(())
    }
}

impl RangeFile {
    /// The settings of the print.
    fn settings(&self) -> Result<Settings, JoinError> {
        let name = self.path.display().to_string();
        let mut builder = Builder::new();
        let read = builder
            .toml(&name, &self.manifest.print.settings)
            .and_then(|()| builder.finish());
        match read {
            Ok((settings, _)) => Ok(settings),
            Err(error) => {
                Err(JoinError::Settings(self.path.clone(), error.into()))
            }
        }
    }

    /// What templates may name of the print.
    fn header(&self, format: Format) -> Header {
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
    fn foot(&self) -> Range<u64> {
        let Manifest {
            head, texts, foot, ..
        } = &self.manifest;
        let start = texts.last().map_or(head.end, |text| text.end);
        start..foot.template
    }
}

/// A file's text.
#[derive(Debug)]
struct Source {
    /// The text. That of a binary file is unpacked into a temporary file.
    text: File,
    format: Format,
}

impl Source {
    fn open(path: &Path) -> Result<Source, JoinError> {
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
    fn between(
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
    fn last(&mut self, path: &Path) -> Result<Last, JoinError> {
        let unread = |e| JoinError::Unread(path.to_owned(), e);
        let length = self.text.seek(SeekFrom::End(0)).map_err(unread)?;
        let start = length.saturating_sub(LAST_LINE);
        let end = self.between(path, start..length)?;
        Last::read(&end, length)
            .ok_or_else(|| JoinError::NoRange(path.to_owned()))
    }

    /// What the file says of itself.
    fn manifest(
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
struct Reading<'a> {
    file: &'a RangeFile,
    text: Summed<BufReader<File>>,
    at: u64,
}

impl<'a> Reading<'a> {
    fn begin(file: &'a RangeFile) -> Result<Self, JoinError> {
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
    fn pass(&mut self, to: u64, out: &mut impl Write) -> Result<(), JoinError> {
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
        limits::check();
        Ok(())
    }

    fn skip(&mut self, to: u64) -> Result<(), JoinError> {
        self.pass(to, &mut sink())
    }

    /// Reads what is left, and checks all that was read.
    fn finish(mut self) -> Result<(), JoinError> {
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
fn pictures(path: &Path) -> Result<Vec<Thumbnail>, JoinError> {
    let unread = |e| JoinError::Unread(path.to_owned(), e);
    let file = File::open(path).map_err(unread)?;
    let mut file = BufReader::with_capacity(BUFFER, file);
    let all = bgcode::pictures(&mut file).map_err(unread)?;
    let all = all.into_iter();
    Ok(all.map(|(size, file)| Thumbnail { size, file }).collect())
}
