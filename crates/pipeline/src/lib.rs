//! The stages, over a window of layers that moves up the part.
//!
//! ```text
//!   what runs through the part: layers' heights, supports, seams, ends of layers
//!      ▼
//!   slabs of layers, in parallel     layers, in parallel           in order
//!   field → contour              ──► walls, skin, infill,     ──►  pace, G-code
//!                                    order, travel
//! ```
//!
//! While some layers are written, the next ones are made. Only the window is kept,
//! and nothing of what has been written, so memory does not grow with the part's
//! height. A part with supports is an exception: they are planned from the top down,
//! and their plan has coarse areas for all layers. The result does not depend on the
//! number of threads: every layer is computed in one way whoever does it.
//!
//! A layer's text does not depend on which layers a run is asked for, either. A
//! layer depends on the outlines around it, on what was planned before any layer was
//! made, and on where the layer below ends, but not on how that was printed. The
//! exceptions are internal bridges and infill that may stand on nothing: `lower` in
//! `supply` says on what they depend. So parts too large for one machine are sliced
//! in ranges of layers whose texts are then joined.
//!
//! | file | what it does |
//! |---|---|
//! | `options`, `summary`, `error` | what goes into a run, and what comes out |
//! | `run` | slices a plate, and checks what was written |
//! | `start` | threads, rafts and the heights of layers |
//! | `job` | plans what needs whole parts |
//! | `write` | the steps of a run, one after the other |
//! | `head` | what a file's start says, and its pictures |
//! | `skirt` | the skirt round several parts |
//! | `plans` | what the stages of a part do, resolved from its settings |
//! | `layer` | what is known of a layer on its way |
//! | `stages` | what can be done for many layers at a time |
//! | `raft` | layers between the bed and the part |
//! | `supported` | the supports of a part, layer by layer |
//! | `posts` | walls of supports that many of their islands share |
//! | `standing` | the supports of a plate, for its picture |
//! | `sound` | notices early that next to nothing can be printed |
//! | `supply` | runs `stages` for a window of layers, with internal bridges, ahead of those that are written |
//! | `part`, `ways` | from the beads of a layer of a part to their order and to its path |
//! | `sums` | what is counted of each part, in order |
//! | `follow` | follows what hangs from layer to layer |
//! | `hanging` | tells what hangs when no bead is laid |
//! | `pacing` | what is done in order for all parts, up to the speeds of moves |
//! | `exit` | the steps that are done in order, each ahead of the next, and the text |
//! | `ahead` | threads of steps that work ahead of others |
//! | `split` | divides layers into ranges of about equal cost |
//! | `fingerprint` | what files of ranges of one print have in common |
//! | `report` | measures how far outlines and walls are from f = 0 |
//! | `tally` | counts over all layers, and warnings that follow from the counts |

#![warn(unreachable_pub)]

mod ahead;
mod error;
#[cfg(test)]
mod estimates;
mod exit;
mod fingerprint;
mod follow;
mod hanging;
mod head;
mod job;
mod layer;
mod options;
mod pacing;
mod part;
mod plans;
mod posts;
mod raft;
mod report;
mod run;
mod skirt;
mod sound;
mod split;
mod stages;
mod standing;
mod start;
mod summary;
mod sums;
mod supply;
mod supported;
mod tally;
mod ways;
mod write;

pub use error::SliceError;
pub use hanging::{Survey, survey};
pub use options::Options;
pub use report::{Figures, RoleSum};
pub use run::{slice, slice_plate};
pub use split::{Share, split};
pub use standing::supports;
pub use summary::{PartSummary, Summary};
