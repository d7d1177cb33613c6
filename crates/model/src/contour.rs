//! The outlines of a slab's layers, under a watch and with the time they take.
//!
//! The crate [`isocontour`] does the work. This module adds the program's
//! watch, its timings, and advice about errors.

use fidget::context::Tree;
use isocontour::{Phase, outlines_in_phases};
use isoslice_base::limits;
use isoslice_base::timings::{Lap, Stage, Timings};
use isoslice_base::units::Mm;
use isoslice_planar::Rect;
use std::ops::Range;

pub use isocontour::{Detail, Field, FieldError, Outline};

/// The field `tree` + `depth` over a box in the plane, sampled every `spacing`
/// millimetres, under the watch of the threads that will evaluate it.
///
/// # Errors
/// If the lattice would be too large, or fidget refuses the expression.
pub fn field(
    tree: &Tree,
    depth: Mm,
    bounds: Rect,
    spacing: Mm,
) -> Result<Field, FieldError> {
    let field = Field::new(tree, depth, bounds, spacing)?;
    Ok(field.with_cancel(limits::Watch::hook()))
}

/// Does what [`field`] does, for the part of a model within a window parallel
/// to the axes.
///
/// # Errors
/// Those of [`field`].
pub fn field_in(
    tree: &Tree,
    window: Rect,
    spacing: Mm,
) -> Result<Field, FieldError> {
    let middle = 0.5 * (window.max + window.min);
    let half = 0.5 * window.size();
    let (x, y, _) = Tree::axes();
    let beyond_x = (x - middle.x as f32).abs() - half.x as f32;
    let beyond_y = (y - middle.y as f32).abs() - half.y as f32;
    let cut = tree.max(beyond_x.max(beyond_y));
    field(&cut, 0.0, window, spacing)
}

/// Outlines of the layers at heights `z`, at most a slab of them. The time they
/// take goes to `timings`.
///
/// # Errors
/// If the field changes its sign finer than `detail.smallest` over large parts
/// of the slab, or if fidget fails, which is a bug, or if the watch stops the
/// work.
pub fn outlines(
    field: &Field,
    z: &[Mm],
    needed: &Range<usize>,
    detail: Detail,
    timings: &Timings,
) -> Result<Vec<Outline>, FieldError> {
    let mut lap: Option<Lap<'_>> = None;
    let found = outlines_in_phases(field, z, needed, detail, &mut |phase| {
        // The last phase ends before the next one begins.
        lap = None;
        lap = Some(timings.begin(match phase {
            Phase::Sampling => Stage::Field,
            Phase::Tracing | Phase::Closing => Stage::Contour,
        }));
    });
    drop(lap);
    found
}

/// What to do about a field that has no outlines.
pub fn remedy(error: &FieldError) -> &'static str {
    match error {
        FieldError::TooLarge { .. } => "; raise sample_spacing",
        FieldError::TooFine { .. } => {
            " (lengths are mm in the model's coordinates, as it is turned and \
             scaled; the limit is a quarter of a line's width). Let the \
             expression oscillate less, or scale the part up (--scale)"
        }
        FieldError::Evaluator(_) => {
            "; this is a bug of isoslice: please report it with the model"
        }
        _ => "",
    }
}
