//! Pictures, volumes and scattered samples as functions of three coordinates.
//!
//! In: the bytes of a file, or numbers in memory. Out: a [`Picture`], a
//! [`Volume`] or [`Samples`], which are [`isocontour::Data`]: they have a value and a gradient
//! at each place, and bounds of both over boxes.
//!
//! ```text
//!  PNG, JPEG, .npy ──► Picture ─┐
//!                               ├─► lattice: numbers, how to go between them,
//!  NRRD, NIfTI, .npy ► Volume ──┘   and pyramids of their bounds
//!  CSV, VTU ─────────► Samples ───► a tree of places
//! ```
//!
//! Guarantees: the same values on any machine; a value and its gradient are
//! exact for the interpolation (but for rounding), and bounds are never too
//! narrow. Files are not trusted: what they take is bounded by what they hold
//! and by [`MOST_BYTES`], and an error says what is wrong and what to do.
//!
//! Not guaranteed: whole numbers of 32 bits and more, and numbers of 64 bits,
//! are kept as 32-bit floating-point numbers, that is with 7 digits.

#![warn(unreachable_pub)]

mod lattice;
mod npy;
mod numbers;
mod picture;
mod samples;
mod sheets;
mod stream;
#[cfg(test)]
mod testing;
mod volume;

pub use lattice::{Border, Interpolation};
pub use numbers::Numbers;
pub use picture::{Picture, PictureOptions, TransparentAs};
pub use samples::{Between, Samples, SamplesOptions};
pub use sheets::Sheets;
pub use volume::{Axes, Volume, VolumeOptions};

/// The most memory that the numbers of one file may take, bytes: a volume of
/// 1024 × 1024 × 512 samples of 16 bits.
pub const MOST_BYTES: usize = 1 << 30;
