//! The outlines of a slab's layers, under a watch and with the time they take.
//!
//! The crate [`isocontour`] does the work. This module adds the program's
//! watch, its timings, and advice about errors.

mod sections;

use fidget::context::Tree;
use isocontour::{Cancel, Phase, Solid, outline_of, outlines_in_phases, solid};
use isoslice_base::limits;
use isoslice_base::timings::{Lap, Stage, Timings};
use isoslice_base::units::Mm;
use isoslice_planar::Rect;
use sections::Sections;
use std::ops::Range;

pub use isocontour::{Detail, FieldError, Outline, SLAB};

/// A field, ready for its outlines.
pub struct Field {
    sampled: isocontour::Field,
    /// Its sections, if they are known exactly.
    sections: Option<Sections>,
    cancel: Cancel,
}

impl Field {
    /// Number of layers whose outlines are found at a time.
    pub fn slab_layers(&self) -> usize {
        self.sampled.slab_layers()
    }

    /// How many of the layers at heights `z`, from the first one on, are found at a
    /// time: all of them, if they are surely alike and the field is walked at all.
    ///
    /// # Errors
    /// If it is stopped, or if fidget fails, which is a bug.
    pub fn at_a_time(&self, z: &[Mm]) -> Result<usize, FieldError> {
        let usual = self.slab_layers();
        let alike = z.len() > usual
            && self.sections.is_none()
            && self.sampled.is_level(z)?;
        Ok(if alike { z.len() } else { usual })
    }
}

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
    let cancel = limits::Watch::hook();
    let sampled = isocontour::Field::new(tree, depth, bounds, spacing)?;
    let solid = if depth == 0.0 { solid(tree) } else { None };
    let solid = solid.filter(Solid::has_sections);
    Ok(Field {
        sampled: sampled.with_cancel(cancel.clone()),
        sections: solid.map(|s| Sections::new(s, bounds)),
        cancel,
    })
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
    let Some(sections) = &field.sections else {
        return sampled(field, z, needed, detail, timings);
    };
    let mut all = Vec::with_capacity(z.len());
    for (k, &height) in z.iter().enumerate() {
        if !needed.contains(&k) {
            all.push(Outline::default());
            continue;
        }
        limits::go_on()?;
        let found = timings.time(Stage::Contour, || {
            let area = sections.at(height)?;
            Some(outline_of(area.rings, detail, &field.cancel))
        });
        match found {
            Some(outline) => all.push(outline?),
            // One at a time: what is found of a layer must not depend on which
            // others have a section.
            None => {
                let z = &z[k..=k];
                all.extend(sampled(field, z, &(0..1), detail, timings)?);
            }
        }
    }
    Ok(all)
}

/// Outlines by samples.
fn sampled(
    field: &Field,
    z: &[Mm],
    needed: &Range<usize>,
    detail: Detail,
    timings: &Timings,
) -> Result<Vec<Outline>, FieldError> {
    let field = &field.sampled;
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
        FieldError::TooLarge { .. } => {
            "; make the part smaller (--scale), or raise sample_spacing if it \
             is less than half of outer_wall_width"
        }
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
