//! From a file or a formula to a model placed on the printer.
//!
//! ```text
//! Source ──load──► Loaded ──place──► Model
//! ```
//!
//! | file | what it does |
//! |---|---|
//! | `source` | reads a model, in whichever format |
//! | `script` | runs rhai scripts in a sandbox |
//! | `vm` | reads fidget's text |
//! | `formula` | reads one formula |
//! | `data` | what models read: meshes, drawings, pictures, volumes |
//! | `functions`, `term` | what scripts, formulas and Python call by name |
//! | `param` | parameters of scripts, `-D name=value`; `value`, `allowed`, what they may be |
//! | `placement` | scale, rotation and place, by the box that [`isocontour::find_bounds`] finds |
//! | `together` | makes one model of several |
//! | `written` | writes a model as words |
//! | `export` | writes a model as a 3MF file |
//! | [`expressions`] | evaluates settings that are expressions |
//! | [`heights`] | finds layers that follow the surface |
//! | [`contour`] | makes outlines under a run's limits |
//!
//! Guarantees: whatever the input, there is an error or a model within bounded
//! time and memory, without panics and without recursion on the caller's stack.
//! Equal input gives the same model (a time limit can only turn it into an
//! error).
//!
//! Not guaranteed: that the model is printable, or one body.

#![warn(unreachable_pub)]

mod allowed;
pub mod contour;
mod data;
mod error;
mod export;
pub mod expressions;
mod formula;
mod functions;
pub mod heights;
mod param;
mod placement;
mod power;
mod probe;
mod script;
mod source;
mod term;
mod testing;
mod together;
mod value;
mod vm;
mod written;

pub use allowed::Allowed;
pub use data::is_mesh;
pub use error::LoadError;
pub use expressions::expression::Place;
pub use expressions::expression::{Expression, ExpressionError};
pub use formula::FormulaError;
pub use isocontour::Bounds;
pub use param::{ParamError, Parameter};
pub use placement::{BuildVolume, Model, PlaceError, Placement, place};
pub use probe::ProbeError;
pub use probe::{Probe, Spot};
pub use script::{Argument, ScriptError, ScriptLimits, call, makes_body};
pub use source::{Loaded, Source, SourceKind, load, load_within};
#[doc(hidden)]
pub use testing::placed;
pub use together::together;
pub use vm::{VmError, parse_vm};
pub use written::operations;
