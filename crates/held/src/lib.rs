//! What holds what is printed.
//!
//! In: the outlines of a part's layers, from below, and plans of plain numbers.
//! Out: what nothing below holds while it is printed ([`overhangs`]), and the areas
//! that are printed below to hold it ([`support`]).
//!
//! One judge decides for both what of a layer the layer below does not hold
//! (`overhangs/judge.rs`): warnings, `isoslice info --supports` and supports
//! agree, except that supports do not count lines of skin as bridges where `bridge_max`
//! is 0.
//!
//! Guarantees: the same outlines give the same answer, on any number of threads.
//! What is listed as hanging is larger than a bead, and no bridge holds it.
//!
//! Not known here: the beads of supports, their order, and G-code.

#![warn(unreachable_pub)]

pub mod overhangs;
pub mod support;
