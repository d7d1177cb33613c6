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
//! In: gaps, and the direction in which lines can hang across each one. Out:
//! for each bridge the direction, the gaps, and the land that its lines reach
//! onto. Land narrower than two anchors holds both bridges beside it, so no
//! line ends over a gap that another bridge crosses.

use crate::plane::clip::{difference, intersection, unite};
use crate::plane::grid::EdgeGrid;
use crate::plane::offset::offset;
use crate::plane::{Area, BoxTree, point_beside};
use crate::units::{Degrees, Mm};

/// How much longer than in its best direction the lines across a gap may be,
/// for the sake of one bridge with the gap beside it.
const LONGER: f64 = 1.1;

/// Land is taken to be as wide as this at least, mm.
const NARROWEST: Mm = 0.1;

/// Ratio of the distances at which it is asked which gap is nearer. The middle
/// of land that is nowhere wider is exact; elsewhere a border is off by the
/// same share at most.
const WIDER: f64 = 1.4;

/// A gap in what holds a layer.
pub(super) struct Gap {
    area: Area,
    /// The span of the lines in the best direction, and that direction; none if
    /// no lines can hang here.
    best: Option<(Mm, Degrees)>,
    /// The gap and what its lines may reach onto.
    reached: Area,
}

/// What hangs in one piece.
pub(super) struct Span {
    /// The gaps and the land that lines reach onto.
    pub reached: Area,
    /// Direction of the lines.
    pub angle: Degrees,
}

impl Gap {
    /// A gap with its best direction, whose lines reach onto the land around it
    /// by `reach`.
    pub(super) fn new(
        area: Area,
        best: Option<(Mm, Degrees)>,
        reach: Mm,
        tolerance: Mm,
    ) -> Gap {
        let reached = match best {
            Some(_) => offset(&area, reach, tolerance),
            None => area.clone(),
        };
        Gap {
            area,
            best,
            reached,
        }
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
    let of_group = |(g, (members, angle)): (usize, &(Vec<usize>, Degrees))| {
        crate::limits::check();
        let all = members.iter().flat_map(|&i| &gaps[i].reached.rings);
        let mut reached = unite(&all.cloned().collect());
        let mut others: Vec<usize> =
            members.iter().flat_map(|&i| &beside[i]).copied().collect();
        others.retain(|&j| owner[j] != Some(g));
        others.sort_unstable();
        others.dedup();
        if others.is_empty() {
            let angle = *angle;
            return Span { reached, angle };
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
            angle: *angle,
        }
    };
    groups.iter().enumerate().map(of_group).collect()
}

/// For each gap, the gaps whose reach meets its own.
fn beside(gaps: &[Gap]) -> Vec<Vec<usize>> {
    let boxes = gaps.iter().map(|gap| gap.reached.bounds());
    let tree = BoxTree::new(boxes.enumerate());
    let meeting = |(i, gap): (usize, &Gap)| {
        crate::limits::check();
        let found = tree.meeting(gap.reached.bounds());
        let meets = |j: &usize| {
            *j != i && !intersection(&gap.reached, &gaps[*j].reached).is_empty()
        };
        let mut found: Vec<usize> = found.filter(meets).collect();
        found.sort_unstable();
        found
    };
    gaps.iter().enumerate().map(meeting).collect()
}

/// A bridge's gaps and the direction of its lines.
type Group = (Vec<usize>, Degrees);

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
        let Some((_, angle)) = gaps[first].best else {
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
                let joins = || {
                    best == angle
                        || span(&gaps[j].area, angle)
                            .is_some_and(|span| span <= LONGER * least)
                };
                if owner[j].is_none() && joins() {
                    owner[j] = own;
                    members.push(j);
                }
            }
        }
        groups.push((members, angle));
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
    /// Size of the cells in which edges are looked up, mm.
    const CELL: Mm = 1.0;
    let from = |a: &Area, b: &Area| {
        let grid = EdgeGrid::new(b, CELL);
        let points = a.rings.iter().flatten();
        let far = points.filter_map(|&p| Some(p.distance(grid.nearest(p)?.1)));
        far.fold(Mm::INFINITY, Mm::min)
    };
    from(a, b).min(from(b, a))
}
