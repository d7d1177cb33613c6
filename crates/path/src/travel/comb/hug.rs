//! Finds tight ways round rings from convex hulls.
//!
//! ```text
//!               ·─────·          The way is the hull of three things: a, b,
//!            ·  ╭─────╮  ·       and the hull of the ring's stretch between
//!         ·   ╭─╯ ring╰─╮   ·    the places where the straight way leaves and
//!   a ┈┈┈┈┈┈┈┈┼┈┈┈┈┈┈┈┈┈┼┈┈┈ b   comes back, moved away by the clearance.
//! ```

use super::rings::Mark;
use super::{BEFORE_PULLING_TIGHT, Comb, KEPT, Stop, stops_length};
use glam::DVec2;
use isoslice_base::units::Mm;
use isoslice_planar::path_length;

/// Greatest turn at a stop, radians (26°). So stops are few, and a way is a few
/// per cent longer than a round one.
const TURN: f64 = 0.45;

/// Turn below which a way counts as straight, radians.
const STRAIGHT: f64 = 1e-6;

/// How many times longer one side of a ring may be than the other to be tried.
const ROUND_ABOUT: f64 = 1.5;

/// Distance below which a point is on the straight way, mm.
const ON_LINE: Mm = 1e-6;

/// How many times longer than the straight line a way past several rings has to
/// be for it to be pulled tight once more.
const WORTH: f64 = 1.1;

/// Shares of the clearance that are tried: narrow places have less room.
const SHARES: [f64; 3] = [1.0, 0.6, 0.3];

/// The hull of a stretch of a ring beside a straight way.
struct Hull {
    /// The hull's points. Their x runs along the straight way, and their y to the
    /// side on which the stretch lies.
    points: Vec<DVec2>,
    along: DVec2,
    aside: DVec2,
    /// Length of the straight way.
    length: Mm,
}

impl Comb<'_> {
    /// The tight way past the rings that the straight way from `a` to `b`
    /// meets; none if another ring is in the way.
    pub(super) fn hugging(
        &self,
        a: Stop,
        b: Stop,
        marks: &[Mark],
        longest: Mm,
    ) -> Option<Vec<Stop>> {
        if marks.is_empty() {
            return self.passing(a, b);
        }
        let hulls: Option<Vec<Hull>> = marks
            .chunks_exact(2)
            .map(|pair| self.hull(a.at, b.at, pair, longest))
            .collect();
        let hulls = hulls?;
        SHARES.iter().find_map(|share| {
            let room = share * self.clearance;
            let mut way = vec![a];
            for hull in &hulls {
                hull.push_stops(a, room, &mut way);
            }
            way.push(b);
            if marks.len() == 2 {
                return self.clear_way(&way).then_some(way);
            }
            let way = self.pulled(&way)?;
            if stops_length(&way) < WORTH * a.at.distance(b.at) {
                Some(way)
            } else {
                Some(self.tightened(a, way))
            }
        })
    }

    /// The tight way from `a` to `b`, which see each other, but between which
    /// the straight line comes too near to the border on one side.
    fn passing(&self, a: Stop, b: Stop) -> Option<Vec<Stop>> {
        SHARES.iter().find_map(|share| {
            let room = share * self.clearance;
            let hull = self.hull_near(a.at, b.at, room)?;
            let mut way = vec![a];
            hull.push_stops(a, room, &mut way);
            way.push(b);
            self.clear_way(&way).then_some(way)
        })
    }

    /// The hull of the border's points near a straight way; none if such points
    /// are on both sides.
    fn hull_near(&self, a: DVec2, b: DVec2, reach: Mm) -> Option<Hull> {
        let length = a.distance(b);
        let along = (b - a) / length;
        let mut aside = along.perp();
        let mut near: Vec<DVec2> = Vec::new();
        self.grid().visit_edges_near(a, b, reach, |edge| {
            let (p, q) = self.grid().edge(edge);
            let place =
                |p: DVec2| DVec2::new((p - a).dot(along), (p - a).dot(aside));
            let beside = |p: &DVec2| (0.0..=length).contains(&p.x);
            near.extend([place(p), place(q)].into_iter().filter(beside));
        });
        let below = near.first()?.y < 0.0;
        if near.iter().any(|p| (p.y < 0.0) != below) {
            return None;
        }
        if !below {
            aside = -aside;
            near.iter_mut().for_each(|p| p.y = -p.y);
        }
        near.sort_by(|p, q| p.x.total_cmp(&q.x).then(p.y.total_cmp(&q.y)));
        Some(Hull {
            points: upper(near.into_iter()),
            along,
            aside,
            length,
        })
    }

    fn clear_way(&self, way: &[Stop]) -> bool {
        way.windows(2).all(|pair| {
            let room = pair[0].room.min(pair[1].room);
            self.grid().clear(pair[0].at, pair[1].at, KEPT * room)
        })
    }

    /// The shorter of the hulls on the two sides of a ring.
    fn hull(
        &self,
        a: DVec2,
        b: DVec2,
        pair: &[Mark],
        longest: Mm,
    ) -> Option<Hull> {
        let rings = self.rings();
        let ring = rings.places.ring(pair[0].edge);
        let total = rings.places.length(ring);
        let forwards = (rings.place(self.grid(), &pair[1])
            - rings.place(self.grid(), &pair[0]))
        .rem_euclid(total);
        let mut sides = [(true, forwards), (false, total - forwards)];
        sides.sort_by(|p, q| p.1.total_cmp(&q.1));
        let mut best: Option<(Mm, Hull)> = None;
        for (ahead, length) in sides {
            let worse = best.is_some() && length > ROUND_ABOUT * sides[0].1;
            if worse || length > BEFORE_PULLING_TIGHT * longest {
                break;
            }
            let stretch = self.stretch(pair[0], pair[1], ahead);
            let Some(hull) = Hull::new(a, b, &stretch, ahead) else {
                continue;
            };
            let way = path_length(&hull.points, false);
            if best.as_ref().is_none_or(|b| way < b.0) {
                best = Some((way, hull));
            }
        }
        best.map(|b| b.1)
    }

    /// The part of a ring from one mark to the other, in the ring's direction
    /// or against it.
    fn stretch(&self, from: Mark, to: Mark, ahead: bool) -> Vec<DVec2> {
        let rings = self.rings();
        let ring = rings.places.ring(from.edge);
        let first = rings.places.first(ring);
        let count = rings.places.of_ring(ring).len();
        let (begin, end) = if ahead { (from, to) } else { (to, from) };
        let mut steps = (end.edge + count - begin.edge) % count;
        if steps == 0
            && rings.place(self.grid(), &end) < rings.place(self.grid(), &begin)
        {
            steps = count;
        }
        let mut points = Vec::with_capacity(steps + 2);
        points.push(begin.at);
        for k in 0..steps {
            let edge = first + (begin.edge - first + k) % count;
            points.push(self.grid().edge(edge).1);
        }
        points.push(end.at);
        if !ahead {
            points.reverse();
        }
        points
    }
}

impl Hull {
    /// The hull of a stretch that begins and ends on the line from `a` to `b`.
    /// None if the stretch is on the wrong side, or winds back behind an end.
    /// With `ahead` the stretch runs as its ring does, with the area to its
    /// left.
    fn new(a: DVec2, b: DVec2, stretch: &[DVec2], ahead: bool) -> Option<Hull> {
        let first = stretch.first()?;
        let twice: f64 = stretch
            .windows(2)
            .map(|p| (p[0] - first).perp_dot(p[1] - first))
            .sum();
        // The outside of the area lies to the right of its rings.
        let left = twice < 0.0;
        if left != ahead {
            return None;
        }
        let length = a.distance(b);
        let along = (b - a) / length;
        let aside = if left { along.perp() } else { -along.perp() };
        let mut above: Vec<DVec2> = stretch
            .iter()
            .map(|&p| DVec2::new((p - a).dot(along), (p - a).dot(aside)))
            .filter(|p| p.y > -ON_LINE)
            .collect();
        if !above.iter().all(|p| (0.0..=length).contains(&p.x)) {
            return None;
        }
        above.sort_by(|p, q| p.x.total_cmp(&q.x).then(p.y.total_cmp(&q.y)));
        Some(Hull {
            points: upper(above.into_iter()),
            along,
            aside,
            length,
        })
    }

    /// Appends the stops of the way round the hull, `far` away from it.
    fn push_stops(&self, a: Stop, far: Mm, way: &mut Vec<Stop>) {
        way.extend(self.stops(a.at, far).into_iter().map(|at| Stop {
            at,
            room: far,
            base: at,
        }));
    }

    /// The stops of the way round the hull, `far` away from it.
    fn stops(&self, a: DVec2, far: Mm) -> Vec<DVec2> {
        let inside = |p: &DVec2| p.x > 0.0 && p.x < self.length;
        let corners = around(&self.points, far).into_iter().filter(inside);
        let end = DVec2::new(self.length, 0.0);
        let all = [DVec2::ZERO].into_iter().chain(corners).chain([end]);
        let way = upper(all);
        let stops = way.get(1..way.len() - 1).unwrap_or_default();
        let place = |p: &DVec2| a + p.x * self.along + p.y * self.aside;
        stops.iter().map(place).collect()
    }
}

/// The upper side of the hull of points that are sorted by x.
fn upper(points: impl Iterator<Item = DVec2>) -> Vec<DVec2> {
    let mut hull: Vec<DVec2> = Vec::new();
    for p in points {
        while let [.., o, q] = hull[..]
            && (q - o).perp_dot(p - o) >= 0.0
        {
            hull.pop();
        }
        hull.push(p);
    }
    hull
}

/// Points around an upper hull, `far` away from it: where its moved sides meet.
/// Many small turns get few points, a sharp corner gets several. The points
/// begin with an upward side and end with a downward one.
fn around(hull: &[DVec2], far: Mm) -> Vec<DVec2> {
    // Lines that touch the hull: a point and a direction.
    let mut touching: Vec<(DVec2, DVec2)> = Vec::new();
    touching.extend(hull.first().map(|&p| (p, DVec2::Y)));
    let side = |i: usize| (hull[i + 1] - hull[i]).normalize_or_zero();
    let mut before = DVec2::Y;
    let turns = |from: DVec2, to: DVec2| from.dot(to) < TURN.cos();
    for (i, &corner) in hull.iter().enumerate() {
        let last = i + 1 == hull.len();
        let next = if last { DVec2::NEG_Y } else { side(i) };
        let since = touching.last().map_or(next, |t| t.1);
        if turns(before, next) {
            if right_turn(since, before) > STRAIGHT {
                touching.push((corner, before));
            }
            let turn = right_turn(before, next);
            let parts = (turn / TURN).ceil();
            for k in 1..parts as usize {
                let by = DVec2::from_angle(-turn * k as f64 / parts);
                touching.push((corner, by.rotate(before)));
            }
            touching.push((corner, next));
        } else if last || turns(since, next) {
            touching.push((corner, next));
        }
        before = next;
    }
    let moved = |(p, d): (DVec2, DVec2)| (p + far * d.perp(), d);
    let meeting = |pair: &[(DVec2, DVec2)]| {
        let ((p, d), (q, e)) = (moved(pair[0]), moved(pair[1]));
        let turn = d.perp_dot(e);
        (turn.abs() > STRAIGHT).then(|| p + d * ((q - p).perp_dot(e) / turn))
    };
    touching.windows(2).filter_map(meeting).collect()
}

/// By how much the direction turns to the right, radians.
fn right_turn(from: DVec2, to: DVec2) -> f64 {
    -from.perp_dot(to).atan2(from.dot(to))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn half_a_circle_is_rounded_at_its_distance() {
        let n = 400;
        // The area is outside, to the left of a ring that runs clockwise.
        let stretch: Vec<DVec2> = (0..=n)
            .map(|i| 5.0 * DVec2::from_angle(PI * (1.0 - f64::from(i) / 400.0)))
            .collect();
        let (a, b) = (DVec2::new(-15.0, 0.0), DVec2::new(15.0, 0.0));
        let stops = Hull::new(a, b, &stretch, true).unwrap().stops(a, 0.5);
        let nearest = |p: DVec2, q: DVec2| {
            isoslice_planar::grid::nearest_on(DVec2::ZERO, p, q).length()
        };
        let way: Vec<DVec2> = [a].into_iter().chain(stops).chain([b]).collect();
        let least = way
            .windows(2)
            .map(|p| nearest(p[0], p[1]))
            .fold(f64::INFINITY, f64::min);
        assert!((5.49..=5.51).contains(&least), "{least}");
        assert!(way.len() < 9, "{way:?}");
        // From a place near the ring the way keeps away from it, too.
        let (a, b) = (DVec2::new(-5.6, 0.0), DVec2::new(5.6, 0.0));
        let stops = Hull::new(a, b, &stretch, true).unwrap().stops(a, 0.5);
        for pair in stops.windows(2) {
            assert!(nearest(pair[0], pair[1]) > 5.49, "{stops:?}");
        }
        assert!(nearest(a, stops[0]) > 5.45, "{stops:?}");
        assert!(Hull::new(a, b, &stretch, false).is_none());
    }

    #[test]
    fn a_thin_wall_is_rounded_at_its_end() {
        let stretch =
            [(9.9, 0.0), (9.9, 4.0), (10.1, 4.0), (10.1, 0.0)].map(DVec2::from);
        let (a, b) = (DVec2::ZERO, DVec2::new(20.0, 0.0));
        let stops = Hull::new(a, b, &stretch, true).unwrap().stops(a, 0.5);
        for p in &stops {
            assert!(p.y > 4.0 && p.y < 4.6, "{stops:?}");
        }
        let low = DVec2::new(10.0, 4.0);
        assert!(stops.iter().all(|p| p.distance(low) < 0.75), "{stops:?}");
    }
}
