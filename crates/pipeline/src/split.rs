//! Divides a part's layers into ranges of about equal cost.
//!
//! In: a plate, and how many ranges are wanted. Out: the ranges. A range begins
//! with a slab of layers, whose outlines are found together.
//!
//! ```text
//!   outlines of 32 layers  ──►  cost of each slab  ──►  ranges
//! ```
//!
//! Guaranteed: each layer is in one range, and no other ranges of as many
//! slabs have a smaller sum of squares of their costs. Not guaranteed: that
//! the cost is the time. It is the length of the outlines of a few layers, and
//! of the lines in them.

use super::job::{Base, Planned};
use super::layer::Layer;
use super::plans::Plans;
use super::stages::{ALL_LAYERS, Stages};
use super::start::{layers_of, pool, raised};
use super::{Options, SliceError};
use isocontour::SLAB;
use isoslice_base::limits;
use isoslice_base::parallel;
use isoslice_base::units::Mm;
use isoslice_planar::Area;
use isoslice_plate::{Part, Plate};
use isoslice_settings::layers::LayerSpan;
use rayon::ThreadPool;
use std::ops::Range;

/// How many layers are looked at.
const LOOKS: usize = 32;

/// A range of layers.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Share {
    /// Indices of the range's layers.
    pub layers: Range<usize>,
    /// The range's share of the whole work, as far as a coarse look tells.
    pub cost: f64,
}

/// Divides the layers of a plate into `parts` ranges, or fewer if there are not
/// enough slabs of layers. It uses `threads` threads, or as many as the
/// machine has.
///
/// # Errors
/// Those of [`slice_plate`](super::slice_plate) before its first layer.
pub fn split(
    plate: &Plate,
    parts: usize,
    threads: Option<usize>,
) -> Result<Vec<Share>, SliceError> {
    if plate.turns().is_some() {
        return Err(SliceError::RangeOneByOne);
    }
    let pool = &pool(threads)?;
    let plate = &raised(plate)?;
    let (spans, _) = pool.install(|| layers_of(plate))?;
    let mut costs: Vec<f64> = Vec::new();
    for (part, spans) in plate.parts.iter().zip(&spans) {
        let of_part = costs_of(part, spans, pool)
            .map_err(|e| SliceError::of(plate, part, e))?;
        if costs.len() < of_part.len() {
            costs.resize(of_part.len(), 0.0);
        }
        let times = part.places.len() as f64;
        // Copies are sliced once, but each copy is ordered, paced and written.
        for (sum, cost) in costs.iter_mut().zip(of_part) {
            *sum += 0.5 * (1.0 + times) * cost;
        }
    }
    limits::go_on()?;
    let slabs: Vec<f64> =
        costs.chunks(SLAB).map(|slab| slab.iter().sum()).collect();
    let all: f64 = slabs.iter().sum();
    let share = |some: Range<usize>| Share {
        cost: slabs[some.clone()].iter().sum::<f64>() / all,
        layers: SLAB * some.start..(SLAB * some.end).min(costs.len()),
    };
    Ok(divided(&slabs, parts).into_iter().map(share).collect())
}

/// The cost of each layer of a part that prints, in some unit.
fn costs_of(
    part: &Part,
    spans: &[LayerSpan],
    pool: &ThreadPool,
) -> Result<Vec<f64>, SliceError> {
    let base = Base::new(part, spans);
    let planned = base.stages(&(0..1), &Options::default(), pool)?;
    let Planned { stages, spans, .. } = &planned;
    let count = spans.len();
    let looks = LOOKS.min(count);
    // These layers are in the middles of equal pieces of the height.
    let at = |k: usize| (2 * k + 1) * count / (2 * looks);
    let look = |k: usize| {
        limits::go_on()?;
        cost(stages, &spans[at(k)])
    };
    let found = parallel::map_in(pool, looks, look);
    let found: Vec<f64> = found.into_iter().collect::<Result<_, _>>()?;
    // Each layer costs as much as the nearest of these layers.
    let nearest = |i: usize| found[(i * looks / count).min(looks - 1)];
    Ok((0..count).map(nearest).collect())
}

/// The cost of a layer: the length of its outline, for the contour, and the
/// length of its lines.
fn cost(stages: &Stages<'_>, span: &LayerSpan) -> Result<f64, SliceError> {
    let layers = stages.layers(&[*span], &ALL_LAYERS)?;
    // Any layer costs something.
    let of_layer = |layer: &Layer| lines_in(layer.area(), stages.plans);
    Ok(1.0 + layers.iter().map(of_layer).sum::<f64>())
}

/// The lengths of an area's outline and of the lines in the area.
fn lines_in(area: &Area, plans: &Plans) -> Mm {
    let walls = plans.walls.count as f64;
    let density = plans.infill.density.constant().unwrap_or(100.0) / 100.0;
    let infill = density * area.content().max(0.0) / plans.infill.width;
    (1.0 + walls) * area.perimeter() + infill
}

/// Divides slabs into ranges, so that the sum of squares of their costs is
/// least.
fn divided(slabs: &[f64], parts: usize) -> Vec<Range<usize>> {
    let count = slabs.len();
    let parts = parts.min(count);
    let mut below = vec![0.0];
    for cost in slabs {
        below.push(below.last().copied().unwrap_or(0.0) + cost);
    }
    let square = |from: usize, to: usize| {
        let cost: f64 = below[to] - below[from];
        cost * cost
    };
    // For each number of ranges and each end: the least sum, and where the last
    // range begins.
    let mut least: Vec<f64> = (0..=count).map(|to| square(0, to)).collect();
    let mut begins: Vec<Vec<usize>> = vec![vec![0; count + 1]];
    for k in 1..parts {
        let best = |to: usize| {
            let sums =
                (k..to).map(|from| (least[from] + square(from, to), from));
            let first = (f64::INFINITY, 0);
            sums.fold(first, |a, b| if b.0 < a.0 { b } else { a })
        };
        let all: Vec<(f64, usize)> = (0..=count).map(best).collect();
        least = all.iter().map(|(sum, _)| *sum).collect();
        begins.push(all.iter().map(|(_, from)| *from).collect());
    }
    let mut ranges = Vec::new();
    let mut to = count;
    for begins in begins.iter().rev().filter(|_| count > 0) {
        let from = begins[to];
        ranges.push(from..to);
        to = from;
    }
    ranges.reverse();
    ranges
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_have_about_equal_costs() {
        let even = [1.0; 16];
        let lengths = |ranges: Vec<Range<usize>>| -> Vec<usize> {
            ranges.iter().map(ExactSizeIterator::len).collect()
        };
        assert_eq!(lengths(divided(&even, 8)), [2; 8]);
        assert_eq!(lengths(divided(&even, 1)), [16]);
        assert_eq!(lengths(divided(&even[..3], 8)), [1; 3]);
        assert!(divided(&[], 8).is_empty());
        // A single costly block is a range of its own.
        let peak = [1.0, 1.0, 1.0, 9.0, 1.0, 1.0, 1.0, 1.0];
        assert_eq!(divided(&peak, 3), [0..3, 3..4, 4..8]);
    }

    #[test]
    fn ranges_are_the_best_of_all() {
        let blocks = [3.0, 1.0, 4.0, 1.0, 5.0, 9.0, 2.0, 6.0];
        let squares = |ranges: &[Range<usize>]| -> f64 {
            let cost = |r: &Range<usize>| blocks[r.clone()].iter().sum::<f64>();
            ranges.iter().map(|r| cost(r).powi(2)).sum()
        };
        let mut least = f64::INFINITY;
        for a in 1..6 {
            for b in a + 1..7 {
                for c in b + 1..8 {
                    least = least.min(squares(&[0..a, a..b, b..c, c..8]));
                }
            }
        }
        assert_eq!(squares(&divided(&blocks, 4)), least);
    }
}
