//! The engine that fills in templates: what it may do, and how it writes.

use crate::number::{scaled, text};
use minijinja::syntax::SyntaxConfig;
use minijinja::value::{Rest, ValueKind, ValueOrKwargs};
use minijinja::{
    Environment, Error, ErrorKind, Output, State, UndefinedBehavior, Value,
    filters,
};

/// What a template may use up: steps, and pieces of memory of 64 bytes. This is
/// enough for thousands of lines and 13 MB.
const FUEL: u64 = 200_000;

/// Decimals of numbers. A template that wants fewer has to round.
const DECIMALS: u32 = 5;

/// An engine for templates of untrusted origin.
pub(super) fn engine() -> Result<Environment<'static>, Error> {
    let mut engine = Environment::new();
    engine.set_undefined_behavior(UndefinedBehavior::Strict);
    engine.set_fuel(Some(FUEL));
    // In this mode errors have a place.
    engine.set_debug(true);
    // A line with nothing but a condition must not leave an empty line.
    let syntax = SyntaxConfig::builder()
        .trim_blocks(true)
        .lstrip_blocks(true)
        .build()?;
    engine.set_syntax(syntax);
    engine.set_formatter(write);
    engine.add_filter("format", format);
    // A namespace may hold itself, and whatever goes through it then has no
    // end.
    engine.remove_global("namespace");
    Ok(engine)
}

/// The filter `format` without conversions by name, `%(name)s`. The engine's
/// own filter panics if such a name has no end (minijinja 3.1.0).
fn format(
    state: &mut State,
    form: &Value,
    values: Rest<ValueOrKwargs>,
) -> Result<Value, Error> {
    let text = form.as_str().unwrap_or_default();
    if text.replace("%%", "").contains("%(") {
        return Err(Error::new(
            ErrorKind::InvalidOperation,
            format!("{text:?} has a %(; write a conversion such as %.2f"),
        ));
    }
    filters::format(state, form, values)
}

/// Writes a value as firmware reads it.
fn write(out: &mut Output, _: &mut State, value: &Value) -> Result<(), Error> {
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
