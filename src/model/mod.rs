//! From a file or a formula to a model placed on the printer.
//!
//! ```text
//! Source ──load──► Loaded ──place──► Model
//! ```
//!
//! - `source`: which format, reading; `script` (rhai, sandboxed), `vm`
//!   (fidget's text), `formula` (one expression), `expression` (of settings), `param` (`-D name=value`)
//! - `expand`: bounds on what an expression may grow to
//! - `bounds`: the tight box of {f < 0} by interval arithmetic, on top of
//!   `program` (the expression over boxes, each a `cell`) and `interval`
//! - `placement`: scale, rotation, position; `shift`: the origin of what is far
//!   from it
//!
//! Guarantees: whatever the input, an error or a model within bounded time
//! and memory, without panics and without recursion on the caller's stack;
//! the same input always gives the same model (a time limit can only turn it
//! into an error).
//!
//! Not guaranteed: that the model is printable, or one body.

mod bounds;
mod cell;
mod error;
mod expand;
mod expression;
mod formula;
mod interval;
mod param;
mod placement;
mod power;
mod program;
mod script;
mod shift;
mod source;
mod vm;

pub use bounds::{
    Bounds, BoundsError, FoundBounds, SearchOptions, find_bounds,
};
pub use error::LoadError;
pub use expand::{ExpandError, MAX_EXPANDED_NODES};
pub use expression::{Expression, ExpressionError, Place};
pub use formula::{FormulaError, parse_formula};
pub(crate) use interval::Interval;
pub use param::{ParamError, Parameter};
pub use placement::{BuildVolume, Model, PlaceError, Placement, place};
pub use script::{ScriptError, ScriptLimits};
pub use source::{Loaded, Source, SourceKind, load, load_within};
pub use vm::{VmError, parse_vm};
