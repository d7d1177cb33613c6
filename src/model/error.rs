//! Why a model cannot be loaded.

use super::formula::FormulaError;
use super::param::ParamError;
use super::script::ScriptError;
use super::vm::VmError;
use crate::encoding::NotText;
use isocontour::{BoundsError, ExpandError};

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
        "{file} {found}; models are .rhai scripts or .vm files (fidget's text \
         format), and a formula is given with -e: {advice}"
    )]
    NoModel {
        /// File.
        file: String,
        /// What the file is instead.
        found: String,
        /// What to do.
        advice: String,
    },
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
        /// What is wrong.
        error: FormulaError,
    },
    /// A script that fails.
    #[error("{file}: {error}")]
    Script {
        /// File.
        file: String,
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
        /// What is wrong.
        error: ExpandError,
    },
}

/// Why a model has no bounds, and what to do about it.
pub(super) fn of_bounds(error: &BoundsError) -> String {
    const CUT: &str = "--bounds x0,y0,z0:x1,y1,z1";
    match error {
        BoundsError::Unbounded {
            direction,
            at_mm,
            flipped,
        } => {
            let flipped = if *flipped {
                " (its outside is bounded: is the sign flipped? f must be \
                 negative inside)"
            } else {
                ""
            };
            format!(
                "the model is unbounded: it goes on along {direction} at \
                 {at_mm} mm; intersect it with a box or a ball, or cut it \
                 with {CUT}{flipped}"
            )
        }
        BoundsError::Empty { searched, cause } => {
            let cause = cause.as_ref().map(|cause| {
                format!(
                    "; in places f is NaN (not a number), which is outside: \
                     {cause}"
                )
            });
            format!(
                "the model is empty: f is nowhere negative within {searched}; \
                 f must be negative inside the part (an unsigned distance \
                 needs a thickness subtracted){}",
                cause.unwrap_or_default()
            )
        }
        BoundsError::NotANumber { searched, cause } => format!(
            "f is NaN (not a number) everywhere within {searched}, so there \
             is no part: {cause}; keep the operand in range, as with \
             max(0, …)"
        ),
        BoundsError::Flat { size: [x, y] } => format!(
            "the model has no height: f does not depend on z (it is a drawing \
             of {x:.3} × {y:.3} mm); give it a height with --height 3, or \
             write max(f, abs(z - 1.5) - 1.5) in the script or formula"
        ),
        BoundsError::EverythingInside { limit_mm } => format!(
            "everything is inside: f is negative all the way to ±{limit_mm} \
             mm; f must be positive outside the part (is the sign flipped?), \
             or cut it with {CUT}"
        ),
        BoundsError::Undecided { direction } => format!(
            "the model's bounds were not found: the ranges of f along \
             {direction} say too little (NaN, infinite or wildly \
             overestimated values); give them with {CUT}"
        ),
        BoundsError::NoBox { min, max } => format!(
            "the given bounds are no box: every lower number must be finite \
             and less than its upper one ({CUT}), got {min}:{max}"
        ),
        other => other.to_string(),
    }
}
