//! The library's errors as exceptions, with the text of the command line.

use isoslice::limits::{Stopped as Limit, TooLittleSpace};
use isoslice::model::{LoadError, PlaceError, ScriptError};
use isoslice::settings;
use pyo3::create_exception;
use pyo3::exceptions::PyException;
use pyo3::prelude::*;

create_exception!(
    isoslice,
    Error,
    PyException,
    "What isoslice cannot do, and the remedy, in the words of the command line."
);
create_exception!(
    isoslice,
    ModelError,
    Error,
    "The model cannot be read, or does not fit the printer."
);
create_exception!(
    isoslice,
    SettingsError,
    Error,
    "A setting or a profile is wrong, or does not go with another one."
);
create_exception!(
    isoslice,
    SliceError,
    Error,
    "The model cannot be sliced with these settings."
);
create_exception!(
    isoslice,
    Stopped,
    Error,
    "The work took more time or memory than its limits allow."
);

/// The exception for an error. Its text is what the command line writes behind
/// `error: `.
pub(crate) fn exception(error: &anyhow::Error) -> PyErr {
    let mut parts: Vec<String> = error.chain().map(|e| e.to_string()).collect();
    // Some errors tell their cause themselves.
    parts.dedup_by(|cause, effect| effect.contains(&**cause));
    let text = parts.join("\n  because: ");
    if error.is::<LoadError>()
        || error.is::<PlaceError>()
        || error.is::<ScriptError>()
    {
        ModelError::new_err(text)
    } else if error.is::<settings::SettingsError>() {
        SettingsError::new_err(text)
    } else if error.is::<isoslice::SliceError>() {
        SliceError::new_err(text)
    } else if error.is::<Limit>() || error.is::<TooLittleSpace>() {
        Stopped::new_err(text)
    } else {
        Error::new_err(text)
    }
}

/// The exception for a plain error.
pub(crate) fn plain(error: impl Into<anyhow::Error>) -> PyErr {
    exception(&error.into())
}
