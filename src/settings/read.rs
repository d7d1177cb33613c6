//! Reading settings: files and assignments, layered in the order given.
//!
//! In: TOML text or `key=value`. Out: [`Settings`], and for each that was
//! given the [`Place`] where, so that an error found only when all is known
//! can still point to it.

use super::check::{self, Conflict};
use super::table::{self, Key};
use super::value::{Raw, Refused};
use super::{Settings, keys};
use std::collections::BTreeMap;
use std::fmt;
use std::ops::Range;
use std::path::{Path, PathBuf};
use toml::de::{DeTable, DeValue};

/// Where a setting was given.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Place {
    /// In a file.
    File {
        /// The file's name as it was given.
        name: String,
        /// Line, from 1.
        line: usize,
    },
    /// As an assignment on the command line.
    Set,
    /// In a program that uses the library.
    Program,
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Place::File { name, line } => write!(f, "{name}:{line}"),
            Place::Set => f.write_str("--set"),
            Place::Program => f.write_str("settings"),
        }
    }
}

/// Why there are no settings.
#[derive(Debug, thiserror::Error)]
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
    /// A file is not TOML.
    #[error(
        "{place}: {message}; the file must be TOML, as `isoslice settings` \
         prints it"
    )]
    NotToml {
        /// Where.
        place: Place,
        /// What the parser says.
        message: String,
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
        /// Where.
        place: Place,
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
        /// Where.
        place: Place,
        /// The group.
        key: String,
        /// The group's first key.
        example: String,
        /// That key's default.
        value: String,
    },
    /// A value is of the wrong type.
    #[error("{place}: {key} = {value} is not understood; write {expected}")]
    WrongType {
        /// Where.
        place: Place,
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
        /// Where.
        place: Place,
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
        /// Where the values come from, empty if nowhere known.
        places: String,
    },
}

/// Gathers settings from several places; what comes later wins.
#[derive(Clone, Debug, Default)]
pub struct Builder {
    settings: Settings,
    places: BTreeMap<&'static str, Place>,
}

impl Builder {
    /// Starts from the defaults.
    pub fn new() -> Self {
        Self::default()
    }

    /// Takes over what a TOML file says.
    ///
    /// # Errors
    /// If the file cannot be read, or as [`Builder::toml`].
    pub fn file(&mut self, path: &Path) -> Result<(), SettingsError> {
        let text = std::fs::read_to_string(path).map_err(|cause| {
            SettingsError::Unreadable {
                path: path.to_owned(),
                cause,
            }
        })?;
        self.toml(&path.display().to_string(), &text)
    }

    /// Takes over what TOML `text` says; `name` is the file's in messages.
    ///
    /// # Errors
    /// If it is not TOML, has an unknown key, or a value is of the wrong type
    /// or out of range: the first such place in the file. What came before it
    /// has been taken over then.
    pub fn toml(
        &mut self,
        name: &str,
        text: &str,
    ) -> Result<(), SettingsError> {
        // Templates that were edited on Windows must give the same G-code.
        let text = &text.replace("\r\n", "\n");
        let place = |span: Range<usize>| Place::File {
            name: name.to_owned(),
            line: line_of(text, span.start),
        };
        let table =
            DeTable::parse(text).map_err(|e| SettingsError::NotToml {
                // Without a span the file as a whole is meant.
                place: place(e.span().unwrap_or(0..0)),
                message: e.message().replace('\n', ", "),
            })?;
        let mut entries = Vec::new();
        flatten("", table.get_ref(), &mut entries);
        // The parser sorts keys by name; messages follow the file.
        entries.sort_by_key(|entry| entry.key_span.start);
        for entry in entries {
            match entry.value {
                Ok(raw) => {
                    let span = if table::find(&entry.key).is_some() {
                        entry.value_span
                    } else {
                        entry.key_span
                    };
                    self.assign(&entry.key, raw, place(span))?;
                }
                Err(hint) => {
                    return Err(SettingsError::UnknownKey {
                        place: place(entry.key_span),
                        key: entry.key,
                        hint,
                    });
                }
            }
        }
        Ok(())
    }

    /// Takes over one `key=value`. The value is read as the key's type asks:
    /// text needs no quotes, but within double quotes escapes such as `\n`
    /// are understood.
    ///
    /// # Errors
    /// If there is no such key, or its value is of the wrong type or out of
    /// range.
    pub fn set(&mut self, assignment: &str) -> Result<(), SettingsError> {
        let malformed = || SettingsError::NotAnAssignment {
            given: assignment.to_owned(),
        };
        let (key, value) = assignment.split_once('=').ok_or_else(malformed)?;
        let (key, value) = (key.trim(), value.trim());
        if key.is_empty() {
            return Err(malformed());
        }
        if value.len() > 1 && value.starts_with('"') && value.ends_with('"') {
            let parsed =
                DeValue::parse(value).map_err(|_| malformed())?.into_inner();
            return self.assign(key, raw(&parsed), Place::Set);
        }
        self.assign(key, Raw::Word(value), Place::Set)
    }

    /// What has been gathered so far; not yet checked for combinations.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// The settings, and warnings about unwise combinations.
    ///
    /// # Errors
    /// As [`Settings::validate`], with the places of the values.
    pub fn finish(self) -> Result<(Settings, Vec<String>), SettingsError> {
        let warnings = check::conflicts(&self.settings)
            .map_err(|conflict| conflict.into_error(&self.places))?;
        Ok((self.settings, warnings))
    }

    fn assign(
        &mut self,
        name: &str,
        raw: Raw<'_>,
        place: Place,
    ) -> Result<(), SettingsError> {
        let Some(key) = table::find(name) else {
            return Err(unknown(name, place));
        };
        (key.field_mut)(&mut self.settings)
            .assign(raw, key)
            .map_err(|refused| refusal(refused, key, raw, place.clone()))?;
        self.places.insert(key.name, place);
        Ok(())
    }
}

impl Settings {
    /// Checks every value's range, and that the values work together. Returns
    /// warnings about combinations that are allowed but unwise.
    ///
    /// # Errors
    /// The first value that is out of range or at odds with another.
    pub fn validate(&self) -> Result<Vec<String>, SettingsError> {
        for key in keys() {
            let Some(number) = (key.field)(self).number() else {
                continue;
            };
            if key.range.is_some_and(|range| !range.contains(number)) {
                let raw = Raw::Float(number);
                let place = Place::Program;
                return Err(refusal(Refused::Range, key, raw, place));
            }
        }
        check::conflicts(self)
            .map_err(|conflict| conflict.into_error(&BTreeMap::new()))
    }
}

impl Conflict {
    fn into_error(
        self,
        places: &BTreeMap<&'static str, Place>,
    ) -> SettingsError {
        let known: Vec<String> = self
            .keys
            .iter()
            .filter_map(|key| {
                places.get(key).map(|place| format!("{key} from {place}"))
            })
            .collect();
        SettingsError::Conflict {
            message: self.message,
            places: if known.is_empty() {
                String::new()
            } else {
                format!(" ({})", known.join(", "))
            },
        }
    }
}

fn unknown(name: &str, place: Place) -> SettingsError {
    if table::is_group(name) {
        let first = keys().iter().find(|key| key.group() == name);
        return SettingsError::Group {
            place,
            key: name.to_owned(),
            example: first.map_or("", |key| key.name).to_owned(),
            value: first.map_or_else(String::new, Key::default),
        };
    }
    SettingsError::UnknownKey {
        place,
        key: name.to_owned(),
        hint: hint(name),
    }
}

fn hint(name: &str) -> String {
    match table::nearest(name) {
        Some(near) => format!("did you mean {near}?"),
        None => "`isoslice settings` lists them all".to_owned(),
    }
}

fn refusal(
    refused: Refused,
    key: &Key,
    raw: Raw<'_>,
    place: Place,
) -> SettingsError {
    let value = raw.describe();
    match refused {
        Refused::Type => SettingsError::WrongType {
            place,
            key: key.name.to_owned(),
            value,
            expected: key.expected(),
        },
        Refused::Range => SettingsError::OutOfRange {
            place,
            key: key.name.to_owned(),
            value,
            allowed: key.allowed(),
        },
    }
}

/// One `key = value` of a file. A key that can be none, whatever the table
/// says, has its hint in place of the value.
struct Entry<'a> {
    key: String,
    value: Result<Raw<'a>, String>,
    key_span: Range<usize>,
    value_span: Range<usize>,
}

/// Lists the values of a table with their full names.
fn flatten<'a>(
    prefix: &str,
    table: &'a DeTable<'_>,
    entries: &mut Vec<Entry<'a>>,
) {
    for (key, value) in table {
        let name = format!("{prefix}{}", key.get_ref());
        let known = table::find(&name).is_some();
        let value_span = value.span();
        let value = match value.get_ref() {
            // Else "speed.travel" in quotes would be speed.travel, and
            // might be given twice in one file.
            _ if key.get_ref().contains('.') => {
                Err(format!("write {name} without quotes"))
            }
            DeValue::Table(inner) if table::is_group(&name) => {
                flatten(&format!("{name}."), inner, entries);
                continue;
            }
            // The unknown setting is likelier to be in it than the table
            // itself to be what was meant, but an empty one must not pass.
            DeValue::Table(inner) if !known && !inner.is_empty() => {
                flatten(&format!("{name}."), inner, entries);
                continue;
            }
            value => Ok(raw(value)),
        };
        entries.push(Entry {
            key: name,
            value,
            key_span: key.span(),
            value_span,
        });
    }
}

fn raw<'a>(value: &'a DeValue<'_>) -> Raw<'a> {
    match value {
        DeValue::Integer(i) => i64::from_str_radix(i.as_str(), i.radix())
            .map_or(Raw::Huge(i.as_str()), Raw::Integer),
        DeValue::Float(x) => {
            x.as_str().parse().map_or(Raw::Float(f64::NAN), Raw::Float)
        }
        DeValue::Boolean(b) => Raw::Bool(*b),
        DeValue::String(s) => Raw::Text(s),
        DeValue::Datetime(_) => Raw::Other("a date"),
        DeValue::Array(_) => Raw::Other("a list"),
        DeValue::Table(_) => Raw::Other("a table"),
    }
}

/// Line, from 1, of a byte of `text`.
fn line_of(text: &str, byte: usize) -> usize {
    1 + text.bytes().take(byte).filter(|b| *b == b'\n').count()
}
