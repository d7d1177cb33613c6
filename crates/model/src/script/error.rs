//! Why a script gives no model: the interpreter's errors in our words.

use super::limits::{
    MAX_ARRAY, MAX_CALLS, MAX_MAP, MAX_STRING, ScriptLimits, Stop,
};
use super::suggest;
use crate::param::ParamError;
use isoslice_base::units::human_start;
use rhai::{EvalAltResult, Position};

/// Why a script gives no model.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ScriptError {
    /// An error of rhai, or of a function that the script has called.
    #[error("{}{message}", place(*.line, *.column))]
    Failed {
        /// Line from 1, if known.
        line: Option<usize>,
        /// Column from 1, if known.
        column: Option<usize>,
        /// What went wrong.
        message: String,
    },
    /// A limit was reached.
    #[error("{}the script {what}", place(*.line, None))]
    Limit {
        /// Line from 1, if known.
        line: Option<usize>,
        /// Which limit, and the remedy.
        what: String,
    },
    /// The script ran, but made no shape.
    #[error(
        "the script gives no model: its last value is {found} and it never \
         calls draw(); end it with an expression of x, y, z (without a `;` \
         after it), such as `sphere(10)`, or pass the shape to draw(shape)"
    )]
    NoModel {
        /// What the last value is.
        found: String,
    },
    /// A parameter is wrong.
    #[error("{}{error}", place(*.line, None))]
    Param {
        /// Line from 1, if it is the script's call that failed.
        line: Option<usize>,
        /// What is wrong.
        error: ParamError,
    },
    /// The interpreter itself broke.
    #[error(
        "the script made the interpreter fail ({message}); this is a bug: \
         please report it with the script"
    )]
    Bug {
        /// What is known.
        message: String,
    },
}

impl ScriptError {
    /// Line and column of the script where it failed, from 1, as far as they
    /// are known.
    pub fn place(&self) -> (Option<usize>, Option<usize>) {
        match self {
            Self::Failed { line, column, .. } => (*line, *column),
            Self::Limit { line, .. } | Self::Param { line, .. } => {
                (*line, None)
            }
            Self::NoModel { .. } | Self::Bug { .. } => (None, None),
        }
    }
}

fn place(line: Option<usize>, column: Option<usize>) -> String {
    match (line, column) {
        (Some(l), Some(c)) => format!("line {l}, column {c}: "),
        (Some(l), None) => format!("line {l}: "),
        _ => String::new(),
    }
}

/// Turns rhai's error into ours.
pub(super) fn explain(
    error: &EvalAltResult,
    parameter: Option<ParamError>,
    limits: &ScriptLimits,
    text: &str,
) -> ScriptError {
    let innermost = unwrapped(error);
    let position = innermost.position();
    let position = if position.is_none() {
        error.position()
    } else {
        position
    };
    let line = position.line();
    if let Some(error) = parameter {
        return ScriptError::Param { line, error };
    }
    let limit = |what: String| ScriptError::Limit { line, what };
    let failed = |message: String| ScriptError::Failed {
        line,
        column: position.position(),
        message: human_start(&message, LONGEST),
    };
    match innermost {
        EvalAltResult::ErrorTerminated(token, _) => {
            let why = token.clone().try_cast::<Stop>();
            limit(why.unwrap_or(Stop::Operations).describe(limits))
        }
        EvalAltResult::ErrorDataTooLarge(what, _) => limit(format!(
            "made something too large ({what}); at most {MAX_ARRAY} array \
             elements, {MAX_MAP} map entries and {MAX_STRING} bytes of text"
        )),
        EvalAltResult::ErrorStackOverflow(_) => limit(format!(
            "calls functions more than {MAX_CALLS} deep; use a loop instead \
             of recursion"
        )),
        EvalAltResult::ErrorTooManyModules(_)
        | EvalAltResult::ErrorModuleNotFound(..) => failed(
            "models cannot import other files; copy the functions into the \
             script"
                .to_owned(),
        ),
        EvalAltResult::ErrorRuntime(value, _) => failed(value.to_string()),
        EvalAltResult::ErrorFunctionNotFound(signature, _) => {
            let own = suggest::declared(text, &["fn"]);
            failed(suggest::function(signature, &own))
        }
        EvalAltResult::ErrorVariableNotFound(name, _) => {
            failed(suggest::variable(name, text))
        }
        EvalAltResult::ErrorMismatchDataType(wanted, found, _)
            if wanted == "bool" && found.ends_with("Tree") =>
        {
            failed(
                "a field is neither true nor false: the script runs once, \
                 and x, y and z have no values yet; write max, min or \
                 compare instead of if"
                    .to_owned(),
            )
        }
        EvalAltResult::ErrorMismatchDataType(wanted, found, _)
            if wanted.ends_with("i64") && found.ends_with("f64") =>
        {
            failed(
                "here counts a whole number: write floor(…) or round(…), and \
                 step: 1 for a parameter that counts"
                    .to_owned(),
            )
        }
        EvalAltResult::ErrorFor(_) => failed(
            "a loop goes over a range or an array: for i in 0..6 { … }"
                .to_owned(),
        ),
        EvalAltResult::ErrorMismatchDataType(wanted, found, _) => {
            failed(format!(
                "this is {}, but {} is wanted: shapes are made of x, y, z \
                 and numbers, which have no quotes",
                suggest::plain_type(found),
                suggest::plain_type(wanted)
            ))
        }
        other => {
            let mut plain = rhai_message(other);
            for (symbol, remedy) in [
                (
                    "Expecting ';'",
                    if text.trim_start().starts_with("def ")
                        || text.contains("\ndef ")
                        || text.contains("function ")
                    {
                        "; a function is fn name(a, b) { a + b }"
                    } else {
                        "; is there a ; missing at the end of the line \
                         before?"
                    },
                ),
                ("an iterable value", "; write for example for i in 0..6"),
                ("'import'", "; models cannot import other files"),
                ("'eval'", "; models cannot run text as code"),
                ("is a reserved keyword", "; give it another name"),
            ] {
                if plain.contains(symbol) {
                    plain.push_str(remedy);
                }
            }
            if suggest::looks_like_openscad(text) {
                plain.push_str(
                    "; this looks like OpenSCAD: here shapes are values, as in \
                     difference(box([0, 0, 0], [10, 10, 10]), sphere(5)), and \
                     docs/shapes.md lists them",
                );
            }
            failed(plain)
        }
    }
}

/// Most characters of a message, which may quote a text of a million letters.
const LONGEST: usize = 400;

/// The error inside of function-call wrappers.
fn unwrapped(mut error: &EvalAltResult) -> &EvalAltResult {
    while let EvalAltResult::ErrorInFunctionCall(_, _, inner, _) = error {
        error = inner;
    }
    error
}

/// rhai's message without its position, which our message begins with.
fn rhai_message(error: &EvalAltResult) -> String {
    let text = error.to_string();
    let position = error.position();
    if position == Position::NONE {
        return text;
    }
    match text.strip_suffix(&format!(" ({position})")) {
        Some(bare) => bare.to_owned(),
        None => text,
    }
}
