//! A slicer for implicit surfaces: from f(x, y, z) to G-code without a mesh.
//!
//! # What an implicit model is
//!
//! A function f(x, y, z) that is negative inside the part, positive outside
//! and zero on its surface. A ball of 15 mm is √(x² + y² + z²) − 15. It need
//! not be a distance: x²/400 + y²/144 + z²/64 − 1 describes an ellipsoid just
//! as well. The larger of two functions is the intersection of their parts,
//! the smaller one the union.
//!
//! # The tour
//!
//! Data flows one way, from the top of this list to its end; no module knows
//! those after it (`tests/architecture.rs` makes sure).
//!
//! 1. [`model`] reads a script, fidget's `.vm` text or a formula, bounds the
//!    part by interval arithmetic and places it on the bed. [`settings`] say
//!    how it is to be printed.
//! 2. [`layers`] cuts the height into layers. A layer is the function at one
//!    height, its sample plane, in the middle between top and bottom.
//! 3. [`field`] evaluates it there: interval arithmetic proves most tiles full
//!    or empty, many layers at a time, and simplifies the expression for the
//!    rest, which is sampled on a lattice.
//! 4. [`contour`] makes closed rings of the samples, moves vertices onto
//!    f = 0, puts back the corners and thins the rings: the layer's outline.
//!    The lattice only finds out what is connected; how accurate the outline
//!    is does not depend on it.
//! 5. [`region`] lays the walls, by distance in the layer's plane, not by the
//!    value of f, and splits what they leave into skin, where the layers above
//!    or below do not cover it, and the rest. [`plane`] has the geometry,
//!    [`bead`] the cross-section that says how far apart lines lie.
//! 6. [`walls`], [`skin`], [`infill`] and [`adhesion`] make beads of that,
//!    and [`fuzzy`] a texture. From here on beads are all there is. [`hang`]
//!    finds what nothing below holds while it is printed.
//! 7. [`seam`] says where loops may begin, and [`order`] puts all beads in a
//!    short order, one island at a time, and begins them there.
//! 8. [`travel`] connects them, and decides where to retract.
//! 9. [`pace`] gives every move its speed: by role, slower where the hot end
//!    or the cooling could not follow, and adds up the time.
//! 10. [`gcode`] writes it down, [`bgcode`] packs it for Prusa's printers;
//!     [`preview`] draws it; [`report`] measures how far it is from f = 0.
//!     [`reader`] reads G-code back, whoever wrote it.
//!
//! Settings that are expressions get their values from [`vary`].
//!
//! [`pipeline`] runs these stages over a window of layers that moves up the
//! part, on as many threads as there are; the result is the same on any
//! number. [`timings`] measures them, [`limits`] stops them when they take too
//! much time or memory, [`files`] reads what they are given, [`encoding`]
//! takes text out of bytes, [`units`] names what is measured.
//!
//! # A ball
//!
//! ```
//! use isoslice::model::{
//!     BuildVolume, Placement, Source, SourceKind, load, place,
//! };
//! use isoslice::pipeline::{Options, slice};
//! use isoslice::settings::Settings;
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let source = Source::Text {
//!     name: "ball".into(),
//!     kind: SourceKind::Formula,
//!     text: "sqrt(x^2 + y^2 + z^2) - 3".into(),
//! };
//! let settings = Settings::default();
//! let bed = BuildVolume { x: 220.0, y: 220.0, z: 250.0 };
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
//! # Glossary
//!
//! One word per thing, here, in the settings and in the G-code's summary;
//! where a dialect of G-code has another word ("perimeter"), only
//! [`gcode`] knows it.
//!
//! | word | meaning |
//! |---|---|
//! | accuracy | greatest distance between what is made and what is meant, mm |
//! | bead | one extruded line: centre line, width, height, role |
//! | bridge | skin whose lines hang between supports |
//! | comb | lead a travel round what is in its way |
//! | field | the function's values in a layer's plane |
//! | first layer | the layer on the bed |
//! | flow | material extruded, as a share of the beads' volume |
//! | gap fill | bead as wide as the thin place that it fills |
//! | hanging | not held by what is below, while it is printed |
//! | hole | closed ring inside an island, outside of the part |
//! | infill | sparse lines where skin is not needed |
//! | island | connected piece of a layer, with its holes |
//! | layer | what is printed at one height |
//! | layer height | thickness of a layer, and height of its beads |
//! | line width | width of a bead, squeezed as it lies there |
//! | outline | border of the part in a layer: where f = 0 |
//! | overhang | wall that the layer below does not hold |
//! | prime | push forward what retraction has pulled back |
//! | reach | how far what hangs is from what holds it |
//! | retraction | pulling filament back, lest it ooze on a travel |
//! | ring | closed line, counter-clockwise round a part, clockwise round a hole |
//! | role | what a bead is for: outer wall, skin, … |
//! | sample plane | height at which a layer's function is evaluated |
//! | seam | where a closed bead begins and ends |
//! | skin | solid area that faces up (top) or down (bottom), some layers deep |
//! | skirt | loop round the part that starts the flow |
//! | slab | layers whose field is evaluated together |
//! | spacing | distance of the centre lines of neighbouring beads |
//! | travel | move without extruding |
//! | wall | bead along the outline; the outer wall is the one that shows |
//! | wipe | go on along a bead while retracting |
//! | z-hop | lifting the nozzle on a travel |

// What goes wrong is an error. The tests may panic, that is how they fail; and
// indices are allowed, since the geometry is full of them: the fuzzer and the
// hostile models look after those.
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

pub mod adhesion;
pub mod bead;
pub mod bgcode;
pub mod check;
pub mod contour;
pub mod encoding;
pub mod files;
pub mod fuzzy;
pub mod gcode;
pub mod hang;
pub mod infill;
pub mod layers;
pub mod limits;
pub mod model;
pub mod order;
pub mod pace;
pub mod pipeline;
pub mod plane;
pub mod preview;
pub mod reader;
pub mod region;
pub mod report;
pub mod seam;
pub mod settings;
pub mod skin;
pub mod timings;
pub mod travel;
pub mod units;
pub mod vary;
pub mod walls;
