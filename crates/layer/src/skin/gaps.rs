//! Gaps beside one another: which of them have one bridge, and how bridges
//! share the land between them.
//!
//! ```text
//!   ┌────┐▒┌────┐▒▒     ┌────┐▒┌─┐    ▒ land; on the left one bridge has its
//!   │════│═│════│══     │════│═│││    lines from end to end. On the right the
//!   │════│═│════│══     │════│═│││    gaps are crossed in different directions,
//!   └────┘▒└────┘▒▒     └────┘▒└─┘    and each bridge has half of the land.
//! ```
//!
//! In: gaps, and the way in which lines can hang over each one. Out:
//! for each bridge the way, the gaps, and the land that its lines reach
//! onto. Land narrower than two anchors holds both bridges beside it, so no
//! line ends over a gap that another bridge crosses.

use super::direction::Way;
use isoslice_base::units::{Degrees, Mm};
use isoslice_planar::clip::{difference, unite};
use isoslice_planar::grid::EdgeGrid;
use isoslice_planar::offset::offset;
use isoslice_planar::{Area, BoxTree, point_beside};
use std::cell::OnceCell;

/// How much longer than in its best direction the lines across a gap may be,
/// for the sake of one bridge with the gap beside it. A longer line sags more:
/// 1.1 times the span sags half as much again, if it sags as a beam does (the
/// fourth power). Equal gaps side by side differ by less.
const LONGER: f64 = 1.1;

/// Land is taken to be as wide as this at least, mm. No bead is narrower. The
/// width is the first distance at which it is asked which gap is nearer, so it
/// bounds the number of questions: 18 for anchors of 20 mm.
const NARROWEST: Mm = 0.1;

/// Ratio of the distances at which it is asked which gap is nearer. The middle
/// of land that is nowhere wider is exact; elsewhere a border is off by the
/// same share at most.
const WIDER: f64 = 1.4;

/// Size of the cells in which edges are looked up, mm.
const CELL: Mm = 1.0;

/// Reaches that overlap by less only touch, mm: coordinates are rounded.
const TOUCH: Mm = 1e-4;

/// A gap in what holds a layer.
pub(super) struct Gap {
    area: Area,
    /// The edges of `area`. They are found when a gap nearby first asks for
    /// them.
    edges: OnceCell<EdgeGrid>,
    /// How far its lines reach onto the land around it.
    reach: Mm,
    /// The span of the lines if they run the best way, and that way; none if no
    /// lines can hang here.
    best: Option<(Mm, Way)>,
    /// The gap and what its lines may reach onto.
    reached: Area,
}

/// What hangs in one piece.
pub(super) struct Span {
    /// The gaps and the land that lines reach onto.
    pub reached: Area,
    /// How the lines run.
    pub way: Way,
}

impl Gap {
    /// A gap with the best way of its lines, which reach onto the land around it
    /// by `reach`.
    pub(super) fn new(
        area: Area,
        best: Option<(Mm, Way)>,
        reach: Mm,
        tolerance: Mm,
    ) -> Gap {
        let (reach, reached) = match best {
            Some(_) => (reach, offset(&area, reach, tolerance)),
            None => (0.0, area.clone()),
        };
        Gap {
            area,
            edges: OnceCell::new(),
            reach,
            best,
            reached,
        }
    }

    /// True if what the lines of two gaps reach meets. The gaps themselves do
    /// not meet, so their edges tell.
    fn meets(&self, other: &Gap) -> bool {
        let within = self.reach + other.reach - TOUCH;
        within > 0.0
            && (self.has_corner_near(other, within)
                || other.has_corner_near(self, within))
    }

    /// True if a corner of the gap is within a distance of another gap's edge.
    fn has_corner_near(&self, other: &Gap, within: Mm) -> bool {
        let edges =
            other.edges.get_or_init(|| EdgeGrid::new(&other.area, CELL));
        let near = other.area.bounds().grown(within);
        let mut corners = self.area.rings.iter().flatten();
        corners.any(|&p| {
            near.contains(p) && edges.nearest_edge(p, within).is_some()
        })
    }
}

/// The bridges over some gaps. `span` is that of lines across an area in a
/// direction, if they can hang there.
pub(super) fn spans(
    gaps: &[Gap],
    span: impl Fn(&Area, Degrees) -> Option<Mm>,
    reach: Mm,
    tolerance: Mm,
) -> Vec<Span> {
    let beside = beside(gaps);
    let (groups, owner) = groups(gaps, &beside, span);
    let of_group = |(g, (members, way)): (usize, &Group)| {
        let all = members.iter().flat_map(|&i| &gaps[i].reached.rings);
        let mut reached = unite(&all.cloned().collect());
        let mut others: Vec<usize> =
            members.iter().flat_map(|&i| &beside[i]).copied().collect();
        others.retain(|&j| owner[j] != Some(g));
        others.sort_unstable();
        others.dedup();
        if others.is_empty() {
            let way = *way;
            return Span { reached, way };
        }
        for j in others {
            let near = beside[j].iter().filter(|&&i| owner[i] == Some(g));
            let near = near.flat_map(|&i| &gaps[i].area.rings);
            let near: Area = near.cloned().collect();
            let other = &gaps[j];
            let taken = match other.best {
                Some(_) => nearer(&other.area, &near, reach, tolerance),
                None => other.area.clone(),
            };
            reached = difference(&reached, &taken);
        }
        // Land beyond another gap is no land of this bridge.
        let inside = members.iter().filter_map(|&i| {
            gaps[i].area.rings.first().and_then(|r| point_beside(r))
        });
        let inside: Vec<_> = inside.collect();
        let parts = reached.islands().into_iter();
        let own = parts.filter(|part| inside.iter().any(|p| part.contains(*p)));
        Span {
            reached: own.flat_map(|part| part.rings).collect(),
            way: *way,
        }
    };
    groups.iter().enumerate().map(of_group).collect()
}

/// For each gap, the gaps whose reach meets its own, in order.
fn beside(gaps: &[Gap]) -> Vec<Vec<usize>> {
    let boxes = gaps.iter().map(|gap| gap.reached.bounds());
    let tree = BoxTree::new(boxes.enumerate());
    let mut beside = vec![Vec::new(); gaps.len()];
    for (i, gap) in gaps.iter().enumerate() {
        if isoslice_base::limits::is_stopped() {
            break;
        }
        let found = tree.meeting(gap.reached.bounds());
        for j in found.filter(|&j| j > i && gap.meets(&gaps[j])) {
            beside[i].push(j);
            beside[j].push(i);
        }
    }
    beside.iter_mut().for_each(|found| found.sort_unstable());
    beside
}

/// A bridge's gaps and how its lines run.
type Group = (Vec<usize>, Way);

/// Puts gaps together that lie beside one another and can be crossed in one
/// direction; also returns for each gap the number of its group.
fn groups(
    gaps: &[Gap],
    beside: &[Vec<usize>],
    span: impl Fn(&Area, Degrees) -> Option<Mm>,
) -> (Vec<Group>, Vec<Option<usize>>) {
    let mut owner = vec![None; gaps.len()];
    let mut groups: Vec<Group> = Vec::new();
    for first in 0..gaps.len() {
        let Some((_, way)) = gaps[first].best else {
            continue;
        };
        if owner[first].is_some() {
            continue;
        }
        let own = Some(groups.len());
        owner[first] = own;
        let mut members = vec![first];
        let mut next = 0;
        while let Some(&member) = members.get(next) {
            next += 1;
            for &j in &beside[member] {
                let Some((least, best)) = gaps[j].best else {
                    continue;
                };
                let joins = || match (way, best) {
                    (Way::Across(angle), Way::Across(own)) => {
                        own == angle
                            || span(&gaps[j].area, angle)
                                .is_some_and(|span| span <= LONGER * least)
                    }
                    _ => best == way,
                };
                if owner[j].is_none() && joins() {
                    owner[j] = own;
                    members.push(j);
                }
            }
        }
        groups.push((members, way));
    }
    (groups, owner)
}

/// Which places within `reach` of an area are nearer to it than to another one;
/// the area itself is part of it.
fn nearer(area: &Area, other: &Area, reach: Mm, tolerance: Mm) -> Area {
    let mut nearer = area.clone();
    let mut distance = 0.5 * apart(area, other).max(NARROWEST);
    while distance < WIDER * reach {
        let within = |a: &Area| offset(a, distance.min(reach), tolerance);
        nearer
            .rings
            .extend(difference(&within(area), &within(other)).rings);
        distance *= WIDER;
    }
    unite(&nearer)
}

/// The distance of two areas that do not meet, mm.
fn apart(a: &Area, b: &Area) -> Mm {
    let from = |a: &Area, b: &Area| {
        let grid = EdgeGrid::new(b, CELL);
        let points = a.rings.iter().flatten();
        let far = points.filter_map(|&p| Some(p.distance(grid.nearest(p)?.1)));
        far.fold(Mm::INFINITY, Mm::min)
    };
    from(a, b).min(from(b, a))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2;
    use isoslice_planar::Ring;
    use isoslice_planar::clip::intersection;

    /// A star in a place, turned by its place; with a hole if it is large.
    fn star(at: DVec2, radius: Mm) -> Area {
        let ring = |radius: Mm| -> Ring {
            let point = |k: i32| {
                let r = radius * if k % 2 == 0 { 1.0 } else { 0.6 };
                let angle = f64::from(k) * std::f64::consts::TAU / 14.0;
                at + r * DVec2::from_angle(angle + at.x)
            };
            (0..14).map(point).collect()
        };
        let mut area: Area = [ring(radius)].into_iter().collect();
        if radius > 4.0 {
            area.rings
                .push(ring(0.8 * radius).into_iter().rev().collect());
        }
        area
    }

    /// Stars beside one another, some of them in the hole of a large one, some
    /// of which cannot be crossed.
    fn stars() -> Vec<(Area, bool)> {
        let star = |k: u32| {
            let (x, y) = (f64::from(k % 7), f64::from(k / 7));
            let at = DVec2::new(4.1 * x + 0.3 * y, 3.7 * y - 0.2 * x);
            (star(at, 0.5 + 0.12 * f64::from(k * 5 % 9)), k % 4 != 1)
        };
        let mut all: Vec<_> = (0..49).map(star).collect();
        all.push((self::star(DVec2::new(12.0, 11.0), 30.0), true));
        all
    }

    #[test]
    fn gaps_lie_beside_one_another_if_what_they_reach_overlaps() {
        let mut counts = Vec::new();
        for reach in [0.2, 1.0, 2.5, 20.0] {
            let gaps = stars().into_iter().map(|(area, crossed)| {
                Gap::new(
                    area,
                    crossed.then_some((1.0, Way::Across(0.0))),
                    reach,
                    1e-3,
                )
            });
            let gaps: Vec<Gap> = gaps.collect();
            let beside = beside(&gaps);
            for (i, a) in gaps.iter().enumerate() {
                for (j, b) in gaps.iter().enumerate() {
                    let both = intersection(&a.reached, &b.reached);
                    // Arcs are cut short, so that little says nothing.
                    let clear = both.content() > 0.01;
                    let listed = beside[i].contains(&j);
                    assert!(listed || !clear || i == j, "{reach}: {i} {j}");
                    assert!(!listed || !both.is_empty(), "{reach}: {i} {j}");
                }
            }
            counts.push(beside.iter().map(Vec::len).sum::<usize>());
        }
        assert!(counts.is_sorted() && counts[0] > 0, "{counts:?}");
        assert!(counts[0] < counts[3] / 9, "{counts:?}");
    }
}
