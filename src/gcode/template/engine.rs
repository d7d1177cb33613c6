//! The engine that fills in templates: what it may do, and how it writes.

use crate::gcode::number::{scaled, text};
use minijinja::value::{Rest, ValueKind};
use minijinja::{
    Environment, Error, ErrorKind, Output, State, UndefinedBehavior, Value,
    filters,
};

/// Steps a template may take: thousands of lines.
const FUEL: u64 = 200_000;

/// Filters that make room for as much as they are told, at once, whatever
/// there is; no G-code needs them.
const LEFT_OUT: [&str; 3] = ["batch", "indent", "slice"];

/// Decimals of numbers; templates that want fewer round.
const DECIMALS: u32 = 5;

/// An engine for templates of untrusted origin.
pub(super) fn engine() -> Environment<'static> {
    let mut engine = Environment::new();
    engine.set_undefined_behavior(UndefinedBehavior::Strict);
    engine.set_fuel(Some(FUEL));
    // For the place of a mistake.
    engine.set_debug(true);
    // A line with nothing but a condition leaves no empty line.
    engine.set_trim_blocks(true);
    engine.set_lstrip_blocks(true);
    engine.set_formatter(write);
    engine.add_filter("format", format_within);
    for filter in LEFT_OUT {
        engine.remove_filter(filter);
    }
    engine
}

/// The filter `format` with plain conversions only, such as `%5.2f`, whose
/// widths and decimals have two digits at most: what is wider is made at
/// once, however wide, and names in brackets make the engine panic.
fn format_within(
    state: &State,
    form: &Value,
    values: Rest<Value>,
) -> Result<Value, Error> {
    let text = form.as_str().unwrap_or_default();
    let mut digits = text.split(|c: char| !c.is_ascii_digit());
    if digits.any(|run| run.len() > 2) {
        return Err(Error::new(
            ErrorKind::InvalidOperation,
            format!("{text:?} has a width of more than two digits"),
        ));
    }
    let without_signs = text.replace("%%", "");
    let mut parts = without_signs.as_str();
    let plain = loop {
        let Some(at) = parts.find('%') else {
            break true;
        };
        let flags = |c: char| c.is_ascii_digit() || "+-# .".contains(c);
        let rest = parts[at + 1..].trim_start_matches(flags);
        if !rest.starts_with(|c: char| c.is_ascii_alphabetic()) {
            break false;
        }
        parts = &rest[1..];
    };
    if !plain {
        return Err(Error::new(
            ErrorKind::InvalidOperation,
            format!(
                "{text:?} has a % that begins no conversion such as %.2f; \
                 write %% for the sign itself"
            ),
        ));
    }
    filters::format(state, form, values)
}

/// Writes a value as firmware reads it.
fn write(out: &mut Output, _: &State, value: &Value) -> Result<(), Error> {
    let written = match value.kind() {
        ValueKind::Number if !value.is_integer() => {
            let x = f64::try_from(value.clone())?;
            if scaled(x, DECIMALS).is_none() {
                return Err(Error::new(
                    ErrorKind::InvalidOperation,
                    format!("the result is {x}, which firmware cannot read"),
                ));
            }
            text(x, DECIMALS)
        }
        ValueKind::Undefined => {
            return Err(Error::from(ErrorKind::UndefinedError));
        }
        ValueKind::Seq | ValueKind::Map | ValueKind::Iterable => {
            return Err(Error::new(
                ErrorKind::InvalidOperation,
                "a list cannot be written; write its elements, as with \
                 | join(' ')",
            ));
        }
        _ => value.to_string(),
    };
    out.write_str(&written)
        .map_err(|_| Error::from(ErrorKind::WriteFailure))
}
