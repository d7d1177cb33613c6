//! Walls that take what nothing else fills where strips meet.
//!
//! ```text
//!     ┃  ┃ ┃  ┃        Where two walls lie side by side in each of some
//!   ━━╯  ╰─╯  ╰━━      strips, they leave a pocket where the strips meet. It
//!          ○           is too small for a bead of its own, and no axis runs
//!   ━━╮  ╭─╮  ╭━━      through it. Each wall beside it becomes as much wider
//!     ┃  ┃ ┃  ┃        as a ball is large that touches it from within.
//! ```
//!
//! In: a wall's lines. Out: these lines, wider beside pockets. The balls are those
//! of the medial axis of what the wall leaves, so that walls on all sides of a
//! pocket meet in its middle.

use super::line::AxisIndex;
use super::medial_axis::Axis;
use super::widen::{CORNER, Station, across, nowhere, widened};
use glam::DVec2;
use isoslice_base::units::Mm;
use isoslice_planar::bead::Stroke;
use isoslice_planar::grid::EdgeGrid;

/// Distance of the places at which a line is looked at, mm.
const LOOK_STEP: Mm = 0.08;
/// Pockets with smaller balls than this are left as they are, and so are walls
/// that lack less, mm.
const LEAST: Mm = 0.02;
/// Slack in distances that are equal but for thinning, mm.
const THINNED: Mm = 0.01;
/// Accuracy of the size of a ball, mm.
const EXACT: Mm = 0.002;
/// Greatest number of times that a ball shrinks.
const ROUNDS: usize = 8;
/// Directions in which a place for other beads is looked for.
const AROUND: usize = 8;

/// The part of an area that a wall leaves, and what is laid there.
pub(super) struct Left<'a> {
    /// The area's edges.
    pub grid: &'a EdgeGrid,
    /// Depth in the area at which this part begins.
    pub depth: Mm,
    /// Distance of the wall's centre lines from this part.
    pub away: Mm,
    /// Width of the wall where nothing has widened it.
    pub width: Mm,
    /// Radius of the balls beside which another wall or skin is laid.
    pub radius: Mm,
    /// The beads in thin places of this part, as its axes.
    pub beads: &'a [Axis],
    /// The ends of the area's axes, which are wherever strips meet.
    pub nodes: &'a EdgeGrid,
    /// Greatest distance of a pocket from such an end.
    pub around: Mm,
    /// True if walls may be wide where skin would be.
    pub shares: bool,
}

impl Left<'_> {
    /// Widens lines beside pockets. Lines are thinned to `tolerance`.
    pub(super) fn shared(
        &self,
        lines: Vec<Stroke>,
        tolerance: Mm,
    ) -> Vec<Stroke> {
        let beads = AxisIndex::new(self.beads, self.reach());
        lines
            .into_iter()
            .map(|line| self.filled(line, &beads, tolerance))
            .collect()
    }

    /// Greatest distance from a pocket's middle of a bead that matters to it.
    fn reach(&self) -> Mm {
        2.0 * self.radius
    }

    fn filled(
        &self,
        line: Stroke,
        beads: &AxisIndex<'_>,
        tolerance: Mm,
    ) -> Stroke {
        if isoslice_base::limits::is_stopped() {
            return line;
        }
        let n = line.points.len();
        let segments = if line.closed { n } else { n.saturating_sub(1) };
        let mut places: Vec<Station> = Vec::with_capacity(n);
        // Slivers may have widened it already.
        let more = |width: Mm| (width - self.width).max(0.0);
        let mut push = |p: DVec2, width: Mm, across: DVec2, near: bool| {
            let inwards = across.normalize_or_zero();
            let more = more(width);
            let usual = p - 0.5 * more * inwards;
            let ball = if near {
                self.pocket(usual, inwards, more, beads).unwrap_or(0.0)
            } else {
                0.0
            };
            let lacks = ball - more;
            places.push(Station {
                at: p,
                across,
                width,
                moves: (lacks > LEAST).then_some(0.5 * lacks),
                narrows: false,
                passed: false,
            });
        };
        let mut near = false;
        for k in 0..segments {
            let next = (k + 1) % n;
            let (a, b) = (line.points[k], line.points[next]);
            let along = (b - a).normalize_or_zero();
            let at_a = across(&line, k);
            let before = near;
            near = !self.nodes.clear(a, b, self.around);
            push(a, line.width_at(k), at_a, near || before);
            if !near || self.is_thick(a, b, along.perp()) {
                continue;
            }
            let count = (a.distance(b) / LOOK_STEP).ceil().clamp(1.0, 1e6);
            for i in 1..count as usize {
                let t = i as f64 / count;
                let (v, w) = (line.width_at(k), line.width_at(next));
                push(a.lerp(b, t), v + t * (w - v), along.perp(), true);
            }
        }
        if let (false, [_, .., b]) = (line.closed, line.points.as_slice()) {
            push(*b, line.width_at(n - 1), across(&line, n - 1), near);
        }
        // A single place is no pocket.
        for i in 0..places.len() {
            let stays =
                |k: usize| places.get(k).is_none_or(|p| p.moves.is_none());
            if stays(i.wrapping_sub(1)) && stays(i + 1) {
                places[i].moves = None;
            }
        }
        let room = |place: &Station, moves: Mm| {
            let inwards = place.across.normalize_or_zero();
            let radius = more(place.width) + 2.0 * moves;
            let on = self.away + radius - 0.5 * more(place.width);
            self.shares && self.fits(place.at + on * inwards, radius)
        };
        widened(places, line.closed, tolerance, CORNER, nowhere, room)
            .unwrap_or(line)
    }

    /// True if there is room for other beads all along a segment.
    fn is_thick(&self, a: DVec2, b: DVec2, inwards: DVec2) -> bool {
        let up = inwards * (self.away + self.radius);
        // The wall's own border is no nearer than this.
        self.grid
            .clear(a + up, b + up, self.depth + self.radius - THINNED)
    }

    /// True if a ball fits into what the wall leaves.
    fn fits(&self, p: DVec2, radius: Mm) -> bool {
        self.grid.clear(p, p, self.depth + radius - THINNED)
    }

    /// The radius of the ball that touches what the wall leaves beside a place
    /// of its line, if it is larger than what is `filled` already and nothing else is
    /// laid there.
    fn pocket(
        &self,
        p: DVec2,
        inwards: DVec2,
        filled: Mm,
        beads: &AxisIndex<'_>,
    ) -> Option<Mm> {
        let base = p + self.away * inwards;
        if !self.fits(base + LEAST * inwards, LEAST) {
            return None;
        }
        // A ball shrinks until it touches the border but nowhere reaches over
        // it (Ma, Bae and Choi 2012).
        let mut low = self.radius;
        for round in 0..ROUNDS {
            let depth = self.depth - THINNED;
            let centre = base + low * inwards;
            let Some((_, q)) = self.grid.nearest_edge(centre, depth + low)
            else {
                break;
            };
            // The radius with which the ball touches the border at `q`.
            let way = base - q;
            let room = 2.0 * (depth - way.dot(inwards));
            let least = (way.length_squared() - depth * depth) / room;
            if room <= 0.0 || least >= low - EXACT || round + 1 == ROUNDS {
                break;
            }
            low = least.max(LEAST);
        }
        if low >= self.radius || low - filled <= LEAST {
            return None;
        }
        let bead_near = |p: DVec2, radius: Mm| {
            beads
                .nearest(p, self.reach())
                .is_some_and(|(q, t)| p.distance(q) < 0.5 * (t + radius))
        };
        let centre = base + low * inwards;
        if bead_near(centre, low) {
            return None;
        }
        (!self.is_laid_around(centre)).then_some(low - 0.5 * THINNED)
    }

    /// True if other beads are laid around a ball: there is room for them in some
    /// direction from its middle.
    fn is_laid_around(&self, centre: DVec2) -> bool {
        // What is in the way in one direction often is in the next one as well.
        let reach = self.depth + self.radius - THINNED;
        let mut last: Option<u32> = None;
        let mut clear = |p: DVec2| {
            let edge = last.as_slice();
            if self.grid.nearest_of(edge, p, reach).is_some() {
                return false;
            }
            last = None;
            self.grid.near(p, p, reach, |edge| {
                last = Some(edge as u32);
                false
            });
            last.is_none()
        };
        (0..AROUND).any(|k| {
            let turn = std::f64::consts::TAU * k as f64 / AROUND as f64;
            let to = DVec2::from_angle(turn) * self.radius;
            clear(centre + 0.6 * to) || clear(centre + 1.2 * to)
        })
    }
}
