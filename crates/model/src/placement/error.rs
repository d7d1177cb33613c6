//! Why a model cannot be placed, and what to do about it.

use isocontour::{BoundsError, ExpandError};

/// Why a model cannot be placed.
#[derive(Debug, thiserror::Error, PartialEq)]
#[non_exhaustive]
pub enum PlaceError {
    /// The model has no usable extent. The message says all that the bounds'
    /// error says, so that error is no source of this one.
    #[error("{}", of_bounds(.0))]
    Bounds(BoundsError),
    /// The model is data and nothing else, and that is no body.
    #[error(
        "{name} alone is no body: its values are numbers, and nothing says \
         where a part ends; use it in one, as in max(part, z - 1 - f)"
    )]
    NumbersAlone {
        /// What messages call the data.
        name: String,
    },
    /// The model is data and nothing else, and all of it lies in a plane.
    #[error(
        "{name} is flat, and nothing is inside it; give it a thickness, as in \
         {name} - 0.5, or make it thick in the program that it is from"
    )]
    FlatAlone {
        /// What messages call the data.
        name: String,
    },
    /// The placed expression is too large.
    #[error(transparent)]
    Expression(#[from] ExpandError),
    /// A number that makes no sense.
    #[error("{option} {value}: {must}")]
    BadNumber {
        /// The option.
        option: &'static str,
        /// The option's value.
        value: f64,
        /// What it must be.
        must: &'static str,
    },
    /// Two options that contradict each other.
    #[error("{first} and {second} cannot be given together; drop one of them")]
    Conflict {
        /// One option.
        first: &'static str,
        /// The other option.
        second: &'static str,
    },
    /// A height is given for a model that depends on z.
    #[error(
        "--height: the model depends on z, so it has a height of its own; \
         leave the option out, or make the model larger with --size or --scale"
    )]
    HasHeight,
    /// The flat sides of a model are not known.
    #[error(
        "--lay: flat sides are known of meshes and of unions of up to 200 of \
         them without --bounds, and this model is something else, or flat; turn \
         it with --rotate-x, --rotate-y and --rotate-z"
    )]
    NoSides,
    /// The part is larger than the printer.
    #[error(
        "the part does not fit the printer: {size} mm, the printer has \
         {volume} mm ({excess}); make it smaller with --size or --scale, \
         turn it with --rotate-x/y/z, or set the printer's size"
    )]
    TooLarge {
        /// Size of the part.
        size: String,
        /// Size of the printer.
        volume: String,
        /// Axes and by how much they are exceeded.
        excess: String,
    },
    /// The part is small enough, but not on the bed.
    #[error(
        "the part would reach beyond the printer ({excess}); choose another \
         --at x,y, or leave --at and --keep-position out to have it centred"
    )]
    OffBed {
        /// Sides and by how much they are exceeded.
        excess: String,
    },
    /// The part's coordinates lie far from the printer.
    #[error(
        "with --keep-position the part would be {metres:.0} m away from the \
         printer, where its coordinates are; leave the option out to have it \
         centred, or move it in the program that made it"
    )]
    TooFar {
        /// How far from the origin they are, m.
        metres: f64,
    },
    /// Nothing of the part is above the bed.
    #[error(
        "with --keep-position all of the part lies below the bed (its top is \
         at z = {top_mm:.3} mm); leave the option out, or move the part up"
    )]
    BelowBed {
        /// Top of the part, mm.
        top_mm: f64,
    },
}

impl From<BoundsError> for PlaceError {
    fn from(error: BoundsError) -> Self {
        PlaceError::Bounds(error)
    }
}

/// Why a model has no bounds, and what to do about it.
fn of_bounds(error: &BoundsError) -> String {
    const CUT: &str = "--bounds x0,y0,z0:x1,y1,z1";
    match error {
        BoundsError::Unbounded {
            direction,
            at_mm,
            flipped,
        } => {
            let flipped = if *flipped {
                " (its outside is bounded: is the sign flipped? f must be \
                 negative inside)"
            } else {
                ""
            };
            format!(
                "the model is unbounded: it goes on along {direction} at \
                 {at_mm} mm; intersect it with a box or a ball, or cut it \
                 with {CUT}{flipped}"
            )
        }
        BoundsError::Empty { searched, cause } => {
            let cause = cause.as_ref().map(|cause| {
                format!(
                    "; in places f is NaN (not a number), which is outside: \
                     {cause}"
                )
            });
            format!(
                "the model is empty: f is nowhere negative within {searched}; \
                 f must be negative inside the part (an unsigned distance \
                 needs a thickness subtracted){}",
                cause.unwrap_or_default()
            )
        }
        BoundsError::NotANumber { searched, cause } => format!(
            "f is NaN (not a number) everywhere within {searched}, so there \
             is no part: {cause}; keep the operand in range, as with \
             max(0, …)"
        ),
        BoundsError::Flat { size: [x, y] } => format!(
            "the model has no height: f does not depend on z (it is a drawing \
             of {x:.3} × {y:.3} mm); give it a height with --height 3, or \
             write max(f, abs(z - 1.5) - 1.5) in the script or formula"
        ),
        BoundsError::EverythingInside { limit_mm } => format!(
            "everything is inside: f is negative all the way to ±{limit_mm} \
             mm; f must be positive outside the part (is the sign flipped?), \
             or cut it with {CUT}"
        ),
        BoundsError::Undecided { direction } => format!(
            "the model's bounds were not found: the ranges of f along \
             {direction} say too little (NaN, infinite or wildly \
             overestimated values); give them with {CUT}"
        ),
        BoundsError::NoBox { min, max } => format!(
            "the given bounds are no box: every lower number must be finite \
             and less than its upper one ({CUT}), got {min}:{max}"
        ),
        other => other.to_string(),
    }
}
