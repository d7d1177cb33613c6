//! The arguments of the command, which do not change while it runs.

use crate::cli::args::{FORMULA, ModelArgs, SettingsSource};
use crate::cli::limits::{LimitArgs, ThreadArgs};
use std::path::Path;

/// What is watched, and how it is sliced.
pub(super) struct Job {
    pub model: ModelArgs,
    pub settings: SettingsSource,
    pub limits: LimitArgs,
    pub threads: ThreadArgs,
}

impl Job {
    /// The name of what is shown.
    pub(super) fn name(&self) -> String {
        let name = self.model.model.as_deref().and_then(Path::file_name);
        name.map_or(FORMULA.into(), |name| name.to_string_lossy().into_owned())
    }
}
