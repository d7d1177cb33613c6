//! Reads settings from files and assignments, in the order given.
//!
//! In: TOML text or `key=value`. Out: [`Settings`], and the [`GivenIn`] of each
//! setting that was given, so that an error found at the end can point to it.

use super::check::{self, Conflict};
use super::error::{GivenIn, GivenPlaces, SettingsError};
use super::foreign;
use super::gone;
use super::profile::{Profile, Profiles};
use super::shipped::ProfileKind;
use super::table::{self, Key};
use super::text::{self, HEAD, line_of};
use super::value::{Raw, Refused, ValueKind, formula};
use super::{Settings, keys};
use isoslice_base::units::human_list;
use std::ops::Range;
use std::path::Path;
use toml::de::{DeTable, DeValue};

/// Gathers settings from several places; what comes later wins.
#[derive(Clone, Debug, Default)]
pub struct Builder {
    settings: Settings,
    places: GivenPlaces,
    /// Warnings about old names of settings.
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
    /// If the file cannot be read, and the errors of [`Builder::toml`].
    pub fn file(&mut self, path: &Path) -> Result<(), SettingsError> {
        let text = text::read(path)?;
        self.toml(&path.display().to_string(), &text)
    }

    /// Takes over what TOML `text` says. Messages call the file `name`.
    ///
    /// # Errors
    /// If the text is not TOML or has an unknown key, or if a value is of the
    /// wrong type or out of range. The error is about the first such place in
    /// the file; what stands before it has been taken over.
    pub fn toml(
        &mut self,
        name: &str,
        text: &str,
    ) -> Result<(), SettingsError> {
        let name = name.to_owned();
        self.take_over(text, &[], |line| GivenIn::File {
            name: name.clone(),
            line,
        })
    }

    /// Takes over a profile, after those that it inherits from. Returns all of
    /// them in that order.
    ///
    /// # Errors
    /// If the profile, or one that it inherits from, does not exist, and the
    /// errors of [`Builder::toml`].
    pub fn profile(
        &mut self,
        profiles: &Profiles,
        kind: ProfileKind,
        name: &str,
    ) -> Result<Vec<Profile>, SettingsError> {
        let chain = profiles.chain(kind, name)?;
        for profile in &chain {
            let name = profile.file();
            self.take_over(&profile.text, &HEAD, |line| GivenIn::Profile {
                name: name.clone(),
                line,
            })?;
        }
        Ok(chain)
    }

    /// Takes over `text` except for the keys in `skip`. `place` makes the place
    /// of a line.
    fn take_over(
        &mut self,
        text: &str,
        skip: &[&str],
        place: impl Fn(usize) -> GivenIn,
    ) -> Result<(), SettingsError> {
        // Line ends of Windows in templates must not change the G-code.
        let text = &text.replace("\r\n", "\n");
        let place = |span: Range<usize>| place(line_of(text, span.start));
        let table = text::parse(text, &place)?;
        self.assign_all(table.get_ref(), skip, &place)
    }

    /// Takes over a table of the file `text`. Messages call the file `name`.
    ///
    /// # Errors
    /// Those of [`Builder::toml`].
    pub fn table(
        &mut self,
        table: &DeTable<'_>,
        text: &str,
        name: &str,
    ) -> Result<(), SettingsError> {
        self.assign_all(table, &[], &|span: Range<usize>| GivenIn::File {
            name: name.to_owned(),
            line: line_of(text, span.start),
        })
    }

    fn assign_all(
        &mut self,
        table: &DeTable<'_>,
        skip: &[&str],
        place: &dyn Fn(Range<usize>) -> GivenIn,
    ) -> Result<(), SettingsError> {
        let mut entries = Vec::new();
        text::flatten("", table, &mut entries);
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
    /// are understood. In a template of G-code `\n` is a new line without
    /// quotes, too, as in files of PrusaSlicer.
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
            return self.assign(key, text::raw(&parsed), GivenIn::Set);
        }
        if table::find(key).is_some_and(Key::is_template) {
            let lines = value.replace("\\n", "\n");
            return self.assign(key, Raw::Word(&lines), GivenIn::Set);
        }
        self.assign(key, Raw::Word(value), GivenIn::Set)
    }

    /// The settings so far. Their combination has not been checked.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Where a setting was given; nothing if it has its default.
    pub fn place(&self, key: &Key) -> Option<&GivenIn> {
        self.places.get(key.name)
    }

    /// The settings, and warnings about unwise combinations.
    ///
    /// # Errors
    /// The first setting that is at odds with another, and its place.
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
        place: GivenIn,
    ) -> Result<(), SettingsError> {
        let Some(key) = table::find(name) else {
            return Err(unknown(name, place));
        };
        (key.assign)(&mut self.settings, raw, key.measure())
            .map_err(|refused| refusal(refused, key, raw, place.clone()))?;
        if name != key.name {
            self.renamed
                .push(format!("{place}: {name} is now called {}", key.name));
        }
        self.places.insert(key.name, place);
        Ok(())
    }
}

impl Conflict {
    fn into_error(self, places: &GivenPlaces) -> SettingsError {
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

fn unknown(name: &str, place: GivenIn) -> SettingsError {
    let has_plural = table::find(&format!("{name}s")).is_some();
    if table::is_group(name) && !has_plural {
        let first = keys().iter().find(|key| key.group() == name);
        let first = first.map(|key| (key.name, key.default()));
        let on = foreign::example(name);
        let on = on.map(|(setting, value)| (setting, value.to_owned()));
        let (example, value) = on.or(first).unwrap_or_default();
        return SettingsError::Group {
            place,
            key: name.to_owned(),
            example: example.to_owned(),
            value,
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
    if let Some(advice) = gone::advice(name) {
        return advice;
    }
    if let Some(now) = foreign::name(name) {
        return format!("did you mean {now}?");
    }
    let plural = format!("{name}s");
    if table::find(&plural).is_some() {
        return format!("did you mean {plural}?");
    }
    let meant = table::ambiguous(name);
    if meant.len() > 1 {
        return format!("did you mean {}?", human_list(&meant, "or"));
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
    place: GivenIn,
) -> SettingsError {
    let value = raw.describe();
    match refused {
        Refused::Type => SettingsError::WrongType {
            place,
            key: key.name.to_owned(),
            expected: key.expected()
                + &foreign::value(key, raw)
                + &elsewhere(key, raw),
            value,
        },
        Refused::Range => SettingsError::OutOfRange {
            place,
            key: key.name.to_owned(),
            value,
            allowed: key.allowed(),
        },
    }
}

/// What a refused value was meant for, as the end of a sentence; empty if that
/// is not known.
fn elsewhere(key: &Key, raw: Raw<'_>) -> String {
    let is_formula = formula(raw).is_some();
    let adaptive = matches!(raw, Raw::Text("adaptive") | Raw::Word("adaptive"));
    let is_number = raw.describe().parse::<f64>().is_ok();
    // What the others take says so.
    if let Some(number) = raw.number_with_unit()
        && key.kind() == ValueKind::Varying
        && !key.unit.is_empty()
    {
        return format!(", or write the number without its unit: {number}");
    }
    let other = match key.name {
        "layer_height" if is_formula || adaptive => "layer_heights",
        "layer_heights" if is_number => "layer_height",
        _ if is_formula => return "; it takes no expression".to_owned(),
        _ => return String::new(),
    };
    format!(", or set {other}, which takes this value")
}
