//! The outlines of a slab's layers: closed rings on f = 0.
//!
//! In: the sampled leaves of [`crate::field`]. Out: per layer an [`Area`],
//! outer rings counter-clockwise, holes clockwise, as polygons within
//! `accuracy` of the field's zero set.
//!
//! Where a plane itself does not tell inside from outside (`blind`), what is
//! just above it or just below it does.
//!
//! The lattice only finds the topology (`edges`, `march`). The vertices are
//! then moved along their lattice edges onto f = 0 (`refine`), and the outline
//! is followed between them where it bends or has a corner (`trace`). Some
//! cells are sampled more finely (`divide`): those that this does not explain,
//! and those whose nodes say that they may hide what is thinner than the lattice
//! is wide (`doubt`). The pieces are joined at shared lattice edges (`link`),
//! and what is too small is left out (`small`). Last, the rings are thinned so
//! that they do not cross (`untangle`, `cut`). A field of which nothing would
//! be left is refused before any of that (`noise`).
//!
//! Inside is f < 0; a NaN is outside. Where the field jumps from one side to
//! the other, the outline is at the jump. Rings smaller than a given size are
//! left out and counted. A disc 1.4 times as wide as a cell always holds a node.
//! Not guaranteed: that a feature without a node in it is found where the field
//! of another feature hides it.
//!
//! The `contour` crate is the oracle of the tests, not the engine. It works on
//! the whole grid with hash maps and nested vectors, and decides ambiguous
//! cells by convention. `march` visits sampled leaves only, and asks the field.

mod blind;
mod buckets;
mod cut;
mod divide;
mod doubt;
mod edges;
mod link;
mod march;
mod noise;
mod refine;
mod runs;
mod samples;
mod small;
mod trace;
mod untangle;

use crate::Length;
use crate::cancel::Cancel;
use crate::field::{Batch, Field, FieldError, LEAF, Leaf, NODES};
use crate::plane::{Area, Ring};
use blind::Blind;
use link::{Chains, Joined};
use march::{Marcher, Precision};
use runs::Runs;
use std::ops::Range;

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
    /// Places with islands or holes that are left out, because they are smaller
    /// than was asked for, or thinner than the accuracy.
    pub dropped_rings: usize,
}

/// How exact and how complete outlines have to be.
#[derive(Clone, Copy, Debug)]
pub struct Detail {
    /// Greatest distance from f = 0.
    pub accuracy: Length,
    /// Extent below which islands and holes are left out.
    pub smallest: Length,
}

/// Share of the accuracy for the chords between the points found on the
/// outline. Thinning gets the rest.
const CHORD_SHARE: f64 = 0.15;

/// Number of leaves that are asked for at once after the first look. Each leaf
/// needs memory while its outline is found.
const AT_ONCE: usize = 1024;

/// The phases of the work, for measuring them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// Proofs and samples of the field.
    Sampling,
    /// Lines of outlines are found among the samples, and followed.
    Tracing,
    /// The lines are joined into rings, and thinned.
    Closing,
}

/// Outlines of the layers at heights `z`: at most [`crate::SLAB`] of them that are alike
/// ([`Field::is_level`]), or [`Field::slab_layers`] others.
///
/// # Errors
/// If the field changes its sign finer than `detail.smallest` over large parts
/// of the slab, if it is stopped, or if fidget fails, which is a bug.
pub fn outlines(
    field: &Field,
    z: &[Length],
    detail: Detail,
) -> Result<Vec<Outline>, FieldError> {
    outlines_in_phases(field, z, &(0..z.len()), detail, &mut |_| {})
}

/// Does what [`outlines`] does, but only for the layers at some of the heights.
/// The others get an empty outline. What is found of a layer does not depend on
/// which others are asked for. It also tells when another phase begins, so that
/// phases can be measured.
///
/// # Errors
/// Those of [`outlines`], where only the layers that are asked for count.
pub fn outlines_in_phases(
    field: &Field,
    z: &[Length],
    needed: &Range<usize>,
    detail: Detail,
    begins: &mut dyn FnMut(Phase),
) -> Result<Vec<Outline>, FieldError> {
    let [face, void, both] = [(true, false), (false, true), (true, true)]
        .map(|(face, void)| Blind { face, void });
    let mut found = look(field, z, needed, detail, both, begins)?;
    // Other fields stand in for a field where it is blind. A look at what is
    // above a face and below it may find that there is a void as well.
    for blind in [face, void, both] {
        let is_so = |k: &usize| found.blind[*k] == blind;
        let layers: Vec<usize> = (0..z.len()).filter(is_so).collect();
        if layers.is_empty() {
            continue;
        }
        let mut stand_in = field;
        if blind.face {
            stand_in = stand_in.beside()?;
        }
        if blind.void {
            stand_in = stand_in.without_zeros()?;
        }
        let heeded = if blind.void { Blind::NOT } else { void };
        // One at a time: what is left of an expression, and with it the last bits of
        // an outline, depends on all layers that are looked at together.
        for k in layers {
            let z = &z[k..=k];
            let again = look(stand_in, z, &(0..1), detail, heeded, begins)?;
            let again = again.outlines.into_iter().zip(again.blind);
            for (outline, more) in again {
                found.outlines[k] = outline;
                found.blind[k] = blind.or(more);
            }
        }
    }
    Ok(found.outlines)
}

/// What a look at some layers found.
struct Found {
    /// The layers' outlines. Those of blind planes are empty.
    outlines: Vec<Outline>,
    /// For each layer why its plane is blind.
    blind: Vec<Blind>,
}

/// Looks at layers. Their planes are judged by whether they are blind for the
/// reasons in `heeded`.
fn look(
    field: &Field,
    z: &[Length],
    needed: &Range<usize>,
    detail: Detail,
    heeded: Blind,
    begins: &mut dyn FnMut(Phase),
) -> Result<Found, FieldError> {
    let mut runs = Runs::new(z.len());
    let precision = Precision {
        chord: CHORD_SHARE * detail.accuracy,
        smallest: detail.smallest,
    };
    let heights: Vec<f32> = z.iter().map(|&z| z as f32).collect();
    let mut marcher = Marcher::new(field.lattice(), &heights, precision);
    begins(Phase::Sampling);
    field.slab(z, &mut |mut batch: Batch<'_>| {
        begins(Phase::Tracing);
        marcher.judge_planes(&mut batch, needed, heeded)?;
        let span = batch.span;
        for leaf in batch.leaves {
            runs.divide(leaf.layer);
            runs.divide(leaf.layer + span);
        }
        let is_wanted =
            |k: &usize| needed.contains(k) && marcher.blind()[*k] == Blind::NOT;
        let wanted = |leaf: &Leaf| {
            let span = leaf.layer..leaf.layer + span;
            span.filter(is_wanted).count()
        };
        let weight = batch.leaves.iter().map(wanted).max().unwrap_or_default();
        if batch.leaves.iter().all(|leaf| wanted(leaf) > 0) {
            marcher.march(batch, weight, &mut runs)?;
        } else {
            let (mut leaves, mut values) = (Vec::new(), Vec::new());
            let of_leaf = batch.values.chunks_exact(NODES * NODES);
            for (leaf, sampled) in batch.leaves.iter().zip(of_leaf) {
                if wanted(leaf) > 0 {
                    leaves.push(*leaf);
                    values.extend_from_slice(sampled);
                }
            }
            let batch = Batch {
                leaves: &leaves,
                span,
                values: &values,
                sampler: batch.sampler,
            };
            marcher.march(batch, weight, &mut runs)?;
        }
        begins(Phase::Sampling);
        Ok(())
    })?;
    marcher.finish()?;
    let blind = marcher.blind().to_vec();
    let left_out = |k: &usize| !needed.contains(k) || blind[*k] != Blind::NOT;
    for run in runs.all() {
        if run.clone().all(|k| left_out(&k)) {
            *runs.at(run.start) = Chains::default();
        }
    }
    begins(Phase::Closing);
    let mut outlines = close(field, z, detail, runs, marcher)?;
    for k in (0..z.len()).filter(left_out) {
        outlines[k] = Outline::default();
    }
    Ok(Found { outlines, blind })
}

/// Joins the runs' pieces into rings, sampling what is missing.
fn close(
    field: &Field,
    z: &[Length],
    detail: Detail,
    mut runs: Runs,
    mut marcher: Marcher<'_>,
) -> Result<Vec<Outline>, FieldError> {
    // A proof that was wrong by a rounding error shows as an outline that stops
    // at the border of a leaf that was not sampled. An outline between two
    // nodes of a cell shows as one that stops at the border of its leaf. What
    // is missing is sampled now. Each round adds at least a leaf or divides a
    // cell, and hardly any slab needs many.
    for _ in 0..64 {
        let mut missing: Vec<Leaf> = Vec::new();
        let mut cells: Vec<(Leaf, [usize; 2])> = Vec::new();
        for run in runs.all() {
            field.check()?;
            let lack = runs.at(run.start).missing(field.lattice());
            let mut layers = run.start..run.start + 1;
            if !lack.leaves.is_empty() {
                // No proof says that the layers are alike in these leaves.
                run.clone().for_each(|layer| runs.divide(layer));
                layers = run;
            }
            for layer in layers {
                if !lack.cells.is_empty() {
                    runs.at(layer).clear(&lack.cells, field.lattice());
                }
                let leaf = |[i, j]: [usize; 2]| Leaf { layer, i, j };
                missing.extend(lack.leaves.iter().map(|&at| leaf(at)));
                for &at in &lack.cells {
                    let [i, j] = at.map(|k| k / LEAF * LEAF);
                    cells.push((leaf([i, j]), [at[0] - i, at[1] - j]));
                }
            }
        }
        if missing.is_empty() && cells.is_empty() {
            break;
        }
        for missing in missing.chunks(AT_ONCE) {
            field.leaves(z, missing, &mut |batch: Batch<'_>| {
                marcher.march(batch, 1, &mut runs)
            })?;
        }
        let place = |l: &Leaf| (l.layer, l.j, l.i);
        cells.sort_unstable_by_key(|(leaf, at)| (place(leaf), *at));
        let mut leaves: Vec<Leaf> = cells.iter().map(|c| c.0).collect();
        leaves.dedup();
        for leaves in leaves.chunks(AT_ONCE) {
            field.leaves(z, leaves, &mut |batch: Batch<'_>| {
                let mut own = Vec::new();
                for (n, leaf) in batch.leaves.iter().enumerate() {
                    let key = place(leaf);
                    let from = cells.partition_point(|c| place(&c.0) < key);
                    let all = cells[from..].iter().take_while(|c| c.0 == *leaf);
                    own.extend(all.map(|(_, at)| (n, *at)));
                }
                marcher.redivide(batch, &own, &mut runs)
            })?;
        }
    }
    marcher.finish()?;
    let nan = marcher.nan_samples();
    let mut outlines = Vec::with_capacity(z.len());
    for run in runs.all() {
        field.check()?;
        let mut chains = std::mem::take(runs.at(run.start));
        chains.shrink();
        let (rings, forced_rings) = chains.into_rings();
        let found = Outline {
            nan_samples: nan[run.start],
            forced_rings,
            ..thinned(rings, detail, field.cancel())?
        };
        outlines.extend(vec![found; run.len()]);
    }
    Ok(outlines)
}

/// The outline of rings that are known exactly and do not cross: thinned, and
/// without those that are too small.
///
/// # Errors
/// If it is stopped.
pub fn outline_of(
    rings: Vec<Ring>,
    detail: Detail,
    cancel: &Cancel,
) -> Result<Outline, FieldError> {
    let joined = |points: Ring| Joined {
        fixed: vec![true; points.len()],
        points,
    };
    thinned(rings.into_iter().map(joined).collect(), detail, cancel)
}

/// The outline of joined rings.
fn thinned(
    mut rings: Vec<Joined>,
    detail: Detail,
    cancel: &Cancel,
) -> Result<Outline, FieldError> {
    let left_out = small::leave_out(&mut rings, detail);
    let tolerance = (1.0 - CHORD_SHARE) * detail.accuracy;
    let mut rings = untangle::thin(rings, tolerance, cancel)?;
    let all = rings.len();
    rings.retain(|r| !r.is_empty());
    Ok(Outline {
        dropped_rings: left_out + all - rings.len(),
        area: Area { rings },
        ..Outline::default()
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plane::{Rect, edges};
    use fidget::context::Tree;
    use glam::DVec2;

    /// Of each circle of a hollow ball one leaf has been sampled. The missing
    /// leaves are found by following the circles from there.
    #[test]
    fn circles_of_which_one_leaf_is_known_are_closed() {
        const SPACING: f64 = 0.1;
        let (outer, inner) = (9.5_f64, 6.5_f64);
        let (x, y, z) = Tree::axes();
        let ball = (x.square() + y.square() + z.square()).sqrt() - 8.0;
        let half = DVec2::splat(11.0);
        let bounds = Rect::new(-half, half);
        let field = Field::new(&(ball.abs() - 1.5), 0.0, bounds, SPACING);
        let field = field.unwrap();
        let detail = Detail {
            accuracy: 0.005,
            smallest: 0.11,
        };
        let precision = Precision {
            chord: CHORD_SHARE * detail.accuracy,
            smallest: detail.smallest,
        };
        let heights = [-2.0, 0.3, 5.0];
        let radii = |z: f64| [outer, inner].map(|r| (r * r - z * z).sqrt());
        let lattice = field.lattice();
        let leaf_of = |p: f64, nodes: &[f32]| {
            let cells = (p - f64::from(nodes[0])) / SPACING;
            cells as usize / LEAF * LEAF
        };
        let known: Vec<Leaf> = heights
            .iter()
            .enumerate()
            .flat_map(|(layer, &z)| {
                radii(z).map(|r| Leaf {
                    layer,
                    i: leaf_of(r, &lattice.x),
                    j: leaf_of(0.0, &lattice.y),
                })
            })
            .collect();
        let mut runs = Runs::new(heights.len());
        (0..heights.len()).for_each(|layer| runs.divide(layer));
        let z = heights.map(|z| z as f32);
        let mut marcher = Marcher::new(lattice, &z, precision);
        let mut march = |batch: Batch<'_>| marcher.march(batch, 1, &mut runs);
        field.leaves(&heights, &known, &mut march).unwrap();
        let outlines = close(&field, &heights, detail, runs, marcher);
        for (outline, z) in outlines.unwrap().iter().zip(heights) {
            assert_eq!((outline.forced_rings, outline.dropped_rings), (0, 0));
            let rings = &outline.area.rings;
            assert_eq!(rings.len(), 2);
            let mut seen = [0.0; 2];
            for (ring, p, q) in rings
                .iter()
                .enumerate()
                .flat_map(|(n, r)| edges(r).map(move |(p, q)| (n, p, q)))
            {
                for share in [0.0, 0.25, 0.5, 0.75] {
                    let r = p.lerp(q, share).length();
                    let off = radii(z).map(|true_r| (r - true_r).abs());
                    let off = off[0].min(off[1]);
                    assert!(off <= detail.accuracy, "{off} at z = {z}");
                }
                seen[ring] += p.perp_dot(q) / 2.0;
            }
            seen.sort_by(f64::total_cmp);
            // The hole runs the other way round.
            let [outer, inner] = radii(z);
            for (area, r) in seen.into_iter().zip([-inner, outer]) {
                let whole = std::f64::consts::PI * r * r.abs();
                assert!((area / whole - 1.0).abs() < 1e-3, "{area}, {whole}");
            }
        }
    }
}
