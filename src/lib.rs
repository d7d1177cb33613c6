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
//! Data flows one way, from the top of this list to its end. No module knows
//! the modules after it, which `tests/architecture.rs` makes sure of.
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
//! 5. [`region`] lays the walls, by distance in the layer's plane, not by the
//!    value of f. It splits the area inside them into skin, where the layers
//!    above or below do not cover it, and area for infill. [`plane`] has the
//!    geometry, [`bead`] the cross-section that says how far apart lines lie.
//! 6. [`walls`], [`skin`], [`infill`] and [`adhesion`] make beads of walls and
//!    areas, and [`fuzzy`] gives outer walls a texture. All later stages work
//!    on beads. [`hang`] finds what nothing below holds while it is printed.
//!    [`support`] plans what is printed below to hold it.
//! 7. [`seam`] says where loops may begin. [`order`] lets them begin there, and
//!    puts all beads in an order with short travels, one island at a time.
//!    Beads that nobody sees go on in the next one where that is near.
//!    [`spiral`] lays one climbing wall in place of all beads. [`relief`] lets
//!    beads follow the surface above them.
//! 8. [`travel`] connects the beads, and decides where to retract.
//! 9. [`pace`] gives every move its speed: by role, and slower where the hot
//!    end or the cooling could not follow. It adds up the time.
//! 10. [`gcode`] writes the G-code, [`bgcode`] packs it for Prusa's printers
//!     and [`package`] for Bambu Lab's. [`reader`] reads G-code of any slicer,
//!     and [`mod@check`] tells whether it is safe to run. [`preview`] draws it.
//!     [`report`] measures how far outlines and walls are from f = 0.
//!
//! The types that flow are a [`Model`], its
//! [`LayerSpan`](layers::LayerSpan)s, for each span an
//! [`Outline`](isocontour::Outline), its [`Walls`](region::Walls), the
//! [`Bead`](bead::Bead)s of walls and areas, a layer's
//! [`LayerBeads`](order::LayerBeads), its [`LayerPath`](travel::LayerPath) with
//! the travels between them, and its [`PacedLayer`](pace::PacedLayer), which is
//! written.
//!
//! Settings that are expressions get their values from [`vary`].
//!
//! [`pipeline`] runs these stages over a window of layers that moves up the
//! part, on any number of threads, which does not change the result.
//! `pipeline/write.rs` has the steps of a run, `pipeline/stages` what is done
//! for many layers at a time. [`timings`] measures the stages, [`limits`] stops
//! them when they take too much time or memory, [`files`] reads files,
//! [`encoding`] reads text from bytes, [`units`] names units, [`sets`] joins
//! what belongs together, and [`random`] makes numbers that look random.
//!
//! The program around this library is the command line, `src/cli`. The crate
//! `slicerprofile` reads profiles of other slicers for it. `CONTRIBUTING.md`
//! says which files a new pattern of infill, a flavour of G-code, a kind of
//! number, a setting or a profile takes.
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
#![doc = include_str!("../docs/glossary.md")]
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

mod adhesion;
mod bead;
mod bgcode;
pub mod check;
mod contour;
mod encoding;
pub mod files;
mod fuzzy;
mod gcode;
mod hang;
pub mod heights;
mod infill;
pub mod layers;
pub mod limits;
pub mod model;
mod order;
mod pace;
mod package;
pub mod pipeline;
mod plane;
pub mod plate;
pub mod preview;
mod random;
pub mod reader;
mod region;
mod relief;
mod report;
mod resolution;
mod seam;
mod sets;
pub mod settings;
mod skin;
mod spiral;
mod stopwatch;
mod support;
mod timings;
mod travel;
mod units;
mod vary;
mod walls;

pub use bgcode::Unpacked;
pub use gcode::{Format, FormatError, TemplateError};
pub use gcode::{JoinError, Joined, Ranges};
pub use gcode::{settings_in_gcode, try_templates, understands_placeholder};
pub use hang::{Hanging, Kind, Sum, Unsupported};
pub use model::{Model, load, place};
pub use pipeline::{Options, SliceError, Summary, slice, slice_plate};
pub use pipeline::{Share, split};
pub use pipeline::{Survey, survey};
pub use plate::Plate;
pub use reader::Reader;
pub use report::{Figures, RoleSum};
pub use settings::Settings;
pub use timings::Stage;
pub use units::human_time;
