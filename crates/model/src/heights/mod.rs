//! Layers whose heights follow the surface.
//!
//! In: a placed model and a plan. Out: the part's layers, and what their
//! heights amount to.
//!
//! With `layer_heights = "uniform"` these are the layers of [`layers::plan()`].
//! Otherwise a layer may be as high as its surface allows. On a surface with
//! the unit normal n, layers of the height h make steps of h·|n_z|, measured
//! across the surface (the cusp of Dolenc and Mäkelä, "Slicing procedures for
//! layered manufacturing techniques", 1994). `isocontour::lean` bounds |n_z| on
//! all of the surface at each height, so no layer makes a step greater than
//! the greatest step, whether or not any sample lies there. An expression gives the
//! heights instead.
//!
//! A level face (|n_z| = 1) would ask for thin layers all around it, and still
//! be missed. So layers end exactly at level faces and at the part's top
//! (`stack`), and these faces make no step.
//!
//! Guarantees: the plan is deterministic, and equal for every range of layers.
//! Each layer above the first is within its limit. Neighbouring layers differ
//! little (`limit`). A layer may be down to half as thick as
//! `layer_height_min`, where that is the only way to hit a level face.
//!
//! Not guaranteed: steps of the first layer, which has its own height. If
//! the greatest step is less than `layer_height_min`, steps may be as great as the
//! latter; [`Steps`] says how great they are.

mod limit;
mod plan;
mod stack;
#[cfg(test)]
mod tests;

use crate::expressions::{Quantity, QuantityError};
use crate::{Model, Place};
use glam::DVec2;
use isocontour::{Lean, LeanError, LeanOptions, lean};
use isoslice_base::limits;
use isoslice_base::parallel;
use isoslice_base::units::Mm;
use isoslice_settings::layers::{self, LayerSpan, MAX_LAYERS, PlanError};
use isoslice_settings::{LayerHeights, Varying};
use limit::Limit;
pub use plan::HeightPlan;
use serde::Serialize;

/// Units of the last digit of G-code in a millimetre. Heights are whole
/// multiples of that unit, so a layer is exactly as high as its move says.
const DIGITS: f64 = 1e3;

/// The setting's name.
const KEY: &str = "layer_heights";

/// A part's layers.
#[derive(Clone, Debug, PartialEq)]
pub struct Heights {
    /// The layers, from the bed up.
    pub spans: Vec<LayerSpan>,
    /// What heights that differ amount to; none for uniform layers.
    pub steps: Option<Steps>,
}

/// The steps that layers of different heights make on the surface. The first
/// layer and level faces at which layers end do not count.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Steps {
    /// The greatest step, mm.
    pub step_max_mm: Mm,
    /// The step that 99 % of the layers do not exceed, mm.
    pub step_p99_mm: Mm,
    /// Height of the thinnest layer above the first, mm.
    pub thinnest_mm: Mm,
    /// Height of the thickest layer above the first, mm.
    pub thickest_mm: Mm,
    /// Number of layers that the part would have with `layer_heights =
    /// "uniform"`.
    pub uniform_layers: usize,
    /// Number of level faces at which layers end.
    pub level_faces: usize,
    /// Number of level faces that lie too close to another border.
    pub missed_faces: usize,
    /// Height of the part in which too little was proved, so that its layers
    /// may be thinner than they need to be, mm.
    pub unproved_mm: Mm,
    /// Height of the part in which nothing was proved, so that its layers are as thin
    /// as for a level surface, mm.
    pub unknown_mm: Mm,
}

/// Why layers cannot be planned.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum HeightsError {
    /// The part cannot be divided into layers, whatever their heights.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// The expression has no value somewhere.
    #[error(transparent)]
    Vary(#[from] QuantityError),
    /// The surface cannot be looked at.
    #[error("layer_heights: the surface cannot be looked at: {0}")]
    Lean(#[source] LeanError),
}

/// The layers of a placed model, those of its raft included. With a raft the
/// model has to be raised ([`Model::raised`]).
///
/// # Errors
/// If there are no layers, or too many, or an expression for their heights has
/// no value.
pub fn heights(
    model: &Model,
    plan: &HeightPlan,
) -> Result<Heights, HeightsError> {
    let part = heights_above(model, plan)?;
    Ok(match plan.raft_layers {
        0 => part,
        raft => on_raft(part, raft, plan),
    })
}

/// The layers of the part on those of its raft.
fn on_raft(part: Heights, raft: usize, plan: &HeightPlan) -> Heights {
    let top = |i: usize| plan.on_bed + i as f64 * plan.uniform;
    let of_raft = (0..raft).map(|index| LayerSpan {
        index,
        bottom: index.checked_sub(1).map_or(0.0, top),
        top: top(index),
    });
    let of_part = part.spans.iter().map(|span| LayerSpan {
        index: span.index + raft,
        ..*span
    });
    Heights {
        spans: of_raft.chain(of_part).collect(),
        steps: part.steps,
    }
}

/// The layers of the part alone.
fn heights_above(
    model: &Model,
    plan: &HeightPlan,
) -> Result<Heights, HeightsError> {
    let (base, first) = (plan.raft_height, plan.first);
    let top = model.bounds.max.z + model.offset.z;
    let uniform = |top: Mm| layers::plan(top - base, first, plan.uniform);
    let of_z = match &plan.heights {
        LayerHeights::Uniform => {
            let mut spans = uniform(top)?;
            if base > 0.0 {
                for span in &mut spans {
                    span.bottom += base;
                    span.top += base;
                }
            }
            return Ok(Heights { spans, steps: None });
        }
        LayerHeights::Adaptive(_) => None,
        LayerHeights::Expression(text) => {
            let value = Varying::Expression(text.clone());
            Some(Quantity::level(KEY, &value)?)
        }
    };
    let height = top - base;
    if height < 0.5 * first {
        return Err(PlanError::TooFlat { height, first }.into());
    }
    if (height - first) / plan.most >= MAX_LAYERS as f64 {
        let (count, layer) = ((height - first) / plan.most, plan.most);
        return Err(PlanError::TooMany { count, layer }.into());
    }
    let lean = surface(model, plan)?;
    let lift = model.offset.z;
    let bottom = lean.bottom + lift;
    let faces: Vec<Mm> = lean.faces.iter().map(|z| z + lift).collect();
    let (borders, missed, top) =
        borders([base, first + base], top, &faces, plan.least);
    let mut level = lean.most_level;
    let bin_of = |z: Mm| ((z - bottom) / lean.bin).max(0.0);
    for z in &missed {
        // A face at which no layer ends makes a step like any other place.
        let nearest = bin_of(*z).round() as usize;
        for k in [nearest.wrapping_sub(1), nearest] {
            if let Some(level) = level.get_mut(k) {
                *level = 1.0;
            }
        }
    }
    let bins = (0..level.len()).map(|k| match &of_z {
        None => Ok(plan.clamp(plan.step / level[k])),
        Some(quantity) => {
            let ends = [0, 1].map(|e| bottom + (k + e) as f64 * lean.bin);
            let [a, b] = ends.map(|z| {
                let at = DVec2::ZERO.extend(z);
                quantity.at(Place { at, depth: 0.0 })
            });
            Ok(plan.clamp(a?.min(b?)))
        }
    });
    let bins: Vec<Mm> = bins.collect::<Result<_, QuantityError>>()?;
    let limit = Limit::new(bottom, lean.bin, &bins);
    let tops = stack::stack(&borders, limit)?;
    let mut spans = vec![LayerSpan {
        index: 0,
        bottom: base,
        top: base + first,
    }];
    for top in tops {
        let bottom = spans.last().map_or(0.0, |s| s.top);
        let index = spans.len();
        spans.push(LayerSpan { index, bottom, top });
    }
    let of_layer = |span: &LayerSpan| {
        // A bin that a layer only touches does not belong to the layer.
        let touch = 1.0 / (DIGITS * lean.bin);
        let last = level.len() - 1;
        let from = (bin_of(span.bottom) + touch) as usize;
        let to = (bin_of(span.top) - touch).max(0.0) as usize;
        let bins = &level[from.min(last)..=to.min(last)];
        bins.iter().copied().fold(0.0, f64::max)
    };
    let of_layers: Vec<(Mm, f64)> = spans[1..]
        .iter()
        .map(|s| (s.height(), of_layer(s)))
        .collect();
    let [step_max_mm, step_p99_mm, thinnest_mm, thickest_mm] =
        extremes(&of_layers);
    let steps = Steps {
        step_max_mm,
        step_p99_mm,
        thinnest_mm,
        thickest_mm,
        level_faces: faces
            .iter()
            .filter(|f| spans.iter().any(|s| (s.top - *f).abs() * DIGITS < 1.0))
            .count(),
        missed_faces: missed.len(),
        unproved_mm: lean.unproved,
        unknown_mm: lean.unknown,
        uniform_layers: uniform(top)?.len(),
    };
    Ok(Heights {
        spans,
        steps: Some(steps),
    })
}

/// Looks at the model's surface.
fn surface(model: &Model, plan: &HeightPlan) -> Result<Lean, HeightsError> {
    /// Number of bins in the thinnest layer.
    const BINS: f64 = 8.0;
    /// Some seconds of one processor. Simple parts need 0.2 to 0.6 s.
    const MOST_WORK: u64 = 60_000_000;
    /// Number of pieces in which the part is looked at, on all threads.
    const PIECES: usize = 32;
    let bin = plan.least / BINS;
    let count = Lean::count(&model.bounds, bin);
    let piece = count.div_ceil(PIECES);
    let pieces = count.div_ceil(piece);
    let options = |i: usize| LeanOptions {
        bin,
        // A layer of the greatest height may be as level as this.
        enough: (plan.step / plan.most).min(1.0),
        most: (plan.step / plan.least).min(1.0),
        tolerance: plan.accuracy,
        bins: (i * piece, (i + 1) * piece),
        max_work: MOST_WORK / pieces as u64,
    };
    let cancel = limits::Watch::hook();
    let look = |i| lean(&model.tree, &model.bounds, &options(i), &cancel);
    let found: Vec<Result<Lean, LeanError>> = parallel::map(pieces, look);
    let found: Vec<Lean> = found
        .into_iter()
        .collect::<Result<_, _>>()
        .map_err(HeightsError::Lean)?;
    let all = found.into_iter().reduce(Lean::joined);
    Ok(all.unwrap_or(Lean {
        bottom: model.bounds.min.z,
        bin,
        most_level: vec![1.0; count],
        faces: Vec::new(),
        unproved: model.bounds.size().z,
        unknown: model.bounds.size().z,
    }))
}

/// Three results: where layers have to end, from the first layer's top
/// (`first`, after its bottom) to the part's; the faces at which no layer ends,
/// because they lie too close to another border; and the part's top, which is a
/// level face if there is one near it.
fn borders(
    [bottom, first]: [Mm; 2],
    top: Mm,
    faces: &[Mm],
    least: Mm,
) -> (Vec<Mm>, Vec<Mm>, Mm) {
    /// How much thinner than the thinnest layers a layer may be to hit a
    /// border, as a share.
    const THINNER: f64 = 0.5;
    /// Accuracy of the part's bounds, mm. A face that is as near to a border
    /// counts as hit.
    const BOUNDS: Mm = 5e-4;
    let near_top = faces.iter().find(|z| (**z - top).abs() <= BOUNDS);
    let top = near_top.copied().unwrap_or(top);
    let mut borders = vec![first];
    let mut missed = Vec::new();
    let last_fits = top - first >= THINNER * least;
    let inside = |z: &&Mm| **z > bottom + BOUNDS && **z < top - BOUNDS;
    for &z in faces.iter().filter(inside) {
        let last = borders.last().copied().unwrap_or(first);
        if (z - last).abs() <= BOUNDS {
            continue;
        }
        if z - last >= THINNER * least && top - z >= THINNER * least {
            borders.push(z)
        } else {
            missed.push(z)
        }
    }
    if last_fits {
        borders.push(top);
    }
    (borders, missed, top)
}

/// The greatest step of layers, the one that 99 % do not exceed, the least
/// height and the greatest. Each layer has its height and a bound of |n_z|.
fn extremes(layers: &[(Mm, f64)]) -> [Mm; 4] {
    let mut steps: Vec<Mm> =
        layers.iter().map(|(h, level)| h * level).collect();
    steps.sort_by(f64::total_cmp);
    let last = steps.len().saturating_sub(1);
    let at = |share: f64| {
        let k = (share * last as f64).ceil() as usize;
        steps.get(k.min(last)).copied().unwrap_or(0.0)
    };
    let heights = layers.iter().map(|l| l.0);
    let thinnest = heights.clone().reduce(f64::min).unwrap_or(0.0);
    let thickest = heights.fold(0.0, f64::max);
    [at(1.0), at(0.99), thinnest, thickest]
}
