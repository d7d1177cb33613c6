//! Why a run fails, in words that say what to do about it.

use crate::report::ReportError;
use isocontour::{Cancelled, ExpandError};
use isoslice_base::units::Mm;
use isoslice_gcode::WriteError;
use isoslice_gcode_read::reader::ReadError;
use isoslice_layer::infill::InfillError;
use isoslice_model::contour::{FieldError, remedy};
use isoslice_model::expressions::QuantityError;
use isoslice_model::heights::HeightsError;
use isoslice_path::spiral::SpiralError;
use isoslice_path::z_contouring::ZContouringError;
use isoslice_plate::{Part, Plate};
use isoslice_preview::PictureError;
use isoslice_settings::layers::PlanError;
use std::io;
use std::path::PathBuf;

/// What to do if the system gives no threads.
const NO_THREADS: &str = "cannot start the worker threads; try --threads 1, or \
                          raise what the system allows (ulimit -v, ulimit -u)";

/// Why a run failed.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SliceError {
    /// The range of layers lies above the part.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// No layers can be made of the part.
    #[error(transparent)]
    Heights(#[from] HeightsError),
    /// The field cannot be evaluated.
    #[error("{}{}", .0, remedy(.0))]
    Field(#[from] FieldError),
    /// A setting that is an expression has no value somewhere.
    #[error(transparent)]
    Vary(#[from] QuantityError),
    /// The watch has stopped the work.
    #[error(transparent)]
    Stopped(#[from] Cancelled),
    /// The expression is too large.
    #[error(transparent)]
    Expression(#[from] ExpandError),
    /// The infill cannot be laid.
    #[error(transparent)]
    Infill(#[from] InfillError),
    /// The G-code cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// On its raft the part is higher than the printer prints.
    #[error(
        "on its raft of {lift:.3} mm the part is {:.3} mm too high: its top is \
         at {top:.3} mm, and the printer has {most} mm; lower raft.layers, or \
         make the part smaller with --size or --scale",
        top - most
    )]
    RaftTooHigh {
        /// Height of the raft and of the air above it, mm.
        lift: Mm,
        /// Height of the part's top, mm.
        top: Mm,
        /// Greatest height of a print, mm.
        most: Mm,
    },
    /// No layer has anything in it that a nozzle could print.
    #[error(
        "nothing to print: in each of the {layers} layers the part is \
         thinner than any line ({line:.2} mm wide); scale it up with --size \
         or --scale, or lower outer_wall_width or thin_min"
    )]
    NothingToPrint {
        /// How many layers were looked at.
        layers: usize,
        /// Width of the outer wall, mm.
        line: Mm,
    },
    /// Hardly any of the part is as thick as a line.
    #[error(
        "next to nothing to print: in {looked} places looked at, all over the \
         part, {share:.0} % of its area is thinner than any line (by thin_min, \
         {line:.2} mm is enough for one); make it thicker, scale it up \
         with --size or --scale, or lower thin_min or outer_wall_width"
    )]
    TooThin {
        /// Number of the places looked at that had something in them.
        looked: usize,
        /// The share that is too thin, %.
        share: f64,
        /// Thickness of the thinnest place that gets a line, mm.
        line: Mm,
    },
    /// One part of several cannot be sliced.
    #[error("{name}: {error}")]
    OfPart {
        /// Name of the part's model.
        name: String,
        /// The part's error.
        error: Box<SliceError>,
    },
    /// There is nothing on the plate.
    #[error("there are no parts on the plate; give it one")]
    NoParts,
    /// Several parts cannot be measured.
    #[error(
        "--report measures one part, and there are several on the plate; \
         leave it out, or slice the parts one by one for their reports"
    )]
    ReportOfSeveral,
    /// A range of layers where there is none.
    #[error(
        "--layers takes layers of all parts together, and plate.sequence = \
         \"one-by-one\" prints one part after the other; leave it out, or set \
         plate.sequence = \"all-at-once\""
    )]
    RangeOneByOne,
    /// A range of layers for a file that holds whole prints.
    #[error(
        "a plate for Bambu Lab's printers (.gcode.3mf) holds a whole print, and \
         --layers asks for a part of it; write the ranges as .gcode"
    )]
    RangeInPlate,
    /// The parts are too many or too large for layers whose heights follow the
    /// surfaces.
    #[error(
        "layer_heights: the parts' expressions are too large together for \
         layers that follow all of their surfaces; set it to \"uniform\", or \
         slice the parts one by one"
    )]
    TooLargeTogether,
    /// The layers' pictures cannot be written.
    #[error("cannot write the pictures in {}", .0.display())]
    Picture(PathBuf, #[source] io::Error),
    /// The part cannot be drawn.
    #[error(transparent)]
    Drawing(#[from] PictureError),
    /// The part cannot be one climbing wall.
    #[error(transparent)]
    Spiral(#[from] SpiralError),
    /// Beads cannot follow the surface.
    #[error(transparent)]
    ZContouring(#[from] ZContouringError),
    /// The layers cannot be measured.
    #[error(transparent)]
    Report(#[from] ReportError),
    /// The threads cannot be started.
    #[error("{NO_THREADS}")]
    Threads(#[from] rayon::ThreadPoolBuildError),
    /// The thread that hands out work to the threads cannot be started.
    #[error("{NO_THREADS}")]
    LayersThread(#[source] io::Error),
    /// The thread that checks the G-code cannot be started.
    #[error("cannot start a thread to check the G-code; try --no-check")]
    CheckThread(#[source] io::Error),
    /// The G-code cannot be read back.
    #[error("the G-code cannot be checked; --no-check leaves that out")]
    Unread(#[from] ReadError),
    /// A part touches the bed in next to nothing.
    #[error(
        "no line fits into the first layer of the part, which touches the bed \
         in hardly more than a point: the next layer would lie on air; set \
         supports = \"auto\", turn it, or cut its tip off in the model, as \
         max(f, 0.5 - z) does. --no-check writes it as it is"
    )]
    Floats,
    /// The G-code could hurt the printer or the print.
    #[error(
        "the G-code should not be run on this printer:\n{}\nIf the lines \
         come from a template (gcode.start, gcode.end, gcode.layer), mend \
         that; if not, please report it with the model. --no-check leaves \
         the check out",
        .0.join("\n")
    )]
    Unsafe(Vec<String>),
}

impl SliceError {
    /// An error of a part, with the part's name if there are several.
    pub(super) fn of(plate: &Plate, part: &Part, error: SliceError) -> Self {
        match plate.parts.len() {
            1 => error,
            _ => SliceError::OfPart {
                name: part.model.name.clone(),
                error: Box::new(error),
            },
        }
    }
}
