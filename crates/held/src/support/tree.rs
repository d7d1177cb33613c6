//! Branches of support, from the top down.
//!
//! In: what needs support, layer by layer. Out: what is printed of supports in
//! each layer.
//!
//! 1. What is needed is cut into the cells of a grid ([`Cells`]), so that a
//!    wide face is held by several branches.
//! 2. Each branch is drawn together on its way down ([`Branch::lower`]). With
//!    another `support.style` there are columns instead, which go straight
//!    down.
//! 3. A post leans towards the branch next to it, if the two can meet well
//!    above the bed and nothing is in their way. Posts that meet become one.

use super::branch::{Branch, POINT, Step, middle};
use super::cells::{CELL, Cells};
use super::parts::Parts;
use super::plan::SupportPlan;
use super::room::{Room, Size, StandsOn};
use super::{SPECK, TOLERANCE};
use glam::DVec2;
use isoslice_base::parallel;
use isoslice_base::units::{Mm, Mm2};
use isoslice_planar::clip::{crop, difference, intersection, union, unite};
use isoslice_planar::clusters::{Cluster, clusters};
use isoslice_planar::offset::offset;
use isoslice_planar::opening::is_wider;
use isoslice_planar::{Area, Rect, Ring, Solid, point_beside, signed_area};
use isoslice_settings::SupportStyle;
use rstar::RTree;
use rstar::primitives::GeomWithData;

/// Two posts lean towards each other only if they meet well above the bed.
/// What is left below must be this share of what they come down on the way.
const BELOW: f64 = 0.5;

/// A branch stands on the part if that is nearer than this share of the way
/// down to the bed, or if it would come past the part as a sheet.
const NEAR: f64 = 0.5;
/// So many of the branches next to a post are looked at.
const LOOKED_AT: usize = 16;
/// Whether posts can meet is looked at in every so many layers: each layer that
/// is looked at has a grid until the branches have passed it.
const MEET: usize = 8;
/// Size of the cells of outlines' grids, mm.
const GRID: Mm = 2.0;
/// Width of the squares of columns, mm.
const SQUARE: Mm = 4.0;
/// A low face as large as this, mm², is held by a column: it would be cut into
/// three cells or more, whose branches would still be wide on the bed.
const WIDE: Mm2 = 3.0 * CELL * CELL;
/// A face of any size that is not in one cell is held by a column if branches
/// are drawn together by less than this share of a cell on each side.
const LOW: f64 = 0.125;
/// Where the part is in the way right below some of a face, the roof is wider
/// there and around it, up to so many times [`Size::post`].
const AROUND: f64 = 2.0;
/// Holes in supports are filled up to this size, mm². A wall around a smaller hole
/// would begin in the air between sparse lines, which are some 4 mm apart.
const PORE: Mm2 = 8.0;

/// The area of all branches in each of the lowest `count` layers. `needs` is
/// what needs a support in each of the part's layers.
pub(super) fn grow(
    parts: Parts<'_>,
    needs: &[Area],
    mut room: Room<'_>,
    count: usize,
    plan: &SupportPlan,
) -> Vec<Area> {
    let tan = plan.lean();
    let mut tops: Vec<Vec<usize>> = vec![Vec::new(); count];
    for (i, _) in needs.iter().enumerate().filter(|(_, n)| !n.is_empty()) {
        if let Some(j) = parts.heights.below(i) {
            tops[j].push(i);
        }
    }
    let all = tops.iter().flatten().map(|&i| needs[i].bounds());
    let Some(bounds) = all.reduce(Rect::union) else {
        return Vec::new();
    };
    // Supports reach beyond what they hold.
    let cells = Cells::new(bounds.grown(Size::new(plan).post));
    let below = parts.outlines.iter().take(count);
    let mut solids: Vec<Solid> = below.map(|o| Solid::of(o, GRID)).collect();
    let mut areas = vec![Area::EMPTY; count];
    let mut branches: Vec<Branch> = Vec::new();
    for j in (0..count).rev() {
        let height = parts.spans().get(j + 1).map_or(0.0, |s| s.height());
        let step = Step {
            layer: j,
            lean: height * tan,
            parts,
            room: &room,
            plan,
        };
        let goals = goals(&branches, step, tan);
        parallel::change(&mut branches, |k, branch| {
            branch.lower(goals[k], step);
        });
        let pieces = branches.into_iter().flat_map(|b| b.pieces(step));
        branches = pieces.collect();
        gather(&mut branches, step);
        join(&mut branches, step);
        for i in std::mem::take(&mut tops[j]) {
            for new in begun(&needs[i], i, step, &cells, &solids) {
                attach(&mut branches, new, step);
            }
        }
        parallel::change(&mut branches, |_, branch| {
            branch.printed = branch.area(step);
        });
        let rings = branches.iter().flat_map(|b| b.printed.rings.clone());
        let rings = rings.collect();
        areas[j] = without_pores(united(&Area { rings }), step);
        // Grids take several times the memory of what they sort, and nothing
        // looks at layers above the branches again.
        room.release(j);
        solids.truncate(j);
    }
    areas
}

/// The union of some rings. Most branches stand alone, and only those whose
/// boxes meet are compared.
fn united(area: &Area) -> Area {
    let of_cluster = |cluster: Cluster| match cluster.area.rings.len() {
        1 => cluster.area,
        _ => unite(&cluster.area),
    };
    let all = clusters(area).into_iter().map(of_cluster);
    all.collect()
}

/// An area of supports without its small holes, except around the part.
fn without_pores(mut area: Area, step: Step<'_>) -> Area {
    area.rings.retain(|ring| {
        let is_pore = (-PORE..0.0).contains(&signed_area(ring));
        !is_pore || !step.room.taken(step.layer, Rect::around(ring)).is_empty()
    });
    area
}

/// The branches that begin in a layer to hold `need`, which is of the part's
/// layer `i`.
fn begun(
    need: &Area,
    i: usize,
    step: Step<'_>,
    cells: &Cells,
    solids: &[Solid<'_>],
) -> Vec<Branch> {
    let (layer, parts) = (step.layer, step.parts);
    let top = parts.spans()[i].bottom;
    let anywhere = step.plan.on_part;
    // The lowest layer needs no supports, since no layer is below it.
    let below = &parts.outlines[i - 1];
    let [to_bed, to_part] = cores(need, below, step);
    let mut new = Vec::new();
    let mut add = |area: &Area, foot: StandsOn| {
        for (cell, core) in pieces(area, cells, foot, step) {
            let is_over = |share: f64| {
                is_over_part(inside(&core), layer, share, parts, solids)
            };
            // Past the part it would come down as a sheet along it.
            let is_cut = || {
                let middle = middle(&core);
                let points = core.rings.iter().flatten();
                let far = points.map(|p| p.distance(middle));
                step.room.cuts(layer, middle, far.fold(0.0, f64::max))
            };
            let foot = if anywhere
                && (is_over(NEAR) || cell.is_some() && is_cut() && is_over(1.0))
            {
                StandsOn::Part
            } else {
                foot
            };
            new.push(Branch {
                held: core.content(),
                core,
                foot,
                cell,
                top,
                printed: Area::EMPTY,
            });
        }
    };
    add(&to_bed, StandsOn::Bed);
    if anywhere {
        add(&to_part, StandsOn::Part);
    }
    new
}

/// The cores of supports that begin in a layer to hold `need`, an area of a
/// layer of the part. The layer below that one has the outline `below`. From the
/// first core a way leads down to the bed, from the second one only to the part.
fn cores(need: &Area, below: &Area, step: Step<'_>) -> [Area; 2] {
    let size = Size::new(step.plan);
    let within = |area: &Area, reach: Mm| {
        let core = offset(area, reach - size.core, TOLERANCE);
        step.room.split(&core, step.layer)
    };
    let [to_bed, to_part] = within(need, size.beyond);
    // Beside a steep part the place right below a face may be taken, and only
    // the outer edge of the face can be held.
    let all = union(&to_bed, &to_part);
    let held = offset(&all, size.beyond, TOLERANCE);
    let lost = difference(need, &held);
    // A point or an edge that begins in the air is held by a whole post, or by a
    // roof as wide: below it supports leave out what is too thin to be printed.
    let begins = |island: &Area| {
        let around = island.bounds().grown(size.post);
        let near = crop(&below.rings, around);
        near.is_empty() || {
            let around = offset(island, size.post, TOLERANCE);
            intersection(&near, &around).is_empty()
        }
    };
    let is_thin =
        |island: &Area| !is_wider(island, 2.0 * size.beyond, TOLERANCE);
    let islands = need.islands().into_iter();
    let points: Area = islands.filter(|i| is_thin(i) && begins(i)).collect();
    let whole = if lost.is_empty() {
        points
    } else {
        let near = offset(&lost, AROUND * size.post, TOLERANCE);
        union(&points, &intersection(need, &near))
    };
    if whole.is_empty() {
        return [to_bed, to_part];
    }
    let [bed, part] = within(&whole, size.post);
    [union(&to_bed, &bed), union(&to_part, &part)]
}

/// The pieces of an area, each for one branch, and their cells. A piece for a
/// column has no cell.
fn pieces(
    area: &Area,
    cells: &Cells,
    foot: StandsOn,
    step: Step<'_>,
) -> Vec<(Option<[u32; 2]>, Area)> {
    let in_cells = |area: &Area| {
        let cut = cells.cut(area).into_iter();
        cut.map(|(cell, core)| (Some(cell), core))
    };
    let columns = |area: &Area| area.islands().into_iter().map(|i| (None, i));
    match step.plan.style {
        SupportStyle::Tree => in_cells(area).collect(),
        SupportStyle::Snug => columns(area).collect(),
        SupportStyle::Grid => {
            let all = squares(area);
            let blocked = step.room.blocked(step.layer, foot, all.bounds());
            columns(&difference(&all, &blocked)).collect()
        }
        SupportStyle::Auto => {
            let bottom = step.parts.spans()[step.layer].bottom;
            // How far a branch is drawn together on its way to the bed.
            let drawn = bottom * step.plan.lean();
            let is_column = |island: &Area| {
                // Branches would still be wide when they reach the bed.
                drawn < 0.5 * CELL && island.content() > WIDE
                    || drawn < LOW * CELL && cells.cut(island).len() > 1
            };
            let (low, high): (Vec<Area>, Vec<Area>) =
                area.islands().into_iter().partition(is_column);
            let high: Area = high.into_iter().collect();
            let low = low.into_iter().map(|island| (None, island));
            low.chain(in_cells(&high)).collect()
        }
    }
}

/// The squares of a fixed grid that an area has a part of.
fn squares(area: &Area) -> Area {
    let Rect { min, max } = area.bounds();
    let (first, last) = ((min / SQUARE).floor(), (max / SQUARE).floor());
    let mut rings = Vec::new();
    let mut y = first.y;
    while y <= last.y {
        let row = Rect::new(
            DVec2::new(min.x, y * SQUARE),
            DVec2::new(max.x, (y + 1.0) * SQUARE),
        );
        let row_of_area = crop(&area.rings, row);
        let mut x = first.x;
        while x <= last.x {
            let corners = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)];
            let corner = |(u, v)| SQUARE * DVec2::new(x + u, y + v);
            let square: Ring = corners.map(corner).to_vec();
            let has = crop(&row_of_area.rings, Rect::around(&square));
            if unite(&has).content() > SPECK {
                rings.push(square);
            }
            x += 1.0;
        }
        y += 1.0;
    }
    unite(&Area { rings })
}

/// A point of an island: its middle, unless that is in a hole or a bay.
fn inside(island: &Area) -> DVec2 {
    let middle = middle(island);
    if island.contains(middle) {
        return middle;
    }
    let outer = island.rings.first();
    outer.and_then(|r| point_beside(r)).unwrap_or(middle)
}

/// True if the part is below a point of a layer, at less than a share of the way to
/// the bed.
fn is_over_part(
    at: DVec2,
    layer: usize,
    share: f64,
    parts: Parts<'_>,
    solids: &[Solid<'_>],
) -> bool {
    let lowest = (1.0 - share) * parts.spans()[layer].bottom;
    let near = (0..layer)
        .rev()
        .take_while(|&k| parts.spans()[k].top > lowest);
    near.into_iter().any(|k| solids[k].grid().contains(at))
}

/// Joins a new branch with one of the same cell that it touches. If there is
/// none, the new branch stays as it is.
fn attach(branches: &mut Vec<Branch>, new: Branch, step: Step<'_>) {
    let size = Size::new(step.plan);
    // The post below a point keeps its place.
    let is_point = new.core.bounds().size().max_element() < 2.0 * size.post;
    let reach = 2.0 * if is_point { size.core } else { size.apart() };
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
    let goal = |k: usize| {
        let branch = &branches[k];
        if branch.is_column() || !branch.is_post() {
            return None;
        }
        let (from, here) = (middles[k], middles[k].to_array());
        let clear = |&to: &DVec2| {
            // The height at which the two meet, and then a layer that is looked
            // at anyway, at that height or a little above.
            let meet = above.bottom - 0.5 * from.distance(to) / tan.max(1e-9);
            let spans = step.parts.spans()[..=step.layer].iter();
            let meet = spans.rev().position(|span| span.bottom <= meet);
            let meet = step.layer - meet.unwrap_or(step.layer);
            let meet = meet.next_multiple_of(MEET).min(step.layer);
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
    parallel::map(branches.len(), goal)
}

/// Joins branches of one cell that lie over each other, if both are more than
/// posts. They are pieces of a branch that went aside to the same place.
fn gather(branches: &mut Vec<Branch>, step: Step<'_>) {
    let mut bounds: Vec<Rect> =
        branches.iter().map(|b| b.core.bounds()).collect();
    let group = |b: &Branch| (b.cell, b.foot == StandsOn::Part);
    let mut order: Vec<usize> = (0..branches.len())
        .filter(|&k| !branches[k].is_column() && !branches[k].is_post())
        .collect();
    order.sort_by(|&a, &b| {
        let groups = group(&branches[a]).cmp(&group(&branches[b]));
        groups.then(bounds[a].min.x.total_cmp(&bounds[b].min.x))
    });
    let mut gone = vec![false; branches.len()];
    for (n, &k) in order.iter().enumerate() {
        for &other in &order[n + 1..] {
            if group(&branches[other]) != group(&branches[k])
                || bounds[other].min.x > bounds[k].max.x
            {
                break;
            }
            if gone[k] || gone[other] || !bounds[k].meets(bounds[other]) {
                continue;
            }
            let [a, b] = [k, other].map(|k| &branches[k].core);
            if !intersection(a, b).is_empty() {
                let other_one = branches[other].clone();
                branches[k].take(other_one, step);
                bounds[k] = branches[k].core.bounds();
                gone[other] = true;
            }
        }
    }
    let mut gone = gone.into_iter();
    branches.retain(|_| !gone.next().unwrap_or(false));
}

/// Joins each post with the branch that it has met.
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
                && if branch.is_post() {
                    middles[other].distance(at) <= POINT
                } else {
                    branch.core.contains(at)
                }
        });
        let Some(other) = met else { continue };
        let post = branches[k].clone();
        if branches[other].is_post() {
            branches[other].meet(&post)
        } else {
            branches[other].take(post, step)
        }
        gone[k] = true;
    }
    let mut gone = gone.into_iter();
    branches.retain(|_| !gone.next().unwrap_or(false));
}

/// Points with their numbers, sorted by place.
fn places(points: &[DVec2]) -> RTree<GeomWithData<[f64; 2], usize>> {
    let numbered = points.iter().enumerate();
    let place = |(k, p): (usize, &DVec2)| GeomWithData::new(p.to_array(), k);
    RTree::bulk_load(numbered.map(place).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::support::heights::Heights;
    use isoslice_planar::rect;
    use isoslice_settings::layers::LayerSpan;
    use isoslice_settings::testing::usual_plan;

    /// What [`gather`] makes of branches over empty layers.
    fn gathered(branches: Vec<Branch>) -> Vec<Branch> {
        let plan = usual_plan(SupportPlan::of);
        let heights = Heights::new(LayerSpan::stack(0.2, 4), &plan);
        let none = vec![Area::EMPTY; 4];
        let parts = Parts::in_layers(&heights, &none, &none);
        let room = Room::new(parts, 4, &plan);
        let step = Step {
            layer: 2,
            lean: 0.2,
            parts,
            room: &room,
            plan: &plan,
        };
        let mut branches = branches;
        gather(&mut branches, step);
        branches
    }

    fn branch(core: Area, cell: Option<[u32; 2]>, foot: StandsOn) -> Branch {
        Branch {
            held: core.content(),
            core,
            foot,
            cell,
            top: 1.0,
            printed: Area::EMPTY,
        }
    }

    #[test]
    fn branches_of_a_cell_that_lie_over_each_other_become_one() {
        let cell = Some([1, 2]);
        let [a, b, c] = [0.0, 2.0, 4.0].map(|x| rect(x, 0.0, x + 3.0, 3.0));
        let of = |core: &Area, cell, foot| branch(core.clone(), cell, foot);
        let far = rect(20.0, 0.0, 23.0, 3.0);
        let all = [&a, &far, &c, &b].map(|core| of(core, cell, StandsOn::Bed));
        let found = gathered(all.to_vec());
        let mut sizes: Vec<[f64; 2]> = found
            .iter()
            .map(|branch| [branch.core.content(), branch.held])
            .collect();
        sizes.sort_by(|a, b| a[0].total_cmp(&b[0]));
        // Three squares, of which neighbours have a third in common.
        let wanted = [[9.0, 9.0], [21.0, 27.0]];
        assert_eq!(sizes.len(), 2, "{sizes:?}");
        for (found, wanted) in sizes.iter().zip(wanted) {
            let off = [found[0] - wanted[0], found[1] - wanted[1]];
            assert!(off.iter().all(|o| o.abs() < 1e-3), "{sizes:?}");
        }
    }

    #[test]
    fn branches_of_other_cells_and_feet_columns_and_posts_stay_apart() {
        let (a, b) = (rect(0.0, 0.0, 3.0, 3.0), rect(1.0, 1.0, 4.0, 4.0));
        let point = rect(1.5, 1.5, 1.6, 1.6);
        let cell = Some([1, 2]);
        let pair = |b: &Area, cell_of_b, foot| {
            let a = branch(a.clone(), cell, StandsOn::Bed);
            gathered(vec![a, branch(b.clone(), cell_of_b, foot)]).len()
        };
        assert_eq!(pair(&b, cell, StandsOn::Bed), 1);
        assert_eq!(pair(&b, Some([2, 2]), StandsOn::Bed), 2);
        assert_eq!(pair(&b, cell, StandsOn::Part), 2);
        assert_eq!(pair(&b, None, StandsOn::Bed), 2);
        assert_eq!(pair(&point, cell, StandsOn::Bed), 2);
    }
}
