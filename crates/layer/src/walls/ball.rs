//! Balls that touch a border from within at two opposite places.
//!
//! In: an area's border. Out: for points all along the border, the largest ball
//! that touches it there, if the ball also touches the opposite side and is not
//! too large to matter: its centre is on the axis. Of two sides that face each
//! other only one has balls. Where the border turns away from the area, balls
//! touch the corner from all directions between its sides.
//!
//! The balls shrink as in Ma, Bae and Choi, 3D medial axis point
//! approximation using nearest neighbors and the normal field (2012); each
//! begins beside the one before.

use glam::DVec2;
use isoslice_base::units::Mm;
use isoslice_planar::grid::{EdgeGrid, nearest_on};
use isoslice_planar::offset::Room;
use isoslice_planar::{Solid, edges};

/// A point of the axis and the thickness there.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ball {
    pub centre: DVec2,
    pub thickness: Mm,
}

/// Distance of the balls along the border, mm: shorter edges get one each.
pub(super) const BALL_STEP: Mm = 0.2;
/// Accuracy along the border with which the end of an axis is found, mm.
const END: Mm = 0.005;
/// Accuracy of an axis's end where the area becomes thicker than what matters,
/// mm. It may be coarse, since the axis is cut by its thickness there.
const THICK_END: Mm = 0.05;
/// Turn of the border at a corner, and between balls that touch the corner.
const FAN: f64 = 0.35;
/// Greatest depth of the border in a ball that touches it, mm.
const DEEP: Mm = 5e-4;
/// Distance of ball and border below which they touch, mm.
const TOUCHING: Mm = 1e-5;

/// The stretches of edges that balls from the other side touch. Balls that
/// begin on such a stretch would only give the same axis again.
struct Seen {
    /// Each edge's last entry in `stretches`; `NONE` for edges that have no
    /// entry.
    last: Vec<u32>,
    /// Stretches of edges: where each begins and ends along its edge, and the
    /// entry before it of the same edge.
    stretches: Vec<(Mm, Mm, u32)>,
}

const NONE: u32 = u32::MAX;

/// The least and the greatest radius where there are no balls.
const UNKNOWN: (Mm, Mm) = (f64::INFINITY, 0.0);

impl Seen {
    fn new(edges: usize) -> Seen {
        Seen {
            last: vec![NONE; edges],
            stretches: Vec::new(),
        }
    }

    fn add(&mut self, edge: usize, from: Mm, to: Mm) {
        let (low, high) = (from.min(to), from.max(to));
        // Along a long edge each stretch goes on where the one before ends. If
        // the two were kept apart, every ball would look through all stretches.
        if let Some(s) = self.stretches.get_mut(self.last[edge] as usize)
            && low <= s.1
            && s.0 <= high
        {
            (s.0, s.1) = (s.0.min(low), s.1.max(high));
            return;
        }
        let entry = self.stretches.len() as u32;
        self.stretches.push((low, high, self.last[edge]));
        self.last[edge] = entry;
    }

    /// True if all places on an edge are in some stretch.
    fn has_all(&self, mut all: impl Iterator<Item = Mm>, edge: usize) -> bool {
        self.last[edge] != NONE && all.all(|at| self.has(edge, at))
    }

    fn has(&self, edge: usize, at: Mm) -> bool {
        let mut entry = self.last[edge];
        while let Some(&(from, to, before)) = self.stretches.get(entry as usize)
        {
            if (from..=to).contains(&at) {
                return true;
            }
            entry = before;
        }
        false
    }
}

/// The border of an area, from which balls are grown.
pub(super) struct Border<'a> {
    grid: &'a EdgeGrid,
    /// Largest radius that matters.
    radius: Mm,
    /// The edge that follows each edge on its ring.
    next: Vec<u32>,
    /// The edge that comes before each edge on its ring.
    last: Vec<u32>,
    seen: Seen,
    /// The least and the largest radius of the balls that touch each edge.
    radii: Vec<(Mm, Mm)>,
    /// An edge on the opposite side of each edge, or `NONE`.
    opposite: Vec<u32>,
}

/// Where an edge of the border begins.
#[derive(Clone, Copy)]
struct Corner {
    at: DVec2,
    /// The edge's number.
    number: usize,
    /// Across the edge, into the area.
    normal: DVec2,
    /// Sine and cosine of how far the border turns to the area.
    turns: [f64; 2],
}

/// A ball and where it touches the other side.
#[derive(Clone, Copy)]
struct Grown {
    ball: Ball,
    edge: usize,
    touch: DVec2,
}

impl<'a> Border<'a> {
    /// The border of an area.
    pub(super) fn new(solid: &'a Solid<'_>, radius: Mm) -> Border<'a> {
        let area = solid.area();
        let numbers = EdgeGrid::numbers(&area.rings);
        let mut border = Border {
            grid: solid.grid(),
            radius,
            seen: Seen::new(numbers),
            next: Vec::with_capacity(numbers),
            last: Vec::with_capacity(numbers),
            radii: vec![UNKNOWN; numbers],
            opposite: vec![NONE; numbers],
        };
        for ring in area.rings.iter().filter(|r| !r.is_empty()) {
            let first = border.next.len() as u32;
            let last = first + ring.len() as u32 - 1;
            // A number that stands for no edge counts as that of the first
            // edge.
            border.next.extend(first + 1..=last);
            border.next.extend([first, first]);
            border.last.push(last);
            border.last.extend(first..=last);
        }
        border
    }

    /// Balls of points all along a ring, in order; none where the area is
    /// thick, and none where another ball has come from the other side. The
    /// ring's edges are numbered from `first_edge`, as in the grid.
    pub(super) fn balls(
        &mut self,
        ring: &[DVec2],
        first_edge: usize,
    ) -> Vec<Option<Ball>> {
        let mut balls = Vec::with_capacity(ring.len());
        let fan = FAN.cos();
        // The last ball, its edge, and how far along the edge it is.
        let mut before: Option<(usize, Mm, Option<Grown>)> = None;
        let mut last_radius = 0.0;
        let mut very_first_corner = None;
        // The first ball, if there is one at the ring's first point.
        let mut very_first = None;
        let mut last_along = (0..ring.len()).rev().find_map(|i| {
            let (a, b) = (ring[i], ring[(i + 1) % ring.len()]);
            (b - a).try_normalize()
        });
        for (number, (a, b)) in (first_edge..).zip(edges(ring)) {
            if isoslice_base::limits::is_stopped() {
                break;
            }
            let along = b - a;
            let length = along.length();
            if length == 0.0 {
                continue;
            }
            let along = along / length;
            let normal = along.perp();
            let last = last_along.replace(along).unwrap_or(along);
            let (sine, cosine) = (last.perp_dot(along), last.dot(along));
            if sine < 0.0 && cosine < fan {
                let turn = (-sine).atan2(cosine);
                let first = self.fan(a, number, normal, turn, &mut balls);
                before = first.map(|g| (number, 0.0, Some(g)));
            }
            let count = (length / BALL_STEP).ceil().clamp(1.0, 1e6);
            let place = |k: usize| (k as f64 + 0.5) / count * length;
            let corner = Corner {
                at: a,
                number,
                normal,
                turns: [sine, cosine],
            };
            very_first_corner.get_or_insert(corner);
            let count = count as usize;
            if self.seen.has_all((0..count).map(place), number) {
                balls.push(None);
                before = None;
                continue;
            }
            // If nothing is within reach of all centres along the edge, no ball
            // shrinks. The reach is a little less than the radius, or each edge
            // would meet the next one.
            let up = normal * self.radius;
            let beside = before.is_some_and(|b| b.2.is_some());
            if !beside && self.grid.clear(a + up, b + up, 0.98 * self.radius) {
                balls.push(None);
                before = None;
                self.meets(number, 0.98 * self.radius, false);
                continue;
            }
            for at in (0..count).map(place) {
                if self.seen.has(number, at) {
                    balls.push(None);
                    before = None;
                    continue;
                }
                let hint = before.and_then(|b| b.2);
                let here = self.grow(a + along * at, normal, hint);
                self.meets(number, here.0, here.1.is_some());
                if let Some(g) = here.1 {
                    self.opposite[number] = g.edge as u32;
                    self.opposite[g.edge] = number as u32;
                }
                let (radius, here) = here;
                let exact = |radius: Mm| {
                    if radius < self.radius { END } else { THICK_END }
                };
                let exact = [exact(last_radius), exact(radius)];
                last_radius = radius;
                let on_edge = |at: Mm, border: &Border<'_>| {
                    border.grow(a + along * at, normal, hint).1
                };
                match (before, here) {
                    (Some((edge, from, Some(g))), None) if edge == number => {
                        let end = self.end(from, g, at, exact[1], on_edge);
                        balls.push(Some(end.ball));
                        self.mark(g, end);
                    }
                    (Some((edge, from, None)), Some(g)) if edge == number => {
                        let begin = self.end(at, g, from, exact[0], on_edge);
                        balls.push(Some(begin.ball));
                        self.mark(begin, g);
                    }
                    (Some((edge, _, Some(f))), Some(g)) => {
                        let between = (edge != number)
                            .then(|| self.at_corner(corner, f, g))
                            .flatten();
                        balls.extend(between.map(|g| Some(g.ball)));
                        self.mark(between.unwrap_or(f), g);
                    }
                    _ => {}
                }
                if balls.is_empty() {
                    very_first = here;
                }
                balls.push(here.map(|g| g.ball));
                before = Some((number, at, here));
            }
        }
        if let (Some((_, _, Some(last))), Some(first), Some(corner)) =
            (before, very_first, very_first_corner)
        {
            let between = self.at_corner(corner, last, first);
            balls.extend(between.map(|g| Some(g.ball)));
            self.mark(between.unwrap_or(last), first);
        }
        balls
    }

    /// Adds balls that touch the corner at the start of an edge with this
    /// `normal`, where the border turns by `turn` away from the area. Returns
    /// the last of these balls.
    fn fan(
        &mut self,
        corner: DVec2,
        number: usize,
        normal: DVec2,
        turn: f64,
        balls: &mut Vec<Option<Ball>>,
    ) -> Option<Grown> {
        let count = (turn / FAN).ceil();
        let mut before: Option<Grown> = None;
        for k in 0..count as usize {
            let angle = turn * (1.0 - (k as f64 + 0.5) / count);
            let normal = DVec2::from_angle(angle).rotate(normal);
            let (r, here) = self.grow(corner, normal, None);
            let last = self.last[number] as usize;
            self.meets(number, r, here.is_some());
            self.meets(last, r, here.is_some());
            let here = here.filter(|g| {
                // A ball between two corners, or between a corner and an edge,
                // belongs to the first of the two.
                let (a, b) = self.grid.edge(g.edge);
                match g.touch {
                    q if q.distance(a) < TOUCHING => number < g.edge,
                    q if q.distance(b) < TOUCHING => {
                        number < self.next[g.edge] as usize
                    }
                    _ => number < g.edge,
                }
            });
            if let (Some(f), Some(g)) = (before, here) {
                self.mark(f, g);
            }
            balls.push(here.map(|g| g.ball));
            before = here;
        }
        before
    }

    /// The ball that touches a corner, if the axis would be torn between the balls beside
    /// it: around a small hole their centres are much farther apart than the places where
    /// they touch it.
    fn at_corner(
        &mut self,
        corner: Corner,
        before: Grown,
        after: Grown,
    ) -> Option<Grown> {
        let Corner {
            at,
            number,
            normal,
            turns: [sine, cosine],
        } = corner;
        let bends_away = sine < 0.0 && cosine > FAN.cos();
        if !bends_away || before.ball.follows(&after.ball, self.grid) {
            return None;
        }
        let turn = (-sine).atan2(cosine);
        let normal = DVec2::from_angle(0.5 * turn).rotate(normal);
        let here = self.grow(at, normal, Some(before)).1?;
        for edge in [number, self.last[number] as usize] {
            self.meets(edge, 0.5 * here.ball.thickness, true);
        }
        self.mark(before, here);
        Some(here)
    }

    /// The last ball on the way from where there is one to where there is
    /// none, up to `exact` of the way.
    fn end(
        &self,
        mut from: Mm,
        mut last: Grown,
        mut to: Mm,
        exact: Mm,
        grow: impl Fn(Mm, &Border<'_>) -> Option<Grown>,
    ) -> Grown {
        while (to - from).abs() > exact {
            let middle = 0.5 * (from + to);
            match grow(middle, self) {
                Some(g) => (from, last) = (middle, g),
                None => to = middle,
            }
        }
        last
    }

    /// Notes the stretch of border that two balls, one after the other, touch
    /// on the opposite side. The border runs the other way there.
    fn mark(&mut self, first: Grown, second: Grown) {
        /// Edges and length beyond which the two touch different parts of
        /// the border.
        const FEW: usize = 8;
        const LONG: Mm = 5.0 * BALL_STEP;
        if !first.ball.near(&second.ball) {
            return;
        }
        let mut stretch = [(0, 0.0, 0.0); FEW];
        let mut length = 0.0;
        let mut edge = second.edge;
        for k in 0..FEW {
            let (a, b) = self.grid.edge(edge);
            let low = if edge == second.edge {
                second.touch.distance(a)
            } else {
                0.0
            };
            let last = edge == first.edge;
            let high = if last {
                first.touch.distance(a)
            } else {
                a.distance(b)
            };
            stretch[k] = (edge, low, high);
            length += (high - low).abs();
            if length > LONG {
                return;
            }
            if last {
                for (edge, low, high) in stretch.into_iter().take(k + 1) {
                    self.seen.add(edge, low, high);
                    self.meets(edge, 0.5 * first.ball.thickness, true);
                    self.meets(edge, 0.5 * second.ball.thickness, true);
                }
                return;
            }
            edge = self.next[edge] as usize;
        }
    }

    /// Notes the radius of a ball that touches an edge, and whether it touches
    /// the opposite side as well. If it does not, as in a corner, the edge
    /// may go farther.
    fn meets(&mut self, edge: usize, radius: Mm, opposite: bool) {
        let (least, most) = &mut self.radii[edge];
        let largest = if opposite { radius } else { f64::INFINITY };
        (*least, *most) = (least.min(radius), most.max(largest));
    }

    /// How far the edges can move inwards until they meet others.
    pub(super) fn room(self) -> Room {
        let all = |edge: usize| {
            let (last, next) = (self.last[edge], self.next[edge]);
            let near = [last as usize, edge, next as usize];
            let radii = near.map(|e| match self.radii[e] {
                // No ball has touched this edge.
                (least, _) if least == f64::INFINITY => (0.0, f64::INFINITY),
                radii => radii,
            });
            radii
                .into_iter()
                .fold(UNKNOWN, |a, b| (a.0.min(b.0), a.1.max(b.1)))
        };
        let (least, most) = (0..self.next.len()).map(all).unzip();
        Room {
            least,
            most,
            opposite: self.opposite,
        }
    }

    /// The radius of the largest ball that touches the border at `p`, or 0 if
    /// there is no such ball. With it comes the ball, if it is small enough to
    /// matter and touches the opposite side as well. `hint` is a ball from
    /// nearby.
    fn grow(
        &self,
        p: DVec2,
        normal: DVec2,
        hint: Option<Grown>,
    ) -> (Mm, Option<Grown>) {
        let guess = hint.and_then(|h| self.beside(p, normal, h));
        let shrunk = match guess {
            Some((r, touch)) => {
                let shrunk = self.shrink(p, normal, r);
                shrunk.map(|(r, nearer)| (r, nearer.or(Some(touch))))
            }
            None => self.shrink(p, normal, self.radius),
        };
        let Some((r, touch)) = shrunk else {
            return (0.0, None);
        };
        let Some((edge, q)) = touch else {
            return (r, None);
        };
        let centre = p + normal * r;
        // Seen from the centre, p and q are more than 120° apart.
        let opposite = (p - centre).dot(q - centre) < -0.5 * r * r;
        let ball = Ball {
            centre,
            thickness: 2.0 * r,
        };
        let grown = Grown {
            ball,
            edge,
            touch: q,
        };
        (r, opposite.then_some(grown))
    }

    /// The radius of a ball at `p` that touches the border where another ball
    /// did, or beside that place. Nothing larger fits there.
    fn beside(
        &self,
        p: DVec2,
        normal: DVec2,
        hint: Grown,
    ) -> Option<(Mm, (usize, DVec2))> {
        /// Rounds after which the ball is small enough for its exact size to be
        /// looked for among all edges.
        const ROUNDS: usize = 6;
        let (before, after) = (self.last[hint.edge], self.next[hint.edge]);
        let beside = [hint.edge, before as usize, after as usize];
        let mut r = (0.75 * hint.ball.thickness).min(self.radius);
        let mut touch = None;
        for _ in 0..ROUNDS {
            let centre = p + normal * r;
            let (mut d, mut edge, mut q) = (f64::INFINITY, hint.edge, p);
            for e in beside {
                let (a, b) = self.grid.edge(e);
                let near = nearest_on(centre, a, b);
                let off = near.distance_squared(centre);
                if off < d {
                    (d, edge, q) = (off, e, near);
                }
            }
            if d >= (r - TOUCHING).max(0.0).powi(2) {
                break;
            }
            let v = q - p;
            let up = normal.dot(v);
            if up <= TOUCHING {
                return None;
            }
            touch = Some((edge, q));
            r = v.length_squared() / (2.0 * up);
        }
        touch.map(|t| (r, t))
    }

    /// The ball of radius `r` at `p` shrunk until nothing of the border is in
    /// it: its radius, and the point of the border that it touches last.
    fn shrink(
        &self,
        p: DVec2,
        normal: DVec2,
        mut r: Mm,
    ) -> Option<(Mm, Option<(usize, DVec2)>)> {
        /// Rounds after which a ball that still shrinks is given up: each
        /// brings it to touch a nearer edge, and few edges are near.
        const ROUNDS: usize = 16;
        let mut touch = None;
        for _ in 0..ROUNDS {
            let centre = p + normal * r;
            let near = self
                .grid
                .nearest_edge(centre, r - TOUCHING)
                .filter(|(_, q)| q.distance_squared(p) > TOUCHING * TOUCHING);
            let Some((edge, q)) = near else { break };
            let v = q - p;
            let up = normal.dot(v);
            if up <= 0.0 {
                return None;
            }
            touch = Some((edge, q));
            // No edge reaches much deeper into the new ball than this edge
            // reached into the ball before.
            let deep = r - q.distance(centre);
            r = v.length_squared() / (2.0 * up);
            if deep < DEEP {
                break;
            }
        }
        Some((r, touch))
    }
}

impl Ball {
    /// True if the two balls can be neighbours on an axis.
    pub(super) fn near(&self, other: &Ball) -> bool {
        let apart = self.centre.distance_squared(other.centre);
        apart
            < (2.0 * BALL_STEP + 0.25 * self.thickness.min(other.thickness))
                .powi(2)
    }
}
