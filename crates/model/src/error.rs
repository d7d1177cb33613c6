//! Why a model cannot be loaded.

use super::formula::FormulaError;
use super::param::ParamError;
use super::script::ScriptError;
use super::vm::VmError;
use isocontour::ExpandError;
use isoslice_base::encoding::NotText;
use std::path::PathBuf;

/// Why a model cannot be loaded. The user can mend all of them, except
/// `ScriptError::Bug`.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LoadError {
    /// The file cannot be read.
    #[error(
        "cannot read {file}: check its name, and that it is a readable text \
         file"
    )]
    Read {
        /// File.
        file: String,
        /// The system's reason.
        source: std::io::Error,
    },
    /// The file is too large for a model.
    #[error(
        "{file} is larger than {limit_mb} MB; is it a model (.rhai or .vm)?"
    )]
    TooLarge {
        /// File.
        file: String,
        /// The limit.
        limit_mb: u64,
    },
    /// The file's name is not a model's.
    #[error(
        "{file} {found}; {advice}; models are .rhai scripts, .vm files \
         (fidget's text format) or meshes (.stl, .obj, .ply, .3mf), and a \
         formula is given with -e"
    )]
    NoModel {
        /// File.
        file: String,
        /// What the file is instead.
        found: String,
        /// What to do.
        advice: String,
    },
    /// A mesh that cannot be read.
    #[error("{0}")]
    Mesh(String),
    /// The file is not text.
    #[error("{file}: {error}")]
    NotText {
        /// File.
        file: String,
        /// What the file is instead.
        error: NotText,
    },
    /// A malformed `.vm` file.
    #[error("{file}: {error}")]
    Vm {
        /// File.
        file: String,
        /// What is wrong.
        error: VmError,
    },
    /// A malformed formula.
    #[error("{file}: {error}")]
    Formula {
        /// Name of the formula.
        file: String,
        /// The files of data that it has named so far.
        data: Vec<PathBuf>,
        /// What is wrong.
        error: FormulaError,
    },
    /// A script that fails.
    #[error("{file}: {error}")]
    Script {
        /// File.
        file: String,
        /// The files of data that it has named so far.
        data: Vec<PathBuf>,
        /// What is wrong.
        error: Box<ScriptError>,
    },
    /// `-D` for a model without parameters.
    #[error("{file}: {error}")]
    Param {
        /// File.
        file: String,
        /// What is wrong.
        error: Box<ParamError>,
    },
    /// An expression that is too large or has free variables.
    #[error("{file}: {error}")]
    Expression {
        /// File.
        file: String,
        /// The files of data that it names.
        data: Vec<PathBuf>,
        /// What is wrong.
        error: ExpandError,
    },
}

impl LoadError {
    /// The files of data that the model has named before it failed, those that
    /// are missing included: once they change, it may load.
    pub fn data_files(&self) -> &[PathBuf] {
        match self {
            LoadError::Formula { data, .. }
            | LoadError::Script { data, .. }
            | LoadError::Expression { data, .. } => data,
            _ => &[],
        }
    }
}
