//! From a file or a formula to a model placed on the printer.
//!
//! ```text
//! Source ──load──► Loaded ──place──► Model
//! ```
//!
//! - `source`: which format, reading; `script` (rhai, sandboxed), `vm`
//!   (fidget's text), `formula` (one expression), `expression` (of settings), `param` (`-D name=value`)
//! - `placement`: scale, rotation, position, in the box that
//!   [`isocontour::find_bounds`] finds; `together`, several models as one;
//!   `written`, a model as words
//!
//! Guarantees: whatever the input, an error or a model within bounded time
//! and memory, without panics and without recursion on the caller's stack;
//! the same input always gives the same model (a time limit can only turn it
//! into an error).
//!
//! Not guaranteed: that the model is printable, or one body.

mod allowed;
mod error;
mod expression;
mod formula;
mod param;
mod placement;
mod power;
mod probe;
mod script;
mod source;
mod together;
mod value;
mod vm;
mod written;

pub use allowed::Allowed;
pub use error::LoadError;
pub(crate) use expression::Place;
pub use expression::{Expression, ExpressionError};
pub use formula::{FormulaError, parse_formula};
pub use isocontour::Bounds;
pub use param::{ParamError, Parameter};
pub use placement::{BuildVolume, Model, PlaceError, Placement, place};
pub use probe::ProbeError;
pub(crate) use probe::{Probe, Spot};
pub use script::{ScriptError, ScriptLimits};
pub use source::{Loaded, Source, SourceKind, load, load_within};
pub(crate) use together::together;
pub use vm::{VmError, parse_vm};
pub(crate) use written::operations;
