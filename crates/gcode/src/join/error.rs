//! Why files of ranges cannot be joined.

use super::super::{Format, TemplateError};
use isoslice_base::limits::Cancelled;
use isoslice_settings::SettingsError;
use std::io;
use std::path::PathBuf;

/// Why files cannot be joined.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum JoinError {
    /// There are no files.
    #[error("there are no files to join; name those of all ranges")]
    Nothing,
    /// The watch has stopped the work.
    #[error(transparent)]
    Stopped(#[from] Cancelled),
    /// A file cannot be read.
    #[error("cannot read {}: check its name", .0.display())]
    Unread(PathBuf, #[source] io::Error),
    /// A file does not end as one of a range.
    #[error(
        "{} does not end as the file of a range of layers: it is cut off, was \
         changed, or holds a whole part; slice its layers again, with \
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
         slice all ranges with the same model, settings and build of isoslice",
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
    BadSettings(PathBuf, #[source] Box<SettingsError>),
    /// A template cannot be filled in.
    #[error(transparent)]
    Template(#[from] TemplateError),
    /// The output cannot be written to.
    #[error("cannot write the G-code")]
    Unwritten(#[source] io::Error),
}

pub(super) fn kind(format: Format) -> &'static str {
    match format {
        Format::Text => "text",
        Format::Binary => "binary",
        Format::Plate => "a plate",
    }
}
