//! Where settings were given, and why settings are refused.

use isoslice_base::files::FileError;
use std::collections::BTreeMap;
use std::fmt;
use std::path::PathBuf;

/// Where a setting was given.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum GivenIn {
    /// The setting was given in a file.
    File {
        /// The file's name as it was given.
        name: String,
        /// Line in the file, from 1.
        line: usize,
    },
    /// The setting was given in a profile.
    Profile {
        /// The profile's file, in messages.
        name: String,
        /// Line in the profile, from 1.
        line: usize,
    },
    /// The setting was given as an assignment on the command line.
    Set,
}

impl fmt::Display for GivenIn {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            GivenIn::File { name, line } | GivenIn::Profile { name, line } => {
                write!(f, "{name}:{line}")
            }
            GivenIn::Set => f.write_str("--set"),
        }
    }
}

impl GivenIn {
    /// True if the value was given for this print, and does not come from a
    /// profile.
    pub(super) fn is_given(&self) -> bool {
        matches!(self, GivenIn::File { .. } | GivenIn::Set)
    }
}

/// The place of each setting that was given.
pub(super) type GivenPlaces = BTreeMap<&'static str, GivenIn>;

/// Why there are no settings.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SettingsError {
    /// A file cannot be read.
    #[error(
        "cannot read the settings file {}: check its name, and that it is a \
         readable text file",
        path.display()
    )]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// What the system says.
        #[source]
        cause: std::io::Error,
    },
    /// A file cannot hold settings.
    #[error(
        "{} cannot be a file of settings: {cause}; give one as `isoslice \
         settings` prints it",
        path.display()
    )]
    NoSettings {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        cause: FileError,
    },
    /// A file is not TOML.
    #[error(
        "{place}: {message}{hint}; the file must be TOML, as `isoslice \
         settings` prints it"
    )]
    NotToml {
        /// Where the mistake is.
        place: GivenIn,
        /// What the parser says.
        message: String,
        /// What to write instead, if that is known.
        hint: String,
    },
    /// An assignment without a key or an equals sign.
    #[error("--set {given}: write it as key=value, as in layer_height=0.15")]
    NotAnAssignment {
        /// The assignment.
        given: String,
    },
    /// There is no such setting.
    #[error("{place}: there is no setting {key:?}; {hint}")]
    UnknownKey {
        /// Where the key was given.
        place: GivenIn,
        /// The key.
        key: String,
        /// What to write instead.
        hint: String,
    },
    /// A group is given a value as if it were a setting.
    #[error(
        "{place}: {key} is a group of settings, not a setting; write for \
         example {example} = {value}"
    )]
    Group {
        /// Where the group was given a value.
        place: GivenIn,
        /// The group.
        key: String,
        /// A setting of the group, to show how one is written.
        example: String,
        /// A value for it, which turns something on where the default does not.
        value: String,
    },
    /// There is no such profile.
    #[error("{place}: there is no {kind} profile {name:?}; {hint}")]
    UnknownProfile {
        /// Where it was named.
        place: String,
        /// The kind of the profile.
        kind: &'static str,
        /// The name.
        name: String,
        /// What to write instead.
        hint: String,
    },
    /// A profile inherits from itself.
    #[error(
        "{place}: profiles inherit in a circle: {names}; let one of them \
         inherit from another, or from none"
    )]
    Circle {
        /// Where the circle is closed.
        place: GivenIn,
        /// The profiles.
        names: String,
    },
    /// Too many profiles inherit from one another in a row.
    #[error(
        "{place}: more than {most} profiles inherit from one another, from \
         {first} on; let some of them be one"
    )]
    TooDeep {
        /// Where the last of these profiles is named.
        place: GivenIn,
        /// Greatest number of profiles of which each inherits from the next.
        most: usize,
        /// The first of these profiles, and what it inherits.
        first: String,
    },
    /// A value is of the wrong type.
    #[error("{place}: {key} = {value} is not understood; write {expected}")]
    WrongType {
        /// Where the value was given.
        place: GivenIn,
        /// The key.
        key: String,
        /// The value.
        value: String,
        /// What the setting takes.
        expected: String,
    },
    /// A number is outside its range.
    #[error("{place}: {key} = {value} is out of range; use {allowed}")]
    OutOfRange {
        /// Where the value was given.
        place: GivenIn,
        /// The key.
        key: String,
        /// The value.
        value: String,
        /// The range.
        allowed: String,
    },
    /// Settings that are each allowed do not work together.
    #[error("{message}{places}")]
    Conflict {
        /// The keys and values, why they do not work, and the remedy.
        message: String,
        /// Where the values come from; empty if no place is known.
        places: String,
    },
}
