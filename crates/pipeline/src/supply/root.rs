//! The layer with which a run begins that writes only some layers.
//!
//! In: the lowest layer whose path a run makes. Out: the highest layer, this one or one
//! below it, whose beads follow from the outlines around it alone. From there on every
//! run finds the same. `lower` says why.

use super::super::SliceError;
use super::super::layer::Filled;
use super::super::options::Extent;
use super::super::part::PartPaths;
use super::Supply;
use super::lower::lowest;
use rayon::ThreadPool;
use std::ops::Range;

/// The layer from which a run has to fill layers that makes the layers from `first`
/// on.
pub(super) fn root(
    paths: &PartPaths<'_>,
    pool: &ThreadPool,
    first: usize,
) -> Result<usize, SliceError> {
    let stages = &paths.planned.stages;
    let checks = stages.standing().is_some();
    let depends = stages.bridge_layers() > 0 || checks;
    let last = paths.planned.spans.len().saturating_sub(1);
    if !depends || first == 0 || first > last {
        return Ok(first);
    }
    let calm = stages.bridge_layers().max(1);
    // What infill stands on may lie far below.
    let lowest = if checks { 0 } else { lowest(first) };
    let (mut end, mut some, mut found) = (first + 1, calm + 1, 0);
    while end > lowest + 1 {
        let from = end.saturating_sub(some).max(lowest);
        let layers = plain(paths, pool, from..end)?;
        for pair in layers.windows(2).rev() {
            let (below, layer) = (&pair[0], &pair[1]);
            found = if is_calm(paths, below, layer) {
                found + 1
            } else {
                0
            };
            let root = layer.layer.span.index + calm - 1;
            let at = layers.iter().find(|l| l.layer.span.index == root);
            if found >= calm && at.map_or(!checks, |root| stands(paths, root)) {
                return Ok(root);
            }
        }
        // The lowest of these layers is looked at again, over the next one.
        (end, some) = (from + 1, 2 * some);
    }
    Ok(lowest)
}

/// Some layers, filled as if nothing were below them.
fn plain(
    paths: &PartPaths<'_>,
    pool: &ThreadPool,
    layers: Range<usize>,
) -> Result<Vec<Filled>, SliceError> {
    let start = layers.start;
    let extent = Extent {
        // Their accuracy is not measured.
        layers: layers.end..layers.end,
        made: layers,
        glimpse: false,
    };
    let mut supply = Supply::from(paths, pool, extent, start)?;
    let mut all = Vec::new();
    while let Some(which) = supply.found()? {
        supply.next += which.len();
        all.extend(supply.filled(which)?);
    }
    Ok(all)
}

/// True if no skin of a layer lies over infill of the layer below.
fn is_calm(paths: &PartPaths<'_>, below: &Filled, layer: &Filled) -> bool {
    let areas = below.areas.as_ref().zip(layer.areas.as_ref());
    areas.is_none_or(|(below, here)| {
        !paths.planned.stages.may_bridge(here, &below.sparse)
    })
}

/// True if all infill of a layer stands, whatever is below it.
fn stands(paths: &PartPaths<'_>, filled: &Filled) -> bool {
    let standing = paths.planned.stages.standing();
    standing.is_none_or(|standing| {
        let beads = &filled.beads;
        standing.is_needless(&beads.infill, beads.shell())
    })
}
