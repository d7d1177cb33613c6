//! The outlines of a slab's layers: closed rings on f = 0.
//!
//! In: the sampled leaves of [`crate::field`]. Out: per layer an [`Area`],
//! outer rings counter-clockwise, holes clockwise, as polygons within
//! `accuracy` of the field's zero set.
//!
//! The lattice only finds the topology. Each vertex is then moved along its
//! lattice edge onto f = 0 (`refine`), the corners that marching squares
//! cuts off are put back (`corner`), the pieces of the leaves are joined
//! at shared lattice edges (`link`), and last the rings are thinned.
//!
//! Inside is f < 0; a NaN is outside. Not guaranteed: that features smaller
//! than the lattice's spacing are found.
//!
//! The `contour` crate is the oracle of the tests and not the engine: it
//! stitches through hash maps and nested vectors over the whole grid handed
//! to it, and decides ambiguous cells by convention, where `march` visits
//! sampled leaves only and asks the field.

mod corner;
mod link;
mod march;
mod refine;

use crate::field::{Batch, Field, FieldError, Leaf};
use crate::plane::Area;
use crate::plane::simplify::simplify;
use crate::timings::{Stage, Timings};
use crate::units::Mm;
use link::Chains;
use march::Marcher;
use std::time::{Duration, Instant};

/// Outlines of one layer and what was met on the way.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Outline {
    /// The solid of the layer.
    pub area: Area,
    /// Samples at which the field was not a number; they count as outside.
    pub nan_samples: usize,
    /// Rings that had to be closed by a straight line because the field
    /// contradicted itself where they broke off.
    pub forced_rings: usize,
}

/// Outlines of the layers at heights `z`, at most a slab of them; the time
/// it takes goes to `timings`.
///
/// # Errors
/// If the evaluator fails, which is a bug.
pub fn outlines(
    field: &Field,
    z: &[Mm],
    accuracy: Mm,
    timings: &Timings,
) -> Result<Vec<Outline>, FieldError> {
    let mut layers: Vec<Chains> = z.iter().map(|_| Chains::default()).collect();
    let mut marcher = Marcher::new(field.lattice(), z);
    let mut marching = Duration::ZERO;
    timings.time(Stage::Field, || {
        field.slab(z, &mut |batch: Batch<'_>| {
            let start = Instant::now();
            let marched = marcher.march(batch, &mut layers);
            marching += start.elapsed();
            marched
        })
    })?;
    let nanos = marching.as_nanos() as u64;
    timings.reassign(Stage::Field, Stage::Contour, nanos);
    timings.time(Stage::Contour, || {
        close(field, z, accuracy, layers, marcher)
    })
}

/// Joins the layers' pieces into rings, sampling what is missing.
fn close(
    field: &Field,
    z: &[Mm],
    accuracy: Mm,
    mut layers: Vec<Chains>,
    mut marcher: Marcher<'_>,
) -> Result<Vec<Outline>, FieldError> {
    // A proof that was wrong by a rounding error shows as an outline that
    // stops at the border of a leaf nobody sampled: sample it now. Each
    // round adds at least a leaf, and few ever need one.
    for _ in 0..64 {
        let missing: Vec<Leaf> = layers
            .iter()
            .enumerate()
            .flat_map(|(k, c)| c.missing_leaves(k, field.lattice()))
            .collect();
        if missing.is_empty() {
            break;
        }
        field.leaves(z, &missing, &mut |batch: Batch<'_>| {
            marcher.march(batch, &mut layers)
        })?;
    }
    let nan = marcher.nan_samples();
    Ok(layers
        .into_iter()
        .zip(nan)
        .map(|(chains, nan_samples)| {
            let (rings, forced_rings) = chains.into_rings();
            let rings = rings
                .iter()
                .map(|r| simplify(r, accuracy))
                .filter(|r| !r.is_empty())
                .collect();
            Outline {
                area: Area { rings },
                nan_samples,
                forced_rings,
            }
        })
        .collect())
}
