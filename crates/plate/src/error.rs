//! Why there is no plate.

use super::{Plate, Wanted};
use isoslice_model::{LoadError, PlaceError};
use isoslice_settings::SettingsError;

/// Why parts cannot be printed together.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PlateError {
    /// There is nothing on the plate.
    #[error(
        "there is nothing on the plate; give it a model, with copies = 1 or \
         more"
    )]
    Empty,
    /// There is too much on the plate.
    #[error(
        "{count} parts are more than a plate may have: at most {}",
        Plate::MOST_PARTS
    )]
    TooMany {
        /// How many parts were asked for.
        count: u64,
    },
    /// A part has another value of a setting that holds for the whole plate.
    #[error(
        "{asked}: {key} = {value} differs from the plate's {of_plate}, and all \
         parts on a plate share this setting; set it for the whole plate \
         instead"
    )]
    Differs {
        /// Where the part is asked for.
        asked: String,
        /// Name of the setting.
        key: &'static str,
        /// The part's value.
        value: String,
        /// The plate's value.
        of_plate: String,
    },
    /// Several copies are asked for in one place.
    #[error(
        "{asked}: {copies} copies cannot all stand in one place; leave `at` \
         out, or write a [[part]] for each of them"
    )]
    CopiesInOnePlace {
        /// Where the copies are asked for.
        asked: String,
        /// How many copies are asked for.
        copies: u64,
    },
    /// A part with a climbing wall is asked for beside other parts.
    #[error(
        "{asked}: spiral prints one part, as its wall climbs without a \
         break; slice the parts one by one, or set spiral = false"
    )]
    Spiral {
        /// Where the part is asked for.
        asked: String,
    },
    /// The model's own coordinates are asked for on a plate of several parts.
    #[error(
        "{asked}: --keep-position is for a single part; tell where the parts \
         stand with `at` in a plate file"
    )]
    KeptPosition {
        /// Where the part is asked for.
        asked: String,
    },
    /// A model cannot be loaded.
    #[error("{asked}: the model cannot be loaded")]
    Load {
        /// Where the model is asked for.
        asked: String,
        /// Why the model cannot be loaded.
        #[source]
        error: Box<LoadError>,
    },
    /// A model cannot be placed.
    #[error("{asked}: {name} cannot be placed")]
    Place {
        /// Where the model is asked for.
        asked: String,
        /// Name of the model.
        name: String,
        /// Why the model cannot be placed.
        #[source]
        error: PlaceError,
    },
    /// A part with a place is not all on the bed.
    #[error(
        "{name} would reach beyond the bed ({excess}); choose another `at` for \
         it, or leave `at` out to have a place found"
    )]
    OffBed {
        /// Name of the part.
        name: String,
        /// The sides of the bed that the part exceeds, and by how much.
        excess: String,
    },
    /// Two parts with places overlap.
    #[error(
        "{first} and {second} overlap by {x:.2} × {y:.2} mm: their boxes do, \
         seen from above, with their brims and rafts; move one of them with \
         `at`, or leave `at` out to have a place found"
    )]
    Overlap {
        /// Name of one part.
        first: String,
        /// Name of the other part.
        second: String,
        /// By how much they overlap along x, mm.
        x: f64,
        /// By how much they overlap along y, mm.
        y: f64,
    },
    /// A part finds no place.
    #[error(
        "there is no place for {name}, {size} mm{with} on the bed: {placed} of \
         {count} parts fit on the bed of {bed} mm with {spacing} mm between \
         them; print fewer at a time, lower plate.spacing (or, if they are \
         printed one by one, print all at once), or turn or scale them"
    )]
    Full {
        /// The first part without a place.
        name: String,
        /// Size of that part.
        size: String,
        /// What belongs to that part.
        with: &'static str,
        /// How many parts have a place.
        placed: usize,
        /// How many parts there are.
        count: usize,
        /// Size of the bed.
        bed: String,
        /// The distance between parts, mm.
        spacing: f64,
    },
    /// It is not known how much room the head needs.
    #[error(
        "plate.sequence = \"one-by-one\" needs to know how much room the head \
         takes beside finished parts: set printer.head_clearance_radius, the \
         distance from the nozzle to the head's farthest edge seen from above, \
         and printer.gantry_height, the height above the nozzle's tip of the \
         beam that carries the head"
    )]
    UnknownHead,
    /// A draft shield is asked for round parts that are printed one by one.
    #[error(
        "a draft shield goes round all parts, and the head could not pass it \
         with plate.sequence = \"one-by-one\"; set draft_shield = \"off\", or \
         plate.sequence = \"all-at-once\""
    )]
    ShieldOneByOne,
    /// The head would hit a part that is finished.
    #[error(
        "{later} is {apart:.1} mm beside {first}, which is finished before it: \
         the head needs {radius:.1} mm (printer.head_clearance_radius) between \
         their boxes; move them apart with `at`, leave `at` out to have places \
         found, or set plate.sequence = \"all-at-once\""
    )]
    TooNear {
        /// The part that is finished first.
        first: String,
        /// The part that is printed beside it.
        later: String,
        /// How far they are from each other, mm.
        apart: f64,
        /// How far they should be from each other, mm.
        radius: f64,
    },
    /// What carries the head would hit a part that is finished.
    #[error(
        "{first} is {height:.1} mm high, and {later} is printed after it: of \
         parts that are printed one by one only the last may be higher than \
         {gantry:.1} mm (printer.gantry_height){but}; print one of them alone, \
         or \
         set plate.sequence = \"all-at-once\""
    )]
    TooHigh {
        /// The part that is finished first.
        first: String,
        /// Height of the part that is finished first, mm.
        height: f64,
        /// The part that is printed after it.
        later: String,
        /// How high the first part may be, mm.
        gantry: f64,
        /// The exception, if there is one.
        but: String,
    },
    /// A plate file cannot be read.
    #[error("cannot read the plate file {file}: {cause}")]
    Unreadable {
        /// The file's name.
        file: String,
        /// Why the file cannot be read.
        cause: String,
    },
    /// A plate file is not understood.
    #[error("{place}: {message}")]
    File {
        /// The file and the line.
        place: String,
        /// What is wrong, and what to write.
        message: String,
    },
    /// Something is wrong with all parts of a plate file.
    #[error("{file}: {error}")]
    InFile {
        /// The file's name.
        file: String,
        /// What is wrong.
        error: Box<PlateError>,
    },
    /// The settings in a plate file are wrong.
    #[error(transparent)]
    BadSettings(#[from] SettingsError),
}

impl PlateError {
    /// The error with the file and the line that asks for each part it names,
    /// and with the file that it is about if it names none.
    pub(super) fn located(mut self, wanted: &[Wanted]) -> PlateError {
        let copies = wanted.iter().flat_map(|one| {
            let most = one.copies.min(Plate::MOST_PARTS) as usize;
            std::iter::repeat_n(one, most)
        });
        let copies: Vec<&Wanted> = copies.collect();
        let names: Vec<String> =
            copies.iter().map(|one| one.source.name()).collect();
        let names = super::names(names.iter().map(String::as_str));
        let locate = |part: &mut String| {
            let at = names.iter().position(|name| name == part);
            if let Some(line) = at.and_then(|at| copies[at].line()) {
                *part = format!("{part} ({line})");
            }
        };
        match &mut self {
            PlateError::OffBed { name, .. } | PlateError::Full { name, .. } => {
                locate(name);
            }
            PlateError::Overlap { first, second, .. }
            | PlateError::TooNear {
                first,
                later: second,
                ..
            }
            | PlateError::TooHigh {
                first,
                later: second,
                ..
            } => {
                locate(first);
                locate(second);
            }
            PlateError::Empty
            | PlateError::TooMany { .. }
            | PlateError::UnknownHead
            | PlateError::ShieldOneByOne => {
                let line = wanted.first().and_then(Wanted::line);
                let file = line.and_then(|line| line.rsplit_once(':'));
                if let Some((file, _)) = file {
                    return PlateError::InFile {
                        file: file.to_owned(),
                        error: Box::new(self),
                    };
                }
            }
            // The others tell where the part is asked for.
            _ => {}
        }
        self
    }
}
