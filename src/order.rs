//! The order in which a layer's beads are printed, and where loops begin.
//!
//! In: a layer's beads by kind. Out: the beads in print order, closed ones
//! rotated to their seam, open ones turned so that their nearer end comes
//! first. Islands are finished one at a time, nearest first; within an island
//! come its walls, then sparse infill, then skin.
//!
//! Seams are carried from layer to layer: a loop begins at the point nearest
//! to a seam of the layer below, so that seams form lines up the part. A new
//! line starts in the sharpest concave corner, or at the back.

mod sweep;

use crate::bead::{Bead, Role};
use crate::plane::Area;
use crate::plane::grid::EdgeGrid;
use crate::plane::grid::nearest_on;
use crate::plane::nest::Nest;
use crate::settings::{Seam, Settings, WallOrder};
use crate::skin::Patch;
use crate::units::Mm;
use glam::DVec2;
use rstar::RTree;
use rstar::primitives::GeomWithData;

/// What there is to print in a layer.
#[derive(Clone, Debug, Default)]
pub struct LayerBeads {
    /// Loops around the part, in order.
    pub skirt: Vec<Bead>,
    /// Closed beads of the walls.
    pub walls: Vec<Bead>,
    /// Sparse infill.
    pub infill: Vec<Bead>,
    /// Skin areas.
    pub skin: Vec<Patch>,
}

/// What one layer hands to the next.
#[derive(Clone, Debug, Default)]
pub struct Head {
    /// Where the nozzle stands, if it has printed yet.
    pub at: Option<DVec2>,
    /// Seams of the layer below.
    pub seams: Vec<DVec2>,
}

/// How far a seam may move from one layer to the next before it counts as a
/// new one, mm.
const SEAM_REACH: Mm = 2.0;

/// The least turn of a corner that hides a seam, in radians (30°).
const SEAM_CORNER: f64 = 0.52;

/// Beads of one island.
#[derive(Default)]
struct Island {
    /// Walls by loop: the outer one first, then what runs inside it.
    loops: Vec<Vec<Bead>>,
    infill: Vec<Bead>,
    skin: Vec<Patch>,
}

/// Puts a layer's beads in order. `outline` is the layer's solid.
pub fn order(
    beads: LayerBeads,
    outline: &Area,
    head: &mut Head,
    settings: &Settings,
) -> Vec<Bead> {
    let mut out = Vec::new();
    for bead in beads.skirt {
        let bead = from_nearest(bead, head.at);
        finish(bead, &mut out, head);
    }
    let islands = islands(outline, beads.walls, beads.infill, beads.skin);
    let mut seams = Vec::new();
    let islands = place_seams(islands, head, settings, &mut seams);
    let starts: Vec<Option<DVec2>> = islands.iter().map(island_start).collect();
    let mut left = Nearest::new(
        starts
            .iter()
            .enumerate()
            .filter_map(|(i, p)| p.map(|p| (p, i))),
    );
    let mut islands: Vec<Option<Island>> =
        islands.into_iter().map(Some).collect();
    while let Some(i) = left.pop(head.at) {
        if let Some(island) = islands[i].take() {
            print_island(island, &mut out, head, settings);
        }
    }
    head.seams = seams;
    out
}

/// Sorts the beads to the islands they lie in.
fn islands(
    outline: &Area,
    walls: Vec<Bead>,
    infill: Vec<Bead>,
    skin: Vec<Patch>,
) -> Vec<Island> {
    let solids = outline.islands();
    // The first ring of an island is its outer one.
    let nest = Nest::new(solids.iter().filter_map(|s| s.rings.first()));
    // What lies in none, for rounding, goes with the bead before it.
    let mut last = 0;
    let mut find = |bead: Option<&Bead>| -> usize {
        if solids.len() > 1
            && let Some(&p) = bead.and_then(|b| b.points.first())
        {
            last = nest.around(p).unwrap_or(last);
        }
        last
    };
    let mut islands: Vec<Island> =
        solids.iter().map(|_| Island::default()).collect();
    if islands.is_empty() {
        return islands;
    }
    let mut outer: Vec<Vec<Bead>> = vec![Vec::new(); islands.len()];
    let mut inner: Vec<Vec<Bead>> = vec![Vec::new(); islands.len()];
    for bead in walls {
        let i = find(Some(&bead));
        match bead.role {
            Role::OuterWall => outer[i].push(bead),
            _ => inner[i].push(bead),
        }
    }
    for (i, (outer, inner)) in outer.into_iter().zip(inner).enumerate() {
        islands[i].loops = loops(outer, inner);
    }
    for bead in infill {
        let i = find(Some(&bead));
        islands[i].infill.push(bead);
    }
    for patch in skin {
        let i = find(patch.rings.first());
        islands[i].skin.push(patch);
    }
    islands
}

/// A grid of beads' segments, numbered by bead.
fn grid_of<'a>(beads: impl Iterator<Item = &'a Bead>, reach: Mm) -> EdgeGrid {
    let segments = beads
        .enumerate()
        .flat_map(|(i, b)| b.segments().map(move |s| (i, s)));
    EdgeGrid::of(segments, reach)
}

/// Groups an island's walls: each inner wall goes with the outer wall that it
/// runs along.
fn loops(outer: Vec<Bead>, inner: Vec<Bead>) -> Vec<Vec<Bead>> {
    if outer.is_empty() {
        return inner.into_iter().map(|b| vec![b]).collect();
    }
    let grid = (outer.len() > 1 && !inner.is_empty())
        .then(|| grid_of(outer.iter(), 1.0));
    let mut loops: Vec<Vec<Bead>> =
        outer.into_iter().map(|b| vec![b]).collect();
    for bead in inner {
        let i = grid
            .as_ref()
            .zip(bead.points.first())
            .and_then(|(grid, &p)| grid.nearest(p))
            .map_or(0, |near| near.0);
        loops[i].push(bead);
    }
    loops
}

/// Rotates the outer walls to their seams and collects these.
fn place_seams(
    mut islands: Vec<Island>,
    head: &Head,
    settings: &Settings,
    seams: &mut Vec<DVec2>,
) -> Vec<Island> {
    let outer: Vec<&Bead> = islands
        .iter()
        .flat_map(|i| i.loops.iter().filter_map(|l| l.first()))
        .collect();
    // For each loop the seam below that is nearest to it.
    let mut below: Vec<Option<(f64, DVec2)>> = vec![None; outer.len()];
    if settings.seam == Seam::Aligned && !head.seams.is_empty() {
        let grid = grid_of(outer.iter().copied(), 0.5 * SEAM_REACH);
        for &seam in &head.seams {
            if let Some((ring, point)) = grid.nearest_within(seam, SEAM_REACH) {
                let d = seam.distance(point);
                if below[ring].is_none_or(|b| d < b.0) {
                    below[ring] = Some((d, point));
                }
            }
        }
    }
    let mut below = below.into_iter();
    for island in &mut islands {
        for walls in &mut island.loops {
            let Some(first) = walls.first_mut() else {
                continue;
            };
            let below = below.next().flatten();
            if !first.closed {
                continue;
            }
            let seam = match (settings.seam, below) {
                (Seam::Aligned, Some((_, point))) => Some(point),
                (Seam::Aligned, None) => new_seam(&first.points),
                (Seam::Rear, _) => rear(&first.points),
                (Seam::Nearest, _) => None,
            };
            let Some(seam) = seam else { continue };
            seams.push(seam);
            begin_at(first, seam);
        }
    }
    islands
}

/// Where a line of seams starts: the sharpest concave corner of the solid,
/// which lies to the left of its rings; else the back.
fn new_seam(ring: &[DVec2]) -> Option<DVec2> {
    let n = ring.len();
    let turn = |i: usize| {
        let (a, b, c) = (ring[(i + n - 1) % n], ring[i], ring[(i + 1) % n]);
        (b - a).angle_to(c - b)
    };
    let sharpest = (0..n)
        .map(|i| (turn(i), i))
        .min_by(|a, b| a.0.total_cmp(&b.0))?;
    if sharpest.0 < -SEAM_CORNER {
        Some(ring[sharpest.1])
    } else {
        rear(ring)
    }
}

/// The point farthest back. Slightly to the right counts as back, so that
/// on a level edge it is not rounding that picks the corner.
fn rear(ring: &[DVec2]) -> Option<DVec2> {
    let back = DVec2::new(0.02, 1.0);
    ring.iter()
        .copied()
        .max_by(|a, b| back.dot(*a).total_cmp(&back.dot(*b)))
}

/// Lets a closed bead begin at its point nearest to `seam`, which is added
/// to it unless a point is there already.
fn begin_at(bead: &mut Bead, seam: DVec2) {
    /// Closer to a point than this the seam is that point, mm.
    const SAME: Mm = 0.01;
    let nearest = bead
        .segments()
        .enumerate()
        .map(|(i, (a, b))| {
            let p = nearest_on(seam, a, b);
            (p.distance(seam), i, p)
        })
        .min_by(|a, b| a.0.total_cmp(&b.0));
    let Some((_, i, p)) = nearest else { return };
    let next = (i + 1) % bead.points.len();
    let (a, b) = (bead.points[i], bead.points[next]);
    if p.distance(a) < SAME {
        bead.begin_at(i);
    } else if p.distance(b) < SAME {
        bead.begin_at(next);
    } else {
        if let (Some(u), Some(v)) = (bead.widths.get(i), bead.widths.get(next))
        {
            let t = a.distance(p) / a.distance(b);
            bead.widths.insert(i + 1, u + t * (v - u));
        }
        bead.points.insert(i + 1, p);
        bead.begin_at(i + 1);
    }
}

/// Where an island's printing would start.
fn island_start(island: &Island) -> Option<DVec2> {
    let walls = island.loops.iter().flatten();
    let skin = island.skin.iter().flat_map(|p| &p.rings);
    walls
        .chain(&island.infill)
        .chain(skin)
        .next()
        .and_then(|b| b.points.first().copied())
}

fn print_island(
    island: Island,
    out: &mut Vec<Bead>,
    head: &mut Head,
    settings: &Settings,
) {
    let mut left =
        Nearest::new(
            island.loops.iter().enumerate().filter_map(|(i, l)| {
                l.first()?.points.first().map(|&p| (p, i))
            }),
        );
    let mut loops: Vec<Vec<Bead>> = island.loops;
    while let Some(i) = left.pop(head.at) {
        let mut walls = std::mem::take(&mut loops[i]).into_iter();
        let Some(outer) = walls.next() else { continue };
        let Some(&seam) = outer.points.first() else {
            continue;
        };
        // Walls that pass the outer one's seam begin there, right before or
        // after it; pieces elsewhere go their own way.
        let (mut beside, mut away) = (Vec::new(), Vec::new());
        for mut wall in walls {
            if wall.closed && outer.closed {
                begin_at(&mut wall, seam);
                let d = wall.points.first().map(|p| p.distance(seam));
                if d.is_some_and(|d| d <= SEAM_REACH) {
                    beside.push(wall);
                    continue;
                }
            }
            away.push(wall);
        }
        if settings.wall_order == WallOrder::InnerFirst {
            print_rings(away, out, head);
            beside.reverse();
            for wall in beside.into_iter().chain([outer]) {
                print_wall(wall, out, head, settings);
            }
        } else {
            for wall in std::iter::once(outer).chain(beside) {
                print_wall(wall, out, head, settings);
            }
            print_rings(away, out, head);
        }
    }
    print_rings(island.infill, out, head);
    let mut left =
        Nearest::new(island.skin.iter().enumerate().filter_map(|(i, p)| {
            p.rings.first()?.points.first().map(|&p| (p, i))
        }));
    let mut skin: Vec<Option<Patch>> =
        island.skin.into_iter().map(Some).collect();
    while let Some(i) = left.pop(head.at) {
        let Some(patch) = skin[i].take() else {
            continue;
        };
        print_rings(patch.rings, out, head);
        for fill in patch.fills {
            match fill.after.is_empty() {
                false => sweep::print(fill, out, head),
                true if fill.lines.iter().any(|l| l.closed) => {
                    print_rings(fill.lines, out, head);
                }
                true => print_lines(fill.lines, out, head),
            }
        }
    }
}

/// A wall from its seam, or from where the head is if that is the seam.
fn print_wall(
    wall: Bead,
    out: &mut Vec<Bead>,
    head: &mut Head,
    settings: &Settings,
) {
    let wall = match wall.closed && settings.seam != Seam::Nearest {
        true => wall,
        false => from_nearest(wall, head.at),
    };
    finish(wall, out, head);
}

/// Beads nearest first, closed ones begun at their point nearest to the head,
/// open ones at their nearer end.
fn print_rings(rings: Vec<Bead>, out: &mut Vec<Bead>, head: &mut Head) {
    let points = rings.iter().enumerate().flat_map(|(i, b)| {
        let (first, last) = (b.points.first(), b.points.last());
        let ends = first.into_iter().chain(last);
        let all: Vec<DVec2> = match b.closed {
            true => b.points.clone(),
            false => ends.copied().collect(),
        };
        all.into_iter().map(move |p| (p, i))
    });
    let mut left = Nearest::new(points);
    let mut rings: Vec<Option<Bead>> = rings.into_iter().map(Some).collect();
    while let Some(i) = left.pop(head.at) {
        if let Some(ring) = rings[i].take() {
            finish(from_nearest(ring, head.at), out, head);
        }
    }
}

/// Open beads, nearest end first.
fn print_lines(lines: Vec<Bead>, out: &mut Vec<Bead>, head: &mut Head) {
    let ends = lines.iter().enumerate().flat_map(|(i, b)| {
        let from = b.points.first().map(|&p| (p, 2 * i));
        let to = b.points.last().map(|&p| (p, 2 * i + 1));
        from.into_iter().chain(to)
    });
    let mut left = Nearest::new(ends);
    let mut lines: Vec<Option<Bead>> = lines.into_iter().map(Some).collect();
    while let Some(end) = left.pop(head.at) {
        let Some(mut bead) = lines[end / 2].take() else {
            continue;
        };
        if end % 2 == 1 {
            bead.reverse();
        }
        finish(bead, out, head);
    }
}

/// A closed bead begun at its point nearest to the head, an open one turned
/// so that its nearer end comes first.
fn from_nearest(mut bead: Bead, head: Option<DVec2>) -> Bead {
    let Some(head) = head else { return bead };
    let d = |p: &DVec2| p.distance_squared(head);
    if bead.closed {
        let nearest = (0..bead.points.len())
            .min_by(|&a, &b| d(&bead.points[a]).total_cmp(&d(&bead.points[b])));
        bead.begin_at(nearest.unwrap_or(0));
    } else if let (Some(a), Some(b)) = (bead.points.first(), bead.points.last())
        && d(b) < d(a)
    {
        bead.reverse();
    }
    bead
}

fn finish(bead: Bead, out: &mut Vec<Bead>, head: &mut Head) {
    crate::limits::check();
    let end = match bead.closed {
        true => bead.points.first(),
        false => bead.points.last(),
    };
    if let Some(&p) = end {
        head.at = Some(p);
        out.push(bead);
    }
}

/// Points to be visited nearest first.
struct Nearest {
    tree: RTree<GeomWithData<[f64; 2], usize>>,
}

impl Nearest {
    fn new(points: impl Iterator<Item = (DVec2, usize)>) -> Nearest {
        let all = points
            .map(|(p, i)| GeomWithData::new(p.to_array(), i))
            .collect();
        Nearest {
            tree: RTree::bulk_load(all),
        }
    }

    /// One more point.
    fn push(&mut self, at: DVec2, number: usize) {
        self.tree.insert(GeomWithData::new(at.to_array(), number));
    }

    /// Takes the point nearest to `from`; without one, that nearest to the
    /// origin, so that the order does not depend on the tree's shape.
    fn pop(&mut self, from: Option<DVec2>) -> Option<usize> {
        let at = from.unwrap_or(DVec2::ZERO).to_array();
        self.tree.pop_nearest_neighbor(&at).map(|g| g.data)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ring(points: &[(f64, f64)]) -> Vec<DVec2> {
        points.iter().map(|&(x, y)| DVec2::new(x, y)).collect()
    }

    fn wall(role: Role, points: Vec<DVec2>) -> Bead {
        Bead {
            role,
            points,
            closed: true,
            width: 0.45,
            widths: Vec::new(),
            height: 0.2,
        }
    }

    fn square(x: f64, half: f64) -> Vec<DVec2> {
        ring(&[
            (x - half, -half),
            (x + half, -half),
            (x + half, half),
            (x - half, half),
        ])
    }

    fn two_squares() -> (LayerBeads, Area) {
        let beads = LayerBeads {
            walls: vec![
                wall(Role::OuterWall, square(0.0, 4.0)),
                wall(Role::OuterWall, square(20.0, 4.0)),
                wall(Role::InnerWall, square(0.0, 3.0)),
                wall(Role::InnerWall, square(20.0, 3.0)),
            ],
            ..LayerBeads::default()
        };
        let outline = Area {
            rings: vec![square(0.0, 4.2), square(20.0, 4.2)],
        };
        (beads, outline)
    }

    #[test]
    fn islands_are_finished_one_at_a_time() {
        let (beads, outline) = two_squares();
        let mut head = Head {
            at: Some(DVec2::new(30.0, 0.0)),
            ..Head::default()
        };
        let settings = Settings::default();
        let out = order(beads, &outline, &mut head, &settings);
        let side: Vec<bool> =
            out.iter().map(|b| b.points[0].x > 10.0).collect();
        assert_eq!(side, [true, true, false, false]);
        let roles: Vec<Role> = out.iter().map(|b| b.role).collect();
        use Role::{InnerWall, OuterWall};
        assert_eq!(roles, [InnerWall, OuterWall, InnerWall, OuterWall]);
    }

    #[test]
    fn seams_follow_those_of_the_layer_below() {
        let (beads, outline) = two_squares();
        let mut head = Head {
            at: None,
            seams: vec![DVec2::new(1.0, -4.1)],
        };
        let settings = Settings::default();
        let out = order(beads, &outline, &mut head, &settings);
        let starts: Vec<DVec2> = out
            .iter()
            .filter(|b| b.role == Role::OuterWall)
            .map(|b| b.points[0])
            .collect();
        assert!(starts.contains(&DVec2::new(1.0, -4.0)), "{starts:?}");
        // The other one starts anew, at the back.
        assert!(starts.iter().any(|p| p.x > 10.0 && p.y == 4.0));
        assert_eq!(head.seams.len(), 2);
    }

    #[test]
    fn a_new_seam_hides_in_a_concave_corner() {
        let l = ring(&[
            (0.0, 0.0),
            (9.0, 0.0),
            (9.0, 3.0),
            (3.0, 3.0),
            (3.0, 9.0),
            (0.0, 9.0),
        ]);
        assert_eq!(new_seam(&l), Some(DVec2::new(3.0, 3.0)));
    }

    #[test]
    fn lines_are_taken_nearest_end_first() {
        let line = |y: f64| Bead {
            role: Role::SparseInfill,
            points: ring(&[(0.0, y), (10.0, y)]),
            closed: false,
            width: 0.45,
            widths: Vec::new(),
            height: 0.2,
        };
        let lines = vec![line(0.0), line(2.0), line(1.0)];
        let mut head = Head {
            at: Some(DVec2::new(11.0, -1.0)),
            ..Head::default()
        };
        let mut out = Vec::new();
        print_lines(lines, &mut out, &mut head);
        let path: Vec<(f64, f64)> =
            out.iter().map(|b| (b.points[0].x, b.points[0].y)).collect();
        assert_eq!(path, [(10.0, 0.0), (0.0, 1.0), (10.0, 2.0)]);
    }
}
