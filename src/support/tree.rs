//! Branches of support, from the top down.
//!
//! In: what needs support, layer by layer. Out: what is printed of supports in
//! each layer.
//!
//! 1. What is needed is cut into the cells of a grid ([`Cells`]), so that a
//!    wide face is held by several branches.
//! 2. Branches are drawn together on their way down ([`Branch::lower`]).
//! 3. Two posts that can still meet halfway well above the bed become one
//!    branch, if nothing is in their way.

use super::TOLERANCE;
use super::branch::{Branch, Size, Step};
use super::cells::Cells;
use super::gaps::top_below;
use super::plan::Parts;
use super::room::{Foot, Room};
use crate::plane::clip::{crop, unite};
use crate::plane::offset::offset;
use crate::plane::{Area, Rect, edges};
use crate::settings::{Settings, Supports};
use crate::units::Mm;
use glam::DVec2;
use rayon::prelude::*;

/// What is left of the height where two posts meet, as a share of what they
/// go down on their way to each other: below that it is not worth its while.
const BELOW: f64 = 0.5;

/// The area that branches have in each of some layers, for what is needed in
/// each of the part's layers.
pub(super) fn grow(
    parts: Parts<'_>,
    needs: &[Area],
    room: &Room,
    count: usize,
    settings: &Settings,
) -> Vec<Area> {
    let size = Size::new(settings);
    let tan = settings.support.branch_angle.to_radians().tan();
    let mut tops: Vec<Vec<(usize, Area)>> = vec![Vec::new(); count];
    for (i, need) in needs.iter().enumerate().filter(|(_, n)| !n.is_empty()) {
        if let Some(j) = top_below(parts.spans, i, settings) {
            let core = offset(need, size.post - size.core, TOLERANCE);
            tops[j].push((i, core));
        }
    }
    let all = tops.iter().flatten().map(|(_, core)| core.bounds());
    let Some(bounds) = all.reduce(Rect::union) else {
        return Vec::new();
    };
    let cells = Cells::new(bounds);
    let mut areas = vec![Area::EMPTY; count];
    let mut branches: Vec<Branch> = Vec::new();
    for j in (0..count).rev() {
        let height = parts.spans.get(j + 1).map_or(0.0, |s| s.height());
        let step = Step {
            layer: j,
            lean: height * tan,
            parts,
            room,
            settings,
        };
        branches
            .par_iter_mut()
            .for_each(|branch| branch.lower(step));
        branches.retain(|branch| !branch.core.is_empty());
        for (i, core) in &tops[j] {
            let top = parts.spans[*i].bottom;
            for (foot, free) in
                [Foot::Bed, Foot::Part].into_iter().zip(room.split(core, j))
            {
                if foot == Foot::Part && settings.supports == Supports::Plate {
                    continue;
                }
                for (cell, core) in cells.cut(&free) {
                    let held = core.content();
                    let cell = Some(cell);
                    let new = Branch {
                        core,
                        foot,
                        cell,
                        top,
                        held,
                    };
                    attach(&mut branches, new, step);
                }
            }
        }
        merge(&mut branches, step, tan);
        let each: Vec<Area> = branches
            .par_iter()
            .map(|branch| branch.area(step))
            .collect();
        let rings = each.into_iter().flat_map(|area| area.rings).collect();
        areas[j] = unite(&Area { rings });
    }
    areas
}

/// Adds what is needed to the branch that holds the same cell already, or as
/// one of its own.
fn attach(branches: &mut Vec<Branch>, new: Branch, step: Step<'_>) {
    let at = new.middle();
    let same = branches.iter_mut().filter(|branch| {
        branch.cell == new.cell
            && branch.foot == new.foot
            && is_clear(step, step.layer, new.foot, at, branch.middle())
    });
    let nearest = same.min_by(|a, b| {
        let far = |branch: &Branch| branch.middle().distance(at);
        far(a).total_cmp(&far(b))
    });
    match nearest {
        Some(branch) => branch.take(new),
        None => branches.push(new),
    }
}

/// Makes one branch of each two posts that are nearest to each other, if they
/// can meet.
fn merge(branches: &mut Vec<Branch>, step: Step<'_>, tan: f64) {
    let height = step.parts.spans[step.layer].bottom;
    let farthest = 2.0 * tan * height / (1.0 + BELOW);
    let posts: Vec<(usize, DVec2)> = branches
        .iter()
        .enumerate()
        .filter(|(_, b)| b.foot == Foot::Bed && b.is_post())
        .map(|(k, b)| (k, b.middle()))
        .collect();
    let near = nearest(&posts, farthest);
    let mut gone = Vec::new();
    for (a, &b) in near.iter().enumerate() {
        let Some(b) = b.filter(|&b| a < b && near[b] == Some(a)) else {
            continue;
        };
        let ((first, from), (second, to)) = (posts[a], posts[b]);
        // The layer in which they meet.
        let meet = height - 0.5 * from.distance(to) / tan.max(1e-9);
        let spans = step.parts.spans[..=step.layer].iter();
        let meet = spans.rev().position(|span| span.bottom <= meet);
        let meet = step.layer - meet.unwrap_or(step.layer);
        let clear = |layer| is_clear(step, layer, Foot::Bed, from, to);
        if clear(step.layer) && clear(meet) {
            let other = branches[second].clone();
            branches[first].take(other);
            branches[first].cell = None;
            gone.push(second);
        }
    }
    let mut k = 0;
    branches.retain(|_| {
        k += 1;
        !gone.contains(&(k - 1))
    });
}

/// For each of some points, the nearest other one that is no farther than
/// `farthest`.
fn nearest(points: &[(usize, DVec2)], farthest: Mm) -> Vec<Option<usize>> {
    let mut by_x: Vec<usize> = (0..points.len()).collect();
    by_x.sort_by(|&a, &b| points[a].1.x.total_cmp(&points[b].1.x));
    let mut near = vec![None; points.len()];
    for (place, &a) in by_x.iter().enumerate() {
        let at = points[a].1;
        let mut best = farthest;
        let before = by_x[..place].iter().rev();
        let sides: [&mut dyn Iterator<Item = &usize>; 2] =
            [&mut before.into_iter(), &mut by_x[place + 1..].iter()];
        for side in sides {
            for &b in side {
                if (points[b].1.x - at.x).abs() > best {
                    break;
                }
                let far = points[b].1.distance(at);
                if far < best {
                    best = far;
                    near[a] = Some(b);
                }
            }
        }
    }
    near
}

/// True if nothing is between two points of a layer that a branch which stands
/// on `foot` has to go around.
fn is_clear(
    step: Step<'_>,
    layer: usize,
    foot: Foot,
    from: DVec2,
    to: DVec2,
) -> bool {
    let within = super::room::widened(Rect::around(&[from, to]), 1.0);
    let blocked: Area = step.room.blocked(layer, foot, within);
    let inner = super::room::widened(within, -0.1);
    // Along the box's sides, cropped rings run to and fro.
    let blocked = crop(&blocked.rings, inner);
    let mid = 0.5 * (from + to);
    !blocked.contains(mid)
        && !blocked.rings.iter().any(|ring| {
            edges(ring).any(|(a, b)| {
                let side = |p: DVec2, q: DVec2, r: DVec2| {
                    (q - p).perp_dot(r - p) > 0.0
                };
                side(from, to, a) != side(from, to, b)
                    && side(a, b, from) != side(a, b, to)
            })
        })
}
