//! A settings file as text: its TOML taken apart, with the line of each entry.

use super::error::{GivenIn, SettingsError};
use super::foreign;
use super::table;
use super::value::{Raw, Value};
use isoslice_base::files::{self, FileError, MAX_SETTINGS_BYTES};
use isoslice_base::units::human_start;
use std::ops::Range;
use std::path::Path;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Keys of a profile that are no settings.
pub(super) const HEAD: [&str; 2] = ["description", "inherits"];

/// The text of a settings file.
pub(super) fn read(path: &Path) -> Result<String, SettingsError> {
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
    /// The profile that this one starts from, and the line that says so.
    pub(super) inherits: Option<(String, usize)>,
}

/// Reads what the profile `file` says about itself.
pub(super) fn head(file: &str, text: &str) -> Result<Head, SettingsError> {
    let place = |span: Range<usize>| GivenIn::Profile {
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

pub(super) fn parse<'a>(
    text: &'a str,
    place: &dyn Fn(Range<usize>) -> GivenIn,
) -> Result<Spanned<DeTable<'a>>, SettingsError> {
    DeTable::parse(text).map_err(|e| {
        // An error without a span is about the whole file.
        let span = e.span().unwrap_or(0..0);
        let what = e.message().replace('\n', ", ");
        let number = line_of(text, span.start);
        let line = text.lines().nth(number - 1);
        SettingsError::NotToml {
            message: match line.map(str::trim).filter(|line| !line.is_empty()) {
                Some(line) => {
                    format!("{what}, in `{}`", human_start(line, LONGEST))
                }
                None => what,
            },
            hint: line.map_or_else(String::new, |line| {
                advice(line, &group_at(text, number))
            }),
            place: place(span),
        }
    })
}

/// Most characters of a line that stands in the middle of a message.
const LONGEST: usize = 60;

/// The group whose settings stand in a line.
fn group_at(text: &str, line: usize) -> String {
    let heads = text.lines().take(line).filter_map(|line| {
        let name = line.trim().strip_prefix('[')?.split_once(']')?.0;
        Some(format!("{}.", name.trim()))
    });
    heads.last().unwrap_or_default()
}

/// What to write instead of a line that is not TOML.
fn advice(line: &str, group: &str) -> String {
    if ends_in_unit(line) {
        return "; numbers have no unit, and texts have quotes".to_owned();
    }
    let line = line.split('#').next().unwrap_or(line);
    if let Some((name, value)) = line.split_once(':')
        && table::find(&format!("{group}{}", name.trim())).is_some()
    {
        return format!("; write {} = {}", name.trim(), value.trim());
    }
    let Some((name, value)) = line.split_once('=') else {
        return String::new();
    };
    let (name, value) = (name.trim(), value.trim());
    if value.contains(',') && value.replace(',', ".").parse::<f64>().is_ok() {
        return format!("; write {name} = {}", value.replace(',', "."));
    }
    let Some(key) = table::find(&format!("{group}{name}")) else {
        return String::new();
    };
    let text = value.trim_matches(|c| matches!(c, '"' | '\''));
    if !value.starts_with('"') && !text.is_empty() && key.takes(text) {
        return format!("; write {name} = {}", text.to_owned().to_toml());
    }
    if !value.starts_with(char::is_alphabetic) {
        return String::new();
    }
    let hint = foreign::value(key, Raw::Text(text));
    format!("; {name} is {}{hint}", key.expected())
}

/// True for lines like `layer_height = 0.2mm` and `infill_density = 20%`.
fn ends_in_unit(line: &str) -> bool {
    let value = line.split_once('=').map_or("", |(_, value)| value.trim());
    value.starts_with(|c: char| c.is_ascii_digit())
        && value.ends_with(|c: char| c.is_alphabetic() || c == '%')
}

/// One `key = value` of a file. A key that is written wrongly has a hint in
/// place of the value.
pub(super) struct Entry<'a> {
    pub(super) key: String,
    pub(super) value: Result<Raw<'a>, String>,
    pub(super) key_span: Range<usize>,
    pub(super) value_span: Range<usize>,
}

/// Lists the values of a table with their full names.
pub(super) fn flatten<'a>(
    prefix: &str,
    table: &'a DeTable<'_>,
    entries: &mut Vec<Entry<'a>>,
) {
    for (key, value) in table {
        let name = format!("{prefix}{}", key.get_ref());
        let known = table::find(&name).is_some();
        let value_span = value.span();
        let value = match value.get_ref() {
            // A quoted "speed.travel" could give speed.travel a second time in
            // one file.
            _ if key.get_ref().contains('.') => {
                Err(format!("write {name} without quotes"))
            }
            DeValue::Table(inner) if table::is_group(&name) => {
                flatten(&format!("{name}."), inner, entries);
                continue;
            }
            // The error for an unknown table names the settings in it, or the
            // table if it is empty.
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

pub(super) fn raw<'a>(value: &'a DeValue<'_>) -> Raw<'a> {
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
pub(super) fn line_of(text: &str, byte: usize) -> usize {
    1 + text.bytes().take(byte).filter(|b| *b == b'\n').count()
}
