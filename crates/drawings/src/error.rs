//! Why a file is no drawing, or a text cannot be drawn.

use std::collections::BTreeMap;

/// Why a drawing or a text cannot be used: which, what is wrong, and what to
/// do.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{name}: {problem}")]
pub struct DrawingError {
    name: String,
    problem: String,
}

impl DrawingError {
    pub(crate) fn new(name: &str, problem: impl Into<String>) -> DrawingError {
        DrawingError {
            name: name.to_owned(),
            problem: problem.into(),
        }
    }

    /// The file's name or the text, as it was given.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// What is wrong, and what to do, without the name.
    pub fn problem(&self) -> &str {
        &self.problem
    }
}

/// What is wrong, before the name is known.
pub(crate) type Problem<T> = Result<T, String>;

/// Lets work go on unless it is to stop.
pub(crate) fn go_on() -> Problem<()> {
    isoslice_base::limits::go_on().map_err(|stopped| stopped.to_string())
}

/// Sentences for what of a file is not drawn, and how often.
pub(crate) fn not_drawn(left_out: BTreeMap<String, usize>) -> Vec<String> {
    let sentence = |(what, times)| match times {
        1 => format!("not drawn: {what}"),
        _ => format!("not drawn: {what} ({times} times)"),
    };
    left_out.into_iter().map(sentence).collect()
}
