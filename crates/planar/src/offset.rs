//! Offsets of areas: level sets of the distance to their border.
//!
//! Every edge is moved along its normal, and the gaps at the corners are
//! closed: with the corner's own angle where the border moves into it, with an
//! arc where it moves away. The moved border is the answer wherever no other
//! part of the border is nearer than the distance, as a grid of the border's
//! edges tells. This is so on most layers, and for the outer walls of all
//! smooth parts. Where the area is thinner than twice the distance, its rings
//! come too near to each other. Only these go through a sweep that removes
//! overlaps (positive winding), which costs several times as much. Where nearly all
//! of a long border is too near, it moves by halves of the distance.
//!
//! Guarantee: the result is within `tolerance` of the true level set.

use super::clip::positive;
use super::grid::EdgeGrid;
use super::trim::{self, Moved, State};
use super::{Area, Rect, Ring, Solid, signed_area};
use glam::DVec2;
use isoslice_base::units::Mm;

/// The area grown by `distance` (shrunk, if negative). Corners that the border
/// moves away from become arcs around the corner, within `tolerance` of the
/// true distance. Corners that the border moves into stay sharp.
pub fn offset(area: &Area, distance: Mm, tolerance: Mm) -> Area {
    let solid = Solid::of(area, distance.abs());
    offset_within(&solid, None, distance, tolerance)
}

/// How far an area's edges can move inwards until they meet what is opposite.
/// Each edge, numbered as in a grid, has a least and a greatest distance, since
/// the room changes along it. An edge of which nothing is known has 0 and
/// infinity.
#[derive(Clone, Debug, Default)]
pub struct Room {
    /// The least room along an edge and its neighbours.
    pub least: Vec<Mm>,
    /// The greatest room along an edge and its neighbours.
    pub most: Vec<Mm>,
    /// For each edge, the number of an edge that it may meet, if there is one.
    pub opposite: Vec<u32>,
}

impl Room {
    /// What becomes of an edge that moves by `distance`, if that is certain.
    /// The room is known at places some tenths of a millimetre apart, and may
    /// be a little less between them.
    fn state(&self, edge: usize, distance: Mm) -> Option<State> {
        let margin = 0.03 + 0.05 * distance;
        // Between opposite sides the room grows by less than 0.6 of the way.
        let steep = 0.06;
        match (self.least.get(edge)?, self.most.get(edge)?) {
            (least, _) if *least > distance + margin => Some(State::Clear),
            (_, most) if *most < distance - steep => Some(State::Covered),
            _ => None,
        }
    }
}

/// [`offset`], given how far the edges can move inwards, if that is known.
pub fn offset_within(
    solid: &Solid<'_>,
    room: Option<&Room>,
    distance: Mm,
    tolerance: Mm,
) -> Area {
    let area = solid.area();
    if area.is_empty() || distance == 0.0 {
        return area.clone();
    }
    // Arcs are cut short by the tolerance, and coordinates are rounded.
    let slack = 1.02 * tolerance + 1e-6;
    let clearance = (distance.abs() - slack).max(0.0);
    // A ring no wider than twice the distance vanishes when its inside shrinks,
    // and next to nothing is left of a ring that is hardly wider. Turned inside
    // out, or shrunk to a point, all edges of such a ring would cross all
    // others.
    let vanishes = |ring: &Ring| {
        let bounds = Rect::around(ring);
        let inside_shrinks = (signed_area(ring) > 0.0) == (distance < 0.0);
        let width = bounds.size().min_element();
        inside_shrinks && width <= 2.0 * distance.abs() + tolerance
    };
    // Of most small islands nothing is left, and nobody has to look around.
    if area.rings.iter().all(vanishes) {
        return Area::EMPTY;
    }
    let grid = solid.grid();
    let room = room.filter(|_| distance < 0.0);
    // In a strip thinner than the slack, a side that has moved through the other
    // is no nearer to it than it should be, but lies on its wrong side.
    let beyond = |p: DVec2| grid.contains(p) != (distance < 0.0);
    // What lies inside a thin strip is nowhere as deep as the edge has moved.
    let is_left = |p: DVec2| !beyond(p) && grid.clear(p, p, clearance);
    let passes = |[a, b]: [DVec2; 2]| {
        if ![a.midpoint(b), a, b].into_iter().all(beyond) {
            return false;
        }
        let mut cuts = grid.crossings(a, b);
        cuts.sort_by(f64::total_cmp);
        let mut between = cuts.windows(2).map(|c| 0.5 * (c[0] + c[1]));
        !between.any(|t| is_left(a.lerp(b, t)))
    };
    let mut rings: Vec<Ring> = Vec::with_capacity(area.rings.len());
    let mut turned = Vec::with_capacity(area.rings.len());
    let mut states = Vec::with_capacity(EdgeGrid::numbers(&area.rings));
    let mut origins = Vec::new();
    let mut first = 0;
    for ring in &area.rings {
        let begin = first;
        first += ring.len() + usize::from(!ring.is_empty());
        if vanishes(ring) {
            continue;
        }
        origins.clear();
        let m = moved(ring, -distance, tolerance, &mut origins);
        if m.len() < 3 {
            continue;
        }
        let mut passed = Passed::default();
        let mut covered_by = None;
        for ((a, b), &origin) in super::edges(&m).zip(&origins) {
            let known = match (room, origin) {
                (Some(room), Some(edge)) => {
                    room.state(begin + edge as usize, -distance)
                }
                _ => None,
            };
            let ask = || {
                let meets = room.zip(origin).and_then(|(room, edge)| {
                    room.opposite.get(begin + edge as usize).copied()
                });
                match meets {
                    Some(edge) if trim::covers(a, b, grid, edge, clearance) => {
                        State::Covered
                    }
                    _ => trim::state(a, b, grid, clearance, &mut covered_by),
                }
            };
            states.push(passed.state(
                known.unwrap_or_else(ask),
                [a, b],
                clearance,
                passes,
            ));
        }
        turned.push((signed_area(ring) > 0.0) != (signed_area(&m) > 0.0));
        rings.push(m);
    }
    if states.iter().all(|s| *s == State::Covered) {
        return Area::EMPTY;
    }
    let clear = states.iter().all(|s| *s == State::Clear);
    if clear && !turned.contains(&true) {
        return Area { rings };
    }
    let crowded = is_crowded(&states, distance);
    let left = Moved {
        rings: &rings,
        states,
        grid,
        clearance,
        slack,
        left: distance < 0.0,
        turned: &turned,
    };
    match left.trim() {
        Some(rings) => Area { rings },
        None if crowded => by_halves(solid, room, distance, tolerance),
        // A hole's loops cancel against the ring around it, so either all rings
        // go through the sweep or none.
        None => positive(&Area { rings }),
    }
}

/// Finds moved edges that have passed through a strip thinner than the slack, one
/// after another along a ring.
#[derive(Default)]
struct Passed {
    /// Whether the last edge has passed, if it is clear of all edges: then so has a
    /// clear edge after it, since there is no border between the two.
    clear: Option<bool>,
}

impl Passed {
    /// The state of an edge, which is covered if all of it `passes` beyond the border.
    fn state(
        &mut self,
        state: State,
        edge: [DVec2; 2],
        clearance: Mm,
        passes: impl Fn([DVec2; 2]) -> bool,
    ) -> State {
        let clear = state == State::Clear && clearance > 0.0;
        let before = self.clear.take().filter(|_| clear);
        let passed =
            state != State::Covered && before.unwrap_or_else(|| passes(edge));
        self.clear = clear.then_some(passed);
        if passed { State::Covered } else { state }
    }
}

/// Least number of edges that are moved by halves of the distance. Fewer are swept
/// in less than a tenth of a second.
const MANY: usize = 20_000;
/// Least distance, mm, that is halved, and so the end of the halving.
const HALVED: Mm = 0.1;
/// Edges are crowded if so many are covered for each one that is not.
const COVERED: usize = 4;

/// True if a sweep would meet very many crossings, since nearly all edges have moved
/// into others.
fn is_crowded(states: &[State], distance: Mm) -> bool {
    let covered = states.iter().filter(|s| **s == State::Covered).count();
    let left = states.len() - covered;
    let many = states.len() > MANY && covered > COVERED * left;
    many && distance.abs() > HALVED
}

/// An offset by a half of the distance and by the other half. On the way most of a
/// crowded border vanishes: 350,000 edges of noise, moved by 0.44 mm, take 4 s
/// instead of 24.
fn by_halves(
    solid: &Solid<'_>,
    room: Option<&Room>,
    distance: Mm,
    tolerance: Mm,
) -> Area {
    let (half, slack) = (0.5 * distance, 0.5 * tolerance);
    let middle = offset_within(solid, room, half, slack);
    offset(&middle, half, slack)
}

/// Greatest turn of a corner, in radians, at which the room of its edges also
/// holds for the arc around it.
const SMALL_TURN: f64 = 0.35;

/// The ring with every edge moved to its left by `by`, which may overlap
/// itself. Where an edge is too short for the corners at its ends, the ring
/// runs back to the corner itself, so that the overlap winds negatively.
/// `origins` gets, for each new edge, the edge from which it comes, if there is
/// one.
pub(super) fn moved(
    ring: &[DVec2],
    by: f64,
    tolerance: Mm,
    origins: &mut Vec<Option<u32>>,
) -> Ring {
    if isoslice_base::limits::is_stopped() {
        return Ring::new();
    }
    isoslice_base::limits::made(ring.len());
    let sides = MovedEdges::new(ring, by);
    let n = sides.all.len();
    let mut out = Ring::with_capacity(n + n / 4);
    let step = {
        let c = 1.0 - (tolerance / by.abs()).min(1.0);
        2.0 * c.acos()
    };
    for i in 0..n {
        let side = &sides.all[i];
        if side.gone {
            continue;
        }
        let before = &sides.all[side.before as usize];
        let (u, v) = (before.along, side.along);
        let (nu, nv) = (u.perp(), v.perp());
        let p = side.from;
        if let Some(meet) = side.corner {
            if before.room() >= 0.0 && side.room() >= 0.0 {
                out.push(meet);
            } else {
                out.extend([p + nu * by, p, p + nv * by]);
                origins.extend([None, None]);
            }
            origins.push(Some(side.edge));
            continue;
        }
        let (sine, cosine) = (u.perp_dot(v), u.dot(v));
        let reach = 1.0 / (1.0 + cosine);
        let excess = by.abs() * ((2.0 * reach).sqrt() - 1.0);
        if excess <= tolerance {
            // The sum of both normals has the bisector's direction. Scaled by
            // `reach` it leads to the point where the moved edges' lines meet.
            out.push(p + (nu + nv) * (by * reach));
            origins.push(Some(side.edge));
            continue;
        }
        let turn = sine.atan2(cosine);
        let turn = if turn == 0.0 || turn * by > 0.0 {
            -std::f64::consts::PI * by.signum()
        } else {
            turn
        };
        let steps = (turn.abs() / step).ceil().max(1.0);
        for k in 0..=steps as usize {
            let angle = turn * k as f64 / steps;
            let normal = DVec2::from_angle(angle).rotate(nu);
            out.push(p + normal * by);
            // The room beside a small turn is that of the edges.
            let beside = k as f64 >= steps || turn.abs() < SMALL_TURN;
            origins.push(beside.then_some(side.edge));
        }
    }
    out
}

/// A ring's edge that is to be moved.
struct MovedEdge {
    /// Number of the edge in the ring.
    edge: u32,
    from: DVec2,
    along: DVec2,
    length: Mm,
    /// The numbers of its neighbours among those that have not vanished.
    before: u32,
    after: u32,
    /// True if it has shrunk to nothing between its neighbours.
    gone: bool,
    /// Where it meets the side before it when both have moved, if the border
    /// moves into the corner between them.
    corner: Option<DVec2>,
    /// The stretch along the side that is left when it has moved.
    start: Mm,
    end: Mm,
}

impl MovedEdge {
    /// Length of the side when it has moved; negative if its ends have passed
    /// each other.
    fn room(&self) -> Mm {
        self.end - self.start
    }
}

/// A ring's edges without those that vanish on the way.
struct MovedEdges {
    all: Vec<MovedEdge>,
    by: f64,
}

impl MovedEdges {
    fn new(ring: &[DVec2], by: f64) -> MovedEdges {
        let mut all: Vec<MovedEdge> = Vec::with_capacity(ring.len());
        let edges = (0..).zip(super::edges(ring));
        for (edge, (a, b)) in edges.filter(|(_, (a, b))| a != b) {
            let length = a.distance(b);
            all.push(MovedEdge {
                edge,
                from: a,
                along: (b - a) / length,
                length,
                before: 0,
                after: 0,
                gone: false,
                corner: None,
                start: 0.0,
                end: length,
            });
        }
        let n = all.len();
        for (i, side) in all.iter_mut().enumerate() {
            side.before = if i == 0 { n - 1 } else { i - 1 } as u32;
            side.after = if i + 1 == n { 0 } else { i + 1 } as u32;
        }
        let mut sides = MovedEdges { all, by };
        for i in 0..n {
            sides.join(if i == 0 { n - 1 } else { i - 1 }, i);
        }
        sides.drop_vanishing();
        sides.restore_crowded();
        sides
    }

    /// Where two sides' lines meet when they have moved, if the border moves
    /// into the corner between them.
    fn meet(&self, i: usize, j: usize) -> Option<DVec2> {
        let (a, b) = (&self.all[i], &self.all[j]);
        let (sine, cosine) = (a.along.perp_dot(b.along), a.along.dot(b.along));
        // Edges that turn nearly straight back meet far away.
        if sine * self.by <= 0.0 || cosine < -0.999 {
            return None;
        }
        let p = a.from + a.along.perp() * self.by;
        let q = b.from + b.along.perp() * self.by;
        Some(p + a.along * ((q - p).perp_dot(b.along) / sine))
    }

    /// Makes two sides neighbours.
    fn join(&mut self, i: usize, j: usize) {
        let corner = self.meet(i, j);
        let by = self.by;
        let at = |side: &MovedEdge, p: DVec2| {
            (p - (side.from + side.along.perp() * by)).dot(side.along)
        };
        let first = &mut self.all[i];
        first.after = j as u32;
        first.end = corner.map_or(first.length, |p| at(first, p));
        let second = &mut self.all[j];
        second.before = i as u32;
        second.start = corner.map_or(0.0, |p| at(second, p));
        second.corner = corner;
    }

    fn has_room(&self, i: usize) -> bool {
        self.all[i].room() >= 0.0
    }

    /// Drops sides without room between two corners that the border moves into.
    /// They bound nothing any more, since their neighbours meet before they
    /// reach them.
    fn drop_vanishing(&mut self) {
        let mut left = self.all.len();
        let mut todo: Vec<usize> = (0..left).collect();
        while let Some(i) = todo.pop() {
            let side = &self.all[i];
            if side.gone || side.room() >= 0.0 || left <= 3 {
                continue;
            }
            let (before, after) = (side.before as usize, side.after as usize);
            let between = side.corner.is_some()
                && self.all[after].corner.is_some()
                && self.meet(before, after).is_some();
            if between {
                self.all[i].gone = true;
                self.join(before, after);
                left -= 1;
                todo.extend([before, after]);
            }
        }
    }

    /// Brings sides back where their neighbours have no room either: the
    /// neighbours' lines may meet anywhere, and only a sweep can tell what is
    /// left.
    fn restore_crowded(&mut self) {
        let n = self.all.len();
        let mut crowded = true;
        while crowded {
            crowded = false;
            for i in 0..n {
                let before = self.all[i].before as usize;
                let beside = before + 1 == if i == 0 { n } else { i };
                if self.all[i].gone || beside {
                    continue;
                }
                if self.has_room(before) && self.has_room(i) {
                    continue;
                }
                crowded = true;
                let mut k = i;
                while k != before {
                    let next = (k + n - 1) % n;
                    self.all[k].gone = false;
                    self.join(next, k);
                    k = next;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::clip::{difference, unite};
    use super::super::opening::opened;
    use super::super::shapes::{circle, rect};
    use super::*;
    use isoslice_base::random::{mix, share};
    use std::f64::consts::PI;

    #[test]
    fn a_needle_takes_nothing_from_its_area() {
        let ring: Ring = [
            (0.83562, -4.61394),
            (0.83562, -7.7965),
            (1.08814, -7.72884),
            (2.91224, -7.72884),
            (3.16515, -7.79662),
            (3.1666, -1.42647),
            (3.16587, -4.61397),
            (3.16573, -4.61394),
        ]
        .map(|(x, y)| DVec2::new(x, y))
        .to_vec();
        // Without the needle, 2.33 mm by 3.11 mm are left.
        let area = Area::from(ring);
        for k in 1..11 {
            let by = 0.1 * f64::from(k);
            let left = offset(&area, -by, 0.01).content();
            let room = (2.33 - 2.0 * by) * (3.115 - 2.0 * by);
            assert!((left - room).abs() < 0.03, "{by}: {left} {room}");
        }
    }

    /// Strips that are thinner than the tolerance, around an empty place, do not fill
    /// it when their fronts pass through them.
    #[test]
    fn nothing_is_left_of_a_thin_frame() {
        let strip = |from: (f64, f64), to: (f64, f64)| {
            let (a, b) = (DVec2::from(from), DVec2::from(to));
            let half = (b - a).normalize().perp() * 0.001;
            Area::from(vec![a - half, b - half, b + half, a + half])
        };
        let sides = [
            strip((-1.0, 0.0), (11.0, 0.0)),
            strip((0.0, -1.0), (5.5, 9.5)),
            strip((10.0, -1.0), (4.5, 9.5)),
        ];
        let all = sides.into_iter().flat_map(|side| side.rings);
        let frame = unite(&all.collect());
        for by in [0.05, 0.2, 0.5] {
            assert!(offset(&frame, -by, 0.01).content().abs() < 1e-9, "{by}");
        }
    }

    /// The fronts of the ring and of the hole graze each other, and cross twice within
    /// the tolerance. On a raster of 0.01 mm, 0.273 mm² are 1.2 mm deep or deeper.
    #[test]
    fn fronts_that_graze_leave_what_lies_beyond() {
        let outer = [
            (1.97202, 1.38318),
            (-1.86964, 3.44628),
            (-3.04362, -0.44219),
            (-0.73666, -2.97152),
            (0.38145, -0.95909),
        ];
        let hole = [
            (0.16660, -0.34982),
            (-0.01137, -0.50873),
            (-0.27647, -0.47076),
            (-0.33871, -0.45011),
            (-0.29996, -0.19869),
            (-0.28493, -0.11605),
            (-0.36424, 0.20782),
            (-0.21411, -0.03055),
            (0.07846, 0.14383),
            (-0.05022, -0.16169),
        ];
        let ring = |points: &[(f64, f64)]| {
            points.iter().map(|p| DVec2::from(*p)).collect()
        };
        let area = Area {
            rings: vec![ring(&outer), ring(&hole)],
        };
        let left = offset(&area, -1.2, 0.02).content();
        assert!((left - 0.276).abs() < 0.02, "{left}");
    }

    #[test]
    fn shrinking_keeps_convex_corners_and_rounds_concave_ones() {
        let a = rect(0.0, 0.0, 10.0, 10.0);
        let inner = offset(&a, -1.0, 1e-3);
        assert_eq!(inner.rings.len(), 1);
        assert_eq!(inner.rings[0].len(), 4);
        assert!((inner.content() - 64.0).abs() < 1e-6);
        let frame = difference(&a, &rect(4.0, 4.0, 6.0, 6.0));
        let inner = offset(&frame, -1.0, 1e-3);
        // The hole grows to a rounded square.
        let hole = 4.0 + 4.0 * 2.0 + PI;
        assert!((inner.content() - (64.0 - hole)).abs() < 0.01);
    }

    #[test]
    fn growing_rounds_corners() {
        let grown = offset(&rect(0.0, 0.0, 10.0, 10.0), 2.0, 1e-4);
        let exact = 100.0 + 80.0 + 4.0 * PI;
        assert!((grown.content() - exact).abs() < 0.01);
    }

    #[test]
    fn a_ring_thinner_than_the_distance_vanishes() {
        let frame =
            difference(&rect(0.0, 0.0, 9.0, 9.0), &rect(1.0, 1.0, 8.0, 8.0));
        assert!(offset(&frame, -0.6, 1e-3).is_empty());
        assert!(offset(&rect(0.0, 0.0, 1.0, 9.0), -0.6, 1e-3).is_empty());
        // The hole closes when the frame grows.
        let grown = offset(&frame, 4.0, 1e-3);
        assert_eq!(grown.rings.len(), 1);
        // The hole also closes where less than the tolerance is left of it.
        let grown = offset(&frame, 3.4997, 1e-3);
        assert_eq!(grown.rings.len(), 1);
        assert_eq!(offset(&frame, 3.499, 1e-3).rings.len(), 2);
    }

    /// Many small blobs with rough borders, some of which overlap.
    fn noise(side: u32) -> Area {
        let mut seed = 1;
        let mut part = || {
            seed = mix(seed);
            share(seed)
        };
        let mut rings = Vec::new();
        for i in 0..side * side {
            let (column, row) = (f64::from(i % side), f64::from(i / side));
            let middle = DVec2::new(column + part(), row + part()) * 0.4;
            let r = 0.05 + 0.2 * part();
            let count = 12 + (r * 200.0) as u32;
            let turn = 2.0 * PI / f64::from(count);
            let at = |k: u32| {
                let off = r * (0.8 + 0.2 * part());
                middle + DVec2::from_angle(turn * f64::from(k)) * off
            };
            rings.push((0..count).map(at).collect());
        }
        unite(&Area { rings })
    }

    /// A sweep of all moved edges is the simple way.
    #[test]
    fn crowded_edges_move_by_halves() {
        let area = noise(25);
        let (distance, tolerance) = (0.441, 0.01);
        let mut origins = Vec::new();
        let rings = area.rings.iter();
        let rings = rings.map(|r| moved(r, -distance, tolerance, &mut origins));
        let swept = positive(&rings.collect());
        let solid = Solid::of(&area, distance);
        let halves = by_halves(&solid, None, distance, tolerance);
        let error = tolerance * swept.perimeter();
        for (a, b) in [(&halves, &swept), (&swept, &halves)] {
            let more = difference(a, b);
            assert!(more.content() < error, "{}", more.content());
            assert!(opened(&more, tolerance, 1e-3).is_empty());
        }
        assert_eq!(halves, offset(&area, distance, tolerance));
    }

    #[test]
    fn edges_are_crowded_if_nearly_all_are_covered() {
        let states = |clear, covered| {
            let mut all = vec![State::Clear; clear];
            all.extend(vec![State::Covered; covered]);
            all
        };
        let full = 2 * MANY;
        assert!(is_crowded(&states(10, full), 0.4));
        // They are few, or half of them are left, or the distance is small.
        assert!(!is_crowded(&states(10, MANY / 2), 0.4));
        assert!(!is_crowded(&states(full, full), 0.4));
        assert!(!is_crowded(&states(10, full), -0.05));
    }

    #[test]
    fn a_hole_stays_where_its_ring_is_nearly_too_thin() {
        let circle = |r: f64| circle(r, 200);
        for thickness in [0.39, 0.399, 0.401, 0.41, 0.7] {
            let mut hole = circle(5.0 - thickness);
            hole.reverse();
            let ring = Area::from_iter([circle(5.0), hole]);
            let inner = offset(&ring, -0.2, 0.01);
            let left = (thickness - 0.4_f64).max(0.0);
            let exact = 2.0 * PI * (5.0 - 0.5 * thickness) * left;
            assert!(
                (inner.content() - exact).abs() < 0.35,
                "{thickness}: {} for {exact}",
                inner.content()
            );
        }
    }

    #[test]
    fn nothing_is_left_of_a_strip_thinner_than_the_tolerance() {
        // Each side moves through the other and comes out where no side is
        // nearer than it should be, by less than the tolerance.
        for thickness in [0.000_1, 0.002, 0.008_8, 0.012, 0.05] {
            let mut hole = circle(20.0 - thickness, 400);
            hole.reverse();
            let ring = Area::from_iter([circle(20.0, 400), hole]);
            for distance in [-0.2, -0.4] {
                let inner = offset(&ring, distance, 0.01);
                assert!(inner.is_empty(), "{thickness}, {distance}: {inner:?}");
            }
            // A slit as thin closes.
            let slit = Area::from_iter([
                circle(25.0, 400),
                ring.rings[0].iter().rev().copied().collect(),
                ring.rings[1].iter().rev().copied().collect(),
            ]);
            let grown = offset(&slit, 0.2, 0.01);
            let exact = PI * 25.2 * 25.2;
            assert_eq!(grown.rings.len(), 1, "{thickness}");
            assert!((grown.content() / exact - 1.0).abs() < 1e-3);
        }
    }

    #[test]
    fn a_neck_thinner_than_the_distance_parts() {
        let left = rect(0.0, 0.0, 4.0, 4.0);
        let right = rect(6.0, 0.0, 10.0, 4.0);
        let neck = rect(4.0, 1.8, 6.0, 2.2);
        let bell = unite(&Area::from_iter([left, neck, right]));
        assert_eq!(bell.rings.len(), 1);
        let parts = offset(&bell, -0.5, 1e-3);
        assert_eq!(parts.rings.len(), 2);
        // Where the neck begins each part bulges between two arcs.
        let bulge = 2.0 * 0.0055;
        assert!((parts.content() - 18.0 - bulge).abs() < 0.001);
    }

    #[test]
    fn a_wavy_disc_keeps_its_distance() {
        let ring: Vec<DVec2> = (0..720)
            .map(|i| {
                let turn = PI * f64::from(i) / 360.0;
                DVec2::from_angle(turn) * (10.0 + (9.0 * turn).sin())
            })
            .collect();
        let area = Area::from(ring);
        for distance in [-0.3, -2.5, 0.7, 3.0] {
            let moved = offset(&area, distance, 1e-3);
            assert_eq!(moved.rings.len(), 1, "{distance}");
            let grid = EdgeGrid::new(&area, 1.0);
            for &p in &moved.rings[0] {
                let near = grid.nearest_within(p, 4.0).unwrap_or_default();
                let d = p.distance(near.1);
                assert!((d - distance.abs()).abs() < 3e-3, "{distance}: {d}");
            }
        }
    }

    #[test]
    fn a_sliver_across_the_axes_vanishes() {
        for width in [1e-7, 1e-4, 1e-3, 0.01, 0.1, 0.39] {
            let (along, up) = (DVec2::new(4.0, 3.0), DVec2::new(-0.6, 0.8));
            let ring = vec![DVec2::ZERO, along, along + up * width, up * width];
            let inner = offset(&Area::from(ring), -0.2, 1e-3);
            assert!(inner.is_empty(), "{width}: {inner:?}");
        }
    }

    #[test]
    fn spikes_and_repeated_points_do_no_harm() {
        let ring = [
            (0.0, 0.0),
            (5.0, 0.0),
            (5.0, 0.0),
            (9.0, 0.0),
            (5.0, 0.0),
            (5.0, 5.0),
            (0.0, 5.0),
        ]
        .map(DVec2::from)
        .to_vec();
        let area = Area::from(ring);
        let inner = offset(&area, -1.0, 1e-3);
        assert!((inner.content() - 9.0).abs() < 0.01, "{}", inner.content());
        let outer = offset(&area, 1.0, 1e-3);
        assert!(outer.content() > 25.0 + 20.0 + 8.0);
    }
}
