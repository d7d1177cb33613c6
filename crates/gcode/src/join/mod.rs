//! Joins the files of all ranges of a part's layers into one file.
//!
//! In: files of ranges, in any order. Out: the file that a single run would have
//! written.
//!
//! ```text
//! 1 to 512     head ─ layers ─ foot   manifest
//! 513 to 1024  head ─ layers ─ foot   manifest
//!               │       │        └ with the totals of all layers
//!               │       └ of each file, with lines that tell the progress
//!               └ of the first file, without what it says about its range
//! ```
//!
//! Guaranteed: the bytes are those of a single run of the same version; files of
//! other models, settings, versions or layers, gaps, overlaps, and files that
//! are cut off or were changed are errors. The layers' texts pass through a
//! buffer: memory holds the manifests, some 100 bytes for each layer and 30 for
//! each second of the print. Not guaranteed: that the output was not begun when a
//! changed file is noticed, since each file is copied in one pass.

mod error;
mod file;

pub use error::JoinError;

use super::ends::{self, Said};
use super::manifest::Head;
use super::progress::{Rhythm, line_at};
use super::sink::Sink;
use super::template::Templates;
use super::{Format, Totals, WriterPlan, facts};
use file::{RangeFile, Reading, Source, pictures};
use isoslice_base::limits;
use isoslice_base::units::{Mm, Seconds};
use isoslice_gcode_read::package;
use std::io::Write;
use std::path::PathBuf;

/// The result of joining files.
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

impl Ranges {
    /// Looks at files, which may come in any order, since each says which
    /// layers it has.
    ///
    /// # Errors
    /// If they are not the files of all ranges of one print.
    pub fn open(paths: &[PathBuf]) -> Result<Ranges, JoinError> {
        let mut files = Vec::new();
        let mut formats = Vec::new();
        for path in paths {
            limits::go_on()?;
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
        let plan = WriterPlan::of(&settings);
        let tells = plan.tells_progress;
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
        let templates = Templates::new(&plan, &header)?;
        let before = &last.manifest.foot.before;
        let end = ends::end(&mut totals, &templates, &plan, before, &foot)?;

        let written = JoinError::Unwritten;
        let mut out = Sink::new(out, self.format).map_err(written)?;
        let flavour = plan.flavour;
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
        let facts = facts::facts(&plan, &totals);
        let footer = match self.format {
            Format::Binary => String::new(),
            Format::Text | Format::Plate => {
                ends::footer(&plan, &totals, &facts)
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
