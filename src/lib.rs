//! A slicer for implicit surfaces: from f(x, y, z) to G-code without a mesh.
//!
//! # What an implicit model is
//!
//! It is a function f(x, y, z) that is negative inside the part, positive
//! outside and zero on its surface. A ball of 15 mm is √(x² + y² + z²) − 15. A
//! function need not be a distance: x²/400 + y²/144 + z²/64 − 1 describes an
//! ellipsoid. The larger of two functions describes the intersection of their
//! parts, the smaller one the union.
//!
//! # The tour
//!
//! Data flows one way, roughly from the top of this list to its end. Most parts
//! of the way are crates in `crates/`. `CONTRIBUTING.md` has their order, which
//! Cargo keeps. Inside `base`, `layer`, `held`, `gcode-read` and `path`,
//! `tests/architecture.rs` keeps the order of the modules.
//!
//! 1. [`model`] reads a script, fidget's `.vm` text or a formula, bounds the
//!    part by interval arithmetic and places it on the bed. [`settings`] say
//!    how to print it. A [`plate`] is one part or several, each with its
//!    settings and its places.
//! 2. [`layers`] cuts the height into layers. A layer is the function at one
//!    height, its sample plane, in the middle between top and bottom.
//!    [`mod@heights`] lets the layers' heights follow the surface.
//! 3. The crate [`isocontour`] evaluates the function there. Interval
//!    arithmetic proves most tiles full or empty, many layers at a time, and
//!    simplifies the expression for the other tiles, which are sampled on a
//!    lattice.
//! 4. The crate then makes the layer's outline: it makes closed rings of the
//!    samples, moves vertices onto f = 0, restores corners and thins the rings.
//!    The lattice only tells what is connected. The outline's accuracy does not
//!    depend on it. [`contour`] calls the crate under a run's limits.
//! 5. [`outline`] changes the outline for what the nozzle and the plastic will do.
//!    [`walls`] lays the walls, by distance in the layer's plane, not by the value
//!    of f. [`exposure`] splits the area inside them into skin, where the layers
//!    above or below do not cover it, and area for infill. [`planar`] has the
//!    geometry, [`bead`] the cross-section that says how far apart lines lie.
//! 6. [`walls`], [`skin`], [`infill`] and [`adhesion`] make beads of walls and
//!    areas, and [`fuzzy`] gives outer walls a texture. All later stages work
//!    on beads. [`overhangs`] finds what nothing below holds while it is printed.
//!    [`support`] plans what is printed below to hold it.
//! 7. [`seam`] says where loops may begin. [`order`] lets them begin there, and
//!    puts all beads in an order with short travels, one island at a time.
//!    Beads that nobody sees go on in the next one where that is near.
//!    [`spiral`] lays one climbing wall in place of all beads. [`z_contouring`] lets
//!    beads follow the surface above them.
//! 8. [`travel`] connects the beads, and decides where to retract.
//! 9. [`pace`] gives every move its speed: by role, and slower where the hot
//!    end or the cooling could not follow. It adds up the time.
//! 10. [`gcode`] writes the G-code, [`bgcode`] packs it for Prusa's printers
//!     and [`package`] for Bambu Lab's. [`reader`] reads G-code of any slicer,
//!     and [`mod@check`] tells whether it is safe to run. [`preview`] draws it.
//!
//! The types that flow are a [`Model`], its
//! [`LayerSpan`](layers::LayerSpan)s, for each span an
//! [`Outline`](isocontour::Outline), its [`Walls`], the
//! [`Bead`]s of walls and areas, a layer's
//! [`LayerBeads`], its [`LayerPath`] with
//! the travels between them, and its [`PacedLayer`], which is
//! written.
//!
//! Settings that are expressions get their values from [`expressions`].
//!
//! [`pipeline`] runs these stages over a window of layers that moves up the
//! part, on any number of threads, which does not change the result.
//! Its `write.rs` has the steps of a run, `stages` what is done for many layers
//! at a time, and `report` measures how far outlines and walls are from f = 0.
//! [`timings`] measures the stages, [`limits`] stops them when they take too much
//! time or memory, [`files`] reads files, [`encoding`] reads text from bytes,
//! [`units`] names units, [`sets`] joins what belongs together, [`named!`] names
//! the values of enums, and [`random`] makes numbers that look random.
//!
//! The program around this library is the command line, `src/cli`. The crate
//! `slicerprofile` reads profiles of other slicers for it. `CONTRIBUTING.md`
//! says which files a new pattern of infill, a flavour of G-code, a kind of
//! number, a setting, a step between stages or a profile takes.
//!
//! # A ball
//!
//! ```
//! use isoslice::model::{BuildVolume, Placement, Source, load, place};
//! use isoslice::pipeline::{Options, slice};
//! use isoslice::settings::Settings;
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let source = Source::formula("ball", "sqrt(x^2 + y^2 + z^2) - 3");
//! let settings = Settings::default();
//! let bed = BuildVolume::of(&settings);
//! let ball = place(&load(&source, &[])?, &Placement::default(), bed)?;
//!
//! let options = Options { threads: Some(2), ..Options::default() };
//! let mut gcode = Vec::new();
//! let summary = slice(&ball, &settings, &options, &mut gcode)?;
//!
//! // A ball of 6 mm in layers of 0.2 mm.
//! assert_eq!(summary.layers, 0..30);
//! let text = String::from_utf8(gcode)?;
//! assert_eq!(text.matches(";LAYER_CHANGE").count(), 30);
//! # Ok(())
//! # }
//! ```
//!
//! [`Bead`]: isoslice_planar::bead::Bead
//! [`LayerBeads`]: isoslice_path::order::LayerBeads
//! [`LayerPath`]: isoslice_path::travel::LayerPath
//! [`PacedLayer`]: isoslice_path::pace::PacedLayer
//! [`Walls`]: isoslice_layer::walls::Walls
//! [`adhesion`]: isoslice_layer::adhesion
//! [`bead`]: isoslice_planar::bead
//! [`bgcode`]: isoslice_gcode_read::bgcode
//! [`contour`]: isoslice_model::contour
//! [`encoding`]: isoslice_base::encoding
//! [`exposure`]: isoslice_layer::exposure
//! [`fuzzy`]: isoslice_layer::fuzzy
//! [`gcode`]: isoslice_gcode
//! [`overhangs`]: isoslice_held::overhangs
//! [`infill`]: isoslice_layer::infill
//! [`named!`]: isoslice_base::named
//! [`order`]: isoslice_path::order
//! [`outline`]: isoslice_layer::outline
//! [`pace`]: isoslice_path::pace
//! [`package`]: isoslice_gcode_read::package
//! [`planar`]: isoslice_planar
//! [`random`]: isoslice_base::random
//! [`z_contouring`]: isoslice_path::z_contouring
//! [`seam`]: isoslice_layer::seam
//! [`sets`]: isoslice_base::sets
//! [`skin`]: isoslice_layer::skin
//! [`spiral`]: isoslice_path::spiral
//! [`support`]: isoslice_held::support
//! [`timings`]: isoslice_base::timings
//! [`travel`]: isoslice_path::travel
//! [`units`]: isoslice_base::units
//! [`expressions`]: isoslice_model::expressions
//! [`walls`]: isoslice_layer::walls
//!
#![doc = include_str!("../docs/glossary.md")]
#![warn(unreachable_pub)]

// The command sees the library by this name, as other programs do.
extern crate self as isoslice;

#[doc(hidden)]
pub mod cli;

/// Checks whether G-code, of any slicer, is safe to run.
pub mod check {
    #[doc(inline)]
    pub use isoslice_check::{
        Finding, FindingKind, Rules, Severity, Verdict, check,
    };
}

/// Files that are read within limits, and written whole or not at all.
pub mod files {
    #[doc(inline)]
    pub use isoslice_base::files::{FileError, Output, OutputError};
    #[doc(inline)]
    pub use isoslice_base::files::{read, read_standard_input, read_text};
}

/// Heights of layers that follow the surface.
pub mod heights {
    use super::{Model, Settings};
    use isoslice_model::heights::HeightPlan;
    #[doc(inline)]
    pub use isoslice_model::heights::{Heights, HeightsError, Steps};

    /// The layers of a placed model, those of its raft included. With a raft the
    /// model has to be raised ([`Model::raised`]).
    ///
    /// # Errors
    /// If there are no layers, or too many, or an expression for their heights
    /// has no value.
    pub fn heights(
        model: &Model,
        settings: &Settings,
    ) -> Result<Heights, HeightsError> {
        isoslice_model::heights::heights(model, &HeightPlan::of(settings))
    }
}

/// The layers that a part is cut into.
pub mod layers {
    #[doc(inline)]
    pub use isoslice_settings::layers::{LayerRange, LayerSpan};
    #[doc(inline)]
    pub use isoslice_settings::layers::{PlanError, plan};
}

/// What a run may take of time and memory, and what it is doing.
pub mod limits {
    #[doc(inline)]
    pub use isoslice_base::limits::{Activity, Limits, Reason, Slow, Stopped};
    #[doc(inline)]
    pub use isoslice_base::limits::{TooLittleSpace, Watch, doing};
    #[doc(inline)]
    pub use isoslice_base::limits::{enough_space, processors};
}

/// Models: scripts, formulas and fidget's text, and their place on the bed.
pub mod model {
    #[doc(inline)]
    pub use isoslice_model::{Allowed, Argument, Bounds, BuildVolume};
    #[doc(inline)]
    pub use isoslice_model::{Expression, ExpressionError, FormulaError};
    #[doc(inline)]
    pub use isoslice_model::{LoadError, Loaded, Model, ParamError, Parameter};
    #[doc(inline)]
    pub use isoslice_model::{PlaceError, Placement, ProbeError};
    #[doc(inline)]
    pub use isoslice_model::{ScriptError, ScriptLimits, Source, SourceKind};
    // For the command line.
    #[doc(hidden)]
    pub use isoslice_model::is_mesh;
    #[doc(inline)]
    pub use isoslice_model::{VmError, call, load, load_within, makes_body};
    #[doc(inline)]
    pub use isoslice_model::{parse_vm, place};
}

/// The stages, run over the layers of a plate.
pub mod pipeline {
    #[doc(inline)]
    pub use isoslice_pipeline::{Options, PartSummary, Share, SliceError};
    #[doc(inline)]
    pub use isoslice_pipeline::{Summary, Survey, supports, survey};
    #[doc(inline)]
    pub use isoslice_pipeline::{slice, slice_plate, split};
}

/// A plate: what is printed in one go.
pub mod plate {
    #[doc(inline)]
    pub use isoslice_plate::Wanted;
    #[doc(inline)]
    pub use isoslice_plate::{Part, PartPlace, Plate, PlateError, PlateFile};
}

/// Pictures and pages of models and of G-code.
pub mod preview {
    #[doc(inline)]
    pub use isoslice_preview::{PictureError, Slabs, Toolpath, ToolpathError};
    #[doc(inline)]
    pub use isoslice_preview::{View, live_html};
}

/// A reader of G-code of any slicer.
pub mod reader {
    #[doc(inline)]
    pub use isoslice_gcode_read::reader::filament_diameter;
    #[doc(inline)]
    pub use isoslice_gcode_read::reader::{Event, Heater, Info, MachineState};
    #[doc(inline)]
    pub use isoslice_gcode_read::reader::{Move, Named, Problem, Problems};
    #[doc(inline)]
    pub use isoslice_gcode_read::reader::{ReadError, Reader, Role};
}

/// Settings of a print, and profiles of printers and filaments.
pub mod settings {
    #[doc(inline)]
    pub use isoslice_settings::{Builder, GivenIn, Key, Origin, Profile};
    #[doc(inline)]
    pub use isoslice_settings::{ProfileKind, Profiles, Range, Settings};
    #[doc(inline)]
    pub use isoslice_settings::{SettingsError, keys};
}

#[doc(inline)]
pub use isoslice_base::timings::Stage;
#[doc(inline)]
pub use isoslice_base::units::human_time;
#[doc(inline)]
pub use isoslice_gcode::is_placeholder;
#[doc(inline)]
pub use isoslice_gcode::{Format, FormatError, JoinError, Joined, Ranges};
#[doc(inline)]
pub use isoslice_gcode::{TemplateError, settings_in_gcode};
#[doc(inline)]
pub use isoslice_gcode_read::bgcode::Unpacked;
#[doc(inline)]
pub use isoslice_held::overhangs::{Hanging, OverhangKind, Sum, Unsupported};
#[doc(inline)]
pub use isoslice_pipeline::{Figures, RoleSum};
#[doc(no_inline)]
pub use model::{Model, load, place};
#[doc(no_inline)]
pub use pipeline::{Options, Share, SliceError, Summary, Survey};
#[doc(no_inline)]
pub use pipeline::{slice, slice_plate, split, survey};
#[doc(no_inline)]
pub use plate::Plate;
#[doc(no_inline)]
pub use reader::Reader;
#[doc(no_inline)]
pub use settings::Settings;

/// Tries the templates of settings on a part in the middle of the bed: what is
/// wrong with each of them.
pub fn try_templates(settings: &Settings) -> Vec<TemplateError> {
    isoslice_gcode::try_templates(&isoslice_gcode::WriterPlan::of(settings))
}
