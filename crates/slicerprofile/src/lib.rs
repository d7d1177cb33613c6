//! Reads the profiles of other slicers, and says what each key means to
//! isoslice.
//!
//! In: a file of PrusaSlicer (`.ini`, a bundle of them, or its G-code),
//! OrcaSlicer and Bambu Studio (`.json`, or their G-code), or Cura
//! (`.curaprofile`, `.def.json`, `.inst.cfg`). Out: a [`Translation`]: the
//! settings of isoslice that follow from the file, and for every other key the
//! reason why no setting follows from it.
//!
//! Guaranteed: every key of the profile is in exactly one of the four lists of
//! the [`Translation`]; reading takes bounded time and memory whatever is in a
//! file; there are no panics. Not guaranteed: that the values are in the ranges
//! that isoslice allows, which only isoslice knows.
//!
//! ```
//! # fn main() -> Result<(), slicerprofile::Error> {
//! # let folder = tempfile::tempdir().unwrap();
//! # let path = folder.path().join("my.ini");
//! # std::fs::write(&path, "perimeters = 3\nfill_density = 15%\nthreads = 4\n").unwrap();
//! let source = slicerprofile::Source::open(&path, &[])?;
//! let translation = slicerprofile::translate(&source.pick(&[])?);
//! assert_eq!(translation.settings[0].name, "walls");
//! assert_eq!(translation.ignored[0].key, "threads");
//! # Ok(())
//! # }
//! ```

/// Makes a slice of pairs. Several words before one `=>` each make a pair with
/// what is behind it.
macro_rules! pairs {
    ($($($word:expr),+ => $meaning:expr;)+) => {
        &[$($(($word, $meaning)),+),+]
    };
}

mod archive;
mod conversion;
mod cura;
mod error;
mod fill;
mod formula;
mod gcode;
mod given;
mod ini;
mod orca;
mod parents;
mod project;
mod source;
mod table;
mod template;
mod translate;
mod values;

pub use error::Error;
pub use fill::{Filled, fill};
pub use given::Value;
pub use source::{Named, Picked, Slicer, Source, both_ends};
pub use table::{Counterpart, PresetKind, Row, Rule, counterpart, rows};
pub use template::{
    NotTranslated, Place, foreign_names, translated, understands,
};
pub use translate::{Left, Setting, Translation, translate};
pub use values::Values;

pub(crate) use source::{MOST_BYTES, bytes_of};
