//! Finds rings that are drawn more than once: in other pieces, from another point or
//! the other way.

use super::GAP;
use super::cells::{Cell, around, cell};
use crate::area::{MOST_CURVES, Piece};
use crate::outline::Outline;
use crate::tree::Tree;
use isocontour::Rect;
use isoslice_base::problem::{Problem, go_on};
use std::cell::OnceCell;
use std::collections::HashMap;

/// How far apart two rings that are the same may be at most, as a share of their
/// size, so that small rings in one another are not: 1 µm at 10 mm, as numbers of
/// 3 digits are rounded.
const SHARE: f64 = 1e-4;

/// How many rings that begin at the same corner of a box are compared with one. More
/// are only in files that are made to take time.
const MOST_LIKE: usize = 16;

/// How many places are looked at to compare rings: twice as many as if all rings of
/// the greatest drawing are drawn twice. What is beyond counts as different.
const MOST_LOOKS: usize = 16 * MOST_CURVES;

struct Ring {
    line: Outline,
    bounds: Rect,
    /// What its nearest point is found with, if it is ever asked for.
    nearest: OnceCell<(Tree, Vec<Piece>)>,
}

/// The rings, each once, and how many are left out.
pub(super) fn each_once(
    mut rings: Vec<Outline>,
) -> Problem<(Vec<Outline>, usize)> {
    // Lines that are shorter than ends are apart leave nothing.
    rings.retain(|ring| !ring.is_empty());
    let before = rings.len();
    let mut looks = MOST_LOOKS;
    let mut kept: Vec<Ring> = Vec::new();
    let mut grid: HashMap<Cell, Vec<usize>> = HashMap::new();
    for line in rings {
        let ring = Ring::new(line);
        let own = cell(ring.bounds.min, GAP);
        let near = around(own).filter_map(|c| grid.get(&c)).flatten();
        let near = near.take(MOST_LIKE).map(|i| &kept[*i]);
        if !ring.is_among(near, &mut looks)? {
            grid.entry(own).or_default().push(kept.len());
            kept.push(ring);
        }
    }
    let twice = before - kept.len();
    Ok((kept.into_iter().map(|ring| ring.line).collect(), twice))
}

impl Ring {
    fn new(line: Outline) -> Ring {
        let parts = line.curves().iter().flat_map(|c| c.monotone());
        let bounds = parts.fold(Rect::EMPTY, |bounds, part| {
            bounds.with(part.start()).with(part.end())
        });
        let nearest = OnceCell::new();
        Ring {
            line,
            bounds,
            nearest,
        }
    }

    fn is_among<'a>(
        &self,
        mut others: impl Iterator<Item = &'a Ring>,
        looks: &mut usize,
    ) -> Problem<bool> {
        go_on()?;
        others.try_fold(false, |found, other| {
            Ok(found || self.is_same(other, looks)?)
        })
    }

    fn is_same(&self, other: &Ring, looks: &mut usize) -> Problem<bool> {
        let (a, b) = (self.bounds, other.bounds);
        let near = GAP.min(SHARE * a.size().max_element());
        let off = (a.min - b.min).abs().max((a.max - b.max).abs());
        Ok(off.max_element() <= near
            && self.is_along(other, near, looks)?
            && other.is_along(self, near, looks)?)
    }

    /// Whether it is near another wherever it is looked at.
    fn is_along(
        &self,
        other: &Ring,
        near: f64,
        looks: &mut usize,
    ) -> Problem<bool> {
        let (tree, pieces) = other.nearest.get_or_init(|| {
            let curves = other.line.curves().iter();
            let boxes = curves.clone().map(|c| c.bounds()).collect();
            (Tree::new(boxes), curves.copied().map(Piece::new).collect())
        });
        let most = near * near;
        for curve in self.line.curves() {
            go_on()?;
            for t in [0.0, 0.25, 0.5, 0.75] {
                let p = curve.at(t);
                let mut least = f64::INFINITY;
                tree.near(p, most, |i, _| {
                    least = least.min(pieces[i].nearest(p).0);
                    least.min(most)
                });
                *looks = looks.saturating_sub(1);
                if least > most || *looks == 0 {
                    return Ok(false);
                }
            }
        }
        Ok(true)
    }
}
