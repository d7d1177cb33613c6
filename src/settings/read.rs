//! Reading settings: files and assignments, layered in the order given.
//!
//! In: TOML text or `key=value`. Out: [`Settings`], and for each that was
//! given the [`Place`] where, so that an error found only when all is known
//! can still point to it.

use super::check::{self, Conflict};
use super::error::{Place, SettingsError};
use super::profile::{Profile, ProfileKind, Profiles};
use super::table::{self, Key};
use super::value::{Raw, Refused};
use super::{Settings, keys};
use crate::files::{self, FileError, MAX_SETTINGS_BYTES};
use std::collections::BTreeMap;
use std::ops::Range;
use std::path::Path;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Where each setting that was given was given.
pub(super) type Places = BTreeMap<&'static str, Place>;

/// What a profile has besides settings.
const HEAD: [&str; 2] = ["description", "inherits"];

/// Gathers settings from several places; what comes later wins.
#[derive(Clone, Debug, Default)]
pub struct Builder {
    settings: Settings,
    places: Places,
    /// Old names of settings that were used, as warnings.
    renamed: Vec<String>,
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
        let text = text_of(path)?;
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
        let name = name.to_owned();
        self.take_over(text, &[], |line| Place::File {
            name: name.clone(),
            line,
        })
    }

    /// Takes over a profile, after those that it inherits from, and returns
    /// them in that order.
    ///
    /// # Errors
    /// If it, or one that it inherits from, does not exist, or as
    /// [`Builder::toml`].
    pub fn profile(
        &mut self,
        profiles: &Profiles,
        kind: ProfileKind,
        name: &str,
    ) -> Result<Vec<Profile>, SettingsError> {
        let chain = profiles.chain(kind, name)?;
        for profile in &chain {
            let name = profile.file();
            self.take_over(&profile.text, &HEAD, |line| Place::Profile {
                name: name.clone(),
                line,
            })?;
        }
        Ok(chain)
    }

    /// Takes over `text` except for the keys in `skip`; `place` tells a line's
    /// place.
    fn take_over(
        &mut self,
        text: &str,
        skip: &[&str],
        place: impl Fn(usize) -> Place,
    ) -> Result<(), SettingsError> {
        // Templates that were edited on Windows must give the same G-code.
        let text = &text.replace("\r\n", "\n");
        let place = |span: Range<usize>| place(line_of(text, span.start));
        let table = parse(text, &place)?;
        let mut entries = Vec::new();
        flatten("", table.get_ref(), &mut entries);
        entries.retain(|entry| !skip.contains(&entry.key.as_str()));
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

    /// Where a setting was given; nowhere if it has its default.
    pub fn place(&self, key: &Key) -> Option<&Place> {
        self.places.get(key.name)
    }

    /// The settings, and warnings about unwise combinations.
    ///
    /// # Errors
    /// As [`Settings::validate`], with the places of the values.
    pub fn finish(self) -> Result<(Settings, Vec<String>), SettingsError> {
        let mut warnings = self.renamed;
        warnings.extend(
            check::conflicts(&self.settings, &self.places)
                .map_err(|conflict| conflict.into_error(&self.places))?,
        );
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
        if name != key.name {
            self.renamed
                .push(format!("{place}: {name} is now called {}", key.name));
        }
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
        let nowhere = Places::new();
        check::conflicts(self, &nowhere)
            .map_err(|conflict| conflict.into_error(&nowhere))
    }
}

impl Conflict {
    fn into_error(self, places: &Places) -> SettingsError {
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
    if HEAD.contains(&name) {
        return "only profiles have it, which are named with --printer, \
                --filament or --preset"
            .to_owned();
    }
    let meant = table::ambiguous(name);
    if meant.len() > 1 {
        return format!("did you mean {}?", table::alternatives(&meant));
    }
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

/// The text of a settings file.
pub(super) fn text_of(path: &Path) -> Result<String, SettingsError> {
    files::read_text(path, MAX_SETTINGS_BYTES).map_err(|error| {
        let path = path.to_owned();
        match error {
            FileError::System(cause) => {
                SettingsError::Unreadable { path, cause }
            }
            cause => SettingsError::NoSettings { path, cause },
        }
    })
}

/// What a profile says about itself.
pub(super) struct Head {
    pub(super) description: Option<String>,
    /// The profile it starts from, and the line that says so.
    pub(super) inherits: Option<(String, usize)>,
}

/// Reads what the profile `file` says about itself.
pub(super) fn head(file: &str, text: &str) -> Result<Head, SettingsError> {
    let place = |span: Range<usize>| Place::Profile {
        name: file.to_owned(),
        line: line_of(text, span.start),
    };
    let table = parse(text, &place)?;
    let text_at = |key: &str| -> Result<_, SettingsError> {
        let Some(value) = table.get_ref().get(key) else {
            return Ok(None);
        };
        match value.get_ref() {
            DeValue::String(s) => {
                Ok(Some((s.to_string(), line_of(text, value.span().start))))
            }
            other => Err(SettingsError::WrongType {
                place: place(value.span()),
                key: key.to_owned(),
                value: raw(other).describe(),
                expected: "text in quotes".to_owned(),
            }),
        }
    };
    Ok(Head {
        description: text_at("description")?.map(|(text, _)| text),
        inherits: text_at("inherits")?,
    })
}

fn parse<'a>(
    text: &'a str,
    place: &dyn Fn(Range<usize>) -> Place,
) -> Result<Spanned<DeTable<'a>>, SettingsError> {
    DeTable::parse(text).map_err(|e| {
        // Without a span the file as a whole is meant.
        let span = e.span().unwrap_or(0..0);
        let what = e.message().replace('\n', ", ");
        let line = text.lines().nth(line_of(text, span.start) - 1);
        SettingsError::NotToml {
            message: match line.map(str::trim).filter(|line| !line.is_empty()) {
                Some(line) => format!("{what}, in `{}`", shortened(line)),
                None => what,
            },
            hint: if line.is_some_and(ends_in_unit) {
                "; numbers have no unit, and texts have quotes"
            } else {
                ""
            },
            place: place(span),
        }
    })
}

/// As much of a line as people read.
fn shortened(line: &str) -> String {
    const MOST: usize = 60;
    match line.char_indices().nth(MOST) {
        Some((end, _)) => format!("{}…", &line[..end]),
        None => line.to_owned(),
    }
}

/// `layer_height = 0.2mm`, `infill_density = 20%`.
fn ends_in_unit(line: &str) -> bool {
    let value = line.split_once('=').map_or("", |(_, value)| value.trim());
    value.starts_with(|c: char| c.is_ascii_digit())
        && value.ends_with(|c: char| c.is_alphabetic() || c == '%')
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
