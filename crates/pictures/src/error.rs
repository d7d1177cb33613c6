//! Why a file is no picture, volume or samples.

/// Why a file cannot be used: which file, what is wrong, and what to do.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{name}: {problem}")]
pub struct DataError {
    name: String,
    problem: String,
}

impl DataError {
    pub(crate) fn new(name: &str, problem: impl Into<String>) -> DataError {
        DataError {
            name: name.to_owned(),
            problem: problem.into(),
        }
    }

    /// The file's name, as it was given.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// What is wrong, and what to do, without the file's name.
    pub fn problem(&self) -> &str {
        &self.problem
    }
}

/// What is wrong with a file, before its name is known.
pub(crate) type Problem<T> = Result<T, String>;

/// Lets work go on unless it is to stop.
pub(crate) fn go_on() -> Problem<()> {
    isoslice_base::limits::go_on().map_err(|stopped| stopped.to_string())
}
