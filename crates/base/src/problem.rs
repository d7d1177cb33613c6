//! What is wrong with something that a user has named, such as a file.

use crate::limits;

/// What is wrong, and what to do, before the name is known.
pub type Problem<T> = Result<T, String>;

/// Why something cannot be used: which, what is wrong, and what to do.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{name}: {problem}")]
pub struct NamedProblem {
    name: String,
    problem: String,
}

impl NamedProblem {
    /// A problem of what has a name.
    pub fn new(name: &str, problem: impl Into<String>) -> NamedProblem {
        NamedProblem {
            name: name.to_owned(),
            problem: problem.into(),
        }
    }

    /// The name, as it was given.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// What is wrong, and what to do, without the name.
    pub fn problem(&self) -> &str {
        &self.problem
    }
}

/// Lets work go on unless it is to stop.
///
/// # Errors
/// In words, if the work is to stop.
pub fn go_on() -> Problem<()> {
    limits::go_on().map_err(|stopped| stopped.to_string())
}
