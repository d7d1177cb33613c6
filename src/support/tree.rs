//! Branches of support, from the top down.
//!
//! In: what needs support, layer by layer. Out: what is printed of supports in
//! each layer.
//!
//! 1. What is needed is cut into the cells of a grid ([`Cells`]), so that a
//!    wide face is held by several branches.
//! 2. Each branch is drawn together on its way down ([`Branch::lower`]).
//! 3. A post leans towards the branch next to it, if the two can meet well
//!    above the bed and nothing is in their way. Those that meet become one.

use super::TOLERANCE;
use super::branch::{Branch, POINT, Step, middle};
use super::cells::Cells;
use super::parts::Parts;
use super::room::{Foot, Room, Size};
use crate::plane::clip::{intersection, unite};
use crate::plane::offset::offset;
use crate::plane::{Area, Rect, Solid};
use crate::settings::{Settings, Supports};
use crate::units::Mm;
use glam::DVec2;
use rayon::prelude::*;
use rstar::RTree;
use rstar::primitives::GeomWithData;

/// What is left of the height where two posts meet, as a share of what they
/// go down on their way to each other: below that it is not worth its while.
const BELOW: f64 = 0.5;

/// A branch stands on the part if that is nearer than this share of the way
/// down to the bed.
const NEAR: f64 = 0.5;
/// So many of the branches next to a post are looked at.
const LOOKED_AT: usize = 16;
/// Size of the cells of outlines' grids, mm.
const CELL: Mm = 2.0;

/// The area that branches have in each of some layers, for what is needed in
/// each of the part's layers.
pub(super) fn grow(
    parts: Parts<'_>,
    needs: &[Area],
    room: &Room<'_>,
    count: usize,
    settings: &Settings,
) -> Vec<Area> {
    let size = Size::new(settings);
    let tan = settings.support.branch_angle.to_radians().tan();
    let mut tops: Vec<Vec<(usize, Area)>> = vec![Vec::new(); count];
    for (i, need) in needs.iter().enumerate().filter(|(_, n)| !n.is_empty()) {
        if let Some(j) = parts.heights.below(i) {
            let core = offset(need, size.post - size.core, TOLERANCE);
            tops[j].push((i, core));
        }
    }
    let all = tops.iter().flatten().map(|(_, core)| core.bounds());
    let Some(bounds) = all.reduce(Rect::union) else {
        return Vec::new();
    };
    let cells = Cells::new(bounds);
    let solids: Vec<Solid> =
        parts.outlines.iter().map(|o| Solid::of(o, CELL)).collect();
    let mut areas = vec![Area::EMPTY; count];
    let mut branches: Vec<Branch> = Vec::new();
    for j in (0..count).rev() {
        let height = parts.spans().get(j + 1).map_or(0.0, |s| s.height());
        let step = Step {
            layer: j,
            lean: height * tan,
            parts,
            room,
            settings,
        };
        let goals = goals(&branches, step, tan);
        let pairs = branches.par_iter_mut().zip(goals);
        pairs.for_each(|(branch, goal)| branch.lower(goal, step));
        let pieces = branches.into_iter().flat_map(|b| b.pieces(step));
        branches = pieces.collect();
        join(&mut branches, step);
        for (i, core) in &tops[j] {
            let top = parts.spans()[*i].bottom;
            for new in begun(core, top, step, &cells, &solids) {
                attach(&mut branches, new, step);
            }
        }
        let each: Vec<Area> = branches
            .par_iter()
            .map(|branch| branch.area(step))
            .collect();
        let rings = each.into_iter().flat_map(|area| area.rings).collect();
        areas[j] = unite(&Area { rings });
    }
    areas
}

/// The branches that begin in a layer under faces at the height `top`, whose
/// cores lie in `core`.
fn begun(
    core: &Area,
    top: Mm,
    step: Step<'_>,
    cells: &Cells,
    solids: &[Solid<'_>],
) -> Vec<Branch> {
    let (layer, parts) = (step.layer, step.parts);
    let anywhere = step.settings.supports == Supports::Auto;
    let [to_bed, to_part] = step.room.split(core, layer);
    let mut new = Vec::new();
    let mut add = |area: &Area, foot: Foot| {
        for (cell, core) in cells.cut(area) {
            let near = || is_near(middle(&core), layer, parts, solids);
            let foot = match anywhere && near() {
                true => Foot::Part,
                false => foot,
            };
            new.push(Branch {
                held: core.content(),
                core,
                foot,
                cell,
                top,
            });
        }
    };
    add(&to_bed, Foot::Bed);
    if anywhere {
        add(&to_part, Foot::Part);
    }
    new
}

/// True if the part is below a point of a layer, at less than [`NEAR`] of the
/// way to the bed.
fn is_near(
    at: DVec2,
    layer: usize,
    parts: Parts<'_>,
    solids: &[Solid<'_>],
) -> bool {
    let lowest = (1.0 - NEAR) * parts.spans()[layer].bottom;
    let near = (0..layer)
        .rev()
        .take_while(|&k| parts.spans()[k].top > lowest);
    near.into_iter().any(|k| solids[k].grid().contains(at))
}

/// Adds what is needed to a branch that holds the same cell and that it
/// touches, or as one of its own.
fn attach(branches: &mut Vec<Branch>, new: Branch, step: Step<'_>) {
    let reach = 2.0 * Size::new(step.settings).core;
    let around = offset(&new.core, reach, TOLERANCE);
    let bounds = around.bounds();
    let touched = branches.iter_mut().find(|branch| {
        branch.cell == new.cell
            && branch.foot == new.foot
            && branch.core.bounds().meets(bounds)
            && !intersection(&around, &branch.core).is_empty()
    });
    match touched {
        Some(branch) => branch.take(new, step),
        None => branches.push(new),
    }
}

/// For each branch, the middle of the one that it should lean to, if any.
fn goals(branches: &[Branch], step: Step<'_>, tan: f64) -> Vec<Option<DVec2>> {
    let Some(above) = step.parts.spans().get(step.layer + 1) else {
        return vec![None; branches.len()];
    };
    let farthest = 2.0 * tan * above.bottom / (1.0 + BELOW);
    let middles: Vec<DVec2> = branches.iter().map(Branch::middle).collect();
    let places = places(&middles);
    let goal = |(k, branch): (usize, &Branch)| {
        if !branch.is_post() {
            return None;
        }
        let (from, here) = (middles[k], middles[k].to_array());
        let clear = |&to: &DVec2| {
            // The layer in which they meet.
            let meet = above.bottom - 0.5 * from.distance(to) / tan.max(1e-9);
            let spans = step.parts.spans()[..=step.layer].iter();
            let meet = spans.rev().position(|span| span.bottom <= meet);
            let meet = step.layer - meet.unwrap_or(step.layer);
            [step.layer, meet]
                .iter()
                .all(|&j| step.room.is_clear(j, branch.foot, from, to))
        };
        let others = places.nearest_neighbor_iter(&here);
        let others = others.map(|place| place.data).filter(|&o| o != k);
        others
            .take(LOOKED_AT)
            .filter(|&other| branches[other].foot == branch.foot)
            .map(|other| middles[other])
            .take_while(|to| to.distance(from) <= farthest)
            .find(clear)
    };
    branches.par_iter().enumerate().map(goal).collect()
}

/// Makes one branch of a post and what it has met.
fn join(branches: &mut Vec<Branch>, step: Step<'_>) {
    let middles: Vec<DVec2> = branches.iter().map(Branch::middle).collect();
    let places = places(&middles);
    let mut gone = vec![false; branches.len()];
    for (k, &at) in middles.iter().enumerate() {
        if gone[k] || !branches[k].is_post() {
            continue;
        }
        let here = at.to_array();
        let others = places.nearest_neighbor_iter(&here);
        let others = others.map(|place| place.data).take(LOOKED_AT);
        let met = others.filter(|&o| o != k && !gone[o]).find(|&other| {
            let branch = &branches[other];
            branch.foot == branches[k].foot
                && match branch.is_post() {
                    true => middles[other].distance(at) <= POINT,
                    false => branch.core.contains(at),
                }
        });
        let Some(other) = met else { continue };
        let post = branches[k].clone();
        match branches[other].is_post() {
            true => branches[other].meet(&post),
            false => branches[other].take(post, step),
        }
        gone[k] = true;
    }
    let mut gone = gone.into_iter();
    branches.retain(|_| !gone.next().unwrap_or(false));
}

/// Some points by where they are, with their numbers.
fn places(points: &[DVec2]) -> RTree<GeomWithData<[f64; 2], usize>> {
    let numbered = points.iter().enumerate();
    let place = |(k, p): (usize, &DVec2)| GeomWithData::new(p.to_array(), k);
    RTree::bulk_load(numbered.map(place).collect())
}
