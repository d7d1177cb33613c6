//! What holds what is printed.
//!
//! In: the outlines of a part's layers, from below, and plans of plain numbers.
//! Out: what nothing below holds while it is printed ([`hang`]), and the areas
//! that are printed below to hold it ([`support`]).
//!
//! One judge decides for both what of a layer the layer below does not hold
//! (`hang/judge.rs`): warnings, `isoslice info --supports` and supports agree.
//!
//! Guarantees: the same outlines give the same answer, on any number of threads.
//! What is listed as hanging is larger than a bead; what bridges hold is not.
//!
//! Not known here: the beads of supports, their order, and G-code.

#![warn(unreachable_pub)]
#![allow(
    rustdoc::private_intra_doc_links,
    reason = "in the documentation of private items these links lead somewhere"
)]
// Failures are errors, not panics; only tests may panic. Indices are allowed,
// since geometry is full of them; the fuzzer and the hostile models test those.
#![cfg_attr(
    not(test),
    deny(
        clippy::panic,
        clippy::expect_used,
        clippy::unwrap_used,
        clippy::unreachable,
        clippy::todo,
        clippy::unimplemented,
        clippy::get_unwrap,
    )
)]

pub mod hang;
pub mod support;
