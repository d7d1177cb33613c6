//! Where a layer has room for supports.
//!
//! In: the outlines of all layers. Out: for each layer the area that the part
//! takes with its gaps (taken), and the area from which no way leads down to
//! the bed (closed):
//!
//! ```text
//!         ╲░░░╱         A branch above the middle of a part cannot lean far
//!        ┌─╲░╱─┐        enough on its way down to get past the part.
//!        └─────┘
//! ───────────────────
//! ```
//!
//! The closed area shrinks upwards by what a branch may lean in a layer:
//! closed(j) = taken(j) ∪ (closed(j − 1) shrunk by h·tan(angle)).
//!
//! A branch that may stand on the part can end in the air between two walls of
//! the part. A second area keeps it out of there:
//! dead(j) = taken(j) ∪ (dead(j − 1) shrunk by h·tan(angle), without the places
//! where a branch can stand on the part).

use super::TOLERANCE;
use super::parts::Parts;
use super::plan::SupportPlan;
use super::survey::thinned;
use glam::DVec2;
use isoslice_base::parallel;
use isoslice_base::units::{Degrees, Mm};
use isoslice_planar::clip::{crop, difference, intersection, union, unite};
use isoslice_planar::offset::offset;
use isoslice_planar::opening::opened;
use isoslice_planar::{Area, Rect, Solid, edges};

/// How thick branches are.
#[derive(Clone, Copy, Debug)]
pub(super) struct Size {
    /// Half the thickness of the thinnest neck.
    pub core: Mm,
    /// Half the thickness of the thinnest post.
    pub post: Mm,
    /// How far the top of a branch reaches beyond what it holds: a line fits
    /// under a face of no width. More would touch faces that hold themselves.
    pub beyond: Mm,
}

impl Size {
    /// The size that the width of the lines allows.
    pub(super) fn new(plan: &SupportPlan) -> Size {
        let width = plan.width;
        Size {
            core: 0.45 * width,
            post: 1.1 * width,
            beyond: 0.55 * width,
        }
    }

    /// Half the distance across which the cores of two branches grow together:
    /// tops as wide as posts would overlap there.
    pub(super) fn apart(self) -> Mm {
        self.core + self.post - self.beyond
    }
}

/// Where the lowest layers have no place for supports.
pub(super) struct Room<'a> {
    plan: &'a SupportPlan,
    /// By layer, what is too near to the part for the middle of a branch.
    tight: Vec<Solid<'static>>,
    /// By layer, the area from which the middle of a branch cannot get down to
    /// the bed. It includes what is too near to the part.
    closed: Vec<Solid<'static>>,
    /// By layer, the area from which the middle of a branch gets down neither
    /// to the bed nor to the part. There are no such areas if no support may
    /// stand on the part.
    dead: Vec<Solid<'static>>,
}

fn solids(areas: Vec<Area>) -> Vec<Solid<'static>> {
    areas.into_iter().map(Solid::new).collect()
}

/// What a support stands on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum StandsOn {
    /// The bed.
    Bed,
    /// Whatever is below.
    Part,
}

impl<'a> Room<'a> {
    /// The room in the lowest `count` layers.
    pub(super) fn new(
        parts: Parts<'_>,
        count: usize,
        plan: &'a SupportPlan,
    ) -> Room<'a> {
        // Each outline is beside several layers of supports.
        let beside = BESIDE + TOLERANCE + margin(plan);
        let outlines = parts.outlines;
        let grown = parallel::map(outlines.len(), |i| {
            offset(&outlines[i], beside, TOLERANCE)
        });
        let tight =
            parallel::map(count, |j| thinned(tight(parts, j, &grown, plan)));
        drop(grown);
        let closed = || no_way_down(parts, &tight, plan, |_| None);
        let on_part = |j: usize| {
            let on = parts.heights.stands_on(j)?;
            Some(offset(&parts.outlines[on], ASTRIDE, TOLERANCE))
        };
        let dead = || {
            if plan.on_part {
                no_way_down(parts, &tight, plan, on_part)
            } else {
                Vec::new()
            }
        };
        let (closed, dead) = rayon::join(closed, dead);
        Room {
            plan,
            tight: solids(tight),
            closed: solids(closed),
            dead: solids(dead),
        }
    }

    /// Forgets a layer, and all layers above it.
    pub(super) fn release(&mut self, j: usize) {
        self.tight.truncate(j);
        self.closed.truncate(j);
        self.dead.truncate(j);
    }

    /// How far a point of layer `j` is from what is too near to the part for the
    /// middle of a branch, and the direction away from it, if it is nearer than
    /// `distance` or inside.
    pub(super) fn way_out(
        &self,
        j: usize,
        at: DVec2,
        distance: Mm,
    ) -> Option<(Mm, DVec2)> {
        let grid = self.tight[j].grid();
        let inside = grid.contains(at);
        let found = grid.nearest_within(at, distance);
        if found.is_none() && !inside {
            return None;
        }
        let (far, away) = match found {
            Some((_, near)) => (at.distance(near), at - near),
            None => (distance, DVec2::ZERO),
        };
        let sign = if inside { -1.0 } else { 1.0 };
        Some((sign * far, sign * away.normalize_or_zero()))
    }

    /// True if the middle of a branch that stands on `foot` has a place in layer
    /// `j` at a point, and within `around` of it.
    pub(super) fn has_place(
        &self,
        j: usize,
        foot: StandsOn,
        at: DVec2,
        around: Mm,
    ) -> bool {
        let grid = self.of(foot)[j].grid();
        !grid.contains(at) && grid.nearest_within(at, around).is_none()
    }

    /// True if the part will cut a branch to the bed, whose core reaches so far from
    /// a point of layer `j`, before it is drawn together. On the way down the core and
    /// its distance from what has no way down both shrink by what branches lean. So
    /// they meet before the core is a post if they overlap now.
    pub(super) fn cuts(&self, j: usize, at: DVec2, reach: Mm) -> bool {
        self.closed[j].grid().nearest_within(at, reach).is_some()
    }

    /// The part in layer `j`, and what is too near to it, within a box. Notches
    /// count as too near if no branch has room in them.
    pub(super) fn taken(&self, j: usize, within: Rect) -> Area {
        let margin = margin(self.plan);
        let near = within.grown(3.0 * margin);
        let tight = crop(&self.tight[j].area().rings, near);
        crop(&offset(&tight, -margin, TOLERANCE).rings, within)
    }

    /// Splits an area of layer `j` in two: from the first one the middle of a
    /// branch gets down to the bed, from the second one only to the part.
    pub(super) fn split(&self, area: &Area, j: usize) -> [Area; 2] {
        let bounds = area.bounds();
        let near = |all: &Solid<'_>| crop(&all.area().rings, bounds);
        let dead = self.dead.get(j).unwrap_or(&self.closed[j]);
        let free = difference(area, &near(dead));
        let to_bed = difference(&free, &near(&self.closed[j]));
        // Rounding leaves slivers, which are left out.
        let to_part = opened(&difference(&free, &to_bed), BESIDE, TOLERANCE);
        [to_bed, to_part]
    }

    /// Where in a box the middle of a branch that stands on `foot` has no
    /// place in layer `j`.
    pub(super) fn blocked(
        &self,
        j: usize,
        foot: StandsOn,
        within: Rect,
    ) -> Area {
        let all = &self.of(foot)[j];
        let grid = all.grid();
        if !grid.meets(within) && !grid.contains(within.min) {
            Area::EMPTY
        } else {
            crop(&all.area().rings, within)
        }
    }

    /// True if some of an area is no place for the middle of a branch that
    /// stands on `foot` in layer `j`.
    pub(super) fn meets(&self, j: usize, foot: StandsOn, area: &Area) -> bool {
        let mut firsts = area.rings.iter().filter_map(|ring| ring.first());
        let grid = self.of(foot)[j].grid();
        let Rect { min, max } = area.bounds();
        // Far from borders all of it is in such a place, or nothing.
        if !grid.meets(Rect::new(min, max)) {
            return firsts.next().is_some_and(|&first| grid.contains(first));
        }
        let mut edges = area.rings.iter().flat_map(|ring| edges(ring));
        let mut meets = false;
        grid.visit_box(min, max, |edge| {
            meets |= !meets && area.contains(grid.edge(edge).0);
        });
        // One island may lie inside such a place, and another one outside.
        meets
            || firsts.any(|&first| grid.contains(first))
            || edges.any(|(a, b)| !grid.crossings(a, b).is_empty())
    }

    /// True if nothing is between two points of layer `j` that a branch which
    /// stands on `foot` has to go around.
    pub(super) fn is_clear(
        &self,
        j: usize,
        foot: StandsOn,
        from: DVec2,
        to: DVec2,
    ) -> bool {
        let grid = self.of(foot)[j].grid();
        !grid.contains(from.midpoint(to)) && grid.crossings(from, to).is_empty()
    }

    /// By layer, what is no place for the middle of a branch that stands on
    /// `foot`.
    fn of(&self, foot: StandsOn) -> &[Solid<'static>] {
        match foot {
            StandsOn::Bed => &self.closed,
            StandsOn::Part => &self.dead,
        }
    }
}

/// A post can stand on the part if its middle is no farther outside of the part
/// than this, mm. More than a third of the thinnest post lies on the part then.
const ASTRIDE: Mm = 0.1;

/// By layer, the area from which no way leads the middle of a branch down to
/// something that it can stand on: the bed, and in layer `j` the area that
/// `lands(j)` gives. `tight` is what is too near to the part.
fn no_way_down(
    parts: Parts<'_>,
    tight: &[Area],
    plan: &SupportPlan,
    lands: impl Fn(usize) -> Option<Area>,
) -> Vec<Area> {
    let lean = plan.lean();
    let mut all: Vec<Area> = Vec::with_capacity(tight.len());
    for (j, (tight, span)) in tight.iter().zip(parts.spans()).enumerate() {
        if isoslice_base::limits::is_stopped() {
            all.push(Area::EMPTY);
            continue;
        }
        let reach = -lean * span.height();
        let left = all.last().map(|below| offset(below, reach, TOLERANCE));
        let left = left.filter(|left| !left.is_empty());
        let left = left.map(|left| match lands(j) {
            None => left,
            Some(lands) => difference(&left, &lands),
        });
        all.push(match left {
            None => tight.clone(),
            Some(left) => thinned(union(tight, &left)),
        });
    }
    all
}

/// Distance in the plane of a support from the part in the layers above and
/// below it, as far as the gaps in z reach, mm.
pub(super) const BESIDE: Mm = 0.05;

/// How far the middle of a branch is from its side, with the tolerance of the
/// offsets.
fn margin(plan: &SupportPlan) -> Mm {
    Size::new(plan).core + TOLERANCE
}

/// The part in layer `j` without what hangs over its sides there, and the distance that
/// supports keep from that, if it is less than from walls: the tops of supports under a
/// slope lie `gap_top` below it, and so not far beside it, the less the thinner layers
/// are. With the distance from walls, faces of 45° would have no supports at all.
fn walls_of(
    parts: Parts<'_>,
    j: usize,
    plan: &SupportPlan,
) -> Option<(Area, Mm)> {
    /// A side hangs over if it leans by at most so much less than what needs supports.
    /// The less it is, the farther down one has to look for how much a side leans.
    const LESS: Degrees = 10.0;
    /// Farthest down that is looked at, mm.
    const DEEPEST: Mm = 1.5;
    /// How far down a side has to recede to hang, mm: by more than the tolerances.
    const AT_ONCE: Mm = 0.2;
    /// Least distance from what hangs over: beads are not laid more exactly.
    const NEAREST: Mm = 0.15;
    let spans = parts.spans();
    let span = spans.get(j)?;
    let steepest = plan.overhangs.angle.to_radians().tan();
    let near = (plan.gap_top + 0.5 * span.height()) * steepest;
    let near = near.max(NEAREST);
    if near >= plan.xy_gap {
        return None;
    }
    let hangs = (plan.overhangs.angle - LESS).max(0.0).to_radians().tan();
    // So far down, such a side has receded by what the distances differ.
    let depth = (plan.xy_gap - near) / (steepest - hangs).max(f64::EPSILON);
    let depth = depth.min(DEEPEST);
    let lower = spans[..j].partition_point(|s| s.top <= span.top - depth);
    let lower = lower.saturating_sub(1);
    let section = &parts.sections[j];
    let hanging = |lower: usize| {
        let recedes = hangs * (span.top - spans[lower].top) + TOLERANCE;
        let below = offset(&parts.sections[lower], recedes, TOLERANCE);
        difference(section, &below)
    };
    // A face that is level farther down leaves upright sides. They do not hang.
    let at_once = spans[..j].partition_point(|s| s.top <= span.top - AT_ONCE);
    let at_once = hanging(at_once.saturating_sub(1));
    if at_once.is_empty() {
        return None;
    }
    let hanging: Vec<Area> = hanging(lower)
        .islands()
        .into_iter()
        .filter(|side| !intersection(side, &at_once).is_empty())
        .collect();
    let hanging: Area = hanging.into_iter().collect();
    Some((difference(section, &hanging), near))
}

/// Where layer `j` has no place for the middle of a branch: in the part, and too
/// near to it. `grown` are the outlines, grown by [`BESIDE`] and [`margin`].
fn tight(
    parts: Parts<'_>,
    j: usize,
    grown: &[Area],
    plan: &SupportPlan,
) -> Area {
    if isoslice_base::limits::is_stopped() {
        return Area::EMPTY;
    }
    let Parts {
        heights,
        outlines,
        sections,
        ..
    } = parts;
    let section = &sections[j];
    // The tolerances of later offsets may take some of the gap.
    let more = 2.0 * TOLERANCE + margin(plan);
    let area = match walls_of(parts, j, plan) {
        None => offset(section, plan.xy_gap + more, TOLERANCE),
        Some((walls, near)) => {
            let walls = offset(&walls, plan.xy_gap + more, TOLERANCE);
            union(&walls, &offset(section, near + more, TOLERANCE))
        }
    };
    // The layers beside it, and those within the gaps above and below.
    let level = heights.beside(j);
    let first = level.start.min(heights.in_gap(j).start);
    let above = (level.end..outlines.len())
        .take_while(|&i| heights.below(i).is_none_or(|top| top < j));
    let mut others = (first..level.end)
        .chain(above)
        .filter(|&k| outlines[k] != *section)
        .map(|k| &grown[k])
        .filter(|area| !area.is_empty())
        .peekable();
    if others.peek().is_none() {
        return area;
    }
    let mut rings = area.rings;
    for other in others {
        rings.extend_from_slice(&other.rings);
    }
    unite(&Area { rings })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::support::heights::Heights;
    use isoslice_planar::rect;
    use isoslice_settings::layers::LayerSpan;
    use isoslice_settings::testing::{plan_with, usual_plan};

    /// A block whose one side leans by 42° over what is beside it, in thin layers.
    #[test]
    fn supports_come_nearer_to_what_hangs_over_them_than_to_walls() {
        let side = |j: usize| 5.0 + 0.09 * j as f64;
        let outlines: Vec<Area> =
            (0..40).map(|j| rect(-5.0, -5.0, side(j), 5.0)).collect();
        let none = vec![Area::EMPTY; 40];
        for (angle, sideways) in [(20.0, 0.15), (55.0, 0.35)] {
            let plan = plan_with(SupportPlan::of, |s| {
                s.layer_height = isoslice_settings::ByNozzle::Length(0.1);
                s.support.angle = angle;
            });
            let heights = Heights::new(LayerSpan::stack(0.1, 40), &plan);
            let parts = Parts::in_layers(&heights, &outlines, &none);
            let more = 2.0 * TOLERANCE + margin(&plan);
            let around = tight(parts, 30, &outlines, &plan).bounds();
            let own = side(30) + sideways + more;
            assert!((around.max.x - own).abs() < 0.021, "{angle}: {around:?}");
            let wall = -5.0 - plan.xy_gap - more;
            assert!((around.min.x - wall).abs() < 0.011, "{angle}: {around:?}");
        }
    }

    #[test]
    fn a_branch_keeps_the_gap_from_walls_and_stays_out_of_thin_notches() {
        let plan = usual_plan(SupportPlan::of);
        let heights = Heights::new(LayerSpan::stack(0.2, 4), &plan);
        // Two walls, and a slot of 1 mm between them.
        let walls = Area::from_iter([
            rect(-10.0, -10.0, 0.0, 10.0),
            rect(1.0, -10.0, 10.0, 10.0),
        ]);
        let outlines = vec![walls; 4];
        let none = vec![Area::EMPTY; 4];
        let parts = Parts::in_layers(&heights, &outlines, &none);
        let room = Room::new(parts, 4, &plan);
        let gap = plan.xy_gap + 2.0 * TOLERANCE;
        let beside = rect(10.0, -1.0, 12.0, 1.0);
        let taken = room.taken(1, beside.bounds()).content();
        assert!((taken - 2.0 * gap).abs() < 0.03, "{taken}");
        let slot = room.taken(1, rect(0.0, -1.0, 1.0, 1.0).bounds());
        assert!((slot.content() - 2.0).abs() < 1e-3, "{}", slot.content());
        // What lies beside it, what reaches into it, what is in it, and what is
        // around it.
        let meets = |area: &Area| room.meets(1, StandsOn::Bed, area);
        let near = 10.0 + gap + margin(&plan);
        assert!(!meets(&rect(near + 0.05, -1.0, 13.0, 1.0)));
        assert!(meets(&rect(near - 0.05, -1.0, 13.0, 1.0)));
        assert!(meets(&rect(3.0, 3.0, 4.0, 4.0)));
        assert!(meets(&rect(-20.0, -20.0, 20.0, 20.0)));
        // An island beside it, with one in it or without.
        let far = rect(near + 1.0, -1.0, near + 2.0, 1.0);
        let inner = rect(3.0, 3.0, 4.0, 4.0);
        assert!(!meets(&far) && meets(&Area::from_iter([far, inner])));
        assert!(!meets(&Area::EMPTY));
    }
}
