//! The settings of a print, each with its unit, range and meaning.
//!
//! In: TOML files and `key=value` assignments. [`Builder`] reads them in order,
//! and the last one wins. Out: one typed [`Settings`] and warnings about
//! combinations that are allowed but unlikely to print well.
//!
//! A program that uses the library gives and reads settings by their names as
//! well, so that it still compiles when settings are added or renamed.
//!
//! Guaranteed: nothing that is given is silently ignored. An unknown key, a
//! wrong type, a value outside its range or a combination that cannot be
//! printed is an error that names the place, the key, the value and the remedy.
//! The text of [`Settings::to_toml`] reads back as equal settings. Not
//! guaranteed: that the G-code templates make sense to the printer.
//!
//! [`Profiles`] are files of settings under names, for printers, filaments and
//! kinds of print. Many are part of the program.
//!
//! Threads, pictures and progress are no settings: equal settings and models
//! give the same bytes on any machine.
//!
//! Everything follows from the table in `rows`: the structs, their defaults,
//! units, ranges, descriptions, the key names (`speed.outer_wall`), reading and
//! writing.
//!
//! ```
//! use isoslice_settings::{Builder, keys};
//!
//! let mut builder = Builder::new();
//! builder.toml("my.toml", "walls = 3\n[speed]\nouter_wall = 25")?;
//! builder.set("infill_density=25%")?;
//! let (settings, warnings) = builder.finish()?;
//! assert!(warnings.is_empty());
//! let speed = keys().iter().find(|key| key.name == "speed.outer_wall");
//! assert_eq!(speed.map(|key| key.get(&settings)), Some("25".to_owned()));
//! # Ok::<(), isoslice_settings::SettingsError>(())
//! ```

#![warn(unreachable_pub)]

mod by_nozzle;
mod check;
mod derived;
mod error;
mod firmware;
mod foreign;
mod gone;
mod head;
mod idle;
mod infill;
mod layer_heights;
pub mod layers;
mod line_density;
mod overhang;
mod pair;
mod profile;
mod read;
mod rows;
mod schema;
mod shell;
mod shipped;
mod sizes;
mod skin_patterns;
mod steps;
mod switch;
mod table;
#[doc(hidden)]
pub mod testing;
mod text;
mod value;
mod word_or_number;
mod words;
mod write;

pub use error::{GivenIn, SettingsError};
pub use foreign::name as foreign_name;
pub use gone::instead;
pub use profile::{Origin, Profile, Profiles};
pub use read::Builder;
pub use rows::Settings;
pub use shipped::ProfileKind;
pub use table::{Key, keys, name_now};
pub use value::Range;

pub use by_nozzle::ByNozzle;
pub use derived::{FullAngle, THICKNESS_SLACK};
pub use firmware::{Pauses, Refusals};
pub use head::HeadRoom;
pub use infill::Infill;
pub use layer_heights::LayerHeights;
pub use line_density::LineDensity;
pub use overhang::{OfOverhangs, OverhangFan, OverhangSpeed};
pub use pair::{ElephantFoot, HeadClearance, Scarf};
pub use rows::{
    Acceleration, Brim, Cooling, Filament, FuzzySkin, Printer, Retract, Skirt,
    Speed, Support,
};
pub use shell::Shell;
pub use sizes::Sizes;
pub use sizes::{ImageFormat, PictureSize};
pub use skin_patterns::SkinPatterns;
pub use steps::Steps;
pub use switch::SwitchOr;
pub use value::Varying;
pub use word_or_number::{DraftShield, InfillMode, InterfacePattern};
pub(crate) use words::InterfaceShape;
pub use words::{
    BrimPlace, Combing, Comments, Emit, Flavour, Hidden, HopWhen,
    InfillPattern, PlateSequence, SeamRule, SkinPattern, SkinWhere,
    SupportStyle, Supports, WallOffset, WallOrder,
};
